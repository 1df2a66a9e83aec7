/* How a meshed body will move, guessed from its shape: enough to choose a damping, a pull that it
 * bears and how long to watch. */
#ifndef LAR_MESHING_MOTION_H
#define LAR_MESHING_MOTION_H

#include "meshing/meshing.h"

typedef struct lar_motion {
    double slowest;    /* [1/s] angular frequency of the slowest natural motion; 0: not known */
    double reach;      /* [m] from what is held to the handle, through the body */
    double compliance; /* [m/N] how far a force at the handle moves it */
} lar_motion;

/* held, handle: [nodes]; the handle is pulled along this axis of the world. All 0 where no element
 * hangs together with what is held. The regions' information must be there. */
lar_status lar_motion_estimate(const lar_meshing *meshing, const bool *held, const bool *handle,
                               int axis, lar_motion *motion, lar_error *error);

#endif
