/* What acts on the nodes of one thread besides elements. */
#ifndef LAR_CONTACT_ACTING_H
#define LAR_CONTACT_ACTING_H

#include "contact/body_contact.h"
#include "contact/conditions.h"
#include "contact/tool_contact.h"

typedef struct lar_acting {
    lar_conditions conditions;     /* supports, prescribed motion, loads */
    lar_tool_contact tool_contact; /* tools and planes */
    lar_body_contact body_contact; /* bodies */
} lar_acting;

/* All of them; idempotent. */
static inline void lar_acting_destroy(lar_acting *acting) {
    lar_conditions_destroy(&acting->conditions);
    lar_tool_contact_destroy(&acting->tool_contact);
    lar_body_contact_destroy(&acting->body_contact);
}

/* The state has been replaced by another one: what contact knew of it, and had counted, is void. */
static inline void lar_acting_forget(lar_acting *acting) {
    lar_tool_contact_forget(&acting->tool_contact);
    lar_body_contact_forget(&acting->body_contact);
    acting->body_contact.too_many_pairs = false; /* the other state may have room for its pairs */
    acting->tool_contact.seen = acting->body_contact.info = (lar_contact_info){0};
}

#endif
