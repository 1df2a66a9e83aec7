/* Cards, nodes and elements. Format: Abaqus keyword files as CalculiX (ccx manual, "Input deck
 * format") reads them too. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "model/format/inp/reader.h"
#include "model/format/mesh_io.h"

/* ---- lines and cards ---------------------------------------------------------------------- */

static bool is_comment(lar_span line) {
    return line.length == 0 || (line.length >= 2 && line.at[0] == '*' && line.at[1] == '*');
}

lar_text inp_begin(inp_reader *reader, const lar_bytes *bytes) {
    lar_text text = lar_text_from(bytes);
    reader->in_part = false;
    if (bytes->size >= 3 && memcmp(text.at, "\xef\xbb\xbf", 3) == 0) text.at += 3;
    return text;
}

bool inp_data_line(inp_reader *reader, lar_span *line) {
    lar_text ahead = reader->text;
    for (int number = ahead.line; lar_text_line(&ahead, line); number = ahead.line) {
        *line = lar_span_trim(*line);
        if (!is_comment(*line)) {
            if (line->at[0] == '*') return false;
            reader->text = ahead;
            reader->line = number;
            return true;
        }
        reader->text = ahead;
    }
    return false;
}

lar_status inp_expected(inp_reader *reader, int line, const char *what, lar_span found) {
    char text[33] = "";
    for (size_t i = 0; i < found.length && i < sizeof text - 1; i++)
        text[i] = found.at[i] >= ' ' && found.at[i] < 127 ? found.at[i] : '?';
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s:%d: expected %s, found '%s'; correct the line", reader->path, line, what,
                    text);
}

/* A part and an instance end with an *END of their own; nothing of them is behind any other one. */
static void enter_scope(inp_reader *reader, const inp_card *card) {
    lar_span word = card->keyword, ignored;
    if (lar_span_equal_nocase(word, "PART") || lar_span_equal_nocase(word, "INSTANCE"))
        reader->in_part = true;
    else if (lar_span_equal_nocase(word, "ASSEMBLY") ||
             (word.length > 3 && strncasecmp(word.at, "END", 3) == 0))
        reader->in_part = false;
    reader->of_part = reader->in_part || inp_parameter(card, "INSTANCE", &ignored);
}

bool inp_next_card(inp_reader *reader, inp_card *card, lar_status *status) {
    lar_span line;
    do {
        card->line = reader->text.line;
        if (!lar_text_line(&reader->text, &line)) return false;
        line = lar_span_trim(line);
    } while (is_comment(line));
    if (line.at[0] != '*') {
        *status = inp_expected(reader, card->line, "a keyword line (such as *NODE)", line);
        return false;
    }
    size_t length = 0;
    for (bool more = true; more;) {
        if (line.length >= sizeof card->text - length) {
            *status = lar_fail(reader->error, LAR_ERROR_FORMAT,
                               "%s:%d: the keyword line is longer than %zu characters; shorten it",
                               reader->path, card->line, sizeof card->text - 1);
            return false;
        }
        memcpy(card->text + length, line.at, line.length);
        length += line.length;
        more = card->text[length - 1] == ',' && inp_data_line(reader, &line);
    }
    card->text[length] = '\0';
    lar_span_split((lar_span){card->text + 1, length - 1}, ',', &card->keyword, &card->parameters);
    card->keyword = lar_span_trim(card->keyword);
    enter_scope(reader, card);
    return true;
}

bool inp_parameter(const inp_card *card, const char *name, lar_span *value) {
    lar_span rest = card->parameters, one, key;
    while (rest.length > 0) {
        lar_span_split(rest, ',', &one, &rest);
        lar_span_split(one, '=', &key, value);
        if (!lar_span_equal_nocase(lar_span_trim(key), name)) continue;
        *value = lar_span_trim(*value);
        if (value->length >= 2 && value->at[0] == '"' && value->at[value->length - 1] == '"')
            *value = (lar_span){value->at + 1, value->length - 2};
        return true;
    }
    return false;
}

/* As much of a word as a message can take. */
static int shown(lar_span word) {
    return word.length < 40 ? (int)word.length : 40;
}

lar_status inp_check_parameters(const inp_reader *reader, const inp_card *card, const char *known) {
    lar_span rest = card->parameters, one, key, value;
    while (rest.length > 0) {
        lar_span_split(rest, ',', &one, &rest);
        lar_span_split(one, '=', &key, &value);
        key = lar_span_trim(key);
        bool found = key.length == 0;
        for (lar_span word, left = {known, strlen(known)}; left.length > 0 && !found;) {
            lar_span_split(left, ',', &word, &left);
            found = word.length == key.length && strncasecmp(word.at, key.at, key.length) == 0;
        }
        if (!found)
            return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                            "%s:%d: the parameter %.*s of *%.*s is not read and could change the "
                            "answer; remove it",
                            reader->path, card->line, shown(key), key.at, shown(card->keyword),
                            card->keyword.at);
    }
    return LAR_OK;
}

static lar_status refuse(inp_reader *reader, const inp_card *card, const char *remedy) {
    return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED, "%s:%d: *%.*s is not read %s",
                    reader->path, card->line, shown(card->keyword), card->keyword.at, remedy);
}

/* ---- nodes -------------------------------------------------------------------------------- */

static lar_status remember_id(inp_reader *reader, inp_ids *ids, int64_t id) {
    if (!LAR_GROW(ids->id, ids->capacity, ids->count))
        return lar_fail_memory(reader->error, ids->count * sizeof id, "ids");
    ids->id[ids->count++] = id;
    return LAR_OK;
}

/* id, x, y, z; a coordinate that is left out is zero. */
static lar_status read_node(inp_reader *reader, lar_span line, int number, inp_set *set) {
    int64_t id;
    double position[3] = {0};
    lar_span field, rest;
    lar_span_split(line, ',', &field, &rest);
    if (!lar_span_int64(lar_span_trim(field), &id))
        return inp_expected(reader, number, "a node id", lar_span_trim(field));
    for (int i = 0; i < 3; i++) {
        lar_span_split(rest, ',', &field, &rest);
        field = lar_span_trim(field);
        if (field.length > 0 && !lar_span_double(field, &position[i]))
            return inp_expected(reader, number, "a coordinate", field);
    }
    if (!reader->in_part && reader->part_count > 0) return remember_id(reader, &reader->apart, id);
    lar_status status = lar_mesh_builder_node(reader->builder, id, position, number, reader->error);
    if (!status) status = remember_id(reader, &reader->nodes, id);
    if (!status && set) status = inp_add_entry(reader, set, (inp_entry){id, number, false});
    return status;
}

static lar_status read_nodes(inp_reader *reader, const inp_card *card) {
    lar_span value, line;
    inp_set *set = NULL;
    if (inp_parameter(card, "INPUT", &value))
        return refuse(reader, card, "with INPUT=; copy the nodes into this file");
    if (inp_parameter(card, "SYSTEM", &value) && !lar_span_equal_nocase(value, "R"))
        return refuse(reader, card, "with SYSTEM=; write the nodes in rectangular coordinates");
    if (inp_parameter(card, "NSET", &value)) {
        lar_status status = inp_open_set(reader, value, LAR_SET_NODES, &set);
        if (status) return status;
    }
    lar_status status = LAR_OK;
    while (!status && inp_data_line(reader, &line))
        status = read_node(reader, line, reader->line, set);
    return status;
}

/* ---- elements ----------------------------------------------------------------------------- */

typedef struct element_type {
    const char *name; /* letters may follow: C3D8R, C3D8RH, S4R */
    int nodes;
    int corners; /* of a solid, 8 of hexahedra; 0: none */
    const char *what;
} element_type;
enum { NODES_MAX = 15 };

/* Solids, then faces and lines that mesh programs write beside the volume. */
static const element_type element_types[] = {
    {"C3D8", 8, 8, "hexahedron"},
    {"C3D4", 4, 4, "four-node tetrahedron"},
    {"C3D10", 10, 4, "ten-node tetrahedron"},
    {"C3D6", 6, 6, "six-node prism"},
    {"C3D15", 15, 6, "15-node prism"},
    {"C3D5", 5, 5, "five-node pyramid"},
    {"S4", 4, 0, NULL},
    {"CPS4", 4, 0, NULL},
    {"CPE4", 4, 0, NULL},
    {"M3D4", 4, 0, NULL},
    {"SFM3D4", 4, 0, NULL},
    {"S3", 3, 0, NULL},
    {"CPS3", 3, 0, NULL},
    {"CPE3", 3, 0, NULL},
    {"M3D3", 3, 0, NULL},
    {"SFM3D3", 3, 0, NULL},
    {"STRI3", 3, 0, NULL},
    {"T3D2", 2, 0, NULL},
    {"CPS6", 6, 0, NULL},
    {"CPS8", 8, 0, NULL},
    {"T3D3", 3, 0, NULL},
};

static const element_type *find_type(lar_span name) {
    for (size_t i = 0; i < sizeof element_types / sizeof *element_types; i++) {
        size_t length = strlen(element_types[i].name);
        if (name.length < length || strncasecmp(name.at, element_types[i].name, length) != 0)
            continue;
        bool letters = true;
        for (size_t c = length; c < name.length; c++)
            letters &= (name.at[c] | 32) >= 'a' && (name.at[c] | 32) <= 'z';
        if (letters) return &element_types[i];
    }
    return NULL;
}

static lar_status refuse_type(inp_reader *reader, const inp_card *card, lar_span type) {
    return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: elements of type '%.*s' are not read: Lariat computes with eight-node "
                    "hexahedra (C3D8, C3D8R, C3D8I, C3D8H, C3D8RH); mesh the volume with these",
                    reader->path, card->line, shown(type), type.at);
}

/* An id and `nodes` node ids; a comma at the end of a line continues it. */
static lar_status read_connectivity(inp_reader *reader, lar_span line, int64_t *number, int nodes) {
    int count = 0, at = reader->line;
    for (bool more = true; more;) {
        lar_span field, rest = line;
        more = false;
        while (rest.length > 0) {
            more = lar_span_split(rest, ',', &field, &rest);
            field = lar_span_trim(field);
            if (field.length == 0) continue;
            if (count > nodes)
                return lar_fail(reader->error, LAR_ERROR_FORMAT,
                                "%s:%d: element %lld has more than the %d nodes of its type; "
                                "correct the line or the type",
                                reader->path, at, (long long)number[0], nodes);
            if (!lar_span_int64(field, &number[count]))
                return inp_expected(reader, at, count ? "a node id" : "an element id", field);
            count++;
        }
        more = more && count <= nodes && inp_data_line(reader, &line);
    }
    if (count == nodes + 1) return LAR_OK;
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s:%d: element %lld has %d nodes where its type needs %d; add the missing "
                    "nodes (a line that goes on ends with a comma)",
                    reader->path, at, count ? (long long)number[0] : 0LL, count ? count - 1 : 0,
                    nodes);
}

static lar_status add_boundary(inp_reader *reader, const int64_t *number, const element_type *type,
                               int line) {
    if (!LAR_GROW(reader->boundary, reader->boundary_capacity, reader->boundary_count))
        return lar_fail_memory(reader->error, sizeof *reader->boundary, "surface elements");
    inp_boundary *boundary = &reader->boundary[reader->boundary_count++];
    *boundary = (inp_boundary){
        .id = number[0], .is_quad = type->nodes == 4, .type = type->name, .line = line};
    if (boundary->is_quad) memcpy(boundary->node_ids, number + 1, sizeof boundary->node_ids);
    return LAR_OK;
}

static lar_status add_solid(inp_reader *reader, const element_type *type, int32_t tag,
                            const int64_t *number, int line) {
    if (type->corners < 8)
        return lar_mesh_builder_solid(reader->builder, number[0], tag, type->what, type->corners,
                                      number + 1, line, reader->error);
    return lar_mesh_builder_hexahedron(reader->builder, number[0], tag, number + 1, line,
                                       reader->error);
}

static lar_status read_elements(inp_reader *reader, const inp_card *card) {
    lar_span type_name, value, line;
    if (inp_parameter(card, "INPUT", &value))
        return refuse(reader, card, "with INPUT=; copy the elements into this file");
    if (!inp_parameter(card, "TYPE", &type_name))
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s:%d: *ELEMENT has no TYPE; add TYPE=C3D8", reader->path, card->line);
    const element_type *type = find_type(type_name);
    if (!type) return refuse_type(reader, card, type_name);
    bool solid = type->corners > 0;

    inp_set *set = NULL;
    if (inp_parameter(card, "ELSET", &value)) {
        lar_status status = inp_open_set(reader, value, LAR_SET_ELEMENTS, &set);
        if (status) return status;
        if (solid && set->tag == 0) set->tag = ++reader->tag_count;
    }
    lar_status status = LAR_OK;
    while (!status && inp_data_line(reader, &line)) {
        int64_t number[1 + NODES_MAX];
        int at = reader->line;
        status = read_connectivity(reader, line, number, type->nodes);
        if (!status) status = remember_id(reader, &reader->elements, number[0]);
        if (!status && solid) status = add_solid(reader, type, set ? set->tag : 0, number, at);
        if (!status && !solid) status = add_boundary(reader, number, type, at);
        if (!status && set) status = inp_add_entry(reader, set, (inp_entry){number[0], at, false});
    }
    return status;
}

/* ---- the file ----------------------------------------------------------------------------- */

static lar_status refuse_include(inp_reader *reader, const inp_card *card) {
    return refuse(reader, card, "here; copy the included file into this one");
}

static lar_status refuse_generation(inp_reader *reader, const inp_card *card) {
    return refuse(
        reader, card,
        "here; write out all nodes and elements (most programs export a flat input file)");
}

static lar_status keep_instance(inp_reader *reader, const inp_card *card) {
    lar_span name;
    if (!inp_parameter(card, "NAME", &name)) return LAR_OK;
    free(reader->instance);
    reader->instance = lar_strndup(name.at, name.length);
    return reader->instance ? LAR_OK : lar_fail_memory(reader->error, name.length, "a name");
}

static lar_status read_part(inp_reader *reader, const inp_card *card) {
    if (++reader->part_count > 1)
        return refuse(reader, card, "a second time; join the parts and write one flat input file");
    return keep_instance(reader, card);
}

/* Where it is put: nowhere else. Behind that a line that turns it could stand. */
static lar_status read_instance(inp_reader *reader, const inp_card *card) {
    lar_span line, field, rest = {"", 0};
    if (++reader->instance_count > 1)
        return refuse(reader, card,
                      "a second time; join the instances and write one flat input file");
    bool moved = false;
    double by = 0;
    if (inp_data_line(reader, &line)) rest = line;
    while (rest.length > 0) {
        lar_span_split(rest, ',', &field, &rest);
        field = lar_span_trim(field);
        moved |= field.length > 0 && !(lar_span_double(field, &by) && by == 0);
    }
    if (moved || inp_data_line(reader, &line))
        return refuse(reader, card,
                      "with a displacement; move the nodes and write one flat input file");
    return keep_instance(reader, card);
}

typedef struct keyword_row {
    const char *keyword;
    int walk; /* in which walk through the file it is read */
    lar_status (*read)(inp_reader *reader, const inp_card *card);
} keyword_row;

enum { WALK_MESH, WALK_SETS, WALK_SURFACES, WALK_COUNT };

static const keyword_row keywords[] = {
    {"NODE", WALK_MESH, read_nodes},
    {"ELEMENT", WALK_MESH, read_elements},
    {"NSET", WALK_SETS, inp_read_nset},
    {"ELSET", WALK_SETS, inp_read_elset},
    {"SURFACE", WALK_SETS, inp_name_surface}, /* so that all names are known before any is built */
    {"SURFACE", WALK_SURFACES, inp_read_surface},
    {"INCLUDE", WALK_MESH, refuse_include},
    {"PART", WALK_MESH, read_part},
    {"INSTANCE", WALK_MESH, read_instance},
    {"SYSTEM", WALK_MESH, refuse_generation},
    {"NGEN", WALK_MESH, refuse_generation},
    {"NFILL", WALK_MESH, refuse_generation},
    {"NCOPY", WALK_MESH, refuse_generation},
    {"NMAP", WALK_MESH, refuse_generation},
    {"ELGEN", WALK_MESH, refuse_generation},
    {"ELCOPY", WALK_MESH, refuse_generation},
};

/* Of the cards above; what is not read of them is refused there. */
static const char parameters[] =
    "NAME,NSET,ELSET,TYPE,GENERATE,UNSORTED,INTERNAL,INSTANCE,PART,SYSTEM";

static lar_status walk_file(inp_reader *reader, const lar_bytes *bytes, int walk) {
    inp_card card;
    lar_span line;
    lar_status status = LAR_OK;
    reader->text = inp_begin(reader, bytes);
    while (!status && inp_next_card(reader, &card, &status)) {
        for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
            if (keywords[i].walk == walk &&
                lar_span_equal_nocase(card.keyword, keywords[i].keyword)) {
                status = keywords[i].read(reader, &card);
                if (!status) status = inp_check_parameters(reader, &card, parameters);
                break;
            }
        while (!status && inp_data_line(reader, &line)) continue;
    }
    return status;
}

static int compare_ids(const void *a, const void *b) {
    int64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static int compare_boundaries(const void *a, const void *b) {
    const inp_boundary *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

static void sort_ids(inp_ids *ids) {
    if (ids->count > 0) qsort(ids->id, ids->count, sizeof *ids->id, compare_ids);
}

/* Sorts what the first walk found. The builder finds repeats among the hexahedra, here are those
 * that concern a surface element. */
static lar_status sort_mesh(inp_reader *reader) {
    sort_ids(&reader->nodes);
    sort_ids(&reader->apart);
    sort_ids(&reader->elements);
    if (reader->boundary_count == 0) return LAR_OK;
    qsort(reader->boundary, reader->boundary_count, sizeof *reader->boundary, compare_boundaries);
    size_t at = 0;
    for (size_t i = 0; i < reader->boundary_count; i++) {
        const inp_boundary *boundary = &reader->boundary[i];
        while (reader->elements.id[at] < boundary->id) at++;
        if (at + 1 < reader->elements.count && reader->elements.id[at + 1] == boundary->id)
            return lar_fail(reader->error, LAR_ERROR_FORMAT,
                            "%s:%d: element %lld is given twice; give every element an id of its "
                            "own",
                            reader->path, boundary->line, (long long)boundary->id);
    }
    return LAR_OK;
}

lar_status inp_read_mesh(inp_reader *reader, const lar_bytes *bytes, lar_mesh *mesh) {
    enum { SPARE_ENTRIES = 1000000 };
    if (!memchr(bytes->data, '\n', bytes->size) && memchr(bytes->data, '\r', bytes->size))
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: its lines end with CR alone, as on old Macs; turn them into LF",
                        reader->path);
    reader->entries_left = bytes->size + SPARE_ENTRIES;
    reader->builder = lar_mesh_builder_create(reader->path);
    lar_status status =
        reader->builder ? LAR_OK : lar_fail_memory(reader->error, sizeof *reader, "the reader");
    for (int walk = 0; walk < WALK_COUNT && !status; walk++) {
        status = walk_file(reader, bytes, walk);
        if (!status) status = walk == WALK_MESH ? sort_mesh(reader) : inp_name_sets(reader);
    }
    if (!status) status = inp_build_sets(reader);
    if (!status) status = lar_mesh_builder_finish(reader->builder, mesh, reader->error);
    mesh->sparse_ranges = reader->sparse_ranges;
    mesh->sparse_line = reader->sparse_line;
    lar_mesh_builder_destroy(reader->builder);
    reader->builder = NULL;
    return status;
}

void inp_clear(inp_reader *reader) {
    for (size_t s = 0; s < reader->set_count; s++) {
        free(reader->set[s].name);
        free(reader->set[s].built);
        free(reader->set[s].entry);
    }
    free(reader->set);
    free(reader->boundary);
    free(reader->instance);
    free(reader->nodes.id);
    free(reader->apart.id);
    free(reader->elements.id);
}

lar_status lar_inp_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error) {
    inp_reader reader = {.path = path, .error = error};
    lar_status status = inp_read_mesh(&reader, bytes, mesh);
    inp_clear(&reader);
    return status;
}
