/* How a meshed body will move, from its stiffness at rest: enough to choose what carries it, a
 * damping, a pull that it bears and how long to watch.
 *
 * One solution for four loads: the weight along each axis, and the pull. The least of their four
 * Rayleigh quotients is taken for the slowest motion's (slowest.h). */
#ifndef LAR_MESHING_STARTER_SAG_H
#define LAR_MESHING_STARTER_SAG_H

#include "meshing/meshing.h"

typedef struct lar_sag {
    double slowest;    /* [1/s] angular frequency of the slowest natural motion; 0: nothing moves */
    double compliance; /* [m/N] how far a force at the handle moves it, in the mean */
} lar_sag;

/* held, handle: [nodes]; the handle is pulled along this axis of the world. What hangs together
 * with nothing that is held is left out. Nodes that would go several times as far as half of the
 * handle does are taken out of it: they sit on something thin, which is drawn out and not the body,
 * and the way of the rest would be another on every mesh. sag: [nodes], or NULL: how far the weight
 * would move each node, the worst of three directions [m], were it that stiff all the way. The
 * regions' information must be there. */
lar_status lar_sag_estimate(const lar_meshing *meshing, const bool *held, bool *handle, int axis,
                            lar_sag *motion, double *sag, lar_error *error);

#endif
