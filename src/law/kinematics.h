/* What a deformation gradient says, for a lane (base/simd.h). */
#ifndef LAR_LAW_KINEMATICS_H
#define LAR_LAW_KINEMATICS_H

#include "base/simd.h"

/* cof F (row by row) and det F: the derivative of the determinant and the determinant. */
LAR_INLINE lar_lane lar_lane_cofactor(const lar_lane F[9], lar_lane cof[9]) {
    cof[0] = lar_lane_fnma(F[5], F[7], F[4] * F[8]);
    cof[1] = lar_lane_fnma(F[3], F[8], F[5] * F[6]);
    cof[2] = lar_lane_fnma(F[4], F[6], F[3] * F[7]);
    cof[3] = lar_lane_fnma(F[1], F[8], F[2] * F[7]);
    cof[4] = lar_lane_fnma(F[2], F[6], F[0] * F[8]);
    cof[5] = lar_lane_fnma(F[0], F[7], F[1] * F[6]);
    cof[6] = lar_lane_fnma(F[2], F[4], F[1] * F[5]);
    cof[7] = lar_lane_fnma(F[0], F[5], F[2] * F[3]);
    cof[8] = lar_lane_fnma(F[1], F[3], F[0] * F[4]);
    return lar_lane_fma(F[0], cof[0], lar_lane_fma(F[1], cof[1], F[2] * cof[2]));
}

/* |F|^2, the first invariant of C. */
LAR_INLINE lar_lane lar_lane_square_sum(const lar_lane F[9]) {
    lar_lane a = lar_lane_fma(F[2], F[2], lar_lane_fma(F[1], F[1], F[0] * F[0]));
    lar_lane b = lar_lane_fma(F[5], F[5], lar_lane_fma(F[4], F[4], F[3] * F[3]));
    lar_lane c = lar_lane_fma(F[8], F[8], lar_lane_fma(F[7], F[7], F[6] * F[6]));
    return a + b + c;
}

/* How |cof F|^2, the second invariant of C, grows: half its derivative, which is the tensor cross
 * product of cof F and F (Bonet, Gil and Ortigosa 2015), e_imn e_jpq cof_mp F_nq, or I1 F - F F^T F
 * with a fifth of the operations less. */
LAR_INLINE void lar_lane_area_slope(const lar_lane F[9], const lar_lane cof[9], lar_lane slope[9]) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++)
#pragma GCC unroll 3
        for (int j = 0; j < 3; j++) {
            const int m = 3 * ((i + 1) % 3), n = 3 * ((i + 2) % 3), p = (j + 1) % 3,
                      q = (j + 2) % 3;
            lar_lane sum = lar_lane_fma(cof[m + p], F[n + q], cof[n + q] * F[m + p]);
            sum = lar_lane_fnma(cof[m + q], F[n + p], sum);
            slope[3 * i + j] = lar_lane_fnma(cof[n + p], F[m + q], sum);
        }
}

#endif
