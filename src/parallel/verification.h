/* Verification (T 6.9): instead of adding forces, the parallel program collects who they are from.
 *
 *     a vector, 24 bytes:   | count | e1 | e2 | ... | e11 |     twelve 16-bit numbers
 *
 * Recovering an element puts its number into the vectors of its nodes; where forces would be added,
 * lists are joined; where a node would move, its list must be exactly the elements that the model
 * has there. Packets, schedules, buffers and threads do not know the difference. So one step of
 * this says that every force arrives everywhere, once.
 *
 * Models with more elements, or more than eleven at a node, are verified in several passes, one per
 * step: in pass r the elements e with e mod passes = r take part, as number e / passes.
 */
#ifndef LAR_PARALLEL_VERIFICATION_H
#define LAR_PARALLEL_VERIFICATION_H

#include "divide/incidence.h"
#include "step/domain.h"
#include "layout/state.h"

enum { LAR_LIST_MAX = 11 };

typedef struct lar_verification {
    const lar_model *model;
    lar_incidence incidence;
    int32_t passes;
} lar_verification;

lar_status lar_verification_create(const lar_model *model, lar_verification *verification,
                                   lar_error *error);
void lar_verification_destroy(lar_verification *verification); /* idempotent */

/* Joins the list `part` to `sum`. A list that grows too long stays too long. */
void lar_list_join(int64_t sum[3], const int64_t part[3]);

/* Puts the elements of runs first .. first + count - 1 into the lists of their nodes. */
void lar_verification_recover(const lar_verification *verification, const lar_domain *domain,
                              int32_t first, int32_t count, lar_state *state);

/* Compares the lists of local nodes first .. end - 1 with the model and clears them. The first
 * difference is an error that names node, processor, step and the elements that are missing or too
 * many. */
lar_status lar_verification_compare(const lar_verification *verification, const lar_domain *domain,
                                    int32_t processor, int32_t first, int32_t end, lar_state *state,
                                    lar_error *error);

#endif
