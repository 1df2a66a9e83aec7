#include "validation/newmark.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "contact/conditions.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hexahedron.h"

/* Symmetric and banded: row i holds the entries (i, i - d), d = 0..band. Vectors have one value per
 * freedom, 3 node + axis. */
typedef struct implicit {
    const lar_model *model;
    int freedoms, band;
    double *mass, *tangent; /* [freedoms][band + 1] */
    double *u, *v, *a, *next, *weight, *force, *inertia, *change, *guess;
    bool *fixed;
    double part; /* of the step, where the balance is: 1 or 1/2 */
    int *motion; /* one more than the index in model->move of what moves a freedom; 0: nothing */
    double time;
} implicit;

static double *entry(const implicit *body, double *matrix, int i, int j) {
    return &matrix[(size_t)i * ((size_t)body->band + 1) + (size_t)(i - j)];
}

static int freedom(const implicit *body, lar_gid e, int k) {
    return 3 * body->model->mesh.element[e][k / 3] + k % 3;
}

static void add_element(const implicit *body, double *matrix, lar_gid e,
                        const double element[24][24]) {
    for (int p = 0; p < 24; p++)
        for (int q = 0; q < 24; q++) {
            int i = freedom(body, e, p), j = freedom(body, e, q);
            if (i >= j) *entry(body, matrix, i, j) += element[p][q];
        }
}

static void clear(const implicit *body, double *matrix) {
    memset(matrix, 0, (size_t)body->freedoms * ((size_t)body->band + 1) * sizeof *matrix);
}

static void assemble_mass(implicit *body, newmark_mass kind) {
    clear(body, body->mass);
    for (lar_gid e = 0; e < body->model->mesh.element_count; e++) {
        double corner[8][3], element[24][24] = {{0}};
        double density = body->model->material[body->model->element_material[e]].density;
        lar_mesh_corners(&body->model->mesh, e, corner);
        for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
            double at[3], gradient[8][3], N[8];
            lar_gauss_point(g, at);
            double here =
                density * lar_hexahedron_gradients((const double(*)[3])corner, at, gradient);
            for (int a = 0; a < 8; a++) {
                N[a] = 0.125;
                for (int i = 0; i < 3; i++) N[a] *= 1 + lar_node_sign[a][i] * at[i];
            }
            for (int a = 0; a < 8; a++)
                for (int b = 0; b < 8; b++)
                    for (int i = 0; i < 3; i++)
                        element[3 * a + i][3 * (kind == NEWMARK_LUMPED ? a : b) + i] +=
                            here * N[a] * N[b];
        }
        add_element(body, body->mass, e, (const double(*)[24])element);
    }
}

/* Forces of one element, 24 values; false when it is turned inside out. */
static bool element_force(const implicit *body, lar_gid e, const double u[24], double force[24]) {
    double corner[8][3];
    const lar_material *material = &body->model->material[body->model->element_material[e]];
    lar_mesh_corners(&body->model->mesh, e, corner);
    return lar_hex8_full_force((const double(*)[3])corner, material, (const double(*)[3])u,
                               (double(*)[3])force) > 0;
}

/* Internal forces between `u` and `next`, and their tangent. */
static bool assemble_forces(implicit *body) {
    const double step = 1e-6;
    clear(body, body->tangent);
    memset(body->force, 0, (size_t)body->freedoms * sizeof *body->force);
    for (lar_gid e = 0; e < body->model->mesh.element_count; e++) {
        double u[24], force[24], above[24], below[24], element[24][24];
        for (int k = 0; k < 24; k++) {
            int i = freedom(body, e, k);
            u[k] = body->u[i] + body->part * (body->next[i] - body->u[i]);
        }
        if (!element_force(body, e, u, force)) return false;
        for (int k = 0; k < 24; k++) body->force[freedom(body, e, k)] += force[k];
        for (int q = 0; q < 24; q++) {
            double kept = u[q];
            u[q] = kept + step;
            element_force(body, e, u, above);
            u[q] = kept - step;
            element_force(body, e, u, below);
            u[q] = kept;
            for (int p = 0; p < 24; p++) element[p][q] = (above[p] - below[p]) / (2 * step);
        }
        add_element(body, body->tangent, e, (const double(*)[24])element);
    }
    return true;
}

static void times_mass(const implicit *body, const double *x, double *y) {
    memset(y, 0, (size_t)body->freedoms * sizeof *y);
    for (int i = 0; i < body->freedoms; i++)
        for (int j = i; j >= 0 && j >= i - body->band; j--) {
            double m = *entry(body, body->mass, i, j);
            y[i] += m * x[j];
            if (j < i) y[j] += m * x[i];
        }
}

/* Solves matrix x = b in place (Cholesky), x = 0 at supports. */
static bool solve(const implicit *body, double *matrix, double *b) {
    int count = body->freedoms, band = body->band;
    for (int i = 0; i < count; i++)
        for (int j = i; j >= 0 && j >= i - band; j--)
            if (body->fixed[i] || body->fixed[j]) *entry(body, matrix, i, j) = i == j;
    for (int i = 0; i < count; i++) {
        if (body->fixed[i]) b[i] = 0;
        for (int j = i > band ? i - band : 0; j <= i; j++) {
            double sum = *entry(body, matrix, i, j);
            for (int k = i > band ? i - band : 0; k < j; k++)
                sum -= j - k > band ? 0 : *entry(body, matrix, i, k) * *entry(body, matrix, j, k);
            if (i == j && !(sum > 0)) return false;
            *entry(body, matrix, i, j) = i == j ? sqrt(sum) : sum / *entry(body, matrix, j, j);
            if (j < i) b[i] -= *entry(body, matrix, i, j) * b[j];
        }
        b[i] /= *entry(body, matrix, i, i);
    }
    for (int i = count - 1; i >= 0; i--) {
        for (int k = i + 1; k < count && k <= i + band; k++)
            b[i] -= *entry(body, matrix, k, i) * b[k];
        b[i] /= *entry(body, matrix, i, i);
    }
    return true;
}

/* What gravity does at that time. */
static void weigh(implicit *body) {
    double gravity[3];
    lar_gravity_at(body->model, NULL, body->time, 0, gravity);
    for (int i = 0; i < body->freedoms; i++) body->guess[i] = gravity[i % 3];
    times_mass(body, body->guess, body->weight);
}

/* Puts moved supports where they are after the step. */
static void move_supports(implicit *body) {
    for (int i = 0; i < body->freedoms; i++) {
        if (!body->motion[i]) continue;
        const lar_move *move = &body->model->move[body->motion[i] - 1];
        body->next[i] = move->by * lar_curve_value(&body->model->curve[move->curve], body->time);
    }
}

/* One step: Newton's method for `next`. */
static bool step(implicit *body, double dt) {
    int count = body->freedoms;
    size_t entries = (size_t)count * ((size_t)body->band + 1);
    double first = 0, change = INFINITY;
    memcpy(body->next, body->u, (size_t)count * sizeof *body->u);
    body->time += dt;
    weigh(body);
    move_supports(body);
    for (int n = 0; n < 30 && change > 1e-20 * first; n++) {
        if (!assemble_forces(body)) return false;
        for (int i = 0; i < count; i++)
            body->guess[i] =
                body->part *
                    ((body->next[i] - body->u[i] - dt * body->v[i]) * 4 / (dt * dt) - body->a[i]) +
                (1 - body->part) * body->a[i];
        times_mass(body, body->guess, body->inertia);
        for (int i = 0; i < count; i++)
            body->change[i] = body->weight[i] - body->force[i] - body->inertia[i];
        for (size_t k = 0; k < entries; k++)
            body->tangent[k] = body->part * (body->tangent[k] + 4 / (dt * dt) * body->mass[k]);
        if (!solve(body, body->tangent, body->change)) return false;
        change = 0;
        for (int i = 0; i < count; i++) {
            body->next[i] += body->change[i];
            change += body->change[i] * body->change[i];
        }
        if (n == 0) first = change;
    }
    for (int i = 0; i < count; i++) {
        double ahead =
            body->fixed[i] && !body->motion[i]
                ? 0
                : (body->next[i] - body->u[i] - dt * body->v[i]) * 4 / (dt * dt) - body->a[i];
        body->v[i] += dt / 2 * (body->a[i] + ahead);
        body->a[i] = ahead;
        body->u[i] = body->next[i];
    }
    return change <= 1e-20 * first;
}

static bool allocate(implicit *body) {
    const lar_mesh *mesh = &body->model->mesh;
    body->freedoms = 3 * mesh->node_count;
    for (lar_gid e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++)
            for (int b = 0; b < 8; b++) {
                int apart = 3 * (mesh->element[e][a] - mesh->element[e][b]) + 2;
                if (apart > body->band) body->band = apart;
            }
    size_t count = (size_t)body->freedoms, entries = count * ((size_t)body->band + 1);
    double **vector[] = {&body->u,     &body->v,       &body->a,      &body->next, &body->weight,
                         &body->force, &body->inertia, &body->change, &body->guess};
    body->mass = lar_calloc(entries, sizeof *body->mass);
    body->tangent = lar_calloc(entries, sizeof *body->tangent);
    body->fixed = lar_calloc(count, sizeof *body->fixed);
    body->motion = lar_calloc(count, sizeof *body->motion);
    bool enough = body->mass && body->tangent && body->fixed && body->motion;
    for (size_t k = 0; k < sizeof vector / sizeof vector[0]; k++)
        enough = (*vector[k] = lar_calloc(count, sizeof(double))) != NULL && enough;
    return enough;
}

static void release(implicit *body) {
    double *all[] = {body->mass,    body->tangent, body->u,      body->v,
                     body->a,       body->next,    body->weight, body->force,
                     body->inertia, body->change,  body->guess};
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) free(all[k]);
    free(body->fixed);
    free(body->motion);
}

/* At rest, with the accelerations that weight alone gives. */
static bool begin(implicit *body, newmark_mass kind) {
    const lar_model *model = body->model;
    for (int f = 0; f < model->fix_count; f++)
        for (int32_t n = 0; n < model->fix[f].nodes.count; n++)
            for (int i = 0; i < 3; i++)
                if (model->fix[f].axes >> i & 1)
                    body->fixed[3 * model->fix[f].nodes.node[n] + i] = true;
    for (int m = 0; m < model->move_count; m++)
        for (int32_t n = 0; n < model->move[m].nodes.count; n++)
            for (int i = 0; i < 3; i++)
                if (model->move[m].axes >> i & 1) {
                    body->fixed[3 * model->move[m].nodes.node[n] + i] = true;
                    body->motion[3 * model->move[m].nodes.node[n] + i] = m + 1;
                }
    assemble_mass(body, kind);
    weigh(body);
    memcpy(body->tangent, body->mass,
           (size_t)body->freedoms * ((size_t)body->band + 1) * sizeof *body->mass);
    memcpy(body->a, body->weight, (size_t)body->freedoms * sizeof *body->a);
    return solve(body, body->tangent, body->a);
}

bool newmark_run(const lar_model *model, newmark_mass mass, newmark_rule rule, double dt, int steps,
                 double *u) {
    implicit body = {.model = model, .part = rule == NEWMARK_MIDPOINT ? 0.5 : 1};
    bool good = allocate(&body) && begin(&body, mass);
    for (int n = 0; good && n < steps; n++) good = step(&body, dt);
    if (good) memcpy(u, body.u, (size_t)body.freedoms * sizeof *u);
    release(&body);
    return good;
}
