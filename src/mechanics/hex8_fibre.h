/* The fibres' phases of the kernels (hex8_kernel.c): what they add to the stress of the law, and,
 * behind what relaxes, what is active. For kernels only.
 */
#ifndef LAR_MECHANICS_HEX8_FIBRE_H
#define LAR_MECHANICS_HEX8_FIBRE_H

#include "law/fibre_stress.h"

/* Some lanes of a block. Returns those that are beyond the limit; *stiffer, where it is not NULL,
 * becomes those to be looked at more closely. Of fibres that `spread` (law hgo) or do not. */
LAR_INLINE unsigned fibre_lanes(bool spread, const lar_fibre_block *block, int lane, int kind,
                                const lar_lane F[9], double limit, lar_lane P[9], lar_lane *length,
                                unsigned *stiffer) {
    lar_fibre_lane c;
    lar_lane stiff;
    for (int i = 0; i < 3; i++) c.direction[i] = lar_lane_load(&block->direction[i][lane]);
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        c.parameter[k] = lar_lane_load(&block->parameter[k][lane]);
    lar_lane size = spread ? lar_fibre_hgo_stress(F, &c, length, stiffer ? &stiff : NULL, P)
                           : lar_fibre_stress(kind, F, &c, length, stiffer ? &stiff : NULL, P);
    if (stiffer)
        *stiffer = ~lar_lane_not_greater(stiff, lar_lane_load(&block->limit[lane])) &
                   ((1U << LAR_LANES) - 1);
    return lar_lane_not_greater(lar_lane_set(limit), size);
}

/* `now` and `energy`: of these lanes (lar_active_step), or NULL. */
LAR_INLINE unsigned active_lanes(const lar_fibre_block *block, int lane, const lar_lane F[9],
                                 const double *now, double *energy, double limit, lar_lane P[9]) {
    lar_fibre_lane c;
    for (int i = 0; i < 3; i++) c.direction[i] = lar_lane_load(&block->direction[i][lane]);
    c.along = lar_lane_load(&block->along[lane]);
    c.across = lar_lane_load(&block->across[lane]);
    if (now) {
        lar_lane_store(energy, lar_active_potential(F, &c));
        c.along = c.along * lar_lane_load(now);
        c.across = c.across * lar_lane_load(now);
    }
    return lar_lane_not_greater(lar_lane_set(limit), lar_active_stress(F, &c, P));
}

#endif
