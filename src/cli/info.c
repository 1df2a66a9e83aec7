/* lariat info: what a model holds, before it is run. */
#include "cli/commands.h"
#include "cli/report/info.h"

static int inspect(info_report *report, const char *against, double scale) {
    lar_error error;
    if (lar_model_inspect(report->model, &report->info, &error) ||
        lar_model_quality(report->model, against, scale, &report->quality, &error))
        return cli_complain(&cli_info, CLI_FAILED, "%s", error.message);
    if (report->timed) report->speed = cli_measure_speed(report->model);
    return CLI_DONE;
}

static int info_main(int argc, char **argv) {
    bool json = false, untimed = false;
    const char *against = NULL, *path;
    double scale = 0;
    const cli_option options[] = {
        CLI_TEXT("--against", "FILE",
                 "compare with a surface (.stl .obj .vtk .vtp), instead\nof the model's "
                 "embedded surface",
                 &against),
        CLI_REAL("--scale", "S", "of that surface: metres per unit of the file (1)", &scale, 1e-9,
                 1e9),
        CLI_FLAG("--no-speed", "do not measure how fast it runs here", &untimed),
        CLI_FLAG("--json", "one JSON object on standard output", &json), CLI_END};
    int status = cli_parse(&cli_info, options, argc, argv, &path, 1);
    if (status >= 0) return status;
    if (scale > 0 && !against)
        return cli_complain(&cli_info, CLI_USAGE,
                            "--scale is that of the surface --against; a mesh is scaled by a "
                            "scene, with scale:");
    lar_model *model = NULL;
    status = cli_open_model(&cli_info, path, &model);
    if (status) return status;
    info_report report = {.path = path, .model = model, .timed = !untimed};
    status = inspect(&report, against, scale > 0 ? scale : 1);
    if (!status && json) info_report_json(&report);
    if (!status && !json) info_report_table(&report);
    if (!status) cli_doubt_units(&cli_info, path, model, &report.info);
    lar_model_destroy(model);
    return status;
}

const cli_command cli_info = {
    .name = "info",
    .summary = "what a scene or a mesh holds",
    .arguments = "FILE",
    .description =
        "Reads a scene (.yaml), a deck (.feb .inp) or a mesh (.vtu .vtk .msh .inp) and\n"
        "prints sizes, materials, sets, mesh quality, the time step and how fast it runs on\n"
        "one core of this machine. A bare mesh is taken to be in metres and gets a soft\n"
        "default material. What the file asks for and Lariat does not do is named on\n"
        "standard error.",
    .examples = "  lariat info demo/uterus.yaml\n"
                "  lariat info liver.vtk --json\n"
                "  lariat info liver.vtu --against liver.stl --scale 0.001\n",
    .main = info_main};
