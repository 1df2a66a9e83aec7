#include "meshing/fine_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"
#include "model/mesh_skin.h"

/* In cells. */
static const double NEAR = 0.5, FAR = 1;
/* The mesh has nothing of a shell with less than this part of its corners near. */
static const double HAS = 0.1;

/* ---- shells ------------------------------------------------------------------------------- */

typedef struct shells {
    int32_t *parent, *count; /* [vertices] a shell is named by its root */
    int32_t *near;           /* [vertices] of these near the mesh */
} shells;

static void find_shells(const lar_triangles *surface, const lar_mesh_skin *skin, double size,
                        shells *found) {
    lar_nearest nearest;
    lar_union_start(found->parent, surface->vertex_count);
    for (int32_t t = 0; t < surface->triangle_count; t++)
        for (int k = 1; k < 3; k++)
            lar_union_join(found->parent, surface->corner[t][0], surface->corner[t][k]);
    for (int32_t v = 0; v < surface->vertex_count; v++) {
        int32_t root = lar_union_root(found->parent, v);
        found->count[root]++;
        if (lar_triangle_tree_nearest(skin->tree, surface->vertex[v], NEAR * size, &nearest))
            found->near[root]++;
    }
}

static void drop_shells(lar_triangles *surface, const shells *found) {
    int32_t kept = 0, largest = 0;
    for (int32_t v = 0; v < surface->vertex_count; v++)
        if (found->count[v] > found->count[largest]) largest = v;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        int32_t root = lar_union_root(found->parent, surface->corner[t][0]);
        bool apart = found->near[root] < HAS * found->count[root];
        if (apart && root != largest) continue;
        if (surface->tag) surface->tag[kept] = surface->tag[t];
        memmove(surface->corner[kept++], surface->corner[t], sizeof *surface->corner);
    }
    surface->triangle_count = kept;
}

lar_status lar_fine_surface_drop(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error) {
    lar_mesh_skin skin = {0};
    size_t vertices = (size_t)surface->vertex_count;
    int32_t before = surface->triangle_count;
    shells found = {.parent = lar_calloc(vertices, sizeof *found.parent),
                    .count = lar_calloc(vertices, sizeof *found.count),
                    .near = lar_calloc(vertices, sizeof *found.near)};
    bool good = found.parent && found.count && found.near;
    lar_status status = good ? lar_mesh_skin_create(mesh, &skin, error)
                             : lar_fail_memory(error, 3 * vertices * sizeof(int32_t), "shells");
    if (!status) {
        find_shells(surface, &skin, size, &found);
        drop_shells(surface, &found);
    }
    if (!status && surface->triangle_count < before) status = lar_triangles_join(surface, error);
    lar_mesh_skin_clear(&skin);
    free(found.parent);
    free(found.count);
    free(found.near);
    return status;
}

/* ---- tongues ------------------------------------------------------------------------------ */

lar_status lar_fine_surface_draw(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error) {
    lar_mesh_skin skin = {0};
    lar_nearest nearest;
    lar_status status = lar_mesh_skin_create(mesh, &skin, error);
    for (int32_t v = 0; !status && v < surface->vertex_count; v++) {
        if (!lar_triangle_tree_nearest(skin.tree, surface->vertex[v], INFINITY, &nearest)) continue;
        if (nearest.distance > FAR * size)
            memcpy(surface->vertex[v], nearest.point, sizeof nearest.point);
    }
    lar_mesh_skin_clear(&skin);
    return status;
}
