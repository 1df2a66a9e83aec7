#include "study/implicit/tangent.h"

#include <math.h>
#include <string.h>

#include "model/mesh/mesh.h"

/* Derivatives of w(I1, I2, J). */
typedef struct law_slopes {
    double w1, w2, wJ, w1J, w2J, wJJ;
} law_slopes;

/* Adds c I_n J^power, n = 1 or 2: the value of I_n is `invariant`; *first, *mixed are w_n, w_nJ. */
static void add_reduced(law_slopes *w, double c, double invariant, double J, double power,
                        double *first, double *mixed) {
    double value = c * pow(J, power);
    *first += value;
    *mixed += power * value / J;
    w->wJ += power * invariant * value / J;
    w->wJJ += power * (power - 1) * invariant * value / (J * J);
}

/* Adds modulus/2 (ln J)^2. */
static void add_logarithmic(law_slopes *w, double modulus, double J) {
    w->wJ += modulus * log(J) / J;
    w->wJJ += modulus * (1 - log(J)) / (J * J);
}

static law_slopes slopes(const lar_material *material, double I1, double I2, double J) {
    const double *p = material->parameter;
    law_slopes w = {0};
    switch (material->law) {
    case LAR_LAW_neo_hookean:
        add_reduced(&w, p[0] / 2, I1, J, -2.0 / 3, &w.w1, &w.w1J);
        w.wJ += p[1] * (J - 1);
        w.wJJ += p[1];
        break;
    case LAR_LAW_coupled_neo_hookean: /* mu/2 I1 - mu ln J + lambda/2 (ln J)^2 */
        w.w1 = p[0] / 2;
        w.wJ = -p[0] / J;
        w.wJJ = p[0] / (J * J);
        add_logarithmic(&w, p[1], J);
        break;
    case LAR_LAW_mooney_rivlin:
        add_reduced(&w, p[0], I1, J, -2.0 / 3, &w.w1, &w.w1J);
        add_reduced(&w, p[1], I2, J, -4.0 / 3, &w.w2, &w.w2J);
        add_logarithmic(&w, p[2], J);
        break;
    case LAR_LAW_COUNT:
        break;
    }
    return w;
}

/* cof'_ij,kl = eps_ikm eps_jln F_mn, times `factor`. */
static void add_cofactor_slope(double factor, const double F[3][3], double A[9][9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int s = 1; s <= 2; s++)
                for (int t = 1; t <= 2; t++) {
                    int k = (i + s) % 3, l = (j + t) % 3, m = 3 - i - k, n = 3 - j - l;
                    A[3 * i + j][3 * k + l] += (s == t ? factor : -factor) * F[m][n];
                }
}

/* I2'' and I2' for I2 = (I1^2 - tr(C C)) / 2: I2' = 2 (I1 F - F F^T F); I2'' times `factor`. */
static void second_invariant(double factor, double I1, const double F[3][3], double slope[9],
                             double A[9][9]) {
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

void lar_law_tangent(const lar_material *material, const double F[3][3], double A[9][9]) {
    double C[9], slope[9], I2 = 0;
    double J = lar_lane_cofactor(&F[0][0], C), I1 = lar_lane_square_sum(&F[0][0]);
    for (int k = 0; k < 9; k++) I2 += C[k] * C[k];
    law_slopes w = slopes(material, I1, I2, J);
    memset(A, 0, 81 * sizeof A[0][0]);
    add_cofactor_slope(w.wJ, F, A);
    second_invariant(w.w2, I1, F, slope, A);
    for (int r = 0; r < 9; r++) {
        A[r][r] += 2 * w.w1;
        double row = 2 * w.w1J * F[r / 3][r % 3] + w.w2J * slope[r];
        for (int s = 0; s < 9; s++)
            A[r][s] += row * C[s] + w.wJJ * C[r] * C[s] +
                       C[r] * (2 * w.w1J * F[s / 3][s % 3] + w.w2J * slope[s]);
    }
}

/* h_m(a), m = 0..6 as in hex8.h. */
static void signs(int a, double h[7]) {
    double x = lar_node_sign[a][0], y = lar_node_sign[a][1], z = lar_node_sign[a][2];
    double all[7] = {x, y, z, y * z, x * z, x * y, x * y * z};
    memcpy(h, all, sizeof all);
}

/* g_a and Q_k(a) of the head comment. */
static void nodal_shapes(const lar_hex8 *element, double g[8][3], double Q[LAR_HEX8_HOURGLASS][8]) {
    for (int a = 0; a < 8; a++) {
        double h[7];
        signs(a, h);
        for (int i = 0; i < 3; i++) {
            g[a][i] = 0;
            for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) g[a][i] += h[m] * element->gradient[m][i];
        }
        for (int k = 0; k < LAR_HEX8_HOURGLASS; k++) {
            Q[k][a] = h[3 + k];
            for (int i = 0; i < 3; i++) Q[k][a] -= g[a][i] * element->shape[k][i];
        }
    }
}

double lar_hex8_tangent(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                        double K[24][24]) {
    double F[3][3], A[9][9], g[8][3], Q[LAR_HEX8_HOURGLASS][8], cof[9];
    lar_hex8_gradient(element, u, F);
    nodal_shapes(element, g, Q);
    lar_law_tangent(material, (const double(*)[3])F, A);
    for (int b = 0; b < 8; b++)
        for (int k = 0; k < 3; k++) {
            double stress[9]; /* V dP by a unit displacement of node b along axis k */
            for (int r = 0; r < 9; r++) {
                stress[r] = 0;
                for (int l = 0; l < 3; l++) stress[r] += A[r][3 * k + l] * g[b][l];
                stress[r] *= element->volume;
            }
            for (int a = 0; a < 8; a++)
                for (int i = 0; i < 3; i++) {
                    double sum = 0;
                    for (int j = 0; j < 3; j++) sum += stress[3 * i + j] * g[a][j];
                    for (int q = 0; i == k && q < LAR_HEX8_HOURGLASS; q++)
                        sum += element->stiffness[q] * Q[q][a] * Q[q][b];
                    K[3 * a + i][3 * b + k] = sum;
                }
        }
    return lar_lane_cofactor((const double *)F, cof);
}
