/* What viewers are told: docs/viewer-protocol.md. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/state.h"

void lar_message_begin(lar_json *json, const char *kind) {
    lar_json_begin(json);
    lar_json_text(json, "kind", kind);
}

/* ---- hello ----------------------------------------------------------------------------------- */

static bool is_active(const lar_material_info *info) {
    return info->active_along != 0 || info->active_across != 0;
}

static void write_materials(lar_json *json, const lar_model *model, int32_t count) {
    lar_json_open(json, "materials", '[');
    for (int32_t i = 0; i < count; i++) {
        lar_material_info info;
        if (lar_model_material(model, i, &info, NULL)) continue;
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", info.name);
        lar_json_text(json, "law", info.law);
        lar_json_integer(json, "elements", info.elements);
        lar_json_number(json, "density", info.density);
        lar_json_number(json, "shear_modulus", info.shear_modulus);
        lar_json_number(json, "bulk_modulus", info.bulk_modulus);
        if (is_active(&info)) lar_json_boolean(json, "active", 1);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_pose(lar_json *json, const lar_tool_pose *pose) {
    lar_json_vector(json, "position", pose->position, 3);
    lar_json_vector(json, "orientation", pose->orientation, 4);
    lar_json_number(json, "opening", pose->opening);
}

/* What status says of spares is what they are. */
static const lar_tool_info no_tool = {
    .name = "", .shape = LAR_TOOL_NONE, .rest = {.orientation = {1, 0, 0, 0}, .opening = 1}};

static void write_tool(lar_json *json, const lar_tool_info *info) {
    lar_json_text(json, "name", info->name);
    lar_json_text(json, "shape", lar_shape_names[info->shape]);
    lar_json_number(json, "radius", info->radius);
    lar_json_number(json, "length", info->length);
    lar_json_number(json, "spread", info->spread);
}

static void write_tools(lar_json *json, const lar_server *server) {
    int32_t first = server->simulated.tools;
    lar_json_open(json, "tools", '[');
    for (int32_t i = 0; i < server->tools; i++) {
        const lar_tool_info info = i < first ? server->tool[i].info : no_tool;
        lar_json_open(json, NULL, '{');
        write_tool(json, &info);
        lar_json_open(json, "rest", '{');
        write_pose(json, &info.rest);
        lar_json_close(json);
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_open(json, "hands", '[');
    for (int32_t i = 0; i < first; i++)
        if (server->tool[i].info.shape == LAR_TOOL_HAND) lar_json_integer(json, NULL, i);
    lar_json_close(json);
    lar_json_open(json, "spares", '[');
    for (int32_t i = first; i < server->tools; i++) lar_json_integer(json, NULL, i);
    lar_json_close(json);
}

static void write_fields(lar_json *json) {
    lar_json_open(json, "fields", '[');
    for (int i = 1; i < LAR_FIELDS; i++) {
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", lar_field_names[i].name);
        lar_json_integer(json, "number", lar_field_names[i].field);
        lar_json_text(json, "title", lar_field_names[i].title);
        lar_json_text(json, "unit", lar_field_names[i].unit);
        lar_json_close(json);
    }
    lar_json_close(json);
}

/* Only what viewers get: not one that is too large. */
static lar_status write_embedded(lar_json *json, const lar_model *model, lar_error *error) {
    lar_embedded_info embedded;
    lar_shown shown;
    lar_status status = lar_shown_create(model, &shown, error);
    if (status) return status;
    if (shown.has_embedded && lar_model_embedded(model, &embedded)) {
        lar_json_open(json, "riding", '{');
        lar_json_integer(json, "vertices", embedded.vertices);
        lar_json_integer(json, "triangles", embedded.triangles);
        lar_json_integer(json, "nodes", shown.count - shown.surface);
        lar_json_close(json);
    }
    lar_shown_destroy(&shown);
    return LAR_OK;
}

static void write_scan(lar_json *json, const lar_scan *scan) {
    lar_json_open(json, "scan", '{');
    lar_json_integers(json, "size", scan->info.size, 3);
    lar_json_open(json, "labels", '[');
    for (int32_t i = 0; i < scan->info.names; i++) {
        int32_t label = 0;
        const char *name = lar_image_name(scan->image, i, &label);
        lar_json_open(json, NULL, '{');
        lar_json_integer(json, "label", label);
        lar_json_text(json, "name", name);
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_close(json);
}

/* What the page may set, and what it goes back to. */
static void write_body(lar_json *json, const lar_model *model) {
    double gravity[3];
    int varies = lar_model_gravity(model, 0, gravity);
    lar_json_open(json, "body", '{');
    lar_json_vector(json, "gravity", gravity, 3);
    lar_json_boolean(json, "gravity_varies", varies);
    lar_json_number(json, "damping", lar_model_damping(model));
    lar_json_number(json, "stiffness_min", LAR_STIFFNESS_MIN);
    lar_json_number(json, "stiffness_max", LAR_STIFFNESS_MAX);
    lar_json_close(json);
}

lar_status lar_server_make_hello(lar_server *server, lar_error *error) {
    const lar_simulation *simulation = server->about.simulation;
    lar_json *json = &server->hello;
    double view[3];
    lar_model_info info;
    lar_surface_info surface;
    lar_status status = lar_model_inspect(server->model, &info, error);
    if (status) return status;
    lar_model_surface(server->model, &surface);
    lar_message_begin(json, "hello");
    lar_json_integer(json, "protocol", 1);
    lar_json_text(json, "lariat", lar_version());
    lar_json_text(json, "title", info.title);
    lar_json_integer(json, "nodes", info.nodes);
    lar_json_integer(json, "elements", info.elements);
    lar_json_open(json, "surface", '{');
    lar_json_integer(json, "nodes", surface.nodes);
    lar_json_integer(json, "faces", surface.faces);
    lar_json_close(json);
    status = write_embedded(json, server->model, error);
    if (status) return status;
    lar_json_vector(json, "lower", info.lower, 3);
    lar_json_vector(json, "upper", info.upper, 3);
    if (lar_model_view(server->model, view)) lar_json_vector(json, "view", view, 3);
    lar_json_number(json, "time_step", server->simulated.time_step);
    lar_json_number(json, "tick", server->about.tick);
    lar_json_text(json, "isa", lar_simulation_isa(simulation));
    lar_json_integer(json, "processors", lar_simulation_processors(simulation));
    lar_json_integer(json, "threads", lar_simulation_threads(simulation));
    write_materials(json, server->model, info.materials);
    if (lar_scan_is_there(&server->scan)) write_scan(json, &server->scan);
    write_tools(json, server);
    write_fields(json);
    lar_json_boolean(json, "saves", server->save_folder != NULL);
    lar_json_number(json, "hand_force", server->about.options.hand_force);
    lar_json_number(json, "tool_speed", server->about.options.tool_speed);
    write_body(json, server->model);
    return json->failed ? lar_fail_memory(error, json->length, "what viewers are told") : LAR_OK;
}

/* ---- status ---------------------------------------------------------------------------------- */

static void write_times(lar_json *json, const char *name, double p50, double p99, double p999,
                        double max) {
    lar_json_open(json, name, '{');
    lar_json_number(json, "p50", round(1e9 * p50) / 1e3);
    lar_json_number(json, "p99", round(1e9 * p99) / 1e3);
    lar_json_number(json, "p999", round(1e9 * p999) / 1e3);
    lar_json_number(json, "max", round(1e9 * max) / 1e3);
    lar_json_close(json);
}

static void write_bins(lar_json *json, const char *name, const uint32_t bin[LAR_TIME_BINS]) {
    lar_json_open(json, name, '[');
    for (int i = 0; i < LAR_TIME_BINS; i++) lar_json_integer(json, NULL, bin[i]);
    lar_json_close(json);
}

static void write_progress(lar_json *json, const lar_session_status *s) {
    static const char *const state[] = {"idle", "playing", "paused", "stopped"};
    static const char *const cause[] = {"", "step", "division", "machine"};
    lar_json_text(json, "state", state[s->state]);
    lar_json_integer(json, "step", (int64_t)s->step);
    lar_json_number(json, "time", s->time);
    write_times(json, "step_us", s->step_p50, s->step_p99, s->step_p999, s->step_max);
    write_times(json, "tick_us", s->tick_p50, s->tick_p99, s->tick_p999, s->tick_max);
    write_bins(json, "step_bins", s->step_bins);
    write_bins(json, "tick_bins", s->tick_bins);
    lar_json_integer(json, "ticks", (int64_t)s->ticks);
    lar_json_integer(json, "misses", (int64_t)s->misses);
    lar_json_integer(json, "slow_ticks", (int64_t)s->slow_ticks);
    lar_json_number(json, "real_time_factor", s->real_time_factor);
    lar_json_number(json, "real_time_factor_now", s->real_time_factor_now);
    lar_json_number(json, "engine_rate", s->engine_rate);
    lar_json_number(json, "haptic_rate", s->haptic_rate);
    lar_json_number(json, "snapshot_rate", s->snapshot_rate);
    lar_json_boolean(json, "slow_motion", s->slow_motion != 0);
    lar_json_text(json, "slow_cause", cause[s->slow_cause]);
    lar_json_text(json, "slow_advice", s->slow_advice);
    lar_json_number(json, "lag", s->lag);
    lar_json_number(json, "skipped", s->skipped);
    lar_json_boolean(json, "lost", s->error == LAR_ERROR_PEER);
    lar_json_text(json, "message", s->message);
    lar_json_integer(json, "recoveries", (int64_t)s->recoveries);
    lar_json_text(json, "recovery", s->recovery);
    lar_json_integer(json, "placed", (int64_t)s->placed);
    lar_json_integer(json, "step_parts", s->step_parts);
    lar_json_integer(json, "divided_steps", (int64_t)s->divided_steps);
    lar_json_integer(json, "heavier", s->heavier);
    lar_json_number(json, "heavier_share", s->heavier_share);
}

/* As it is now. */
static void write_settings(const lar_server *server, lar_json *json) {
    const lar_session *session = server->session;
    double gravity[3];
    int32_t materials = lar_model_material_count(server->model);
    lar_session_gravity(session, gravity);
    lar_json_open(json, "body", '{');
    lar_json_vector(json, "gravity", gravity, 3);
    lar_json_number(json, "damping", lar_session_damping(session));
    lar_json_open(json, "stiffness", '[');
    for (int32_t i = 0; i < materials; i++)
        lar_json_number(json, NULL, lar_session_stiffness(session, i));
    lar_json_close(json);
    bool active = false;
    for (int32_t i = 0; i < materials && !active; i++) {
        lar_material_info info;
        active = !lar_model_material(server->model, i, &info, NULL) && is_active(&info);
    }
    if (active) {
        lar_json_open(json, "activation", '[');
        for (int32_t i = 0; i < materials; i++)
            lar_json_number(json, NULL, lar_session_activation(session, i));
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_recording(const lar_server *server, lar_json *json) {
    const lar_session_status *s = &server->status;
    bool viewers = __atomic_load_n(&server->work.records, __ATOMIC_RELAXED);
    lar_json_boolean(json, "recording", s->recording != 0);
    lar_json_text(json, "recording_by", !s->recording ? "" : viewers ? "viewer" : "program");
    lar_json_text(json, "recording_lost", s->recording_lost);
}

static void write_replay(const lar_server *server, lar_json *json) {
    const lar_session_status *s = &server->status;
    if (!s->replaying) return;
    lar_json_open(json, "replay", '{');
    lar_json_text(json, "name", server->played);
    lar_json_number(json, "time", s->replay_time);
    lar_json_number(json, "length", s->replay_length);
    lar_json_close(json);
}

static void write_status(const lar_server *server, const lar_viewer *viewer, lar_json *json) {
    int64_t now = lar_clock_ns();
    lar_message_begin(json, "status");
    write_progress(json, &server->status);
    write_recording(server, json);
    lar_json_number(json, "pace", server->pace);
    lar_json_integer(json, "viewers", __atomic_load_n(&server->viewers, __ATOMIC_RELAXED));
    lar_json_open(json, "saved", '[');
    for (int i = 0; i < server->states.count; i++)
        lar_json_text(json, NULL, server->states.name[i]);
    lar_json_close(json);
    lar_json_open(json, "recordings", '[');
    for (int i = 0; i < server->recordings.count; i++)
        lar_json_text(json, NULL, server->recordings.name[i]);
    lar_json_close(json);
    write_settings(server, json);
    write_replay(server, json);
    lar_json_open(json, "tools", '[');
    for (int32_t i = 0; i < server->tools; i++) {
        const lar_tool_force *force = &server->tool[i].force;
        lar_json_open(json, NULL, '{');
        if (i >= server->simulated.tools) write_tool(json, &server->tool[i].info);
        write_pose(json, &server->tool[i].pose);
        lar_json_vector(json, "force", force->force, 3);
        lar_json_vector(json, "torque", force->torque, 3);
        lar_json_integer(json, "touching", force->touching);
        lar_json_integer(json, "held", force->held);
        lar_json_number(json, "limit", force->limit);
        lar_json_number(json, "depth", force->depth);
        lar_json_number(json, "apart", force->apart);
        lar_json_boolean(json, "limited", force->limited != 0);
        lar_json_number(json, "grasp", force->grasp_force);
        lar_json_text(json, "by", lar_hands_by(&server->hands, i, viewer->number, now));
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_end(json);
}

/* ---- notes ----------------------------------------------------------------------------------- */

void lar_viewer_tell(lar_viewer *viewer, lar_json *json) {
    lar_json_end(json);
    char *text = json->failed ? NULL : lar_strdup(lar_json_data(json));
    if (!text) return;
    if (viewer->notes == LAR_NOTES_MAX) {
        free(viewer->note[0]);
        viewer->notes--;
        memmove(viewer->note, viewer->note + 1, (size_t)viewer->notes * sizeof *viewer->note);
    }
    viewer->note[viewer->notes++] = text;
    lar_viewer_wants(viewer, LAR_DUE_NOTES);
}

void lar_viewer_note(lar_server *server, lar_viewer *viewer, const char *sentence) {
    lar_json *json = &server->json;
    lar_message_begin(json, "note");
    lar_json_text(json, "text", sentence);
    lar_viewer_tell(viewer, json);
}

void lar_server_tell_hand(void *context, uint64_t number, int32_t hand, int32_t tool,
                          const char *state) {
    lar_server *server = context;
    lar_viewer *viewer = lar_server_find(server, number);
    lar_json *json = &server->json;
    if (!viewer) return;
    lar_message_begin(json, "hand");
    lar_json_integer(json, "hand", hand);
    if (tool < 0)
        lar_json_text(json, "tool", NULL);
    else
        lar_json_integer(json, "tool", tool);
    lar_json_text(json, "state", state);
    lar_viewer_tell(viewer, json);
}

/* ---- sending --------------------------------------------------------------------------------- */

static int send_bytes(lar_viewer *viewer, unsigned char *data, size_t length,
                      enum lws_write_protocol kind) {
    return lws_write(viewer->wsi, data, length, kind) < (int)length ? -1 : 0;
}

static int send_json(lar_viewer *viewer, lar_json *json) {
    if (json->failed) return -1;
    return send_bytes(viewer, (unsigned char *)lar_json_data(json), json->length, LWS_WRITE_TEXT);
}

static int send_hello(lar_server *server, lar_viewer *viewer) {
    lar_json *json = &server->json;
    lar_json_begin(json);
    /* What is the same for all, behind its opening brace, and what is not. */
    lar_json_raw(json, lar_json_data(&server->hello) + 1, server->hello.length - 1);
    lar_json_integer(json, "viewer", (int64_t)viewer->number);
    lar_json_boolean(json, "watches", viewer->watches);
    lar_json_end(json);
    return send_json(viewer, json);
}

static int send_note(lar_server *server, lar_viewer *viewer) {
    lar_json *json = &server->json;
    char *note = viewer->note[0];
    viewer->notes--;
    memmove(viewer->note, viewer->note + 1, (size_t)viewer->notes * sizeof *viewer->note);
    if (viewer->notes > 0) lar_viewer_wants(viewer, LAR_DUE_NOTES);
    lar_json_begin(json);
    lar_json_raw(json, note + 1, strlen(note) - 2); /* what is between its braces */
    lar_json_end(json);
    free(note);
    return send_json(viewer, json);
}

typedef struct forces_head {
    uint32_t kind, tool, count, zero;
    uint64_t last;
    double tick;
} forces_head;
_Static_assert(sizeof(forces_head) == 32, "the header of forces has no gaps");

static int send_forces(lar_server *server, lar_viewer *viewer) {
    unsigned char *data = lar_blob_data(&server->forces);
    uint64_t last = viewer->forces_after;
    float(*force)[3] = (float(*)[3])(void *)(data + sizeof(forces_head));
    int32_t count =
        lar_session_force_history(server->session, viewer->forces_tool, viewer->forces_after,
                                  LAR_HISTORY_TICKS, force, &last);
    forces_head head = {.kind = 3,
                        .tool = (uint32_t)viewer->forces_tool,
                        .count = (uint32_t)count,
                        .last = last,
                        .tick = server->about.tick};
    memcpy(data, &head, sizeof head);
    return send_bytes(viewer, data, sizeof head + (size_t)count * sizeof *force, LWS_WRITE_BINARY);
}

static int send_picture(lar_server *server, lar_viewer *viewer) {
    lar_blob *frame = &server->picture.frame[viewer->field];
    /* The picture may be another one by now: then the next one has it again. */
    if (frame->length == 0 || !viewer->asks) return 0;
    viewer->asks = false;
    viewer->painted_at = lar_clock_ns();
    viewer->painted_step = server->picture.step;
    viewer->painted_field = viewer->field;
    return send_bytes(viewer, lar_blob_data(frame), frame->length, LWS_WRITE_BINARY);
}

/* First the reason in words, then the end. */
static int send_end(lar_server *server, lar_viewer *viewer) {
    lar_json *json = &server->json;
    if (viewer->told) {
        lws_close_reason(viewer->wsi, (enum lws_close_status)viewer->closing,
                         (unsigned char *)viewer->reason, strlen(viewer->reason));
        return -1;
    }
    viewer->told = true;
    lws_callback_on_writable(viewer->wsi);
    lar_message_begin(json, "error");
    lar_json_text(json, "text", viewer->reason);
    lar_json_end(json);
    return send_json(viewer, json);
}

int lar_viewer_send(lar_server *server, lar_viewer *viewer) {
    if (viewer->closing != LAR_CLOSE_NOT) return send_end(server, viewer);
    if (lws_get_close_length(viewer->wsi)) return 0; /* libwebsockets has closed it: no more data */
    unsigned due = viewer->due & -viewer->due;       /* the lowest bit: the most urgent */
    int failed = 0;
    viewer->due &= ~due;
    switch (due) {
    case LAR_DUE_HELLO:
        failed = send_hello(server, viewer);
        break;
    case LAR_DUE_SURFACE:
        failed = send_bytes(viewer, lar_blob_data(&server->surface), server->surface.length,
                            LWS_WRITE_BINARY);
        break;
    case LAR_DUE_EMBEDDED:
        failed = send_bytes(viewer, lar_blob_data(&server->embedded), server->embedded.length,
                            LWS_WRITE_BINARY);
        break;
    case LAR_DUE_NOTES:
        failed = send_note(server, viewer);
        break;
    case LAR_DUE_FORCES:
        failed = send_forces(server, viewer);
        break;
    case LAR_DUE_PICTURE:
        failed = send_picture(server, viewer);
        break;
    case LAR_DUE_STATUS:
        write_status(server, viewer, &server->json);
        failed = send_json(viewer, &server->json);
        break;
    case LAR_DUE_SLICE:
        lar_scan_slice(&server->scan, viewer->slice_axis, viewer->slice_index);
        failed = send_bytes(viewer, lar_blob_data(&server->scan.slice), server->scan.slice.length,
                            LWS_WRITE_BINARY);
        break;
    default:
        break;
    }
    if (!failed && viewer->due) lar_viewer_wants(viewer, 0);
    return failed;
}
