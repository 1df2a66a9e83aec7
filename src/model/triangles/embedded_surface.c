/* Binds by the trilinear map of the element around a vertex, inverted with Newton's method. A
 * vertex outside of all elements goes on linearly from the nearest point of the boundary: with the
 * shape functions N_a and the Jacobian J of the nearest element at that point xi_0, place x_0,
 *
 *     w_a = N_a(xi_0) + grad N_a(xi_0) . J^-1 (x - x_0)
 *
 * The weights sum to 1 and give x exactly, as trilinear ones beyond -1..1 would, but they grow with
 * the distance and not with its cube, so a strained element throws nothing about.
 */
#include "model/triangles/embedded_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "model/triangles/surface_tree.h"

/* Vertices farther from the body than so many mean edges are another body's. */
static const double REACH = 2;
/* Natural coordinates up to so much beyond an element are inside: rounding on shared faces. */
static const double OUTER = 1e-6;
/* What no element holds and the boundary is far from, in the gap that a twisted element leaves, is
 * bound to an element up to so much beyond it. */
static const double ASIDE = 1.5;
/* A Jacobian of less than this part of a box with the same edges is no base to go on from. */
static const double FLAT = 1e-3;

/* ---- the element ---------------------------------------------------------------------------- */

static void shape_functions(const double xi[3], double n[8], double slope[8][3]) {
    for (int a = 0; a < 8; a++) {
        double f[3];
        for (int i = 0; i < 3; i++) f[i] = 0.5 * (1 + lar_node_sign[a][i] * xi[i]);
        n[a] = f[0] * f[1] * f[2];
        slope[a][0] = 0.5 * lar_node_sign[a][0] * f[1] * f[2];
        slope[a][1] = 0.5 * lar_node_sign[a][1] * f[2] * f[0];
        slope[a][2] = 0.5 * lar_node_sign[a][2] * f[0] * f[1];
    }
}

static double determinant(const double j[3][3]) {
    return j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) +
           j[0][1] * (j[1][2] * j[2][0] - j[1][0] * j[2][2]) +
           j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
}

/* The place of xi, dx_i/dxi_j there, and how far that is from flat: 1 for a box, <= 0 bad. */
static double locate(const double corner[8][3], const double n[8], const double slope[8][3],
                     double place[3], double j[3][3]) {
    double product = 1;
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int k = 0; k < 3; k++) j[i][k] = 0;
        for (int a = 0; a < 8; a++) {
            place[i] += n[a] * corner[a][i];
            for (int k = 0; k < 3; k++) j[i][k] += slope[a][k] * corner[a][i];
        }
    }
    for (int k = 0; k < 3; k++) product *= hypot(hypot(j[0][k], j[1][k]), j[2][k]);
    return product > 0 ? determinant((const double(*)[3])j) / product : 0;
}

/* j d = r by Cramer's rule. */
static void solve(const double j[3][3], const double r[3], double d[3]) {
    double det = determinant(j);
    for (int k = 0; k < 3; k++) {
        double changed[3][3];
        memcpy(changed, j, sizeof changed);
        for (int i = 0; i < 3; i++) changed[i][k] = r[i];
        d[k] = determinant((const double(*)[3])changed) / det;
    }
}

static double largest(const double xi[3]) {
    return fmax(fabs(xi[0]), fmax(fabs(xi[1]), fabs(xi[2])));
}

/* Natural coordinates of a point, beginning at the centre. False when there is no way to them: far
 * outside, or a twisted element. */
static bool invert(const double corner[8][3], const double point[3], double xi[3]) {
    xi[0] = xi[1] = xi[2] = 0;
    for (int round = 0; round < 20; round++) {
        double n[8], slope[8][3], place[3], j[3][3], miss[3], step[3];
        shape_functions(xi, n, slope);
        if (!(locate(corner, n, (const double(*)[3])slope, place, j) > 0)) return false;
        for (int i = 0; i < 3; i++) miss[i] = point[i] - place[i];
        solve((const double(*)[3])j, miss, step);
        for (int i = 0; i < 3; i++) xi[i] += step[i];
        if (largest(step) < 1e-13) return true;
        if (!(largest(xi) < 4)) return false;
    }
    return largest(xi) < 4;
}

/* Weights that go on linearly from `from`; where the element is too flat there, from its corner
 * that is least so (lar_mesh_check: every corner's Jacobian is positive). */
static void weigh(const double corner[8][3], const double from[3], const double point[3],
                  double weight[8]) {
    double n[8], slope[8][3], place[3], j[3][3], miss[3], step[3], best[3], good;
    memcpy(best, from, sizeof best);
    shape_functions(best, n, slope);
    good = locate(corner, n, (const double(*)[3])slope, place, j);
    for (int a = 0; good < FLAT && a < 8; a++) {
        double other[3];
        for (int i = 0; i < 3; i++) other[i] = lar_node_sign[a][i];
        shape_functions(other, n, slope);
        double here = locate(corner, n, (const double(*)[3])slope, place, j);
        if (here <= good) continue;
        good = here;
        memcpy(best, other, sizeof best);
    }
    shape_functions(best, n, slope);
    locate(corner, n, (const double(*)[3])slope, place, j);
    for (int i = 0; i < 3; i++) miss[i] = point[i] - place[i];
    solve((const double(*)[3])j, miss, step);
    for (int a = 0; a < 8; a++)
        weight[a] = n[a] + slope[a][0] * step[0] + slope[a][1] * step[1] + slope[a][2] * step[2];
}

/* ---- finding elements ----------------------------------------------------------------------- */

typedef struct binder {
    const lar_mesh *mesh;
    double mean_edge;
    /* The tree knows boxes of triangles: one per element stands for the element's box. */
    lar_triangles boxes;
    lar_triangle_tree *box_tree;
    lar_surface_tree outer;
    lar_embedded_surface *embedded; /* that is made */
    double *outside;                /* [vertices] distance from the body; 0 in it */
} binder;

static void binder_clear(binder *b) {
    lar_triangle_tree_destroy(b->box_tree);
    lar_triangles_clear(&b->boxes);
    lar_surface_tree_clear(&b->outer);
    free(b->outside);
}

/* A triangle with the same box as the element: from its lower corner to its upper one and back by
 * a third corner of the box. */
static lar_status make_boxes(binder *b, lar_error *error) {
    const lar_mesh *mesh = b->mesh;
    size_t count = (size_t)mesh->element_count;
    if (mesh->element_count > INT32_MAX / 3)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "a surface can ride on %ld elements at most; this mesh has %ld",
                        (long)(INT32_MAX / 3), (long)mesh->element_count);
    b->boxes.vertex = lar_calloc(3 * count, sizeof *b->boxes.vertex);
    b->boxes.corner = lar_calloc(count, sizeof *b->boxes.corner);
    if (!b->boxes.vertex || !b->boxes.corner)
        return lar_fail_memory(error, 84 * count, "the boxes of elements");
    b->boxes.vertex_count = 3 * mesh->element_count;
    b->boxes.triangle_count = mesh->element_count;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double(*v)[3] = b->boxes.vertex + 3 * (size_t)e, corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        for (int i = 0; i < 3; i++) {
            v[0][i] = v[1][i] = corner[0][i];
            for (int a = 1; a < 8; a++) {
                v[0][i] = fmin(v[0][i], corner[a][i]);
                v[1][i] = fmax(v[1][i], corner[a][i]);
            }
            v[2][i] = v[i == 0][i];
            b->boxes.corner[e][i] = 3 * e + i;
        }
    }
    return lar_triangle_tree_create(&b->boxes, NULL, mesh->element_count, &b->box_tree, error);
}

typedef struct search {
    const binder *binder;
    const double *point;
    int32_t element; /* -1: none so far */
    double out;      /* largest natural coordinate there */
    double xi[3];
} search;

/* Keeps the element in which the point lies deepest; on shared faces the first one. */
static bool try_element(void *context, int32_t element) {
    search *s = context;
    double corner[8][3], xi[3];
    lar_mesh_corners(s->binder->mesh, element, corner);
    if (!invert((const double(*)[3])corner, s->point, xi)) return true;
    double out = fmax(largest(xi), 1 - OUTER);
    if (s->element >= 0 && (out > s->out || (out == s->out && element > s->element))) return true;
    s->element = element;
    s->out = out;
    memcpy(s->xi, xi, sizeof xi);
    return true;
}

/* ---- binding -------------------------------------------------------------------------------- */

static lar_status refuse_far(const binder *b, const lar_triangles *surface, int32_t vertex,
                             lar_error *error) {
    const double *p = surface->vertex[vertex];
    lar_nearest nearest;
    double distance = NAN;
    if (lar_triangle_tree_nearest(b->outer.tree, p, INFINITY, &nearest))
        distance = nearest.distance;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: the vertex at (%g, %g, %g) m lies %.3g m from the mesh, farther than "
                    "two of its mean edges (%.3g m each); is it the surface of another body, or "
                    "in another unit (scale)?",
                    surface->source ? surface->source : "the surface", p[0], p[1], p[2], distance,
                    b->mean_edge);
}

static lar_status refuse(const binder *b, const lar_triangles *surface, int32_t vertex,
                         lar_error *error) {
    const double *p = surface->vertex[vertex];
    if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))
        return refuse_far(b, surface, vertex, error);
    return lar_fail(error, LAR_ERROR_MODEL, "%s: vertex %ld is not finite",
                    surface->source ? surface->source : "the surface", (long)vertex);
}

/* The element of one vertex and its weights; -1: none is near. Returns how far it lies outside. */
static double bind_vertex(const binder *b, int32_t vertex) {
    lar_embedded_surface *embedded = b->embedded;
    const double *point = embedded->surface.vertex[vertex];
    double outside = 0;
    embedded->element[vertex] = -1;
    if (!isfinite(point[0]) || !isfinite(point[1]) || !isfinite(point[2])) return 0;
    search s = {.binder = b, .point = point, .element = -1};
    lar_triangle_tree_boxes(b->box_tree, point, point, OUTER * b->mean_edge, try_element, &s);
    lar_nearest nearest;
    if ((s.element < 0 || s.out > 1 + OUTER) &&
        lar_triangle_tree_nearest(b->outer.tree, point, REACH * b->mean_edge, &nearest)) {
        int32_t face = b->outer.face[nearest.triangle / 2];
        s.element = face / 6;
        for (int i = 0; i < 3; i++) s.xi[i] = 0;
        for (int c = 0; c < 3; c++) {
            const int8_t *sign =
                lar_node_sign[lar_face_node[face % 6][c == 0 ? 0 : c + nearest.triangle % 2]];
            for (int i = 0; i < 3; i++) s.xi[i] += nearest.weight[c] * sign[i];
        }
        s.out = 1;
        outside = nearest.distance;
    }
    if (s.element < 0 || s.out > ASIDE) return 0;
    for (int i = 0; i < 3; i++) s.xi[i] = fmax(-1, fmin(1, s.xi[i]));
    double corner[8][3], weight[8];
    lar_mesh_corners(b->mesh, s.element, corner);
    weigh((const double(*)[3])corner, s.xi, point, weight);
    embedded->element[vertex] = s.element;
    for (int a = 0; a < 8; a++) embedded->weight[vertex][a] = (float)weight[a];
    return outside;
}

static void bind_some(void *context, int32_t first, int32_t end) {
    const binder *b = context;
    for (int32_t v = first; v < end; v++) b->outside[v] = bind_vertex(b, v);
}

/* The first vertex that nothing is near is the one that is told. */
static lar_status bind_all(binder *b, lar_error *error) {
    enum { PORTION = 1024 };
    lar_embedded_surface *embedded = b->embedded;
    const int32_t vertices = embedded->surface.vertex_count;
    b->outside = lar_calloc((size_t)vertices, sizeof *b->outside);
    if (!b->outside) return lar_fail_memory(error, 8 * (size_t)vertices, "an embedded surface");
    lar_parallel_for(vertices, PORTION, bind_some, b);
    for (int32_t v = 0; v < vertices; v++) {
        if (embedded->element[v] < 0) return refuse(b, &embedded->surface, v, error);
        embedded->farthest = fmax(embedded->farthest, b->outside[v]);
    }
    return LAR_OK;
}

lar_status lar_embedded_surface_bind(const lar_mesh *mesh, lar_triangles *surface,
                                     lar_embedded_surface *embedded, lar_error *error) {
    *embedded = (lar_embedded_surface){.surface = *surface};
    *surface = (lar_triangles){0};
    size_t vertices = (size_t)embedded->surface.vertex_count;
    binder b = {.mesh = mesh, .mean_edge = lar_mesh_mean_edge(mesh), .embedded = embedded};
    embedded->element = lar_calloc(vertices, sizeof *embedded->element);
    embedded->weight = lar_calloc(vertices, sizeof *embedded->weight);
    lar_status status = LAR_OK;
    if (!embedded->element || !embedded->weight)
        status = lar_fail_memory(error, 36 * vertices, "an embedded surface");
    if (!status) status = make_boxes(&b, error);
    if (!status) status = lar_surface_tree_create(mesh, &b.outer, error);
    if (!status) status = bind_all(&b, error);
    binder_clear(&b);
    if (status) lar_embedded_surface_clear(embedded);
    return status;
}

void lar_embedded_surface_clear(lar_embedded_surface *embedded) {
    lar_triangles_clear(&embedded->surface);
    free(embedded->element);
    free(embedded->weight);
    *embedded = (lar_embedded_surface){0};
}

/* ---- moving --------------------------------------------------------------------------------- */

/* From the place at rest by the mean of the nodes' movements, so that rounding of the weights does
 * not show at rest, wherever the body lies. */
void lar_embedded_surface_move(const lar_embedded_surface *embedded, const lar_mesh *mesh,
                               const double (*u)[3], double (*place)[3]) {
    for (int32_t v = 0; v < embedded->surface.vertex_count; v++) {
        memcpy(place[v], embedded->surface.vertex[v], sizeof place[v]);
        const int32_t *node = mesh->element[embedded->element[v]];
        for (int a = 0; u && a < 8; a++)
            for (int i = 0; i < 3; i++)
                place[v][i] += (double)embedded->weight[v][a] * u[node[a]][i];
    }
}
