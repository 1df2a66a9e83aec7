/* Reading schedules; what the files look like is in docs/formats.md. Everything in them is checked
 * here as far as one file and the mesh can tell, so that whoever uses a schedule may index by it.
 */
#include "divide/schedule/file.h"

#include <inttypes.h>
#include <stdlib.h>

#include "divide/text_file.h"

enum {
    VERSION = 1,
    MINIMUM_BATCH = 8, /* "batch 0\n" */
    MINIMUM_NUMBER = 2 /* "0\n" */
};
/* No buffer is larger: sums of offsets and sizes stay far from overflow. */
static const int64_t offset_max = INT64_C(1) << 40;

/* A packet's place in a buffer: in ours, or in that of the peer. */
typedef struct place {
    bool received;
    int32_t peer, stage;
    int64_t offset, end;
    int line;
} place;

typedef struct reader {
    lar_text_file file;
    const lar_mesh *mesh;
    lar_schedule s;
    size_t batch_room, element_room, wait_room, transfer_room, node_room, vector_room, place_room;

    uint8_t *recovered;         /* [elements of the mesh] */
    int *moved;                 /* [nodes of the mesh] line, 0: not yet */
    int32_t *carried;           /* [nodes of the mesh] 1 + the last transfer with it */
    int32_t *awaited;           /* [batch_count] 1 + the last batch that waits for it */
    place *place;               /* [transfer_count] */
    int32_t own_first, own_end; /* batches of this thread */
    int room_line;              /* where receive-bytes stands */
} reader;

/* One sentence with file and line. */
#define REFUSE(r, ...) lar_text_file_refuse(&(r)->file, (r)->file.number, __VA_ARGS__)
#define SHOWN(r)       lar_text_file_shown((r)->file.word_length), (r)->file.word

static lar_status no_memory(const reader *r) {
    return lar_fail_memory(r->file.error, (size_t)(r->file.end - r->file.at), r->file.path);
}

/* ---- words: the one that comes next is always read already -------------------------------- */

static lar_status advance(reader *r) {
    return lar_text_file_word(&r->file);
}

static bool next_is(const reader *r, const char *word) {
    return lar_text_file_is(&r->file, word);
}

static lar_status expect(reader *r, const char *word) {
    if (next_is(r, word)) return advance(r);
    return REFUSE(r, "here must stand '%s', not '%.*s'; see docs/formats.md", word, SHOWN(r));
}

/* The next word as a number; it stays the next word, so that refusals name its line. */
static lar_status number(const reader *r, const char *what, int64_t min, int64_t max,
                         int64_t *value) {
    if (!lar_text_file_int64(&r->file, value))
        return REFUSE(r, "here must stand a number, %s, not '%.*s'; see docs/formats.md", what,
                      SHOWN(r));
    if (*value < min || *value > max)
        return REFUSE(r, "%s is %" PRId64 " here, but must lie between %" PRId64 " and %" PRId64,
                      what, *value, min, max);
    return LAR_OK;
}

/* ---- head -------------------------------------------------------------------------------- */

static lar_status head_number(reader *r, const char *key, int64_t min, int64_t max,
                              int64_t *value) {
    lar_status status = lar_text_file_key(&r->file, key);
    return status ? status : number(r, key, min, max, value);
}

static lar_status head_name(reader *r, const char *key, const char *const *names, int count,
                            int *value) {
    lar_status status = lar_text_file_key(&r->file, key);
    if (status) return status;
    char known[128];
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        if (next_is(r, names[i])) {
            *value = i;
            return LAR_OK;
        }
        used +=
            (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", names[i]);
    }
    return REFUSE(r, "the %s '%.*s' is not known; there are %s", key, SHOWN(r), known);
}

static lar_status head_bits(reader *r, const char *key, uint64_t *value) {
    lar_status status = lar_text_file_key(&r->file, key);
    if (!status && !lar_text_file_hexadecimal(&r->file, value))
        return REFUSE(r, "behind '%s' stand 16 hexadecimal digits, not '%.*s'", key, SHOWN(r));
    return status;
}

static lar_status read_head(reader *r) {
    lar_schedule *s = &r->s;
    int64_t processor = 0, threads = 0, batches = 0;
    int scheme = 0, channels = 0;
    lar_status status = lar_text_file_version(&r->file, VERSION);
    if (!status) status = lar_text_file_grid(&r->file, &s->grid);
    if (!status) status = head_number(r, "processor", 0, s->grid.count - 1, &processor);
    if (!status) status = head_number(r, "threads", 1, LAR_THREADS_MAX, &threads);
    if (!status) status = head_name(r, "scheme", lar_scheme_name, LAR_SCHEMES, &scheme);
    if (!status)
        status = head_name(r, "channels", lar_channel_use_name, LAR_CHANNEL_USES, &channels);
    if (!status) status = head_bits(r, "mesh", &s->mesh);
    if (!status) status = lar_text_file_mesh(&r->file, s->mesh, r->mesh);
    if (!status) status = head_bits(r, "division", &s->division);
    if (!status) status = head_number(r, "receive-bytes", 0, offset_max, &s->receive_bytes);
    r->room_line = r->file.number;
    if (!status && s->receive_bytes % LAR_PACKET_ALIGN != 0)
        status = REFUSE(r, "receive-bytes is %" PRId64 ", but must be a multiple of %d",
                        s->receive_bytes, LAR_PACKET_ALIGN);
    if (!status) status = head_number(r, "batches", 1, INT32_MAX, &batches);
    if (status) return status;
    if (!lar_claim_fits((unsigned long long)batches, MINIMUM_BATCH,
                        (size_t)(r->file.end - r->file.at)))
        return REFUSE(r, "the file is too short for %" PRId64 " batches; count them again",
                      batches);
    s->processor = (int32_t)processor;
    s->threads = (int32_t)threads;
    s->scheme = (lar_scheme)scheme;
    s->channels = (lar_channel_use)channels;
    s->thread_first[threads] = (int32_t)batches;
    r->awaited = lar_calloc((size_t)batches, sizeof *r->awaited);
    return r->awaited ? LAR_OK : no_memory(r);
}

/* ---- lists of numbers ---------------------------------------------------------------------- */

/* What a list holds, and whether one more number may follow `before` (-1 at the beginning). */
typedef struct list {
    const char *what;
    int32_t limit; /* numbers are below it */
    int32_t **array, *used;
    size_t *room;
    lar_status (*accept)(reader *r, int32_t before, int32_t value);
} list;

/* "COUNT NUMBER NUMBER ...", over any number of lines, to the end of an array. */
static lar_status read_list(reader *r, const list *l, lar_range *out) {
    int64_t count, value;
    lar_status status = number(r, "a count", 1, INT32_MAX, &count);
    if (status) return status;
    if (!lar_claim_fits((unsigned long long)count, MINIMUM_NUMBER,
                        (size_t)(r->file.end - r->file.word)))
        return REFUSE(r, "the file is too short for %" PRId64 " numbers; count them again", count);
    status = advance(r);
    *out = (lar_range){*l->used, (int32_t)count};
    int32_t before = -1;
    for (int64_t i = 0; i < count && !status; i++) {
        status = number(r, l->what, 0, l->limit - 1, &value);
        if (!status) status = l->accept(r, before, (int32_t)value);
        if (status) return status;
        if (!lar_grow_array(l->array, l->room, (size_t)*l->used, sizeof **l->array))
            return no_memory(r);
        (*l->array)[(*l->used)++] = before = (int32_t)value;
        status = advance(r);
    }
    return status;
}

static lar_status ascending(const reader *r, const char *what, int32_t before, int32_t value) {
    if (value > before) return LAR_OK;
    return REFUSE(r, "%s %d stands behind %s %d; they ascend, each once", what, (int)value, what,
                  (int)before);
}

static lar_status accept_element(reader *r, int32_t before, int32_t e) {
    if (r->recovered[e] && e != before)
        return REFUSE(r, "element %d is recovered already; remove one of both", (int)e);
    r->recovered[e] = 1;
    return ascending(r, "element", before, e);
}

static lar_status accept_moved(reader *r, int32_t before, int32_t n) {
    if (r->moved[n] && n != before)
        return REFUSE(r, "node %d moves in line %d already; remove one of both", (int)n,
                      r->moved[n]);
    r->moved[n] = r->file.number;
    return ascending(r, "node", before, n);
}

static lar_status accept_wait(reader *r, int32_t before, int32_t batch) {
    (void)before;
    if (batch >= r->own_first && batch < r->own_end)
        return REFUSE(r,
                      "batch %d is of this thread, which has %d to %d; waits are for those of "
                      "other threads, remove it",
                      (int)batch, (int)r->own_first, (int)r->own_end - 1);
    if (r->awaited[batch] == r->s.batch_count)
        return REFUSE(r, "batch %d is waited for already; remove one of both", (int)batch);
    r->awaited[batch] = r->s.batch_count;
    return LAR_OK;
}

static lar_status accept_whole(reader *r, int32_t before, int32_t n) {
    (void)before;
    if (r->carried[n] == r->s.transfer_count + 1)
        return REFUSE(r, "node %d is in this packet already; remove one of both", (int)n);
    r->carried[n] = r->s.transfer_count + 1;
    return LAR_OK;
}

static lar_status accept_added(reader *r, int32_t before, int32_t n) {
    lar_status status = ascending(r, "node", before, n);
    return status ? status : accept_whole(r, before, n);
}

/* ---- parts of a batch ---------------------------------------------------------------------- */

static lar_status read_elements(reader *r, lar_batch *b) {
    list l = {"an element",        r->mesh->element_count, &r->s.element,
              &r->s.element_count, &r->element_room,       accept_element};
    return read_list(r, &l, &b->elements);
}

static lar_status read_waits(reader *r, lar_batch *b) {
    list l = {"a batch",     r->s.thread_first[r->s.threads],
              &r->s.wait,    &r->s.wait_count,
              &r->wait_room, accept_wait};
    return read_list(r, &l, &b->waits);
}

static lar_status read_positions(reader *r, lar_batch *b) {
    list l = {"a node",         r->mesh->node_count, &r->s.node,
              &r->s.node_count, &r->node_room,       accept_moved};
    return read_list(r, &l, &b->positions);
}

/* The nodes of a packet: "add COUNT ..." and "whole COUNT ...", both optional. */
static lar_status read_vectors(reader *r, lar_transfer *t) {
    list l = {"a node",           r->mesh->node_count, &r->s.vector,
              &r->s.vector_count, &r->vector_room,     accept_added};
    lar_range added = {r->s.vector_count, 0}, whole = {0};
    lar_status status = LAR_OK;
    if (next_is(r, "add")) {
        status = advance(r);
        if (!status) status = read_list(r, &l, &added);
    }
    if (!status && next_is(r, "whole")) {
        l.accept = accept_whole;
        status = advance(r);
        if (!status) status = read_list(r, &l, &whole);
    }
    t->whole = whole.count;
    t->vectors = (lar_range){added.first, added.count + whole.count};
    return status;
}

/* "PEER stage STAGE offset OFFSET". */
static lar_status read_address(reader *r, lar_transfer *t) {
    int64_t peer = 0, stage = 0;
    lar_status status = number(r, "a processor", 0, r->s.grid.count - 1, &peer);
    if (!status && peer == r->s.processor)
        status =
            REFUSE(r, "processor %d cannot exchange packets with itself; remove them", (int)peer);
    if (!status) status = advance(r);
    if (!status) status = expect(r, "stage");
    if (!status) status = number(r, "a stage", 0, LAR_STAGES - 1, &stage);
    if (!status) status = advance(r);
    if (!status) status = expect(r, "offset");
    if (!status) status = number(r, "an offset", 0, offset_max, &t->offset);
    if (!status && t->offset % LAR_PACKET_ALIGN != 0)
        status = REFUSE(r, "the offset %" PRId64 " is no multiple of %d; packets begin at those",
                        t->offset, LAR_PACKET_ALIGN);
    if (!status) status = advance(r);
    t->peer = (int32_t)peer;
    t->stage = (int32_t)stage;
    return status;
}

static lar_status read_transfer(reader *r, bool received, lar_range *span) {
    lar_transfer t = {0};
    int line = r->file.number;
    lar_status status = read_address(r, &t);
    if (!status) status = read_vectors(r, &t);
    if (status) return status;
    int64_t end = t.offset + lar_packet_payload(t.vectors.count) + LAR_TAIL_BYTES;
    if (received && end > r->s.receive_bytes)
        return lar_text_file_refuse(&r->file, line,
                                    "the packet reaches to byte %" PRId64 ", but receive-bytes is "
                                    "%" PRId64 "; give it another offset or more room",
                                    end, r->s.receive_bytes);
    int32_t i = r->s.transfer_count;
    if (!LAR_GROW(r->s.transfer, r->transfer_room, i) || !LAR_GROW(r->place, r->place_room, i))
        return no_memory(r);
    r->s.transfer[i] = t;
    r->place[i] = (place){received, t.peer, t.stage, t.offset, end, line};
    r->s.transfer_count++;
    if (span->count++ == 0) span->first = i;
    return LAR_OK;
}

static lar_status read_receive(reader *r, lar_batch *b) {
    return read_transfer(r, true, &b->receives);
}

static lar_status read_send(reader *r, lar_batch *b) {
    return read_transfer(r, false, &b->sends);
}

/* ---- threads and batches ------------------------------------------------------------------- */

/* The parts of a batch in their order; only packets may be several. */
static const struct {
    const char *key;
    lar_status (*read)(reader *r, lar_batch *b);
    bool several;
} parts[] = {{"recover", read_elements, false},
             {"wait", read_waits, false},
             {"receive", read_receive, true},
             {"move", read_positions, false},
             {"send", read_send, true}};
enum { PARTS = sizeof parts / sizeof *parts };

static lar_status read_parts(reader *r, lar_batch *b) {
    for (int done = -1;;) {
        int part = 0;
        while (part < PARTS && !next_is(r, parts[part].key)) part++;
        if (part == PARTS) return LAR_OK;
        if (part < done || (part == done && !parts[part].several))
            return REFUSE(r,
                          "the parts of a batch are recover, wait, receive, move, send, in this "
                          "order; put '%s' where it belongs",
                          parts[part].key);
        done = part;
        lar_status status = advance(r);
        if (!status) status = parts[part].read(r, b);
        if (status) return status;
    }
}

/* "batch NUMBER" and its parts. */
static lar_status read_batch(reader *r) {
    int32_t i = r->s.batch_count;
    int64_t claimed;
    if (!next_is(r, "batch"))
        return REFUSE(r,
                      "here must stand 'batch %d' or a part of a batch, not '%.*s'; count again "
                      "what stands before",
                      (int)i, SHOWN(r));
    lar_status status = advance(r);
    if (!status) status = number(r, "the number of this batch", i, i, &claimed);
    if (!status) status = advance(r);
    if (status) return status;
    if (!LAR_GROW(r->s.batch, r->batch_room, i)) return no_memory(r);
    r->s.batch_count++;
    lar_batch b = {.elements.first = r->s.element_count,
                   .waits.first = r->s.wait_count,
                   .receives.first = r->s.transfer_count,
                   .positions.first = r->s.node_count,
                   .sends.first = r->s.transfer_count};
    status = read_parts(r, &b);
    r->s.batch[i] = b;
    return status;
}

/* "thread NUMBER batches COUNT" and the batches. */
static lar_status read_thread(reader *r, int32_t thread) {
    int64_t claimed, count = 0;
    int32_t first = r->s.batch_count;
    lar_status status = expect(r, "thread");
    if (!status) status = number(r, "the number of this thread", thread, thread, &claimed);
    if (!status) status = advance(r);
    if (!status) status = expect(r, "batches");
    if (!status)
        status =
            number(r, "its count of batches", 0, r->s.thread_first[r->s.threads] - first, &count);
    if (!status) status = advance(r);
    if (status) return status;
    r->s.thread_first[thread] = r->own_first = first;
    r->own_end = first + (int32_t)count;
    while (!status && r->s.batch_count < r->own_end) status = read_batch(r);
    return status;
}

static lar_status read_threads(reader *r) {
    lar_status status = advance(r);
    for (int32_t t = 0; t < r->s.threads && !status; t++) status = read_thread(r, t);
    if (status) return status;
    if (!next_is(r, "end"))
        return REFUSE(r,
                      "here must stand 'end' or a part of a batch, not '%.*s'; count again what "
                      "stands before",
                      SHOWN(r));
    if (r->s.batch_count != r->s.thread_first[r->s.threads])
        return REFUSE(r,
                      "the threads have %d batches together, not the %d of the head; count "
                      "them again",
                      (int)r->s.batch_count, (int)r->s.thread_first[r->s.threads]);
    return LAR_OK;
}

/* ---- what only the whole file shows --------------------------------------------------------- */

/* Nodes that move, or travel, are those of the elements here, and all of them move. */
static lar_status check_nodes(const reader *r, int end) {
    const lar_schedule *s = &r->s;
    if (s->element_count == 0)
        return lar_text_file_refuse(&r->file, end,
                                    "processor %d recovers no element; give it some or choose a "
                                    "smaller grid",
                                    (int)s->processor);
    uint8_t *here = lar_calloc((size_t)r->mesh->node_count, 1);
    if (!here) return lar_fail_memory(r->file.error, (size_t)r->mesh->node_count, r->file.path);
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < s->element_count && !status; i++)
        for (int a = 0; a < 8 && !status; a++) {
            int32_t n = r->mesh->element[s->element[i]][a];
            here[n] = 1;
            if (!r->moved[n])
                status = lar_text_file_refuse(&r->file, end,
                                              "node %d of element %d never moves; add it to a "
                                              "'move'",
                                              (int)n, (int)s->element[i]);
        }
    for (int32_t i = 0; i < s->node_count && !status; i++)
        if (!here[s->node[i]])
            status = lar_text_file_refuse(&r->file, r->moved[s->node[i]],
                                          "node %d moves, but no element here has it; remove it",
                                          (int)s->node[i]);
    for (int32_t i = 0; i < s->transfer_count && !status; i++)
        for (int32_t j = 0; j < s->transfer[i].vectors.count && !status; j++) {
            int32_t n = s->vector[s->transfer[i].vectors.first + j];
            if (!here[n])
                status = lar_text_file_refuse(&r->file, r->place[i].line,
                                              "node %d is in this packet, but no element here has "
                                              "it; remove it",
                                              (int)n);
        }
    free(here);
    return status;
}

static int compare(int64_t a, int64_t b) {
    return (a > b) - (a < b);
}

static int by_name(const void *a, const void *b) {
    const place *p = a, *q = b;
    int order = compare(p->received, q->received);
    if (!order) order = compare(p->peer, q->peer);
    if (!order) order = compare(p->stage, q->stage);
    return order ? order : compare(p->line, q->line);
}

/* By buffer: ours first, then those of the peers. */
static int by_place(const void *a, const void *b) {
    const place *p = a, *q = b;
    int order = compare(q->received, p->received);
    if (!order && !p->received) order = compare(p->peer, q->peer);
    if (!order) order = compare(p->offset, q->offset);
    return order ? order : compare(p->line, q->line);
}

/* Sender, receiver and stage name one packet, and its bytes are its own. */
static lar_status check_packets(const reader *r) {
    place *p = r->place;
    int32_t count = r->s.transfer_count;
    if (count > 1) qsort(p, (size_t)count, sizeof *p, by_name);
    for (int32_t i = 1; i < count; i++)
        if (p[i].received == p[i - 1].received && p[i].peer == p[i - 1].peer &&
            p[i].stage == p[i - 1].stage)
            return lar_text_file_refuse(&r->file, p[i].line,
                                        "there is a packet of stage %d %s processor %d in line %d "
                                        "already; join them or remove one",
                                        (int)p[i].stage, p[i].received ? "from" : "to",
                                        (int)p[i].peer, p[i - 1].line);
    if (count > 1) qsort(p, (size_t)count, sizeof *p, by_place);
    for (int32_t i = 1; i < count; i++)
        if (p[i].received == p[i - 1].received && (p[i].received || p[i].peer == p[i - 1].peer) &&
            p[i].offset < p[i - 1].end)
            return lar_text_file_refuse(&r->file, p[i].line,
                                        "the packet lies over that of line %d, which reaches to "
                                        "byte %" PRId64 "; give it another offset",
                                        p[i - 1].line, p[i - 1].end);
    return LAR_OK;
}

/* Gaps between packets are fine, but a buffer that is mostly gap is a mistake that costs memory. */
static lar_status check_room(const reader *r) {
    int64_t needed = 0;
    for (int32_t i = 0; i < r->s.transfer_count; i++) {
        int64_t bytes = r->place[i].end - r->place[i].offset + LAR_PACKET_ALIGN - 1;
        if (r->place[i].received) needed += bytes - bytes % LAR_PACKET_ALIGN;
    }
    if (r->s.receive_bytes / 2 <= needed) return LAR_OK;
    return lar_text_file_refuse(&r->file, r->room_line,
                                "receive-bytes is %" PRId64 ", but %" PRId64
                                " hold all packets; put them closer together",
                                r->s.receive_bytes, needed);
}

static lar_status read_everything(reader *r) {
    lar_status status = read_head(r);
    if (!status) status = read_threads(r);
    int end = r->file.number;
    if (!status) status = lar_text_file_done(&r->file);
    if (!status) status = check_nodes(r, end);
    if (!status) status = check_packets(r);
    if (!status) status = check_room(r);
    return status;
}

lar_status lar_schedule_parse(const char *path, const lar_bytes *bytes, const lar_mesh *mesh,
                              lar_schedule *out, lar_error *error) {
    reader r = {.file = lar_text_file_from("schedule", path, bytes, error), .mesh = mesh};
    if (bytes->size > INT32_MAX)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:1: the file is larger than 2 GiB; choose a larger grid", path);
    r.recovered = lar_calloc((size_t)mesh->element_count, sizeof *r.recovered);
    r.moved = lar_calloc((size_t)mesh->node_count, sizeof *r.moved);
    r.carried = lar_calloc((size_t)mesh->node_count, sizeof *r.carried);
    lar_status status = r.recovered && r.moved && r.carried ? LAR_OK : no_memory(&r);
    if (!status) status = read_everything(&r);
    free(r.recovered);
    free(r.moved);
    free(r.carried);
    free(r.awaited);
    free(r.place);
    if (status)
        lar_schedule_clear(&r.s);
    else
        *out = r.s;
    return status;
}

lar_status lar_schedule_read(const char *path, const lar_mesh *mesh, lar_schedule *out,
                             lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (!status) status = lar_schedule_parse(path, &bytes, mesh, out, error);
    lar_bytes_free(&bytes);
    return status;
}
