#include "session/session.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

lar_session_options lar_session_options_default(void) {
    return (lar_session_options){.pace = 1};
}

/* ---- opening and closing ------------------------------------------------------------------- */

static lar_status check_number(const char *name, double value, lar_error *error) {
    if (value >= 0 && value <= 1e6) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "lar_session_options.%s is %g; it must be between 0 and 1e6", name, value);
}

static lar_status choose(lar_session *session, const lar_session_options *asked, lar_error *error) {
    lar_session_options *o = &session->options;
    *o = *asked;
    lar_status status = check_number("tick", o->tick, error);
    if (!status) status = check_number("pace", o->pace, error);
    if (!status) status = check_number("tool_speed", o->tool_speed, error);
    if (!status) status = check_number("hand_force", o->hand_force, error);
    if (status) return status;
    if (o->tick == 0) o->tick = 1e-3;
    if (o->tool_speed == 0) o->tool_speed = 1;
    if (o->hand_force == 0) o->hand_force = 5;
    if (o->hash_every == 0) o->hash_every = 100;
    /* A tick of exactly ten steps must not become nine by rounding. */
    double steps = floor(o->tick / session->time_step * (1 + 1e-9));
    session->tick_steps = steps < 1 ? 1 : (uint64_t)steps;
    session->pace.pace = o->pace;
    return LAR_OK;
}

static lar_status make_tools(lar_session *session, lar_error *error) {
    const lar_coupling_limits limits = {.tool_speed = session->options.tool_speed,
                                        .hand_force = session->options.hand_force,
                                        .seconds =
                                            (double)session->tick_steps * session->time_step};
    lar_status status = LAR_OK;
    session->tools = lar_simulation_tool_count(session->simulation);
    for (int32_t i = 0; i < session->tools && !status; i++) {
        lar_session_tool *tool = &session->tool[i];
        status = lar_simulation_tool(session->simulation, i, &tool->info, error);
        lar_coupling_create(&tool->coupling, &tool->info, &limits);
        if (!status)
            status = lar_mailbox_create(&tool->hand, sizeof(lar_tool_pose), "a tool", error);
    }
    if (!status) status = lar_history_create(session->tools, &session->history, error);
    if (!status) lar_session_take_tools(session);
    return status;
}

static void destroy(lar_session *session) {
    for (int32_t i = 0; i < session->tools; i++) {
        lar_device_close(session->tool[i].device);
        lar_mailbox_destroy(&session->tool[i].hand);
    }
    lar_history_destroy(&session->history);
    lar_snapshots_destroy(&session->snapshots);
    lar_mailbox_destroy(&session->view);
    lar_requests_destroy(&session->requests);
    free(session);
}

lar_status lar_session_open(lar_simulation *simulation, const lar_session_options *options,
                            lar_session **out, lar_error *error) {
    if (!simulation || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_session_open needs a simulation and a place for the session");
    lar_session_options asked = options ? *options : lar_session_options_default();
    lar_session *session = lar_calloc(1, sizeof *session);
    if (!session) return lar_fail_memory(error, sizeof *session, "the session");
    lar_requests_create(&session->requests);
    session->simulation = simulation;
    session->time_step = lar_simulation_time_step(simulation);
    lar_status status = choose(session, &asked, error);
    if (!status) status = make_tools(session, error);
    if (!status)
        status = lar_mailbox_create(&session->view, sizeof(lar_session_view), "a session", error);
    if (!status) status = lar_snapshots_create(simulation, &session->snapshots, error);
    if (status) {
        destroy(session);
        return status;
    }
    lar_session_publish(session, true);
    *out = session;
    return LAR_OK;
}

/* Signals are for the threads of the program, not for the engine. */
static int start_thread(lar_session *session) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int cause = pthread_create(&session->thread, NULL, lar_session_run, session);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return cause;
}

lar_status lar_session_start(lar_session *session, lar_error *error) {
    if (!session)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "lar_session_start needs a session, not NULL");
    lar_status status = LAR_OK;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started) {
        status = lar_fail(error, LAR_ERROR_ARGUMENT, "the session has been started already");
    } else {
        if (session->status.state == LAR_SESSION_IDLE)
            session->status.state =
                session->options.paused ? LAR_SESSION_PAUSED : LAR_SESSION_PLAYING;
        lar_session_publish(session, true);
        int cause = start_thread(session);
        session->started = cause == 0;
        if (cause) {
            session->status.state = LAR_SESSION_IDLE;
            lar_session_publish(session, true);
            status = lar_fail(error, LAR_ERROR_MEMORY,
                              "the system gives no thread for the session: %s; raise the limit "
                              "(ulimit -u)",
                              strerror(cause));
        }
    }
    pthread_mutex_unlock(&session->requests.lock);
    return status;
}

/* ---- asking -------------------------------------------------------------------------------- */

static void ask(lar_session *session, lar_request request) {
    if (!session) return;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started)
        lar_requests_place(&session->requests, &request);
    else
        lar_session_obey(session, &request);
    pthread_mutex_unlock(&session->requests.lock);
}

static lar_status ask_and_wait(lar_session *session, lar_request request, lar_error *error) {
    lar_request_answer answer = {0};
    if (!session)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a call of a session needs one, not NULL");
    request.answer = &answer;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started) {
        lar_requests_place(&session->requests, &request);
        while (!answer.done) lar_requests_wait(&session->requests, INT64_MAX);
    } else {
        lar_session_obey(session, &request);
    }
    pthread_mutex_unlock(&session->requests.lock);
    if (error && answer.status) *error = answer.error;
    return answer.status;
}

lar_status lar_session_close(lar_session *session, lar_error *error) {
    (void)error;
    if (!session) return LAR_OK;
    ask(session, (lar_request){.kind = LAR_REQUEST_END});
    if (session->started) pthread_join(session->thread, NULL);
    destroy(session);
    return LAR_OK;
}

void lar_session_play(lar_session *session) {
    ask(session, (lar_request){.kind = LAR_REQUEST_PLAY});
}

void lar_session_pause(lar_session *session) {
    ask(session, (lar_request){.kind = LAR_REQUEST_PAUSE});
}

void lar_session_step(lar_session *session, uint64_t steps) {
    ask(session, (lar_request){.kind = LAR_REQUEST_STEP, .steps = steps});
}

void lar_session_set_pace(lar_session *session, double pace) {
    if (pace >= 0 && pace <= 1e6)
        ask(session, (lar_request){.kind = LAR_REQUEST_PACE, .pace = pace});
}

lar_status lar_session_reset(lar_session *session, lar_error *error) {
    return ask_and_wait(session, (lar_request){.kind = LAR_REQUEST_RESET}, error);
}

static lar_status check_path(const char *path, const char *call, lar_error *error) {
    if (path && *path) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs the path of a file", call);
}

lar_status lar_session_save(lar_session *session, const char *path, lar_error *error) {
    lar_status status = check_path(path, "lar_session_save", error);
    return status ? status
                  : ask_and_wait(session, (lar_request){.kind = LAR_REQUEST_SAVE, .path = path},
                                 error);
}

lar_status lar_session_load(lar_session *session, const char *path, lar_error *error) {
    lar_status status = check_path(path, "lar_session_load", error);
    return status ? status
                  : ask_and_wait(session, (lar_request){.kind = LAR_REQUEST_LOAD, .path = path},
                                 error);
}

lar_status lar_session_record(lar_session *session, const char *path, lar_error *error) {
    return ask_and_wait(session, (lar_request){.kind = LAR_REQUEST_RECORD, .path = path}, error);
}

/* ---- tools --------------------------------------------------------------------------------- */

static lar_status check_tool(const lar_session *session, int32_t tool, lar_error *error) {
    if (!session)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a call of a session needs one, not NULL");
    if (tool >= 0 && tool < session->tools) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no tool %ld; the session has %ld, counted from 0", (long)tool,
                    (long)session->tools);
}

/* A pose as a device gives it: the quaternion may be off unit length by rounding. */
static lar_status clean_pose(const lar_tool_pose *pose, lar_tool_pose *clean, lar_error *error) {
    double square = 0, sum = pose->opening;
    for (int i = 0; i < 4; i++) square += pose->orientation[i] * pose->orientation[i];
    for (int i = 0; i < 3; i++) sum += fabs(pose->position[i]);
    if (!(sum < 1e9) || !(fabs(square - 1) < 0.01) || !(pose->opening >= 0 && pose->opening <= 1))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "this is no pose of a tool: position %g %g %g m, orientation %g %g %g %g, "
                        "opening %g; give finite numbers, a unit quaternion, an opening from 0 "
                        "to 1",
                        pose->position[0], pose->position[1], pose->position[2],
                        pose->orientation[0], pose->orientation[1], pose->orientation[2],
                        pose->orientation[3], pose->opening);
    *clean = *pose;
    for (int i = 0; i < 4; i++) clean->orientation[i] /= sqrt(square);
    return LAR_OK;
}

lar_status lar_session_tool_move(lar_session *session, int32_t tool, const lar_tool_pose *pose,
                                 lar_error *error) {
    lar_tool_pose clean;
    lar_status status = check_tool(session, tool, error);
    if (!status && !pose)
        status = lar_fail(error, LAR_ERROR_ARGUMENT, "lar_session_tool_move needs a pose");
    if (!status) status = clean_pose(pose, &clean, error);
    if (status) return status;
    lar_mailbox *box = &session->tool[tool].hand;
    lar_mailbox_lock(box);
    *(lar_tool_pose *)lar_mailbox_draft(box) = clean;
    lar_mailbox_send(box);
    lar_mailbox_unlock(box);
    return LAR_OK;
}

/* Reading takes a letter out of the box, which changes nothing that callers see. */
static const lar_session_view *look_at_view(const lar_session *session) {
    lar_mailbox *box = &((lar_session *)session)->view;
    lar_mailbox_lock(box);
    return lar_mailbox_newest(box, NULL);
}

static void end_look(const lar_session *session) {
    lar_mailbox_unlock(&((lar_session *)session)->view);
}

lar_status lar_session_tool_force(const lar_session *session, int32_t tool, lar_tool_pose *pose,
                                  lar_tool_force *force, lar_error *error) {
    lar_status status = check_tool(session, tool, error);
    if (status) return status;
    const lar_session_view *view = look_at_view(session);
    if (pose) *pose = view->tool[tool].pose;
    if (force) *force = view->tool[tool].force;
    end_look(session);
    return LAR_OK;
}

void lar_session_status_get(const lar_session *session, lar_session_status *status) {
    if (!session || !status) return;
    *status = look_at_view(session)->status;
    end_look(session);
}

int32_t lar_session_force_history(const lar_session *session, int32_t tool, uint64_t after,
                                  int32_t most, float (*force)[3], uint64_t *last) {
    uint64_t ignored;
    if (last) *last = after;
    if (check_tool(session, tool, NULL) || !force) return 0;
    return lar_history_copy(&session->history, tool, after, most, force, last ? last : &ignored);
}

/* ---- snapshots ----------------------------------------------------------------------------- */

lar_status lar_snapshot_create(const lar_session *session, lar_snapshot **out, lar_error *error) {
    if (!session || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_snapshot_create needs a session and a place for the snapshot");
    int32_t nodes = session->simulation->domain.model->mesh.node_count;
    lar_snapshot *snapshot = lar_calloc(1, sizeof *snapshot);
    if (snapshot) snapshot->u = lar_calloc((size_t)nodes, sizeof *snapshot->u);
    if (!snapshot || !snapshot->u) {
        free(snapshot);
        return lar_fail_memory(error, (size_t)nodes * sizeof *snapshot->u, "a snapshot");
    }
    snapshot->nodes = nodes;
    *out = snapshot;
    return LAR_OK;
}

void lar_snapshot_destroy(lar_snapshot *snapshot) {
    if (!snapshot) return;
    free(snapshot->u);
    free(snapshot);
}

lar_status lar_session_snapshot(lar_session *session, lar_snapshot *snapshot, double seconds,
                                lar_error *error) {
    if (!session || !snapshot)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_session_snapshot needs a session and a snapshot; neither may be NULL");
    int64_t limit = lar_clock_ns() + (int64_t)(1e9 * fmin(fmax(seconds, 0), 1e6));
    uint64_t number = lar_snapshots_ask(&session->snapshots);
    bool in_time = true;
    pthread_mutex_lock(&session->requests.lock);
    if (!session->started) lar_snapshots_serve(&session->snapshots, session->simulation);
    pthread_cond_signal(&session->requests.work);
    while (in_time && !lar_snapshots_ready(&session->snapshots, number))
        in_time = lar_requests_wait(&session->requests, limit);
    in_time = lar_snapshots_ready(&session->snapshots, number);
    pthread_mutex_unlock(&session->requests.lock);
    if (!in_time)
        return lar_fail(error, LAR_ERROR_PEER,
                        "no snapshot came within %g s: a tick takes longer; wait longer", seconds);
    return lar_snapshots_take(&session->snapshots, session->simulation, snapshot, error);
}
