/* Functions of a lane that must have the same bits on every machine: no libm, a fixed number of
 * operations, no branches.
 */
#ifndef LAR_LAW_LANE_MATH_H
#define LAR_LAW_LANE_MATH_H

#include "base/simd.h"

/* J^(-1/3) for normal positive J, to about 2 units in the last place.
 *
 * First guess from the bits: the upper half of a double read as an integer is nearly 2^20 log2(J)
 * plus a constant, so -1/3 of it (with the constant put right) is the upper half of a number
 * within 3.5% of J^(-1/3). Two iterations of fourth order follow: with r = 1 - J y^3,
 *     J^(-1/3) = y (1 - r)^(-1/3) = y (1 + r/3 + 2 r^2/9 + 14 r^3/81 + ...).
 * For J <= 0 or not finite the result means nothing; the caller checks J. */
LAR_INLINE lar_lane lar_lane_rcbrt(lar_lane J) {
    lar_lane upper = lar_ilane_to_lane(lar_lane_bits(J) >> 32);
    lar_lane guess = lar_lane_fma(upper, lar_lane_set(-1.0 / 3), lar_lane_set(1430186164.0));
    lar_lane y = lar_ilane_as_lane(lar_lane_round(guess) << 32);
    for (int i = 0; i < 2; i++) {
        lar_lane r = lar_lane_fnma(y * y, J * y, lar_lane_set(1));
        lar_lane series = lar_lane_fma(r, lar_lane_set(14.0 / 81), lar_lane_set(2.0 / 9));
        series = lar_lane_fma(r, series, lar_lane_set(1.0 / 3));
        y = lar_lane_fma(y * r, series, y);
    }
    return y;
}

/* ln(J) for normal positive J.
 *
 * J = 2^k m with m in [sqrt(1/2), sqrt(2)); ln m = 2 artanh(s), s = (m - 1)/(m + 1), |s| < 0.1716;
 * the odd series up to s^21 leaves less than 1e-17. The quotient is IEEE division, the same
 * everywhere. */
LAR_INLINE lar_lane lar_lane_log(lar_lane J) {
    const int64_t half_bits = 0x3fe6a09e00000000LL; /* upper half of sqrt(1/2) */
    lar_ilane bits = lar_lane_bits(J);
    lar_ilane above = bits - half_bits;
    lar_ilane k = above >> 52;
    lar_lane m = lar_ilane_as_lane(bits - (above & ~((1LL << 52) - 1)));
    lar_lane s = (m - lar_lane_set(1)) / (m + lar_lane_set(1));
    lar_lane s2 = s * s;
    lar_lane sum = lar_lane_set(2.0 / 21);
    for (int n = 19; n >= 3; n -= 2) sum = lar_lane_fma(sum, s2, lar_lane_set(2.0 / n));
    lar_lane log_m = lar_lane_fma(s2 * s, sum, s + s);
    lar_lane exponent = lar_ilane_to_lane(k);
    lar_lane low = lar_lane_fma(exponent, lar_lane_set(0x1.abc9e3b39803fp-56), log_m);
    return lar_lane_fma(exponent, lar_lane_set(0x1.62e42fefa39efp-1), low);
}

#endif
