/* The outer faces of a mesh as a surface of triangles, and a tree to find the nearest place on it.
 *
 *     3-----2
 *     |  1 /|      face f is the triangles 2 f and 2 f + 1: its corners 0 1 2 and 0 2 3
 *     | / 0 |
 *     0-----1
 */
#ifndef LAR_MODEL_TRIANGLES_SKIN_H
#define LAR_MODEL_TRIANGLES_SKIN_H

#include "model/mesh/mesh.h"
#include "model/triangles/tree.h"

typedef struct lar_mesh_skin {
    int32_t *face;           /* [faces] element * 6 + local face, ascending */
    lar_triangles triangles; /* [2 faces]; its vertices are the mesh's nodes, lent */
    lar_triangle_tree *tree;
} lar_mesh_skin;

/* Into a zeroed one, of a mesh that outlives it unmoved. The caller clears in any case. */
lar_status lar_mesh_skin_create(const lar_mesh *mesh, lar_mesh_skin *skin, lar_error *error);
void lar_mesh_skin_clear(lar_mesh_skin *skin); /* a zeroed one is fine */

#endif
