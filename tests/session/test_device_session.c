/* Devices at a session's tools: a script is the same run every time, on any grid; a device on the
 * network is answered while the session plays and while it rests. */
#include "session/session_test.h"

#include "study/device_client.h"

static void write_script(void) {
    FILE *file = fopen("device_session.csv", "w");
    assert_non_null(file);
    fputs("time,x,y,z\n0,0.02,0.01,0.03\n0.1,0.02,0.01,0.012\n0.2,0.025,0.01,0.03\n", file);
    fclose(file);
}

static void wait_for_step(const bench *b, uint64_t step) {
    for (int i = 0; i < 2000 && status_of(b).step < step; i++) nap(0.01);
    assert_int_equal(status_of(b).step, step);
}

static uint64_t hash_of(const bench *b) {
    lar_snapshot *snapshot;
    DONE(lar_snapshot_create(b->session, &snapshot, &failure));
    DONE(lar_session_snapshot(b->session, snapshot, 5, &failure));
    uint64_t hash = snapshot->hash;
    lar_snapshot_destroy(snapshot);
    return hash;
}

static double greatest_force(const bench *b) {
    float force[2000][3];
    uint64_t last;
    double max = 0;
    int32_t count = lar_session_force_history(b->session, BALL, 0, 2000, force, &last);
    for (int32_t i = 0; i < count; i++) max = fmax(max, hypot(force[i][0], force[i][2]));
    return max;
}

static uint64_t play_script(const char *grid, double pace, bool reset) {
    lar_session_options options = lar_session_options_default();
    options.paused = 1;
    options.pace = pace;
    bench b = open_bench(grid, 1, &options);
    DONE(lar_session_attach(b.session, BALL, "script:device_session.csv", &failure));
    DONE(lar_session_start(b.session, &failure));
    if (reset) {
        lar_session_step(b.session, 700);
        wait_for_step(&b, 700);
        DONE(lar_session_reset(b.session, &failure));
    }
    lar_session_step(b.session, 2000);
    wait_for_step(&b, 2000);
    uint64_t hash = hash_of(&b);
    assert_true(greatest_force(&b) > 1e-3);
    close_bench(&b);
    return hash;
}

static void test_script_is_the_same_run(void **state) {
    (void)state;
    write_script();
    uint64_t hash = play_script(NULL, 0, false);
    assert_int_equal(play_script(NULL, 2, false), hash); /* at another pace */
    assert_int_equal(play_script("2x1x1", 0, false), hash);
    assert_int_equal(play_script(NULL, 0, true), hash); /* begins anew with a reset */
}

static lar_device_status device_of(const bench *b, int32_t tool) {
    lar_device_status status;
    DONE(lar_session_device(b->session, tool, &status, &failure));
    return status;
}

static lar_device_client_report emulate(int port, double push, double seconds) {
    char address[64];
    snprintf(address, sizeof address, "udp:127.0.0.1:%d", port);
    lar_device_client_options options = {
        .address = address, .push = push, .period = 0.5, .rate = 1000, .seconds = seconds};
    lar_device_client_report report;
    DONE(lar_device_client(&options, &report, &failure));
    return report;
}

static void test_network_device_plays(void **state) {
    (void)state;
    bench b = open_bench(NULL, 1, NULL);
    assert_null(device_of(&b, BALL).name);
    DONE(lar_session_start(b.session, &failure));
    nap(0.02);
    DONE(lar_session_attach(b.session, BALL, "udp:127.0.0.1:0", &failure)); /* while it runs */
    lar_device_status device = device_of(&b, BALL);
    assert_string_equal(device.name, "udp:127.0.0.1:0");
    assert_true(device.port > 0);
    assert_int_equal(lar_session_attach(b.session, BALL, "udp:127.0.0.1:0", &failure),
                     LAR_ERROR_ARGUMENT); /* has one already */
    lar_device_client_report report = emulate(device.port, 0.02, 1.1);
    assert_true(report.answered > 0 && report.steps > 0);
    assert_true(report.touching > 0);
    if (!(report.force_max > 1e-3 && report.force_max <= 8.001))
        fail_msg("the largest force is %g N", report.force_max);
    assert_int_equal(report.strange, 0);
    /* What has a device does not listen. */
    lar_tool_pose away = {.position = {0.5, 0.5, 0.5}, .orientation = {1, 0, 0, 0}}, pose;
    DONE(lar_session_tool_move(b.session, BALL, &away, &failure));
    nap(0.05);
    DONE(lar_session_tool_force(b.session, BALL, &pose, NULL, &failure));
    assert_true(pose.position[0] < 0.1);
    close_bench(&b);
}

/* At rest it is answered, without force, in ticks as long as when it plays. */
static void test_network_device_at_rest(void **state) {
    (void)state;
    lar_session_options options = lar_session_options_default();
    options.paused = 1;
    bench b = open_bench(NULL, 1, &options);
    DONE(lar_session_attach(b.session, BALL, "udp:127.0.0.1:0", &failure));
    DONE(lar_session_start(b.session, &failure));
    lar_device_client_report report = emulate(device_of(&b, BALL).port, 0.02, 0.2);
    assert_true(report.answered > 0);
    assert_int_equal(report.steps, 0);
    assert_true(report.force_max == 0);
    close_bench(&b);
}

/* The answer times are there within the second that they are summed up in. */
static void test_answer_times_are_told(void **state) {
    (void)state;
    bench b = open_bench(NULL, 1, NULL);
    DONE(lar_session_attach(b.session, BALL, "udp:127.0.0.1:0", &failure));
    DONE(lar_session_start(b.session, &failure));
    lar_device_client_report report = emulate(device_of(&b, BALL).port, 0, 0.2);
    for (int i = 0; i < 300 && device_of(&b, BALL).received < report.sent; i++) nap(0.01);
    lar_device_status device = device_of(&b, BALL);
    assert_int_equal(device.received, report.sent - device.lost - device.late);
    assert_true(device.answered >= report.answered);
    assert_true(device.answer_p50 > 0 && device.answer_p50 <= device.answer_p99);
    assert_true(device.answer_p99 <= device.answer_p999);
    assert_true(device.answer_p999 <= device.answer_max);
    assert_true(report.round_trip_p50 >= 0.5 * device.answer_p50);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_script_is_the_same_run),
        cmocka_unit_test(test_network_device_plays),
        cmocka_unit_test(test_network_device_at_rest),
        cmocka_unit_test(test_answer_times_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
