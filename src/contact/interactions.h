/* What one thread knows, beside its state, of what acts on its nodes besides elements: what is near
 * what, what tools have felt, what has been counted. All of it can be forgotten between steps: the
 * next ones have the same bits, which is why energies are asked for with interactions of their own
 * (step/measure.h). */
#ifndef LAR_CONTACT_INTERACTIONS_H
#define LAR_CONTACT_INTERACTIONS_H

#include "contact/surroundings.h"

typedef struct lar_interactions {
    const lar_surroundings *surroundings;
    lar_condition_notes notes;     /* of supports, prescribed motion and loads */
    lar_tool_contact tool_contact; /* tools and planes */
    lar_body_contact body_contact; /* bodies */
    lar_planes planes;             /* where supports were set; in place of the surroundings' */
    lar_tools *leads;              /* free bodies go where these say that they do; NULL: others see
                                      to that (step/rigid/free_body.h) */
} lar_interactions;

/* Notes, and contact of tools and planes; bodies are left to the caller (lar_body_contact_create,
 * parallel/contact_exchange.h). `surroundings` and `tools`, which may be NULL, outlive it. */
static inline lar_status lar_interactions_create(const lar_surroundings *surroundings,
                                                 const lar_tools *tools, bool search_always,
                                                 lar_interactions *interactions, lar_error *error) {
    *interactions = (lar_interactions){.surroundings = surroundings};
    lar_status status =
        lar_condition_notes_create(&surroundings->conditions, &interactions->notes, error);
    if (status) return status;
    return lar_tool_contact_create(&surroundings->faces, &surroundings->planes, surroundings->list,
                                   tools, search_always, &interactions->tool_contact, error);
}

/* All of them; idempotent. */
static inline void lar_interactions_destroy(lar_interactions *interactions) {
    lar_condition_notes_destroy(&interactions->notes);
    lar_tool_contact_destroy(&interactions->tool_contact);
    lar_body_contact_destroy(&interactions->body_contact);
    lar_planes_destroy(&interactions->planes);
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
