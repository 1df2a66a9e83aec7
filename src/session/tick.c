/* The engine's thread: ticks, and what is done between them. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "session/session.h"

/* Not in every build yet. */
extern __typeof__(lar_simulation_reset) lar_simulation_reset __attribute__((weak));
extern __typeof__(lar_simulation_save) lar_simulation_save __attribute__((weak));
extern __typeof__(lar_simulation_load) lar_simulation_load __attribute__((weak));

/* How long a force takes to fade when the engine pauses [s]. */
static const double FADE = 0.05;
static const int64_t LONG = 3600LL * 1000000000; /* [ns] */

/* ---- tools --------------------------------------------------------------------------------- */

void lar_session_take_tools(lar_session *session) {
    for (int32_t i = 0; i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        lar_mailbox_newest(&tool->hand, NULL); /* what was sent before does not count */
        lar_simulation_tool_pose(session->simulation, i, &tool->pose, NULL);
        tool->target = tool->pose;
        tool->force = (lar_tool_force){0};
        tool->led = false;
    }
}

static void follow(const lar_session *session, lar_session_tool *tool, uint64_t steps) {
    double way[3], length = 0;
    double most = session->options.tool_speed * (double)steps * session->time_step;
    for (int i = 0; i < 3; i++) {
        way[i] = tool->target.position[i] - tool->pose.position[i];
        length += way[i] * way[i];
    }
    double share = length > most * most ? most / sqrt(length) : 1;
    for (int i = 0; i < 3; i++) tool->pose.position[i] += share * way[i];
    memcpy(tool->pose.orientation, tool->target.orientation, sizeof tool->pose.orientation);
    tool->pose.opening = tool->target.opening;
}

static lar_status move_tools(lar_session *session, uint64_t steps, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < session->tools && !status; i++) {
        lar_session_tool *tool = &session->tool[i];
        bool fresh;
        const lar_tool_pose *hand = lar_mailbox_newest(&tool->hand, &fresh);
        if (fresh) {
            tool->target = *hand;
            tool->led = true;
        }
        if (!tool->led) continue;
        follow(session, tool, steps);
        status = lar_simulation_tool_move(session->simulation, i, &tool->pose, steps, error);
    }
    return status;
}

static void feel_tools(lar_session *session) {
    lar_history_begin(&session->history);
    for (int32_t i = 0; i < session->tools; i++) {
        lar_session_tool *tool = &session->tool[i];
        lar_simulation_tool_force(session->simulation, i, &tool->force, NULL);
        lar_history_put(&session->history, i, tool->force.force);
    }
    lar_history_end(&session->history);
}

static void drop_forces(lar_session *session, double share) {
    for (int32_t i = 0; i < session->tools; i++) {
        lar_tool_force *force = &session->tool[i].force;
        for (int k = 0; k < 3; k++) {
            force->force[k] *= share;
            force->torque[k] *= share;
        }
    }
}

/* ---- telling ------------------------------------------------------------------------------- */

void lar_session_publish(lar_session *session, bool quantiles) {
    lar_session_status *status = &session->status;
    status->step = lar_simulation_steps(session->simulation);
    status->time = (double)status->step * session->time_step;
    lar_pace_report(&session->pace, quantiles, status);
    lar_session_view *view = lar_mailbox_draft(&session->view);
    view->status = *status;
    for (int32_t i = 0; i < session->tools; i++) {
        view->tool[i].pose = session->tool[i].pose;
        view->tool[i].force = session->tool[i].force;
    }
    lar_mailbox_send(&session->view);
}

static void serve_snapshots(lar_session *session) {
    bool served = lar_snapshots_serve(&session->snapshots, session->simulation);
    session->pace.total.snapshots += served;
    if (served || session->requests.ring_the_bell) lar_requests_ring(&session->requests);
}

/* ---- playing ------------------------------------------------------------------------------- */

static void stop(lar_session *session, const lar_error *error) {
    session->status.state = LAR_SESSION_STOPPED;
    memcpy(session->status.message, error->message, sizeof session->status.message);
    lar_pace_stop(&session->pace);
    drop_forces(session, 0);
    lar_session_publish(session, true);
}

static void pause_now(lar_session *session) {
    session->status.state = LAR_SESSION_PAUSED;
    session->stepping = false;
    lar_pace_stop(&session->pace);
    lar_session_publish(session, true);
}

static void play(lar_session *session) {
    session->status.state = LAR_SESSION_PLAYING;
    lar_pace_start(&session->pace);
}

static void tick(lar_session *session) {
    lar_error error;
    uint64_t steps = session->tick_steps;
    if (session->stepping && session->steps_left < steps) steps = session->steps_left;
    lar_pace_begin(&session->pace, steps, (double)steps * session->time_step);
    lar_status status = move_tools(session, steps, &error);
    int64_t begin = lar_clock_ns();
    if (!status) status = lar_simulation_advance(session->simulation, steps, &error);
    if (status) {
        stop(session, &error);
        return;
    }
    lar_pace_computed(&session->pace, steps, lar_clock_ns() - begin);
    feel_tools(session);
    session->pace.total.exchanges++;
    lar_pace_answered(&session->pace);
    lar_session_publish(session, lar_pace_look(&session->pace));
    serve_snapshots(session);
    if (!session->stepping) return;
    session->steps_left -= steps;
    if (session->steps_left == 0) pause_now(session);
}

/* ---- what is asked for --------------------------------------------------------------------- */

/* The simulation is somewhere else now. */
static void arrive(lar_session *session) {
    lar_session_take_tools(session);
    session->status.message[0] = '\0';
    if (session->status.state == LAR_SESSION_STOPPED) play(session);
    lar_pace_restart(&session->pace);
}

static lar_status change(lar_session *session, const lar_request *request, lar_error *error) {
    lar_simulation *simulation = session->simulation;
    lar_status status = LAR_OK;
    if (!lar_simulation_reset || !lar_simulation_save || !lar_simulation_load)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "this build cannot go back, save or load");
    switch (request->kind) {
    case LAR_REQUEST_RESET:
        status = lar_simulation_reset(simulation, error);
        if (!status) arrive(session);
        break;
    case LAR_REQUEST_SAVE:
        status = lar_simulation_save(simulation, request->path, error);
        break;
    case LAR_REQUEST_LOAD:
        status = lar_simulation_load(simulation, request->path, error);
        if (!status) arrive(session);
        break;
    default:
        status = lar_fail(error, LAR_ERROR_UNSUPPORTED, "recording is not there yet");
        break;
    }
    return status;
}

static void go(lar_session *session, const lar_request *request) {
    bool broken = session->status.state == LAR_SESSION_STOPPED;
    switch (request->kind) {
    case LAR_REQUEST_PLAY:
        session->stepping = false;
        if (!broken) play(session);
        break;
    case LAR_REQUEST_PAUSE:
        if (!broken) pause_now(session);
        break;
    case LAR_REQUEST_STEP:
        if (broken || request->steps == 0) break;
        session->steps_left = (session->stepping ? session->steps_left : 0) + request->steps;
        session->stepping = true;
        play(session);
        break;
    case LAR_REQUEST_PACE:
        lar_pace_set(&session->pace, request->pace);
        break;
    default:
        session->ended = true;
        break;
    }
}

void lar_session_obey(lar_session *session, const lar_request *request) {
    if (!request->answer) {
        go(session, request);
        return;
    }
    lar_error error = {LAR_OK, ""};
    lar_status status = change(session, request, &error);
    lar_session_publish(session, true);
    request->answer->error = error;
    request->answer->status = status;
}

static void obey_requests(lar_session *session) {
    lar_request request;
    while (!session->ended && lar_requests_next(&session->requests, &request)) {
        lar_session_obey(session, &request);
        if (request.answer) lar_requests_answer(&session->requests, request.answer);
    }
}

/* ---- the thread ---------------------------------------------------------------------------- */

static bool snapshot_is_wanted(void *context) {
    const lar_session *session = context;
    return lar_snapshots_wanted(&session->snapshots);
}

/* Not playing: the forces fade, and then nothing happens until somebody asks for something. */
static void rest(lar_session *session, double *fade) {
    int64_t wake = lar_clock_ns() + LONG;
    if (*fade > 0) {
        double seconds = (double)session->tick_steps * session->time_step;
        double left = fmax(0, *fade - seconds);
        drop_forces(session, left / *fade);
        *fade = left;
        lar_session_publish(session, false);
        wake = lar_clock_ns() + (int64_t)(1e9 * fmin(seconds, FADE));
    }
    serve_snapshots(session);
    lar_requests_sleep(&session->requests, snapshot_is_wanted, session, wake);
}

void *lar_session_run(void *argument) {
    lar_session *session = argument;
    double fade = FADE;
    lar_clock_be_prompt();
    if (session->status.state == LAR_SESSION_PLAYING) lar_pace_start(&session->pace);
    while (!session->ended) {
        obey_requests(session);
        if (session->ended) break;
        if (session->status.state == LAR_SESSION_PLAYING) {
            tick(session);
            fade = FADE;
            if (session->status.state == LAR_SESSION_PLAYING) lar_pace_wait(&session->pace);
        } else {
            rest(session, &fade);
        }
    }
    lar_pace_stop(&session->pace);
    return NULL;
}
