#include "mechanics/hex8.h"

#include <string.h>

#include "mechanics/hexahedron.h"
#include "model/mesh/mesh.h"

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
    memset(derivative, 0, 6 * sizeof derivative[0]);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int t = 0; t < 2; t++)
            add_cross(derivative[m], LAR_HEX8_VOLUME_TERM[m][t].factor / 64,
                      X[LAR_HEX8_VOLUME_TERM[m][t].left], X[LAR_HEX8_VOLUME_TERM[m][t].right]);
    double volume = 0; /* Euler: a cubic form is a third of its gradient times its argument */
    for (int m = 0; m < 6; m++)
        for (int i = 0; i < 3; i++) volume += derivative[m][i] * X[m][i] / 3;
    return volume;
}

double lar_hex8_areas(const double corner[8][3]) {
    double X[7][3], derivative[6][3], sum = 0;
    to_modes(corner, X);
    volume_gradient(X, derivative);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++) sum += derivative[m][i] * derivative[m][i];
    return 8 * sum; /* every mode is 1 or -1 at each of the nodes */
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
    memset(element->fibre, 0, sizeof element->fibre);
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

/* G_m from the Piola-Kirchhoff stress and the hourglass forces c_m q_m. */
static void modal_forces(const lar_hex8 *element, const double P[3][3], const double cq[4][3],
                         double G[7][3]) {
    double S[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            S[i][j] = element->volume * P[i][j];
            for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) S[i][j] -= cq[m][i] * element->shape[m][j];
        }
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) {
            G[m][i] = m >= 3 ? cq[m - 3][i] : 0;
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

void lar_hex8_modes(const lar_hex8 *element, const double u[8][3], double F[3][3],
                    double q[LAR_HEX8_HOURGLASS][3]) {
    double U[7][3];
    to_modes(u, U);
    modal_gradient(element, U, F);
    hourglass_displacement(element, U, (const double(*)[3])F, q);
    for (int i = 0; i < 3; i++) F[i][i] += 1;
}

void lar_hex8_nodal(const lar_hex8 *element, const double P[3][3],
                    const double hourglass[LAR_HEX8_HOURGLASS][3], double force[8][3]) {
    double G[7][3];
    modal_forces(element, P, hourglass, G);
    from_modes(G, force);
}

double lar_hex8_force(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                      double force[8][3]) {
    double F[3][3], P[3][3], q[LAR_HEX8_HOURGLASS][3];
    lar_hex8_modes(element, u, F, q);
    double J = lar_material_stress(material, element->fibre, (const double(*)[3])F, P);
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        for (int i = 0; i < 3; i++) q[m][i] *= element->stiffness[m];
    lar_hex8_nodal(element, (const double(*)[3])P, (const double(*)[3])q, force);
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
    return element->volume * lar_material_energy(material, element->fibre, F);
}

/* The stiffness at rest in modes, A = Z (x) 1 + V b^T D b: D is Hooke's law, b takes the modes to
 * the strain sym(sum_m U_m (x) B_m), and Z holds the hourglass modes, the same along each axis. */
typedef struct rest_stiffness {
    const lar_hex8 *element;
    double shear, bulk;
    double hourglass[7][7];    /* Z = Q^T c Q with q_k = sum_m Q_km U_m */
    double shear_compliance;   /* 1 / (2 G V): D^-1/V of a stress without pressure */
    double pressure_softening; /* D^-1 s = s / (2 G) - softening tr(s) 1 */
} rest_stiffness;

static rest_stiffness at_rest(const lar_hex8 *element, double shear, double bulk) {
    rest_stiffness rest = {.element = element, .shear = shear, .bulk = bulk};
    double Q[LAR_HEX8_HOURGLASS][7] = {{0}};
    for (int k = 0; k < LAR_HEX8_HOURGLASS; k++) {
        const double *X = element->shape[k];
        for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) {
            const double *B = element->gradient[m];
            Q[k][m] = -(B[0] * X[0] + B[1] * X[1] + B[2] * X[2]);
        }
        Q[k][3 + k] += 1;
    }
    for (int m = 0; m < 7; m++)
        for (int n = 0; n < 7; n++)
            for (int k = 0; k < LAR_HEX8_HOURGLASS; k++)
                rest.hourglass[m][n] += element->stiffness[k] * Q[k][m] * Q[k][n];
    rest.shear_compliance = 1 / (2 * shear * element->volume);
    rest.pressure_softening = rest.shear_compliance / 3 - 1 / (9 * bulk * element->volume);
    return rest;
}

/* image = A U */
static void apply(const rest_stiffness *rest, const double U[7][3], double image[7][3]) {
    double H[3][3], S[3][3];
    modal_gradient(rest->element, U, H);
    double pressure = (rest->bulk - 2 * rest->shear / 3) * (H[0][0] + H[1][1] + H[2][2]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            S[i][j] = rest->element->volume *
                      (rest->shear * (H[i][j] + H[j][i]) + (i == j ? pressure : 0));
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) {
            image[m][i] = 0;
            for (int n = 0; n < 7; n++) image[m][i] += rest->hourglass[m][n] * U[n][i];
            if (m >= LAR_HEX8_GRADIENTS) continue;
            for (int j = 0; j < 3; j++) image[m][i] += S[i][j] * rest->element->gradient[m][j];
        }
}

static double dot21(const double a[7][3], const double b[7][3]) {
    double sum = 0;
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) sum += a[m][i] * b[m][i];
    return sum;
}

/* Power iteration from any start that leans on no symmetry: returns the Rayleigh quotient, which
 * no eigenvalue bound may undercut; an eigenvalue, nearly always the largest, is within
 * *residual. */
static double rayleigh(const rest_stiffness *rest, double *residual) {
    double U[7][3], image[7][3], quotient = 0;
    for (int m = 0; m < 7; m++)
        for (int i = 0; i < 3; i++) U[m][i] = 1 + 0.37 * m - 0.61 * i + 0.11 * m * i * i;
    for (int n = 0; n < 12; n++) {
        double norm = sqrt(dot21(U, U));
        for (int k = 0; k < 21; k++) (&U[0][0])[k] /= norm;
        apply(rest, U, image);
        quotient = dot21(U, image);
        *residual = sqrt(fmax(dot21(image, image) - quotient * quotient, 0));
        if (*residual < 1e-3 * quotient) break;
        memcpy(U, image, sizeof U);
    }
    return quotient;
}

/* N = B^T M^-1 B for M = lambda 1 - Z = L diag(d) L^T; false unless M is positive definite. */
static bool gradient_flexibility(const rest_stiffness *rest, double lambda, double N[3][3]) {
    double L[7][7], scaled[7], Y[7][3], inverse[7];
    memset(N, 0, 9 * sizeof(double));
    for (int m = 0; m < 7; m++) {
        double pivot = lambda - rest->hourglass[m][m];
        for (int i = 0; i < 3; i++) Y[m][i] = m < 6 ? rest->element->gradient[m][i] : 0;
        for (int n = 0; n < m; n++) {
            scaled[n] = -rest->hourglass[m][n]; /* L_mn d_n */
            for (int k = 0; k < n; k++) scaled[n] -= scaled[k] * L[n][k];
            L[m][n] = scaled[n] * inverse[n];
            pivot -= L[m][n] * scaled[n];
            for (int i = 0; i < 3; i++) Y[m][i] -= L[m][n] * Y[n][i];
        }
        if (!(pivot > 0)) return false;
        inverse[m] = 1 / pivot;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) N[i][j] += Y[m][i] * Y[m][j] * inverse[m];
    }
    return true;
}

/* Trace, sum of the principal minors and determinant of a symmetric matrix. */
static void invariants(const double A[3][3], double e[3]) {
    double cof[9];
    e[2] = lar_lane_cofactor(&A[0][0], cof);
    e[1] = cof[0] + cof[4] + cof[8];
    e[0] = A[0][0] + A[1][1] + A[2][2];
}

/* Is lambda above every eigenvalue of A? By Schur complements lambda 1 - A is positive definite
 * when M = lambda 1 - Z is and, for every symmetric s,
 *
 *     s : D^-1 s / V - tr(s s N) > 0,     N = B^T M^-1 B.
 *
 * Along the principal axes of N the six components of s part into three shears, for which that
 * says 1 / (G V) > n_i + n_j, and the three normal ones, whose matrix is diag(r) - w 1 1^T with
 * r_i = 1 / (2 G V) - n_i. Applied to (1, -1, 0) the latter contains the former. Real eigenvalues
 * are positive when their elementary symmetric functions are, and these need only the invariants
 * of N: no eigenvector is ever computed. */
static bool exceeds_all(const rest_stiffness *rest, double lambda) {
    double R[3][3], r[3], w = rest->pressure_softening;
    if (!gradient_flexibility(rest, lambda, R)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) R[i][j] = (i == j ? rest->shear_compliance : 0) - R[i][j];
    invariants((const double(*)[3])R, r);
    return r[0] > 3 * w && r[1] > 2 * w * r[0] && r[2] > w * r[1];
}

/* The same of fibres where tension begins, and of what is active: V times the slope times the sum
 * over the modes of |D B_m|^2, D = a (x) a, or its deviator where only that is seen. */
static double family_stiffness(const lar_hex8 *element, const lar_material *material,
                               const double *a, bool active) {
    const lar_fibre *fibre = &material->fibre;
    const double third = fibre->isochoric ? 1.0 / 3 : 0;
    double modulus = lar_viscosity_instant(&material->viscosity) * lar_fibre_modulus(fibre);
    double pull = active ? fmax(fibre->along - fibre->across, 0) : 0, sum = 0;
    double across = active ? fmax(fibre->across, 0) : 0;
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) {
        const double *B = element->gradient[m];
        double along = a[0] * B[0] + a[1] * B[1] + a[2] * B[2], square = 0, all = 0;
        for (int i = 0; i < 3; i++) {
            double D = a[i] * along - third * B[i];
            square += D * D;
            all += B[i] * B[i];
        }
        sum += modulus * square + pull * along * along + across * all;
    }
    return element->volume * sum;
}

static double fibre_stiffness(const lar_hex8 *element, const lar_material *material) {
    double first = family_stiffness(element, material, element->fibre, true);
    return lar_fibre_families(&material->fibre) == 2
               ? first + family_stiffness(element, material, element->fibre + 3, false)
               : first;
}

double lar_hex8_frequency(const lar_hex8 *element, const lar_material *material) {
    rest_stiffness rest =
        at_rest(element, lar_material_instant_shear(material), lar_material_instant_bulk(material));
    double residual, below = rayleigh(&rest, &residual);
    double above = below + fmin(residual, 1e-3 * below), growth = 1e-3;
    /* Proven at once as a rule; else up in growing strides and back by bisection. What is not a
     * number ends here too and is reported by the caller. */
    while (isfinite(above) && !exceeds_all(&rest, above)) {
        below = above;
        above *= 1 + growth;
        growth *= 4;
    }
    while (isfinite(above) && growth > 1e-3 && above > 1.001 * below) {
        double middle = sqrt(above * below);
        *(exceeds_all(&rest, middle) ? &above : &below) = middle;
    }
    if (lar_fibre_here(&material->fibre)) above += fibre_stiffness(element, material);
    /* nodal forces sum_m h_m G_m over the lumped mass rho V/8 are modes 64 G_m / (rho V) */
    return sqrt(64 * above / (material->density * element->volume));
}
