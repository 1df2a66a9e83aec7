/* What the parallel part of lar_options comes to for a model, before anything is divided: the grid
 * may stand in a distribution file, grid, threads and scheme in schedule files. Who starts
 * processes, or reports on a run, must know.
 */
#ifndef LAR_STUDY_PARALLEL_H
#define LAR_STUDY_PARALLEL_H

#include <stdbool.h>

#include "divide/grid.h"
#include "lariat.h"

typedef struct lar_parallel {
    bool divided; /* false: none of the options is given, one processor without a schedule */
    char grid[LAR_GRID_TEXT];
    int32_t processors, threads;
    const char *scheme; /* "all", ...; "none" when not divided */
    const char *channels;
    const char *comm;   /* "threads", ...; "none" when not divided */
    const char *reason; /* why this grid was chosen; empty: it was asked for */
} lar_parallel;

/* Fails for a grid that is none or has more processors than the model elements, for files that
 * cannot be read, and for a way to communicate that does not exist or that this build lacks. */
lar_status lar_parallel_find(const lar_model *model, const lar_options *options, lar_parallel *out,
                             lar_error *error);

/* Fails where LARIAT_GRID in the environment is no grid, nor auto, nor empty. */
lar_status lar_parallel_check_environment(lar_error *error);

#endif
