/* Yeoh's law (Yeoh 1993) of three terms, with the logarithmic volume term of FEBio:
 *     W = c1 x + c2 x^2 + c3 x^3 + K/2 (ln J)^2,     x = I1 J^(-2/3) - 3
 *     P = 2 s J^(-2/3) F + (K ln J - 2/3 s I1 J^(-2/3)) / J cof F,     s = c1 + 2 c2 x + 3 c3 x^2
 * p[0] = c1, p[1] = c2, p[2] = c3, p[3] = K. It stiffens as it is stretched (c3 > 0), so that the
 * stable step has to follow. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_YEOH_H
#define LAR_LAW_YEOH_H

#include "law/lane_math.h"

LAR_INLINE lar_lane lar_yeoh_stress(const lar_lane F[9], lar_lane P[9], lar_lane J, lar_lane I1,
                                    const lar_lane *p) {
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y;
    lar_lane x = lar_lane_fma(I1, y2, lar_lane_set(-3));
    lar_lane rise = lar_lane_fma(lar_lane_set(3) * p[2], x, lar_lane_set(2) * p[1]);
    lar_lane a = lar_lane_set(2) * lar_lane_fma(rise, x, p[0]) * y2;
    lar_lane b = lar_lane_fnma(a * I1, lar_lane_set(1.0 / 3), p[3] * lar_lane_log(J)) * (y * y2);
#pragma GCC unroll 9
    for (int k = 0; k < 9; k++) P[k] = lar_lane_fma(b, P[k], a * F[k]);
    lar_lane bI1 = b * I1;
    return lar_lane_fma(bI1, bI1, a * a * I1);
}

LAR_INLINE lar_lane lar_yeoh_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                    const lar_lane *p) {
    (void)F;
    lar_lane y = lar_lane_rcbrt(J), log_J = lar_lane_log(J);
    lar_lane x = lar_lane_fma(I1, y * y, lar_lane_set(-3));
    lar_lane series = lar_lane_fma(lar_lane_fma(p[2], x, p[1]), x, p[0]);
    return lar_lane_fma(series, x, lar_lane_set(0.5) * p[3] * log_J * log_J);
}

/* The slope s pulls all directions alike, as a shear modulus 2 s does. Along F itself, without what
 * changes the volume, there is 4 s' J^(-4/3) D^2 more, D^2 = |F - I1/3 F^-T|^2, that is a shear
 * modulus larger by half of it. 8/3 s and 8/3 of the other make up 4/3 of the modulus; with the
 * lengths of an element, its areas and K this is lar_hex8_growth but for U(J). */
LAR_INLINE unsigned lar_yeoh_stiffened(lar_lane J, lar_lane I1, lar_lane area, const lar_lane *p,
                                       lar_lane share) {
    const lar_lane none = lar_lane_set(0), part = lar_lane_set(8.0 / 3);
    lar_lane y = lar_lane_rcbrt(J);
    lar_lane y2 = y * y;
    lar_lane x = lar_lane_fma(I1, y2, lar_lane_set(-3));
    lar_lane cubic = lar_lane_set(3) * p[2] * x;
    lar_lane slope = (lar_lane_set(2) * p[1] + cubic) * x;
    lar_lane rise = lar_lane_set(2) * (p[1] + cubic);
    lar_lane D2 = I1 * y2 * (I1 * area * lar_lane_set(1.0 / 9) / (J * J) - lar_lane_set(1)) * y2;
    lar_lane wider = area * lar_lane_set(1.0 / 3), longer = wider / (J * J);
    lar_lane shear = (p[0] + lar_lane_max(slope, none)) * lar_lane_max(longer, lar_lane_set(1)) +
                     lar_lane_max(rise, none) * D2;
    lar_lane max = (share + lar_lane_set(1)) * lar_lane_fma(part, p[0], p[3]);
    return ~lar_lane_not_greater(lar_lane_fma(part, shear, p[3] * wider), max) &
           ((1U << LAR_LANES) - 1);
}

#ifdef LAR_LAW_ROWS

static const char lar_yeoh_name[] = "yeoh", lar_yeoh_title[] = "Yeoh";
static const lar_law_parameter lar_yeoh_parameter[] = {{"c1", LAR_VALUE_MODULUS},
                                                       {"c2", LAR_VALUE_CONSTANT},
                                                       {"c3", LAR_VALUE_CONSTANT},
                                                       {"bulk_modulus", LAR_VALUE_MODULUS}};
enum { lar_yeoh_history = 0, lar_yeoh_fibres = 0, lar_yeoh_uncoupled = 1 };

static const lar_law_parameter lar_yeoh_febio_parameter[] = {
    {"c1", LAR_VALUE_CONSTANT}, {"c2", LAR_VALUE_OPTIONAL}, {"c3", LAR_VALUE_OPTIONAL},
    {"k", LAR_VALUE_MODULUS},   {"c4", LAR_VALUE_NOT_OURS}, {"c5", LAR_VALUE_NOT_OURS},
    {"c6", LAR_VALUE_NOT_OURS}};
static void lar_yeoh_read_febio(const double *given, double *p) {
    for (int k = 0; k < 4; k++) p[k] = given[k];
}
static const lar_law_dialect lar_yeoh_febio =
    LAR_LAW_DIALECT("Yeoh", lar_yeoh_febio_parameter, lar_yeoh_read_febio, "k/2 (ln J)^2");

/* Abaqus: U = sum_i Ci0 (I1' - 3)^i + sum_i (J - 1)^(2 i) / Di. */
static const lar_law_parameter lar_yeoh_constant[] = {
    {"C10", LAR_VALUE_CONSTANT}, {"C20", LAR_VALUE_OPTIONAL}, {"C30", LAR_VALUE_OPTIONAL},
    {"D1", LAR_VALUE_SOFTNESS},  {"D2", LAR_VALUE_NOT_OURS},  {"D3", LAR_VALUE_NOT_OURS}};
static void lar_yeoh_read_abaqus(const double *given, double *p) {
    for (int k = 0; k < 3; k++) p[k] = given[k];
    p[3] = 2.0 / given[3];
}
static const lar_law_dialect lar_yeoh_abaqus = LAR_LAW_SERIES(
    "YEOH", lar_yeoh_constant, lar_yeoh_read_abaqus, "K/2 (ln J)^2", "REDUCED POLYNOMIAL", 1);

static double lar_yeoh_shear(const double *p) {
    return 2.0 * p[0];
}
static double lar_yeoh_bulk(const double *p) {
    return p[3];
}
static void lar_yeoh_from_moduli(double shear, double bulk, double *p) {
    p[0] = shear / 2.0;
    p[1] = p[2] = 0;
    p[3] = bulk;
}

static lar_law_slopes lar_yeoh_slopes(const double *p, const lar_law_invariants *is) {
    double y2 = lar_law_reduced(is->J), x = is->I1 * y2 - 3;
    double s = p[0] + 2 * p[1] * x + 3 * p[2] * x * x, rise = 2 * p[1] + 6 * p[2] * x;
    double by_J = -2.0 / 3 * is->I1 * y2 / is->J; /* dx/dJ */
    lar_law_slopes w = {.w11 = rise * y2 * y2, .w1J = rise * y2 * by_J, .wJJ = rise * by_J * by_J};
    lar_law_add_reduced(&w, s, is->I1, is->J, 1, &w.w1, &w.w1J);
    lar_law_add_logarithmic(&w, p[3], is->J);
    return w;
}
static void lar_yeoh_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_isotropic_tangent_of(lar_yeoh_slopes, p, F, A);
}

static lar_law_strained lar_yeoh_strained(const double *p, double J, double I1, double area) {
    double log_J = lar_lane_log(J), y = lar_lane_rcbrt(J); /* the same bits everywhere */
    double x = I1 * y * y - 3, D2 = I1 * y * y * (I1 * area / (9 * J * J) - 1) * y * y;
    double slope = (2 * p[1] + 3 * p[2] * x) * x, rise = 2 * p[1] + 6 * p[2] * x;
    return (lar_law_strained){.pressure = p[3] * log_J / J,
                              .slope = p[3] * (1 - log_J) / (J * J),
                              .shear = 8 * (p[0] + fmax(slope, 0)) / 3,
                              .further = 8 * fmax(rise, 0) * fmax(D2, 0) / 3};
}

#endif

#endif
