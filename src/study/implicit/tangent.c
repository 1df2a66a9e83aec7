#include "study/implicit/tangent.h"

#include <string.h>

#include "model/mesh/mesh.h"

void lar_law_tangent(const lar_material *material, const double F[3][3], double A[9][9]) {
    lar_law_table[material->law].tangent(material->parameter, &F[0][0], A);
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
