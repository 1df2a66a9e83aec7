/* What can be proved from the schedules of all processors alone, before anything runs.
 *
 *   fit        every element is recovered by one processor, once; every processor moves each node
 *              of its elements once, and exchanges no others
 *   sums       played through symbolically, every node of every processor is moved with the forces
 *              of exactly its elements E_k, each once; what is sent holds what its stage says
 *   races      whatever happens to a node has the order of schedule.h, "for one node": within a
 *              thread as it stands there, between threads by waits; nobody begins the next step
 *              before all nodes have moved
 *   deadlock   no cycle over batches, threads, waits and messages (T 7.5.8)
 *   buffers    a packet that is sent is received, with the same nodes, once; its place in the
 *              receiver's buffer is its own; packets do not overlap and stay inside
 *   parity     every pair that exchanges does so in both directions in every step (T 6.4)
 *   balance    eq. 6.7 (a warning when the distribution was made by hand)
 *
 * and how far apart two processors can be (T 6.5.2): the longest of the shortest ways from exchange
 * to exchange.
 */
#ifndef LAR_DIVIDE_PROOF_SCHEDULE_PROOF_H
#define LAR_DIVIDE_PROOF_SCHEDULE_PROOF_H

#include "divide/schedule/schedule.h"

typedef struct lar_schedule_proof {
    int64_t batches, waits, packets, empty_packets, vectors; /* sent by all; `packets` have some */
    int64_t sums;                                            /* nodes of processors proved */
    bool balanced;                                           /* eq. 6.7 */
    int32_t spread; /* steps that two processors can be apart; -1: some never hear of each other */
} lar_schedule_proof;

/* LAR_OK when everything holds. Otherwise LAR_ERROR_MODEL with a sentence that names processor,
 * thread, batch and, where they are to blame, node, element or packet. For files, `error` names
 * no path: the caller knows it. */
lar_status lar_schedule_prove(const lar_mesh *mesh, const lar_incidence *incidence,
                              const lar_schedule_set *set, lar_schedule_proof *proof,
                              lar_error *error);

/* Steps that each pair of processors can be apart, [count * count]; -1: no way between them. Owned
 * by the caller; NULL without memory. */
int32_t *lar_schedule_distances(const lar_schedule_set *set);

#endif
