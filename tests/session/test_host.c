/* A host that has a clock of its own ticks a session, and a driver in the same process gets what
 * its hand feels. */
#include "session/session.h"
#include "session/session_test.h"

#define PATH LAR_TEST_BUILD "/host.recording"

static void ticks(const bench *b, int count) {
    for (int i = 0; i < count; i++) DONE(lar_session_tick(b->session, &failure));
}

static double length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Ticks are those of the session's own thread: the same bits, and recordings of them. */
static void ticks_compute(void **unused) {
    (void)unused;
    for (int grid = 0; grid < 2; grid++) {
        lar_session_options options = lar_session_options_default();
        options.record = PATH;
        options.hash_every = 20;
        remove(PATH);
        bench b = open_bench(grid ? "2x1x1" : NULL, 0, &options);
        lar_session_info info;
        lar_session_inspect(b.session, &info);
        ticks(&b, 30);
        assert_int_equal(status_of(&b).step, 30 * info.tick_steps);
        assert_int_equal(status_of(&b).state, LAR_SESSION_PLAYING);
        assert_int_equal(status_of(&b).misses, 0);
        uint64_t hash = lar_simulation_hash(b.simulation);
        for (int i = 0; i < 200; i++) {
            const lar_tool_pose pose = pose_at(0.02, 0.01, 0.03 - 5e-5 * i, 0);
            DONE(lar_session_tool_move(b.session, BALL, &pose, &failure));
            ticks(&b, 1);
        }
        DONE(lar_session_set_stiffness(b.session, -1, 2, &failure));
        ticks(&b, 20);
        close_bench(&b);

        lar_model *model = hanging_block();
        lar_simulation *simulation = start_with(model, block_options(NULL, 0));
        lar_replay_report report;
        DONE(lar_simulation_advance(simulation, 30 * info.tick_steps, &failure));
        assert_int_equal(lar_simulation_hash(simulation), hash);
        DONE(lar_simulation_reset(simulation, &failure));
        DONE(lar_replay(simulation, PATH, NULL, NULL, &report, &failure));
        assert_true(report.different == UINT64_MAX && report.hashes > 10);
        finish(simulation, model);
    }
}

/* What waits elsewhere for the end of a tick is done at once, after what was asked for before. */
static void between_ticks(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    lar_snapshot *snapshot = NULL;
    int32_t held = 0;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    ticks(&b, 10);
    DONE(lar_session_snapshot(b.session, snapshot, 1, &failure));
    assert_int_equal(snapshot->hash, lar_simulation_hash(b.simulation));
    DONE(lar_session_grasp(b.session, HAND, (double[3]){0.02, 0.01, 0.02}, &held, &failure));
    assert_true(held > 0);
    lar_session_pause(b.session);
    ticks(&b, 5);
    assert_int_equal(status_of(&b).state, LAR_SESSION_PAUSED);
    assert_int_equal(status_of(&b).step, snapshot->step);
    lar_session_step(b.session, 7);
    ticks(&b, 5);
    assert_int_equal(status_of(&b).step, snapshot->step + 7);
    lar_session_play(b.session);
    DONE(lar_session_reset(b.session, &failure));
    assert_int_equal(status_of(&b).state, LAR_SESSION_PLAYING);
    ticks(&b, 1);
    assert_true(status_of(&b).step > 0 && status_of(&b).step < snapshot->step);
    lar_snapshot_destroy(snapshot);
    close_bench(&b);
}

/* One clock at a time, and nobody computes beside it. */
static void other_clocks_are_refused(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    ticks(&b, 1);
    assert_int_equal(lar_session_start(b.session, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "lar_session_tick"));
    assert_int_equal(lar_simulation_advance(b.simulation, 1, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_reset(b.simulation, &failure), LAR_ERROR_ARGUMENT);
    ticks(&b, 1);
    DONE(lar_session_close(b.session, &failure));
    DONE(lar_simulation_advance(b.simulation, 1, &failure));
    DONE(lar_session_open(b.simulation, NULL, &b.session, &failure));
    DONE(lar_session_start(b.session, &failure));
    assert_int_equal(lar_session_tick(b.session, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_tick(NULL, &failure), LAR_ERROR_ARGUMENT);
    close_bench(&b);
}

static void broken_runs_say_so(void **unused) {
    (void)unused;
    bench b = open_bench_of(torn_block(), NULL, 0, NULL);
    lar_status status = LAR_OK;
    for (int i = 0; i < 1000 && !status; i++) status = lar_session_tick(b.session, &failure);
    assert_int_equal(status, LAR_ERROR_UNSTABLE);
    assert_string_equal(failure.message, status_of(&b).message);
    DONE(lar_session_reset(b.session, &failure));
    ticks(&b, 1);
    close_bench(&b);
}

/* At rest the hand bears what the tissue pushes with; never more than 8 N; nothing when it has
 * gone, or while the session rests. */
static void hands_feel(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    lar_tool_force force;
    double felt[3] = {1, 1, 1}, torque[3];
    ticks(&b, 50);
    DONE(lar_session_tool_felt(b.session, BALL, felt, torque, &failure));
    assert_true(length(felt) == 0 && length(torque) == 0);
    for (int i = 0; i < 2000; i++) {
        const lar_tool_pose pose = pose_at(0.02, 0.01, 0.03 - fmin(1e-5 * i, 0.012), 0);
        DONE(lar_session_tool_move(b.session, BALL, &pose, &failure));
        ticks(&b, 1);
    }
    DONE(lar_session_tool_felt(b.session, BALL, felt, NULL, &failure));
    DONE(lar_session_tool_force(b.session, BALL, NULL, &force, &failure));
    assert_true(force.force[2] > 0.01);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(felt[k] - force.force[k]) < 0.02 * length(force.force));
    double most = 0;
    for (int i = 0; i < 500; i++) { /* far through the block, and beyond what it holds */
        const lar_tool_pose pose = pose_at(0.02, 0.01, 0.018 - fmin(1e-4 * i, 0.03), 0);
        DONE(lar_session_tool_move(b.session, BALL, &pose, &failure));
        ticks(&b, 1);
        DONE(lar_session_tool_felt(b.session, BALL, felt, NULL, &failure));
        most = fmax(most, length(felt));
    }
    assert_true(most > 2 * length(force.force) && most <= 8 + 1e-9);
    lar_session_pause(b.session);
    ticks(&b, 200);
    DONE(lar_session_tool_felt(b.session, BALL, felt, NULL, &failure));
    assert_true(length(felt) < 1e-3 * most);
    assert_int_equal(lar_session_tool_felt(b.session, TOOLS, felt, torque, &failure),
                     LAR_ERROR_ARGUMENT);
    DONE(lar_session_tool_felt(b.session, BALL, NULL, NULL, &failure));
    close_bench(&b);
}

static void *ask_all_the_time(void *argument) {
    bench *b = argument;
    lar_snapshot *snapshot = NULL;
    lar_error error;
    double felt[3];
    lar_status status = lar_snapshot_create(b->session, &snapshot, &error);
    for (int i = 0; i < 200 && !status; i++) {
        const lar_tool_pose pose = pose_at(0.02, 0.01, 0.03 - 5e-5 * i, 0);
        status = lar_session_tool_move(b->session, BALL, &pose, &error);
        if (!status) status = lar_session_tool_felt(b->session, BALL, felt, NULL, &error);
        if (!status) status = lar_session_snapshot(b->session, snapshot, 10, &error);
        if (!status && i % 20 == 0)
            status = lar_session_set_gravity(b->session, (double[3]){0, 0, -0.1 * i}, &error);
        if (i % 10 == 0) lar_session_pause(b->session);
        if (i % 10 == 1) lar_session_play(b->session);
    }
    lar_snapshot_destroy(snapshot);
    if (status) fprintf(stderr, "%s\n", error.message);
    return status ? argument : NULL;
}

static void other_threads_ask_meanwhile(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    pthread_t thread;
    void *failed = NULL;
    ticks(&b, 1);
    assert_int_equal(pthread_create(&thread, NULL, ask_all_the_time, &b), 0);
    while (pthread_tryjoin_np(thread, &failed)) {
        ticks(&b, 1);
        nap(1e-4); /* mutexes are not fair */
    }
    assert_null(failed);
    ticks(&b, 1);
    double gravity[3];
    lar_session_gravity(b.session, gravity);
    assert_true(gravity[2] == -0.1 * 180);
    close_bench(&b);
}

/* A host at a thousand hertz gets a thousandth of a second from every tick. */
static void ticks_are_exact(void **unused) {
    (void)unused;
    lar_model *model = hanging_block();
    lar_options options = block_options(NULL, 0);
    double given = options.time_step;
    options.time_step = 0;
    lar_simulation *simulation = start_with(model, options);
    double automatic = lar_simulation_time_step(simulation);
    lar_simulation_destroy(simulation);

    options.tick = 1e-3;
    simulation = start_with(model, options);
    double step = lar_simulation_time_step(simulation), steps = round(1e-3 / step);
    print_message("automatic step %g s, of a tick of 1 ms %g s\n", automatic, step);
    assert_true(step <= automatic && 1e-3 / (steps - 1) > automatic);
    assert_true(fabs(steps * step - 1e-3) < 1e-15);
    lar_session *session = NULL;
    lar_session_info info;
    DONE(lar_session_open(simulation, NULL, &session, &failure));
    lar_session_inspect(session, &info);
    assert_int_equal(info.tick_steps, steps);
    for (int i = 0; i < 100; i++) DONE(lar_session_tick(session, &failure));
    lar_session_close(session, NULL);
    assert_true(fabs(lar_simulation_time(simulation) - 0.1) < 1e-12);
    lar_simulation_destroy(simulation);

    /* A step that is given must fit; what is no tick is refused. */
    options.time_step = 0.37 * automatic;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "do not make a tick of 0.001 s"));
    options.time_step = 1e-3 / ceil(1e-3 / automatic + 1);
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    assert_true(lar_simulation_time_step(simulation) == options.time_step);
    lar_simulation_destroy(simulation);
    options.time_step = given;
    for (int i = 0; i < 4; i++) {
        options.tick = (double[]){-1e-3, NAN, INFINITY, 1e-317}[i];
        assert_int_equal(lar_simulation_create(model, &options, &simulation, &failure),
                         LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(failure.message, "a tick must be 1e-15 s at least"));
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ticks_compute),
        cmocka_unit_test(between_ticks),
        cmocka_unit_test(other_clocks_are_refused),
        cmocka_unit_test(broken_runs_say_so),
        cmocka_unit_test(hands_feel),
        cmocka_unit_test(other_threads_ask_meanwhile),
        cmocka_unit_test(ticks_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
