/* The packets of all processors: what they carry, empty ones, and their places in buffers. */
#include <stdlib.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "divide/schedule/plan.h"

/* One possible packet: sender, stage, receiver. Counts first, then cursors. */
typedef struct cell {
    int32_t added, whole, onward;
    int32_t packet; /* LAR_NOWHERE: none; while counting LAR_AT_START: an empty one */
} cell;

typedef struct table {
    int32_t processors;
    cell *cell; /* [processors][LAR_STAGES][processors] */
    lar_packets *packets;
    int32_t node; /* whose messages are visited */
} table;

static cell *cell_of(const table *t, int32_t from, int stage, int32_t to) {
    size_t row = (size_t)from * LAR_STAGES + (size_t)stage;
    return &t->cell[row * (size_t)t->processors + (size_t)to];
}

static void count_vector(void *context, const lar_message *m) {
    cell *c = cell_of(context, m->from, m->stage, m->to);
    if (m->what == LAR_CARRIES_ALL)
        c->whole++;
    else
        c->added++;
    if (m->onward > c->onward) c->onward = m->onward;
}

static void put_vector(void *context, const lar_message *m) {
    table *t = context;
    cell *c = cell_of(t, m->from, m->stage, m->to);
    const lar_plan_packet *packet = &t->packets->packet[c->packet];
    int64_t at = packet->first;
    at += m->what == LAR_CARRIES_ALL ? packet->count - packet->whole + c->whole++ : c->added++;
    t->packets->node[at] = t->node;
}

static void visit_nodes(table *t, const lar_sharing *sharing, const lar_schedule_options *options,
                        lar_message_visit *visit) {
    for (t->node = 0; t->node < sharing->node_count; t->node++) {
        const int32_t *set;
        int32_t count = lar_sharing_of(sharing, t->node, &set);
        lar_scheme_messages(options->scheme, options->channels, &sharing->grid, set, count, visit,
                            t);
    }
}

/* ---- empty packets ---------------------------------------------------------------------- */

static bool sends(const table *t, int32_t from, int32_t to) {
    for (int s = 0; s < LAR_STAGES; s++) {
        const cell *c = cell_of(t, from, s, to);
        if (c->added + c->whole > 0 || c->packet == LAR_AT_START) return true;
    }
    return false;
}

/* Where data flows in one direction only, something must flow back (T 6.4). And signals that go
 * from neighbour to neighbour must reach everybody: bodies that do not touch are joined like the
 * nodes of a binary tree, by their first processors. */
static lar_status add_empty(table *t, lar_error *error) {
    int32_t n = t->processors;
    int32_t *parent = lar_calloc((size_t)n * 2, sizeof *parent);
    if (!parent) return lar_fail_memory(error, (size_t)n * 2 * sizeof *parent, "processors");
    int32_t *body = parent + n, bodies = 0;
    lar_union_start(parent, n);
    for (int32_t p = 0; p < n; p++)
        for (int32_t q = p + 1; q < n; q++) {
            bool there = sends(t, p, q), back = sends(t, q, p);
            if (there && !back) cell_of(t, q, 0, p)->packet = LAR_AT_START;
            if (back && !there) cell_of(t, p, 0, q)->packet = LAR_AT_START;
            if (there || back) lar_union_join(parent, p, q);
        }
    for (int32_t p = 0; p < n; p++)
        if (lar_union_root(parent, p) == p) body[bodies++] = p;
    for (int32_t i = 1; i < bodies; i++) {
        cell_of(t, body[i], 0, body[(i - 1) / 2])->packet = LAR_AT_START;
        cell_of(t, body[(i - 1) / 2], 0, body[i])->packet = LAR_AT_START;
    }
    free(parent);
    return LAR_OK;
}

/* ---- the list --------------------------------------------------------------------------- */

static bool is_packet(const cell *c) {
    return c->added + c->whole > 0 || c->packet == LAR_AT_START;
}

static void count_packets(const table *t, lar_packets *out, int64_t *vectors) {
    *vectors = 0;
    for (int32_t from = 0; from < t->processors; from++)
        for (int s = 0; s < LAR_STAGES; s++)
            for (int32_t to = 0; to < t->processors; to++) {
                const cell *c = cell_of(t, from, s, to);
                *vectors += c->added + c->whole;
                out->count += is_packet(c);
            }
}

static void list_packets(const table *t, const lar_grid *grid, lar_packets *out) {
    int32_t count = 0;
    int64_t first = 0;
    for (int32_t from = 0; from < t->processors; from++) {
        out->sent_first[from] = count;
        for (int s = 0; s < LAR_STAGES; s++)
            for (int32_t to = 0; to < t->processors; to++) {
                cell *c = cell_of(t, from, s, to);
                if (!is_packet(c)) continue;
                out->packet[count] =
                    (lar_plan_packet){.from = from,
                                      .to = to,
                                      .stage = s,
                                      .count = c->added + c->whole,
                                      .whole = c->whole,
                                      .distance = lar_grid_distance(grid, from, to),
                                      .onward = c->onward,
                                      .first = first,
                                      .sent_in = LAR_NOWHERE,
                                      .received_in = LAR_NOWHERE};
                first += out->packet[count].count;
                *c = (cell){.packet = count++};
            }
    }
    out->sent_first[t->processors] = count;
}

/* By receiver; a place of its own for each in the receiver's buffer, earlier stages first. */
static void list_received(const table *t, lar_packets *out) {
    int32_t count = 0;
    for (int32_t to = 0; to < t->processors; to++) {
        out->received_first[to] = count;
        for (int s = 0; s < LAR_STAGES; s++)
            for (int32_t from = 0; from < t->processors; from++) {
                int32_t packet = cell_of(t, from, s, to)->packet;
                if (packet == LAR_NOWHERE) continue;
                int64_t bytes = (lar_packet_payload(out->packet[packet].count) + 7) / 8 * 8;
                out->packet[packet].offset = out->room[to];
                out->room[to] += bytes + LAR_TAIL_BYTES + LAR_PACKET_ALIGN - 1;
                out->room[to] -= out->room[to] % LAR_PACKET_ALIGN;
                out->received[count++] = packet;
            }
    }
    out->received_first[t->processors] = count;
}

static lar_status make_lists(table *t, const lar_grid *grid, lar_packets *out, lar_error *error) {
    int64_t vectors;
    size_t n = (size_t)t->processors;
    count_packets(t, out, &vectors);
    out->packet = lar_calloc((size_t)out->count, sizeof *out->packet);
    out->received = lar_calloc((size_t)out->count, sizeof *out->received);
    out->sent_first = lar_calloc(n + 1, sizeof *out->sent_first);
    out->received_first = lar_calloc(n + 1, sizeof *out->received_first);
    out->room = lar_calloc(n, sizeof *out->room);
    out->node = lar_calloc((size_t)vectors, sizeof *out->node);
    if (!out->packet || !out->received || !out->sent_first || !out->received_first || !out->room ||
        !out->node)
        return lar_fail_memory(error, (size_t)vectors * sizeof *out->node, "vectors of packets");
    list_packets(t, grid, out);
    list_received(t, out);
    return LAR_OK;
}

lar_status lar_packets_build(const lar_sharing *sharing, const lar_schedule_options *options,
                             lar_packets *out, lar_error *error) {
    size_t n = (size_t)sharing->grid.count, cells = n * n * LAR_STAGES;
    lar_packets packets = {0};
    table t = {sharing->grid.count, lar_calloc(cells, sizeof(cell)), &packets, 0};
    if (!t.cell) return lar_fail_memory(error, cells * sizeof(cell), "packets");
    for (size_t i = 0; i < cells; i++) t.cell[i].packet = LAR_NOWHERE;
    visit_nodes(&t, sharing, options, count_vector);
    lar_status status = add_empty(&t, error);
    if (status == LAR_OK) status = make_lists(&t, &sharing->grid, &packets, error);
    if (status == LAR_OK) visit_nodes(&t, sharing, options, put_vector);
    free(t.cell);
    if (status == LAR_OK)
        *out = packets;
    else
        lar_packets_clear(&packets);
    return status;
}

void lar_packets_clear(lar_packets *packets) {
    free(packets->packet);
    free(packets->sent_first);
    free(packets->received);
    free(packets->received_first);
    free(packets->node);
    free(packets->room);
    *packets = (lar_packets){0};
}
