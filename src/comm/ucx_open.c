/* UCX in this process, and everyone reaching everyone: open and connect of the backend ucx. */
#ifdef LAR_HAVE_UCX
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "base/memory.h"
#include "comm/rendezvous.h"
#include "comm/ucx_state.h"

static const double LOOK = 0.05; /* while connecting, whether all are still there [s] */

/* Travels in lar_comm_address: the key and the worker's address follow. */
typedef struct ucx_address {
    uint64_t receive;
    uint32_t key_bytes, worker_bytes;
} ucx_address;

/* ---- the library in this process ----------------------------------------------------------- */

enum { ROOM = 8 << 20 /* of shared memory, for each processor [bytes] */ };

static lar_status refuse(const char *what, ucs_status_t why, lar_error *error) {
    struct statvfs room;
    const bool little = statvfs("/dev/shm", &room) == 0 && room.f_bavail < ROOM / room.f_frsize;
    return lar_fail(error, LAR_ERROR_IO, "UCX cannot %s: %s; %s, or use the backend tcp", what,
                    lar_ucx.ucs_status_string(why),
                    little ? "/dev/shm has less than 8 MiB: make room there"
                           : "see what ucx_info -d finds and what the variables UCX_... say");
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

/* ---- start ---------------------------------------------------------------------------------- */

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
    ucs_status_t refused = lar_ucx.ucp_config_read(NULL, NULL, &config);
    if (refused) return refuse("read its settings", refused, error);
    /* Loopback stays loopback: only a master elsewhere makes this processor reachable. */
    if (lar_comm_is_local(comm) && !getenv("UCX_NET_DEVICES"))
        lar_ucx.ucp_config_modify(config, "NET_DEVICES", "lo");
    ucp_params_t params = {.field_mask =
                               UCP_PARAM_FIELD_FEATURES | UCP_PARAM_FIELD_ESTIMATED_NUM_EPS,
                           .features = UCP_FEATURE_RMA | UCP_FEATURE_AM,
                           .estimated_num_eps = (size_t)comm->options.count};
    refused =
        lar_ucx.ucp_init_version(UCP_API_MAJOR, UCP_API_MINOR, &params, config, &state->context);
    lar_ucx.ucp_config_release(config);
    if (refused) return refuse("start", refused, error);
    ucp_worker_params_t worker = {.field_mask = UCP_WORKER_PARAM_FIELD_THREAD_MODE,
                                  .thread_mode = UCS_THREAD_MODE_SERIALIZED};
    refused = lar_ucx.ucp_worker_create(state->context, &worker, &state->worker);
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
        lar_ucx.ucp_worker_set_am_recv_handler(((ucx_state *)comm->state)->worker, &param);
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
    ucs_status_t refused = lar_ucx.ucp_mem_map(state->context, &params, &state->memory);
    if (!refused) refused = lar_ucx.ucp_mem_query(state->memory, &found);
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
    ucs_status_t refused = lar_ucx.ucp_worker_get_address(state->worker, &worker, &worker_bytes);
    if (!refused) refused = lar_ucx.ucp_rkey_pack(state->context, state->memory, &key, &key_bytes);
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
    if (key) lar_ucx.ucp_rkey_buffer_release(key);
    if (worker) lar_ucx.ucp_worker_release_address(state->worker, worker);
    return status;
}

lar_status lar_ucx_open(lar_comm *comm, lar_error *error) {
    lar_status status = lar_ucx_load(error);
    if (status) return status;
    size_t count = (size_t)comm->options.count;
    ucx_state *state = comm->state = lar_calloc(1, sizeof *state);
    if (!state) return lar_fail_memory(error, sizeof *state, "connections");
    atomic_flag_clear(&state->lock);
    state->links = lar_calloc(count, sizeof *state->links);
    if (!state->links) return lar_fail_memory(error, count * sizeof *state->links, "connections");
    status = choose_way(state, error);
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
    ucs_status_t refused = lar_ucx.ucp_ep_create(state->worker, &params, &link->endpoint);
    link->severable = !refused && params.err_mode == UCP_ERR_HANDLING_MODE_PEER;
    if (refused != UCS_ERR_UNREACHABLE && refused != UCS_ERR_UNSUPPORTED) return refused;
    params.err_mode = UCP_ERR_HANDLING_MODE_NONE;
    return lar_ucx.ucp_ep_create(state->worker, &params, &link->endpoint);
}

/* UCX has no question for this that all its versions answer; its description of an endpoint names
 * the transports, as in "lane[0]:  2:rc_mlx5/mlx5_0:1". What is not understood gets messages. */
static bool card_writes_memory(ucp_ep_h endpoint) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    if (!file) return false;
    lar_ucx.ucp_ep_print_info(endpoint, file);
    fclose(file);
    bool found = text && (strstr(text, ":rc_") || strstr(text, ":dc_"));
    (free)(text); /* the C library's own */
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
    /* UCX 1.13 crashes on the key of a process that has ended (ucp_ep_rkey_unpack releases what it
     * has not unpacked): whoever is known to be lost is not asked. */
    lar_status lost = lar_rendezvous_check(comm, error);
    if (lost) return lost;
    if (!refused) refused = lar_ucx.ucp_ep_rkey_unpack(link->endpoint, key, &link->key);
    if (refused)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d cannot reach processor %d by UCX: %s; allow both a common "
                        "network in UCX_TLS and UCX_NET_DEVICES, or use the backend tcp",
                        (int)comm->options.self, (int)p, lar_ucx.ucs_status_string(refused));
    link->receive = head.receive;
    void *there = NULL;
    if (state->first == WAY_DIRECT && !lar_ucx.ucp_rkey_ptr(link->key, head.receive, &there))
        comm->peers[p].direct = there;
    else if (state->first == WAY_PUT)
        link->way = WAY_PUT;
    else
        link->way = state->first == WAY_DIRECT && card_writes_memory(link->endpoint) ? WAY_PUT
                                                                                     : WAY_MESSAGE;
    link->hello = (note){comm->token, comm->options.self, NOTE_HELLO, link->way == WAY_DIRECT};
    lar_ucx_send_note(state, link, &link->hello);
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

lar_status lar_ucx_connect(lar_comm *comm, lar_error *error) {
    ucx_state *state = comm->state;
    int32_t count = comm->options.count;
    lar_status status = LAR_OK;
    state->connecting = true;
    lock(state);
    for (int32_t p = 0; p < count && !status; p++)
        if (p != comm->options.self) status = reach(comm, p, error);
    unlock(state);
    if (status) return status;
    double now, deadline = lar_comm_now() + comm->options.start_timeout;
    do {
        now = lar_comm_now();
        if (lar_ucx_work_until(comm, all_have_greeted, now + LOOK)) break;
    } while (now < deadline && !(status = lar_rendezvous_check(comm, error)));
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
    return LAR_OK;
}

#endif
