/* The viscous phase of the kernels (hex8_kernel.c), behind that of the law: the stress of the law
 * becomes that of the material, and what the elements remember goes on by a step. For kernels only.
 *
 *     run of blocks      | block 0             | block 1             | ...
 *     beside it          | coefficients        | coefficients        | ...   lar_viscous_block
 *     in the state       | values [13 + 6 n][8]| values [13 + 6 n][8]| ...   law/viscosity.h
 */
#ifndef LAR_MECHANICS_VISCOUS_HEX8_VISCOUS_H
#define LAR_MECHANICS_VISCOUS_HEX8_VISCOUS_H

#include "law/viscous_stress.h"
#include "mechanics/hex8_gather.h"

/* Coefficients of some lanes. What the terms do in a step stays where the rates do, from one chunk
 * of a run to the next: the next lanes are mostly of the same material. */
typedef struct viscous_lane {
    lar_lane rate[LAR_VISCOUS_TERMS];
    lar_viscous_lane c;
} viscous_lane;

/* Of no material yet. */
LAR_INLINE void viscous_begin(viscous_lane *of) {
    *of = (viscous_lane){0};
    for (int i = 0; i < LAR_VISCOUS_TERMS; i++) of->rate[i] = lar_lane_set(-1);
}

__attribute__((noinline)) static void viscous_change(double length, int term, lar_lane rate,
                                                     viscous_lane *of) {
    of->rate[term] = rate;
    lar_viscous_fade(lar_lane_set(length), rate, &of->c.less[term], &of->c.rise[term]);
}

LAR_INLINE void viscous_load(const lar_viscous_block *block, int lane, int terms, double length,
                             viscous_lane *of) {
    for (int i = 0; i < terms; i++) {
        lar_lane rate = lar_lane_load(&block->term[i].rate[lane]), last = of->rate[i];
        unsigned same = lar_lane_not_greater(rate, last) & lar_lane_not_greater(last, rate);
        if (__builtin_expect(same != (1U << LAR_LANES) - 1, 0)) viscous_change(length, i, rate, of);
        of->c.share[i] = lar_lane_load(&block->term[i].share[lane]);
    }
    of->c.rest = lar_lane_load(&block->rest[lane]);
    of->c.unit = lar_lane_load(&block->unit[lane]);
    of->c.inverse = lar_lane_load(&block->inverse[lane]);
}

/* relax, with as many terms as are known when it is compiled. */
LAR_INLINE unsigned relax_terms(const lar_block_run *run, int terms, const lar_viscous_step *step,
                                int32_t b, size_t count, const lar_hex8_limits *limits,
                                lar_lane gradient[][9], viscous_lane *kept, lane_record *record) {
    double nowhere[LAR_HISTORY_MAX * LAR_BLOCK] __attribute__((aligned(64)));
    size_t size = (size_t)lar_history_values(terms) * LAR_BLOCK, part = 0;
    unsigned beyond = 0;
    viscous_lane of = *kept;
    for (size_t i = (size_t)b; i < (size_t)b + count; i++)
        for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES, part++) {
            double *before = step->history + i * size + lane;
            viscous_load(&run->relaxing[i], lane, terms, step->length, &of);
            lar_lane stress =
                lar_viscous_stress(gradient[part], &of.c, terms, run->isochoric, before,
                                   step->keep ? before : nowhere, LAR_BLOCK, record[part].F);
            beyond |= lar_lane_not_greater(lar_lane_set(limits->stress_square), stress)
                      << part * LAR_LANES;
        }
    *kept = of;
    return beyond;
}

/* Phase 2 goes on, for viscous materials: `gradient` is what the record held before the law. */
__attribute__((noinline)) static unsigned relax(const lar_block_run *run,
                                                const lar_viscous_step *step, int32_t b,
                                                size_t count, const lar_hex8_limits *limits,
                                                lar_lane gradient[][9], viscous_lane *of,
                                                lane_record *record) {
#if LAR_LANES > 1
    if (run->terms == 1) return relax_terms(run, 1, step, b, count, limits, gradient, of, record);
    if (run->terms == 2) return relax_terms(run, 2, step, b, count, limits, gradient, of, record);
#endif
    return relax_terms(run, run->terms, step, b, count, limits, gradient, of, record);
}

#endif
