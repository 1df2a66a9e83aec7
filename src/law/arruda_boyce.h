/* The eight-chain law of Arruda and Boyce (1993) by the first five terms of its series, as FEBio
 * and Abaqus have it, with the logarithmic volume term of FEBio:
 *     W = mu sum_i C_i / N^(i-1) (I^i - 3^i) + K/2 (ln J)^2,     I = I1 J^(-2/3),
 *     C = 1/2, 1/20, 11/1050, 19/7000, 519/673750
 *     P = 2 s J^(-2/3) F + (K ln J - 2/3 s I) / J cof F,
 *     s = mu (1/2 + z/10 + 11/350 z^2 + 19/1750 z^3 + 519/134750 z^4),     z = I / N
 * p[0] = mu, p[1] = N, links of a chain: sqrt(N) is the stretch at which chains lock, towards which
 * the series stiffens without an end. p[2] = K. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_ARRUDA_BOYCE_H
#define LAR_LAW_ARRUDA_BOYCE_H

#include "law/first_invariant.h"
#include "law/numbers.h"

/* I / N; lanes without an element have no N. */
LAR_INLINE lar_lane lar_arruda_boyce_share(lar_lane I, const lar_lane *p) {
    return I / lar_lane_max(p[1], lar_lane_set(LAR_LAW_NUMBER_MIN));
}

/* s / mu. */
LAR_INLINE lar_lane lar_arruda_boyce_slope(lar_lane z) {
    lar_lane sum = lar_lane_fma(lar_lane_set(519.0 / 134750), z, lar_lane_set(19.0 / 1750));
    sum = lar_lane_fma(lar_lane_fma(sum, z, lar_lane_set(11.0 / 350)), z, lar_lane_set(0.1));
    return lar_lane_fma(sum, z, lar_lane_set(0.5));
}

/* N ds/dI / mu. */
LAR_INLINE lar_lane lar_arruda_boyce_rise(lar_lane z) {
    lar_lane sum = lar_lane_fma(lar_lane_set(1038.0 / 67375), z, lar_lane_set(57.0 / 1750));
    return lar_lane_fma(lar_lane_fma(sum, z, lar_lane_set(11.0 / 175)), z, lar_lane_set(0.1));
}

LAR_INLINE lar_lane lar_arruda_boyce_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                            lar_lane I1, const lar_lane *p) {
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y;
    lar_lane a =
        lar_lane_set(2) * p[0] * lar_arruda_boyce_slope(lar_arruda_boyce_share(I1 * y2, p)) * y2;
    lar_lane b = lar_lane_fnma(a * I1, lar_lane_set(1.0 / 3), p[2] * lar_lane_log(J)) * (y * y2);
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fma(b, P[k], a * F[k]);
    lar_lane bI1 = b * I1;
    return lar_lane_fma(bI1, bI1, a * a * I1);
}

/* I^i - 3^i = (I - 3) (I^(i-1) + 3 I^(i-2) + ...), which keeps the digits of small strains. */
LAR_INLINE lar_lane lar_arruda_boyce_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                            const lar_lane *p) {
    static const double C[] = {0.5, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
    (void)F;
    lar_lane y = lar_lane_rcbrt(J), log_J = lar_lane_log(J);
    lar_lane x = lar_lane_fma(I1, y * y, lar_lane_set(-3)),
             rest = lar_arruda_boyce_share(lar_lane_set(3), p);
    lar_lane z = lar_arruda_boyce_share(x + lar_lane_set(3), p), quotient = lar_lane_set(1),
             power = rest;
    lar_lane sum = lar_lane_set(C[0]);
    for (int i = 1; i < 5; i++, power *= rest) {
        quotient = lar_lane_fma(quotient, z, power);
        sum = lar_lane_fma(lar_lane_set(C[i]), quotient, sum);
    }
    return lar_lane_fma(p[0] * sum, x, lar_lane_set(0.5) * p[2] * log_J * log_J);
}

/* 8/3 s, 8/3 s at rest, and what there is along F. */
LAR_INLINE void lar_arruda_boyce_stiffness(lar_lane J, lar_lane I1, lar_lane area,
                                           const lar_lane *p, lar_lane stiffness[3]) {
    const lar_lane part = lar_lane_set(8.0 / 3) * p[0];
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane z = lar_arruda_boyce_share(I1 * y * y, p);
    stiffness[0] = part * lar_arruda_boyce_slope(z);
    stiffness[1] = part * lar_arruda_boyce_slope(lar_arruda_boyce_share(lar_lane_set(3), p));
    stiffness[2] = lar_first_invariant_further(J, I1, area, p[0] / p[1] * lar_arruda_boyce_rise(z));
}

LAR_INLINE unsigned lar_arruda_boyce_stiffened(lar_lane J, lar_lane I1, lar_lane area,
                                               const lar_lane *p, lar_lane share) {
    lar_lane now[3];
    lar_arruda_boyce_stiffness(J, I1, area, p, now);
    return lar_first_invariant_stiffened(J, area, now[0], now[2], now[1], p[2], share);
}

#ifdef LAR_LAW_ROWS

static const char lar_arruda_boyce_name[] = "arruda-boyce",
                  lar_arruda_boyce_title[] = "Arruda-Boyce";
static const lar_law_parameter lar_arruda_boyce_parameter[] = {
    {"mu", LAR_VALUE_MODULUS}, {"N", LAR_VALUE_NUMBER}, {"bulk_modulus", LAR_VALUE_MODULUS}};
enum { lar_arruda_boyce_history = 0, lar_arruda_boyce_fibres = 0, lar_arruda_boyce_uncoupled = 1 };

static const lar_law_parameter lar_arruda_boyce_febio_parameter[] = {
    {"mu", LAR_VALUE_CONSTANT}, {"N", LAR_VALUE_NUMBER}, {"k", LAR_VALUE_MODULUS}};
static void lar_arruda_boyce_read_febio(const double *given, double *p) {
    for (int k = 0; k < 3; k++) p[k] = given[k];
}
static const lar_law_dialect lar_arruda_boyce_febio = LAR_LAW_DIALECT(
    "Arruda-Boyce", lar_arruda_boyce_febio_parameter, lar_arruda_boyce_read_febio, "k/2 (ln J)^2");

/* Abaqus has the locking stretch sqrt(N), and ((J^2 - 1)/2 - ln J) / D. */
static const lar_law_parameter lar_arruda_boyce_constant[] = {
    {"MU", LAR_VALUE_CONSTANT}, {"LAMBDA_M", LAR_VALUE_NUMBER}, {"D", LAR_VALUE_SOFTNESS}};
static void lar_arruda_boyce_read_abaqus(const double *given, double *p) {
    p[0] = given[0];
    p[1] = given[1] * given[1];
    p[2] = 2.0 / given[2];
}
static const lar_law_dialect lar_arruda_boyce_abaqus = LAR_LAW_DIALECT(
    "ARRUDA-BOYCE", lar_arruda_boyce_constant, lar_arruda_boyce_read_abaqus, "K/2 (ln J)^2");

static double lar_arruda_boyce_shear(const double *p) {
    return 2.0 * p[0] * lar_arruda_boyce_slope(3.0 / p[1]);
}
static double lar_arruda_boyce_bulk(const double *p) {
    return p[2];
}
/* Moduli do not say when chains lock: at 2.2 times their length. */
static void lar_arruda_boyce_from_moduli(double shear, double bulk, double *p) {
    p[1] = 5;
    p[0] = shear / (2.0 * lar_arruda_boyce_slope(3.0 / p[1]));
    p[2] = bulk;
}

static lar_law_slopes lar_arruda_boyce_slopes(const double *p, const lar_law_invariants *is) {
    double y2 = lar_law_reduced(is->J), z = is->I1 * y2 / p[1];
    double s = p[0] * lar_arruda_boyce_slope(z), rise = p[0] / p[1] * lar_arruda_boyce_rise(z);
    lar_law_slopes w = {0};
    lar_law_add_rise(&w, rise, is);
    lar_law_add_reduced(&w, s, is->I1, is->J, 1, &w.w1, &w.w1J);
    lar_law_add_logarithmic(&w, p[2], is->J);
    return w;
}
static void lar_arruda_boyce_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_isotropic_tangent_of(lar_arruda_boyce_slopes, p, F, A);
}

static lar_law_strained lar_arruda_boyce_strained(const double *p, double J, double I1,
                                                  double area) {
    double log_J = lar_lane_log(J), now[3];
    lar_arruda_boyce_stiffness(J, I1, area, p, now);
    return (lar_law_strained){.pressure = p[2] * log_J / J,
                              .slope = p[2] * (1 - log_J) / (J * J),
                              .shear = now[0],
                              .further = now[2]};
}

#endif

#endif
