/* hex8-matrix: element stiffness matrices, built anew in every step (T 4.2.1).
 *
 * The thesis multiplies the displacements with the element matrix of its eq. 4.3,
 *
 *     K = integral B_L^T C B_L dV + integral B_N^T S^ B_N dV,
 *
 * the tangent at the current state. K u is then the force only for small displacements; at finite
 * strain it has to be a SECANT matrix, the same two terms with the operators chosen so that K u is
 * the force exactly. With E Green's strain and S the second Piola-Kirchhoff stress:
 *
 *     f_a = integral P grad N_a dV,  P = F S = S + H S,  H = sum_b u_b (x) grad N_b
 *
 *   first part   integral S grad N_a dV = integral B_0^T S dV, B_0 the strain operator at rest.
 *                E = 1/2 (H + H^T + H^T H) = B_h u with B_h = B_0 + 1/2 B_1(u): HALF of the term
 *                that depends on u, because E is quadratic in it (the derivative of E has all of
 *                it). A secant material matrix with S = C_s E gives B_0^T C_s B_h u.
 *   second part  integral H S grad N_a dV = sum_b (integral grad N_a . S grad N_b dV) u_b: the
 *                geometric stiffness, which is B_N^T S^ B_N of eq. 4.3 as it stands.
 *
 * So K(u) = integral B_0^T C_s B_h dV + integral B_N^T S^ B_N dV; at u = 0 it is the linear
 * stiffness matrix, elsewhere it is not symmetric. C_s is not unique: here the small-strain matrix
 * and a rank-one correction,
 *
 *     C_s = C_0 + (S - C_0 E) E^T / (E . E)      (C_0 alone where E is below 1e-12).
 *
 * The forces are those of hex8-full by another road, so each tests the other; energy, stress and
 * frequency are the same integrals: hex8_full.h has them for both. More than four times the
 * operations: never for a real run.
 */
#ifndef LAR_MECHANICS_HEX8_MATRIX_H
#define LAR_MECHANICS_HEX8_MATRIX_H

#include "mechanics/stress.h"

/* The secant matrix [N/m] for displacements u [8][3]; row and column 3 a + i belong to axis i of
 * node a. Returns the smallest det F of the Gauss points (NaN if one is NaN). */
double lar_hex8_matrix_build(const double corner[8][3], const lar_material *material,
                             const double u[8][3], double K[24][24]);

/* Internal forces K(u) u [8][3] in newtons; returns as lar_hex8_matrix_build. The forces mean
 * nothing unless it is positive. */
double lar_hex8_matrix_force(const double corner[8][3], const lar_material *material,
                             const double u[8][3], double force[8][3]);

#endif
