/* The elements of a Gmsh file: hexahedra to compute with, other solids whose boundary is meshed;
 * faces, lines and points for sets. */
#include <stdio.h>
#include <string.h>

#include "model/format/msh_reader.h"

typedef struct cell_type {
    int number, dimension, nodes;
    const char *name;
    int corners; /* of a solid that is taken as a collapsed hexahedron, which come first */
} cell_type;

/* Gmsh reference manual, "MSH file format", element types. */
static const cell_type cell_types[] = {
    {1, 1, 2, "two-node line", 0},
    {2, 2, 3, "three-node triangle", 0},
    {3, 2, 4, "four-node quadrilateral", 0},
    {4, 3, 4, "four-node tetrahedron", 4},
    {5, 3, 8, "eight-node hexahedron", 0},
    {6, 3, 6, "six-node prism", 6},
    {7, 3, 5, "five-node pyramid", 5},
    {8, 1, 3, "three-node line", 0},
    {9, 2, 6, "six-node triangle", 0},
    {10, 2, 9, "nine-node quadrilateral", 0},
    {11, 3, 10, "ten-node tetrahedron", 4},
    {12, 3, 27, "27-node hexahedron", 0},
    {13, 3, 18, "18-node prism", 6},
    {14, 3, 14, "14-node pyramid", 5},
    {15, 0, 1, "point", 0},
    {16, 2, 8, "eight-node quadrilateral", 0},
    {17, 3, 20, "20-node hexahedron", 0},
    {18, 3, 15, "15-node prism", 6},
    {19, 3, 13, "13-node pyramid", 5},
    {20, 2, 9, "nine-node triangle", 0},
    {21, 2, 10, "ten-node triangle", 0},
    {22, 2, 12, "twelve-node triangle", 0},
    {23, 2, 15, "15-node triangle", 0},
    {24, 2, 15, "15-node triangle", 0},
    {25, 2, 21, "21-node triangle", 0},
    {26, 1, 4, "four-node line", 0},
    {27, 1, 5, "five-node line", 0},
    {28, 1, 6, "six-node line", 0},
    {29, 3, 20, "20-node tetrahedron", 4},
    {30, 3, 35, "35-node tetrahedron", 4},
    {31, 3, 56, "56-node tetrahedron", 4},
    {36, 2, 16, "16-node quadrilateral", 0},
    {37, 2, 25, "25-node quadrilateral", 0},
    {90, 3, 40, "40-node prism", 6},
    {91, 3, 75, "75-node prism", 6},
    {92, 3, 64, "64-node hexahedron", 0},
    {93, 3, 125, "125-node hexahedron", 0},
};
enum { QUADRILATERAL = 3, HEXAHEDRON = 5 };
/* Of the cells that are not refused at once. */
enum { MAX_NODES = 75 };

/* One cell with the groups it belongs to. */
typedef struct cell {
    int64_t id;
    const cell_type *type;
    int64_t node[MAX_NODES];
    const int64_t *group;
    size_t group_count;
    int line;
} cell;

/* Refuses what is unknown, and hexahedra of second and higher order. */
static lar_status find_type(msh_reader *reader, int64_t number, int64_t id,
                            const cell_type **type) {
    for (size_t i = 0; i < sizeof cell_types / sizeof *cell_types; i++) {
        if (cell_types[i].number != number) continue;
        *type = &cell_types[i];
        if ((*type)->dimension < 3 || (*type)->corners || number == HEXAHEDRON) return LAR_OK;
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: element %lld is a %s, but Lariat computes with eight-node "
                        "hexahedra; save the mesh with elements of first order",
                        msh_here(reader).text, (long long)id, (*type)->name);
    }
    return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                    "%s: element %lld has the type %lld, which is not known; Lariat computes with "
                    "eight-node hexahedra (type 5)",
                    msh_here(reader).text, (long long)id, (long long)number);
}

static lar_status open_set(msh_reader *reader, const char *name, lar_set_kind kind,
                           size_t entries) {
    if (entries > reader->entries_left)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: the physical groups repeat the same elements more often than such a "
                        "file can mean; it is damaged, save it again",
                        msh_here(reader).text);
    reader->entries_left -= entries;
    return lar_mesh_builder_set(reader->builder, name, kind, reader->error);
}

static lar_status add_nodes_to_set(msh_reader *reader, const cell *c, const char *name) {
    lar_status status = open_set(reader, name, LAR_SET_NODES, (size_t)c->type->nodes);
    for (int a = 0; a < c->type->nodes && !status; a++)
        status = lar_mesh_builder_set_id(reader->builder, c->node[a], c->line, reader->error);
    return status;
}

static lar_status add_face_to_set(msh_reader *reader, const cell *c, const char *name) {
    if (c->type->number != QUADRILATERAL) {
        if (!reader->has_odd_face) {
            reader->has_odd_face = true;
            reader->odd_face_id = c->id;
            reader->odd_face_line = c->line;
            reader->odd_face_type = c->type->name;
            reader->odd_face_group = name;
        }
        return LAR_OK;
    }
    lar_status status = open_set(reader, name, LAR_SET_FACES, 1);
    if (status) return status;
    return lar_mesh_builder_set_quad(reader->builder, c->node, c->line, reader->error);
}

static lar_status add_solid(msh_reader *reader, const cell *c) {
    const int corners = c->type->corners ? c->type->corners : 8;
    int64_t node[8] = {0};
    memcpy(node, c->node, (size_t)corners * sizeof *node);
    bool again = reader->has_last && reader->version < 4 &&
                 memcmp(reader->last_nodes, node, sizeof node) == 0;
    if (again) return LAR_OK;
    reader->has_last = true;
    reader->last_id = c->id;
    memcpy(reader->last_nodes, node, sizeof node);
    int64_t tag = c->group_count > 0 ? c->group[0] : 0;
    if (tag < INT32_MIN || tag > INT32_MAX)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: element %lld has the physical group %lld, which is too large; the "
                        "file is damaged",
                        msh_here(reader).text, (long long)c->id, (long long)tag);
    if (corners < 8)
        return lar_mesh_builder_solid(reader->builder, c->id, (int32_t)tag, c->type->name, corners,
                                      c->node, c->line, reader->error);
    return lar_mesh_builder_hexahedron(reader->builder, c->id, (int32_t)tag, c->node, c->line,
                                       reader->error);
}

static lar_status add_cell(msh_reader *reader, const cell *c) {
    bool volume = c->type->dimension == 3;
    lar_status status = volume ? add_solid(reader, c) : LAR_OK;
    for (size_t g = 0; g < c->group_count && !status; g++) {
        const char *name = msh_group_name(reader, c->type->dimension, c->group[g]);
        if (!name) continue;
        if (volume) {
            status = open_set(reader, name, LAR_SET_ELEMENTS, 1);
            if (!status)
                status = lar_mesh_builder_set_id(reader->builder, reader->last_id, c->line,
                                                 reader->error);
            continue;
        }
        status = add_nodes_to_set(reader, c, name);
        if (!status && c->type->dimension == 2) status = add_face_to_set(reader, c, name);
    }
    return status;
}

lar_status msh_check_faces(msh_reader *reader) {
    if (!reader->has_odd_face || !reader->has_last) return LAR_OK;
    if (lar_mesh_builder_has_solids(reader->builder)) return LAR_OK;
    char line[16] = "";
    if (reader->odd_face_line > 0) snprintf(line, sizeof line, ":%d", reader->odd_face_line);
    return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                    "%.370s%s: element %lld of the physical group '%s' is a %s, but the faces of "
                    "hexahedra are four-node quadrilaterals; recombine this surface or take it out "
                    "of the group",
                    reader->path, line, (long long)reader->odd_face_id, reader->odd_face_group,
                    reader->odd_face_type);
}

/* ---- version 1 and 2 -------------------------------------------------------------------- */

static lar_status read_cell_nodes(msh_reader *reader, cell *c,
                                  lar_status (*read)(msh_reader *, const char *, int64_t *)) {
    lar_status status = LAR_OK;
    for (int a = 0; a < c->type->nodes && !status; a++)
        status = read(reader, "a node of an element", &c->node[a]);
    return status;
}

/* Tags of version 2: the first is the physical group, 0 when there is none. */
static lar_status read_tags(msh_reader *reader, int64_t count, int64_t *group) {
    *group = 0;
    lar_status status = LAR_OK;
    for (int64_t i = 0; i < count && !status; i++) {
        int64_t tag;
        status = msh_int(reader, "a tag of an element", &tag);
        if (!status && i == 0) *group = msh_group_number(tag);
    }
    return status;
}

static lar_status fail_tags(msh_reader *reader, int64_t count) {
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s: an element has %lld tags; the file is damaged, save it again",
                    msh_here(reader).text, (long long)count);
}

/* id type tag-count tags... nodes..., in version 1 id type group entity node-count nodes... */
static lar_status read_text_element(msh_reader *reader) {
    int64_t type = 0, tag_count = 2, group = 0, node_count = 0;
    cell c = {.line = 0};
    lar_status status = msh_int(reader, "an element id", &c.id);
    if (!status) status = msh_int(reader, "an element type", &type);
    if (!status) status = find_type(reader, type, c.id, &c.type);
    c.line = msh_line(reader);
    if (!status && reader->version == 2) status = msh_int(reader, "a number of tags", &tag_count);
    if (!status && tag_count < 0) status = fail_tags(reader, tag_count);
    if (!status) status = read_tags(reader, tag_count, &group);
    if (!status && reader->version == 1) {
        status = msh_int(reader, "a number of nodes", &node_count);
        if (!status && node_count != c.type->nodes)
            return lar_fail(reader->error, LAR_ERROR_FORMAT,
                            "%s: element %lld is a %s with %lld nodes; the file is damaged, save "
                            "it again",
                            msh_here(reader).text, (long long)c.id, c.type->name,
                            (long long)node_count);
    }
    if (!status) status = read_cell_nodes(reader, &c, msh_int);
    if (status) return status;
    c.group = &group;
    c.group_count = group != 0;
    return add_cell(reader, &c);
}

/* A header (type, count, tag-count) and the elements it stands for: id, tags, nodes. */
static lar_status read_binary_block(msh_reader *reader, int64_t left, int64_t *seen) {
    int64_t type = 0, count = 0, tag_count = 0, group = 0, first_id = 0;
    lar_status status = msh_int(reader, "an element type", &type);
    if (!status) status = msh_int(reader, "a number of elements", &count);
    if (!status) status = msh_int(reader, "a number of tags", &tag_count);
    if (status) return status;
    if (tag_count < 0) return fail_tags(reader, tag_count);
    if (count <= 0 || count > left)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: a block of %lld elements does not fit in the %lld that $Elements "
                        "still announces; the file is damaged, save it again",
                        msh_here(reader).text, (long long)count, (long long)left);
    msh_reader peek = *reader;
    status = msh_int(&peek, "an element id", &first_id);
    cell c = {.line = 0};
    if (!status) status = find_type(reader, type, first_id, &c.type);
    if (!status)
        status =
            msh_claim(reader, count, "elements", 0, (size_t)(1 + tag_count + c.type->nodes) * 4);
    for (int64_t i = 0; i < count && !status; i++) {
        status = msh_int(reader, "an element id", &c.id);
        if (!status) status = read_tags(reader, tag_count, &group);
        if (!status) status = read_cell_nodes(reader, &c, msh_int);
        if (status) break;
        c.group = &group;
        c.group_count = group != 0;
        status = add_cell(reader, &c);
    }
    *seen = count;
    return status;
}

static lar_status read_elements_2(msh_reader *reader) {
    int64_t count;
    if (!lar_text_int64(&reader->text, &count))
        return msh_expected(reader, "the number of elements");
    lar_span rest;
    if (reader->binary) lar_text_line(&reader->text, &rest);
    lar_status status = msh_claim(reader, count, "elements", 7, 8);
    for (int64_t i = 0; i < count && !status;) {
        int64_t seen = 1;
        status = reader->binary ? read_binary_block(reader, count - i, &seen)
                                : read_text_element(reader);
        i += seen;
    }
    return status;
}

/* ---- version 4.1 ------------------------------------------------------------------------ */

static lar_status read_block_4(msh_reader *reader, int64_t *count) {
    int64_t dimension, entity = 0, type = 0, first_id = 0;
    lar_status status = msh_int(reader, "the dimension of an element block", &dimension);
    if (!status) status = msh_int(reader, "the entity of an element block", &entity);
    if (!status) status = msh_int(reader, "an element type", &type);
    if (!status) status = msh_size(reader, "the number of elements of a block", count);
    if (status || *count == 0) return status;
    msh_reader peek = *reader;
    status = msh_size(&peek, "an element id", &first_id);
    cell c = {.line = 0};
    if (!status) status = find_type(reader, type, first_id, &c.type);
    if (status) return status;

    const msh_entity *owner = msh_find_entity(reader, c.type->dimension, entity);
    if (owner && owner->count > 0) {
        c.group = reader->physical + owner->first;
        c.group_count = owner->count;
    }
    size_t numbers = (size_t)c.type->nodes + 1;
    status = msh_claim(reader, *count, "elements", 2 * numbers - 1, 8 * numbers);
    for (int64_t i = 0; i < *count && !status; i++) {
        status = msh_size(reader, "an element id", &c.id);
        c.line = msh_line(reader);
        if (!status) status = read_cell_nodes(reader, &c, msh_size);
        if (!status) status = add_cell(reader, &c);
    }
    return status;
}

static lar_status read_elements_4(msh_reader *reader) {
    int64_t blocks = 0, total = 0, seen = 0, ignored;
    lar_status status = msh_size(reader, "the number of element blocks", &blocks);
    if (!status) status = msh_size(reader, "the number of elements", &total);
    if (!status) status = msh_size(reader, "the smallest element id", &ignored);
    if (!status) status = msh_size(reader, "the largest element id", &ignored);
    if (!status) status = msh_claim(reader, blocks, "element blocks", 7, 20);
    if (!status) status = msh_claim(reader, total, "elements", 3, 16);
    for (int64_t b = 0; b < blocks && !status; b++) {
        int64_t count = 0;
        status = read_block_4(reader, &count);
        if (!status) seen += count;
    }
    if (!status && seen != total)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: $Elements announces %lld elements, but its blocks hold %lld; the file "
                        "is damaged, save it again",
                        msh_here(reader).text, (long long)total, (long long)seen);
    return status;
}

lar_status msh_read_elements(msh_reader *reader) {
    return reader->version == 4 ? read_elements_4(reader) : read_elements_2(reader);
}
