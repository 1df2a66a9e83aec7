/* Anywhere at all: one TCP connection between any two processors.
 *
 *     | offset 8 | bytes 8 | step 8 | payload ... |      then the next packet
 *
 * The reader copies the payload to where the sender says and stores the tail itself, while somebody
 * waits (progress). A sender whose connection is full reads meanwhile, so two processors that send
 * to each other cannot block each other. Connections: the higher number calls the lower.
 */
#include <errno.h>
#include <poll.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/socket.h"
#include "comm/backend.h"
#include "comm/rendezvous.h"

enum { CHUNK = 65536, ALL_EVERY = 16 };

typedef struct packet_head {
    uint64_t offset, bytes, step;
} packet_head;

/* First words on a connection. */
typedef struct caller {
    uint64_t token;
    int32_t self, spare;
} caller;

typedef struct tcp_link {
    int socket;
    bool ended;          /* nothing more will come */
    atomic_flag sending; /* one thread writes a packet at a time */
    packet_head head;    /* of the packet that is coming in */
    size_t head_filled, payload_filled;
} tcp_link;

typedef struct tcp_state {
    int listener;
    tcp_link *links;      /* [count] */
    atomic_flag reading;  /* one thread reads at a time */
    unsigned turn;        /* of the reader */
    unsigned char *chunk; /* [CHUNK] */
} tcp_state;

/* ---- start and end ------------------------------------------------------------------------ */

static lar_status tcp_start(lar_comm *comm, lar_error *error) {
    size_t count = (size_t)comm->options.count, bytes = 2 * comm->options.receive_bytes;
    tcp_state *state = comm->state = lar_calloc(1, sizeof *state);
    if (!state) return lar_fail_memory(error, sizeof *state, "connections");
    state->listener = -1;
    atomic_flag_clear(&state->reading);
    state->links = lar_calloc(count, sizeof *state->links);
    state->chunk = lar_calloc(CHUNK, 1);
    comm->receive = lar_calloc_aligned(bytes ? bytes : 8, 1);
    if (!state->links || !state->chunk || !comm->receive)
        return lar_fail_memory(error, bytes + CHUNK, "a receive buffer");
    for (size_t p = 0; p < count; p++) {
        state->links[p].socket = -1;
        atomic_flag_clear(&state->links[p].sending);
    }
    if (count == 1) return LAR_OK;
    /* Loopback stays loopback: only a master elsewhere makes this processor reachable. */
    const char *master = comm->options.master;
    bool local = lar_comm_is_local(comm);
    bool six = master && master[0] == '[';
    const char *at = six ? local ? "[::1]:0" : "[::]:0" : local ? "127.0.0.1:0" : "0.0.0.0:0";
    lar_status status = lar_socket_listen(at, &state->listener, error);
    if (status) return status;
    lar_comm_address *own = &comm->addresses[comm->options.self];
    own->bytes = (uint32_t)snprintf((char *)own->data, sizeof own->data, "%d",
                                    lar_socket_port(state->listener));
    return LAR_OK;
}

static lar_status call(lar_comm *comm, int32_t p, double deadline, lar_error *error) {
    tcp_state *state = comm->state;
    lar_comm_address *to = &comm->addresses[p];
    char address[LAR_COMM_ADDRESS_TEXT];
    to->host[sizeof to->host - 1] = '\0';
    snprintf(address, sizeof address, strchr(to->host, ':') ? "[%s]:%.7s" : "%s:%.7s", to->host,
             (const char *)to->data);
    int *socket = &state->links[p].socket;
    for (;;) {
        double look = lar_comm_now() + 0.5;
        if (look > deadline) look = deadline;
        lar_status status = lar_rendezvous_call(p, address, look, socket, error);
        if (!status) break;
        if (lar_comm_now() > deadline || lar_rendezvous_check(comm, error)) return LAR_ERROR_PEER;
    }
    caller c = {.token = comm->token, .self = comm->options.self};
    if (lar_socket_send(*socket, &c, sizeof c, deadline))
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d does not take the call of processor %d at %s; check the "
                        "network between them",
                        (int)p, (int)comm->options.self, address);
    return LAR_OK;
}

static lar_status take_call(lar_comm *comm, double deadline, int32_t *missing, lar_error *error) {
    tcp_state *state = comm->state;
    int socket;
    lar_status status = lar_rendezvous_accept(comm, state->listener, deadline, &socket, error);
    if (status) return status;
    if (socket < 0)
        return lar_fail(error, LAR_ERROR_PEER,
                        "%d processors could not call processor %d within %g s; check the network "
                        "between them",
                        (int)*missing, (int)comm->options.self, comm->options.start_timeout);
    caller c;
    if (lar_socket_receive(socket, &c, sizeof c, lar_comm_now() + 1) || c.token != comm->token ||
        c.self <= comm->options.self || c.self >= comm->options.count ||
        state->links[c.self].socket >= 0) {
        close(socket); /* a stranger */
        return LAR_OK;
    }
    state->links[c.self].socket = socket;
    --*missing;
    return LAR_OK;
}

static lar_status tcp_connect(lar_comm *comm, lar_error *error) {
    double deadline = lar_comm_now() + comm->options.start_timeout;
    lar_status status = LAR_OK;
    for (int32_t p = 0; p < comm->options.self && !status; p++)
        status = call(comm, p, deadline, error);
    int32_t missing = comm->options.count - 1 - comm->options.self;
    while (!status && missing > 0) status = take_call(comm, deadline, &missing, error);
    return status;
}

static void tcp_begin(lar_comm *comm) {
    tcp_state *state = comm->state;
    if (state->listener >= 0) close(state->listener);
    state->listener = -1;
}

/* Closing a connection that holds unread bytes would take back what was sent last: everyone first
 * ends its own direction and reads until the others have. */
static void drain(lar_comm *comm) {
    tcp_state *state = comm->state;
    int32_t count = comm->options.count;
    for (int32_t p = 0; p < count; p++)
        if (state->links[p].socket >= 0) shutdown(state->links[p].socket, SHUT_WR);
    if (__atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE)) return;
    double deadline = lar_comm_now() + comm->options.timeout;
    for (int32_t p = 0; p < count; p++) {
        while (state->links[p].socket >= 0 && !state->links[p].ended &&
               lar_socket_receive(state->links[p].socket, state->chunk, 1, deadline) ==
                   LAR_SOCKET_DONE)
            continue;
    }
}

static void tcp_close(lar_comm *comm) {
    tcp_state *state = comm->state;
    if (!state) return;
    tcp_begin(comm);
    if (state->links && state->chunk && !comm->forked) drain(comm);
    for (int32_t p = 0; state->links && p < comm->options.count; p++)
        if (state->links[p].socket >= 0) close(state->links[p].socket);
    free(state->links);
    free(state->chunk);
    free(comm->receive);
    free(state);
}

/* ---- reading ------------------------------------------------------------------------------- */

/* Takes some of the bytes at `at`; returns how many. 0: they are no packet of ours. */
static size_t take_bytes(lar_comm *comm, tcp_link *link, const unsigned char *at, size_t bytes) {
    size_t half = comm->options.receive_bytes;
    packet_head *head = &link->head;
    size_t used = 0;
    if (link->head_filled < sizeof *head) {
        used = sizeof *head - link->head_filled;
        if (used > bytes) used = bytes;
        memcpy((char *)head + link->head_filled, at, used);
        link->head_filled += used;
        if (link->head_filled < sizeof *head) return used;
        link->payload_filled = 0;
        if (head->step == 0 || !lar_comm_fits(half, head->offset, head->bytes)) return 0;
    }
    size_t rest = head->bytes - link->payload_filled;
    if (rest > bytes - used) rest = bytes - used;
    unsigned char *there = comm->receive + (head->step & 1 ? half : 0) + head->offset;
    memcpy(there + link->payload_filled, at + used, rest);
    link->payload_filled += rest;
    if (link->payload_filled == head->bytes) {
        uint64_t *tail = lar_comm_tail(comm->receive, half, head->offset, head->bytes, head->step);
        __atomic_store_n(tail, head->step, __ATOMIC_RELEASE);
        link->head_filled = 0;
    }
    return used + rest;
}

/* Reads what has come from one peer. */
static void read_peer(lar_comm *comm, int32_t p) {
    tcp_state *state = comm->state;
    tcp_link *link = &state->links[p];
    while (link->socket >= 0 && !link->ended) {
        ssize_t got = recv(link->socket, state->chunk, CHUNK, 0);
        if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return;
        if (got <= 0) link->ended = true;
        for (size_t at = 0; got > 0 && at < (size_t)got;) {
            size_t used = take_bytes(comm, link, state->chunk + at, (size_t)got - at);
            if (used == 0) link->ended = true;
            if (used == 0) break;
            at += used;
        }
        if (got < CHUNK) return;
    }
}

/* Reads from the awaited peer, now and then from all. The caller holds `reading`. */
static void read_some(lar_comm *comm, int32_t peer, bool all) {
    tcp_state *state = comm->state;
    if (peer != comm->options.self) read_peer(comm, peer);
    if (all || ++state->turn % ALL_EVERY == 0)
        for (int32_t p = 0; p < comm->options.count; p++) read_peer(comm, p);
}

static lar_status tcp_progress(lar_comm *comm, int32_t peer) {
    tcp_state *state = comm->state;
    if (atomic_flag_test_and_set_explicit(&state->reading, memory_order_acquire)) return LAR_OK;
    read_some(comm, peer, false);
    bool ended = peer != comm->options.self && state->links[peer].ended;
    atomic_flag_clear_explicit(&state->reading, memory_order_release);
    return ended ? LAR_ERROR_PEER : LAR_OK;
}

/* ---- writing ------------------------------------------------------------------------------- */

static lar_status write_packet(lar_comm *comm, int32_t peer, struct iovec parts[2], uint64_t step,
                               lar_error *error) {
    tcp_state *state = comm->state;
    int socket = state->links[peer].socket;
    lar_comm_waited waited = {0};
    size_t left = parts[0].iov_len + parts[1].iov_len;
    while (left > 0) {
        struct msghdr message = {.msg_iov = parts, .msg_iovlen = 2};
        ssize_t sent = sendmsg(socket, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
            return lar_comm_give_up(comm, peer, LAR_LOSS_ENDED, step, error);
        if (sent < 0) {
            if (!atomic_flag_test_and_set_explicit(&state->reading, memory_order_acquire)) {
                read_some(comm, peer, true);
                atomic_flag_clear_explicit(&state->reading, memory_order_release);
            }
            sched_yield();
            lar_status status = lar_comm_check(comm, step, error);
            if (status) return status;
            if (lar_comm_impatient(comm, &waited))
                return lar_comm_give_up(comm, peer, LAR_LOSS_STALLED, step, error);
            continue;
        }
        left -= (size_t)sent;
        for (int i = 0; i < 2; i++) {
            size_t part = (size_t)sent < parts[i].iov_len ? (size_t)sent : parts[i].iov_len;
            if (part) parts[i].iov_base = (char *)parts[i].iov_base + part;
            parts[i].iov_len -= part;
            sent -= (ssize_t)part;
        }
    }
    return LAR_OK;
}

static lar_status tcp_put(lar_comm *comm, int32_t peer, size_t offset, const void *data,
                          size_t bytes, uint64_t step, lar_error *error) {
    tcp_link *link = &((tcp_state *)comm->state)->links[peer];
    packet_head head = {offset, bytes, step};
    struct iovec parts[2] = {{&head, sizeof head}, {(void *)(uintptr_t)data, bytes}};
    while (atomic_flag_test_and_set_explicit(&link->sending, memory_order_acquire)) sched_yield();
    lar_status status = write_packet(comm, peer, parts, step, error);
    atomic_flag_clear_explicit(&link->sending, memory_order_release);
    return status;
}

const lar_comm_backend lar_comm_tcp = {.name = "tcp",
                                       .summary = "anywhere at all, sockets",
                                       .polls = 4,
                                       .open = tcp_start,
                                       .connect = tcp_connect,
                                       .begin = tcp_begin,
                                       .put = tcp_put,
                                       .progress = tcp_progress,
                                       .close = tcp_close};
