#include "study/device_client.h"

#include <errno.h>
#include <math.h>
#include <netdb.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/device_packet.h"
#include "base/histogram.h"
#include "base/memory.h"
#include "model/tool_script.h"

/* How many packets may be on the way; a power of two. */
enum { WINDOW = 1 << 14 };
static const double TAU = 6.28318530717958647693;
static const double LAST_WAIT = 0.1; /* for answers, after the last packet [s] */

typedef struct client {
    const lar_device_client_options *options;
    lar_device_client_report *report;
    int socket;
    lar_tool_script script;
    int64_t sent_at[WINDOW]; /* [ns] by sequence number; 0: answered, or never sent */
    uint32_t sequence;       /* of the last packet */
    uint32_t word;           /* of the last answer, in its place: it goes back */
    uint64_t first_step;
    double force_sum;
    lar_histogram trip;
} client;

/* ---- where the hand is ----------------------------------------------------------------------- */

static void pose_at(client *c, double time, lar_tool_pose *pose) {
    const lar_device_client_options *o = c->options;
    *pose = (lar_tool_pose){.orientation = {1, 0, 0, 0}, .opening = 1};
    double turn = TAU * time / o->period;
    if (o->script) {
        lar_tool_script_at(&c->script, time, pose);
    } else if (o->circle > 0) {
        double radius = o->circle * fmin(1, 4 * time / o->period); /* no jump at the start */
        pose->position[0] = radius * cos(turn);
        pose->position[1] = radius * sin(turn);
    } else if (o->push > 0) {
        pose->position[2] = -0.5 * o->push * (1 - cos(turn));
    }
}

/* ---- the network ----------------------------------------------------------------------------- */

static lar_status reach(client *c, lar_error *error) {
    const char *text = c->options->address;
    char host[256];
    const char *colon = strrchr(text, ':');
    const char *begin = !strncmp(text, "udp:", 4) ? text + 4 : NULL;
    size_t length = begin && colon > begin ? (size_t)(colon - begin) : 0;
    if (length > 2 && begin[0] == '[' && begin[length - 1] == ']') begin++, length -= 2;
    if (length == 0 || length >= sizeof host || colon[1] == '\0')
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: an address as udp:127.0.0.1:9000 is wanted, the one that the session "
                        "was given",
                        text);
    memcpy(host, begin, length);
    host[length] = '\0';
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_NUMERICSERV}, *found;
    int refused = getaddrinfo(host, colon + 1, &hints, &found);
    if (refused)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: no such address: %s", text,
                        gai_strerror(refused));
    c->socket = socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    bool reached = c->socket >= 0 && !connect(c->socket, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    if (reached) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO, "%s: cannot be reached: %s", text, strerror(errno));
}

static void send_position(client *c, double time) {
    lar_position_packet packet = {
        .sequence = ++c->sequence, .buttons = c->word, .time = (uint64_t)(1e6 * time)};
    unsigned char bytes[LAR_PACKET_BYTES];
    if (c->options->token)
        memcpy(packet.token, c->options->token, strnlen(c->options->token, LAR_PACKET_TOKEN));
    pose_at(c, time, &packet.pose);
    lar_position_packet_encode(&packet, bytes);
    c->sent_at[c->sequence % WINDOW] = lar_clock_ns();
    /* A full buffer or a port where nobody listens yet: the packet is lost, as on any network. */
    (void)!send(c->socket, bytes, sizeof bytes, MSG_DONTWAIT);
    c->report->sent++;
}

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void take_answer(client *c, const lar_force_packet *packet) {
    lar_device_client_report *r = c->report;
    int64_t *sent_at = &c->sent_at[packet->sequence % WINDOW];
    /* While a force fades the last answer is sent again, with less force. */
    c->word = packet->flags >> LAR_PACKET_WORD << LAR_PACKET_WORD;
    bool first = *sent_at && c->sequence - packet->sequence < WINDOW;
    if (first) {
        int64_t trip = lar_clock_ns() - *sent_at;
        lar_histogram_add(&c->trip, trip > 0 ? (uint64_t)trip : 0);
        *sent_at = 0;
        if (r->answered++ == 0) c->first_step = packet->step;
        r->steps = packet->step > c->first_step ? packet->step - c->first_step : 0;
        c->force_sum += length_of(packet->force);
        r->touching += (packet->flags & LAR_ANSWER_TOUCHING) != 0;
        r->holding += (packet->flags & LAR_ANSWER_HOLDING) != 0;
    }
    r->force_max = fmax(r->force_max, length_of(packet->force));
    r->torque_max = fmax(r->torque_max, length_of(packet->torque));
}

static void take_answers(client *c) {
    unsigned char bytes[LAR_PACKET_BYTES + 1];
    lar_force_packet packet;
    ssize_t size;
    while ((size = recv(c->socket, bytes, sizeof bytes, MSG_DONTWAIT)) >= 0) {
        if (lar_force_packet_decode(bytes, (size_t)size, &packet))
            take_answer(c, &packet);
        else
            c->report->strange++;
    }
}

/* Takes answers until that moment of the clock [ns]. */
static void listen_until(client *c, int64_t end) {
    int64_t left;
    while ((left = end - lar_clock_ns()) > 0) {
        struct pollfd wanted = {.fd = c->socket, .events = POLLIN};
        struct timespec max = {left / 1000000000, left % 1000000000};
        if (ppoll(&wanted, 1, &max, NULL) > 0) take_answers(c);
    }
}

/* ---- all of it ------------------------------------------------------------------------------- */

static bool is_stopped(const client *c) {
    return c->options->stop && *c->options->stop;
}

static void play(client *c) {
    const lar_device_client_options *o = c->options;
    int64_t begin = lar_clock_ns(), due = begin;
    int64_t end = begin + (int64_t)(1e9 * o->seconds), period = (int64_t)(1e9 / o->rate);
    while (due < end && !is_stopped(c)) {
        send_position(c, 1e-9 * (double)(due - begin));
        due += period;
        /* Who is late sends now and goes on from there, as a device's own clock would. */
        int64_t now = lar_clock_ns();
        if (now > due + period) due = now;
        take_answers(c);
        listen_until(c, due);
    }
    c->report->seconds = 1e-9 * (double)(lar_clock_ns() - begin);
    listen_until(c, lar_clock_ns() + (int64_t)(1e9 * LAST_WAIT));
}

static lar_status finish(client *c, lar_error *error) {
    lar_device_client_report *r = c->report;
    r->lost = r->sent - r->answered;
    if (r->answered == 0)
        return lar_fail(error, LAR_ERROR_PEER,
                        "nobody at %s answered %llu packets; start a session with a tool on that "
                        "device first, give the same token, and end who moves that tool already",
                        c->options->address, (unsigned long long)r->sent);
    r->round_trip_p50 = 1e-9 * lar_histogram_quantile(&c->trip, 0.5);
    r->round_trip_p99 = 1e-9 * lar_histogram_quantile(&c->trip, 0.99);
    r->round_trip_p999 = 1e-9 * lar_histogram_quantile(&c->trip, 0.999);
    r->round_trip_max = 1e-9 * (double)c->trip.max;
    r->force_mean = c->force_sum / (double)r->answered;
    return LAR_OK;
}

lar_status lar_device_client(const lar_device_client_options *options,
                             lar_device_client_report *report, lar_error *error) {
    *report = (lar_device_client_report){0};
    client *c = lar_calloc(1, sizeof *c);
    if (!c) return lar_fail_memory(error, sizeof *c, "a device");
    c->options = options;
    c->report = report;
    c->socket = -1;
    lar_status status = LAR_OK;
    if (options->script) status = lar_tool_script_read(options->script, &c->script, error);
    if (!status) status = reach(c, error);
    if (!status) {
        prctl(PR_SET_TIMERSLACK, 1000UL, 0, 0, 0); /* waking up late would count as the network's */
        play(c);
        status = finish(c, error);
    }
    if (c->socket >= 0) close(c->socket);
    lar_tool_script_destroy(&c->script);
    free(c);
    return status;
}
