/* Friction of bodies against each other and themselves: Coulomb's law with stick.
 *
 *        s  elastic slip [m]              a node that touches a face is held by a spring along the
 *     ---o~~~~~o---  node                 surface from where it took hold: as stiff and as damped
 *        |        face                    as the one that pushes it, and never stronger than mu
 *                                         times that. Beyond, it slides, and takes its hold along.
 *
 * On planes and tools friction is decided with all other forces known (plane_contact.h). Between
 * bodies nobody knows them: those of the face's corners are other threads' and processors' until
 * the step is over. So what sticks remembers how far it has come: four numbers for each contact
 * node, behind the history of viscous elements, in the state of everyone who has the node:
 *
 *     sx sy sz    elastic slip against the body that it rubs on [m]
 *     body + 1    which that is; 0: none
 *
 * They travel with the places, so whoever takes part in a contact computes its friction to the same
 * bits, and who moves the node takes its numbers on. Return mapping (Wriggers 2006): s grows by
 * what the node moves along the face and is cut off where it reaches the cone; it is projected on
 * the surface as that turns. The spring gives back no more than what it took.
 *
 * Momentum and moments. The face is taken to go on, flat, to where the node is: the velocity that
 * it has there is that of its closest point, plus what its tilting makes of the gap. The forces on
 * its corners are those of the transposed map, so no rigid motion of both rubs, and moments balance
 * as well as forces, also across the contact distance.
 *
 * A point of a sharp edge rubs with the mean slip of the edge's two nodes; the cone is its own. A
 * node rubs on one body at a time: the one that it holds on to until another pushes it twice as
 * hard. With it, what the points of its edges bear counts.
 */
#ifndef LAR_CONTACT_FRICTION_BODY_FRICTION_H
#define LAR_CONTACT_FRICTION_BODY_FRICTION_H

#include "contact/body_contact.h"

/* What a node hears of friction in the step under way. */
typedef struct lar_rub_note {
    double hardest;  /* push on it [N]; 0: nothing yet */
    double same;     /* the hardest of the body that it holds on to [N] */
    double slip[3];  /* of that push, not cut off yet [m] */
    double limit;    /* the longest slip within a cone of that body [m] */
    int32_t leading; /* the body of the hardest */
} lar_rub_note;

struct lar_body_friction {
    lar_rub_note *note;        /* [contact nodes] of those that this thread moves */
    int32_t *touched, *active; /* [contact nodes] with a note; with numbers that are not 0 */
    int32_t touched_count, active_count;
    bool known; /* `active` belongs to the state */
};

/* A push of a face on a node or a point of an edge. */
typedef struct lar_rub {
    int32_t node, face;
    const double *x, *v;                    /* [m], [m/s] */
    const double *way;                      /* its direction, of length one */
    const double (*corner)[3], (*speed)[3]; /* of the face */
    const double *weight;                   /* the corners' shares in the closest point */
    double press;                           /* [N] */
    double mass;                            /* that its spring moves [kg] */
} lar_rub;

/* Makes `friction` of a contact whose surface is rough; of others nothing. */
lar_status lar_body_friction_create(const lar_contact_surface *surface, lar_body_contact *contact,
                                    lar_error *error);
void lar_body_friction_destroy(lar_body_contact *contact); /* idempotent */

/* Before the contacts of a step. */
void lar_body_friction_begin(lar_body_friction *friction);

/* Adds friction on the corners of the face to `on`; the node gets minus their sum. False: none. */
bool lar_body_friction_rub(lar_body_contact *contact, const lar_state *state, const lar_rub *rub,
                           double on[4][3]);

/* The nodes move: what those that this thread moves remember goes on. */
void lar_body_friction_keep(lar_body_contact *contact, lar_state *state);

/* What nodes of this surface remember: the last values of a state's history. */
static inline size_t lar_stick_total(const lar_contact_surface *surface) {
    return surface->rough ? LAR_STICK_VALUES * (size_t)surface->node_count : 0;
}
static inline double *lar_stick_of(const lar_contact_surface *surface, const lar_state *state,
                                   int32_t node) {
    return state->history + state->history_count - lar_stick_total(surface) +
           LAR_STICK_VALUES * (size_t)node;
}

#endif
