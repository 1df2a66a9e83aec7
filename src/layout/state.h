/* The state of a simulation: everything that changes from step to step, in ONE table.
 *
 * The table drives allocation, freeing, and (as the engine grows) checkpoint, hash and
 * comparison: an array that is not in it does not exist. Nodes are in the domain's local order,
 * four values each (x, y, z, 0), padded to an even number of nodes and aligned to 64 bytes. The
 * fourth value of u is the node's offset in contact of its body with itself (body_contact.h), which
 * the kernels leave as it is.
 */
#ifndef LAR_LAYOUT_STATE_H
#define LAR_LAYOUT_STATE_H

#include <stdint.h>

#include "base/memory.h"

/* X(type, name, values per node, kept): `kept` arrays carry the state from one step to the next;
 * the others are empty between steps. */
#define LAR_STATE_ARRAYS(X)                                                                        \
    X(double, u, 4, 1)      /* displacements at the present time [m] */                            \
    X(double, v, 4, 1)      /* velocities half a step before it [m/s] */                           \
    X(int64_t, force, 4, 0) /* internal minus external forces [force units] */

typedef struct lar_strained lar_strained; /* step/guard.h */

typedef struct lar_state {
    uint64_t step;   /* steps done */
    int32_t part;    /* parts of a divided step done; 0 between advances */
    int32_t parts;   /* of the step under way */
    uint64_t round;  /* times that nodes were moved; no state */
    double damped;   /* sum over the steps of sum c m |v + v'|^2, c: damping */
    double external; /* work of loads, prescribed motion and tools so far [J] */
    double contact;  /* what contacts have taken from the bodies so far [J] */
    double fastest;  /* largest velocity of an axis of the nodes moved last [m/s]; no state */
    double need;     /* of the elements looked at in this stretch of steps: see lar_step_division */
    bool close;      /* they are looked at in this step: lar_division_is_close */
    bool listed;     /* the strained elements are listed; false: they are looked for anew */
    lar_strained *strained; /* the list, lent; no state */
    int32_t node_count;
#define LAR_STATE_MEMBER(type, name, values, kept) type *name;
    LAR_STATE_ARRAYS(LAR_STATE_MEMBER)
#undef LAR_STATE_MEMBER
} lar_state;

/* All zero, for `node_count` (even) nodes. */
lar_status lar_state_create(lar_state *state, int32_t node_count, lar_error *error);
void lar_state_destroy(lar_state *state); /* idempotent */

#endif
