/* How long a step takes on the parallel computer, against the plain loop of one processor.
 *
 *     turn 1   plain | 1x1x1 | 2x1x1 by threads | 2x1x1 by shm | ...
 *     turn 2   plain | 1x1x1 | 2x1x1 by threads | 2x1x1 by shm | ...      --repeat turns
 *
 * Every sample makes its simulation anew, processes included, because where memory happens to lie
 * changes a time by some per cent; and all ways take turns, because a machine changes from minute
 * to minute. Medians of the samples compare.
 *
 *     a sample   create | warm up | section | section | ... | hash | destroy
 *
 * A sample is the median of sections of some milliseconds each, timed from within one advance, so
 * that neither waking threads nor gathering the state counts, nor a moment in which the system
 * does something else. All ways start from the same state and do the same steps: their state hash
 * at the end is the same, or the benchmark fails.
 *
 * The body is a scene, or the block of `lariat bench kernel` with every node moving: a body at
 * rest computes with denormal numbers until the motion has reached all of it.
 *
 * Processes are started for every sample. Under mpirun they are there already: rank 0 measures, the
 * others compute when it is their turn.
 */
#ifndef LAR_STUDY_BENCH_SCALING_H
#define LAR_STUDY_BENCH_SCALING_H

#include <stdbool.h>

#include "divide/grid.h"
#include "study/bench/kernel.h"

enum { LAR_BENCH_SCALING_ROWS = 64 };

typedef struct lar_bench_scaling_options {
    const lar_model *model;
    const char *processors;   /* "1,2": how many, in grids with the least communication; 1 is one
                                 processor with a schedule */
    const char *grids;        /* "2x1x1,1x2x1": instead; NULL: none */
    const char *threads;      /* "2,3": of one processor, not under mpirun; NULL: none */
    const char *comm;         /* "threads,shm": for two processors and more; NULL: these, and under
                                 mpirun mpi */
    const char *scheme;       /* as in lar_options, NULL: its default */
    const char *distribution; /* the same */
    bool pin;
    bool quick;                            /* few steps: whether it works, not how fast it is */
    int repeat;                            /* turns, 1..LAR_BENCH_REPEAT_MAX */
    const char *command;                   /* that a process is started with: "bench scaling" */
    const char *argument[2];               /* of it that say which model, NULL: fewer */
    void (*turn)(void *context, int turn); /* before each of them; may be NULL */
    void *context;
} lar_bench_scaling_options;

typedef struct lar_bench_scaling_row {
    char grid[LAR_GRID_TEXT]; /* "none": the plain loop */
    const char *comm;         /* "none", "threads", ... */
    int32_t processors, threads;
    const char *missing;     /* NULL, or why there are no figures */
    lar_spread microseconds; /* of a step */
    double over_plain;       /* medians */
    double speed_up;         /* 1 / over_plain */
    double efficiency;       /* speed_up by threads in all */
} lar_bench_scaling_row;

typedef struct lar_bench_scaling_result {
    lar_model_info info;
    const char *isa;
    int32_t cores;           /* that this process may use */
    bool pinned;             /* where cores suffice */
    uint64_t warm_up, steps; /* of a sample */
    int repeat;
    lar_spread core_to_core; /* of a word, one way, from turn to turn [ns]; 0: not measured */
    uint64_t hash;           /* after warm-up and steps, the same for all rows */
    int rows;                /* 0 at processes of mpirun other than the first; row 0 is plain */
    lar_bench_scaling_row row[LAR_BENCH_SCALING_ROWS];
} lar_bench_scaling_result;

lar_status lar_bench_scaling(const lar_bench_scaling_options *options,
                             lar_bench_scaling_result *result, lar_error *error);

/* A process that a sample has started: one grid, one way to communicate. */
lar_status lar_bench_scaling_serve(const lar_bench_scaling_options *options, int32_t processor,
                                   const char *master, lar_error *error);

/* The block of about so many elements, general, in motion. The caller destroys it. */
lar_status lar_bench_scaling_block(int32_t elements, lar_model **model, lar_error *error);

#endif
