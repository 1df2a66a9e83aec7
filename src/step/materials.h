/* Materials of a domain: as the model has them, with the parameters that were set, times their
 * stiffness; and what they say in the blocks of elements, and in what stands beside these: the
 * coefficients of viscosity, and fibres. What changes them between steps is
 * lar_domain_stiffen (domain.h).
 */
#ifndef LAR_STEP_MATERIALS_H
#define LAR_STEP_MATERIALS_H

#include "step/domain.h"

/* As the model has them. */
lar_status lar_materials_copy(lar_domain *domain, lar_error *error);

/* What the material of the element in a lane says, in block `b` of run `r`, and in corner_limit. */
void lar_materials_fill(const lar_domain *domain, int32_t r, int32_t b, void *block, int lane);

/* Makes the blocks of fibres and of what may fold, where there are any, and lets the runs point to
 * them. False: there was no memory. */
bool lar_beside_plan(lar_domain *domain);

/* Refuses kinds of elements that cannot have fibres. */
lar_status lar_fibres_check(const lar_domain *domain, lar_error *error);

#endif
