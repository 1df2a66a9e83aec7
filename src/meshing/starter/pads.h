/* What carries a body that its support does not: pads under it, as few as it takes.
 *
 *           .---------------------------.
 *          /   the body                  \
 *     ----'---------+-------------+-------'----
 *       support    pad           pad              its underside looks to the supported side
 *
 * In a body an organ lies on its neighbours, which a mesh of it alone does not have. Where its own
 * weight would move a piece of the body by more than 0.15 of the piece's length (linearly, in
 * the worst of three directions), small patches of its underside are held: first half of its
 * length apart, in the order of how far they would sag, then closer, until it is carried. */
#ifndef LAR_MESHING_STARTER_PADS_H
#define LAR_MESHING_STARTER_PADS_H

#include "meshing/starter/motion.h"

/* held: [nodes], by other rules; the pads' nodes are added to pad: [nodes], false before. The
 * underside is where the surface looks towards the lower (sign -1) or upper (1) end of an axis
 * within 60 degrees. handle and pulled: as in lar_motion_estimate; pads take nodes from the handle
 * where all else is carried. Returns the number of pads, whether the body is carried then,
 * and its motion with them. */
lar_status lar_pads_choose(const lar_meshing *meshing, const bool *held, int axis, int sign,
                           bool *handle, int pulled, bool *pad, int32_t *count, bool *carried,
                           lar_motion *motion, lar_error *error);

#endif
