/* Going back when the run becomes unstable, so that no hand ends a session.
 *
 *     origin     1        2        3        4     broke
 *     ---o-------o--------o--------o--------o-------x      a state every 0.5 s, in memory
 *                                  ^                       4 is too young to be sound: on from 3
 *                         ^                                broke again soon: one further back
 *        ^                                                 none left: where the session was opened,
 *                                                          reset or loaded, and then the start
 *
 * A state is sound when the run has gone on for 0.25 s behind it. It breaks again `soon` when it
 * does so within 1 s after going back, or where it broke before: from the same state the same
 * inputs lead to the same break.
 *
 * The run is taken up as from a checkpoint: the same bits follow, on every grid, so the state that
 * stands in a recording plays on to the same hashes. Tools begin at rest where that state has them;
 * hands have let go. For a second they follow what moves them no faster than 0.1 m/s, and a hand
 * that was closed is not followed before it has opened.
 *
 * What is not a hand's doing stops the session: a run that breaks although nobody has moved a tool
 * since it went back to the start would do so for ever. Where that is not known, since somebody
 * moves the tools all the time, they rest for a second once the start has not helped.
 */
#ifndef LAR_SESSION_RECOVERY_H
#define LAR_SESSION_RECOVERY_H

#include "simulation/simulation.h"

enum { LAR_STATES_KEPT = 4 };

typedef struct lar_kept_state {
    lar_state state;
    lar_tools tools;
} lar_kept_state;

typedef struct lar_recovery {
    lar_kept_state kept[LAR_STATES_KEPT]; /* a ring: the oldest is `first` */
    int first, count;
    lar_kept_state origin; /* where the session was opened, reset or loaded last */
    bool has_origin;       /* and the run had not broken there */
    /* Numbers of steps. */
    uint64_t every, sound, soon;
    uint64_t arrived, broke; /* the last time that it went back: where to, and from where */
    bool went_back;          /* since the last opening, reset or load */
    uint64_t slow_until;     /* tools follow slowly before this step; 0: they do not */
    uint64_t rest_until;     /* tools do not follow at all before this step */
} lar_recovery;

/* Memory for all states. `time_step` in seconds. */
lar_status lar_recovery_create(const lar_simulation *simulation, double time_step,
                               lar_recovery *recovery, lar_error *error);
void lar_recovery_destroy(lar_recovery *recovery); /* idempotent; a zeroed one is fine */

#endif
