/* lariat bench kernel --sweep. */
#ifndef LAR_CLI_BENCH_SWEEP_H
#define LAR_CLI_BENCH_SWEEP_H

#include "cli/bench/frame.h"

/* Measures, prints, and writes the picture where there is a path. Returns the exit status. */
int bench_sweep(bench_frame *frame, int32_t elements, int repeat, const char *svg);

#endif
