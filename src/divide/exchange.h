/* Exchanging two elements between two processors, and what that does to the cost.
 *
 *       p | q            e leaves p for q, g leaves q for p: both keep their number of
 *     . e | f .          elements (eq. 6.7), and of the cost (eq. 6.8) only the terms of
 *     . . | g .          the at most 16 nodes of e and g change.
 *
 * In the representation of T 6.8.3 an exchange is a mutation: the two elements exchange their
 * logical positions, and algorithm 3, which sees only the set of positions, finds the same cuts.
 * That makes it cheap: some 1 us instead of the 100 us of cutting and counting anew.
 */
#ifndef LAR_DIVIDE_EXCHANGE_H
#define LAR_DIVIDE_EXCHANGE_H

#include "divide/cost.h"
#include "divide/random.h"

typedef struct lar_exchange {
    const lar_mesh *mesh;
    const lar_incidence *incidence;
    int32_t processors;
    int32_t *set;     /* [incidence->max] scratch */
    int32_t *waiting; /* [processors][processors]: an element of p seen beside q, -1 */
    int64_t *pays;    /* [processors] what each pays now */
} lar_exchange;

/* Fails only without memory. Mesh and incidence must outlive it; cleared with
 * lar_exchange_clear, also after a failure. */
lar_status lar_exchange_create(const lar_mesh *mesh, const lar_incidence *incidence,
                               int32_t processors, lar_exchange *x, lar_error *error);
void lar_exchange_clear(lar_exchange *x);

/* Looks at `trials` random pairs of touching elements, exchanges those that do not raise the power
 * of the cost, and swaps their logical positions with them. `slack` is the share by which it may
 * rise nevertheless, at most and seldom: that leads out of dead ends. processor[] and logical[] are
 * one individual; *cost is set to its cost. */
void lar_exchange_run(lar_exchange *x, lar_random *random, int32_t trials, double slack,
                      int32_t *processor, double (*logical)[3], lar_cost *cost);

#endif
