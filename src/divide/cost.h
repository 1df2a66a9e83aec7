/* What a distribution costs in communication (T 6.8.1).
 *
 * A processor pays for each of its nodes that others have too (eq. 6.8):
 *
 *     processors that have the node    1   2   3   4   5 ...
 *     cost                             0   4   7   8   9 ...   4 + n for n > 2
 *
 * Processors exchange at the same time, so the one that pays most decides: `worst` is the fitness,
 * and of two distributions with the same worst the one with the smaller sum is better. A search
 * that sees only the worst walks over plateaus: nothing tells it that the second worst got better.
 * `power` tells it: the sum of fourth powers follows the worst, but every processor has a say.
 */
#ifndef LAR_DIVIDE_COST_H
#define LAR_DIVIDE_COST_H

#include <stdbool.h>

#include "divide/incidence.h"

typedef struct lar_cost {
    int64_t worst; /* of one processor: the fitness of eq. 6.8, lower is better */
    int64_t total; /* of all processors */
    double power;  /* sum of the fourth powers of what each pays */
} lar_cost;

/* Cost to each processor of a node that `count` processors have: f of eq. 6.8. */
static inline int64_t lar_cost_of_node(int32_t count) {
    return count < 2 ? 0 : count == 2 ? 4 : 4 + count;
}

static inline bool lar_cost_less(lar_cost a, lar_cost b) {
    return a.worst != b.worst ? a.worst < b.worst : a.total < b.total;
}

/* The processors that have node k, P_k, ascending, into set[] (room for incidence->max). Returns
 * how many. processor[e] is the distribution. */
int32_t lar_node_processors(const lar_incidence *incidence, const int32_t *processor, int32_t k,
                            int32_t *set);

/* Cost of a distribution. set[incidence->max] and pays[processors] are scratch; pays[] is then
 * what each processor pays. */
lar_cost lar_cost_measure(const lar_incidence *incidence, const int32_t *processor,
                          int32_t processors, int32_t *set, int64_t *pays);

#endif
