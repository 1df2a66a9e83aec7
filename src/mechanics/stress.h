/* Stress and energy of a material in a state: what its law (law/law.h) says, in plain doubles, for
 * the oracles and for results. The kernels take the law for a lane (law/lanes.h).
 */
#ifndef LAR_MECHANICS_STRESS_H
#define LAR_MECHANICS_STRESS_H

#include "law/kinematics.h"
#include "model/material.h"

/* First Piola-Kirchhoff stress P(F) [Pa] of the law, of a viscous material what is left of it in
 * the end; returns J = det F. P means nothing when J <= 0. */
double lar_law_stress(const lar_material *material, const double F[3][3], double P[3][3]);
/* The same with its fibres (law/fibre.h) along the unit vector `fibre`, of a pair along the two
 * that stand there one behind the other, as active as it says. */
double lar_material_stress(const lar_material *material, const double *fibre, const double F[3][3],
                           double P[3][3]);

/* The stress of a viscous material `factor` times as stiff as its history says, after `past`
 * seconds in which it has come to F; the history (law/viscosity.h) goes on. */
void lar_viscous_stress_at(const lar_material *material, double factor, double past,
                           const double *fibre, const double F[3][3], double *history,
                           double P[3][3]);

/* Of its law's stress at F what relaxes, with its fibres: Se of law/viscosity.h [Pa]. */
void lar_relaxing_stress(const lar_material *material, const double *fibre, const double F[3][3],
                         double S[6]);

/* Energy per reference volume [J/m^3], that of lar_law_stress. */
double lar_law_energy(const lar_material *material, const double F[3][3]);
/* That of lar_material_stress, of what is active too, at the activation that it has. */
double lar_material_energy(const lar_material *material, const double *fibre, const double F[3][3]);
/* The part of it that is active. */
double lar_active_energy(const lar_material *material, const double *fibre, const double F[3][3]);

/* Cauchy stress from P and F: P F^T / J, as xx yy zz xy yz zx. */
void lar_cauchy_stress(const double F[3][3], const double P[3][3], double J, double cauchy[6]);

/* Von Mises stress and pressure (minus a third of the trace) of a Cauchy stress [Pa]. */
double lar_von_mises(const double cauchy[6]);
double lar_mean_pressure(const double cauchy[6]);

#endif
