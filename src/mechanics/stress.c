#include "mechanics/stress.h"

double lar_law_stress(const lar_material *material, const double F[3][3], double P[3][3]) {
    double J = lar_lane_cofactor(&F[0][0], &P[0][0]), I1 = lar_lane_square_sum(&F[0][0]);
    lar_law_table[material->law].stress(&F[0][0], &P[0][0], J, I1, material->parameter);
    return J;
}

double lar_law_energy(const lar_material *material, const double F[3][3]) {
    double cof[9], J = lar_lane_cofactor(&F[0][0], cof), I1 = lar_lane_square_sum(&F[0][0]);
    return lar_law_table[material->law].energy(&F[0][0], J, I1, material->parameter);
}

void lar_cauchy_stress(const double F[3][3], const double P[3][3], double J, double cauchy[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    for (int n = 0; n < 6; n++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) sum += P[row[n]][k] * F[column[n]][k];
        cauchy[n] = sum / J;
    }
}

double lar_von_mises(const double cauchy[6]) {
    double xy = cauchy[0] - cauchy[1], yz = cauchy[1] - cauchy[2], zx = cauchy[2] - cauchy[0];
    double shear = cauchy[3] * cauchy[3] + cauchy[4] * cauchy[4] + cauchy[5] * cauchy[5];
    return sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * shear);
}

double lar_mean_pressure(const double cauchy[6]) {
    return -(cauchy[0] + cauchy[1] + cauchy[2]) / 3;
}
