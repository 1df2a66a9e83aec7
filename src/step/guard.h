/* The guard of strained elements (mechanics/hex8_guard.h), within the step.
 *
 * In the last step of an interval the kernels list the elements that are strained. These are looked
 * at, eight side by side: how fast they have become, for the division of steps, and how close a
 * corner is to where its barrier begins. Those that are close are gone through in every step until
 * the next list is made. A force is added only where a barrier is at work, so which elements are
 * listed besides does not matter; and corners with volume to spare are not looked at again before
 * the fastest node can have used it up.
 */
#ifndef LAR_STEP_GUARD_H
#define LAR_STEP_GUARD_H

#include "step/mass/strained.h"

/* Adds the barriers' forces of run r to state->force. */
void lar_guard_apply(const lar_domain *domain, int32_t r, lar_state *state);

/* The same in a step in which the kernel has listed the strained elements of run r: what is close
 * of these is what is looked at from now on. `measures`: how fast they are counts for
 * state->need. Both in one go, for looking at corners is what takes the time. */
void lar_guard_select_and_apply(const lar_domain *domain, int32_t r,
                                const lar_hex8_monitor *monitor, bool measures, lar_state *state);

/* The same of all elements of the model, looked for one by one. */
void lar_guard_apply_all(const lar_domain *domain, lar_state *state);

/* The first half of what dampers of barriers take in the step that follows, to state->contact, and
 * of what barriers lack, to state->external, as if none had lacked anything before. For who looks:
 * adds forces as well. */
void lar_guard_half_work(const lar_domain *domain, lar_state *state);

/* The second half of that of the step before, which the next step counts before it looks at the run
 * of the element: to *contact and *external. For who looks, and for who copies the state: one that
 * is put back knows nothing of the step before. */
void lar_guard_half_to_come(const lar_domain *domain, const lar_state *state, double *contact,
                            double *external);

/* Energy of an element's barriers [J]. */
double lar_guard_energy(const lar_domain *domain, const lar_state *state, lar_gid e);

#endif
