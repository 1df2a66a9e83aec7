#include "mechanics/hexahedron.h"

#include <string.h>

#include "mechanics/stress.h"
#include "model/mesh/mesh.h"

void lar_gauss_point(int g, double at[3]) {
    for (int k = 0; k < 3; k++) at[k] = lar_node_sign[g][k] / sqrt(3.0);
}

/* dN_a/dxi */
static void natural_slope(int a, const double at[3], double slope[3]) {
    double n[3];
    for (int k = 0; k < 3; k++) n[k] = 1 + lar_node_sign[a][k] * at[k];
    for (int k = 0; k < 3; k++)
        slope[k] = lar_node_sign[a][k] * n[(k + 1) % 3] * n[(k + 2) % 3] / 8;
}

void lar_hexahedron_jacobian(const double corner[8][3], const double at[3], double J[3][3]) {
    memset(J, 0, 9 * sizeof(double));
    for (int a = 0; a < 8; a++) {
        double slope[3];
        natural_slope(a, at, slope);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) J[i][k] += corner[a][i] * slope[k];
    }
}

double lar_hexahedron_gradients(const double corner[8][3], const double at[3],
                                double gradient[8][3]) {
    double J[3][3], cof[9];
    lar_hexahedron_jacobian(corner, at, J);
    double det = lar_lane_cofactor((const double *)J, cof);
    for (int a = 0; a < 8; a++) {
        double slope[3];
        natural_slope(a, at, slope);
        for (int i = 0; i < 3; i++) /* J^-T slope */
            gradient[a][i] =
                (cof[3 * i] * slope[0] + cof[3 * i + 1] * slope[1] + cof[3 * i + 2] * slope[2]) /
                det;
    }
    return det;
}
