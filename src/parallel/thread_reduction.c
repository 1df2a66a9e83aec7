#include "parallel/thread_reduction.h"

#include <stdlib.h>
#include <string.h>

_Static_assert(LAR_THREADS_MAX <= 16, "node_use has a bit for each thread");
_Static_assert((int)LAR_LAYOUT_THREADS >= (int)LAR_THREADS_MAX, "a layout takes all threads");

/* known[b * threads + t]: the last batch of thread t that is finished when batch b has waited, -1:
 * none. What a batch that is waited for knew is known too. */
static int32_t *find_known(const lar_schedule *schedule) {
    size_t threads = (size_t)schedule->threads;
    int32_t *known = lar_calloc((size_t)schedule->batch_count * threads, sizeof *known);
    if (!known) return NULL;
    memset(known, -1, (size_t)schedule->batch_count * threads * sizeof *known);
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t b = 0; b < schedule->batch_count; b++) {
            const lar_batch *batch = &schedule->batch[b];
            int32_t thread = lar_batch_thread(schedule, b);
            bool first = b == schedule->thread_first[thread];
            for (int32_t i = first ? 0 : -1; i < batch->waits.count; i++) {
                int32_t other = i < 0 ? b - 1 : schedule->wait[batch->waits.first + i];
                int32_t its_thread = lar_batch_thread(schedule, other);
                for (int32_t t = 0; t < schedule->threads; t++) {
                    int32_t *mine = &known[(size_t)b * threads + (size_t)t];
                    int32_t theirs = known[(size_t)other * threads + (size_t)t];
                    if (t == its_thread && other > theirs) theirs = other;
                    changed = changed || theirs > *mine;
                    if (theirs > *mine) *mine = theirs;
                }
            }
        }
    }
    return known;
}

/* The last batch of thread `from` that is known to be finished when the nodes of `to` move. */
static int32_t batch_waited_for(const lar_schedule *schedule, const int32_t *known, int32_t from,
                                int32_t to) {
    for (int32_t b = schedule->thread_first[to]; b < schedule->thread_first[to + 1]; b++)
        if (schedule->batch[b].positions.count > 0)
            return known[(size_t)b * (size_t)schedule->threads + (size_t)from];
    return -1;
}

/* Who has something to do with a local node: a bit for each thread. */
typedef struct node_use {
    uint16_t *reads; /* recovers an element there */
    uint16_t *adds;  /* that, or receives for it */
    bool *replaced;  /* a whole force may come */
    int32_t *known;  /* find_known */
} node_use;

static void clear_use(node_use *use) {
    free(use->reads);
    free(use->adds);
    free(use->replaced);
    free(use->known);
}

static lar_status find_use(const lar_schedule *schedule, const int32_t *thread,
                           const lar_processor *p, node_use *use, lar_error *error) {
    const lar_layout *layout = &p->domain.layout;
    const lar_mesh *mesh = &p->domain.model->mesh;
    size_t nodes = (size_t)layout->node_padded;
    *use = (node_use){lar_calloc(nodes, sizeof *use->reads), lar_calloc(nodes, sizeof *use->adds),
                      lar_calloc(nodes, sizeof *use->replaced), find_known(schedule)};
    if (!use->reads || !use->adds || !use->replaced || !use->known)
        return lar_fail_memory(error, 5 * nodes, "who uses the nodes");
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int k = 0; thread[e] >= 0 && k < 8; k++)
            use->reads[layout->local[mesh->element[e][k]]] |= (uint16_t)(1u << thread[e]);
    memcpy(use->adds, use->reads, nodes * sizeof *use->adds);
    for (int32_t b = 0; b < schedule->batch_count; b++) {
        lar_range receives = schedule->batch[b].receives;
        for (int32_t i = receives.first; i < receives.first + receives.count; i++) {
            const lar_transfer *t = &schedule->transfer[i];
            for (int32_t v = 0; v < t->vectors.count; v++) {
                lar_lid n = p->node[t->vectors.first + v];
                use->adds[n] |= (uint16_t)(1u << lar_batch_thread(schedule, b));
                use->replaced[n] = use->replaced[n] || v >= t->vectors.count - t->whole;
            }
        }
    }
    return LAR_OK;
}

/* Whether a node that `owner` moves is summed in place. */
static bool is_shared(const node_use *use, lar_lid n, int32_t owner) {
    unsigned others = ~(1u << owner);
    return (use->replaced[n] && use->adds[n] & others) ||
           (use->adds[n] & ~use->reads[n] & others) != 0;
}

static bool is_packed(const node_use *use, lar_lid n, int32_t from, int32_t owner) {
    return use->adds[n] >> from & 1 && !is_shared(use, n, owner);
}

static lar_status create_buffer(const lar_schedule *schedule, const node_use *use, int32_t from,
                                int32_t to, lar_processor *p, lar_error *error) {
    lar_reduction_buffer *reduction = &p->worker[from].reduction[to];
    const lar_condition_context *moved = &p->worker[to].context;
    *reduction = (lar_reduction_buffer){.batch = batch_waited_for(schedule, use->known, from, to)};
    for (lar_lid n = moved->first; n < moved->end; n++)
        reduction->count += is_packed(use, n, from, to);
    if (reduction->count > 0 && reduction->batch < 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "the schedule of processor %d lets thread %d move nodes without waiting "
                        "for thread %d, which has elements there; make the schedules anew with "
                        "lariat partition",
                        (int)p->self, (int)to, (int)from);
    reduction->node = lar_calloc((size_t)reduction->count, sizeof *reduction->node);
    reduction->vector = lar_calloc_aligned(3 * (size_t)p->layers * (size_t)reduction->count,
                                           sizeof *reduction->vector);
    if (!reduction->node || !reduction->vector)
        return lar_fail_memory(error, 28 * (size_t)reduction->count, "sums between threads");
    int32_t count = 0;
    for (lar_lid n = moved->first; n < moved->end; n++)
        if (is_packed(use, n, from, to)) reduction->node[count++] = n;
    return LAR_OK;
}

/* What the threads have to do with each other's nodes. */
static lar_status join_worker(const lar_schedule *schedule, const node_use *use, int32_t thread,
                              lar_processor *p, lar_error *error) {
    lar_worker *worker = &p->worker[thread];
    const lar_condition_context *own = &worker->context;
    size_t nodes = (size_t)p->domain.layout.node_padded;
    worker->reduction = lar_calloc((size_t)p->thread_count, sizeof *worker->reduction);
    worker->shared_node = lar_calloc(nodes, sizeof *worker->shared_node);
    worker->foreign = lar_calloc(nodes, sizeof *worker->foreign);
    if (!worker->reduction || !worker->shared_node || !worker->foreign)
        return lar_fail_memory(error, 8 * nodes, "sums between threads");
    for (lar_lid n = 0; n < (lar_lid)nodes; n++) {
        bool moved = n >= own->first && n < own->end;
        if (moved && is_shared(use, n, thread)) worker->shared_node[worker->shared_count++] = n;
        if (!moved && use->reads[n] >> thread & 1) worker->foreign[worker->foreign_count++] = n;
    }
    lar_status status = LAR_OK;
    for (int32_t to = 0; to < p->thread_count && !status; to++) {
        worker->reduction[to].batch = -1;
        if (to != thread) status = create_buffer(schedule, use, thread, to, p, error);
    }
    return status;
}

lar_status lar_thread_reduction_create(const lar_schedule *schedule, const int32_t *thread,
                                       lar_processor *p, lar_error *error) {
    node_use use = {0};
    lar_status status = find_use(schedule, thread, p, &use, error);
    for (int32_t t = 0; t < p->thread_count && !status; t++)
        status = join_worker(schedule, &use, t, p, error);
    clear_use(&use);
    return status;
}

void lar_thread_reduction_destroy(lar_worker *worker) {
    for (int32_t to = 0; worker->reduction && to < worker->processor->thread_count; to++) {
        free(worker->reduction[to].node);
        free(worker->reduction[to].vector);
    }
    free(worker->reduction);
    free(worker->shared_node);
    free(worker->foreign);
    worker->reduction = NULL;
    worker->shared_node = worker->foreign = NULL;
}
