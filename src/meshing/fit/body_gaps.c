#include "meshing/fit/body_gaps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/face_contact.h"
#include "meshing/fit/face_boxes.h"
#include "meshing/fit/work.h"

/* Between surfaces, and how far in each other they are looked for [size]. */
static const double GAP = 0.02, DEEP = 0.5;
/* Part of the gap that may be missing in the end. */
static const double ENOUGH = 0.25;
static const double JACOBIAN_MIN = 0.2;

enum {
    ROUNDS = 40,
    BODIES = 8, /* others that one point may be near */
    /* Where a face is compared with others, as contact will do it (contact/contact_edges.c): at
       corners, four points of each side and four between; and in the middle. */
    SIDE = 4,
    POINTS = 4 * (SIDE + 2) + 1
};

typedef struct gaps {
    lar_mesh *mesh;
    double size;
    int32_t *outer, count;   /* faces, element * 6 + local face */
    int32_t (*face)[4];      /* [count] their nodes */
    int32_t *body;           /* [nodes] its least node */
    int32_t *start, *around; /* corners of elements around each node, element * 8 + local node */
    double (*move)[3];       /* [nodes] */
    double weight[POINTS][4];
    lar_face_boxes boxes;
    double worst; /* of the gap is missing [m] */
} gaps;

static void gaps_clear(gaps *g) {
    free(g->outer);
    free(g->face);
    free(g->body);
    free(g->start);
    free(g->around);
    free(g->move);
    lar_face_boxes_clear(&g->boxes);
}

static void lay_points(double weight[POINTS][4]) {
    int p = 0;
    for (int a = 0; a < 4; a++) {
        weight[p++][a] = 1;
        for (int k = 0; k < SIDE; k++, p++) {
            weight[p][a] = 1 - (k + 0.5) / SIDE;
            weight[p][(a + 1) & 3] = (k + 0.5) / SIDE;
        }
        lar_face_weights(a % 2 ? 0.5 : -0.5, a / 2 ? 0.5 : -0.5, weight[p++]);
    }
    for (int c = 0; c < 4; c++) weight[p][c] = 0.25;
}

static lar_status gaps_create(gaps *g, lar_error *error) {
    const lar_mesh *mesh = g->mesh;
    const size_t nodes = (size_t)mesh->node_count;
    lar_status status = lar_mesh_boundary(mesh, &g->outer, &g->count, error);
    if (status) return status;
    g->face = lar_calloc((size_t)g->count, sizeof *g->face);
    g->body = lar_calloc(nodes, sizeof *g->body);
    g->move = lar_calloc(nodes, sizeof *g->move);
    if (!g->face || !g->body || !g->move ||
        !lar_fit_list_around(mesh->element[0], 8, (size_t)mesh->element_count, 8, mesh->node_count,
                             &g->start, &g->around))
        return lar_fail_memory(error, 96 * nodes, "the gaps between bodies");
    for (int32_t f = 0; f < g->count; f++)
        for (int a = 0; a < 4; a++)
            g->face[f][a] = mesh->element[g->outer[f] / 6][lar_face_node[g->outer[f] % 6][a]];
    lar_mesh_bodies(mesh, g->body);
    lay_points(g->weight);
    return LAR_OK;
}

static int32_t body_of(const gaps *g, int32_t face) {
    return g->body[g->face[face][0]];
}

static void corners_of(const gaps *g, int32_t face, double corner[4][3]) {
    for (int a = 0; a < 4; a++)
        memcpy(corner[a], g->mesh->position[g->face[face][a]], sizeof corner[a]);
}

/* ---- what is too near ------------------------------------------------------------------------ */

/* The face of a body that is closest to a point. */
typedef struct closest {
    int32_t body, face;
    lar_face_point point;
} closest;

/* A face, and for each of its points what is closest of every other body. */
typedef struct look {
    const gaps *gaps;
    int32_t face, body;
    double x[POINTS][3];
    closest found[POINTS][BODIES];
    int count[POINTS];
} look;

static void compare(look *l, int p, const closest *candidate, double tie) {
    int i = 0;
    while (i < l->count[p] && l->found[p][i].body != candidate->body) i++;
    if (i == BODIES) return;
    closest *kept = &l->found[p][i];
    const double less = kept->point.distance - candidate->point.distance;
    if (i == l->count[p])
        l->count[p]++;
    else if (!(less > tie ||
               (less > -tie && lar_face_point_before(&candidate->point, &kept->point))))
        return;
    *kept = *candidate;
}

static bool look_at(void *context, int32_t other) {
    look *l = context;
    const gaps *g = l->gaps;
    closest candidate = {.body = body_of(g, other), .face = other};
    if (candidate.body == l->body) return true;
    double corner[4][3];
    corners_of(g, other, corner);
    const double tie = LAR_FACE_TIE * g->size;
    for (int p = 0; p < POINTS; p++) {
        lar_face_closest(l->x[p], (const double(*)[3])corner, tie, &candidate.point);
        if (candidate.point.distance < DEEP * g->size) compare(l, p, &candidate, tie);
    }
    return true;
}

/* The longest that was asked for. */
static void ask(gaps *g, int32_t node, const double way[3], double length) {
    double move[3];
    for (int i = 0; i < 3; i++) move[i] = length * way[i];
    if (lar_dot(move, move) > lar_dot(g->move[node], g->move[node]))
        memcpy(g->move[node], move, sizeof move);
}

/* Half of what is missing is the one's to move, and half the other's. */
static void part_point(gaps *g, const look *l, int p, const closest *from) {
    double corner[4][3], way[3], square[2] = {0};
    const lar_face_point *point = &from->point;
    const double sign = point->height < 0 ? -1 : 1;
    const double missing = GAP * g->size - sign * point->distance;
    if (!(missing > 0)) return;
    corners_of(g, from->face, corner);
    memcpy(way, l->x[p], sizeof way);
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) way[i] -= point->weight[a] * corner[a][i];
    if (point->distance > 1e-6 * g->size)
        for (int i = 0; i < 3; i++) way[i] *= sign / point->distance;
    else
        lar_face_normal((const double(*)[3])corner, way);
    for (int a = 0; a < 4; a++) {
        square[0] += g->weight[p][a] * g->weight[p][a];
        square[1] += point->weight[a] * point->weight[a];
    }
    for (int a = 0; a < 4; a++) {
        ask(g, g->face[l->face][a], way, 0.5 * missing * g->weight[p][a] / square[0]);
        ask(g, g->face[from->face][a], way, -0.5 * missing * point->weight[a] / square[1]);
    }
    g->worst = fmax(g->worst, missing);
}

static void part_face(gaps *g, int32_t face) {
    double corner[4][3];
    look l = {.gaps = g, .face = face, .body = body_of(g, face)};
    corners_of(g, face, corner);
    for (int p = 0; p < POINTS; p++)
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 4; a++) l.x[p][i] += g->weight[p][a] * corner[a][i];
    lar_face_boxes_near(&g->boxes, face, DEEP * g->size, look_at, &l);
    for (int p = 0; p < POINTS; p++)
        for (int i = 0; i < l.count[p]; i++) part_point(g, &l, p, &l.found[p][i]);
}

/* ---- moving ---------------------------------------------------------------------------------- */

static double worst_around(const gaps *g, int32_t node) {
    double worst = 1, corner[8][3];
    for (int32_t i = g->start[node]; i < g->start[node + 1]; i++) {
        lar_mesh_corners(g->mesh, g->around[i] / 8, corner);
        worst = fmin(worst, lar_scaled_jacobian((const double(*)[3])corner));
    }
    return worst;
}

/* By part of what was asked for. */
static void move_node(gaps *g, int32_t node, double part) {
    enum { HALVINGS = 3 };
    double *x = g->mesh->position[node], before[3];
    const double floor = fmin(JACOBIAN_MIN, worst_around(g, node));
    memcpy(before, x, sizeof before);
    for (int half = 0; half <= HALVINGS; half++) {
        for (int i = 0; i < 3; i++) x[i] = before[i] + part * ldexp(g->move[node][i], -half);
        if (worst_around(g, node) >= floor) return;
    }
    memcpy(x, before, sizeof before);
}

/* In narrow places one wall asks for what the other one takes back: later rounds do half of it. */
static lar_status part_all(gaps *g, int round, lar_error *error) {
    const lar_mesh *mesh = g->mesh;
    memset(g->move, 0, (size_t)mesh->node_count * sizeof *g->move);
    g->worst = 0;
    lar_face_boxes_clear(&g->boxes);
    lar_status status =
        lar_face_boxes_create((const double(*)[3])mesh->position, (const int32_t(*)[4])g->face,
                              g->count, &g->boxes, error);
    for (int32_t f = 0; !status && f < g->count; f++) part_face(g, f);
    for (int32_t n = 0; !status && n < mesh->node_count; n++)
        if (lar_dot(g->move[n], g->move[n]) > 0) move_node(g, n, round < ROUNDS / 4 ? 1 : 0.5);
    return status;
}

lar_status lar_body_gaps_open(lar_mesh *mesh, double size, lar_error *error) {
    gaps g = {.mesh = mesh, .size = size};
    lar_status status = gaps_create(&g, error);
    for (int round = 0; !status && round < ROUNDS; round++) {
        status = part_all(&g, round, error);
        if (!(g.worst > ENOUGH * GAP * size)) break;
    }
    gaps_clear(&g);
    return status;
}
