#include "model/mesh/surface.h"

#include <stdlib.h>
#include <string.h>

static lar_status allocate(const lar_mesh *mesh, lar_surface *surface, lar_error *error) {
    size_t faces = (size_t)surface->face_count, nodes = (size_t)mesh->node_count;
    surface->corner = lar_calloc(faces, sizeof *surface->corner);
    surface->element = lar_calloc(faces, sizeof *surface->element);
    surface->node = lar_calloc(nodes, sizeof *surface->node);
    surface->index_of = lar_calloc(nodes, sizeof *surface->index_of);
    if (surface->corner && surface->element && surface->node && surface->index_of) return LAR_OK;
    return lar_fail_memory(error, 20 * faces + 8 * nodes, "the surface of the mesh");
}

static void list_corners(const lar_mesh *mesh, lar_surface *surface) {
    memset(surface->index_of, -1, (size_t)mesh->node_count * sizeof *surface->index_of);
    for (int32_t i = 0; i < surface->face_count; i++) {
        int32_t e = surface->face[i] / 6, f = surface->face[i] % 6;
        surface->element[i] = e;
        for (int a = 0; a < 4; a++) {
            int32_t node = mesh->element[e][lar_face_node[f][a]];
            surface->corner[i][a] = node;
            surface->index_of[node] = 0;
        }
    }
}

lar_status lar_surface_build(const lar_mesh *mesh, lar_surface *surface, lar_error *error) {
    lar_surface made = {0};
    lar_status status = lar_mesh_boundary(mesh, &made.face, &made.face_count, error);
    if (!status) status = allocate(mesh, &made, error);
    if (status) {
        lar_surface_clear(&made);
        return status;
    }
    list_corners(mesh, &made);
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (made.index_of[n] == 0) {
            made.index_of[n] = made.node_count;
            made.node[made.node_count++] = n;
        }
    lar_surface_clear(surface);
    *surface = made;
    return LAR_OK;
}

void lar_surface_clear(lar_surface *surface) {
    free(surface->face);
    free(surface->corner);
    free(surface->element);
    free(surface->node);
    free(surface->index_of);
    *surface = (lar_surface){0};
}

int32_t lar_surface_find(const lar_surface *surface, int32_t face) {
    int32_t low = 0, high = surface->face_count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (surface->face[middle] < face)
            low = middle + 1;
        else
            high = middle;
    }
    return low < surface->face_count && surface->face[low] == face ? low : -1;
}
