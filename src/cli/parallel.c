#include "cli/parallel.h"

#include <stdio.h>
#include <string.h>

#include "base/pin.h"

const char *const cli_scheme_names[] = {"all", "local", "one", "two", NULL};
const char *const cli_channel_names[] = {"sequential", "concurrent", NULL};
const char *const cli_comm_names[] = {"threads", "shm", "ucx", "mpi", "tcp", NULL};

static bool is_divided(const cli_parallel *p) {
    return p->grid || p->distribution || p->schedules || p->threads > 0;
}

static int check_files(const cli_command *command, const cli_parallel *p) {
    if (p->schedules && (p->grid || p->distribution || p->threads || p->scheme >= 0))
        return cli_complain(command, CLI_USAGE,
                            "the schedules in %s have their own grid, distribution, threads and "
                            "scheme; leave --%s out",
                            p->schedules,
                            p->grid           ? "grid"
                            : p->distribution ? "distribution"
                            : p->threads      ? "threads"
                                              : "scheme");
    if (p->channels >= 0 && (p->scheme < 0 || strcmp(cli_scheme_names[p->scheme], "local") != 0))
        return cli_complain(command, CLI_USAGE, "--channels belongs to --scheme local");
    if (!is_divided(p) && (p->scheme >= 0 || p->delays > 0 || p->comm >= 0))
        return cli_complain(command, CLI_USAGE,
                            "--%s is for several processors; say how many, e.g. --grid 2x1x1",
                            p->scheme >= 0  ? "scheme"
                            : p->delays > 0 ? "delays"
                                            : "comm");
    return CLI_DONE;
}

static int check_processes(const cli_command *command, const cli_parallel *p) {
    const char *comm = p->comm < 0 ? "threads" : cli_comm_names[p->comm];
    if (p->processor >= 0 && strcmp(comm, "threads") == 0)
        return cli_complain(command, CLI_USAGE,
                            "--processor is for processors that are processes of their own; give "
                            "--comm tcp, shm or ucx");
    if (p->processor >= 0 && strcmp(comm, "mpi") == 0)
        return cli_complain(command, CLI_USAGE,
                            "with --comm mpi mpirun or srun says which processor this is; leave "
                            "--processor out");
    if (p->processor >= 0 && !p->master)
        return cli_complain(command, CLI_USAGE,
                            "--processor %d must know where processor 0 listens; give --master "
                            "HOST:PORT, the same to all",
                            (int)p->processor);
    if (p->master && p->processor < 0)
        return cli_complain(command, CLI_USAGE,
                            "--master is for processors that are started by hand; say which one "
                            "this is with --processor, or leave it out");
    if (p->pin && p->no_pin)
        return cli_complain(command, CLI_USAGE, "--pin and --no-pin contradict each other");
    return CLI_DONE;
}

int cli_parallel_check(const cli_command *command, const cli_parallel *p) {
    int status = check_processes(command, p);
    if (!status) status = check_files(command, p);
    if (!status && p->pin && lar_pin_cores() == 0)
        cli_complain(command, CLI_DONE,
                     "note: --pin has no effect, threads cannot be bound to cores here (lariat "
                     "doctor says how)");
    return status;
}

void cli_parallel_set(const cli_parallel *p, lar_options *options) {
    options->grid = p->grid;
    options->threads = (int32_t)p->threads;
    options->scheme = p->scheme < 0 ? NULL : cli_scheme_names[p->scheme];
    options->channels = p->channels < 0 ? NULL : cli_channel_names[p->channels];
    options->distribution = p->distribution;
    options->schedules = p->schedules;
    options->comm = p->comm < 0 ? NULL : cli_comm_names[p->comm];
    options->delays = (uint64_t)p->delays;
    options->pin = p->pin ? 1 : p->no_pin ? 0 : 2;
}

int cli_choose_grid(const cli_command *command, const cli_parallel *p, const lar_model *model,
                    const lar_grid_aim *aim, lar_options *options, lar_grid_choice *choice) {
    bool asked = p->grid && strcmp(p->grid, "auto") == 0;
    lar_error error;
    choice->reason[0] = '\0';
    if (!asked && (is_divided(p) || p->comm >= 0)) return CLI_DONE;
    options->grid = NULL;
    if (lar_grid_choose(model, options, aim, choice, &error)) return cli_refuse(command, &error);
    lar_grid_take(choice, options);
    return CLI_DONE;
}

void cli_print_reason(const lar_parallel *parallel, FILE *out) {
    if (parallel->reason[0])
        fprintf(out, "%-17s%s: %s\n", parallel->divided ? "" : "grid",
                parallel->divided ? "chosen" : parallel->grid, parallel->reason);
}

void cli_print_redivisions(const lar_simulation *simulation, FILE *out) {
    unsigned long long times = lar_simulation_redivisions(simulation);
    if (times > 0)
        fprintf(out,
                "%-17s%llu times, where elements had come to cost one processor more than others\n",
                "divided anew", times);
}

void cli_write_parallel(lar_json *json, const lar_parallel *parallel) {
    lar_json_text(json, "grid", parallel->grid);
    lar_json_text(json, "grid_reason", parallel->reason);
    lar_json_integer(json, "processors", parallel->processors);
    lar_json_integer(json, "threads", parallel->threads);
    lar_json_text(json, "scheme", parallel->scheme);
    lar_json_text(json, "comm", parallel->comm);
}

/* ---- processes ------------------------------------------------------------------------------ */

int cli_processes_begin(const cli_command *command, const cli_parallel *p, int argc, char **argv,
                        lar_processes **processes) {
    const lar_processes_setting setting = {.comm = p->comm < 0 ? NULL : cli_comm_names[p->comm],
                                           .processor = (int32_t)p->processor,
                                           .master = p->master,
                                           .command = command->name,
                                           .argument_count = argc,
                                           .argument = argv};
    lar_error error;
    if (lar_processes_begin(&setting, processes, &error)) return cli_refuse(command, &error);
    cli_speak_as(lar_processes_self(*processes));
    return CLI_DONE;
}

int cli_processes_start(const cli_command *command, lar_processes *processes,
                        const lar_model *model, const lar_options *options, lar_parallel *found) {
    lar_error error;
    if (lar_parallel_find(model, options, found, &error) ||
        lar_processes_start(processes, found->processors, &error))
        return cli_complain_as_other(command, processes, &error);
    return CLI_DONE;
}

int cli_processes_end(const cli_command *command, lar_processes *processes, lar_status failure,
                      int status) {
    lar_error error;
    if (!lar_processes_end(processes, failure, &error)) return status;
    cli_complain(command, CLI_FAILED, "%s", error.message);
    return status ? status : CLI_FAILED;
}

int cli_complain_as_other(const cli_command *command, const lar_processes *processes,
                          const lar_error *error) {
    if (lar_processes_interrupted(error) && lar_processes_has_parent(processes))
        return CLI_FAILED; /* processor zero says so */
    if (error->status != LAR_ERROR_PEER) lar_processes_hesitate(processes);
    return cli_refuse(command, error);
}
