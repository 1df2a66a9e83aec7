#include "session/recovery.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "session/session.h"

/* Of simulated time [s]. */
static const double EVERY = 0.5, SOUND = 0.25, SOON = 1;
/* Tools after going back [m/s]. */
static const double SLOW = 0.1;
/* A hand whose opening is more is open (lariat.h). */
static const double OPEN = 0.5;

/* ---- the states ---------------------------------------------------------------------------- */

static uint64_t steps_of(double seconds, double time_step) {
    double steps = ceil(seconds / time_step * (1 - 1e-9));
    return steps < 1 ? 1 : (uint64_t)steps;
}

lar_status lar_recovery_create(const lar_simulation *simulation, double time_step,
                               lar_recovery *recovery, lar_error *error) {
    int32_t nodes = simulation->state.node_count;
    size_t history = simulation->state.history_count;
    *recovery = (lar_recovery){.every = steps_of(EVERY, time_step),
                               .sound = steps_of(SOUND, time_step),
                               .soon = steps_of(SOON, time_step)};
    lar_status status = lar_state_create(&recovery->origin.state, nodes, history, error);
    for (int i = 0; i < LAR_STATES_KEPT && !status; i++)
        status = lar_state_create(&recovery->kept[i].state, nodes, history, error);
    return status;
}

void lar_recovery_destroy(lar_recovery *recovery) {
    for (int i = 0; i < LAR_STATES_KEPT; i++) lar_state_destroy(&recovery->kept[i].state);
    lar_state_destroy(&recovery->origin.state);
}

/* The i-th of those that are kept, the oldest first. */
static lar_kept_state *kept_state(lar_recovery *recovery, int i) {
    return &recovery->kept[(recovery->first + i) % LAR_STATES_KEPT];
}

static lar_status keep(lar_recovery *recovery, lar_simulation *simulation, lar_error *error) {
    bool full = recovery->count == LAR_STATES_KEPT;
    lar_kept_state *place = kept_state(recovery, full ? 0 : recovery->count);
    lar_status status = lar_simulation_copy(simulation, &place->state, &place->tools, error);
    if (status) return status;
    if (full)
        recovery->first = (recovery->first + 1) % LAR_STATES_KEPT;
    else
        recovery->count++;
    return LAR_OK;
}

lar_status lar_session_keep_state(lar_session *session, lar_error *error) {
    lar_recovery *r = &session->recovery;
    uint64_t step = lar_simulation_steps(session->simulation);
    if (session->options.stop_when_unstable) return LAR_OK;
    if (r->slow_until > 0 && step >= r->slow_until) {
        for (int32_t i = 0; i < session->tools; i++)
            lar_coupling_set_speed(&session->tool[i].coupling, INFINITY);
        r->slow_until = 0;
    }
    uint64_t last = r->count > 0    ? kept_state(r, r->count - 1)->state.step
                    : r->has_origin ? r->origin.state.step
                                    : 0;
    return step - last >= r->every ? keep(r, session->simulation, error) : LAR_OK;
}

lar_status lar_session_begin_states(lar_session *session, lar_error *error) {
    lar_recovery *r = &session->recovery;
    if (session->options.stop_when_unstable) return LAR_OK;
    r->first = r->count = 0;
    r->went_back = false;
    r->slow_until = r->rest_until = 0;
    for (int32_t i = 0; i < session->tools; i++) {
        session->tool[i].waits = false;
        lar_coupling_set_speed(&session->tool[i].coupling, INFINITY);
    }
    lar_status status =
        lar_simulation_copy(session->simulation, &r->origin.state, &r->origin.tools, error);
    r->has_origin = !status;
    return status == LAR_ERROR_UNSTABLE ? LAR_OK : status;
}

/* ---- where to ------------------------------------------------------------------------------ */

static bool breaks_again(const lar_recovery *r, uint64_t step) {
    uint64_t apart = step > r->broke ? step - r->broke : r->broke - step;
    return r->went_back && (step < r->arrived + r->soon || apart <= r->sound);
}

/* The newest state that is sound, or, where the run breaks again, older than the last one. What is
 * newer is forgotten. NULL: the start, which is made anew and needs no state. */
static lar_kept_state *choose(lar_recovery *r, uint64_t step, bool again) {
    uint64_t age = step < r->sound ? step : r->sound, limit = again ? r->arrived : step - age + 1;
    while (r->count > 0 && kept_state(r, r->count - 1)->state.step >= limit) r->count--;
    if (r->count > 0) return kept_state(r, r->count - 1);
    bool origin = r->has_origin && r->origin.state.step > 0;
    if (origin && (!again || r->origin.state.step < r->arrived)) return &r->origin;
    r->has_origin = false;
    return NULL;
}

static bool somebody_moves(const lar_session *session) {
    bool led = false;
    for (int32_t i = 0; i < session->tools; i++) led = led || session->tool[i].led;
    return led;
}

/* ---- going back ---------------------------------------------------------------------------- */

static bool is_hand(const lar_session *session, int32_t tool) {
    return session->tool[tool].info.shape == LAR_TOOL_HAND;
}

/* Hands are open and hold nothing. */
static void open_hands(const lar_session *session, lar_tools *tools) {
    int32_t count = 0;
    for (int32_t i = 0; i < tools->grasp_count; i++)
        if (!is_hand(session, tools->grasps[i].tool)) tools->grasps[count++] = tools->grasps[i];
    tools->grasp_count = count;
    for (int32_t i = 0; i < tools->count; i++) {
        lar_tool_motion *motion = &tools->motion[i];
        if (!is_hand(session, i)) continue;
        motion->holding = 0;
        motion->from.opening = motion->to.opening = 1;
        tools->follower[i].hand = *motion;
    }
}

static bool is_same_tool(const lar_spare_tool *a, const lar_spare_tool *b) {
    return a->placed == b->placed && (!a->placed || a->serial == b->serial);
}

/* What somebody has added or removed since the state was kept stays so: instruments do not vanish
 * from a hand. They come to stand where there is room beside the body as it is now. */
static lar_status keep_spares(lar_session *session, const lar_spare_tool *wanted,
                              lar_error *error) {
    const lar_simulation *simulation = session->simulation;
    int32_t first = lar_spares_first(&simulation->list);
    lar_status status = LAR_OK;
    for (int32_t k = 0; k < simulation->list.spares && !status; k++) {
        const lar_spare_tool *now = &simulation->tools.spare[k], *then = &wanted[k];
        if (is_same_tool(now, then)) continue;
        if (now->placed)
            status = lar_session_apply(
                session, &(lar_setting){.kind = LAR_SETTING_REMOVE_TOOL, .of = first + k}, error);
        if (then->placed && !status)
            status = lar_session_apply(
                session,
                &(lar_setting){.kind = LAR_SETTING_ADD_TOOL,
                               .of = lar_setting_of_tool(then->shape, k),
                               .value = {then->radius, then->length, then->spread}},
                error);
    }
    return status;
}

/* A replay does not go back by itself: the recording says where to. */
static lar_status go_back(lar_session *session, lar_kept_state *kept, lar_error *error) {
    lar_spare_tool spare[LAR_SPARES_MAX];
    lar_status status;
    memcpy(spare, session->simulation->tools.spare, sizeof spare);
    if (!kept) {
        status = lar_simulation_reset(session->simulation, error);
        if (!status)
            lar_session_put_record(
                session, &(lar_record){.kind = LAR_RECORD_RESET, .step = session->good_step});
        return status;
    }
    open_hands(session, &kept->tools);
    status = lar_simulation_go_back(session->simulation, &kept->state, &kept->tools, error);
    if (!status) status = lar_session_record_state(session, error);
    return status ? status : keep_spares(session, spare, error);
}

/* Tools where the simulation has them, slow from now on. */
static void calm_tools(lar_session *session, bool rest) {
    lar_recovery *r = &session->recovery;
    r->rest_until = r->arrived + (rest ? r->soon : 0);
    r->slow_until = r->rest_until + r->soon;
    for (int32_t i = 0; i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        tool->waits = is_hand(session, i) && (tool->waits || tool->target.opening <= OPEN);
        lar_coupling_set_speed(&tool->coupling, SLOW);
    }
    lar_session_take_tools(session);
}

static void tell(lar_session *session, uint64_t step, bool start, const lar_error *cause) {
    lar_session_status *status = &session->status;
    uint64_t arrived = session->recovery.arrived;
    char place[40] = "the start";
    if (!start) snprintf(place, sizeof place, "step %" PRIu64, arrived);
    status->recoveries++;
    snprintf(status->recovery, sizeof status->recovery, "went back %.2f s to %s: %.*s",
             (double)(step - arrived) * session->time_step, place,
             (int)sizeof status->recovery - 100, cause->message);
}

bool lar_session_recover(lar_session *session, lar_error *error) {
    lar_recovery *r = &session->recovery;
    const lar_error cause = *error;
    if (session->options.stop_when_unstable || cause.status != LAR_ERROR_UNSTABLE) return false;
    uint64_t step = lar_simulation_steps(session->simulation);
    bool again = breaks_again(r, step);
    bool from_start = r->went_back ? r->arrived == 0 : !r->has_origin || r->origin.state.step == 0;
    if (from_start && !somebody_moves(session)) return false;
    lar_kept_state *kept = choose(r, step, again);
    if (go_back(session, kept, error)) return false;
    r->arrived = lar_simulation_steps(session->simulation);
    r->broke = step;
    calm_tools(session, again && from_start);
    r->went_back = true;
    session->good_step = session->hashed = r->arrived;
    lar_pace_restart(&session->pace, lar_clock_ns());
    tell(session, step, !kept, &cause);
    lar_session_publish(session, true);
    return true;
}

bool lar_session_follows(lar_session *session, int32_t tool) {
    lar_session_tool *t = &session->tool[tool];
    if (t->waits && t->target.opening <= OPEN) return false;
    t->waits = false;
    return lar_simulation_steps(session->simulation) >= session->recovery.rest_until;
}
