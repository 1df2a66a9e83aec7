/* What is asked of a session, from any thread. */

#include <stdio.h>
#include <string.h>

#include "simulation/checkpoint.h"
#include "session/session.h"

/* Before the start it waits for the start. */
static void ask(lar_session *session, lar_request request) {
    if (!session) return;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started || !lar_requests_full(&session->requests))
        lar_requests_place(&session->requests, &request);
    pthread_mutex_unlock(&session->requests.lock);
}

/* Done when it returns. */
static lar_status ask_and_wait(lar_session *session, lar_request request, lar_error *error) {
    lar_request_answer *answer = request.answer;
    pthread_mutex_lock(&session->requests.lock);
    if (session->started) {
        lar_requests_place(&session->requests, &request);
        while (!answer->done) lar_requests_wait(&session->requests, INT64_MAX);
    } else {
        lar_simulation_reserve_here(session->simulation);
        if (session->hosted) lar_session_execute_asked(session);
        lar_session_execute(session, &request);
        lar_simulation_reserve_here(NULL);
    }
    pthread_mutex_unlock(&session->requests.lock);
    if (error && answer->status) *error = answer->error;
    return answer->status;
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

static lar_status check_session(const lar_session *session, lar_error *error) {
    if (session) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "a call of a session needs one, not NULL");
}

static lar_status check_file(const lar_session *session, const char *path, const char *call,
                             lar_error *error) {
    lar_status status = check_session(session, error);
    if (status || (path && *path)) return status;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs the path of a file", call);
}

lar_status lar_session_reset(lar_session *session, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = check_session(session, error);
    if (status) return status;
    status =
        ask_and_wait(session, (lar_request){.kind = LAR_REQUEST_RESET, .answer = &answer}, error);
    lar_player_close(answer.player);
    return status;
}

lar_status lar_session_replay(lar_session *session, const char *path, lar_error *error) {
    lar_request_answer answer = {0};
    lar_player *player = NULL;
    lar_status status = check_session(session, error);
    if (!status && path) status = lar_player_open(path, &player, error);
    if (status) return status;
    status = ask_and_wait(
        session, (lar_request){.kind = LAR_REQUEST_REPLAY, .player = player, .answer = &answer},
        error);
    lar_player_close(answer.player);
    return status;
}

void lar_session_seek(lar_session *session, double seconds) {
    if (seconds >= 0 && seconds <= 1e12)
        ask(session, (lar_request){.kind = LAR_REQUEST_SEEK, .seconds = seconds});
}

lar_status lar_session_save(lar_session *session, const char *path, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = check_file(session, path, "lar_session_save", error);
    if (!status)
        status = ask_and_wait(
            session, (lar_request){.kind = LAR_REQUEST_SAVE, .path = path, .answer = &answer},
            error);
    if (!status) status = lar_checkpoint_store(path, &answer.state, error);
    lar_bytes_free(&answer.state);
    return status;
}

lar_status lar_session_load(lar_session *session, const char *path, lar_error *error) {
    lar_request_answer answer = {0};
    lar_bytes state = {0};
    lar_status status = check_file(session, path, "lar_session_load", error);
    if (!status) status = lar_checkpoint_read(path, &state, error);
    if (!status)
        status = ask_and_wait(
            session,
            (lar_request){
                .kind = LAR_REQUEST_LOAD, .path = path, .state = &state, .answer = &answer},
            error);
    lar_player_close(answer.player);
    lar_bytes_free(&state);
    return status;
}

static lar_status check_saved(const lar_session *session, const lar_saved *saved, const char *call,
                              lar_error *error) {
    lar_status status = check_session(session, error);
    if (status || saved) return status;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs a place of lar_saved_create", call);
}

lar_status lar_session_save_to(lar_session *session, lar_saved *saved, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = check_saved(session, saved, "lar_session_save_to", error);
    if (status) return status;
    return ask_and_wait(
        session, (lar_request){.kind = LAR_REQUEST_SAVE, .save_to = saved, .answer = &answer},
        error);
}

lar_status lar_session_load_from(lar_session *session, const lar_saved *saved, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = check_saved(session, saved, "lar_session_load_from", error);
    if (status) return status;
    status = ask_and_wait(
        session, (lar_request){.kind = LAR_REQUEST_LOAD, .load_from = saved, .answer = &answer},
        error);
    lar_player_close(answer.player);
    return status;
}

lar_status lar_session_record(lar_session *session, const char *path, lar_error *error) {
    lar_request_answer answer = {0};
    lar_recorder *recorder = NULL;
    lar_status status = check_session(session, error);
    if (!status && path) {
        const lar_recording_header header = lar_session_recording_header(session);
        status = lar_recorder_create(path, &header, &recorder, error);
    }
    if (!status)
        status = ask_and_wait(
            session,
            (lar_request){.kind = LAR_REQUEST_RECORD, .recorder = recorder, .answer = &answer},
            error);
    lar_status closed = lar_recorder_close(answer.recorder, status ? NULL : error);
    if (status && recorder) remove(path); /* there is nothing in it */
    return status ? status : closed;
}

static lar_status set(lar_session *session, lar_setting setting, int32_t *tool, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = check_session(session, error);
    if (!status)
        status = ask_and_wait(
            session, (lar_request){.kind = LAR_REQUEST_SET, .setting = setting, .answer = &answer},
            error);
    if (!status && tool) *tool = answer.tool;
    return status;
}

lar_status lar_session_set_gravity(lar_session *session, const double gravity[3],
                                   lar_error *error) {
    lar_setting setting = {.kind = LAR_SETTING_MODEL_GRAVITY};
    if (gravity)
        setting = (lar_setting){.kind = LAR_SETTING_GRAVITY,
                                .value = {gravity[0], gravity[1], gravity[2]}};
    return set(session, setting, NULL, error);
}

lar_status lar_session_set_damping(lar_session *session, double damping, lar_error *error) {
    return set(session, (lar_setting){.kind = LAR_SETTING_DAMPING, .value = {damping}}, NULL,
               error);
}

lar_status lar_session_set_stiffness(lar_session *session, int32_t material, double factor,
                                     lar_error *error) {
    return set(session,
               (lar_setting){.kind = LAR_SETTING_STIFFNESS, .of = material, .value = {factor}},
               NULL, error);
}

lar_status lar_session_set_parameter(lar_session *session, int32_t material, const char *name,
                                     double value, lar_error *error) {
    int index;
    lar_status status = check_session(session, error);
    if (!status)
        status = lar_simulation_parameter_index(session->simulation->domain.model, material, name,
                                                &index, error);
    if (status) return status;
    return set(
        session,
        (lar_setting){.kind = LAR_SETTING_PARAMETER, .of = material, .value = {value, index}}, NULL,
        error);
}

lar_status lar_session_activate(lar_session *session, int32_t material, double value,
                                lar_error *error) {
    return set(session,
               (lar_setting){.kind = LAR_SETTING_ACTIVATION, .of = material, .value = {value}},
               NULL, error);
}

static lar_setting force_of(lar_setting_kind kind, int32_t of, const double force[3]) {
    lar_setting setting = {.kind = kind, .of = of};
    if (force) memcpy(setting.value, force, sizeof setting.value);
    return setting;
}

lar_status lar_session_set_force(lar_session *session, int32_t node, const double force[3],
                                 lar_error *error) {
    if (node < 0 && (node != -1 || force))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no node %ld; -1 without a force removes all forces that were set",
                        (long)node);
    return set(session, force_of(LAR_SETTING_FORCE, node, force), NULL, error);
}

lar_status lar_session_set_force_on(lar_session *session, const char *of, const double force[3],
                                    lar_error *error) {
    int32_t index;
    lar_status status = check_session(session, error);
    if (!status)
        status = lar_simulation_force_set(session->simulation->domain.model, of, &index, error);
    return status ? status
                  : set(session, force_of(LAR_SETTING_FORCE_ON, index, force), NULL, error);
}

static lar_status set_support(lar_session *session, lar_setting_kind kind, int32_t of,
                              unsigned axes, int held, lar_error *error) {
    return set(session, (lar_setting){.kind = kind, .of = of, .value = {axes, held != 0}}, NULL,
               error);
}

lar_status lar_session_set_support(lar_session *session, int32_t node, unsigned axes, int held,
                                   lar_error *error) {
    return set_support(session, LAR_SETTING_SUPPORT, node, axes, held, error);
}

lar_status lar_session_set_support_on(lar_session *session, const char *of, unsigned axes, int held,
                                      lar_error *error) {
    int32_t index;
    lar_status status = check_session(session, error);
    if (!status)
        status = lar_simulation_force_set(session->simulation->domain.model, of, &index, error);
    return status ? status : set_support(session, LAR_SETTING_SUPPORT_ON, index, axes, held, error);
}

lar_status lar_session_add_tool(lar_session *session, const lar_tool_info *wanted, int32_t *tool,
                                lar_error *error) {
    if (!wanted || (unsigned)wanted->shape >= LAR_TOOL_HAND)
        return lar_fail(
            error, LAR_ERROR_ARGUMENT,
            "lar_session_add_tool needs a sphere, a capsule or a grasper, and its size");
    lar_status status = lar_added_tool_check(wanted, error);
    if (status) return status;
    return set(session,
               (lar_setting){.kind = LAR_SETTING_ADD_TOOL,
                             .of = (int32_t)wanted->shape,
                             .value = {wanted->radius, wanted->length, wanted->spread}},
               tool, error);
}

lar_status lar_session_remove_tool(lar_session *session, int32_t tool, lar_error *error) {
    return set(session, (lar_setting){.kind = LAR_SETTING_REMOVE_TOOL, .of = tool}, NULL, error);
}

static lar_request grasp_of(int32_t tool, const double point[3]) {
    lar_request request = {.kind = LAR_REQUEST_GRASP, .tool = tool, .pointed = point != NULL};
    if (point) memcpy(request.point, point, sizeof request.point);
    return request;
}

lar_status lar_session_grasp(lar_session *session, int32_t tool, const double point[3],
                             int32_t *held, lar_error *error) {
    lar_request_answer answer = {0};
    lar_request request = grasp_of(tool, point);
    request.answer = &answer;
    if (held) *held = 0;
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status) status = ask_and_wait(session, request, error);
    if (!status && held) *held = answer.held;
    return status;
}

lar_status lar_session_release(lar_session *session, int32_t tool, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = lar_session_check_tool(session, tool, error);
    if (status) return status;
    return ask_and_wait(session,
                        (lar_request){.kind = LAR_REQUEST_RELEASE, .tool = tool, .answer = &answer},
                        error);
}

lar_status lar_session_tool_touches(lar_session *session, int32_t tool, int32_t max,
                                    lar_touch *touch, int32_t *count, lar_error *error) {
    lar_request_answer answer = {0};
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && !count)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_session_tool_touches needs a place for the count");
    if (!status)
        status = ask_and_wait(session,
                              (lar_request){.kind = LAR_REQUEST_TOUCHES,
                                            .tool = tool,
                                            .max = max,
                                            .touch = touch,
                                            .answer = &answer},
                              error);
    if (!status) *count = answer.held;
    return status;
}

static lar_status ask_if_free(lar_session *session, lar_request request, lar_error *error) {
    lar_status status = lar_session_check_tool(session, request.tool, error);
    if (status) return status;
    pthread_mutex_lock(&session->requests.lock);
    bool full = lar_requests_full(&session->requests);
    if (!full) lar_requests_place(&session->requests, &request);
    pthread_mutex_unlock(&session->requests.lock);
    if (!full) return LAR_OK;
    return lar_fail(error, LAR_ERROR_PEER,
                    "%d requests wait for the session already: ask again in a moment",
                    LAR_REQUESTS_MAX);
}

lar_status lar_session_ask_grasp(lar_session *session, int32_t tool, const double point[3],
                                 uint64_t ticket, lar_error *error) {
    lar_request request = grasp_of(tool, point);
    request.ticket = ticket;
    if (ticket == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_session_ask_grasp needs a ticket that is not 0, to know its answer");
    return ask_if_free(session, request, error);
}

lar_status lar_session_ask_release(lar_session *session, int32_t tool, lar_error *error) {
    return ask_if_free(session, (lar_request){.kind = LAR_REQUEST_RELEASE, .tool = tool}, error);
}

lar_status lar_session_attach(lar_session *session, int32_t tool, const char *device,
                              lar_error *error) {
    lar_request_answer answer = {0};
    lar_device *opened = NULL;
    lar_tool_info info;
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && (!device || !*device))
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_session_attach needs a device, such as \"udp:127.0.0.1:9000\"");
    if (!status) status = lar_session_tool_info(session, tool, &info, error);
    if (!status) status = lar_device_open(device, &info, &opened, error);
    if (status) return status;
    status = ask_and_wait(
        session,
        (lar_request){
            .kind = LAR_REQUEST_ATTACH, .tool = tool, .device = opened, .answer = &answer},
        error);
    if (status) lar_device_close(opened);
    return status;
}
