#include "model/triangles/surface_tree.h"

#include <stdlib.h>

void lar_surface_tree_clear(lar_surface_tree *outer) {
    lar_triangle_tree_destroy(outer->tree);
    free(outer->triangles.corner);
    free(outer->face);
    *outer = (lar_surface_tree){0};
}

lar_status lar_surface_tree_create(const lar_mesh *mesh, lar_surface_tree *outer,
                                   lar_error *error) {
    int32_t faces = 0;
    lar_status status = lar_mesh_boundary(mesh, &outer->face, &faces, error);
    if (status) return status;
    lar_triangles *triangles = &outer->triangles;
    if (faces <= INT32_MAX / 2)
        triangles->corner = lar_calloc(2 * (size_t)faces, sizeof *triangles->corner);
    if (!triangles->corner)
        return lar_fail_memory(error, 24 * (size_t)faces, "the boundary of the mesh");
    triangles->vertex = mesh->position;
    triangles->vertex_count = mesh->node_count;
    triangles->triangle_count = 2 * faces;
    for (int32_t t = 0; t < 2 * faces; t++)
        for (int i = 0; i < 3; i++) {
            int32_t face = outer->face[t / 2];
            int corner = i == 0 ? 0 : i + t % 2;
            triangles->corner[t][i] = mesh->element[face / 6][lar_face_node[face % 6][corner]];
        }
    return lar_triangle_tree_create(triangles, NULL, 2 * faces, &outer->tree, error);
}
