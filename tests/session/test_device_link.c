/* The network's part of a device without a network: packets, owners, silence. */
#include "testing.h"

#include "session/device/link.h"

static const uint64_t MS = 1000000;

static lar_position_packet sample(uint32_t sequence) {
    return (lar_position_packet){
        .sequence = sequence,
        .buttons = 0,
        .time = 0x0102030405060708,
        .token = "abcdefgh",
        .pose = {.position = {1, -2, 0.5}, .orientation = {0.5, -0.5, 0.5, -0.5}, .opening = 0.25}};
}

/* ---- packets --------------------------------------------------------------------------------- */

static void test_packets_there_and_back(void **state) {
    (void)state;
    unsigned char bytes[LAR_PACKET_BYTES];
    lar_position_packet in = sample(0xfffffffe), out;
    in.buttons = 3;
    lar_position_packet_encode(&in, bytes);
    assert_true(lar_position_packet_decode(bytes, sizeof bytes, &out));
    assert_memory_equal(&in, &out, sizeof in);
    lar_force_packet force = {.sequence = 7,
                              .flags = 5,
                              .time = 9,
                              .step = UINT64_MAX,
                              .force = {1, 2, -3},
                              .torque = {4, 5, -6},
                              .position = {7, 8, -9}};
    lar_force_packet back;
    lar_force_packet_encode(&force, bytes);
    assert_true(lar_force_packet_decode(bytes, sizeof bytes, &back));
    assert_memory_equal(&force, &back, sizeof force);
    assert_false(lar_position_packet_decode(bytes, sizeof bytes, &out)); /* the other kind */
}

/* The bytes that docs/devices.md promises. */
static void test_golden_bytes(void **state) {
    (void)state;
    static const unsigned char golden[LAR_PACKET_BYTES] = {
        'L', 'A', 'R', 'D', 1,   0,   1,    0,    42, 0, 0, 0, 1, 0, 0,    0,    /* head */
        8,   7,   6,   5,   4,   3,   2,    1,                                   /* time */
        'a', 'b', 'c', 'd', 'e', 'f', 'g',  'h',  0,  0, 0, 0, 0, 0, 0,    0,    /* token */
        0,   0,   0,   0,   0,   0,   0xf0, 0x3f, 0,  0, 0, 0, 0, 0, 0,    0xc0, /* 1, -2 */
        0,   0,   0,   0,   0,   0,   0xe0, 0x3f,                                /* 0.5 */
        0,   0,   0,   0,   0,   0,   0xe0, 0x3f, 0,  0, 0, 0, 0, 0, 0xe0, 0xbf, /* 0.5, -0.5 */
        0,   0,   0,   0,   0,   0,   0xe0, 0x3f, 0,  0, 0, 0, 0, 0, 0xe0, 0xbf,
        0,   0,   0,   0,   0,   0,   0xd0, 0x3f /* 0.25 */
    };
    unsigned char bytes[LAR_PACKET_BYTES];
    lar_position_packet packet = sample(42);
    packet.buttons = LAR_BUTTON_CLOSE;
    lar_position_packet_encode(&packet, bytes);
    assert_memory_equal(bytes, golden, sizeof golden);
    static const unsigned char head[40] = {'L', 'A', 'R', 'D', 1, 0, 2, 0, 42, 0, 0, 0,   9, 0,
                                           0,   0,   8,   7,   6, 5, 4, 3, 2,  1, 4, 3,   2, 1,
                                           0,   0,   0,   0,   0, 0, 0, 0, 0,  0, 4, 0x40};
    lar_force_packet force = {.sequence = 42,
                              .flags = LAR_ANSWER_PLAYING | LAR_ANSWER_FADING,
                              .time = packet.time,
                              .step = 0x01020304,
                              .force = {2.5, 0, 0}};
    lar_force_packet_encode(&force, bytes);
    assert_memory_equal(bytes, head, sizeof head);
}

static void put_double(unsigned char *at, double value) {
    memcpy(at, &value, sizeof value);
}

static void test_what_is_no_packet(void **state) {
    (void)state;
    unsigned char good[LAR_PACKET_BYTES + 1] = {0}, bytes[LAR_PACKET_BYTES + 1];
    lar_position_packet packet = sample(1), out;
    lar_position_packet_encode(&packet, good);
    for (size_t size = 0; size <= LAR_PACKET_BYTES + 1; size++)
        assert_int_equal(lar_position_packet_decode(good, size, &out), size == LAR_PACKET_BYTES);
    for (int i = 0; i < 8; i++) { /* magic, version, kind */
        memcpy(bytes, good, sizeof bytes);
        bytes[i] ^= 0x40;
        assert_false(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
    }
    const double bad[] = {NAN, -NAN, INFINITY, -INFINITY, 1e300, -100.5};
    for (size_t b = 0; b < sizeof bad / sizeof bad[0]; b++)
        for (int i = 40; i < LAR_PACKET_BYTES; i += 8) {
            memcpy(bytes, good, sizeof bytes);
            put_double(bytes + i, bad[b]);
            assert_false(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
        }
    memcpy(bytes, good, sizeof bytes);
    memset(bytes + 64, 0, 32); /* no orientation */
    assert_false(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
    memcpy(bytes, good, sizeof bytes);
    put_double(bytes + 64, 0.7);
    assert_false(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
    put_double(bytes + 64, 0.502); /* a float's rounding, generously */
    assert_true(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
    double square = 0;
    for (int i = 0; i < 4; i++) square += out.pose.orientation[i] * out.pose.orientation[i];
    assert_true(fabs(square - 1) < 1e-12);
    memcpy(bytes, good, sizeof bytes);
    put_double(bytes + 96, 1.1);
    assert_false(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
    put_double(bytes + 96, -0.1);
    assert_false(lar_position_packet_decode(bytes, LAR_PACKET_BYTES, &out));
}

/* ---- the link -------------------------------------------------------------------------------- */

static const lar_tool_pose ORIGIN = {.orientation = {1, 0, 0, 0}, .opening = 1};
static const lar_link_address HE = {{1}}, SHE = {{2}};

static lar_link_verdict take(lar_link *link, const lar_link_address *from, uint32_t sequence,
                             const char *token, double x, uint64_t now) {
    unsigned char bytes[LAR_PACKET_BYTES];
    lar_position_packet packet = {.sequence = sequence, .pose = ORIGIN};
    packet.pose.position[0] = x;
    if (token) memcpy(packet.token, token, strnlen(token, sizeof packet.token));
    lar_position_packet_encode(&packet, bytes);
    return lar_link_take(link, from, bytes, sizeof bytes, now);
}

static void test_old_packets_are_late(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, NULL, &ORIGIN);
    const struct {
        uint32_t sequence;
        lar_link_verdict verdict;
    } list[] = {{UINT32_MAX - 3, LAR_LINK_TAKEN},
                {UINT32_MAX - 3, LAR_LINK_LATE},
                {UINT32_MAX - 1, LAR_LINK_TAKEN},
                {UINT32_MAX - 2, LAR_LINK_LATE},
                {1, LAR_LINK_TAKEN},
                {UINT32_MAX, LAR_LINK_LATE},
                {0, LAR_LINK_LATE},
                {20000, LAR_LINK_REFUSED},
                {2, LAR_LINK_TAKEN}};
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++)
        assert_int_equal(take(&link, &HE, list[i].sequence, NULL, 0, MS * (1 + i)),
                         list[i].verdict);
    assert_int_equal(link.received, 4);
    assert_int_equal(link.late, 4);
    assert_int_equal(link.lost, 1 + 2);
    assert_int_equal(link.refused, 1);
    /* A device that starts anew is heard after a second of silence. */
    assert_int_equal(take(&link, &HE, 1, NULL, 0, 900 * MS), LAR_LINK_LATE);
    assert_int_equal(take(&link, &HE, 1, NULL, 0, 1020 * MS), LAR_LINK_TAKEN);
}

static void test_first_sender_owns(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, NULL, &ORIGIN);
    assert_int_equal(take(&link, &HE, 1, NULL, 0, 1 * MS), LAR_LINK_TAKEN);
    for (uint32_t i = 0; i < 100; i++)
        assert_int_equal(take(&link, &SHE, i, NULL, 9, (2 + i) * MS), LAR_LINK_REFUSED);
    assert_int_equal(link.refused, 100);
    assert_true(link.newest.pose.position[0] == 0);
    assert_int_equal(take(&link, &SHE, 5, NULL, 0, 1001 * MS), LAR_LINK_REFUSED);
    assert_int_equal(take(&link, &SHE, 6, NULL, 0, 1002 * MS), LAR_LINK_TAKEN);
    assert_int_equal(take(&link, &HE, 2, NULL, 0, 1003 * MS), LAR_LINK_REFUSED);
}

static void test_token_is_asked_for(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, "0123456789abcdef", &ORIGIN);
    assert_int_equal(take(&link, &HE, 1, NULL, 0, MS), LAR_LINK_REFUSED);
    assert_int_equal(take(&link, &HE, 1, "0123456789abcdeg", 0, MS), LAR_LINK_REFUSED);
    assert_int_equal(take(&link, &HE, 1, "0123456789abcde", 0, MS), LAR_LINK_REFUSED);
    assert_int_equal(take(&link, &HE, 1, "0123456789abcdef", 0, MS), LAR_LINK_TAKEN);
    lar_link_create(&link, "01234567", &ORIGIN);
    assert_int_equal(take(&link, &HE, 1, "012345678", 0, MS), LAR_LINK_REFUSED);
    assert_int_equal(take(&link, &HE, 1, "01234567", 0, MS), LAR_LINK_TAKEN);
    lar_link_create(&link, NULL, &ORIGIN); /* where none is wanted there is none */
    assert_int_equal(take(&link, &HE, 1, "01234567", 0, MS), LAR_LINK_REFUSED);
    assert_int_equal(take(&link, &HE, 1, NULL, 0, MS), LAR_LINK_TAKEN);
}

/* Silence: after 20 ms the force goes to zero within 50 ms; the tool stays; and it comes back from
 * where the tool is, without a jump, the whole force after 300 ms. */
static void test_silence_fades(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, NULL, &ORIGIN);
    uint64_t t = 1000 * MS;
    uint32_t n = 0;
    for (int i = 0; i < 400; i++, t += MS) {
        double before = link.pose.position[0];
        assert_int_equal(take(&link, &HE, ++n, NULL, 0.1, t), LAR_LINK_TAKEN);
        assert_true(lar_link_advance(&link, false, t));
        assert_true(fabs(link.pose.position[0] - before) < 0.1 * 0.006);
    }
    assert_true(link.strength == 1 && link.approach == 1);
    assert_true(link.pose.position[0] == 0.1);
    uint64_t last = t - MS;
    double strength = 1;
    for (; t <= last + 100 * MS; t += MS) {
        bool here = lar_link_advance(&link, false, t);
        assert_int_equal(here, t - last <= 20 * MS);
        assert_true(link.strength <= strength);
        strength = link.strength;
        if (t - last <= 20 * MS) assert_true(strength == 1);
        if (t - last == 45 * MS) assert_true(fabs(strength - 0.5) < 0.05);
        if (t - last > 70 * MS) assert_true(strength == 0);
    }
    assert_int_equal(link.timeouts, 1);
    assert_true(link.owned);
    assert_int_equal(link.owners, 1);
    link.tool = ORIGIN;
    link.tool.position[0] = 0.07; /* where the tool stayed */
    for (int i = 0; i < 350; i++, t += MS) {
        double before = i ? link.pose.position[0] : 0.07;
        assert_int_equal(take(&link, &HE, ++n, NULL, -0.1, t), LAR_LINK_TAKEN);
        assert_true(lar_link_advance(&link, false, t));
        assert_true(fabs(link.pose.position[0] - before) < 0.17 * 0.006);
        if (i < 200) assert_true(link.strength < 0.75);
    }
    assert_true(link.strength == 1 && link.pose.position[0] == -0.1);
    assert_int_equal(link.timeouts, 1);
}

/* An engine that was held up comes back as after a silence: no blow for where the hand is by now.
 */
static void test_engine_held_up(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, NULL, &ORIGIN);
    for (uint32_t i = 0; i < 400; i++) {
        take(&link, &HE, i + 1, NULL, 0.1, (1000 + i) * MS);
        lar_link_advance(&link, false, (1000 + i) * MS);
    }
    assert_true(link.strength == 1);
    link.tool = link.pose;
    for (uint32_t i = 400; i < 490; i++) take(&link, &HE, i + 1, NULL, 0.15, 1490 * MS);
    assert_true(lar_link_advance(&link, false, 1490 * MS));
    assert_true(link.strength < 0.3);
    assert_true(link.pose.position[0] < 0.13);
    take(&link, &HE, 491, NULL, 0.15, 1491 * MS);
    assert_true(lar_link_advance(&link, false, 1491 * MS));
    assert_true(link.strength < 0.4);
}

/* An engine that is too slow for the clock still brings the tool to the hand. */
static void test_slow_engine_arrives(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, NULL, &ORIGIN);
    for (uint32_t i = 0; i < 20; i++) {
        take(&link, &HE, i + 1, NULL, 0.1, (1000 + 40 * i) * MS);
        assert_true(lar_link_advance(&link, false, (1000 + 40 * i) * MS));
    }
    assert_true(link.strength == 1 && link.pose.position[0] == 0.1);
}

static void test_pause_fades(void **state) {
    (void)state;
    lar_link link;
    lar_link_create(&link, NULL, &ORIGIN);
    for (uint32_t i = 0; i < 400; i++) {
        take(&link, &HE, i + 1, NULL, 0.1, (1000 + i) * MS);
        lar_link_advance(&link, false, (1000 + i) * MS);
    }
    link.tool.position[0] = 0.1;
    for (uint32_t i = 400; i < 460; i++) {
        take(&link, &HE, i + 1, NULL, 0.2, (1000 + i) * MS);
        assert_false(lar_link_advance(&link, true, (1000 + i) * MS));
    }
    assert_true(link.strength == 0);
    assert_int_equal(link.timeouts, 0);
    take(&link, &HE, 500, NULL, 0.2, 1460 * MS);
    assert_true(lar_link_advance(&link, false, 1460 * MS));
    assert_true(fabs(link.pose.position[0] - 0.1) < 1e-3);
}

static void test_button_closes(void **state) {
    (void)state;
    lar_link link;
    unsigned char bytes[LAR_PACKET_BYTES];
    lar_link_create(&link, NULL, &ORIGIN);
    lar_position_packet packet = {.buttons = LAR_BUTTON_CLOSE, .pose = ORIGIN};
    lar_position_packet_encode(&packet, bytes);
    assert_int_equal(lar_link_take(&link, &HE, bytes, sizeof bytes, MS), LAR_LINK_TAKEN);
    lar_link_advance(&link, false, MS);
    assert_true(link.pose.opening == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_packets_there_and_back), cmocka_unit_test(test_golden_bytes),
        cmocka_unit_test(test_what_is_no_packet),      cmocka_unit_test(test_old_packets_are_late),
        cmocka_unit_test(test_first_sender_owns),      cmocka_unit_test(test_token_is_asked_for),
        cmocka_unit_test(test_silence_fades),          cmocka_unit_test(test_pause_fades),
        cmocka_unit_test(test_button_closes),          cmocka_unit_test(test_engine_held_up),
        cmocka_unit_test(test_slow_engine_arrives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
