/* How processor zero tells the processors of other processes what to do.
 *
 *     zero                                      the others
 *       order {advance until round 5000, tools} ->  compute
 *       <------------- answer {step 5000, fault, work; what the tools felt}
 *       order {gather, round 0} ---------------->  copy
 *       <------------- answer {values of some nodes}      ... until all are there
 *       order {scatter, part of a state} ------->  keep the part
 *       <------------- answer {}                          ... until all are there, then take it
 *       order {contact, pairs} ----------------->  take the list (contact_exchange.h)
 *       <------------- answer {}
 *       order {finish} ------------------------->  end
 *
 * Orders and answers are packets of comm in regions of their own, before those of the schedule in
 * every receive buffer, counted 1, 2, 3, ... instead of steps.
 *
 * Payloads have any length, but what polls a packet must know where its tail stands. So packets are
 * put against the END of their region, the head last:
 *
 *     region   | ........ free ........ | payload, padded to 8 | head | tail |
 *                                                              fixed places
 *
 * The tail of a region never moves, and is never covered by a payload; the head says how many bytes
 * before it belong to the packet. For a backend it is a packet of some size at some offset.
 * A payload that is longer than LAR_PART_BYTES goes in parts, each an order of its own.
 *
 * Buffering by parity holds as for steps (comm.h), because every order is answered, each part too:
 * order k + 2 is sent when all have answered k + 1, which they do when they are done with the
 * payload of k; answer k + 2 comes after order k + 2, which is sent when answer k has been used.
 */
#ifndef LAR_PARALLEL_CONTROL_H
#define LAR_PARALLEL_CONTROL_H

#include "comm/comm.h"
#include "step/step.h"

typedef enum lar_order_kind {
    LAR_ORDER_ADVANCE = 1,
    LAR_ORDER_GATHER,
    LAR_ORDER_HISTORY, /* gathers what viscous elements remember */
    LAR_ORDER_SCATTER,
    LAR_ORDER_CONTACT,
    LAR_ORDER_CONTINUE, /* an advance that was interrupted for that */
    LAR_ORDER_FINISH
} lar_order_kind;

typedef struct lar_order {
    uint64_t kind;     /* lar_order_kind */
    uint64_t argument; /* advance, continue: the round to stop before; gathering: which asking */
} lar_order;

/* Bytes of payload in one packet. */
enum { LAR_PART_BYTES = 32768 };

/* Values of so many nodes fit into one answer: the rows of the state's table. */
enum { LAR_ANSWER_NODES = LAR_PART_BYTES / (LAR_NODE_VALUES * (int)sizeof(double)) };

typedef struct lar_answer {
    uint64_t step;   /* steps done */
    lar_fault fault; /* the first of the processor */
    double external, damped, contact, exchanged;
    uint64_t bytes; /* of the payload */
} lar_answer;

typedef struct lar_control {
    lar_comm *comm;
    uint64_t count;        /* orders so far */
    unsigned char *packet; /* being put together */
    unsigned char *whole;  /* a payload of several parts; not zero's */
} lar_control;

/* Bytes that control needs at the beginning of a half of processor p's receive buffer. */
size_t lar_control_bytes(int32_t processors, int32_t p);

lar_status lar_control_create(lar_comm *comm, lar_control **control, lar_error *error);
void lar_control_destroy(lar_control *control); /* accepts NULL */

/* Processor zero: an order to all, with `bytes` of payload (NULL and 0: none); then the answer of
 * each, valid until the next order. *payload (may be NULL) has answer->bytes bytes. */
lar_status lar_control_order(lar_control *control, const lar_order *order, const void *payload,
                             size_t bytes, lar_error *error);
lar_status lar_control_hear(lar_control *control, int32_t p, const lar_answer **answer,
                            const void **payload, lar_error *error);

/* The others: wait for an order, however long. *payload, aligned to 8, has *bytes bytes and is
 * valid until the next order. Then answer, with at most LAR_PART_BYTES of payload;
 * answer->bytes is set here. */
lar_status lar_control_await(lar_control *control, lar_order *order, const void **payload,
                             size_t *bytes, lar_error *error);
lar_status lar_control_answer(lar_control *control, const lar_answer *answer, const void *payload,
                              size_t bytes, lar_error *error);

#endif
