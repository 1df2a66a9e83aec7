#include "model/forces.h"

#include <math.h>
#include <string.h>

static bool is_zero(const double force[3]) {
    return force[0] == 0 && force[1] == 0 && force[2] == 0;
}

bool lar_forces_put(lar_forces *forces, const lar_force_entry *entry) {
    int32_t at = 0;
    while (at < forces->count &&
           (forces->entry[at].of != entry->of || forces->entry[at].on_set != entry->on_set))
        at++;
    if (!is_zero(entry->force)) {
        if (at == LAR_FORCES_MAX) return false;
        forces->entry[at] = *entry;
        if (at == forces->count) forces->count++;
        return true;
    }
    if (at == forces->count) return true;
    forces->count--;
    memmove(&forces->entry[at], &forces->entry[at + 1],
            (size_t)(forces->count - at) * sizeof *entry);
    forces->entry[forces->count] = (lar_force_entry){0};
    return true;
}

void lar_forces_at(const lar_forces *forces, const lar_model *model, int32_t node, double sum[3]) {
    for (int i = 0; i < 3; i++) sum[i] = 0;
    for (int32_t k = 0; k < forces->count; k++) {
        const lar_force_entry *entry = &forces->entry[k];
        lar_force_nodes nodes = lar_force_nodes_of(model, entry);
        for (int32_t n = 0; n < nodes.count; n++)
            for (int i = 0; i < 3 && nodes.node[n] == node; i++) sum[i] += entry->force[i];
    }
}

bool lar_force_good(const lar_force_entry *entry, const lar_model *model, double max) {
    const lar_mesh *mesh = &model->mesh;
    bool of = entry->of >= 0 && (entry->on_set == 0 || entry->on_set == 1) &&
              entry->of < (entry->on_set ? mesh->set_count : mesh->node_count);
    if (!of || (entry->on_set && mesh->set[entry->of].kind != LAR_SET_NODES)) return false;
    for (int i = 0; i < 3; i++)
        if (!(fabs(entry->force[i]) <= max)) return false;
    return true;
}

bool lar_forces_good(const lar_forces *forces, const lar_model *model, double max) {
    bool good = forces->count >= 0 && forces->count <= LAR_FORCES_MAX && forces->padding == 0;
    for (int32_t k = 0; good && k < forces->count; k++)
        good = lar_force_good(&forces->entry[k], model, max) && !is_zero(forces->entry[k].force);
    return good;
}
