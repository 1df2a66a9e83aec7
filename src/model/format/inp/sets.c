/* Sets and surfaces of an Abaqus file. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "model/format/inp/reader.h"

static inp_set *find_set(const inp_reader *reader, lar_span name, bool of_nodes) {
    for (size_t s = 0; s < reader->set_count; s++)
        if (reader->set[s].of_nodes == of_nodes && lar_span_equal_nocase(name, reader->set[s].name))
            return &reader->set[s];
    return NULL;
}

lar_status inp_open_set(inp_reader *reader, lar_span name, bool of_nodes, inp_set **set) {
    *set = find_set(reader, name, of_nodes);
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
    **set = (inp_set){.name = copy, .of_nodes = of_nodes};
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

lar_status inp_add_entry(inp_reader *reader, inp_set *set, int64_t id, int line) {
    lar_status status = spend_entry(reader, line);
    if (status) return status;
    if (!LAR_GROW(set->entry, set->capacity, set->count))
        return lar_fail_memory(reader->error, set->count * sizeof *set->entry, "a set");
    set->entry[set->count++] = (inp_entry){id, line};
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
    const inp_ids *ids = set->of_nodes ? &reader->nodes : &reader->elements;
    size_t low = 0, high = ids->count, before = set->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (ids->id[middle] < bound[0])
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < ids->count && ids->id[low] <= bound[1]; low++) {
        uint64_t offset = (uint64_t)ids->id[low] - (uint64_t)bound[0];
        lar_status status = offset % (uint64_t)bound[2] == 0
                                ? inp_add_entry(reader, set, ids->id[low], at)
                                : spend_entry(reader, at);
        if (status) return status;
    }
    uint64_t span = (uint64_t)bound[1] - (uint64_t)bound[0];
    return check_range(reader, set->of_nodes, set->count - before, span / (uint64_t)bound[2] + 1,
                       at);
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
            status = inp_add_entry(reader, set, id, at);
        } else {
            const inp_set *other = find_set(reader, field, set->of_nodes);
            if (!other) return fail_set_name(reader, at, field, set->of_nodes);
            /* A set may name itself: it gets the entries it has now once more. */
            for (size_t i = 0, count = other->count; i < count && !status; i++)
                status = inp_add_entry(reader, set, other->entry[i].id, at);
        }
        if (status) return status;
    }
    return LAR_OK;
}

static lar_status read_set(inp_reader *reader, const inp_card *card, bool of_nodes) {
    lar_span name, ignored, line;
    inp_set *set;
    if (!inp_parameter(card, of_nodes ? "NSET" : "ELSET", &name) || name.length == 0)
        return lar_fail(reader->error, LAR_ERROR_FORMAT, "%s:%d: the set has no name; add %s=name",
                        reader->path, card->line, of_nodes ? "NSET" : "ELSET");
    if (of_nodes && inp_parameter(card, "ELSET", &ignored))
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: *NSET with ELSET= is not read; list the nodes", reader->path,
                        card->line);
    lar_status status = inp_open_set(reader, name, of_nodes, &set);
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
    const inp_set *set = find_set(reader, first, false);
    if (!set) return fail_set_name(reader, at, first, false);
    lar_status status = LAR_OK;
    for (size_t i = 0; i < set->count && !status; i++) {
        status = spend_entry(reader, at);
        if (!status) status = add_face(reader, set->entry[i].id, label, at);
    }
    return status;
}

/* A name for the builder, which wants it terminated. */
static lar_status open_built_set(inp_reader *reader, lar_span name, lar_set_kind kind) {
    char *copy = lar_strndup(name.at, name.length);
    if (!copy) return lar_fail_memory(reader->error, name.length, "a name");
    lar_status status = lar_mesh_builder_set(reader->builder, copy, kind, reader->error);
    free(copy);
    return status;
}

lar_status inp_read_surface(inp_reader *reader, const inp_card *card) {
    lar_span name, type = {"ELEMENT", 7}, ignored, line;
    bool typed = inp_parameter(card, "TYPE", &type);
    bool of_nodes = typed && lar_span_equal_nocase(type, "NODE");
    if (!inp_parameter(card, "NAME", &name) || name.length == 0)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s:%d: the surface has no name; add NAME=name", reader->path, card->line);
    if (inp_parameter(card, "COMBINE", &ignored) ||
        (typed && !of_nodes && !lar_span_equal_nocase(type, "ELEMENT")))
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: only surfaces with TYPE=ELEMENT or TYPE=NODE are read; list the "
                        "faces of surface '%.*s'",
                        reader->path, card->line, (int)name.length, name.at);
    lar_status status = LAR_OK;
    if (of_nodes) {
        inp_set *set;
        status = inp_open_set(reader, name, true, &set);
        while (!status && inp_data_line(reader, &line))
            status = add_list(reader, set, line, reader->line);
        return status;
    }
    status = open_built_set(reader, name, LAR_SET_FACES);
    while (!status && inp_data_line(reader, &line)) status = read_faces(reader, line, reader->line);
    return status;
}

/* ---- handing over ------------------------------------------------------------------------- */

static lar_status build_node_set(inp_reader *reader, const inp_set *set) {
    lar_status status =
        lar_mesh_builder_set(reader->builder, set->name, LAR_SET_NODES, reader->error);
    for (size_t i = 0; i < set->count && !status; i++)
        status = lar_mesh_builder_set_id(reader->builder, set->entry[i].id, set->entry[i].line,
                                         reader->error);
    return status;
}

/* Faces in an element set become a face set and, when the name is free, a node set. */
static lar_status build_quad(inp_reader *reader, const inp_set *set, const inp_boundary *quad,
                             bool nodes_too) {
    lar_mesh_builder *builder = reader->builder;
    lar_status status = lar_mesh_builder_set(builder, set->name, LAR_SET_FACES, reader->error);
    if (!status)
        status = lar_mesh_builder_set_quad(builder, quad->node_ids, quad->line, reader->error);
    if (!status && nodes_too)
        status = lar_mesh_builder_set(builder, set->name, LAR_SET_NODES, reader->error);
    for (int a = 0; a < 4 && nodes_too && !status; a++)
        status = lar_mesh_builder_set_id(builder, quad->node_ids[a], quad->line, reader->error);
    return status;
}

static lar_status build_element_set(inp_reader *reader, const inp_set *set) {
    lar_span name = {set->name, strlen(set->name)};
    bool nodes_too = !find_set(reader, name, true);
    lar_status status = LAR_OK;
    for (size_t i = 0; i < set->count && !status; i++) {
        const inp_boundary *boundary = find_boundary(reader, set->entry[i].id);
        if (boundary) {
            if (boundary->is_quad) status = build_quad(reader, set, boundary, nodes_too);
            continue;
        }
        status = lar_mesh_builder_set(reader->builder, set->name, LAR_SET_ELEMENTS, reader->error);
        if (!status)
            status = lar_mesh_builder_set_id(reader->builder, set->entry[i].id, set->entry[i].line,
                                             reader->error);
    }
    return status;
}

lar_status inp_build_sets(inp_reader *reader) {
    lar_status status = LAR_OK;
    for (size_t s = 0; s < reader->set_count && !status; s++)
        status = reader->set[s].of_nodes ? build_node_set(reader, &reader->set[s])
                                         : build_element_set(reader, &reader->set[s]);
    return status;
}
