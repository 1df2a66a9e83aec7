/* Who holds what: surface points bound to tools.
 *
 *     hand: opening 1 ... 0.2     takes hold of the points of the surface within its radius
 *                                 (of the nearest one, when there is none but one is near)
 *     grasper                     of the points between its jaws
 *     opening 0.2 ... 0.6         lets go
 *
 * Decided between advances by whoever has the whole state (engine/tools.h); the springs themselves
 * are engine/touch.h's. */
#ifndef LAR_ENGINE_HOLD_H
#define LAR_ENGINE_HOLD_H

#include "engine/domain.h"
#include "engine/state.h"

/* Takes hold or lets go, as the tool's new pose asks: `pose->opening` below 0.25 closes a grasper
 * or a hand that is open, above 0.5 opens it. Where the tool is now, at state->step, decides what
 * is within reach. Other tools do not hold. No memory is asked for. */
lar_status lar_hold_update(const lar_domain *whole, const lar_state *state,
                           const lar_tool_list *list, int32_t tool, const lar_tool_pose *pose,
                           lar_tools *tools, lar_error *error);

#endif
