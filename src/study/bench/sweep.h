/* The kernel over sizes, shapes and instruction sets, against what the machine allows: the roofline
 * of Williams, Waterman and Patterson (Communications of the ACM 52(4):65, 2009), made here.
 *
 *     Gflop/s |          ____________ peak: multiply-adds in registers
 *             |      o  /    o
 *             |        /  o             o: 816 operations in the time of an element
 *             |       / memory: bytes a second times operations a byte
 *             +------------------------ operations per byte
 *
 * Peak and bandwidth are measured in the same run as the kernel (peaks between its samples). An
 * element has as many bytes as a simulation keeps for it, read once in a step; models that fit into
 * a cache do better than memory allows.
 */
#ifndef LAR_STUDY_BENCH_SWEEP_H
#define LAR_STUDY_BENCH_SWEEP_H

#include "study/bench/kernel.h"

enum { LAR_SWEEP_SIZES = 5, LAR_SWEEP_ROWS = 50 };

/* Of rows: general elements whose numbers stand in memory, those whose numbers are made anew, and
 * boxes. */
typedef enum lar_sweep_shape {
    LAR_SWEEP_GENERAL,
    LAR_SWEEP_LEAN,
    LAR_SWEEP_BOX,
    LAR_SWEEP_SHAPES
} lar_sweep_shape;

extern const char *const lar_sweep_shape_name[LAR_SWEEP_SHAPES];

typedef struct lar_sweep_row {
    lar_bench_kernel_result kernel;
    lar_sweep_shape shape;
    double gflops;    /* 816 operations in the median time */
    double intensity; /* operations per byte */
    double roof;      /* what memory and peak allow [Gflop/s] */
} lar_sweep_row;

typedef struct lar_sweep_options {
    int32_t elements; /* the largest block; smaller ones of 500, 1840, 20,000, 200,000 */
    int repeat;       /* samples of each */
    /* Told before each row what it is; false from it ends the sweep. May be NULL. */
    bool (*callback)(void *context, const char *what);
    void *context;
} lar_sweep_options;

typedef struct lar_sweep_result {
    double bandwidth; /* of reading memory with one core [GB/s] */
    int rows;
    lar_sweep_row row[LAR_SWEEP_ROWS];
    int32_t left_out; /* the smallest size that half of the free memory does not hold; 0: none */
} lar_sweep_result;

/* Some seconds for each row. Instruction sets that this processor lacks are left out, and plain C
 * beyond 20,000 elements. Fails as lar_bench_kernel does. */
lar_status lar_bench_sweep(const lar_sweep_options *options, lar_sweep_result *result,
                           lar_error *error);

/* The picture, whole or not at all. */
lar_status lar_sweep_write_svg(const char *path, const lar_sweep_result *result, const char *cpu,
                               lar_error *error);

#endif
