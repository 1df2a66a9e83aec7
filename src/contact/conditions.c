#include "contact/conditions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/vector.h"
#include "mechanics/contact.h"

/* Room for at most so many entries; the lists are still empty. */
LAR_SETUP static lar_status allocate(lar_conditions *c, size_t nodes, size_t constraints,
                                     size_t forces, size_t springs, size_t pressures,
                                     lar_error *error) {
    c->held = lar_calloc(nodes, sizeof *c->held);
    c->constraint = lar_calloc(constraints, sizeof *c->constraint);
    c->force = lar_calloc(forces, sizeof *c->force);
    c->spring = lar_calloc(springs, sizeof *c->spring);
    c->pressure = lar_calloc(pressures, sizeof *c->pressure);
    if (c->held && c->constraint && c->force && c->spring && c->pressure) return LAR_OK;
    lar_conditions_destroy(c);
    return lar_fail_memory(error,
                           nodes + constraints * sizeof *c->constraint + forces * sizeof *c->force +
                               springs * sizeof *c->spring + pressures * sizeof *c->pressure,
                           "supports and loads");
}

/* Sets overlap at edges and corners: what is held already is not held again, or its reaction would
 * count twice. (Whatever is moved is held by nothing else: lar_model_check.) */
static void add_constraints(lar_conditions *c, const int32_t *local,
                            const lar_condition_share *share, const lar_node_list *nodes,
                            unsigned axes, lar_constraint like) {
    for (int32_t i = 0; i < nodes->count; i++) {
        int32_t node = nodes->node[i];
        if (share && share->holds[node] != share->thread) continue;
        unsigned fresh = axes & ~(unsigned)c->held[node];
        like.node = local[node];
        like.point = node;
        for (like.axis = 0; like.axis < 3; like.axis++)
            if (fresh & (1u << like.axis)) c->constraint[c->constraint_count++] = like;
        c->held[node] |= (uint8_t)fresh;
    }
}

/* Those of the model, but for the axes that `held` has already. */
static void list_constraints(lar_conditions *c, const lar_model *model, const int32_t *local,
                             const lar_condition_share *share) {
    for (int i = 0; i < model->fix_count; i++)
        add_constraints(c, local, share, &model->fix[i].nodes, model->fix[i].axes,
                        (lar_constraint){.curve = -1, .rigid = -1});
    c->fixed_count = c->constraint_count;
    for (int i = 0; i < model->move_count; i++) {
        const lar_move *move = &model->move[i];
        lar_constraint like = {.curve = move->curve, .rigid = -1, .by = move->by};
        if (move->screw_count > 0) like.rigid = i;
        if (move->tool) like.curve = LAR_CURVE_TOOL;
        if (move->tool) like.rigid = move->tool - 1;
        add_constraints(c, local, share, &move->nodes, move->axes, like);
    }
}

static void add_pressure(lar_conditions *c, const lar_mesh *mesh, const int32_t *local,
                         int32_t face, const lar_pressure_load *load) {
    lar_face_pressure *p = &c->pressure[c->pressure_count++];
    *p = (lar_face_pressure){.curve = load->curve, .pressure = load->pressure};
    for (int a = 0; a < 4; a++) {
        int32_t node = mesh->element[face / 6][lar_face_node[face % 6][a]];
        p->node[a] = local[node];
        memcpy(p->position[a], mesh->position[node], sizeof p->position[a]);
    }
}

static void add_forces(lar_conditions *c, const int32_t *local, const lar_condition_share *share,
                       const lar_nodal_load *load) {
    for (int32_t k = 0; k < load->nodes.count; k++) {
        int32_t node = load->nodes.node[k];
        if (share && share->loads[node] != share->thread) continue;
        lar_point_force *f = &c->force[c->force_count++];
        *f = (lar_point_force){.node = local[node], .curve = load->curve};
        memcpy(f->force, load->force, sizeof f->force);
    }
}

static void add_springs(lar_conditions *c, const int32_t *local, const lar_condition_share *share,
                        const lar_spring_bed *bed) {
    for (int32_t k = 0; k < bed->nodes.count; k++) {
        int32_t node = bed->nodes.node[k];
        if (share && share->loads[node] != share->thread) continue;
        c->spring[c->spring_count++] = (lar_point_spring){local[node], bed->stiffness[k]};
    }
}

/* A force may be set on any node, and its thread applies it. */
static lar_status note_bearers(const lar_condition_share *share, int32_t nodes, lar_conditions *c,
                               lar_error *error) {
    size_t bytes = ((size_t)nodes + 7) / 8;
    c->bears = lar_calloc(bytes, 1);
    if (!c->bears) return lar_fail_memory(error, bytes, "supports and loads");
    for (int32_t n = 0; n < nodes; n++)
        if (share->loads[n] == share->thread) c->bears[n / 8] |= (uint8_t)(1u << n % 8);
    return LAR_OK;
}

LAR_SETUP lar_status lar_conditions_create(const lar_model *model, const int32_t *local,
                                           const lar_condition_share *share, lar_conditions *c,
                                           lar_error *error) {
    *c = (lar_conditions){0};
    size_t constraints = 0, forces = 0, springs = 0, pressures = 0;
    for (int i = 0; i < model->fix_count; i++)
        constraints += 3u * (size_t)model->fix[i].nodes.count;
    for (int i = 0; i < model->move_count; i++)
        constraints += 3u * (size_t)model->move[i].nodes.count;
    for (int i = 0; i < model->load_count; i++) forces += (size_t)model->load[i].nodes.count;
    for (int i = 0; i < model->spring_count; i++) springs += (size_t)model->spring[i].nodes.count;
    for (int i = 0; i < model->pressure_count; i++) pressures += (size_t)model->pressure[i].count;
    size_t nodes = (size_t)model->mesh.node_count;
    lar_status status = allocate(c, nodes, constraints, forces, springs, pressures, error);
    if (!status && share) status = note_bearers(share, model->mesh.node_count, c, error);
    if (status) {
        lar_conditions_destroy(c);
        return status;
    }
    c->local = local;

    list_constraints(c, model, local, share);
    for (int i = 0; i < model->load_count; i++) add_forces(c, local, share, &model->load[i]);
    for (int i = 0; i < model->spring_count; i++) add_springs(c, local, share, &model->spring[i]);
    for (int i = 0; i < model->pressure_count; i++)
        for (int32_t k = 0; k < model->pressure[i].count; k++) {
            int32_t face = model->pressure[i].face[k];
            if (share && share->presses[face / 6] != share->thread) continue;
            add_pressure(c, &model->mesh, local, face, &model->pressure[i]);
        }
    if (share) {
        free(c->held);
        c->held = NULL;
    }
    return LAR_OK;
}

void lar_conditions_destroy(lar_conditions *c) {
    free(c->constraint);
    free(c->force);
    free(c->spring);
    free(c->pressure);
    free(c->held);
    free(c->bears);
    *c = (lar_conditions){0};
}

LAR_SETUP lar_status lar_condition_notes_create(const lar_conditions *c, lar_condition_notes *notes,
                                                lar_error *error) {
    size_t moved = (size_t)(c->constraint_count - c->fixed_count);
    size_t forces = (size_t)c->force_count + (size_t)c->spring_count;
    size_t pressures = (size_t)c->pressure_count;
    *notes = (lar_condition_notes){.constraint_count = c->constraint_count,
                                   .fixed_count = c->fixed_count,
                                   .constraint = c->constraint,
                                   .held = c->held,
                                   .moved = lar_calloc(moved, sizeof *notes->moved),
                                   .force = lar_calloc(forces, sizeof *notes->force),
                                   .pressure = lar_calloc(pressures, sizeof *notes->pressure)};
    if (notes->moved && notes->force && notes->pressure) return LAR_OK;
    lar_condition_notes_destroy(notes);
    return lar_fail_memory(error,
                           moved * sizeof *notes->moved + forces * sizeof *notes->force +
                               pressures * sizeof *notes->pressure,
                           "supports and loads");
}

static void free_supports(lar_condition_notes *notes) {
    if (notes->mark) free(notes->constraint);
    free(notes->mark);
    free(notes->moved);
}

void lar_condition_notes_destroy(lar_condition_notes *notes) {
    free_supports(notes);
    free(notes->force);
    free(notes->pressure);
    *notes = (lar_condition_notes){0};
}

/* How many axes are held at most. */
static size_t count_axes(const uint8_t *mark, size_t nodes) {
    size_t count = 0;
    for (size_t n = 0; n < nodes; n++) count += mark[n] & LAR_AXIS_ALL ? 3 : 0;
    return count;
}

/* Those of the model where nothing else was set, and behind them what is held where it is. */
static void list_supports(lar_conditions *made, const lar_conditions *c, const lar_model *model,
                          const lar_condition_share *share, const uint8_t *mark) {
    int32_t nodes = model->mesh.node_count;
    for (int32_t n = 0; n < nodes; n++) made->held[n] = mark[n] / LAR_SUPPORT_SET;
    list_constraints(made, model, c->local, share);
    for (int32_t n = 0; n < nodes; n++) {
        made->held[n] = 0;
        add_constraints(made, c->local, share, &(lar_node_list){1, &n},
                        mark[n] & (mark[n] / LAR_SUPPORT_SET),
                        (lar_constraint){.curve = LAR_CURVE_HERE, .rigid = -1});
    }
}

LAR_SETUP lar_status lar_condition_notes_set(const lar_conditions *c, const lar_model *model,
                                             const lar_condition_share *share,
                                             const lar_supports *set, lar_condition_notes *notes,
                                             lar_error *error) {
    size_t nodes = (size_t)model->mesh.node_count;
    lar_conditions made = {0};
    lar_moved_axis *moved = NULL;
    uint8_t *mark = lar_calloc(nodes, 1);
    if (!mark) return lar_fail_memory(error, nodes, "supports");
    lar_supports_mark(set, model, mark);
    size_t axes = count_axes(mark, nodes);
    lar_status status = allocate(&made, nodes, axes, 0, 0, 0, error);
    if (!status && !(moved = lar_calloc(axes, sizeof *moved)))
        status = lar_fail_memory(error, axes * sizeof *moved, "supports");
    if (!status) {
        list_supports(&made, c, model, share, mark);
        free_supports(notes);
        notes->constraint_count = made.constraint_count;
        notes->fixed_count = made.fixed_count;
        notes->constraint = made.constraint;
        notes->held = notes->mark = mark;
        notes->moved = moved;
        notes->set = *set;
        made.constraint = NULL;
        mark = NULL;
    }
    free(mark);
    lar_conditions_destroy(&made);
    return status;
}

/* Of a load, for the time that it changes velocities for. */
static double factor_at(const lar_condition_context *context, int curve, double time) {
    return curve < 0 ? 1 : lar_curve_mean(&context->model->curve[curve], time, context->mean_step);
}

/* Subtracts an external force from the residual, in force units, rounded to nearest. False, and
 * that part left out, where the sum would come near the end of the integers. */
static bool add_external(lar_state *state, int32_t node, double scale, const double external[3]) {
    bool fits = true;
    for (int i = 0; i < 3; i++) {
        double units = external[i] * scale;
        int64_t *force = &state->force[lar_state_at(state, node, i)];
        if (fabs(units) + fabs((double)*force) < 0x1p60)
            *force -= llrint(units);
        else
            fits = false;
    }
    return fits;
}

/* Corner forces of a pressure that follows the deformed face: -p integral N_a (x_r cross x_s) over
 * the bilinear quadrilateral, exact with 2x2 Gauss points. */
static void pressure_forces(const double x[4][3], double pressure, double force[4][3]) {
    static const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    memset(force, 0, 12 * sizeof(double));
    for (int g = 0; g < 4; g++) {
        double r = sign[g][0] / sqrt(3.0), s = sign[g][1] / sqrt(3.0);
        double xr[3] = {0}, xs[3] = {0};
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) {
                xr[i] += x[a][i] * sign[a][0] * (1 + sign[a][1] * s) / 4;
                xs[i] += x[a][i] * sign[a][1] * (1 + sign[a][0] * r) / 4;
            }
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double normal = xr[j] * xs[k] - xr[k] * xs[j];
            for (int a = 0; a < 4; a++)
                force[a][i] -= pressure * normal * (1 + sign[a][0] * r) * (1 + sign[a][1] * s) / 4;
        }
    }
}

static double half_work(const double force[3], const double *v, double dt) {
    return 0.5 * dt * (force[0] * v[0] + force[1] * v[1] + force[2] * v[2]);
}

static double half_work_on(const double force[3], const lar_state *state, int32_t node, double dt) {
    double v[3];
    lar_state_velocity(state, node, v);
    return half_work(force, v, dt);
}

/* Half the work of gravity that follows a curve. (Constant gravity is a potential.) */
static double gravity_half_work(const lar_condition_context *context, double time,
                                const lar_state *state) {
    double gravity[3], momentum[3] = {0};
    lar_gravity_at(context->model, context->settings, time, context->mean_step, gravity);
    for (int32_t n = context->first; n < context->end; n++) {
        double weight = context->weight[n];
        if (context->added && weight > 0) weight -= context->added[n];
        for (int i = 0; i < 3; i++) momentum[i] += weight * state->v[lar_state_at(state, n, i)];
    }
    return half_work(gravity, momentum, context->mean_step);
}

/* ---- forces that were set ------------------------------------------------------------------ */

static bool bears(const lar_conditions *c, int32_t node) {
    return !c->bears || (c->bears[node / 8] >> node % 8 & 1);
}

/* As lar_conditions_load. */
static int32_t add_set_forces(const lar_conditions *c, const lar_condition_context *context,
                              lar_state *state) {
    int32_t beyond = -1, count = context->forces ? context->forces->count : 0;
    for (int32_t k = 0; k < count; k++) {
        const lar_force_entry *entry = &context->forces->entry[k];
        lar_force_nodes nodes = lar_force_nodes_of(context->model, entry);
        for (int32_t i = 0; i < nodes.count; i++) {
            if (!bears(c, nodes.node[i])) continue;
            int32_t n = c->local[nodes.node[i]];
            if (!add_external(state, n, context->scale, entry->force)) beyond = n;
        }
    }
    return beyond;
}

static double set_half_work(const lar_conditions *c, const lar_condition_context *context,
                            const lar_state *state) {
    int32_t count = context->forces ? context->forces->count : 0;
    double work = 0;
    for (int32_t k = 0; k < count; k++) {
        const lar_force_entry *entry = &context->forces->entry[k];
        lar_force_nodes nodes = lar_force_nodes_of(context->model, entry);
        for (int32_t i = 0; i < nodes.count; i++)
            if (bears(c, nodes.node[i]))
                work +=
                    half_work_on(entry->force, state, c->local[nodes.node[i]], context->mean_step);
    }
    return work;
}

/* ---- the step ------------------------------------------------------------------------------ */

double lar_conditions_half_work(const lar_conditions *c, const lar_condition_context *context,
                                double time, const lar_condition_notes *notes,
                                const lar_state *state) {
    double dt = context->mean_step, work = 0;
    for (int32_t i = 0; i < c->force_count; i++)
        work += half_work_on(notes->force[i], state, c->force[i].node, dt);
    for (int32_t i = 0; i < c->spring_count; i++)
        work += half_work_on(notes->force[c->force_count + i], state, c->spring[i].node, dt);
    for (int32_t i = 0; i < c->pressure_count; i++)
        for (int a = 0; a < 4; a++)
            work += half_work_on(notes->pressure[i][a], state, c->pressure[i].node[a], dt);
    if (lar_gravity_varies(context->model, context->settings))
        work += gravity_half_work(context, time, state);
    return work + set_half_work(c, context, state);
}

int32_t lar_conditions_load(const lar_conditions *c, const lar_condition_context *context,
                            double time, lar_condition_notes *notes, lar_state *state) {
    int32_t beyond = -1;
    for (int32_t i = 0; i < c->force_count; i++) {
        const lar_point_force *f = &c->force[i];
        double factor = factor_at(context, f->curve, time), *now = notes->force[i];
        for (int k = 0; k < 3; k++) now[k] = factor * f->force[k];
        if (!add_external(state, f->node, context->scale, now)) beyond = f->node;
    }
    for (int32_t i = 0; i < c->spring_count; i++) {
        const lar_point_spring *s = &c->spring[i];
        double *now = notes->force[c->force_count + i];
        for (int k = 0; k < 3; k++)
            now[k] = -s->stiffness * state->u[lar_state_at(state, s->node, k)];
        if (!add_external(state, s->node, context->scale, now)) beyond = s->node;
    }
    for (int32_t i = 0; i < c->pressure_count; i++) {
        const lar_face_pressure *p = &c->pressure[i];
        double x[4][3], (*now)[3] = notes->pressure[i];
        for (int a = 0; a < 4; a++)
            for (int k = 0; k < 3; k++)
                x[a][k] = p->position[a][k] + state->u[lar_state_at(state, p->node[a], k)];
        pressure_forces(x, p->pressure * factor_at(context, p->curve, time), now);
        for (int a = 0; a < 4; a++)
            if (!add_external(state, p->node[a], context->scale, now[a])) beyond = p->node[a];
    }
    int32_t set = add_set_forces(c, context, state);
    return set >= 0 ? set : beyond;
}

void lar_conditions_observe(const lar_condition_context *context, lar_condition_notes *notes,
                            lar_state *state) {
    /* The support takes it: a large reaction is no fast node. */
    for (int32_t i = 0; i < notes->fixed_count; i++)
        state->force[lar_constraint_at(state, &notes->constraint[i])] = 0;
    for (int32_t i = notes->fixed_count; i < notes->constraint_count; i++) {
        lar_constraint *constraint = &notes->constraint[i];
        size_t value = lar_constraint_at(state, constraint);
        int64_t *force = &state->force[value];
        notes->moved[i - notes->fixed_count] =
            (lar_moved_axis){(double)*force / context->scale, state->v[value]};
        if (constraint->curve == LAR_CURVE_HERE) constraint->by = state->u[value];
        *force = 0;
    }
}

/* ---- motion --------------------------------------------------------------------------------- */

/* A rigid motion: u = turn X + shift, `turn` being the rotation less the identity. */
typedef struct rigid {
    double turn[3][3], shift[3];
} rigid;

/* One screw: Rodrigues' formula, with an angle of any size. */
LAR_SETUP static rigid screw_at(const lar_screw *screw, double factor) {
    double sine, cosine, k[3][3], square[3][3];
    lar_sine_cosine(0.5 * remainder(factor * screw->angle, 2 * LAR_PI), &sine, &cosine);
    const double s = 2 * sine * cosine, versine = 2 * sine * sine, *a = screw->axis;
    rigid out = {0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            square[i][j] = a[i] * a[j] - (i == j);
            k[i][j] = i == j ? 0 : ((i + 1) % 3 == j ? -1 : 1) * a[3 - i - j];
        }
    for (int i = 0; i < 3; i++) {
        out.shift[i] = factor * screw->slide * a[i];
        for (int j = 0; j < 3; j++) {
            out.turn[i][j] = s * k[i][j] + versine * square[i][j];
            out.shift[i] -= out.turn[i][j] * screw->point[j];
        }
    }
    return out;
}

/* First one, then the next. */
LAR_SETUP static rigid behind(const rigid *first, const rigid *next) {
    rigid out = *first;
    for (int i = 0; i < 3; i++) {
        out.shift[i] += next->shift[i];
        for (int k = 0; k < 3; k++) {
            out.shift[i] += next->turn[i][k] * first->shift[k];
            out.turn[i][k] += next->turn[i][k];
            for (int j = 0; j < 3; j++) out.turn[i][j] += next->turn[i][k] * first->turn[k][j];
        }
    }
    return out;
}

/* What a tool moves as it goes from where it is at rest to a pose. */
LAR_SETUP static rigid carried_to(const lar_tool_pose *rest, const lar_tool_pose *pose) {
    double back[4], q[4];
    lar_quaternion_inverse(rest->orientation, back);
    lar_quaternion_product(pose->orientation, back, q);
    rigid out;
    for (int j = 0; j < 3; j++) {
        const double axis[3] = {j == 0, j == 1, j == 2};
        double turned[3];
        lar_turn(q, axis, turned);
        for (int i = 0; i < 3; i++) out.turn[i][j] = turned[i] - axis[i];
    }
    for (int i = 0; i < 3; i++)
        out.shift[i] = pose->position[i] - rest->position[i] - lar_dot(out.turn[i], rest->position);
    return out;
}

/* What all constraints of an entry have in common at one time: they stand one behind the other. */
typedef struct course {
    double time;
    const lar_condition_context *context; /* NULL: tools are at rest */
    const lar_state *state;
    int32_t ahead;        /* 0: at the beginning of the part of the step, 1: at its end */
    int32_t curve, rigid; /* whose it is; -1: nobody's yet */
    double factor;
    struct rigid motion;
} course;

LAR_SETUP static void find_carried(course *now) {
    const lar_condition_context *context = now->context;
    lar_tool_pose pose;
    now->motion = (rigid){0};
    if (!context || !context->tools) return;
    lar_tool_pose_now(&context->tools->motion[now->rigid], now->state, now->ahead,
                      context->whole_step, &pose);
    now->motion = carried_to(&context->list->tool[now->rigid].rest, &pose);
}

LAR_SETUP static void find_course(const lar_model *model, const lar_constraint *constraint,
                                  course *now) {
    now->curve = constraint->curve;
    now->rigid = constraint->rigid;
    if (now->curve == LAR_CURVE_TOOL) {
        find_carried(now);
        return;
    }
    if (now->rigid < 0) {
        now->factor = lar_curve_value(&model->curve[now->curve], now->time);
        return;
    }
    const lar_move *move = &model->move[now->rigid];
    now->motion = (rigid){0};
    for (int k = 0; k < move->screw_count; k++) {
        const lar_screw *screw = &move->screw[k];
        double factor = lar_curve_value(&model->curve[screw->curve], now->time);
        rigid next = screw_at(screw, factor);
        now->motion = behind(&now->motion, &next);
    }
}

static double value_in(const lar_model *model, const lar_constraint *constraint, course *now) {
    if (constraint->curve < 0 && constraint->curve != LAR_CURVE_TOOL) return constraint->by;
    if (now->curve != constraint->curve || now->rigid != constraint->rigid)
        find_course(model, constraint, now);
    if (now->rigid < 0) return constraint->by * now->factor;
    const double *at = model->mesh.position[constraint->point];
    const double *turn = now->motion.turn[constraint->axis];
    return now->motion.shift[constraint->axis] +
           (turn[0] * at[0] + turn[1] * at[1] + turn[2] * at[2]);
}

double lar_constraint_value(const lar_model *model, const lar_constraint *constraint, double time) {
    course now = {.time = time, .curve = -1, .rigid = -1};
    return value_in(model, constraint, &now);
}

double lar_constraint_velocity(const lar_condition_context *context,
                               const lar_constraint *constraint, double time,
                               const lar_state *state) {
    const double dt = context->time_step;
    course now = {time, context, state, 0, .curve = -1, .rigid = -1};
    course next = {time + dt, context, state, 1, .curve = -1, .rigid = -1};
    return (value_in(context->model, constraint, &next) -
            value_in(context->model, constraint, &now)) /
           dt;
}

/* The kernel moved what stands still as if it were free, and counted that as damped motion. */
static double hold(const lar_condition_notes *notes, const double *weight, lar_state *state) {
    double counted = 0, *restrict u = state->u, *restrict v = state->v;
    for (int32_t i = 0; i < notes->fixed_count; i++) {
        size_t value = lar_constraint_at(state, &notes->constraint[i]);
        counted += weight[notes->constraint[i].node] * v[value] * v[value];
        u[value] = v[value] = 0;
    }
    return counted;
}

double lar_conditions_impose(const lar_condition_context *context, double time,
                             const lar_condition_notes *notes, lar_state *state) {
    const lar_model *model = context->model;
    double damping = lar_damping_of(model, context->settings), gravity[3], work = 0;
    double dt = context->time_step, step = context->mean_step;
    double share = damping * step / context->whole_step;
    course was = {time, context, state, 0, .curve = -1, .rigid = -1};
    course next = {time + dt, context, state, 1, .curve = -1, .rigid = -1};
    lar_gravity_at(model, context->settings, time, context->mean_step, gravity);
    state->damped -= share * hold(notes, context->weight, state);
    for (int32_t i = notes->fixed_count; i < notes->constraint_count; i++) {
        const lar_constraint *constraint = &notes->constraint[i];
        const lar_moved_axis *noted = &notes->moved[i - notes->fixed_count];
        size_t value = lar_constraint_at(state, constraint);
        double *u = &state->u[value], *v = &state->v[value];
        double mass = context->mass[constraint->node], weight = context->weight[constraint->node];
        double before = noted->before, free = before + *v;
        double old = value_in(model, constraint, &was);
        *u = value_in(model, constraint, &next);
        *v = (*u - old) / dt;
        if (fabs(*v) > state->fastest) state->fastest = fabs(*v);
        state->damped += share * weight * ((before + *v) * (before + *v) - free * free);
        /* What the support must add for the node to move so: m a + c m v - m g + residual. */
        double mean = 0.5 * (*v + before);
        double acceleration = (*v - before) / step;
        double reaction =
            mass * (acceleration + damping * mean - gravity[constraint->axis]) + noted->force;
        if (weight > 0) work += reaction * mean * step;
    }
    return work;
}

double lar_conditions_largest(const lar_conditions *c) {
    double largest = 0;
    for (int32_t i = 0; i < c->force_count; i++)
        for (int k = 0; k < 3; k++) largest = fmax(largest, fabs(c->force[i].force[k]));
    return largest;
}
