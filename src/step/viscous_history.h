/* What viscous elements remember (law/viscosity.h), in the state of a domain and on its way to and
 * from others.
 *
 *     model     element 0, 1, 2, ...          one element's values one after the other; those of
 *                   |                         what is elastic have none. Hash, checkpoint and
 *                   v                         messages have this order
 *     domain    runs of blocks                eight lanes of each value beside each other, in the
 *                                             order in which a step needs them
 *
 * Every element belongs to one thread of one processor, which alone takes its history on. A model
 * in which nothing is viscous has none of this: no memory, no bit of any hash.
 */
#ifndef LAR_STEP_VISCOUS_HISTORY_H
#define LAR_STEP_VISCOUS_HISTORY_H

#include "layout/state.h"
#include "step/domain.h"

/* Plans the history of a domain whose runs are listed. Refuses elements that cannot have one, and
 * terms that relax within a step. */
lar_status lar_viscous_plan(lar_domain *domain, lar_error *error);
void lar_viscous_unplan(lar_domain *domain); /* idempotent */

/* Values of one element, 0: it is elastic. */
int lar_viscous_count(const lar_model *model, lar_gid e);
/* Values of all elements of a model. */
size_t lar_viscous_total(const lar_model *model);

/* Values of an element of this domain. */
void lar_viscous_read(const lar_domain *domain, const lar_state *state, lar_gid e, double *value);
void lar_viscous_write(const lar_domain *domain, lar_state *state, lar_gid e, const double *value);
/* Whether the domain recovers the element and it remembers. */
static inline bool lar_viscous_here(const lar_domain *domain, lar_gid e) {
    return domain->element_history && domain->element_history[e] >= 0;
}

/* All values of a model, element after element, from and to a whole's state. */
void lar_viscous_gather(const lar_domain *whole, const lar_state *state, double *value);
void lar_viscous_scatter(const lar_domain *whole, lar_state *state, const double *value);

/* What two domains of a model have in common, from one state to the other. */
void lar_viscous_copy(const lar_domain *from, const lar_state *state, const lar_domain *to,
                      lar_state *copy);

/* The history's part of the hash of a state, and of `values` of lar_viscous_gather. */
uint64_t lar_viscous_hash(const lar_domain *whole, const lar_state *state, uint64_t hash);
uint64_t lar_viscous_hash_values(uint64_t hash, const double *value, size_t values);

#endif
