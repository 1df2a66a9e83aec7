/* The viscous phase of the kernels (hex8_kernel.c), behind that of the law: the stress of the law
 * becomes that of the material, and what the elements remember goes on by a step. For kernels only.
 *
 *     run of blocks      | block 0             | block 1             | ...
 *     beside it          | coefficients        | coefficients        | ...   lar_viscous_block
 *     in the state       | values [13 + 6 n][8]| values [13 + 6 n][8]| ...   law/viscosity.h
 */
#ifndef LAR_MECHANICS_HEX8_VISCOUS_H
#define LAR_MECHANICS_HEX8_VISCOUS_H

#include "law/viscous_stress.h"
#include "mechanics/hex8_gather.h"

/* What the terms of some lanes do in a step; what comes next is mostly of the same material. */
typedef struct viscous_fading {
    lar_lane rate[LAR_VISCOUS_TERMS], less[LAR_VISCOUS_TERMS], rise[LAR_VISCOUS_TERMS];
} viscous_fading;

/* Of no material yet. */
LAR_INLINE void fading_begin(viscous_fading *fading) {
    for (int i = 0; i < LAR_VISCOUS_TERMS; i++) {
        fading->rate[i] = lar_lane_set(-1);
        fading->less[i] = fading->rise[i] = lar_lane_set(0);
    }
}

__attribute__((noinline)) static void fading_change(double length, int term, lar_lane rate,
                                                    viscous_fading *fading) {
    fading->rate[term] = rate;
    lar_viscous_fade(lar_lane_set(length), rate, &fading->less[term], &fading->rise[term]);
}

LAR_INLINE void fading_of(const lar_viscous_block *block, int lane, int terms, double length,
                          viscous_fading *fading) {
    for (int i = 0; i < terms; i++) {
        lar_lane rate = lar_lane_load(&block->rate[i][lane]), last = fading->rate[i];
        unsigned same = lar_lane_not_greater(rate, last) & lar_lane_not_greater(last, rate);
        if (__builtin_expect(same != (1U << LAR_LANES) - 1, 0))
            fading_change(length, i, rate, fading);
    }
}

/* Some lanes of a block. Returns those that are beyond the limit. */
LAR_INLINE unsigned viscous_lanes(const lar_viscous_block *block, int lane, int terms,
                                  bool isochoric, const viscous_fading *fading,
                                  const double *before, double *after, const lar_lane F[9],
                                  double limit, lar_lane P[9]) {
    lar_viscous_lane c = {.rest = lar_lane_load(&block->rest[lane]),
                          .unit = lar_lane_load(&block->unit[lane]),
                          .inverse = lar_lane_load(&block->inverse[lane])};
    for (int i = 0; i < terms; i++) {
        c.share[i] = lar_lane_load(&block->share[i][lane]);
        c.less[i] = fading->less[i];
        c.rise[i] = fading->rise[i];
    }
    lar_lane size =
        lar_viscous_stress(F, &c, terms, isochoric, before + lane, after + lane, LAR_BLOCK, P);
    return lar_lane_not_greater(lar_lane_set(limit), size);
}

/* relax, with as many terms as are known when it is compiled. */
LAR_INLINE unsigned relax_terms(const lar_block_run *run, int terms, const lar_viscous_step *step,
                                int32_t b, size_t count, const lar_hex8_limits *limits,
                                lar_lane gradient[][9], lane_record *record) {
    double nowhere[LAR_HISTORY_MAX * LAR_BLOCK] __attribute__((aligned(64)));
    size_t size = (size_t)lar_history_values(terms) * LAR_BLOCK, part = 0;
    unsigned beyond = 0;
    viscous_fading fading;
    fading_begin(&fading);
    for (size_t i = (size_t)b; i < (size_t)b + count; i++)
        for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES, part++) {
            const lar_viscous_block *block = &run->relaxing[i];
            double *history = step->history + i * size;
            fading_of(block, lane, terms, step->length, &fading);
            beyond |= viscous_lanes(block, lane, terms, run->isochoric, &fading, history,
                                    step->keep ? history : nowhere, gradient[part],
                                    limits->stress_square, record[part].F)
                      << part * LAR_LANES;
        }
    return beyond;
}

/* Phase 2 goes on, for viscous materials: `gradient` is what the record held before the law. */
__attribute__((noinline)) static unsigned relax(const lar_block_run *run,
                                                const lar_viscous_step *step, int32_t b,
                                                size_t count, const lar_hex8_limits *limits,
                                                lar_lane gradient[][9], lane_record *record) {
#if LAR_LANES > 1
    if (run->terms == 1) return relax_terms(run, 1, step, b, count, limits, gradient, record);
    if (run->terms == 2) return relax_terms(run, 2, step, b, count, limits, gradient, record);
#endif
    return relax_terms(run, run->terms, step, b, count, limits, gradient, record);
}

#endif
