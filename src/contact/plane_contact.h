/* Bodies on fixed planes: nodes that stop at them.
 *
 *     free to be here        moved freely    stopped
 *        o  node                o               o
 *     ---|---------- plane   ---|-----       ---o-----
 *        v                      o
 *
 * A plane cannot move, so nobody else needs to know the force it exerts, and it need not be guessed
 * before the elements' forces are known: after the nodes have moved freely, those that went through
 * are put on the plane, with the velocity that takes them there, as supports are. That is the
 * limit of an infinitely stiff spring without its small time step. It cannot add energy whatever
 * the step (docs/theory.md, contact), nothing sinks in, and a resting node rests.
 *
 * Friction is decided with all forces known as well: what the stop has changed along the normal
 * tells the normal force, and so much along the plane is stopped as Coulomb's law allows, down to
 * nothing (lar_friction_part). A node that sticks stands still, but for rounding, for as long as it
 * does; no anchor is remembered.
 *
 * Every processor that has a node stops its copy, with the same bits.
 *
 * Prediction (T 3.8.2) from what has really happened instead of a greatest acceleration: no node
 * is faster than state->fastest, so the nodes that were farther away at the last search than all
 * have travelled since cannot be at the plane.
 */
#ifndef LAR_CONTACT_PLANE_CONTACT_H
#define LAR_CONTACT_PLANE_CONTACT_H

#include "contact/conditions.h"

/* How nodes with the same supports stop at a plane. */
typedef struct lar_plane_way {
    double normal[3]; /* unit, to where bodies may be */
    double slide[3];  /* the change of velocity per change of its part along the normal: the normal
                         itself, but for axes that supports hold */
    double free[3];   /* 0 for these axes and 1 for the others; without friction 1 */
    double grip;      /* Coulomb's coefficient, and times what the plane's impulse is larger than
                         that along the free axes */
    int64_t held;     /* friction, and some are 0 in `free` */
} lar_plane_way;

/* A node before a plane. */
typedef struct lar_plane_node {
    int32_t node; /* local */
    int32_t way;
    double offset; /* height above the plane at rest [m] */
} lar_plane_node;

/* One that may touch, with all that a stop needs in one place: the rest of a step leaves nothing of
 * it in the core's caches. */
typedef struct lar_plane_near {
    lar_plane_node node;
    double weight;    /* as the context has it */
    double before[3]; /* velocity before it moved [m/s] */
} lar_plane_near;

/* The nodes before planes: constant. */
typedef struct lar_planes {
    int32_t count, way_count;
    bool rough;           /* some have friction */
    lar_plane_node *node; /* [count] all planes of a node one after the other */
    lar_plane_way *way;   /* [way_count] */
} lar_planes;

/* What a thread knows of them. */
typedef struct lar_plane_contact {
    const lar_planes *planes;
    int32_t near_count;
    lar_plane_near *near; /* [near_count] in the order of planes->node */
    lar_plane_near *last; /* [planes->count] scratch of searches */
    double travel;        /* at most this far has any node gone since the search [m] */
    double reach;         /* how far `near` looks [m] */
    bool known;           /* `near` belongs to the state */
} lar_plane_contact;

/* `local` and `share` as for lar_conditions_create; `set`: supports that were set, or NULL. */
lar_status lar_planes_create(const lar_model *model, const int32_t *local,
                             const lar_condition_share *share, const lar_supports *set,
                             lar_planes *planes, lar_error *error);
void lar_planes_destroy(lar_planes *planes); /* idempotent */

/* `planes` outlive it. */
lar_status lar_plane_contact_create(const lar_planes *planes, lar_plane_contact *plane_contact,
                                    lar_error *error);
void lar_plane_contact_destroy(lar_plane_contact *plane_contact); /* idempotent */

/* Before the nodes move, and after they have, supports included. The work goes to state->contact.
 * With `always` the near nodes are searched anew. `seen` counts. */
void lar_plane_contact_observe(lar_plane_contact *plane_contact,
                               const lar_condition_context *context, const lar_state *state,
                               bool always, lar_contact_info *seen);
void lar_plane_contact_stop(lar_plane_contact *plane_contact, const lar_condition_context *context,
                            lar_state *state, bool always, lar_contact_info *seen);

/* The velocity that nodes would have half a step later: from `ahead`, what it were without planes,
 * to what it will be, for one node; `entry` is its first in `node`. Returns the entry behind its
 * last. (For energies; changes nothing.) */
int32_t lar_planes_ahead(const lar_planes *planes, const lar_condition_context *context,
                         const lar_state *state, int32_t entry, double ahead[3]);

#endif
