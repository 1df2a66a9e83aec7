/* Strained elements that are heavier for a while, in place of steps in parts.
 *
 *     need n of an element, (w dt / 2)^2,     dt / p bears it      p^2 as much
 *     and of springs at its corners           f times its mass     f as much
 *
 * A few squeezed elements divide the steps of the whole body. Where the scene lets them
 * (mass_scaling: {strained: SHARE}), those that need most move with up to FACTOR_MAX times their
 * mass, together with at most that share of the model's; then steps are divided into as few parts
 * as that allows. The bound that makes it sound is the one of mass_scaling.h: no mode of an
 * assembly is faster than its fastest element, each with its own mass in eighths at its corners.
 *
 * Decided where steps are divided (step/interval.h), from what every processor reports
 * (step/mass/needs.h). A factor rises at once and fades like the memory of what was needed, in
 * eighths, so that it changes seldom. Velocities stay when mass changes, and what that does to the
 * kinetic energy is work from outside, to the last joule (docs/theory.md). What has been added
 * moves and has no weight; springs of contact are fitted to masses without it.
 */
#ifndef LAR_STEP_MASS_HEAVIER_H
#define LAR_STEP_MASS_HEAVIER_H

#include "layout/state.h"
#include "step/domain.h"
#include "step/mass/needs.h"

/* ---- who is heavier: decided by processor zero ---------------------------------------------- */

/* What was needed in an interval. */
void lar_heavier_harvest(const lar_needs *needs, lar_heavy_list *list);

/* A decision begins: what was needed counts, what was needed before less. The LAR_HEAVIER_MAX that
 * need most stay. */
void lar_heavier_fade(double fading, lar_heavy_list *list);

/* What a step, or parts of one, have room for, (omega dt / 2)^2 with dt undivided, and what of it
 * springs may take that elements of the list have not reported. */
typedef struct lar_heavy_room {
    double max, springs;
} lar_heavy_room;

/* Whether the elements bear that with what they may be heavier. */
bool lar_heavier_bears(const lar_domain *whole, const lar_heavy_list *list,
                       const lar_heavy_room *room);

/* They become as heavy as that takes, those that were heavier fade. */
void lar_heavier_settle(const lar_domain *whole, const lar_heavy_room *room, double fading,
                        lar_heavy_list *list);

/* Who of a list is heavier. True when *now changes. */
bool lar_heavier_name(const lar_heavy_list *list, lar_heavy_now *now);

/* Whether what comes from elsewhere may be of this model. */
bool lar_heavier_good(const lar_domain *whole, const lar_heavy_list *list);
bool lar_heavier_now_good(const lar_domain *whole, const lar_heavy_now *now);

/* What they have more than they weigh [kg]. */
double lar_heavier_added(const lar_domain *whole, const lar_heavy_now *now);

/* ---- what follows for masses ---------------------------------------------------------------- */

/* Between steps: the masses of those that are heavier from now on. What that does to the kinetic
 * energy goes to state->external; NULL: the state belongs to these masses already. True when
 * something changed. */
bool lar_burden_take(lar_domain *domain, const lar_heavy_now *now, lar_state *state);

/* How many times its mass an element has now. */
double lar_burden_factor(const lar_domain *domain, lar_gid e);

#endif
