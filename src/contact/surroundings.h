/* What acts on the nodes of one thread besides elements, compiled from the model: constant. What is
 * known of the state stands beside that (interactions.h).
 *
 *     surroundings (constant)        interactions (beside the state)
 *       conditions           --->      notes           within a step
 *       planes, faces        --->      tool_contact    what is near, what tools felt, counters
 *       bodies               --->      body_contact    list of pairs, search under way, counters
 */
#ifndef LAR_CONTACT_SURROUNDINGS_H
#define LAR_CONTACT_SURROUNDINGS_H

#include "contact/body_contact.h"
#include "contact/conditions.h"
#include "contact/tool_contact.h"

typedef struct lar_surroundings {
    const lar_tool_list *list; /* of the simulation; NULL: no tools */
    lar_conditions conditions; /* supports, prescribed motion, loads */
    lar_planes planes;         /* nodes before fixed planes */
    lar_tool_faces faces;      /* before tools */
    lar_contact_tree bodies;   /* what may touch what; of the whole model only */
} lar_surroundings;

/* Planes and, where there can be tools, faces: of the whole model, or with a share (NULL: all) of
 * one thread. `list` outlives it and may be NULL. `conditions` are there already; what cannot be
 * made is cleared with lar_surroundings_destroy. */
lar_status lar_surroundings_add_contact(const lar_model *model, const int32_t *local,
                                        const lar_condition_share *share, const lar_tool_list *list,
                                        lar_surroundings *surroundings, lar_error *error);

/* Bodies that may touch, of the whole model. */
lar_status lar_surroundings_add_bodies(const lar_model *model, const double *mass,
                                       const int32_t *local, double time_step, double stable_step,
                                       lar_surroundings *surroundings, lar_error *error);

/* All of them; idempotent. */
void lar_surroundings_destroy(lar_surroundings *surroundings);

#endif
