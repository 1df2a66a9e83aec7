/* The thesis's law, in reduced invariants (T eq. 1.1; Sussman and Bathe 1987), G = 2 mu, K = kappa:
 *     W = G/2 (I1 J^(-2/3) - 3) + K/2 (J - 1)^2
 *     P = G J^(-2/3) (F - I1/3 F^-T) + K (J - 1) cof F,    F^-T = cof F / J
 * p[0] = G, p[1] = K. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_NEO_HOOKEAN_H
#define LAR_LAW_NEO_HOOKEAN_H

#include "law/lane_math.h"

LAR_INLINE lar_lane lar_neo_hookean_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                           lar_lane I1, const lar_lane *p) {
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
                                           const lar_lane *p) {
    (void)F;
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane change = J - lar_lane_set(1);
    lar_lane shear = lar_lane_fma(I1, y * y, lar_lane_set(-3));
    return lar_lane_set(0.5) * (p[0] * shear + p[1] * change * change);
}

LAR_INLINE unsigned lar_neo_hookean_stiffened(lar_lane J, lar_lane I1, lar_lane area,
                                              const lar_lane *p, lar_lane share) {
    (void)J, (void)I1, (void)area, (void)p, (void)share;
    return 0;
}

#ifdef LAR_LAW_ROWS

static const char lar_neo_hookean_name[] = "neo-hookean", lar_neo_hookean_title[] = "neo-Hookean";
static const lar_law_parameter lar_neo_hookean_parameter[] = {{"shear_modulus", LAR_VALUE_MODULUS},
                                                              {"bulk_modulus", LAR_VALUE_MODULUS}};
static const lar_law_dialect lar_neo_hookean_febio = LAR_LAW_NO_DIALECT;
enum { lar_neo_hookean_history = 0, lar_neo_hookean_fibres = 0, lar_neo_hookean_uncoupled = 1 };

/* Abaqus: U = C10 (I1' - 3) + (J - 1)^2 / D1. */
static const lar_law_parameter lar_neo_hookean_constant[] = {{"C10", LAR_VALUE_CONSTANT},
                                                             {"D1", LAR_VALUE_SOFTNESS}};
static void lar_neo_hookean_read_abaqus(const double *given, double *p) {
    p[0] = 2.0 * given[0];
    p[1] = 2.0 / given[1];
}
static const lar_law_dialect lar_neo_hookean_abaqus =
    LAR_LAW_DIALECT("NEO HOOKE", lar_neo_hookean_constant, lar_neo_hookean_read_abaqus, NULL);

static double lar_neo_hookean_shear(const double *p) {
    return p[0];
}
static double lar_neo_hookean_bulk(const double *p) {
    return p[1];
}
static void lar_neo_hookean_from_moduli(double shear, double bulk, double *p) {
    p[0] = shear;
    p[1] = bulk;
}

static lar_law_slopes lar_neo_hookean_slopes(const double *p, const lar_law_invariants *is) {
    lar_law_slopes w = {0};
    lar_law_add_reduced(&w, p[0] / 2, is->I1, is->J, 1, &w.w1, &w.w1J);
    w.wJ += p[1] * (is->J - 1);
    w.wJJ += p[1];
    return w;
}
static void lar_neo_hookean_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_isotropic_tangent_of(lar_neo_hookean_slopes, p, F, A);
}

static lar_law_strained lar_neo_hookean_strained(const double *p, double J, double I1,
                                                 double area) {
    (void)I1, (void)area;
    return (lar_law_strained){
        .pressure = p[1] * (J - 1), .slope = p[1], .shear = 4 * p[0] / 3, .further = 0};
}

#endif

#endif
