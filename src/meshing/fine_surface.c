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
/* The mesh has nothing of a shell with less than this part of its area near. */
static const double HAS = 0.1;

enum { PORTION = 1024, CUTS_MAX = 32 };

/* ---- shells ------------------------------------------------------------------------------- */

typedef struct shell {
    double area, near; /* of it what is near the mesh */
    double volume;     /* below zero: a hollow */
    int32_t tag;       /* of its last triangle */
    bool dropped;
} shell;

/* Asking where the mesh is, for every vertex, or for parts of every triangle as large as a cell's
 * face. */
typedef struct question {
    lar_triangles *surface;
    lar_surface_tree outer;
    double size;
    float *near; /* [triangles] which part of it */
} question;

static void find_near(void *context, int32_t first, int32_t end) {
    const question *q = context;
    for (int32_t t = first; t < end; t++) {
        double normal[3], middle[3];
        lar_triangles_normal(q->surface, t, normal);
        const int cuts = (int)fmin(1 + sqrt(lar_length(normal)) / q->size, CUTS_MAX);
        int near = 0;
        for (int part = 0; part < cuts * cuts; part++) {
            lar_triangles_part(q->surface, t, cuts, part, middle);
            near += lar_triangle_tree_is_near(q->outer.tree, middle, NEAR * q->size);
        }
        q->near[t] = (float)near / (float)(cuts * cuts);
    }
}

/* A shell is named by its root. */
static void find_shells(const question *q, int32_t *parent, shell *found) {
    const lar_triangles *surface = q->surface;
    lar_union_start(parent, surface->vertex_count);
    for (int32_t t = 0; t < surface->triangle_count; t++)
        for (int k = 1; k < 3; k++)
            lar_union_join(parent, surface->corner[t][0], surface->corner[t][k]);
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *corner = surface->corner[t], root = lar_union_root(parent, corner[0]);
        shell *one = &found[root];
        double normal[3], from[3];
        lar_triangles_normal(surface, t, normal);
        lar_minus(surface->vertex[corner[0]], surface->vertex[root], from);
        const double area = lar_length(normal) / 2;
        one->area += area;
        one->near += area * (double)q->near[t];
        one->volume += lar_dot(from, normal) / 6;
        one->tag = surface->tag[t];
    }
}

static void choose_dropped(const question *q, shell *found, const lar_boundary *boundary,
                           lar_dropped *dropped) {
    const double cell = q->size * q->size * q->size;
    const int32_t vertices = q->surface->vertex_count;
    int32_t largest = 0;
    for (int32_t v = 0; v < vertices; v++)
        if (found[v].area > found[largest].area) largest = v;
    for (int32_t v = 0; v < vertices; v++) {
        shell *one = &found[v];
        const double volume = one->volume;
        const bool small = volume < 0 && volume > -cell; /* at most one cell, which is filled */
        if (one->area == 0 || v == largest || (one->near >= HAS * one->area && !small)) continue;
        one->dropped = true;
        dropped->hollows += volume < 0;
        for (int32_t r = 1; r <= boundary->region_count; r++)
            if (boundary->region[r].tag == one->tag) dropped->volume[r] += volume;
    }
}

static void drop_shells(lar_triangles *surface, int32_t *parent, const shell *found) {
    int32_t kept = 0;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        if (found[lar_union_root(parent, surface->corner[t][0])].dropped) continue;
        surface->tag[kept] = surface->tag[t];
        memmove(surface->corner[kept++], surface->corner[t], sizeof *surface->corner);
    }
    surface->triangle_count = kept;
}

lar_status lar_fine_surface_drop(const lar_mesh *mesh, double size, const lar_boundary *boundary,
                                 lar_triangles *surface, lar_dropped *dropped, lar_error *error) {
    const size_t vertices = (size_t)surface->vertex_count;
    const int32_t before = surface->triangle_count;
    question q = {
        .surface = surface, .size = size, .near = lar_calloc((size_t)before, sizeof *q.near)};
    int32_t *parent = lar_calloc(vertices, sizeof *parent);
    shell *found = lar_calloc(vertices, sizeof *found);
    lar_status status = q.near && parent && found
                            ? lar_surface_tree_create(mesh, &q.outer, error)
                            : lar_fail_memory(error, vertices * sizeof *found, "shells");
    if (!status) {
        lar_parallel_for(before, PORTION, find_near, &q);
        find_shells(&q, parent, found);
        choose_dropped(&q, found, boundary, dropped);
        drop_shells(surface, parent, found);
    }
    if (!status && surface->triangle_count < before) status = lar_triangles_join(surface, error);
    lar_surface_tree_clear(&q.outer);
    free(q.near);
    free(parent);
    free(found);
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
