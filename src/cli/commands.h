/* The commands, one file each, and what they share. */
#ifndef LAR_CLI_COMMANDS_H
#define LAR_CLI_COMMANDS_H

#include <stdio.h>

#include "cli/options.h"
#include "lariat.h"

extern const cli_command cli_info, cli_run, cli_verify, cli_partition, cli_demo_model, cli_bench,
    cli_device, cli_view, cli_replay, cli_mesh, cli_bench_kernel, cli_bench_comm, cli_bench_scaling,
    cli_bench_step, cli_bench_jitter, cli_bench_precision, cli_bench_implicit, cli_requirements,
    cli_predict, cli_fit, cli_doctor, cli_help;

/* All commands in the order in which they are listed, and the benchmarks, whose names begin with
 * "bench "; NULL ends them. */
extern const cli_command *const cli_commands[], *const cli_benchmarks[];

/* What `lariat --help` prints. */
void cli_print_overview(FILE *out);

/* There is no command `name`; prints what was probably meant and returns the exit status. */
int cli_unknown_command(const char *name);

/* Prints a message of the library and returns the exit status that it stands for: what the command
 * line asked for and cannot be is wrong usage. */
int cli_refuse(const cli_command *command, const lar_error *error);

/* Opens a model and prints its notices to standard error. Returns the exit status; messages are
 * printed. */
int cli_open_model(const cli_command *command, const char *path, lar_model **model);

/* Says on standard error when a model, read from `path`, is as long or as short as no organ is, or
 * of a material as light, heavy, soft or hard as there is none. */
void cli_doubt_units(const cli_command *command, const char *path, const lar_model *model,
                     const lar_model_info *info);

/* Into the options what a saved state was made with, as far as they leave it open: kind of
 * elements, time step, hands. `path` NULL: nothing. */
int cli_resume_options(const cli_command *command, const char *path, const lar_model *model,
                       lar_options *options);

/* Names of --element and --isa, in the order of lar_element_kind and lar_isa. */
extern const char *const cli_element_names[], *const cli_isa_names[];

#endif
