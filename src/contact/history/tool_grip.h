/* Friction of tools on free bodies: Coulomb's law with stick that remembers.
 *
 *     tool  ==~~~~~==o  node     s   elastic slip [m]: how far the node has come along the tool
 *            s           `       from where it took hold
 *
 * What a node of tissue needs to stick follows from the forces on it (tool_friction.h). A node of a
 * rigid body bears what others of the body ask for, and whoever moves it does not know that: held
 * by its own forces alone it would slip by M / m dt g a second, M being the mass of the body and m
 * that of the nodes that are held. So it hangs on a spring, as where bodies rub on each other
 * (body_friction.h), never stronger than the cone: what sticks does not creep.
 *
 * The springs are as stiff as those that push the node off the tool, which the body bears all at
 * once: pressed with F by a tool that is d deep in the body, F / d, or what the node's mass bears
 * if that is more.
 *
 * Four numbers for each node of a free body, the first of a state's history:
 *
 *     sx sy sz    elastic slip [m]
 *     tool + 1    which it holds on to; 0: none
 */
#ifndef LAR_CONTACT_HISTORY_TOOL_GRIP_H
#define LAR_CONTACT_HISTORY_TOOL_GRIP_H

#include "contact/body_contact.h"
#include "mechanics/contact.h"

/* The nodes of the model that remember, which are as many as it returns, in their order: none where
 * no tool is rough (those that are added later are not). `node` may be NULL. */
int32_t lar_grips_list(const lar_model *model, int32_t *node);

static inline double *lar_grip_of(const lar_state *state, int32_t grip) {
    return state->history + LAR_STICK_VALUES * (size_t)grip;
}

/* A node that a tool presses. */
typedef struct lar_grip {
    int32_t tool;
    double stiffness; /* of its spring [N/m] */
    double press[3];  /* along the normal, as long as friction may be strong [N] */
    double slide[3];  /* its velocity against the tool [m/s] */
} lar_grip;

/* The force on the node [N], and what it remembers next: it `had` that. `dt`: of the step or part
 * under way [s]; `lead` [s]: how much sooner it pulls (mechanics/contact.h). */
void lar_tool_grip_pull(const lar_grip *grip, double lead, double dt,
                        const double had[LAR_STICK_VALUES], double next[LAR_STICK_VALUES],
                        double force[3]);

#endif
