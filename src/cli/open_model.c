#include <stdio.h>

#include "cli/commands.h"

const char *const cli_element_names[] = {"hex8", "hex8-full", "hex8-matrix", NULL};
const char *const cli_isa_names[] = {"auto", "c", "neon", "avx2", "avx512", NULL};

int cli_open_model(const cli_command *command, const char *path, lar_model **model) {
    lar_error error;
    if (lar_model_open(path, model, &error))
        return cli_complain(command, CLI_FAILED, "%s", error.message);
    for (int32_t i = 0; cli_speaker() == 0 && i < lar_model_notice_count(*model); i++)
        cli_complain(command, CLI_DONE, "note: %s", lar_model_notice_text(*model, i));
    return CLI_DONE;
}
