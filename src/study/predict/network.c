/* Events are packets that come to a link; between them a thread goes on as far as it can, and a
 * thread that waits is woken by what it waits for. Times of threads run ahead of the events, never
 * behind: whatever a woken thread sends comes to its link later than the event that woke it. */
#include "study/predict/network.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "study/predict/network_wiring.h"

const char *const lar_span_kind_name[LAR_SPAN_KINDS] = {"compute", "exchange", "wait", "link"};

/* How much processors' paces may differ, and for how many steps of how many processors together we
 * look for that: some ten seconds. */
static const double SAME_PACE = 0.0025;
enum { WORK_MAX = 320000 };

/* Where a thread goes on: part of its batch, and which wait, packet or the like of it. */
typedef enum part { RECOVER, WAIT, RECEIVE, POSITIONS, SEND, DONE } part;

typedef struct runner {
    int32_t processor, thread;
    int32_t batch, item; /* within the schedule; of the part */
    part at;
    int32_t step; /* from 1 */
    bool blocked;
    double clock, busy;
} runner;

/* A batch's mark, and a packet's place in each half of the receive buffer. */
typedef struct stamp {
    int32_t step;
    double time;
} stamp;

typedef struct event {
    double time;
    int64_t transfer; /* of the sender */
    bool arriving;    /* at the receiver's link, or leaving by the sender's */
    int8_t half;
    int32_t step;
} event;

typedef struct simulation {
    const lar_network_options *options;
    lar_network_wiring wiring;
    const double *number; /* of the machine */
    int32_t threads, steps;
    runner *runner;                     /* [processors * threads] */
    stamp *mark;                        /* [batches] */
    stamp (*arrived)[2];                /* [transfers] of receivers, by half */
    double *leaving_free, *coming_free; /* [processors] links */
    double *step_end;                   /* [steps + 1] */
    double (*half_end)[2];              /* [processors] of the first half, and of all steps */
    lar_network_span *start;            /* links in the first step; recorded only */
    size_t starts, start_room;
    double link_busy; /* in the steps that count */
    event *heap;
    size_t events, heap_room;
    lar_network_result *result;
    size_t span_room;
    lar_status status;
    lar_error *error;
} simulation;

static void fail(simulation *s, size_t bytes, const char *what) {
    if (!s->status) s->status = lar_fail_memory(s->error, bytes, what);
}

/* Steps that count for means; the first ones do not, because all begin them together. */
static bool counts(const simulation *s, int32_t step) {
    return step > s->steps / 2;
}

/* ---- events: a heap by time ----------------------------------------------------------------- */

static bool before(const event *a, const event *b) {
    if (a->time != b->time) return a->time < b->time;
    if (a->arriving != b->arriving) return a->arriving;
    return a->transfer < b->transfer;
}

static void push(simulation *s, event e) {
    if (!LAR_GROW(s->heap, s->heap_room, s->events)) {
        fail(s, s->events * sizeof e, "packets on their way");
        return;
    }
    size_t i = s->events++;
    for (; i > 0 && before(&e, &s->heap[(i - 1) / 2]); i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = e;
}

static event pop(simulation *s) {
    event first = s->heap[0], last = s->heap[--s->events];
    size_t i = 0;
    for (;;) {
        size_t child = 2 * i + 1;
        if (child >= s->events) break;
        if (child + 1 < s->events && before(&s->heap[child + 1], &s->heap[child])) child++;
        if (!before(&s->heap[child], &last)) break;
        s->heap[i] = s->heap[child];
        i = child;
    }
    s->heap[i] = last;
    return first;
}

/* ---- what is written down ------------------------------------------------------------------- */

static void keep_span(simulation *s, lar_network_span **list, size_t *count, size_t *room,
                      lar_network_span span) {
    if (!s->options->record || span.end <= span.begin) return;
    if (LAR_GROW(*list, *room, *count))
        (*list)[(*count)++] = span;
    else
        fail(s, *count * sizeof span, "the course of a step");
}

static void record(simulation *s, int32_t processor, int32_t thread, lar_span_kind kind,
                   int32_t peer, double begin, double end) {
    lar_network_result *r = s->result;
    keep_span(s, &r->span, &r->span_count, &s->span_room,
              (lar_network_span){processor, thread, kind, peer, begin, end});
}

/* A thread does something until a moment. */
static void pass(simulation *s, runner *t, lar_span_kind kind, double until) {
    lar_network_processor *of = &s->result->of[t->processor];
    if (until <= t->clock) return;
    if (counts(s, t->step))
        *(kind == LAR_SPAN_COMPUTE ? &of->compute
          : kind == LAR_SPAN_WAIT  ? &of->wait
                                   : &of->exchange) += until - t->clock;
    if (t->step + 2 >= s->steps) record(s, t->processor, t->thread, kind, -1, t->clock, until);
    t->clock = until;
}

/* ---- threads -------------------------------------------------------------------------------- */

static int64_t packet_bytes(const lar_transfer *t) {
    return lar_packet_payload(t->vectors.count) + LAR_TAIL_BYTES;
}

static void send(simulation *s, runner *t, const lar_schedule *schedule, int32_t i) {
    const lar_transfer *packet = &schedule->transfer[i];
    double bytes = (double)packet_bytes(packet), vectors = packet->vectors.count;
    lar_network_processor *of = &s->result->of[t->processor];
    pass(s, t, LAR_SPAN_EXCHANGE,
         t->clock + s->number[LAR_CLUSTER_OVERHEAD] + bytes * s->number[LAR_CLUSTER_BYTE] +
             vectors * s->threads * s->number[LAR_CLUSTER_VECTOR]);
    if (counts(s, t->step)) {
        of->packets++;
        of->bytes_sent += packet_bytes(packet);
    }
    push(s, (event){t->clock, s->wiring.transfer_first[t->processor] + i, false,
                    (int8_t)(t->step & 1), t->step});
}

/* False: has to wait. */
static bool receive(simulation *s, runner *t, const lar_schedule *schedule, int32_t i) {
    const lar_transfer *packet = &schedule->transfer[i];
    const stamp *there = &s->arrived[s->wiring.transfer_first[t->processor] + i][t->step & 1];
    if (there->step != t->step) return false;
    pass(s, t, LAR_SPAN_WAIT, there->time);
    pass(s, t, LAR_SPAN_EXCHANGE,
         t->clock + s->number[LAR_CLUSTER_RECEIVE] +
             packet->vectors.count * s->number[LAR_CLUSTER_VECTOR]);
    if (counts(s, t->step)) s->result->of[t->processor].bytes_received += packet_bytes(packet);
    return true;
}

static bool await(simulation *s, runner *t, int32_t batch) {
    const stamp *mark = &s->mark[s->wiring.batch_first[t->processor] + batch];
    if (mark->step < t->step) return false;
    if (mark->step == t->step) pass(s, t, LAR_SPAN_WAIT, mark->time + s->number[LAR_CLUSTER_JOIN]);
    return true;
}

static void end_step(simulation *s, runner *t, const lar_schedule *schedule) {
    s->step_end[t->step] = fmax(s->step_end[t->step], t->clock);
    if (t->step == s->steps / 2 || t->step == s->steps) {
        double *end = &s->half_end[t->processor][t->step == s->steps];
        *end = fmax(*end, t->clock);
    }
    t->batch = schedule->thread_first[t->thread];
    t->at = t->step++ == s->steps ? DONE : RECOVER;
    if (t->at != DONE) pass(s, t, LAR_SPAN_COMPUTE, t->clock + s->number[LAR_CLUSTER_STEP]);
}

/* One thing that a thread does. False: it waits, or is at its end. */
static bool go_on(simulation *s, runner *t) {
    const lar_schedule *schedule = s->wiring.schedule[t->processor];
    if (t->at == DONE) return false;
    if (t->batch == schedule->thread_first[t->thread + 1]) {
        end_step(s, t, schedule);
        return true;
    }
    const lar_batch *b = &schedule->batch[t->batch];
    const lar_range *items[] = {NULL, &b->waits, &b->receives, NULL, &b->sends};
    const lar_range *list = items[t->at];
    if (list && t->item < list->count) {
        int32_t i = list->first + t->item;
        if (t->at == WAIT && !await(s, t, schedule->wait[i])) return false;
        if (t->at == RECEIVE && !receive(s, t, schedule, i)) return false;
        if (t->at == SEND) send(s, t, schedule, i);
        t->item++;
        return true;
    }
    if (t->at == RECOVER)
        pass(s, t, LAR_SPAN_COMPUTE, t->clock + b->elements.count * s->number[LAR_CLUSTER_ELEMENT]);
    if (t->at == POSITIONS)
        pass(s, t, LAR_SPAN_COMPUTE, t->clock + b->positions.count * s->number[LAR_CLUSTER_NODE]);
    t->item = 0;
    if (t->at++ == SEND) {
        s->mark[s->wiring.batch_first[t->processor] + t->batch++] = (stamp){t->step, t->clock};
        t->at = RECOVER;
    }
    return true;
}

/* All threads of a processor as far as they get: marks wake the others. */
static void run_processor(simulation *s, int32_t processor) {
    runner *first = s->runner + (size_t)processor * (size_t)s->threads;
    for (bool moved = true; moved && !s->status;) {
        moved = false;
        for (int32_t t = 0; t < s->threads; t++)
            while (!s->status && go_on(s, first + t)) moved = true;
    }
}

/* ---- packets -------------------------------------------------------------------------------- */

/* A link takes the packet as soon as it is free, and is busy for the gap and the bytes. Returns
 * when it began. */
static double occupy(const simulation *s, double *free_at, double time, int64_t bytes) {
    double begin = fmax(time, *free_at);
    *free_at =
        begin + s->number[LAR_CLUSTER_GAP] + (double)bytes / s->number[LAR_CLUSTER_BANDWIDTH];
    return begin;
}

static void leave(simulation *s, event e) {
    int32_t from = lar_wiring_processor(&s->wiring, e.transfer);
    const lar_transfer *packet = lar_wiring_transfer(&s->wiring, from, e.transfer);
    int64_t to = s->wiring.partner[e.transfer];
    double begin = occupy(s, &s->leaving_free[from], e.time, packet_bytes(packet));
    if (counts(s, e.step)) s->link_busy += s->leaving_free[from] - begin;
    const lar_network_span span = {from,          -1,
                                   LAR_SPAN_LINK, lar_wiring_processor(&s->wiring, to),
                                   begin,         s->leaving_free[from]};
    if (e.step == 1) keep_span(s, &s->start, &s->starts, &s->start_room, span);
    if (e.step + 2 >= s->steps)
        keep_span(s, &s->result->span, &s->result->span_count, &s->span_room, span);
    e.time = begin + s->number[LAR_CLUSTER_LATENCY];
    e.arriving = true;
    push(s, e);
}

/* The head of a packet is there; its tail is seen when all bytes are through. */
static void arrive(simulation *s, event e) {
    int32_t from = lar_wiring_processor(&s->wiring, e.transfer);
    int64_t place = s->wiring.partner[e.transfer];
    int32_t to = lar_wiring_processor(&s->wiring, place);
    int64_t bytes = packet_bytes(lar_wiring_transfer(&s->wiring, from, e.transfer));
    double begin = occupy(s, &s->coming_free[to], e.time, bytes);
    s->arrived[place][e.half] =
        (stamp){e.step, begin + (double)bytes / s->number[LAR_CLUSTER_BANDWIDTH]};
    run_processor(s, to);
}

/* ---- the result ----------------------------------------------------------------------------- */

/* Spans of the last step but one, cut to it, in time from its beginning: the moment in which the
 * last thread ended the step before. The last step still runs beside it as all others did. */
static void cut_spans(simulation *s) {
    lar_network_result *r = s->result;
    double begin = s->step_end[s->steps - 2], length = s->step_end[s->steps - 1] - begin;
    size_t kept = 0;
    for (size_t i = 0; i < r->span_count; i++) {
        lar_network_span span = r->span[i];
        span.begin = fmax(0, span.begin - begin);
        span.end = fmin(length, span.end - begin);
        if (span.end > span.begin) r->span[kept++] = span;
    }
    r->span_count = kept;
}

/* The share of the links that is busy in each of `slices` parts of 0..length. */
static void slice_links(const lar_network_span *span, size_t spans, int32_t processors,
                        double length, double *share, int slices) {
    double slice = length / slices;
    for (size_t i = 0; i < spans; i++)
        for (int k = 0; span[i].kind == LAR_SPAN_LINK && k < slices; k++) {
            double both = fmin(span[i].end, slice * (k + 1)) - fmax(span[i].begin, slice * k);
            if (both > 0) share[k] += both / slice / processors;
        }
}

/* Every processor's own pace, and whether all have the same (network.h). */
static void compare_paces(simulation *s) {
    lar_network_result *r = s->result;
    r->fastest = INFINITY;
    for (int32_t p = 0; p < r->processors; p++) {
        double pace = (s->half_end[p][1] - s->half_end[p][0]) / (s->steps - s->steps / 2);
        r->fastest = fmin(r->fastest, pace);
        r->slowest = fmax(r->slowest, pace);
    }
    r->settled = r->slowest - r->fastest <= SAME_PACE * r->slowest;
}

static void finish(simulation *s) {
    lar_network_result *r = s->result;
    int32_t half = s->steps / 2, counted = s->steps - half;
    r->step = (s->step_end[s->steps] - s->step_end[half]) / counted;
    r->occupation = r->step > 0 ? s->link_busy / counted / r->step / r->processors : 0;
    for (int32_t p = 0; p < r->processors; p++) {
        lar_network_processor *of = &r->of[p];
        of->compute /= counted;
        of->exchange /= counted;
        of->wait /= counted;
        of->packets /= counted;
        of->bytes_sent /= counted;
        of->bytes_received /= counted;
    }
    r->steps = s->steps;
    r->start_step = s->step_end[1];
    compare_paces(s);
    if (!s->options->record) return;
    slice_links(s->start, s->starts, r->processors, r->start_step, r->start_slice,
                LAR_NETWORK_START_SLICES);
    cut_spans(s);
    slice_links(r->span, r->span_count, r->processors,
                s->step_end[s->steps - 1] - s->step_end[s->steps - 2], r->slice,
                LAR_NETWORK_SLICES);
}

static lar_status check_end(simulation *s) {
    for (int32_t i = 0; i < s->result->processors * s->threads && !s->status; i++)
        if (s->runner[i].at != DONE)
            s->status = lar_fail(s->error, LAR_ERROR_FORMAT,
                                 "processor %d waits for ever in batch %d of its schedule; make "
                                 "the schedules anew with lariat partition",
                                 (int)s->runner[i].processor, (int)s->runner[i].batch);
    return s->status;
}

static lar_status run(simulation *s) {
    for (int32_t p = 0; p < s->result->processors && !s->status; p++) run_processor(s, p);
    while (s->events > 0 && !s->status) {
        event e = pop(s);
        if (e.arriving)
            arrive(s, e);
        else
            leave(s, e);
    }
    if (!check_end(s)) finish(s);
    return s->status;
}

static lar_status prepare(simulation *s) {
    lar_network_result *r = s->result;
    size_t processors = (size_t)s->wiring.processors, threads = (size_t)s->threads;
    memcpy(r->grid, s->wiring.grid, sizeof r->grid);
    r->processors = s->wiring.processors;
    r->threads = s->threads;
    r->of = lar_calloc(processors, sizeof *r->of);
    s->runner = lar_calloc(processors * threads, sizeof *s->runner);
    s->mark = lar_calloc((size_t)s->wiring.batch_first[processors], sizeof *s->mark);
    s->arrived = lar_calloc((size_t)s->wiring.transfer_first[processors], sizeof *s->arrived);
    s->leaving_free = lar_calloc(processors, sizeof(double));
    s->coming_free = lar_calloc(processors, sizeof(double));
    s->step_end = lar_calloc((size_t)s->steps + 1, sizeof(double));
    s->half_end = lar_calloc(processors, sizeof *s->half_end);
    if (!r->of || !s->runner || !s->mark || !s->arrived || !s->leaving_free || !s->coming_free ||
        !s->step_end || !s->half_end)
        return lar_fail_memory(s->error, processors * threads * sizeof *s->runner,
                               "the processors of a prediction");
    for (size_t p = 0; p < processors; p++)
        for (size_t t = 0; t < threads; t++) {
            runner *one = &s->runner[p * threads + t];
            *one = (runner){.processor = (int32_t)p, .thread = (int32_t)t, .step = 1};
            one->batch = s->wiring.schedule[p]->thread_first[t];
            pass(s, one, LAR_SPAN_COMPUTE, s->number[LAR_CLUSTER_STEP]);
        }
    return LAR_OK;
}

static lar_status simulate(const lar_network_options *options, int32_t steps,
                           lar_network_result *result, lar_error *error) {
    lar_network_result made = {0};
    simulation s = {.options = options,
                    .number = options->machine->number,
                    .threads = options->schedules->of[0].threads,
                    .steps = steps,
                    .result = &made,
                    .error = error};
    s.status = lar_cluster_check(options->machine, error);
    if (!s.status) s.status = lar_wiring_make(options, &s.wiring, error);
    if (!s.status) s.status = prepare(&s);
    if (!s.status) run(&s);
    free(s.runner);
    free(s.mark);
    free(s.arrived);
    free(s.leaving_free);
    free(s.coming_free);
    free(s.step_end);
    free(s.half_end);
    free(s.start);
    free(s.heap);
    lar_wiring_clear(&s.wiring);
    if (s.status)
        lar_network_clear(&made);
    else
        *result = made;
    return s.status;
}

lar_status lar_network_simulate(const lar_network_options *options, lar_network_result *result,
                                lar_error *error) {
    lar_network_result made = {0};
    int32_t steps = options->steps ? options->steps : LAR_NETWORK_STEPS_MIN;
    if (steps < 2 || steps > LAR_NETWORK_STEPS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%d steps; take 2 to %d", (int)steps,
                        LAR_NETWORK_STEPS_MAX);
    lar_status status = simulate(options, steps, &made, error);
    while (!status && !options->steps && !made.settled) {
        steps *= 2;
        if (steps > LAR_NETWORK_STEPS_MAX || steps > WORK_MAX / made.processors) break;
        lar_network_clear(&made);
        status = simulate(options, steps, &made, error);
    }
    if (!status) *result = made;
    return status;
}

void lar_network_clear(lar_network_result *result) {
    free(result->of);
    free(result->span);
    *result = (lar_network_result){0};
}
