/* Taking hold and letting go, as a person asks for it: at once, answered, whatever was sent before,
 * and played again to the same bits. */
#include "session/session_test.h"

#define PATH LAR_TEST_BUILD "/grasp.recording"

static const double corner[3] = {0.03, 0.02, 0.019}, nowhere[3] = {0.3, 0.2, 0.1};

static int32_t held_now(const bench *b, int32_t tool) {
    lar_tool_force force;
    DONE(lar_session_tool_force(b->session, tool, NULL, &force, &failure));
    return force.held;
}

static double opening_of(const bench *b, int32_t tool) {
    lar_tool_pose pose;
    DONE(lar_session_tool_force(b->session, tool, &pose, NULL, &failure));
    return pose.opening;
}

static void pull(const bench *b, double by) {
    const lar_tool_pose pose = pose_at(corner[0] + by, corner[1], corner[2] + by, 0);
    DONE(lar_session_tool_move(b->session, HAND, &pose, &failure));
}

static void a_hand_takes_hold_at_once(void **unused) {
    (void)unused;
    for (int paused = 0; paused < 2; paused++) {
        lar_session_options options = lar_session_options_default();
        options.paused = paused;
        bench b = open_bench(NULL, 0, &options);
        int32_t held = -1;
        DONE(lar_session_start(b.session, &failure));
        /* What was sent before does not open it again. */
        const lar_tool_pose away = pose_at(0.1, 0.1, 0.1, 1);
        DONE(lar_session_tool_move(b.session, HAND, &away, &failure));
        DONE(lar_session_grasp(b.session, HAND, corner, &held, &failure));
        assert_true(held > 0);
        assert_int_equal(held_now(&b, HAND), held);
        lar_session_play(b.session);
        pull(&b, 0.01);
        await(&b, LAR_SESSION_PLAYING, status_of(&b).step + 500);
        assert_int_equal(held_now(&b, HAND), held);
        /* Somewhere else, without letting go first; then at nothing. */
        DONE(lar_session_grasp(b.session, HAND, (double[]){0.03, 0, 0.019}, &held, &failure));
        assert_true(held > 0);
        DONE(lar_session_grasp(b.session, HAND, nowhere, &held, &failure));
        assert_int_equal(held, 0);
        await(&b, LAR_SESSION_PLAYING, status_of(&b).step + 20);
        assert_int_equal(held_now(&b, HAND), 0);
        assert_true(opening_of(&b, HAND) > 0.9);
        DONE(lar_session_grasp(b.session, HAND, corner, NULL, &failure));
        DONE(lar_session_release(b.session, HAND, &failure));
        assert_int_equal(held_now(&b, HAND), 0);
        close_bench(&b);
    }
}

static void others_are_refused(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    bench b = open_bench(NULL, 0, &options);
    int32_t held = 7;
    const double endless[3] = {0, INFINITY, 0};
    struct {
        int32_t tool;
        const double *point;
        const char *why;
    } wrong[] = {{BALL, corner, "no hand and no grasper"},
                 {HAND, NULL, "needs the point"},
                 {HAND, endless, "not finite"},
                 {TOOLS, corner, "there is no tool 3"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(
            lar_session_grasp(b.session, wrong[i].tool, wrong[i].point, &held, &failure),
            LAR_ERROR_ARGUMENT);
        if (!strstr(failure.message, wrong[i].why)) fail_msg("%s", failure.message);
        assert_int_equal(held, 0);
    }
    assert_int_equal(lar_session_release(b.session, BALL, &failure), LAR_ERROR_ARGUMENT);
    close_bench(&b);
}

/* The answer to a ticket, when it is there. */
static lar_grasp_answer await_answer(const bench *b, int32_t tool, uint64_t ticket) {
    lar_grasp_answer answer = {0};
    int64_t limit = lar_clock_ns() + 20000000000;
    do {
        usleep(1000);
        DONE(lar_session_grasp_answer(b->session, tool, &answer, &failure));
    } while (answer.ticket != ticket && lar_clock_ns() < limit);
    assert_int_equal(answer.ticket, ticket);
    return answer;
}

static void nobody_has_to_wait(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    bench b = open_bench(NULL, 0, &options);
    lar_grasp_answer answer = {.ticket = 7};
    lar_session_info info;
    lar_session_inspect(b.session, &info);
    assert_ptr_equal(info.simulation, b.simulation);
    assert_int_equal(info.tick_steps, 10);
    assert_true(fabs(info.tick - 1e-3) < 1e-12 && info.options.pace == 1);
    assert_true(info.options.tool_speed == 1 && info.options.hand_force == 1);
    DONE(lar_session_grasp_answer(b.session, HAND, &answer, &failure));
    assert_int_equal(answer.ticket, 0);
    /* Before the start it waits for it; 256 may. */
    DONE(lar_session_ask_grasp(b.session, HAND, corner, 1, &failure));
    DONE(lar_session_grasp_answer(b.session, HAND, &answer, &failure));
    assert_int_equal(answer.ticket, 0);
    for (int i = 0; i < 255; i++) DONE(lar_session_ask_release(b.session, HAND + 1, &failure));
    assert_int_equal(lar_session_ask_release(b.session, HAND, &failure), LAR_ERROR_PEER);
    assert_non_null(strstr(failure.message, "256"));
    assert_int_equal(lar_session_ask_grasp(b.session, HAND, corner, 2, &failure), LAR_ERROR_PEER);
    DONE(lar_session_start(b.session, &failure));
    answer = await_answer(&b, HAND, 1);
    assert_true(answer.held > 0 && answer.status == LAR_OK);
    assert_int_equal(held_now(&b, HAND), answer.held);
    DONE(lar_session_ask_grasp(b.session, HAND, nowhere, 2, &failure));
    answer = await_answer(&b, HAND, 2);
    assert_true(answer.held == 0 && answer.status == LAR_OK);
    /* What waiting would have refused. */
    DONE(lar_session_ask_grasp(b.session, HAND, NULL, 3, &failure));
    answer = await_answer(&b, HAND, 3);
    assert_true(answer.held == 0 && answer.status == LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_ask_grasp(b.session, HAND, corner, 0, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_ask_grasp(b.session, TOOLS, corner, 4, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_ask_grasp(NULL, HAND, corner, 4, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_ask_release(b.session, -1, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_ask_release(NULL, HAND, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_grasp_answer(NULL, HAND, &answer, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_grasp_answer(b.session, HAND, NULL, &failure), LAR_ERROR_ARGUMENT);
    close_bench(&b);
}

static void recordings_have_them(void **unused) {
    (void)unused;
    static const char *const grid[] = {NULL, "2x1x1", "2x2x1"};
    lar_session_options options = lar_session_options_default();
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_bench("2x1x1", 1, &options);
    DONE(lar_session_start(b.session, &failure));
    for (int k = 1; k <= 4; k++) {
        int32_t held;
        DONE(lar_session_grasp(b.session, HAND, corner, &held, &failure));
        assert_true(held > 0);
        pull(&b, 0.002 * k);
        await(&b, LAR_SESSION_PLAYING, status_of(&b).step + 100);
        if (k % 2) DONE(lar_session_release(b.session, HAND, &failure));
        /* And without waiting. */
        DONE(lar_session_ask_grasp(b.session, HAND + 1, corner, (uint64_t)k, &failure));
        assert_true(await_answer(&b, HAND + 1, (uint64_t)k).held > 0);
        if (k % 2) DONE(lar_session_ask_release(b.session, HAND + 1, &failure));
    }
    close_bench(&b);
    for (int k = 0; k < 3; k++) {
        lar_model *model = hanging_block();
        lar_simulation *simulation = start_with(model, block_options(grid[k], 0));
        lar_replay_report report;
        DONE(lar_replay(simulation, PATH, NULL, NULL, &report, &failure));
        assert_true(report.different == UINT64_MAX && report.hashes > 4);
        assert_true(report.recorded_hash == report.replayed_hash);
        finish(simulation, model);
    }
}

/* Without a session; a grasper's jaws take some steps. */
static void simulations_have_them(void **unused) {
    (void)unused;
    lar_model *model = hanging_block();
    *(lar_tool *)LAR_MODEL_APPEND(model, tool) =
        (lar_tool){.name = lar_strdup("grasper"),
                   .shape = LAR_TOOL_GRASPER,
                   .radius = 0.002,
                   .length = 0.015,
                   .spread = 1,
                   .rest = {.position = {0.055, 0.01, 0.01},
                            .orientation = {sqrt(0.5), 0, sqrt(0.5), 0},
                            .opening = 1}};
    lar_simulation *simulation = start_with(model, block_options(NULL, 0));
    int32_t hand = 2, grasper = 1, held = -1;
    lar_tool_pose pose;
    DONE(lar_simulation_grasp(simulation, hand, corner, 1, &held, &failure));
    assert_true(held > 0);
    DONE(lar_simulation_release(simulation, hand, 1, &failure));
    DONE(lar_simulation_grasp(simulation, hand, nowhere, 1, &held, &failure));
    assert_int_equal(held, 0);
    DONE(lar_simulation_grasp(simulation, grasper, NULL, 200, &held, &failure));
    advance(simulation, 100);
    DONE(lar_simulation_tool_pose(simulation, grasper, &pose, &failure));
    assert_true(pose.opening > 0.2 && pose.opening < 1);
    DONE(lar_simulation_release(simulation, grasper, 100, &failure));
    advance(simulation, 200);
    DONE(lar_simulation_tool_pose(simulation, grasper, &pose, &failure));
    assert_true(pose.opening > 0.99);
    DONE(lar_simulation_grasp(simulation, grasper, NULL, 0, &held, &failure)); /* as it needs */
    advance(simulation, 200);
    DONE(lar_simulation_tool_pose(simulation, grasper, &pose, &failure));
    assert_true(pose.opening < 0.9);
    DONE(lar_simulation_release(simulation, grasper, 0, &failure));
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hand_takes_hold_at_once), cmocka_unit_test(others_are_refused),
        cmocka_unit_test(nobody_has_to_wait), cmocka_unit_test(recordings_have_them),
        cmocka_unit_test(simulations_have_them)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
