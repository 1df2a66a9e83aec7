/* The outer faces of a mesh as a surface of triangles, and a tree to find the nearest place on it.
 *
 *     3-----2
 *     |  1 /|      face f is the triangles 2 f and 2 f + 1: its corners 0 1 2 and 0 2 3
 *     | / 0 |
 *     0-----1
 */
#ifndef LAR_MODEL_TRIANGLES_SURFACE_TREE_H
#define LAR_MODEL_TRIANGLES_SURFACE_TREE_H

#include "model/mesh/mesh.h"
#include "model/triangles/tree.h"

typedef struct lar_surface_tree {
    int32_t *face;           /* [faces] element * 6 + local face, ascending */
    lar_triangles triangles; /* [2 faces]; its vertices are the mesh's nodes, lent */
    lar_triangle_tree *tree;
} lar_surface_tree;

/* Into a zeroed one, of a mesh that outlives it unmoved. The caller clears in any case. */
lar_status lar_surface_tree_create(const lar_mesh *mesh, lar_surface_tree *outer, lar_error *error);
void lar_surface_tree_clear(lar_surface_tree *outer); /* a zeroed one is fine */

#endif
