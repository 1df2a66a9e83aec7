/* How long a step may be: the elements' highest frequencies, and the mass that the scene lets those
 * have that would ask for shorter steps than it wants (mass_scaling.h).
 */
#ifndef LAR_STEP_STABLE_STEP_H
#define LAR_STEP_STABLE_STEP_H

#include "mechanics/hex8.h"
#include "model/model.h"
#include "model/settings.h"

/* What an element's frequency follows from, with the mass that moves. */
typedef struct lar_element_rate {
    double square; /* of its highest frequency at rest [1/s^2] */
    double mass;   /* of a corner [kg] */
    double added;  /* of this; what the element does not weigh [kg] */
    double share;  /* of `square`: what its neighbours leave of it, at most 1 */
} lar_element_rate;

typedef struct lar_step_bound {
    double step;    /* the elements' bound at rest [s] */
    double without; /* the same without added mass [s] */
    lar_gid worst, worst_without;
    double fastest[LAR_FACTORS_MAX]; /* lar_domain.fastest */
} lar_step_bound;

/* An element's own highest frequency at rest [rad/s] if it were of that material, and its hex8
 * form. */
double lar_element_frequency(const lar_model *model, lar_element_kind kind, lar_gid e,
                             const lar_material *material, lar_hex8 *hex8);

/* Fills rate[elements], with as much mass as that takes (lar_mass_scaling_check). */
lar_status lar_step_bound_find(const lar_model *model, lar_element_kind kind,
                               lar_element_rate *rate, lar_step_bound *bound, lar_error *error);

/* The elements' bound of the time step at rest and the element that sets it. */
lar_status lar_stable_step(const lar_model *model, lar_element_kind kind, double *step,
                           lar_gid *worst, lar_error *error);

/* The step that `time_step: auto` takes: 0.8 of the stable step, which leaves room for elements
 * that are squeezed during the run; less where bodies touch whose volume gives way (K below 22 G),
 * for springs that are as stiff as they are; and at most 1/200 of a duration that the model states.
 */
double lar_auto_step(const lar_model *model, double stable_step);

/* Whether steps bear materials that are `times` faster, squares of frequencies, and take `share` of
 * a step, without being divided: what is little faster does so. */
static inline bool lar_little_faster(double times, double share) {
    return times <= 1.02 && share <= 0.9;
}

/* What an undivided step bears of elements and springs together, (omega dt / 2)^2, what the
 * springs of tools take of it that are as hard as at rest, and what the fastest element takes that
 * is not strained. Parts of a step bear their square times as much; springs do not become stiffer
 * with them. */
typedef struct lar_step_room {
    double max, springs, rest;
} lar_step_room;

lar_step_room lar_step_room_of(double time_step, double stable_step);

/* Force units: the characteristic force, (K + 4 G/3) V^(2/3) of the stiffest element, is 2^45 to
 * 2^46 units, so rounding is 1e-14 of it and 2^8 times it still fits (docs/theory.md); or up to
 * 2^50. Returns by how many powers more. */
int lar_force_scale_choose(const lar_model *model, double *scale);

#endif
