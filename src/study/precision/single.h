/* The hex8 kernels in single precision, for the study of what that loses
 * (study/precision/precision.h): the same source, hex8_kernel.c, compiled with floats
 * (single_kernel.c). Production has none of it.
 *
 *     state in double    relative displacements of an element's nodes are formed in double, then
 *                        rounded; everything of the element is float
 *     state in single    displacements are rounded first, then the relative ones are formed
 *
 * Blocks have 16 elements, two of hex8_block.h beside each other, so that AVX-512 has 16 lanes.
 * Modal forces are rounded to the 64-bit integers of production; sums at nodes are the same.
 */
#ifndef LAR_STUDY_PRECISION_SINGLE_H
#define LAR_STUDY_PRECISION_SINGLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LAR_SINGLE_BLOCK = 16 };

/* lar_block_head, lar_hex8_block and lar_box_block of hex8_block.h, in float. */
typedef struct lar_single_head {
    float modulus[3][LAR_SINGLE_BLOCK];
    float stiffness[4][LAR_SINGLE_BLOCK];
    int32_t node[8][LAR_SINGLE_BLOCK];
} __attribute__((aligned(64))) lar_single_head;

typedef struct lar_single_general {
    lar_single_head head;
    float gradient[6][3][LAR_SINGLE_BLOCK];
    float shape[4][3][LAR_SINGLE_BLOCK];
} lar_single_general;

typedef struct lar_single_box {
    lar_single_head head;
    float gradient[3][LAR_SINGLE_BLOCK];
} lar_single_box;

typedef struct lar_single_more {
    float modulus[4][LAR_SINGLE_BLOCK];
} __attribute__((aligned(64))) lar_single_more;

/* A run of such blocks; law, shape and rows as numbers of hex8_block.h and material.h. */
typedef struct lar_single_run {
    int law, shape, rows, turn;
    int32_t count;
    size_t axis_stride;
    const void *blocks;
    const lar_single_more *more; /* NULL when the law has no more parameters */
} lar_single_run;

typedef struct lar_single_kernels {
    const char *name; /* as in LARIAT_ISA */
    int lanes;
    /* Adds the forces for `u` to `force`, both [3][axis_stride]; `u` is rounded
     * on the way where the state is single. Nothing is watched. */
    void (*recover)(const lar_single_run *run, const double *u, int64_t *force);
} lar_single_kernels;

/* By instruction set and by whether the state is single: c and avx512, else NULL. */
const lar_single_kernels *lar_single_kernels_find(const char *isa, bool single_state);

#endif
