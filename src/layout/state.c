#include "layout/state.h"

#include <stdlib.h>

lar_status lar_state_create(lar_state *state, int32_t node_count, size_t history_count,
                            lar_error *error) {
    *state = (lar_state){.node_count = node_count,
                         .stride = lar_axis_stride((size_t)node_count),
                         .history_count = history_count};
    bool complete = true;
    size_t bytes = 0;
#define LAR_STATE_CREATE(type, name, of_node, of_history, kept)                                    \
    size_t name##_size = LAR_STATE_SIZE(state, of_node, of_history);                               \
    if (name##_size) state->name = lar_calloc_aligned(name##_size, sizeof(type));                  \
    bytes += name##_size * sizeof(type);                                                           \
    complete = complete && (state->name || !name##_size);
    LAR_STATE_ARRAYS(LAR_STATE_CREATE)
#undef LAR_STATE_CREATE
    if (complete) return LAR_OK;
    lar_state_destroy(state);
    return lar_fail_memory(error, bytes, "the state of the nodes");
}

void lar_state_destroy(lar_state *state) {
#define LAR_STATE_DESTROY(type, name, of_node, of_history, kept) free(state->name);
    LAR_STATE_ARRAYS(LAR_STATE_DESTROY)
#undef LAR_STATE_DESTROY
    *state = (lar_state){0};
}
