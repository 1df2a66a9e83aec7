/* Friction of tools: Coulomb's law at the nodes of the faces that a tool pushes.
 *
 *     begin of a step    faces: what the tool pushes a corner with, times mu  -->  press sums
 *     elements, others   force sums, and press sums with them where nodes are shared
 *     before nodes move  who moves a node knows all forces but one: friction
 *
 *                 tool V ->                 F    sum of the pushes at the node, its normal
 *             ______________                f    along the surface, no more than mu |F|:
 *            |      F       |                    what brings the node to the tool's own
 *     -------o------v-------o------              velocity there, or as much of it as may be
 *                <- f
 *
 * Whether a node sticks or slides is decided in every step with all forces known, as on planes
 * (plane_contact.h; Carpenter, Taylor and Katona 1991), so that nothing creeps and nothing need be
 * remembered: no anchor in checkpoints, none to exchange when a face goes to another processor. A
 * spring with an anchor would need both, and its own part of what a step bears; a damper creeps:
 * a node of 0.1 g that bears 0.01 N would slip by 1 cm/s at 0.1 ms.
 *
 * The force is whole units like all others, in the same sums, and the tool feels its opposite: the
 * balance of momentum and moments is exact, and the account of energy needs nothing new. Press sums
 * are integers as well: the same on any grid.
 *
 * A node that several tools push at once rubs on the nearest of those with friction. Nodes that
 * supports hold or move along some axes rub along the others only, with what pushes them along
 * these: a node in a plane of symmetry is pushed from one side, and what pushes it across the plane
 * is borne by what is left out. Nodes of free bodies hang on springs instead (history/tool_grip.h).
 */
#ifndef LAR_CONTACT_TOOL_FRICTION_H
#define LAR_CONTACT_TOOL_FRICTION_H

#include "contact/tool_contact.h"
#include "mechanics/hex8_block.h"

/* Whether a tool of the list has friction; NULL: none. */
bool lar_tool_friction_any(const lar_tool_list *list);

/* Fills in faces->rub: nodes of the surface that the thread of the share moves. */
lar_status lar_tool_friction_list(const lar_model *model, const int32_t *local,
                                  const lar_condition_share *share,
                                  const lar_conditions *conditions, lar_tool_faces *faces,
                                  lar_error *error);

/* Room for it in contact->press and contact->rubbed, if a tool of contact->list has friction. */
lar_status lar_tool_friction_create(lar_tool_contact *contact, lar_error *error);
void lar_tool_friction_destroy(lar_tool_contact *contact); /* idempotent */

/* Whoever adds to the press sums of a local node, or replaces them, says so. */
static inline void lar_tool_friction_mark(uint64_t *pressed, int32_t node) {
    pressed[(uint32_t)node / 64] |= (uint64_t)1 << (uint32_t)node % 64;
}

/* Empties press sums of a step that was never finished. */
void lar_tool_friction_forget(lar_tool_contact *contact);

/* Adds to the press sums what a tool pushes the corners of a face with [N]. */
void lar_tool_friction_press(lar_tool_contact *contact, const lar_condition_context *context,
                             double friction, const lar_tool_contact_face *face,
                             const double force[3][4]);

/* Press and force sums are complete: adds friction to the force sums of the nodes that the thread
 * moves, and clears the press sums of these. `leapfrog` and `push` are those of the update that
 * follows (hex8_block.h). */
void lar_tool_friction_add(lar_tool_contact *contact, const lar_condition_context *context,
                           const lar_leapfrog *leapfrog, const double *push, lar_state *state);

/* Before the nodes move: what those of free bodies remember of it goes on. */
void lar_tool_friction_keep(const lar_tool_contact *contact, lar_state *state);

/* Half its work in this step, to state->external: once before and once after the nodes move. */
void lar_tool_friction_half_work(const lar_tool_contact *contact,
                                 const lar_condition_context *context, lar_state *state);

#endif
