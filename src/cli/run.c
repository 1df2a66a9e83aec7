/* lariat run: a scene in, motion, figures and results out. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "base/file/part_file.h"
#include "cli/commands.h"
#include "cli/parallel.h"
#include "cli/stop.h"
#include "cli/report/rest_remedy.h"
#include "cli/report/run.h"

enum { PATH_SIZE = 4096 };

typedef struct run_settings {
    const char *scene, *out, *resume, *save;
    double time, time_step; /* 0: not given */
    int64_t steps;          /* 0: not given */
    int element, isa;       /* as lar_element_kind, lar_isa */
    bool realtime, json, verify, surface, until_rest;
    cli_parallel parallel;
    int argc; /* what the command was given */
    char **argv;
} run_settings;

/* One run under way. */
typedef struct run {
    run_settings settings;
    lar_model *model;
    lar_model_info info;
    lar_processes *processes;
    lar_grid_choice choice;
    lar_parallel parallel;
    lar_simulation *simulation;
    lar_status failure;   /* of the library, LAR_OK: none */
    lar_results *results; /* NULL without --out */
    lar_step_clock clock;
    uint64_t first_step, last_step; /* where the run begins and ends */
    bool follows;       /* the run goes on until it is at rest, at most to its last step */
    lar_rest rest;      /* then */
    lar_energy began;   /* before the first step */
    double interval;    /* between frames [s], 0: only the end */
    int64_t next_frame; /* number of the next one, in intervals */
    uint64_t framed;    /* the step of the latest frame, UINT64_MAX: none */
    int frames;
    double elapsed;     /* [s] */
    double progress_at; /* when progress was last shown [s]; 0: it is not on the screen */
} run;

/* ---- progress --------------------------------------------------------------------------- */

static void show_progress(run *r) {
    static const double QUIET = 1.0, EVERY = 0.1; /* shorter runs say nothing [s] */
    double elapsed = lar_step_clock_elapsed(&r->clock);
    if (elapsed < QUIET || elapsed < r->progress_at + EVERY || !isatty(STDERR_FILENO)) return;
    double done = (double)(lar_simulation_steps(r->simulation) - r->first_step) /
                  (double)(r->last_step - r->first_step);
    double time = lar_simulation_time(r->simulation);
    if (r->follows && r->rest.looked)
        fprintf(stderr, "\r%.4g s simulated, motion %.1e of the strain, at rest %.0e \033[K", time,
                r->rest.left, r->rest.share);
    else if (r->follows)
        fprintf(stderr, "\r%.4g s simulated, until it is at rest \033[K", time);
    else
        fprintf(stderr, "\r%5.1f %%  %.4g s simulated, %.0f s to go \033[K", 100 * done, time,
                ceil(elapsed * (1 - done) / done));
    fflush(stderr);
    r->progress_at = elapsed;
}

static void clear_progress(run *r) {
    if (r->progress_at > 0) fputs("\r\033[K", stderr);
    r->progress_at = 0;
}

/* For the step clock. */
static bool look(void *context) {
    show_progress(context);
    return true;
}

static int fail(run *r, int status, const char *message) {
    clear_progress(r);
    return cli_complain(&cli_run, status, "%s", message);
}

/* ---- results ---------------------------------------------------------------------------- */

static int fail_by(run *r, const lar_error *error) {
    r->failure = error->status;
    clear_progress(r);
    return cli_refuse(&cli_run, error);
}

static int add_frame(run *r) {
    lar_error error;
    uint64_t step = lar_simulation_steps(r->simulation);
    if (!r->results || r->framed == step) return CLI_DONE;
    if (lar_results_add(r->results, r->simulation, &error)) return fail_by(r, &error);
    r->framed = step;
    r->frames++;
    return CLI_DONE;
}

/* The step nearest to the next frame, at least one ahead; the end when there are no more. */
static uint64_t next_frame(const run *r) {
    uint64_t now = lar_simulation_steps(r->simulation);
    if (r->interval <= 0) return r->last_step;
    double at = (double)r->next_frame * r->interval;
    double step = round(at / lar_simulation_time_step(r->simulation));
    if (step >= (double)r->last_step) return r->last_step;
    return (uint64_t)step > now ? (uint64_t)step : now + 1;
}

/* What a run leaves for the next one: its state, beside the frames. */
static int state_path(run *r, char path[PATH_SIZE]) {
    const char *slash = strrchr(r->settings.scene, '/');
    const char *name = slash ? slash + 1 : r->settings.scene, *dot = strrchr(name, '.');
    int length = snprintf(path, PATH_SIZE, "%s/%.*s.checkpoint", r->settings.out,
                          (int)(dot && dot > name ? (size_t)(dot - name) : strlen(name)), name);
    return length >= 0 && length < PATH_SIZE
               ? CLI_DONE
               : fail(r, CLI_FAILED, "the name of the folder for results is too long");
}

static int save_to(run *r, const char *path) {
    lar_error error;
    return lar_simulation_save(r->simulation, path, &error) ? fail_by(r, &error) : CLI_DONE;
}

/* Beside the frames, and where --save says. */
static int save_states(run *r) {
    char path[PATH_SIZE];
    int status = r->settings.out ? state_path(r, path) : CLI_DONE;
    if (r->settings.out && !status) status = save_to(r, path);
    int other = r->settings.save ? save_to(r, r->settings.save) : CLI_DONE;
    return status ? status : other;
}

static const char MAGIC[] = "LARIATCP"; /* what a checkpoint begins with */

/* What is no checkpoint is somebody's: saving will refuse to replace it. */
static bool is_checkpoint(const char *path) {
    char magic[8] = "";
    struct stat about;
    bool plain = stat(path, &about) == 0 && S_ISREG(about.st_mode); /* a pipe would wait */
    FILE *file = plain ? fopen(path, "rb") : NULL;
    bool is = file && fread(magic, sizeof magic, 1, file) == 1 && !memcmp(magic, MAGIC, 8);
    if (file) fclose(file);
    return is;
}

/* A run that ends early leaves no report and no state of an earlier one. The state that it goes on
 * from stays until there is another one. */
static int forget_earlier(run *r) {
    char state[PATH_SIZE], report[PATH_SIZE + 16];
    int status = state_path(r, state);
    if (status) return status;
    snprintf(report, sizeof report, "%s/run.json", r->settings.out);
    const char *path[2] = {report, state};
    for (int i = 0; i < 2; i++) {
        struct stat file, from;
        lar_error error;
        if (lar_file_replaceable(path[i], &error))
            return cli_complain(&cli_run, CLI_FAILED, "%s", error.message);
        if (path[i] == state && !is_checkpoint(state)) continue;
        if (r->settings.resume && stat(r->settings.resume, &from) == 0 &&
            stat(path[i], &file) == 0 && file.st_dev == from.st_dev && file.st_ino == from.st_ino)
            continue;
        if (unlink(path[i]) != 0 && errno != ENOENT)
            return cli_complain(&cli_run, CLI_FAILED,
                                "%s: is of an earlier run and cannot be removed: %s; check the "
                                "folder and its permissions, or choose another one",
                                path[i], strerror(errno));
    }
    return CLI_DONE;
}

/* Whether a state can be saved there: its file has a longer name first, as long as this. */
static int try_place(const char *path) {
    char trial[PATH_SIZE];
    int length = snprintf(trial, sizeof trial, "%s.%ld-XXXXXX", path, (long)getpid());
    int file = length < PATH_SIZE ? mkstemp(trial) : -1;
    if (file < 0) {
        const int cause = length < PATH_SIZE ? errno : ENAMETOOLONG;
        const char *usual = cause == ENAMETOOLONG ? "choose a shorter name"
                                                  : "check the folder and its permissions";
        return cli_complain(&cli_run, CLI_FAILED, "%s: cannot be written: %s; %s", path,
                            strerror(cause), lar_remedy(cause, usual));
    }
    close(file);
    unlink(trial);
    return CLI_DONE;
}

/* A long run must not end without its states for a reason that was there from the start. --save may
 * name a file in the folder of --out, which is made here. */
static int check_save(run *r) {
    const char *path = r->settings.save;
    char beside[PATH_SIZE];
    lar_error error;
    if ((path && lar_file_replaceable(path, &error)) ||
        (r->settings.out && lar_folder_make(r->settings.out, &error)) ||
        (path && lar_file_spare(path, MAGIC, "not a checkpoint", &error)))
        return cli_complain(&cli_run, CLI_FAILED, "%s", error.message);
    int status = path ? try_place(path) : CLI_DONE;
    if (status || !r->settings.out) return status;
    status = state_path(r, beside);
    return status ? status : try_place(beside);
}

static run_report report_of(const run *r) {
    return (run_report){.scene = r->settings.scene,
                        .model = r->model,
                        .element = cli_element_names[r->settings.element],
                        .interrupted = cli_stop_asked != 0,
                        .verify = r->settings.verify,
                        .parallel = &r->parallel,
                        .folder = r->settings.out,
                        .frames = r->frames,
                        .rest = r->follows ? &r->rest : NULL,
                        .simulation = r->simulation,
                        .began = r->began,
                        .clock = &r->clock,
                        .elapsed = r->elapsed,
                        .info = r->info};
}

static int write_run_json(run *r, const run_report *report) {
    char path[PATH_SIZE];
    lar_part_file out;
    lar_error error;
    int length = snprintf(path, sizeof path, "%s/run.json", r->settings.out);
    if (length < 0 || (size_t)length >= sizeof path)
        return fail(r, CLI_FAILED, "the name of the folder for results is too long");
    lar_status status = lar_part_open(&out, path, &error);
    if (!status) run_report_json(report, out.file);
    if (lar_part_close(&out, status) == LAR_OK) return CLI_DONE;
    return cli_complain(&cli_run, CLI_FAILED, "%s", error.message);
}

/* What was computed is told although something cannot be written; JSON only stands for success. */
static int report(run *r, int status) {
    run_report made = report_of(r);
    int written = r->settings.out ? write_run_json(r, &made) : CLI_DONE;
    if (!status) status = written;
    if (r->settings.json && !status)
        run_report_json(&made, stdout);
    else
        run_report_table(&made, r->settings.json ? stderr : stdout);
    return status;
}

/* ---- the run ---------------------------------------------------------------------------- */

static int report_failure(run *r, const lar_error *error) {
    int status = fail_by(r, error);
    if (!r->results || status != CLI_UNSTABLE) return status;
    if (add_frame(r) == CLI_DONE)
        cli_complain(&cli_run, status,
                     "the state of that moment is the last frame in %s, number %d", r->settings.out,
                     r->frames - 1);
    return status;
}

/* Up to the next frame or look, whichever comes first, or to the last step but one: what tools felt
 * is a mean over all steps of a stretch, and the report is about the last one. */
static int advance_stretch(run *r) {
    const lar_step_glance glance = {.every = 0.1, .look = look, .context = r};
    uint64_t now = lar_simulation_steps(r->simulation), frame = next_frame(r), stop = frame;
    lar_error error;
    if (r->follows && r->rest.next < stop) stop = r->rest.next;
    if (stop == r->last_step && stop > now + 1) stop--;
    if (lar_step_clock_advance(&r->clock, r->simulation, stop - now, &glance, &cli_stop_asked,
                               &error))
        return report_failure(r, &error);
    int status = CLI_DONE;
    if (r->interval > 0 && lar_simulation_steps(r->simulation) == frame) {
        status = add_frame(r);
        r->next_frame++;
    }
    if (r->follows) lar_rest_look(&r->rest, r->simulation);
    return status;
}

/* What the last step did shows in the next one: a state whose energy is no number is none to end
 * with. */
static int check_end(run *r) {
    lar_error error;
    lar_energy e;
    lar_simulation_energy(r->simulation, &e);
    if (isfinite(e.kinetic + e.strain + e.hourglass)) return CLI_DONE;
    uint64_t step = lar_simulation_steps(r->simulation);
    if (!lar_simulation_advance(r->simulation, 1, &error)) {
        error.status = LAR_ERROR_UNSTABLE;
        snprintf(error.message, sizeof error.message,
                 "unstable at step %" PRIu64 ": the energy is no number any more", step);
    }
    return fail_by(r, &error);
}

static int advance(run *r) {
    int status = r->interval > 0 ? add_frame(r) : CLI_DONE;
    if (r->interval > 0)
        r->next_frame = (int64_t)floor(lar_simulation_time(r->simulation) / r->interval + 1e-6) + 1;
    lar_step_clock_start(&r->clock, r->simulation, r->settings.realtime);
    while (!status && !cli_stop_asked && !(r->follows && r->rest.reached) &&
           lar_simulation_steps(r->simulation) < r->last_step)
        status = advance_stretch(r);
    r->elapsed = lar_step_clock_elapsed(&r->clock);
    clear_progress(r);
    if (!status) status = check_end(r);
    return status ? status : add_frame(r);
}

/* A run that was to end at rest and did not has no answer, only a last state. */
static int complain_restless(const run *r) {
    double time = lar_simulation_time(r->simulation);
    char left[64] = "its motion could not be judged yet", smaller[REST_REMEDY_SIZE];
    lar_contact_info contact;
    lar_energy now;
    lar_simulation_energy(r->simulation, &now);
    lar_simulation_contact(r->simulation, &contact);
    if (r->rest.looked && r->rest.kinetic > 1e6 * fabs(r->rest.strain))
        snprintf(left, sizeof left, "it moves, and next to nothing strains it");
    else if (r->rest.looked)
        snprintf(left, sizeof left, "its motion is still %.1e of the strain energy", r->rest.left);
    return cli_complain(&cli_run, CLI_RESTLESS,
                        "%s: not at rest after %.4g s, the limit of this run: %s, and at rest that "
                        "is below %.0e; %s",
                        r->settings.scene, time, left, r->rest.share,
                        rest_remedy(&r->rest, now.kinetic, lar_simulation_damping(r->simulation),
                                    lar_simulation_time_step(r->simulation), contact.touching > 0,
                                    smaller));
}

/* Of the scene's duration; a scene without one is open. */
static double time_left(const run *r) {
    double duration = lar_model_duration(r->model);
    if (duration > 0) return duration - lar_simulation_time(r->simulation);
    return r->interval > 0 ? r->interval : 1;
}

/* The step nearest to its time, as for frames. */
static int choose_time(run *r) {
    double time = r->settings.time;
    if (time <= 0) time = time_left(r);
    double step = lar_simulation_time_step(r->simulation), steps = round(time / step);
    if (r->first_step > 0 && steps < 1 && r->settings.time <= 0)
        return cli_complain(&cli_run, CLI_DONE,
                            "note: %s: %g s are simulated already, the scene's duration: nothing "
                            "is left to do; --time or --steps say how long to go on",
                            r->settings.resume, lar_simulation_time(r->simulation));
    if (steps > 1e15)
        return cli_complain(&cli_run, CLI_FAILED,
                            "%g s take %.3g steps of %.3g s; give a smaller --time or --steps",
                            time, steps, step);
    r->last_step = r->first_step + (uint64_t)fmax(1, steps);
    double done = fmax(1, steps) * step;
    if (r->settings.time > 0 && fabs(done - time) > 0.05 * time)
        cli_complain(&cli_run, CLI_DONE,
                     "note: %g s are no whole number of steps of %.4g s; the run is %.4g s long",
                     time, step, done);
    return CLI_DONE;
}

/* Where the run ends. */
static int choose_length(run *r) {
    const run_settings *settings = &r->settings;
    r->interval = lar_model_output_interval(r->model);
    r->first_step = lar_simulation_steps(r->simulation);
    r->last_step = r->first_step + (uint64_t)settings->steps;
    bool open = settings->steps == 0 && settings->time <= 0, any = open && !settings->verify;
    r->follows = settings->until_rest || (any && lar_model_until_rest(r->model));
    if (r->follows) lar_rest_begin(&r->rest, r->simulation);
    if (isinf(r->rest.since))
        return cli_complain(&cli_run, CLI_FAILED,
                            "%s: a wave or a curve comes again and again: leave out --until-rest",
                            settings->scene);
    if (r->follows && open) r->last_step = r->rest.limit;
    int status = r->last_step > r->first_step ? CLI_DONE : choose_time(r);
    r->rest.limit = r->last_step; /* --time and --steps are the most */
    return status;
}

static lar_options options_of(const run_settings *settings) {
    lar_options options = lar_options_default();
    options.element = (lar_element_kind)settings->element;
    options.isa = (lar_isa)settings->isa;
    options.time_step = settings->time_step;
    options.verify = settings->verify;
    cli_parallel_set(&settings->parallel, &options);
    return options;
}

/* By default as many processors as make it fastest, where it takes longer than to find out. */
static int choose_grid(run *r, lar_options *options) {
    const run_settings *s = &r->settings;
    double duration = lar_model_duration(r->model);
    const lar_grid_aim aim = {.tick = s->realtime ? CLI_TICK : 0,
                              .steps = (uint64_t)s->steps,
                              .seconds = s->steps > 0   ? 0
                                         : s->time > 0  ? s->time
                                         : duration > 0 ? duration
                                                        : 1};
    const lar_grid_aim open = {.tick = aim.tick}; /* until rest: who knows */
    bool follows = s->until_rest || lar_model_until_rest(r->model);
    return cli_choose_grid(&cli_run, &s->parallel, r->model, follows ? &open : &aim, options,
                           &r->choice);
}

/* The model, the processes, and this one's share of the simulation. */
static int prepare(run *r) {
    const run_settings *s = &r->settings;
    lar_options options = options_of(s);
    lar_error error;
    int status = cli_processes_begin(&cli_run, &s->parallel, s->argc, s->argv, &r->processes);
    if (!status) status = cli_open_model(&cli_run, s->scene, &r->model);
    if (!status) status = cli_resume_options(&cli_run, s->resume, r->model, &options);
    if (!status) status = choose_grid(r, &options);
    if (!status)
        status = cli_processes_start(&cli_run, r->processes, r->model, &options, &r->parallel);
    if (status) return status;
    r->parallel.reason = r->choice.reason;
    if (!lar_model_inspect(r->model, &r->info, &error) &&
        !lar_processes_create(r->processes, r->model, &options, &r->simulation, &error))
        return CLI_DONE;
    r->failure = error.status;
    return cli_complain_as_other(&cli_run, r->processes, &error);
}

/* The file is somebody's, by its name: it is not removed as results are, so it is said whose it is.
 */
static void tell_of_earlier_state(const run *r, int status) {
    const char *path = r->settings.save;
    bool resumed = path && r->settings.resume && strcmp(path, r->settings.resume) == 0;
    if (path && !resumed && access(path, F_OK) == 0)
        cli_complain(&cli_run, status, "%s stays as it was before this run", path);
}

/* What is to come to rest and goes by no damping gets that of its slowest motion, unless a file to
 * go on from or the scene says otherwise. */
static int damp(run *r) {
    lar_error error;
    double damping;
    if (!r->settings.until_rest || r->settings.resume) return CLI_DONE;
    if (lar_rest_damp(r->simulation, &damping, &error)) return fail_by(r, &error);
    if (damping > 0)
        cli_complain(&cli_run, CLI_DONE,
                     "note: %s names no damping; it is %.3g 1/s, as its slowest motion needs",
                     r->settings.scene, damping);
    return CLI_DONE;
}

static int open_results(run *r) {
    const run_settings *s = &r->settings;
    lar_error error;
    if (s->resume    ? lar_results_resume(s->out, r->simulation, s->surface, &r->results, &error)
        : s->surface ? lar_results_open_surface(s->out, r->simulation, &r->results, &error)
                     : lar_results_open(s->out, r->simulation, &r->results, &error))
        return cli_complain(&cli_run, CLI_FAILED, "%s", error.message);
    r->frames = lar_results_frames(r->results);
    if (r->frames == 0) return CLI_DONE;
    r->framed = lar_simulation_steps(r->simulation);
    return cli_complain(&cli_run, CLI_DONE, "note: %s: goes on behind its frames up to %g s",
                        s->out, lar_simulation_time(r->simulation));
}

static int compute(run *r) {
    lar_error error;
    cli_doubt_units(&cli_run, r->settings.scene, r->model, &r->info);
    if (r->settings.resume && lar_simulation_load(r->simulation, r->settings.resume, &error))
        return fail_by(r, &error);
    lar_simulation_energy(r->simulation, &r->began);
    if (check_save(r)) return CLI_FAILED;
    int status = damp(r);
    if (!status) status = choose_length(r);
    cli_catch_stop(); /* from here on there are results to end with */
    if (!status && r->settings.out) status = open_results(r);
    if (!status && r->settings.out) status = forget_earlier(r);
    if (!status) status = advance(r);
    if (lar_results_close(r->results, &error) && !status)
        status = cli_complain(&cli_run, CLI_FAILED, "%s", error.message);
    int saved = status ? status : save_states(r);
    if (saved) tell_of_earlier_state(r, saved);
    if (!status) status = report(r, saved);
    if (!status && cli_stop_asked) return CLI_INTERRUPTED;
    return !status && r->follows && !r->rest.reached ? complain_restless(r) : status;
}

/* Processor zero hears Ctrl-C too, and ends the run for all. */
static int serve(run *r) {
    lar_error error;
    cli_catch_stop_of_all(lar_processes_by_hand(r->processes));
    return lar_simulation_serve(r->simulation, &error) ? fail_by(r, &error) : CLI_DONE;
}

static int run_scene(const run_settings *settings) {
    static run r; /* too large for a small stack (ulimit -s) */
    r.settings = *settings;
    r.framed = UINT64_MAX;
    int status = prepare(&r);
    if (!status) status = lar_processes_self(r.processes) > 0 ? serve(&r) : compute(&r);
    bool failed = status && status != CLI_INTERRUPTED && status != CLI_RESTLESS;
    lar_simulation_destroy(r.simulation);
    lar_model_destroy(r.model);
    if (failed && !r.failure) r.failure = LAR_ERROR_IO;
    return cli_processes_end(&cli_run, r.processes, r.failure, status);
}

/* ---- the command line ------------------------------------------------------------------- */

static int check_settings(const run_settings *s) {
    if (s->time > 0 && s->steps > 0)
        return cli_complain(&cli_run, CLI_USAGE, "--time and --steps both say how long; give one");
    if (s->verify && s->until_rest)
        return cli_complain(&cli_run, CLI_USAGE,
                            "--verify moves nothing, so nothing comes to rest; give one of "
                            "--verify and --until-rest");
    if (s->verify && s->out)
        return cli_complain(&cli_run, CLI_USAGE,
                            "--verify moves nothing, there would be nothing to see in %s; leave "
                            "--out out",
                            s->out);
    return cli_parallel_check(&cli_run, &s->parallel);
}

static int run_main(int argc, char **argv) {
    run_settings s = {.parallel = CLI_PARALLEL_NONE, .argc = argc, .argv = argv};
    const cli_option options[] = {
        CLI_REAL("--time", "S",
                 "simulated seconds; without: the scene's duration,\nelse one output "
                 "interval, else 1",
                 &s.time, 1e-12, 1e9),
        CLI_COUNT("--steps", "N", "the same in steps", &s.steps, 1, 1e15),
        CLI_FLAG("--until-rest",
                 "until loads are constant and the body at rest; --time\nand --steps then are the "
                 "most; static decks and scenes\nwith duration: rest do so by themselves",
                 &s.until_rest),
        CLI_REAL("--time-step", "S",
                 "seconds, instead of the scene's; above the stable\nstep an "
                 "error",
                 &s.time_step, 1e-15, 1e3),
        CLI_CHOICE("--element", "NAME",
                   "hex8 (default), or the slow oracles hex8-full and\n"
                   "hex8-matrix",
                   &s.element, cli_element_names),
        CLI_CHOICE("--isa", "NAME",
                   "instruction set: auto (default), c, neon, avx2,\navx512; the "
                   "results are the same",
                   &s.isa, cli_isa_names),
        CLI_TEXT("--out", "DIR",
                 "write frames, .pvd, probes.csv, the last state\n(.checkpoint) and run.json there",
                 &s.out),
        CLI_FLAG("--surface", "with --out: the embedded surface in every frame, too", &s.surface),
        CLI_TEXT("--resume", "FILE",
                 "go on from a saved state of this scene (.checkpoint);\n--time and --steps count "
                 "from there",
                 &s.resume),
        CLI_TEXT("--save", "FILE", "save the last state there (.checkpoint), to go on from",
                 &s.save),
        CLI_FLAG("--realtime", "follow the wall clock, and count missed ticks", &s.realtime),
        CLI_PARALLEL(s.parallel),
        CLI_FLAG("--verify",
                 "steps verify that every force arrives everywhere\nonce, instead of moving "
                 "anything",
                 &s.verify),
        CLI_FLAG("--json", "the summary as one JSON object on standard output", &s.json),
        CLI_END};
    int status = cli_parse(&cli_run, options, argc, argv, &s.scene, 1);
    if (status >= 0) return status;
    status = check_settings(&s);
    return status ? status : run_scene(&s);
}

const cli_command cli_run = {
    .name = "run",
    .summary = "simulate a scene",
    .arguments = "SCENE",
    .description =
        "Simulates a scene (.yaml), a deck (.feb .inp) or a bare mesh, and ends with a summary.\n"
        "With --out the folder can be opened in ParaView while the run goes on. Ctrl-C ends a run\n"
        "with what there is (exit status 130); an unstable run ends with a message and its last\n"
        "state (exit status 3), one that was to come to rest and does not with status 4.",
    .examples = "  lariat run demo/uterus.yaml --out demo/results\n"
                "  lariat run demo/uterus.yaml --time 2 --realtime\n"
                "  lariat run demo/uterus.yaml --steps 1000 --json\n"
                "  lariat run demo/uterus.yaml --time 1 --save half.checkpoint\n"
                "  lariat run demo/uterus.yaml --resume half.checkpoint\n"
                "  lariat run demo/uterus.yaml --grid 2x1x1\n"
                "  lariat run demo/uterus.yaml --grid 2x2x1 --threads 2 --scheme local --comm shm\n"
                "  mpirun -n 4 lariat run demo/uterus.yaml --grid 2x2x1 --comm mpi\n"
                "  lariat run demo/uterus.yaml --steps 100 --element hex8-full\n",
    .main = run_main};
