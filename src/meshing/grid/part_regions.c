#include "meshing/grid/part_regions.h"

#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"
#include "model/mesh/faces.h"

/* Corners of elements, element * 8 + local node: those at one node that stay together. */
typedef struct corners {
    int32_t *parent; /* [8 elements] the group's least corner is its root */
    int32_t *node;   /* [8 elements] at roots: the group's node */
} corners;

static int32_t node_at(const lar_mesh *mesh, int32_t corner) {
    return mesh->element[corner / 8][corner % 8];
}

/* The corners of two elements at the nodes of the face that they share. */
static void join_at_face(const lar_mesh *mesh, int32_t p, int32_t q, int32_t *parent) {
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            int32_t a = 8 * (p / 6) + lar_face_node[p % 6][i];
            int32_t b = 8 * (q / 6) + lar_face_node[q % 6][k];
            if (node_at(mesh, a) == node_at(mesh, b)) lar_union_join(parent, a, b);
        }
}

static lar_status find_groups(const lar_mesh *mesh, int32_t *parent, lar_error *error) {
    lar_face_table table = {0};
    lar_status status = lar_face_table_build(mesh, &table, error);
    lar_union_start(parent, 8 * mesh->element_count);
    for (size_t i = 0; !status && i + 1 < table.count; i++) {
        const int32_t p = table.key[i].face, q = table.key[i + 1].face;
        if (mesh->element_tag[p / 6] == mesh->element_tag[q / 6] &&
            lar_face_key_same(&table.key[i], &table.key[i + 1]))
            join_at_face(mesh, p, q, parent);
    }
    free(table.key);
    return status;
}

/* The first group at a node keeps it; the number of nodes that the others need. */
static int32_t number_groups(const lar_mesh *mesh, bool *taken, corners *c) {
    int32_t added = 0;
    for (int32_t i = 0; i < 8 * mesh->element_count; i++) {
        if (lar_union_root(c->parent, i) != i) continue;
        int32_t n = node_at(mesh, i);
        c->node[i] = taken[n] ? mesh->node_count + added++ : n;
        taken[n] = true;
    }
    return added;
}

static lar_status add_nodes(lar_mesh *mesh, corners *c, int32_t added, lar_error *error) {
    size_t all = (size_t)mesh->node_count + (size_t)added;
    double(*position)[3] = realloc(mesh->position, all * sizeof *position);
    if (position) mesh->position = position;
    int64_t *id = position ? realloc(mesh->node_id, all * sizeof *id) : NULL;
    if (id) mesh->node_id = id;
    if (!id) return lar_fail_memory(error, all * sizeof *position, "the nodes of bodies");
    for (int32_t i = 0; i < 8 * mesh->element_count; i++) {
        int32_t *node = &mesh->element[i / 8][i % 8], now = c->node[lar_union_root(c->parent, i)];
        if (now >= mesh->node_count) {
            memcpy(position[now], position[*node], sizeof *position);
            id[now] = now + 1;
        }
        *node = now;
    }
    mesh->node_count += added;
    return LAR_OK;
}

lar_status lar_regions_part(lar_mesh *mesh, int32_t *added, lar_error *error) {
    size_t count = 8 * (size_t)mesh->element_count;
    corners c = {.parent = lar_calloc(count, sizeof *c.parent),
                 .node = lar_calloc(count, sizeof *c.node)};
    bool *taken = lar_calloc((size_t)mesh->node_count, sizeof *taken);
    lar_status status = c.parent && c.node && taken
                            ? find_groups(mesh, c.parent, error)
                            : lar_fail_memory(error, 2 * count * sizeof *c.node, "bodies");
    if (!status) *added = number_groups(mesh, taken, &c);
    if (!status) status = add_nodes(mesh, &c, *added, error);
    free(c.parent);
    free(c.node);
    free(taken);
    return status;
}
