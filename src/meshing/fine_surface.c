#include "meshing/fine_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "base/union_find.h"
#include "base/vector.h"
#include "model/triangles/surface_tree.h"

/* In cells. */
static const double NEAR = 0.5, FAR = 1;
/* The mesh has nothing of a shell with less than this part of its corners near. */
static const double HAS = 0.1;

enum { PORTION = 1024 };

/* ---- shells ------------------------------------------------------------------------------- */

typedef struct shells {
    int32_t *parent, *count; /* [vertices] a shell is named by its root */
    int32_t *near;           /* [vertices] of these near the mesh */
    double *volume;          /* [vertices] of the shell; below zero: a hollow */
    int32_t *tag;            /* [vertices] of its last triangle */
} shells;

/* Asking where the mesh is, for every vertex. */
typedef struct question {
    lar_triangles *surface;
    lar_surface_tree outer;
    double size;
    bool *is_near; /* [vertices] */
} question;

static void find_near(void *context, int32_t first, int32_t end) {
    const question *q = context;
    for (int32_t v = first; v < end; v++)
        q->is_near[v] =
            lar_triangle_tree_is_near(q->outer.tree, q->surface->vertex[v], NEAR * q->size);
}

static void find_shells(question *q, shells *found) {
    const lar_triangles *surface = q->surface;
    lar_parallel_for(surface->vertex_count, PORTION, find_near, q);
    lar_union_start(found->parent, surface->vertex_count);
    for (int32_t t = 0; t < surface->triangle_count; t++)
        for (int k = 1; k < 3; k++)
            lar_union_join(found->parent, surface->corner[t][0], surface->corner[t][k]);
    for (int32_t v = 0; v < surface->vertex_count; v++) {
        int32_t root = lar_union_root(found->parent, v);
        found->count[root]++;
        found->near[root] += q->is_near[v];
    }
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *corner = surface->corner[t], root = lar_union_root(found->parent, corner[0]);
        const double *origin = surface->vertex[root];
        double edge[3][3], across[3];
        for (int k = 0; k < 3; k++) lar_minus(surface->vertex[corner[k]], origin, edge[k]);
        lar_cross(edge[1], edge[2], across);
        found->volume[root] += lar_dot(edge[0], across) / 6;
        found->tag[root] = surface->tag[t];
    }
}

/* What is dropped has a count of 0 then. */
static void choose_dropped(const question *q, const shells *found, const lar_boundary *boundary,
                           lar_dropped *dropped) {
    const double cell = q->size * q->size * q->size;
    const int32_t vertices = q->surface->vertex_count;
    int32_t largest = 0;
    for (int32_t v = 0; v < vertices; v++)
        if (found->count[v] > found->count[largest]) largest = v;
    for (int32_t v = 0; v < vertices; v++) {
        const double volume = found->volume[v];
        const bool small = volume < 0 && volume > -cell; /* at most one cell, which is filled */
        if (found->count[v] == 0 || v == largest) continue;
        if (found->near[v] >= HAS * found->count[v] && !small) continue;
        found->count[v] = 0;
        dropped->hollows += volume < 0;
        for (int32_t r = 1; r <= boundary->region_count; r++)
            if (boundary->region[r].tag == found->tag[v]) dropped->volume[r] += volume;
    }
}

static void drop_shells(lar_triangles *surface, const shells *found) {
    int32_t kept = 0;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        if (found->count[lar_union_root(found->parent, surface->corner[t][0])] == 0) continue;
        surface->tag[kept] = surface->tag[t];
        memmove(surface->corner[kept++], surface->corner[t], sizeof *surface->corner);
    }
    surface->triangle_count = kept;
}

lar_status lar_fine_surface_drop(const lar_mesh *mesh, double size, const lar_boundary *boundary,
                                 lar_triangles *surface, lar_dropped *dropped, lar_error *error) {
    size_t vertices = (size_t)surface->vertex_count;
    int32_t before = surface->triangle_count;
    question q = {
        .surface = surface, .size = size, .is_near = lar_calloc(vertices, sizeof *q.is_near)};
    shells found = {.parent = lar_calloc(vertices, sizeof *found.parent),
                    .count = lar_calloc(vertices, sizeof *found.count),
                    .near = lar_calloc(vertices, sizeof *found.near),
                    .volume = lar_calloc(vertices, sizeof *found.volume),
                    .tag = lar_calloc(vertices, sizeof *found.tag)};
    bool good = q.is_near && found.parent && found.count && found.near && found.volume && found.tag;
    lar_status status = good ? lar_surface_tree_create(mesh, &q.outer, error)
                             : lar_fail_memory(error, 3 * vertices * sizeof(int32_t), "shells");
    if (!status) {
        find_shells(&q, &found);
        choose_dropped(&q, &found, boundary, dropped);
        drop_shells(surface, &found);
    }
    if (!status && surface->triangle_count < before) status = lar_triangles_join(surface, error);
    lar_surface_tree_clear(&q.outer);
    free(q.is_near);
    free(found.parent);
    free(found.count);
    free(found.near);
    free(found.volume);
    free(found.tag);
    return status;
}

/* ---- tongues ------------------------------------------------------------------------------ */

static void draw_some(void *context, int32_t first, int32_t end) {
    const question *q = context;
    for (int32_t v = first; v < end; v++) {
        double *vertex = q->surface->vertex[v];
        lar_nearest nearest;
        if (lar_triangle_tree_is_near(q->outer.tree, vertex, FAR * q->size)) continue;
        if (!lar_triangle_tree_nearest(q->outer.tree, vertex, INFINITY, &nearest)) continue;
        if (nearest.distance > FAR * q->size) memcpy(vertex, nearest.point, sizeof nearest.point);
    }
}

lar_status lar_fine_surface_draw(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error) {
    question q = {.surface = surface, .size = size};
    lar_status status = lar_surface_tree_create(mesh, &q.outer, error);
    if (!status) lar_parallel_for(surface->vertex_count, PORTION, draw_some, &q);
    lar_surface_tree_clear(&q.outer);
    return status;
}
