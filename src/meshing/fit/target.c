#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "base/vector.h"
#include "meshing/fit/work.h"

/* (1 + g) / 2 and (1 - g) / 2 with g = 1 / sqrt(3), multiplied. */
const double lar_fit_share[4] = {0.62200846792814621559, 1.0 / 6, 0.04465819873852045108, 1.0 / 6};

/* Farther away, in cells, the true boundary between two regions is another one than the one that
 * the mesh has there. */
static const double REACH = 1.8;

/* A plane serves until the point that it was asked for has moved so far [cells]. */
static const double NEGLIGIBLE = 0.03;

/* How much more a flat cut weighs: it is known exactly, and its edge shall be sharp. */
static const double CUT_WEIGHT = 4;

/* How much more an outer face weighs where it and interfaces draw at the same nodes: it is what is
 * seen, and where the body ends. */
static const double OUTER_WEIGHT = 2;

/* ---- trees ---------------------------------------------------------------------------------- */

/* Triangles by the region behind them, so that not all are looked at for each pair. */
enum { BEHIND = LAR_REGION_CUT + LAR_CUTS };

typedef struct planting {
    lar_fit_work *work;
    int32_t start[BEHIND + 1], *order;
    bool failed; /* atomic */
} planting;

static bool sort_triangles(planting *all) {
    const lar_boundary *boundary = all->work->boundary;
    const int32_t triangles = boundary->triangles.triangle_count;
    all->order = lar_calloc((size_t)triangles, sizeof *all->order);
    if (!all->order) return false;
    for (int32_t t = 0; t < triangles; t++) all->start[boundary->side[t][1] + 1]++;
    for (int r = 0; r < BEHIND; r++) all->start[r + 1] += all->start[r];
    for (int32_t t = 0; t < triangles; t++) all->order[all->start[boundary->side[t][1]]++] = t;
    memmove(all->start + 1, all->start, BEHIND * sizeof *all->start);
    all->start[0] = 0;
    return true;
}

/* What stands for the boundary between a and b: the triangles between them, in their order. Where
 * there are none, since a gap or a third region between them is thinner than a cell, nothing draws
 * faces. */
static int32_t choose_triangles(const planting *all, const uint16_t region[2], int32_t *chosen) {
    const lar_boundary *boundary = all->work->boundary;
    int32_t at[2], end[2], count = 0;
    for (int k = 0; k < 2; k++) {
        at[k] = all->start[region[k]];
        end[k] = all->start[region[k] + 1];
    }
    while (at[0] < end[0] || at[1] < end[1]) {
        const bool other =
            at[0] == end[0] || (at[1] < end[1] && all->order[at[1]] < all->order[at[0]]);
        const int32_t t = all->order[at[other]++];
        if (lar_boundary_between(boundary, t, region[0], region[1])) chosen[count++] = t;
    }
    return count;
}

static void plant_trees(void *context, int32_t first, int32_t end) {
    planting *all = context;
    const lar_triangles *triangles = &all->work->boundary->triangles;
    int32_t *chosen = lar_calloc((size_t)triangles->triangle_count, sizeof *chosen);
    bool ready = chosen != NULL;
    for (int32_t p = first; ready && p < end; p++) {
        lar_fit_pair *pair = &all->work->pair[p];
        const int32_t count = choose_triangles(all, pair->region, chosen);
        ready =
            count == 0 || !lar_triangle_tree_create(triangles, chosen, count, &pair->tree, NULL);
    }
    if (!ready) __atomic_store_n(&all->failed, true, __ATOMIC_RELAXED);
    free(chosen);
}

lar_status lar_fit_targets_create(lar_fit_work *work, lar_error *error) {
    enum { PORTION = 4 };
    const size_t bytes = (size_t)work->boundary->triangles.triangle_count * sizeof(int32_t);
    planting all = {.work = work};
    all.failed = !sort_triangles(&all);
    if (!all.failed) lar_parallel_for(work->pair_count, PORTION, plant_trees, &all);
    free(all.order);
    if (!all.failed) return LAR_OK;
    return lar_fail_memory(error, bytes, "the triangles between two regions");
}

/* ---- planes --------------------------------------------------------------------------------- */

typedef struct target {
    double point[3], normal[3]; /* in cells; towards the pair's first region */
    double away[3];             /* from the point to what asked */
} target;

static bool triangle_normal(const lar_fit_work *work, const lar_fit_pair *pair, int32_t t,
                            double normal[3]) {
    const lar_triangles *triangles = &work->boundary->triangles;
    const int32_t *corner = triangles->corner[t];
    const uint16_t *side = work->boundary->side[t];
    double along[3], across[3];
    lar_minus(triangles->vertex[corner[1]], triangles->vertex[corner[0]], along);
    lar_minus(triangles->vertex[corner[2]], triangles->vertex[corner[0]], across);
    lar_cross(along, across, normal);
    const double length = lar_length(normal);
    if (!(length > 0)) return false;
    /* Of nested surfaces the later one has the place behind its triangles. */
    const bool front_first = side[1] == pair->region[1] || side[0] == pair->region[0];
    const double factor = (front_first ? 1 : -1) / length;
    for (int i = 0; i < 3; i++) normal[i] *= factor;
    return true;
}

/* The nearest point of the pair's boundary to `ask`, seen from `x`, when it looks the same way. */
static bool ask_tree(const lar_fit_work *work, const lar_fit_pair *pair, const double ask[3],
                     double reach, const double x[3], const double facing[3], target *found) {
    double world[3];
    lar_nearest nearest;
    for (int i = 0; i < 3; i++) world[i] = work->origin[i] + work->size * ask[i];
    if (!lar_triangle_tree_nearest(pair->tree, world, reach * work->size, &nearest)) return false;
    if (!triangle_normal(work, pair, nearest.triangle, found->normal)) return false;
    if (!(lar_dot(found->normal, facing) > 0)) return false;
    for (int i = 0; i < 3; i++) {
        found->point[i] = (nearest.point[i] - work->origin[i]) / work->size;
        found->away[i] = x[i] - found->point[i];
    }
    return true;
}

/* Where the mesh is about as thin as a cell, the nearest triangle may be one of the other side,
 * which looks the other way; then those beyond are asked, half a cell in front and behind. */
static bool find_own(const lar_fit_work *work, const lar_fit_pair *pair, const double x[3],
                     double reach, const double facing[3], target *found) {
    if (ask_tree(work, pair, x, reach, x, facing, found)) return true;
    target other[2];
    bool any[2];
    for (int k = 0; k < 2; k++) {
        double ask[3];
        for (int i = 0; i < 3; i++) ask[i] = x[i] + (k ? -0.6 : 0.6) * facing[i];
        any[k] = ask_tree(work, pair, ask, REACH, x, facing, &other[k]);
    }
    if (!any[0] && !any[1]) return false;
    *found = other[!any[0] || (any[1] && lar_dot(other[1].away, other[1].away) <
                                             lar_dot(other[0].away, other[0].away))];
    return true;
}

/* The nearest of what is outer boundary of any region. */
static bool find_outer(const lar_fit_work *work, const double x[3], const double facing[3],
                       target *found) {
    double reach = REACH;
    bool any = false;
    for (int32_t p = 0; p < work->pair_count; p++) {
        const lar_fit_pair *pair = &work->pair[p];
        target other;
        if (!pair->tree || pair->region[0] != 0) continue;
        if (!ask_tree(work, pair, x, reach, x, facing, &other)) continue;
        if (any && !(lar_length(other.away) < reach)) continue;
        *found = other;
        reach = lar_length(other.away);
        any = true;
    }
    return any;
}

/* Of small regions many cells lie where the true boundary is a neighbour's. Their outer faces are
 * drawn to that one where their own is so much farther, or there is none: it is the body's boundary
 * all the same, and the interface beside it shows whose it is. */
static bool find_target(const lar_fit_work *work, const lar_fit_pair *pair, const double x[3],
                        double reach, const double facing[3], target *found) {
    const double MORE = 0.3; /* cells */
    const bool own = find_own(work, pair, x, reach, facing, found);
    if (pair->region[0] != 0 || work->boundary->region_count == 1) return own;
    const double far = own ? lar_length(found->away) - MORE : INFINITY;
    target other;
    if (!(far > 0) || !find_outer(work, x, facing, &other)) return own;
    if (!(lar_length(other.away) < far)) return own;
    *found = other;
    return true;
}

static double pair_weight(const lar_fit_work *work, const lar_fit_pair *pair) {
    if (pair->region[1] >= LAR_REGION_CUT) return CUT_WEIGHT;
    return pair->region[0] == 0 && work->boundary->region_count > 1 ? OUTER_WEIGHT : 1;
}

/* The plane through the nearest point. It stands across the way there, which beyond the rim of an
 * open boundary, and at its edges, is not the triangle's normal; near the boundary the triangle's
 * says it better, and a flat cut has only one. */
static void renew_plane(const lar_fit_work *work, const lar_fit_pair *pair, const double x[3],
                        const double facing[3], double weight, lar_fit_plane *plane) {
    target found;
    double reach = REACH;
    if (plane->weight > 0) {
        double moved[3], away[3];
        lar_minus(x, plane->asked, moved);
        if (lar_dot(moved, moved) < NEGLIGIBLE * NEGLIGIBLE) return;
        lar_minus(x, plane->point, away);
        reach = fmin(REACH, 1.0001 * lar_length(away) + 1e-6); /* there is one so near */
    }
    plane->weight = 0;
    if (!pair->tree || !find_target(work, pair, x, reach, facing, &found)) return;
    const double distance = lar_length(found.away);
    if (distance > 0.02 && pair->region[1] < LAR_REGION_CUT) {
        const double sign = lar_dot(found.away, found.normal) < 0 ? -1 : 1;
        for (int i = 0; i < 3; i++) found.normal[i] = sign * found.away[i] / distance;
    }
    memcpy(plane->asked, x, sizeof plane->asked);
    memcpy(plane->point, found.point, sizeof plane->point);
    memcpy(plane->normal, found.normal, sizeof plane->normal);
    plane->level = lar_dot(found.normal, found.point);
    plane->weight = pair_weight(work, pair) * weight;
}

static void unit_normal(const lar_fit_work *work, const lar_fit_face *face, double normal[3]) {
    lar_fit_area(work, face->node, normal);
    const double length = lar_length(normal);
    for (int i = 0; i < 3; i++) normal[i] = length > 0 ? normal[i] / length : 0;
}

static void renew_face(lar_fit_work *work, lar_fit_face *face) {
    double normal[3];
    unit_normal(work, face, normal);
    for (int g = 0; g < LAR_FIT_GAUSS; g++) {
        double x[3] = {0};
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++)
                x[i] += lar_fit_share[(a - g) & 3] * work->x[face->node[a]][i];
        renew_plane(work, &work->pair[face->pair], x, normal, work->face_weight / LAR_FIT_GAUSS,
                    &face->plane[g]);
    }
}

static void renew_point(lar_fit_work *work, lar_fit_point *point) {
    double sum[3] = {0};
    const int32_t n = point->node;
    for (int32_t i = work->face_start[n]; i < work->face_start[n + 1]; i++) {
        const lar_fit_face *face = &work->face[work->face_around[i] / 4];
        double normal[3];
        if (face->pair != point->pair) continue;
        unit_normal(work, face, normal);
        for (int k = 0; k < 3; k++) sum[k] += normal[k];
    }
    const double length = lar_length(sum);
    for (int k = 0; k < 3; k++) sum[k] = length > 0 ? sum[k] / length : 0;
    renew_plane(work, &work->pair[point->pair], work->x[n], sum,
                work->node_weight * point->faces / 4, &point->plane);
}

static void renew_faces(void *context, int32_t first, int32_t end) {
    lar_fit_work *work = context;
    for (int32_t f = first; f < end; f++) renew_face(work, &work->face[f]);
}

static void renew_points(void *context, int32_t first, int32_t end) {
    lar_fit_work *work = context;
    for (int32_t i = first; i < end; i++) renew_point(work, &work->point[i]);
}

void lar_fit_targets_renew(lar_fit_work *work) {
    enum { PORTION = 512 };
    lar_parallel_for(work->face_count, PORTION, renew_faces, work);
    lar_parallel_for(work->point_count, PORTION, renew_points, work);
}
