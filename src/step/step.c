#include "step/step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/tool_friction.h"
#include "step/activation.h"
#include "step/guard.h"
#include "step/mass/pressed.h"
#include "step/rigid/free_body.h"
#include "step/viscous_history.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"

/* Of several elements in a step the first of the mesh, whoever computes them. */
static void fault_element(lar_fault *fault, const lar_state *state, lar_gid e) {
    if (!fault->kind || (fault->kind == LAR_FAULT_ELEMENT && fault->step == state->step &&
                         fault->part == state->part && e < fault->element))
        *fault = (lar_fault){
            .kind = LAR_FAULT_ELEMENT, .element = e, .step = state->step, .part = state->part};
}

/* Forces of run r. `keeps`: the step counts, and what viscous elements remember goes on. */
static int64_t recover_run(const lar_domain *domain, int32_t r, bool keeps,
                           lar_hex8_monitor *monitor, lar_state *state) {
    const lar_block_run *run = &domain->run[r];
    if (!run->viscous && !run->fibrous && !run->folds)
        return domain->kernels->recover(run, state->u, state->force, &domain->limits, monitor);
    lar_viscous_step step = {.length = state->past, .keep = keeps};
    lar_active_step active;
    bool activates = lar_activation_begin(domain, r, state, &active);
    if (run->viscous) step.history = state->history + domain->run_history[r];
    if (keeps && state->strained) step.beyond = state->strained->beyond + domain->run_first[r];
    int64_t found =
        domain->kernels->recover_more(run, run->viscous ? &step : NULL, activates ? &active : NULL,
                                      state->u, state->force, &domain->limits, monitor);
    if (activates && keeps) state->external += lar_activation_change(domain, r, &active, state);
    return found;
}

/* A viscous run has elements beyond the limits, the first of them in block `first`; its kernel has
 * noted which. Their elastic stress says nothing of theirs, and what they remember has gone on. */
static void fault_viscous(const lar_domain *domain, int32_t r, int32_t first, lar_state *state,
                          lar_fault *fault) {
    for (int32_t b = first; b < domain->run[r].count; b++) {
        const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + b];
        uint8_t *beyond = &state->strained->beyond[domain->run_first[r] + b];
        for (int lane = 0; lane < LAR_BLOCK; lane++)
            if ((*beyond >> lane & 1) && lanes->element[lane] >= 0)
                fault_element(fault, state, lanes->element[lane]);
        *beyond = 0;
    }
}

/* A run has elements beyond the limits, the first of them in the block that `found` says;
 * `watched`: hourglass forces were looked at, too. Forces no longer count. */
static void fault_run(const lar_domain *domain, int32_t r, int64_t found, bool watched,
                      lar_state *state, lar_fault *fault) {
    lar_active_step active;
    bool activates = lar_activation_begin(domain, r, state, &active);
    lar_block_run one = domain->run[r];
    size_t size = lar_run_stride(&one);
    if (one.viscous) {
        fault_viscous(domain, r, (int32_t)(found >> 8), state, fault);
        return;
    }
    one.count = 1;
    for (int32_t b = (int32_t)(found >> 8); b < domain->run[r].count; b++) {
        int32_t listed[LAR_BLOCK];
        float strain[LAR_BLOCK][LAR_STRAIN_NUMBERS];
        size_t place = LAR_BLOCK * (size_t)(domain->run_first[r] + b);
        lar_hex8_monitor watch = {
            .limit = domain->corner_limit + place, .lane = listed, .strain = strain};
        lar_hex8_monitor *monitor = watched ? &watch : NULL;
        one.blocks = (const char *)domain->run[r].blocks + (size_t)b * size;
        one.more = domain->run[r].more ? domain->run[r].more + b : NULL;
        if (one.fibrous) one.fibres = domain->run[r].fibres + b;
        if (one.second) one.second = domain->run[r].second + b;
        if (one.folds) one.folds = domain->run[r].folds + b;
        lar_active_step now =
            activates ? (lar_active_step){active.now + LAR_BLOCK * b, active.energy + LAR_BLOCK * b}
                      : (lar_active_step){0};
        found =
            one.fibrous || one.folds
                ? domain->kernels->recover_more(&one, NULL, activates ? &now : NULL, state->u,
                                                state->force, &domain->limits, monitor)
                : domain->kernels->recover(&one, state->u, state->force, &domain->limits, monitor);
        const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + b];
        for (int lane = 0; lane < LAR_BLOCK; lane++)
            if (found >= 0 && (found >> lane & 1) && lanes->element[lane] >= 0)
                fault_element(fault, state, lanes->element[lane]);
    }
}

/* Whether the strained elements are looked for in this step: in the last one of an interval, so
 * that what is found is known when the next one begins. */
static bool interval_ends(const lar_domain *domain, bool close, const lar_state *state) {
    return (close || (state->step + 1) % domain->interval == 0) && state->part == 0;
}

static void recover_blocks(const lar_domain *domain, int32_t first, int32_t count, lar_state *state,
                           lar_fault *fault) {
    /* Where elements are strained, listed in every part: in a step nodes that are thrown come from
     * anywhere to the barrier and beyond. */
    bool due = interval_ends(domain, state->close, state);
    bool watches = due || state->close || !state->listed;
    for (int32_t r = first; r < first + count; r++) {
        size_t place = LAR_BLOCK * (size_t)domain->run_first[r];
        lar_hex8_monitor monitor = {.limit = domain->corner_limit + place,
                                    .area = domain->area_limit ? domain->area_limit + place : NULL,
                                    .lane = state->strained->lane + place,
                                    .strain = state->strained->strain + place};
        int64_t found = recover_run(domain, r, true, watches ? &monitor : NULL, state);
        if (watches) state->strained->listed_count[r] = monitor.count;
        if (watches)
            lar_guard_select_and_apply(domain, r, &monitor, due, state);
        else
            lar_guard_apply(domain, r, state);
        if (found >= 0) fault_run(domain, r, found, watches, state, fault);
    }
    /* Before the nodes move on: a step later the element says little. */
    if (fault->kind == LAR_FAULT_ELEMENT) lar_fault_examine(domain, state, 0, 0, fault);
}

/* The oracle elements, one at a time: slow is fine. */
static void recover_slowly(const lar_domain *domain, lar_gid e, lar_state *state,
                           lar_fault *fault) {
    const lar_model *model = domain->model;
    double corner[8][3], u[8][3], f[8][3];
    const lar_material *material = lar_domain_material(domain, e);
    lar_mesh_corners(&model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    double J = domain->kind == LAR_ELEMENT_HEX8_FULL
                   ? lar_hex8_full_force(corner, material, u, f)
                   : lar_hex8_matrix_force(corner, material, u, f);
    bool fits = J > domain->limits.min_volume;
    for (int k = 0; k < 24; k++) fits = fits && fabs(f[k / 3][k % 3]) * domain->scale < 0x1p58;
    if (!fits) {
        fault_element(fault, state, e);
        return;
    }
    for (int a = 0; a < 8; a++)
        for (int k = 0; k < 3; k++)
            state->force[lar_state_at(state, domain->layout.local[model->mesh.element[e][a]], k)] +=
                llrint(f[a][k] * domain->scale);
}

void lar_step_recover(const lar_domain *domain, int32_t first, int32_t count, lar_state *state,
                      lar_fault *fault) {
    if (domain->kind == LAR_ELEMENT_HEX8) {
        recover_blocks(domain, first, count, state, fault);
        return;
    }
    for (int32_t r = first; r < first + count; r++)
        for (int32_t b = 0; b < domain->run[r].count; b++)
            for (int lane = 0; lane < LAR_BLOCK; lane++) {
                lar_gid e = domain->layout.block[domain->run_first[r] + b].element[lane];
                if (e >= 0) recover_slowly(domain, e, state, fault);
            }
}

/* ---- how long a step is --------------------------------------------------------------------- */

const lar_step_division *lar_division_of(const lar_interactions *interactions) {
    static const lar_step_division undivided = {.parts = 1, .before = 1, .hardness = 1, .base = 1};
    return interactions->tool_contact.tools ? &interactions->tool_contact.tools->division
                                            : &undivided;
}

double lar_mean_step(const lar_domain *domain, const lar_step_division *division,
                     const lar_state *state) {
    double step = domain->time_step / division->parts;
    bool changes = state->part == 0 && state->step == division->since;
    return changes ? 0.5 * (step + domain->time_step / division->before) : step;
}

double lar_past_step(const lar_domain *domain, const lar_step_division *division,
                     const lar_state *state) {
    if (state->part > 0) return domain->time_step / state->parts;
    if (state->step == 0) return 0;
    int32_t parts = state->step == division->since ? division->before : division->parts;
    return domain->time_step / parts;
}

const lar_settings *lar_settings_of(const lar_interactions *interactions) {
    return interactions->tool_contact.tools ? &interactions->tool_contact.tools->settings : NULL;
}

static bool is_set(const lar_settings *settings) {
    return settings && (settings->gravity_set || settings->damping_set);
}

lar_leapfrog lar_step_leapfrog(const lar_domain *domain, const lar_interactions *interactions,
                               const lar_state *state) {
    const lar_step_division *division = lar_division_of(interactions);
    const lar_settings *settings = lar_settings_of(interactions);
    lar_leapfrog leapfrog = domain->leapfrog;
    double mean = lar_mean_step(domain, division, state), whole = domain->time_step;
    leapfrog.dt = whole / division->parts;
    if (mean == whole && !is_set(settings)) return leapfrog;
    double half = 0.5 * lar_damping_of(domain->model, settings) * mean;
    double half_whole = 0.5 * domain->model->damping * whole, gravity[3];
    lar_gravity_at(domain->model, settings, 0, 0, gravity);
    leapfrog.keep = (1 - half) / (1 + half);
    leapfrog.push = mean / whole * (1 + half_whole) / (1 + half);
    for (int i = 0; i < 3; i++) leapfrog.drift[i] = gravity[i] * mean / (1 + half);
    return leapfrog;
}

void lar_step_enter(const lar_domain *domain, const lar_interactions *interactions,
                    lar_condition_context *context, lar_state *state) {
    const lar_step_division *division = lar_division_of(interactions);
    if (state->part == 0) state->parts = division->parts;
    state->past = lar_past_step(domain, division, state);
    context->time_step = domain->time_step / state->parts;
    context->mean_step = lar_mean_step(domain, division, state);
    context->settings = lar_settings_of(interactions);
    context->forces =
        interactions->tool_contact.tools ? &interactions->tool_contact.tools->forces : NULL;
    context->list = interactions->tool_contact.list;
    context->tools = interactions->tool_contact.tools;
    context->held = interactions->notes.mark;
    state->hardness = division->hardness;
    state->pressed = state->strained ? state->strained->pressed : NULL;
    state->close = lar_division_is_close(division);
    state->lets_go = lar_division_lets_go(division);
    context->shares = LAR_STEP_SHARES / state->parts;
}

/* ---- supports that are set ------------------------------------------------------------------ */

/* Nodes give way to planes along their free axes, which are others then. */
LAR_SETUP static lar_status set_supports(lar_interactions *interactions, const lar_model *model,
                                         const lar_condition_share *share, const lar_supports *set,
                                         lar_error *error) {
    const lar_conditions *conditions = &interactions->surroundings->conditions;
    lar_plane_contact *contact = &interactions->tool_contact.plane_contact, fresh = {0};
    lar_planes planes;
    lar_status status = lar_planes_create(model, conditions->local, share, set, &planes, error);
    if (!status) status = lar_plane_contact_create(&planes, &fresh, error);
    if (!status)
        status =
            lar_condition_notes_set(conditions, model, share, set, &interactions->notes, error);
    if (status) {
        lar_plane_contact_destroy(&fresh);
        lar_planes_destroy(&planes);
        return status;
    }
    lar_plane_contact_destroy(contact);
    lar_planes_destroy(&interactions->planes);
    interactions->planes = planes;
    *contact = fresh;
    contact->planes = &interactions->planes;
    return LAR_OK;
}

LAR_SETUP lar_status lar_step_support(const lar_condition_context *context, const lar_supports *set,
                                      lar_interactions *interactions, lar_error *error) {
    const int32_t *local = interactions->surroundings->conditions.local;
    size_t nodes = (size_t)context->model->mesh.node_count;
    if (memcmp(&interactions->notes.set, set, sizeof *set) == 0) return LAR_OK;
    int32_t *holds = lar_calloc(nodes, sizeof *holds);
    if (!holds) return lar_fail_memory(error, nodes * sizeof *holds, "supports");
    for (size_t n = 0; n < nodes; n++)
        holds[n] = local[n] >= context->first && local[n] < context->end;
    const lar_condition_share share = {.thread = 1, .holds = holds};
    lar_status status = set_supports(interactions, context->model, &share, set, error);
    free(holds);
    return status;
}

/* ---- the parts ------------------------------------------------------------------------------ */

/* Spare nodes fall with gravity like any other; now and then they are put back. */
static void park_spares(const lar_domain *domain, const lar_condition_context *context,
                        lar_state *state) {
    for (int32_t i = 0; i < domain->spare_count; i++) {
        lar_lid n = domain->spare[i];
        if (n < context->first || n >= context->end) continue;
        lar_axes_put(state->u, state->stride, n, (const double[3]){0});
        lar_axes_put(state->v, state->stride, n, (const double[3]){0});
    }
}

lar_leapfrog lar_step_leapfrog_at(const lar_domain *domain, const lar_interactions *interactions,
                                  const lar_condition_context *context, const lar_state *state) {
    const lar_settings *settings = lar_settings_of(interactions);
    lar_leapfrog leapfrog = lar_step_leapfrog(domain, interactions, state);
    if (lar_gravity_varies(domain->model, settings)) {
        double gravity[3], damping = lar_damping_of(domain->model, settings);
        double mean = context->mean_step;
        lar_gravity_at(domain->model, settings, lar_state_time(domain, state), mean, gravity);
        for (int i = 0; i < 3; i++)
            leapfrog.drift[i] = gravity[i] * mean / (1 + 0.5 * damping * mean);
    }
    return leapfrog;
}

static void move_nodes(const lar_domain *domain, const lar_interactions *interactions,
                       const lar_condition_context *context, lar_state *state, lar_fault *fault) {
    /* Where contact is predicted from the fastest node, that is none of these. */
    bool predicts = interactions->body_contact.surface ||
                    interactions->tool_contact.plane_contact.planes->count > 0 ||
                    interactions->surroundings->faces.face_count > 0;
    uint64_t park_interval = predicts ? 4 : LAR_PARK_INTERVAL;
    lar_leapfrog leapfrog = lar_step_leapfrog_at(domain, interactions, context, state);
    double damping = lar_damping_of(domain->model, lar_settings_of(interactions)), damped = 0;
    if (state->step % park_interval == 0) park_spares(domain, context, state);
    const double *weight = damping > 0 ? domain->weight : NULL;
    state->fastest = 0;
    if (!domain->kernels->update(&leapfrog, context->first, context->end, state->stride, state->u,
                                 state->v, state->force, domain->push, weight, &damped,
                                 &state->fastest) &&
        !fault->kind)
        *fault = (lar_fault){
            .kind = LAR_FAULT_SPEED, .element = -1, .step = state->step, .part = state->part};
    state->damped += damping * damped * (context->mean_step / domain->time_step);
}

static void apply_loads(const lar_domain *domain, lar_interactions *interactions,
                        const lar_condition_context *context, double time, lar_state *state,
                        lar_fault *fault) {
    int32_t beyond = lar_conditions_load(&interactions->surroundings->conditions, context, time,
                                         &interactions->notes, state);
    if (beyond >= 0 && !fault->kind)
        *fault = (lar_fault){
            .kind = LAR_FAULT_LOAD, .element = domain->layout.global[beyond], .step = state->step};
}

/* Loads, tools and planes; half of their work when the nodes are about to move. */
static void act(const lar_domain *domain, lar_interactions *interactions,
                const lar_condition_context *context, lar_state *state, lar_fault *fault) {
    apply_loads(domain, interactions, context, lar_state_time(domain, state), state, fault);
    lar_tool_contact_apply(&interactions->tool_contact, context, state);
}

static void add_half_work(const lar_domain *domain, const lar_interactions *interactions,
                          const lar_condition_context *context, lar_state *state) {
    state->external +=
        lar_conditions_half_work(&interactions->surroundings->conditions, context,
                                 lar_state_time(domain, state), &interactions->notes, state);
    lar_tool_contact_half_work(&interactions->tool_contact, context, state);
}

/* Contact of bodies, by who has all nodes. */
static void add_body_contact(lar_body_contact *contact, const lar_condition_context *context,
                             lar_state *state, lar_fault *fault) {
    lar_body_contact_apply(contact, context, state);
    if (contact->too_many_pairs && !fault->kind)
        *fault = (lar_fault){.kind = LAR_FAULT_TOO_MANY_PAIRS, .element = -1, .step = state->step};
}

static inline void hold_up_node(const lar_domain *domain, lar_lid n, int axis, double pull,
                                lar_state *state) {
    double units = domain->added[n] * pull;
    int64_t *force = &state->force[lar_state_at(state, n, axis)];
    if (units != 0 && fabs(units) < 0x1p56)
        *force = (int64_t)((uint64_t)*force + (uint64_t)llrint(units));
}

/* Drift is gravity's for all that moves: mass without weight is held up, in whole units. A force
 * beyond these is of a run that is about to break. */
static void hold_up_added(const lar_domain *domain, const lar_interactions *interactions,
                          const lar_condition_context *context, lar_state *state) {
    const lar_burden *burden = domain->burden;
    double gravity[3];
    if (!domain->added) return;
    lar_gravity_at(domain->model, lar_settings_of(interactions), lar_state_time(domain, state),
                   context->mean_step, gravity);
    for (int axis = 0; axis < 3; axis++) {
        double pull = gravity[axis] * domain->scale;
        for (lar_lid n = context->first; domain->adds && n < context->end && pull != 0; n++)
            hold_up_node(domain, n, axis, pull, state);
        for (int32_t i = 0; !domain->adds && i < burden->node_count && pull != 0; i++)
            if (burden->node[i] >= context->first && burden->node[i] < context->end)
                hold_up_node(domain, burden->node[i], axis, pull, state);
    }
}

/* Friction of tools: all other forces are there. */
static void add_friction(const lar_domain *domain, lar_interactions *interactions,
                         const lar_condition_context *context, lar_state *state) {
    lar_tool_contact *contact = &interactions->tool_contact;
    if (!contact->press) return;
    lar_leapfrog leapfrog = lar_step_leapfrog_at(domain, interactions, context, state);
    lar_tool_friction_add(contact, context, &leapfrog, domain->push, state);
}

/* What comes when all other forces are there. */
static void add_last(const lar_domain *domain, lar_interactions *interactions,
                     const lar_condition_context *context, lar_state *state) {
    hold_up_added(domain, interactions, context, state);
    add_friction(domain, interactions, context, state);
}

/* Elements of a state that is looked at: no step follows. */
static void recover_seen(const lar_domain *domain, lar_state *state, lar_fault *fault) {
    if (domain->kind != LAR_ELEMENT_HEX8) {
        lar_step_recover(domain, 0, domain->run_count, state, fault);
        return;
    }
    for (int32_t r = 0; r < domain->run_count; r++) recover_run(domain, r, false, NULL, state);
    lar_guard_apply_all(domain, state);
}

void lar_step_forces_of(const lar_domain *domain, lar_interactions *scratch, lar_acting what,
                        lar_state *state, lar_fault *fault) {
    lar_condition_context context = lar_domain_context(domain);
    lar_step_enter(domain, scratch, &context, state);
    lar_interactions_forget(scratch);
    if (what == LAR_ACTING_LOADS)
        apply_loads(domain, scratch, &context, lar_state_time(domain, state), state, fault);
    else if (what == LAR_ACTING_TOOLS)
        lar_tool_contact_apply(&scratch->tool_contact, &context, state);
    else if (what == LAR_ACTING_BODIES)
        add_body_contact(&scratch->body_contact, &context, state, fault);
    else
        recover_seen(domain, state, fault);
}

void lar_step_forces(const lar_domain *domain, lar_interactions *scratch, lar_state *state,
                     lar_fault *fault) {
    lar_condition_context context = lar_domain_context(domain);
    lar_step_enter(domain, scratch, &context, state);
    lar_interactions_forget(scratch);
    act(domain, scratch, &context, state, fault);
    add_body_contact(&scratch->body_contact, &context, state, fault);
    recover_seen(domain, state, fault);
    add_last(domain, scratch, &context, state);
}

void lar_step_begin(const lar_domain *domain, lar_interactions *interactions,
                    const lar_condition_context *context, lar_state *state, lar_fault *fault) {
    act(domain, interactions, context, state, fault);
    if (interval_ends(domain, state->close, state)) lar_pressed_mark(domain, interactions, state);
    add_half_work(domain, interactions, context, state);
}

void lar_step_move(const lar_domain *domain, lar_interactions *interactions,
                   const lar_condition_context *context, lar_state *state, lar_fault *fault) {
    double time = lar_state_time(domain, state);
    add_last(domain, interactions, context, state);
    if (interactions->leads) {
        const lar_leapfrog leapfrog = lar_step_leapfrog_at(domain, interactions, context, state);
        lar_free_bodies_go(domain, &interactions->notes, state, &leapfrog, interactions->leads,
                           NULL);
    }
    lar_tool_friction_keep(&interactions->tool_contact, state);
    lar_tool_friction_half_work(&interactions->tool_contact, context, state);
    lar_tool_contact_carry(&interactions->tool_contact, context, &interactions->notes, state);
    lar_conditions_observe(context, &interactions->notes, state);
    lar_tool_contact_observe(&interactions->tool_contact, context, state);
    move_nodes(domain, interactions, context, state, fault);
    state->external += lar_conditions_impose(context, time, &interactions->notes, state);
    lar_tool_contact_stop(&interactions->tool_contact, context, state);
    lar_body_contact_moved(&interactions->body_contact, state, state->fastest * context->time_step);
    if (state->strained->follows)
        state->strained->travel += 1.7320508075688774 * state->fastest * context->time_step;
}

void lar_step_end(const lar_domain *domain, const lar_interactions *interactions,
                  const lar_condition_context *context, lar_state *state, lar_fault *fault) {
    add_half_work(domain, interactions, context, state);
    lar_body_contact_half_work(&interactions->body_contact, context, state);
    /* The monitor over speeds does not see nodes that are moved. */
    if (!isfinite(state->external) && !fault->kind)
        *fault = (lar_fault){
            .kind = LAR_FAULT_SPEED, .element = -1, .step = state->step, .part = state->part};
    if (interval_ends(domain, state->close, state)) lar_pressed_list(domain, interactions, state);
    state->round++;
    state->listed = true;
    if (++state->part < state->parts) return;
    state->part = 0;
    state->step++;
}

void lar_step(const lar_domain *domain, lar_interactions *interactions, lar_state *state,
              lar_fault *fault) {
    lar_condition_context context = lar_domain_context(domain);
    lar_step_enter(domain, interactions, &context, state);
    lar_step_begin(domain, interactions, &context, state, fault);
    add_body_contact(&interactions->body_contact, &context, state, fault);
    lar_body_contact_half_work(&interactions->body_contact, &context, state);
    lar_step_recover(domain, 0, domain->run_count, state, fault);
    lar_step_move(domain, interactions, &context, state, fault);
    lar_step_end(domain, interactions, &context, state, fault);
}
