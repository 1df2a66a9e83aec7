/* Clusters: UCX, which knows InfiniBand, RoCE, sockets and shared memory.
 *
 * Each processor has a worker; an endpoint leads to every peer. Three ways for a packet, chosen per
 * peer when they connect, the first that is possible:
 *
 *     direct    the receive buffer lies in memory that UCX can map on the same machine:
 *               comm.c copies and stores the tail, as with shm; no network takes part
 *     put       the network card writes the peer's memory: put payload, fence, put tail
 *     message   anything else, above all sockets: an active message; its handler at the peer copies
 *               the payload and stores the tail. A put over sockets is made of two such messages
 *               and their answers, and takes two to three times as long
 *
 * A message is right on every network. A put is used only over those that write memory themselves
 * and in order (rc, dc). LARIAT_UCX=put or =message in the environment forces one, for tests and
 * measurements.
 *
 * Lifetimes. The payload of a put or message must stay until UCX has taken it, which it mostly has
 * when the call returns; otherwise lar_comm_put lets UCX work until then, which also takes in what
 * the peer sends, so two that send to each other do not block each other. All tails of a step to
 * one peer are the same word, the step: two words per peer, by parity, rewritten two steps later
 * when no put of theirs is under way.
 *
 *     connect   hello ---> everyone: "I write (not) directly"; until all hellos have come
 *     begin     endpoints between two that both write directly are cut
 *     leave     flush, bye ---> the others; until their byes have come: then nothing is under way
 *               in either direction
 *
 * Threads. The worker has one lock of ours: who only polls goes on when it is taken, who puts goes
 * first. UCX's own (UCS_THREAD_MODE_MULTI) is not faster, some builds lack it, and what is counted
 * here needs a lock anyway.
 *
 * Losses. An endpoint that fails says so here and ends the waits for that peer; who is silent is
 * noticed by heartbeat.h. UCX itself neither prints nor catches signals nor ends the process.
 */
#include "comm/backend.h"

#ifdef LAR_HAVE_UCX
#include <stdlib.h>

#include "comm/ucx_state.h"

/* Polls while nothing must come through UCX, and fruitless ones before the processor is yielded. */
enum { SELDOM = 16, FRUITLESS = 4 };
static const double CUT_TIME = 0.2; /* until an endpoint is closed by force [s] */

/* ---- what is under way ---------------------------------------------------------------------- */

/* Ends an operation that `user` counts. */
static void count_down(void *request, ucs_status_t status, void *user) {
    (void)status;
    --*(int *)user;
    lar_ucx.ucp_request_free(request);
}

static ucp_request_param_t counted(int *count) {
    return (ucp_request_param_t){.op_attr_mask =
                                     UCP_OP_ATTR_FIELD_CALLBACK | UCP_OP_ATTR_FIELD_USER_DATA,
                                 .cb.send = count_down,
                                 .user_data = count};
}

/* `request` is what a counted call returned. */
static void count_up(int *count, ucs_status_ptr_t request) {
    if (UCS_PTR_IS_PTR(request)) ++*count;
}

void lar_ucx_send_note(ucx_state *state, ucx_link *link, const note *n) {
    ucp_request_param_t param = counted(&state->pending);
    param.op_attr_mask |= UCP_OP_ATTR_FIELD_FLAGS;
    param.flags = UCP_AM_SEND_FLAG_EAGER;
    count_up(&state->pending,
             lar_ucx.ucp_am_send_nbx(link->endpoint, MESSAGE_NOTE, n, sizeof *n, NULL, 0, &param));
}

static void cut(ucx_state *state, ucx_link *link) {
    ucp_request_param_t param = counted(&state->pending);
    param.op_attr_mask |= UCP_OP_ATTR_FIELD_FLAGS;
    param.flags = link->severable ? UCP_EP_CLOSE_FLAG_FORCE : 0;
    if (link->endpoint) count_up(&state->pending, lar_ucx.ucp_ep_close_nbx(link->endpoint, &param));
    link->endpoint = NULL;
}

bool lar_ucx_work_until(lar_comm *comm, condition fulfilled, double deadline) {
    ucx_state *state = comm->state;
    for (;;) {
        lock(state);
        unsigned events = lar_ucx.ucp_worker_progress(state->worker);
        bool done = fulfilled(comm);
        unlock(state);
        if (done || lar_comm_now() > deadline) return done;
        if (!events) sched_yield();
    }
}

static bool nothing_pending(const lar_comm *comm) {
    return ((const ucx_state *)comm->state)->pending == 0;
}

/* Between two that write each other's memory no network is needed any more. */
static void ucx_begin(lar_comm *comm) {
    ucx_state *state = comm->state;
    state->connecting = false;
    lock(state);
    for (int32_t p = 0; p < comm->options.count; p++)
        if (!goes_through_ucx(&state->links[p]) && state->links[p].severable)
            cut(state, &state->links[p]);
    unlock(state);
    lar_ucx_work_until(comm, nothing_pending, lar_comm_now() + CUT_TIME);
}

/* ---- put and progress ----------------------------------------------------------------------- */

/* Lets UCX work once, unless somebody else does or wants to put. Returns what happened. */
static unsigned work(ucx_state *state) {
    if (atomic_load_explicit(&state->putters, memory_order_relaxed) > 0 ||
        atomic_flag_test_and_set_explicit(&state->lock, memory_order_acquire))
        return 0;
    unsigned events = lar_ucx.ucp_worker_progress(state->worker);
    unlock(state);
    return events;
}

/* A put that cannot go on: waits until UCX no longer reads the caller's memory. */
static lar_status abandon(lar_comm *comm, ucx_link *link, ucs_status_ptr_t request,
                          lar_status status) {
    ucx_state *state = comm->state;
    double deadline = lar_comm_now() + CUT_TIME;
    lock(state);
    if (link->severable) cut(state, link);
    while (link->severable && lar_ucx.ucp_request_check_status(request) == UCS_INPROGRESS &&
           lar_comm_now() < deadline)
        lar_ucx.ucp_worker_progress(state->worker);
    lar_ucx.ucp_request_free(request);
    unlock(state);
    return status;
}

/* Lets UCX work until it no longer needs the caller's memory. */
static lar_status complete(lar_comm *comm, int32_t peer, ucs_status_ptr_t request, uint64_t step,
                           lar_error *error) {
    ucx_state *state = comm->state;
    ucx_link *link = &state->links[peer];
    lar_comm_waited waited = {0};
    for (;;) {
        lock(state);
        lar_ucx.ucp_worker_progress(state->worker);
        ucs_status_t status = lar_ucx.ucp_request_check_status(request);
        if (status != UCS_INPROGRESS) lar_ucx.ucp_request_free(request);
        unlock(state);
        if (status == UCS_OK) return LAR_OK;
        if (status != UCS_INPROGRESS)
            return lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, step, error);
        lar_status lost = lar_comm_check(comm, step, error);
        if (!lost && lar_comm_impatient(comm, &waited))
            lost = lar_comm_give_up(comm, peer, LAR_LOSS_STALLED, step, error);
        if (lost) return abandon(comm, link, request, lost);
        sched_yield();
    }
}

/* The caller holds the lock. */
static ucs_status_ptr_t send_packet(lar_comm *comm, ucx_link *link, const packet_head *head,
                                    const void *data) {
    static const ucp_request_param_t eager = {.op_attr_mask = UCP_OP_ATTR_FIELD_FLAGS,
                                              .flags = UCP_AM_SEND_FLAG_EAGER};
    (void)comm;
    return lar_ucx.ucp_am_send_nbx(link->endpoint, MESSAGE_PACKET, head, sizeof *head, data,
                                   head->bytes, &eager);
}

/* The same with the lock, when no put of the half's last tail is under way. */
static ucs_status_ptr_t put_packet(lar_comm *comm, ucx_link *link, size_t half,
                                   const packet_head *head, const void *data) {
    ucx_state *state = comm->state;
    int parity = (int)(head->step & 1);
    uint64_t there = link->receive + (parity ? half : 0) + head->offset;
    ucp_request_param_t plain = {0}, tail = counted(&link->puts[parity]);
    ucs_status_ptr_t request = NULL;
    if (head->bytes)
        request = lar_ucx.ucp_put_nbx(link->endpoint, data, head->bytes, there, link->key, &plain);
    if (UCS_PTR_IS_ERR(request)) return request;
    lar_ucx.ucp_worker_fence(state->worker);
    link->tails[parity] = head->step;
    ucs_status_ptr_t end =
        lar_ucx.ucp_put_nbx(link->endpoint, &link->tails[parity], sizeof link->tails[parity],
                            there + lar_comm_padded(head->bytes), link->key, &tail);
    count_up(&link->puts[parity], end);
    /* The endpoint has failed; `request` ends by that too. */
    if (UCS_PTR_IS_ERR(end) && !request) return end;
    return request;
}

/* Whether the tail of this parity may be written: it has this step, or nobody reads it. */
static bool tail_is_free(const ucx_link *link, uint64_t step) {
    return link->puts[step & 1] == 0 || link->tails[step & 1] == step;
}

static lar_status ucx_put(lar_comm *comm, int32_t peer, size_t offset, const void *data,
                          size_t bytes, uint64_t step, lar_error *error) {
    ucx_state *state = comm->state;
    ucx_link *link = &state->links[peer];
    packet_head head = {comm->token, offset, bytes, step};
    lar_comm_waited waited = {0};
    lock(state);
    while (link->endpoint && link->way == WAY_PUT && !tail_is_free(link, step)) {
        lar_ucx.ucp_worker_progress(state->worker);
        unlock(state);
        lar_status status = lar_comm_check(comm, step, error);
        if (!status && lar_comm_impatient(comm, &waited))
            status = lar_comm_give_up(comm, peer, LAR_LOSS_STALLED, step, error);
        if (status) return status;
        lock(state);
    }
    ucs_status_ptr_t request = UCS_STATUS_PTR(UCS_ERR_CONNECTION_RESET);
    if (link->endpoint && !__atomic_load_n(&link->failed, __ATOMIC_ACQUIRE))
        request = link->way == WAY_PUT ? put_packet(comm, link, comm->peers[peer].half, &head, data)
                                       : send_packet(comm, link, &head, data);
    unlock(state);
    if (!request) return LAR_OK;
    if (UCS_PTR_IS_ERR(request)) return lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, step, error);
    return complete(comm, peer, request, step, error);
}

static lar_status ucx_progress(lar_comm *comm, int32_t peer) {
    static _Thread_local unsigned turn;
    ucx_state *state = comm->state;
    const ucx_link *link = &state->links[peer];
    turn++;
    /* Others may need what this processor has sent or should take in. */
    if (link->writes && (!state->remote || turn % SELDOM)) {
        lar_comm_relax();
        return LAR_OK;
    }
    if (work(state) == 0 && turn % FRUITLESS == 0) sched_yield();
    bool ended = !link->writes && __atomic_load_n(&link->failed, __ATOMIC_ACQUIRE);
    return ended ? LAR_ERROR_PEER : LAR_OK;
}

/* ---- end ------------------------------------------------------------------------------------ */

static bool talks(const ucx_link *link) {
    return link->endpoint && goes_through_ucx(link) &&
           !__atomic_load_n(&link->failed, __ATOMIC_ACQUIRE);
}

static bool all_have_left(const lar_comm *comm) {
    const ucx_state *state = comm->state;
    if (__atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE)) return true;
    for (int32_t p = 0; p < comm->options.count; p++)
        if (talks(&state->links[p]) && !state->links[p].left) return false;
    return state->pending == 0;
}

static bool all_is_put(const lar_comm *comm) {
    return nothing_pending(comm) || __atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE);
}

static void ucx_leave(lar_comm *comm) {
    ucx_state *state = comm->state;
    if (!state || state->connecting || !state->remote) return;
    double deadline = lar_comm_now() + comm->options.timeout;
    lock(state);
    for (int32_t p = 0; p < comm->options.count; p++) {
        ucp_request_param_t param = counted(&state->pending);
        if (talks(&state->links[p]))
            count_up(&state->pending, lar_ucx.ucp_ep_flush_nbx(state->links[p].endpoint, &param));
    }
    unlock(state);
    if (!lar_ucx_work_until(comm, all_is_put, deadline)) return;
    lock(state);
    for (int32_t p = 0; p < comm->options.count; p++) {
        ucx_link *link = &state->links[p];
        link->bye = (note){comm->token, comm->options.self, NOTE_BYE, 0};
        if (talks(link)) lar_ucx_send_note(state, link, &link->bye);
    }
    unlock(state);
    lar_ucx_work_until(comm, all_have_left, deadline);
}

/* UCX 1.13 ends the process (assertions in ucp_request.c, wireup_ep.c) when endpoints are closed or
 * a worker destroyed while two are still connecting. After a start that was called off all of it
 * stays, untouched until the process ends: memory without names, nothing in the file system. */
static void leave_as_it_is(ucx_state *state) {
    static ucx_state *stay; /* for who looks for lost memory */
    state->earlier = __atomic_exchange_n(&stay, state, __ATOMIC_ACQ_REL);
}

static void ucx_close(lar_comm *comm) {
    ucx_state *state = comm->state;
    if (!state || comm->forked) return; /* UCX does not outlive a fork: its memory stays */
    if (state->connecting && lar_comm_check_interrupt(NULL)) {
        leave_as_it_is(state);
        return;
    }
    bool lost = __atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE) != 0;
    if (state->worker) {
        lock(state);
        for (int32_t p = 0; p < comm->options.count; p++) {
            ucx_link *link = &state->links[p];
            if (link->severable || !lost) cut(state, link);
            if (link->key) lar_ucx.ucp_rkey_destroy(link->key);
        }
        unlock(state);
        lar_ucx_work_until(comm, nothing_pending, lar_comm_now() + CUT_TIME);
        lar_ucx.ucp_worker_destroy(state->worker);
    }
    if (state->memory) lar_ucx.ucp_mem_unmap(state->context, state->memory);
    if (state->context) lar_ucx.ucp_cleanup(state->context);
    free(state->links);
    free(state);
}

#endif

const lar_comm_backend lar_comm_ucx = {.name = "ucx",
                                       .summary = "clusters: InfiniBand, RoCE, shared memory",
#ifdef LAR_HAVE_UCX
                                       .polls = 50,
                                       .open = lar_ucx_open,
                                       .connect = lar_ucx_connect,
                                       .begin = ucx_begin,
                                       .put = ucx_put,
                                       .progress = ucx_progress,
                                       .leave = ucx_leave,
                                       .close = ucx_close
#else
                                       .missing = "this build of Lariat lacks it; install "
                                                  "libucx-dev and build Lariat again"
#endif
};
