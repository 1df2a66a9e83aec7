/* The parts of schedule_proof.h, in this order; each may rely on what those before it have proved.
 *
 *     shape      spans, numbers and nodes are inside what they point into
 *     fit        every element once, every node once per processor      gives owner
 *     packets    sends and receives in pairs, places, both directions   gives packet
 *     order      no cycle: the batches in an order that is possible     gives order
 *     races      for every node the order of time is that of schedule.h
 *     sums       each node moves with all its elements
 *
 * Because of `races`, a processor that sends a node in stage s sends the forces of all its elements
 * and of the packets of the stages before, no more and no less, whatever the threads do. So `sums`
 * need not play batches: it plays stages, node by node, and needs no memory for whole processors.
 */
#ifndef LAR_DIVIDE_PROOF_PROOF_H
#define LAR_DIVIDE_PROOF_PROOF_H

#include "divide/proof/schedule_proof.h"

/* A packet with both its ends. */
typedef struct lar_proof_packet {
    int32_t from, to, stage;
    int32_t send, receive;             /* transfer of the sender's, of the receiver's schedule */
    int32_t send_batch, receive_batch; /* the same for batches */
} lar_proof_packet;

typedef struct lar_proof {
    const lar_mesh *mesh;
    const lar_incidence *incidence;
    const lar_schedule_set *set;
    int32_t *owner; /* [elements] the processor that recovers it */
    int32_t packet_count;
    lar_proof_packet *packet; /* [packet_count] ascending by from, to, stage */
    int32_t batch_count;
    int32_t *first; /* [set->count + 1] a processor's batches among those of all */
    int32_t *order; /* [batch_count] of all, each after everything that it needs */
} lar_proof;

lar_status lar_proof_shape(lar_proof *proof, lar_error *error);
lar_status lar_proof_fit(lar_proof *proof, lar_error *error);
lar_status lar_proof_packets(lar_proof *proof, lar_error *error);
lar_status lar_proof_order(lar_proof *proof, lar_error *error);
lar_status lar_proof_races(lar_proof *proof, lar_error *error);
lar_status lar_proof_sums(lar_proof *proof, int64_t *sums, lar_error *error);

#define LAR_DISPROVE(error, ...) lar_fail((error), LAR_ERROR_MODEL, __VA_ARGS__)

/* "processor 3, thread 1, batch 7". */
enum { LAR_PLACE_TEXT = 64 };
const char *lar_proof_place(const lar_schedule *s, int32_t batch, char text[LAR_PLACE_TEXT]);

#endif
