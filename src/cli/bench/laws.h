/* lariat bench kernel --law. */
#ifndef LAR_CLI_BENCH_LAWS_H
#define LAR_CLI_BENCH_LAWS_H

#include "cli/bench/frame.h"

/* Measures what `words` name, or everything for "all", and prints. Returns the exit status. */
int bench_laws(bench_frame *frame, const lar_bench_kernel_options *wanted, const char *words);

#endif
