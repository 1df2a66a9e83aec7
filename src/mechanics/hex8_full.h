/* hex8-full: the textbook element, eight Gauss points, direct vector calculation (T 4.2.2).
 *
 *     H_g = sum_a u_a (x) grad N_a          displacement gradient at Gauss point g; F = I + H
 *     f_a = sum_g w_g P(F_g) grad N_a       w_g = det dX/dxi, the reference volume of the point
 *
 * No hourglass control is needed and none of the shortcuts of hex8.h is taken: it integrates the
 * material law as it stands, so it is the oracle of hex8 on fine meshes and of the step's energy
 * balance on any. It locks when the material is nearly incompressible or a thin body is bent
 * (two elements through a beam of nu = 0.45 carry only 80% of the deflection), and costs some
 * twenty times the operations. Plain C, no lanes: for tests, comparison and T table 4.3.
 *
 * All functions take the reference corners [8][3] in metres and displacements u [8][3] in metres,
 * in the order of model/mesh/mesh.h, and keep nothing.
 */
#ifndef LAR_MECHANICS_HEX8_FULL_H
#define LAR_MECHANICS_HEX8_FULL_H

#include "mechanics/stress.h"

/* Internal forces dW/du [8][3] in newtons. Returns the smallest det F of the Gauss points (NaN if
 * one is NaN); the forces mean nothing unless it is positive. */
double lar_hex8_full_force(const double corner[8][3], const lar_material *material,
                           const double u[8][3], double force[8][3]);

/* Strain energy [J]. */
double lar_hex8_full_energy(const double corner[8][3], const lar_material *material,
                            const double u[8][3]);

/* Volume average over the deformed element of the Cauchy stress [Pa], as xx yy zz xy yz zx. */
void lar_hex8_full_stress(const double corner[8][3], const lar_material *material,
                          const double u[8][3], double cauchy[6]);

/* Angular frequency [rad/s] that the fastest mode of the element alone at rest does not exceed,
 * and reaches within 0.2%, with its mass lumped in eight equal parts. As for hex8 2 / max over
 * elements bounds the central difference step of any assembly. */
double lar_hex8_full_frequency(const double corner[8][3], const lar_material *material);

#endif
