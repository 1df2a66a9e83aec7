#include "model/supports.h"

#include <string.h>

static void mark_nodes(const lar_node_list *nodes, unsigned axes, uint8_t *mark) {
    for (int32_t k = 0; k < nodes->count; k++) mark[nodes->node[k]] |= (uint8_t)axes;
}

static lar_force_nodes nodes_of(const lar_model *model, const lar_support_entry *entry) {
    return lar_nodes_of(model, &entry->of, entry->on_set);
}

void lar_supports_mark(const lar_supports *supports, const lar_model *model, uint8_t *mark) {
    memset(mark, 0, (size_t)model->mesh.node_count);
    for (int i = 0; i < model->fix_count; i++)
        mark_nodes(&model->fix[i].nodes, model->fix[i].axes, mark);
    for (int i = 0; i < model->move_count; i++)
        mark_nodes(&model->move[i].nodes, model->move[i].axes, mark);
    for (int32_t k = 0; supports && k < supports->count; k++) {
        const lar_support_entry *entry = &supports->entry[k];
        lar_force_nodes nodes = nodes_of(model, entry);
        unsigned axes = entry->axes;
        for (int32_t n = 0; n < nodes.count; n++) {
            uint8_t *at = &mark[nodes.node[n]];
            *at = (uint8_t)((*at & ~axes) | (entry->held ? axes : 0) | axes * LAR_SUPPORT_SET);
        }
    }
}

static bool holds_any(const lar_supports *supports, const lar_model *model,
                      const lar_support_entry *entry, uint8_t *mark) {
    lar_force_nodes nodes = nodes_of(model, entry);
    unsigned held = 0;
    lar_supports_mark(supports, model, mark);
    for (int32_t n = 0; n < nodes.count; n++) held |= mark[nodes.node[n]];
    return held & entry->axes;
}

bool lar_supports_put(lar_supports *supports, const lar_model *model,
                      const lar_support_entry *entry, uint8_t *mark) {
    lar_supports made = {0};
    for (int32_t k = 0; k < supports->count; k++) {
        lar_support_entry old = supports->entry[k];
        if (old.of == entry->of && old.on_set == entry->on_set) old.axes &= (uint8_t)~entry->axes;
        if (old.axes) made.entry[made.count++] = old;
    }
    if (entry->held || holds_any(&made, model, entry, mark)) {
        if (made.count == LAR_SUPPORTS_MAX) return false;
        made.entry[made.count++] = *entry;
    }
    *supports = made;
    return true;
}

bool lar_support_good(const lar_support_entry *entry, const lar_model *model) {
    const lar_mesh *mesh = &model->mesh;
    return entry->of >= 0 && entry->on_set <= 1 && entry->held <= 1 && entry->padding == 0 &&
           entry->axes >= 1 && entry->axes <= LAR_AXIS_ALL &&
           (entry->on_set
                ? entry->of < mesh->set_count && mesh->set[entry->of].kind == LAR_SET_NODES
                : entry->of < mesh->node_count);
}

bool lar_supports_good(const lar_supports *supports, const lar_model *model) {
    bool good =
        supports->count >= 0 && supports->count <= LAR_SUPPORTS_MAX && supports->padding == 0;
    for (int32_t k = 0; good && k < supports->count; k++)
        good = lar_support_good(&supports->entry[k], model);
    return good;
}

static unsigned axes_there(lar_force_nodes nodes, unsigned axes, int32_t node) {
    for (int32_t k = 0; k < nodes.count; k++)
        if (nodes.node[k] == node) return axes;
    return 0;
}

static unsigned axes_of(const lar_node_list *nodes, unsigned axes, int32_t node) {
    return axes_there((lar_force_nodes){nodes->count, nodes->node}, axes, node);
}

unsigned lar_supports_at(const lar_supports *supports, const lar_model *model, int32_t node) {
    unsigned held = 0;
    for (int i = 0; i < model->fix_count; i++)
        held |= axes_of(&model->fix[i].nodes, model->fix[i].axes, node);
    for (int i = 0; i < model->move_count; i++)
        held |= axes_of(&model->move[i].nodes, model->move[i].axes, node);
    for (int32_t k = 0; k < supports->count; k++) {
        const lar_support_entry *entry = &supports->entry[k];
        unsigned axes = axes_there(nodes_of(model, entry), entry->axes, node);
        held = entry->held ? held | axes : held & ~axes;
    }
    return held;
}
