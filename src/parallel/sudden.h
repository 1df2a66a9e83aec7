/* Steps in which what acts changes at once: forces and settings that somebody sets, loads whose
 * tables jump, the first steps of all.
 *
 * Processors run ahead of each other, so a list of pairs in contact has room for what nodes may
 * move until all have stopped (computer_contact.c), told by how fast they are. Where what acts
 * jumps that says nothing: a node may be as fast in the next step as no node was before. There all
 * stop after every round, and the list is good as long as on one processor.
 */
#ifndef LAR_PARALLEL_SUDDEN_H
#define LAR_PARALLEL_SUDDEN_H

#include "contact/tools.h"
#include "step/domain.h"

typedef struct lar_sudden {
    uint64_t since; /* the step before which something was set last, or a state taken up */
    lar_settings settings;
    lar_forces forces;
    double *size; /* [curves of the model] the largest value of each; NULL: none */
} lar_sudden;

lar_status lar_sudden_create(const lar_model *model, lar_sudden *sudden, lar_error *error);
void lar_sudden_destroy(lar_sudden *sudden); /* idempotent */

/* Before a stretch from `step`: whether something has been set since the last one; `fresh`: the
 * state is another one. */
void lar_sudden_note(lar_sudden *sudden, const lar_tools *tools, uint64_t step, bool fresh);

/* The first such step from `step` on; `end`: there is none before. */
uint64_t lar_sudden_next(const lar_sudden *sudden, const lar_domain *whole, uint64_t step,
                         uint64_t end);

#endif
