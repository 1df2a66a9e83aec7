/* What acts on the nodes of one thread besides elements. */
#ifndef LAR_CONTACT_ACTING_H
#define LAR_CONTACT_ACTING_H

#include "contact/collide.h"
#include "contact/conditions.h"
#include "contact/touch.h"

typedef struct lar_acting {
    lar_conditions conditions; /* supports, prescribed motion, loads */
    lar_touch touch;           /* tools and planes */
    lar_collide collide;       /* bodies */
} lar_acting;

/* All of them; idempotent. */
static inline void lar_acting_destroy(lar_acting *acting) {
    lar_conditions_destroy(&acting->conditions);
    lar_touch_destroy(&acting->touch);
    lar_collide_destroy(&acting->collide);
}

/* The state has been replaced by another one: what contact knew of it, and had counted, is void. */
static inline void lar_acting_forget(lar_acting *acting) {
    lar_touch_forget(&acting->touch);
    lar_collide_forget(&acting->collide);
    acting->collide.too_many_pairs = false; /* the other state may have room for its pairs */
    acting->touch.seen = acting->collide.info = (lar_contact_info){0};
}

#endif
