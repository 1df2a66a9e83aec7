/* A device on the network, over real sockets on loopback. Time is the test's own. */
#include "testing.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/device_packet.h"
#include "session/device/device.h"

static const uint64_t MS = 1000000;
static const lar_tool_info PROBE = {.name = "probe",
                                    .radius = 0.005,
                                    .rest = {.position = {0, 0, 0.1}, .orientation = {1, 0, 0, 0}}};

typedef struct rig {
    lar_device *device;
    lar_device_status report;
    uint64_t now;
    lar_tool_pose pose;
    lar_tool_force force;
} rig;

static rig open_rig(const char *spec) {
    rig r = {.now = 1000 * MS, .pose = PROBE.rest, .force = {.force = {0, 0, 2}, .touching = 3}};
    lar_error error = {LAR_OK, ""};
    if (lar_device_open(spec, &PROBE, &r.device, &error)) fail_msg("%s", error.message);
    lar_device_status_get(r.device, &r.report);
    return r;
}

static bool tick(rig *r) {
    lar_device_tick tick = {.step = r->now / 100000, .seconds = 0.001, .now = r->now};
    bool here = lar_device_poll(r->device, &tick, &r->pose);
    lar_device_feel(r->device, &tick, &r->force, &r->pose);
    lar_device_status_get(r->device, &r->report);
    r->now += MS;
    return here;
}

static int reach(const rig *r) {
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_port = htons((uint16_t)r->report.port),
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int s = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    assert_true(s >= 0);
    assert_int_equal(connect(s, (struct sockaddr *)&to, sizeof to), 0);
    return s;
}

/* The word of the last answer, which who hears sends back. */
static uint32_t heard;

static void send_position(int s, uint32_t sequence, double x, const char *token) {
    unsigned char bytes[LAR_PACKET_BYTES];
    lar_position_packet packet = {.sequence = sequence,
                                  .buttons = heard,
                                  .time = sequence,
                                  .pose = {{x, 0, 0}, {1, 0, 0, 0}, 1}};
    if (token) memcpy(packet.token, token, strnlen(token, sizeof packet.token));
    lar_position_packet_encode(&packet, bytes);
    /* Who is shut out is told that nobody listens, by the send after that. */
    if (send(s, bytes, sizeof bytes, 0) < 0) assert_int_equal(errno, ECONNREFUSED);
}

/* False when nothing has come. */
static bool receive(int s, lar_force_packet *packet) {
    unsigned char bytes[LAR_PACKET_BYTES + 1];
    long size = recv(s, bytes, sizeof bytes, MSG_DONTWAIT);
    if (size < 0) return false;
    assert_true(lar_force_packet_decode(bytes, (size_t)size, packet));
    heard = packet->flags & 0xffff0000u;
    return true;
}

/* A force for every position, in the next tick. */
static void test_position_in_force_out(void **state) {
    (void)state;
    rig r = open_rig("udp:127.0.0.1:0,scale=0.5");
    assert_true(r.report.port > 0);
    assert_string_equal(r.report.name, "udp:127.0.0.1:0,scale=0.5");
    int s = reach(&r);
    lar_force_packet answer;
    assert_false(tick(&r));
    assert_false(receive(s, &answer));
    for (uint32_t i = 1; i <= 400; i++) {
        send_position(s, i, 0.02, NULL);
        assert_true(tick(&r));
        assert_true(receive(s, &answer));
        assert_int_equal(answer.sequence, i);
        assert_int_equal(answer.time, i);
        assert_true(answer.flags & LAR_ANSWER_PLAYING && answer.flags & LAR_ANSWER_TOUCHING);
        assert_false(receive(s, &answer));
    }
    assert_true(r.report.connected);
    assert_true(answer.force[2] == 2 && !(answer.flags & LAR_ANSWER_FADING));
    assert_true(fabs(r.pose.position[0] - 0.01) < 1e-12); /* scaled, from the rest pose on */
    assert_true(fabs(r.pose.position[2] - 0.1) < 1e-12);
    assert_true(fabs(answer.position[0] - 0.02) < 1e-12); /* and back */
    for (uint32_t i = 401; i <= 404; i++) send_position(s, i, 0.02, NULL);
    tick(&r); /* four at once: four answers */
    for (uint32_t i = 401; i <= 404; i++) {
        assert_true(receive(s, &answer));
        assert_int_equal(answer.sequence, i);
    }
    assert_int_equal(r.report.received, 404);
    assert_int_equal(r.report.answered, 404);
    assert_true(r.report.answer_p50 > 0 && r.report.answer_max < 1);
    close(s);
    lar_device_close(r.device);
}

/* Silence: the last answer is repeated while its force fades, and then not any more. */
static void test_silent_device_is_told_zero(void **state) {
    (void)state;
    rig r = open_rig("udp:127.0.0.1:0");
    int s = reach(&r), answers = 0;
    lar_force_packet answer = {0};
    for (uint32_t i = 1; i <= 350; i++) {
        send_position(s, i, 0.02, NULL);
        tick(&r);
        assert_true(receive(s, &answer));
    }
    assert_true(answer.force[2] == 2);
    double before = 2;
    for (int i = 0; i < 150; i++) {
        assert_int_equal(tick(&r), i < 20);
        if (!receive(s, &answer)) continue;
        answers++;
        assert_int_equal(answer.sequence, 350);
        assert_true(answer.force[2] < before || answer.force[2] == 0);
        assert_true(answer.flags & LAR_ANSWER_FADING);
        before = answer.force[2];
    }
    assert_true(before == 0);
    assert_true(answers > 45 && answers < 60);
    assert_true(r.report.answered == 350 && r.report.received == 350);
    assert_int_equal(r.report.timeouts, 1);
    assert_false(r.report.connected);
    close(s);
    lar_device_close(r.device);
}

enum { ECHO_NOTHING, ECHO_WRONG, ECHO_RIGHT };

/* Sends so many packets, one every `gap` ticks, and counts what comes within the next 200. */
static int answers_to(uint32_t packets, int gap, int echo) {
    rig r = open_rig("udp:127.0.0.1:0");
    int s = reach(&r), answers = 0;
    lar_force_packet answer;
    heard = 0;
    for (uint32_t i = 1; i <= packets; i++) {
        if (echo == ECHO_NOTHING) heard = 0;
        if (echo == ECHO_WRONG) heard ^= 0x10000;
        send_position(s, i, 0, NULL);
        for (int k = 0; k < (i < packets ? gap : 200); k++) {
            tick(&r);
            while (receive(s, &answer)) answers++;
        }
    }
    close(s);
    lar_device_close(r.device);
    heard = 0;
    return answers;
}

/* Whoever has not shown that it hears the answers may have sent under somebody else's address: no
 * packet brings more than one answer there. */
static void test_one_answer_per_packet(void **state) {
    (void)state;
    static const uint32_t packets[] = {1, 2, 5, 10};
    static const int gaps[] = {1, 30, 200, 600};
    for (int p = 0; p < 4; p++)
        for (int g = 0; g < 4; g++)
            for (int echo = ECHO_NOTHING; echo <= ECHO_WRONG; echo++)
                assert_int_equal(answers_to(packets[p], gaps[g], echo), packets[p]);
    /* The first packet cannot echo anything; who then does is told of every fading. */
    assert_int_equal(answers_to(1, 1, ECHO_RIGHT), 1);
    assert_true(answers_to(2, 1, ECHO_RIGHT) > 2 + 3);
}

/* Another sender has to show it anew. */
static void test_proof_is_the_owners(void **state) {
    (void)state;
    rig r = open_rig("udp:127.0.0.1:0");
    int first = reach(&r), second = reach(&r), answers = 0;
    lar_force_packet answer;
    for (uint32_t i = 1; i <= 3; i++) {
        send_position(first, i, 0, NULL);
        tick(&r);
        assert_true(receive(first, &answer));
    }
    uint32_t word = heard;
    assert_true(word != 0);
    r.now += 1100 * MS;
    tick(&r);
    heard = word;
    send_position(second, 1, 0, NULL);
    for (int k = 0; k < 200; k++) {
        tick(&r);
        while (receive(second, &answer)) answers++;
    }
    assert_int_equal(answers, 1);
    assert_true(heard != word);
    heard = 0;
    close(first);
    close(second);
    lar_device_close(r.device);
}

/* What a device is told changes by no more than its rate times the time since it was last told,
 * however ticks come, and whatever the force does. */
static void test_rate_holds_at_the_packet(void **state) {
    (void)state;
    rig r = open_rig("udp:127.0.0.1:0,rate=200");
    int s = reach(&r);
    lar_force_packet answer;
    uint32_t sequence = 0;
    double before = 0;
    uint64_t told = 0;
    heard = 0;
    for (int i = 0; i < 6000; i++) {
        bool late = i > 3000; /* held up for 15 ms, and then 15 ticks in 3 ms */
        r.now += (late ? (i % 15 ? 200 : 15000) : 100) * MS / 1000 - MS; /* tick adds it */
        r.force.force[2] = (i / 700) % 2 ? -8 : 8;
        r.force.torque[1] = r.force.force[2] / 40;
        uint64_t now = r.now;
        if (i % 3 == 0 || i < 100) send_position(s, ++sequence, 0.02, NULL);
        if (i % 50 == 0) send_position(s, ++sequence, 0.02, NULL);
        tick(&r);
        double max = told ? 200 * 1e-9 * (double)(now - told) : 0;
        while (receive(s, &answer)) {
            double change = fabs(answer.force[2] - before);
            if (change > max * (1 + 1e-9) + 1e-12)
                fail_msg("packet %u: from %g to %g N, at most %g N", sequence, before,
                         answer.force[2], max);
            before = answer.force[2];
            assert_true(fabs(answer.torque[1] - before / 40) < 0.2);
            told = now;
            max = 0;
        }
        if (i == 3499) assert_true(fabs(before) > 7.9); /* it does get there */
    }
    heard = 0;
    close(s);
    lar_device_close(r.device);
}

/* Others get no answer and move nothing; a flood is read in portions and then not at all. */
static void test_strangers_and_floods(void **state) {
    (void)state;
    rig r = open_rig("udp:127.0.0.1:0");
    int owner = reach(&r), stranger = reach(&r);
    lar_force_packet answer;
    send_position(owner, 1, 0.02, NULL);
    tick(&r);
    assert_true(receive(owner, &answer));
    for (uint32_t i = 0; i < 10; i++) send_position(stranger, 100 + i, 0.5, NULL);
    assert_int_equal(send(stranger, "hello", 5, 0), 5);
    assert_int_equal(send(stranger, "", 0, 0), 0);
    tick(&r);
    assert_false(receive(stranger, &answer));
    assert_int_equal(r.report.refused, 12);
    for (uint32_t i = 0; i < 100; i++) send_position(stranger, i, 0.5, NULL);
    uint64_t before = r.report.refused;
    tick(&r);
    assert_true(r.report.refused - before <= 32);
    for (int i = 0; i < 4; i++) tick(&r); /* what was there already */
    before = r.report.refused;
    for (uint32_t i = 0; i < 100; i++) send_position(stranger, i, 0.5, NULL);
    send_position(owner, 2, 0.02, NULL);
    tick(&r);
    assert_int_equal(r.report.refused, before);
    assert_true(receive(owner, &answer));
    assert_int_equal(answer.sequence, 2);
    r.now += 1100 * MS; /* the owner has gone: everybody is heard again */
    tick(&r);
    send_position(stranger, 6, 0.01, NULL); /* takes the error of before, or is heard */
    send_position(stranger, 7, 0.01, NULL);
    tick(&r);
    while (receive(stranger, &answer)) continue;
    assert_int_equal(answer.sequence, 7);
    close(owner);
    close(stranger);
    lar_device_close(r.device);
}

static void test_token_on_any_address(void **state) {
    (void)state;
    rig r = open_rig("udp:0.0.0.0:0,token=let-me-in");
    int s = reach(&r);
    lar_force_packet answer;
    send_position(s, 1, 0, "let-me-out");
    tick(&r);
    assert_false(receive(s, &answer));
    send_position(s, 2, 0, "let-me-in");
    tick(&r);
    assert_true(receive(s, &answer));
    close(s);
    lar_device_close(r.device);
}

static void test_port_in_use(void **state) {
    (void)state;
    rig r = open_rig("udp:localhost:0");
    char spec[64];
    lar_device *second = NULL;
    lar_error error;
    snprintf(spec, sizeof spec, "udp:127.0.0.1:%d", r.report.port);
    assert_int_equal(lar_device_open(spec, &PROBE, &second, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "cannot listen there"));
    lar_device_close(r.device);
    r = open_rig("udp:127.0.0.1:0");
    lar_device_close(r.device);
}

/* A reset: the force comes back slowly, and the pose from where the tool is. */
static void test_reset_is_smooth(void **state) {
    (void)state;
    rig r = open_rig("udp:127.0.0.1:0");
    int s = reach(&r);
    lar_force_packet answer;
    r.pose.position[0] = 0.2; /* where the tool was when the device came */
    tick(&r);
    for (uint32_t i = 1; i <= 350; i++) {
        send_position(s, i, 0.05, NULL);
        tick(&r);
        assert_true(receive(s, &answer));
    }
    assert_true(answer.force[2] == 2);
    lar_device_reset(r.device);
    r.pose = PROBE.rest;
    r.force = (lar_tool_force){0}; /* nothing is felt where it begins anew */
    lar_device_feel(r.device, &(lar_device_tick){.now = r.now - MS / 2}, &r.force, &r.pose);
    while (receive(s, &answer)) continue; /* that it begins to fade */
    double before = 2;
    for (uint32_t i = 351; i <= 410; i++) { /* what was felt fades in 50 ms, packet by packet */
        send_position(s, i, 0.05, NULL);
        assert_true(tick(&r));
        assert_true(receive(s, &answer));
        if (i == 351) assert_true(fabs(r.pose.position[0]) < 0.001);
        assert_true(answer.flags & LAR_ANSWER_FADING);
        assert_true(answer.force[2] <= before && before - answer.force[2] < 0.041);
        before = answer.force[2];
    }
    assert_true(before == 0);
    r.force.force[2] = 2; /* and what comes then grows within 300 ms */
    for (uint32_t i = 411; i <= 660; i++) {
        send_position(s, i, 0.05, NULL);
        tick(&r);
        assert_true(receive(s, &answer));
        double max = i > 411 ? 0.041 : 0.45;
        if (fabs(answer.force[2] - before) > max)
            fail_msg("packet %u: from %g to %g N", i, before, answer.force[2]);
        before = answer.force[2];
    }
    if (before != 2) fail_msg("%g N", before);
    close(s);
    lar_device_close(r.device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_position_in_force_out),
        cmocka_unit_test(test_silent_device_is_told_zero),
        cmocka_unit_test(test_one_answer_per_packet),
        cmocka_unit_test(test_proof_is_the_owners),
        cmocka_unit_test(test_rate_holds_at_the_packet),
        cmocka_unit_test(test_strangers_and_floods),
        cmocka_unit_test(test_token_on_any_address),
        cmocka_unit_test(test_port_in_use),
        cmocka_unit_test(test_reset_is_smooth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
