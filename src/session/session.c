#include "session/session.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/parallel_for.h"
#include "base/thread.h"

lar_session_options lar_session_options_default(void) {
    return (lar_session_options){.pace = 1};
}

/* ---- opening and closing ------------------------------------------------------------------- */

static lar_status check_number(const char *name, double value, lar_error *error) {
    if (value >= 0 && value <= 1e6) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "lar_session_options.%s is %g; it must be between 0 and 1e6", name, value);
}

/* Of a tick: nobody is heard within one, closing, pausing and settings wait for its end. Some
 * tenths of a second for a small body, some seconds for a large one. */
static const double TICK_STEPS_MAX = 1e4, TICK_MIN = 1e-15;

static lar_status choose(lar_session *session, const lar_session_options *asked, lar_error *error) {
    lar_session_options *o = &session->options;
    *o = *asked;
    lar_status status = check_number("tick", o->tick, error);
    if (!status) status = check_number("pace", o->pace, error);
    if (!status) status = check_number("tool_speed", o->tool_speed, error);
    if (!status && (o->priority < 0 || o->priority > 99))
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "a session cannot have the priority %d; give 1 to 99, or 0 for none",
                          o->priority);
    if (!status) status = check_number("hand_force", o->hand_force, error);
    if (status) return status;
    if (o->tick == 0) o->tick = fmin(1e-3, TICK_STEPS_MAX * session->time_step);
    if (o->tool_speed == 0) o->tool_speed = 1;
    if (o->hand_force == 0) o->hand_force = 1;
    if (o->hash_every == 0) o->hash_every = 100;
    /* A tick of exactly ten steps must not become nine by rounding. */
    double steps = floor(o->tick / session->time_step * (1 + 1e-9));
    if (steps > TICK_STEPS_MAX || o->tick < TICK_MIN)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a session cannot have ticks of %g s, %.3g steps: closing waits for the "
                        "end of one; give %g to %g s",
                        o->tick, steps, TICK_MIN, TICK_STEPS_MAX * session->time_step);
    session->tick_steps = steps < 1 ? 1 : (uint64_t)steps;
    session->pace.pace = o->pace;
    return LAR_OK;
}

static lar_status make_tools(lar_session *session, lar_error *error) {
    lar_status status = LAR_OK;
    session->tools = lar_simulation_tool_count(session->simulation);
    for (int32_t i = 0; i < session->tools && !status; i++) {
        lar_session_tool *tool = &session->tool[i];
        status = lar_simulation_tool(session->simulation, i, &tool->info, error);
        lar_session_couple(session, i);
        if (!status)
            status = lar_triple_buffer_create(&tool->hand, sizeof(lar_tool_pose), "a tool", error);
    }
    if (!status) status = lar_history_create(session->tools, &session->history, error);
    if (!status) lar_session_take_tools(session);
    session->status.placed = 0;
    return status;
}

static void make_advice(lar_session *session) {
    const lar_simulation *simulation = session->simulation;
    session->advice = (lar_advice){.time_step = session->time_step,
                                   .elements = simulation->domain.model->mesh.element_count,
                                   .processors = lar_simulation_processors(simulation),
                                   .busy = lar_simulation_processors(simulation) *
                                           lar_simulation_threads(simulation),
                                   .cores = lar_usable_cores(),
                                   .priority = session->options.priority};
}

static lar_status make_recovery(lar_session *session, lar_error *error) {
    if (session->options.stop_when_unstable) return LAR_OK;
    lar_status status =
        lar_recovery_create(session->simulation, session->time_step, &session->recovery, error);
    return status ? status : lar_session_begin_states(session, error);
}

lar_recording_header lar_session_recording_header(const lar_session *session) {
    const lar_simulation *simulation = session->simulation;
    const lar_model *model = simulation->domain.model;
    int32_t tools = lar_spares_first(&simulation->list);
    return (lar_recording_header){.element = simulation->domain.kind,
                                  .nodes = model->mesh.node_count,
                                  .elements = model->mesh.element_count,
                                  .tools = tools,
                                  .hands = tools - lar_model_tool_count(model),
                                  .time_step = session->time_step,
                                  .tick_steps = session->tick_steps,
                                  .hash_every = session->options.hash_every,
                                  .spares = simulation->list.spares};
}

static lar_status record_from_start(lar_session *session, lar_error *error) {
    const char *path = session->options.record;
    if (!path) return LAR_OK;
    lar_status status = lar_session_record(session, path, error);
    session->options.record = NULL; /* borrowed until here */
    return status;
}

static bool is_here(const lar_session *session) {
    return session->process == getpid();
}

static void destroy(lar_session *session) {
    lar_simulation_reserve(session->simulation, false);
    __atomic_store_n(&session->simulation->sessions, 0, __ATOMIC_RELEASE);
    for (int32_t i = 0; i < session->tools; i++) {
        lar_device_close(session->tool[i].device);
        lar_triple_buffer_destroy(&session->tool[i].hand);
    }
    lar_history_destroy(&session->history);
    lar_snapshots_destroy(&session->snapshots);
    lar_recovery_destroy(&session->recovery);
    lar_player_close(session->player);
    if (session->view) lar_triple_buffer_destroy(session->view);
    free(session->view);
    /* In a forked child it may look as if somebody waited there, who would be waited for. */
    if (is_here(session)) lar_requests_destroy(&session->requests);
    free(session);
}

lar_status lar_session_open(lar_simulation *simulation, const lar_session_options *options,
                            lar_session **out, lar_error *error) {
    if (!simulation || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_session_open needs a simulation and a place for the session");
    if (simulation->calling)
        return lar_simulation_check_idle(simulation, "lar_session_open", error);
    if (__atomic_exchange_n(&simulation->sessions, 1, __ATOMIC_ACQ_REL))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a session is open on this simulation already; close it first, or create "
                        "another simulation of the same model");
    lar_session_options asked = options ? *options : lar_session_options_default();
    lar_session *session = lar_calloc(1, sizeof *session);
    if (!session) {
        __atomic_store_n(&simulation->sessions, 0, __ATOMIC_RELEASE);
        return lar_fail_memory(error, sizeof *session, "the session");
    }
    lar_requests_create(&session->requests);
    session->simulation = simulation;
    session->process = getpid();
    session->time_step = lar_simulation_time_step(simulation);
    session->divided = lar_simulation_divided_steps(simulation, NULL);
    session->good_step = lar_simulation_steps(simulation);
    lar_status status = choose(session, &asked, error);
    if (!status) status = make_tools(session, error);
    if (!status && !(session->view = lar_calloc(1, sizeof *session->view)))
        status = lar_fail_memory(error, sizeof *session->view, "the session");
    if (!status)
        status =
            lar_triple_buffer_create(session->view, sizeof(lar_session_view), "a session", error);
    if (!status) status = lar_snapshots_create(simulation, &session->snapshots, error);
    if (!status) status = make_recovery(session, error);
    if (status) {
        destroy(session);
        return status;
    }
    make_advice(session);
    lar_session_publish(session, true);
    status = record_from_start(session, error);
    if (status) {
        destroy(session);
        return status;
    }
    lar_simulation_reserve(simulation, true);
    *out = session;
    return LAR_OK;
}

static lar_status refuse_thread(const lar_session *session, int cause, lar_error *error) {
    if (cause == EPERM || cause == EINVAL)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "the system does not allow the session a real-time priority of %d: %s; "
                        "raise the limit (ulimit -r), run as root, or leave the priority out",
                        session->options.priority, strerror(cause));
    return lar_fail_thread(error, cause, "the session");
}

lar_status lar_session_start(lar_session *session, lar_error *error) {
    if (!session)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "lar_session_start needs a session, not NULL");
    lar_status status = LAR_OK;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started) {
        status = lar_fail(error, LAR_ERROR_ARGUMENT, "the session has been started already");
    } else if (session->hosted) {
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "the session ticks by its host's clock (lar_session_tick); open another "
                          "one to start it");
    } else {
        if (session->status.state == LAR_SESSION_IDLE)
            session->status.state =
                session->options.paused ? LAR_SESSION_PAUSED : LAR_SESSION_PLAYING;
        lar_session_publish(session, true);
        int cause = lar_thread_start_urgent(&session->thread, session->options.priority,
                                            lar_session_run, session);
        session->started = cause == 0;
        if (cause) {
            session->status.state = LAR_SESSION_IDLE;
            lar_session_publish(session, true);
            status = refuse_thread(session, cause, error);
        }
    }
    pthread_mutex_unlock(&session->requests.lock);
    return status;
}

lar_status lar_session_close(lar_session *session, lar_error *error) {
    if (!session) return LAR_OK;
    if (session->started && is_here(session)) {
        pthread_mutex_lock(&session->requests.lock);
        lar_requests_place(&session->requests, &(lar_request){.kind = LAR_REQUEST_END});
        pthread_mutex_unlock(&session->requests.lock);
        lar_thread_join(&session->thread);
    }
    if (is_here(session)) lar_session_record_end(session);
    lar_status status = lar_recorder_close(session->recorder, error);
    destroy(session);
    return status;
}
