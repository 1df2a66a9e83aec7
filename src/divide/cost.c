#include "divide/cost.h"

#include <string.h>

int32_t lar_node_processors(const lar_incidence *incidence, const int32_t *processor, int32_t k,
                            int32_t *set) {
    int32_t count = 0;
    for (int64_t i = incidence->first[k]; i < incidence->first[k + 1]; i++) {
        int32_t p = processor[incidence->element[i]];
        int32_t at = count;
        while (at > 0 && set[at - 1] > p) at--;
        if (at > 0 && set[at - 1] == p) continue;
        memmove(set + at + 1, set + at, (size_t)(count - at) * sizeof *set);
        set[at] = p;
        count++;
    }
    return count;
}

lar_cost lar_cost_measure(const lar_incidence *incidence, const int32_t *processor,
                          int32_t processors, int32_t *set, int64_t *pays) {
    lar_cost cost = {0};
    memset(pays, 0, (size_t)processors * sizeof *pays);
    for (int32_t k = 0; k < incidence->node_count; k++) {
        int32_t count = lar_node_processors(incidence, processor, k, set);
        if (count < 2) continue;
        for (int32_t i = 0; i < count; i++) pays[set[i]] += lar_cost_of_node(count);
        cost.total += count * lar_cost_of_node(count);
    }
    for (int32_t p = 0; p < processors; p++) {
        double square = (double)pays[p] * (double)pays[p];
        cost.power += square * square;
        if (pays[p] > cost.worst) cost.worst = pays[p];
    }
    return cost;
}
