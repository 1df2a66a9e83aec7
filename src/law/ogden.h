/* Ogden's law (1972) of three terms in stretches without their change of volume, l_a = J^(-1/3)
 * times the stretches, with the logarithmic volume term, both as FEBio has them:
 *     W = sum_i c_i / m_i^2 (l_0^m_i + l_1^m_i + l_2^m_i - 3) + K/2 (ln J)^2
 *     P = F S + K ln J / J cof F,     S_a = (b_a - (b_0 + b_1 + b_2)/3) / (stretch a)^2,
 *     b_a = sum_i c_i / m_i l_a^m_i
 * S is a function of C = F^T F (law/spectrum.h). Powers are e^(m h) with h_a = ln l_a, whose sum is
 * zero; e^(m h) - 1 keeps the digits of small strains.
 * p[0], p[1] = c_1, m_1 and so on, p[6] = K; c in pascal, m numbers; m = 0 where c = 0. The shear
 * modulus at rest is half the sum of c. law/lanes.h says what is called how.
 */
#ifndef LAR_LAW_OGDEN_H
#define LAR_LAW_OGDEN_H

#include "law/kinematics.h"
#include "law/principal.h"

enum { LAR_OGDEN_TERMS = 3 };

/* h from the squares of the stretches, whose product is J^2. */
LAR_INLINE void lar_ogden_logs(const lar_lane c[3], lar_lane log_J, lar_lane h[3]) {
    lar_lane mean = lar_lane_set(1.0 / 3) * log_J;
#pragma GCC unroll 2
    for (int a = 0; a < 2; a++) h[a] = lar_lane_fma(lar_lane_set(0.5), lar_lane_log(c[a]), -mean);
    h[2] = -(h[0] + h[1]);
}

/* The power of a term, where it may be zero a number that nobody has. */
LAR_INLINE lar_lane lar_ogden_power(const lar_lane *p, int term) {
    return p[2 * term + 1] + lar_lane_set(LAR_LANE_TINY);
}

/* b_a less their mean. */
LAR_LONG void lar_ogden_pull(const lar_lane h[3], const lar_lane *p, lar_lane b[3]) {
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) b[a] = lar_lane_set(0);
#pragma GCC unroll 1 /* three exponentials are long enough */
    for (int i = 0; i < LAR_OGDEN_TERMS; i++) {
        lar_lane m = lar_ogden_power(p, i), factor = p[2 * i] / m;
#pragma GCC unroll 3
        for (int a = 0; a < 3; a++) b[a] = lar_lane_fma(factor, lar_lane_expm1(m * h[a]), b[a]);
    }
    lar_lane mean = (b[0] + b[1] + b[2]) * lar_lane_set(1.0 / 3);
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) b[a] = b[a] - mean;
}

LAR_INLINE lar_lane lar_ogden_stress(const lar_lane F[9], lar_lane P[9], lar_lane J, lar_lane I1,
                                     const lar_lane *p) {
    static const int symmetric[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    lar_lane_spectrum s;
    lar_lane h[3], f[3], S[6], sum = lar_lane_set(0), by = lar_lane_set(1) / J;
    lar_lane log_J = lar_lane_log(J);
    lar_lane_spectrum_of(F, I1, &s);
    lar_ogden_logs(s.c, log_J, h);
    lar_ogden_pull(h, p, f);
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) {
        const int next = (a + 1) % 3, last = (a + 2) % 3;
        lar_lane pull = f[a];
        f[a] = (pull * by * by) * (s.c[next] * s.c[last]); /* by c, whose product is J^2 */
        sum = lar_lane_fma(pull, f[a], sum);
    }
    lar_lane_spectral(&s, f, S);
    lar_lane b = p[6] * log_J * by;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++)
#pragma GCC unroll 3
        for (int j = 0; j < 3; j++) {
            lar_lane pull = lar_lane_fma(
                F[3 * i], S[symmetric[0][j]],
                lar_lane_fma(F[3 * i + 1], S[symmetric[1][j]], F[3 * i + 2] * S[symmetric[2][j]]));
            P[3 * i + j] = lar_lane_fma(b, P[3 * i + j], pull);
        }
    lar_lane bI1 = b * I1;
    return lar_lane_fma(bI1, bI1, sum);
}

LAR_INLINE lar_lane lar_ogden_energy(const lar_lane F[9], lar_lane J, lar_lane I1,
                                     const lar_lane *p) {
    lar_lane_spectrum s;
    lar_lane h[3], log_J = lar_lane_log(J), W = lar_lane_set(0.5) * p[6] * log_J * log_J;
    lar_lane_spectrum_of(F, I1, &s);
    lar_ogden_logs(s.c, log_J, h);
    for (int i = 0; i < LAR_OGDEN_TERMS; i++) {
        lar_lane m = lar_ogden_power(p, i), sum = lar_lane_set(0);
        for (int a = 0; a < 3; a++) sum = sum + lar_lane_expm1(m * h[a]);
        W = lar_lane_fma(p[2 * i] / m, sum / m, W);
    }
    return W;
}

/* Derivatives by the stretches, without the volume term. With t_a = l_a dW/dl_a less their mean and
 * t_ab = dt_a/dh_b: w_a = t_a / l_a, w_ab = (t_ab - delta_ab t_a) / (l_a l_b). */
LAR_INLINE void lar_ogden_principal(const lar_lane c[3], lar_lane log_J, const lar_lane *p,
                                    lar_principal *w) {
    const lar_lane third = lar_lane_set(1.0 / 3), ninth = lar_lane_set(1.0 / 9);
    lar_lane h[3], t[3], e[3] = {lar_lane_set(0), lar_lane_set(0), lar_lane_set(0)};
    lar_ogden_logs(c, log_J, h);
    lar_ogden_pull(h, p, t);
#pragma GCC unroll 1
    for (int i = 0; i < LAR_OGDEN_TERMS; i++)
        for (int a = 0; a < 3; a++)
            e[a] = lar_lane_fma(p[2 * i], lar_lane_exp(p[2 * i + 1] * h[a]), e[a]);
    lar_lane sum = (e[0] + e[1] + e[2]) * ninth;
    for (int a = 0; a < 3; a++) {
        w->stretch[a] = lar_lane_sqrt(c[a]);
        w->first[a] = t[a] / w->stretch[a];
        w->second[a] = (lar_lane_fma(third, e[a], sum) - t[a]) / c[a];
    }
    for (int pair = 0; pair < 3; pair++) {
        const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
        w->mixed[pair] = lar_lane_fnma(third, e[a] + e[b], sum) / (w->stretch[a] * w->stretch[b]);
    }
}

/* Its largest stiffness but for volume, 2 G at rest and never counted below, and 2/3 G less, so
 * that 4/3 G are left at rest. */
LAR_INLINE lar_lane lar_ogden_further(lar_lane J, lar_lane I1, lar_lane area, const lar_lane *p) {
    lar_lane c[3], all, twice = p[0] + p[2] + p[4];
    lar_principal w;
    lar_lane_stretch_squares(I1, area, J, c);
    lar_ogden_principal(c, lar_lane_log(J), p, &w);
    (void)lar_principal_largest(&w, &all);
    return lar_lane_max(all, twice) - twice * lar_lane_set(1.0 / 3);
}

LAR_INLINE unsigned lar_ogden_stiffened(lar_lane J, lar_lane I1, lar_lane area, const lar_lane *p,
                                        lar_lane share) {
    lar_lane rest = lar_lane_fma(lar_lane_set(2.0 / 3), p[0] + p[2] + p[4], p[6]);
    lar_lane now =
        lar_lane_fma(p[6], area * lar_lane_set(1.0 / 3), lar_ogden_further(J, I1, area, p));
    return ~lar_lane_not_greater(now, (share + lar_lane_set(1)) * rest) & ((1U << LAR_LANES) - 1);
}

#ifdef LAR_LAW_ROWS

static const char lar_ogden_name[] = "ogden", lar_ogden_title[] = "Ogden";
static const lar_law_parameter lar_ogden_parameter[] = {
    {"c1", LAR_VALUE_CONSTANT},         {"m1", LAR_VALUE_POWER},
    {"c2", LAR_VALUE_OPTIONAL},         {"m2", LAR_VALUE_POWER},
    {"c3", LAR_VALUE_OPTIONAL},         {"m3", LAR_VALUE_POWER},
    {"bulk_modulus", LAR_VALUE_MODULUS}};
#define lar_ogden_slopes NULL
enum { lar_ogden_history = 0, lar_ogden_fibres = 0, lar_ogden_uncoupled = 1 };

static const lar_law_parameter lar_ogden_febio_parameter[] = {
    {"c1", LAR_VALUE_CONSTANT}, {"c2", LAR_VALUE_OPTIONAL}, {"c3", LAR_VALUE_OPTIONAL},
    {"m1", LAR_VALUE_POWER},    {"m2", LAR_VALUE_POWER},    {"m3", LAR_VALUE_POWER},
    {"k", LAR_VALUE_MODULUS},   {"c4", LAR_VALUE_NOT_OURS}, {"c5", LAR_VALUE_NOT_OURS},
    {"c6", LAR_VALUE_NOT_OURS}, {"m4", LAR_VALUE_POWER},    {"m5", LAR_VALUE_POWER},
    {"m6", LAR_VALUE_POWER}};
static void lar_ogden_read_febio(const double *given, double *p) {
    for (int i = 0; i < LAR_OGDEN_TERMS; i++) {
        p[2 * i] = given[i];
        p[2 * i + 1] = given[3 + i];
    }
    p[6] = given[6];
}
static const lar_law_dialect lar_ogden_febio =
    LAR_LAW_DIALECT("Ogden", lar_ogden_febio_parameter, lar_ogden_read_febio, "k/2 (ln J)^2");

/* Abaqus: U = sum_i 2 MUi / ALPHAi^2 (...) + sum_i (J - 1)^(2 i) / Di. */
static const lar_law_parameter lar_ogden_constant[] = {
    {"MU1", LAR_VALUE_CONSTANT}, {"ALPHA1", LAR_VALUE_POWER}, {"MU2", LAR_VALUE_OPTIONAL},
    {"ALPHA2", LAR_VALUE_POWER}, {"MU3", LAR_VALUE_OPTIONAL}, {"ALPHA3", LAR_VALUE_POWER},
    {"D1", LAR_VALUE_SOFTNESS},  {"D2", LAR_VALUE_NOT_OURS},  {"D3", LAR_VALUE_NOT_OURS}};
static void lar_ogden_read_abaqus(const double *given, double *p) {
    for (int i = 0; i < LAR_OGDEN_TERMS; i++) {
        p[2 * i] = 2.0 * given[2 * i];
        p[2 * i + 1] = given[2 * i + 1];
    }
    p[6] = 2.0 / given[6];
}
static const lar_law_dialect lar_ogden_abaqus =
    LAR_LAW_SERIES("OGDEN", lar_ogden_constant, lar_ogden_read_abaqus, "K/2 (ln J)^2", "OGDEN", 2);

static double lar_ogden_shear(const double *p) {
    return (p[0] + p[2] + p[4]) / 2.0;
}
static double lar_ogden_bulk(const double *p) {
    return p[6];
}
static void lar_ogden_from_moduli(double shear, double bulk, double *p) {
    p[0] = 2.0 * shear;
    p[1] = 2;
    p[2] = p[3] = p[4] = p[5] = 0;
    p[6] = bulk;
}

static void lar_ogden_tangent(const double *p, const double F[9], double A[9][9]) {
    lar_law_invariants is = lar_law_invariants_of(F);
    lar_law_slopes volume = {0};
    lar_principal w;
    double N[3][3], stretch[3], c[3];
    lar_law_add_logarithmic(&volume, p[6], is.J);
    lar_isotropic_tangent(&volume, &is, F, A);
    lar_principal_frame(F, N, stretch);
    for (int a = 0; a < 3; a++) c[a] = stretch[a] * stretch[a];
    lar_ogden_principal(c, lar_lane_log(is.J), p, &w);
    lar_principal_tangent(&w, F, (const double(*)[3])N, A);
}

static lar_law_strained lar_ogden_strained(const double *p, double J, double I1, double area) {
    double log_J = lar_lane_log(J);
    return (lar_law_strained){.pressure = p[6] * log_J / J,
                              .slope = p[6] * (1 - log_J) / (J * J),
                              .shear = 0,
                              .further = lar_ogden_further(J, I1, area, p)};
}

#endif

#endif
