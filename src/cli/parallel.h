/* The options that divide a model among processors, the same for every command that computes with
 * them, and the processes behind. */
#ifndef LAR_CLI_PARALLEL_H
#define LAR_CLI_PARALLEL_H

#include "base/json/write.h"
#include "cli/commands.h"
#include "study/parallel.h"
#include "study/processes.h"

typedef struct cli_parallel {
    const char *grid, *distribution, *schedules, *master; /* NULL: not given */
    int64_t threads, delays;                              /* 0: not given */
    int64_t processor;                                    /* -1: not given */
    int scheme, channels, comm;                           /* -1: not given */
    bool pin, no_pin;
} cli_parallel;

#define CLI_PARALLEL_NONE                                                                          \
    { .processor = -1, .scheme = -1, .channels = -1, .comm = -1 }

extern const char *const cli_scheme_names[], *const cli_channel_names[], *const cli_comm_names[];

/* Rows of the table of options. */
#define CLI_PARALLEL(p)                                                                            \
    CLI_TEXT("--grid", "AxBxC",                                                                    \
             "divide the model among so many processors, e.g. 2x2x3;\n"                            \
             "auto, the default of run and view: measured, which is\nbest here",                   \
             &(p).grid),                                                                           \
        CLI_COUNT("--threads", "N", "of each processor (1)", &(p).threads, 1, 16),                 \
        CLI_CHOICE("--scheme", "NAME", "who sends to whom: all (default), local, one, two",        \
                   &(p).scheme, cli_scheme_names),                                                 \
        CLI_CHOICE("--channels", "NAME",                                                           \
                   "of --scheme local: sequential (default: x, then y,\nthen z) or concurrent",    \
                   &(p).channels, cli_channel_names),                                              \
        CLI_CHOICE("--comm", "NAME",                                                               \
                   "processors are threads (default), or processes that\ncommunicate by shm, "     \
                   "ucx, mpi or tcp; they are started\nhere, or by mpirun or srun",                \
                   &(p).comm, cli_comm_names),                                                     \
        CLI_TEXT("--distribution", "FILE",                                                         \
                 "which processor has which element: a file of lariat\npartition, or cut, "        \
                 "genetic, metis, random; without: cut,\nand anew where that becomes faster",      \
                 &(p).distribution),                                                               \
        CLI_TEXT("--schedules", "DIR",                                                             \
                 "the schedule files of lariat partition, instead of\nall of these but --comm",    \
                 &(p).schedules),                                                                  \
        CLI_COUNT("--delays", "SEED", "random delays, to see that nothing depends on them",        \
                  &(p).delays, 1, 9e15),                                                           \
        CLI_FLAG(                                                                                  \
            "--pin",                                                                               \
            "a core for every thread where there are enough\n(default where they take all cores)", \
            &(p).pin),                                                                             \
        CLI_FLAG("--no-pin", "leave it to the system which thread runs where", &(p).no_pin),       \
        CLI_COUNT("--processor", "K",                                                              \
                  "this process is processor K, 0 the one that reports;\nfor processors that are " \
                  "started by hand",                                                               \
                  &(p).processor, 0, 1023),                                                        \
        CLI_TEXT("--master", "HOST:PORT", "where processor 0 listens", &(p).master)

/* CLI_USAGE with a message when they do not belong together. */
int cli_parallel_check(const cli_command *command, const cli_parallel *parallel);

#define CLI_TICK 1e-3 /* of the clock that deadlines are kept by [s] */

/* Where no division was asked for, or --grid auto, one is chosen by measuring, into *choice and
 * the options; otherwise choice->reason is empty. */
int cli_choose_grid(const cli_command *command, const cli_parallel *parallel,
                    const lar_model *model, const lar_grid_aim *aim, lar_options *options,
                    lar_grid_choice *choice);
/* Why, where one was chosen. */
void cli_print_reason(const lar_parallel *parallel, FILE *out);
/* A line where the grid was divided anew under way. */
void cli_print_redivisions(const lar_simulation *simulation, FILE *out);
/* Who computes, and why so. */
void cli_write_parallel(lar_json *json, const lar_parallel *parallel);

/* Into the parallel part of the library's options. */
void cli_parallel_set(const cli_parallel *parallel, lar_options *options);

/* Who this process is: messages begin with that from now on. `argc` and `argv` are what stands
 * behind the command's name. */
int cli_processes_begin(const cli_command *command, const cli_parallel *parallel, int argc,
                        char **argv, lar_processes **processes);

/* Finds the division and starts the other processes. */
int cli_processes_start(const cli_command *command, lar_processes *processes,
                        const lar_model *model, const lar_options *options, lar_parallel *found);

/* Ends the processes; returns `status`, or a failure of theirs when it is CLI_DONE. `failure`: see
 * lar_processes_end. */
int cli_processes_end(const cli_command *command, lar_processes *processes, lar_status failure,
                      int status);

/* For a process other than processor zero: says why it failed, if it has to. */
int cli_complain_as_other(const cli_command *command, const lar_processes *processes,
                          const lar_error *error);

#endif
