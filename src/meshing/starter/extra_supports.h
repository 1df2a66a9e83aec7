/* What carries a body that its support does not: extra supports under it, as few as it takes.
 *
 *           .---------------------------.
 *          /   the body                  \
 *     ----'---------+-------------+-------'----
 *       support   extra         extra             its underside looks to the supported side
 *
 * In a body an organ lies on its neighbours, which a mesh of it alone does not have. Where its own
 * weight would move a piece of the body by more than 0.15 of the piece's length (linearly, in
 * the worst of three directions), small patches of its underside are held: first half of its
 * length apart, in the order of how far they would sag, then closer, until it is carried. */
#ifndef LAR_MESHING_STARTER_EXTRA_SUPPORTS_H
#define LAR_MESHING_STARTER_EXTRA_SUPPORTS_H

#include "meshing/starter/sag.h"

/* held: [nodes], by other rules; the extra supports' nodes are added to extra: [nodes], false
 * before. The underside is where the surface looks towards the lower (sign -1) or upper (1) end of
 * an axis within 60 degrees. handle and pulled: as in lar_sag_estimate; extra supports take
 * nodes from the handle where all else is carried. Returns the number of extra supports, whether
 * the body is carried then, and its motion with them. */
lar_status lar_extra_supports_choose(const lar_meshing *meshing, const bool *held, int axis,
                                     int sign, bool *handle, int pulled, bool *extra,
                                     int32_t *count, bool *carried, lar_sag *motion,
                                     lar_error *error);

#endif
