/* The engine's thread: ticks, and what is done between them. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/thread.h"
#include "session/session.h"

/* How long a force takes to fade when the engine pauses or stops [s]. */
static const double FADE = 0.05;
/* How often a session that does not advance looks whether the other processes live [ns]. */
static const int64_t LOOK = 200000000;
static const int64_t LONG = 3600000000000; /* [ns] */
/* A tick that is due later than this is not just waited for [ns]. */
static const int64_t FAR = 20000000;

/* ---- telling ------------------------------------------------------------------------------- */

static bool is_touched(const lar_session *session) {
    for (int32_t i = 0; i < session->tools; i++)
        if (session->tool[i].force.touching + session->tool[i].force.held > 0) return true;
    return false;
}

void lar_session_publish(lar_session *session, bool quantiles) {
    lar_session_status *status = &session->status;
    status->step = lar_simulation_steps(session->simulation);
    status->time = (double)status->step * session->time_step;
    const int32_t parts = lar_simulation_step_parts(session->simulation);
    if (parts != status->step_parts) lar_pace_forget_min(&session->pace);
    status->step_parts = parts;
    status->divided_steps =
        lar_simulation_divided_steps(session->simulation, NULL) - session->divided;
    lar_heavier heavier;
    lar_simulation_heavier(session->simulation, &heavier);
    status->heavier = heavier.elements;
    status->heavier_share = heavier.share;
    lar_pace_report(&session->pace, quantiles, lar_clock_ns(), status);
    session->advice.stiffer = session->simulation->tools.division.base;
    session->advice.touched = is_touched(session);
    if (quantiles) lar_advise(&session->advice, session->pace.pace, status);
    const lar_player *player = session->player;
    status->replaying = player != NULL;
    status->replay_time = player ? (double)player->place * session->time_step : 0;
    status->replay_length = player ? (double)player->length * session->time_step : 0;
    lar_session_view *view = lar_triple_buffer_back(session->view);
    view->status = *status;
    lar_simulation_gravity(session->simulation, view->gravity);
    view->damping = lar_simulation_damping(session->simulation);
    memcpy(view->factor, session->simulation->tools.settings.factor, sizeof view->factor);
    memcpy(view->activation, session->simulation->tools.settings.activation,
           sizeof view->activation);
    for (int32_t i = 0; i < session->tools; i++) {
        view->tool[i].info = session->tool[i].info;
        view->tool[i].pose = session->tool[i].place;
        view->tool[i].force = session->tool[i].force;
        view->tool[i].felt = session->tool[i].felt;
        view->tool[i].load = session->tool[i].load;
        view->tool[i].grasp = session->tool[i].grasp;
        if (quantiles && session->tool[i].device)
            lar_device_status_get(session->tool[i].device, &session->tool[i].device_status);
        view->tool[i].device = session->tool[i].device_status;
    }
    lar_triple_buffer_publish(session->view);
}

bool lar_session_serve_snapshots(lar_session *session) {
    lar_snapshot_tool tool[LAR_TOOLS_MAX];
    if (!lar_snapshots_wanted(&session->snapshots)) return false;
    for (int32_t i = 0; i < session->tools; i++) {
        const lar_session_tool *from = &session->tool[i];
        tool[i].pose = from->place;
        memcpy(tool[i].force, from->force.force, sizeof tool[i].force);
        memcpy(tool[i].torque, from->force.torque, sizeof tool[i].torque);
    }
    lar_snapshots_serve(&session->snapshots, session->simulation, tool, session->tools);
    return true;
}

static void serve_snapshots(lar_session *session) {
    lar_error error;
    if (session->status.state == LAR_SESSION_PLAYING && lar_snapshots_wanted(&session->snapshots) &&
        lar_simulation_gather(session->simulation, &error))
        lar_session_stop(session, &error);
    bool served = lar_session_serve_snapshots(session);
    session->pace.total.snapshots += served;
    if (served || session->requests.ring_the_bell) lar_requests_ring(&session->requests);
}

/* ---- playing ------------------------------------------------------------------------------- */

_Static_assert(sizeof((lar_session_status *)0)->message == sizeof((lar_error *)0)->message,
               "copied whole, with its end");

void lar_session_stop(lar_session *session, const lar_error *error) {
    session->status.state = LAR_SESSION_STOPPED;
    session->stepping = false;
    session->status.error = error->status;
    memcpy(session->status.message, error->message, sizeof session->status.message);
    lar_pace_stop(&session->pace, lar_clock_ns());
    lar_session_drop_forces(session);
    lar_session_publish(session, true);
}

void lar_session_rest(lar_session *session) {
    session->status.state = LAR_SESSION_PAUSED;
    session->stepping = false;
    lar_pace_stop(&session->pace, lar_clock_ns());
    lar_session_publish(session, true);
}

void lar_session_go_on(lar_session *session) {
    session->status.state = LAR_SESSION_PLAYING;
    lar_pace_start(&session->pace, lar_clock_ns());
}

/* What is played ends here, or cannot go on: it rests. */
static void rest_player(lar_session *session, const lar_error *error) {
    if (error) memcpy(session->status.message, error->message, sizeof error->message);
    lar_session_rest(session);
}

/* On the way to a place that somebody wants to see: as fast as it goes, and never long at once. */
static void hurry(lar_session *session) {
    lar_player *player = session->player;
    lar_error error;
    lar_status status = LAR_OK;
    int64_t until = lar_clock_ns() + FAR;
    while (!status && player->place < player->goal && lar_clock_ns() < until) {
        uint64_t left = player->goal - player->place, steps = session->tick_steps;
        status =
            lar_player_advance(player, session->simulation, left < steps ? left : steps, &error);
        if (player->goal > player->length) player->goal = player->length;
    }
    lar_session_feel_tools(session);
    lar_pace_restart(&session->pace, lar_clock_ns());
    lar_session_publish(session, lar_pace_look(&session->pace, lar_clock_ns()));
    serve_snapshots(session);
    if (status || (player->place >= player->goal && player->rests))
        rest_player(session, status ? &error : NULL);
    if (player->place >= player->goal) player->rests = false;
}

/* How many steps the tick has. */
static uint64_t begin_tick(lar_session *session) {
    uint64_t steps = session->tick_steps;
    if (session->stepping && session->steps_left < steps) steps = session->steps_left;
    lar_pace_begin(&session->pace, (double)steps * session->time_step, lar_clock_ns());
    return steps;
}

/* The least of a second is wanted, and the kernel takes half a microsecond to answer. 0: not asked.
 */
static int64_t processor_time(const lar_session *session) {
    return session->pace.total.ticks % 8 == 0 ? lar_clock_thread_ns() : 0;
}

/* Hands feel it, and everybody is told. */
static void answer(lar_session *session) {
    lar_session_feel_tools(session);
    session->pace.total.exchanges++;
    lar_pace_answered(&session->pace, lar_clock_ns());
    lar_session_publish(session, lar_pace_look(&session->pace, lar_clock_ns()));
}

/* Rests when all steps that were asked for are done. */
static void count_steps(lar_session *session, uint64_t steps) {
    if (!session->stepping) return;
    session->steps_left -= steps;
    if (session->steps_left == 0) lar_session_rest(session);
}

/* A tick of what is played: as one of a run, but tools follow the recording. */
static void play_tick(lar_session *session) {
    lar_player *player = session->player;
    lar_error error;
    uint64_t steps = begin_tick(session);
    int64_t begin = lar_clock_ns(), before = processor_time(session);
    lar_status status = lar_player_advance(player, session->simulation, steps, &error);
    lar_pace_computed(&session->pace, steps, lar_clock_ns() - begin,
                      before ? lar_clock_thread_ns() - before : 0);
    answer(session);
    serve_snapshots(session);
    if (status || player->place >= player->length) rest_player(session, status ? &error : NULL);
    count_steps(session, steps);
}

static void tick(lar_session *session) {
    lar_error error;
    uint64_t steps = begin_tick(session);
    lar_status status = lar_session_move_tools(session, &error);
    int64_t begin = lar_clock_ns(), before = processor_time(session);
    if (!status) status = lar_simulation_compute(session->simulation, steps, NULL, NULL, &error);
    if (status) {
        if (!lar_session_recover(session, &error)) lar_session_stop(session, &error);
        return;
    }
    lar_pace_computed(&session->pace, steps, lar_clock_ns() - begin,
                      before ? lar_clock_thread_ns() - before : 0);
    answer(session);
    session->good_step = session->status.step;
    serve_snapshots(session);
    if (session->status.recording &&
        session->good_step - session->hashed >= session->options.hash_every)
        lar_session_record_hash(session);
    if (session->status.state == LAR_SESSION_PLAYING && lar_session_keep_state(session, &error))
        lar_session_stop(session, &error);
    count_steps(session, steps);
}

static void play(lar_session *session) {
    const lar_player *player = session->player;
    if (!player)
        tick(session);
    else if (player->goal > player->place || player->rests)
        hurry(session);
    else
        play_tick(session);
}

/* ---- the thread ---------------------------------------------------------------------------- */

static void execute_requests(lar_session *session) {
    lar_request request;
    while (!session->ended && lar_requests_next(&session->requests, &request)) {
        lar_session_execute(session, &request);
        if (request.answer) lar_requests_answer(&session->requests, request.answer);
    }
}

static bool snapshot_is_wanted(void *context) {
    const lar_session *session = context;
    return lar_snapshots_wanted(&session->snapshots);
}

/* A processor of another process that is lost is noticed where something is waited for; while
 * nothing is, somebody has to look. Returns when to look again. */
static int64_t look_for_losses(lar_session *session, int64_t now) {
    lar_error error;
    if (!lar_simulation_has_peers(session->simulation)) return now + LONG;
    if (lar_simulation_look(session->simulation, &error)) lar_session_stop(session, &error);
    return now + LOOK;
}

/* Forces fade by the clock: how much is left of the time, and since when. */
typedef struct fading {
    double left; /* [s] */
    int64_t at;  /* [ns] */
} fading;

static fading fade_from_now(void) {
    return (fading){FADE, lar_clock_ns()};
}

/* Not playing: the forces fade, and then nothing happens until somebody asks for something, or a
 * device has to be looked after. */
static void rest(lar_session *session, fading *fade) {
    double seconds = (double)session->tick_steps * session->time_step;
    int64_t now = lar_clock_ns(), wake = now + (int64_t)(1e9 * fmin(seconds, FADE));
    double left = fmax(0, fade->left - 1e-9 * (double)(now - fade->at));
    bool device = lar_session_idle_tools(session, fade->left > 0 ? left / fade->left : 0);
    if (device) session->pace.total.exchanges++;
    bool look = lar_pace_look(&session->pace, now);
    if (fade->left > 0 || look) lar_session_publish(session, look);
    int64_t again = look_for_losses(session, now);
    if (fade->left <= 0 && !device) wake = again;
    *fade = (fading){left, now};
    serve_snapshots(session);
    lar_requests_sleep(&session->requests, snapshot_is_wanted, session, wake);
}

/* Threads that go before all others have their cores for themselves: while a session finds no time
 * to wait, not even a viewer is served, and Linux stops them for 50 ms of every second
 * (sched_rt_runtime_us). Then a twelfth of the time is taken off, half a millisecond at once. */
static bool owes_a_turn(lar_session *session, int64_t now, int64_t turn) {
    static const int64_t SHARE = 12, MUCH = 10000000; /* [ns] */
    int64_t busy = now - session->waited;
    session->owed += (busy < FAR ? busy : FAR) / SHARE;
    return session->owed > MUCH && session->pace.deadline.due < now + turn;
}

static void wait_until_due(lar_session *session) {
    static const int64_t TURN = 500000, BEFORE = 60000; /* [ns] */
    int64_t now = lar_clock_ns(), rise = session->pace.deadline.due - BEFORE;
    if (session->urgent && owes_a_turn(session, now, TURN)) {
        lar_clock_sleep_until(now + TURN);
    } else {
        /* Threads of the other processors have fallen asleep, and wake before they are needed. */
        if (session->urgent && rise > now + BEFORE) {
            lar_clock_wait_until(rise, LAR_WAKE_EARLY);
            lar_simulation_rouse(session->simulation);
        }
        lar_pace_wait(&session->pace);
    }
    session->waited = lar_clock_ns();
    session->owed -= session->waited - now;
    if (session->owed < 0) session->owed = 0;
}

/* What the engine will have to do soon is done while the clock is waited for. */
static void work_ahead(lar_session *session) {
    static const double BEFORE = 150e-6; /* [s] */
    double until = 1e-9 * (double)session->pace.deadline.due - BEFORE;
    lar_error error;
    if (session->pace.pace > 0 && lar_clock_seconds() < until &&
        lar_simulation_work_ahead(session->simulation, until, &error))
        lar_session_stop(session, &error);
}

/* Until the next tick is due. In very slow motion that is long: requests and snapshots are served
 * meanwhile, as in a pause. */
static void wait_for_tick(lar_session *session) {
    lar_pace *pace = &session->pace;
    while (!session->ended && session->status.state == LAR_SESSION_PLAYING && pace->pace > 0 &&
           pace->deadline.due - lar_clock_ns() > FAR) {
        serve_snapshots(session);
        int64_t wake = pace->deadline.due - FAR;
        int64_t look = look_for_losses(session, lar_clock_ns());
        if (session->status.state != LAR_SESSION_PLAYING) return;
        lar_requests_sleep(&session->requests, snapshot_is_wanted, session,
                           look < wake ? look : wake);
        execute_requests(session);
    }
    if (!session->ended && session->status.state == LAR_SESSION_PLAYING) work_ahead(session);
    if (!session->ended && session->status.state == LAR_SESSION_PLAYING) wait_until_due(session);
}

void *lar_session_run(void *argument) {
    lar_session *session = argument;
    fading fade = fade_from_now();
    lar_simulation_reserve_here(session->simulation);
    lar_clock_be_prompt();
    session->urgent = lar_thread_priority();
    if (session->urgent) lar_simulation_go_before(session->simulation, session->urgent);
    if (session->status.state == LAR_SESSION_PLAYING) lar_session_go_on(session);
    while (!session->ended) {
        execute_requests(session);
        if (session->ended) break;
        if (session->status.state == LAR_SESSION_PLAYING) {
            play(session);
            wait_for_tick(session);
            fade = fade_from_now();
        } else {
            rest(session, &fade);
        }
    }
    lar_pace_stop(&session->pace, lar_clock_ns());
    if (session->urgent) lar_simulation_go_before(session->simulation, 0);
    return NULL;
}

/* ---- a host's clock ------------------------------------------------------------------------ */

void lar_session_execute_asked(lar_session *session) {
    lar_request request;
    while (lar_requests_take(&session->requests, &request)) lar_session_execute(session, &request);
}

static void begin_hosted(lar_session *session) {
    session->hosted = true;
    if (session->status.state != LAR_SESSION_IDLE) return;
    if (session->options.paused)
        session->status.state = LAR_SESSION_PAUSED;
    else
        lar_session_go_on(session);
}

/* Forces fade as in rest(), by ticks: a hundredth is left after FADE. */
static void rest_hosted(lar_session *session) {
    double seconds = (double)session->tick_steps * session->time_step;
    lar_session_idle_tools(session, exp(-4.6 * seconds / FADE));
    serve_snapshots(session);
    lar_session_publish(session, lar_pace_look(&session->pace, lar_clock_ns()));
}

/* Under the lock, which keeps out those who do what they ask for themselves (calls.c). */
static void host_tick(lar_session *session) {
    if (!session->hosted) begin_hosted(session);
    lar_simulation_reserve_here(session->simulation);
    lar_session_execute_asked(session);
    session->pace.pace = 0; /* nothing is late by a clock that is not ours */
    if (session->status.state == LAR_SESSION_PLAYING)
        play(session);
    else
        rest_hosted(session);
    lar_simulation_reserve_here(NULL); /* between two ticks the host is a caller like others */
}

lar_status lar_session_tick(lar_session *session, lar_error *error) {
    if (!session)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "lar_session_tick needs a session, not NULL");
    lar_status status = LAR_OK;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "the session has been started and ticks by itself; lar_session_tick is "
                          "for one that has not been");
    else
        host_tick(session);
    if (!status && session->status.state == LAR_SESSION_STOPPED)
        status = lar_fail(error, session->status.error, "%s", session->status.message);
    pthread_mutex_unlock(&session->requests.lock);
    return status;
}
