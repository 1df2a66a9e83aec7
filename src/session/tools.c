/* From hands to tools and back, once in a tick. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "session/session.h"
#include "step/grasp.h"

static lar_device_tick tick_of(const lar_session *session) {
    uint64_t step = lar_simulation_steps(session->simulation);
    return (lar_device_tick){.step = step,
                             .time = (double)step * session->time_step,
                             .seconds = (double)session->tick_steps * session->time_step,
                             .now = (uint64_t)lar_clock_ns(),
                             .paused = session->status.state != LAR_SESSION_PLAYING};
}

static void take_tool(lar_session *session, int32_t i) {
    lar_session_tool *tool = &session->tool[i];
    lar_tool_force now;
    lar_triple_buffer_newest(&tool->hand, NULL); /* what was sent before does not count */
    lar_simulation_tool_asked(session->simulation, i, &tool->pose);
    lar_simulation_tool_pose(session->simulation, i, &tool->place, NULL);
    tool->sent = tool->target = tool->pose;
    tool->force = tool->felt = (lar_tool_force){0};
    lar_simulation_tool_force(session->simulation, i, &now, NULL);
    tool->force.limit = tool->load.limit = now.limit;
    tool->force.apart = now.apart;
    tool->force.limited = now.limited;
    tool->led = false;
    lar_coupling_reset(&tool->coupling, &tool->pose);
    if (tool->device) lar_device_reset(tool->device);
}

void lar_session_take_tools(lar_session *session) {
    session->status.placed++;
    lar_session_look_at_spares(session);
    for (int32_t i = 0; i < session->tools; i++) take_tool(session, i);
}

void lar_session_take_rate(lar_session_tool *tool) {
    double rate = tool->device ? lar_device_rate(tool->device) : 0;
    if (rate > 0) lar_coupling_set_rate(&tool->coupling, rate);
}

void lar_session_couple(lar_session *session, int32_t tool) {
    const lar_coupling_limits limits = {.tool_speed = session->options.tool_speed,
                                        .hand_force = session->options.hand_force,
                                        .seconds = (double)session->tick_steps * session->time_step,
                                        .time_step = session->time_step};
    lar_coupling_create(&session->tool[tool].coupling, &session->tool[tool].info, &limits);
    lar_session_take_rate(&session->tool[tool]);
}

/* Names and shapes go together. */
static bool is_another(const lar_session_tool *tool, const lar_tool_info *now) {
    const lar_tool_info *was = &tool->info;
    return was->serial != now->serial || was->shape != now->shape || was->radius != now->radius ||
           was->length != now->length || was->spread != now->spread ||
           memcmp(&was->rest, &now->rest, sizeof was->rest) != 0;
}

void lar_session_look_at_spares(lar_session *session) {
    const lar_simulation *simulation = session->simulation;
    for (int32_t i = lar_spares_first(&simulation->list); i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        lar_tool_info now;
        if (lar_simulation_tool(simulation, i, &now, NULL) || !is_another(tool, &now)) continue;
        tool->info = now;
        tool->load = (lar_tool_load){0};
        lar_session_couple(session, i);
        take_tool(session, i);
    }
}

/* Without a pace there is no clock that ticks keep to. */
static void lead_evenly(const lar_session *session, lar_session_tool *tool, bool fresh) {
    tool->evenly = tool->target;
    if (fresh && tool->device && session->pace.pace > 0)
        lar_device_evenly(tool->device, session->pace.deadline.due, &tool->evenly);
}

/* Where the hands are. */
static void look_at_hands(lar_session *session) {
    const lar_device_tick now = tick_of(session);
    for (int32_t i = 0; i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        bool fresh;
        const lar_tool_pose *hand = lar_triple_buffer_newest(&tool->hand, &fresh);
        if (tool->device) {
            fresh = lar_device_poll(tool->device, &now, &tool->target);
            const uint64_t owners = lar_device_owners(tool->device);
            if (tool->owners != owners) lar_coupling_greet(&tool->coupling);
            tool->owners = owners;
        } else if (fresh)
            tool->target = *hand;
        lead_evenly(session, tool, fresh);
        if (tool->info.shape == LAR_TOOL_NONE) continue;
        tool->led = tool->led || (fresh && lar_session_follows(session, i));
    }
}

/* To where it is wanted, in the recording as well. */
static lar_status move_tool(lar_session *session, int32_t i, uint64_t steps, lar_error *error) {
    lar_session_tool *tool = &session->tool[i];
    lar_status status = lar_simulation_tool_move(session->simulation, i, &tool->pose, steps, error);
    if (status) return status;
    tool->sent = tool->pose;
    lar_session_put_record(session, &(lar_record){.kind = LAR_RECORD_MOVE,
                                                  .step = lar_simulation_steps(session->simulation),
                                                  .tool = i,
                                                  .steps = steps,
                                                  .pose = tool->pose});
    return LAR_OK;
}

/* A tool whose place did not change rests where it was sent. */
static lar_status send_tool(lar_session *session, int32_t i, lar_error *error) {
    lar_session_tool *tool = &session->tool[i];
    if (memcmp(&tool->sent, &tool->pose, sizeof tool->pose) == 0) return LAR_OK;
    lar_status status = move_tool(session, i, session->tick_steps, error);
    if (status == LAR_ERROR_ARGUMENT) {
        /* Nowhere to go, or too far for one tick: it stays, and starts anew from there. */
        lar_simulation_tool_asked(session->simulation, i, &tool->pose);
        lar_coupling_reset(&tool->coupling, &tool->pose);
        status = LAR_OK;
    }
    return status;
}

lar_status lar_session_move_tools(lar_session *session, lar_error *error) {
    lar_status status = LAR_OK;
    look_at_hands(session);
    for (int32_t i = 0; i < session->tools && !status; i++) {
        lar_session_tool *tool = &session->tool[i];
        if (!tool->led) continue;
        lar_coupling_follow(&tool->coupling, &tool->target, &tool->evenly, &tool->pose);
        status = send_tool(session, i, error);
    }
    return status;
}

/* ---- taking hold --------------------------------------------------------------------------- */

/* A grasper goes on as it was led, with its jaws open or closed. */
static void ask_jaws(lar_session_tool *tool, double opening) {
    bool fresh;
    const lar_tool_pose *hand = lar_triple_buffer_newest(&tool->hand, &fresh);
    if (fresh) tool->target = *hand;
    tool->target.opening = opening;
    tool->led = true;
}

static lar_status open_hand(lar_session *session, int32_t i, lar_error *error) {
    lar_session_tool *tool = &session->tool[i];
    tool->pose.opening = 1;
    lar_status status = move_tool(session, i, 1, error);
    tool->force.held = 0;
    return status;
}

/* What was sent before does not count; the hand is led on from where it is. */
static void begin_anew(lar_session_tool *tool) {
    lar_triple_buffer_newest(&tool->hand, NULL);
    tool->target = tool->pose;
    tool->led = true;
    tool->waits = false;
    lar_coupling_reset(&tool->coupling, &tool->pose);
}

lar_status lar_session_let_go(lar_session *session, int32_t i, lar_error *error) {
    lar_session_tool *tool = &session->tool[i];
    lar_status status = LAR_OK;
    if (tool->info.shape == LAR_TOOL_GRASPER)
        ask_jaws(tool, 1);
    else if (!(status = open_hand(session, i, error)))
        begin_anew(tool);
    return status;
}

lar_status lar_session_take_hold(lar_session *session, int32_t i, const double point[3],
                                 int32_t *held, lar_error *error) {
    lar_session_tool *tool = &session->tool[i];
    if (tool->info.shape == LAR_TOOL_GRASPER) {
        ask_jaws(tool, 0);
        return LAR_OK;
    }
    lar_status status = open_hand(session, i, error);
    memcpy(tool->pose.position, point, sizeof tool->pose.position);
    tool->pose.opening = 0;
    if (!status) status = move_tool(session, i, 1, error);
    if (!status) {
        *held = tool->force.held = lar_grasp_count(&session->simulation->tools, i);
        if (*held == 0) status = open_hand(session, i, error);
    }
    if (!status) begin_anew(tool);
    return status;
}

/* ---- forces -------------------------------------------------------------------------------- */

static void tell_devices(lar_session *session) {
    for (int32_t i = 0; i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        if (!tool->device) continue;
        lar_device_tick now = tick_of(session); /* each by the clock when it is told */
        if (!now.paused) memcpy(now.held_back, tool->coupling.held_back, sizeof now.held_back);
        lar_device_feel(tool->device, &now, &tool->felt, &tool->place);
        lar_device_told(tool->device, (uint64_t)lar_clock_ns());
    }
}

static void record_load(lar_session_tool *tool) {
    const double *f = tool->force.force;
    double force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    tool->load.limit = tool->force.limit;
    tool->load.force = fmax(tool->load.force, force);
    tool->load.grasp_force = fmax(tool->load.grasp_force, tool->force.grasp_force);
    tool->load.reached = tool->load.reached || tool->force.limited;
}

void lar_session_feel_tools(lar_session *session) {
    lar_session_look_at_spares(session); /* a recording that is played adds and removes, too */
    int64_t now = lar_clock_ns();
    double passed = session->felt_at ? 1e-9 * (double)(now - session->felt_at) : 0;
    if (session->hosted) passed = (double)session->tick_steps * session->time_step;
    session->felt_at = now;
    lar_history_begin(&session->history);
    for (int32_t i = 0; i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        lar_simulation_tool_force(session->simulation, i, &tool->force, NULL);
        lar_simulation_tool_pose(session->simulation, i, &tool->place, NULL);
        record_load(tool);
        if (tool->led) lar_coupling_feel(&tool->coupling, &tool->force, passed, &tool->felt);
        lar_history_put(&session->history, i, tool->force.force);
    }
    lar_history_end(&session->history);
    tell_devices(session);
}

void lar_session_drop_forces(lar_session *session) {
    for (int32_t i = 0; i < session->tools; i++) {
        lar_tool_force *force = &session->tool[i].force;
        memset(force->force, 0, sizeof force->force);
        memset(force->torque, 0, sizeof force->torque);
        force->grasp_force = 0;
    }
}

static void shrink(lar_tool_force *force, double share) {
    for (int k = 0; k < 3; k++) {
        force->force[k] *= share;
        force->torque[k] *= share;
    }
    force->grasp_force *= share;
}

bool lar_session_idle_tools(lar_session *session, double share) {
    bool device = false;
    look_at_hands(session);
    for (int32_t i = 0; i < session->tools; i++) {
        shrink(&session->tool[i].felt, share); /* the tissue's stays: it still pushes */
        device = device || session->tool[i].device;
    }
    tell_devices(session);
    return device;
}
