/* Mass scaling: elements that would ask for shorter steps than the scene wants move with more mass
 * than they weigh.
 *
 *     stable step of the element at rest   2 / w
 *     wanted                               2 / w' = s,  s > 2 / w
 *     its mass becomes                     m (s w / 2)^2, at each corner an eighth as before
 *
 * That is added mass of each element, lumped (Olovsson, Simonsson and Unosson 2005 add a matrix
 * that spares an element's rigid motion; this is the plain kind, with which masses stay diagonal).
 * It follows from mesh and materials alone. Only what has the added mass moves with it; it has no
 * weight (step/step.c), so that what is at rest is what it would be without.
 */
#ifndef LAR_STEP_MASS_SCALING_H
#define LAR_STEP_MASS_SCALING_H

#include "step/stable_step.h"

/* Refuses more than the model's largest share. */
lar_status lar_mass_scaling_check(const lar_model *model, const lar_element_rate *rate,
                                  const lar_step_bound *bound, lar_error *error);

/* What lar_model_inspect tells of it; of `box` lower and upper are known. */
lar_status lar_mass_scaling_tell(const lar_model *model, const lar_element_rate *rate,
                                 const lar_step_bound *bound, const lar_model_info *box,
                                 lar_mass_scaling *told, lar_error *error);

#endif
