#include "study/implicit/implicit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "contact/conditions.h"
#include "mechanics/fold/hex8_fold.h"
#include "study/implicit/tangent.h"

/* Newmark's parameters: the trapezoidal rule, which neither damps nor gains (for linear bodies). */
#define ALPHA 0.5
#define BETA  0.25

/* One time-step's vectors are [rows], row 3 n + i being axis i of node n; state.u and state.force
 * are the engine's, axis by axis. */
struct lar_implicit {
    const lar_model *model;
    lar_implicit_options options;
    lar_implicit_tally tally;
    double time;
    int32_t rows;
    double scale; /* force units per newton in state.force */
    double unit;  /* [N] what a force is measured against where nothing acts */
    lar_state state;
    lar_conditions conditions;
    lar_condition_notes notes;
    lar_hex8 *element;
    lar_sparse matrix;
    int32_t *local; /* [nodes] n: what the conditions take */
    bool *held;     /* [rows] */
    double *vectors;
    double *mass, *u, *v, *a;            /* of the last step done; mass by row */
    double *target;                      /* prescribed displacements of held rows at the new time */
    double *residual, *right, *d, *from; /* `from`: u before the line search */
    double reference;                    /* [N] norm of the forces that balance in the residual */
};

lar_implicit_options lar_implicit_options_default(void) {
    return (lar_implicit_options){.time_step = 0.01, .tolerance = 1e-6, .newton_max = 25};
}

/* ---- making --------------------------------------------------------------------------------- */

static lar_status refuse(const lar_model *model, const lar_implicit_options *o, lar_error *error) {
    if (model->contact_count > 0 || model->tool_count > 0)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: the implicit comparison knows neither contact nor tools; take a scene "
                        "without them",
                        lar_model_source(model));
    if (lar_model_viscous(model))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: the implicit comparison knows no viscous materials; take a model "
                        "without them",
                        lar_model_source(model), lar_model_viscous(model)->viscosity.line);
    if (lar_model_fibrous(model))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: the implicit comparison knows no fibres; take a model without them",
                        lar_model_source(model), lar_model_fibrous(model)->fibre.line);
    if (model->spring_count > 0)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: the implicit comparison knows no springs; take a model without "
                        "them, or hold those nodes with fix",
                        lar_model_source(model), model->spring[0].line);
    if (!(o->time_step > 0 && isfinite(o->time_step)) || !(o->tolerance > 0) || o->newton_max < 1)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "implicit integration needs a step, a tolerance and iterations above 0");
    return LAR_OK;
}

static lar_status allocate(lar_implicit *m, lar_error *error) {
    size_t nodes = (size_t)m->model->mesh.node_count, rows = 3 * nodes;
    m->rows = (int32_t)rows;
    m->element = lar_calloc((size_t)m->model->mesh.element_count, sizeof *m->element);
    m->local = lar_calloc(nodes, sizeof *m->local);
    m->held = lar_calloc(rows, sizeof *m->held);
    m->vectors = lar_calloc(9 * rows, sizeof *m->vectors);
    if (!m->element || !m->local || !m->held || !m->vectors)
        return lar_fail_memory(error, 9 * rows * sizeof *m->vectors, "implicit integration");
    double **vector[9] = {&m->mass,     &m->u,     &m->v, &m->a,   &m->target,
                          &m->residual, &m->right, &m->d, &m->from};
    for (size_t k = 0; k < 9; k++) *vector[k] = m->vectors + k * rows;
    return LAR_OK;
}

/* As the engine does: a node has an eighth of the mass of each of its elements. */
static void prepare_elements(lar_implicit *m) {
    const lar_mesh *mesh = &m->model->mesh;
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        const lar_material *material = lar_model_material_of(m->model, e);
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        lar_hex8_prepare((const double(*)[3])corner, material, &m->element[e]);
        double volume = lar_hexahedron_volume((const double(*)[3])corner), side = cbrt(volume);
        double modulus = lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
        m->unit = fmax(m->unit, modulus * side * side);
        for (int k = 0; k < 24; k++)
            m->mass[3 * mesh->element[e][k / 3] + k % 3] += material->density * volume / 8;
    }
    int exponent;
    frexp(m->unit, &exponent);
    m->scale = ldexp(1, 46 - exponent);
}

static int32_t row_of(const lar_constraint *constraint) {
    return 3 * constraint->node + constraint->axis;
}

static void set_targets(lar_implicit *m, double time) {
    for (int32_t i = 0; i < m->conditions.constraint_count; i++) {
        const lar_constraint *c = &m->conditions.constraint[i];
        m->target[row_of(c)] = lar_constraint_value(m->model, c, time);
    }
}

static void start_motion(lar_implicit *m) {
    for (int32_t i = 0; i < m->conditions.constraint_count; i++)
        m->held[row_of(&m->conditions.constraint[i])] = true;
    for (int32_t r = 0; r < m->rows; r++)
        if (!(m->mass[r] > 0)) m->held[r] = true;
    set_targets(m, 0);
    for (int32_t r = 0; r < m->rows; r++)
        if (m->held[r]) m->u[r] = m->target[r];
    for (int i = 0; i < m->model->initial_count && !m->options.quasi_static; i++) {
        const lar_initial_velocity *initial = &m->model->initial[i];
        for (int32_t k = 0; k < initial->nodes.count; k++)
            for (int axis = 0; axis < 3; axis++)
                m->v[3 * initial->nodes.node[k] + axis] = initial->velocity[axis];
    }
}

/* ---- forces --------------------------------------------------------------------------------- */

static void gather(const lar_implicit *m, const double *u, lar_gid e, double corner[8][3]) {
    for (int k = 0; k < 24; k++)
        corner[k / 3][k % 3] = u[3 * m->model->mesh.element[e][k / 3] + k % 3];
}

static double norm(int32_t rows, const double *x) {
    double sum = 0;
    for (int32_t r = 0; r < rows; r++) sum += x[r] * x[r];
    return sqrt(sum);
}

/* External forces at (u, time) to `out`, by the engine's own function. */
static lar_status external(lar_implicit *m, const double *u, double time, double *out,
                           lar_error *error) {
    lar_condition_context context = {.model = m->model, .scale = m->scale};
    double gravity[3];
    lar_gravity_at(m->model, NULL, time, 0, gravity);
    memset(m->state.force, 0, 3 * m->state.stride * sizeof *m->state.force);
    for (int32_t r = 0; r < m->rows; r++) m->state.u[lar_state_at(&m->state, r / 3, r % 3)] = u[r];
    int32_t beyond = lar_conditions_load(&m->conditions, &context, time, &m->notes, &m->state);
    if (beyond >= 0)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "the load on node %lld is too large at %g s; check its unit",
                        (long long)m->model->mesh.node_id[beyond], time);
    for (int32_t r = 0; r < m->rows; r++)
        out[r] = m->mass[r] * gravity[r % 3] -
                 (double)m->state.force[lar_state_at(&m->state, r / 3, r % 3)] / m->scale;
    return LAR_OK;
}

/* Adds the elements' forces at u to `out`; false when one is inverted. */
static bool add_internal(const lar_implicit *m, const double *u, double *out) {
    const lar_mesh *mesh = &m->model->mesh;
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double corner[8][3], force[8][3], place[8][3];
        gather(m, u, e, corner);
        double J = lar_hex8_force(&m->element[e], lar_model_material_of(m->model, e),
                                  (const double(*)[3])corner, force);
        if (!(J > 0)) return false;
        lar_mesh_corners(mesh, e, place);
        lar_hex8_fold_force((const double(*)[3])place, lar_model_material_of(m->model, e),
                            (const double(*)[3])corner, force);
        for (int k = 0; k < 24; k++)
            out[3 * mesh->element[e][k / 3] + k % 3] += force[k / 3][k % 3];
    }
    return true;
}

/* Acceleration of row r by (2.10) when it is at `u` after dt. */
static double acceleration(const lar_implicit *m, int32_t r, double u, double dt) {
    return (u - m->u[r]) / (BETA * dt * dt) - m->v[r] / (BETA * dt) -
           (1 / (2 * BETA) - 1) * m->a[r];
}

/* Velocity by (2.9), with the second factor put right. */
static double velocity(const lar_implicit *m, int32_t r, double u, double dt) {
    return ALPHA / (BETA * dt) * (u - m->u[r]) - (ALPHA / BETA - 1) * m->v[r] -
           dt * (ALPHA / (2 * BETA) - 1) * m->a[r];
}

/* m->residual = M a + c M v + f(u) - p at `u` and the end of the step; 0 in held rows. */
static lar_status balance(lar_implicit *m, const double *u, double dt, bool *upright,
                          lar_error *error) {
    lar_status status = external(m, u, m->time + dt, m->residual, error);
    if (status) return status;
    m->reference = norm(m->rows, m->residual);
    double moving = 0;
    for (int32_t r = 0; r < m->rows; r++) {
        m->residual[r] = -m->residual[r];
        if (m->options.quasi_static || m->held[r]) continue;
        double inertia = m->mass[r] * acceleration(m, r, u[r], dt);
        moving += inertia * inertia;
        m->residual[r] += inertia + m->model->damping * m->mass[r] * velocity(m, r, u[r], dt);
    }
    *upright = add_internal(m, u, m->residual);
    double reactions = 0;
    for (int32_t r = 0; r < m->rows; r++)
        if (m->held[r]) {
            reactions += m->residual[r] * m->residual[r];
            m->residual[r] = 0;
        }
    m->reference = fmax(m->reference, sqrt(fmax(moving, reactions)));
    m->reference = fmax(m->reference, 1e-9 * m->unit);
    return LAR_OK;
}

/* ---- Newton --------------------------------------------------------------------------------- */

/* The tangent at `u` and the right side -r - K d_held; held rows say d = what is left to go. */
static void assemble(lar_implicit *m, const double *u, double dt) {
    const lar_mesh *mesh = &m->model->mesh;
    double inertia = m->options.quasi_static
                         ? 0
                         : 1 / (BETA * dt * dt) + m->model->damping * ALPHA / (BETA * dt);
    lar_sparse *A = &m->matrix;
    memset(A->value, 0, (size_t)A->start[A->rows] * sizeof *A->value);
    for (int32_t r = 0; r < m->rows; r++) {
        m->d[r] = m->held[r] ? m->target[r] - u[r] : 0;
        m->right[r] = -m->residual[r];
    }
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double corner[8][3], K[24][24];
        gather(m, u, e, corner);
        lar_hex8_tangent(&m->element[e], lar_model_material_of(m->model, e),
                         (const double(*)[3])corner, K);
        for (int s = 0; s < 24; s++) {
            int32_t row = 3 * mesh->element[e][s / 3] + s % 3;
            if (m->held[row]) continue;
            for (int b = 0; b < 8; b++) {
                int32_t column = 3 * mesh->element[e][b];
                double *at = lar_sparse_at(A, row, column); /* three axes side by side */
                for (int k = 0; k < 3; k++)
                    if (m->held[column + k])
                        m->right[row] -= K[s][3 * b + k] * m->d[column + k];
                    else
                        at[k] += K[s][3 * b + k];
            }
        }
    }
    for (int32_t r = 0; r < m->rows; r++) {
        *lar_sparse_at(A, r, r) += m->held[r] ? 1 : inertia * m->mass[r];
        if (m->held[r]) m->right[r] = m->d[r];
    }
}

static double along(const lar_implicit *m) {
    double sum = 0;
    for (int32_t r = 0; r < m->rows; r++)
        if (!m->held[r]) sum += m->d[r] * m->residual[r];
    return sum;
}

/* u += s d, with the largest s = 1, 1/2, 1/4, ... that inverts no element and, where supports do
 * not move any more, leaves at most 0.9 of the residual along d. */
static lar_status search(lar_implicit *m, double *u, double dt, double to_go, bool *found,
                         lar_error *error) {
    double before = fabs(along(m)), s = 1;
    memcpy(m->from, u, (size_t)m->rows * sizeof *u);
    *found = false;
    for (int n = 0; n < 12; n++, s *= 0.5) {
        bool upright;
        for (int32_t r = 0; r < m->rows; r++)
            u[r] = n == 0 && m->held[r] ? m->target[r] : m->from[r] + s * m->d[r];
        lar_status status = balance(m, u, dt, &upright, error);
        if (status) return status;
        *found = upright && (to_go > 0 || fabs(along(m)) <= 0.9 * before ||
                             norm(m->rows, m->residual) <= m->options.tolerance * m->reference);
        if (*found) {
            if (n > 0) m->tally.searches++;
            return LAR_OK;
        }
    }
    return LAR_OK;
}

static lar_status fail_at(const lar_implicit *m, double dt, const char *why, lar_error *error) {
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "%s: the implicit step from %g to %g s finds no equilibrium: %s; take smaller "
                    "steps, or integrate explicitly",
                    lar_model_source(m->model), m->time, m->time + dt, why);
}

static lar_status iterate(lar_implicit *m, double *u, double dt, lar_error *error) {
    bool upright, found;
    lar_status status = balance(m, u, dt, &upright, error);
    for (int n = 0; !status && n <= m->options.newton_max; n++) {
        double to_go = 0;
        for (int32_t r = 0; r < m->rows; r++)
            if (m->held[r]) to_go = fmax(to_go, fabs(m->target[r] - u[r]));
        if (!(to_go > 0) && norm(m->rows, m->residual) <= m->options.tolerance * m->reference)
            return LAR_OK;
        if (n == m->options.newton_max) break;
        lar_linear_result linear;
        double start = lar_clock_seconds();
        assemble(m, u, dt);
        double built = lar_clock_seconds();
        status = lar_linear_solve(m->options.solver, &m->matrix, m->right, m->d, &linear, error);
        m->tally.assembly += built - start;
        m->tally.solving += lar_clock_seconds() - built;
        m->tally.newton++;
        m->tally.linear += linear.iterations;
        if (status) return status;
        if (!linear.solved) return fail_at(m, dt, linear.reason, error);
        status = search(m, u, dt, to_go, &found, error);
        if (!status && !found)
            return fail_at(m, dt,
                           "no part of Newton's step leaves all elements upright and the "
                           "residual smaller",
                           error);
    }
    return status
               ? status
               : fail_at(m, dt, "Newton's method does not converge within its iterations", error);
}

/* One step; on failure nothing has changed. */
static lar_status take_step(lar_implicit *m, double *u, double dt, lar_error *error) {
    memcpy(u, m->u, (size_t)m->rows * sizeof *u);
    set_targets(m, m->time + dt);
    lar_status status = iterate(m, u, dt, error);
    if (status) return status;
    for (int32_t r = 0; r < m->rows; r++) {
        double a = acceleration(m, r, u[r], dt), v = velocity(m, r, u[r], dt);
        bool still = m->options.quasi_static || m->held[r];
        m->a[r] = still ? 0 : a;
        m->v[r] = still ? 0 : v;
        m->u[r] = u[r];
    }
    m->time += dt;
    m->tally.steps++;
    return LAR_OK;
}

/* ---- public --------------------------------------------------------------------------------- */

/* At the start M a = p - f - c M v. */
static lar_status first_acceleration(lar_implicit *m, lar_error *error) {
    if (m->options.quasi_static) return LAR_OK;
    lar_status status = external(m, m->u, 0, m->residual, error);
    if (status) return status;
    memset(m->right, 0, (size_t)m->rows * sizeof *m->right);
    if (!add_internal(m, m->u, m->right))
        return lar_fail(error, LAR_ERROR_MODEL, "%s: supports invert an element at the start",
                        lar_model_source(m->model));
    for (int32_t r = 0; r < m->rows; r++)
        if (!m->held[r])
            m->a[r] = (m->residual[r] - m->right[r]) / m->mass[r] - m->model->damping * m->v[r];
    return LAR_OK;
}

lar_status lar_implicit_create(const lar_model *model, const lar_implicit_options *options,
                               lar_implicit **implicit, lar_error *error) {
    lar_status status = refuse(model, options, error);
    if (status) return status;
    lar_implicit *m = lar_calloc(1, sizeof *m);
    if (!m) return lar_fail_memory(error, sizeof *m, "implicit integration");
    m->model = model;
    m->options = *options;
    status = lar_sparse_create(&model->mesh, &m->matrix, error);
    if (!status) status = allocate(m, error);
    for (int32_t n = 0; !status && n < model->mesh.node_count; n++) m->local[n] = n;
    if (!status) status = lar_conditions_create(model, m->local, NULL, &m->conditions, error);
    if (!status) status = lar_condition_notes_create(&m->conditions, &m->notes, error);
    if (!status)
        status = lar_state_create(&m->state, lar_whole_lanes(model->mesh.node_count), 0, error);
    if (!status) {
        prepare_elements(m);
        start_motion(m);
        status = first_acceleration(m, error);
    }
    if (status)
        lar_implicit_destroy(m);
    else
        *implicit = m;
    return status;
}

void lar_implicit_destroy(lar_implicit *m) {
    if (!m) return;
    lar_state_destroy(&m->state);
    lar_conditions_destroy(&m->conditions);
    lar_condition_notes_destroy(&m->notes);
    lar_sparse_destroy(&m->matrix);
    free(m->element);
    free(m->local);
    free(m->held);
    free(m->vectors);
    free(m);
}

lar_status lar_implicit_advance(lar_implicit *m, double until, lar_error *error) {
    double *u = lar_calloc((size_t)m->rows, sizeof *u), dt = m->options.time_step;
    if (!u) return lar_fail_memory(error, (size_t)m->rows * sizeof *u, "a step");
    lar_status status = LAR_OK;
    int halved = 0;
    while (!status && until - m->time > 1e-9 * dt) {
        double left = until - m->time;
        status = take_step(m, u, dt < left ? dt : left, error);
        if (!status && halved > 0) {
            halved--;
            dt *= 2;
        } else if (status == LAR_ERROR_UNSTABLE && halved < m->options.halvings_max) {
            halved++;
            m->tally.halved++;
            dt = 0.5 * (dt < left ? dt : left);
            status = LAR_OK;
        }
    }
    free(u);
    return status;
}

double lar_implicit_time(const lar_implicit *m) {
    return m->time;
}

const lar_implicit_tally *lar_implicit_count(const lar_implicit *m) {
    return &m->tally;
}

int32_t lar_implicit_rows(const lar_implicit *m) {
    return m->rows;
}

int64_t lar_implicit_values(const lar_implicit *m) {
    return m->matrix.start[m->matrix.rows];
}

void lar_implicit_displacements(const lar_implicit *m, double (*out)[3]) {
    for (int32_t r = 0; r < m->rows; r++) out[r / 3][r % 3] = m->u[r];
}
