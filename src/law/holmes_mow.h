/* The law of Holmes and Mow (1990) for cartilage, Lame's mu and lambda at rest, M = lambda + 2 mu:
 *     W = M / (4 beta) (e^Q - 1),     Q = beta R / M,
 *     R = (2 mu - lambda)(I1 - 3) + lambda (I2 - 3) - 2 M ln J,     I2 = |cof F|^2
 *     P = e^Q / 2 ((2 mu - lambda) F + lambda cof F x F - M / J cof F),
 *     cof F x F = I1 F - F F^T F (lar_lane_area_slope)
 * p[0] = mu, p[1] = lambda, p[2] = beta, a number. It is not divided into volume and shape, and
 * stiffens without an end whatever is done to it. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_HOLMES_MOW_H
#define LAR_LAW_HOLMES_MOW_H

#include "law/kinematics.h"
#include "law/principal.h"

/* M, of lanes without an element next to nothing. */
LAR_INLINE lar_lane lar_holmes_mow_modulus(const lar_lane *p) {
    return lar_lane_fma(lar_lane_set(2), p[0], p[1]) + lar_lane_set(LAR_LANE_TINY);
}

LAR_INLINE lar_lane lar_holmes_mow_exponent(lar_lane J, lar_lane I1, lar_lane I2,
                                            const lar_lane *p) {
    const lar_lane three = lar_lane_set(3), two = lar_lane_set(2);
    lar_lane M = lar_holmes_mow_modulus(p);
    lar_lane R = lar_lane_fma(lar_lane_fma(two, p[0], -p[1]), I1 - three, p[1] * (I2 - three));
    return p[2] * (R / M - two * lar_lane_log(J));
}

LAR_INLINE lar_lane lar_holmes_mow_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                          lar_lane I1, const lar_lane *p) {
    lar_lane I2 = lar_lane_square_sum(P), slope[9];
    lar_lane half = lar_lane_set(0.5) * lar_lane_exp(lar_holmes_mow_exponent(J, I1, I2, p));
    lar_lane c = half * p[1], M = lar_holmes_mow_modulus(p);
    lar_lane a = half * lar_lane_fma(lar_lane_set(2), p[0], -p[1]);
    lar_lane b = half * M / J;
    lar_lane_area_slope(F, P, slope);
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fnma(b, P[k], lar_lane_fma(c, slope[k], a * F[k]));
    return lar_lane_square_sum(P); /* its terms are large at rest, and cancel */
}

LAR_INLINE lar_lane lar_holmes_mow_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                          const lar_lane *p) {
    lar_lane cof[9];
    lar_lane_cofactor(F, cof);
    lar_lane Q = lar_holmes_mow_exponent(J, I1, lar_lane_square_sum(cof), p);
    lar_lane M = lar_holmes_mow_modulus(p);
    return M / (lar_lane_set(4) * p[2]) * lar_lane_expm1(Q);
}

/* How stiff it is, in all, as a part of its M at rest: by w_aa and pairs of M and 2 mu, and in all
 * directions at once of 3 K (or 2 mu, where that is more). An element counts by one, by the other
 * or, as its edges are long or short, by something in between. */
LAR_INLINE lar_lane lar_holmes_mow_growth(lar_lane J, lar_lane I1, lar_lane area,
                                          const lar_lane *p) {
    const lar_lane two = lar_lane_set(2), quarter = lar_lane_set(0.25);
    lar_principal w;
    lar_lane c[3], all, M = lar_holmes_mow_modulus(p);
    lar_lane growth = quarter * lar_lane_exp(lar_holmes_mow_exponent(J, I1, area, p));
    lar_lane_stretch_squares(I1, area, J, c);
    for (int a = 0; a < 3; a++) {
        lar_lane pull = two * (lar_lane_fma(two, p[0], -p[1]) + p[1] * (I1 - c[a]));
        lar_lane push = two * M / c[a];
        w.stretch[a] = lar_lane_sqrt(c[a]);
        w.first[a] = w.stretch[a] * (pull - push);
        w.second[a] = pull + push + p[2] * w.first[a] * w.first[a] / M;
    }
    for (int pair = 0; pair < 3; pair++) {
        const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
        w.mixed[pair] = lar_lane_set(4) * p[1] * w.stretch[a] * w.stretch[b] +
                        p[2] * w.first[a] * w.first[b] / M;
    }
    lar_lane single = lar_principal_largest(&w, &all);
    lar_lane rest = lar_lane_max(lar_lane_fma(two, p[1], M), two * p[0]);
    return growth * lar_lane_max(single / M, all / rest);
}

LAR_INLINE unsigned lar_holmes_mow_stiffened(lar_lane J, lar_lane I1, lar_lane area,
                                             const lar_lane *p, lar_lane share) {
    return ~lar_lane_not_greater(lar_holmes_mow_growth(J, I1, area, p), share + lar_lane_set(1)) &
           ((1U << LAR_LANES) - 1);
}

#ifdef LAR_LAW_ROWS

static const char lar_holmes_mow_name[] = "holmes-mow", lar_holmes_mow_title[] = "Holmes-Mow";
static const lar_law_parameter lar_holmes_mow_parameter[] = {
    {"mu", LAR_VALUE_MODULUS}, {"lambda", LAR_VALUE_CONSTANT}, {"beta", LAR_VALUE_NUMBER}};
#define lar_holmes_mow_slopes NULL
enum { lar_holmes_mow_history = 0, lar_holmes_mow_fibres = 0, lar_holmes_mow_uncoupled = 0 };
static const lar_law_dialect lar_holmes_mow_abaqus = LAR_LAW_NO_DIALECT;

static const lar_law_parameter lar_holmes_mow_young[] = {
    {"E", LAR_VALUE_MODULUS}, {"v", LAR_VALUE_RATIO}, {"beta", LAR_VALUE_NUMBER}};
static void lar_holmes_mow_read_febio(const double *given, double *p) {
    double young = given[0], poisson = given[1];
    p[0] = young / (2.0 * (1.0 + poisson));
    p[1] = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    p[2] = given[2];
}
static const lar_law_dialect lar_holmes_mow_febio =
    LAR_LAW_DIALECT("Holmes-Mow", lar_holmes_mow_young, lar_holmes_mow_read_febio, NULL);

static double lar_holmes_mow_shear(const double *p) {
    return p[0];
}
static double lar_holmes_mow_bulk(const double *p) {
    return p[1] + 2.0 * p[0] / 3.0;
}
/* Moduli do not say how fast it stiffens: e-fold where R = M. */
static void lar_holmes_mow_from_moduli(double shear, double bulk, double *p) {
    p[0] = shear;
    p[1] = bulk - 2.0 * shear / 3.0;
    p[2] = 1;
}

/* e^Q / 4 times R'', and R' beside itself, which the stress has. */
static void lar_holmes_mow_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_law_invariants is = lar_law_invariants_of(F);
    double M = p[1] + 2 * p[0], P[9];
    double R = (2 * p[0] - p[1]) * (is.I1 - 3) + p[1] * (is.I2 - 3) - 2 * M * lar_lane_log(is.J);
    double quarter = lar_lane_exp(p[2] * R / M) / 4;
    lar_law_slopes w = {.w1 = quarter * (2 * p[0] - p[1]),
                        .w2 = quarter * p[1],
                        .wJ = -2 * quarter * M / is.J,
                        .wJJ = 2 * quarter * M / (is.J * is.J)};
    lar_isotropic_tangent(&w, &is, F, A);
    memcpy(P, is.cof, sizeof P);
    lar_holmes_mow_stress(F, P, is.J, is.I1, p);
    for (int r = 0; r < 9; r++)
        for (int s = 0; s < 9; s++) A[r][s] += p[2] / (M * quarter) * (P[r] * P[s]);
}

static lar_law_strained lar_holmes_mow_strained(const double *p, double J, double I1, double area) {
    return (lar_law_strained){.pressure = 0,
                              .slope = 0,
                              .shear = 0,
                              .further = (p[1] + 2 * p[0]) * lar_holmes_mow_growth(J, I1, area, p)};
}

#endif

#endif
