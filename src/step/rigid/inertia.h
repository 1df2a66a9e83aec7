/* Mass, momentum and inertia of a rigid body. */
#ifndef LAR_STEP_RIGID_INERTIA_H
#define LAR_STEP_RIGID_INERTIA_H

#include "model/model.h"

/* Sums over the nodes of a body where they are now, with their masses and those velocities. */
typedef struct lar_rigid_sum {
    double mass, centre[3]; /* [kg]; of mass, or where the body is held [m] */
    double momentum[3];     /* [kg m/s] */
    double spin[3];         /* angular momentum about `centre` [kg m^2/s] */
    double inertia[6];      /* about `centre`: xx yy zz xy yz zx [kg m^2] */
    double had[3],
        had_spin[3]; /* momentum and spin half a step before, without the step's forces */
} lar_rigid_sum;

/* a: xx yy zz xy yz zx. */
void lar_symmetric_product(const double a[6], const double v[3], double out[3]);

/* The inverse; with an axis, not zero, what is left of it where a body turns about that alone.
 * false, and zero: of nodes that lie in a line, or nearly, or in the axis. */
bool lar_inertia_invert(const double inertia[6], const double axis[3], double out[6]);

/* What a change of the spin is multiplied with to have the turn: zero along axes that are not free
 * to turn. */
void lar_rigid_sum_yields(const lar_rigid_sum *sum, const lar_tool *tool, double inverse[6]);

#endif
