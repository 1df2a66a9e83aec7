/* The coupled neo-Hookean law (FEBio "neo-Hookean"; Bonet and Wood 1997), Lame's mu and lambda:
 *     W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2
 *     P = mu F + (lambda ln J - mu)/J cof F
 * p[0] = mu, p[1] = lambda. See law.h for the calling convention.
 */
#ifndef LAR_MECHANICS_LAW_COUPLED_NEO_HOOKEAN_H
#define LAR_MECHANICS_LAW_COUPLED_NEO_HOOKEAN_H

#include "mechanics/lane_math.h"

LAR_INLINE lar_lane lar_coupled_neo_hookean_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                                   lar_lane I1, const lar_lane p[3]) {
    lar_lane a = p[0];
    lar_lane b = (p[1] * lar_lane_log(J) - a) / J;
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fma(b, P[k], a * F[k]);
    lar_lane bI1 = b * I1;
    return lar_lane_fma(bI1, bI1, a * a * I1);
}

LAR_INLINE lar_lane lar_coupled_neo_hookean_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                                   const lar_lane p[3]) {
    (void)F;
    lar_lane log_J = lar_lane_log(J);
    lar_lane shear = lar_lane_fma(lar_lane_set(-2), log_J, I1 - lar_lane_set(3));
    return lar_lane_set(0.5) * (p[0] * shear + p[1] * log_J * log_J);
}

#endif
