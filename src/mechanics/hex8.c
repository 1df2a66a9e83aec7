#include "mechanics/hex8.h"

#include <string.h>

#include "mechanics/hexahedron.h"
#include "model/mesh.h"

/* h_m(a): columns xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta. */
static void modal_signs(int a, double sign[7]) {
    double xi = lar_node_sign[a][0], eta = lar_node_sign[a][1], zeta = lar_node_sign[a][2];
    double h[7] = {xi, eta, zeta, eta * zeta, xi * zeta, xi * eta, xi * eta * zeta};
    memcpy(sign, h, sizeof h);
}

/* By differences first, so that the modes a box does not have are zero to the last bit. */
static void to_modes(const double nodal[8][3], double modal[7][3]) {
    for (int i = 0; i < 3; i++) {
        double sum[4], difference[4]; /* along xi, for (eta, zeta) = --, +-, -+, ++ */
        static const int left[4] = {0, 3, 4, 7}, right[4] = {1, 2, 5, 6};
        for (int k = 0; k < 4; k++) {
            sum[k] = nodal[right[k]][i] + nodal[left[k]][i];
            difference[k] = nodal[right[k]][i] - nodal[left[k]][i];
        }
        modal[0][i] = (difference[3] + difference[2]) + (difference[1] + difference[0]);
        modal[1][i] = (sum[3] - sum[2]) + (sum[1] - sum[0]);
        modal[2][i] = (sum[3] + sum[2]) - (sum[1] + sum[0]);
        modal[3][i] = (sum[3] - sum[2]) - (sum[1] - sum[0]);
        modal[4][i] = (difference[3] + difference[2]) - (difference[1] + difference[0]);
        modal[5][i] = (difference[3] - difference[2]) + (difference[1] - difference[0]);
        modal[6][i] = (difference[3] - difference[2]) - (difference[1] - difference[0]);
    }
}

static void from_modes(const double modal[7][3], double nodal[8][3]) {
    memset(nodal, 0, 8 * sizeof nodal[0]);
    for (int a = 0; a < 8; a++) {
        double h[7];
        modal_signs(a, h);
        for (int m = 0; m < 7; m++)
            for (int i = 0; i < 3; i++) nodal[a][i] += h[m] * modal[m][i];
    }
}

/* sum += factor * (a x b) */
static void add_cross(double sum[3], double factor, const double a[3], const double b[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum[i] += factor * (a[j] * b[k] - a[k] * b[j]);
    }
}

/* Volume and its derivatives by the modes of the corner positions. With a..f the modes 0..5 and
 * [.,.,.] the triple product,
 *     64 V = [a,b,c] + ([e,d,c] + [f,b,d] + [a,f,e]) / 3,
 * the average of det dx/dxi over the natural cube; odd powers drop out and so does mode 6. */
static double volume_gradient(const double X[7][3], double derivative[6][3]) {
    enum { A, B, C, D, E, F };
    static const struct {
        int mode, left, right;
        double factor;
    } term[12] = {{A, B, C, 1},      {A, F, E, 1. / 3}, {B, C, A, 1},      {B, D, F, 1. / 3},
                  {C, A, B, 1},      {C, E, D, 1. / 3}, {D, C, E, 1. / 3}, {D, F, B, 1. / 3},
                  {E, D, C, 1. / 3}, {E, A, F, 1. / 3}, {F, B, D, 1. / 3}, {F, E, A, 1. / 3}};
    memset(derivative, 0, 6 * sizeof derivative[0]);
    for (int t = 0; t < 12; t++)
        add_cross(derivative[term[t].mode], term[t].factor / 64, X[term[t].left], X[term[t].right]);
    double volume = 0; /* Euler: a cubic form is a third of its gradient times its argument */
    for (int m = 0; m < 6; m++)
        for (int i = 0; i < 3; i++) volume += derivative[m][i] * X[m][i] / 3;
    return volume;
}

/* 2 I2 / I1 of M = integral grad h (x) grad h dV for the hourglass modes, by 2x2x2 Gauss. */
static void bending_stiffness(const double corner[8][3], double stiffness[4]) {
    double M[4][3][3] = {{{0}}};
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        double at[3], J[3][3], cof[9];
        lar_gauss_point(g, at);
        lar_hexahedron_jacobian(corner, at, J);
        double det = lar_lane_cofactor((const double *)J, cof);
        double slope[4][3] = {{0, at[2], at[1]}, /* d(eta zeta) by xi, eta, zeta; and so on */
                              {at[2], 0, at[0]},
                              {at[1], at[0], 0},
                              {at[1] * at[2], at[0] * at[2], at[0] * at[1]}};
        for (int m = 0; m < 4; m++) {
            double gradient[3]; /* J^-T slope */
            for (int i = 0; i < 3; i++)
                gradient[i] = (cof[3 * i] * slope[m][0] + cof[3 * i + 1] * slope[m][1] +
                               cof[3 * i + 2] * slope[m][2]) /
                              det;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) M[m][i][j] += gradient[i] * gradient[j] * det;
        }
    }
    for (int m = 0; m < 4; m++) {
        double trace = M[m][0][0] + M[m][1][1] + M[m][2][2], minors = 0;
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3;
            minors += M[m][i][i] * M[m][j][j] - M[m][i][j] * M[m][j][i];
        }
        stiffness[m] = trace > 0 ? 2 * minors / trace : 0;
    }
}

void lar_hex8_prepare(const double corner[8][3], const lar_material *material, lar_hex8 *element) {
    double X[7][3], bending[4];
    to_modes(corner, X);
    element->volume = volume_gradient(X, element->gradient);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++) element->gradient[m][i] /= element->volume;
    bending_stiffness(corner, bending);
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        memcpy(element->shape[m], X[3 + m], sizeof X[0]);
        element->stiffness[m] =
            LAR_HOURGLASS_FACTOR * lar_material_shear(material) * bending[m] / 64;
    }
}

/* H = sum U_m (x) B_m */
static void modal_gradient(const lar_hex8 *element, const double U[7][3], double H[3][3]) {
    memset(H, 0, 9 * sizeof(double));
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) H[i][j] += U[m][i] * element->gradient[m][j];
}

/* q_m = U_m - H X_m */
static void hourglass_displacement(const lar_hex8 *element, const double U[7][3],
                                   const double H[3][3], double q[4][3]) {
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        for (int i = 0; i < 3; i++) {
            q[m][i] = U[3 + m][i];
            for (int j = 0; j < 3; j++) q[m][i] -= H[i][j] * element->shape[m][j];
        }
}

/* G_m from the Piola-Kirchhoff stress and the hourglass displacements. */
static void modal_forces(const lar_hex8 *element, const double P[3][3], const double q[4][3],
                         double G[7][3]) {
    double S[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            S[i][j] = element->volume * P[i][j];
            for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
                S[i][j] -= element->stiffness[m] * q[m][i] * element->shape[m][j];
        }
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) {
            G[m][i] = m >= 3 ? element->stiffness[m - 3] * q[m - 3][i] : 0;
            if (m >= LAR_HEX8_GRADIENTS) continue;
            for (int j = 0; j < 3; j++) G[m][i] += S[i][j] * element->gradient[m][j];
        }
}

void lar_hex8_gradient(const lar_hex8 *element, const double u[8][3], double F[3][3]) {
    double U[7][3];
    to_modes(u, U);
    modal_gradient(element, U, F);
    for (int i = 0; i < 3; i++) F[i][i] += 1;
}

double lar_hex8_force(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                      double force[8][3]) {
    double U[7][3], H[3][3], F[3][3], P[3][3], q[4][3], G[7][3];
    to_modes(u, U);
    modal_gradient(element, U, H);
    hourglass_displacement(element, U, H, q);
    memcpy(F, H, sizeof F);
    for (int i = 0; i < 3; i++) F[i][i] += 1;
    double J = lar_law_stress(material, F, P);
    modal_forces(element, P, q, G);
    from_modes(G, force);
    return J;
}

double lar_hex8_energy(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                       double *hourglass) {
    double U[7][3], F[3][3], q[4][3];
    to_modes(u, U);
    modal_gradient(element, U, F);
    if (hourglass) {
        hourglass_displacement(element, U, F, q);
        *hourglass = 0;
        for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
            for (int i = 0; i < 3; i++)
                *hourglass += 0.5 * element->stiffness[m] * q[m][i] * q[m][i];
    }
    for (int i = 0; i < 3; i++) F[i][i] += 1;
    return element->volume * lar_law_energy(material, F);
}

/* One product with M^-1 K at rest, in modes: the nodal forces sum_m h_m G_m divided by the lumped
 * mass rho V/8 transform back to 64 G_m / (rho V). */
static void rest_operator(const lar_hex8 *element, double shear, double bulk, double density,
                          const double U[7][3], double result[7][3]) {
    double H[3][3], P[3][3], q[4][3];
    modal_gradient(element, U, H);
    hourglass_displacement(element, U, H, q);
    double trace = H[0][0] + H[1][1] + H[2][2];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            P[i][j] = shear * (H[i][j] + H[j][i]) + (i == j ? (bulk - 2 * shear / 3) * trace : 0);
    modal_forces(element, P, q, result);
    double factor = 64 / (density * element->volume);
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) result[m][i] *= factor;
}

static double dot21(const double a[7][3], const double b[7][3]) {
    double sum = 0;
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) sum += a[m][i] * b[m][i];
    return sum;
}

double lar_hex8_frequency(const lar_hex8 *element, const lar_material *material) {
    double shear = lar_material_shear(material), bulk = lar_material_bulk(material);
    double U[7][3], image[7][3], square = 0, residual = 0;
    for (int m = 0; m < 7; m++) /* any start that leans on no symmetry */
        for (int i = 0; i < 3; i++) U[m][i] = 1 + 0.37 * m - 0.61 * i + 0.11 * m * i * i;
    /* Power iteration; an eigenvalue lies within the residual of the Rayleigh quotient. */
    for (int n = 0; n < 40; n++) {
        double norm = sqrt(dot21(U, U));
        for (int k = 0; k < 21; k++) (&U[0][0])[k] /= norm;
        rest_operator(element, shear, bulk, material->density, U, image);
        square = dot21(U, image);
        residual = sqrt(fmax(dot21(image, image) - square * square, 0));
        if (residual < 1e-3 * square) break;
        memcpy(U, image, sizeof U);
    }
    return sqrt(square + residual);
}
