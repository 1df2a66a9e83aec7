/* Stiffness of an isotropic law in its principal stretches a: its energy's derivatives w_a, w_ab.
 *
 * In the frame of the stretches dP/dF falls apart (Ogden 1984, 6.1.4): the matrix w_ab for changes
 * of the stretches, and for each pair of directions (w_a - w_b)/(l_a - l_b) and
 * (w_a + w_b)/(l_a + l_b), which turn them.
 */
#ifndef LAR_LAW_PRINCIPAL_H
#define LAR_LAW_PRINCIPAL_H

#include "law/spectrum.h"

typedef struct lar_principal {
    lar_lane stretch[3]; /* largest first */
    lar_lane first[3];   /* w_a */
    lar_lane second[3];  /* w_aa */
    lar_lane mixed[3];   /* w_01, w_02, w_12 */
} lar_principal;

static const int LAR_PRINCIPAL_PAIR[3][2] __attribute__((unused)) = {{0, 1}, {0, 2}, {1, 2}};

/* Where two stretches meet, (w_a - w_b)/(l_a - l_b) is w_aa - w_ab. */
LAR_INLINE lar_lane lar_principal_met(const lar_principal *w, int pair) {
    const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
    return lar_lane_set(0.5) * (w->second[a] + w->second[b]) - w->mixed[pair];
}

/* (w_a - w_b)/(l_a - l_b) to some 1e-5, for estimates. */
LAR_INLINE lar_lane lar_principal_slope(const lar_principal *w, int pair) {
    const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
    lar_lane near = lar_lane_set(1e-5) * w->stretch[a];
    lar_lane apart = w->stretch[a] - w->stretch[b];
    return lar_lane_fma(near, lar_principal_met(w, pair), w->first[a] - w->first[b]) /
           (apart + near);
}

LAR_INLINE lar_lane lar_principal_turn(const lar_principal *w, int pair) {
    const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
    return (w->first[a] + w->first[b]) / (w->stretch[a] + w->stretch[b]);
}

/* The largest of w_aa and of what turns pairs; *all: and of the eigenvalues of w_ab. */
LAR_INLINE lar_lane lar_principal_largest(const lar_principal *w, lar_lane *all) {
    lar_lane max = lar_lane_max(w->second[0], lar_lane_max(w->second[1], w->second[2]));
    lar_lane p = (w->second[0] + w->second[1] + w->second[2]) * lar_lane_set(1.0 / 3);
    lar_lane by = lar_lane_set(1) /
                  (lar_lane_max(max, lar_lane_abs(p)) + lar_lane_set(LAR_LANE_TINY)),
             A[6], c[3];
    A[0] = (w->second[0] - p) * by;
    A[1] = w->mixed[0] * by;
    A[2] = w->mixed[1] * by;
    A[3] = (w->second[1] - p) * by;
    A[4] = w->mixed[2] * by;
    A[5] = (w->second[2] - p) * by;
    lar_lane_three(p * by, lar_lane_symmetric_square(A) * lar_lane_set(1.0 / 6),
                   lar_lane_symmetric_determinant(A), c);
    for (int pair = 0; pair < 3; pair++)
        max = lar_lane_max(max,
                           lar_lane_max(lar_principal_slope(w, pair), lar_principal_turn(w, pair)));
    *all = lar_lane_max(max, c[0] / by);
    return max;
}

#ifdef LAR_LAW_ROWS

#include <math.h>

/* Eigenvectors N of C = F^T F (columns) and stretches, largest first, by rotations of Jacobi. */
static inline void lar_principal_frame(const double F[9], double N[3][3], double stretch[3]) {
    double C[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            C[i][j] = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
            N[i][j] = i == j;
        }
    for (int turn = 0; turn < 30; turn++) {
        const int a = LAR_PRINCIPAL_PAIR[turn % 3][0], b = LAR_PRINCIPAL_PAIR[turn % 3][1];
        if (C[a][b] == 0) continue;
        double theta = (C[b][b] - C[a][a]) / (2 * C[a][b]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; k++) {
            double ka = C[k][a], kb = C[k][b], na = N[k][a], nb = N[k][b];
            C[k][a] = c * ka - s * kb, C[k][b] = s * ka + c * kb;
            N[k][a] = c * na - s * nb, N[k][b] = s * na + c * nb;
        }
        for (int k = 0; k < 3; k++) {
            double ak = C[a][k], bk = C[b][k];
            C[a][k] = c * ak - s * bk, C[b][k] = s * ak + c * bk;
        }
    }
    for (int pair = 0; pair < 3; pair++) { /* 01, 02, 12: the largest comes first */
        const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
        if (C[a][a] >= C[b][b]) continue;
        double kept = C[a][a];
        C[a][a] = C[b][b], C[b][b] = kept;
        for (int k = 0; k < 3; k++) kept = N[k][a], N[k][a] = N[k][b], N[k][b] = kept;
    }
    for (int a = 0; a < 3; a++) stretch[a] = sqrt(C[a][a]);
}

/* Adds factor x (x) y to A. */
static inline void lar_principal_add(double factor, const double x[9], const double y[9],
                                     double A[9][9]) {
    for (int r = 0; r < 9; r++)
        for (int s = 0; s < 9; s++) A[r][s] += factor * (x[r] * y[s] + y[r] * x[s]);
}

/* Adds dP/dF of a law with the derivatives w in the frame N of F. */
static inline void lar_principal_tangent(const lar_principal *w, const double F[9],
                                         const double N[3][3], double A[9][9]) {
    double dyad[3][3][9]; /* F N_a / l_a (x) N_b */
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    dyad[a][b][3 * i + j] =
                        (F[3 * i] * N[0][a] + F[3 * i + 1] * N[1][a] + F[3 * i + 2] * N[2][a]) /
                        w->stretch[a] * N[j][b];
    for (int a = 0; a < 3; a++) lar_principal_add(w->second[a] / 2, dyad[a][a], dyad[a][a], A);
    for (int pair = 0; pair < 3; pair++) {
        const int a = LAR_PRINCIPAL_PAIR[pair][0], b = LAR_PRINCIPAL_PAIR[pair][1];
        double sum[9], difference[9], apart = w->stretch[a] - w->stretch[b];
        double slope = apart > 1e-6 * w->stretch[a] ? (w->first[a] - w->first[b]) / apart
                                                    : lar_principal_met(w, pair);
        for (int k = 0; k < 9; k++) {
            sum[k] = dyad[a][b][k] + dyad[b][a][k];
            difference[k] = dyad[a][b][k] - dyad[b][a][k];
        }
        lar_principal_add(w->mixed[pair], dyad[a][a], dyad[b][b], A);
        lar_principal_add(slope / 4, sum, sum, A);
        lar_principal_add(lar_principal_turn(w, pair) / 4, difference, difference, A);
    }
}

#endif

#endif
