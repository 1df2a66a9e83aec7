#include "server/embedded.h"

#include <stdlib.h>
#include <string.h>

bool lar_embedded_is_too_large(const lar_model *model) {
    lar_embedded_info info;
    if (!lar_model_embedded(model, &info)) return false;
    return info.triangles > LAR_EMBEDDED_MAX || info.vertices > LAR_EMBEDDED_MAX;
}

/* Marks the nodes of elements that carry vertices. */
static void mark_carriers(const lar_model *model, unsigned char *mark) {
    lar_embedded_info info;
    if (!lar_model_embedded(model, &info)) return;
    for (int32_t v = 0; v < info.vertices; v++) {
        const int32_t *node = lar_model_element_nodes(model, info.element[v]);
        for (int a = 0; a < 8; a++) mark[node[a]] = 1;
    }
}

lar_status lar_shown_create(const lar_model *model, lar_shown *shown, lar_error *error) {
    int32_t all = lar_model_node_count(model);
    size_t nodes = (size_t)all;
    lar_surface_info surface;
    lar_model_surface(model, &surface);
    *shown = (lar_shown){.count = surface.nodes,
                         .surface = surface.nodes,
                         .node = lar_calloc(nodes, sizeof *shown->node),
                         .has_embedded =
                             lar_model_embedded(model, NULL) && !lar_embedded_is_too_large(model)};
    unsigned char *mark = lar_calloc(nodes, 1);
    if (!shown->node || !mark) {
        lar_shown_destroy(shown);
        free(mark);
        return lar_fail_memory(error, 5 * nodes, "the nodes that viewers see");
    }
    if (shown->has_embedded) mark_carriers(model, mark);
    for (int32_t i = 0; i < surface.nodes; i++) {
        shown->node[i] = surface.node[i];
        mark[surface.node[i]] = 0;
    }
    for (int32_t k = 0; k < all; k++)
        if (mark[k]) shown->node[shown->count++] = k;
    free(mark);
    return LAR_OK;
}

void lar_shown_destroy(lar_shown *shown) {
    free(shown->node);
    *shown = (lar_shown){0};
}

/* ---- the message ---------------------------------------------------------------------------- */

/* `index`: of every node of the model among those shown. */
static void write_message(const lar_model *model, const lar_shown *shown, const float *processor,
                          const int32_t *index, unsigned char *out) {
    const double(*rest)[3] = lar_model_positions(model);
    lar_embedded_info info;
    lar_model_embedded(model, &info);
    size_t s = (size_t)(shown->count - shown->surface);
    size_t m = (size_t)info.vertices, k = (size_t)info.triangles;
    uint32_t *header = (uint32_t *)(void *)out;
    float *position = (float *)(void *)(header + 4);
    uint32_t *owner = header + 4 + 3 * s, *node = owner + s;
    float *weight = (float *)(void *)(node + s);
    uint32_t *carrier = node + s + 8 * m, *material = carrier + 8 * m, *corner = material + m;
    header[0] = 4;
    header[1] = (uint32_t)m;
    header[2] = (uint32_t)k;
    header[3] = (uint32_t)s;
    for (size_t i = 0; i < s; i++) {
        int32_t n = shown->node[(size_t)shown->surface + i];
        for (size_t axis = 0; axis < 3; axis++) position[3 * i + axis] = (float)rest[n][axis];
        owner[i] = (uint32_t)processor[n];
        node[i] = (uint32_t)n;
    }
    memcpy(weight, info.weight, m * sizeof *info.weight);
    for (size_t v = 0; v < m; v++) {
        const int32_t *nodes = lar_model_element_nodes(model, info.element[v]);
        for (size_t a = 0; a < 8; a++) carrier[8 * v + a] = (uint32_t)index[nodes[a]];
        material[v] = (uint32_t)lar_model_element_material(model, info.element[v]);
    }
    memcpy(corner, info.triangle, k * sizeof *info.triangle);
}

lar_status lar_embedded_message(const lar_model *model, const lar_shown *shown,
                                const float *processor, lar_blob *message, lar_error *error) {
    lar_embedded_info info;
    *message = (lar_blob){0};
    if (!shown->has_embedded || !lar_model_embedded(model, &info)) return LAR_OK;
    size_t s = (size_t)(shown->count - shown->surface);
    size_t length = 16 + 20 * s + 68 * (size_t)info.vertices + 12 * (size_t)info.triangles;
    unsigned char *memory = lar_calloc_aligned(LAR_HEADROOM + length, 1);
    int32_t *index = lar_calloc((size_t)lar_model_node_count(model), sizeof *index);
    if (!memory || !index) {
        free(memory);
        free(index);
        return lar_fail_memory(error, length, "the embedded surface for viewers");
    }
    for (int32_t i = 0; i < shown->count; i++) index[shown->node[i]] = i;
    write_message(model, shown, processor, index, memory + LAR_HEADROOM);
    free(index);
    *message = (lar_blob){memory, length};
    return LAR_OK;
}
