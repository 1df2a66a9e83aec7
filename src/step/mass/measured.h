/* How fast strained elements have become: what they need of a step, (omega dt / 2)^2.
 *
 *     by strain    what the law says of the mean gradient        from the monitor
 *     by areas     of flat ones, as they are                     steady while nodes go little
 *     by barriers  that are at work, or come near                those of the corners' list
 *
 * What counts is the largest need of all, and those that find no room in a whole step (needs.h). So
 * those with barriers come first, and for most of the others it is enough to know that they need
 * no more than that. No bit depends on how that is known.
 */
#ifndef LAR_STEP_MASS_MEASURED_H
#define LAR_STEP_MASS_MEASURED_H

#include "layout/state.h"
#include "step/domain.h"

/* Measures all elements of run r that the monitor has listed, of which lar_strained.near are known
 * to be close to a barrier: for state->need, and state->needs where it is there. */
void lar_measure_strained(const lar_domain *domain, const lar_hex8_monitor *monitor, int32_t r,
                          lar_state *state);

/* How far nodes go in the steps that are looked ahead, if nothing stops them, where it is known. */
double lar_way_ahead(const lar_domain *domain, const lar_state *state);

/* In place of the stiffness of barriers that no corner can come to on that way. */
static const double LAR_BARRIER_FAR = -1;

#endif
