/* The thesis's law, in reduced invariants (T eq. 1.1; Sussman and Bathe 1987), G = 2 mu, K = kappa:
 *     W = G/2 (I1 J^(-2/3) - 3) + K/2 (J - 1)^2
 *     P = G J^(-2/3) (F - I1/3 F^-T) + K (J - 1) cof F,    F^-T = cof F / J
 * p[0] = G, p[1] = K. See law.h for the calling convention.
 */
#ifndef LAR_MECHANICS_LAW_NEO_HOOKEAN_H
#define LAR_MECHANICS_LAW_NEO_HOOKEAN_H

#include "mechanics/lane_math.h"

LAR_INLINE lar_lane lar_neo_hookean_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                           lar_lane I1, const lar_lane p[3]) {
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y;
    lar_lane a = p[0] * y2;
    lar_lane b =
        lar_lane_fnma(a * I1, (y * y2) * lar_lane_set(1.0 / 3), p[1] * (J - lar_lane_set(1)));
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fma(b, P[k], a * F[k]);
    lar_lane bI1 = b * I1;
    return lar_lane_fma(bI1, bI1, a * a * I1);
}

LAR_INLINE lar_lane lar_neo_hookean_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                           const lar_lane p[3]) {
    (void)F;
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane change = J - lar_lane_set(1);
    lar_lane shear = lar_lane_fma(I1, y * y, lar_lane_set(-3));
    return lar_lane_set(0.5) * (p[0] * shear + p[1] * change * change);
}

#endif
