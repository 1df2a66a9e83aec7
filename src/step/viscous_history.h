/* What viscous elements remember (law/viscosity.h), and behind it nodes of bodies that rub
 * (contact/history/body_friction.h), in the state of a domain and on its way to and from others;
 * before it, those of free bodies that tools hold (contact/history/tool_grip.h).
 *
 *     model     element 0, 1, 2, ...          one element's values one after the other; those of
 *                   |                         what is elastic have none. Hash, checkpoint and
 *                   v                         messages have this order
 *     domain    runs of blocks                eight lanes of each value beside each other, in the
 *                                             order in which a step needs them
 *
 * Every element belongs to one thread of one processor, which alone takes its history on. A node is
 * taken on by all processors that have it, to the same bits. A model in which nothing is viscous,
 * no bodies rub and none is free has none of this: no memory, no bit of any hash.
 *
 * Items are the elements of the model, and behind them its contact nodes where these rub, and the
 * nodes of free bodies.
 */
#ifndef LAR_STEP_VISCOUS_HISTORY_H
#define LAR_STEP_VISCOUS_HISTORY_H

#include "layout/state.h"
#include "step/domain.h"

/* Plans the history of a domain whose runs are listed. Refuses elements that cannot have one, and
 * terms that relax within a step. */
lar_status lar_viscous_plan(lar_domain *domain, lar_error *error);
void lar_viscous_unplan(lar_domain *domain); /* idempotent */

/* Adds what nodes remember, where bodies rub: once, behind the plan; `surface`, that of the whole
 * model, outlives the domain. */
void lar_history_plan_nodes(lar_domain *domain, const lar_contact_surface *surface);

/* One behind the last item. */
static inline int32_t lar_history_end(const lar_domain *domain) {
    int32_t nodes = domain->rubbing ? domain->rubbing->node_count : 0;
    return domain->model->mesh.element_count + nodes + domain->grip_count;
}
/* The place of an item among the nodes of free bodies; -1: it is none of them. */
static inline int32_t lar_history_grip(const lar_domain *domain, int32_t item) {
    int32_t grip = item - (lar_history_end(domain) - domain->grip_count);
    return grip < 0 ? -1 : grip;
}
/* The node of the model that an item is; -1: it is an element. */
static inline lar_gid lar_history_node(const lar_domain *domain, int32_t item) {
    int32_t node = item - domain->model->mesh.element_count;
    int32_t grip = lar_history_grip(domain, item);
    if (node < 0) return -1;
    return grip < 0 ? domain->rubbing->node[node].node : domain->grip[grip];
}

/* Values of one item, 0: it is elastic. */
int lar_viscous_count(const lar_domain *domain, int32_t item);
/* Values of all items of a model. */
size_t lar_viscous_total(const lar_domain *domain);

/* Values of an item of this domain. */
void lar_viscous_read(const lar_domain *domain, const lar_state *state, int32_t item,
                      double *value);
void lar_viscous_write(const lar_domain *domain, lar_state *state, int32_t item,
                       const double *value);
/* Whether the domain recovers the element, or has the node, and it remembers. */
static inline bool lar_viscous_here(const lar_domain *domain, int32_t item) {
    lar_gid node = lar_history_node(domain, item);
    if (node >= 0) return domain->layout.local[node] >= 0;
    return domain->element_history && domain->element_history[item] >= 0;
}

/* All values of a model, item after item, from and to a whole's state. */
void lar_viscous_gather(const lar_domain *whole, const lar_state *state, double *value);
void lar_viscous_scatter(const lar_domain *whole, lar_state *state, const double *value);

/* What two domains of a model have in common, from one state to the other. */
void lar_viscous_copy(const lar_domain *from, const lar_state *state, const lar_domain *to,
                      lar_state *copy);

/* The history's part of the hash of a state, and of `values` of lar_viscous_gather. */
uint64_t lar_viscous_hash(const lar_domain *whole, const lar_state *state, uint64_t hash);
uint64_t lar_viscous_hash_values(uint64_t hash, const double *value, size_t values);

#endif
