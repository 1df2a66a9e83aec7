/* Which batches a batch waits for: shared sums in the order of time (schedule.h). */
#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "divide/schedule/plan.h"

/* What is done with the sum of a node, in the order of time. */
enum { RECOVERED = 0, SENT = 1, RECEIVED = 2, MOVED = 1 + 2 * LAR_STAGES };

/* `batch` does something with the sum of a node. */
typedef struct touch {
    int32_t batch;
    int32_t when; /* RECOVERED, SENT + 2 stage, RECEIVED + 2 stage, MOVED */
} touch;

typedef struct book {
    const lar_mesh *mesh;
    const int32_t *place;
    const lar_schedule *schedule;
    int64_t *first;  /* [nodes + 1] */
    touch *touch;    /* node after node */
    int32_t *thread; /* [batches] */
    int32_t *latest; /* [batches][threads] the batch of a thread that is waited for; -1: none */
} book;

static void note(book *b, int32_t node, int32_t batch, int32_t when) {
    int32_t k = b->place[node];
    if (b->touch)
        b->touch[b->first[k]++] = (touch){batch, when};
    else
        b->first[k + 1]++;
}

static void note_transfers(book *b, int32_t batch, lar_range span, int32_t first_when) {
    for (int32_t i = span.first; i < span.first + span.count; i++) {
        const lar_transfer *t = &b->schedule->transfer[i];
        for (int32_t j = 0; j < t->vectors.count; j++)
            note(b, b->schedule->vector[t->vectors.first + j], batch, first_when + 2 * t->stage);
    }
}

static void note_all(book *b) {
    const lar_schedule *s = b->schedule;
    for (int32_t i = 0; i < s->batch_count; i++) {
        const lar_batch *batch = &s->batch[i];
        for (int32_t j = 0; j < batch->elements.count; j++)
            for (int a = 0; a < 8; a++)
                note(b, b->mesh->element[s->element[batch->elements.first + j]][a], i, RECOVERED);
        for (int32_t j = 0; j < batch->positions.count; j++)
            note(b, s->node[batch->positions.first + j], i, MOVED);
        note_transfers(b, i, batch->receives, RECEIVED);
        note_transfers(b, i, batch->sends, SENT);
    }
}

static bool list_touches(book *b) {
    int32_t nodes = b->schedule->node_count;
    b->first = lar_calloc((size_t)nodes + 1, sizeof *b->first);
    if (!b->first) return false;
    note_all(b);
    for (int32_t k = 0; k < nodes; k++) b->first[k + 1] += b->first[k];
    b->touch = lar_calloc((size_t)b->first[nodes], sizeof *b->touch);
    if (!b->touch) return false;
    note_all(b);
    for (int32_t k = nodes; k > 0; k--) b->first[k] = b->first[k - 1];
    b->first[0] = 0;
    return true;
}

/* When within a batch: elements, receives, positions, sends. */
static int part_of_batch(int32_t when) {
    if (when == RECOVERED) return 0;
    if (when == MOVED) return 2;
    return when % 2 == SENT % 2 ? 3 : 1;
}

static bool in_order(const book *b, const touch *early, const touch *late, const int32_t *rank) {
    if (b->thread[early->batch] != b->thread[late->batch])
        return rank[early->batch] < rank[late->batch];
    if (early->batch != late->batch) return early->batch < late->batch;
    return part_of_batch(early->when) < part_of_batch(late->when);
}

/* What is earlier for the same node must be over, on other threads; on the same one the order of
 * batches has to see to it. */
static void find_latest(book *b, const int32_t *rank) {
    int32_t threads = b->schedule->threads;
    for (int32_t k = 0; k < b->schedule->node_count; k++)
        for (int64_t i = b->first[k]; i < b->first[k + 1]; i++)
            for (int64_t j = b->first[k]; j < b->first[k + 1]; j++) {
                const touch *early = &b->touch[i], *late = &b->touch[j];
                if (early->when >= late->when) continue;
                bool sound = in_order(b, early, late, rank);
                assert(sound);
                (void)sound;
                int32_t thread = b->thread[early->batch];
                if (thread == b->thread[late->batch]) continue;
                int32_t *latest = &b->latest[late->batch * threads + thread];
                if (early->batch > *latest) *latest = early->batch;
            }
}

/* A gate waits for all others' last batches. */
static void close_gates(book *b) {
    const lar_schedule *s = b->schedule;
    for (int32_t t = 0; t < s->threads && s->threads > 1; t++)
        for (int32_t other = 0; other < s->threads; other++)
            if (other != t)
                b->latest[(s->thread_first[t + 1] - 1) * s->threads + other] =
                    s->thread_first[other + 1] - 2;
}

/* Waits that the thread has behind it already are left out. With `put`, writes them. */
static int32_t write_waits(const book *b, lar_schedule *s, bool put) {
    int32_t count = 0;
    for (int32_t t = 0; t < s->threads; t++) {
        int32_t passed[LAR_THREADS_MAX];
        for (int32_t other = 0; other < s->threads; other++) passed[other] = -1;
        for (int32_t i = s->thread_first[t]; i < s->thread_first[t + 1]; i++) {
            int32_t first = count;
            for (int32_t other = 0; other < s->threads; other++) {
                int32_t latest = b->latest[i * s->threads + other];
                if (latest <= passed[other]) continue;
                passed[other] = latest;
                if (put) s->wait[count] = latest;
                count++;
            }
            if (put) s->batch[i].waits = (lar_range){first, count - first};
        }
    }
    return count;
}

static lar_status fill_waits(book *b, const int32_t *rank, lar_schedule *s, lar_error *error) {
    size_t batches = (size_t)s->batch_count, pairs = batches * (size_t)s->threads;
    b->thread = lar_calloc(batches, sizeof *b->thread);
    b->latest = lar_calloc(pairs, sizeof *b->latest);
    if (!b->thread || !b->latest || !list_touches(b))
        return lar_fail_memory(error, pairs * sizeof *b->latest, "waits");
    for (size_t i = 0; i < pairs; i++) b->latest[i] = -1;
    for (int32_t t = 0; t < s->threads; t++)
        for (int32_t i = s->thread_first[t]; i < s->thread_first[t + 1]; i++) b->thread[i] = t;
    find_latest(b, rank);
    close_gates(b);
    s->wait_count = write_waits(b, s, false);
    s->wait = lar_calloc((size_t)s->wait_count, sizeof *s->wait);
    if (!s->wait) return lar_fail_memory(error, batches * sizeof *s->wait, "waits");
    write_waits(b, s, true);
    return LAR_OK;
}

lar_status lar_schedule_find_waits(const lar_mesh *mesh, const int32_t *place, const int32_t *rank,
                                   lar_schedule *schedule, lar_error *error) {
    book b = {.mesh = mesh, .place = place, .schedule = schedule};
    lar_status status = fill_waits(&b, rank, schedule, error);
    free(b.first);
    free(b.touch);
    free(b.thread);
    free(b.latest);
    return status;
}
