#include "engine/step.h"

#include <math.h>
#include <string.h>

#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"

static void trip_element(lar_trip *trip, const lar_state *state, lar_gid e) {
    if (!trip->kind) *trip = (lar_trip){LAR_TRIP_ELEMENT, e, state->step};
}

static void recover_blocks(const lar_domain *domain, lar_state *state, lar_trip *trip) {
    bool watch = state->step % LAR_WATCH_INTERVAL == 0;
    for (int r = 0; r < domain->run_count; r++) {
        int64_t lane = domain->kernels->recover(&domain->run[r], state->u, state->force,
                                                &domain->limits, watch);
        if (lane < 0) continue;
        const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + lane / LAR_BLOCK];
        trip_element(trip, state, lanes->element[lane % LAR_BLOCK]);
    }
}

/* The oracle elements, one at a time: slow is fine. */
static void recover_slowly(const lar_domain *domain, lar_state *state, lar_trip *trip) {
    const lar_model *model = domain->model;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
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
            continue;
        }
        for (int a = 0; a < 8; a++)
            for (int k = 0; k < 3; k++)
                state->force[4 * domain->layout.local[model->mesh.element[e][a]] + k] +=
                    llrint(f[a][k] * domain->scale);
    }
}

static void recover_elements(const lar_domain *domain, lar_state *state, lar_trip *trip) {
    if (domain->kind == LAR_ELEMENT_HEX8)
        recover_blocks(domain, state, trip);
    else
        recover_slowly(domain, state, trip);
}

/* Spare nodes fall with gravity like any other; now and then they are put back. */
static void park_spares(const lar_domain *domain, lar_state *state) {
    for (int32_t i = 0; i < domain->spare_count; i++) {
        memset(state->u + 4 * domain->spare[i], 0, 4 * sizeof *state->u);
        memset(state->v + 4 * domain->spare[i], 0, 4 * sizeof *state->v);
    }
}

static void move_nodes(const lar_domain *domain, double time, lar_state *state, lar_trip *trip) {
    const lar_model *model = domain->model;
    lar_motion motion = domain->motion;
    if (domain->conditions.gravity_varies) {
        double gravity[3];
        lar_gravity_at(model, time, gravity);
        for (int i = 0; i < 3; i++)
            motion.drift[i] = gravity[i] * motion.dt / (1 + 0.5 * model->damping * motion.dt);
    }
    if (state->step % LAR_WATCH_INTERVAL == 0) park_spares(domain, state);
    const double *mass = model->damping > 0 ? domain->mass : NULL;
    if (!domain->kernels->update(&motion, 0, domain->layout.node_padded, state->u, state->v,
                                 state->force, domain->push, mass, &state->damped) &&
        !trip->kind)
        *trip = (lar_trip){LAR_TRIP_SPEED, -1, state->step};
}

static void apply_loads(lar_domain *domain, double time, lar_state *state, lar_trip *trip) {
    lar_condition_context context = lar_domain_context(domain);
    int32_t beyond = lar_conditions_load(&domain->conditions, &context, time, state);
    if (beyond >= 0 && !trip->kind)
        *trip = (lar_trip){LAR_TRIP_LOAD, domain->layout.global[beyond], state->step};
}

void lar_step_forces(lar_domain *domain, lar_state *state, lar_trip *trip) {
    apply_loads(domain, lar_state_time(domain, state), state, trip);
    recover_elements(domain, state, trip);
}

void lar_step(lar_domain *domain, lar_state *state, lar_trip *trip) {
    lar_conditions *conditions = &domain->conditions;
    lar_condition_context context = lar_domain_context(domain);
    double time = lar_state_time(domain, state);

    apply_loads(domain, time, state, trip);
    state->external += lar_conditions_half_work(conditions, &context, time, state);
    recover_elements(domain, state, trip);
    lar_conditions_observe(conditions, &context, state);
    move_nodes(domain, time, state, trip);
    state->external += lar_conditions_impose(conditions, &context, time, state);
    state->external += lar_conditions_half_work(conditions, &context, time, state);
    /* The watch over speeds does not see nodes that are moved. */
    if (!isfinite(state->external) && !trip->kind)
        *trip = (lar_trip){LAR_TRIP_SPEED, -1, state->step};
    state->step++;
}
