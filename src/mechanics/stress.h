/* Stress and energy of a material in a state: what its law (law/law.h) says, in plain doubles, for
 * the oracles and for results. The kernels take the law for a lane (law/lanes.h).
 */
#ifndef LAR_MECHANICS_STRESS_H
#define LAR_MECHANICS_STRESS_H

#include "law/kinematics.h"
#include "model/material.h"

/* First Piola-Kirchhoff stress P(F) [Pa]; returns
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
