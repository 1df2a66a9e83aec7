#include "mechanics/hex8_matrix.h"

#include <string.h>

#include "mechanics/hexahedron.h"

enum { FREEDOMS = 24, STRAINS = 6 };

/* Strains and stresses as six numbers: xx yy zz xy yz zx, shear strains doubled. */
static const int row_of[STRAINS] = {0, 1, 2, 0, 1, 2}, column_of[STRAINS] = {0, 1, 2, 1, 2, 0};

/* H = sum_a u_a (x) grad N_a */
static void displacement_gradient(const double gradient[8][3], const double u[8][3],
                                  double H[3][3]) {
    memset(H, 0, 9 * sizeof(double));
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) H[i][j] += u[a][i] * gradient[a][j];
}

/* The operator B_0 + share * B_1(u): share 0 the strain at rest, 1/2 Green's strain from u, 1 its
 * derivative by u. */
static void strain_operator(const double gradient[8][3], const double H[3][3], double share,
                            double B[STRAINS][FREEDOMS]) {
    for (int n = 0; n < STRAINS; n++) {
        int i = row_of[n], j = column_of[n];
        for (int a = 0; a < 8; a++)
            for (int k = 0; k < 3; k++) {
                double left = (k == i) + share * H[k][i], right = (k == j) + share * H[k][j];
                B[n][3 * a + k] =
                    i == j ? left * gradient[a][i] : left * gradient[a][j] + right * gradient[a][i];
            }
    }
}

/* E = 1/2 (H + H^T + H^T H): from its definition, not B_h u, so that a wrong B_h shows. */
static void green_strain(const double H[3][3], double strain[STRAINS]) {
    for (int n = 0; n < STRAINS; n++) {
        int i = row_of[n], j = column_of[n];
        double twice = H[i][j] + H[j][i];
        for (int k = 0; k < 3; k++) twice += H[k][i] * H[k][j];
        strain[n] = i == j ? 0.5 * twice : twice;
    }
}

/* S = F^-1 P; returns det F. */
static double second_piola(const lar_material *material, const double H[3][3], double S[3][3]) {
    double F[3][3], P[3][3], cof[9];
    memcpy(F, H, sizeof F);
    for (int i = 0; i < 3; i++) F[i][i] += 1;
    double J = lar_law_stress(material, (const double(*)[3])F, P);
    lar_lane_cofactor((const double *)F, cof);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            S[i][j] = (cof[i] * P[0][j] + cof[3 + i] * P[1][j] + cof[6 + i] * P[2][j]) / J;
    return J;
}

/* C_s with C_s E = S: the small-strain matrix and its rank-one correction. */
static void secant_material(const lar_material *material, const double strain[STRAINS],
                            const double stress[STRAINS], double C[STRAINS][STRAINS]) {
    double shear = lar_material_shear(material);
    double lame = lar_material_bulk(material) - 2 * shear / 3;
    double square = 0, rest[STRAINS];
    memset(C, 0, STRAINS * sizeof C[0]);
    for (int n = 0; n < STRAINS; n++) {
        C[n][n] = n < 3 ? 2 * shear : shear;
        for (int m = 0; n < 3 && m < 3; m++) C[n][m] += lame;
    }
    for (int n = 0; n < STRAINS; n++) {
        square += strain[n] * strain[n];
        rest[n] = stress[n];
        for (int m = 0; m < STRAINS; m++) rest[n] -= C[n][m] * strain[m];
    }
    if (!(square > 1e-24)) return; /* rest is of second order: nothing but rounding is left */
    for (int n = 0; n < STRAINS; n++)
        for (int m = 0; m < STRAINS; m++) C[n][m] += rest[n] * strain[m] / square;
}

/* K += volume * B_0^T (C_s B_h) */
static void add_material_part(const lar_material *material, const double gradient[8][3],
                              const double H[3][3], const double S[3][3], double volume,
                              double K[FREEDOMS][FREEDOMS]) {
    double left[STRAINS][FREEDOMS], right[STRAINS][FREEDOMS];
    double C[STRAINS][STRAINS], product[STRAINS][FREEDOMS];
    double strain[STRAINS], stress[STRAINS];
    strain_operator(gradient, H, 0, left);
    strain_operator(gradient, H, 0.5, right);
    green_strain(H, strain);
    for (int n = 0; n < STRAINS; n++) stress[n] = S[row_of[n]][column_of[n]];
    secant_material(material, strain, stress, C);
    for (int n = 0; n < STRAINS; n++)
        for (int m = 0; m < FREEDOMS; m++) {
            product[n][m] = 0;
            for (int k = 0; k < STRAINS; k++) product[n][m] += C[n][k] * right[k][m];
        }
    for (int n = 0; n < FREEDOMS; n++)
        for (int m = 0; m < FREEDOMS; m++) {
            double sum = 0;
            for (int k = 0; k < STRAINS; k++) sum += left[k][n] * product[k][m];
            K[n][m] += volume * sum;
        }
}

/* K += volume * B_N^T S^ B_N: grad N_a . S grad N_b for each axis alike. */
static void add_geometric_part(const double gradient[8][3], const double S[3][3], double volume,
                               double K[FREEDOMS][FREEDOMS]) {
    for (int a = 0; a < 8; a++)
        for (int b = 0; b < 8; b++) {
            double sum = 0;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) sum += gradient[a][i] * S[i][j] * gradient[b][j];
            for (int k = 0; k < 3; k++) K[3 * a + k][3 * b + k] += volume * sum;
        }
}

double lar_hex8_matrix_build(const double corner[8][3], const lar_material *material,
                             const double u[8][3], double K[24][24]) {
    double min = INFINITY;
    memset(K, 0, FREEDOMS * sizeof K[0]);
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        double at[3], gradient[8][3], H[3][3], S[3][3];
        lar_gauss_point(g, at);
        double volume = lar_hexahedron_gradients(corner, at, gradient);
        const double(*slopes)[3] = (const double(*)[3])gradient;
        displacement_gradient(slopes, u, H);
        double J = second_piola(material, (const double(*)[3])H, S);
        if (J < min || isnan(J)) min = J; /* a NaN stays: nothing is less */
        add_material_part(material, slopes, (const double(*)[3])H, (const double(*)[3])S, volume,
                          K);
        add_geometric_part(slopes, (const double(*)[3])S, volume, K);
    }
    return min;
}

double lar_hex8_matrix_force(const double corner[8][3], const lar_material *material,
                             const double u[8][3], double force[8][3]) {
    double K[FREEDOMS][FREEDOMS];
    double min = lar_hex8_matrix_build(corner, material, u, K);
    for (int n = 0; n < FREEDOMS; n++) {
        double sum = 0;
        for (int m = 0; m < FREEDOMS; m++) sum += K[n][m] * u[m / 3][m % 3];
        force[n / 3][n % 3] = sum;
    }
    return min;
}
