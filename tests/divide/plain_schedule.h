/* Schedules made the plain way, independent of the builder: everything at the latest possible, all
 * threads of a processor in step with each other.
 *
 *     rank      0          1        2          3        4          5        6          7      8
 *     batch     elements   send 0   receive 0  send 1   receive 1  send 2   receive 2  move   gate
 *
 * Every thread has these batches, and each waits for the one before it of all other threads. Batch
 * r of thread t is batch t * plain_batches(threads) + r. There is a gate only with several threads.
 */
#ifndef LAR_TESTS_PLAIN_SCHEDULE_H
#define LAR_TESTS_PLAIN_SCHEDULE_H

#include "testing.h"

#include "divide/incidence.h"
#include "divide/schedule/schedule.h"
#include "brick_mesh.h"

/* A mesh and who has what of it. */
typedef struct divided {
    lar_mesh mesh;
    lar_incidence incidence;
    lar_distribution distribution;
    lar_sharing sharing;
} divided;

static TEST_UNUSED void divided_clear(divided *d) {
    lar_sharing_clear(&d->sharing);
    lar_distribution_clear(&d->distribution);
    lar_incidence_clear(&d->incidence);
    lar_mesh_clear(&d->mesh);
}

/* A brick mesh on a grid, cut. */
static TEST_UNUSED divided divided_brick(int nx, int ny, int nz, int gx, int gy, int gz) {
    divided d = {.mesh = brick_mesh(nx, ny, nz)};
    lar_grid grid = grid_of(gx, gy, gz);
    assert_int_equal(lar_incidence_build(&d.mesh, &d.incidence, NULL), LAR_OK);
    assert_int_equal(lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL), LAR_OK);
    assert_int_equal(lar_sharing_build(&d.incidence, &d.distribution, &d.sharing, NULL), LAR_OK);
    return d;
}

static inline int plain_batches(int threads) {
    return threads > 1 ? 9 : 8;
}

typedef struct plain_message {
    int32_t from, to, stage, whole, node;
} plain_message;

typedef struct plain_list {
    int32_t count, room, node;
    plain_message *message;
} plain_list;

static void plain_keep(void *context, const lar_message *m) {
    plain_list *list = context;
    if (list->count == list->room) {
        list->room = 2 * list->room + 64;
        list->message = realloc(list->message, (size_t)list->room * sizeof *list->message);
    }
    list->message[list->count++] =
        (plain_message){m->from, m->to, m->stage, m->what == LAR_CARRIES_ALL, list->node};
}

static int plain_compare(const void *a, const void *b) {
    const int32_t *x = a, *y = b;
    for (int i = 0; i < 5; i++)
        if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
    return 0;
}

/* All messages of a step, and an empty one (node -1) where nothing flows back. */
static plain_list plain_messages(const divided *d, lar_scheme scheme, lar_channel_use channels) {
    plain_list list = {0};
    size_t n = (size_t)d->sharing.grid.count;
    uint8_t *sends = calloc(n * n, 1);
    for (list.node = 0; list.node < d->mesh.node_count; list.node++) {
        const int32_t *set;
        int32_t count = lar_sharing_of(&d->sharing, list.node, &set);
        lar_scheme_messages(scheme, channels, &d->sharing.grid, set, count, plain_keep, &list);
    }
    for (int32_t i = 0; i < list.count; i++)
        sends[(size_t)list.message[i].from * n + (size_t)list.message[i].to] = 1;
    list.node = -1;
    for (size_t p = 0; p < n; p++)
        for (size_t q = 0; q < n; q++)
            if (sends[p * n + q] && !sends[q * n + p])
                plain_keep(&list, &(lar_message){.from = (int32_t)q, .to = (int32_t)p});
    free(sends);
    qsort(list.message, (size_t)list.count, sizeof *list.message, plain_compare);
    return list;
}

/* Adds one end of the packet message[0 .. count) to schedule s, which has room. */
static void plain_transfer(lar_schedule *s, int32_t peer, const plain_message *message,
                           int32_t count, int64_t offset) {
    lar_transfer *t = &s->transfer[s->transfer_count++];
    *t = (lar_transfer){.peer = peer, .stage = message->stage, .offset = offset};
    t->vectors.first = s->vector_count;
    for (int32_t i = 0; i < count && message[i].node >= 0; i++) {
        s->vector[s->vector_count++] = message[i].node;
        t->vectors.count++;
        t->whole += message[i].whole;
    }
}

/* Batches of rank r: what falls to each thread is a part of first .. s->transfer_count. */
static void plain_share(lar_schedule *s, int rank, int32_t first) {
    int32_t count = s->transfer_count - first, n = plain_batches(s->threads);
    for (int32_t t = 0; t < s->threads; t++) {
        lar_batch *b = &s->batch[t * n + rank];
        int32_t begin = first + count * t / s->threads, end = first + count * (t + 1) / s->threads;
        *(rank & 1 ? &b->sends : &b->receives) = (lar_range){begin, end - begin};
    }
}

static int64_t plain_size(int32_t vectors) {
    int64_t bytes = lar_packet_payload(vectors) + LAR_TAIL_BYTES;
    return (bytes + LAR_PACKET_ALIGN - 1) / LAR_PACKET_ALIGN * LAR_PACKET_ALIGN;
}

/* Transfers of one rank of processor p. Places in a buffer are given out as packets come in the
 * list, by all alike. */
static void plain_rank(lar_schedule *s, const plain_list *list, int rank) {
    int32_t first = s->transfer_count, p = s->processor;
    int64_t *end = calloc((size_t)s->grid.count, sizeof *end);
    for (int32_t i = 0, n; i < list->count; i += n) {
        const plain_message *m = &list->message[i];
        n = 1;
        while (i + n < list->count && m[n].from == m->from && m[n].to == m->to &&
               m[n].stage == m->stage)
            n++;
        bool mine = rank & 1 ? m->from == p : m->to == p;
        if (mine && m->stage == (rank - 1) / 2)
            plain_transfer(s, rank & 1 ? m->to : m->from, m, n, end[m->to]);
        end[m->to] += plain_size(m->node < 0 ? n - 1 : n);
    }
    s->receive_bytes = end[p];
    free(end);
    plain_share(s, rank, first);
}

static void plain_work(lar_schedule *s, const divided *d) {
    int32_t n = plain_batches(s->threads);
    uint8_t *mine = calloc((size_t)d->mesh.node_count, 1);
    for (int32_t e = 0; e < d->mesh.element_count; e++) {
        if (d->distribution.processor[e] != s->processor) continue;
        s->element[s->element_count++] = e;
        for (int a = 0; a < 8; a++) mine[d->mesh.element[e][a]] = 1;
    }
    for (int32_t k = 0; k < d->mesh.node_count; k++)
        if (mine[k]) s->node[s->node_count++] = k;
    free(mine);
    for (int32_t t = 0; t < s->threads; t++) {
        int32_t e = s->element_count * t / s->threads, f = s->element_count * (t + 1) / s->threads;
        int32_t k = s->node_count * t / s->threads, l = s->node_count * (t + 1) / s->threads;
        s->batch[t * n].elements = (lar_range){e, f - e};
        s->batch[t * n + 7].positions = (lar_range){k, l - k};
        s->thread_first[t + 1] = (t + 1) * n;
        for (int32_t r = 1; r < n; r++) {
            s->batch[t * n + r].waits = (lar_range){s->wait_count, s->threads - 1};
            for (int32_t u = 0; u < s->threads; u++)
                if (u != t) s->wait[s->wait_count++] = u * n + r - 1;
        }
    }
}

static TEST_UNUSED lar_schedule_set plain_schedules(const divided *d, lar_scheme scheme,
                                                    lar_channel_use channels, int threads) {
    plain_list list = plain_messages(d, scheme, channels);
    const lar_grid *grid = &d->distribution.grid;
    lar_schedule_set set = {grid->count, calloc((size_t)grid->count, sizeof *set.of)};
    int32_t batches = threads * plain_batches(threads);
    for (int32_t p = 0; p < set.count; p++) {
        lar_schedule *s = &set.of[p];
        *s = (lar_schedule){.grid = *grid,
                            .processor = p,
                            .threads = threads,
                            .scheme = scheme,
                            .channels = channels,
                            .mesh = lar_mesh_fingerprint(&d->mesh),
                            .division = 1,
                            .batch_count = batches};
        s->batch = calloc((size_t)batches, sizeof *s->batch);
        s->element = calloc((size_t)d->mesh.element_count, sizeof *s->element);
        s->wait = calloc((size_t)(batches * threads), sizeof *s->wait);
        s->node = calloc((size_t)d->mesh.node_count, sizeof *s->node);
        s->transfer = calloc((size_t)(2 * list.count) + 1, sizeof *s->transfer);
        s->vector = calloc((size_t)(2 * list.count) + 1, sizeof *s->vector);
        plain_work(s, d);
        for (int rank = 1; rank < 7; rank++) plain_rank(s, &list, rank);
    }
    free(list.message);
    return set;
}

#endif
