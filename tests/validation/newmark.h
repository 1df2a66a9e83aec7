/* The way implicit programs step in time, for one purpose: to tell what in the answer of such a
 * program belongs to its element and what to its steps.
 *
 * Newmark's method with beta = 1/4, gamma = 1/2 (the trapezoidal rule), on hex8-full's forces, with
 * a consistent mass matrix and the accelerations at the start from the balance there:
 *
 *     M a' + f(u') = M g,    u' = u + dt v + dt^2 (a + a') / 4,    v' = v + dt (a + a') / 2,
 *
 * every step solved to rounding by Newton's method. The tangent comes from differences of the
 * element forces; matrices are banded as the nodes are numbered. What moves a support tells where
 * it is at the end of a step; its acceleration is what the rule makes of that, as in FEBio. For
 * small models: gravity, no other loads, no damping.
 */
#ifndef LAR_TESTS_VALIDATION_NEWMARK_H
#define LAR_TESTS_VALIDATION_NEWMARK_H

#include "model/model.h"

typedef enum newmark_mass { NEWMARK_CONSISTENT, NEWMARK_LUMPED } newmark_mass;
/* Balance at the end of a step, or half-way: FEBio's generalised alpha with rhoi = 1. */
typedef enum newmark_rule { NEWMARK_TRAPEZOIDAL, NEWMARK_MIDPOINT } newmark_rule;

/* Displacements u[3 * nodes] after `steps` steps of dt [s] from rest. False when Newton's method
 * does not converge or the memory is short. */
bool newmark_run(const lar_model *model, newmark_mass mass, newmark_rule rule, double dt, int steps,
                 double *u);

#endif
