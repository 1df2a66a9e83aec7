/* A small brick of hexahedra in memory, in place of a mesh file: 2 x 2 x 2 elements, 10 mm each.
 *
 * Node i, j, k has the id 1 + i + 3 (j + 3 k), elements have the ids 101 to 108. The lower four
 * elements have the tag 1, the upper four the tag 2. Sets: nodes "bottom" (9), faces "lid" (the
 * four upper ones), elements "upper" (4). The file name "two.vtu" gives the same brick 50 mm
 * away along x, "wall.vtu" one more set, the face "wall" between its first two elements, "bare.vtu"
 * no set, "bad.vtu" an error.
 */
#ifndef LAR_TESTS_BRICK_H
#define LAR_TESTS_BRICK_H

#include <stdlib.h>
#include <string.h>

#include "model/mesh/mesh.h"

enum { BRICK_EDGE = 2, BRICK_NODES = 27, BRICK_ELEMENTS = 8 };

static inline int brick_node(int i, int j, int k) {
    return i + 3 * (j + 3 * k);
}

static inline void brick_element(lar_mesh *mesh, int e, int i, int j, int k) {
    for (int a = 0; a < 8; a++)
        mesh->element[e][a] =
            brick_node(i + (lar_node_sign[a][0] > 0), j + (lar_node_sign[a][1] > 0),
                       k + (lar_node_sign[a][2] > 0));
    mesh->element_id[e] = 101 + e;
    mesh->element_tag[e] = k + 1;
}

static inline lar_status brick_set(lar_mesh *mesh, const char *name, lar_set_kind kind, int first,
                                   int step, int add, int count, lar_error *error) {
    int32_t *index = lar_calloc((size_t)count, sizeof *index);
    for (int i = 0; index && i < count; i++) index[i] = (first + i) * step + add;
    return index ? lar_mesh_add_set(mesh, name, kind, index, count, error) : LAR_ERROR_MEMORY;
}

static inline lar_status brick_read(const char *path, double scale, lar_mesh *mesh,
                                    lar_error *error) {
    if (strstr(path, "bad.vtu"))
        return lar_fail(error, LAR_ERROR_IO, "%s: cannot be opened: gone; check the path", path);
    double shift = strstr(path, "two.vtu") ? 0.05 : 0.0;
    mesh->source = lar_strdup(path);
    mesh->node_count = BRICK_NODES;
    mesh->element_count = BRICK_ELEMENTS;
    mesh->position = lar_calloc(BRICK_NODES, sizeof *mesh->position);
    mesh->node_id = lar_calloc(BRICK_NODES, sizeof *mesh->node_id);
    mesh->element = lar_calloc(BRICK_ELEMENTS, sizeof *mesh->element);
    mesh->element_id = lar_calloc(BRICK_ELEMENTS, sizeof *mesh->element_id);
    mesh->element_tag = lar_calloc(BRICK_ELEMENTS, sizeof *mesh->element_tag);
    if (!mesh->position || !mesh->node_id || !mesh->element || !mesh->element_id ||
        !mesh->element_tag)
        return lar_fail_memory(error, 0, path);
    for (int n = 0; n < BRICK_NODES; n++) {
        mesh->node_id[n] = n + 1;
        mesh->position[n][0] = (0.01 * (n % 3) + shift) * scale;
        mesh->position[n][1] = 0.01 * (n / 3 % 3) * scale;
        mesh->position[n][2] = 0.01 * (n / 9) * scale;
    }
    for (int e = 0; e < BRICK_ELEMENTS; e++) brick_element(mesh, e, e % 2, e / 2 % 2, e / 4);
    if (strstr(path, "bare.vtu")) return LAR_OK;
    lar_status status = brick_set(mesh, "bottom", LAR_SET_NODES, 0, 1, 0, 9, error);
    if (!status) status = brick_set(mesh, "lid", LAR_SET_FACES, 4, 6, 5, 4, error);
    if (!status) status = brick_set(mesh, "upper", LAR_SET_ELEMENTS, 4, 1, 0, 4, error);
    if (!status && strstr(path, "wall.vtu"))
        status = brick_set(mesh, "wall", LAR_SET_FACES, 0, 6, 1, 1, error);
    return status;
}

#endif
