/* Material laws: stress and energy from the deformation gradient.
 *
 * A law is written once, for a lane (base/simd.h), and serves the fast kernels, the oracle and
 * the energies alike. Adding one: a row in LAR_LAWS (model/material.h) and a file law_NAME.h with
 *
 *   lar_lane lar_NAME_stress(F[9], P[9], J, I1, p[3])
 *       F row by row, J = det F > 0, I1 = |F|^2, p the parameters of the table times any common
 *       factor. P holds cof F on entry and the first Piola-Kirchhoff stress (times that factor)
 *       on return. Returns a number not below |P|^2 in order of magnitude (for the overflow
 *       guard): the sum of the squares of the terms P is made of, with |cof F| <= I1.
 *   lar_lane lar_NAME_energy(F[9], J, I1, p[3])
 *       energy per reference volume (times the factor).
 *
 * No libm, no branch on the data: the same bits everywhere (docs/determinism.md).
 */
#ifndef LAR_MECHANICS_LAW_H
#define LAR_MECHANICS_LAW_H

#include "mechanics/law_coupled_neo_hookean.h"
#include "mechanics/law_mooney_rivlin.h"
#include "mechanics/law_neo_hookean.h"
#include "model/material.h"

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

/* Plain doubles, for the oracle and for results. First Piola-Kirchhoff stress P(F) [Pa]; returns
 * J = det F. P means nothing when J <= 0. */
double lar_law_stress(const lar_material *material, const double F[3][3], double P[3][3]);

/* Energy per reference volume [J/m^3]. */
double lar_law_energy(const lar_material *material, const double F[3][3]);

/* Cauchy stress from P and F: P F^T / J, as xx yy zz xy yz zx. */
void lar_cauchy_stress(const double F[3][3], const double P[3][3], double J, double cauchy[6]);

/* Von Mises stress and pressure (minus a third of the trace) of a Cauchy stress [Pa]. */
double lar_von_mises(const double cauchy[6]);
double lar_mean_pressure(const double cauchy[6]);

#endif
