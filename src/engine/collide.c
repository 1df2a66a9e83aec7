#include "engine/collide.h"

void lar_collide_destroy(lar_collide *collide) {
    *collide = (lar_collide){0};
}

void lar_collide_apply(lar_collide *collide, const lar_condition_context *context,
                       lar_state *state) {
    (void)collide, (void)context, (void)state;
}

void lar_collide_half_work(const lar_collide *collide, const lar_condition_context *context,
                           lar_state *state) {
    (void)collide, (void)context, (void)state;
}
