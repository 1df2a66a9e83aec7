/* Whoever breaks the protocol is cut off, with a reason, and the engine does not notice: the run
 * goes on, and its state is that of a run that nobody looked at. */
#include "session/session_test.h"

#include "session/server_test.h"

static served s;
static client good; /* a viewer that behaves, all the time */

static int open_all(void **unused) {
    (void)unused;
    s = serve(NULL);
    good = open_client(s.port);
    await_text(&good, "hello");
    return 0;
}

static int close_all(void **unused) {
    (void)unused;
    close_client(&good);
    end_serving(&s);
    return 0;
}

/* The run goes on, the good viewer has its pictures, and they are right. */
static void all_is_well(void) {
    lar_model *model = served_model();
    lar_simulation *plain = served_simulation(model, NULL);
    lar_session_status before = status_of(&s.b);
    ask_frame(&good, "displacement");
    uint64_t step = long_at(&good, 8), hash = long_at(&good, 24);
    DONE(lar_simulation_advance(plain, step, &failure));
    assert_true(lar_simulation_hash(plain) == hash);
    for (int i = 0; i < 1000 && status_of(&s.b).step == before.step; i++) nap(0.005);
    lar_session_status after = status_of(&s.b);
    assert_int_equal(after.state, LAR_SESSION_PLAYING);
    assert_true(after.step > before.step);
    assert_int_equal(after.step % 10, 0);
    lar_simulation_destroy(plain);
    lar_model_destroy(model);
}

/* Sends one frame and expects to be closed with this code (0: without a close frame, or 1002). */
static void expect_cut(int code, int first, const void *payload, size_t length, bool masked) {
    client c = open_client(s.port);
    put_frame(&c, first, payload, length, masked);
    int got = await_close(&c);
    if (code ? got != code : got != 0 && got != 1002)
        fail_msg("a frame %02x of %zu bytes: closed with %d instead of %d", (unsigned)first, length,
                 got, code);
    close_client(&c);
}

/* Sends the head of a frame, behind which nothing comes, and expects 1002 and nothing after it (RFC
 * 6455, 5.5.1), though status comes ten times a second. */
static void expect_last_word(int first) {
    client c = open_client(s.port);
    struct pollfd more = {.fd = c.fd, .events = POLLIN};
    unsigned char next;
    for (int i = 0; i < 3; i++) await_text(&c, "status");
    put_frame(&c, first, "", 0, true);
    assert_int_equal(await_close(&c), 1002);
    if (poll(&more, 1, 400) > 0 && recv(c.fd, &next, 1, 0) > 0)
        fail_msg("a frame %02x: more comes after the close frame", (unsigned)first);
    close_client(&c);
}

static void expect_cut_text(int code, const char *text) {
    expect_cut(code, 0x80 | TEXT_FRAME, text, strlen(text), true);
}

static void messages_that_are_none(void **unused) {
    (void)unused;
    char big[5000];
    memset(big, 'x', sizeof big);
    expect_cut_text(1008, "{\"do\":\"frame\",\"x\":1}");
    expect_cut_text(1008, "hello");
    expect_cut_text(1008, "{\"do\":\"grab\",\"hand\":0,\"point\":[0,0,NaN]}");
    expect_cut_text(1008, "{\"do\":\"forces\",\"tool\":99,\"after\":0}");
    expect_cut_text(1007, "{\"do\":\"pl\xff\"}");
    expect_cut(1009, 0x80 | TEXT_FRAME, big, 1025, true);
    expect_cut(1009, 0x80 | TEXT_FRAME, big, sizeof big, true);
    expect_cut(1003, 0x80 | BINARY_FRAME, big, 100, true);
    expect_cut(1003, 0x80 | BINARY_FRAME, "{\"do\":\"play\"}", 13, true);
    /* The largest that is read: no JSON, but no longer than allowed. */
    expect_cut(1008, 0x80 | TEXT_FRAME, big, 1024, true);
    all_is_well();
}

static void frames_that_are_none(void **unused) {
    (void)unused;
    char data[200] = "{\"do\":\"play\"}";
    static const int first[] = {0xf0 | TEXT_FRAME,    /* reserved bits */
                                0x80 | 3, 0x80 | 0xb, /* reserved opcodes */
                                0x80,                 /* goes on with nothing */
                                PING};                /* a control frame in pieces */
    for (size_t i = 0; i < sizeof first / sizeof first[0]; i++) {
        expect_cut(0, first[i], data, 13, true);
        expect_last_word(first[i]);
    }
    expect_cut(0, 0x80 | PING, data, 126, true); /* one that is too long */
    all_is_well();
}

/* Clients mask (RFC 6455, 5.1). libwebsockets takes what does not, and nobody else sees it. */
static void unmasked_frames(void **unused) {
    (void)unused;
    client c = open_client(s.port);
    put_frame(&c, 0x80 | TEXT_FRAME, "{\"do\":\"pace\",\"value\":0.5}", 25, false);
    put_frame(&c, 0x80 | TEXT_FRAME, "junk", 4, false);
    assert_int_not_equal(await_close(&c), -1);
    close_client(&c);
    all_is_well();
}

static void lengths_that_lie(void **unused) {
    (void)unused;
    static const unsigned char heads[][14] = {
        {0x81, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4},
        {0x81, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4},
        {0x81, 0xff, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4},
        {0x81, 0xfe, 0xff, 0xff, 1, 2, 3, 4, 'x', 'x', 'x', 'x', 'x', 'x'}};
    for (int i = 0; i < 4; i++) {
        client c = open_client(s.port);
        char junk[4096] = "x";
        put(c.fd, heads[i], 14);
        put(c.fd, junk, sizeof junk);
        await_close(&c);
        close_client(&c);
    }
    all_is_well();
}

/* Pieces are put together, and together they are no longer than one message. */
static void messages_in_pieces(void **unused) {
    (void)unused;
    client c = open_client(s.port);
    static const char text[] = "{\"do\":\"frame\"}";
    for (size_t i = 0; i < sizeof text - 1; i++)
        put_frame(&c, (i == 0 ? TEXT_FRAME : 0) | (i == sizeof text - 2 ? 0x80 : 0), text + i, 1,
                  true);
    await_binary(&c, 2);
    /* A ping in between belongs to nobody's message. */
    put_frame(&c, TEXT_FRAME, text, 5, true);
    put_frame(&c, 0x80 | PING, "hi", 2, true);
    put_frame(&c, 0x80, text + 5, sizeof text - 6, true);
    await_binary(&c, 2);
    char part[300];
    memset(part, ' ', sizeof part);
    put_frame(&c, TEXT_FRAME, part, sizeof part, true);
    for (int i = 0; i < 5; i++) put_frame(&c, 0, part, sizeof part, true);
    assert_int_equal(await_close(&c), 1009);
    close_client(&c);

    c = open_client(s.port); /* empty pieces without end */
    put_frame(&c, TEXT_FRAME, "", 0, true);
    for (int i = 0; i < 1000; i++) put_frame(&c, 0, "", 0, true);
    close_client(&c);
    all_is_well();
}

static void floods(void **unused) {
    (void)unused;
    client c = open_client(s.port); /* messages that are right, too many of them */
    for (int i = 0; i < 2000; i++)
        if (!put_frame(&c, 0x80 | TEXT_FRAME, "{\"do\":\"frame\"}", 14, true)) break;
    assert_int_equal(await_close(&c), 1008);
    close_client(&c);

    c = open_client(s.port); /* pings */
    char ping[125] = {0};
    int sent = 0, code = 0;
    for (; sent < 2000000 && code == 0; sent++) {
        struct pollfd ready = {.fd = c.fd, .events = POLLIN};
        if (!put_frame(&c, 0x80 | PING, ping, sizeof ping, true)) break;
        while (poll(&ready, 1, 0) > 0 && next_frame(&c))
            if (c.opcode == CLOSE_FRAME) code = c.data[0] << 8 | c.data[1];
        if (poll(&ready, 1, 0) > 0 && c.opcode == CLOSE_FRAME) break;
    }
    assert_true(sent < 2000000);
    close_client(&c);
    all_is_well();
}

/* Bytes from a generator, before and after the handshake. */
static void junk(void **unused) {
    (void)unused;
    uint32_t seed = 7;
    for (int round = 0; round < 100; round++) {
        unsigned char bytes[600];
        for (size_t i = 0; i < sizeof bytes; i++) {
            seed = seed * 1664525u + 1013904223u;
            bytes[i] = (unsigned char)(seed >> 24);
        }
        client c = {.fd = connect_to(s.port), .port = s.port};
        c.data = malloc(CLIENT_MAX);
        if (round % 2 == 0) try_upgrade(c.fd, s.port, (upgrade){0});
        if (round % 4 == 1) put(c.fd, "GET / HTTP/1.1\r\n", 16);
        put(c.fd, bytes, sizeof bytes);
        shutdown(c.fd, SHUT_WR);
        close_client(&c);
    }
    all_is_well();
}

/* Somebody comes and is let in, within a second. */
static void somebody_comes_in(void) {
    int status = 0;
    for (int i = 0; i < 100 && status != 101; i++) {
        int again = connect_to(s.port);
        if (again >= 0) status = try_upgrade(again, s.port, (upgrade){0});
        if (again >= 0) close(again);
        nap(0.01);
    }
    assert_int_equal(status, 101);
}

/* Connections that say nothing, or never end their request: more than the server keeps. They keep
 * nobody out. */
static void half_open_connections(void **unused) {
    (void)unused;
    enum { MANY = 400 };
    int fd[MANY];
    for (int i = 0; i < MANY; i++) {
        fd[i] = connect_to(s.port);
        if (fd[i] >= 0 && i % 2) put(fd[i], "GET /socket HTTP/1.1\r\nHost: ", 28);
    }
    all_is_well();
    somebody_comes_in();
    for (int i = 0; i < MANY; i++)
        if (fd[i] >= 0) close(fd[i]);
    somebody_comes_in();
    all_is_well();
}

/* Asks and never reads: pictures are left out for it, and it alone waits. */
static void who_never_reads(void **unused) {
    (void)unused;
    client c = open_client(s.port);
    int small = 2048;
    setsockopt(c.fd, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    for (int i = 0; i < 200; i++) {
        put_frame(&c, 0x80 | TEXT_FRAME, "{\"do\":\"frame\",\"field\":\"von_mises\"}", 34, true);
        put_frame(&c, 0x80 | TEXT_FRAME, "{\"do\":\"forces\",\"tool\":0,\"after\":0}", 34, true);
        nap(0.004);
    }
    all_is_well();
    close_client(&c);
    all_is_well();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(messages_that_are_none),
                                       cmocka_unit_test(frames_that_are_none),
                                       cmocka_unit_test(unmasked_frames),
                                       cmocka_unit_test(lengths_that_lie),
                                       cmocka_unit_test(messages_in_pieces),
                                       cmocka_unit_test(floods),
                                       cmocka_unit_test(junk),
                                       cmocka_unit_test(half_open_connections),
                                       cmocka_unit_test(who_never_reads)};
    return cmocka_run_group_tests(tests, open_all, close_all);
}
