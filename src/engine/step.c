#include "engine/step.h"

#include <math.h>
#include <string.h>

#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"

static void trip_element(lar_trip *trip, const lar_state *state, lar_gid e) {
    if (!trip->kind)
        *trip = (lar_trip){.kind = LAR_TRIP_ELEMENT, .element = e, .step = state->step};
}

static void recover_blocks(const lar_domain *domain, int32_t first, int32_t count, lar_state *state,
                           lar_trip *trip) {
    bool watch = state->step % LAR_WATCH_INTERVAL == 0;
    for (int32_t r = first; r < first + count; r++) {
        int64_t lane = domain->kernels->recover(&domain->run[r], state->u, state->force,
                                                &domain->limits, watch);
        if (lane < 0) continue;
        const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + lane / LAR_BLOCK];
        trip_element(trip, state, lanes->element[lane % LAR_BLOCK]);
    }
}

/* The oracle elements, one at a time: slow is fine. */
static void recover_slowly(const lar_domain *domain, lar_gid e, lar_state *state, lar_trip *trip) {
    const lar_model *model = domain->model;
    double corner[8][3], u[8][3], f[8][3];
    const lar_material *material = lar_model_material_of(model, e);
    lar_mesh_corners(&model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    double J = domain->kind == LAR_ELEMENT_HEX8_FULL
                   ? lar_hex8_full_force(corner, material, u, f)
                   : lar_hex8_matrix_force(corner, material, u, f);
    bool fits = J > domain->limits.least_volume;
    for (int k = 0; k < 24; k++) fits = fits && fabs(f[k / 3][k % 3]) * domain->scale < 0x1p58;
    if (!fits) {
        trip_element(trip, state, e);
        return;
    }
    for (int a = 0; a < 8; a++)
        for (int k = 0; k < 3; k++)
            state->force[4 * domain->layout.local[model->mesh.element[e][a]] + k] +=
                llrint(f[a][k] * domain->scale);
}

void lar_step_recover(const lar_domain *domain, int32_t first, int32_t count, lar_state *state,
                      lar_trip *trip) {
    if (domain->kind == LAR_ELEMENT_HEX8) {
        recover_blocks(domain, first, count, state, trip);
        return;
    }
    for (int32_t r = first; r < first + count; r++)
        for (int32_t b = 0; b < domain->run[r].count; b++)
            for (int lane = 0; lane < LAR_BLOCK; lane++) {
                lar_gid e = domain->layout.block[domain->run_first[r] + b].element[lane];
                if (e >= 0) recover_slowly(domain, e, state, trip);
            }
}

/* Spare nodes fall with gravity like any other; now and then they are put back. */
static void park_spares(const lar_domain *domain, const lar_condition_context *context,
                        lar_state *state) {
    for (int32_t i = 0; i < domain->spare_count; i++) {
        lar_lid n = domain->spare[i];
        if (n < context->first || n >= context->end) continue;
        memset(state->u + 4 * n, 0, 4 * sizeof *state->u);
        memset(state->v + 4 * n, 0, 4 * sizeof *state->v);
    }
}

static void move_nodes(const lar_domain *domain, const lar_acting *acting,
                       const lar_condition_context *context, double time, lar_state *state,
                       lar_trip *trip) {
    /* Where contact is predicted from the fastest node, that is none of these. */
    bool predicts =
        acting->collide.surface || acting->touch.planes.count > 0 || acting->touch.face_count > 0;
    uint64_t park_interval = predicts ? 4 : LAR_WATCH_INTERVAL;
    const lar_model *model = domain->model;
    lar_motion motion = domain->motion;
    if (acting->conditions.gravity_varies) {
        double gravity[3];
        lar_gravity_at(model, time, gravity);
        for (int i = 0; i < 3; i++)
            motion.drift[i] = gravity[i] * motion.dt / (1 + 0.5 * model->damping * motion.dt);
    }
    if (state->step % park_interval == 0) park_spares(domain, context, state);
    const double *weight = model->damping > 0 ? domain->weight : NULL;
    state->fastest = 0;
    if (!domain->kernels->update(&motion, context->first, context->end, state->u, state->v,
                                 state->force, domain->push, weight, &state->damped,
                                 &state->fastest) &&
        !trip->kind)
        *trip = (lar_trip){.kind = LAR_TRIP_SPEED, .element = -1, .step = state->step};
}

static void apply_loads(const lar_domain *domain, lar_conditions *conditions,
                        const lar_condition_context *context, double time, lar_state *state,
                        lar_trip *trip) {
    int32_t beyond = lar_conditions_load(conditions, context, time, state);
    if (beyond >= 0 && !trip->kind)
        *trip = (lar_trip){
            .kind = LAR_TRIP_LOAD, .element = domain->layout.global[beyond], .step = state->step};
}

/* Loads, tools and planes; half of their work when the nodes are about to move. */
static void act(const lar_domain *domain, lar_acting *acting, const lar_condition_context *context,
                lar_state *state, lar_trip *trip) {
    apply_loads(domain, &acting->conditions, context, lar_state_time(domain, state), state, trip);
    lar_touch_apply(&acting->touch, context, state);
}

static void add_half_work(const lar_domain *domain, const lar_acting *acting,
                          const lar_condition_context *context, lar_state *state) {
    state->external += lar_conditions_half_work(&acting->conditions, context,
                                                lar_state_time(domain, state), state);
    lar_touch_half_work(&acting->touch, context, state);
}

/* Contact of bodies, by who has all nodes. */
static void collide(lar_collide *collide, const lar_condition_context *context, lar_state *state,
                    lar_trip *trip) {
    lar_collide_apply(collide, context, state);
    if (collide->crowded && !trip->kind)
        *trip = (lar_trip){.kind = LAR_TRIP_CROWD, .element = -1, .step = state->step};
}

void lar_step_forces(lar_domain *domain, lar_state *state, lar_trip *trip) {
    lar_condition_context context = lar_domain_context(domain);
    lar_touch_note note;
    lar_touch_remember(&domain->acting.touch, &note);
    lar_contact_info counted = domain->acting.collide.info;
    act(domain, &domain->acting, &context, state, trip);
    lar_collide_forget(&domain->acting.collide);
    collide(&domain->acting.collide, &context, state, trip);
    lar_collide_forget(&domain->acting.collide);
    domain->acting.collide.info = counted;
    lar_touch_restore(&domain->acting.touch, &note);
    lar_step_recover(domain, 0, domain->run_count, state, trip);
}

void lar_step_begin(const lar_domain *domain, lar_acting *acting,
                    const lar_condition_context *context, lar_state *state, lar_trip *trip) {
    act(domain, acting, context, state, trip);
    add_half_work(domain, acting, context, state);
}

void lar_step_move(const lar_domain *domain, lar_acting *acting,
                   const lar_condition_context *context, lar_state *state, lar_trip *trip) {
    lar_conditions *conditions = &acting->conditions;
    double time = lar_state_time(domain, state);
    lar_conditions_observe(conditions, context, state);
    lar_touch_observe(&acting->touch, context, state);
    move_nodes(domain, acting, context, time, state, trip);
    state->external += lar_conditions_impose(conditions, context, time, state);
    lar_touch_stop(&acting->touch, context, state);
    lar_collide_moved(&acting->collide, state, state->fastest * domain->time_step);
}

void lar_step_end(const lar_domain *domain, const lar_acting *acting,
                  const lar_condition_context *context, lar_state *state, lar_trip *trip) {
    add_half_work(domain, acting, context, state);
    lar_collide_half_work(&acting->collide, context, state);
    /* The watch over speeds does not see nodes that are moved. */
    if (!isfinite(state->external) && !trip->kind)
        *trip = (lar_trip){.kind = LAR_TRIP_SPEED, .element = -1, .step = state->step};
    state->step++;
}

void lar_step(lar_domain *domain, lar_state *state, lar_trip *trip) {
    lar_condition_context context = lar_domain_context(domain);
    lar_step_begin(domain, &domain->acting, &context, state, trip);
    collide(&domain->acting.collide, &context, state, trip);
    lar_collide_half_work(&domain->acting.collide, &context, state);
    lar_step_recover(domain, 0, domain->run_count, state, trip);
    lar_step_move(domain, &domain->acting, &context, state, trip);
    lar_step_end(domain, &domain->acting, &context, state, trip);
}
