#include "step/rigid/firm.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/contact_surface.h"
#include "mechanics/contact.h"
#include "step/rigid/free_body.h"

enum { MOTIONS = 6 };

/* ---- the body -------------------------------------------------------------------------------- */

/* Of all nodes that the entry moves, at rest. */
static void sum_at_rest(const lar_domain *domain, const lar_move *move, const lar_tool *tool,
                        lar_rigid_sum *sum) {
    const lar_node_list *nodes = &move->nodes;
    double all[3] = {0};
    *sum = (lar_rigid_sum){0};
    for (int32_t k = 0; k < nodes->count; k++) {
        const double mass = domain->mass[domain->layout.local[nodes->node[k]]];
        sum->mass += mass;
        for (int i = 0; i < 3; i++)
            all[i] += mass * domain->model->mesh.position[nodes->node[k]][i];
    }
    for (int i = 0; i < 3; i++)
        sum->centre[i] = tool->free & LAR_AXIS_ALL ? all[i] / sum->mass : tool->point[i];
    for (int32_t k = 0; k < nodes->count; k++) {
        const double mass = domain->mass[domain->layout.local[nodes->node[k]]];
        double r[3];
        lar_minus(domain->model->mesh.position[nodes->node[k]], sum->centre, r);
        for (int i = 0; i < 3; i++) {
            sum->inertia[i] += mass * (lar_dot(r, r) - r[i] * r[i]);
            sum->inertia[3 + i] -= mass * r[i] * r[(i + 1) % 3];
        }
    }
}

/* ---- its surface ----------------------------------------------------------------------------- */

/* What a corner of a face adds, pushed along the face's normal: as much of the node's mass as the
 * face has of the surface around it that looks one way. */
static void add_corner(const lar_contact_surface *s, const lar_contact_face *face, int a,
                       const double normal[3], const double centre[3],
                       double sum[MOTIONS][MOTIONS]) {
    const lar_contact_node *node = &s->node[face->corner[a]];
    const double area = lar_length(normal), mass = node->mass * (0.125 * area) / node->area;
    double r[3], g[MOTIONS];
    if (!(mass > 0) || !isfinite(mass)) return;
    for (int i = 0; i < 3; i++) g[i] = normal[i] / area;
    lar_minus(s->rest[face->corner[a]], centre, r);
    lar_cross(r, g, &g[3]);
    for (int i = 0; i < MOTIONS; i++)
        for (int k = 0; k < MOTIONS; k++) sum[i][k] += mass * g[i] * g[k];
}

/* With the corners' nodes that are bound. */
static void sum_pushes(const lar_contact_surface *s, const lar_rigid_sum *body,
                       double sum[MOTIONS][MOTIONS]) {
    for (int32_t f = 0; f < s->face_count; f++) {
        const lar_contact_face *face = &s->face[f];
        double x[4][3], normal[3];
        for (int a = 0; a < 4; a++) memcpy(x[a], s->rest[face->corner[a]], sizeof x[a]);
        lar_face_normal((const double(*)[3])x, normal);
        for (int a = 0; a < 4; a++)
            if (s->node[face->corner[a]].bound < 0)
                add_corner(s, face, a, normal, body->centre, sum);
    }
}

/* Through the inverse of the body's mass and inertia: zero where it is not free. */
static void divide_by_body(const lar_rigid_sum *body, const lar_tool *tool,
                           double sum[MOTIONS][MOTIONS]) {
    double yields[6];
    lar_rigid_sum_yields(body, tool, yields);
    for (int k = 0; k < MOTIONS; k++) {
        double turn[3], turned[3];
        for (int i = 0; i < 3; i++) turn[i] = sum[3 + i][k];
        lar_symmetric_product(yields, turn, turned);
        for (int i = 0; i < 3; i++) {
            sum[i][k] = tool->free >> i & 1 ? sum[i][k] / body->mass : 0;
            sum[3 + i][k] = turned[i];
        }
    }
}

static double trace(const double a[MOTIONS][MOTIONS]) {
    double sum = 0;
    for (int i = 0; i < MOTIONS; i++) sum += a[i][i];
    return sum;
}

/* No less than its largest eigenvalue, which is positive, as all are. */
static double largest(double a[MOTIONS][MOTIONS]) {
    enum { TWICE = 4 };
    const double size = trace(a);
    if (!(size > 0)) return 0;
    for (int i = 0; i < MOTIONS * MOTIONS; i++) a[i / MOTIONS][i % MOTIONS] /= size;
    for (int n = 0; n < TWICE; n++) {
        double square[MOTIONS][MOTIONS] = {{0}};
        for (int i = 0; i < MOTIONS; i++)
            for (int k = 0; k < MOTIONS; k++)
                for (int j = 0; j < MOTIONS; j++) square[i][k] += a[i][j] * a[j][k];
        memcpy(a, square, sizeof square);
    }
    double root = trace((const double(*)[MOTIONS])a);
    for (int n = 0; n < TWICE; n++) root = sqrt(root); /* the same bits everywhere */
    return size * root;
}

/* ---- all of them ----------------------------------------------------------------------------- */

/* The first contact node that is no node of the model before `node`. */
static int32_t first_from(const lar_contact_surface *s, int32_t node) {
    int32_t low = 0, high = s->node_count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (s->node[middle].node < node)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Marks the contact nodes of a body: with -1, until it is known how heavy they are. */
static int32_t mark(const lar_move *move, lar_contact_surface *s) {
    int32_t count = 0;
    for (int32_t k = 0; k < move->nodes.count; k++) {
        const int32_t n = first_from(s, move->nodes.node[k]);
        if (n == s->node_count || s->node[n].node != move->nodes.node[k]) continue;
        s->node[n].bound = -1;
        count++;
    }
    return count;
}

/* Points of edges are bound as little as their nodes. */
static void bind_points(lar_contact_surface *s) {
    for (int32_t n = s->node_count; n < s->point_count; n++) {
        const lar_contact_point *point = &s->point[n - s->node_count];
        float bound = s->node[point->node[0]].bound;
        for (int i = 1; i < point->count; i++)
            bound = s->node[point->node[i]].bound < bound ? s->node[point->node[i]].bound : bound;
        s->node[n].bound = bound;
    }
}

/* Of a unit push at a corner; no less than what all of the mass yields, also where a joint bears
 * the push. */
static double yield_at(const lar_rigid_sum *body, const lar_tool *tool, const double yields[6],
                       const double place[3], const double normal[3]) {
    double r[3], turn[3], turned[3], yield = 0;
    lar_minus(place, body->centre, r);
    lar_cross(r, normal, turn);
    lar_symmetric_product(yields, turn, turned);
    for (int i = 0; i < 3; i++)
        if (tool->free >> i & 1) yield += normal[i] * normal[i] / body->mass;
    return lar_greater(yield + lar_dot(turn, turned), 1 / body->mass);
}

/* A tool begins to push where it touches, with the closest point of the face: rigid bodies do not
 * take the shape of what presses on them. */
static void make_firm(const lar_rigid_sum *body, const lar_tool *tool, int32_t index,
                      lar_tool_contact_face *face) {
    static const double WALL = 0.002;
    double yields[6], normal[3];
    lar_rigid_sum_yields(body, tool, yields);
    lar_face_normal((const double(*)[3])face->rest, normal);
    const double area = lar_length(normal);
    if (!(area > 0)) return;
    for (int i = 0; i < 3; i++) normal[i] /= area;
    face->wall = WALL;
    face->body = index;
    for (int a = 0; a < 4; a++)
        face->yields[a] = yield_at(body, tool, yields, face->rest[a], normal);
}

lar_status lar_free_bodies_yield(const lar_domain *domain, lar_tool_faces *faces,
                                 lar_error *error) {
    const lar_model *model = domain->model;
    const size_t nodes = (size_t)model->mesh.node_count;
    if (faces->face_count == 0 || !lar_free_bodies_any(model)) return LAR_OK;
    uint8_t *of = lar_calloc(nodes, sizeof *of); /* the tool that moves a node, and one */
    if (!of) return lar_fail_memory(error, nodes, "free bodies");
    for (int m = 0; m < model->move_count; m++) {
        const lar_move *move = &model->move[m];
        const int32_t index = move->tool - 1;
        lar_rigid_sum body;
        if (!move->tool || !model->tool[index].free) continue;
        sum_at_rest(domain, move, &model->tool[index], &body);
        faces->heavy[index] = body.mass;
        for (int32_t k = 0; k < move->nodes.count; k++)
            of[move->nodes.node[k]] = (uint8_t)move->tool;
        for (int32_t f = 0; f < faces->face_count; f++) {
            const int32_t *corner = model->surface.corner[faces->face[f].of];
            bool all = true;
            for (int a = 0; a < 4; a++) all = all && of[corner[a]] == move->tool;
            if (all) make_firm(&body, &model->tool[index], index, &faces->face[f]);
            faces->weighs = faces->weighs || all;
        }
    }
    free(of);
    return LAR_OK;
}

void lar_free_bodies_firm(const lar_domain *domain, lar_contact_surface *s) {
    static const double MOST = 64;
    const lar_model *model = domain->model;
    bool any = false;
    for (int m = 0; m < model->move_count && s->node_count > 0; m++) {
        const lar_move *move = &model->move[m];
        const lar_tool *tool = move->tool ? &model->tool[move->tool - 1] : NULL;
        double sum[MOTIONS][MOTIONS] = {{0}};
        lar_rigid_sum body;
        if (!tool || !tool->free || mark(move, s) == 0) continue;
        sum_at_rest(domain, move, tool, &body);
        sum_pushes(s, &body, sum);
        divide_by_body(&body, tool, sum);
        const double most = fmin(1 / largest(sum), MOST), bound = most > 1 ? most : 1;
        for (int32_t n = 0; n < s->node_count; n++) {
            if (!(s->node[n].bound < 0)) continue;
            s->node[n].bound = (float)bound;
            s->node[n].mass *= (double)s->node[n].bound;
        }
        any = true;
    }
    if (!any) return;
    lar_contact_edges_fit(s);
    bind_points(s);
}
