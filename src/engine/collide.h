/* Bodies against each other and themselves: what one thread has of it. */
#ifndef LAR_ENGINE_COLLIDE_H
#define LAR_ENGINE_COLLIDE_H

#include "engine/conditions.h"

typedef struct lar_collide {
    int32_t pair_count;
} lar_collide;

void lar_collide_destroy(lar_collide *collide); /* idempotent */

/* Adds the forces at the state's step to state->force. Asks for no memory. */
void lar_collide_apply(lar_collide *collide, const lar_condition_context *context,
                       lar_state *state);

/* Half the work of these forces in this step, to state->contact: once before and once after the
 * nodes move. */
void lar_collide_half_work(const lar_collide *collide, const lar_condition_context *context,
                           lar_state *state);

#endif
