/* The engine's thread: ticks, and what is done between them. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "session/session.h"

/* How long a force takes to fade when the engine pauses [s]. */
static const double FADE = 0.05;
static const int64_t LONG = 3600000000000; /* [ns] */

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

void lar_session_note(lar_session *session, const lar_record *record) {
    (void)session, (void)record;
}

/* ---- playing ------------------------------------------------------------------------------- */

static void stop(lar_session *session, const lar_error *error) {
    session->status.state = LAR_SESSION_STOPPED;
    memcpy(session->status.message, error->message, sizeof session->status.message);
    lar_pace_stop(&session->pace);
    lar_session_idle_tools(session, 0);
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
    lar_status status = lar_session_move_tools(session, &error);
    int64_t begin = lar_clock_ns();
    if (!status) status = lar_simulation_advance(session->simulation, steps, &error);
    if (status) {
        stop(session, &error);
        return;
    }
    lar_pace_computed(&session->pace, steps, lar_clock_ns() - begin);
    lar_session_feel_tools(session);
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

/* Not playing: the forces fade, and then nothing happens until somebody asks for something, or a
 * device has to be looked after. */
static void rest(lar_session *session, double *fade) {
    double seconds = (double)session->tick_steps * session->time_step;
    double left = fmax(0, *fade - seconds);
    int64_t wake = lar_clock_ns() + (int64_t)(1e9 * fmin(seconds, FADE));
    bool device = lar_session_idle_tools(session, *fade > 0 ? left / *fade : 0);
    if (device) session->pace.total.exchanges++;
    bool look = lar_pace_look(&session->pace);
    if (*fade > 0 || (device && look)) lar_session_publish(session, look);
    if (*fade <= 0 && !device) wake += LONG;
    *fade = left;
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
