/* Inside the scaling benchmark: which ways to compute stand side by side. */
#ifndef LAR_STUDY_BENCH_SCALING_ROWS_H
#define LAR_STUDY_BENCH_SCALING_ROWS_H

#include "study/bench/scaling.h"

/* Rows of the result, without figures, row 0 the plain loop. `launched`: processes that mpirun has
 * started, 1: none. Fails for lists that are none, and for grids that do not fit the model. */
lar_status lar_scaling_rows(const lar_bench_scaling_options *options, int32_t launched,
                            lar_bench_scaling_result *result, lar_error *error);

/* Whether the processors of a row are processes. */
bool lar_scaling_by_processes(const lar_bench_scaling_row *row);

#endif
