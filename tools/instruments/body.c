#include "body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/hexahedron.h"
#include "model/model.h"

/* ---- making -------------------------------------------------------------------------------- */

static void corners_of(const lar_body *body, const double (*x)[3], int32_t e, double corner[8][3]) {
    const int32_t *node = lar_model_element_nodes(body->model, e);
    for (int a = 0; a < 8; a++) memcpy(corner[a], x[node[a]], sizeof corner[a]);
}

/* What the edges at a corner span, up to a factor that a part of it at rest does not have. */
static double corner_jacobian(const double corner[8][3], int a) {
    static const int next[8][3] = {{1, 3, 4}, {0, 2, 5}, {3, 1, 6}, {2, 0, 7},
                                   {5, 7, 0}, {4, 6, 1}, {7, 5, 2}, {6, 4, 3}};
    double edge[3][3], cross[3];
    for (int i = 0; i < 3; i++) lar_minus(corner[next[a][i]], corner[a], edge[i]);
    lar_cross(edge[0], edge[1], cross);
    return lar_dot(cross, edge[2]);
}

/* The mean over the volume, as hex8 takes it. */
static void prepare_element(lar_body *body, int32_t e) {
    double corner[8][3], volume = 0, sum[8][3] = {{0}};
    corners_of(body, body->rest, e, corner);
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        double at[3], gradient[8][3];
        lar_gauss_point(g, at);
        double share = lar_hexahedron_gradients((const double(*)[3])corner, at, gradient);
        volume += share;
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) sum[a][i] += share * gradient[a][i];
    }
    for (int a = 0; a < 8; a++) {
        body->corner[e][a] = corner_jacobian((const double(*)[3])corner, a);
        for (int i = 0; i < 3; i++) body->gradient[e][a][i] = sum[a][i] / volume;
    }
}

static void mark(lar_body *body, const lar_node_list *nodes) {
    for (int32_t i = 0; i < nodes->count; i++) body->fixed[nodes->node[i]] = 1;
}

lar_status lar_body_create(const lar_model *model, lar_body *body, lar_error *error) {
    lar_model_info info;
    lar_status status = lar_model_inspect(model, &info, error);
    if (status) return status;
    *body = (lar_body){.nodes = info.nodes, .elements = info.elements, .model = model};
    body->rest = lar_model_positions(model);
    lar_model_surface(model, &body->surface);
    size_t nodes = (size_t)info.nodes, elements = (size_t)info.elements;
    size_t faces = (size_t)body->surface.faces;
    body->u = calloc(nodes, sizeof *body->u);
    body->x = calloc(nodes, sizeof *body->x);
    body->fixed = calloc(nodes, sizeof *body->fixed);
    body->middle = calloc(faces, sizeof *body->middle);
    body->extent = calloc(faces, sizeof *body->extent);
    body->gradient = calloc(elements, sizeof *body->gradient);
    body->corner = calloc(elements, sizeof *body->corner);
    if (!body->u || !body->x || !body->fixed || !body->middle || !body->extent || !body->gradient ||
        !body->corner) {
        lar_body_clear(body);
        return lar_fail_memory(error, elements * sizeof *body->gradient, "the body's elements");
    }
    for (int32_t e = 0; e < body->elements; e++) prepare_element(body, e);
    for (int i = 0; i < model->fix_count; i++) mark(body, &model->fix[i].nodes);
    for (int i = 0; i < model->move_count; i++) mark(body, &model->move[i].nodes);
    lar_body_look(body, NULL);
    memcpy(body->rest_lower, body->lower, sizeof body->lower);
    memcpy(body->rest_upper, body->upper, sizeof body->upper);
    double across[3];
    lar_minus(body->upper, body->lower, across);
    body->diagonal = lar_length(across);
    return LAR_OK;
}

void lar_body_clear(lar_body *body) {
    free(body->u);
    free(body->x);
    free(body->fixed);
    free(body->middle);
    free(body->extent);
    free(body->gradient);
    free(body->corner);
    *body = (lar_body){0};
}

/* ---- looking ------------------------------------------------------------------------------- */

void lar_body_look(lar_body *body, const lar_simulation *simulation) {
    if (simulation)
        lar_simulation_displacements(simulation, body->u);
    else
        memset(body->u, 0, (size_t)body->nodes * sizeof *body->u);
    for (int i = 0; i < 3; i++) body->lower[i] = INFINITY, body->upper[i] = -INFINITY;
    for (int32_t n = 0; n < body->nodes; n++)
        for (int i = 0; i < 3; i++) {
            body->x[n][i] = body->rest[n][i] + body->u[n][i];
            body->lower[i] = fmin(body->lower[i], body->x[n][i]);
            body->upper[i] = fmax(body->upper[i], body->x[n][i]);
        }
    for (int32_t f = 0; f < body->surface.faces; f++) {
        const int32_t *node = body->surface.face[f];
        double square = 0, *middle = body->middle[f];
        for (int i = 0; i < 3; i++) {
            middle[i] = 0;
            for (int a = 0; a < 4; a++) middle[i] += 0.25 * body->x[node[a]][i];
        }
        for (int a = 0; a < 4; a++) {
            double away[3];
            lar_minus(body->x[node[a]], middle, away);
            square = fmax(square, lar_dot(away, away));
        }
        body->extent[f] = sqrt(square);
    }
}

static double determinant(const double F[3][3]) {
    double cross[3];
    lar_cross(F[0], F[1], cross);
    return lar_dot(cross, F[2]);
}

lar_shape lar_body_shape(const lar_body *body) {
    lar_shape shape = {.min_volume = INFINITY, .min_corner = INFINITY};
    for (int32_t e = 0; e < body->elements; e++) {
        double corner[8][3], F[3][3] = {{0}}, worst = INFINITY;
        corners_of(body, (const double(*)[3])body->x, e, corner);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) F[i][j] += corner[a][i] * body->gradient[e][a][j];
        double volume = determinant((const double(*)[3])F);
        for (int a = 0; a < 8; a++) {
            double ratio = corner_jacobian((const double(*)[3])corner, a) / body->corner[e][a];
            if (!(ratio >= worst)) worst = ratio;
        }
        if (!(volume >= shape.min_volume)) shape.min_volume = volume;
        if (!(worst >= shape.min_corner)) shape.min_corner = worst;
        shape.inverted += !(volume > 0);
        shape.negative += !(worst > 0);
    }
    return shape;
}

double lar_body_farthest(const lar_body *body, const double (*before)[3]) {
    double square = 0;
    for (int32_t n = 0; n < body->nodes; n++) {
        double way[3];
        memcpy(way, body->u[n], sizeof way);
        if (before) lar_minus(way, before[n], way);
        square = fmax(square, lar_dot(way, way));
    }
    return sqrt(square);
}

/* ---- winding number ------------------------------------------------------------------------ */

/* The solid angle of a triangle is twice this one's argument (van Oosterom and Strackee 1983). */
static void triangle(const double a[3], const double b[3], const double c[3], double out[2]) {
    double cross[3], la = lar_length(a), lb = lar_length(b), lc = lar_length(c);
    lar_cross(b, c, cross);
    out[0] = la * lb * lc + lar_dot(a, b) * lc + lar_dot(b, c) * la + lar_dot(c, a) * lb;
    out[1] = lar_dot(a, cross);
}

static double angle_near(const double corner[4][3], const double middle[3]) {
    double sum = 0, part[2];
    for (int a = 0; a < 4; a++) {
        triangle(corner[a], corner[(a + 1) % 4], middle, part);
        sum += 2 * atan2(part[1], part[0]);
    }
    return sum;
}

/* From afar it does not matter how a face is cut into triangles, and no angle is large. */
static double angle_far(const double corner[4][3]) {
    double one[2], two[2];
    triangle(corner[0], corner[1], corner[2], one);
    triangle(corner[0], corner[2], corner[3], two);
    return 2 * atan2(one[0] * two[1] + one[1] * two[0], one[0] * two[0] - one[1] * two[1]);
}

double lar_body_winding(const lar_body *body, const double place[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++)
        if (!(place[i] >= body->lower[i] && place[i] <= body->upper[i])) return 0;
    for (int32_t f = 0; f < body->surface.faces; f++) {
        double corner[4][3], middle[3];
        for (int a = 0; a < 4; a++) lar_minus(body->x[body->surface.face[f][a]], place, corner[a]);
        lar_minus(body->middle[f], place, middle);
        bool far = lar_dot(middle, middle) > 4 * body->extent[f] * body->extent[f];
        sum += far ? angle_far((const double(*)[3])corner)
                   : angle_near((const double(*)[3])corner, middle);
    }
    return sum / (4 * acos(-1));
}

/* ---- where to begin ------------------------------------------------------------------------ */

void lar_body_face(const lar_body *body, int32_t face, double middle[3], double normal[3]) {
    const int32_t *node = body->surface.face[face];
    double across[2][3];
    memcpy(middle, body->middle[face], 3 * sizeof *middle);
    lar_minus(body->x[node[2]], body->x[node[0]], across[0]);
    lar_minus(body->x[node[3]], body->x[node[1]], across[1]);
    lar_cross(across[0], across[1], normal);
    double length = lar_length(normal);
    for (int i = 0; i < 3; i++) normal[i] /= length;
}

/* The square of the distance to the nearest held node. */
static double from_held(const lar_body *body, int32_t face) {
    double min = INFINITY;
    for (int32_t n = 0; n < body->nodes; n++) {
        double away[3];
        if (!body->fixed[n]) continue;
        lar_minus(body->middle[face], body->rest[n], away);
        min = fmin(min, lar_dot(away, away));
    }
    return min;
}

int32_t lar_body_extreme(const lar_body *body, const double direction[3]) {
    static const double NEAR = 0.1; /* of the diagonal */
    int32_t best = 0;
    bool best_free = false;
    double farthest = -INFINITY, limit = NEAR * body->diagonal;
    for (int32_t f = 0; f < body->surface.faces; f++) {
        double far = lar_dot(body->middle[f], direction), held = from_held(body, f);
        bool clear = held > limit * limit;
        if (!(held > body->extent[f] * body->extent[f] * 1.01) || (best_free && !clear)) continue;
        if (far <= farthest && clear == best_free) continue;
        farthest = far;
        best_free = clear;
        best = f;
    }
    return best;
}

/* Where a line meets a triangle, or -1 (Moeller and Trumbore 1997). */
static double meet(const double from[3], const double along[3], const double a[3],
                   const double b[3], const double c[3]) {
    double edge[2][3], p[3], q[3], t[3];
    lar_minus(b, a, edge[0]);
    lar_minus(c, a, edge[1]);
    lar_cross(along, edge[1], p);
    double det = lar_dot(edge[0], p);
    if (det == 0) return -1;
    lar_minus(from, a, t);
    double u = lar_dot(t, p) / det;
    lar_cross(t, edge[0], q);
    double v = lar_dot(along, q) / det;
    return u < 0 || v < 0 || u + v > 1 ? -1 : lar_dot(edge[1], q) / det;
}

double lar_body_beyond(const lar_body *body, const double place[3], const double direction[3]) {
    double farthest = 0;
    for (int32_t f = 0; f < body->surface.faces; f++)
        for (int a = 0; a < 4; a++) {
            const int32_t *node = body->surface.face[f];
            farthest = fmax(farthest, meet(place, direction, body->x[node[a]],
                                           body->x[node[(a + 1) % 4]], body->middle[f]));
        }
    return farthest;
}
