/* lariat view: a scene in real time, in the browser. */
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/parallel.h"
#include "cli/stop.h"
#include "cli/report/view.h"

typedef struct view_settings {
    const char *scene, *resume, *listen, *token, *watch_token, *record, *save_folder, *viewer,
        *scan;
    cli_texts devices; /* TOOL=SPEC */
    int64_t port, priority;
    double pace, seconds, time_step, save_max;
    int isa;
    bool paused, open, json, force;
    cli_parallel parallel;
    int argc; /* what the command was given */
    char **argv;
} view_settings;

typedef struct view {
    view_settings settings;
    lar_model *model;
    lar_processes *processes;
    lar_grid_choice choice;
    lar_parallel parallel;
    lar_simulation *simulation;
    lar_session *session;
    lar_server *server;
    view_report report;
    char *url;
    pid_t browser;                /* its starter; 0: none */
    lar_session_state state;      /* as last told */
    bool slow, recording_lost;    /* as last told */
    double slow_since, slow_told; /* when slow motion began, and was last announced [s] */
    double slow_quiet;            /* so long it is not announced again [s] */
    uint64_t recoveries;          /* as last told */
    double recovered_told;        /* when that was [s] */
    double progress_at;
    double lost_at; /* when a processor was found lost [s]; 0: never */
    lar_status failure;
} view;

static double now(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* ---- opening --------------------------------------------------------------------------------- */

static int fail_by(view *v, const lar_error *error) {
    v->failure = error->status;
    return cli_refuse(&cli_view, error);
}

/* The model, the processes, and this one's share of the simulation. */
static int prepare(view *v) {
    const view_settings *s = &v->settings;
    lar_options options = lar_options_default();
    lar_error error;
    options.isa = (lar_isa)s->isa;
    options.time_step = s->time_step;
    options.hands = 4;
    options.spares = 4;
    cli_parallel_set(&s->parallel, &options);
    int status = cli_processes_begin(&cli_view, &s->parallel, s->argc, s->argv, &v->processes);
    if (!status) status = cli_open_model(&cli_view, s->scene, &v->model);
    if (!status) status = cli_resume_options(&cli_view, s->resume, v->model, &options);
    if (!status && options.hands == 0)
        cli_complain(
            &cli_view, CLI_DONE,
            "note: %s has no hands, nobody can pull; states that lariat view saves have some",
            s->resume);
    if (!status)
        status = cli_choose_grid(&cli_view, &s->parallel, v->model,
                                 &(lar_grid_aim){.tick = CLI_TICK * s->pace}, &options, &v->choice);
    if (!status)
        status = cli_processes_start(&cli_view, v->processes, v->model, &options, &v->parallel);
    if (status) return status;
    v->parallel.reason = v->choice.reason;
    if (!lar_model_inspect(v->model, &v->report.info, &error) &&
        !lar_processes_create(v->processes, v->model, &options, &v->simulation, &error))
        return CLI_DONE;
    v->failure = error.status;
    return cli_complain_as_other(&cli_view, v->processes, &error);
}

/* "udp:HOST:PORT,token=...": what the device shows is for nobody else to read. */
static void name_device(const char *spec, char name[128]) {
    static const char KEY[] = ",token=";
    const char *token = strstr(spec, KEY), *rest = "";
    if (token) rest = token + strlen(KEY) + strcspn(token + strlen(KEY), ",");
    snprintf(name, 128, "%.*s%s", (int)(token ? token - spec : (long)strlen(spec)), spec, rest);
}

static int unknown_tool(const view *v, const char *device) {
    char known[512] = "", name[128];
    name_device(device, name);
    for (int32_t i = 0; i < lar_simulation_tool_count(v->simulation); i++) {
        lar_tool_info tool;
        size_t used = strlen(known);
        if (!lar_simulation_tool(v->simulation, i, &tool, NULL) && tool.shape != LAR_TOOL_NONE)
            snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", tool.name);
    }
    return cli_complain(&cli_view, CLI_USAGE, "--device %s: there is no such tool; there are: %s",
                        name, known);
}

/* "probe=udp:127.0.0.1:9000" */
static int attach(view *v, const char *device) {
    const char *equals = strchr(device, '=');
    size_t length = equals ? (size_t)(equals - device) : 0;
    lar_error error;
    if (!equals || !equals[1])
        return cli_complain(&cli_view, CLI_USAGE,
                            "--device %s: write TOOL=DEVICE, such as probe=udp:127.0.0.1:9000",
                            device);
    for (int32_t i = 0; i < lar_simulation_tool_count(v->simulation); i++) {
        lar_tool_info tool;
        if (lar_simulation_tool(v->simulation, i, &tool, NULL) || strlen(tool.name) != length ||
            memcmp(tool.name, device, length) != 0)
            continue;
        if (lar_session_attach(v->session, i, equals + 1, &error)) return fail_by(v, &error);
        lar_device_status status;
        if (!lar_session_device(v->session, i, &status, NULL) && status.port > 0)
            cli_complain(&cli_view, CLI_DONE, "note: the device of %s is expected at port %d",
                         tool.name, status.port);
        return CLI_DONE;
    }
    return unknown_tool(v, device);
}

/* The port that is asked for, or the next one that is free. */
static int open_server(view *v) {
    const view_settings *s = &v->settings;
    enum { TRIES = 50 };
    lar_server_options options = {.address = s->listen,
                                  .port = (int)s->port,
                                  .token = s->token,
                                  .watch_token = s->watch_token,
                                  .scan = s->scan,
                                  .folder = s->viewer,
                                  .save_folder = s->save_folder,
                                  .save_max = 1e9 * s->save_max};
    lar_error error, first;
    lar_status status = lar_server_open(v->session, v->model, &options, &v->server, &first);
    error = first;
    for (int i = 1; i < TRIES && status == LAR_ERROR_IO && options.port > 0 && options.port < 65535;
         i++) {
        options.port++;
        status = lar_server_open(v->session, v->model, &options, &v->server, &error);
    }
    if (status) return fail_by(v, status == LAR_ERROR_IO ? &first : &error);
    if (options.port != s->port)
        cli_complain(&cli_view, CLI_DONE, "note: port %d is taken; listening at port %d instead",
                     (int)s->port, options.port);
    v->url = strdup(lar_server_url(v->server));
    return v->url ? CLI_DONE : cli_complain(&cli_view, CLI_FAILED, "out of memory");
}

static int open_session(view *v) {
    const view_settings *s = &v->settings;
    lar_session_options options = lar_session_options_default();
    lar_error error;
    options.pace = s->pace;
    options.paused = s->paused;
    options.priority = (int)s->priority;
    struct stat there;
    if (s->record && stat(s->record, &there) == 0 && S_ISDIR(there.st_mode))
        return cli_complain(&cli_view, CLI_FAILED, "%s is a folder; give --record a file",
                            s->record);
    if (s->record && !s->force && access(s->record, F_OK) == 0)
        return cli_complain(&cli_view, CLI_FAILED,
                            "%s is there already; --force replaces it, or take another name",
                            s->record);
    if (s->resume && lar_simulation_load(v->simulation, s->resume, &error))
        return fail_by(v, &error);
    if (lar_session_open(v->simulation, &options, &v->session, &error)) return fail_by(v, &error);
    int status = CLI_DONE;
    for (int i = 0; i < s->devices.count && !status; i++) status = attach(v, s->devices.text[i]);
    if (!status) status = open_server(v);
    /* When all else is sound: one that is refused leaves no recording, and replaces none. */
    if (!status && s->record && lar_session_record(v->session, s->record, &error))
        status = fail_by(v, &error);
    if (!status && lar_session_start(v->session, &error)) status = fail_by(v, &error);
    return status;
}

/* ---- the browser ----------------------------------------------------------------------------- */

static bool has_display(void) {
    const char *x = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    return (x && *x) || (wayland && *wayland);
}

static void open_browser(view *v) {
    char *const argv[] = {"xdg-open", v->url, NULL};
    extern char **environ;
    posix_spawn_file_actions_t quiet;
    if (!has_display()) {
        cli_complain(&cli_view, CLI_DONE,
                     "note: there is no display here to open a browser on; open the address "
                     "yourself");
        return;
    }
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    if (posix_spawnp(&v->browser, argv[0], &quiet, NULL, argv, environ) != 0) {
        v->browser = 0;
        cli_complain(&cli_view, CLI_DONE,
                     "note: there is no xdg-open here; open the address in a browser yourself");
    }
    posix_spawn_file_actions_destroy(&quiet);
}

/* ---- while it runs --------------------------------------------------------------------------- */

static void clear_progress(view *v) {
    if (v->progress_at > 0) fputs("\r\033[K", stderr);
    v->progress_at = 0;
}

static void show_progress(view *v, const lar_session_status *s, double at) {
    static const double EVERY = 0.5; /* [s] */
    if (at < v->progress_at + EVERY || !isatty(STDERR_FILENO)) return;
    fprintf(stderr,
            "\r%.1f s simulated, %.2f x real time, %" PRIu64 " of %" PRIu64
            " ticks missed, %d viewer%s \033[K",
            s->time, s->real_time_factor_now, s->misses, s->ticks,
            (int)lar_server_viewers(v->server), lar_server_viewers(v->server) == 1 ? "" : "s");
    fflush(stderr);
    v->progress_at = at;
}

static const double REPEAT_LIMIT = 5; /* [s] */

/* The run went back to a sound state; when it does so often, only now and then. */
static void announce_recovery(view *v, const lar_session_status *s, double at) {
    if (s->recoveries == v->recoveries || at < v->recovered_told + REPEAT_LIMIT) return;
    clear_progress(v);
    cli_complain(&cli_view, CLI_DONE, "note: the run became unstable and %s", s->recovery);
    v->recoveries = s->recoveries;
    v->recovered_told = at;
}

/* A recording that ends by itself, as on a full disk, is told at once: what is done next is lost.
 */
static void announce_recording(view *v, const lar_session_status *s) {
    bool lost = s->recording_lost[0] != '\0';
    if (lost && !v->recording_lost) {
        clear_progress(v);
        cli_complain(&cli_view, CLI_DONE, "note: recording has ended: %s", s->recording_lost);
    }
    v->recording_lost = lost;
}

/* Slow motion is told half a second after it has begun: by then it is known why, and how slow the
 * last second was. One that is over by then was a moment's, and is only counted. */
static void announce_slow(view *v, const lar_session_status *s, double at) {
    static const double KNOWN = 0.5; /* [s] */
    if (s->slow_motion && !v->slow) {
        v->report.slow_times++;
        v->slow_since = at;
    }
    v->slow = s->slow_motion != 0;
    if (s->slow_cause != LAR_SLOW_NOT) v->report.slow_cause = s->slow_cause;
    if (!v->slow || s->slow_cause == LAR_SLOW_NOT || at < v->slow_since + KNOWN ||
        at < v->slow_told + v->slow_quiet || v->slow_told > v->slow_since ||
        s->real_time_factor_now > 0.99 * s->pace)
        return;
    clear_progress(v);
    cli_complain(&cli_view, CLI_DONE, "note: slow motion, %.2f times real time: %s",
                 s->real_time_factor_now, s->slow_advice);
    v->slow_told = at;
    v->slow_quiet *= 2; /* what comes again and again is known; the report counts all */
}

/* Slow motion and stops are announced, each time they begin. */
static void announce(view *v, const lar_session_status *s, double at) {
    announce_slow(v, s, at);
    announce_recovery(v, s, at);
    announce_recording(v, s);
    if (s->error == LAR_ERROR_PEER && v->failure != LAR_ERROR_PEER) {
        clear_progress(v);
        cli_complain(&cli_view, CLI_FAILED, "%s", s->message);
        v->failure = LAR_ERROR_PEER;
        v->lost_at = at;
    } else if (s->state == LAR_SESSION_STOPPED && v->state != LAR_SESSION_STOPPED) {
        clear_progress(v);
        cli_complain(&cli_view, CLI_DONE, "note: the run has stopped, reset takes it up again: %s",
                     s->message);
    }
    v->state = s->state;
}

/* At most VIEW_TOOLS: as many as there can be. */
static void note_tools(view *v) {
    view_report *r = &v->report;
    for (int32_t i = 0; i < lar_simulation_tool_count(v->simulation) && r->tools < VIEW_TOOLS;
         i++) {
        view_tool *tool = &r->tool[r->tools];
        lar_tool_info info;
        if (lar_session_tool_info(v->session, i, &info, NULL) || info.shape == LAR_TOOL_HAND ||
            info.shape == LAR_TOOL_NONE || lar_session_tool_load(v->session, i, &tool->load, NULL))
            continue;
        tool->name = info.name;
        r->tools++;
    }
}

/* At most VIEW_DEVICES: as many as there can be tools. */
static void note_devices(view *v) {
    view_report *r = &v->report;
    for (int32_t i = 0; i < lar_simulation_tool_count(v->simulation); i++) {
        view_device *device = &r->device[r->devices];
        lar_tool_info tool;
        if (r->devices == VIEW_DEVICES ||
            lar_session_device(v->session, i, &device->status, NULL) || !device->status.name ||
            lar_simulation_tool(v->simulation, i, &tool, NULL))
            continue;
        device->tool = tool.name;
        name_device(device->status.name, device->name);
        r->devices++;
    }
}

/* Viewers are told why for a second, then it is over: without a processor nothing goes on. */
static bool is_over(const view *v, double begin, double at) {
    static const double TELL = 1; /* [s] */
    return cli_stop_asked || (v->settings.seconds > 0 && at >= begin + v->settings.seconds) ||
           (v->failure == LAR_ERROR_PEER && at >= v->lost_at + TELL);
}

/* How it stands at the end. Times are summed up now and then only: all of them, when it rests. */
static void look_last(view *v) {
    const struct timespec nap = {0, 1000000};
    enum { NAPS = 1000 };
    lar_session_status *status = &v->report.status;
    lar_session_status_get(v->session, status);
    lar_session_state state = status->state;
    lar_session_pause(v->session);
    for (int i = 0; i < NAPS && status->state == LAR_SESSION_PLAYING; i++) {
        nanosleep(&nap, NULL);
        lar_session_status_get(v->session, status);
    }
    if (status->state == LAR_SESSION_PAUSED) status->state = state;
    announce(v, status, now());
}

static void look_after(view *v) {
    const struct timespec nap = {0, 50000000};
    double begin = now();
    v->slow_told = v->recovered_told = -1e9;
    v->slow_quiet = REPEAT_LIMIT;
    while (!is_over(v, begin, now())) {
        lar_session_status status;
        nanosleep(&nap, NULL);
        lar_session_status_get(v->session, &status);
        int32_t viewers = lar_server_viewers(v->server);
        if (viewers > v->report.viewers_max) v->report.viewers_max = viewers;
        announce(v, &status, now());
        show_progress(v, &status, now());
        if (v->browser && waitpid(v->browser, NULL, WNOHANG)) v->browser = 0;
    }
    clear_progress(v);
    v->report.elapsed = now() - begin;
    look_last(v);
    note_tools(v);
    note_devices(v);
}

/* ---- the command ----------------------------------------------------------------------------- */

static void greet(view *v) {
    FILE *out = v->settings.json ? stderr : stdout;
    const char *watch = lar_server_watch_url(v->server);
    fprintf(out, "%s\n", v->url ? v->url : "");
    fprintf(out, "Open this address in a browser; Ctrl-C ends.\n");
    if (*watch) fprintf(out, "%s\nWho opens that one can only watch.\n", watch);
    fflush(out);
    const double duration = v->report.info.duration; /* ends of ramps are none */
    if (duration > 0)
        cli_complain(&cli_view, CLI_DONE, "note: the scene lasts %g s; view goes on", duration);
    if (v->settings.open && v->url) open_browser(v);
}

static int report(view *v, int status) {
    view_report *r = &v->report;
    r->scene = v->settings.scene;
    r->url = v->url;
    r->parallel = &v->parallel;
    r->simulation = v->simulation;
    r->pace = v->settings.pace;
    if (v->settings.json)
        view_report_json(r, stdout);
    else
        view_report_table(r, stdout);
    if (status || r->status.state != LAR_SESSION_STOPPED) return status;
    return r->status.error == LAR_ERROR_UNSTABLE ? CLI_UNSTABLE : CLI_FAILED;
}

static int present(view *v) {
    lar_error error;
    cli_catch_stop();
    int status = open_session(v);
    if (!status) {
        greet(v);
        look_after(v);
        if (v->failure) status = CLI_FAILED;
    }
    lar_server_close(v->server);
    if (lar_session_close(v->session, &error) && !status) status = fail_by(v, &error);
    if (v->report.elapsed > 0) status = report(v, status);
    free(v->url);
    return status;
}

/* Processor zero hears Ctrl-C too, and ends the session for all. */
static int serve(view *v) {
    lar_error error;
    cli_catch_stop_of_all(lar_processes_by_hand(v->processes));
    return lar_simulation_serve(v->simulation, &error) ? fail_by(v, &error) : CLI_DONE;
}

static int view_scene(const view_settings *settings) {
    view v = {.settings = *settings};
    int status = prepare(&v);
    if (!status) status = lar_processes_self(v.processes) > 0 ? serve(&v) : present(&v);
    lar_simulation_destroy(v.simulation);
    lar_model_destroy(v.model);
    if (status && !v.failure) v.failure = LAR_ERROR_IO;
    return cli_processes_end(&cli_view, v.processes, v.failure, status);
}

static int view_main(int argc, char **argv) {
    view_settings s = {.parallel = CLI_PARALLEL_NONE,
                       .argc = argc,
                       .argv = argv,
                       .port = 8000,
                       .pace = 1,
                       .save_max = 4};
    const cli_option options[] = {
        CLI_COUNT("--port", "N",
                  "where the viewer is served (8000; when it is taken the next\none that is free); "
                  "0: any free one",
                  &s.port, 0, 65535),
        CLI_TEXT(
            "--listen", "ADDRESS",
            "an address of this machine that others can reach, or\n0.0.0.0 for all, instead of "
            "127.0.0.1; needs --token",
            &s.listen),
        CLI_TEXT("--token", "TOKEN",
                 "what viewers must show: 8 to 128 letters, digits, - and _;\nit is part of the "
                 "address that is printed",
                 &s.token),
        CLI_TEXT(
            "--watch-token", "TOKEN",
            "who shows this one instead may watch and do nothing else;\nits address is printed "
            "too; needs --token",
            &s.watch_token),
        CLI_TEXTS("--device", "TOOL=DEVICE",
                  "a tool's device: script:FILE.csv, udp:HOST:PORT, gamepad:N;\nmay be given for "
                  "several tools",
                  &s.devices),
        CLI_TEXT("--resume", "FILE", "go on from a saved state of this scene (.checkpoint)",
                 &s.resume),
        CLI_TEXT("--record", "FILE", "record all inputs, from the start", &s.record),
        CLI_FLAG("--force", "--record replaces a recording that is there", &s.force),
        CLI_TEXT("--save-folder", "DIR",
                 "where the viewer may save states and recordings; without:\nnowhere",
                 &s.save_folder),
        CLI_REAL("--save-most", "GB",
                 "how much states and recordings may take there, those from\nbefore included (4)",
                 &s.save_max, 1e-3, 1e6),
        CLI_TEXT(
            "--scan", "IMAGE",
            "the segmented image that the scene was meshed from: its\nslices can be seen beside "
            "the organ",
            &s.scan),
        CLI_REAL("--pace", "F",
                 "simulated seconds per second of the clock (1); 0: as fast as it goes", &s.pace, 0,
                 100),
        CLI_FLAG("--paused", "wait for play", &s.paused),
        CLI_COUNT(
            "--priority", "N",
            "the threads that compute go before all ordinary ones of the\nmachine (SCHED_FIFO); "
            "needs the right to (ulimit -r)",
            &s.priority, 1, 99),
        CLI_REAL("--seconds", "S", "end after so many seconds of the clock; without: at Ctrl-C",
                 &s.seconds, 1e-3, 1e9),
        CLI_FLAG("--open", "open the address in a browser, where there is a display", &s.open),
        CLI_TEXT("--viewer", "DIR", "the viewer's files, instead of those of this build",
                 &s.viewer),
        CLI_REAL("--time-step", "S",
                 "seconds, instead of the scene's; above the stable step an error", &s.time_step,
                 1e-15, 1e3),
        CLI_CHOICE(
            "--isa", "NAME",
            "instruction set: auto (default), c, neon, avx2, avx512; the\nresults are the same",
            &s.isa, cli_isa_names),
        CLI_PARALLEL(s.parallel),
        CLI_FLAG("--json", "the report as one JSON object on standard output", &s.json),
        CLI_END};
    int status = cli_parse(&cli_view, options, argc, argv, &s.scene, 1);
    if (status >= 0) return status;
    status = cli_parallel_check(&cli_view, &s.parallel);
    return status ? status : view_scene(&s);
}

const cli_command cli_view = {
    .name = "view",
    .summary = "simulate a scene in real time, to see and to pull at in the browser",
    .arguments = "SCENE",
    .description =
        "Simulates a scene in real time and serves a viewer, whose address is "
        "printed:\n"
        "take hold of the organ with the mouse and pull. Only this machine can reach it unless\n"
        "--listen says otherwise. Ctrl-C ends it with a report, the scene's duration does not;\n"
        "when the run breaks, the viewer shows why, and its reset begins again.",
    .examples =
        "  lariat view demo/uterus_live.yaml\n"
        "  lariat view demo/uterus_live.yaml --open --save-folder demo/saved\n"
        "  lariat view demo/uterus_live.yaml --grid 2x1x1 --device probe=udp:127.0.0.1:9000\n"
        "  lariat view demo/uterus_live.yaml --listen 0.0.0.0 --token correct-horse-battery\n"
        "  lariat view demo/uterus_live.yaml --seconds 5 --port 0 --json\n",
    .main = view_main};
