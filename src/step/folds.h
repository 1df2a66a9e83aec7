/* What keeps flat elements from folding (mechanics/fold/hex8_fold.h), of a domain: a block beside
 * each of a run with such elements. Which these are is the model's; how stiff they are follows the
 * materials as they are now.
 */
#ifndef LAR_STEP_FOLDS_H
#define LAR_STEP_FOLDS_H

#include "layout/state.h"
#include "mechanics/fold/hex8_fold.h"
#include "step/domain.h"

/* Once runs are there: finds those that need it. False: no memory. */
bool lar_folds_plan(lar_domain *domain);

/* A lane of block b of run r, which is there, with its material as it is now, whose hourglass modes
 * are held with so much stiffness, times the scale. */
void lar_folds_fill(const lar_domain *domain, int32_t r, int32_t b, int lane,
                    const double stiffness[LAR_HEX8_HOURGLASS]);

/* Energy of an element [J], 0 of those that do not fold. */
double lar_folds_energy(const lar_domain *domain, const lar_state *state, lar_gid e);

#endif
