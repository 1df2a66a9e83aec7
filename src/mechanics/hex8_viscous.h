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

/* Some lanes of a block. Returns those that are beyond the limit. */
LAR_INLINE unsigned viscous_lanes(const lar_viscous_block *block, int lane, int terms,
                                  bool isochoric, const lar_viscous_step *step, double *values,
                                  const lar_lane F[9], double limit, lar_lane P[9]) {
    lar_viscous_lane c = {.rest = lar_lane_load(&block->rest[lane]),
                          .unit = lar_lane_load(&block->unit[lane]),
                          .inverse = lar_lane_load(&block->inverse[lane])};
    lar_lane history[LAR_HISTORY_MAX];
    int count = lar_history_values(terms);
    for (int i = 0; i < terms; i++) {
        c.share[i] = lar_lane_load(&block->share[i][lane]);
        c.rate[i] = lar_lane_load(&block->rate[i][lane]);
    }
    for (int k = 0; k < count; k++) history[k] = lar_lane_load(values + LAR_BLOCK * k + lane);
    lar_lane size =
        lar_viscous_stress(F, &c, terms, isochoric, lar_lane_set(step->length), history, P);
    for (int k = 0; step->keep && k < count; k++)
        lar_lane_store(values + LAR_BLOCK * k + lane, history[k]);
    return lar_lane_not_greater(lar_lane_set(limit), size);
}

#endif
