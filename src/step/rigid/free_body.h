/* Rigid bodies that nothing leads: tools that move nodes (LAR_TOOL_RIGID), with the key `free`.
 *
 * When all forces of a step are there, each node of a body has the velocity that it would have next
 * if nothing held them together. The body takes the rigid motion that has their momentum, and their
 * angular momentum about the centre of mass: that is the projection onto rigid motions in the
 * metric of masses, so what holds it together does no work. Gravity, damping, initial velocities
 * and all forces are in these velocities, and no state beside that of the nodes is needed: bits do
 * not depend on where a run was saved.
 *
 * Turns are those of SHAKE (Ryckaert, Ciccotti and Berendsen 1977) for a body of all its nodes:
 * with the Cayley vector v of the turn within the step, 2 tan(angle / 2) along its axis, I the
 * inertia and L the angular momentum,
 *
 *     I v + v x (I v) / 2 = (1 + v.v / 4) dt L,
 *
 * which keeps the angular momentum of the nodes' ways exactly, also of what spins freely.
 *
 * What turns about a point or an axis is the same about that point.
 *
 * One thread must have all nodes: lar_step does it itself; for processors it is done between steps,
 * and the parts of divided ones, by a look at the forces (lar_measure_ahead), with the same bits.
 */
#ifndef LAR_STEP_RIGID_FREE_BODY_H
#define LAR_STEP_RIGID_FREE_BODY_H

#include "contact/tools.h"
#include "step/domain.h"
#include "step/rigid/inertia.h"

bool lar_free_bodies_any(const lar_model *model);

/* For who looks: planes' impulses on nodes. */
typedef struct lar_landed {
    double times;       /* what to add of them [1/s] */
    double (*force)[3]; /* [nodes of the model] to this [N] */
} lar_landed;

/* All forces stand in state->force: tells `tools` where free bodies go in the step, or in the part
 * of it that comes, those that nobody leads. `leapfrog`: how nodes move there. `landed` may be
 * NULL. */
void lar_free_bodies_go(const lar_domain *domain, const lar_condition_notes *notes,
                        const lar_state *state, const lar_leapfrog *leapfrog, lar_tools *tools,
                        const lar_landed *landed);

/* Before the first step: how they turn to begin with, by the nodes' velocities. */
void lar_free_bodies_start(const lar_domain *domain, const lar_condition_notes *notes,
                           const lar_state *state, lar_tools *tools);

/* Whether one of them would turn by more than a tenth in each of so many parts of a step: momentum
 * says the sine of the turn, and beyond a quarter of a circle nothing. */
bool lar_free_bodies_turn_far(const lar_tools *tools, uint64_t step, int32_t parts);

/* For who looks before the first step, when nobody has decided yet into how many parts it is
 * divided: with as many as bodies ask for that spin fast. False: they ask for none. */
bool lar_free_bodies_divide(const lar_tools *tools, const lar_state *state, lar_tools *divided);

/* The Cayley vector of the turn of a body within dt, about `axis` where that is not zero. What is
 * as thin as a line turns about an axis only. */
void lar_free_body_turn(const lar_rigid_sum *sum, const double axis[3], double dt, double v[3]);

#endif
