/* What reports say of mass that is added for the sake of the time step. */
#ifndef LAR_CLI_REPORT_MASS_SCALING_H
#define LAR_CLI_REPORT_MASS_SCALING_H

#include <stdio.h>

#include "base/json/write.h"
#include "lariat.h"

/* The object `mass_scaling`: docs/cli.md. */
void cli_write_mass_scaling(lar_json *json, const lar_model *model, const lar_mass_scaling *m);
/* Nothing where the scene asks for none, unless the caller `offers` it. */
/* The keys of what strained elements have more, and their line; nothing where they may not. */
void cli_write_heavier(lar_json *json, const lar_simulation *simulation);
void cli_print_heavier(const lar_simulation *simulation, FILE *out);
void cli_print_mass_scaling(const lar_model *model, const lar_mass_scaling *m, bool offers,
                            FILE *out);

#endif
