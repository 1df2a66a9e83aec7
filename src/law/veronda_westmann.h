/* The law of Veronda and Westmann (1970) for skin, with the logarithmic volume term of FEBio:
 *     W = c1 (e^(c2 x) - 1) - c1 c2 / 2 (I2 J^(-4/3) - 3) + K/2 (ln J)^2,
 *     x = I1 J^(-2/3) - 3,     I2 = |cof F|^2
 *     P = 2 s J^(-2/3) F - c1 c2 J^(-4/3) (I1 F - F F^T F)
 *         + (K ln J - 2/3 s I1 J^(-2/3) + 2/3 c1 c2 I2 J^(-4/3)) / J cof F,    s = c1 c2 e^(c2 x)
 * p[0] = c1, p[1] = c2, a number, p[2] = K; the shear modulus at rest is c1 c2. It stiffens without
 * an end. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_VERONDA_WESTMANN_H
#define LAR_LAW_VERONDA_WESTMANN_H

#include "law/first_invariant.h"
#include "law/kinematics.h"

LAR_INLINE lar_lane lar_veronda_westmann_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                                lar_lane I1, const lar_lane *p) {
    lar_lane y = lar_lane_rcbrt(J), I2 = lar_lane_square_sum(P), slope[9];
    lar_lane y2 = y * y, modulus = p[0] * p[1];
    lar_lane x = lar_lane_fma(I1, y2, lar_lane_set(-3));
    lar_lane first = lar_lane_set(2) * modulus * lar_lane_exp(p[1] * x) * y2;
    lar_lane c = modulus * y2 * y2;
    lar_lane deviatoric = lar_lane_fnma(lar_lane_set(2) * c, I2, first * I1);
    lar_lane b =
        lar_lane_fma(lar_lane_set(-1.0 / 3), deviatoric, p[2] * lar_lane_log(J)) * (y * y2);
    lar_lane_area_slope(F, P, slope);
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++)
        P[k] = lar_lane_fma(b, P[k], lar_lane_fnma(c, slope[k], first * F[k]));
    lar_lane bI1 = b * I1, cI1 = c * I1;
    return lar_lane_fma(bI1, bI1, lar_lane_fma(cI1 * cI1, I1, first * first * I1));
}

LAR_INLINE lar_lane lar_veronda_westmann_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                                const lar_lane *p) {
    lar_lane y = lar_lane_rcbrt(J), log_J = lar_lane_log(J), cof[9];
    lar_lane y2 = y * y;
    lar_lane_cofactor(F, cof);
    lar_lane x = lar_lane_fma(I1, y2, lar_lane_set(-3));
    lar_lane second = lar_lane_fma(lar_lane_square_sum(cof), y2 * y2, lar_lane_set(-3));
    lar_lane shear = lar_lane_fma(lar_lane_set(-0.5) * p[1], second, lar_lane_expm1(p[1] * x));
    return lar_lane_fma(p[0], shear, lar_lane_set(0.5) * p[2] * log_J * log_J);
}

/* 8/3 of half of 2 s - c1 c2, that at rest, and what there is along F. */
LAR_INLINE void lar_veronda_westmann_stiffness(lar_lane J, lar_lane I1, lar_lane area,
                                               const lar_lane *p, lar_lane stiffness[3]) {
    const lar_lane part = lar_lane_set(4.0 / 3), two = lar_lane_set(2);
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane growth = lar_lane_exp(p[1] * lar_lane_fma(I1, y * y, lar_lane_set(-3)));
    lar_lane modulus = p[0] * p[1];
    stiffness[0] = part * modulus * lar_lane_fma(two, growth, lar_lane_set(-1));
    stiffness[1] = part * modulus;
    stiffness[2] = lar_first_invariant_further(J, I1, area, modulus * p[1] * growth);
}

LAR_INLINE unsigned lar_veronda_westmann_stiffened(lar_lane J, lar_lane I1, lar_lane area,
                                                   const lar_lane *p, lar_lane share) {
    lar_lane now[3];
    lar_veronda_westmann_stiffness(J, I1, area, p, now);
    return lar_first_invariant_stiffened(J, area, now[0], now[2], now[1], p[2], share);
}

#ifdef LAR_LAW_ROWS

static const char lar_veronda_westmann_name[] = "veronda-westmann",
                  lar_veronda_westmann_title[] = "Veronda-Westmann";
static const lar_law_parameter lar_veronda_westmann_parameter[] = {
    {"c1", LAR_VALUE_MODULUS}, {"c2", LAR_VALUE_NUMBER}, {"bulk_modulus", LAR_VALUE_MODULUS}};
enum {
    lar_veronda_westmann_history = 0,
    lar_veronda_westmann_fibres = 0,
    lar_veronda_westmann_uncoupled = 1
};
static const lar_law_dialect lar_veronda_westmann_abaqus = LAR_LAW_NO_DIALECT;

static const lar_law_parameter lar_veronda_westmann_febio_parameter[] = {
    {"c1", LAR_VALUE_CONSTANT}, {"c2", LAR_VALUE_NUMBER}, {"k", LAR_VALUE_MODULUS}};
static void lar_veronda_westmann_read_febio(const double *given, double *p) {
    for (int k = 0; k < 3; k++) p[k] = given[k];
}
static const lar_law_dialect lar_veronda_westmann_febio =
    LAR_LAW_DIALECT("Veronda-Westmann", lar_veronda_westmann_febio_parameter,
                    lar_veronda_westmann_read_febio, "k/2 (ln J)^2");

static double lar_veronda_westmann_shear(const double *p) {
    return p[0] * p[1];
}
static double lar_veronda_westmann_bulk(const double *p) {
    return p[2];
}
/* Moduli do not say how fast it stiffens: e-fold where x = 1. */
static void lar_veronda_westmann_from_moduli(double shear, double bulk, double *p) {
    p[0] = shear;
    p[1] = 1;
    p[2] = bulk;
}

static lar_law_slopes lar_veronda_westmann_slopes(const double *p, const lar_law_invariants *is) {
    double s = p[0] * p[1] * lar_lane_exp(p[1] * (is->I1 * lar_law_reduced(is->J) - 3));
    lar_law_slopes w = {0};
    lar_law_add_rise(&w, p[1] * s, is);
    lar_law_add_reduced(&w, s, is->I1, is->J, 1, &w.w1, &w.w1J);
    lar_law_add_reduced(&w, -p[0] * p[1] / 2, is->I2, is->J, 2, &w.w2, &w.w2J);
    lar_law_add_logarithmic(&w, p[2], is->J);
    return w;
}
static void lar_veronda_westmann_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_isotropic_tangent_of(lar_veronda_westmann_slopes, p, F, A);
}

static lar_law_strained lar_veronda_westmann_strained(const double *p, double J, double I1,
                                                      double area) {
    double log_J = lar_lane_log(J), now[3];
    lar_veronda_westmann_stiffness(J, I1, area, p, now);
    return (lar_law_strained){.pressure = p[2] * log_J / J,
                              .slope = p[2] * (1 - log_J) / (J * J),
                              .shear = now[0],
                              .further = now[2]};
}

#endif

#endif
