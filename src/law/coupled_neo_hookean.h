/* The coupled neo-Hookean law (FEBio "neo-Hookean"; Bonet and Wood 1997), Lame's mu and lambda:
 *     W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2
 *     P = mu F + (lambda ln J - mu)/J cof F
 * p[0] = mu, p[1] = lambda. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_COUPLED_NEO_HOOKEAN_H
#define LAR_LAW_COUPLED_NEO_HOOKEAN_H

#include "law/lane_math.h"

LAR_INLINE lar_lane lar_coupled_neo_hookean_stress(const lar_lane F[9], lar_lane P[9], lar_lane J,
                                                   lar_lane I1, const lar_lane *p) {
    lar_lane a = p[0];
    lar_lane b = (p[1] * lar_lane_log(J) - a) / J;
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fma(b, P[k], a * F[k]);
    lar_lane bI1 = b * I1;
    return lar_lane_fma(bI1, bI1, a * a * I1);
}

LAR_INLINE lar_lane lar_coupled_neo_hookean_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                                   const lar_lane *p) {
    (void)F;
    lar_lane log_J = lar_lane_log(J);
    lar_lane shear = lar_lane_fma(lar_lane_set(-2), log_J, I1 - lar_lane_set(3));
    return lar_lane_set(0.5) * (p[0] * shear + p[1] * log_J * log_J);
}

LAR_INLINE unsigned lar_coupled_neo_hookean_stiffened(lar_lane J, lar_lane I1, lar_lane area,
                                                      const lar_lane *p, lar_lane share) {
    (void)J, (void)I1, (void)area, (void)p, (void)share;
    return 0;
}

#ifdef LAR_LAW_ROWS

static const char lar_coupled_neo_hookean_name[] = "coupled-neo-hookean",
                  lar_coupled_neo_hookean_title[] = "coupled neo-Hookean";
static const lar_law_parameter lar_coupled_neo_hookean_parameter[] = {
    {"mu", LAR_VALUE_MODULUS}, {"lambda", LAR_VALUE_CONSTANT}};
static const lar_law_dialect lar_coupled_neo_hookean_abaqus = LAR_LAW_NO_DIALECT;
enum {
    lar_coupled_neo_hookean_history = 0,
    lar_coupled_neo_hookean_fibres = 0,
    lar_coupled_neo_hookean_uncoupled = 0
};

static const lar_law_parameter lar_coupled_neo_hookean_young[] = {{"E", LAR_VALUE_MODULUS},
                                                                  {"v", LAR_VALUE_RATIO}};
static void lar_coupled_neo_hookean_read_febio(const double *given, double *p) {
    double young = given[0], poisson = given[1];
    p[0] = young / (2.0 * (1.0 + poisson));
    p[1] = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
}
static const lar_law_dialect lar_coupled_neo_hookean_febio = LAR_LAW_DIALECT(
    "neo-Hookean", lar_coupled_neo_hookean_young, lar_coupled_neo_hookean_read_febio, NULL);

static double lar_coupled_neo_hookean_shear(const double *p) {
    return p[0];
}
static double lar_coupled_neo_hookean_bulk(const double *p) {
    return p[1] + 2.0 * p[0] / 3.0;
}
static void lar_coupled_neo_hookean_from_moduli(double shear, double bulk, double *p) {
    p[0] = shear;
    p[1] = bulk - 2.0 * shear / 3.0;
}

static lar_law_slopes lar_coupled_neo_hookean_slopes(const double *p,
                                                     const lar_law_invariants *is) {
    lar_law_slopes w = {.w1 = p[0] / 2, .wJ = -p[0] / is->J, .wJJ = p[0] / (is->J * is->J)};
    lar_law_add_logarithmic(&w, p[1], is->J);
    return w;
}
static void lar_coupled_neo_hookean_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_isotropic_tangent_of(lar_coupled_neo_hookean_slopes, p, F, A);
}

/* The volume term is lambda/2 (ln J)^2 - mu ln J, and of its pressure I1 holds the second part. */
static lar_law_strained lar_coupled_neo_hookean_strained(const double *p, double J, double I1,
                                                         double area) {
    double log_J = lar_lane_log(J); /* the same bits everywhere */
    (void)I1, (void)area;
    return (lar_law_strained){.pressure = p[1] * log_J / J,
                              .slope = (p[1] * (1 - log_J) + p[0]) / (J * J),
                              .shear = 4 * p[0] / 3,
                              .further = 0};
}

#endif

#endif
