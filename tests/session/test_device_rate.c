/* What a device feels of a session, by the clock, at the packet: how fast its force changes at any
 * pace and on a busy machine, and how it fades when the run pauses or breaks off. */
#include "session/session_test.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include "base/device_packet.h"

enum { HEARD_MAX = 8000 };

/* One answer: when it left, by the kernel's stamp, and what it said. */
typedef struct heard {
    double at, force[3]; /* [s] [N] */
    uint32_t flags;
} heard;

typedef struct hand {
    int socket;
    uint32_t sequence, word;
    heard answer[HEARD_MAX];
    int count;
} hand;

static hand him;

static void reach(const bench *b) {
    lar_device_status device;
    int yes = 1;
    DONE(lar_session_device(b->session, BALL, &device, &failure));
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_port = htons((uint16_t)device.port),
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    him = (hand){.socket = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)};
    assert_true(him.socket >= 0);
    setsockopt(him.socket, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
    assert_int_equal(connect(him.socket, (struct sockaddr *)&to, sizeof to), 0);
}

static void take_answers(void) {
    unsigned char bytes[LAR_PACKET_BYTES + 1];
    _Alignas(struct cmsghdr) char control[64];
    struct iovec part = {bytes, sizeof bytes};
    for (;;) {
        struct msghdr message = {.msg_iov = &part,
                                 .msg_iovlen = 1,
                                 .msg_control = control,
                                 .msg_controllen = sizeof control};
        ssize_t size = recvmsg(him.socket, &message, MSG_DONTWAIT);
        struct cmsghdr *stamp = size < 0 ? NULL : CMSG_FIRSTHDR(&message);
        if (size < 0) return;
        lar_force_packet packet;
        struct timespec at;
        assert_non_null(stamp);
        memcpy(&at, CMSG_DATA(stamp), sizeof at);
        assert_true(lar_force_packet_decode(bytes, (size_t)size, &packet));
        him.word = packet.flags & 0xffff0000u;
        if (him.count == HEARD_MAX) return;
        heard *h = &him.answer[him.count++];
        *h = (heard){.at = (double)(at.tv_sec % 100000) + 1e-9 * (double)at.tv_nsec,
                     .flags = packet.flags};
        memcpy(h->force, packet.force, sizeof h->force);
    }
}

/* Sends a thousand positions a second, evenly between two depths below the ball's rest, and hears
 * the answers. */
static void push_on(double seconds, double from, double to) {
    int64_t begin = lar_clock_ns(), next = begin, end = begin + (int64_t)(1e9 * seconds);
    for (; next < end; next += 1000000) {
        double depth = from + (to - from) * (double)(next - begin) / (double)(end - begin);
        unsigned char bytes[LAR_PACKET_BYTES];
        lar_position_packet packet = {.sequence = ++him.sequence,
                                      .buttons = him.word,
                                      .pose = {{0, 0, -depth}, {1, 0, 0, 0}, 1}};
        lar_position_packet_encode(&packet, bytes);
        (void)!send(him.socket, bytes, sizeof bytes, 0);
        lar_clock_sleep_until(next + 1000000);
        take_answers();
    }
}

static void push(double seconds, double depth) {
    push_on(seconds, depth, depth);
}

static double size_of(const heard *h) {
    return sqrt(h->force[0] * h->force[0] + h->force[1] * h->force[1] + h->force[2] * h->force[2]);
}

/* Returns the largest force; no packet differs from the one before it by more than rate times the
 * time between them. A force that nobody paid for may fall at once, so that growing is looked at
 * alone where that can be. */
static double check_rate(int from, double rate, bool falls_too) {
    double max = 0;
    for (int i = from > 0 ? from : 1; i < him.count; i++) {
        const heard *a = &him.answer[i - 1], *b = &him.answer[i];
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double d = b->force[k] - a->force[k];
            square += d * d;
        }
        double change = falls_too ? sqrt(square) : size_of(b) - size_of(a);
        double most = rate * (b->at - a->at);
        if (change > 1.001 * most + 1e-6)
            fail_msg("answer %d of %d: from %g to %g N within %g ms", i, him.count, size_of(a),
                     size_of(b), 1e3 * (b->at - a->at));
        max = fmax(max, size_of(b));
    }
    return max;
}

static bench open_pushed(lar_model *model, double pace, const char *device) {
    lar_session_options options = lar_session_options_default();
    options.pace = pace;
    options.paused = 1;
    options.stop_when_unstable = 1;
    bench b = open_bench_of(model, NULL, 1, &options);
    DONE(lar_session_attach(b.session, BALL, device, &failure));
    DONE(lar_session_start(b.session, &failure));
    reach(&b);
    return b;
}

static void close_pushed(bench *b) {
    close(him.socket);
    close_bench(b);
}

/* Ten times as fast as the clock, a tenth as fast, and as fast as it goes. */
static void test_rate_at_any_pace(void **state) {
    (void)state;
    const double paces[] = {1, 10, 0.2, 0};
    for (int i = 0; i < 4; i++) {
        bench b = open_pushed(hanging_block(), paces[i], "udp:127.0.0.1:0,rate=100");
        push(0.1, 0);
        lar_session_play(b.session);
        push_on(0.4, 0, 0.03); /* paid for, and then */
        push(0.6, 0.04);       /* a blow: a centimetre at once */
        push(0.2, 0);
        double max = check_rate(0, 100, false);
        printf("pace %g: %d answers, at most %.2f N\n", paces[i], him.count, max);
        assert_true(max > 0.3 && max <= 8.001);
        close_pushed(&b);
    }
}

/* Ticks that are late and made up for: the whole process stands still now and then. */
static void *hold_up(void *argument) {
    bench *b = argument;
    for (int i = 0; i < 12; i++) {
        nap(0.08);
        lar_session_step(b->session, 1);
        lar_session_set_pace(b->session, i % 2 ? 1 : 3);
        lar_session_play(b->session);
    }
    return NULL;
}

static void test_rate_while_the_pace_changes(void **state) {
    (void)state;
    pthread_t thread;
    bench b = open_pushed(hanging_block(), 1, "udp:127.0.0.1:0,rate=100");
    lar_session_play(b.session);
    assert_int_equal(pthread_create(&thread, NULL, hold_up, &b), 0);
    for (int i = 0; i < 10; i++) push_on(0.1, i % 2 ? 0 : 0.04, i % 2 ? 0.04 : 0);
    pthread_join(thread, NULL);
    double max = check_rate(0, 100, false);
    assert_true(max > 1);
    close_pushed(&b);
}

/* The first answer from which on there is no force. */
static int faded(int from) {
    int at = him.count;
    while (at > from && size_of(&him.answer[at - 1]) == 0) at--;
    return at;
}

/* Whether there is a force to fade: an engine that was held up has just begun anew. */
static bool is_felt(int at) {
    return at > 0 && size_of(&him.answer[at]) > 0.5;
}

/* Both fade within 50 ms, and no faster than the rate allows; the machine may add some. */
static void expect_fading(int from, const char *what) {
    int end = faded(from);
    if (end <= from || end >= him.count)
        fail_msg("%s: answers %d to %d of %d, from %g N to %g N", what, from, end, him.count,
                 size_of(&him.answer[from]), size_of(&him.answer[him.count - 1]));
    double seconds = him.answer[end].at - him.answer[from].at;
    printf("%s: from %.2f N to none within %.1f ms, in %d packets\n", what,
           size_of(&him.answer[from]), 1e3 * seconds, end - from);
    assert_true(end - from > 5);
    assert_true(seconds > 0.01 && seconds < 0.15);
    check_rate(from, 200, true);
}

static int last_playing(void) {
    int at = him.count - 1;
    while (at > 0 && !(him.answer[at].flags & LAR_ANSWER_PLAYING)) at--;
    return at;
}

static bool pause_fades(void) {
    bench b = open_pushed(hanging_block(), 0.08, "udp:127.0.0.1:0,rate=200");
    lar_session_play(b.session);
    push(0.25, 0.04); /* on its way down the spring is long */
    lar_session_pause(b.session);
    push(0.3, 0.04);
    bool felt = is_felt(last_playing());
    if (felt) expect_fading(last_playing(), "a pause");
    close_pushed(&b);
    return felt;
}

/* The block is torn apart at step 200: the session stops, the hand is not let go at once. */
static bool stop_fades(void) {
    bench b = open_pushed(torn_block(), 0.08, "udp:127.0.0.1:0,rate=200");
    lar_session_play(b.session);
    for (int i = 0; i < 100 && status_of(&b).state != LAR_SESSION_STOPPED; i++) push(0.02, 0.04);
    assert_int_equal(status_of(&b).state, LAR_SESSION_STOPPED);
    push(0.3, 0.04);
    bool felt = is_felt(last_playing());
    if (felt) expect_fading(last_playing(), "a stop");
    lar_tool_force force;
    DONE(lar_session_tool_force(b.session, BALL, NULL, &force, &failure));
    assert_true(force.force[2] == 0);
    close_pushed(&b);
    return felt;
}

static void test_pause_and_stop_fade(void **state) {
    (void)state;
    bool paused = false, stopped = false;
    for (int i = 0; i < 5 && !paused; i++) paused = pause_fades();
    for (int i = 0; i < 5 && !stopped; i++) stopped = stop_fades();
    assert_true(paused && stopped);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rate_at_any_pace),
        cmocka_unit_test(test_rate_while_the_pace_changes),
        cmocka_unit_test(test_pause_and_stop_fade),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
