/* Functions of a lane that must have the same bits on every machine: no libm, a fixed number of
 * operations, no branches.
 */
#ifndef LAR_LAW_LANE_MATH_H
#define LAR_LAW_LANE_MATH_H

#include "base/simd.h"

/* Powers of stretches are e^(m ln stretch): 2 + 5 |m ln stretch| units in the last place. */

/* J^(-1/3) for normal positive J, to about 2 units in the last place.
 *
 * First guess from the bits: the upper half of a double read as an integer is nearly 2^20 log2(J)
 * plus a constant, so -1/3 of it (with the constant put right) is the upper half of a number
 * within 3.5% of J^(-1/3). Two iterations of fourth order follow: with r = 1 - J y^3,
 *     J^(-1/3) = y (1 - r)^(-1/3) = y (1 + r/3 + 2 r^2/9 + 14 r^3/81 + ...).
 * For J <= 0 or not finite the result means nothing; the caller checks J. */
LAR_INLINE lar_lane lar_lane_rcbrt(lar_lane J) {
    lar_lane guess =
        lar_lane_fma(lar_lane_upper(J), lar_lane_set(-1.0 / 3), lar_lane_set(1430186164.0));
    lar_lane y = lar_lane_from_upper(guess);
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
LAR_LONG lar_lane lar_lane_log(lar_lane J) {
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

/* e^x = 2^k e^r, k the integer nearest to x / ln 2, |r| <= ln 2 / 2: returns e^r - 1 and 2^k.
 *
 * Adding 1.5 * 2^52 leaves k in the low bits. ln 2 is taken away in two parts, each by a fused
 * operation. (e^r - 1 - r) / r^2 is a polynomial through ten Chebyshev nodes, which leaves less
 * than 4e-17 of r. Beyond +-708, where 2^k would not be normal, x counts as +-708: 3e307 and
 * 3e-308. */
LAR_LONG lar_lane lar_lane_exp_parts(lar_lane x, lar_lane *power) {
    static const double term[] = {
        0x1.af38a9b0ec855p-26, 0x1.289185613a3d6p-22, 0x1.71de0dae63bb3p-19, 0x1.a019b90d2ae7ap-16,
        0x1.a01a01a7c41d5p-13, 0x1.6c16c1788bd90p-10, 0x1.11111111109b3p-7,  0x1.5555555553d63p-5,
        0x1.5555555555556p-3,  0x1.0000000000001p-1};
    const lar_lane magic = lar_lane_set(0x1.8p52), max = lar_lane_set(708);
    x = -lar_lane_max(-max, -lar_lane_max(-max, x));
    lar_lane shifted = lar_lane_fma(x, lar_lane_set(0x1.71547652b82fep+0), magic);
    lar_lane k = shifted - magic;
    lar_lane r = lar_lane_fnma(k, lar_lane_set(0x1.62e42fefa39efp-1), x);
    r = lar_lane_fnma(k, lar_lane_set(0x1.abc9e3b39803fp-56), r);
    lar_lane sum = lar_lane_set(term[0]);
#pragma GCC unroll 9
    for (int n = 1; n < 10; n++) sum = lar_lane_fma(sum, r, lar_lane_set(term[n]));
    *power = lar_ilane_as_lane(((lar_lane_bits(shifted) + 1023) & 0x7ff) << 52);
    return lar_lane_fma(r * r, sum, r);
}

/* e^x, to 1.1 units in the last place. */
LAR_INLINE lar_lane lar_lane_exp(lar_lane x) {
    lar_lane power, less_one = lar_lane_exp_parts(x, &power);
    return lar_lane_fma(power, less_one, power);
}

/* e^x - 1, to 2.2 units in the last place, of small x too. */
LAR_INLINE lar_lane lar_lane_expm1(lar_lane x) {
    lar_lane power, less_one = lar_lane_exp_parts(x, &power);
    return lar_lane_fma(power, less_one, power - lar_lane_set(1));
}

/* 1 with the sign of x. */
LAR_INLINE lar_lane lar_lane_sign(lar_lane x) {
    return lar_ilane_as_lane((lar_lane_bits(x) & INT64_MIN) | 0x3ff0000000000000LL);
}

/* What is added where nothing may be divided by nothing: lost in any number that matters. */
#define LAR_LANE_TINY 1e-200

#endif
