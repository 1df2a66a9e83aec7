/* How far a parameter can go while the others make up for it: its profile likelihood.
 *
 *     squares |  \                      /
 *             |   \                    /
 *      t^2 s^2|----\------------------/----   the interval ends where the squares have grown by
 *             |      \_____________/          t^2 s^2; where they have not at a bound, the data
 *             +----------------------- u      do not tell
 */
#ifndef LAR_STUDY_INVERSE_PROFILE_H
#define LAR_STUDY_INVERSE_PROFILE_H

#include "study/inverse/solver.h"

/* Moves parameter j from bound to bound, from the solver's best. The squares may grow by `limit`.
 * low and high are values; *open_low, *open_high: it fits as well at that bound. */
lar_status lar_inverse_profile(const lar_inverse_solver *solver, int j, double limit, double *low,
                               double *high, bool *open_low, bool *open_high, int *runs);

#endif
