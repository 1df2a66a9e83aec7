/* Mooney-Rivlin in reduced invariants with the logarithmic volume term of FEBio:
 *     W = c1 (I1 J^(-2/3) - 3) + c2 (I2 J^(-4/3) - 3) + K/2 (ln J)^2,     I2 = |cof F|^2
 *     P = 2 c1 J^(-2/3) F + 2 c2 J^(-4/3) cof F x F
 *         + (K ln J - 2/3 c1 I1 J^(-2/3) - 4/3 c2 I2 J^(-4/3)) / J cof F
 * with cof F x F = I1 F - F F^T F (lar_lane_area_slope).
 * p[0] = c1, p[1] = c2, p[2] = K. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_MOONEY_RIVLIN_H
#define LAR_LAW_MOONEY_RIVLIN_H

#include "law/kinematics.h"
#include "law/lane_math.h"

LAR_INLINE lar_lane lar_mooney_rivlin_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                             lar_lane I1, const lar_lane *p) {
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y, y4 = y2 * y2;
    lar_lane I2 = lar_lane_square_sum(P);

    lar_lane first = p[0] * y2, second = p[1] * y4;
    lar_lane deviatoric = lar_lane_fma(first, I1, lar_lane_set(2) * (second * I2));
    lar_lane b =
        lar_lane_fma(lar_lane_set(-2.0 / 3), deviatoric, p[2] * lar_lane_log(J)) * (y * y2);
    lar_lane a = lar_lane_set(2) * first, c = lar_lane_set(2) * second;

    lar_lane slope[9];
    lar_lane_area_slope(F, P, slope);
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fma(b, P[k], lar_lane_fma(c, slope[k], a * F[k]));
    lar_lane bI1 = b * I1, cI1 = c * I1;
    return lar_lane_fma(bI1, bI1, lar_lane_fma(cI1 * cI1, I1, a * a * I1));
}

LAR_INLINE lar_lane lar_mooney_rivlin_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                             const lar_lane *p) {
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y, log_J = lar_lane_log(J);
    lar_lane trace_C2 = lar_lane_set(0); /* tr (C C) */
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            lar_lane C = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
            trace_C2 = lar_lane_fma(C, C, trace_C2);
        }
    lar_lane I2 = lar_lane_set(0.5) * (I1 * I1 - trace_C2);
    return p[0] * (I1 * y2 - lar_lane_set(3)) + p[1] * (I2 * y2 * y2 - lar_lane_set(3)) +
           lar_lane_set(0.5) * p[2] * log_J * log_J;
}

LAR_INLINE unsigned lar_mooney_rivlin_stiffened(lar_lane J, lar_lane I1, lar_lane area,
                                                const lar_lane *p, lar_lane share) {
    (void)J, (void)I1, (void)area, (void)p, (void)share;
    return 0;
}

#ifdef LAR_LAW_ROWS

static const char lar_mooney_rivlin_name[] = "mooney-rivlin",
                  lar_mooney_rivlin_title[] = "Mooney-Rivlin";
static const lar_law_parameter lar_mooney_rivlin_parameter[] = {
    {"c1", LAR_VALUE_CONSTANT}, {"c2", LAR_VALUE_CONSTANT}, {"bulk_modulus", LAR_VALUE_MODULUS}};
enum {
    lar_mooney_rivlin_history = 0,
    lar_mooney_rivlin_fibres = 0,
    lar_mooney_rivlin_uncoupled = 1
};

static const lar_law_parameter lar_mooney_rivlin_febio_parameter[] = {
    {"c1", LAR_VALUE_CONSTANT}, {"c2", LAR_VALUE_OPTIONAL}, {"k", LAR_VALUE_MODULUS}};
static void lar_mooney_rivlin_read_febio(const double *given, double *p) {
    for (int k = 0; k < 3; k++) p[k] = given[k];
}
static const lar_law_dialect lar_mooney_rivlin_febio =
    LAR_LAW_DIALECT("Mooney-Rivlin", lar_mooney_rivlin_febio_parameter,
                    lar_mooney_rivlin_read_febio, "k/2 (ln J)^2");

/* Abaqus: U = C10 (I1' - 3) + C01 (I2' - 3) + (J - 1)^2 / D1. */
static const lar_law_parameter lar_mooney_rivlin_constant[] = {
    {"C10", LAR_VALUE_CONSTANT}, {"C01", LAR_VALUE_CONSTANT}, {"D1", LAR_VALUE_SOFTNESS}};
static void lar_mooney_rivlin_read_abaqus(const double *given, double *p) {
    p[0] = given[0];
    p[1] = given[1];
    p[2] = 2.0 / given[2];
}
static const lar_law_dialect lar_mooney_rivlin_abaqus =
    LAR_LAW_SERIES("MOONEY-RIVLIN", lar_mooney_rivlin_constant, lar_mooney_rivlin_read_abaqus,
                   "K/2 (ln J)^2", "POLYNOMIAL", 2);

static double lar_mooney_rivlin_shear(const double *p) {
    return 2.0 * (p[0] + p[1]);
}
static double lar_mooney_rivlin_bulk(const double *p) {
    return p[2];
}
static void lar_mooney_rivlin_from_moduli(double shear, double bulk, double *p) {
    p[0] = shear / 2.0;
    p[1] = 0;
    p[2] = bulk;
}

static lar_law_slopes lar_mooney_rivlin_slopes(const double *p, const lar_law_invariants *is) {
    lar_law_slopes w = {0};
    lar_law_add_reduced(&w, p[0], is->I1, is->J, 1, &w.w1, &w.w1J);
    lar_law_add_reduced(&w, p[1], is->I2, is->J, 2, &w.w2, &w.w2J);
    lar_law_add_logarithmic(&w, p[2], is->J);
    return w;
}
static void lar_mooney_rivlin_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_isotropic_tangent_of(lar_mooney_rivlin_slopes, p, F, A);
}

static lar_law_strained lar_mooney_rivlin_strained(const double *p, double J, double I1,
                                                   double area) {
    double log_J = lar_lane_log(J); /* the same bits everywhere */
    (void)I1, (void)area;
    return (lar_law_strained){.pressure = p[2] * log_J / J,
                              .slope = p[2] * (1 - log_J) / (J * J),
                              .shear = 4 * lar_mooney_rivlin_shear(p) / 3,
                              .further = 0};
}

#endif

#endif
