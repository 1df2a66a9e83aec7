#include "comm/comm.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/memory.h"
#include "comm/backend.h"
#include "comm/rendezvous.h"
#include "comm/heartbeat.h"

/* ---- the backends ------------------------------------------------------------------------ */

/* Default first. One that this build lacks has a name and says how to get it. */
static const lar_comm_backend *const table[] = {&lar_comm_threads, &lar_comm_shm, &lar_comm_ucx,
                                                &lar_comm_mpi, &lar_comm_tcp};
enum { BACKENDS = sizeof table / sizeof table[0] };

bool lar_comm_backend_list(int index, lar_comm_backend_info *info) {
    if (index < 0 || index >= BACKENDS) return false;
    const lar_comm_backend *b = table[index];
    *info = (lar_comm_backend_info){b->name, b->summary, b->missing, b->start};
    return true;
}

static lar_status find_backend(const char *name, const lar_comm_backend **found, lar_error *error) {
    for (int i = 0; i < BACKENDS; i++) {
        if (!name || strcmp(table[i]->name, name) != 0) continue;
        if (table[i]->missing)
            return lar_fail(error, LAR_ERROR_UNSUPPORTED, "communication by %s: %s", name,
                            table[i]->missing);
        *found = table[i];
        return LAR_OK;
    }
    char names[100] = "";
    for (int i = 0, used = 0; i < BACKENDS; i++)
        if (!table[i]->missing)
            used += snprintf(names + used, sizeof names - (size_t)used, "%s%s", used ? ", " : "",
                             table[i]->name);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no communication backend %s; take one of these: %s",
                    name ? name : "(none)", names);
}

/* ---- opening and closing ----------------------------------------------------------------- */

lar_comm_options lar_comm_options_default(void) {
    return (lar_comm_options){.backend = "threads",
                              .count = 1,
                              .listener = -1,
                              .start_timeout = 20,
                              .timeout = 2,
                              .patience = 1.7};
}

bool lar_comm_is_local(const lar_comm *comm) {
    const char *master = comm->options.master;
    return !master || strncmp(master, "127.", 4) == 0 || strncmp(master, "[::1]", 5) == 0 ||
           strncmp(master, "localhost:", 10) == 0;
}

static lar_status check_options(const lar_comm_options *o, const lar_comm_backend *backend,
                                lar_error *error) {
    if (o->count < 1 || o->count > LAR_COMM_PROCESSORS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%d processors; take 1 to %d", (int)o->count,
                        LAR_COMM_PROCESSORS_MAX);
    if (o->self < 0 || o->self >= o->count)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "processor %d of %d; they count from 0",
                        (int)o->self, (int)o->count);
    if (o->receive_bytes % 8 != 0 || o->receive_bytes > SIZE_MAX / 4)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a receive buffer of %zu bytes; take a multiple of 8", o->receive_bytes);
    if (!(o->start_timeout > 0 && o->timeout > 0 && o->patience > 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "time limits must be greater than 0 s");
    if (backend->start == LAR_COMM_BY_TEAM && !o->team)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "communication by %s needs the team that all processors share",
                        backend->name);
    if (backend->start == LAR_COMM_BY_ADDRESS && !o->master && o->count > 1 &&
        !(o->self == 0 && o->listener >= 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "communication by %s needs the address of processor 0 (host:port)",
                        backend->name);
    return LAR_OK;
}

/* ---- an interrupted start ------------------------------------------------------------------- */

const char lar_comm_interrupted[] =
    "the start was interrupted: a processor was told to end before all were ready";

static int interrupted, opening; /* atomic; lar_comm_open waits so many times */

bool lar_comm_interrupt(void) {
    __atomic_store_n(&interrupted, 1, __ATOMIC_SEQ_CST);
    return __atomic_load_n(&opening, __ATOMIC_SEQ_CST) > 0;
}

lar_status lar_comm_check_interrupt(lar_error *error) {
    if (!__atomic_load_n(&interrupted, __ATOMIC_SEQ_CST)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_PEER, "%s", lar_comm_interrupted);
}

/* Connects to the peers between two parts of the rendezvous: before, all addresses are known;
 * after, everyone can reach everyone. */
static lar_status come_together(lar_comm *comm, lar_error *error) {
    const lar_comm_backend *backend = comm->backend;
    if (backend->meets) return backend->connect(comm, error);
    lar_status status = lar_rendezvous_gather(comm, error);
    if (status) return status;
    for (int32_t p = 0; p < comm->options.count; p++)
        comm->peers[p].half = comm->addresses[p].receive_bytes;
    lar_error own;
    status = backend->connect(comm, &own);
    return lar_rendezvous_ready(comm, status ? &own : NULL, error);
}

static lar_status open_parts(lar_comm *comm, lar_error *error) {
    size_t count = (size_t)comm->options.count;
    comm->peers = lar_calloc(count, sizeof *comm->peers);
    comm->addresses = lar_calloc(count, sizeof *comm->addresses);
    comm->links = lar_calloc(count, sizeof *comm->links);
    if (!comm->peers || !comm->addresses || !comm->links)
        return lar_fail_memory(error, count * sizeof *comm->addresses, "addresses of processors");
    for (size_t p = 0; p < count; p++) comm->links[p] = -1;
    comm->addresses[comm->options.self].receive_bytes = comm->options.receive_bytes;
    lar_status status = comm->backend->open(comm, error);
    if (!status) status = come_together(comm, error);
    if (status) return status;
    if (comm->backend->begin) comm->backend->begin(comm);
    /* What a processor sends to itself needs no network. */
    comm->peers[comm->options.self] = (lar_comm_peer){comm->receive, comm->options.receive_bytes};
    return comm->backend->meets ? LAR_OK : lar_heartbeat_start(comm, error);
}

lar_status lar_comm_open(const lar_comm_options *options, lar_comm **out, lar_error *error) {
    const lar_comm_backend *backend = NULL;
    lar_comm *comm = NULL;
    lar_status status = find_backend(options->backend, &backend, error);
    /* Who is alone needs no launcher to talk to itself. */
    if (!status && options->count == 1 && backend->start == LAR_COMM_BY_LAUNCHER)
        backend = &lar_comm_shm;
    if (!status) status = check_options(options, backend, error);
    if (!status && !(comm = lar_calloc(1, sizeof *comm)))
        status = lar_fail_memory(error, sizeof *comm, "communication");
    if (status) {
        if (options->team) lar_comm_team_give_up(options->team, options->self);
        if (options->listener >= 0) close(options->listener);
        return status;
    }
    comm->backend = backend;
    comm->process = getpid();
    comm->options = *options;
    comm->verdict = &comm->own_verdict;
    /* Until what a start has made is gone as well: who is told to end before leaves it behind. */
    const bool waits = !backend->meets && options->count > 1;
    __atomic_fetch_add(&opening, waits, __ATOMIC_SEQ_CST);
    status = open_parts(comm, error);
    if (status && options->team) lar_comm_team_give_up(options->team, options->self);
    if (status)
        lar_comm_close(comm);
    else
        *out = comm;
    __atomic_fetch_sub(&opening, waits, __ATOMIC_SEQ_CST);
    return status;
}

void lar_comm_close(lar_comm *comm) {
    if (!comm) return;
    comm->forked = comm->process != getpid();
    if (comm->backend->leave && !comm->forked) comm->backend->leave(comm);
    /* Goodbyes first: a connection that ends after one is no loss. */
    lar_heartbeat_stop(comm);
    if (comm->backend->close) comm->backend->close(comm);
    for (int32_t p = 0; comm->links && p < comm->options.count; p++)
        if (comm->links[p] >= 0) close(comm->links[p]);
    if (comm->options.listener >= 0) close(comm->options.listener);
    free(comm->links);
    free(comm->addresses);
    free(comm->peers);
    free(comm);
}

int32_t lar_comm_self(const lar_comm *comm) {
    return comm->options.self;
}
int32_t lar_comm_count(const lar_comm *comm) {
    return comm->options.count;
}
void lar_comm_number_steps(lar_comm *comm, int64_t ahead) {
    comm->ahead = (uint64_t)ahead;
}
void lar_comm_complete(lar_comm *comm, uint64_t steps) {
    comm->completed = steps;
    comm->completed_known = true;
}

/* ---- who is lost ------------------------------------------------------------------------- */

double lar_comm_now(void) {
    return lar_clock_seconds();
}

lar_status lar_comm_check(lar_comm *comm, uint64_t step, lar_error *error) {
    uint64_t verdict = __atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE);
    if (!verdict) return LAR_OK;
    static const char *const reasons[] = {
        "", "its process or its connection ended", "it gives no sign of life",
        "it lives but does not send what is waited for", "it stopped with a failure of its own"};
    int lost = (int)(verdict & 0xffffffffu) - 1;
    char complete[80] = "";
    uint64_t steps = step ? step - 1 + comm->ahead : comm->completed;
    if (step || comm->completed_known)
        snprintf(complete, sizeof complete, "the last complete step of processor %d is %llu; ",
                 (int)comm->options.self, (unsigned long long)steps);
    if (lost == comm->options.self)
        return lar_fail(error, LAR_ERROR_PEER,
                        "the others have given up processor %d, which is this one (%s); %slook for "
                        "what held it up and start all processors again",
                        lost, reasons[verdict >> 32], complete);
    return lar_fail(error, LAR_ERROR_PEER,
                    "processor %d is lost: %s; %ssee what processor %d says itself and start all "
                    "processors again",
                    lost, reasons[verdict >> 32], complete, lost);
}

lar_status lar_comm_look(lar_comm *comm, lar_error *error) {
    return lar_comm_check(comm, 0, error);
}

/* Who is waited for may wait himself: the one at the end of the chain holds up all. */
static int32_t end_of_chain(const lar_comm *comm, int32_t processor) {
    for (int32_t hops = 0; comm->waiting && hops < comm->options.count; hops++) {
        int32_t next = __atomic_load_n(&comm->waiting[processor], __ATOMIC_ACQUIRE);
        if (next == 0) break;
        processor = next - 1;
    }
    return processor;
}

lar_status lar_comm_give_up(lar_comm *comm, int32_t processor, lar_comm_loss loss, uint64_t step,
                            lar_error *error) {
    if (!__atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE)) {
        /* Processor zero decides among processes; without it everyone decides alone. */
        if (comm->heartbeat) lar_heartbeat_report(comm, processor, loss, step);
        if (loss == LAR_LOSS_STALLED) processor = end_of_chain(comm, processor);
        uint64_t nobody = 0;
        __atomic_compare_exchange_n(comm->verdict, &nobody, lar_comm_verdict(processor, loss),
                                    false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
    }
    return lar_comm_check(comm, step, error);
}

void lar_comm_abort(lar_comm *comm) {
    lar_comm_give_up(comm, comm->options.self, LAR_LOSS_FAILED, 0, NULL);
}

bool lar_comm_waited_for(lar_comm_waited *waited, double now, double patience) {
    if (!waited->began || now - waited->looked > patience / 2) waited->until = now + patience;
    waited->began = true;
    waited->looked = now;
    return now > waited->until;
}

bool lar_comm_impatient(const lar_comm *comm, lar_comm_waited *waited) {
    return lar_comm_waited_for(waited, lar_comm_now(), comm->options.patience);
}

/* ---- put and wait ------------------------------------------------------------------------ */

static lar_status refuse_packet(size_t half, int32_t peer, size_t offset, size_t bytes,
                                uint64_t step, lar_error *error) {
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "a packet of %zu bytes at offset %zu of processor %d in step %llu; offsets are "
                    "multiples of 8, steps count from 1 and the buffer has %zu bytes",
                    bytes, offset, (int)peer, (unsigned long long)step, half);
}

static bool peer_exists(const lar_comm *comm, int32_t peer) {
    return peer >= 0 && peer < comm->options.count;
}

lar_status lar_comm_put(lar_comm *comm, int32_t peer, size_t offset, const void *data, size_t bytes,
                        uint64_t step, lar_error *error) {
    size_t half = peer_exists(comm, peer) ? comm->peers[peer].half : 0;
    if (step == 0 || !lar_comm_fits(half, offset, bytes))
        return refuse_packet(half, peer, offset, bytes, step, error);
    unsigned char *direct = comm->peers[peer].direct;
    if (!direct) return comm->backend->put(comm, peer, offset, data, bytes, step, error);
    unsigned char *there = direct + (step & 1 ? half : 0) + offset;
    if (bytes && data != there) memcpy(there, data, bytes);
    __atomic_store_n(lar_comm_tail(direct, half, offset, bytes, step), step, __ATOMIC_RELEASE);
    return LAR_OK;
}

void *lar_comm_room(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step) {
    if (!peer_exists(comm, peer)) return NULL;
    const lar_comm_peer *to = &comm->peers[peer];
    if (step == 0 || !lar_comm_fits(to->half, offset, bytes)) return NULL;
    return to->direct ? to->direct + (step & 1 ? to->half : 0) + offset : NULL;
}

static inline uint64_t load_tail(const uint64_t *tail) {
    return __atomic_load_n(tail, __ATOMIC_ACQUIRE);
}

/* After the deadline, or with a tail that cannot be: what to say. */
static lar_status complain(lar_comm *comm, int32_t peer, uint64_t tail, uint64_t step,
                           lar_error *error) {
    if (tail <= step) return lar_comm_give_up(comm, peer, LAR_LOSS_STALLED, step, error);
    lar_fail(error, LAR_ERROR_PEER,
             "processor %d sent step %llu where processor %d waits for step %llu; the schedules "
             "do not belong together or lack an exchange in both directions: make them anew",
             (int)peer, (unsigned long long)(tail + comm->ahead), (int)comm->options.self,
             (unsigned long long)(step + comm->ahead));
    lar_comm_abort(comm);
    return LAR_ERROR_PEER;
}

static lar_status poll_and_yield(lar_comm *comm, int32_t peer, const uint64_t *tail, uint64_t step,
                                 lar_error *error) {
    const lar_comm_backend *backend = comm->backend;
    lar_comm_waited waited = {0};
    for (;;) {
        for (int i = 0; i < backend->polls; i++) {
            if (backend->progress) {
                lar_status status = backend->progress(comm, peer);
                if (load_tail(tail) == step) return LAR_OK;
                /* The peer may act on a verdict that has not come here yet: giving up waits for it.
                 */
                if (status) return lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, step, error);
            } else {
                if (load_tail(tail) == step) return LAR_OK;
                lar_comm_relax();
            }
        }
        sched_yield();
        uint64_t there = load_tail(tail);
        if (there == step) return LAR_OK;
        lar_status status = lar_comm_check(comm, step, error);
        if (status) return status;
        bool over = lar_comm_impatient(comm, &waited);
        if (there > step || over) return complain(comm, peer, there, step, error);
    }
}

/* Without a limit: who lives may take its time. */
static lar_status poll_and_sleep(lar_comm *comm, int32_t peer, const uint64_t *tail, uint64_t step,
                                 lar_error *error) {
    /* [s] Longer than from one tick of a session to the next (1 ms): commands follow each other,
     * and who sleeps hears them late. */
    static const double POLLING = 2.5e-3;
    enum { SLEEP_MIN = 50000, SLEEP_MAX = 1000000 /* [ns] */ };
    struct timespec sleep = {.tv_nsec = SLEEP_MIN};
    const lar_comm_backend *backend = comm->backend;
    double until = lar_comm_now() + POLLING;
    for (;;) {
        lar_status ended = backend->progress ? backend->progress(comm, peer) : LAR_OK;
        uint64_t there = load_tail(tail);
        if (there == step) return LAR_OK;
        if (there > step) return complain(comm, peer, there, step, error);
        if (ended) return lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, 0, error);
        lar_status status = lar_comm_check(comm, 0, error);
        if (status) return status;
        if (lar_comm_now() < until) {
            sched_yield();
            continue;
        }
        nanosleep(&sleep, NULL);
        sleep.tv_nsec = 2 * sleep.tv_nsec < SLEEP_MAX ? 2 * sleep.tv_nsec : SLEEP_MAX;
    }
}

typedef lar_status (*wait_way)(lar_comm *comm, int32_t peer, const uint64_t *tail, uint64_t step,
                               lar_error *error);

static lar_status wait_long(lar_comm *comm, int32_t peer, const uint64_t *tail, uint64_t step,
                            wait_way way, lar_error *error) {
    int32_t *waiting = comm->waiting ? &comm->waiting[comm->options.self] : NULL;
    double begin = comm->times ? lar_comm_now() : 0;
    if (waiting) __atomic_store_n(waiting, peer + 1, __ATOMIC_RELEASE);
    lar_status status = way(comm, peer, tail, step, error);
    if (waiting) __atomic_store_n(waiting, 0, __ATOMIC_RELEASE);
    if (comm->times) comm->waited += lar_comm_now() - begin;
    return status;
}

void lar_comm_time_waits(lar_comm *comm, bool times) {
    comm->times = times;
    comm->waited = 0;
}

double lar_comm_time_waited(const lar_comm *comm) {
    return comm->waited;
}

static inline lar_status wait_for(lar_comm *comm, int32_t peer, size_t offset, size_t bytes,
                                  uint64_t step, const void **payload, wait_way way,
                                  lar_error *error) {
    size_t half = comm->options.receive_bytes;
    if (step == 0 || !peer_exists(comm, peer) || !lar_comm_fits(half, offset, bytes))
        return refuse_packet(half, peer, offset, bytes, step, error);
    /* Also while all packets come in time: a processor that is cut off may go on sending. */
    if (__atomic_load_n(comm->verdict, __ATOMIC_RELAXED))
        return lar_comm_check(comm, way == poll_and_sleep ? 0 : step, error);
    const uint64_t *tail = lar_comm_tail(comm->receive, half, offset, bytes, step);
    if (load_tail(tail) != step) {
        lar_status status = wait_long(comm, peer, tail, step, way, error);
        if (status) return status;
    }
    if (payload) *payload = comm->receive + (step & 1 ? half : 0) + offset;
    return LAR_OK;
}

lar_status lar_comm_wait(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step,
                         const void **payload, lar_error *error) {
    return wait_for(comm, peer, offset, bytes, step, payload, poll_and_yield, error);
}

lar_status lar_comm_await(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step,
                          const void **payload, lar_error *error) {
    return wait_for(comm, peer, offset, bytes, step, payload, poll_and_sleep, error);
}
