/* Who holds what: surface points bound to tools.
 *
 *     opening 1 ... 0.2    hand: takes hold of the points of the surface within its radius, or of
 *                          the nearest one within twice as much when there is none
 *                          grasper: of the points between its jaws
 *     opening 0.25 .. 0.5  grasper: holds softer and softer
 *     opening 0.2 ... 0.6  lets go
 *
 * Points are those at which tools touch (contact/tool_contact.h). A grasp is a spring and a damper
 * between the point and where it was in the tool's own axes when it was taken, so taking hold moves
 * nothing. All grasps of a tool together are as stiff as what it stands for: finger tips, or jaws.
 *
 * Decided between advances by whoever has the whole state (contact/tools.h); the springs themselves
 * are contact/tool_contact.h's.
 */
#ifndef LAR_STEP_GRASP_H
#define LAR_STEP_GRASP_H

#include "step/domain.h"
#include "layout/state.h"

/* Takes hold or lets go, as the tool's new pose asks: `pose->opening` below 0.25 closes a grasper
 * or a hand that is open, above 0.5 opens it. A grasper takes what is between its jaws now, at
 * state->step; an empty hand is already at `pose`. Other tools do not hold. A tool gets its share
 * of LAR_GRASPS_MAX: of more points it takes every second, third, ... No memory is asked for. */
lar_status lar_grasp_update(const lar_domain *whole, const lar_state *state,
                            const lar_tool_list *list, int32_t tool, const lar_tool_pose *pose,
                            lar_tools *tools, lar_error *error);
/* Whether that is asked for: only then the state is looked at. */
bool lar_grasp_changes(const lar_tool *tool, const lar_tool_motion *motion, double opening);

/* At a decision: what has been pulled out of a grasper's jaws, all of it farther than they are
 * long, is held no longer; closed as they are they hold nothing. True when that has happened. */
bool lar_grasp_slip(const lar_tool_list *list, lar_tools *tools);

/* Lets go of everything at once. */
void lar_grasp_drop(int32_t tool, lar_tools *tools);

/* How many points a tool holds. */
int32_t lar_grasp_count(const lar_tools *tools, int32_t tool);

/* The jaws of a grasper are asked to be as open as that: on the way from closed to open they hold
 * softer and softer, so that their letting go is no blow. */
void lar_grasp_ease(const lar_domain *whole, const lar_tool_list *list, int32_t tool,
                    double opening, lar_tools *tools);

#endif
