#include "contact/surroundings.h"

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
