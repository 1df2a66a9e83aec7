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
 * measurements. No memory to gather in (room): UCX copies packets of a few kilobytes anyway.
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
 * first. UCX's own (UCS_THREAD_MODE_MULTI) makes every poll wait for it.
 *
 * Losses. An endpoint that fails says so here and ends the waits for that peer; who is silent is
 * noticed by watch.h. UCX itself neither prints nor catches signals nor ends the process.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "comm/backend.h"
#include "comm/meeting.h"

#ifdef LAR_HAVE_UCX
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <ucp/api/ucp.h>
#include <ucs/config/global_opts.h>
#if __has_include(<ucs/debug/debug.h>)
#include <ucs/debug/debug.h>
#endif

enum { MESSAGE_NOTE = 1, MESSAGE_PACKET = 2 };
/* Polls while nothing must come through UCX, and fruitless ones before the processor is yielded. */
enum { SELDOM = 16, FRUITLESS = 4 };
static const double LOOK = 0.05;    /* while connecting, whether all are still there [s] */
static const double CUT_TIME = 0.2; /* until an endpoint is closed by force [s] */

typedef enum ucx_way { WAY_DIRECT, WAY_PUT, WAY_MESSAGE } ucx_way;

/* Travels in lar_comm_address: the key and the worker's address follow. */
typedef struct ucx_address {
    uint64_t receive;
    uint32_t key_bytes, worker_bytes;
} ucx_address;

typedef struct packet_head {
    uint64_t token, offset, bytes, step;
} packet_head;

typedef enum note_kind { NOTE_HELLO = 1, NOTE_BYE } note_kind;
typedef struct note {
    uint64_t token;
    int32_t self;
    uint16_t kind, direct;
} note;

typedef struct ucx_link {
    ucp_ep_h endpoint; /* NULL: none, or cut */
    ucp_rkey_h key;
    uint64_t receive; /* where the peer has its receive buffer */
    ucx_way way;      /* of packets to it */
    bool writes;      /* it writes into our memory: nothing of it comes through UCX */
    bool severable;   /* may be closed by force */
    bool greeted, left;
    int failed;        /* atomic */
    uint64_t tails[2]; /* what the puts under way read, by parity */
    int puts[2];       /* of tails, under way */
    note hello, bye;
} ucx_link;

typedef struct ucx_state {
    ucp_context_h context;
    ucp_worker_h worker;
    ucp_mem_h memory;
    ucx_link *links; /* [count] */
    ucx_way first;   /* that may be chosen */
    bool remote;     /* packets to or from somebody go through UCX */
    bool connected;
    int pending; /* notes, flushes and closings under way */
    atomic_int putters;
    atomic_flag lock; /* over all above that changes, and all of UCX */
} ucx_state;

/* ---- the library in this process ----------------------------------------------------------- */

/* UCX catches the signals of crashes as soon as it is loaded, whether it is used or not. */
__attribute__((constructor)) static void leave_signals_alone(void) {
#if __has_include(<ucs/debug/debug.h>)
    static const int caught[] = {SIGILL, SIGSEGV, SIGBUS, SIGFPE};
    if (getenv("UCX_ERROR_SIGNALS") || getenv("UCX_HANDLE_ERRORS")) return;
    for (int i = 0; i < 4; i++) ucs_debug_disable_signal(caught[i]);
#endif
}

/* What it has to say arrives as a status. The user's own settings stand. */
static void leave_terminal_alone(void) {
    if (!getenv("UCX_LOG_LEVEL")) ucs_global_opts_set_value("LOG_LEVEL", "fatal");
    if (!getenv("UCX_HANDLE_ERRORS")) ucs_global_opts_set_value("HANDLE_ERRORS", "none");
}

static lar_status refuse(const char *what, ucs_status_t why, lar_error *error) {
    return lar_fail(error, LAR_ERROR_IO,
                    "UCX cannot %s: %s; see what ucx_info -d finds and what the variables UCX_... "
                    "say, or use the backend tcp",
                    what, ucs_status_string(why));
}

static void lock(ucx_state *state) {
    atomic_fetch_add_explicit(&state->putters, 1, memory_order_relaxed);
    while (atomic_flag_test_and_set_explicit(&state->lock, memory_order_acquire)) sched_yield();
    atomic_fetch_sub_explicit(&state->putters, 1, memory_order_relaxed);
}

static void unlock(ucx_state *state) {
    atomic_flag_clear_explicit(&state->lock, memory_order_release);
}

/* Lets UCX work once, unless somebody else does or wants to put. Returns what happened. */
static unsigned work(ucx_state *state) {
    if (atomic_load_explicit(&state->putters, memory_order_relaxed) > 0 ||
        atomic_flag_test_and_set_explicit(&state->lock, memory_order_acquire))
        return 0;
    unsigned events = ucp_worker_progress(state->worker);
    unlock(state);
    return events;
}

/* ---- what comes ---------------------------------------------------------------------------- */

static ucs_status_t take_note(void *context, const void *header, size_t header_bytes, void *data,
                              size_t bytes, const ucp_am_recv_param_t *param) {
    (void)data, (void)bytes, (void)param;
    lar_comm *comm = context;
    ucx_state *state = comm->state;
    note n;
    if (header_bytes != sizeof n) return UCS_OK; /* a stranger */
    memcpy(&n, header, sizeof n);
    if (n.token != comm->token || n.self < 0 || n.self >= comm->options.count) return UCS_OK;
    ucx_link *link = &state->links[n.self];
    if (n.kind == NOTE_BYE) {
        link->left = true;
        return UCS_OK;
    }
    link->writes = n.direct;
    link->greeted = true;
    return UCS_OK;
}

static ucs_status_t take_packet(void *context, const void *header, size_t header_bytes, void *data,
                                size_t bytes, const ucp_am_recv_param_t *param) {
    (void)param;
    lar_comm *comm = context;
    size_t half = comm->options.receive_bytes;
    packet_head head;
    if (header_bytes != sizeof head) return UCS_OK; /* a stranger */
    memcpy(&head, header, sizeof head);
    if (head.token != comm->token || head.step == 0 || head.bytes != bytes ||
        !lar_comm_fits(half, head.offset, head.bytes))
        return UCS_OK;
    if (bytes) memcpy(comm->receive + (head.step & 1 ? half : 0) + head.offset, data, bytes);
    uint64_t *tail = lar_comm_tail(comm->receive, half, head.offset, head.bytes, head.step);
    __atomic_store_n(tail, head.step, __ATOMIC_RELEASE);
    return UCS_OK;
}

static void endpoint_failed(void *context, ucp_ep_h endpoint, ucs_status_t why) {
    (void)endpoint, (void)why;
    __atomic_store_n(&((ucx_link *)context)->failed, 1, __ATOMIC_RELEASE);
}

/* ---- what is under way ---------------------------------------------------------------------- */

/* Ends an operation that `user` counts. */
static void count_down(void *request, ucs_status_t status, void *user) {
    (void)status;
    --*(int *)user;
    ucp_request_free(request);
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

static void send_note(ucx_state *state, ucx_link *link, const note *n) {
    ucp_request_param_t param = counted(&state->pending);
    param.op_attr_mask |= UCP_OP_ATTR_FIELD_FLAGS;
    param.flags = UCP_AM_SEND_FLAG_EAGER;
    count_up(&state->pending,
             ucp_am_send_nbx(link->endpoint, MESSAGE_NOTE, n, sizeof *n, NULL, 0, &param));
}

static void cut(ucx_state *state, ucx_link *link) {
    ucp_request_param_t param = counted(&state->pending);
    param.op_attr_mask |= UCP_OP_ATTR_FIELD_FLAGS;
    param.flags = link->severable ? UCP_EP_CLOSE_FLAG_FORCE : 0;
    if (link->endpoint) count_up(&state->pending, ucp_ep_close_nbx(link->endpoint, &param));
    link->endpoint = NULL;
}

typedef bool (*condition)(const lar_comm *comm);

static bool work_until(lar_comm *comm, condition fulfilled, double deadline) {
    ucx_state *state = comm->state;
    for (;;) {
        lock(state);
        unsigned events = ucp_worker_progress(state->worker);
        bool done = fulfilled(comm);
        unlock(state);
        if (done || lar_comm_now() > deadline) return done;
        if (!events) sched_yield();
    }
}

static bool nothing_pending(const lar_comm *comm) {
    return ((const ucx_state *)comm->state)->pending == 0;
}

/* ---- start ---------------------------------------------------------------------------------- */

/* In either direction. */
static bool goes_through_ucx(const ucx_link *link) {
    return !link->writes || link->way != WAY_DIRECT;
}

static lar_status choose_way(ucx_state *state, lar_error *error) {
    const char *wanted = getenv("LARIAT_UCX");
    state->first = WAY_DIRECT;
    if (!wanted || !*wanted) return LAR_OK;
    state->first = strcmp(wanted, "put") == 0 ? WAY_PUT : WAY_MESSAGE;
    if (state->first == WAY_PUT || strcmp(wanted, "message") == 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "LARIAT_UCX=%s in the environment; set it to put or message, or not at all",
                    wanted);
}

static lar_status start_context(lar_comm *comm, lar_error *error) {
    ucx_state *state = comm->state;
    ucp_config_t *config = NULL;
    ucs_status_t refused = ucp_config_read(NULL, NULL, &config);
    if (refused) return refuse("read its settings", refused, error);
    /* Loopback stays loopback: only a master elsewhere makes this processor reachable. */
    if (lar_comm_is_local(comm) && !getenv("UCX_NET_DEVICES"))
        ucp_config_modify(config, "NET_DEVICES", "lo");
    ucp_params_t params = {.field_mask =
                               UCP_PARAM_FIELD_FEATURES | UCP_PARAM_FIELD_ESTIMATED_NUM_EPS,
                           .features = UCP_FEATURE_RMA | UCP_FEATURE_AM,
                           .estimated_num_eps = (size_t)comm->options.count};
    refused = ucp_init(&params, config, &state->context);
    ucp_config_release(config);
    if (refused) return refuse("start", refused, error);
    ucp_worker_params_t worker = {.field_mask = UCP_WORKER_PARAM_FIELD_THREAD_MODE,
                                  .thread_mode = UCS_THREAD_MODE_SERIALIZED};
    refused = ucp_worker_create(state->context, &worker, &state->worker);
    return refused ? refuse("create a worker", refused, error) : LAR_OK;
}

static lar_status set_handler(lar_comm *comm, unsigned id, ucp_am_recv_callback_t handler,
                              lar_error *error) {
    ucp_am_handler_param_t param = {.field_mask = UCP_AM_HANDLER_PARAM_FIELD_ID |
                                                  UCP_AM_HANDLER_PARAM_FIELD_CB |
                                                  UCP_AM_HANDLER_PARAM_FIELD_ARG,
                                    .id = id,
                                    .cb = handler,
                                    .arg = comm};
    ucs_status_t refused =
        ucp_worker_set_am_recv_handler(((ucx_state *)comm->state)->worker, &param);
    return refused ? refuse("take messages", refused, error) : LAR_OK;
}

/* UCX takes memory that others on this machine can map, where it can. */
static lar_status take_memory(lar_comm *comm, lar_error *error) {
    ucx_state *state = comm->state;
    size_t bytes = 2 * comm->options.receive_bytes;
    if (bytes == 0) bytes = 8;
    ucp_mem_map_params_t params = {.field_mask = UCP_MEM_MAP_PARAM_FIELD_LENGTH |
                                                 UCP_MEM_MAP_PARAM_FIELD_FLAGS,
                                   .length = bytes,
                                   .flags = UCP_MEM_MAP_ALLOCATE};
    ucp_mem_attr_t found = {.field_mask = UCP_MEM_ATTR_FIELD_ADDRESS};
    ucs_status_t refused = ucp_mem_map(state->context, &params, &state->memory);
    if (!refused) refused = ucp_mem_query(state->memory, &found);
    if (refused) return refuse("give memory for a receive buffer", refused, error);
    comm->receive = found.address;
    memset(comm->receive, 0, bytes);
    return LAR_OK;
}

static lar_status write_address(lar_comm *comm, lar_error *error) {
    ucx_state *state = comm->state;
    lar_comm_address *own = &comm->addresses[comm->options.self];
    ucx_address head = {.receive = (uintptr_t)comm->receive};
    ucp_address_t *worker = NULL;
    void *key = NULL;
    size_t worker_bytes = 0, key_bytes = 0;
    ucs_status_t refused = ucp_worker_get_address(state->worker, &worker, &worker_bytes);
    if (!refused) refused = ucp_rkey_pack(state->context, state->memory, &key, &key_bytes);
    lar_status status = LAR_OK;
    size_t bytes = sizeof head + key_bytes + worker_bytes;
    if (refused) {
        status = refuse("tell its address", refused, error);
    } else if (bytes > sizeof own->data) {
        status = lar_fail(error, LAR_ERROR_UNSUPPORTED,
                          "the address of processor %d takes %zu bytes, %zu are provided for; name "
                          "fewer networks in the variable UCX_NET_DEVICES",
                          (int)comm->options.self, bytes, sizeof own->data);
    } else {
        head.key_bytes = (uint32_t)key_bytes;
        head.worker_bytes = (uint32_t)worker_bytes;
        own->bytes = (uint32_t)bytes;
        memcpy(own->data, &head, sizeof head);
        memcpy(own->data + sizeof head, key, key_bytes);
        memcpy(own->data + sizeof head + key_bytes, worker, worker_bytes);
    }
    if (key) ucp_rkey_buffer_release(key);
    if (worker) ucp_worker_release_address(state->worker, worker);
    return status;
}

static lar_status ucx_start(lar_comm *comm, lar_error *error) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, leave_terminal_alone);
    size_t count = (size_t)comm->options.count;
    ucx_state *state = comm->state = lar_calloc(1, sizeof *state);
    if (!state) return lar_fail_memory(error, sizeof *state, "connections");
    atomic_flag_clear(&state->lock);
    state->links = lar_calloc(count, sizeof *state->links);
    if (!state->links) return lar_fail_memory(error, count * sizeof *state->links, "connections");
    lar_status status = choose_way(state, error);
    if (!status) status = start_context(comm, error);
    if (!status) status = set_handler(comm, MESSAGE_NOTE, take_note, error);
    if (!status) status = set_handler(comm, MESSAGE_PACKET, take_packet, error);
    if (!status) status = take_memory(comm, error);
    return status ? status : write_address(comm, error);
}

/* ---- connecting ----------------------------------------------------------------------------- */

/* Failures are reported where the network can: shared memory alone cannot. When puts are forced,
 * shared memory goes first: it has real ones, and UCX ends the process when a peer is lost to whom
 * it puts by messages. */
static ucs_status_t create_endpoint(ucx_state *state, ucx_link *link, const void *address) {
    ucp_ep_params_t params = {.field_mask = UCP_EP_PARAM_FIELD_REMOTE_ADDRESS |
                                            UCP_EP_PARAM_FIELD_ERR_HANDLER |
                                            UCP_EP_PARAM_FIELD_ERR_HANDLING_MODE,
                              .address = address,
                              .err_mode = state->first == WAY_PUT ? UCP_ERR_HANDLING_MODE_NONE
                                                                  : UCP_ERR_HANDLING_MODE_PEER,
                              .err_handler = {.cb = endpoint_failed, .arg = link}};
    ucs_status_t refused = ucp_ep_create(state->worker, &params, &link->endpoint);
    link->severable = !refused && params.err_mode == UCP_ERR_HANDLING_MODE_PEER;
    if (refused != UCS_ERR_UNREACHABLE && refused != UCS_ERR_UNSUPPORTED) return refused;
    params.err_mode = UCP_ERR_HANDLING_MODE_NONE;
    return ucp_ep_create(state->worker, &params, &link->endpoint);
}

/* UCX has no question for this that all its versions answer; its description of an endpoint names
 * the transports, as in "lane[0]:  2:rc_mlx5/mlx5_0:1". What is not understood gets messages. */
static bool card_writes_memory(ucp_ep_h endpoint) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    if (!file) return false;
    ucp_ep_print_info(endpoint, file);
    fclose(file);
    bool found = text && (strstr(text, ":rc_") || strstr(text, ":dc_"));
    free(text);
    return found;
}

static lar_status reach(lar_comm *comm, int32_t p, lar_error *error) {
    ucx_state *state = comm->state;
    ucx_link *link = &state->links[p];
    const lar_comm_address *address = &comm->addresses[p];
    ucx_address head;
    memcpy(&head, address->data, sizeof head);
    if (sizeof head + head.key_bytes + (size_t)head.worker_bytes != address->bytes)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d sent an address that is none; install the same version of "
                        "Lariat and UCX on all machines",
                        (int)p);
    const unsigned char *key = address->data + sizeof head;
    ucs_status_t refused = create_endpoint(state, link, key + head.key_bytes);
    if (!refused) refused = ucp_ep_rkey_unpack(link->endpoint, key, &link->key);
    if (refused)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d cannot reach processor %d by UCX: %s; allow both a common "
                        "network in UCX_TLS and UCX_NET_DEVICES, or use the backend tcp",
                        (int)comm->options.self, (int)p, ucs_status_string(refused));
    link->receive = head.receive;
    void *there = NULL;
    if (state->first == WAY_DIRECT && !ucp_rkey_ptr(link->key, head.receive, &there))
        comm->peers[p].direct = there;
    else if (state->first == WAY_PUT)
        link->way = WAY_PUT;
    else
        link->way = state->first == WAY_DIRECT && card_writes_memory(link->endpoint) ? WAY_PUT
                                                                                     : WAY_MESSAGE;
    link->hello = (note){comm->token, comm->options.self, NOTE_HELLO, link->way == WAY_DIRECT};
    send_note(state, link, &link->hello);
    return LAR_OK;
}

static bool all_have_greeted(const lar_comm *comm) {
    const ucx_state *state = comm->state;
    for (int32_t p = 0; p < comm->options.count; p++) {
        const ucx_link *link = &state->links[p];
        if (p == comm->options.self) continue;
        if (!link->greeted && !__atomic_load_n(&link->failed, __ATOMIC_ACQUIRE)) return false;
    }
    return state->pending == 0;
}

static lar_status ucx_connect(lar_comm *comm, lar_error *error) {
    ucx_state *state = comm->state;
    int32_t count = comm->options.count;
    lar_status status = LAR_OK;
    lock(state);
    for (int32_t p = 0; p < count && !status; p++)
        if (p != comm->options.self) status = reach(comm, p, error);
    unlock(state);
    if (status) return status;
    double now, deadline = lar_comm_now() + comm->options.start_timeout;
    do {
        now = lar_comm_now();
        if (work_until(comm, all_have_greeted, now + LOOK)) break;
    } while (now < deadline && !(status = lar_meeting_check(comm, error)));
    if (status) return status;
    state->links[comm->options.self].greeted = state->links[comm->options.self].writes = true;
    for (int32_t p = 0; p < count; p++) {
        const ucx_link *link = &state->links[p];
        if (!link->greeted)
            return lar_fail(error, LAR_ERROR_PEER,
                            "processor %d did not hear from processor %d by UCX within %g s; check "
                            "the network between them, or use the backend tcp",
                            (int)comm->options.self, (int)p, comm->options.start_timeout);
        if (p != comm->options.self && goes_through_ucx(link)) state->remote = true;
    }
    state->connected = true;
    return LAR_OK;
}

/* Between two that write each other's memory no network is needed any more. */
static void ucx_begin(lar_comm *comm) {
    ucx_state *state = comm->state;
    lock(state);
    for (int32_t p = 0; p < comm->options.count; p++)
        if (!goes_through_ucx(&state->links[p]) && state->links[p].severable)
            cut(state, &state->links[p]);
    unlock(state);
    work_until(comm, nothing_pending, lar_comm_now() + CUT_TIME);
}

/* ---- put and progress ----------------------------------------------------------------------- */

/* A put that cannot go on: waits until UCX no longer reads the caller's memory. */
static lar_status abandon(lar_comm *comm, ucx_link *link, ucs_status_ptr_t request,
                          lar_status status) {
    ucx_state *state = comm->state;
    double deadline = lar_comm_now() + CUT_TIME;
    lock(state);
    if (link->severable) cut(state, link);
    while (link->severable && ucp_request_check_status(request) == UCS_INPROGRESS &&
           lar_comm_now() < deadline)
        ucp_worker_progress(state->worker);
    ucp_request_free(request);
    unlock(state);
    return status;
}

/* Lets UCX work until it no longer needs the caller's memory. */
static lar_status complete(lar_comm *comm, int32_t peer, ucs_status_ptr_t request, uint64_t step,
                           lar_error *error) {
    ucx_state *state = comm->state;
    ucx_link *link = &state->links[peer];
    double deadline = lar_comm_now() + comm->options.patience;
    for (;;) {
        lock(state);
        ucp_worker_progress(state->worker);
        ucs_status_t status = ucp_request_check_status(request);
        if (status != UCS_INPROGRESS) ucp_request_free(request);
        unlock(state);
        if (status == UCS_OK) return LAR_OK;
        if (status != UCS_INPROGRESS)
            return lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, step, error);
        lar_status lost = lar_comm_check(comm, step, error);
        if (!lost && lar_comm_now() > deadline)
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
    return ucp_am_send_nbx(link->endpoint, MESSAGE_PACKET, head, sizeof *head, data, head->bytes,
                           &eager);
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
        request = ucp_put_nbx(link->endpoint, data, head->bytes, there, link->key, &plain);
    if (UCS_PTR_IS_ERR(request)) return request;
    ucp_worker_fence(state->worker);
    link->tails[parity] = head->step;
    ucs_status_ptr_t end =
        ucp_put_nbx(link->endpoint, &link->tails[parity], sizeof link->tails[parity],
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
    double deadline = 0;
    lock(state);
    while (link->endpoint && link->way == WAY_PUT && !tail_is_free(link, step)) {
        ucp_worker_progress(state->worker);
        unlock(state);
        lar_status status = lar_comm_check(comm, step, error);
        double now = lar_comm_now();
        if (deadline == 0) deadline = now + comm->options.patience;
        if (!status && now > deadline)
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
    if (!state || !state->connected || !state->remote) return;
    double deadline = lar_comm_now() + comm->options.timeout;
    lock(state);
    for (int32_t p = 0; p < comm->options.count; p++) {
        ucp_request_param_t param = counted(&state->pending);
        if (talks(&state->links[p]))
            count_up(&state->pending, ucp_ep_flush_nbx(state->links[p].endpoint, &param));
    }
    unlock(state);
    if (!work_until(comm, all_is_put, deadline)) return;
    lock(state);
    for (int32_t p = 0; p < comm->options.count; p++) {
        ucx_link *link = &state->links[p];
        link->bye = (note){comm->token, comm->options.self, NOTE_BYE, 0};
        if (talks(link)) send_note(state, link, &link->bye);
    }
    unlock(state);
    work_until(comm, all_have_left, deadline);
}

static void ucx_close(lar_comm *comm) {
    ucx_state *state = comm->state;
    if (!state) return;
    bool lost = __atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE) != 0;
    if (state->worker) {
        lock(state);
        for (int32_t p = 0; p < comm->options.count; p++) {
            ucx_link *link = &state->links[p];
            if (link->severable || !lost) cut(state, link);
            if (link->key) ucp_rkey_destroy(link->key);
        }
        unlock(state);
        work_until(comm, nothing_pending, lar_comm_now() + CUT_TIME);
        ucp_worker_destroy(state->worker);
    }
    if (state->memory) ucp_mem_unmap(state->context, state->memory);
    if (state->context) ucp_cleanup(state->context);
    free(state->links);
    free(state);
}

#endif

const lar_comm_backend lar_comm_ucx = {.name = "ucx",
                                       .summary = "clusters: InfiniBand, RoCE, shared memory",
#ifdef LAR_HAVE_UCX
                                       .polls = 50,
                                       .open = ucx_start,
                                       .connect = ucx_connect,
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
