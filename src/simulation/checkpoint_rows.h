/* The rows of the state's table (layout/state.h) as a checkpoint has them: one after the other, for
 * all nodes of the mesh each. */
#ifndef LAR_SIMULATION_CHECKPOINT_ROWS_H
#define LAR_SIMULATION_CHECKPOINT_ROWS_H

#include "layout/state.h"

/* A node's values in the order of the table, from and to the rows of a file. */
static inline void lar_checkpoint_get(const double *rows, size_t nodes, size_t node,
                                      double value[LAR_NODE_VALUES]) {
#define LAR_STATE_GET(array, count, before, always)                                                \
    memcpy(value, rows + nodes * (before) + node * (count), (count) * sizeof *value);              \
    value += (count);
    LAR_STATE_ROWS(LAR_STATE_GET)
#undef LAR_STATE_GET
}

static inline void lar_checkpoint_put(double *rows, size_t nodes, size_t node,
                                      const double value[LAR_NODE_VALUES]) {
#define LAR_STATE_PUT(array, count, before, always)                                                \
    memcpy(rows + nodes * (before) + node * (count), value, (count) * sizeof *value);              \
    value += (count);
    LAR_STATE_ROWS(LAR_STATE_PUT)
#undef LAR_STATE_PUT
}

/* As lar_state_hash, for nodes in the mesh's order. */
static inline uint64_t lar_checkpoint_hash(uint64_t step, const double *rows, size_t nodes) {
    uint64_t hash = lar_hash_word(0, step);
    for (size_t n = 0; n < nodes; n++) {
        double value[LAR_NODE_VALUES];
        lar_checkpoint_get(rows, nodes, n, value);
        hash = lar_state_hash_values(hash, value);
    }
    return hash;
}

#endif
