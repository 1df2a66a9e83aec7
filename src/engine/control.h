/* How processor zero tells the processors of other processes what to do.
 *
 *     zero                                      the others
 *       order {advance until 5000} ------------->  compute
 *       <------------- answer {step 5000, trip, work}
 *       order {gather, round 0} ---------------->  copy
 *       <------------- answer {values of some nodes}      ... until all are there
 *       order {finish} ------------------------->  end
 *
 * Orders and answers are packets of comm in regions of their own, before those of the schedule in
 * every receive buffer, counted 1, 2, 3, ... instead of steps. Every order is answered, so
 * buffering by parity holds here too.
 */
#ifndef LAR_ENGINE_CONTROL_H
#define LAR_ENGINE_CONTROL_H

#include "comm/comm.h"
#include "engine/step.h"

typedef enum lar_order_kind {
    LAR_ORDER_ADVANCE = 1,
    LAR_ORDER_GATHER,
    LAR_ORDER_FINISH
} lar_order_kind;

typedef struct lar_order {
    uint64_t kind;     /* lar_order_kind */
    uint64_t argument; /* advance: the step to stop before; gather: the round, 0, 1, ... */
} lar_order;

/* Values of so many nodes fit into one answer: u and v, three numbers each. */
enum { LAR_ANSWER_NODES = 680 };

typedef struct lar_answer {
    uint64_t step; /* steps done */
    lar_trip trip; /* the first of the processor */
    double external, damped, contact;
    int64_t nodes; /* in `value` */
    double value[LAR_ANSWER_NODES][6];
} lar_answer;

typedef struct lar_control {
    lar_comm *comm;
    uint64_t count;     /* orders so far */
    lar_answer *answer; /* being put together; not zero's */
} lar_control;

/* Bytes that control needs at the beginning of a half of processor p's receive buffer. */
size_t lar_control_bytes(int32_t processors, int32_t p);

lar_status lar_control_create(lar_comm *comm, lar_control **control, lar_error *error);
void lar_control_destroy(lar_control *control); /* accepts NULL */

/* Processor zero: an order to all; then the answer of each, valid until the next order. */
lar_status lar_control_order(lar_control *control, const lar_order *order, lar_error *error);
lar_status lar_control_hear(lar_control *control, int32_t p, const lar_answer **answer,
                            lar_error *error);

/* The others: wait for an order, however long; then answer with control->answer. */
lar_status lar_control_obey(lar_control *control, lar_order *order, lar_error *error);
lar_status lar_control_answer(lar_control *control, lar_error *error);

#endif
