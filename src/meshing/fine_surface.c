#include "meshing/fine_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"
#include "model/triangle_tree.h"

static const double APART = 0.5, FAR = 1; /* in cells */

/* The mesh's outer faces, each as two triangles, and the tree over them. */
typedef struct skin {
    lar_triangles triangles; /* vertices: the mesh's own */
    lar_triangle_tree *tree;
} skin;

static void clear_skin(skin *s) {
    lar_triangle_tree_destroy(s->tree);
    free(s->triangles.corner);
}

static lar_status make_skin(const lar_mesh *mesh, skin *s, lar_error *error) {
    int32_t *face = NULL, count = 0;
    lar_status status = lar_mesh_boundary(mesh, &face, &count, error);
    if (status) return status;
    s->triangles = (lar_triangles){
        .vertex_count = mesh->node_count, .vertex = mesh->position, .triangle_count = 2 * count};
    s->triangles.corner = lar_calloc(2 * (size_t)count, sizeof *s->triangles.corner);
    if (!s->triangles.corner)
        status = lar_fail_memory(error, 2 * (size_t)count * sizeof *s->triangles.corner,
                                 "the mesh's surface");
    for (int32_t i = 0; !status && i < count; i++) {
        const int32_t *node = mesh->element[face[i] / 6];
        const uint8_t *at = lar_face_node[face[i] % 6];
        const int32_t two[2][3] = {{node[at[0]], node[at[1]], node[at[2]]},
                                   {node[at[0]], node[at[2]], node[at[3]]}};
        memcpy(s->triangles.corner[2 * i], two, sizeof two);
    }
    free(face);
    if (!status)
        status = lar_triangle_tree_create(&s->triangles, NULL, s->triangles.triangle_count,
                                          &s->tree, error);
    return status;
}

/* ---- shells ------------------------------------------------------------------------------- */

typedef struct shells {
    int32_t *parent, *count; /* [vertices] a shell is named by its root */
    double *distance;        /* [vertices] summed up at the roots */
} shells;

static void find_shells(const lar_triangles *surface, const skin *s, shells *found) {
    lar_nearest nearest;
    lar_union_start(found->parent, surface->vertex_count);
    for (int32_t t = 0; t < surface->triangle_count; t++)
        for (int k = 1; k < 3; k++)
            lar_union_join(found->parent, surface->corner[t][0], surface->corner[t][k]);
    for (int32_t v = 0; v < surface->vertex_count; v++) {
        int32_t root = lar_union_root(found->parent, v);
        found->count[root]++;
        if (lar_triangle_tree_nearest(s->tree, surface->vertex[v], INFINITY, &nearest))
            found->distance[root] += nearest.distance;
    }
}

static void drop_shells(lar_triangles *surface, const shells *found, double size) {
    int32_t kept = 0, largest = 0;
    for (int32_t v = 0; v < surface->vertex_count; v++)
        if (found->count[v] > found->count[largest]) largest = v;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        int32_t root = lar_union_root(found->parent, surface->corner[t][0]);
        bool apart = found->distance[root] > APART * size * found->count[root];
        if (apart && root != largest) continue;
        if (surface->tag) surface->tag[kept] = surface->tag[t];
        memmove(surface->corner[kept++], surface->corner[t], sizeof *surface->corner);
    }
    surface->triangle_count = kept;
}

lar_status lar_fine_surface_drop(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error) {
    skin s = {0};
    size_t vertices = (size_t)surface->vertex_count;
    int32_t before = surface->triangle_count;
    shells found = {.parent = lar_calloc(vertices, sizeof *found.parent),
                    .count = lar_calloc(vertices, sizeof *found.count),
                    .distance = lar_calloc(vertices, sizeof *found.distance)};
    bool good = found.parent && found.count && found.distance;
    lar_status status = good ? make_skin(mesh, &s, error)
                             : lar_fail_memory(error, 2 * vertices * sizeof(double), "shells");
    if (!status) {
        find_shells(surface, &s, &found);
        drop_shells(surface, &found, size);
    }
    if (!status && surface->triangle_count < before) status = lar_triangles_join(surface, error);
    clear_skin(&s);
    free(found.parent);
    free(found.count);
    free(found.distance);
    return status;
}

/* ---- tongues ------------------------------------------------------------------------------ */

lar_status lar_fine_surface_draw(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error) {
    skin s = {0};
    lar_nearest nearest;
    lar_status status = make_skin(mesh, &s, error);
    for (int32_t v = 0; !status && v < surface->vertex_count; v++) {
        if (!lar_triangle_tree_nearest(s.tree, surface->vertex[v], INFINITY, &nearest)) continue;
        if (nearest.distance > FAR * size)
            memcpy(surface->vertex[v], nearest.point, sizeof nearest.point);
    }
    clear_skin(&s);
    return status;
}
