/* Anywhere MPI runs, the portable baseline: two-sided messages, because MPI gives no way to poll a
 * word that a one-sided put of it writes.
 *
 *     | offset 8 | bytes 8 | step 8 | token 8 | payload ... |
 *
 * Receives for messages from anyone wait in a ring; the oldest is tested, its payload copied to
 * where the sender says, the tail stored, and the receive posted again. Messages leave from a pool
 * that is used in a circle: a message's memory is free again when MPI says that it is sent. A put
 * that finds no room receives meanwhile, so two that send to each other cannot block each other.
 *
 * Large packets leave only while their sender waits, puts or closes: MPI works inside its calls.
 *
 * Leaving: everyone tells everyone goodbye (step 0) and waits for those of all others. Messages do
 * not overtake each other, so nothing is on the way to a processor that has heard them all. What
 * MPI still holds of its own goodbyes leaves at MPI's next call (mpi_world.c: a barrier).
 * Synchronous sends would say that they came; but with 27 processes of MPICH over UCX on two cores
 * an acknowledgement never came in one run of fifteen, and that process waited its whole timeout.
 *
 * After a loss MPI may never finish with what it was given. That memory is then not freed: such
 * a process has nothing left to do but to end (job.h).
 */
#include <limits.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "comm/backend.h"
#include "comm/mpi_world.h"

enum { RECEIVES_MAX = 16, RECEIVE_BYTES = 8 << 20, SENDS = 1024, POOL_MIN = 1 << 16 };

typedef struct message {
    uint64_t offset, bytes, step, token;
} message;

/* What the others must know. */
typedef struct mpi_address {
    int32_t rank, tag; /* zero's tag is everyone's */
} mpi_address;

typedef struct sent {
    lar_mpi_request request;
    size_t begin; /* in the pool */
} sent;

typedef struct mpi_state {
    lar_mpi_world *world;
    struct mpi_state *next; /* of the abandoned */
    int tag;
    int *ranks; /* [count] */
    bool begun;
    bool broken;          /* MPI has failed; who is lost is the heartbeat's to say */
    int receives, oldest; /* the ring */
    size_t receive_bytes; /* of one */
    unsigned char *incoming;
    lar_mpi_request posted[RECEIVES_MAX];
    unsigned char *pool;
    size_t pool_bytes, pool_at;
    int first_sent, sents; /* a ring, too */
    sent sends[SENDS];
    message goodbye;
    lar_mpi_request *goodbyes; /* [count] */
    int32_t heard;             /* goodbyes of others */
} mpi_state;

/* ---- start ---------------------------------------------------------------------------------- */

static lar_status mpi_open(lar_comm *comm, lar_error *error) {
    lar_mpi_world *world = lar_mpi_joined();
    const lar_comm_options *o = &comm->options;
    if (!world || (o->count > 1 && !o->master && o->listener < 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "communication by mpi needs processors that were started together; start "
                        "them with mpirun -n %d or srun -n %d, or use shm or tcp",
                        (int)o->count, (int)o->count);
    size_t bytes = o->receive_bytes;
    if (bytes > INT_MAX / 2)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "communication by mpi takes receive buffers of up to %d bytes, not %zu; "
                        "use more processors or the backend tcp",
                        INT_MAX / 2, bytes);
    mpi_state *state = comm->state = lar_calloc(1, sizeof *state);
    comm->receive = lar_calloc_aligned(bytes ? 2 * bytes : 8, 1);
    if (!state || !comm->receive) return lar_fail_memory(error, 2 * bytes, "a receive buffer");
    state->world = world;
    lar_mpi_lock(world);
    mpi_address own = {.rank = world->rank, .tag = world->tags_used % world->tag_max};
    world->tags_used++;
    lar_mpi_unlock(world);
    lar_comm_address *address = &comm->addresses[o->self];
    memcpy(address->data, &own, sizeof own);
    address->bytes = sizeof own;
    return LAR_OK;
}

static lar_status take_memory(lar_comm *comm, lar_error *error) {
    mpi_state *state = comm->state;
    size_t count = (size_t)comm->options.count, max = comm->options.receive_bytes;
    state->receive_bytes = sizeof(message) + max;
    state->receives = (int)(RECEIVE_BYTES / state->receive_bytes);
    if (state->receives > RECEIVES_MAX) state->receives = RECEIVES_MAX;
    if (state->receives < 2) state->receives = 2;
    /* Two steps of packets to someone who takes the most; heads may be more than payload. */
    for (size_t p = 0; p < count; p++)
        if (comm->peers[p].half > max) max = comm->peers[p].half;
    state->pool_bytes = 4 * (sizeof(message) + max) + POOL_MIN;
    state->ranks = lar_calloc(count, sizeof *state->ranks);
    state->goodbyes = lar_calloc(count, sizeof *state->goodbyes);
    state->incoming = lar_calloc_aligned((size_t)state->receives, state->receive_bytes);
    state->pool = lar_calloc_aligned(state->pool_bytes, 1);
    if (!state->ranks || !state->goodbyes || !state->incoming || !state->pool)
        return lar_fail_memory(error, state->pool_bytes + RECEIVE_BYTES, "messages");
    return LAR_OK;
}

static lar_status mpi_connect(lar_comm *comm, lar_error *error) {
    mpi_state *state = comm->state;
    lar_status status = take_memory(comm, error);
    for (int32_t p = 0; p < comm->options.count && !status; p++) {
        mpi_address at;
        memcpy(&at, comm->addresses[p].data, sizeof at);
        state->ranks[p] = at.rank;
        if (p == 0) state->tag = at.tag;
    }
    return status;
}

static void post(mpi_state *state, int i) {
    void *there = state->incoming + (size_t)i * state->receive_bytes;
    if (state->world->mpi->receive(there, (int)state->receive_bytes, state->tag, &state->posted[i]))
        state->broken = true;
}

/* What comes before this waits in MPI. */
static void mpi_begin(lar_comm *comm) {
    mpi_state *state = comm->state;
    state->goodbye.token = comm->token;
    lar_mpi_lock(state->world);
    for (int i = 0; i < state->receives; i++) post(state, i);
    lar_mpi_unlock(state->world);
    state->begun = true;
}

/* ---- receiving ------------------------------------------------------------------------------ */

static void store(lar_comm *comm, const message *m) {
    mpi_state *state = comm->state;
    size_t half = comm->options.receive_bytes;
    if (m->token != comm->token) return; /* of a lar_comm that was lost before */
    if (m->step == 0) {
        state->heard++;
        return;
    }
    if (!lar_comm_fits(half, m->offset, m->bytes)) return;
    memcpy(comm->receive + (m->step & 1 ? half : 0) + m->offset, m + 1, m->bytes);
    uint64_t *tail = lar_comm_tail(comm->receive, half, m->offset, m->bytes, m->step);
    __atomic_store_n(tail, m->step, __ATOMIC_RELEASE);
}

/* Whether a request is done. The caller has the lock. */
static bool is_done(mpi_state *state, lar_mpi_request *request) {
    bool done = false;
    if (!state->broken && state->world->mpi->test(request, &done)) state->broken = true;
    return done && !state->broken;
}

/* The caller has the lock. */
static void receive_some(lar_comm *comm) {
    mpi_state *state = comm->state;
    for (int i = 0; i < state->receives; i++) {
        if (!is_done(state, &state->posted[state->oldest])) return;
        const unsigned char *at = state->incoming + (size_t)state->oldest * state->receive_bytes;
        store(comm, (const message *)(const void *)at);
        post(state, state->oldest);
        state->oldest = (state->oldest + 1) % state->receives;
    }
}

static lar_status mpi_progress(lar_comm *comm, int32_t peer) {
    (void)peer;
    mpi_state *state = comm->state;
    if (!lar_mpi_try(state->world)) return LAR_OK;
    receive_some(comm);
    lar_mpi_unlock(state->world);
    return LAR_OK;
}

/* ---- sending -------------------------------------------------------------------------------- */

/* Forgets what is sent. The caller has the lock. */
static void reclaim(mpi_state *state) {
    while (state->sents > 0) {
        if (!is_done(state, &state->sends[state->first_sent].request)) return;
        state->first_sent = (state->first_sent + 1) % SENDS;
        state->sents--;
    }
    state->pool_at = 0;
}

/* A place in the pool, between the newest and the oldest message; NULL: none now. */
static message *take_place(mpi_state *state, size_t bytes) {
    size_t need = sizeof(message) + lar_comm_padded(bytes);
    reclaim(state);
    if (state->sents == SENDS) return NULL;
    size_t oldest = state->sents ? state->sends[state->first_sent].begin : 0;
    bool wrapped = state->sents && state->pool_at <= oldest;
    size_t end = wrapped ? oldest : state->pool_bytes;
    if (end - state->pool_at < need) {
        if (wrapped || oldest < need) return NULL;
        state->pool_at = 0;
    }
    size_t begin = state->pool_at;
    state->pool_at += need;
    state->sends[(state->first_sent + state->sents) % SENDS].begin = begin;
    return (message *)(void *)(state->pool + begin);
}

/* Returns with the lock held, unless it fails. */
static lar_status wait_for_place(lar_comm *comm, int32_t peer, size_t bytes, uint64_t step,
                                 message **place, lar_error *error) {
    mpi_state *state = comm->state;
    lar_comm_waited waited = {0};
    for (;;) {
        lar_mpi_lock(state->world);
        if ((*place = take_place(state, bytes))) return LAR_OK;
        receive_some(comm);
        lar_mpi_unlock(state->world);
        sched_yield();
        lar_status status = lar_comm_check(comm, step, error);
        if (status) return status;
        if (lar_comm_impatient(comm, &waited))
            return lar_comm_give_up(comm, peer, LAR_LOSS_STALLED, step, error);
    }
}

static lar_status mpi_put(lar_comm *comm, int32_t peer, size_t offset, const void *data,
                          size_t bytes, uint64_t step, lar_error *error) {
    mpi_state *state = comm->state;
    message *m;
    lar_status status = wait_for_place(comm, peer, bytes, step, &m, error);
    if (status) return status;
    *m = (message){offset, bytes, step, comm->token};
    if (bytes) memcpy(m + 1, data, bytes);
    sent *s = &state->sends[(state->first_sent + state->sents) % SENDS];
    int failed = state->world->mpi->send(m, (int)(sizeof *m + bytes), state->ranks[peer],
                                         state->tag, &s->request);
    if (!failed) state->sents++;
    lar_mpi_unlock(state->world);
    return failed ? lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, step, error) : LAR_OK;
}

/* ---- leaving -------------------------------------------------------------------------------- */

static bool all_said(lar_comm *comm) {
    mpi_state *state = comm->state;
    receive_some(comm);
    reclaim(state);
    bool all = state->sents == 0 && state->heard == comm->options.count - 1;
    for (int32_t p = 0; p < comm->options.count && all; p++)
        all = p == comm->options.self || is_done(state, &state->goodbyes[p]);
    return all;
}

/* True when nothing is on the way any more. */
static bool say_goodbye(lar_comm *comm) {
    mpi_state *state = comm->state;
    double deadline = lar_comm_now() + comm->options.timeout;
    bool all = false, failed = false;
    lar_mpi_lock(state->world);
    for (int32_t p = 0; p < comm->options.count; p++)
        if (p != comm->options.self &&
            state->world->mpi->send(&state->goodbye, sizeof state->goodbye, state->ranks[p],
                                    state->tag, &state->goodbyes[p]))
            failed = true;
    while (!failed && !(all = all_said(comm)) && lar_comm_now() < deadline &&
           !__atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE)) {
        lar_mpi_unlock(state->world);
        sched_yield();
        lar_mpi_lock(state->world);
    }
    for (int i = 0; i < state->receives && all; i++) state->world->mpi->cancel(&state->posted[i]);
    lar_mpi_unlock(state->world);
    return all;
}

static void mpi_leave(lar_comm *comm) {
    mpi_state *state = comm->state;
    if (!state || !state->begun) return;
    state->begun = false;
    bool lost = __atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE) != 0;
    if (!lost && say_goodbye(comm)) return;
    lar_mpi_lock(state->world);
    state->next = state->world->abandoned;
    state->world->abandoned = state;
    lar_mpi_unlock(state->world);
    comm->state = NULL;
}

static void mpi_close(lar_comm *comm) {
    mpi_state *state = comm->state;
    free(comm->receive);
    if (!state) return;
    free(state->ranks);
    free(state->goodbyes);
    free(state->incoming);
    free(state->pool);
    free(state);
}

const lar_comm_backend lar_comm_mpi = {.name = "mpi",
                                       .summary = "anywhere MPI runs",
                                       .start = LAR_COMM_BY_LAUNCHER,
#ifndef LAR_HAVE_MPI
                                       .missing = "this build found no MPI; install libopenmpi-dev "
                                                  "or libmpich-dev and build Lariat again",
#endif
                                       .polls = 50,
                                       .open = mpi_open,
                                       .connect = mpi_connect,
                                       .begin = mpi_begin,
                                       .put = mpi_put,
                                       .progress = mpi_progress,
                                       .leave = mpi_leave,
                                       .close = mpi_close};
