/* What all benchmarks have in common: the head of their JSON, and the comparison with an earlier
 * run.
 *
 *     bench_frame frame = bench_frame_of(&cli_bench_kernel, "kernel");
 *     options: ..., BENCH_OPTIONS(frame), CLI_END        --against, --tolerance, --json
 *     lar_bench_set_text(&frame.report, "shape", ...)    what it was asked for
 *     bench_begin(&frame)                                load of the machine, the earlier run
 *     ... measure ...
 *     lar_bench_add(&frame.report, "ns", ...)            figures
 *     bench_open_json, own keys, bench_close_json        or a table of its own
 *     return bench_end(&frame)                           compares; the exit status
 */
#ifndef LAR_CLI_BENCH_FRAME_H
#define LAR_CLI_BENCH_FRAME_H

#include "base/json/write.h"
#include "cli/options.h"
#include "study/bench/baseline.h"
#include "study/bench/kernel.h"
#include "study/machine.h"

typedef struct bench_frame {
    const cli_command *command;
    const char *against; /* the earlier run's file; NULL: none */
    double tolerance;    /* [%]; below 0: not given */
    bool json;
    lar_machine machine;
    lar_baseline *baseline;
    lar_bench_report report;
} bench_frame;

#define BENCH_OPTIONS(frame)                                                                       \
    CLI_TEXT("--against", "FILE",                                                                  \
             "compare with an earlier run: a file that --json wrote;\nexit status 1 when a "       \
             "figure is worse",                                                                    \
             &(frame).against),                                                                    \
        CLI_REAL("--tolerance", "PERCENT", "by more than this (10)", &(frame).tolerance, 0, 1e6),  \
        CLI_FLAG("--json", "one JSON object on standard output", &(frame).json)

bench_frame bench_frame_of(const cli_command *command, const char *bench);

/* Reads the earlier run and looks whether it compares, before anything is measured. Returns the
 * exit status; messages are printed. */
int bench_begin(bench_frame *frame);

lar_json bench_open_json(const bench_frame *frame);
void bench_close_json(const bench_frame *frame, lar_json *json);

/* Prints the comparison where there is one, releases what the frame holds, and returns the exit
 * status. */
int bench_end(bench_frame *frame);
/* Releases it without; returns `status`. */
int bench_abandon(bench_frame *frame, int status);

/* Some samples, as an object. */
void bench_write_spread(lar_json *json, const char *name, const lar_spread *spread);

#endif
