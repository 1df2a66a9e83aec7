/* One experiment computed with given parameters: what would have been measured.
 *
 *     to rest    level 1 --ramp--> at rest? --> force --ramp--> level 2 --> at rest? --> force ...
 *     in time    0 ------ measured motion, straight between rows ------> force at each row's time
 *
 * Elastic tissue knows no history, so each level of a curve is ramped to and followed to rest
 * (simulation/rest.h), with the damping of static decks whatever the scene says: at rest that makes
 * no difference, and nothing comes to rest sooner. Tissue that relaxes is computed in the time of
 * the experiment, with the scene's own damping. Where the body is at rest to 1e-5 (rest.h), forces
 * are exact to about as much, which decides how far apart differences are taken
 * (study/inverse/inverse.h).
 */
#ifndef LAR_STUDY_INVERSE_FORWARD_H
#define LAR_STUDY_INVERSE_FORWARD_H

#include <signal.h>

#include "study/inverse/experiment.h"

/* Whether *stop, which may be NULL, is not 0: set by a signal or by another thread. */
static inline bool lar_inverse_stop_asked(const volatile sig_atomic_t *stop) {
    return stop && __atomic_load_n(stop, __ATOMIC_RELAXED);
}

/* The automatic time step of experiment k with value[parameters] [s]; 0 where none is to be kept:
 * at rest it does not count, and a scene may give its own. */
lar_status lar_inverse_own_step(const lar_inverse_problem *problem, int k, const double *value,
                                double *step, lar_error *error);

/* How runs in time go their steps (study/inverse/solver.h). */
typedef struct lar_inverse_pace {
    double step; /* that is kept, or the half, a quarter ... of it [s]; 0: the automatic one */
    double part; /* of the automatic step: the most */
    double open; /* told: by what share the account of energy was open at the end */
} lar_inverse_pace;

/* Into model[values] of experiment k, with value[parameters]; pace may be NULL. Ends early with
 * LAR_ERROR_ARGUMENT and an empty message when *stop (may be NULL) is not 0. Any thread; runs share
 * nothing. */
lar_status lar_inverse_forward(const lar_inverse_problem *problem, int k, const double *value,
                               lar_inverse_pace *pace, const volatile sig_atomic_t *stop,
                               double *model, lar_error *error);

#endif
