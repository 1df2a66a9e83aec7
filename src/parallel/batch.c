/* The step of one thread over its batches (T 6.6.1, fig. 6.15): recover, wait, receive, positions,
 * send. See divide/schedule/schedule.h for what makes this order safe. */
#include <sched.h>
#include <string.h>
#include <time.h>

#include "contact/tool_friction.h"
#include "parallel/contact_exchange.h"

/* ---- force sums, or lists of elements ------------------------------------------------------ */

/* Sums of a worker, axis by axis (mechanics/axes.h). */
typedef struct sums {
    int64_t *value;
    size_t stride;
    uint64_t *pressed; /* of what tools press: the nodes where there is any (tool_friction.h) */
} sums;

/* Forces, and with friction of tools what these press (contact/tool_friction.h). They travel in the
 * same packets, one layer behind the other. */
static inline sums sums_of(const lar_worker *worker, int32_t layer) {
    const lar_tool_contact *contact = &worker->interactions.tool_contact;
    return layer == 0
               ? (sums){worker->state.force, worker->state.stride, NULL}
               : (sums){contact->press, (size_t)contact->faces->local_count, contact->pressed};
}

static inline void take_vector(sums of, int32_t node, int64_t *vector) {
    for (int i = 0; i < 3; i++) vector[i] = of.value[(size_t)node + (size_t)i * of.stride];
}
static inline void put_vector(sums of, int32_t node, const int64_t *vector) {
    if (of.pressed && (vector[0] | vector[1] | vector[2]) != 0)
        lar_tool_friction_mark(of.pressed, node);
    for (int i = 0; i < 3; i++) of.value[(size_t)node + (size_t)i * of.stride] = vector[i];
}
static inline void clear_vector(sums of, int32_t node) {
    put_vector(of, node, (const int64_t[3]){0});
}

static inline void add_vector(const lar_processor *p, int64_t *sum, const int64_t *part) {
    if (p->check) {
        lar_list_join(sum, part);
        return;
    }
    /* Unsigned: a run that is about to be stopped may wrap around. */
    for (int i = 0; i < 3; i++) sum[i] = (int64_t)((uint64_t)sum[i] + (uint64_t)part[i]);
}

static inline void add_to_sum(const lar_processor *p, sums to, int32_t node, const int64_t *part) {
    int64_t sum[3];
    take_vector(to, node, sum);
    add_vector(p, sum, part);
    put_vector(to, node, sum);
}

/* What all threads of the processor together have at some nodes, one vector after the other. */
static void collect(const lar_processor *p, int32_t layer, const int32_t *node, int32_t count,
                    int64_t *restrict vector) {
    sums of = sums_of(&p->worker[0], layer);
    for (int32_t i = 0; i < count; i++) take_vector(of, node[i], vector + 3 * i);
    for (int32_t t = 1; t < p->thread_count; t++) {
        of = sums_of(&p->worker[t], layer);
        for (int32_t i = 0; i < count; i++) {
            int64_t part[3];
            take_vector(of, node[i], part);
            add_vector(p, vector + 3 * i, part);
        }
    }
}

/* Adds vectors, one after the other, at some nodes. */
static void spread(const lar_processor *p, const int32_t *node, int32_t count,
                   const int64_t *restrict vector, sums to) {
    for (int32_t i = 0; i < count; i++) add_to_sum(p, to, node[i], vector + 3 * i);
}

/* Packs what this thread has for the nodes of others that wait for batch b. The sums themselves
 * stay: who sends such a node reads them until the end of the step. */
static void pack_reduction(const lar_worker *worker, int32_t b) {
    const lar_processor *p = worker->processor;
    for (int32_t to = 0; to < p->thread_count; to++) {
        const lar_reduction_buffer *reduction = &worker->reduction[to];
        if (reduction->batch != b) continue;
        for (int32_t layer = 0; layer < p->layers; layer++) {
            const sums own = sums_of(worker, layer);
            int64_t *vector = reduction->vector + 3 * (size_t)layer * (size_t)reduction->count;
            for (int32_t i = 0; i < reduction->count; i++)
                take_vector(own, reduction->node[i], vector + 3 * i);
        }
    }
}

/* At the end of the step, when nobody reads them any more. */
static void clear_reduction(const lar_worker *worker) {
    const lar_processor *p = worker->processor;
    for (int32_t to = 0; to < p->thread_count; to++) {
        const lar_reduction_buffer *reduction = &worker->reduction[to];
        for (int32_t layer = 0; layer < p->layers; layer++) {
            const sums own = sums_of(worker, layer);
            for (int32_t i = 0; i < reduction->count; i++) clear_vector(own, reduction->node[i]);
        }
    }
}

/* Takes the sums of the other threads over into the one that moves the nodes. */
static void join_layer(lar_worker *worker, int32_t layer) {
    const lar_processor *p = worker->processor;
    const sums own = sums_of(worker, layer);
    for (int32_t t = 0; t < p->thread_count; t++) {
        if (t == worker->thread) continue;
        const lar_reduction_buffer *reduction = &p->worker[t].reduction[worker->thread];
        spread(p, reduction->node, reduction->count,
               reduction->vector + 3 * (size_t)layer * (size_t)reduction->count, own);
        const sums other = sums_of(&p->worker[t], layer);
        for (int32_t i = 0; i < worker->shared_count; i++) {
            int64_t part[3];
            take_vector(other, worker->shared_node[i], part);
            add_to_sum(p, own, worker->shared_node[i], part);
            clear_vector(other, worker->shared_node[i]);
        }
    }
}

static void join_sums(lar_worker *worker) {
    for (int32_t layer = 0; layer < worker->processor->layers; layer++) join_layer(worker, layer);
}

/* ---- packets ------------------------------------------------------------------------------- */

/* Returns where the next layer is. */
static const int64_t *receive_layer(lar_worker *worker, int32_t layer,
                                    const lar_packet_plan *packet, const int64_t *vector) {
    lar_processor *p = worker->processor;
    const int32_t *node = p->node + packet->first;
    const sums own = sums_of(worker, layer);
    spread(p, node, packet->added, vector, own);
    for (int32_t i = packet->added; i < packet->added + packet->whole; i++) {
        for (int32_t t = 0; t < p->thread_count; t++)
            clear_vector(sums_of(&p->worker[t], layer), node[i]);
        put_vector(own, node[i], vector + 3 * i);
    }
    return vector + 3 * (packet->added + packet->whole);
}

static lar_status receive(lar_worker *worker, const lar_packet_plan *packet, uint64_t round,
                          lar_error *error) {
    lar_processor *p = worker->processor;
    const void *payload;
    lar_status status =
        lar_comm_wait(p->comm, packet->peer, packet->offset, packet->bytes, round, &payload, error);
    if (status) return status;
    uint64_t stop;
    memcpy(&stop, payload, sizeof stop);
    if (stop) lar_processor_ask_stop(p, stop);
    const int64_t *vector =
        (const int64_t *)(const void *)((const char *)payload + LAR_SIGNAL_BYTES);
    for (int32_t layer = 0; layer < p->layers; layer++)
        vector = receive_layer(worker, layer, packet, vector);
    return LAR_OK;
}

static lar_status send(lar_worker *worker, const lar_packet_plan *packet, uint64_t round,
                       lar_error *error) {
    const lar_processor *p = worker->processor;
    unsigned char *bytes =
        lar_comm_room(p->comm, packet->peer, packet->offset, packet->bytes, round);
    if (!bytes) bytes = worker->gather;
    uint64_t stop = __atomic_load_n(&p->stop, __ATOMIC_RELAXED);
    memcpy(bytes, &stop, sizeof stop);
    int64_t *vector = (int64_t *)(void *)(bytes + LAR_SIGNAL_BYTES);
    const int32_t count = packet->added + packet->whole;
    for (int32_t layer = 0; layer < p->layers; layer++)
        collect(p, layer, p->node + packet->first, count, vector + 3 * layer * count);
    return lar_comm_put(p->comm, packet->peer, packet->offset, bytes, packet->bytes, round, error);
}

/* ---- the step ------------------------------------------------------------------------------ */

/* Random delays, to see that nothing depends on who is first (T 6.9): mostly none, sometimes a few
 * microseconds, now and then long enough for others to run ahead as far as they can. */
static void delay_at_random(lar_worker *worker) {
    if (!worker->random) return;
    worker->random ^= worker->random << 13;
    worker->random ^= worker->random >> 7;
    worker->random ^= worker->random << 17;
    uint64_t dice = worker->random >> 40;
    if (dice % 8 == 0) sched_yield();
    if (dice % 128 != 1) return;
    struct timespec nap = {0, (long)(dice / 128 % 60000)};
    nanosleep(&nap, NULL);
}

/* The displacements that other threads have computed are in their cores' caches. */
static void fetch_foreign(const lar_worker *worker) {
    for (int32_t i = 0; i < worker->foreign_count; i++)
        for (int k = 0; k < 3; k++)
            __builtin_prefetch(
                &worker->state.u[lar_state_at(&worker->state, worker->foreign[i], k)]);
}

/* How far the memory of a batch's packets has been asked for. */
typedef struct prefetch_cursor {
    lar_range packets;
    size_t at; /* in the first of them */
} prefetch_cursor;

/* Asks for at most so many bytes of the packets that will be sent, or have come. */
static void prefetch_packets(const lar_processor *p, prefetch_cursor *cursor, bool sends,
                             size_t bytes, uint64_t round) {
    while (cursor->packets.count > 0 && bytes > 0) {
        const lar_packet_plan *packet = &p->packet[cursor->packets.first];
        size_t left = lar_comm_packet_bytes(packet->bytes) - cursor->at;
        size_t part = left < bytes ? left : bytes;
        if (sends)
            lar_comm_prepare(p->comm, packet->peer, packet->offset + cursor->at, part, round);
        else if (lar_comm_expect(p->comm, packet->offset, packet->bytes, round))
            lar_comm_fetch(p->comm, packet->offset + cursor->at, part, round);
        else
            return;
        bytes -= part;
        cursor->at += part;
        if (part < left) return;
        cursor->packets.first++;
        cursor->packets.count--;
        cursor->at = 0;
    }
}

/* Between the runs of elements the memory of the batch's packets is prefetched, a little each time:
 * a core can wait for a few dozen lines at once, and does not compute while it asks for more. */
static void recover(lar_worker *worker, const lar_batch_plan *batch, uint64_t round) {
    enum { PORTION = 4096 };
    lar_processor *p = worker->processor;
    if (p->check) {
        lar_verification_recover(p->check, &p->domain, batch->run_first, batch->run_count,
                                 &worker->state);
        return;
    }
    prefetch_cursor sends = {batch->sends, 0}, receives = {batch->receives, 0};
    for (int32_t r = 0; r < batch->run_count; r++) {
        if (r > 0 || batch->run_count == 1) {
            prefetch_packets(p, &sends, true, PORTION, round);
            prefetch_packets(p, &receives, false, PORTION, round);
        }
        lar_step_recover(&p->domain, batch->run_first + r, 1, &worker->state, &worker->fault);
    }
}

static lar_status move(lar_worker *worker, lar_error *error) {
    lar_processor *p = worker->processor;
    join_sums(worker);
    if (p->check)
        return lar_verification_compare(p->check, &p->domain, p->self, worker->context.first,
                                        worker->context.end, &worker->state, error);
    lar_step_move(&p->domain, &worker->interactions, &worker->context, &worker->state,
                  &worker->fault);
    return LAR_OK;
}

static lar_status run_batch(lar_worker *worker, int32_t b, uint64_t round, lar_error *error) {
    lar_processor *p = worker->processor;
    const lar_batch_plan *batch = &p->batch[b];
    lar_status status = LAR_OK;
    delay_at_random(worker);
    recover(worker, batch, round);
    /* Before anybody can wait for this thread's sums, like loads; behind the first elements, while
     * whose recovery the places of others come. */
    if (p->exchange && b == worker->batch_first) status = lar_contact_apply(worker, round, error);
    for (int32_t i = 0; i < batch->waits.count && !status; i++)
        status = lar_processor_await(p, &p->sequence[p->wait[batch->waits.first + i]].round, round,
                                     error);
    delay_at_random(worker);
    for (int32_t i = 0; i < batch->receives.count && !status; i++)
        status = receive(worker, &p->packet[batch->receives.first + i], round, error);
    if (batch->moves && !status) status = move(worker, error);
    if (batch->sends.count) delay_at_random(worker);
    for (int32_t i = 0; i < batch->sends.count && !status; i++)
        status = send(worker, &p->packet[batch->sends.first + i], round, error);
    pack_reduction(worker, b);
    if (!status) __atomic_store_n(&p->sequence[b].round, round, __ATOMIC_RELEASE);
    return status;
}

lar_status lar_worker_step(lar_worker *worker, lar_error *error) {
    lar_processor *p = worker->processor;
    uint64_t round = worker->round + 1; /* comm and flags count from 1 */
    lar_status status = LAR_OK;
    lar_step_enter(&p->domain, &worker->interactions, &worker->context, &worker->state);
    fetch_foreign(worker);
    if (p->exchange) status = lar_contact_send(worker, round, error);
    if (!p->check && !status)
        lar_step_begin(&p->domain, &worker->interactions, &worker->context, &worker->state,
                       &worker->fault);
    for (int32_t b = worker->batch_first; b < worker->batch_end && !status; b++)
        status = run_batch(worker, b, round, error);
    if (p->exchange && worker->batch_first == worker->batch_end && !status)
        status = lar_contact_apply(worker, round, error);
    if (status) {
        worker->follows = __atomic_exchange_n(&p->failed, 1, __ATOMIC_ACQ_REL) != 0;
        if (!worker->follows && status != LAR_ERROR_PEER && p->comm) lar_comm_abort(p->comm);
        return status;
    }
    clear_reduction(worker);
    worker->round = round;
    if (p->exchange) lar_contact_publish(worker, round + 1);
    if (p->check)
        worker->state.step++;
    else
        lar_step_end(&p->domain, &worker->interactions, &worker->context, &worker->state,
                     &worker->fault);
    return LAR_OK;
}
