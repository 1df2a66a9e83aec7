/* Sums that go from thread to thread within a processor.
 *
 * Every thread has force sums of its own; the one that moves a node needs those of all. Reading and
 * clearing them where they are would drag two cache lines per node from core to core. So each
 * thread packs what it has for another's nodes into a reduction, at the end of the batch that the
 * other waits for, and clears its own sums itself when the step is over.
 *
 * Some nodes are summed where they are, by the thread that moves them, which also clears them
 * (`shared_node`): those for which a whole force may come, because it replaces the sums of all
 * threads, also what has been packed; and those for which a thread receives without having an
 * element there: it would clear them after the gate, and nobody who sends them in the next step
 * waits for it.
 */
#ifndef LAR_PARALLEL_THREAD_REDUCTION_H
#define LAR_PARALLEL_THREAD_REDUCTION_H

#include "parallel/processor.h"

/* Fills reduction, shared_node and foreign of all workers. thread[element of the model]: who
 * recovers it, -1: another processor. A schedule that moves nodes too early is refused. */
lar_status lar_thread_reduction_create(const lar_schedule *schedule, const int32_t *thread,
                                       lar_processor *processor, lar_error *error);
void lar_thread_reduction_destroy(lar_worker *worker); /* idempotent */

#endif
