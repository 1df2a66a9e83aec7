#include "model/triangles/skin.h"

#include <stdlib.h>

void lar_mesh_skin_clear(lar_mesh_skin *skin) {
    lar_triangle_tree_destroy(skin->tree);
    free(skin->triangles.corner);
    free(skin->face);
    *skin = (lar_mesh_skin){0};
}

lar_status lar_mesh_skin_create(const lar_mesh *mesh, lar_mesh_skin *skin, lar_error *error) {
    int32_t faces = 0;
    lar_status status = lar_mesh_boundary(mesh, &skin->face, &faces, error);
    if (status) return status;
    lar_triangles *triangles = &skin->triangles;
    if (faces <= INT32_MAX / 2)
        triangles->corner = lar_calloc(2 * (size_t)faces, sizeof *triangles->corner);
    if (!triangles->corner)
        return lar_fail_memory(error, 24 * (size_t)faces, "the boundary of the mesh");
    triangles->vertex = mesh->position;
    triangles->vertex_count = mesh->node_count;
    triangles->triangle_count = 2 * faces;
    for (int32_t t = 0; t < 2 * faces; t++)
        for (int i = 0; i < 3; i++) {
            int32_t face = skin->face[t / 2];
            int corner = i == 0 ? 0 : i + t % 2;
            triangles->corner[t][i] = mesh->element[face / 6][lar_face_node[face % 6][corner]];
        }
    return lar_triangle_tree_create(triangles, NULL, 2 * faces, &skin->tree, error);
}
