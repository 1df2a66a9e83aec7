/* Activation (model/activation.h) of the elements of a domain, within the step and between steps.
 *
 * A run of blocks with active stress gets a number for each lane, made anew in every step from what
 * was set, the curve and the wave of the lane's material. Where nobody changes anything, no number
 * is made and the kernels take the stress as it is.
 *
 * Whoever changes the activation a does work. Elements store a W1 with W1 the potential of the
 * whole active stress (law/fibre_stress.h). As the activation goes from step to step,
 *
 *     external += (a[n] - a[n-1]) (W1[n-1] + W1[n]) / 2
 *
 * summed by parts: step n adds W1[n] (a[n+1] - a[n-1]) / 2, and nothing must be remembered. Of a
 * state that is looked at, the half up to n is added then. What is set between two steps jumps:
 * lar_activation_work, as for stiffness (simulation/simulation_settings.c).
 */
#ifndef LAR_STEP_ACTIVATION_H
#define LAR_STEP_ACTIVATION_H

#include "layout/state.h"
#include "step/domain.h"

/* Places on the way of waves, where there are any. */
lar_status lar_activation_plan(lar_domain *domain, lar_error *error);
void lar_activation_unplan(lar_domain *domain); /* idempotent */

/* Between steps: what was set. */
void lar_activation_take(lar_domain *domain, const lar_settings *settings);

/* Of run r at the time of the state, into the scratch that the state lends; false: all of the
 * active stress is there, and *step says nothing. */
bool lar_activation_begin(const lar_domain *domain, int32_t r, const lar_state *state,
                          lar_active_step *step);
/* Behind the kernel, which has filled step->energy: what the change of activation does in this
 * step [J]. */
double lar_activation_change(const lar_domain *domain, int32_t r, const lar_active_step *step,
                             const lar_state *state);

/* Activation of element e at `time` [s]. */
double lar_activation_at(const lar_domain *domain, lar_gid e, double time);

/* The material of element e, with as much of its active stress as there is at `time` [s]. */
lar_material lar_activation_material(const lar_domain *domain, lar_gid e, double time);

/* Half of the work that the change up to the present step does on element e [J]; `F`: its
 * deformation gradient. state->past is known (lar_step_enter). */
double lar_activation_pending(const lar_domain *domain, const lar_state *state, lar_gid e,
                              double volume, const double F[3][3]);

/* What it takes to set the activations of `wanted` in place of those of the domain [J]; `past` is
 * the last step (lar_past_step) and `next` the one that follows [s]. */
double lar_activation_work(const lar_domain *domain, const lar_settings *wanted,
                           const lar_state *state, double past, double next);

#endif
