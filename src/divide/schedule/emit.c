/* From a plan to the schedule of its processor: batches without work fall away, the others stand
 * thread after thread; gates and empty packets come in. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "divide/schedule/plan.h"

typedef struct emission {
    const lar_plan *plan;
    lar_schedule *to;
    int32_t *number;   /* [plan batches] batch of the schedule, or LAR_NOWHERE */
    int32_t *rank;     /* [schedule's batches] batch of the plan; gates: above all */
    int32_t *receives; /* [plan batches] */
    int32_t *sends;    /* [plan batches] */
    int32_t start;     /* batch of the schedule that sends the empty packets */
} emission;

static lar_plan_packet *packets_of(const lar_plan *plan) {
    return plan->site->packets.packet;
}

static lar_range sent(const lar_plan *plan) {
    const int32_t *first = plan->site->packets.sent_first + plan->processor;
    return (lar_range){first[0], first[1] - first[0]};
}

static lar_range received(const lar_plan *plan) {
    const int32_t *first = plan->site->packets.received_first + plan->processor;
    return (lar_range){first[0], first[1] - first[0]};
}

static lar_plan_packet *received_packet(const lar_plan *plan, int32_t i) {
    return &packets_of(plan)[plan->site->packets.received[i]];
}

/* Returns whether empty packets leave. */
static bool count_transfers(emission *em) {
    const lar_plan *plan = em->plan;
    lar_range out = sent(plan), in = received(plan);
    bool empty = false;
    for (int32_t i = out.first; i < out.first + out.count; i++) {
        const lar_plan_packet *packet = &packets_of(plan)[i];
        if (packet->sent_in == LAR_AT_START)
            empty = true;
        else
            em->sends[packet->sent_in]++;
        em->to->vector_count += packet->count;
    }
    for (int32_t i = in.first; i < in.first + in.count; i++) {
        em->receives[received_packet(plan, i)->received_in]++;
        em->to->vector_count += received_packet(plan, i)->count;
    }
    em->to->transfer_count = out.count + in.count;
    return empty;
}

/* Numbers the batches. Empty packets leave with the first packets of thread 0; where it has
 * nothing to send of its own, a batch before all others sends them: they may not wait for what
 * others send. */
static void number_batches(emission *em, bool empty) {
    const lar_plan *plan = em->plan;
    lar_schedule *s = em->to;
    em->start = LAR_NOWHERE;
    for (int32_t b = 0; b < plan->batch_count; b++) em->number[b] = LAR_NOWHERE;
    for (int32_t t = 0; t < plan->threads; t++) {
        s->thread_first[t] = s->batch_count;
        for (int32_t b = 0; b < plan->batch_count; b++) {
            bool idle = plan->batch[b].elements + em->receives[b] + em->sends[b] == 0;
            if (plan->batch[b].thread != t || (idle && b != plan->last[t])) continue;
            if (empty && em->start == LAR_NOWHERE) {
                em->start = s->batch_count;
                if (em->sends[b] == 0 || em->receives[b] > 0) em->rank[s->batch_count++] = -1;
            }
            em->rank[s->batch_count] = b;
            em->number[b] = s->batch_count++;
        }
        if (plan->threads > 1) em->rank[s->batch_count++] = plan->batch_count;
    }
    s->thread_first[plan->threads] = s->batch_count;
}

/* ---- filling ---------------------------------------------------------------------------- */

static void close_spans(emission *em, size_t member) {
    int32_t first = 0;
    for (int32_t b = 0; b < em->to->batch_count; b++) {
        lar_range *span = (lar_range *)(void *)((char *)&em->to->batch[b] + member);
        span->first = first;
        first += span->count;
        span->count = 0;
    }
}

/* Twice over the same things: counted, then put. They come ascending, and so they stay. */
static void put_elements(emission *em) {
    const lar_plan *plan = em->plan;
    for (int put = 0; put < 2; put++) {
        for (int32_t i = 0; i < plan->element_count; i++) {
            int32_t e = plan->element[i];
            lar_range *span = &em->to->batch[em->number[plan->site->batch[e]]].elements;
            if (put) em->to->element[span->first + span->count] = e;
            span->count++;
        }
        if (!put) close_spans(em, offsetof(lar_batch, elements));
    }
}

static void put_positions(emission *em) {
    const lar_plan *plan = em->plan;
    for (int put = 0; put < 2; put++) {
        for (int32_t k = 0; k < plan->node_count; k++) {
            int32_t batch = em->number[plan->last[plan->owner[k]]];
            lar_range *span = &em->to->batch[batch].positions;
            if (put) em->to->node[span->first + span->count] = plan->node[k];
            span->count++;
        }
        if (!put) close_spans(em, offsetof(lar_batch, positions));
    }
}

static int32_t sending_batch(const emission *em, const lar_plan_packet *packet) {
    return packet->sent_in == LAR_AT_START ? em->start : em->number[packet->sent_in];
}

static void place_transfers(emission *em) {
    const lar_plan *plan = em->plan;
    lar_range out = sent(plan), in = received(plan);
    for (int32_t i = out.first; i < out.first + out.count; i++)
        em->to->batch[sending_batch(em, &packets_of(plan)[i])].sends.count++;
    for (int32_t i = in.first; i < in.first + in.count; i++)
        em->to->batch[em->number[received_packet(plan, i)->received_in]].receives.count++;
    int32_t first = 0;
    for (int32_t b = 0; b < em->to->batch_count; b++) {
        lar_batch *batch = &em->to->batch[b];
        batch->receives.first = first;
        batch->sends.first = first + batch->receives.count;
        first = batch->sends.first + batch->sends.count;
        batch->receives.count = batch->sends.count = 0;
    }
}

static void put_transfer(emission *em, const lar_plan_packet *packet, int32_t peer,
                         lar_range *span) {
    em->to->transfer[span->first + span->count++] =
        (lar_transfer){.peer = peer,
                       .stage = packet->stage,
                       .whole = packet->whole,
                       .vectors = {(int32_t)(packet - packets_of(em->plan)), packet->count},
                       .offset = packet->offset};
}

/* Vectors follow in the order of the transfers; until here a transfer holds its packet's number. */
static void put_vectors(emission *em) {
    int32_t first = 0;
    for (int32_t i = 0; i < em->to->transfer_count; i++) {
        lar_range *vectors = &em->to->transfer[i].vectors;
        const int32_t *node = em->plan->site->packets.node;
        node += packets_of(em->plan)[vectors->first].first;
        if (vectors->count > 0)
            memcpy(em->to->vector + first, node, (size_t)vectors->count * sizeof *node);
        vectors->first = first;
        first += vectors->count;
    }
}

static void put_transfers(emission *em) {
    const lar_plan *plan = em->plan;
    lar_range out = sent(plan), in = received(plan);
    place_transfers(em);
    for (int32_t i = out.first; i < out.first + out.count; i++) {
        const lar_plan_packet *packet = &packets_of(plan)[i];
        put_transfer(em, packet, packet->to, &em->to->batch[sending_batch(em, packet)].sends);
    }
    for (int32_t i = in.first; i < in.first + in.count; i++) {
        const lar_plan_packet *packet = received_packet(plan, i);
        lar_batch *batch = &em->to->batch[em->number[packet->received_in]];
        put_transfer(em, packet, packet->from, &batch->receives);
    }
    put_vectors(em);
}

/* ---- the schedule ----------------------------------------------------------------------- */

static bool make_room(emission *em) {
    lar_schedule *s = em->to;
    size_t max = (size_t)em->plan->batch_count + LAR_THREADS_MAX + 1;
    em->number = lar_calloc(max, sizeof *em->number);
    em->rank = lar_calloc(max, sizeof *em->rank);
    em->receives = lar_calloc(max, sizeof *em->receives);
    em->sends = lar_calloc(max, sizeof *em->sends);
    s->batch = lar_calloc(max, sizeof *s->batch);
    s->element = lar_calloc((size_t)s->element_count, sizeof *s->element);
    s->node = lar_calloc((size_t)s->node_count, sizeof *s->node);
    return em->number && em->rank && em->receives && em->sends && s->batch && s->element && s->node;
}

static lar_status fill_schedule(emission *em, lar_error *error) {
    lar_schedule *s = em->to;
    if (!make_room(em)) return lar_fail_memory(error, sizeof *s->batch, "a schedule");
    bool empty = count_transfers(em);
    s->transfer = lar_calloc((size_t)s->transfer_count, sizeof *s->transfer);
    s->vector = lar_calloc((size_t)s->vector_count, sizeof *s->vector);
    if (!s->transfer || !s->vector) return lar_fail_memory(error, sizeof *s->batch, "a schedule");
    number_batches(em, empty);
    put_elements(em);
    put_positions(em);
    put_transfers(em);
    return lar_schedule_find_waits(em->plan->site->mesh, em->plan->site->place, em->rank, s, error);
}

lar_status lar_plan_emit(const lar_plan *plan, lar_schedule *out, lar_error *error) {
    const lar_schedule_options *options = plan->site->options;
    lar_schedule schedule = {.grid = plan->site->distribution->grid,
                             .processor = plan->processor,
                             .threads = plan->threads,
                             .scheme = options->scheme,
                             .channels = options->channels,
                             .receive_bytes = plan->site->packets.room[plan->processor],
                             .element_count = plan->element_count,
                             .node_count = plan->node_count};
    emission em = {.plan = plan, .to = &schedule};
    lar_status status = fill_schedule(&em, error);
    free(em.number);
    free(em.rank);
    free(em.receives);
    free(em.sends);
    if (status == LAR_OK)
        *out = schedule;
    else
        lar_schedule_clear(&schedule);
    return status;
}
