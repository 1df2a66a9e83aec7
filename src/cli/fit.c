/* lariat fit: parameters of tissue from experiments. */
#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "cli/commands.h"
#include "cli/report/fit.h"
#include "cli/report/profile.h"
#include "cli/stop.h"
#include "study/inverse/json.h"
#include "study/inverse/output.h"

enum { PATH_SIZE = 4096 };

/* ---- progress -------------------------------------------------------------------------------- */

/* Told after every evaluation, on a terminal. */
static void show_progress(void *context, const lar_inverse_progress *p) {
    char left[48] = "";
    (void)context;
    if (p->remaining >= 0) snprintf(left, sizeof left, ", some %.0f s to go", ceil(p->remaining));
    fprintf(stderr, "\r%s: residual %.4g, %d simulations%s \033[K", p->doing, p->residual, p->runs,
            left);
    fflush(stderr);
}

/* The same for a program that reads along: a line for each. It ends with a program that has closed
 * its end of the pipe (SIGPIPE). */
static void write_progress(void *context, const lar_inverse_progress *p) {
    char left[32] = "null", residual[32] = "null";
    (void)context;
    if (p->remaining >= 0) snprintf(left, sizeof left, "%.6g", p->remaining);
    if (isfinite(p->residual)) snprintf(residual, sizeof residual, "%.17g", p->residual);
    fprintf(stderr, "{\"doing\": \"%s\", \"residual\": %s, \"runs\": %d, \"remaining\": %s}\n",
            p->doing, residual, p->runs, left);
    fflush(stderr);
}

/* ---- the command ----------------------------------------------------------------------------- */

/* `lines`: also the kind of failure in a word, for whoever reads the lines of progress. */
static int complain(const lar_error *error, bool lines) {
    static const char *const word[] = {
        "", "argument", "io", "format", "model", "unsupported", "memory", "unstable", "peer"};
    if (lines && error->status > LAR_OK && error->status <= LAR_ERROR_PEER)
        fprintf(stderr, "{\"failed\": \"%s\"}\n", word[error->status]);
    return cli_complain(&cli_fit, error->status == LAR_ERROR_UNSTABLE ? CLI_UNSTABLE : CLI_FAILED,
                        "%s", error->message);
}

static int fit(const lar_inverse_problem *problem, const char *folder, bool json, bool lines) {
    lar_inverse_result result;
    lar_error error = {0}, full = {0};
    const bool terminal = !lines && isatty(STDERR_FILENO);
    const lar_inverse_options options = {.stop = &cli_stop_asked,
                                         .progress = lines      ? write_progress
                                                     : terminal ? show_progress
                                                                : NULL};
    cli_catch_stop();
    lar_status failed = lar_inverse_solve(problem, &options, &result, &error);
    if (terminal) fputs("\r\033[K", stderr);
    int status = CLI_DONE;
    if (failed && cli_stop_asked)
        status =
            cli_complain(&cli_fit, CLI_INTERRUPTED,
                         "interrupted before the first guess was computed: there is no answer");
    else if (failed)
        status = complain(&error, lines);
    if (!status && folder && lar_inverse_write_folder(folder, problem, &result, &full))
        status = complain(&full, lines);
    /* What took long is told also where the disk is full. */
    if (!failed && !status && json) lar_inverse_json(problem, &result, stdout);
    if (!failed && (status || !json)) fit_report_table(problem, &result, json ? stderr : stdout);
    if (!status && result.interrupted)
        status = cli_complain(&cli_fit, CLI_INTERRUPTED,
                              "interrupted: these are the best values so far, without intervals");
    lar_inverse_result_clear(&result);
    return status;
}

/* ---- profiles from frames -------------------------------------------------------------------- */

static lar_status write_profiles(const lar_profiles *p, const char *folder, lar_error *error) {
    char path[PATH_SIZE];
    lar_status status = lar_folder_make(folder, error);
    snprintf(path, sizeof path, "%.3900s/profiles.csv", folder);
    if (!status) status = lar_profiles_write(p, path, error);
    snprintf(path, sizeof path, "%.3900s/profiles.svg", folder);
    return status ? status : lar_profiles_draw(p, path, error);
}

static int measure(const char *film, const char *view, const char *folder, bool json, bool lines) {
    lar_profiles profiles = {0};
    lar_error error = {0};
    int status = CLI_DONE;
    cli_catch_stop();
    lar_status failed = lar_profiles_read(film, view, &cli_stop_asked, &profiles, &error);
    if (!failed && !json) profile_report_table(&profiles, stdout);
    if (!failed && folder) failed = write_profiles(&profiles, folder, &error);
    if (failed && cli_stop_asked)
        status = cli_complain(&cli_fit, CLI_INTERRUPTED, "%s", error.message);
    else if (failed)
        status = complain(&error, lines);
    else if (json)
        profile_report_json(&profiles, stdout);
    lar_profiles_clear(&profiles);
    return status;
}

static int fit_main(int argc, char **argv) {
    const char *path = NULL, *folder = NULL, *film = NULL;
    bool json = false, lines = false;
    const cli_option options[] = {
        CLI_TEXT("--profile", "FRAMES",
                 "measure instead of fitting: FRAMES are side views of tissue in a\ntube, a folder "
                 "(.png, .pgm) or a list (.txt), EXPERIMENT is the\nfile of the view (.yaml)",
                 &film),
        CLI_TEXT("--out", "DIR",
                 "write tissue files for scenes (.tissue.yaml), pictures of\nmeasurement and model "
                 "(.svg) and fit.json there; with --profile\nprofiles.csv, which an aspiration "
                 "reads, and its picture",
                 &folder),
        CLI_FLAG("--progress",
                 "a line of JSON on standard error after every simulation:\ndoing, residual, runs, "
                 "remaining (s); after a failure one with its kind",
                 &lines),
        CLI_FLAG("--json", "the answer as one JSON object on standard output", &json), CLI_END};
    int status = cli_parse(&cli_fit, options, argc, argv, &path, 1);
    if (status >= 0) return status;
    if (film) return measure(film, path, folder, json, lines);
    lar_inverse_problem problem = {0};
    lar_error error = {0};
    if (!lar_inverse_available())
        lar_fail(&error, LAR_ERROR_UNSUPPORTED,
                 "this program was built without cminpack, which fits need; apt-get install "
                 "libcminpack-dev, then make");
    if (error.status || lar_inverse_problem_read(path, &problem, &error) ||
        (folder && lar_folder_make(folder, &error)))
        status = complain(&error, lines);
    else
        status = fit(&problem, folder, json, lines);
    lar_inverse_problem_clear(&problem);
    return status;
}

const cli_command cli_fit = {
    .name = "fit",
    .summary = "find parameters of tissue from experiments",
    .arguments = "EXPERIMENT",
    .description =
        "Finds parameters of materials so that simulations answer as experiments did (tension,\n"
        "compression, indentation, aspiration, markers, deformed surfaces), by least squares:\n"
        "values, 95 % intervals, which parameters the data cannot tell, and whether what is left\n"
        "is chance.\n"
        "EXPERIMENT is a file (.yaml) that names scenes, tables of measured numbers (.csv) and\n"
        "the free parameters. Simulations go on all cores. Ctrl-C ends a fit with the best so\n"
        "far (exit status 130).\n"
        "With --profile it measures: frames of a camera become the profiles of an aspiration.",
    .examples = "  lariat fit examples/fit_tension.yaml\n"
                "  lariat fit examples/fit_tension.yaml --out fitted\n"
                "  lariat fit examples/fit_tension.yaml --json\n"
                "  lariat fit --profile frames view.yaml --out measured\n",
    .main = fit_main};
