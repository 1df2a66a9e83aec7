/* Sets and surfaces of an Abaqus file. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "model/format/inp/reader.h"

lar_span inp_without_instance(lar_span name) {
    size_t dot = name.length;
    while (dot > 0 && name.at[dot - 1] != '.') dot--;
    return (lar_span){name.at + dot, name.length - dot};
}

static inp_set *find_set(const inp_reader *reader, lar_span name, lar_set_kind kind, bool in_part) {
    for (size_t s = 0; s < reader->set_count; s++) {
        inp_set *set = &reader->set[s];
        if (set->kind == kind && set->in_part == in_part && lar_span_equal_nocase(name, set->name))
            return set;
    }
    return NULL;
}

/* The set that a card means by a name: one of its own scope before one of the other. */
static const inp_set *named_set(const inp_reader *reader, lar_span name, lar_set_kind kind) {
    const lar_span bare = inp_without_instance(name);
    for (int look = 0; look < 4; look++) {
        bool part = look < 2 ? reader->of_part == (look == 0) : look == 2;
        const inp_set *set = find_set(reader, look < 2 ? name : bare, kind, part);
        if (set) return set;
    }
    return NULL;
}

/* Whether a set of the part needs its instance's name before its own. Sets of elements and of faces
 * share their names, because elements without volume become faces. */
static bool is_taken(const inp_reader *reader, const inp_set *set) {
    for (size_t s = 0; s < reader->set_count && set->in_part; s++) {
        const inp_set *other = &reader->set[s];
        if (!other->in_part && (other->kind == LAR_SET_NODES) == (set->kind == LAR_SET_NODES) &&
            strcasecmp(other->name, set->name) == 0)
            return true;
    }
    return false;
}

lar_status inp_name_sets(inp_reader *reader) {
    const char *instance = reader->instance ? reader->instance : "";
    for (size_t s = 0; s < reader->set_count; s++) {
        inp_set *set = &reader->set[s];
        if (set->built || !is_taken(reader, set)) continue;
        size_t size = strlen(instance) + strlen(set->name) + 2;
        set->built = malloc(size);
        if (!set->built) return lar_fail_memory(reader->error, size, "a name");
        snprintf(set->built, size, "%s.%s", instance, set->name);
    }
    return LAR_OK;
}

lar_status inp_open_set(inp_reader *reader, lar_span name, lar_set_kind kind, inp_set **set) {
    *set = find_set(reader, name, kind, reader->in_part);
    if (*set) return LAR_OK;
    if (reader->set_count >= LAR_MESH_SETS_MAX)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: holds more than %d named sets; remove those that are not used",
                        reader->path, LAR_MESH_SETS_MAX);
    char *copy = lar_strndup(name.at, name.length);
    if (!copy || !LAR_GROW(reader->set, reader->set_capacity, reader->set_count)) {
        free(copy);
        return lar_fail_memory(reader->error, sizeof **set, "a set");
    }
    *set = &reader->set[reader->set_count++];
    **set = (inp_set){.name = copy, .kind = kind, .in_part = reader->in_part};
    return LAR_OK;
}

static lar_status spend_entry(inp_reader *reader, int line) {
    if (reader->entries_left > 0) {
        reader->entries_left--;
        return LAR_OK;
    }
    return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: the sets repeat the same nodes or elements more often than such a file "
                    "can mean; remove sets that are not used",
                    reader->path, line);
}

lar_status inp_add_entry(inp_reader *reader, inp_set *set, inp_entry entry) {
    lar_status status = spend_entry(reader, entry.line);
    if (status) return status;
    if (!LAR_GROW(set->entry, set->capacity, set->count))
        return lar_fail_memory(reader->error, set->count * sizeof *set->entry, "a set");
    set->entry[set->count++] = entry;
    return LAR_OK;
}

/* ---- elements without volume -------------------------------------------------------------- */

static int compare_boundary(const void *id, const void *boundary) {
    int64_t x, y = ((const inp_boundary *)boundary)->id;
    memcpy(&x, id, sizeof x);
    return (x > y) - (x < y);
}

static const inp_boundary *find_boundary(const inp_reader *reader, int64_t id) {
    if (reader->boundary_count == 0) return NULL;
    return bsearch(&id, reader->boundary, reader->boundary_count, sizeof *reader->boundary,
                   compare_boundary);
}

lar_status inp_check_solids(inp_reader *reader, lar_span name) {
    const inp_set *set = named_set(reader, name, LAR_SET_ELEMENTS);
    for (size_t i = 0; set && i < set->count; i++) {
        const inp_boundary *found = find_boundary(reader, set->entry[i].id);
        if (found)
            return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                            "%s:%d: element %lld is of type %s, and a *SOLID SECTION gives it a "
                            "material; Lariat computes with eight-node hexahedra, take it out of "
                            "the set '%s'",
                            reader->path, found->line, (long long)found->id, found->type,
                            set->name);
    }
    return LAR_OK;
}

/* ---- *NSET and *ELSET --------------------------------------------------------------------- */

static lar_status fail_set_name(inp_reader *reader, int line, lar_span name, bool of_nodes) {
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s:%d: '%.*s' is neither a number nor %s set defined above; correct the "
                    "name or move the set up",
                    reader->path, line, (int)(name.length < 60 ? name.length : 60), name.at,
                    of_nodes ? "a node" : "an element");
}

/* The first of the ids that is not below this one. */
static size_t first_id(const inp_ids *ids, int64_t id) {
    size_t low = 0, high = ids->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (ids->id[middle] < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool inp_is_apart(const inp_reader *reader, int64_t id) {
    size_t at = first_id(&reader->apart, id);
    return !reader->of_part && at < reader->apart.count && reader->apart.id[at] == id;
}

/* A number of a list or a range. */
static lar_status add_number(inp_reader *reader, inp_set *set, int64_t id, int at) {
    if (set->kind == LAR_SET_NODES && inp_is_apart(reader, id)) return spend_entry(reader, at);
    return inp_add_entry(reader, set, (inp_entry){id, at, false});
}

/* Of a range so many numbers exist: unlike a list it may have others too, which is told; none is a
 * slip. */
static lar_status check_range(inp_reader *reader, bool of_nodes, uint64_t found, uint64_t wanted,
                              int at) {
    if (found == 0)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s:%d: the file defines no %s of this range; correct it or remove the "
                        "line",
                        reader->path, at, of_nodes ? "node" : "element");
    if (found == wanted) return LAR_OK;
    if (reader->sparse_ranges++ == 0) reader->sparse_line = at;
    return LAR_OK;
}

/* first, last, step: those of the range that the file defines. */
static lar_status add_range(inp_reader *reader, inp_set *set, lar_span line, int at) {
    int64_t bound[3] = {0, 0, 1};
    lar_span field, rest = line;
    for (int i = 0; i < 3; i++) {
        lar_span_split(rest, ',', &field, &rest);
        field = lar_span_trim(field);
        if (i == 2 && field.length == 0) break;
        if (!lar_span_int64(field, &bound[i]))
            return inp_expected(reader, at, "first, last, step after GENERATE", line);
    }
    if (bound[1] < bound[0] || bound[2] < 1)
        return inp_expected(reader, at, "an ascending range after GENERATE", line);
    const bool of_nodes = set->kind == LAR_SET_NODES;
    const inp_ids *ids = of_nodes ? &reader->nodes : &reader->elements;
    uint64_t found = 0;
    for (size_t low = first_id(ids, bound[0]); low < ids->count && ids->id[low] <= bound[1];
         low++) {
        uint64_t offset = (uint64_t)ids->id[low] - (uint64_t)bound[0];
        bool wanted = offset % (uint64_t)bound[2] == 0;
        found += wanted;
        lar_status status =
            wanted ? add_number(reader, set, ids->id[low], at) : spend_entry(reader, at);
        if (status) return status;
    }
    uint64_t span = (uint64_t)bound[1] - (uint64_t)bound[0];
    return check_range(reader, of_nodes, found, span / (uint64_t)bound[2] + 1, at);
}

/* Numbers and names of sets, comma separated. */
static lar_status add_list(inp_reader *reader, inp_set *set, lar_span line, int at) {
    lar_span field, rest = line;
    while (rest.length > 0) {
        lar_span_split(rest, ',', &field, &rest);
        field = lar_span_trim(field);
        int64_t id;
        lar_status status = LAR_OK;
        if (field.length == 0) continue;
        if (lar_span_int64(field, &id)) {
            status = add_number(reader, set, id, at);
        } else {
            const inp_set *other = named_set(reader, field, set->kind);
            if (!other) return fail_set_name(reader, at, field, set->kind == LAR_SET_NODES);
            /* A set may name itself: it gets the entries it has now once more. */
            for (size_t i = 0, count = other->count; i < count && !status; i++)
                status = inp_add_entry(
                    reader, set, (inp_entry){other->entry[i].id, at, other->entry[i].corners});
        }
        if (status) return status;
    }
    return LAR_OK;
}

/* The nodes of an element set. */
static lar_status add_nodes_of(inp_reader *reader, inp_set *set, lar_span name, int at) {
    const inp_set *from = named_set(reader, name, LAR_SET_ELEMENTS);
    if (!from) return fail_set_name(reader, at, name, false);
    lar_status status = LAR_OK;
    for (size_t i = 0; i < from->count && !status; i++) {
        const inp_boundary *boundary = find_boundary(reader, from->entry[i].id);
        if (!boundary)
            status = inp_add_entry(reader, set, (inp_entry){from->entry[i].id, at, true});
        for (int a = 0; boundary && boundary->is_quad && a < 4 && !status; a++)
            status = inp_add_entry(reader, set, (inp_entry){boundary->node_ids[a], at, false});
    }
    return status;
}

static lar_status read_set(inp_reader *reader, const inp_card *card, bool of_nodes) {
    lar_span name, ignored, line, elements;
    inp_set *set;
    if (!inp_parameter(card, of_nodes ? "NSET" : "ELSET", &name) || name.length == 0)
        return lar_fail(reader->error, LAR_ERROR_FORMAT, "%s:%d: the set has no name; add %s=name",
                        reader->path, card->line, of_nodes ? "NSET" : "ELSET");
    lar_status status =
        inp_open_set(reader, name, of_nodes ? LAR_SET_NODES : LAR_SET_ELEMENTS, &set);
    if (!status && of_nodes && inp_parameter(card, "ELSET", &elements))
        status = add_nodes_of(reader, set, elements, card->line);
    bool range = inp_parameter(card, "GENERATE", &ignored);
    while (!status && inp_data_line(reader, &line)) {
        int at = reader->line;
        status = range ? add_range(reader, set, line, at) : add_list(reader, set, line, at);
    }
    return status;
}

lar_status inp_read_nset(inp_reader *reader, const inp_card *card) {
    return read_set(reader, card, true);
}

lar_status inp_read_elset(inp_reader *reader, const inp_card *card) {
    return read_set(reader, card, false);
}

/* ---- *SURFACE ----------------------------------------------------------------------------- */

int inp_face_of(char digit) {
    static const int face[6] = {4, 5, 2, 1, 3, 0};
    return digit >= '1' && digit <= '6' ? face[digit - '1'] : -1;
}

static int face_of_label(lar_span label) {
    return label.length == 2 && (label.at[0] | 32) == 's' ? inp_face_of(label.at[1]) : -1;
}

static lar_status add_face(inp_reader *reader, int64_t id, lar_span label, int at) {
    const inp_boundary *boundary = find_boundary(reader, id);
    if (boundary && boundary->is_quad)
        return lar_mesh_builder_set_quad(reader->builder, boundary->node_ids, at, reader->error);
    if (lar_mesh_builder_has_solids(reader->builder)) return LAR_OK; /* only its regions count */
    if (boundary)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: element %lld is neither a hexahedron nor a four-node face; take it "
                        "out of the surface",
                        reader->path, at, (long long)id);
    int face = face_of_label(label);
    if (face < 0) return inp_expected(reader, at, "a face S1 to S6 of a hexahedron", label);
    return lar_mesh_builder_set_face(reader->builder, id, face, at, reader->error);
}

/* An element or element set, and the face. */
static lar_status read_faces(inp_reader *reader, lar_span line, int at) {
    lar_span first, label, rest;
    lar_span_split(line, ',', &first, &rest);
    lar_span_split(rest, ',', &label, &rest);
    first = lar_span_trim(first);
    label = lar_span_trim(label);
    int64_t id;
    if (lar_span_int64(first, &id)) {
        lar_status status = spend_entry(reader, at);
        return status ? status : add_face(reader, id, label, at);
    }
    const inp_set *set = named_set(reader, first, LAR_SET_ELEMENTS);
    if (!set) return fail_set_name(reader, at, first, false);
    lar_status status = LAR_OK;
    for (size_t i = 0; i < set->count && !status; i++) {
        status = spend_entry(reader, at);
        if (!status) status = add_face(reader, set->entry[i].id, label, at);
    }
    return status;
}

/* Opens the set of that kind which the builder has for this one. */
static lar_status open_built(inp_reader *reader, const inp_set *set, lar_set_kind kind) {
    return lar_mesh_builder_set(reader->builder, set->built ? set->built : set->name, kind,
                                reader->error);
}

static bool is_of_nodes(const inp_card *card) {
    lar_span type;
    return inp_parameter(card, "TYPE", &type) && lar_span_equal_nocase(type, "NODE");
}

static lar_status open_surface(inp_reader *reader, const inp_card *card, inp_set **set) {
    lar_span name;
    if (!inp_parameter(card, "NAME", &name) || name.length == 0)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s:%d: the surface has no name; add NAME=name", reader->path, card->line);
    return inp_open_set(reader, name, is_of_nodes(card) ? LAR_SET_NODES : LAR_SET_FACES, set);
}

lar_status inp_name_surface(inp_reader *reader, const inp_card *card) {
    inp_set *set;
    return is_of_nodes(card) ? LAR_OK : open_surface(reader, card, &set);
}

lar_status inp_read_surface(inp_reader *reader, const inp_card *card) {
    lar_span type, ignored, line;
    const bool of_nodes = is_of_nodes(card), typed = inp_parameter(card, "TYPE", &type);
    inp_set *set;
    lar_status status = open_surface(reader, card, &set);
    if (status) return status;
    if (inp_parameter(card, "COMBINE", &ignored) ||
        (typed && !of_nodes && !lar_span_equal_nocase(type, "ELEMENT")))
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: only surfaces with TYPE=ELEMENT or TYPE=NODE are read; list the "
                        "faces of surface '%s'",
                        reader->path, card->line, set->name);
    if (!of_nodes) status = open_built(reader, set, LAR_SET_FACES);
    while (!status && inp_data_line(reader, &line))
        status = of_nodes ? add_list(reader, set, line, reader->line)
                          : read_faces(reader, line, reader->line);
    return status;
}

/* ---- handing over ------------------------------------------------------------------------- */

static lar_status build_node_set(inp_reader *reader, const inp_set *set) {
    lar_mesh_builder *builder = reader->builder;
    lar_status status = open_built(reader, set, LAR_SET_NODES);
    for (size_t i = 0; i < set->count && !status; i++) {
        const inp_entry *entry = &set->entry[i];
        status = entry->corners
                     ? lar_mesh_builder_set_corners(builder, entry->id, entry->line, reader->error)
                     : lar_mesh_builder_set_id(builder, entry->id, entry->line, reader->error);
    }
    return status;
}

/* Faces in an element set become a face set and, when the name is free, a node set. */
static lar_status build_quad(inp_reader *reader, const inp_set *set, const inp_boundary *quad,
                             bool nodes_too) {
    lar_mesh_builder *builder = reader->builder;
    lar_status status = open_built(reader, set, LAR_SET_FACES);
    if (!status)
        status = lar_mesh_builder_set_quad(builder, quad->node_ids, quad->line, reader->error);
    if (!status && nodes_too) status = open_built(reader, set, LAR_SET_NODES);
    for (int a = 0; a < 4 && nodes_too && !status; a++)
        status = lar_mesh_builder_set_id(builder, quad->node_ids[a], quad->line, reader->error);
    return status;
}

static lar_status build_element_set(inp_reader *reader, const inp_set *set) {
    bool nodes_too = !named_set(reader, (lar_span){set->name, strlen(set->name)}, LAR_SET_NODES);
    lar_status status = LAR_OK;
    for (size_t i = 0; i < set->count && !status; i++) {
        const inp_boundary *boundary = find_boundary(reader, set->entry[i].id);
        if (boundary) {
            if (boundary->is_quad) status = build_quad(reader, set, boundary, nodes_too);
            continue;
        }
        status = open_built(reader, set, LAR_SET_ELEMENTS);
        if (!status)
            status = lar_mesh_builder_set_id(reader->builder, set->entry[i].id, set->entry[i].line,
                                             reader->error);
    }
    return status;
}

lar_status inp_build_sets(inp_reader *reader) {
    lar_status status = LAR_OK;
    for (size_t s = 0; s < reader->set_count && !status; s++) {
        const inp_set *set = &reader->set[s];
        if (set->kind == LAR_SET_NODES) status = build_node_set(reader, set);
        if (set->kind == LAR_SET_ELEMENTS) status = build_element_set(reader, set);
    }
    return status;
}
