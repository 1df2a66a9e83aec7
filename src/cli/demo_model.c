/* lariat demo-model: the demonstration organ on disk. */
#include <stdio.h>

#include "cli/commands.h"
#include "study/demo.h"

static int demo_model_main(int argc, char **argv) {
    bool force = false;
    const char *folder, *kept[LAR_DEMO_KEPT_MAX];
    const cli_option options[] = {
        CLI_FLAG("--force", "replace scenes that are there and differ", &force), CLI_END};
    int status = cli_parse(&cli_demo_model, options, argc, argv, &folder, 1);
    if (status >= 0) return status;
    lar_error error;
    if (lar_demo_write_or_keep(folder, force, kept, &error))
        return cli_complain(&cli_demo_model, CLI_FAILED, "%s", error.message);
    for (int i = 0; kept[i]; i++)
        cli_complain(&cli_demo_model, CLI_DONE,
                     "note: %s/%s is there already and differs from the demonstration's; it is "
                     "left as it is (--force replaces it)",
                     folder, kept[i]);
    /* Too large for a small stack (ulimit -s). */
    static char scene[CLI_QUOTED], results[CLI_QUOTED], quoted[2][CLI_QUOTED];
    snprintf(scene, sizeof scene, "%s/uterus.yaml", folder);
    snprintf(results, sizeof results, "%s/results", folder);
    printf("%s, uterus_live.yaml and uterus.vtu are there. Try\n"
           "    lariat run %s --out %s\n",
           scene, cli_quote(scene, quoted[0], CLI_QUOTED),
           cli_quote(results, quoted[1], CLI_QUOTED));
    return CLI_DONE;
}

const cli_command cli_demo_model = {
    .name = "demo-model",
    .summary = "write the demonstration organ, a scene like any other",
    .arguments = "DIR",
    .description =
        "Writes a mesh of 1840 hexahedra, DIR/uterus.vtu, and two scenes with comments:\n"
        "in DIR/uterus.yaml a force pulls the organ, in DIR/uterus_live.yaml a person\n"
        "does. The folder is made when it is missing. A scene that is there already and\n"
        "differs, as after an edit, is left as it is; the mesh is written.",
    .examples = "  lariat demo-model demo\n"
                "  lariat info demo/uterus.yaml\n"
                "  lariat run demo/uterus.yaml --out demo/results\n",
    .main = demo_model_main};
