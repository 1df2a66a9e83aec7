#include "parallel/processor.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "contact/tool_friction.h"
#include "parallel/contact_exchange.h"
#include "parallel/thread_reduction.h"
#include "step/viscous_history.h"

/* Who does what, by global element and node, while a schedule is compiled. */
typedef struct assignment {
    int32_t *thread, *batch; /* [elements] */
    int32_t *owner, *loads;  /* [nodes] */
    bool *counted;           /* [nodes] */
} assignment;

static void clear_assignment(assignment *a) {
    free(a->thread);
    free(a->batch);
    free(a->owner);
    free(a->loads);
    free(a->counted);
}

static lar_status allocate_assignment(assignment *a, const lar_mesh *mesh, lar_error *error) {
    size_t elements = (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
    *a = (assignment){.thread = lar_calloc(elements, sizeof *a->thread),
                      .batch = lar_calloc(elements, sizeof *a->batch),
                      .owner = lar_calloc(nodes, sizeof *a->owner),
                      .loads = lar_calloc(nodes, sizeof *a->loads),
                      .counted = lar_calloc(nodes, sizeof *a->counted)};
    if (!a->thread || !a->batch || !a->owner || !a->loads || !a->counted)
        return lar_fail_memory(error, 8 * elements + 9 * nodes, "the work of a processor");
    memset(a->thread, -1, elements * sizeof *a->thread);
    memset(a->owner, -1, nodes * sizeof *a->owner);
    memset(a->loads, -1, nodes * sizeof *a->loads);
    return LAR_OK;
}

/* Loads act before a thread's first batch, like elements: with the first element that has the node,
 * so that whoever waits for the elements of a node waits for its loads too. Of several processors
 * the one that accounts for the node applies them. */
static lar_status assign(const lar_schedule *schedule, const lar_processor_setting *setting,
                         assignment *a, lar_error *error) {
    const lar_mesh *mesh = &setting->whole->model->mesh;
    lar_status status = allocate_assignment(a, mesh, error);
    if (status) return status;
    for (int32_t b = 0; b < schedule->batch_count; b++) {
        const lar_batch *batch = &schedule->batch[b];
        int32_t thread = lar_batch_thread(schedule, b);
        for (int32_t i = 0; i < batch->elements.count; i++) {
            int32_t e = schedule->element[batch->elements.first + i];
            a->thread[e] = thread;
            a->batch[e] = b - schedule->thread_first[thread];
        }
        for (int32_t i = 0; i < batch->positions.count; i++)
            a->owner[schedule->node[batch->positions.first + i]] = thread;
    }
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int k = 0; a->thread[e] >= 0 && k < 8; k++) {
            int32_t node = mesh->element[e][k];
            a->counted[node] = setting->reporter[node] == schedule->processor;
            if (a->counted[node] && a->loads[node] < 0) a->loads[node] = a->thread[e];
        }
    return LAR_OK;
}

/* An element may be recovered earlier than its batch asks for. Where the elements of a processor do
 * not stay in its core's cache, going through them once is worth more than sending early, as long
 * as packets need little time: all move to the first batch, but for a tail of some ten microseconds
 * behind which the exchange still hides (20,000 elements on two cores: 108 instead of 111 us). The
 * tail is the end of the whole layout's order: one region. */
static void recover_in_one_sweep(const lar_layout *whole, const lar_mesh *mesh, assignment *a) {
    enum { CACHED_ELEMENTS = 3000, TAIL = 1024 };
    int32_t own[LAR_THREADS_MAX] = {0}, kept[LAR_THREADS_MAX] = {0};
    for (int32_t e = 0; e < mesh->element_count; e++)
        if (a->thread[e] >= 0) own[a->thread[e]]++;
    for (int32_t b = whole->block_count - 1; b >= 0; b--)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = whole->block[b].element[lane];
            int32_t thread = e < 0 ? -1 : a->thread[e];
            if (thread < 0 || own[thread] < CACHED_ELEMENTS || a->batch[e] == 0) continue;
            if (kept[thread] < TAIL)
                kept[thread]++;
            else
                a->batch[e] = 0;
        }
}

/* ---- batches and packets ------------------------------------------------------------------ */

static lar_status compile_batches(const lar_schedule *schedule, lar_processor *p,
                                  lar_error *error) {
    size_t batches = (size_t)schedule->batch_count, waits = (size_t)schedule->wait_count;
    p->batch = lar_calloc(batches, sizeof *p->batch);
    p->sequence = lar_calloc_aligned(batches, sizeof *p->sequence);
    p->wait = lar_calloc(waits, sizeof *p->wait);
    if (!p->batch || !p->sequence || !p->wait)
        return lar_fail_memory(error, batches * sizeof *p->batch, "the batches of a processor");
    p->batch_count = schedule->batch_count;
    if (waits) memcpy(p->wait, schedule->wait, waits * sizeof *p->wait);
    for (int32_t b = 0; b < p->batch_count; b++) {
        const lar_batch *from = &schedule->batch[b];
        p->batch[b] = (lar_batch_plan){.waits = from->waits,
                                       .receives = from->receives,
                                       .sends = from->sends,
                                       .moves = from->positions.count > 0};
    }
    /* Runs are sorted by thread and batch: each batch has one stretch of them. */
    const lar_domain *domain = &p->domain;
    for (int32_t r = 0; r < domain->run_count; r++) {
        const lar_lanes *lanes = &domain->layout.block[domain->run_first[r]];
        lar_batch_plan *batch = &p->batch[schedule->thread_first[lanes->thread] + lanes->batch];
        if (batch->run_count++ == 0) batch->run_first = r;
    }
    return LAR_OK;
}

static lar_status compile_packets(const lar_schedule *schedule, lar_processor *p,
                                  lar_error *error) {
    size_t packets = (size_t)schedule->transfer_count, values = (size_t)schedule->vector_count;
    p->packet = lar_calloc(packets, sizeof *p->packet);
    p->node = lar_calloc(values, sizeof *p->node);
    if (!p->packet || !p->node)
        return lar_fail_memory(error, packets * sizeof *p->packet + 4 * values, "packets");
    p->packet_count = schedule->transfer_count;
    for (size_t i = 0; i < values; i++) {
        lar_lid local = p->domain.layout.local[schedule->vector[i]];
        if (local < 0)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "the schedule of processor %d exchanges a node that it does not have "
                            "(number %d from 0); make the schedules anew with lariat partition",
                            (int)p->self, (int)schedule->vector[i]);
        p->node[i] = local;
    }
    for (int32_t b = 0; b < schedule->batch_count; b++)
        for (int direction = 0; direction < 2; direction++) {
            lar_range span = direction ? schedule->batch[b].sends : schedule->batch[b].receives;
            for (int32_t i = span.first; i < span.first + span.count; i++) {
                const lar_transfer *t = &schedule->transfer[i];
                p->packet[i] = (lar_packet_plan){
                    .peer = t->peer,
                    .added = t->vectors.count - t->whole,
                    .whole = t->whole,
                    .first = t->vectors.first,
                    .offset = p->shift[direction ? t->peer : p->self] +
                              (size_t)p->layers * (size_t)t->offset,
                    .bytes = (size_t)lar_packet_payload(p->layers * t->vectors.count)};
            }
        }
    return LAR_OK;
}

/* ---- threads ------------------------------------------------------------------------------ */

/* Thread 0 has the processor's state; the others see its u and v and have forces of their own. */
static lar_status create_state(lar_processor *p, lar_worker *worker, lar_error *error) {
    int32_t nodes = p->domain.layout.node_padded;
    if (worker->thread == 0)
        return lar_state_create(&worker->state, nodes, p->domain.history_count, error);
    const lar_state *first = &p->worker[0].state;
    worker->state = (lar_state){.node_count = nodes,
                                .stride = first->stride,
                                .history_count = first->history_count,
                                .u = first->u,
                                .v = first->v,
                                .level = first->level,
                                .history = first->history};
    worker->state.force = lar_calloc_aligned(3 * first->stride, sizeof *worker->state.force);
    if (worker->state.force) return LAR_OK;
    return lar_fail_memory(error, 24 * first->stride, "the force sums of a thread");
}

static lar_status create_worker(const lar_schedule *schedule, const lar_processor_setting *setting,
                                const assignment *a, int32_t thread, lar_processor *p,
                                lar_error *error) {
    lar_worker *worker = &p->worker[thread];
    const lar_layout *layout = &p->domain.layout;
    worker->processor = p;
    worker->thread = thread;
    worker->batch_first = schedule->thread_first[thread];
    worker->batch_end = schedule->thread_first[thread + 1];
    worker->context = lar_domain_context_of(&p->domain, layout->first_node[thread],
                                            layout->first_node[thread + 1]);
    if (setting->delays)
        worker->random = setting->delays * 0x9e3779b97f4a7c15u +
                         (uint64_t)(p->self * LAR_THREADS_MAX + thread + 1);
    int32_t moving = 0;
    size_t largest = 64;
    for (int32_t b = worker->batch_first; b < worker->batch_end; b++) {
        moving += p->batch[b].moves;
        lar_range sends = p->batch[b].sends;
        for (int32_t i = sends.first; i < sends.first + sends.count; i++)
            if (p->packet[i].bytes > largest) largest = p->packet[i].bytes;
    }
    if (moving > 1)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "the schedule of processor %d moves nodes of thread %d in %d batches; "
                        "a thread moves all its nodes in one batch: put them together",
                        (int)p->self, (int)thread, (int)moving);
    lar_status status = create_state(p, worker, error);
    worker->state.strained = &p->strained;
    worker->state.needs = &worker->needs;
    if (!status && !(worker->gather = lar_calloc_aligned(largest, 1)))
        status = lar_fail_memory(error, largest, "a packet");
    lar_condition_share share = {thread, a->owner, a->loads, a->thread};
    if (!status)
        status = lar_conditions_create(setting->whole->model, layout->local, &share,
                                       &worker->surroundings.conditions, error);
    const lar_tool_contact *contact = &setting->interactions->tool_contact;
    if (!status)
        status = lar_surroundings_add_contact(setting->whole->model, layout->local, &share,
                                              contact->list, &worker->surroundings, error);
    if (!status)
        lar_tool_faces_yield_as(&setting->whole->surroundings.faces, &worker->surroundings.faces);
    if (!status)
        status = lar_interactions_create(&worker->surroundings, contact->tools, contact->always,
                                         &worker->interactions, error);
    return status;
}

static lar_status create_workers(const lar_schedule *schedule, const lar_processor_setting *setting,
                                 const assignment *a, lar_processor *p, lar_error *error) {
    size_t bytes = (size_t)p->thread_count * sizeof *p->worker;
    p->worker = lar_calloc_aligned((size_t)p->thread_count, sizeof *p->worker);
    if (!p->worker) return lar_fail_memory(error, bytes, "the threads of a processor");
    lar_status status = LAR_OK;
    for (int32_t t = 0; t < p->thread_count && !status; t++)
        status = create_worker(schedule, setting, a, t, p, error);
    const lar_condition_share share = {-1, a->owner, a->loads, a->thread};
    if (!status && !p->check)
        status = lar_contact_exchange_create(&setting->interactions->body_contact, &share,
                                             setting->reporter, schedule->grid.count, p, error);
    return status ? status : lar_thread_reduction_create(schedule, a->thread, p, error);
}

/* Between two runs a processor that exchanges asks for some memory of its packets (batch.c): often
 * enough, and so seldom that calling the kernel does not count. */
enum { RUN_BLOCKS = 128 };

/* ---- the processor ------------------------------------------------------------------------ */

int32_t lar_processor_layers(const lar_interactions *whole, bool checking) {
    return !checking && whole->tool_contact.press ? 2 : 1;
}

lar_status lar_processor_create(const lar_processor_setting *setting, const lar_schedule *schedule,
                                lar_processor *p, lar_error *error) {
    *p = (lar_processor){.self = schedule->processor,
                         .thread_count = schedule->threads,
                         .layers = lar_processor_layers(setting->interactions, setting->check),
                         .shift = setting->shift,
                         .check = setting->check};
    assignment a = {0};
    lar_status status = assign(schedule, setting, &a, error);
    if (!status && setting->low_latency)
        recover_in_one_sweep(&setting->whole->layout, &setting->whole->model->mesh, &a);
    lar_part part = {
        .threads = schedule->threads, .thread = a.thread, .batch = a.batch, .owner = a.owner};
    if (!status)
        status = lar_domain_create_part(setting->whole, &part, a.counted,
                                        schedule->transfer_count ? RUN_BLOCKS : INT32_MAX,
                                        &p->domain, error);
    if (!status && setting->whole->rubbing)
        lar_history_plan_nodes(&p->domain, setting->whole->rubbing);
    if (!status) status = lar_strained_create(&p->domain, &p->strained, error);
    if (!status) status = compile_batches(schedule, p, error);
    if (!status) status = compile_packets(schedule, p, error);
    if (!status) status = create_workers(schedule, setting, &a, p, error);
    clear_assignment(&a);
    if (status) lar_processor_destroy(p);
    return status;
}

void lar_processor_destroy(lar_processor *p) {
    lar_contact_exchange_destroy(p);
    for (int32_t t = p->worker ? p->thread_count - 1 : -1; t >= 0; t--) {
        lar_worker *worker = &p->worker[t];
        lar_interactions_destroy(&worker->interactions);
        lar_surroundings_destroy(&worker->surroundings);
        lar_thread_reduction_destroy(worker);
        free(worker->gather);
        if (t == 0)
            lar_state_destroy(&worker->state);
        else
            free(worker->state.force);
    }
    lar_strained_destroy(&p->strained);
    lar_domain_destroy(&p->domain);
    free(p->worker);
    free(p->batch);
    free(p->sequence);
    free(p->packet);
    free(p->node);
    free(p->wait);
    *p = (lar_processor){0};
}

void lar_processor_scatter(lar_processor *p, const lar_domain *whole, const lar_state *state) {
    const lar_layout *layout = &p->domain.layout;
    lar_state *own = &p->worker[0].state;
    memset(own->u, 0, 3 * own->stride * sizeof *own->u);
    memset(own->v, 0, 3 * own->stride * sizeof *own->v);
    memset(own->level, 0, own->stride * sizeof *own->level);
    for (lar_lid n = 0; n < layout->node_padded; n++) {
        if (layout->global[n] < 0) continue;
        double value[LAR_NODE_VALUES];
        lar_state_read(state, whole->layout.local[layout->global[n]], value);
        lar_state_write(own, n, value);
    }
    lar_viscous_copy(whole, state, &p->domain, own);
    for (int32_t t = 0; t < p->thread_count; t++) {
        lar_worker *worker = &p->worker[t];
        worker->state.step = state->step;
        worker->state.part = 0;
        worker->state.parts = 1;
        worker->state.listed = false;
        worker->state.external = worker->state.damped = 0;
        worker->state.contact = worker->state.exchanged = 0;
        worker->fault = (lar_fault){0};
        lar_interactions_forget(&worker->interactions);
        memset(worker->state.force, 0, 3 * own->stride * sizeof(int64_t));
        lar_tool_friction_forget(&worker->interactions.tool_contact);
    }
    p->ahead = (int64_t)(state->step - p->worker[0].round);
    if (p->comm) lar_comm_number_steps(p->comm, p->ahead);
}

void lar_processor_pause(lar_processor *p) {
    const lar_worker *first = &p->worker[0];
    p->stop = 0;
    /* Parts of divided steps are rounds of their own. */
    p->ahead = (int64_t)(first->state.step - first->round);
    if (!p->comm) return;
    lar_comm_number_steps(p->comm, p->ahead);
    lar_comm_complete(p->comm, first->state.step);
}

void lar_processor_ask_stop(lar_processor *p, uint64_t round) {
    uint64_t known = __atomic_load_n(&p->stop, __ATOMIC_RELAXED);
    while ((known == 0 || round < known) &&
           !__atomic_compare_exchange_n(&p->stop, &known, round, false, __ATOMIC_RELAXED,
                                        __ATOMIC_RELAXED))
        continue;
}

lar_status lar_processor_await(const lar_processor *p, const uint64_t *sequence, uint64_t round,
                               lar_error *error) {
    enum { POLLS = 50 };
    for (;;) {
        for (int i = 0; i < POLLS; i++)
            if (__atomic_load_n(sequence, __ATOMIC_ACQUIRE) >= round) return LAR_OK;
        /* The other thread itself has a deadline in everything that it waits for. */
        if (__atomic_load_n(&p->failed, __ATOMIC_ACQUIRE))
            return lar_fail(error, LAR_ERROR_PEER,
                            "another thread of processor %d has given up in step %llu; see what "
                            "it says",
                            (int)p->self, (unsigned long long)(round - 1 + (uint64_t)p->ahead));
        sched_yield();
    }
}
