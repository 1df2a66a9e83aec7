/* Executes the requests of a session, on the engine's thread between two ticks. */
#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "session/session.h"

/* ---- the recording ------------------------------------------------------------------------- */

/* The file is at fault: everyone is told now, and whoever closes it once more. */
static void lose_recording(lar_session *session) {
    lar_error why;
    lar_recorder_why(session->recorder, &why);
    session->status.recording = 0;
    snprintf(session->status.recording_lost, sizeof session->status.recording_lost, "%s",
             why.message);
}

void lar_session_put_record(lar_session *session, const lar_record *record) {
    if (session->status.recording && !lar_recorder_put(session->recorder, record))
        lose_recording(session);
}

void lar_session_record_hash(lar_session *session) {
    lar_error error;
    if (!session->status.recording) return;
    if (lar_simulation_gather(session->simulation, &error)) {
        lar_session_stop(session, &error);
        return;
    }
    session->hashed = lar_simulation_steps(session->simulation);
    lar_session_put_record(session,
                           &(lar_record){.kind = LAR_RECORD_HASH,
                                         .step = session->hashed,
                                         .hash = lar_simulation_hash(session->simulation)});
}

/* The state goes on all the same when it cannot be recorded; whoever closes the recording is told.
 */
lar_status lar_session_record_state(lar_session *session, lar_error *error) {
    if (!session->status.recording ||
        !lar_recorder_put_state(session->recorder, session->simulation, error))
        return LAR_OK;
    lose_recording(session);
    return error->status == LAR_ERROR_PEER ? LAR_ERROR_PEER : LAR_OK;
}

/* A run that broke has no hash there: when it is played it breaks in the same step. */
void lar_session_record_end(lar_session *session) {
    if (!session->status.recording) return;
    bool broken = session->status.state == LAR_SESSION_STOPPED;
    if (!broken) lar_session_record_hash(session);
    lar_session_put_record(
        session,
        &(lar_record){.kind = LAR_RECORD_END, .step = lar_simulation_steps(session->simulation)});
}

static lar_status change_recorder(lar_session *session, const lar_request *request,
                                  lar_error *error) {
    lar_recorder *fresh = request->recorder;
    lar_status status = LAR_OK;
    if (fresh && session->player)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "a recording is being played; leave it before another one is made");
    if (fresh && !status) status = lar_recorder_put_state(fresh, session->simulation, error);
    if (status) {
        request->answer->recorder = fresh;
        return status;
    }
    lar_session_record_end(session);
    request->answer->recorder = session->recorder;
    session->recorder = fresh;
    session->hashed = lar_simulation_steps(session->simulation);
    session->status.recording = fresh != NULL;
    if (fresh) session->status.recording_lost[0] = '\0';
    return LAR_OK;
}

/* ---- going back, saving, loading ----------------------------------------------------------- */

lar_status lar_session_arrive(lar_session *session, lar_error *error) {
    lar_session_take_tools(session);
    session->status.error = LAR_OK;
    session->status.message[0] = '\0';
    session->good_step = session->hashed = lar_simulation_steps(session->simulation);
    if (session->status.state == LAR_SESSION_STOPPED) lar_session_go_on(session);
    lar_pace_restart(&session->pace, lar_clock_ns());
    return lar_session_begin_states(session, error);
}

static lar_status reset(lar_session *session, lar_error *error) {
    lar_status status = lar_simulation_reset(session->simulation, error);
    if (status) return status;
    lar_session_put_record(session,
                           &(lar_record){.kind = LAR_RECORD_RESET, .step = session->good_step});
    return lar_session_arrive(session, error);
}

static lar_status load(lar_session *session, const lar_request *request, lar_error *error) {
    lar_status status =
        request->load_from
            ? lar_simulation_load_from(session->simulation, request->load_from, error)
            : lar_simulation_unpack(session->simulation, request->path, request->state, error);
    if (!status) status = lar_session_arrive(session, error);
    return status ? status : lar_session_record_state(session, error);
}

static lar_status attach(lar_session *session, const lar_request *request, lar_error *error) {
    lar_session_tool *tool = &session->tool[request->tool];
    if (tool->info.shape == LAR_TOOL_NONE)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "tool %ld is not there; add one before a device is connected with it",
                        (long)request->tool);
    if (tool->device)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "tool %ld, '%s', has a device already, and keeps it until the session ends",
                        (long)request->tool, tool->info.name);
    tool->device = request->device;
    lar_session_take_rate(tool);
    return LAR_OK;
}

/* What is played is over when the run was put somewhere else; the caller frees it. */
static lar_status end_player(lar_session *session, const lar_request *request, lar_status status) {
    if (status) return status;
    request->answer->player = session->player;
    session->player = NULL;
    return LAR_OK;
}

static lar_status change_player(lar_session *session, const lar_request *request,
                                lar_error *error) {
    lar_player *fresh = request->player;
    if (!fresh && !session->player) return LAR_OK; /* nothing to leave: the run goes on as it was */
    if (!fresh) return end_player(session, request, lar_session_arrive(session, error));
    request->answer->player = fresh;
    if (session->status.recording)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a recording is being made; end it before another one is played");
    lar_status status = lar_player_begin(fresh, session->simulation, error);
    if (!status) status = lar_session_arrive(session, error);
    if (status) return status;
    end_player(session, request, LAR_OK);
    session->player = fresh;
    lar_session_go_on(session);
    return LAR_OK;
}

lar_status lar_session_apply(lar_session *session, const lar_setting *setting, lar_error *error) {
    lar_status status = lar_setting_apply(setting, session->simulation, error);
    if (status) return status;
    lar_record record = {.kind = LAR_RECORD_SET,
                         .step = lar_simulation_steps(session->simulation),
                         .setting = *setting};
    record.setting.members = lar_setting_members(setting, session->simulation);
    lar_session_put_record(session, &record);
    lar_session_look_at_spares(session);
    lar_session_publish(session, false);
    return LAR_OK;
}

/* A device keeps its tool until the session ends. */
static lar_status check_device(const lar_session *session, const lar_setting *setting,
                               lar_error *error) {
    int32_t tool = setting->of;
    if (setting->kind != LAR_SETTING_REMOVE_TOOL || tool < 0 || tool >= session->tools ||
        !session->tool[tool].device)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s has a device, and keeps it until the session ends; it cannot be removed",
                    session->tool[tool].info.name);
}

static lar_status set(lar_session *session, const lar_request *request, lar_error *error) {
    if (session->player)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a recording is being played; leave it to change gravity, damping, "
                        "stiffness, activation, tools, forces and supports");
    if (session->status.state == LAR_SESSION_STOPPED)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "the run has broken off; reset it or load a state before gravity, damping, "
                        "stiffness, activation, tools, forces and supports are changed");
    lar_setting setting = request->setting;
    lar_status status = check_device(session, &setting, error);
    if (!status && setting.kind == LAR_SETTING_ADD_TOOL) {
        int32_t place = lar_simulation_free_place(session->simulation);
        setting.of = lar_setting_of_tool(setting.of, place);
        request->answer->tool = lar_spares_first(&session->simulation->list) + place;
    }
    return status ? status : lar_session_apply(session, &setting, error);
}

static lar_status grasp(lar_session *session, const lar_request *request, int32_t *held,
                        lar_error *error) {
    static const double nowhere[3];
    const lar_session_tool *tool = &session->tool[request->tool];
    bool takes = request->kind == LAR_REQUEST_GRASP;
    const double *point = !takes ? nowhere : request->pointed ? request->point : NULL;
    if (session->player)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a recording is being played; leave it to take hold");
    if (session->status.state == LAR_SESSION_STOPPED)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "the run has broken off; reset it or load a state to take hold");
    if (tool->device)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s has a device, which takes hold and lets go itself", tool->info.name);
    lar_status status =
        lar_tool_check_grasp(&session->simulation->list.tool[request->tool], point, error);
    if (status) return status;
    return takes ? lar_session_take_hold(session, request->tool, point, held, error)
                 : lar_session_let_go(session, request->tool, error);
}

static lar_status change(lar_session *session, const lar_request *request, lar_error *error) {
    switch (request->kind) {
    case LAR_REQUEST_RESET:
        return end_player(session, request, reset(session, error));
    case LAR_REQUEST_SAVE:
        return request->save_to
                   ? lar_simulation_save_to(session->simulation, request->save_to, error)
                   : lar_simulation_pack(session->simulation, request->path,
                                         &request->answer->state, error);
    case LAR_REQUEST_LOAD:
        return end_player(session, request, load(session, request, error));
    case LAR_REQUEST_RECORD:
        return change_recorder(session, request, error);
    case LAR_REQUEST_REPLAY:
        return change_player(session, request, error);
    case LAR_REQUEST_SET:
        return set(session, request, error);
    case LAR_REQUEST_GRASP:
    case LAR_REQUEST_RELEASE:
        return grasp(session, request, &request->answer->held, error);
    case LAR_REQUEST_TOUCHES:
        return lar_simulation_tool_touches(session->simulation, request->tool, request->max,
                                           request->touch, &request->answer->held, error);
    default:
        return attach(session, request, error);
    }
}

/* ---- playing ------------------------------------------------------------------------------- */

static void step(lar_session *session, uint64_t steps) {
    if (steps == 0) return;
    session->steps_left = steps + (session->stepping ? session->steps_left : 0);
    session->stepping = true;
    lar_session_go_on(session);
}

/* To a moment of what is played: there, it rests or plays as it did. */
static void seek(lar_session *session, double seconds) {
    lar_error error;
    lar_player *player = session->player;
    if (!player) return;
    bool rested = session->status.state != LAR_SESSION_PLAYING;
    double place = fmax(0, seconds) / session->time_step;
    player->rests = rested || player->rests; /* sought again before it came there */
    uint64_t wanted = place < (double)player->length ? (uint64_t)place : player->length;
    if (lar_player_seek(player, session->simulation, wanted, &error)) {
        lar_session_stop(session, &error);
        return;
    }
    session->status.message[0] = '\0';
    lar_session_take_tools(session);
    lar_session_go_on(session);
}

/* Nobody waits, but everybody sees what came of it. */
static void grasp_unawaited(lar_session *session, const lar_request *request) {
    lar_grasp_answer answer = {.ticket = request->ticket};
    lar_error error;
    answer.status = grasp(session, request, &answer.held, &error);
    if (answer.status == LAR_ERROR_PEER) lar_session_stop(session, &error);
    if (request->kind == LAR_REQUEST_GRASP) session->tool[request->tool].grasp = answer;
    lar_session_publish(session, false);
}

static void go(lar_session *session, const lar_request *request) {
    if (request->kind == LAR_REQUEST_GRASP || request->kind == LAR_REQUEST_RELEASE) {
        grasp_unawaited(session, request);
        return;
    }
    bool broken = session->status.state == LAR_SESSION_STOPPED;
    if (request->kind == LAR_REQUEST_PACE)
        lar_pace_set(&session->pace, request->pace, lar_clock_ns());
    if (request->kind == LAR_REQUEST_END) session->ended = true;
    if (request->kind == LAR_REQUEST_SEEK) seek(session, request->seconds);
    if (broken) return;
    if (request->kind == LAR_REQUEST_PAUSE) {
        if (session->player) lar_player_stay(session->player);
        lar_session_rest(session);
    }
    if (request->kind == LAR_REQUEST_STEP) step(session, request->steps);
    if (request->kind != LAR_REQUEST_PLAY) return;
    session->stepping = false;
    lar_session_go_on(session);
}

void lar_session_execute(lar_session *session, const lar_request *request) {
    if (!request->answer) {
        go(session, request);
        return;
    }
    lar_error error = {LAR_OK, ""};
    lar_status status = change(session, request, &error);
    /* Whoever finds that a processor is lost: from now on nothing goes any more. */
    if (status == LAR_ERROR_PEER && session->status.error != LAR_ERROR_PEER)
        lar_session_stop(session, &error);
    lar_session_publish(session, true);
    request->answer->error = error;
    request->answer->status = status;
}
