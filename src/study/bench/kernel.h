/* How fast a step is: whole steps of a free block, against the peak of the same core.
 *
 *     warm-up | steps  peak  steps  peak  steps  peak ...        --repeat samples of each
 *
 * The block has the wanted number of elements, near a cube: exact boxes, or with every node moved a
 * little by a fixed generator so that no element is a parallelepiped (the general case). Its
 * material is a nearly incompressible neo-Hookean one, with damping, and its nodes move smoothly.
 * A sample is some milliseconds of steps, the median of twenty sections; the median of the samples
 * counts, with the best and the worst beside it. The peak (fma_peak.h) is sampled in between,
 * because the clock rate of a core changes from second to second.
 *
 * An element counts as 816 floating point operations, the thesis's count for the formulation of
 * its algorithm 1, whatever this code really needs: the figures stay comparable.
 */
#ifndef LAR_STUDY_BENCH_KERNEL_H
#define LAR_STUDY_BENCH_KERNEL_H

#include <stdbool.h>

#include "model/material.h"

enum { LAR_BENCH_OPERATIONS = 816, LAR_BENCH_REPEAT_MAX = 1000 };

typedef struct lar_bench_kernel_options {
    int32_t elements;   /* about so many; exactly, when it is a product of three like numbers */
    bool general;       /* not boxes */
    const char *blocks; /* of LARIAT_BLOCKS: "auto", "lean" or "whole"; NULL: as it stands */
    lar_isa isa;
    int repeat; /* samples, 1..LAR_BENCH_REPEAT_MAX */
} lar_bench_kernel_options;

/* Least, median and greatest of the samples; below or at p25, p75 and p95 lie so many per cent of
 * them. */
typedef struct lar_spread {
    double min, median, max, p25, p75, p95;
} lar_spread;

/* Sorts the samples. */
lar_spread lar_spread_of(double *sample, int count);

typedef struct lar_bench_kernel_result {
    int32_t elements, nodes;
    int32_t edge[3]; /* elements along x, y, z */
    const char *isa;
    bool lean; /* its blocks (mechanics/hex8_block.h) */
    int repeat;
    uint64_t steps;         /* per sample */
    lar_spread nanoseconds; /* of a step per element */
    lar_spread peak_gflops;
    double fraction_of_peak; /* 816 operations in the median time, of the median peak */
    double bytes_per_element;
    double scaled_jacobian_min;
} lar_bench_kernel_result;

/* Makes the block, runs and measures it on the calling thread, for some tenths of a second. Fails
 * for options out of range, for want of memory, and for an instruction set that is not there. */
lar_status lar_bench_kernel(const lar_bench_kernel_options *options,
                            lar_bench_kernel_result *result, lar_error *error);

/* Refuses options out of range. */
lar_status lar_bench_check(const lar_bench_kernel_options *options, lar_error *error);

/* The block alone: edge[] elements along each axis. The caller destroys it. */
lar_status lar_bench_block(const int32_t edge[3], bool general, lar_model **model,
                           lar_error *error);
/* The same of another material, whose fibres cross in the plane y = 0. */
lar_status lar_bench_block_of(const int32_t edge[3], bool general, const lar_material *material,
                              lar_model **model, lar_error *error);
/* The neo-Hookean material of the block. */
lar_material lar_bench_material(void);

/* The block in its smooth motion, computed as the options say. The caller destroys it. */
lar_status lar_bench_start(const lar_model *model, const lar_bench_kernel_options *options,
                           lar_simulation **simulation, lar_error *error);
/* Seconds that `steps` steps take; they mean nothing when *status is not LAR_OK. */
double lar_bench_time(lar_simulation *simulation, uint64_t steps, lar_status *status,
                      lar_error *error);

/* Edges of a near-cubic block of about `elements` elements: exact when a division with edges not
 * more than 3 : 1 exists, else the nearest with edges not more than 2 : 1. */
void lar_bench_edges(int32_t elements, int32_t edge[3]);

#endif
