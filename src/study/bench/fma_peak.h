/* The most a core can compute: fused multiply-adds in registers and nothing else.
 *
 * The yardstick for the element kernel, measured in the same run on the same core. Compiled once
 * per instruction set, as the kernel itself. Twenty accumulators do not depend on each other:
 * more than latency times throughput (4 cycles x 2 units = 8) on every processor of today, and few
 * enough for the 32 registers of AVX-512 and NEON; AVX2 has 16 registers and takes twelve. Plain C
 * multiplies and adds where the compiler may not use the instruction.
 */
#ifndef LAR_STUDY_BENCH_FMA_PEAK_H
#define LAR_STUDY_BENCH_FMA_PEAK_H

#include <stdint.h>

typedef struct lar_fma_peak {
    const char *name; /* instruction set, as in LARIAT_ISA */
    int operations;   /* floating point operations per round, two per multiply-add and lane */
    /* Runs so many rounds; returns a number that depends on all of them. */
    double (*run)(uint64_t rounds);
} lar_fma_peak;

/* The loop of an instruction set by its name; NULL when this build does not have it. */
const lar_fma_peak *lar_fma_peak_find(const char *name);

#endif
