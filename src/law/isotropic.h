/* The tangent of an isotropic law, from its derivatives by the invariants. In plain numbers, for
 * the rows of the laws (law/law.c): implicit solvers use it, and the engine where it must know how
 * fast strained elements of compressible tissue are (step/mass/compressible.h).
 *
 * A law is w(I1, I2, J) with I1 = |F|^2, I2 = |cof F|^2, and P = dw/dF. I2 stands in it linearly
 * and not in products with I1, thus
 *
 *     dP/dF = 2 w_1 1 + 4 w_11 F (x) F + w_2 I2'' + w_J cof' + w_JJ C (x) C
 *             + w_1J (2F (x) C + C (x) 2F) + w_2J (I2' (x) C + C (x) I2'),      C = cof F
 *
 * and a law is seven numbers. No libm: the same bits everywhere.
 */
#ifndef LAR_LAW_ISOTROPIC_H
#define LAR_LAW_ISOTROPIC_H

#include <math.h>
#include <string.h>

#include "law/kinematics.h"
#include "law/lane_math.h"
#include "law/law.h"

static inline lar_law_invariants lar_law_invariants_of(const double F[9]) {
    lar_law_invariants is = {0};
    is.J = lar_lane_cofactor(F, is.cof);
    is.I1 = lar_lane_square_sum(F);
    for (int k = 0; k < 9; k++) is.I2 += is.cof[k] * is.cof[k];
    return is;
}

/* J^(-2/3), with the same bits everywhere. */
static inline double lar_law_reduced(double J) {
    double y = lar_lane_rcbrt(J);
    return y * y;
}

/* Adds c I_n J^(-2n/3), n = 1 or 2: the value of I_n is `invariant`; *first, *mixed are w_n, w_nJ.
 */
static inline void lar_law_add_reduced(lar_law_slopes *w, double c, double invariant, double J,
                                       int n, double *first, double *mixed) {
    double y2 = lar_law_reduced(J), power = -2.0 / 3 * n;
    double value = c * (n == 1 ? y2 : y2 * y2);
    *first += value;
    *mixed += power * value / J;
    w->wJ += power * invariant * value / J;
    w->wJJ += power * (power - 1) * invariant * value / (J * J);
}

/* Adds what a law that is curved in x = I1 J^(-2/3) - 3 has beyond its slope: `rise` = w''(x). */
static inline void lar_law_add_rise(lar_law_slopes *w, double rise, const lar_law_invariants *is) {
    double y2 = lar_law_reduced(is->J), by_J = -2.0 / 3 * is->I1 * y2 / is->J; /* dx/dJ */
    w->w11 += rise * y2 * y2;
    w->w1J += rise * y2 * by_J;
    w->wJJ += rise * by_J * by_J;
}

/* Adds modulus/2 (ln J)^2. */
static inline void lar_law_add_logarithmic(lar_law_slopes *w, double modulus, double J) {
    double log_J = lar_lane_log(J);
    w->wJ += modulus * log_J / J;
    w->wJJ += modulus * (1 - log_J) / (J * J);
}

/* cof'_ij,kl = eps_ikm eps_jln F_mn, times `factor`. */
static inline void lar_law_add_cofactor(double factor, const double f[9], double A[9][9]) {
    const double(*F)[3] = (const double(*)[3])f;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int s = 1; s <= 2; s++)
                for (int t = 1; t <= 2; t++) {
                    int k = (i + s) % 3, l = (j + t) % 3, m = 3 - i - k, n = 3 - j - l;
                    A[3 * i + j][3 * k + l] += (s == t ? factor : -factor) * F[m][n];
                }
}

/* I2'' and I2' for I2 = (I1^2 - tr(C C)) / 2: I2' = 2 (I1 F - F F^T F); I2'' times `factor`. */
static inline void lar_law_second_invariant(double factor, double I1, const double f[9],
                                            double slope[9], double A[9][9]) {
    const double(*F)[3] = (const double(*)[3])f;
    double left[3][3] = {{0}}, right[3][3] = {{0}}; /* F F^T and F^T F */
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) {
                left[i][j] += F[i][k] * F[j][k];
                right[i][j] += F[k][i] * F[k][j];
            }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            slope[3 * i + j] = I1 * F[i][j];
            for (int k = 0; k < 3; k++) slope[3 * i + j] -= left[i][k] * F[k][j];
            slope[3 * i + j] *= 2;
            for (int k = 0; k < 3; k++)
                for (int l = 0; l < 3; l++) {
                    double sum = 2 * F[k][l] * F[i][j] - F[i][l] * F[k][j];
                    if (i == k && j == l) sum += I1;
                    if (i == k) sum -= right[l][j];
                    if (j == l) sum -= left[i][k];
                    A[3 * i + j][3 * k + l] += 2 * factor * sum;
                }
        }
}

static inline void lar_isotropic_tangent(const lar_law_slopes *w, const lar_law_invariants *is,
                                         const double F[9], double A[9][9]) {
    const double *C = is->cof;
    double slope[9];
    memset(A, 0, 81 * sizeof A[0][0]);
    lar_law_add_cofactor(w->wJ, F, A);
    lar_law_second_invariant(w->w2, is->I1, F, slope, A);
    for (int r = 0; r < 9; r++) {
        A[r][r] += 2 * w->w1;
        double row = 2 * w->w1J * F[r] + w->w2J * slope[r];
        for (int s = 0; s < 9; s++)
            A[r][s] += 4 * w->w11 * F[r] * F[s] + row * C[s] + w->wJJ * C[r] * C[s] +
                       C[r] * (2 * w->w1J * F[s] + w->w2J * slope[s]);
    }
}

static inline void lar_isotropic_tangent_of(lar_law_slopes (*slopes)(const double *p,
                                                                     const lar_law_invariants *is),
                                            const double *p, const double F[9], double A[9][9]) {
    lar_law_invariants is = lar_law_invariants_of(F);
    lar_law_slopes w = slopes(p, &is);
    lar_isotropic_tangent(&w, &is, F, A);
}

#endif
