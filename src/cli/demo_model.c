/* lariat demo-model: the demonstration organ on disk. */
#include <stdio.h>

#include "cli/commands.h"

static int demo_model_main(int argc, char **argv) {
    const cli_option options[] = {CLI_END};
    const char *folder;
    int status = cli_parse(&cli_demo_model, options, argc, argv, &folder, 1);
    if (status >= 0) return status;
    lar_error error;
    if (lar_demo_write(folder, &error))
        return cli_complain(&cli_demo_model, CLI_FAILED, "%s", error.message);
    printf("%s/uterus.yaml and %s/uterus.vtu are written. Try\n"
           "    lariat run %s/uterus.yaml --out %s/results\n",
           folder, folder, folder, folder);
    return CLI_DONE;
}

const cli_command cli_demo_model = {
    .name = "demo-model",
    .summary = "write the demonstration organ, a scene like any other",
    .arguments = "DIR",
    .description = "Writes DIR/uterus.yaml, a scene with comments, and its mesh DIR/uterus.vtu of\n"
                   "1840 hexahedra. The folder is made when it is missing.",
    .examples = "  lariat demo-model demo\n"
                "  lariat info demo/uterus.yaml\n"
                "  lariat run demo/uterus.yaml --out demo/results\n",
    .main = demo_model_main};
