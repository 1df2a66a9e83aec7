/* Materials of a domain: as the model has them, with the parameters that were set, times their
 * stiffness; and what they say in the blocks of elements. What changes them between steps is
 * lar_domain_stiffen (domain.h).
 */
#ifndef LAR_STEP_MATERIALS_H
#define LAR_STEP_MATERIALS_H

#include "step/domain.h"

/* As the model has them. */
lar_status lar_materials_copy(lar_domain *domain, lar_error *error);

/* What the material of the element in a lane says, in block `b` of run `r`, and in corner_limit. */
void lar_materials_fill(const lar_domain *domain, int32_t r, int32_t b, void *block, int lane);

#endif
