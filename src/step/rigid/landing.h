/* Planes stop free bodies as bodies: where nodes would come below a plane within the step, impulses
 * at these take from momentum and spin what would take them there, and by Coulomb's friction what
 * goes along the plane. Inelastic, as planes are for nodes, or by Newton's restitution; where that
 * and friction together would give energy, inelastic (Kane and Levinson 1985).
 *
 * The impulses of all nodes in touch are found together, by sweeps over them, each with what the
 * others leave (projected Gauss-Seidel; Jourdan, Alart and Jean 1998). Before a plane a body is its
 * convex hull, so of many nodes those count that go farthest in sixteen directions along the plane,
 * and the deepest.
 */
#ifndef LAR_STEP_RIGID_LANDING_H
#define LAR_STEP_RIGID_LANDING_H

#include "step/rigid/inertia.h"

enum { LAR_LANDING_SPOTS = 17 }; /* of a plane */

/* A node that may touch a plane within the step. */
typedef struct lar_landing_spot {
    int32_t node;       /* the nth of the body's, from 1; 0: none */
    int plane;          /* the nth of the model's entries of contact */
    double most;        /* how far it goes in its direction [m] */
    double arm[3], gap; /* from sum->centre; above the plane [m] */
    double came[3];     /* from here on of those that touch: how fast, before all impulses [m/s] */
    double half[3];     /* of that, half of what the forces of the step have given [m/s] */
    double back;        /* how fast the plane throws it back; 0: it does not [m/s] */
    double push[3];     /* impulses along its normal and along the plane [N s] */
    double yields, yields_beside; /* speed by an impulse of one [1/kg] */
    double way[3][3];             /* unit, of these impulses */
    double lever[3][3];           /* spin by one [m] */
    double swing[3][3];           /* what the body turns by for it [1/(kg m)] */
} lar_landing_spot;

typedef struct lar_landing {
    const lar_model *model;
    const lar_tool *tool;
    lar_rigid_sum *sum;
    double dt, inverse[6]; /* of the inertia that is free to turn; else zero [1/(kg m^2)] */
    double v[3], w[3];     /* of the body within the step [m/s], [1/s] */
    double light[3];       /* one over its mass along axes that are free [1/kg] */
    double bounces;        /* the part of restitution that spots are thrown back with */
    int32_t nodes;         /* seen so far */
    int count;
    lar_landing_spot spot[LAR_TOOL_PLANES_MAX * LAR_LANDING_SPOTS];
} lar_landing;

/* `sum`: all of it; stays with the caller, and is what changes at the end. */
void lar_landing_begin(const lar_model *model, const lar_tool *tool, lar_rigid_sum *sum, double dt,
                       lar_landing *landing);

/* One node after the other, as seen from sum->centre. */
void lar_landing_meet(lar_landing *landing, const double arm[3]);

void lar_landing_end(lar_landing *landing);

/* Adds the impulses on the nth node, from 1 [N s]. */
void lar_landing_on(const lar_landing *landing, int32_t node, double impulse[3]);

#endif
