/* Domains of several simulations of one model: what no call changes is there once.
 *
 *     simulation   domain ---- own: blocks, materials (lar_domain_stiffen compiles them anew),
 *                        \    masses where strained elements may be heavier (lar_burden_take)
 *                        \
 *     its clone    domain ---- shared, counted: layout, masses, conditions, faces, planes, bodies
 *
 * Whoever leaves last frees what is shared, in whatever order simulations are destroyed. */
#ifndef LAR_STEP_DOMAIN_SHARE_H
#define LAR_STEP_DOMAIN_SHARE_H

#include "step/domain.h"

/* A domain of a whole model once more, as stiff as `from` is now; the caller sets
 * surroundings.list. One thread at a time for `from`; afterwards each belongs to its own. */
lar_status lar_domain_share(lar_domain *from, lar_domain *copy, lar_error *error);

/* lar_domain_destroy for a domain that may be shared; idempotent. */
void lar_domain_leave(lar_domain *domain);

#endif
