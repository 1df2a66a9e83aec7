/* A device on the network: a position in, a force out, each in one datagram (device_packet.h).
 *
 *     engine's thread, every tick:
 *       poll   recvmmsg, no waiting: what has come since the last tick, at most READ_MAX
 *       feel   sendmmsg: one answer for every position that was taken
 *
 * No thread of its own: a force is known only when the tick is done, so a receiver that is woken by
 * every packet could answer no earlier, and would cost a switch of threads for each on a machine
 * where the engine may need all cores. When a packet came is told by the kernel's time stamp, not
 * by when the engine looked; so the answer time below is what the device sees, but for the wire.
 *
 * A flood: no more than READ_MAX packets are read in a tick. When there are as many, and
 * somebody owns the device, the socket is connected to the owner, and the kernel drops all others
 * before they take room in its queue, until the owner has gone.
 */
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/histogram.h"
#include "base/memory.h"
#include "session/device/backend.h"
#include "session/device/link.h"

enum { READ_MAX = 32 };

/* One more byte than a packet has, so that longer ones are seen to be longer. */
enum { ROOM = LAR_PACKET_BYTES + 1, CONTROL = 64 };

typedef struct udp_answer {
    uint32_t sequence;
    uint64_t time;
    int64_t came; /* CLOCK_REALTIME [ns] */
} udp_answer;

typedef struct udp_state {
    int socket, port;
    bool only_owner; /* connected: the kernel drops packets of others */
    lar_link link;
    struct sockaddr_storage bound, owner;
    socklen_t bound_bytes, owner_bytes;
    int due; /* answers */
    udp_answer answer[READ_MAX];
    udp_answer last;  /* taken: what is said while a force fades */
    bool tells;       /* something has left in the last udp_feel */
    int said_nothing; /* answers of zero since the force has faded */
    uint64_t answered;
    lar_histogram answer_time;
    struct mmsghdr message[READ_MAX];
    struct iovec vector[READ_MAX];
    struct sockaddr_storage from[READ_MAX];
    unsigned char bytes[READ_MAX][ROOM];
    _Alignas(struct cmsghdr) unsigned char control[READ_MAX][CONTROL];
} udp_state;

static int64_t real_time(void) {
    struct timespec at;
    clock_gettime(CLOCK_REALTIME, &at);
    return (int64_t)at.tv_sec * 1000000000 + at.tv_nsec;
}

/* ---- opening --------------------------------------------------------------------------------- */

static bool is_loopback(const struct sockaddr *address) {
    if (address->sa_family == AF_INET)
        return ntohl(((const struct sockaddr_in *)(const void *)address)->sin_addr.s_addr) >> 24 ==
               127;
    return address->sa_family == AF_INET6 &&
           IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)(const void *)address)->sin6_addr);
}

/* "127.0.0.1:9000", "localhost:9000", "[::1]:9000". */
static lar_status find_address(const lar_device_spec *spec, struct addrinfo **found,
                               lar_error *error) {
    char host[256];
    const char *text = spec->argument, *port = strrchr(text, ':');
    size_t length = port ? (size_t)(port - text) : 0;
    if (length > 2 && text[0] == '[' && text[length - 1] == ']') text++, length -= 2;
    char *stop = NULL;
    long number = port && port[1] >= '0' && port[1] <= '9' ? strtol(port + 1, &stop, 10) : -1;
    if (length == 0 || length >= sizeof host || number < 0 || number > 65535 || *stop != '\0')
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "device '%s': after udp: an address and a port are wanted, as in "
                        "udp:127.0.0.1:9000; port 0 takes a free one",
                        spec->text);
    memcpy(host, text, length);
    host[length] = '\0';
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_PASSIVE | AI_NUMERICSERV};
    int refused = getaddrinfo(host, port + 1, &hints, found);
    if (refused)
        return lar_fail(error, LAR_ERROR_IO, "device '%s': no such address: %s", spec->text,
                        gai_strerror(refused));
    if (is_loopback((*found)->ai_addr) || spec->token) return LAR_OK;
    freeaddrinfo(*found);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "device '%s': anybody who reaches this address could move the tool; use "
                    "127.0.0.1, or add ,token=... of 8 to 16 characters that the device sends "
                    "along",
                    spec->text);
}

static lar_status bind_socket(udp_state *state, const lar_device_spec *spec, lar_error *error) {
    struct addrinfo *found = NULL;
    lar_status status = find_address(spec, &found, error);
    if (status) return status;
    struct sockaddr_storage *bound = &state->bound;
    int yes = 1;
    state->bound_bytes = sizeof *bound;
    state->socket = socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (state->socket < 0 || bind(state->socket, found->ai_addr, found->ai_addrlen) ||
        getsockname(state->socket, (struct sockaddr *)bound, &state->bound_bytes))
        status = lar_fail(error, LAR_ERROR_IO, "device '%s': cannot listen there: %s", spec->text,
                          strerror(errno));
    freeaddrinfo(found);
    if (status) return status;
    /* Without time stamps (no Linux has none) answer times begin when the engine looks. */
    (void)setsockopt(state->socket, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
    state->port =
        ntohs(bound->ss_family == AF_INET6 ? ((struct sockaddr_in6 *)(void *)bound)->sin6_port
                                           : ((struct sockaddr_in *)(void *)bound)->sin_port);
    return LAR_OK;
}

static void udp_close(void *data) {
    udp_state *state = data;
    if (state->socket >= 0) close(state->socket);
    free(state);
}

static lar_status udp_open(lar_device_spec *spec, void **data, lar_error *error) {
    udp_state *state = lar_calloc(1, sizeof *state);
    if (!state) return lar_fail_memory(error, sizeof *state, "a device");
    *data = state;
    state->socket = -1;
    lar_link_create(&state->link, spec->token,
                    &(lar_tool_pose){.orientation = {1, 0, 0, 0}, .opening = 1});
    if (spec->rate > 0) state->link.rate = spec->rate;
    /* Without a source of random numbers the clock has to do. */
    if (getrandom(&state->link.dice, sizeof state->link.dice, GRND_NONBLOCK) < 0)
        state->link.dice = (uint64_t)real_time();
    for (int i = 0; i < READ_MAX; i++) {
        state->vector[i].iov_base = state->bytes[i];
        state->message[i].msg_hdr = (struct msghdr){.msg_iov = &state->vector[i],
                                                    .msg_iovlen = 1,
                                                    .msg_name = &state->from[i],
                                                    .msg_control = state->control[i]};
    }
    return bind_socket(state, spec, error);
}

/* ---- packets in ------------------------------------------------------------------------------ */

static int64_t arrival(struct msghdr *message) {
    struct cmsghdr *control = CMSG_FIRSTHDR(message);
    for (; control; control = CMSG_NXTHDR(message, control)) {
        if (control->cmsg_level != SOL_SOCKET || control->cmsg_type != SCM_TIMESTAMPNS) continue;
        struct timespec at;
        memcpy(&at, CMSG_DATA(control), sizeof at);
        return (int64_t)at.tv_sec * 1000000000 + at.tv_nsec;
    }
    return real_time();
}

static lar_link_address address_of(const struct sockaddr_storage *from) {
    lar_link_address address = {{0}};
    if (from->ss_family == AF_INET6) {
        const struct sockaddr_in6 *six = (const void *)from;
        memcpy(address.bytes, &six->sin6_addr, 16);
        memcpy(address.bytes + 16, &six->sin6_port, 2);
        memcpy(address.bytes + 18, &six->sin6_scope_id, 4);
    } else {
        const struct sockaddr_in *four = (const void *)from;
        memcpy(address.bytes, &four->sin_addr, 4);
        memcpy(address.bytes + 4, &four->sin_port, 2);
    }
    address.bytes[31] = (unsigned char)from->ss_family;
    return address;
}

static void take(udp_state *state, int i, uint64_t now) {
    struct msghdr *head = &state->message[i].msg_hdr;
    lar_link_address from = address_of(&state->from[i]);
    if (lar_link_take(&state->link, &from, state->bytes[i], state->message[i].msg_len, now) !=
        LAR_LINK_TAKEN)
        return;
    memcpy(&state->owner, &state->from[i], sizeof state->owner);
    state->owner_bytes = head->msg_namelen;
    state->last = (udp_answer){.sequence = state->link.newest.sequence,
                               .time = state->link.newest.time,
                               .came = arrival(head)};
    if (state->due < READ_MAX) state->answer[state->due++] = state->last;
    state->said_nothing = 0;
}

/* Listens to everybody again, or to the owner alone. */
static void choose_senders(udp_state *state, bool flooded) {
    static const struct sockaddr nobody = {.sa_family = AF_UNSPEC};
    if (state->only_owner && !state->link.owned) {
        state->only_owner = connect(state->socket, &nobody, sizeof nobody) != 0;
        /* Linux forgets a port that it has chosen itself. */
        (void)bind(state->socket, (const struct sockaddr *)&state->bound, state->bound_bytes);
    } else if (!state->only_owner && state->link.owned && flooded) {
        state->only_owner =
            connect(state->socket, (const struct sockaddr *)&state->owner, state->owner_bytes) == 0;
    }
}

static bool udp_poll(void *data, const lar_device_tick *tick, lar_tool_pose *pose) {
    udp_state *state = data;
    for (int i = 0; i < READ_MAX; i++) {
        struct msghdr *head = &state->message[i].msg_hdr;
        head->msg_iovlen = 1;
        head->msg_namelen = sizeof state->from[i];
        head->msg_name = &state->from[i];
        head->msg_control = state->control[i];
        head->msg_controllen = CONTROL;
        state->vector[i].iov_len = ROOM;
    }
    state->due = 0;
    int count = recvmmsg(state->socket, state->message, READ_MAX, MSG_DONTWAIT, NULL);
    for (int i = 0; i < count; i++) take(state, i, tick->now);
    bool here = lar_link_advance(&state->link, tick->paused, tick->now);
    choose_senders(state, count == READ_MAX);
    if (here) *pose = state->link.pose;
    return here;
}

static uint64_t udp_owners(const void *data) {
    const udp_state *state = data;
    return state->link.owners;
}

static void udp_evenly(void *data, int64_t due, lar_tool_pose *pose) {
    udp_state *state = data;
    lar_link_evenly(&state->link, due, pose);
}

/* ---- forces out ------------------------------------------------------------------------------ */

static lar_force_packet force_packet(const udp_state *state, const lar_device_tick *tick,
                                     const lar_tool_force *force, const lar_tool_pose *pose) {
    lar_force_packet packet = {.step = tick->step};
    static const double FEW = 0.01;
    const bool whole = state->link.strength >= 1 && !(state->link.left > 0) &&
                       !(tick->held_back[0] > FEW) && !(tick->held_back[1] > FEW);
    packet.flags = (tick->paused ? 0 : LAR_ANSWER_PLAYING) |
                   (force->touching ? LAR_ANSWER_TOUCHING : 0) |
                   (force->held ? LAR_ANSWER_HOLDING : 0) | (whole ? 0 : LAR_ANSWER_FADING) |
                   state->link.word << LAR_PACKET_WORD;
    for (int i = 0; i < 3; i++) {
        packet.force[i] = state->link.force[i];
        packet.torque[i] = state->link.torque[i];
        packet.position[i] = pose->position[i];
    }
    return packet;
}

/* A silent device is told in every tick that its force fades, and three times that it is gone. Only
 * one that is known to hear: what was sent under a false address is answered, and that is all. */
static void add_fading(udp_state *state) {
    enum { ENOUGH = 3 };
    const lar_link *link = &state->link;
    if (state->due > 0 || !link->owned || !link->silent || !link->proved) return;
    if (state->said_nothing == ENOUGH) return;
    if (link->strength <= 0 && link->left <= 0) state->said_nothing++;
    state->answer[state->due++] = state->last;
}

static void udp_feel(void *data, const lar_device_tick *tick, const lar_tool_force *force,
                     const lar_tool_pose *pose) {
    udp_state *state = data;
    state->link.tool = *pose;
    lar_link_feel(&state->link, force->force, force->torque, tick->held_back);
    bool fading = state->due == 0;
    add_fading(state);
    if (state->due == 0) return;
    lar_link_tell(&state->link, tick->now);
    lar_force_packet packet = force_packet(state, tick, force, pose);
    for (int i = 0; i < state->due; i++) {
        struct msghdr *head = &state->message[i].msg_hdr;
        packet.sequence = state->answer[i].sequence;
        packet.time = state->answer[i].time;
        lar_force_packet_encode(&packet, state->bytes[i]);
        head->msg_name = state->only_owner ? NULL : &state->owner;
        head->msg_namelen = state->only_owner ? 0 : state->owner_bytes;
        head->msg_control = NULL;
        head->msg_controllen = 0;
        state->vector[i].iov_len = LAR_PACKET_BYTES;
    }
    int sent = sendmmsg(state->socket, state->message, (unsigned)state->due, MSG_DONTWAIT);
    state->tells = true;
    int64_t now = real_time();
    for (int i = 0; i < sent && !fading; i++) {
        int64_t took = now - state->answer[i].came;
        if (took >= 0) lar_histogram_add(&state->answer_time, (uint64_t)took);
    }
    if (sent > 0 && !fading) state->answered += (uint64_t)sent;
    state->due = 0;
}

/* The next packet counts from when this one has left: no two are closer than that. */
static void udp_told(void *data, uint64_t now) {
    udp_state *state = data;
    if (state->tells && now > state->link.told_at) state->link.told_at = now;
    state->tells = false;
}

static void udp_reset(void *data) {
    udp_state *state = data;
    lar_link_jump(&state->link);
}

static void udp_report(const void *data, lar_device_status *status) {
    const udp_state *state = data;
    const lar_link *link = &state->link;
    status->port = state->port;
    status->connected = link->owned && !link->silent;
    status->received = link->received;
    status->answered = state->answered;
    status->refused = link->refused;
    status->late = link->late;
    status->lost = link->lost;
    status->timeouts = link->timeouts;
    const lar_histogram *h = &state->answer_time;
    status->answer_p50 = 1e-9 * lar_histogram_quantile(h, 0.5);
    status->answer_p99 = 1e-9 * lar_histogram_quantile(h, 0.99);
    status->answer_p999 = 1e-9 * lar_histogram_quantile(h, 0.999);
    status->answer_max = 1e-9 * (double)h->max;
}

const lar_device_backend lar_device_udp = {.name = "udp",
                                           .form = "udp:HOST:PORT",
                                           .summary = "a device on the network, 1 kHz",
                                           .options = " token rate ",
                                           .open = udp_open,
                                           .close = udp_close,
                                           .poll = udp_poll,
                                           .evenly = udp_evenly,
                                           .owners = udp_owners,
                                           .feel = udp_feel,
                                           .told = udp_told,
                                           .reset = udp_reset,
                                           .report = udp_report};
