#include "session/snapshot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One value: this head, then u, v and history as the state has them. */
typedef struct frame {
    uint64_t step, hash;
    double time;
    bool hashed; /* by the first thread that took it */
    int32_t tools;
    lar_snapshot_tool tool[LAR_TOOLS_MAX];
} frame;

static size_t head_size(void) {
    return (sizeof(frame) + 63) / 64 * 64;
}

/* Of the state's arrays, one behind the other. */
static size_t stride_of(const lar_simulation *simulation) {
    return simulation->domain.layout.axis_stride;
}

/* The frame's arrays as a state that can be hashed. */
static lar_state state_of(frame *f, const lar_simulation *simulation) {
    double *u = (double *)((unsigned char *)f + head_size());
    return (lar_state){.step = f->step,
                       .node_count = simulation->domain.layout.node_padded,
                       .stride = stride_of(simulation),
                       .history_count = simulation->state.history_count,
                       .u = u,
                       .v = u + 3 * stride_of(simulation),
                       .level = u + 6 * stride_of(simulation),
                       .history = u + 7 * stride_of(simulation)};
}

lar_status lar_snapshots_create(const lar_simulation *simulation, lar_snapshots *snapshots,
                                lar_error *error) {
    size_t values = 7 * stride_of(simulation) + simulation->state.history_count;
    size_t bytes = head_size() + values * sizeof(double);
    return lar_triple_buffer_create(&snapshots->frames, bytes, "snapshots", error);
}

void lar_snapshots_destroy(lar_snapshots *snapshots) {
    lar_triple_buffer_destroy(&snapshots->frames);
}

uint64_t lar_snapshots_ask(lar_snapshots *snapshots) {
    return __atomic_add_fetch(&snapshots->asked, 1, __ATOMIC_ACQ_REL);
}

bool lar_snapshots_ready(const lar_snapshots *snapshots, uint64_t number) {
    return __atomic_load_n(&snapshots->ready, __ATOMIC_ACQUIRE) >= number;
}

bool lar_snapshots_wanted(const lar_snapshots *snapshots) {
    return __atomic_load_n(&snapshots->asked, __ATOMIC_ACQUIRE) != snapshots->answered;
}

void lar_snapshots_serve(lar_snapshots *snapshots, const lar_simulation *simulation,
                         const lar_snapshot_tool *tool, int32_t tools) {
    uint64_t asked = __atomic_load_n(&snapshots->asked, __ATOMIC_ACQUIRE);
    const lar_state *state = lar_simulation_state(simulation);
    frame *f = lar_triple_buffer_back(&snapshots->frames);
    f->step = state->step;
    f->time = (double)state->step * simulation->domain.time_step;
    f->hashed = false;
    f->tools = tools;
    memcpy(f->tool, tool, (size_t)tools * sizeof *tool);
    lar_state copy = state_of(f, simulation);
    memcpy(copy.u, state->u, 3 * copy.stride * sizeof *copy.u);
    memcpy(copy.v, state->v, 3 * copy.stride * sizeof *copy.v);
    memcpy(copy.level, state->level, copy.stride * sizeof *copy.level);
    if (state->history)
        memcpy(copy.history, state->history, state->history_count * sizeof *copy.history);
    lar_triple_buffer_publish(&snapshots->frames);
    snapshots->answered = asked;
    __atomic_store_n(&snapshots->ready, asked, __ATOMIC_RELEASE);
}

lar_status lar_snapshots_take(lar_snapshots *snapshots, const lar_simulation *simulation,
                              lar_snapshot *snapshot, lar_error *error) {
    const lar_domain *domain = &simulation->domain;
    bool finite = true;
    snapshot->kinetic = 0;
    lar_triple_buffer_lock(&snapshots->frames);
    frame *f = lar_triple_buffer_newest(&snapshots->frames, NULL);
    const lar_state state = state_of(f, simulation);
    if (!f->hashed) f->hash = lar_state_hash(domain, &state);
    f->hashed = true;
    snapshot->step = f->step;
    snapshot->time = f->time;
    snapshot->hash = f->hash;
    snapshot->tools = f->tools;
    memcpy(snapshot->tool, f->tool, (size_t)f->tools * sizeof *f->tool);
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++) {
        double *u = snapshot->u[g], v[3];
        lar_state_displacement(&state, domain->layout.local[g], u);
        lar_state_velocity(&state, domain->layout.local[g], v);
        snapshot->kinetic +=
            0.5 * domain->mass[domain->layout.local[g]] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        finite = finite && isfinite(u[0] + u[1] + u[2]);
    }
    lar_triple_buffer_unlock(&snapshots->frames);
    if (finite) return LAR_OK;
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "the state at step %llu is not finite and cannot be shown; reset the session "
                    "or load a saved state",
                    (unsigned long long)snapshot->step);
}
