/* Which triangles of a surface go through each other, and how deep.
 *
 * Two triangles are apart exactly when some direction is found along which their extents do not
 * overlap, and it is enough to try both normals and the cross products of their edges (separating
 * axes: Gottschalk, Lin, Manocha 1996, "OBBTree"). The least overlap of all directions is the
 * depth: how far one of them must be moved to be free of the other. Triangles that only touch, at a
 * common vertex too, have depth 0. Rounded directions do no harm: along any direction at all the
 * overlap is never less than the depth. */
#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <math.h>

#include "base/vector.h"
#include "model/triangles/tree.h"

/* Corners common to two triangles. */
static int common_corners(const int32_t a[3], const int32_t b[3]) {
    int common = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) common += a[i] == b[k];
    return common;
}

/* The overlap of the two along `axis`, as a length; INFINITY when it is no direction. */
static double overlap(const double axis[3], const double a[3][3], const double b[3][3],
                      double shortest) {
    double length = lar_length(axis);
    if (!(length > shortest)) return INFINITY;
    double from[2] = {INFINITY, INFINITY}, to[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++) {
        double at[2] = {lar_dot(axis, a[k]), lar_dot(axis, b[k])};
        for (int s = 0; s < 2; s++) {
            if (at[s] < from[s]) from[s] = at[s];
            if (at[s] > to[s]) to[s] = at[s];
        }
    }
    return fmin(to[0] - from[1], to[1] - from[0]) / length;
}

double lar_triangle_overlap(const double a[3][3], const double b[3][3], double gap) {
    const double rounding = 1e-12; /* of their size */
    double e[3][3], f[3][3], square = 0;
    for (int k = 0; k < 3; k++) {
        lar_minus(a[(k + 1) % 3], a[k], e[k]);
        lar_minus(b[(k + 1) % 3], b[k], f[k]);
        square = fmax(square, fmax(lar_dot(a[k], a[k]), lar_dot(b[k], b[k])));
    }
    const double shortest = 1e-13 * square, apart = rounding * sqrt(square) - gap;
    double depth = INFINITY;
    for (int test = 0; test < 11 && depth > apart; test++) {
        double axis[3];
        if (test < 2)
            lar_cross(test ? f[0] : e[0], test ? f[1] : e[1], axis);
        else
            lar_cross(e[(test - 2) / 3], f[(test - 2) % 3], axis);
        depth = fmin(depth, overlap(axis, a, b, shortest));
    }
    return isfinite(depth) && depth > apart ? depth + gap : 0;
}

/* The same for two that lie on each other and look the same way, as the sides of two bodies do that
 * overlap: how far one must be moved within the plane. Bodies that touch look at each other. */
static double lying_depth(const double a[3][3], const double b[3][3]) {
    const double flat = 1e-6; /* of their size: what rounding to single precision leaves */
    double e[2][3], f[2][3], normal[3], other[3], square = 0, depth = INFINITY;
    for (int k = 0; k < 2; k++) {
        lar_minus(a[k + 1], a[k], e[k]);
        lar_minus(b[k + 1], b[k], f[k]);
    }
    lar_cross(e[0], e[1], normal);
    lar_cross(f[0], f[1], other);
    if (!(lar_dot(normal, other) > 0)) return 0;
    double lowest = 0, highest = 0;
    for (int k = 0; k < 3; k++) {
        double high[2] = {lar_dot(normal, a[k]), lar_dot(normal, b[k])};
        lowest = fmin(lowest, fmin(high[0], high[1]));
        highest = fmax(highest, fmax(high[0], high[1]));
        square = fmax(square, fmax(lar_dot(a[k], a[k]), lar_dot(b[k], b[k])));
    }
    if (highest - lowest > flat * sqrt(square) * lar_length(normal)) return 0;
    for (int k = 0; k < 3; k++) {
        double edge[3], axis[3];
        lar_minus(a[(k + 1) % 3], a[k], edge);
        lar_cross(normal, edge, axis);
        depth = fmin(depth, overlap(axis, a, b, 0));
        lar_minus(b[(k + 1) % 3], b[k], edge);
        lar_cross(normal, edge, axis);
        depth = fmin(depth, overlap(axis, a, b, 0));
    }
    return isfinite(depth) ? fmax(depth, 0) : 0;
}

/* ---- all pairs ---------------------------------------------------------------------------- */

typedef struct search {
    const lar_triangles *surface;
    int32_t triangle; /* the one that is compared with the others */
    double harmless;  /* depth [m] */
    lar_crossings *found;
} search;

static bool compare(void *context, int32_t other) {
    search *s = context;
    const int32_t *mine = s->surface->corner[s->triangle], *its = s->surface->corner[other];
    int common = common_corners(mine, its);
    if (other <= s->triangle || common == 2) return true;
    const double *origin = s->surface->vertex[mine[0]];
    double a[3][3], b[3][3];
    for (int k = 0; k < 3; k++) {
        lar_minus(s->surface->vertex[mine[k]], origin, a[k]);
        lar_minus(s->surface->vertex[its[k]], origin, b[k]);
    }
    double depth = lar_triangle_overlap((const double(*)[3])a, (const double(*)[3])b, 0),
           lying = lying_depth(a, b);
    if (lying > s->harmless) depth = fmax(depth, lying);
    if (depth == 0) return true;
    lar_crossings *found = s->found;
    if (depth > found->deepest) {
        found->deepest = depth;
        found->pair[0] = s->triangle;
        found->pair[1] = other;
    }
    if (depth > s->harmless)
        found->deep++;
    else if (found->shallow < INT32_MAX)
        found->shallow++;
    return found->deep < LAR_CROSSINGS_MAX;
}

static double mean_edge(const lar_triangles *triangles) {
    double sum = 0;
    for (int32_t t = 0; t < triangles->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            double edge[3];
            lar_minus(triangles->vertex[triangles->corner[t][(k + 1) % 3]],
                      triangles->vertex[triangles->corner[t][k]], edge);
            sum += lar_length(edge);
        }
    return triangles->triangle_count > 0 ? sum / 3 / triangles->triangle_count : 0;
}

lar_status lar_triangles_find_crossings(const lar_triangles *triangles, lar_crossings *crossings,
                                        lar_error *error) {
    lar_triangle_tree *tree = NULL;
    lar_status status = lar_triangle_tree_create(triangles, NULL, 0, &tree, error);
    if (status) return status;
    *crossings = (lar_crossings){0};
    search s = {.surface = triangles,
                .harmless = LAR_CROSSING_HARMLESS * mean_edge(triangles),
                .found = crossings};
    for (int32_t t = 0; t < triangles->triangle_count && crossings->deep < LAR_CROSSINGS_MAX; t++) {
        double lower[3], upper[3];
        for (int i = 0; i < 3; i++) {
            const int32_t *c = triangles->corner[t];
            double at[3];
            for (int a = 0; a < 3; a++) at[a] = triangles->vertex[c[a]][i];
            lower[i] = fmin(at[0], fmin(at[1], at[2]));
            upper[i] = fmax(at[0], fmax(at[1], at[2]));
        }
        s.triangle = t;
        lar_triangle_tree_boxes(tree, lower, upper, 0, compare, &s);
    }
    lar_triangle_tree_destroy(tree);
    return LAR_OK;
}

lar_status lar_triangles_check_crossing(const lar_triangles *triangles, lar_error *error) {
    lar_crossings found;
    lar_status status = lar_triangles_find_crossings(triangles, &found, error);
    if (status || found.deep == 0) return status;
    const double *at = triangles->vertex[triangles->corner[found.pair[0]][0]];
    return lar_fail(
        error, LAR_ERROR_MODEL,
        "%s: the surface goes through itself: %s%" PRId32
        " pair%s of triangles cross%s, the deepest by %.3g m near (%.6g, %.6g, %.6g) m; "
        "unite its parts or remake it in a mesh editor (Blender: remesh modifier; "
        "MeshLab: select self intersecting faces)",
        triangles->source ? triangles->source : "surface",
        found.deep == LAR_CROSSINGS_MAX ? "more than " : "", found.deep, found.deep == 1 ? "" : "s",
        found.deep == 1 ? "es" : "", found.deepest, at[0], at[1], at[2]);
}
