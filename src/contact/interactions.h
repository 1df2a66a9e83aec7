/* What acts on the nodes of one thread besides elements. */
#ifndef LAR_CONTACT_INTERACTIONS_H
#define LAR_CONTACT_INTERACTIONS_H

#include "contact/body_contact.h"
#include "contact/conditions.h"
#include "contact/tool_contact.h"

typedef struct lar_interactions {
    lar_conditions conditions;     /* supports, prescribed motion, loads */
    lar_tool_contact tool_contact; /* tools and planes */
    lar_body_contact body_contact; /* bodies */
} lar_interactions;

/* All of them; idempotent. */
static inline void lar_interactions_destroy(lar_interactions *interactions) {
    lar_conditions_destroy(&interactions->conditions);
    lar_tool_contact_destroy(&interactions->tool_contact);
    lar_body_contact_destroy(&interactions->body_contact);
}

/* The state has been replaced by another one: what contact knew of it, and had counted, is void. */
static inline void lar_interactions_forget(lar_interactions *interactions) {
    lar_tool_contact_forget(&interactions->tool_contact);
    lar_body_contact_forget(&interactions->body_contact);
    interactions->body_contact.too_many_pairs =
        false; /* the other state may have room for its pairs */
    interactions->tool_contact.seen = interactions->body_contact.info = (lar_contact_info){0};
}

#endif
