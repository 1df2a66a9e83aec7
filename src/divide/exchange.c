#include "divide/exchange.h"

#include <stdlib.h>

lar_status lar_exchange_create(const lar_mesh *mesh, const lar_incidence *incidence,
                               int32_t processors, lar_exchange *x, lar_error *error) {
    size_t pairs = (size_t)processors * (size_t)processors;
    *x = (lar_exchange){
        .mesh = mesh,
        .incidence = incidence,
        .processors = processors,
        .set = lar_calloc((size_t)incidence->max, sizeof *x->set),
        .waiting = lar_calloc(pairs, sizeof *x->waiting),
        .pays = lar_calloc((size_t)processors, sizeof *x->pays),
    };
    if (x->set && x->waiting && x->pays) return LAR_OK;
    lar_exchange_clear(x);
    return lar_fail_memory(error, pairs * sizeof *x->waiting, "exchanges between processors");
}

void lar_exchange_clear(lar_exchange *x) {
    free(x->set);
    free(x->waiting);
    free(x->pays);
    *x = (lar_exchange){0};
}

/* Adds (sign 1) or takes away (-1) what the nodes of e and g cost. */
static int64_t count_nodes(lar_exchange *x, const int32_t *processor, const int32_t *node,
                           int nodes, int sign) {
    int64_t total = 0;
    for (int i = 0; i < nodes; i++) {
        int32_t count = lar_node_processors(x->incidence, processor, node[i], x->set);
        int64_t cost = sign * lar_cost_of_node(count);
        for (int32_t j = 0; j < count; j++) x->pays[x->set[j]] += cost;
        total += count * cost;
    }
    return total;
}

static void weigh(const lar_exchange *x, lar_cost *cost) {
    cost->worst = 0;
    cost->power = 0;
    for (int32_t p = 0; p < x->processors; p++) {
        double square = (double)x->pays[p] * (double)x->pays[p];
        cost->power += square * square;
        if (x->pays[p] > cost->worst) cost->worst = x->pays[p];
    }
}

static void swap_processors(int32_t *processor, int32_t e, int32_t g) {
    int32_t p = processor[e];
    processor[e] = processor[g];
    processor[g] = p;
}

static int nodes_of_both(const lar_mesh *mesh, int32_t e, int32_t g, int32_t node[16]) {
    int count = 8;
    for (int a = 0; a < 8; a++) node[a] = mesh->element[e][a];
    for (int a = 0; a < 8; a++) {
        bool shared = false;
        for (int b = 0; b < 8; b++) shared |= node[b] == mesh->element[g][a];
        if (!shared) node[count++] = mesh->element[g][a];
    }
    return count;
}

static bool try_exchange(lar_exchange *x, int32_t *processor, int32_t e, int32_t g, double limit,
                         lar_cost *cost) {
    int32_t node[16];
    int nodes = nodes_of_both(x->mesh, e, g, node);
    lar_cost after = {.total = cost->total + count_nodes(x, processor, node, nodes, -1)};
    swap_processors(processor, e, g);
    after.total += count_nodes(x, processor, node, nodes, 1);
    weigh(x, &after);
    if (after.power <= cost->power * limit) {
        *cost = after;
        return true;
    }
    count_nodes(x, processor, node, nodes, -1);
    swap_processors(processor, e, g);
    count_nodes(x, processor, node, nodes, 1);
    return false;
}

void lar_exchange_run(lar_exchange *x, lar_random *random, int32_t trials, double slack,
                      int32_t *processor, double (*logical)[3], lar_cost *cost) {
    const lar_incidence *in = x->incidence;
    size_t pairs = (size_t)x->processors * (size_t)x->processors;
    for (size_t i = 0; i < pairs; i++) x->waiting[i] = -1;
    *cost = lar_cost_measure(in, processor, x->processors, x->set, x->pays);
    for (int32_t trial = 0; trial < trials; trial++) {
        int32_t e = lar_random_below(random, in->element_count);
        int32_t k = x->mesh->element[e][lar_random_below(random, 8)];
        int32_t meet = (int32_t)(in->first[k + 1] - in->first[k]);
        int32_t f = in->element[in->first[k] + lar_random_below(random, meet)];
        int32_t p = processor[e], q = processor[f];
        if (p == q) continue;
        /* An element of q seen beside p: would the two rather be where the other is? */
        int32_t *mine = &x->waiting[(size_t)p * (size_t)x->processors + (size_t)q];
        int32_t *other = &x->waiting[(size_t)q * (size_t)x->processors + (size_t)p];
        int32_t g = *other;
        if (g < 0 || processor[g] != q) {
            *mine = e;
            continue;
        }
        *other = -1;
        double chance = lar_random_unit(random);
        double limit = 1 + slack * chance * chance * chance;
        if (!try_exchange(x, processor, e, g, limit, cost)) continue;
        for (int i = 0; i < 3; i++) {
            double swap = logical[e][i];
            logical[e][i] = logical[g][i];
            logical[g][i] = swap;
        }
    }
}
