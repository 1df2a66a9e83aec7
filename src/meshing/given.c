/* Meshing without files: surfaces of the caller's memory, and what was made as arrays. */
#include <stdlib.h>
#include <string.h>

#include "meshing/meshing.h"

lar_status lar_meshing_take_surface(const lar_surface_arrays *given, double scale,
                                    lar_triangles *surface, lar_error *error) {
    const char *name = given->name && *given->name ? given->name : "surface";
    if (given->vertices < 3 || given->triangles < 4 || !given->vertex || !given->triangle)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%.300s: a closed surface has at least four triangles; give vertices and "
                        "triangles",
                        name);
    for (int32_t t = 0; t < given->triangles; t++)
        for (int c = 0; c < 3; c++)
            if (given->triangle[t][c] < 0 || given->triangle[t][c] >= given->vertices)
                return lar_fail(error, LAR_ERROR_ARGUMENT,
                                "%.300s: triangle %d has the vertex %d; there are %d, from 0", name,
                                (int)t, (int)given->triangle[t][c], (int)given->vertices);
    const size_t vertices = (size_t)given->vertices, triangles = (size_t)given->triangles;
    *surface = (lar_triangles){.vertex_count = given->vertices,
                               .vertex = lar_calloc(vertices, sizeof *surface->vertex),
                               .triangle_count = given->triangles,
                               .corner = lar_calloc(triangles, sizeof *surface->corner)};
    lar_status status = surface->vertex && surface->corner
                            ? LAR_OK
                            : lar_fail_memory(error, 24 * vertices + 12 * triangles, name);
    if (!status) {
        memcpy(surface->vertex, given->vertex, vertices * sizeof *surface->vertex);
        memcpy(surface->corner, given->triangle, triangles * sizeof *surface->corner);
        status = lar_triangles_settle(surface, name, scale, error);
    }
    if (status) lar_triangles_clear(surface);
    return status;
}

lar_status lar_meshing_list_sets(lar_meshing *m, lar_error *error) {
    static const char *const kinds[] = {"nodes", "elements", "faces"};
    m->set = lar_calloc((size_t)m->mesh.set_count + 1, sizeof *m->set);
    if (!m->set) return lar_fail_memory(error, sizeof *m->set, "sets");
    for (int32_t i = 0; i < m->mesh.set_count; i++) {
        const lar_set *set = &m->mesh.set[i];
        m->set[i] = (lar_array_set){set->name, kinds[set->kind], set->count, set->index};
    }
    return LAR_OK;
}

void lar_meshing_arrays(const lar_meshing *m, lar_mesh_arrays *mesh, lar_surface_arrays *surface) {
    if (mesh) *mesh = (lar_mesh_arrays){0};
    if (surface) *surface = (lar_surface_arrays){0};
    if (m && mesh)
        *mesh = (lar_mesh_arrays){.nodes = m->mesh.node_count,
                                  .elements = m->mesh.element_count,
                                  .sets = m->mesh.set_count,
                                  .position = m->mesh.position,
                                  .element = m->mesh.element,
                                  .tag = m->mesh.element_tag,
                                  .set = m->set,
                                  .fibre = (const double(*)[3])m->mesh.fibre};
    if (m && surface)
        *surface = (lar_surface_arrays){m->title, m->outer.vertex_count, m->outer.triangle_count,
                                        m->outer.vertex, m->outer.corner};
}

int32_t lar_meshing_region_boundary(const lar_meshing *m, int32_t index, int32_t (*triangle)[3],
                                    lar_surface_arrays *boundary) {
    int32_t count = 0;
    if (boundary) *boundary = (lar_surface_arrays){0};
    if (!m || index < 0 || index >= m->info.regions) return -1;
    const lar_triangles *all = &m->boundary.triangles;
    for (int32_t t = 0; t < all->triangle_count; t++) {
        const int front = lar_boundary_region(m->boundary.side[t][0]);
        const bool turned = front == index + 1;
        if (turned == (lar_boundary_region(m->boundary.side[t][1]) == index + 1)) continue;
        for (int c = 0; triangle && c < 3; c++)
            triangle[count][c] = all->corner[t][turned ? 2 - c : c];
        count++;
    }
    if (boundary)
        *boundary = (lar_surface_arrays){m->region[index].name, all->vertex_count, count,
                                         all->vertex, triangle};
    return count;
}

lar_status lar_meshing_scene(lar_meshing *meshing, const char **scene, lar_error *error) {
    if (!meshing || !scene)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_meshing_scene needs a meshing and a place for the text");
    lar_status status = meshing->text ? LAR_OK : lar_starter_text(meshing, &meshing->text, error);
    if (!status) *scene = meshing->text;
    return status;
}
