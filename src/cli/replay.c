/* lariat replay: a recording of a session again, compared hash by hash, and as pictures. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "base/json/write.h"
#include "cli/parallel.h"
#include "cli/stop.h"
#include "study/bench/step_clock.h"

typedef struct replay_settings {
    const char *recording, *scene, *out;
    double every; /* between frames [s]; 0: not given */
    int isa;
    bool json, surface;
    cli_parallel parallel;
    int argc; /* what the command was given */
    char **argv;
} replay_settings;

/* One replay under way. */
typedef struct replay {
    replay_settings settings;
    lar_recording_info recorded;
    lar_model *model;
    lar_model_info info;
    lar_processes *processes;
    lar_grid_choice choice;
    lar_parallel parallel;
    lar_simulation *simulation;
    lar_replay_report report;
    lar_status failure;   /* of the library, LAR_OK: none */
    char fault[1024];     /* with which the recording ends; "": none */
    lar_results *results; /* NULL without --out */
    lar_results *first;   /* of the first part, while there is another one */
    lar_status written;   /* of the results */
    lar_error written_error;
    double interval;   /* between frames [s] */
    double next_frame; /* when the next one is due [s] */
    uint64_t step;     /* of the latest look */
    uint64_t framed;   /* of the latest frame */
    int frames, parts; /* a part for each time that the simulation went back */
    lar_step_clock clock;
    double elapsed, progress_at; /* [s] */
} replay;

/* ---- frames -------------------------------------------------------------------------------- */

/* A series of frames has one time line: where the recording goes back, a new one begins. */
static lar_status open_part(replay *r, lar_error *error) {
    char folder[4096];
    lar_status status = LAR_OK;
    r->parts++;
    if (r->parts == 2) /* the folder stays this replay's until the end */
        r->first = r->results;
    else
        status = lar_results_close(r->results, error);
    r->results = NULL;
    if (status) return status;
    if (r->parts == 1)
        snprintf(folder, sizeof folder, "%s", r->settings.out);
    else
        snprintf(folder, sizeof folder, "%s/part_%d", r->settings.out, r->parts);
    return (r->settings.surface ? lar_results_open_surface
                                : lar_results_open)(folder, r->simulation, &r->results, error);
}

static lar_status add_state(replay *r, uint64_t step, lar_error *error) {
    r->frames++;
    r->framed = step;
    return lar_results_add(r->results, r->simulation, error);
}

static lar_status add_frame(replay *r, uint64_t step, lar_error *error) {
    double time = lar_simulation_time(r->simulation);
    lar_status status = LAR_OK;
    if (r->parts == 0 || step < r->step) {
        status = open_part(r, error);
        r->next_frame = time;
    }
    if (status || time < r->next_frame - 1e-9) return status;
    r->next_frame = r->interval * (floor(time / r->interval + 1e-6) + 1);
    return add_state(r, step, error);
}

/* Where the recording ends, with a fault too: as `run` does. What a reset or a load ended is gone
 * when it is heard of. */
static void add_last(replay *r) {
    uint64_t step = lar_simulation_steps(r->simulation);
    if (r->results && !r->written && r->framed != step)
        r->written = add_state(r, step, &r->written_error);
}

static void show_progress(replay *r) {
    static const double QUIET = 1.0, EVERY = 0.1; /* [s] */
    double elapsed = lar_step_clock_elapsed(&r->clock);
    if (elapsed < QUIET || elapsed < r->progress_at + EVERY || !isatty(STDERR_FILENO)) return;
    fprintf(stderr, "\r%.4g s simulated, %d frame%s \033[K", lar_simulation_time(r->simulation),
            r->frames, r->frames == 1 ? "" : "s");
    fflush(stderr);
    r->progress_at = elapsed;
}

static int look(void *context, uint64_t step) {
    replay *r = context;
    if (r->settings.out) r->written = add_frame(r, step, &r->written_error);
    r->step = step;
    show_progress(r);
    return !r->written && !cli_stop_asked;
}

/* ---- telling ------------------------------------------------------------------------------- */

static void write_json(const replay *r) {
    char hash[17];
    snprintf(hash, sizeof hash, "%016" PRIx64, lar_simulation_hash(r->simulation));
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "recording", r->settings.recording);
    lar_json_text(&json, "title", r->info.title);
    lar_json_integer(&json, "elements", r->info.elements);
    lar_json_integer(&json, "nodes", r->info.nodes);
    lar_json_text(&json, "element", cli_element_names[r->recorded.element]);
    lar_json_integer(&json, "steps", (int64_t)r->report.steps);
    lar_json_number(&json, "time_step", r->recorded.time_step);
    cli_write_parallel(&json, &r->parallel);
    lar_json_text(&json, "isa", lar_simulation_isa(r->simulation));
    lar_json_number(&json, "wall_time", r->elapsed);
    lar_json_integer(&json, "hashes", (int64_t)r->report.hashes);
    lar_json_boolean(&json, "equal", true);
    lar_json_text(&json, "fault", r->fault);
    lar_json_text(&json, "state_hash", *r->fault ? "" : hash);
    lar_json_integer(&json, "frames", r->frames);
    lar_json_boolean(&json, "interrupted", cli_stop_asked != 0);
    lar_json_end(&json);
}

static void write_table(const replay *r) {
    printf("%s: %d elements, %d nodes (%s, %s)\n",
           *r->info.title ? r->info.title : r->settings.scene, (int)r->info.elements,
           (int)r->info.nodes, cli_element_names[r->recorded.element],
           lar_simulation_isa(r->simulation));
    printf("%-17s%" PRIu64 " steps of %.4g s in %.4g s%s\n", "played", r->report.steps,
           r->recorded.time_step, r->elapsed, cli_stop_asked ? ", interrupted" : "");
    printf("%-17sall %" PRIu64 " hashes are equal to those of the recording\n", "compared",
           r->report.hashes);
    if (*r->fault)
        printf("%-17sas the recording did, by a fault: %s\n", "ended", r->fault);
    else
        printf("%-17s%016" PRIx64 "\n", "state hash", lar_simulation_hash(r->simulation));
    if (!r->settings.out) return;
    printf("%-17s%s: %d frame%s, .pvd, probes.csv", "results", r->settings.out, r->frames,
           r->frames == 1 ? "" : "s");
    if (r->parts > 1)
        printf("; in %d parts, because the session went back %d time%s", r->parts, r->parts - 1,
               r->parts == 2 ? "" : "s");
    printf("\n");
}

/* ---- the replay ---------------------------------------------------------------------------- */

static int fail_by(replay *r, const lar_error *error) {
    r->failure = error->status;
    return cli_refuse(&cli_replay, error);
}

static bool is_recording(const char *path) {
    const char *dot = strrchr(path, '.');
    lar_recording_info info;
    return (dot && strcmp(dot, ".recording") == 0) || !lar_recording_inspect(path, &info, NULL);
}

/* The recording stood first once. */
static void accept_old_order(replay_settings *s) {
    if (!is_recording(s->scene) || is_recording(s->recording)) return;
    const char *scene = s->recording;
    s->recording = s->scene;
    s->scene = scene;
    char quoted[2][CLI_QUOTED];
    if (cli_speaker() == 0)
        cli_complain(&cli_replay, CLI_DONE,
                     "note: the scene comes first, as for all commands: lariat replay %s %s",
                     cli_quote(s->scene, quoted[0], CLI_QUOTED),
                     cli_quote(s->recording, quoted[1], CLI_QUOTED));
}

/* The model, the processes, and this one's share of the simulation. */
static int prepare(replay *r) {
    replay_settings *s = &r->settings;
    lar_options options = lar_options_default();
    lar_error error;
    int status = cli_processes_begin(&cli_replay, &s->parallel, s->argc, s->argv, &r->processes);
    if (status) return status;
    accept_old_order(s);
    if (lar_recording_inspect(s->recording, &r->recorded, &error)) {
        r->failure = error.status;
        return cli_complain_as_other(&cli_replay, r->processes, &error);
    }
    options.element = r->recorded.element;
    options.isa = (lar_isa)s->isa;
    options.time_step = r->recorded.time_step;
    options.hands = r->recorded.hands;
    options.spares = r->recorded.spares;
    cli_parallel_set(&s->parallel, &options);
    status = cli_open_model(&cli_replay, s->scene, &r->model);
    if (!status && s->parallel.grid) /* auto; by default one processor: most are short */
        status = cli_choose_grid(&cli_replay, &s->parallel, r->model, NULL, &options, &r->choice);
    if (!status)
        status = cli_processes_start(&cli_replay, r->processes, r->model, &options, &r->parallel);
    if (status) return status;
    r->parallel.reason = r->choice.reason;
    if (!lar_model_inspect(r->model, &r->info, &error) &&
        !lar_processes_create(r->processes, r->model, &options, &r->simulation, &error))
        return CLI_DONE;
    r->failure = error.status;
    return cli_complain_as_other(&cli_replay, r->processes, &error);
}

static int compare(replay *r) {
    lar_error error, closing;
    r->interval = r->settings.every > 0 ? r->settings.every : lar_model_output_interval(r->model);
    if (r->interval <= 0) r->interval = 0.04;
    lar_step_clock_start(&r->clock, r->simulation, false);
    lar_status status =
        lar_replay(r->simulation, r->settings.recording, look, r, &r->report, &error);
    r->elapsed = lar_step_clock_elapsed(&r->clock);
    if (r->progress_at > 0) fputs("\r\033[K", stderr);
    if (!status || r->report.broken) add_last(r);
    lar_status closed = lar_results_close(r->results, &closing), first;
    first = lar_results_close(r->first, closed ? NULL : &closing);
    if (!closed) closed = first;
    if (status == LAR_ERROR_UNSTABLE && r->report.broken)
        snprintf(r->fault, sizeof r->fault, "%s", error.message);
    else if (status)
        return fail_by(r, &error);
    if (r->written) return fail_by(r, &r->written_error);
    if (closed) return fail_by(r, &closing);
    if (r->settings.json)
        write_json(r);
    else
        write_table(r);
    return cli_stop_asked ? CLI_INTERRUPTED : CLI_DONE;
}

/* Processor zero hears Ctrl-C too, and ends the replay for all. */
static int serve(replay *r) {
    lar_error error;
    return lar_simulation_serve(r->simulation, &error) ? fail_by(r, &error) : CLI_DONE;
}

static int replay_recording(const replay_settings *settings) {
    static replay r; /* too large for a small stack (ulimit -s) */
    r.settings = *settings;
    cli_catch_stop();
    int status = prepare(&r);
    if (!status) status = lar_processes_self(r.processes) > 0 ? serve(&r) : compare(&r);
    bool failed = status && status != CLI_INTERRUPTED;
    lar_simulation_destroy(r.simulation);
    lar_model_destroy(r.model);
    if (failed && !r.failure) r.failure = LAR_ERROR_IO;
    return cli_processes_end(&cli_replay, r.processes, r.failure, status);
}

/* ---- the command line ---------------------------------------------------------------------- */

static int replay_main(int argc, char **argv) {
    replay_settings s = {.parallel = CLI_PARALLEL_NONE, .argc = argc, .argv = argv};
    const char *arguments[2];
    const cli_option options[] = {
        CLI_TEXT("--out", "DIR", "write frames, .pvd and probes.csv there", &s.out),
        CLI_FLAG("--surface", "with --out: the embedded surface in every frame, too", &s.surface),
        CLI_REAL("--every", "S",
                 "simulated seconds between frames; without: what the\nscene's output says, 0.04 "
                 "when it says nothing",
                 &s.every, 1e-9, 1e9),
        CLI_CHOICE("--isa", "NAME",
                   "instruction set: auto (default), c, neon, avx2,\navx512; the results are the "
                   "same",
                   &s.isa, cli_isa_names),
        CLI_PARALLEL(s.parallel),
        CLI_FLAG("--json", "the summary as one JSON object on standard output", &s.json),
        CLI_END};
    int status = cli_parse(&cli_replay, options, argc, argv, arguments, 2);
    if (status >= 0) return status;
    s.scene = arguments[0];
    s.recording = arguments[1];
    if (s.every > 0 && !s.out)
        return cli_complain(&cli_replay, CLI_USAGE,
                            "--every is the time between frames; say with --out where they go");
    status = cli_parallel_check(&cli_replay, &s.parallel);
    return status ? status : replay_recording(&s);
}

const cli_command cli_replay = {
    .name = "replay",
    .summary = "play a recorded session again, and compare",
    .arguments = "SCENE RECORDING",
    .description =
        "Plays what a session has recorded, as fast as it goes and on any grid, and compares the\n"
        "state hashes. The exit status is 0 only when all of them are equal; otherwise the "
        "message\n"
        "names the first step that differs. A run that broke breaks again in the same step, which\n"
        "is told. With --out the motion is written as a run's is.",
    .examples =
        "  lariat replay demo/uterus_live.yaml session.recording\n"
        "  lariat replay demo/uterus_live.yaml session.recording --grid 2x1x1 --json\n"
        "  lariat replay demo/uterus_live.yaml session.recording --out frames --every 0.04\n",
    .main = replay_main};
