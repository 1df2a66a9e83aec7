/* How a law stiffens whose shear is w(x), x = I1 J^(-2/3) - 3, for the stable step.
 *
 * The slope s = w' pulls all directions alike, as a shear modulus 2 s does. Along F itself, without
 * what changes the volume, there is 4 w'' J^(-4/3) D^2 more, D^2 = |F - I1/3 F^-T|^2.
 */
#ifndef LAR_LAW_FIRST_INVARIANT_H
#define LAR_LAW_FIRST_INVARIANT_H

#include "law/lane_math.h"

/* 4 w'' J^(-4/3) D^2 for `rise` = w''. */
LAR_INLINE lar_lane lar_first_invariant_further(lar_lane J, lar_lane I1, lar_lane area,
                                                lar_lane rise) {
    const lar_lane none = lar_lane_set(0), ninth = lar_lane_set(1.0 / 9);
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y;
    lar_lane D2 = I1 * y2 * (I1 * area * ninth / (J * J) - lar_lane_set(1)) * y2;
    return lar_lane_set(4) * lar_lane_max(rise, none) * lar_lane_max(D2, none);
}

/* Whether, with 8/3 w' = `shear` and that at rest, it is stiffer by `share` of what it is at rest:
 * lar_hex8_growth but for the volume term's own slope. */
LAR_INLINE unsigned lar_first_invariant_stiffened(lar_lane J, lar_lane area, lar_lane shear,
                                                  lar_lane further, lar_lane at_rest, lar_lane bulk,
                                                  lar_lane share) {
    lar_lane wider = area * lar_lane_set(1.0 / 3), longer = wider / (J * J);
    lar_lane stiffness = lar_lane_fma(shear, lar_lane_max(longer, lar_lane_set(1)), further);
    lar_lane max = (share + lar_lane_set(1)) * (at_rest + bulk);
    return ~lar_lane_not_greater(lar_lane_fma(bulk, wider, stiffness), max) &
           ((1U << LAR_LANES) - 1);
}

#endif
