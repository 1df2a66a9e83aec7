/* lariat requirements: what machine a model needs. */
#include <stdio.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/report/requirements.h"

/* NULL: it is over. */
static void show_progress(void *context, const char *what) {
    (void)context;
    fprintf(stderr, "\r%60s\r", "");
    if (what) fprintf(stderr, "counting and measuring: %s", what);
    fflush(stderr);
}

static int report_model(const char *path, lar_requirements_options *wanted, bool thesis,
                        bool json) {
    lar_model *model = NULL;
    int status = cli_open_model(&cli_requirements, path, &model);
    if (status) return status;
    if (isatty(STDERR_FILENO)) wanted->progress = show_progress;
    lar_requirements found = {.elements_max = 0};
    lar_model_info info;
    lar_error error;
    bool failed = lar_model_inspect(model, &info, &error) ||
                  lar_requirements_of(model, wanted, &found, &error);
    if (wanted->progress) wanted->progress(NULL, NULL);
    if (failed) {
        status = cli_refuse(&cli_requirements, &error);
    } else {
        const char *title = info.title[0] ? info.title : path;
        const requirements_report report = {title, &found, thesis || found.demonstration};
        if (json)
            requirements_write_json(&report);
        else
            requirements_print(&report);
    }
    lar_requirements_clear(&found);
    lar_model_destroy(model);
    return status;
}

static int report_thesis(const lar_requirements_options *wanted, bool json) {
    if (wanted->grid || wanted->distribution)
        return cli_complain(&cli_requirements, CLI_USAGE,
                            "--grid and --distribution divide a model; name one");
    lar_requirements thesis = {.quantities = lar_thesis_quantities()};
    if (wanted->iterations > 0) thesis.quantities.n_it = wanted->iterations;
    if (wanted->implicit_step > 0) thesis.quantities.step_im = wanted->implicit_step;
    const requirements_report report = {NULL, &thesis, true};
    if (json)
        requirements_write_json(&report);
    else
        requirements_print(&report);
    return CLI_DONE;
}

static int requirements_main(int argc, char **argv) {
    lar_requirements_options wanted = {0};
    bool thesis = false, no_speed = false, json = false;
    int64_t iterations = 0;
    const cli_option options[] = {
        CLI_TEXT("--grid", "AxBxC", "processors along x, y and z (3x2x2, the thesis's 12)",
                 &wanted.grid),
        CLI_TEXT("--distribution", "FILE",
                 "who has which element, a file of lariat partition;\nwithout it the model is cut",
                 &wanted.distribution),
        CLI_COUNT("--iterations", "N", "n_it of the implicit solver (100)", &iterations, 1, 1e9),
        CLI_REAL("--implicit-step", "S", "dt_im of the implicit method (0.02)",
                 &wanted.implicit_step, 1e-9, 1e6),
        CLI_FLAG("--thesis",
                 "the thesis's numbers beside the model's; without SCENE\nits quantities alone",
                 &thesis),
        CLI_FLAG("--no-speed", "measure nothing on this machine", &no_speed),
        CLI_FLAG("--json", "one JSON object on standard output", &json),
        CLI_END};
    const char *path = NULL;
    int status = cli_parse(&cli_requirements, options, argc, argv, &path, 1);
    if (status >= 0) return status;
    wanted.iterations = (double)iterations;
    wanted.measure = !no_speed;
    if (path) return report_model(path, &wanted, thesis, json);
    if (thesis) return report_thesis(&wanted, json);
    return cli_complain(&cli_requirements, CLI_USAGE,
                        "which model? Name a scene or a mesh, or say --thesis for the thesis's "
                        "own quantities");
}

const cli_command cli_requirements = {
    .name = "requirements",
    .summary = "tell what machine a model needs",
    .arguments = "[SCENE]",
    .description =
        "Operations and bytes per step and second for a model: by the formulas of the thesis's\n"
        "chapter 4 (its tables 4.1 to 4.4 and 3.1) for an implicit and three explicit methods,\n"
        "with quantities counted from the model; beside them what Lariat's kernels do, counted\n"
        "from their code, what real schedules send, and how many cores of this machine it takes,\n"
        "measured. Every table says which of the three it is. For the demonstration organ, and\n"
        "with --thesis, the thesis's numbers stand beside the others.",
    .examples = "  lariat requirements --thesis\n"
                "  lariat requirements demo/uterus.yaml\n"
                "  lariat requirements demo/uterus.yaml --grid 4x3x2 --no-speed --json\n"
                "  lariat requirements demo/uterus.yaml --distribution uterus.dist\n",
    .main = requirements_main};
