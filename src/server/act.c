/* The commands of viewers are executed. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/state.h"

lar_viewer *lar_server_find(const lar_server *server, uint64_t number) {
    lar_viewer *viewer = server->first;
    while (viewer && viewer->number != number) viewer = viewer->next;
    return viewer;
}

/* ---- files that are saved -------------------------------------------------------------------- */

static const char CHECKPOINT[] = "checkpoint", RECORDING[] = "recording";

/* The next free name of a kind: uterus-3.checkpoint. An empty file takes it at once, so that no
 * other session of this folder gets it too. False when the folder is full of them. */
static bool choose_name(lar_server *server, const char *extension, lar_job *job) {
    while (server->saved_number < LAR_SAVE_NUMBERS) {
        int length = snprintf(job->name, sizeof job->name, "%s-%d.%s", server->stem,
                              ++server->saved_number, extension);
        int whole = snprintf(job->path, sizeof job->path, "%s/%s", server->save_folder, job->name);
        if (length < 0 || (size_t)length >= sizeof job->name || whole < 0 ||
            (size_t)whole >= sizeof job->path)
            return false;
        int file = open(job->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) return close(file) == 0;
        if (errno != EEXIST) return false;
    }
    return false;
}

/* A name under which nothing was written is free again. */
static void give_back_name(const lar_job *job) {
    struct stat about;
    bool named = job->kind == LAR_COMMAND_SAVE || (job->kind == LAR_COMMAND_RECORD && job->on);
    if (named && lstat(job->path, &about) == 0 && S_ISREG(about.st_mode) && about.st_size == 0)
        unlink(job->path);
}

/* Twice a second is often enough for people; whoever wants to fill the disk has to wait. */
static bool saves_too_often(lar_server *server) {
    int64_t now = lar_clock_ns();
    bool often = server->saved_at && now - server->saved_at < LAR_SECOND_NS / 2;
    if (!often) server->saved_at = now;
    return often;
}

/* One of those that lie in the folder: a viewer cannot name any other file. */
static bool find_saved(const lar_server *server, const lar_command *command, lar_job *job) {
    const lar_saved_list *list =
        command->kind == LAR_COMMAND_LOAD ? &server->states : &server->recordings;
    const char *found = lar_saved_find(list, command->name);
    if (!found) return false;
    snprintf(job->name, sizeof job->name, "%s", found);
    int length = snprintf(job->path, sizeof job->path, "%s/%s", server->save_folder, job->name);
    return length > 0 && (size_t)length < sizeof job->path;
}

static bool prepare_job(lar_server *server, lar_viewer *viewer, const lar_command *command,
                        lar_job *job) {
    bool leaves = command->kind == LAR_COMMAND_REPLAY && !command->name[0];
    if (command->kind == LAR_COMMAND_RESET || leaves) return true;
    if (!server->save_folder) {
        lar_viewer_note(server, viewer,
                        "saving, loading and recording are not allowed here; start the engine with "
                        "--save-folder");
        return false;
    }
    if (command->kind == LAR_COMMAND_LOAD && !find_saved(server, command, job)) {
        lar_viewer_note(server, viewer, "there is no saved state of this name; save one first");
        return false;
    }
    if (command->kind == LAR_COMMAND_REPLAY && !find_saved(server, command, job)) {
        lar_viewer_note(server, viewer, "there is no recording of this name; make one first");
        return false;
    }
    bool names =
        command->kind == LAR_COMMAND_SAVE || (command->kind == LAR_COMMAND_RECORD && command->on);
    if (names && saves_too_often(server)) {
        lar_viewer_note(server, viewer, "this is too often; save or record again in a second");
        return false;
    }
    if (names && lar_server_saves_full(server)) {
        char sentence[160];
        snprintf(
            sentence, sizeof sentence,
            "saved states and recordings take %.3g GB, as much as they may; move some away, or "
            "start the engine with a larger --save-most",
            1e-9 * server->save_max);
        lar_viewer_note(server, viewer, sentence);
        return false;
    }
    if (names &&
        !choose_name(server, command->kind == LAR_COMMAND_SAVE ? CHECKPOINT : RECORDING, job)) {
        lar_viewer_note(server, viewer,
                        "no name is left in the folder for saved states, or nothing can be written "
                        "there; move some files away, or check its permissions and the free space");
        return false;
    }
    return true;
}

static void ask_job(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    lar_job job = {.kind = command->kind, .viewer = viewer->number, .on = command->on};
    if (!prepare_job(server, viewer, command, &job) || lar_work_ask(&server->work, &job)) return;
    give_back_name(&job);
    lar_viewer_note(server, viewer, "too much is asked for at once; try again in a moment");
}

void lar_server_watch_recording(lar_server *server) {
    if (!server->recording[0] || server->recording_ends || !lar_server_saves_full(server)) return;
    lar_job job = {.kind = LAR_COMMAND_RECORD};
    server->recording_ends = lar_work_ask(&server->work, &job);
    for (lar_viewer *viewer = server->first; viewer && server->recording_ends;
         viewer = viewer->next)
        lar_viewer_note(server, viewer,
                        "the recording has ended: the folder for saved states holds as much as it "
                        "may (--save-most)");
}

/* Materials of viewers begin at 0, and all are none. */
static bool has_material(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    const long of = command->material, count = lar_model_material_count(server->model);
    bool asked = command->kind == LAR_COMMAND_STIFFNESS || command->kind == LAR_COMMAND_ACTIVATE;
    if (!asked || of < count) return true;
    char sentence[128];
    snprintf(sentence, sizeof sentence,
             "there is no material %ld; there are %ld, counted from 0, and without material all "
             "are meant",
             of, count);
    lar_viewer_note(server, viewer, sentence);
    return false;
}

static void ask_setting(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    if (!has_material(server, viewer, command)) return;
    lar_job job = {.kind = command->kind, .viewer = viewer->number, .setting = *command};
    if (!lar_work_ask(&server->work, &job))
        lar_viewer_note(server, viewer, "too much is asked for at once; try again in a moment");
}

static void tell_saved(lar_server *server, lar_viewer *viewer, const char *what, const char *name) {
    lar_json *json = &server->json;
    lar_message_begin(json, "saved");
    lar_json_text(json, "what", what);
    lar_json_text(json, "name", name);
    lar_viewer_tell(viewer, json);
}

static void tell_added(lar_server *server, lar_viewer *viewer, int32_t tool) {
    lar_json *json = &server->json;
    lar_message_begin(json, "added");
    lar_json_integer(json, "tool", tool);
    lar_viewer_tell(viewer, json);
}

void lar_server_job_ended(lar_server *server, const lar_job_end *end) {
    if (end->job.kind == LAR_COMMAND_INSPECT) return lar_server_tell_reading(server, end);
    lar_viewer *viewer = lar_server_find(server, end->job.viewer);
    bool done = end->error.status == LAR_OK;
    if (!done) give_back_name(&end->job);
    if (!done && viewer) lar_viewer_note(server, viewer, end->error.message);
    bool over = end->job.kind == LAR_COMMAND_RECORD && !end->job.on;
    if (!done && over) server->recording[0] = '\0'; /* it is lost, and the status says so */
    if (over) server->recording_ends = false;
    if (!done) return;
    if (end->job.kind == LAR_COMMAND_SAVE) {
        lar_saved_add(&server->states, end->job.name);
        if (viewer) tell_saved(server, viewer, CHECKPOINT, end->job.name);
    } else if (end->job.kind == LAR_COMMAND_RECORD && end->job.on) {
        snprintf(server->recording, sizeof server->recording, "%s", end->job.name);
    } else if (end->job.kind == LAR_COMMAND_ADD_TOOL) {
        if (viewer) tell_added(server, viewer, end->job.setting.tool);
    } else if (end->job.kind == LAR_COMMAND_REPLAY) {
        snprintf(server->played, sizeof server->played, "%s", end->job.name);
    } else if (end->job.kind == LAR_COMMAND_RECORD && server->recording[0]) {
        lar_saved_add(&server->recordings, server->recording);
        if (viewer) tell_saved(server, viewer, RECORDING, server->recording);
        server->recording[0] = '\0';
    } else if (over && viewer) {
        lar_viewer_note(server, viewer, "nothing is being recorded");
    }
}

/* ---- commands -------------------------------------------------------------------------------- */

static void ask_frame(lar_viewer *viewer, const lar_command *command) {
    int field = lar_field_index(command->field);
    if (!viewer->asks || field != viewer->field) viewer->asked_at = lar_clock_ns();
    if (field != viewer->field) viewer->due &= ~(unsigned)LAR_DUE_PICTURE;
    viewer->field = field;
    viewer->asks = true;
}

static void ask_slice(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    const int32_t *size = server->scan.info.size;
    char sentence[160];
    if (!lar_scan_is_there(&server->scan)) {
        lar_viewer_note(server, viewer,
                        "there is no scan here; start the engine with --scan and the image that "
                        "the scene was meshed from");
        return;
    }
    if (command->index >= size[command->axis]) {
        snprintf(sentence, sizeof sentence,
                 "the scan has %d x %d x %d voxels, counted from 0; ask for a slice of these",
                 (int)size[0], (int)size[1], (int)size[2]);
        lar_viewer_note(server, viewer, sentence);
        return;
    }
    viewer->slice_axis = command->axis;
    viewer->slice_index = command->index;
    lar_viewer_wants(viewer, LAR_DUE_SLICE);
}

/* What is played moves its tools itself. */
static bool is_played(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    if (!server->status.replaying) return false;
    lar_viewer_note(server, viewer,
                    "a recording is being played; leave it to pull and to move instruments");
    if (command->kind == LAR_COMMAND_GRAB)
        lar_server_tell_hand(server, viewer->number, command->hand, -1, "missed");
    return true;
}

static void move_tool(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    lar_error error;
    if (is_played(server, viewer, command)) return;
    if (lar_hands_move(&server->hands, viewer->number, command, lar_clock_ns(), &error))
        lar_viewer_note(server, viewer, error.message);
}

static void seek(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    lar_session_status now;
    lar_session_seek(server->session, command->time);
    lar_session_status_get(server->session, &now);
    if (!now.replaying)
        lar_viewer_note(server, viewer, "no recording is being played; replay one first");
}

static void remove_tool(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    lar_error error;
    if (lar_hands_may_remove(&server->hands, viewer->number, command->tool, lar_clock_ns(), &error))
        lar_viewer_note(server, viewer, error.message);
    else
        ask_setting(server, viewer, command);
}

/* Who may only watch gets pictures and forces. Pulls come a hundred times a second and follow a
 * grab that was refused: they need no sentence of their own. */
static bool is_refused(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    bool looks = command->kind == LAR_COMMAND_FRAME || command->kind == LAR_COMMAND_FORCES ||
                 command->kind == LAR_COMMAND_INSPECT || command->kind == LAR_COMMAND_SLICE;
    if (!viewer->watches || looks) return false;
    if (command->kind == LAR_COMMAND_PULL || command->kind == LAR_COMMAND_RELEASE) return true;
    lar_viewer_note(server, viewer,
                    "this viewer may only watch; to act on the run, open the address that has the "
                    "other token");
    if (command->kind == LAR_COMMAND_GRAB)
        lar_server_tell_hand(server, viewer->number, command->hand, -1, "missed");
    return true;
}

void lar_server_act(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    if (is_refused(server, viewer, command)) return;
    switch (command->kind) {
    case LAR_COMMAND_FRAME:
        ask_frame(viewer, command);
        break;
    case LAR_COMMAND_FORCES:
        viewer->forces_tool = command->tool;
        viewer->forces_after = command->after;
        lar_viewer_wants(viewer, LAR_DUE_FORCES);
        break;
    case LAR_COMMAND_GRAB:
        if (is_played(server, viewer, command)) break;
        lar_hands_execute(&server->hands, viewer->number, command, lar_clock_ns());
        break;
    case LAR_COMMAND_PULL:
    case LAR_COMMAND_RELEASE:
        lar_hands_execute(&server->hands, viewer->number, command, lar_clock_ns());
        break;
    case LAR_COMMAND_TOOL:
        move_tool(server, viewer, command);
        break;
    case LAR_COMMAND_PLAY:
        lar_session_play(server->session);
        break;
    case LAR_COMMAND_PAUSE:
        lar_session_pause(server->session);
        break;
    case LAR_COMMAND_STEP:
        lar_session_step(server->session, command->steps);
        break;
    case LAR_COMMAND_PACE:
        lar_session_set_pace(server->session, command->pace);
        server->pace = command->pace;
        break;
    case LAR_COMMAND_SEEK:
        seek(server, viewer, command);
        break;
    case LAR_COMMAND_SLICE:
        ask_slice(server, viewer, command);
        break;
    case LAR_COMMAND_INSPECT:
        lar_server_inspect(server, viewer, command);
        break;
    case LAR_COMMAND_RESET:
    case LAR_COMMAND_SAVE:
    case LAR_COMMAND_LOAD:
    case LAR_COMMAND_RECORD:
    case LAR_COMMAND_REPLAY:
        ask_job(server, viewer, command);
        break;
    case LAR_COMMAND_GRAVITY:
    case LAR_COMMAND_DAMPING:
    case LAR_COMMAND_STIFFNESS:
    case LAR_COMMAND_ACTIVATE:
    case LAR_COMMAND_ADD_TOOL:
        ask_setting(server, viewer, command);
        break;
    case LAR_COMMAND_REMOVE_TOOL:
        remove_tool(server, viewer, command);
        break;
    }
}
