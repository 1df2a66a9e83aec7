/* No deadlock (T 7.5.8): the batches of all processors can be put in an order in which each comes
 * after what it needs.
 *
 *     p   batch 0 --> batch 1 --> batch 2        --> thread order: a batch after the one before it
 *                        |           ^           ==> wait, or message: what the batch in front
 *                        v           |               receives or waits for is done when the batch
 *     q               batch 0 --> batch 1            behind it ends
 *
 * A batch waits and receives before it sends, so one vertex stands for both: whoever needs anything
 * of a batch needs its end. Sending never blocks. Steps follow each other with nothing but thread
 * order in between; what has no cycle in one step has none in many.
 */
#include <stdio.h>
#include <stdlib.h>

#include "divide/proof/proof.h"

typedef struct arrow {
    int32_t from, to; /* to needs from */
} arrow;

/* What each batch is needed by, or what it needs, as the arrows are filled in. */
typedef struct graph {
    int32_t *first; /* [vertices + 1] */
    int32_t *other; /* [arrows] */
} graph;

static bool graph_make(graph *g, int32_t vertices, const arrow *arrows, int32_t count, bool back) {
    g->first = lar_calloc((size_t)vertices + 2, sizeof *g->first);
    g->other = lar_calloc((size_t)count, sizeof *g->other);
    if (!g->first || !g->other) return false;
    /* Counts are kept two places on: filling moves each start to its final place. */
    int32_t *start = g->first + 1;
    for (int32_t i = 0; i < count; i++) start[(back ? arrows[i].to : arrows[i].from) + 1]++;
    for (int32_t v = 0; v < vertices; v++) start[v + 1] += start[v];
    for (int32_t i = 0; i < count; i++) {
        int32_t at = back ? arrows[i].to : arrows[i].from;
        g->other[start[at]++] = back ? arrows[i].from : arrows[i].to;
    }
    return true;
}

static void graph_clear(graph *g) {
    free(g->first);
    free(g->other);
}

static int32_t collect_arrows(const lar_proof *proof, arrow *arrows) {
    int32_t n = 0;
    for (int32_t p = 0; p < proof->set->count; p++) {
        const lar_schedule *s = &proof->set->of[p];
        int32_t base = proof->first[p];
        for (int32_t t = 0; t < s->threads; t++)
            for (int32_t b = s->thread_first[t] + 1; b < s->thread_first[t + 1]; b++)
                arrows[n++] = (arrow){base + b - 1, base + b};
        for (int32_t b = 0; b < s->batch_count; b++)
            for (int32_t i = 0; i < s->batch[b].waits.count; i++)
                arrows[n++] = (arrow){base + s->wait[s->batch[b].waits.first + i], base + b};
    }
    for (int32_t i = 0; i < proof->packet_count; i++) {
        const lar_proof_packet *packet = &proof->packet[i];
        arrows[n++] = (arrow){proof->first[packet->from] + packet->send_batch,
                              proof->first[packet->to] + packet->receive_batch};
    }
    return n;
}

/* Takes away batches that need nothing any more, one after the other (Kahn). needs[] keeps what is
 * left. Returns how many could be taken. */
static int32_t take_away(const graph *g, int32_t vertices, int32_t *needs, int32_t *order) {
    int32_t taken = 0;
    for (int32_t i = 0; i < g->first[vertices]; i++) needs[g->other[i]]++;
    for (int32_t v = 0; v < vertices; v++)
        if (!needs[v]) order[taken++] = v;
    for (int32_t i = 0; i < taken; i++)
        for (int32_t j = g->first[order[i]]; j < g->first[order[i] + 1]; j++)
            if (--needs[g->other[j]] == 0) order[taken++] = g->other[j];
    return taken;
}

/* ---- a cycle in words -------------------------------------------------------------------- */

static int32_t processor_of(const lar_proof *proof, int32_t v) {
    int32_t low = 0, high = proof->set->count;
    while (high - low > 1) {
        int32_t middle = (low + high) / 2;
        *(proof->first[middle] <= v ? &low : &high) = middle;
    }
    /* Processors without batches begin where the next one does. */
    return low;
}

typedef enum reason { COMES_AFTER, WAITS_FOR, RECEIVES_FROM } reason;

static reason reason_of(const lar_proof *proof, int32_t v, int32_t needed) {
    int32_t p = processor_of(proof, v);
    if (processor_of(proof, needed) != p) return RECEIVES_FROM;
    const lar_schedule *s = &proof->set->of[p];
    return lar_batch_thread(s, v - proof->first[p]) == lar_batch_thread(s, needed - proof->first[p])
               ? COMES_AFTER
               : WAITS_FOR;
}

/* A shortest cycle through `start`, which is on one: cycle[0] = start, each needs the next, the
 * last needs the first. via[] is scratch for all vertices. Returns its length. */
static int32_t find_cycle(const graph *needed, int32_t vertices, const int32_t *left, int32_t start,
                          int32_t *via, int32_t *cycle) {
    int32_t head = 0, tail = 0, *queue = cycle;
    for (int32_t v = 0; v < vertices; v++) via[v] = -1;
    queue[tail++] = start;
    while (via[start] < 0 && head < tail) {
        int32_t v = queue[head++];
        for (int32_t i = needed->first[v]; i < needed->first[v + 1]; i++) {
            int32_t u = needed->other[i];
            if (!left[u] || via[u] >= 0) continue;
            via[u] = v;
            if (u != start) queue[tail++] = u;
        }
    }
    /* via[] leads from what is needed to who needs it: it is walked from the end. */
    int32_t length = 1;
    for (int32_t v = via[start]; v != start; v = via[v]) length++;
    int32_t v = start;
    for (int32_t i = length - 1; i >= 0; i--) cycle[i] = v = via[v];
    return length;
}

static lar_status tell_cycle(const lar_proof *proof, const int32_t *cycle, int32_t length,
                             lar_error *error) {
    static const char *const words[] = {"comes after", "waits for", "receives from"};
    enum { HOPS = 6 };
    char text[900], at[LAR_PLACE_TEXT];
    int32_t start = 0, hops = 0;
    while (start < length - 1 && reason_of(proof, cycle[start], cycle[start + 1]) == COMES_AFTER)
        start++;
    size_t used = 0;
    bool closed = false;
    for (int32_t i = 0; i <= length && hops <= HOPS; i++) {
        int32_t v = cycle[(start + i) % length], next = cycle[(start + i + 1) % length];
        reason why = reason_of(proof, cycle[(start + i + length - 1) % length], v);
        /* Of a row of batches of one thread only its ends are worth a word. */
        if (i > 0 && i < length && why == COMES_AFTER && reason_of(proof, v, next) == COMES_AFTER)
            continue;
        int32_t p = processor_of(proof, v);
        lar_proof_place(&proof->set->of[p], v - proof->first[p], at);
        int wrote = snprintf(text + used, sizeof text - used, "%s%s%s%s", i > 1 ? ", which " : " ",
                             i ? words[why] : "", i ? " " : "", at);
        used += wrote > 0 ? (size_t)wrote : 0;
        if (used >= sizeof text) used = sizeof text - 1;
        hops++;
        closed = i == length;
    }
    return LAR_DISPROVE(error, "deadlock, %d batches wait for each other in a circle:%s%s", length,
                        text, closed ? "" : " ...");
}

static lar_status refuse_cycle(const lar_proof *proof, const arrow *arrows, int32_t count,
                               const int32_t *left, lar_error *error) {
    graph needed = {0};
    size_t room = (size_t)proof->batch_count + 1;
    int32_t *via = lar_calloc(room, sizeof *via), *cycle = lar_calloc(room, sizeof *cycle);
    bool good = graph_make(&needed, proof->batch_count, arrows, count, true) && via && cycle;
    lar_status status = good ? LAR_OK : lar_fail_memory(error, 3 * room * sizeof *via, "a cycle");
    if (good) {
        /* Whatever is left needs something that is left: going back ends in a cycle. */
        int32_t v = 0;
        while (!left[v]) v++;
        while (!via[v]) {
            via[v] = 1;
            int32_t i = needed.first[v];
            while (!left[needed.other[i]]) i++;
            v = needed.other[i];
        }
        int32_t length = find_cycle(&needed, proof->batch_count, left, v, via, cycle);
        status = tell_cycle(proof, cycle, length, error);
    }
    graph_clear(&needed);
    free(via);
    free(cycle);
    return status;
}

lar_status lar_proof_order(lar_proof *proof, lar_error *error) {
    int64_t batches = 0, count = proof->packet_count;
    proof->first = lar_calloc((size_t)proof->set->count + 1, sizeof *proof->first);
    if (!proof->first) return lar_fail_memory(error, 4 * (size_t)proof->set->count, "processors");
    for (int32_t p = 0; p < proof->set->count; p++) {
        const lar_schedule *s = &proof->set->of[p];
        batches += s->batch_count;
        count += s->batch_count;
        for (int32_t b = 0; b < s->batch_count; b++) count += s->batch[b].waits.count;
        if (count > INT32_MAX)
            return LAR_DISPROVE(error, "processor %d: the schedules have too many waits", p);
        proof->first[p + 1] = (int32_t)batches;
    }
    proof->batch_count = (int32_t)batches;

    graph g = {0};
    arrow *arrows = lar_calloc((size_t)count, sizeof *arrows);
    int32_t *needs = lar_calloc((size_t)batches, sizeof *needs);
    proof->order = lar_calloc((size_t)batches, sizeof *proof->order);
    lar_status status = LAR_OK;
    int32_t n = arrows ? collect_arrows(proof, arrows) : 0;
    if (!arrows || !needs || !proof->order || !graph_make(&g, proof->batch_count, arrows, n, false))
        status = lar_fail_memory(error, (size_t)count * 12, "dependencies of batches");
    else if (take_away(&g, proof->batch_count, needs, proof->order) < proof->batch_count)
        status = refuse_cycle(proof, arrows, n, needs, error);
    graph_clear(&g);
    free(arrows);
    free(needs);
    return status;
}
