/* Going back to the start, saving and loading, as the public header has them. */
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "simulation/checkpoint.h"
#include "simulation/simulation.h"
#include "step/guard.h"
#include "step/rigid/free_body.h"
#include "step/viscous_history.h"

/* ---- the start ------------------------------------------------------------------------------- */

/* Where a deck prescribes a displacement from time 0 on, the body starts with it: energies begin
 * with what that holds (lar_energy: "+ start"), and nothing jumps in the first step. */
static void set_initial_displacements(lar_simulation *simulation) {
    const lar_conditions *conditions = &simulation->domain.surroundings.conditions;
    for (int32_t i = 0; i < conditions->constraint_count; i++) {
        const lar_constraint *c = &conditions->constraint[i];
        double value = lar_constraint_value(simulation->domain.model, c, 0);
        if (value != 0) /* never -0: it has other bits */
            simulation->state.u[lar_constraint_at(&simulation->state, c)] = value;
    }
}

/* The first step: v' = keep v + p. */
typedef struct first_step {
    lar_leapfrog leapfrog;
    const lar_domain *domain;
} first_step;

/* With gravity, as its curve says, and damping that are set. */
static first_step first_of(const lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    const lar_settings *settings = &simulation->tools.settings;
    const double dt = domain->time_step, half = 0.5 * lar_damping_of(domain->model, settings) * dt;
    first_step first = {.domain = domain};
    first.leapfrog.keep = (1 - half) / (1 + half);
    first.leapfrog.push = (1 + 0.5 * domain->model->damping * dt) / (1 + half);
    lar_gravity_at(domain->model, settings, 0, dt, first.leapfrog.drift);
    double *drift = first.leapfrog.drift; /* step.c has the same order of operations */
    for (int i = 0; i < 3; i++) drift[i] = drift[i] * dt / (1 + half);
    return first;
}

static double first_push(const first_step *first, const lar_state *state, lar_lid node, int axis) {
    const double push = first->leapfrog.push * first->domain->push[node];
    return first->leapfrog.drift[axis] -
           push * (double)state->force[lar_state_at(state, node, axis)];
}

/* Of a node at entry `entry` of the planes: where a plane bears it from the start on, it does so
 * half a step before, too. Otherwise it would come up from below and be stopped, by a plane that
 * gives what it never took. Who flies onto a plane is stopped. Returns the entry behind its last.
 */
static int32_t start_on_planes(const first_step *begin, int32_t entry, lar_state *state) {
    static const double ALONG = 1e-9; /* of what is free: it neither leaves nor comes */
    const lar_domain *domain = begin->domain;
    const lar_planes *planes = &domain->surroundings.planes;
    const lar_condition_context context = lar_domain_context(domain);
    const lar_lid node = planes->node[entry].node;
    double v[3], free[3], ahead[3];
    lar_state_velocity(state, node, v);
    for (int i = 0; i < 3; i++) {
        free[i] = begin->leapfrog.keep * v[i] + first_push(begin, state, node, i);
        ahead[i] = free[i];
    }
    const int32_t first = entry;
    entry = lar_planes_ahead(planes, &context, state, entry, ahead);
    for (int32_t k = first; k < entry; k++) {
        const double *normal = planes->way[planes->node[k].way].normal;
        double start = 0.5 * (lar_dot(normal, v) + lar_dot(normal, free));
        if (start < -ALONG * lar_length(free)) return entry;
    }
    for (int i = 0; i < 3; i++) state->v[lar_state_at(state, node, i)] -= ahead[i] - free[i];
    return entry;
}

/* The velocities half a step BEFORE the start, such that those half a step before and after it
 * have the given ones as their mean: v' = keep v + p with p = drift - push f gives
 * v = (2 v0 - p) / (1 + keep). Starting with v0 itself would cost half a step. */
static void set_initial_velocities(lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    lar_state *state = &simulation->state;
    const lar_model *model = domain->model;
    const first_step begin = first_of(simulation);
    for (int i = 0; i < model->initial_count; i++) {
        const lar_initial_velocity *initial = &model->initial[i];
        for (int32_t k = 0; k < initial->nodes.count; k++)
            lar_axes_put(state->v, state->stride, domain->layout.local[initial->nodes.node[k]],
                         initial->velocity);
    }
    lar_fault ignored = {0};
    lar_step_forces(domain, &simulation->scratch->measure.interactions, state, &ignored);
    for (lar_gid g = 0; g < model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) {
            lar_lid node = domain->layout.local[g];
            size_t value = lar_state_at(state, node, i);
            double push = first_push(&begin, state, node, i);
            state->v[value] = (2 * state->v[value] - push) / (1 + begin.leapfrog.keep);
        }
    for (int32_t i = 0; i < domain->surroundings.conditions.constraint_count; i++) {
        const lar_constraint *c = &domain->surroundings.conditions.constraint[i];
        if (c->curve != LAR_CURVE_TOOL || !model->tool[c->rigid].free)
            state->v[lar_constraint_at(state, c)] = 0;
    }
    for (int32_t entry = 0; entry < domain->surroundings.planes.count;)
        entry = start_on_planes(&begin, entry, state);
    memset(state->force, 0, 3 * state->stride * sizeof *state->force);
    if (lar_free_bodies_any(model))
        lar_free_bodies_start(domain, &simulation->scratch->measure.interactions.notes, state,
                              &simulation->tools);
}

lar_status lar_simulation_set_anew(lar_simulation *simulation, lar_error *error) {
    lar_state *state = &simulation->state;
    lar_simulation_set(simulation);
    /* Several processors have the state, of which the whole may know nothing yet. */
    if (lar_simulation_steps(simulation) > 0 || state->part > 0) return LAR_OK;
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    memset(state->v, 0, 3 * state->stride * sizeof *state->v);
    set_initial_velocities(simulation);
    state->external = 0;
    return lar_simulation_take_up(simulation, error);
}

void lar_simulation_set_start(lar_simulation *simulation) {
    lar_state *state = &simulation->state;
#define LAR_STATE_CLEAR(type, name, of_node, of_history, kept)                                     \
    if (state->name)                                                                               \
        memset(state->name, 0, LAR_STATE_SIZE(state, of_node, of_history) * sizeof(type));
    LAR_STATE_ARRAYS(LAR_STATE_CLEAR)
#undef LAR_STATE_CLEAR
    state->step = 0;
    state->part = 0;
    state->parts = 1;
    state->listed = false;
    state->damped = state->external = state->contact = state->exchanged = 0;
    simulation->measured = simulation->taken = 0;
    lar_tools_reset(&simulation->list, &simulation->tools);
    lar_simulation_settle(simulation);
    set_initial_displacements(simulation);
    set_initial_velocities(simulation);
    lar_interactions_forget(&simulation->interactions);
}

/* ---- going back ------------------------------------------------------------------------------ */

static lar_status check_whole(const lar_simulation *simulation, lar_error *error) {
    return simulation->computer ? lar_computer_check(simulation->computer, error) : LAR_OK;
}

/* Only what carries the state from one step to the next. A run that breaks off may do so between
 * the parts of a step; copies are made between steps. */
static void copy_state(const lar_state *from, lar_state *to) {
    to->step = from->step;
    to->part = 0;
    to->parts = 1;
    to->listed = false;
    to->damped = from->damped;
    to->external = from->external;
    to->contact = from->contact;
    to->exchanged = from->exchanged;
#define LAR_STATE_COPY(type, name, of_node, of_history, kept)                                      \
    if ((kept) && from->name && to->name)                                                          \
        memcpy(to->name, from->name, LAR_STATE_SIZE(from, of_node, of_history) * sizeof(type));
    LAR_STATE_ARRAYS(LAR_STATE_COPY)
#undef LAR_STATE_COPY
}

/* Forces are of no step then, and what contact remembers is of another state. */
static void put_state(lar_simulation *simulation, const lar_state *state) {
    copy_state(state, &simulation->state);
    memset(simulation->state.force, 0,
           3 * simulation->state.stride * sizeof *simulation->state.force);
    lar_interactions_forget(&simulation->interactions);
}

/* The start takes as long as ten steps to compute, and is always the same: who goes back there may
 * do so often, so it is kept from the first time on, where there is memory for it. */
static void go_to_start(lar_simulation *simulation) {
    const lar_state *state = &simulation->state;
    lar_state *start = &simulation->start;
    if (start->u) {
        put_state(simulation, start);
        lar_tools_reset(&simulation->list, &simulation->tools);
        return;
    }
    lar_simulation_set_start(simulation);
    if (!lar_state_create(start, state->node_count, state->history_count, NULL))
        copy_state(state, start);
}

lar_status lar_simulation_reset(lar_simulation *simulation, lar_error *error) {
    lar_status status = lar_simulation_check_idle(simulation, "lar_simulation_reset", error);
    if (!status) status = check_whole(simulation, error);
    if (status) return status;
    go_to_start(simulation);
    return lar_simulation_take_up(simulation, error);
}

/* What is kept of a state has no list of what its step leaves to the next one: it is counted there.
 * (Where several compute, gathering has.) */
static void count_all(const lar_simulation *simulation, lar_state *copy) {
    if (simulation->computer) return;
    lar_guard_half_to_come(&simulation->domain, &simulation->state, &copy->contact,
                           &copy->external);
}

lar_status lar_simulation_copy(const lar_simulation *simulation, lar_state *state, lar_tools *tools,
                               lar_error *error) {
    if (simulation->fault.kind)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "the state at step %llu is not kept: the run has broken off, and would "
                        "again from here; load an earlier checkpoint or go back to the start",
                        (unsigned long long)lar_simulation_steps(simulation));
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    copy_state(&simulation->state, state);
    count_all(simulation, state);
    *tools = simulation->tools;
    return LAR_OK;
}

/* `history`: of all elements of the model, where the state has none of its own. */
static lar_status take_state(lar_simulation *simulation, const lar_state *state,
                             const double *history, const lar_tools *tools, lar_error *error) {
    lar_status status = check_whole(simulation, error);
    if (status) return status;
    put_state(simulation, state);
    if (history) lar_viscous_scatter(&simulation->domain, &simulation->state, history);
    simulation->tools = *tools;
    return lar_simulation_take_up(simulation, error);
}

lar_status lar_simulation_go_back(lar_simulation *simulation, const lar_state *state,
                                  const lar_tools *tools, lar_error *error) {
    return take_state(simulation, state, NULL, tools, error);
}

static lar_status check_path(const char *path, const char *call, lar_error *error) {
    if (path && *path) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs the path of a checkpoint", call);
}

lar_status lar_simulation_pack(const lar_simulation *simulation, const char *path, lar_bytes *bytes,
                               lar_error *error) {
    if (simulation->fault.kind)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "%s: is not written: the run has broken off, and would again from here; "
                        "load an earlier checkpoint or go back to the start",
                        path);
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    lar_state all = simulation->state; /* its arrays are lent */
    count_all(simulation, &all);
    return lar_checkpoint_pack(path, &simulation->domain, &all, &simulation->tools, bytes, error);
}

lar_status lar_simulation_unpack(lar_simulation *simulation, const char *path,
                                 const lar_bytes *bytes, lar_error *error) {
    lar_status status = check_whole(simulation, error);
    if (status) return status;
    lar_checkpoint *checkpoint = lar_calloc(1, sizeof *checkpoint);
    if (!checkpoint) return lar_fail_memory(error, sizeof *checkpoint, "a checkpoint");
    status = lar_checkpoint_parse(path, bytes, &simulation->domain, checkpoint, error);
    if (!status)
        lar_checkpoint_take(checkpoint, &simulation->domain, &simulation->state,
                            &simulation->tools);
    free(checkpoint);
    if (status) return status;
    lar_interactions_forget(&simulation->interactions);
    return lar_simulation_take_up(simulation, error);
}

lar_status lar_simulation_save(const lar_simulation *simulation, const char *path,
                               lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_save", error);
    if (!status) status = check_path(path, "lar_simulation_save", error);
    if (!status) status = lar_simulation_pack(simulation, path, &bytes, error);
    if (!status) status = lar_checkpoint_store(path, &bytes, error);
    lar_bytes_free(&bytes);
    return status;
}

lar_status lar_simulation_load(lar_simulation *simulation, const char *path, lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_simulation_check_idle(simulation, "lar_simulation_load", error);
    if (!status) status = check_path(path, "lar_simulation_load", error);
    if (!status) status = lar_checkpoint_read(path, &bytes, error);
    if (!status) status = lar_simulation_unpack(simulation, path, &bytes, error);
    lar_bytes_free(&bytes);
    return status;
}

/* ---- in memory ------------------------------------------------------------------------------- */

struct lar_saved {
    lar_simulation_info of;
    bool full;       /* something has been saved */
    lar_state state; /* of the nodes, which are the same on every grid */
    double *history; /* of the elements, in the order of the model; NULL: nothing is viscous */
    lar_tools tools;
    /* What tools felt in the last advance, and how many steps that was. */
    lar_tool_sum felt[LAR_TOOLS_MAX];
    double depth[LAR_TOOLS_MAX];
    uint64_t steps;
};

lar_status lar_saved_create(const lar_simulation *simulation, lar_saved **out, lar_error *error) {
    if (!simulation || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_saved_create needs a simulation and a place for the saved state");
    lar_saved *saved = lar_calloc(1, sizeof *saved);
    if (!saved) return lar_fail_memory(error, sizeof *saved, "a saved state");
    size_t values = lar_viscous_total(&simulation->domain);
    lar_status status = lar_state_create(&saved->state, simulation->state.node_count, 0, error);
    if (!status && values > 0 && !(saved->history = lar_calloc(values, sizeof *saved->history)))
        status = lar_fail_memory(error, values * sizeof *saved->history, "a saved state");
    lar_simulation_inspect(simulation, &saved->of);
    if (status)
        lar_saved_destroy(saved);
    else
        *out = saved;
    return status;
}

void lar_saved_destroy(lar_saved *saved) {
    if (!saved) return;
    lar_state_destroy(&saved->state);
    free(saved->history);
    free(saved);
}

static lar_status check_saved(const lar_simulation *simulation, const lar_saved *saved,
                              const char *call, lar_error *error) {
    lar_simulation_info of;
    lar_status status = lar_simulation_check_zero(simulation, call, error);
    if (status) return status;
    if (!saved)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs a place of lar_saved_create", call);
    lar_simulation_inspect(simulation, &of);
    if (of.model == saved->of.model && simulation->state.node_count == saved->state.node_count &&
        of.element == saved->of.element && of.tools == saved->of.tools &&
        of.spares == saved->of.spares && of.time_step == saved->of.time_step)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s: this place is for a simulation of another model, element, time step or "
                    "number of tools; create one for this simulation",
                    call);
}

lar_status lar_simulation_save_to(const lar_simulation *simulation, lar_saved *saved,
                                  lar_error *error) {
    lar_status status = check_saved(simulation, saved, "lar_simulation_save_to", error);
    if (!status) status = lar_simulation_copy(simulation, &saved->state, &saved->tools, error);
    if (status) return status;
    const lar_interval *interval =
        simulation->computer ? &simulation->computer->interval : &simulation->interval;
    if (saved->history) lar_viscous_gather(&simulation->domain, &simulation->state, saved->history);
    memcpy(saved->felt, simulation->report.tool, sizeof saved->felt);
    memcpy(saved->depth, interval->depth, sizeof saved->depth);
    saved->steps = simulation->report_steps;
    saved->full = true;
    return LAR_OK;
}

lar_status lar_simulation_load_from(lar_simulation *simulation, const lar_saved *saved,
                                    lar_error *error) {
    static const char call[] = "lar_simulation_load_from";
    lar_status status = lar_simulation_check_idle(simulation, call, error);
    if (!status) status = check_saved(simulation, saved, call, error);
    if (!status && !saved->full)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "nothing has been saved there; call lar_simulation_save_to before");
    if (!status)
        status = take_state(simulation, &saved->state, saved->history, &saved->tools, error);
    if (status) return status;
    lar_interval *interval =
        simulation->computer ? &simulation->computer->interval : &simulation->interval;
    memcpy(simulation->report.tool, saved->felt, sizeof saved->felt);
    memcpy(interval->depth, saved->depth, sizeof saved->depth);
    simulation->report_steps = saved->steps;
    return LAR_OK;
}
