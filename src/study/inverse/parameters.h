/* Parameters of materials by name, and the axis on which a fit moves them.
 *
 * Names are those of the law's row (law/law.h); shear_modulus, bulk_modulus, youngs_modulus and
 * poisson_ratio where two moduli are all that the law has; g0, g1, time1, g2, ... of what relaxes;
 * fibres.ksi and so on of fibres (lar_fibre_parameter_name), fibres.along and fibres.across of what
 * is active in them.
 *
 *     value p          [low, high]
 *     u                ln p where the bounds are positive: moduli of tissue are known to a factor,
 *                      not to a pascal; else p over the size of its bounds
 *     x                u = middle + half sin(x - 2), so that every x is within the bounds
 *
 * The sine (James and Roos, MINUIT, Comput. Phys. Commun. 10:343, 1975) reaches the bounds, which
 * a logistic curve would not, and keeps Levenberg-Marquardt free of them: MINPACK knows none. The
 * shift by 2 keeps x away from 0, where MINPACK's first step would be none.
 */
#ifndef LAR_STUDY_INVERSE_PARAMETERS_H
#define LAR_STUDY_INVERSE_PARAMETERS_H

#include "study/inverse/problem.h"

/* A parameter of a material. False: it has none of that name. */
bool lar_inverse_get(const lar_material *material, const char *name, double *value);
bool lar_inverse_set(lar_material *material, const char *name, double value);
/* The names that a material has, into name[max]; how many. */
typedef char lar_inverse_name[24];
int lar_inverse_names(const lar_material *material, lar_inverse_name *name, int max);
/* "Pa", "s" or "". */
const char *lar_inverse_unit(const lar_material *material, const char *name);

/* The first material of that name in any experiment; NULL: none. */
const lar_material *lar_inverse_material(const lar_inverse_problem *problem, const char *name);

/* Of parameter j of the problem: "Pa", "s" or "". */
const char *lar_inverse_unit_of(const lar_inverse_problem *problem, int j);

/* All parameters into the materials of one model; where there is no such material nothing. */
void lar_inverse_set_all(const lar_inverse_problem *problem, const double *value,
                         lar_material *material, int materials);

double lar_inverse_u(const lar_inverse_parameter *p, double value);
double lar_inverse_value(const lar_inverse_parameter *p, double u);
double lar_inverse_u_low(const lar_inverse_parameter *p);
double lar_inverse_u_high(const lar_inverse_parameter *p);
double lar_inverse_x(const lar_inverse_parameter *p, double u);
double lar_inverse_u_of_x(const lar_inverse_parameter *p, double x, double *slope /* du/dx */);

#endif
