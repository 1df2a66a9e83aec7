/* Forces that are set on nodes while a simulation runs, besides the model's loads.
 *
 * One entry for a node, or for a set of the mesh with so much on each of its nodes; what acts on a
 * node is the sum. Plain numbers, as settings (model/settings.h): they travel with the tools and
 * are in checkpoints, where an entry is 32 bytes.
 */
#ifndef LAR_MODEL_FORCES_H
#define LAR_MODEL_FORCES_H

#include <stdbool.h>

#include "model/model.h"

typedef struct lar_force_entry {
    int32_t of;      /* node of the model, or index of a set of nodes */
    int32_t on_set;  /* 0 or 1 */
    double force[3]; /* on the node, or on each of the set [N] */
} lar_force_entry;

typedef struct lar_forces {
    int32_t count, padding;
    lar_force_entry entry[LAR_FORCES_MAX];
} lar_forces;

/* The nodes that an entry is on. */
typedef struct lar_force_nodes {
    int32_t count;
    const int32_t *node;
} lar_force_nodes;

static inline lar_force_nodes lar_nodes_of(const lar_model *model, const int32_t *of, bool on_set) {
    if (!on_set) return (lar_force_nodes){1, of};
    const lar_set *set = &model->mesh.set[*of];
    return (lar_force_nodes){set->count, set->index};
}
static inline lar_force_nodes lar_force_nodes_of(const lar_model *model,
                                                 const lar_force_entry *entry) {
    return lar_nodes_of(model, &entry->of, entry->on_set);
}

/* Puts the entry in the place of that for the same node or set; zeros remove it. False: no place is
 * left. The order of entries is that in which they were first set. */
bool lar_forces_put(lar_forces *forces, const lar_force_entry *entry);

/* What acts on a node together [N]. */
void lar_forces_at(const lar_forces *forces, const lar_model *model, int32_t node, double sum[3]);

/* Whether an entry is for something of the model, and no component larger than `max` [N]. */
bool lar_force_good(const lar_force_entry *entry, const lar_model *model, double max);
/* The same of all, for what comes from files and from other processes. */
bool lar_forces_good(const lar_forces *forces, const lar_model *model, double max);

#endif
