#include "model/mesh/builder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/mesh/id_map.h"
#include "model/mesh/faces.h"

typedef struct built_node {
    int64_t id;
    double position[3];
    int line;
} built_node;

typedef struct built_element {
    int64_t id;
    int64_t node_ids[8];
    int32_t tag;
    int line;
} built_element;

/* One entry of a set; `face` is used in face sets, and in sets of nodes for all of an element. */
typedef struct built_entry {
    int64_t id;
    int line;
    int face;
} built_entry;
enum { CORNERS = -1 };

typedef struct built_quad {
    int64_t node_ids[4];
    int line;
} built_quad;

typedef struct built_set {
    char *name;
    lar_set_kind kind;
    size_t entry_count, entry_capacity;
    built_entry *entry;
    size_t quad_count, quad_capacity;
    built_quad *quad;
    size_t corners; /* nodes of the elements in a set of nodes */
} built_set;

struct lar_mesh_builder {
    char *source;
    size_t node_count, node_capacity;
    built_node *node;
    size_t element_count, element_capacity;
    built_element *element;
    size_t set_count, set_capacity;
    built_set *set;
    built_set *open;
    int32_t collapsed_count; /* as in lar_mesh */
    const char *collapsed_name;
    int64_t collapsed_id;
    int collapsed_line;
    /* Hash table of the sets by name and kind: set number + 1, 0 where free. Readers ask for a set
     * once per element. */
    uint16_t *set_slot;
};
enum { SET_SLOTS = 4 * LAR_MESH_SETS_MAX };
_Static_assert((SET_SLOTS & (SET_SLOTS - 1)) == 0 && LAR_MESH_SETS_MAX < UINT16_MAX,
               "the hash of a set is cut by a mask, its number fits a slot");

/* Where an entry stands: "file" or "file:line". */
typedef struct place {
    char text[400];
} place;

static place place_of(const lar_mesh_builder *builder, int line) {
    place where;
    if (line > 0)
        snprintf(where.text, sizeof where.text, "%.380s:%d", builder->source, line);
    else
        snprintf(where.text, sizeof where.text, "%.380s", builder->source);
    return where;
}

lar_mesh_builder *lar_mesh_builder_create(const char *source) {
    lar_mesh_builder *builder = lar_calloc(1, sizeof *builder);
    if (!builder) return NULL;
    builder->source = lar_strdup(source ? source : "mesh");
    if (builder->source) return builder;
    free(builder);
    return NULL;
}

void lar_mesh_builder_destroy(lar_mesh_builder *builder) {
    if (!builder) return;
    for (size_t s = 0; s < builder->set_count; s++) {
        free(builder->set[s].name);
        free(builder->set[s].entry);
        free(builder->set[s].quad);
    }
    free(builder->set);
    free(builder->set_slot);
    free(builder->node);
    free(builder->element);
    free(builder->source);
    free(builder);
}

lar_status lar_mesh_builder_node(lar_mesh_builder *builder, int64_t id, const double position[3],
                                 int line, lar_error *error) {
    for (int i = 0; i < 3; i++)
        if (!isfinite(position[i]))
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: node %lld has the %c coordinate %g, which is no usable number; "
                            "correct it in the file",
                            place_of(builder, line).text, (long long)id, "xyz"[i], position[i]);
    if (builder->node_count >= INT32_MAX)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%s: more than %d nodes; use a coarser mesh",
                        place_of(builder, line).text, INT32_MAX);
    if (!LAR_GROW(builder->node, builder->node_capacity, builder->node_count))
        return lar_fail_memory(error, builder->node_count * sizeof *builder->node, "nodes");
    built_node *node = &builder->node[builder->node_count++];
    *node = (built_node){.id = id, .line = line};
    memcpy(node->position, position, sizeof node->position);
    return LAR_OK;
}

lar_status lar_mesh_builder_hexahedron(lar_mesh_builder *builder, int64_t id, int32_t tag,
                                       const int64_t node_ids[8], int line, lar_error *error) {
    /* element * 6 + face must fit an int32_t. */
    if (builder->element_count >= INT32_MAX / 6)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: more than %d elements; use a coarser mesh",
                        place_of(builder, line).text, INT32_MAX / 6);
    if (!LAR_GROW(builder->element, builder->element_capacity, builder->element_count))
        return lar_fail_memory(error, builder->element_count * sizeof *builder->element,
                               "elements");
    built_element *element = &builder->element[builder->element_count++];
    *element = (built_element){.id = id, .tag = tag, .line = line};
    memcpy(element->node_ids, node_ids, sizeof element->node_ids);
    return LAR_OK;
}

lar_status lar_mesh_builder_solid(lar_mesh_builder *builder, int64_t id, int32_t tag,
                                  const char *name, int corners, const int64_t *node_ids, int line,
                                  lar_error *error) {
    const uint8_t *corner = lar_solid_corners(corners);
    int64_t node[8];
    for (int a = 0; a < 8; a++) node[a] = node_ids[corner[a]];
    if (builder->collapsed_count++ == 0) {
        builder->collapsed_name = name;
        builder->collapsed_id = id;
        builder->collapsed_line = line;
    }
    return lar_mesh_builder_hexahedron(builder, id, tag, node, line, error);
}

bool lar_mesh_builder_has_solids(const lar_mesh_builder *builder) {
    return builder->collapsed_count > 0;
}

/* The slot of that set, or the free one where it belongs. */
static uint16_t *find_slot(lar_mesh_builder *builder, const char *name, lar_set_kind kind) {
    uint32_t hash = 2166136261u + (uint32_t)kind; /* FNV-1a */
    for (const char *c = name; *c; c++) hash = (hash ^ (unsigned char)*c) * 16777619u;
    for (hash ^= hash >> 15;; hash++) {
        uint16_t *slot = &builder->set_slot[hash & (SET_SLOTS - 1)];
        if (*slot == 0) return slot;
        const built_set *set = &builder->set[*slot - 1];
        if (set->kind == kind && strcmp(set->name, name) == 0) return slot;
    }
}

lar_status lar_mesh_builder_set(lar_mesh_builder *builder, const char *name, lar_set_kind kind,
                                lar_error *error) {
    if (!builder->set_slot) builder->set_slot = lar_calloc(SET_SLOTS, sizeof *builder->set_slot);
    if (!builder->set_slot) return lar_fail_memory(error, SET_SLOTS, "sets");
    uint16_t *slot = find_slot(builder, name, kind);
    if (*slot != 0) {
        builder->open = &builder->set[*slot - 1];
        return LAR_OK;
    }
    if (builder->set_count >= LAR_MESH_SETS_MAX)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: holds more than %d named sets; remove those that are not used",
                        builder->source, LAR_MESH_SETS_MAX);
    char *copy = lar_strdup(name);
    if (!copy || !LAR_GROW(builder->set, builder->set_capacity, builder->set_count)) {
        free(copy);
        return lar_fail_memory(error, sizeof *builder->set, "a set");
    }
    builder->open = &builder->set[builder->set_count++];
    *builder->open = (built_set){.name = copy, .kind = kind};
    *slot = (uint16_t)builder->set_count;
    return LAR_OK;
}

static lar_status add_entry(lar_mesh_builder *builder, built_entry entry, lar_error *error) {
    built_set *set = builder->open;
    if (!set)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: an entry stands outside of any set",
                        place_of(builder, entry.line).text);
    if (set->entry_count + set->quad_count + set->corners >= INT32_MAX - 8)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%s: set '%s' has more than %d entries",
                        place_of(builder, entry.line).text, set->name, INT32_MAX);
    if (!LAR_GROW(set->entry, set->entry_capacity, set->entry_count))
        return lar_fail_memory(error, set->entry_count * sizeof *set->entry, "a set");
    set->entry[set->entry_count++] = entry;
    return LAR_OK;
}

lar_status lar_mesh_builder_set_id(lar_mesh_builder *builder, int64_t id, int line,
                                   lar_error *error) {
    return add_entry(builder, (built_entry){.id = id, .line = line}, error);
}

lar_status lar_mesh_builder_set_corners(lar_mesh_builder *builder, int64_t element_id, int line,
                                        lar_error *error) {
    built_entry entry = {.id = element_id, .line = line, .face = CORNERS};
    lar_status status = add_entry(builder, entry, error);
    if (!status) builder->open->corners += 8;
    return status;
}

lar_status lar_mesh_builder_set_face(lar_mesh_builder *builder, int64_t element_id, int face,
                                     int line, lar_error *error) {
    if (face < 0 || face > 5)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: face %d of element %lld does not exist; a hexahedron has six",
                        place_of(builder, line).text, face + 1, (long long)element_id);
    return add_entry(builder, (built_entry){.id = element_id, .line = line, .face = face}, error);
}

lar_status lar_mesh_builder_set_quad(lar_mesh_builder *builder, const int64_t node_ids[4], int line,
                                     lar_error *error) {
    built_set *set = builder->open;
    if (!set || set->kind != LAR_SET_FACES)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: a face stands outside of any face set",
                        place_of(builder, line).text);
    if (set->entry_count + set->quad_count >= INT32_MAX)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%s: set '%s' has more than %d entries",
                        place_of(builder, line).text, set->name, INT32_MAX);
    if (!LAR_GROW(set->quad, set->quad_capacity, set->quad_count))
        return lar_fail_memory(error, set->quad_count * sizeof *set->quad, "a set");
    built_quad *quad = &set->quad[set->quad_count++];
    memcpy(quad->node_ids, node_ids, sizeof quad->node_ids);
    quad->line = line;
    return LAR_OK;
}

/* ---- finish ----------------------------------------------------------------------------- */

/* What finish needs beside the builder and the mesh: who is where. */
typedef struct resolver {
    lar_id_map nodes, elements;
    int32_t *kept;        /* new index of each node, -1 when no element uses it */
    lar_face_table faces; /* filled when the first quad asks */
} resolver;

static lar_status fail_duplicate(const lar_mesh_builder *builder, const char *what, int64_t id,
                                 int first_line, int second_line, lar_error *error) {
    char first[40] = "";
    if (first_line > 0) snprintf(first, sizeof first, " (first in line %d)", first_line);
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: %s %lld is given twice%s; give every %s an id of its own",
                    place_of(builder, second_line).text, what, (long long)id, first, what);
}

static lar_status map_ids(const lar_mesh_builder *builder, resolver *ids, lar_error *error) {
    lar_id_clash clash;
    if (!lar_id_map_build(&ids->nodes, builder->node ? &builder->node[0].id : NULL,
                          (int32_t)builder->node_count, sizeof *builder->node, &clash))
        return lar_fail_memory(error, builder->node_count * sizeof(lar_id_pair), "node ids");
    if (clash.second >= 0)
        return fail_duplicate(builder, "node", builder->node[clash.second].id,
                              builder->node[clash.first].line, builder->node[clash.second].line,
                              error);
    if (!lar_id_map_build(&ids->elements, builder->element ? &builder->element[0].id : NULL,
                          (int32_t)builder->element_count, sizeof *builder->element, &clash))
        return lar_fail_memory(error, builder->element_count * sizeof(lar_id_pair), "element ids");
    if (clash.second >= 0)
        return fail_duplicate(builder, "element", builder->element[clash.second].id,
                              builder->element[clash.first].line,
                              builder->element[clash.second].line, error);
    return LAR_OK;
}

static lar_status move_elements(const lar_mesh_builder *builder, resolver *ids, lar_mesh *mesh,
                                lar_error *error) {
    ids->kept = malloc((builder->node_count + 1) * sizeof *ids->kept);
    if (!ids->kept) return lar_fail_memory(error, builder->node_count * 4, "node numbers");
    for (size_t n = 0; n < builder->node_count; n++) ids->kept[n] = -1;
    mesh->element_line = lar_calloc(builder->element_count, sizeof *mesh->element_line);
    if (!mesh->element_line) return lar_fail_memory(error, builder->element_count * 4, "lines");

    for (size_t e = 0; e < builder->element_count; e++) {
        const built_element *element = &builder->element[e];
        for (int a = 0; a < 8; a++) {
            int32_t n = lar_id_map_find(&ids->nodes, element->node_ids[a]);
            if (n < 0)
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: element %lld names node %lld, which the file does not "
                                "define; add the node or correct the element",
                                place_of(builder, element->line).text, (long long)element->id,
                                (long long)element->node_ids[a]);
            ids->kept[n] = 0;
            mesh->element[e][a] = n;
        }
        mesh->element_id[e] = element->id;
        mesh->element_line[e] = element->line;
        mesh->element_tag[e] = element->tag;
    }
    mesh->element_count = (int32_t)builder->element_count;
    mesh->collapsed_count = builder->collapsed_count;
    mesh->collapsed_name = builder->collapsed_name;
    mesh->collapsed_id = builder->collapsed_id;
    mesh->collapsed_line = builder->collapsed_line;
    return LAR_OK;
}

static void move_nodes(const lar_mesh_builder *builder, resolver *ids, lar_mesh *mesh) {
    for (size_t n = 0; n < builder->node_count; n++) {
        if (ids->kept[n] < 0) continue;
        ids->kept[n] = mesh->node_count++;
        memcpy(mesh->position[ids->kept[n]], builder->node[n].position, sizeof *mesh->position);
        mesh->node_id[ids->kept[n]] = builder->node[n].id;
    }
    mesh->dropped_node_count = (int32_t)builder->node_count - mesh->node_count;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) mesh->element[e][a] = ids->kept[mesh->element[e][a]];
}

static lar_status fail_unknown(const lar_mesh_builder *builder, const built_set *set,
                               const char *what, int64_t id, int line, lar_error *error) {
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: set '%s' names %s %lld, which the file does not define; correct the set",
                    place_of(builder, line).text, set->name, what, (long long)id);
}

static lar_status resolve_entries(const lar_mesh_builder *builder, const built_set *set,
                                  const resolver *ids, const lar_mesh *mesh, int32_t *index,
                                  int32_t *count, lar_error *error) {
    for (size_t i = 0; i < set->entry_count; i++) {
        const built_entry *entry = &set->entry[i];
        bool of_nodes = set->kind == LAR_SET_NODES && entry->face != CORNERS;
        int32_t found = lar_id_map_find(of_nodes ? &ids->nodes : &ids->elements, entry->id);
        if (found < 0)
            return fail_unknown(builder, set, of_nodes ? "node" : "element", entry->id, entry->line,
                                error);
        for (int a = 0; a < 8 && entry->face == CORNERS; a++)
            index[(*count)++] = mesh->element[found][a];
        if (entry->face == CORNERS || (of_nodes && ids->kept[found] < 0)) continue;
        index[(*count)++] = of_nodes                     ? ids->kept[found]
                            : set->kind == LAR_SET_FACES ? found * 6 + entry->face
                                                         : found;
    }
    return LAR_OK;
}

static lar_status resolve_quads(const lar_mesh_builder *builder, const built_set *set,
                                resolver *ids, const lar_mesh *mesh, int32_t *index, int32_t *count,
                                lar_error *error) {
    if (set->quad_count > 0 && !ids->faces.key) {
        lar_status status = lar_face_table_build(mesh, &ids->faces, error);
        if (status) return status;
    }
    for (size_t i = 0; i < set->quad_count; i++) {
        const built_quad *quad = &set->quad[i];
        int32_t node[4];
        for (int a = 0; a < 4; a++) {
            int32_t found = lar_id_map_find(&ids->nodes, quad->node_ids[a]);
            if (found < 0)
                return fail_unknown(builder, set, "node", quad->node_ids[a], quad->line, error);
            node[a] = ids->kept[found];
        }
        lar_face_sort_nodes(node);
        const lar_face_key *key = lar_face_table_find(&ids->faces, node);
        if (!key && builder->collapsed_count > 0) continue;
        if (!key)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the quadrilateral %lld %lld %lld %lld of set '%s' is not a face "
                            "of any hexahedron; take it out of the set or mesh surface and "
                            "volume together",
                            place_of(builder, quad->line).text, (long long)quad->node_ids[0],
                            (long long)quad->node_ids[1], (long long)quad->node_ids[2],
                            (long long)quad->node_ids[3], set->name);
        index[(*count)++] = key->face;
    }
    return LAR_OK;
}

static lar_status move_set(const lar_mesh_builder *builder, const built_set *set, resolver *ids,
                           lar_mesh *mesh, lar_error *error) {
    int32_t count = 0;
    int32_t *index = lar_calloc(set->entry_count + set->quad_count + set->corners, sizeof *index);
    if (!index) return lar_fail_memory(error, set->entry_count * sizeof *index, "a set");
    lar_status status = resolve_entries(builder, set, ids, mesh, index, &count, error);
    if (!status) status = resolve_quads(builder, set, ids, mesh, index, &count, error);
    if (status) {
        free(index);
        return status;
    }
    return lar_mesh_add_set(mesh, set->name, set->kind, index, count, error);
}

lar_status lar_mesh_builder_finish(lar_mesh_builder *builder, lar_mesh *mesh, lar_error *error) {
    resolver ids = {0};
    lar_status status = map_ids(builder, &ids, error);
    if (!status)
        status = lar_mesh_allocate(mesh, builder->source, builder->node_count,
                                   builder->element_count, error);
    if (!status) status = move_elements(builder, &ids, mesh, error);
    if (!status) move_nodes(builder, &ids, mesh);
    /* Without hexahedra no set can be right; lar_mesh_check says what is missing. */
    size_t set_count = builder->element_count > 0 ? builder->set_count : 0;
    for (size_t s = 0; s < set_count && !status; s++)
        status = move_set(builder, &builder->set[s], &ids, mesh, error);
    lar_id_map_clear(&ids.nodes);
    lar_id_map_clear(&ids.elements);
    free(ids.kept);
    free(ids.faces.key);
    if (status) lar_mesh_clear(mesh);
    return status;
}
