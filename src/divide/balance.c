#include "divide/balance.h"

#include <stdlib.h>
#include <string.h>

typedef struct balancer {
    const lar_mesh *mesh;
    const lar_incidence *incidence;
    int32_t processors;
    int32_t *processor;
    int32_t *load;  /* [processors] elements */
    int32_t *from;  /* [processors] where the way came from; itself at its start, -1 unreached */
    int32_t *queue; /* [processors] */
    bool *touch;    /* [processors][processors] */
    int32_t *set;   /* [incidence->max] */
} balancer;

static int64_t cost_of_element_nodes(balancer *b, int32_t e) {
    int64_t cost = 0;
    for (int a = 0; a < 8; a++) {
        int32_t count =
            lar_node_processors(b->incidence, b->processor, b->mesh->element[e][a], b->set);
        cost += count * lar_cost_of_node(count);
    }
    return cost;
}

static bool touches(balancer *b, int32_t e, int32_t q) {
    for (int a = 0; a < 8; a++) {
        int32_t k = b->mesh->element[e][a];
        for (int64_t i = b->incidence->first[k]; i < b->incidence->first[k + 1]; i++)
            if (b->processor[b->incidence->element[i]] == q) return true;
    }
    return false;
}

/* Moves the cheapest element of p to q; where none touches q, any. */
static void move_one(balancer *b, int32_t p, int32_t q) {
    int32_t best = -1;
    int64_t best_rise = 0;
    bool best_touches = false;
    for (int32_t e = 0; e < b->mesh->element_count; e++) {
        if (b->processor[e] != p) continue;
        bool near = touches(b, e, q);
        if (best >= 0 && best_touches && !near) continue;
        int64_t before = cost_of_element_nodes(b, e);
        b->processor[e] = q;
        int64_t rise = cost_of_element_nodes(b, e) - before;
        b->processor[e] = p;
        if (best >= 0 && near == best_touches && rise >= best_rise) continue;
        best = e;
        best_rise = rise;
        best_touches = near;
    }
    if (best < 0) return;
    b->processor[best] = q;
    b->load[p]--;
    b->load[q]++;
}

static void find_touching(balancer *b) {
    size_t n = (size_t)b->processors;
    memset(b->touch, 0, n * n * sizeof *b->touch);
    for (int32_t k = 0; k < b->incidence->node_count; k++) {
        int32_t count = lar_node_processors(b->incidence, b->processor, k, b->set);
        for (int32_t i = 0; i < count; i++)
            for (int32_t j = 0; j < count; j++)
                b->touch[(size_t)b->set[i] * n + (size_t)b->set[j]] = true;
    }
}

/* The shortest way of touching processors from p, into from[]. */
static void find_ways(balancer *b, int32_t p) {
    int32_t read = 0, written = 0;
    memset(b->from, 0xff, (size_t)b->processors * sizeof *b->from);
    b->from[p] = p;
    b->queue[written++] = p;
    while (read < written) {
        int32_t r = b->queue[read++];
        for (int32_t q = 0; q < b->processors; q++)
            if (b->from[q] < 0 && b->touch[(size_t)r * (size_t)b->processors + (size_t)q]) {
                b->from[q] = r;
                b->queue[written++] = q;
            }
    }
}

/* Every round takes one element from the fullest processor and gives one to the emptiest, so the
 * number of rounds is bounded by the number of elements. */
static void balance(balancer *b) {
    for (;;) {
        int32_t max = 0, min = 0;
        for (int32_t p = 1; p < b->processors; p++) {
            if (b->load[p] > b->load[max]) max = p;
            if (b->load[p] < b->load[min]) min = p;
        }
        if (b->load[max] - b->load[min] <= 1) return;
        find_touching(b);
        find_ways(b, max);
        if (b->from[min] < 0) b->from[min] = max;
        for (int32_t q = min; q != max; q = b->from[q]) move_one(b, b->from[q], q);
    }
}

lar_status lar_balance(const lar_mesh *mesh, const lar_incidence *incidence, int32_t processors,
                       int32_t *processor, lar_error *error) {
    size_t n = (size_t)processors;
    balancer b = {.mesh = mesh,
                  .incidence = incidence,
                  .processors = processors,
                  .processor = processor,
                  .load = lar_calloc(n, sizeof *b.load),
                  .from = lar_calloc(n, sizeof *b.from),
                  .queue = lar_calloc(n, sizeof *b.queue),
                  .touch = lar_calloc(n * n, sizeof *b.touch),
                  .set = lar_calloc((size_t)incidence->max, sizeof *b.set)};
    lar_status status = LAR_OK;
    if (b.load && b.from && b.queue && b.touch && b.set) {
        for (int32_t e = 0; e < mesh->element_count; e++) b.load[processor[e]]++;
        balance(&b);
    } else {
        status = lar_fail_memory(error, n * n, "balancing a distribution");
    }
    free(b.load);
    free(b.from);
    free(b.queue);
    free(b.touch);
    free(b.set);
    return status;
}
