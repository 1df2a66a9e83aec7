#include "contact/surroundings.h"

#include <stdlib.h>
#include <string.h>

#include "contact/interactions.h"
#include "contact/tool_friction.h"

lar_status lar_surroundings_add_contact(const lar_model *model, const int32_t *local,
                                        const lar_condition_share *share, const lar_tool_list *list,
                                        lar_surroundings *surroundings, lar_error *error) {
    surroundings->list = list;
    lar_status status = lar_planes_create(model, local, share, NULL, &surroundings->planes, error);
    if (status || !list || list->count == 0) return status;
    status = lar_tool_faces_create(model, local, share, &surroundings->faces, error);
    if (status || !lar_tool_friction_any(list)) return status;
    return lar_tool_friction_list(model, local, share, &surroundings->conditions,
                                  &surroundings->faces, error);
}

lar_status lar_surroundings_add_bodies(const lar_model *model, const double *mass,
                                       const int32_t *local, double time_step, double stable_step,
                                       lar_surroundings *surroundings, lar_error *error) {
    lar_contact_tree *tree = &surroundings->bodies;
    lar_status status = lar_contact_tree_create(model, mass, local, tree, error);
    if (status || tree->surface.node_count == 0) return status;
    return lar_contact_surface_fit(model, time_step, stable_step, &tree->surface, error);
}

void lar_surroundings_destroy(lar_surroundings *surroundings) {
    lar_conditions_destroy(&surroundings->conditions);
    lar_planes_destroy(&surroundings->planes);
    lar_tool_faces_destroy(&surroundings->faces);
    lar_contact_tree_clear(&surroundings->bodies);
    surroundings->list = NULL;
}

/* Whoever is fixed to a plane's nodes does not stop at it; whoever is released does. */
static lar_status set_supports(lar_interactions *interactions, const lar_model *model,
                               const lar_condition_share *share, const lar_supports *set,
                               lar_error *error) {
    const lar_conditions *conditions = &interactions->surroundings->conditions;
    lar_plane_contact *contact = &interactions->tool_contact.plane_contact, fresh = {0};
    lar_planes planes;
    lar_status status = lar_planes_create(model, conditions->local, share, set, &planes, error);
    if (!status) status = lar_plane_contact_create(&planes, &fresh, error);
    if (!status)
        status =
            lar_condition_notes_set(conditions, model, share, set, &interactions->notes, error);
    if (status) {
        lar_plane_contact_destroy(&fresh);
        lar_planes_destroy(&planes);
        return status;
    }
    lar_plane_contact_destroy(contact);
    lar_planes_destroy(&interactions->planes);
    interactions->planes = planes;
    *contact = fresh;
    contact->planes = &interactions->planes;
    return LAR_OK;
}

lar_status lar_interactions_set(lar_interactions *interactions,
                                const lar_condition_context *context, const lar_supports *set,
                                lar_error *error) {
    const int32_t *local = interactions->surroundings->conditions.local;
    size_t nodes = (size_t)context->model->mesh.node_count;
    if (memcmp(&interactions->notes.set, set, sizeof *set) == 0) return LAR_OK;
    int32_t *holds = lar_calloc(nodes, sizeof *holds);
    if (!holds) return lar_fail_memory(error, nodes * sizeof *holds, "supports");
    for (size_t n = 0; n < nodes; n++)
        holds[n] = local[n] >= context->first && local[n] < context->end;
    const lar_condition_share share = {.thread = 1, .holds = holds};
    lar_status status = set_supports(interactions, context->model, &share, set, error);
    free(holds);
    return status;
}
