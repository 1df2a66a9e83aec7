/* Principal stretches of a lane, and functions of C = F^T F by them.
 *
 * With p = tr C / 3, the six numbers of C - p 1 and q^2 = |C - p 1|^2 / 6, A = (C - p 1) / q has
 * the eigenvalues of x^3 - 3 x = det A (Smith 1961). Turned such that det A >= 0, the largest is 2
 * cos(arccos(det A / 2) / 3) in [sqrt 3, 2] and far from the two others, which lie in [-2, 0]: that
 * one is well conditioned, however close the two are to each other, and so is its projector
 *
 *     E = (A^2 + e A + (e^2 - 3) 1) / (3 e^2 - 3).
 *
 * What is left of A on the plane of the two, without their mean, is symmetric without trace; half
 * their difference is its size, a sum of squares that loses nothing where they meet (deflation as
 * of Eberly 2014, without eigenvectors and choices). With values f of a function at the three,
 *
 *     f(C) = f_0 E + (f_1 + f_2)/2 (1 - E) + (f_1 - f_2)/(c_1 - c_2) plane.
 *
 * A fixed number of operations, no branches. Where F is a rotation all of it is rounding, and f(C)
 * is f(1) 1 all the same.
 */
#ifndef LAR_LAW_SPECTRUM_H
#define LAR_LAW_SPECTRUM_H

#include "law/lane_math.h"

/* Symmetric: xx xy xz yy yz zz. */
typedef struct lar_lane_spectrum {
    lar_lane c[3];     /* squares of the stretches: the far one, then the others, larger first */
    lar_lane E[6];     /* projector on the direction of the far one */
    lar_lane plane[6]; /* C on the plane of the others, less their mean */
    lar_lane gap;      /* c[1] - c[2], and never zero */
} lar_lane_spectrum;

/* cos(arccos(r) / 3) for r in [0, 1]: a guess to 7e-7, and one step of third order on
 * 4 t^3 - 3 t = r. */
LAR_INLINE lar_lane lar_lane_cos_third(lar_lane r) {
    static const double guess[] = {0.0019473,   -0.00896645, 0.02189963,
                                   -0.04752501, 0.16661886,  0.86602606};
    lar_lane t = lar_lane_set(guess[0]);
#pragma GCC unroll 5
    for (int n = 1; n < 6; n++) t = lar_lane_fma(t, r, lar_lane_set(guess[n]));
    lar_lane four = lar_lane_set(4) * t * t;
    lar_lane wrong = lar_lane_fma(four - lar_lane_set(3), t, -r);
    lar_lane by = lar_lane_set(1) / lar_lane_fma(lar_lane_set(3), four, lar_lane_set(-3));
    lar_lane first = wrong * by;
    return lar_lane_fnma(first, lar_lane_fma(first * by, lar_lane_set(12) * t, lar_lane_set(1)), t);
}

/* B = A A. */
LAR_INLINE void lar_lane_square(const lar_lane A[6], lar_lane B[6]) {
    B[0] = lar_lane_fma(A[0], A[0], lar_lane_fma(A[1], A[1], A[2] * A[2]));
    B[1] = lar_lane_fma(A[0], A[1], lar_lane_fma(A[1], A[3], A[2] * A[4]));
    B[2] = lar_lane_fma(A[0], A[2], lar_lane_fma(A[1], A[4], A[2] * A[5]));
    B[3] = lar_lane_fma(A[1], A[1], lar_lane_fma(A[3], A[3], A[4] * A[4]));
    B[4] = lar_lane_fma(A[1], A[2], lar_lane_fma(A[3], A[4], A[4] * A[5]));
    B[5] = lar_lane_fma(A[2], A[2], lar_lane_fma(A[4], A[4], A[5] * A[5]));
}

/* A : A of a symmetric one. */
LAR_INLINE lar_lane lar_lane_symmetric_square(const lar_lane A[6]) {
    lar_lane off = lar_lane_fma(A[1], A[1], lar_lane_fma(A[2], A[2], A[4] * A[4]));
    lar_lane on = lar_lane_fma(A[0], A[0], lar_lane_fma(A[3], A[3], A[5] * A[5]));
    return lar_lane_fma(lar_lane_set(2), off, on);
}

LAR_INLINE lar_lane lar_lane_symmetric_determinant(const lar_lane A[6]) {
    lar_lane a = lar_lane_fnma(A[4], A[4], A[3] * A[5]);
    lar_lane b = lar_lane_fnma(A[1], A[5], A[2] * A[4]);
    lar_lane c = lar_lane_fnma(A[2], A[3], A[1] * A[4]);
    return lar_lane_fma(A[0], a, lar_lane_fma(A[1], b, A[2] * c));
}

/* C = F^T F less its mean p, which is returned. */
LAR_INLINE lar_lane lar_lane_deviator(const lar_lane F[9], lar_lane I1, lar_lane A[6]) {
    lar_lane p = I1 * lar_lane_set(1.0 / 3);
#pragma GCC unroll 3
    for (int i = 0, n = 0; i < 3; i++)
#pragma GCC unroll 3
        for (int j = i; j < 3; j++, n++)
            A[n] = lar_lane_fma(
                F[i], F[j],
                lar_lane_fma(F[3 + i], F[3 + j],
                             i == j ? lar_lane_fma(F[6 + i], F[6 + j], -p) : F[6 + i] * F[6 + j]));
    return p;
}

LAR_LONG void lar_lane_spectrum_of(const lar_lane F[9], lar_lane I1, lar_lane_spectrum *s) {
    static const int diagonal[6] = {1, 0, 0, 1, 0, 1};
    const lar_lane half = lar_lane_set(0.5);
    lar_lane A[6], A2[6], plane[6];
    lar_lane p = lar_lane_deviator(F, I1, A);
    lar_lane q = lar_lane_sqrt(lar_lane_fma(lar_lane_symmetric_square(A), lar_lane_set(1.0 / 6),
                                            lar_lane_set(LAR_LANE_TINY)));
    lar_lane by = lar_lane_set(1) / q;
#pragma GCC unroll 6
    for (int n = 0; n < 6; n++) A[n] = A[n] * by;
    lar_lane r = lar_lane_symmetric_determinant(A) * half, sign = lar_lane_sign(r);
#pragma GCC unroll 6
    for (int n = 0; n < 6; n++) A[n] = A[n] * sign;
    lar_lane e = lar_lane_set(2) * lar_lane_cos_third(r * sign), e2 = e * e;
    lar_lane_square(A, A2);
    lar_lane scale = lar_lane_set(1) / lar_lane_fma(lar_lane_set(3), e2, lar_lane_set(-3));
    lar_lane offset = e2 - lar_lane_set(3), part = lar_lane_set(-1.5) * e;
    lar_lane size = q * sign;
#pragma GCC unroll 6
    for (int n = 0; n < 6; n++) {
        lar_lane sum = lar_lane_fma(e, A[n], A2[n]);
        s->E[n] = (diagonal[n] ? sum + offset : sum) * scale;
        sum = lar_lane_fma(part, s->E[n], A[n]);
        plane[n] = diagonal[n] ? lar_lane_fma(half, e, sum) : sum;
        s->plane[n] = plane[n] * size;
    }
    lar_lane apart = q * lar_lane_sqrt(lar_lane_fma(lar_lane_symmetric_square(plane), half,
                                                    lar_lane_set(LAR_LANE_TINY)));
    lar_lane mean = lar_lane_fnma(size * half, e, p);
    s->c[0] = lar_lane_fma(size, e, p);
    s->c[1] = mean + apart;
    s->c[2] = mean - apart;
    s->gap = lar_lane_set(2) * apart;
}

/* f(C) from its values at the three. */
LAR_LONG void lar_lane_spectral(const lar_lane_spectrum *s, const lar_lane f[3], lar_lane S[6]) {
    static const int diagonal[6] = {1, 0, 0, 1, 0, 1};
    lar_lane mean = lar_lane_set(0.5) * (f[1] + f[2]), slope = (f[1] - f[2]) / s->gap;
    lar_lane beyond = f[0] - mean;
#pragma GCC unroll 6
    for (int n = 0; n < 6; n++) {
        lar_lane sum = lar_lane_fma(slope, s->plane[n], beyond * s->E[n]);
        S[n] = diagonal[n] ? sum + mean : sum;
    }
}

/* Eigenvalues of a symmetric tensor, largest first, from a third of its trace, |its deviator|^2 / 6
 * and the deviator's determinant. For estimates: where they are close to each other they are
 * off by up to the third root of what is rounded, some 1e-5 of p. */
LAR_INLINE void lar_lane_three(lar_lane p, lar_lane q2, lar_lane determinant, lar_lane c[3]) {
    const lar_lane none = lar_lane_set(0), one = lar_lane_set(1), two = lar_lane_set(2);
    q2 = lar_lane_max(q2, none);
    lar_lane q = lar_lane_sqrt(q2);
    lar_lane r = determinant / lar_lane_fma(two * q2, q, lar_lane_set(LAR_LANE_TINY));
    lar_lane sign = lar_lane_sign(r), qs = q * sign;
    lar_lane t = lar_lane_cos_third(-lar_lane_max(-one, -(r * sign)));
    lar_lane sine = lar_lane_sqrt(lar_lane_set(3) * lar_lane_max(lar_lane_fnma(t, t, one), none));
    lar_lane mean = lar_lane_fnma(qs, t, p), far = lar_lane_fma(two * qs, t, p);
    c[0] = lar_lane_max(far, lar_lane_fma(q, sine, mean));
    c[2] = -lar_lane_max(-far, -lar_lane_fnma(q, sine, mean));
    c[1] = lar_lane_set(3) * p - c[0] - c[2];
}

/* Squares of the stretches from the invariants; none is below 1e-9 of their mean. */
LAR_LONG void lar_lane_stretch_squares(lar_lane I1, lar_lane I2, lar_lane J, lar_lane c[3]) {
    lar_lane p = I1 * lar_lane_set(1.0 / 3), least = lar_lane_set(1e-9) * p;
    lar_lane determinant = lar_lane_fma(J, J, p * lar_lane_fma(lar_lane_set(2) * p, p, -I2));
    lar_lane_three(p, lar_lane_fnma(I2, lar_lane_set(1.0 / 3), p * p), determinant, c);
    c[1] = lar_lane_max(c[1], least);
    c[2] = lar_lane_max(c[2], least);
}

#endif
