/* Tools, status and snapshots of a session, from any thread. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/pose.h"
#include "session/session.h"

/* ---- tools --------------------------------------------------------------------------------- */

lar_status lar_session_check_tool(const lar_session *session, int32_t tool, lar_error *error) {
    if (!session)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a call of a session needs one, not NULL");
    if (tool >= 0 && tool < session->tools) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no tool %ld; the session has %ld, counted from 0", (long)tool,
                    (long)session->tools);
}

/* Reading takes over the newest view, which changes nothing that callers see. */
static const lar_session_view *look_at_view(const lar_session *session) {
    lar_triple_buffer *box = session->view;
    lar_triple_buffer_lock(box);
    return lar_triple_buffer_newest(box, NULL);
}

static void end_look(const lar_session *session) {
    lar_triple_buffer_unlock(session->view);
}

static lar_tool_info look_at_tool(const lar_session *session, int32_t tool) {
    lar_tool_info info = look_at_view(session)->tool[tool].info;
    end_look(session);
    return info;
}

/* Spares are, once they have been added. */
static lar_status check_there(const lar_session *session, int32_t tool, lar_error *error) {
    if (lar_spare_of(&session->simulation->list, tool) < 0 ||
        look_at_tool(session, tool).shape != LAR_TOOL_NONE)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "tool %ld is not there; add one with lar_session_add_tool", (long)tool);
}

lar_status lar_session_tool_move(lar_session *session, int32_t tool, const lar_tool_pose *pose,
                                 lar_error *error) {
    lar_tool_pose clean;
    char whose[32];
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && !pose)
        status = lar_fail(error, LAR_ERROR_ARGUMENT, "lar_session_tool_move needs a pose");
    if (!status) {
        clean = *pose;
        snprintf(whose, sizeof whose, "tool %d", (int)tool);
        status = lar_pose_normalise(&clean, whose, error);
    }
    if (!status) status = check_there(session, tool, error);
    if (status) return status;
    lar_triple_buffer *box = &session->tool[tool].hand;
    lar_triple_buffer_lock(box);
    *(lar_tool_pose *)lar_triple_buffer_back(box) = clean;
    lar_triple_buffer_publish(box);
    lar_triple_buffer_unlock(box);
    return LAR_OK;
}

lar_status lar_session_tool_info(const lar_session *session, int32_t tool, lar_tool_info *info,
                                 lar_error *error) {
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && !info)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_session_tool_info needs a place for the answer");
    if (!status) *info = look_at_tool(session, tool);
    return status;
}

lar_status lar_session_tool_force(const lar_session *session, int32_t tool, lar_tool_pose *pose,
                                  lar_tool_force *force, lar_error *error) {
    lar_status status = lar_session_check_tool(session, tool, error);
    if (status) return status;
    const lar_session_view *view = look_at_view(session);
    if (pose) *pose = view->tool[tool].pose;
    if (force) *force = view->tool[tool].force;
    end_look(session);
    return LAR_OK;
}

lar_status lar_session_tool_felt(const lar_session *session, int32_t tool, double force[3],
                                 double torque[3], lar_error *error) {
    lar_status status = lar_session_check_tool(session, tool, error);
    if (status) return status;
    const lar_tool_force *felt = &look_at_view(session)->tool[tool].felt;
    if (force) memcpy(force, felt->force, sizeof felt->force);
    if (torque) memcpy(torque, felt->torque, sizeof felt->torque);
    end_look(session);
    return LAR_OK;
}

lar_status lar_session_tool_load(const lar_session *session, int32_t tool, lar_tool_load *load,
                                 lar_error *error) {
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && !load)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_session_tool_load needs a place for the answer");
    if (status) return status;
    *load = look_at_view(session)->tool[tool].load;
    end_look(session);
    return LAR_OK;
}

lar_status lar_session_grasp_answer(const lar_session *session, int32_t tool,
                                    lar_grasp_answer *answer, lar_error *error) {
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && !answer)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_session_grasp_answer needs a place for the answer");
    if (status) return status;
    *answer = look_at_view(session)->tool[tool].grasp;
    end_look(session);
    return LAR_OK;
}

lar_status lar_session_device(const lar_session *session, int32_t tool, lar_device_status *out,
                              lar_error *error) {
    lar_status status = lar_session_check_tool(session, tool, error);
    if (!status && !out)
        status =
            lar_fail(error, LAR_ERROR_ARGUMENT, "lar_session_device needs a place for the answer");
    if (status) return status;
    *out = look_at_view(session)->tool[tool].device;
    end_look(session);
    return LAR_OK;
}

void lar_session_inspect(const lar_session *session, lar_session_info *info) {
    if (!info) return;
    *info = (lar_session_info){0};
    if (!session) return;
    *info = (lar_session_info){.simulation = session->simulation,
                               .tick_steps = session->tick_steps,
                               .tick = (double)session->tick_steps * session->time_step,
                               .options = session->options};
}

void lar_session_status_get(const lar_session *session, lar_session_status *status) {
    if (!session || !status) return;
    *status = look_at_view(session)->status;
    end_look(session);
}

void lar_session_gravity(const lar_session *session, double gravity[3]) {
    if (!gravity) return;
    for (int i = 0; i < 3; i++) gravity[i] = 0;
    if (!session) return;
    memcpy(gravity, look_at_view(session)->gravity, 3 * sizeof *gravity);
    end_look(session);
}

double lar_session_damping(const lar_session *session) {
    if (!session) return 0;
    double damping = look_at_view(session)->damping;
    end_look(session);
    return damping;
}

double lar_session_stiffness(const lar_session *session, int32_t material) {
    if (!session || material < 0 || material >= session->simulation->domain.model->material_count)
        return 0;
    double factor = look_at_view(session)->factor[lar_factor_of(material)];
    end_look(session);
    return factor;
}

double lar_session_activation(const lar_session *session, int32_t material) {
    if (!session || material < 0 || material >= session->simulation->domain.model->material_count)
        return 0;
    double value = look_at_view(session)->activation[lar_factor_of(material)];
    end_look(session);
    return value;
}

int32_t lar_session_force_history(const lar_session *session, int32_t tool, uint64_t after,
                                  int32_t max, float (*force)[3], uint64_t *last) {
    uint64_t ignored;
    if (last) *last = after;
    if (lar_session_check_tool(session, tool, NULL) || !force) return 0;
    return lar_history_copy(&session->history, tool, after, max, force, last ? last : &ignored);
}

/* ---- snapshots ----------------------------------------------------------------------------- */

/* A snapshot, and what it was asked for. */
typedef struct own_snapshot {
    lar_snapshot shown;
    const lar_session *of;
    uint64_t asked; /* by polling; 0: not yet */
    lar_snapshot_tool tool[LAR_TOOLS_MAX];
} own_snapshot;

lar_status lar_snapshot_create(const lar_session *session, lar_snapshot **out, lar_error *error) {
    if (!session || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_snapshot_create needs a session and a place for the snapshot");
    int32_t nodes = session->simulation->domain.model->mesh.node_count;
    own_snapshot *own = lar_calloc(1, sizeof *own);
    if (own) own->shown.u = lar_calloc((size_t)nodes, sizeof *own->shown.u);
    if (!own || !own->shown.u) {
        free(own);
        return lar_fail_memory(error, (size_t)nodes * sizeof *own->shown.u, "a snapshot");
    }
    own->of = session;
    own->shown.nodes = nodes;
    own->shown.tool = own->tool;
    *out = &own->shown;
    return LAR_OK;
}

void lar_snapshot_destroy(lar_snapshot *snapshot) {
    if (!snapshot) return;
    free(snapshot->u);
    free(snapshot);
}

static lar_status check_snapshot(const lar_session *session, const lar_snapshot *snapshot,
                                 const char *call, lar_error *error) {
    /* A later session may have the address of one that was closed. */
    if (session && snapshot && ((const own_snapshot *)snapshot)->of == session &&
        snapshot->nodes == session->simulation->domain.model->mesh.node_count)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s needs a session and a snapshot that was created for it", call);
}

/* Who has a thread is woken; for one that has none, who asks does what is asked for. */
static void wake(lar_session *session) {
    if (!session->started) lar_session_serve_snapshots(session);
    pthread_cond_signal(&session->requests.work);
}

lar_status lar_session_snapshot(lar_session *session, lar_snapshot *snapshot, double seconds,
                                lar_error *error) {
    lar_status status = check_snapshot(session, snapshot, "lar_session_snapshot", error);
    if (status) return status;
    int64_t limit = lar_clock_ns() + (int64_t)(1e9 * fmin(fmax(seconds, 0), 1e6));
    uint64_t number = lar_snapshots_ask(&session->snapshots);
    bool in_time = true;
    pthread_mutex_lock(&session->requests.lock);
    wake(session);
    while (in_time && !lar_snapshots_ready(&session->snapshots, number))
        in_time = lar_requests_wait(&session->requests, limit);
    in_time = lar_snapshots_ready(&session->snapshots, number);
    pthread_mutex_unlock(&session->requests.lock);
    if (!in_time)
        return lar_fail(error, LAR_ERROR_PEER,
                        "no snapshot came within %g s: a tick takes longer; wait longer", seconds);
    return lar_snapshots_take(&session->snapshots, session->simulation, snapshot, error);
}

/* Never waits for a tick: who holds the lock now will look who has asked, and the next call wakes
 * who sleeps. */
lar_status lar_session_snapshot_poll(lar_session *session, lar_snapshot *snapshot, int32_t *fresh,
                                     lar_error *error) {
    own_snapshot *own = (own_snapshot *)snapshot;
    bool runs = true;
    if (fresh) *fresh = 0;
    lar_status status = check_snapshot(session, snapshot, "lar_session_snapshot_poll", error);
    if (status) return status;
    if (pthread_mutex_trylock(&session->requests.lock) == 0) {
        runs = session->started;
        if (!runs || !own->asked) own->asked = lar_snapshots_ask(&session->snapshots);
        wake(session);
        pthread_mutex_unlock(&session->requests.lock);
    }
    if (!own->asked || !lar_snapshots_ready(&session->snapshots, own->asked)) return LAR_OK;
    status = lar_snapshots_take(&session->snapshots, session->simulation, snapshot, error);
    own->asked = runs ? lar_snapshots_ask(&session->snapshots) : 0;
    if (fresh) *fresh = !status;
    return status;
}
