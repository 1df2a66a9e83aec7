#include "mechanics/hex8_full.h"

#include <string.h>

#include "mechanics/hexahedron.h"

enum { FREEDOMS = 24 };

/* One Gauss point under way: shape gradients, its volume and the deformation gradient there. */
typedef struct gauss {
    double gradient[8][3];
    double volume;
    double F[3][3];
} gauss;

static gauss gauss_at(int g, const double corner[8][3], const double u[8][3]) {
    gauss point = {.F = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    double at[3];
    lar_gauss_point(g, at);
    point.volume = lar_hexahedron_gradients(corner, at, point.gradient);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) point.F[i][j] += u[a][i] * point.gradient[a][j];
    return point;
}

double lar_hex8_full_force(const double corner[8][3], const lar_material *material,
                           const double u[8][3], double force[8][3]) {
    double min = INFINITY;
    memset(force, 0, FREEDOMS * sizeof(double));
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        gauss point = gauss_at(g, corner, u);
        double P[3][3];
        double J = lar_law_stress(material, (const double(*)[3])point.F, P);
        if (J < min || isnan(J)) min = J; /* a NaN stays: nothing is less */
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    force[a][i] += point.volume * P[i][j] * point.gradient[a][j];
    }
    return min;
}

double lar_hex8_full_energy(const double corner[8][3], const lar_material *material,
                            const double u[8][3]) {
    double sum = 0;
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        gauss point = gauss_at(g, corner, u);
        sum += point.volume * lar_law_energy(material, (const double(*)[3])point.F);
    }
    return sum;
}

void lar_hex8_full_stress(const double corner[8][3], const lar_material *material,
                          const double u[8][3], double cauchy[6]) {
    double volume = 0;
    memset(cauchy, 0, 6 * sizeof(double));
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        gauss point = gauss_at(g, corner, u);
        double P[3][3], here[6];
        double J = lar_law_stress(material, (const double(*)[3])point.F, P);
        lar_cauchy_stress((const double(*)[3])point.F, (const double(*)[3])P, J, here);
        for (int n = 0; n < 6; n++) cauchy[n] += J * point.volume * here[n];
        volume += J * point.volume;
    }
    for (int n = 0; n < 6; n++) cauchy[n] /= volume;
}

/* Linear elastic stiffness at rest; returns the element's volume. */
static double rest_stiffness(const double corner[8][3], const lar_material *material,
                             double K[FREEDOMS][FREEDOMS]) {
    static const double none[8][3];
    double shear = lar_material_shear(material);
    double lame = lar_material_bulk(material) - 2 * shear / 3, volume = 0;
    memset(K, 0, FREEDOMS * sizeof K[0]);
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        gauss point = gauss_at(g, corner, none);
        volume += point.volume;
        for (int n = 0; n < FREEDOMS; n++)
            for (int m = 0; m < FREEDOMS; m++) {
                int i = n % 3, j = m % 3;
                const double *A = point.gradient[n / 3], *B = point.gradient[m / 3];
                double dot = i == j ? A[0] * B[0] + A[1] * B[1] + A[2] * B[2] : 0;
                K[n][m] += point.volume * (lame * A[i] * B[j] + shear * (A[j] * B[i] + dot));
            }
    }
    return volume;
}

/* Largest eigenvalue of a symmetric matrix without negative ones, never too small, by squaring:
 * the sum of the p-th powers of the eigenvalues is the trace of A^p, and its p-th root lies
 * between the largest and 24^(1/p) times it. Power iteration has no such guarantee. */
static double largest_eigenvalue(double A[FREEDOMS][FREEDOMS]) {
    enum { SQUARINGS = 10 };
    double logarithm = 0, square[FREEDOMS][FREEDOMS], p = 1;
    for (int step = 0;; step++) {
        double trace = 0;
        for (int n = 0; n < FREEDOMS; n++) trace += A[n][n];
        if (!(trace > 0)) return 0;
        logarithm += log(trace) / p;
        if (step == SQUARINGS) return exp(logarithm);
        for (int n = 0; n < FREEDOMS; n++)
            for (int m = 0; m <= n; m++) {
                double sum = 0;
                for (int k = 0; k < FREEDOMS; k++) sum += A[n][k] * A[m][k];
                square[n][m] = square[m][n] = sum / (trace * trace);
            }
        memcpy(A, square, sizeof square);
        p *= 2;
    }
}

double lar_hex8_full_frequency(const double corner[8][3], const lar_material *material) {
    double K[FREEDOMS][FREEDOMS];
    double volume = rest_stiffness(corner, material, K);
    double node_mass = material->density * volume / 8;
    return sqrt(largest_eigenvalue(K) / node_mass);
}
