/* For every node of every processor: what happens to it in the order of schedule.h, by whatever
 * thread.
 *
 *     rank   0          1        2          3        4          5        6          7
 *            elements   send 0   receive 0  send 1   receive 1  send 2   receive 2  positions
 *
 * Within a thread ranks must not fall. Between threads a batch with a higher rank must know that
 * the batch with the lower one is done, which is a matter of vector clocks:
 *
 *     thread 0   0 ----> 1 ----> 2          clock[batch][thread]: the last batch of that thread
 *                         \                 which is surely done when this batch has waited;
 *     thread 1   3 ----> 4 -wait-> 5        of batch 5: thread 0 up to batch 1
 *
 * Only threads and waits of the same processor count. A message there and back would order batches
 * too, but two threads that touch the same memory must synchronise here, not by way of a peer.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "divide/proof/proof.h"

enum { MOVED = 2 * LAR_STAGES + 1, RANKS };

static uint8_t rank_of_send(int32_t stage) {
    return (uint8_t)(2 * stage + 1);
}
static uint8_t rank_of_receive(int32_t stage) {
    return (uint8_t)(2 * stage + 2);
}

/* One thing that a batch does with a node. */
typedef struct use {
    int32_t batch;
    uint8_t rank, thread;
    bool whole;
} use;

typedef struct processor {
    const lar_proof *proof;
    const lar_schedule *s;
    int32_t *clock; /* [batch_count][threads] */
    int32_t *local; /* [nodes of the mesh] number of a node among s->node; others are not asked */
    int64_t *first; /* [node_count + 2] of a node's uses */
    int32_t *used;  /* [node_count] */
    use *use;
} processor;

/* ---- clocks ------------------------------------------------------------------------------ */

static void learn(const processor *p, int32_t batch, int32_t from) {
    int32_t threads = p->s->threads;
    int32_t *mine = p->clock + (size_t)batch * (size_t)threads;
    const int32_t *theirs = p->clock + (size_t)from * (size_t)threads;
    for (int32_t t = 0; t < threads; t++)
        if (theirs[t] > mine[t]) mine[t] = theirs[t];
}

/* The batch is in order: everything that it learns from has been set. */
static void set_clock(const processor *p, int32_t batch) {
    const lar_schedule *s = p->s;
    int32_t thread = lar_batch_thread(s, batch);
    int32_t *mine = p->clock + (size_t)batch * (size_t)s->threads;
    for (int32_t t = 0; t < s->threads; t++) mine[t] = -1;
    if (batch > s->thread_first[thread]) learn(p, batch, batch - 1);
    for (int32_t i = 0; i < s->batch[batch].waits.count; i++)
        learn(p, batch, s->wait[s->batch[batch].waits.first + i]);
    mine[thread] = batch;
}

static bool does_work(const lar_batch *b) {
    return b->elements.count || b->receives.count || b->positions.count || b->sends.count;
}

/* At its end every thread knows that the others have done their work: the next step may begin, and
 * whoever hears from this processor in it may use the buffers again. */
static lar_status check_gates(const processor *p, lar_error *error) {
    const lar_schedule *s = p->s;
    for (int32_t u = 0; u < s->threads; u++) {
        int32_t last = s->thread_first[u + 1] - 1;
        while (last >= s->thread_first[u] && !does_work(&s->batch[last])) last--;
        if (last < s->thread_first[u]) continue;
        for (int32_t t = 0; t < s->threads; t++) {
            int32_t end = s->thread_first[t + 1] - 1;
            bool knows = end >= s->thread_first[t] &&
                         p->clock[(size_t)end * (size_t)s->threads + (size_t)u] >= last;
            if (t != u && !knows)
                return LAR_DISPROVE(error,
                                    "processor %d, thread %d can begin the next step while thread "
                                    "%d is still in batch %d: its gate does not wait for it",
                                    s->processor, t, u, last);
        }
    }
    return LAR_OK;
}

/* ---- uses of nodes ----------------------------------------------------------------------- */

typedef void touch(processor *p, int32_t node, use u);

static void count_use(processor *p, int32_t node, use u) {
    (void)u;
    p->first[p->local[node] + 1]++;
}

static void keep_use(processor *p, int32_t node, use u) {
    int32_t n = p->local[node];
    use *next = p->use + p->first[n] + p->used[n];
    /* The elements of a batch at a node are one use. */
    bool again = u.rank == 0 && p->used[n] && next[-1].batch == u.batch && next[-1].rank == 0;
    if (again) return;
    *next = u;
    p->used[n]++;
}

static void touch_packets(processor *p, int32_t batch, uint8_t thread, bool sends, touch *visit) {
    const lar_schedule *s = p->s;
    int32_t first = sends ? s->batch[batch].sends.first : s->batch[batch].receives.first;
    int32_t count = sends ? s->batch[batch].sends.count : s->batch[batch].receives.count;
    for (int32_t i = first; i < first + count; i++) {
        const lar_transfer *t = &s->transfer[i];
        uint8_t rank = sends ? rank_of_send(t->stage) : rank_of_receive(t->stage);
        for (int32_t j = 0; j < t->vectors.count; j++)
            visit(p, s->vector[t->vectors.first + j],
                  (use){batch, rank, thread, !sends && j >= t->vectors.count - t->whole});
    }
}

/* All uses in the order in which the threads come to them, thread after thread. */
static void touch_all(processor *p, touch *visit) {
    const lar_schedule *s = p->s;
    for (int32_t b = 0; b < s->batch_count; b++) {
        const lar_batch *batch = &s->batch[b];
        uint8_t thread = (uint8_t)lar_batch_thread(s, b);
        for (int32_t i = 0; i < batch->elements.count; i++)
            for (int a = 0; a < 8; a++)
                visit(p, p->proof->mesh->element[s->element[batch->elements.first + i]][a],
                      (use){b, 0, thread, false});
        touch_packets(p, b, thread, false, visit);
        for (int32_t i = 0; i < batch->positions.count; i++)
            visit(p, s->node[batch->positions.first + i], (use){b, MOVED, thread, false});
        touch_packets(p, b, thread, true, visit);
    }
}

/* ---- what is out of order, in words ------------------------------------------------------ */

enum { USE_TEXT = 96 };

/* "recovers element 5", "sends it to processor 2 (stage 0)". */
static const char *describe(const processor *p, int32_t node, use u, char text[USE_TEXT]) {
    const lar_schedule *s = p->s;
    const lar_batch *batch = &s->batch[u.batch];
    if (u.rank == MOVED) return "moves it";
    if (u.rank == 0) {
        for (int32_t i = 0; i < batch->elements.count; i++)
            for (int a = 0; a < 8; a++)
                if (p->proof->mesh->element[s->element[batch->elements.first + i]][a] == node) {
                    snprintf(text, USE_TEXT, "recovers element %d at it",
                             s->element[batch->elements.first + i]);
                    return text;
                }
    }
    bool sends = u.rank & 1;
    int32_t first = sends ? batch->sends.first : batch->receives.first;
    int32_t count = sends ? batch->sends.count : batch->receives.count;
    int32_t stage = (u.rank - 1) / 2, peer = -1;
    for (int32_t i = first; i < first + count && peer < 0; i++)
        for (int32_t j = 0; s->transfer[i].stage == stage && j < s->transfer[i].vectors.count; j++)
            if (s->vector[s->transfer[i].vectors.first + j] == node) peer = s->transfer[i].peer;
    snprintf(text, USE_TEXT, "%s processor %d (stage %d)",
             sends ? "sends it to" : "receives it from", peer, stage);
    return text;
}

static lar_status refuse_thread(const processor *p, int32_t node, use early, use late,
                                lar_error *error) {
    char at[LAR_PLACE_TEXT], one[USE_TEXT], two[USE_TEXT];
    return LAR_DISPROVE(error, "node %d: %s %s, and only then, in batch %d, %s", node,
                        lar_proof_place(p->s, late.batch, at), describe(p, node, late, two),
                        early.batch, describe(p, node, early, one));
}

static lar_status refuse_race(const processor *p, int32_t node, use early, use late,
                              lar_error *error) {
    char at[LAR_PLACE_TEXT], other[LAR_PLACE_TEXT], one[USE_TEXT], two[USE_TEXT];
    return LAR_DISPROVE(error, "node %d: %s %s and does not wait for %s, which %s", node,
                        lar_proof_place(p->s, late.batch, at), describe(p, node, late, two),
                        lar_proof_place(p->s, early.batch, other), describe(p, node, early, one));
}

/* ---- the check --------------------------------------------------------------------------- */

/* A whole force replaces what is there. Beside another vector of the same stage the result would
 * hang on which of them comes last. */
static lar_status check_whole(const processor *p, int32_t node, const use *use_of, int32_t count,
                              lar_error *error) {
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = 0; use_of[i].whole && j < count; j++)
            if (j != i && use_of[j].rank == use_of[i].rank) {
                char here[LAR_PLACE_TEXT], there[LAR_PLACE_TEXT], text[USE_TEXT];
                return LAR_DISPROVE(error,
                                    "node %d: %s receives its whole force in the stage in which "
                                    "%s %s",
                                    node, lar_proof_place(p->s, use_of[i].batch, here),
                                    lar_proof_place(p->s, use_of[j].batch, there),
                                    describe(p, node, use_of[j], text));
            }
    return LAR_OK;
}

static lar_status check_threads(const processor *p, int32_t node, const use *use_of, int32_t count,
                                lar_error *error) {
    /* before[r][t]: the last batch of thread t in which the node has a rank below r. */
    int32_t threads = p->s->threads, before[RANKS + 1][LAR_THREADS_MAX];
    memset(before, 0xff, sizeof before);
    for (int32_t i = 0; i < count; i++)
        before[use_of[i].rank + 1][use_of[i].thread] = use_of[i].batch;
    for (int r = 1; r <= RANKS; r++)
        for (int32_t t = 0; t < threads; t++)
            if (before[r - 1][t] > before[r][t]) before[r][t] = before[r - 1][t];
    for (int32_t i = 0; i < count; i++) {
        const int32_t *known = p->clock + (size_t)use_of[i].batch * (size_t)threads;
        for (int32_t t = 0; t < threads; t++) {
            int32_t needed = before[use_of[i].rank][t];
            if (t == use_of[i].thread || needed <= known[t]) continue;
            int32_t j = 0;
            while (use_of[j].batch != needed || use_of[j].rank >= use_of[i].rank) j++;
            return refuse_race(p, node, use_of[j], use_of[i], error);
        }
    }
    return LAR_OK;
}

static lar_status check_node(const processor *p, int32_t n, lar_error *error) {
    const use *use_of = p->use + p->first[n];
    int32_t node = p->s->node[n], count = p->used[n];
    bool whole = false;
    for (int32_t i = 0; i < count; i++) {
        whole |= use_of[i].whole;
        if (i > 0 && use_of[i].thread == use_of[i - 1].thread &&
            use_of[i].rank < use_of[i - 1].rank)
            return refuse_thread(p, node, use_of[i], use_of[i - 1], error);
    }
    lar_status status = whole ? check_whole(p, node, use_of, count, error) : LAR_OK;
    if (!status && p->s->threads > 1) status = check_threads(p, node, use_of, count, error);
    return status;
}

static lar_status check_nodes(processor *p, lar_error *error) {
    const lar_schedule *s = p->s;
    for (int32_t n = 0; n < s->node_count; n++) p->local[s->node[n]] = n;
    p->first = lar_calloc((size_t)s->node_count + 1, sizeof *p->first);
    p->used = lar_calloc((size_t)s->node_count, sizeof *p->used);
    if (!p->first || !p->used)
        return lar_fail_memory(error, 12 * (size_t)s->node_count, "what happens to nodes");
    touch_all(p, count_use);
    for (int32_t n = 0; n < s->node_count; n++) p->first[n + 1] += p->first[n];
    size_t uses = (size_t)p->first[s->node_count];
    p->use = lar_calloc(uses, sizeof *p->use);
    if (!p->use) return lar_fail_memory(error, uses * sizeof *p->use, "what happens to nodes");
    touch_all(p, keep_use);
    lar_status status = LAR_OK;
    for (int32_t n = 0; !status && n < s->node_count; n++) status = check_node(p, n, error);
    return status;
}

static lar_status check_processor(const lar_proof *proof, int32_t *local, int32_t **at,
                                  const lar_schedule *s, lar_error *error) {
    processor p = {.proof = proof, .s = s, .local = local};
    size_t clocks = (size_t)s->batch_count * (size_t)s->threads;
    p.clock = lar_calloc(clocks, sizeof *p.clock);
    lar_status status = LAR_OK;
    if (!p.clock) status = lar_fail_memory(error, 4 * clocks, "clocks of threads");
    for (int32_t b = 0; !status && b < s->batch_count; b++) set_clock(&p, *(*at)++);
    if (!status) status = check_nodes(&p, error);
    if (!status) status = check_gates(&p, error);
    free(p.clock);
    free(p.first);
    free(p.used);
    free(p.use);
    return status;
}

/* The order of all batches, sorted by processor and numbered as the processor does. */
static void order_by_processor(const lar_proof *proof, int32_t *where, int32_t *order) {
    for (int32_t p = 0, v = 0; p < proof->set->count; p++)
        for (; v < proof->first[p + 1]; v++) where[v] = p;
    int32_t *next = where + proof->batch_count;
    for (int32_t p = 0; p < proof->set->count; p++) next[p] = proof->first[p];
    for (int32_t i = 0; i < proof->batch_count; i++) {
        int32_t p = where[proof->order[i]];
        order[next[p]++] = proof->order[i] - proof->first[p];
    }
}

lar_status lar_proof_races(lar_proof *proof, lar_error *error) {
    size_t batches = (size_t)proof->batch_count, processors = (size_t)proof->set->count;
    int32_t *local = lar_calloc((size_t)proof->mesh->node_count, sizeof *local);
    int32_t *where = lar_calloc(batches + processors, sizeof *where);
    int32_t *order = lar_calloc(batches, sizeof *order), *at = order;
    lar_status status = LAR_OK;
    if (!local || !where || !order)
        status = lar_fail_memory(error, 4 * (size_t)proof->mesh->node_count, "nodes");
    else
        order_by_processor(proof, where, order);
    for (int32_t p = 0; !status && p < proof->set->count; p++)
        status = check_processor(proof, local, &at, &proof->set->of[p], error);
    free(local);
    free(where);
    free(order);
    return status;
}
