/* The consistent tangent of hex8: what an implicit solver needs of the production element.
 *
 * With g_a = sum_m h_m(a) B_m the mean gradient of node a and Q_k(a) = h_k(a) - g_a . X_k what
 * the hourglass mode k sees of it (mechanics/hex8.h), the forces are
 *
 *     f_a = V P(F) g_a + sum_b Z_ab u_b,    F = 1 + sum_b u_b (x) g_b,    Z = sum_k c_k Q_k (x) Q_k
 *
 * so that the tangent is a uniform strain part, which changes with F, and a hourglass part, which
 * does not (total hourglass control is linear), the same along each axis:
 *
 *     K_ai,bk = V g_aj (dP_ij / dF_kl) g_bl + delta_ik Z_ab
 *
 * dP/dF is that of the law's row (law/isotropic.h). For study only: the engine never builds a
 * matrix, which is its point (T 2.2.4). Plain C and libm; the bits may differ between machines.
 */
#ifndef LAR_STUDY_IMPLICIT_TANGENT_H
#define LAR_STUDY_IMPLICIT_TANGENT_H

#include "mechanics/hex8.h"

/* dP_ij/dF_kl [Pa] as A[3 i + j][3 k + l], symmetric. F must have det F > 0. */
void lar_law_tangent(const lar_material *material, const double F[3][3], double A[9][9]);

/* The tangent [N/m] of lar_hex8_force for displacements u [8][3]; row and column 3 a + i belong to
 * axis i of node a; symmetric. Returns det F; K means nothing unless it is positive. */
double lar_hex8_tangent(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                        double K[24][24]);

#endif
