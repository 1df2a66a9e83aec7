#include "study/inverse/forward.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "model/rest.h"
#include "model/triangles/surface_tree.h"
#include "simulation/rest.h"
#include "simulation/simulation.h"
#include "study/inverse/aspiration.h"
#include "study/inverse/parameters.h"

/* One run under way. */
typedef struct forward {
    const lar_inverse_experiment *e;
    const volatile sig_atomic_t *stop;
    lar_model model;    /* a shallow copy: materials, moves and curves are its own */
    double (*point)[2]; /* of the curve that drives; the last one of the model */
    lar_simulation *simulation;
    double ramp; /* from one level to the next [s] */
    lar_error *error;
} forward;

/* ---- the model ------------------------------------------------------------------------------- */

static void *copied(const void *from, int count, int more, size_t size) {
    char *to = lar_calloc((size_t)(count + more), size);
    if (to && count > 0) memcpy(to, from, (size_t)count * size);
    return to;
}

/* The driven support, or the pressure in the tube, follows a curve of its own, in metres or Pa. */
static lar_status drive(forward *f) {
    const lar_inverse_experiment *e = f->e;
    const lar_inverse_aspiration *a = &e->aspiration;
    if (!a->suction && (e->move < 0 || !e->along)) return LAR_OK;
    const int32_t rows = a->suction ? a->points : e->rows;
    f->point = lar_calloc((size_t)rows + 1, sizeof *f->point);
    if (!f->point) return lar_fail_memory(f->error, (size_t)rows, e->scene);
    int count = 1; /* the start, where nothing has moved */
    for (int32_t i = 0; e->in_time && i < rows; i++) {
        double time = a->suction ? a->suction[i][0] : e->time[i];
        double value = a->suction ? a->suction[i][1] : e->along[i];
        if (time > 0) f->point[count++][0] = time;
        f->point[count - 1][1] = value;
    }
    const int curve = f->model.curve_count++;
    if (a->suction) {
        f->model.pressure[a->load].pressure = -1; /* positive pressures push */
        f->model.pressure[a->load].curve = curve;
    } else {
        lar_move *move = &f->model.move[e->move];
        move->by = e->way;
        move->curve = curve;
    }
    f->model.curve[curve] = (lar_curve){.kind = LAR_CURVE_TABLE,
                                        .shape = e->in_time ? LAR_CURVE_LINEAR : LAR_CURVE_SMOOTH,
                                        .count = count,
                                        .point = f->point};
    return LAR_OK;
}

static lar_status copy_model(forward *f, const lar_inverse_problem *problem, const double *value) {
    const lar_model *from = f->e->model;
    lar_model *m = &f->model;
    *m = *from;
    m->material = copied(from->material, from->material_count, 0, sizeof *m->material);
    m->curve = copied(from->curve, from->curve_count, 1, sizeof *m->curve);
    m->move = copied(from->move, from->move_count, 0, sizeof *m->move);
    m->pressure = copied(from->pressure, from->pressure_count, 0, sizeof *m->pressure);
    if (!m->material || !m->curve || !m->move || !m->pressure)
        return lar_fail_memory(f->error, sizeof *m, f->e->scene);
    lar_inverse_set_all(problem, value, m->material, m->material_count);
    for (int i = 0; i < m->material_count; i++) {
        lar_status status = lar_material_check(&m->material[i], f->e->scene, f->error);
        if (status) return status;
    }
    if (!f->e->in_time) m->damping = lar_rest_damping(m);
    f->ramp = 0.5 * lar_model_slow_period(m);
    return drive(f);
}

static void forward_clear(forward *f) {
    lar_simulation_destroy(f->simulation);
    free(f->model.material);
    free(f->model.curve);
    free(f->model.move);
    free(f->model.pressure);
    free(f->point);
}

/* ---- steps ----------------------------------------------------------------------------------- */

static lar_status advance(forward *f, uint64_t steps) {
    enum { PORTION = 256 }; /* between looks whether to stop */
    while (steps > 0) {
        uint64_t now = steps < PORTION ? steps : PORTION;
        if (lar_inverse_stop_asked(f->stop))
            return lar_fail(f->error, LAR_ERROR_ARGUMENT, "%s", "");
        lar_status status = lar_simulation_advance(f->simulation, now, f->error);
        if (status) return status;
        steps -= now;
    }
    return LAR_OK;
}

static lar_status follow_to_rest(forward *f) {
    lar_rest rest;
    lar_rest_begin(&rest, f->simulation);
    while (!lar_rest_look(&rest, f->simulation)) {
        uint64_t now = lar_simulation_steps(f->simulation);
        if (now >= rest.limit)
            return lar_fail(f->error, LAR_ERROR_UNSTABLE, "%s: not at rest after %.4g s; %s",
                            f->e->scene, lar_simulation_time(f->simulation),
                            rest.looked == 2
                                ? "viscous terms still relax: leave `viscous` out, or fit in time"
                                : "look whether the body is held by supports, and whether anything "
                                  "can turn or fall freely");
        lar_status status = advance(f, rest.next > now ? rest.next - now : 1);
        if (status) return status;
    }
    return LAR_OK;
}

static uint64_t steps_to(const forward *f, double time) {
    double steps = round(time / lar_simulation_time_step(f->simulation));
    double now = (double)lar_simulation_steps(f->simulation);
    return steps > now ? (uint64_t)(steps - now) : 0;
}

/* ---- supports that are moved ----------------------------------------------------------------- */

/* Of the support on the body, along the way that it is moved. The curve through rows has a kink at
 * each, where the nodes' mass would be thrown from one speed to the next in a single step: what
 * counts is the force with which the support arrives. */
static lar_status support_force(forward *f, double *force) {
    const lar_simulation *s = f->simulation;
    const lar_move *move = &f->model.move[f->e->move];
    double sum[3];
    const bool arriving = f->e->along != NULL;
    lar_status status =
        lar_measure_reaction(&s->domain, &s->scratch->measure, lar_simulation_state(s),
                             &move->nodes, arriving, NULL, sum, f->error);
    int axis = move->axes == LAR_AXIS_X ? 0 : move->axes == LAR_AXIS_Y ? 1 : 2;
    *force = f->e->way * sum[axis];
    return status;
}

/* The driving curve goes from one level to another, and the body to rest. */
static lar_status settle(forward *f, double from, double to) {
    double now = lar_simulation_time(f->simulation);
    f->point[0][0] = now;
    f->point[0][1] = from;
    f->point[1][0] = now + f->ramp;
    f->point[1][1] = to;
    f->model.curve[f->model.curve_count - 1].count = 2;
    return follow_to_rest(f);
}

static lar_status pull(forward *f, double *model) {
    const lar_inverse_experiment *e = f->e;
    lar_status status = LAR_OK;
    double before = 0;
    for (int32_t i = 0; i < e->rows && !status; i++) {
        if (e->in_time) {
            status = advance(f, steps_to(f, e->time[i]));
        } else {
            status = settle(f, before, e->along[i]);
            before = e->along[i];
        }
        if (!status) status = support_force(f, &model[i]);
    }
    return status;
}

/* ---- tubes --------------------------------------------------------------------------------------
 */

static lar_status suck(forward *f, double *model) {
    const lar_inverse_experiment *e = f->e;
    const double(*suction)[2] = (const double(*)[2])e->aspiration.suction;
    size_t nodes = (size_t)f->model.mesh.node_count;
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    if (!u) return lar_fail_memory(f->error, nodes * sizeof *u, e->scene);
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < e->rows && !status; i++) {
        bool next = lar_inverse_new_moment(e, i);
        if (next && e->in_time)
            status = advance(f, steps_to(f, e->time[i]));
        else if (next)
            status = settle(f, i > 0 ? suction[i - 1][1] : 0, suction[i][1]);
        if (next && !status) lar_simulation_displacements(f->simulation, u);
        if (!status) model[i] = lar_inverse_tube_height(e, (const double(*)[3])u, e->along[i]);
    }
    free(u);
    return status;
}

/* ---- tools ----------------------------------------------------------------------------------- */

static lar_status tool_to(forward *f, double depth, uint64_t steps) {
    const lar_inverse_experiment *e = f->e;
    lar_tool_pose pose = f->model.tool[e->tool].rest;
    for (int i = 0; i < 3; i++) pose.position[i] += depth * e->direction[i];
    lar_status status = lar_simulation_tool_move(f->simulation, e->tool, &pose, steps, f->error);
    return status ? status : advance(f, steps);
}

static const double OF_DEEPEST = 0.75;

/* To a level and to rest. Contact is a spring: tissue comes some way into the ball, more at a
 * larger step, and has so much less depth. So the ball goes further, by the mean of that way over
 * the pressure: three quarters of the deepest where both are as in Hertz's contact (K. L. Johnson,
 * Contact Mechanics, 1985, section 4.2), p ~ sqrt(1 - r^2/a^2). */
static lar_status settle_tool(forward *f, double depth, double *inside) {
    enum { ROUNDS = 2 };
    lar_status status = LAR_OK;
    for (int i = 0; i < ROUNDS && !status; i++) {
        lar_tool_force felt = {0};
        double ramp = i == 0 ? f->ramp : 0.5 * f->ramp;
        uint64_t steps = steps_to(f, lar_simulation_time(f->simulation) + ramp);
        status = tool_to(f, depth + *inside, steps > 0 ? steps : 1);
        if (!status) status = follow_to_rest(f);
        if (!status) status = lar_simulation_tool_force(f->simulation, f->e->tool, &felt, f->error);
        *inside = OF_DEEPEST * felt.depth;
    }
    return status;
}

static lar_status press(forward *f, double *model) {
    const lar_inverse_experiment *e = f->e;
    lar_status status = LAR_OK;
    double inside = 0;
    for (int32_t i = 0; i < e->rows && !status; i++) {
        uint64_t steps = e->in_time ? steps_to(f, e->time[i]) : 0;
        lar_tool_force felt = {0};
        if (steps > 0) status = tool_to(f, e->along[i] + inside, steps);
        if (!status && !e->in_time) status = settle_tool(f, e->along[i], &inside);
        if (!status) status = lar_simulation_tool_force(f->simulation, e->tool, &felt, f->error);
        if (!status && felt.limited)
            status = lar_fail(f->error, LAR_ERROR_UNSTABLE,
                              "%s: the tissue stops the tool %s before %.4g m, at %.3g N; give a "
                              "finer mesh or less depth",
                              e->scene, f->model.tool[e->tool].name, e->along[i], felt.limit);
        inside = OF_DEEPEST * felt.depth;
        model[i] = -lar_dot(felt.force, e->direction);
    }
    return status;
}

/* ---- points ---------------------------------------------------------------------------------- */

static void markers(const forward *f, const double (*u)[3], double *model) {
    const lar_inverse_experiment *e = f->e;
    for (int32_t i = 0; i < e->rows; i++) {
        const int32_t *node = f->model.mesh.element[e->points.element[i]];
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int a = 0; a < 8; a++) sum += (double)e->points.weight[i][a] * u[node[a]][k];
            model[3 * i + k] = sum;
        }
    }
}

/* Distances of the measured points from the deformed surface, positive outside: unlike plain ones
 * they pass through zero without a kink. */
static lar_status distances(forward *f, const double (*u)[3], double *model) {
    const lar_inverse_experiment *e = f->e;
    lar_mesh mesh = f->model.mesh;
    lar_surface_tree outer = {0};
    size_t nodes = (size_t)mesh.node_count;
    double(*place)[3] = lar_calloc(nodes, sizeof *place);
    if (!place) return lar_fail_memory(f->error, nodes * sizeof *place, e->scene);
    for (size_t n = 0; n < nodes; n++)
        for (int k = 0; k < 3; k++) place[n][k] = mesh.position[n][k] + u[n][k];
    mesh.position = place;
    lar_status status = lar_surface_tree_create(&mesh, &outer, f->error);
    for (int32_t i = 0; i < e->rows && !status; i++) {
        const double *point = e->points.surface.vertex[i];
        lar_nearest nearest;
        double away[3], normal[3];
        if (!lar_triangle_tree_nearest(outer.tree, point, INFINITY, &nearest)) continue;
        lar_triangles_normal(&outer.triangles, nearest.triangle, normal);
        lar_minus(point, nearest.point, away);
        model[i] = copysign(nearest.distance, lar_dot(away, normal));
    }
    lar_surface_tree_clear(&outer);
    free(place);
    return status;
}

static lar_status look_at_points(forward *f, double *model) {
    size_t nodes = (size_t)f->model.mesh.node_count;
    lar_status status = follow_to_rest(f);
    if (status) return status;
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    if (!u) return lar_fail_memory(f->error, nodes * sizeof *u, f->e->scene);
    lar_simulation_displacements(f->simulation, u);
    if (f->e->kind == LAR_INVERSE_MARKERS)
        markers(f, (const double(*)[3])u, model);
    else
        status = distances(f, (const double(*)[3])u, model);
    free(u);
    return status;
}

/* Half of the automatic step under a tool: its springs are four times as stiff then. */
static lar_status automatic_step(const forward *f, double *step) {
    lar_model_info info;
    lar_status status = lar_model_inspect(&f->model, &info, f->error);
    if (!status) *step = f->e->tool < 0 ? info.time_step : 0.5 * info.time_step;
    return status;
}

static lar_status choose_step(const forward *f, const lar_inverse_pace *pace,
                              lar_options *options) {
    double most, kept = pace ? pace->step : 0;
    if (f->model.time_step > 0 || (f->e->tool < 0 && kept == 0)) return LAR_OK;
    lar_status status = automatic_step(f, &most);
    if (status) return status;
    while (kept > 0 && kept > pace->part * most) kept *= 0.5;
    options->time_step = kept > 0 ? kept : most;
    return LAR_OK;
}

static double open_of(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass + e->damping + e->contact + e->viscous -
           e->external;
}

/* What the run has made of energy, as a share of what went in or out. */
static double open_share(const lar_simulation *simulation, const lar_energy *began) {
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    double all = fabs(e.kinetic) + fabs(e.strain) + fabs(e.hourglass) + fabs(e.damping) +
                 fabs(e.contact) + fabs(e.viscous);
    all = fmax(all, fabs(e.external));
    return all > 0 ? fabs(open_of(&e) - open_of(began)) / all : 0;
}

/* ---- one experiment -------------------------------------------------------------------------- */

lar_status lar_inverse_own_step(const lar_inverse_problem *problem, int k, const double *value,
                                double *step, lar_error *error) {
    forward f = {.e = &problem->experiment[k], .error = error};
    *step = 0;
    if (!f.e->in_time || f.e->model->time_step > 0) return LAR_OK;
    lar_status status = copy_model(&f, problem, value);
    if (!status) status = automatic_step(&f, step);
    forward_clear(&f);
    return status;
}

lar_status lar_inverse_forward(const lar_inverse_problem *problem, int k, const double *value,
                               lar_inverse_pace *pace, const volatile sig_atomic_t *stop,
                               double *model, lar_error *error) {
    forward f = {.e = &problem->experiment[k], .stop = stop, .error = error};
    lar_options options = lar_options_default();
    lar_energy began;
    lar_status status = copy_model(&f, problem, value);
    if (!status) status = choose_step(&f, pace, &options);
    if (!status) status = lar_simulation_create(&f.model, &options, &f.simulation, error);
    if (!status) lar_simulation_energy(f.simulation, &began);
    if (!status && f.e->tool >= 0)
        status = press(&f, model);
    else if (!status && f.e->kind == LAR_INVERSE_ASPIRATION)
        status = suck(&f, model);
    else if (!status && f.e->kind <= LAR_INVERSE_INDENTATION)
        status = pull(&f, model);
    else if (!status)
        status = look_at_points(&f, model);
    if (!status && pace) pace->open = f.e->in_time ? open_share(f.simulation, &began) : 0;
    forward_clear(&f);
    return status;
}
