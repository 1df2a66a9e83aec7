/* Sets of nodes: who has a node, and in which directions it must travel (traffic.h). */
#include <stdlib.h>

#include "divide/cost.h"
#include "divide/traffic.h"

lar_status lar_sharing_build(const lar_incidence *incidence, const lar_distribution *distribution,
                             lar_sharing *out, lar_error *error) {
    size_t corners = (size_t)incidence->first[incidence->node_count];
    lar_sharing s = {.grid = distribution->grid,
                     .node_count = incidence->node_count,
                     .first = lar_calloc((size_t)incidence->node_count + 1, sizeof *s.first),
                     .processor = lar_calloc(corners + 1, sizeof *s.processor)};
    if (!s.first || !s.processor) {
        lar_sharing_clear(&s);
        return lar_fail_memory(error, corners * sizeof *s.processor, "processors of nodes");
    }
    /* P_k is no larger than E_k: it fits behind what is there already. */
    for (int32_t k = 0; k < s.node_count; k++)
        s.first[k + 1] = s.first[k] + lar_node_processors(incidence, distribution->processor, k,
                                                          s.processor + s.first[k]);
    *out = s;
    return LAR_OK;
}

void lar_sharing_clear(lar_sharing *sharing) {
    free(sharing->first);
    free(sharing->processor);
    *sharing = (lar_sharing){0};
}

double lar_sharing_mean(const lar_sharing *sharing) {
    return (double)sharing->first[sharing->node_count] / sharing->node_count;
}

int lar_node_direction(const lar_grid *grid, const int32_t *set, int32_t count) {
    int32_t spread[3];
    int direction = 0;
    lar_grid_spread_along(grid, set, count, spread);
    for (int axis = 0; axis < 3; axis++) {
        if (spread[axis] > 1) return LAR_DIRECTION_IRREGULAR;
        direction |= spread[axis] << axis;
    }
    return direction;
}

bool lar_node_scattered(const lar_grid *grid, const int32_t *set, int32_t count) {
    int direction = lar_node_direction(grid, set, count);
    if (direction == LAR_DIRECTION_IRREGULAR) return true;
    int32_t corners = 1;
    for (int axis = 0; axis < 3; axis++) corners <<= direction >> axis & 1;
    return count != corners;
}
