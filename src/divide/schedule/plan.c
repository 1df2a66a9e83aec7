/* The batches of one processor: units, relays, the gaps between, and the last ones. */
#include "divide/schedule/plan.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

int32_t lar_plan_add_batch(lar_plan *plan, int32_t thread) {
    if (!LAR_GROW(plan->batch, plan->batch_capacity, plan->batch_count)) return LAR_NOWHERE;
    plan->batch[plan->batch_count] = (lar_plan_batch){.thread = thread};
    return plan->batch_count++;
}

static const int32_t *nodes_of(const lar_plan *plan, const lar_plan_packet *packet) {
    return plan->site->packets.node + packet->first;
}

int32_t lar_plan_claim(lar_plan *plan, const lar_plan_packet *packet, int32_t batch,
                       int32_t *list) {
    const lar_incidence *at = plan->site->incidence;
    const int32_t *node = nodes_of(plan, packet);
    int32_t count = 0;
    for (int32_t i = 0; i < packet->count; i++)
        for (int64_t j = at->first[node[i]]; j < at->first[node[i] + 1]; j++) {
            int32_t e = at->element[j];
            if (plan->site->distribution->processor[e] != plan->processor ||
                plan->site->batch[e] != LAR_NOWHERE)
                continue;
            plan->site->batch[e] = batch;
            if (list) list[count] = e;
            count++;
        }
    return count;
}

/* ---- which packets need others ---------------------------------------------------------- */

static void find_arrivals(lar_plan *plan) {
    const lar_packets *all = &plan->site->packets;
    for (int32_t k = 0; k < plan->node_count; k++) plan->arrival[k] = LAR_STAGES;
    for (int32_t i = all->received_first[plan->processor];
         i < all->received_first[plan->processor + 1]; i++) {
        const lar_plan_packet *packet = &all->packet[all->received[i]];
        const int32_t *node = nodes_of(plan, packet);
        for (int32_t j = 0; j < packet->count; j++) {
            int32_t *arrival = &plan->arrival[plan->site->place[node[j]]];
            if (packet->stage < *arrival) *arrival = packet->stage;
        }
    }
}

static bool needs_others(const lar_plan *plan, const lar_plan_packet *packet) {
    const int32_t *node = nodes_of(plan, packet);
    for (int32_t j = 0; j < packet->count; j++)
        if (plan->arrival[plan->site->place[node[j]]] < packet->stage) return true;
    return false;
}

/* ---- relays ----------------------------------------------------------------------------- */

/* Receives in `batch` what came before `stage` and has one of the marked nodes. */
static bool receive_marked(lar_plan *plan, int32_t stage, int32_t batch) {
    const lar_packets *all = &plan->site->packets;
    bool any = false;
    for (int32_t i = all->received_first[plan->processor];
         i < all->received_first[plan->processor + 1]; i++) {
        lar_plan_packet *packet = &all->packet[all->received[i]];
        if (packet->stage >= stage || packet->received_in != LAR_NOWHERE) continue;
        const int32_t *node = nodes_of(plan, packet);
        for (int32_t j = 0; j < packet->count && packet->received_in == LAR_NOWHERE; j++)
            if (plan->mark[plan->site->place[node[j]]]) packet->received_in = batch;
        any |= packet->received_in == batch;
    }
    return any;
}

static void mark_nodes(lar_plan *plan, const lar_plan_packet *packet, int32_t mark) {
    const int32_t *node = nodes_of(plan, packet);
    for (int32_t j = 0; j < packet->count; j++) plan->mark[plan->site->place[node[j]]] = mark;
}

/* A new gap with a batch for each thread, the one that receives (if only one does) at the end: it
 * waits for the others. */
static lar_plan_gap *add_gap(lar_plan *plan, int32_t receiver, lar_error *error) {
    assert(plan->gap_count < LAR_GAPS_MAX);
    lar_plan_gap *gap = &plan->gap[plan->gap_count];
    *gap = (lar_plan_gap){.relay = LAR_NOWHERE, .first = plan->pooled, .before = plan->since};
    for (int32_t i = 1; i <= plan->threads; i++) {
        int32_t thread = (receiver + i) % plan->threads;
        gap->batch[thread] = lar_plan_add_batch(plan, thread);
        if (gap->batch[thread] == LAR_NOWHERE) {
            lar_fail_memory(error, sizeof *plan->batch, "batches");
            return NULL;
        }
    }
    plan->gap_count++;
    plan->first_unit = plan->batch_count;
    memset(plan->clock, 0, sizeof plan->clock);
    return gap;
}

/* Elements at the nodes of packets, to be recovered in the newest gap. */
static void need(lar_plan *plan, lar_plan_packet **packet, int32_t count) {
    lar_plan_gap *gap = &plan->gap[plan->gap_count - 1];
    for (int32_t i = 0; i < count; i++)
        plan->pooled += lar_plan_claim(plan, packet[i], LAR_POOLED, plan->pool + plan->pooled);
    gap->needed = plan->pooled - gap->first;
}

/* A batch that sends `count` packets of a stage on, and the gap before it. */
static lar_status add_relay(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                            lar_error *error) {
    int32_t receiver = plan->gap_count % plan->threads;
    lar_plan_gap *gap = add_gap(plan, receiver, error);
    if (!gap) return LAR_ERROR_MEMORY;
    need(plan, packet, count);
    gap->relay = gap->batch[receiver];
    for (int32_t i = 0; i < count; i++) {
        packet[i]->sent_in = gap->relay;
        mark_nodes(plan, packet[i], 1);
    }
    gap->receives = receive_marked(plan, packet[0]->stage, gap->relay);
    for (int32_t i = 0; i < count; i++) mark_nodes(plan, packet[i], 0);
    plan->since = 0;
    return LAR_OK;
}

lar_status lar_plan_split(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                          lar_error *error) {
    const lar_plan_gap *gap = add_gap(plan, plan->threads - 1, error);
    if (!gap) return LAR_ERROR_MEMORY;
    need(plan, packet, count);
    plan->since += gap->needed;
    for (int32_t t = 0; t < plan->threads && t < count; t++) {
        int32_t batch = lar_plan_add_batch(plan, t);
        if (batch == LAR_NOWHERE) return lar_fail_memory(error, sizeof *plan->batch, "batches");
        for (int32_t i = t; i < count; i += plan->threads) packet[i]->sent_in = batch;
    }
    plan->first_unit = plan->batch_count;
    return LAR_OK;
}

/* ---- stage after stage ------------------------------------------------------------------ */

/* Far travellers first; of those, the ones with a long way now; x+ before x-, as in T 6.6.2.1. */
static int compare_units(const void *a, const void *b) {
    const lar_plan_packet *x = *(lar_plan_packet *const *)a, *y = *(lar_plan_packet *const *)b;
    if (x->onward != y->onward) return x->onward > y->onward ? -1 : 1;
    if (x->distance != y->distance) return x->distance > y->distance ? -1 : 1;
    return x->to > y->to ? -1 : x->to < y->to;
}

/* How far apart the numbers are: less along x than along y, along y than along z. */
static int32_t step_of(const lar_plan_packet *packet) {
    return abs(packet->to - packet->from);
}

/* x before y before z: what comes over x is sent first, so it is there first. */
static int compare_relays(const void *a, const void *b) {
    const lar_plan_packet *x = *(lar_plan_packet *const *)a, *y = *(lar_plan_packet *const *)b;
    if (step_of(x) != step_of(y)) return step_of(x) < step_of(y) ? -1 : 1;
    return x->to > y->to ? -1 : x->to < y->to;
}

/* Units of equal urgency are one group (eq. 6.6). */
static lar_status add_units(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                            lar_error *error) {
    lar_status status = LAR_OK;
    qsort(packet, (size_t)count, sizeof *packet, compare_units);
    for (int32_t i = 0, j; i < count && status == LAR_OK; i = j) {
        for (j = i + 1; j < count && packet[j]->onward == packet[i]->onward &&
                        packet[j]->distance == packet[i]->distance;)
            j++;
        status = lar_plan_units(plan, packet + i, j - i, error);
    }
    return status;
}

/* One batch receives and sends on for a whole stage. Only in the concurrent use, by one thread,
 * each axis has its own: finer, but each costs other threads a wait. */
static lar_status add_relays(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                             lar_error *error) {
    const lar_schedule_options *o = plan->site->options;
    bool fine = o->scheme == LAR_SCHEME_LOCAL && o->channels == LAR_CHANNELS_CONCURRENT &&
                plan->threads == 1;
    lar_status status = LAR_OK;
    qsort(packet, (size_t)count, sizeof *packet, compare_relays);
    for (int32_t i = 0, j; i < count && status == LAR_OK; i = j) {
        for (j = i + 1; j < count && (!fine || step_of(packet[j]) == step_of(packet[i]));) j++;
        status = add_relay(plan, packet + i, j - i, error);
    }
    return status;
}

static lar_status add_stage(lar_plan *plan, int32_t stage, lar_plan_packet **scratch,
                            lar_error *error) {
    lar_packets *all = &plan->site->packets;
    int32_t units = 0, end = all->sent_first[plan->processor + 1];
    int32_t relays = end - all->sent_first[plan->processor], max = relays;
    for (int32_t i = all->sent_first[plan->processor]; i < end; i++) {
        lar_plan_packet *packet = &all->packet[i];
        if (packet->stage != stage) continue;
        if (packet->count == 0)
            packet->sent_in = LAR_AT_START;
        else if (needs_others(plan, packet))
            scratch[--relays] = packet;
        else
            scratch[units++] = packet;
    }
    lar_status status = add_units(plan, scratch, units, error);
    if (status == LAR_OK) status = add_relays(plan, scratch + relays, max - relays, error);
    if (stage == 0) plan->since = 0; /* until now nothing was on its way */
    return status;
}

/* ---- the last batches ------------------------------------------------------------------- */

/* A node belongs to the lowest thread that has one of its elements. */
static void find_owners(lar_plan *plan) {
    for (int32_t k = 0; k < plan->node_count; k++) plan->owner[k] = plan->threads;
    for (int32_t i = 0; i < plan->element_count; i++)
        for (int a = 0; a < 8; a++) {
            int32_t e = plan->element[i];
            int32_t *owner = &plan->owner[plan->site->place[plan->site->mesh->element[e][a]]];
            int32_t thread = plan->batch[plan->site->batch[e]].thread;
            if (thread < *owner) *owner = thread;
        }
}

/* The thread for a packet: it moves most of the nodes, but all should have as much to receive. */
static int32_t receiver_of(const lar_plan *plan, const lar_plan_packet *packet,
                           const int64_t *given) {
    int32_t own[LAR_THREADS_MAX] = {0}, best = 0;
    const int32_t *node = nodes_of(plan, packet);
    for (int32_t j = 0; j < packet->count; j++) own[plan->owner[plan->site->place[node[j]]]]++;
    for (int32_t t = 1; t < plan->threads; t++)
        if (given[t] - own[t] < given[best] - own[best]) best = t;
    return best;
}

static void receive_rest(lar_plan *plan) {
    const lar_packets *all = &plan->site->packets;
    const lar_plan_gap *gap = &plan->gap[plan->gap_count - 1];
    int64_t given[LAR_THREADS_MAX] = {0};
    for (int32_t i = all->received_first[plan->processor];
         i < all->received_first[plan->processor + 1]; i++) {
        lar_plan_packet *packet = &all->packet[all->received[i]];
        if (packet->received_in != LAR_NOWHERE) continue;
        int32_t thread = receiver_of(plan, packet, given);
        given[thread] += packet->count;
        packet->received_in = packet->count > 0 ? gap->batch[thread] : plan->last[0];
    }
}

static bool receives_rest(const lar_plan *plan) {
    const lar_packets *all = &plan->site->packets;
    bool any = false;
    for (int32_t i = all->received_first[plan->processor];
         i < all->received_first[plan->processor + 1]; i++)
        any |= all->packet[all->received[i]].received_in == LAR_NOWHERE;
    return any;
}

/* Several threads must have received everything before one of them moves a node. One thread does
 * both in one batch. */
static lar_status add_last(lar_plan *plan, lar_error *error) {
    lar_plan_gap *gap = add_gap(plan, plan->threads - 1, error);
    if (!gap) return LAR_ERROR_MEMORY;
    gap->receives = receives_rest(plan);
    for (int32_t i = 0; i < plan->element_count; i++) {
        int32_t e = plan->element[i];
        if (plan->site->batch[e] != LAR_NOWHERE) continue;
        plan->site->batch[e] = LAR_POOLED;
        plan->pool[plan->pooled++] = e;
    }
    plan->last[0] = gap->batch[0];
    for (int32_t t = 0; t < plan->threads && plan->threads > 1; t++) {
        plan->last[t] = lar_plan_add_batch(plan, t);
        if (plan->last[t] == LAR_NOWHERE)
            return lar_fail_memory(error, sizeof *plan->batch, "batches");
    }
    return LAR_OK;
}

/* ---- the plan --------------------------------------------------------------------------- */

static lar_status start_plan(lar_plan *plan, lar_error *error) {
    lar_plan_site *site = plan->site;
    size_t nodes = (size_t)plan->node_count, elements = (size_t)plan->element_count;
    plan->pool = lar_calloc(elements, sizeof *plan->pool);
    plan->arrival = lar_calloc(nodes, sizeof *plan->arrival);
    plan->mark = lar_calloc(nodes, sizeof *plan->mark);
    plan->owner = lar_calloc(nodes, sizeof *plan->owner);
    if (!plan->pool || !plan->arrival || !plan->mark || !plan->owner)
        return lar_fail_memory(error, nodes * sizeof *plan->arrival, "nodes of a processor");
    for (int32_t k = 0; k < plan->node_count; k++) site->place[plan->node[k]] = k;
    for (int32_t i = 0; i < plan->element_count; i++) site->batch[plan->element[i]] = LAR_NOWHERE;
    find_arrivals(plan);
    return LAR_OK;
}

lar_status lar_plan_build(lar_plan_site *site, int32_t processor, lar_plan *plan,
                          lar_error *error) {
    const int32_t *elements = site->element_first + processor;
    const int64_t *nodes = site->node_first + processor;
    *plan = (lar_plan){.site = site,
                       .processor = processor,
                       .threads = site->options->threads,
                       .element = site->element + elements[0],
                       .element_count = elements[1] - elements[0],
                       .node = site->node + nodes[0],
                       .node_count = (int32_t)(nodes[1] - nodes[0])};
    const int32_t *sent = site->packets.sent_first + processor;
    lar_plan_packet **scratch = lar_calloc((size_t)(sent[1] - sent[0]), sizeof *scratch);
    if (!scratch) return lar_fail_memory(error, sizeof *scratch, "packets of a processor");
    lar_status status = start_plan(plan, error);
    for (int32_t s = 0; s < LAR_STAGES && status == LAR_OK; s++)
        status = add_stage(plan, s, scratch, error);
    free(scratch);
    if (status == LAR_OK) status = add_last(plan, error);
    if (status == LAR_OK) status = lar_plan_shares(plan, error);
    if (status != LAR_OK) return status;
    find_owners(plan);
    receive_rest(plan);
    return LAR_OK;
}

void lar_plan_clear(lar_plan *plan) {
    free(plan->batch);
    free(plan->pool);
    free(plan->arrival);
    free(plan->mark);
    free(plan->owner);
    *plan = (lar_plan){0};
}
