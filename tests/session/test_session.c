/* A session starts, plays, pauses, steps, stops and ends; what it tells is of one step, and says
 * how it goes. */
#include "session/session_test.h"

/* ---- playing ------------------------------------------------------------------------------- */

static void plays_pauses_and_steps(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    assert_int_equal(status_of(&b).state, LAR_SESSION_IDLE);
    DONE(lar_session_start(b.session, &failure));
    assert_int_equal(lar_session_start(b.session, &failure), LAR_ERROR_ARGUMENT);
    await(&b, LAR_SESSION_PLAYING, 100);
    lar_session_pause(b.session);
    uint64_t step = await(&b, LAR_SESSION_PAUSED, 0).step;
    assert_int_equal(step % 10, 0);
    nap(0.02);
    assert_int_equal(status_of(&b).step, step);
    lar_session_step(b.session, 7);
    lar_session_step(b.session, 16);
    assert_int_equal(await(&b, LAR_SESSION_PAUSED, step + 23).step, step + 23);
    lar_session_play(b.session);
    await(&b, LAR_SESSION_PLAYING, step + 60);
    lar_session_step(b.session, 5);
    uint64_t after = await(&b, LAR_SESSION_PAUSED, step + 65).step;
    assert_int_equal((after - step - 23) % 10, 5);
    close_bench(&b);
}

static void waits_when_it_starts_paused(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.paused = 1;
    bench b = open_bench(NULL, 0, &options);
    DONE(lar_session_start(b.session, &failure));
    await(&b, LAR_SESSION_PAUSED, 0);
    nap(0.03);
    assert_int_equal(status_of(&b).step, 0);
    close_bench(&b);
    /* What is asked before the start is done after it. */
    b = open_bench(NULL, 0, &options);
    for (int i = 0; i < 300; i++) lar_session_step(b.session, 1); /* the ring holds 256 */
    DONE(lar_session_start(b.session, &failure));
    assert_int_equal(await(&b, LAR_SESSION_PAUSED, 256).step, 256);
    close_bench(&b);
    lar_session_close(NULL, &failure);
}

static void refused_by(const char *part, lar_status status) {
    assert_int_equal(status, LAR_ERROR_ARGUMENT);
    if (!strstr(failure.message, part)) fail_msg("%s", failure.message);
}

/* Nobody else may compute what a session computes, or change it, from when it is open: recordings
 * begin there. */
static void has_its_simulation_for_itself(void **unused) {
    (void)unused;
    static const char busy[] = "a session has this simulation";
    bench b = open_bench(NULL, 0, NULL);
    lar_session *other = NULL;
    lar_results *results = NULL;
    refused_by("a session is open", lar_session_open(b.simulation, NULL, &other, &failure));
    assert_null(other);
    refused_by(busy, lar_simulation_advance(b.simulation, 1, &failure));
    refused_by(busy, lar_simulation_set_damping(b.simulation, 1, &failure));
    DONE(lar_results_open("session_results", b.simulation, &results, &failure));
    refused_by(busy, lar_results_add(results, b.simulation, &failure));
    DONE(lar_session_start(b.session, &failure));
    await(&b, LAR_SESSION_PLAYING, 20);
    const lar_tool_pose pose = {.position = {0, 0, 0.1}, .orientation = {1, 0, 0, 0}};
    refused_by(busy, lar_simulation_advance(b.simulation, 1, &failure));
    refused_by(busy, lar_simulation_reset(b.simulation, &failure));
    refused_by(busy, lar_simulation_tool_move(b.simulation, BALL, &pose, 10, &failure));
    refused_by(busy, lar_simulation_set_damping(b.simulation, 1, &failure));
    refused_by(busy, lar_results_add(results, b.simulation, &failure));
    DONE(lar_session_reset(b.session, &failure));
    DONE(lar_session_close(b.session, &failure));
    DONE(lar_simulation_advance(b.simulation, 1, &failure));
    DONE(lar_results_close(results, &failure));
    DONE(lar_session_open(b.simulation, NULL, &b.session, &failure));
    close_bench(&b);
}

/* The simulation does not get ahead of the clock, and on a fast pace does. */
static void keeps_its_pace(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.pace = 0.25;
    bench b = open_bench(NULL, 0, &options);
    int64_t begin = lar_clock_ns();
    DONE(lar_session_start(b.session, &failure));
    nap(0.2);
    lar_session_status status = status_of(&b);
    assert_below(status.time, 0.25e-9 * (double)(lar_clock_ns() - begin) + 1.1e-3);
    assert_below(status.real_time_factor, 0.2501);
    lar_session_set_pace(b.session, 0);
    await(&b, LAR_SESSION_PLAYING, 20000); /* two seconds */
    lar_session_pause(b.session);
    status = await(&b, LAR_SESSION_PAUSED, 0);
    assert_true(status.real_time_factor > 0.25);
    close_bench(&b);
}

/* However far away the next tick is, nobody waits for it. */
static void listens_in_slow_motion(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.pace = 1e-9; /* ticks of 11 days */
    bench b = open_bench(NULL, 0, &options);
    lar_snapshot *snapshot = NULL;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    DONE(lar_session_start(b.session, &failure));
    assert_int_equal(await(&b, LAR_SESSION_PLAYING, 10).step, 10);
    DONE(lar_session_snapshot(b.session, snapshot, 20, &failure));
    assert_int_equal(snapshot->step, 10);
    lar_session_pause(b.session);
    await(&b, LAR_SESSION_PAUSED, 10);
    lar_session_play(b.session);
    await(&b, LAR_SESSION_PLAYING, 20);
    lar_session_set_pace(b.session, 100);
    await(&b, LAR_SESSION_PLAYING, 200);
    lar_session_set_pace(b.session, 1e-300);
    DONE(lar_session_reset(b.session, &failure));
    lar_snapshot_destroy(snapshot);
    close_bench(&b);
}

/* A pace that no machine can hold is announced as slow motion, and what is lost is counted. */
static void slow_motion_is_announced(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.pace = 1e6;
    bench b = open_bench(NULL, 0, &options);
    DONE(lar_session_start(b.session, &failure));
    lar_session_status status = status_of(&b);
    for (int i = 0; i < 10000 && !status.slow_motion; i++) {
        nap(0.001);
        status = status_of(&b);
    }
    assert_true(status.slow_motion);
    nap(0.3);
    status = status_of(&b);
    assert_true(status.slow_motion);
    assert_true(status.skipped > 0);
    assert_int_equal(status.misses, 0);
    assert_true(status.slow_ticks > 0 && status.slow_ticks <= status.ticks);
    assert_int_equal(status.slow_cause, LAR_SLOW_STEP);
    assert_non_null(strstr(status.slow_advice, "what would hold"));
    assert_true(status.real_time_factor < 1e5);
    lar_session_set_pace(b.session, 0); /* no pace, nothing to miss */
    lar_session_pause(b.session);
    status = await(&b, LAR_SESSION_PAUSED, 0);
    lar_session_play(b.session);
    await(&b, LAR_SESSION_PLAYING, status.step + 1000);
    assert_int_equal(status_of(&b).misses + status_of(&b).slow_ticks,
                     status.misses + status.slow_ticks);
    close_bench(&b);
}

static void numbers_are_finite(const lar_session_status *s) {
    const double value[] = {
        s->time,        s->step_p50,         s->step_p99,    s->step_p999,
        s->step_max,    s->tick_p50,         s->tick_p99,    s->tick_p999,
        s->tick_max,    s->real_time_factor, s->engine_rate, s->real_time_factor_now,
        s->haptic_rate, s->snapshot_rate,    s->lag,         s->skipped};
    for (size_t i = 0; i < sizeof value / sizeof value[0]; i++)
        if (!(value[i] >= 0 && value[i] < 1e12)) fail_msg("number %d is %g", (int)i, value[i]);
}

static void status_is_finite_and_complete(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    lar_session_status status = status_of(&b);
    numbers_are_finite(&status);
    DONE(lar_session_start(b.session, &failure));
    for (int i = 0; i < 200; i++) {
        status = status_of(&b);
        numbers_are_finite(&status);
        nap(0.002);
    }
    assert_true(status.step_p50 > 0 && status.step_max >= status.step_p50);
    assert_true(status.tick_p50 > 0 && status.tick_max >= status.tick_p50);
    assert_true(status.engine_rate > 0 && status.haptic_rate > 0);
    assert_true(status.ticks > 0 && status.ticks <= status.step / 10 + 1);
    assert_true(status.real_time_factor_now > 0);
    lar_session_pause(b.session);
    status = await(&b, LAR_SESSION_PAUSED, 0);
    numbers_are_finite(&status);
    close_bench(&b);
}

/* ---- snapshots ----------------------------------------------------------------------------- */

static void snapshots_are_of_one_step(void **unused) {
    (void)unused;
    static const struct {
        const char *grid;
        int threads;
    } divided[] = {{NULL, 0}, {"1x1x1", 1}, {"2x1x1", 1}, {"2x1x1", 2}};
    for (int k = 0; k < 4; k++) {
        bench b = open_bench(divided[k].grid, divided[k].threads, NULL);
        lar_model *model = hanging_block();
        lar_simulation *plain = start_with(model, block_options(NULL, 0));
        lar_snapshot *snapshot = NULL;
        DONE(lar_snapshot_create(b.session, &snapshot, &failure));
        double(*u)[3] = lar_calloc((size_t)snapshot->nodes, sizeof *u);
        for (int i = 0; i < 10; i++) {
            /* Before the start, while it plays, and paused. */
            if (i == 1) DONE(lar_session_start(b.session, &failure));
            if (i == 8) lar_session_pause(b.session);
            DONE(lar_session_snapshot(b.session, snapshot, 30, &failure));
            uint64_t now = lar_simulation_steps(plain);
            assert_true(snapshot->step >= now);
            advance(plain, snapshot->step - now);
            assert_true(snapshot->hash == lar_simulation_hash(plain));
            assert_true(snapshot->time == lar_simulation_time(plain));
            lar_simulation_displacements(plain, u);
            assert_memory_equal(u, snapshot->u, (size_t)snapshot->nodes * sizeof *u);
            nap(0.003);
        }
        free(u);
        lar_snapshot_destroy(snapshot);
        close_bench(&b);
        finish(plain, model);
    }
}

static void late_snapshots_are_refused(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.tick = 1; /* the longest */
    options.pace = 0;
    bench b = open_bench(NULL, 0, &options);
    lar_snapshot *snapshot = NULL;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    lar_session_step(b.session, 100000);
    DONE(lar_session_start(b.session, &failure));
    assert_int_equal(lar_session_snapshot(b.session, snapshot, 0, &failure), LAR_ERROR_PEER);
    lar_snapshot_destroy(snapshot);
    close_bench(&b);
}

/* Another session's may be of fewer nodes, and nothing is written behind them. */
static void snapshots_of_others_are_refused(void **unused) {
    (void)unused;
    static const brick small = {{1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};
    bench a = open_bench_of(brick_model(&small), NULL, 0, NULL), b = open_bench(NULL, 0, NULL);
    lar_snapshot *snapshot = NULL;
    int32_t fresh = 1;
    DONE(lar_snapshot_create(a.session, &snapshot, &failure));
    assert_int_equal(lar_session_snapshot(b.session, snapshot, 1, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "created for it"));
    assert_int_equal(lar_session_snapshot_poll(b.session, snapshot, &fresh, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(fresh, 0);
    DONE(lar_session_snapshot(a.session, snapshot, 1, &failure));
    lar_snapshot_destroy(snapshot);
    close_bench(&a);
    close_bench(&b);
}

/* Polling never waits: the present state before the start, then one state after the other. */
static void polled_snapshots_come_by_and_by(void **unused) {
    (void)unused;
    bench b = open_bench("2x1x1", 1, NULL);
    lar_snapshot *snapshot = NULL, *waited = NULL;
    int32_t fresh = 0, seen = 0;
    uint64_t last = 0;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    DONE(lar_snapshot_create(b.session, &waited, &failure));
    assert_int_equal(lar_session_snapshot_poll(b.session, NULL, &fresh, &failure),
                     LAR_ERROR_ARGUMENT);
    for (int i = 0; i < 3; i++) {
        DONE(lar_session_snapshot_poll(b.session, snapshot, &fresh, &failure));
        assert_true(fresh && snapshot->step == 0 && snapshot->tools == TOOLS);
    }
    DONE(lar_session_start(b.session, &failure));
    for (int i = 0; i < 20000 && seen < 5; i++) {
        DONE(lar_session_snapshot_poll(b.session, snapshot, &fresh, &failure));
        assert_true(!fresh || snapshot->step >= last);
        if (fresh) last = snapshot->step;
        seen += fresh;
        nap(0.001);
    }
    assert_int_equal(seen, 5);
    lar_session_pause(b.session);
    uint64_t end = await(&b, LAR_SESSION_PAUSED, last).step;
    for (int i = 0; i < 20000 && snapshot->step < end; i++) {
        DONE(lar_session_snapshot_poll(b.session, snapshot, &fresh, &failure));
        nap(0.001);
    }
    assert_int_equal(snapshot->step, end);
    DONE(lar_session_snapshot(b.session, waited, 30, &failure));
    assert_true(snapshot->hash == waited->hash && snapshot->kinetic == waited->kinetic);
    lar_snapshot_destroy(snapshot);
    lar_snapshot_destroy(waited);
    close_bench(&b);
}

/* ---- tools --------------------------------------------------------------------------------- */

/* The ball is pressed onto the block: a force is there, kept in the history; in a pause the
 * tissue's stays, and what a hand feels of it fades. */
static void tools_are_felt(void **unused) {
    (void)unused;
    bench b = open_bench("2x1x1", 1, NULL);
    DONE(lar_session_start(b.session, &failure));
    const lar_tool_pose down = pose_at(0.02, 0.01, 0.021, 0);
    DONE(lar_session_tool_move(b.session, BALL, &down, &failure));
    lar_tool_force force = {0};
    lar_tool_pose pose = {0};
    /* The force is a tick's mean, the points are its last step's: the block may have jumped off. */
    for (int i = 0; i < 10000 && (force.force[2] < 1e-3 || force.touching == 0); i++) {
        nap(0.001);
        DONE(lar_session_tool_force(b.session, BALL, &pose, &force, &failure));
    }
    assert_true(force.force[2] >= 1e-3);
    assert_true(force.touching > 0);
    assert_true(pose.position[2] < 0.025);
    lar_snapshot *snapshot = NULL;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    DONE(lar_session_snapshot(b.session, snapshot, 30, &failure));
    assert_int_equal(snapshot->tools, TOOLS);
    assert_true(snapshot->tool[BALL].pose.position[2] < 0.025);
    assert_true(snapshot->tool[HAND].force[2] == 0);
    lar_snapshot_destroy(snapshot);
    float kept[64][3];
    uint64_t last = 0, tick = 0;
    int32_t count = 0;
    bool felt = false;
    while ((count = lar_session_force_history(b.session, BALL, last, 64, kept, &last)) > 0) {
        for (int32_t i = 0; i < count; i++) felt = felt || kept[i][2] > 0;
        tick += (uint64_t)count;
        assert_int_equal(last, tick);
    }
    assert_true(felt);
    lar_session_pause(b.session);
    await(&b, LAR_SESSION_PAUSED, 0);
    DONE(lar_session_tool_force(b.session, BALL, NULL, &force, &failure));
    double hand[3] = {0, 0, 1}, pushed = force.force[2];
    for (int i = 0; i < 10000 && hand[2] != 0; i++) {
        nap(0.001);
        DONE(lar_session_tool_felt(b.session, BALL, hand, NULL, &failure));
    }
    assert_true(hand[2] == 0);
    nap(0.1);
    DONE(lar_session_tool_force(b.session, BALL, NULL, &force, &failure));
    assert_true(force.force[2] == pushed);
    close_bench(&b);
}

/* Whoever closes a session waits for the end of the tick. */
static void endless_ticks_are_refused(void **unused) {
    (void)unused;
    bench b = {.model = hanging_block()};
    const lar_options how = block_options(NULL, 0);
    DONE(lar_simulation_create(b.model, &how, &b.simulation, &failure));
    for (int i = 0; i < 4; i++) {
        lar_session_options options = lar_session_options_default();
        options.tick = (double[]){1.0001, 1e5, 1e-317, 1}[i];
        lar_status status = lar_session_open(b.simulation, &options, &b.session, &failure);
        assert_int_equal(status, i < 3 ? LAR_ERROR_ARGUMENT : LAR_OK);
        if (status) assert_non_null(strstr(failure.message, "give 1e-15 to 1 s"));
    }
    close_bench(&b);
}

/* Those that nobody has asked for are not: of a cell a millisecond would be too many steps. */
static void ticks_of_small_steps_are_shorter(void **unused) {
    (void)unused;
    bench b = {.model = hanging_block()};
    lar_options how = block_options(NULL, 0);
    how.time_step = 3e-8;
    DONE(lar_simulation_create(b.model, &how, &b.simulation, &failure));
    DONE(lar_session_open(b.simulation, NULL, &b.session, &failure));
    lar_session_info info;
    lar_session_inspect(b.session, &info);
    assert_int_equal(info.tick_steps, 10000);
    close_bench(&b);
}

static void wrong_calls_are_refused(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    lar_session *session = NULL;
    lar_snapshot *snapshot = NULL;
    lar_tool_pose pose = pose_at(0, 0, 0, 0);
    uint64_t last = 7;
    float kept[1][3];
#define REFUSED(call) assert_int_equal(call, LAR_ERROR_ARGUMENT)
    REFUSED(lar_session_open(NULL, NULL, &session, &failure));
    REFUSED(lar_session_open(b.simulation, NULL, NULL, &failure));
    lar_session_options options = lar_session_options_default();
    options.tick = -1;
    REFUSED(lar_session_open(b.simulation, &options, &session, &failure));
    options = lar_session_options_default();
    options.pace = NAN;
    REFUSED(lar_session_open(b.simulation, &options, &session, &failure));
    options = lar_session_options_default();
    options.priority = 100;
    REFUSED(lar_session_open(b.simulation, &options, &session, &failure));
    assert_null(session);
    REFUSED(lar_session_start(NULL, &failure));
    REFUSED(lar_session_reset(NULL, &failure));
    REFUSED(lar_session_save(b.session, NULL, &failure));
    REFUSED(lar_session_save(NULL, "x", &failure));
    REFUSED(lar_session_load(b.session, "", &failure));
    REFUSED(lar_session_record(NULL, "x", &failure));
    REFUSED(lar_session_tool_move(b.session, TOOLS, &pose, &failure));
    REFUSED(lar_session_tool_move(b.session, -1, &pose, &failure));
    REFUSED(lar_session_tool_move(b.session, 0, NULL, &failure));
    pose.position[1] = NAN;
    REFUSED(lar_session_tool_move(b.session, 0, &pose, &failure));
    pose = pose_at(0, 0, 0, 1.5);
    REFUSED(lar_session_tool_move(b.session, 0, &pose, &failure));
    pose = pose_at(0, 0, 0, 0);
    pose.orientation[0] = 0;
    REFUSED(lar_session_tool_move(b.session, 0, &pose, &failure));
    REFUSED(lar_session_tool_force(b.session, TOOLS, NULL, NULL, &failure));
    REFUSED(lar_session_attach(b.session, 0, NULL, &failure));
    REFUSED(lar_session_attach(b.session, TOOLS, "udp:127.0.0.1:0", &failure));
    REFUSED(lar_snapshot_create(NULL, &snapshot, &failure));
    REFUSED(lar_session_snapshot(b.session, NULL, 1, &failure));
    assert_int_equal(lar_session_force_history(b.session, TOOLS, 7, 1, kept, &last), 0);
    assert_int_equal(last, 7);
    assert_int_equal(lar_session_load(b.session, "/none", &failure), LAR_ERROR_IO);
    lar_session_status_get(NULL, NULL);
    lar_session_play(NULL);
    lar_snapshot_destroy(NULL);
    close_bench(&b);
}

/* ---- going back, and what breaks ----------------------------------------------------------- */

static void goes_back_and_on(void **unused) {
    (void)unused;
    const char *path = LAR_TEST_BUILD "/session_goes_back.checkpoint";
    for (int started = 0; started < 2; started++) {
        lar_session_options options = lar_session_options_default();
        options.paused = 1;
        bench b = open_bench("2x1x1", 1, &options);
        lar_snapshot *first = NULL, *then = NULL;
        DONE(lar_snapshot_create(b.session, &first, &failure));
        DONE(lar_snapshot_create(b.session, &then, &failure));
        if (started) {
            DONE(lar_session_start(b.session, &failure));
            lar_session_step(b.session, 123);
            await(&b, LAR_SESSION_PAUSED, 123);
        }
        DONE(lar_session_snapshot(b.session, first, 30, &failure));
        DONE(lar_session_save(b.session, path, &failure));
        if (started) {
            lar_session_step(b.session, 50);
            await(&b, LAR_SESSION_PAUSED, 173);
        }
        DONE(lar_session_reset(b.session, &failure));
        assert_int_equal(status_of(&b).step, 0);
        DONE(lar_session_load(b.session, path, &failure));
        assert_int_equal(status_of(&b).step, started ? 123 : 0);
        DONE(lar_session_snapshot(b.session, then, 30, &failure));
        assert_true(then->hash == first->hash);
        lar_snapshot_destroy(first);
        lar_snapshot_destroy(then);
        close_bench(&b);
    }
}

/* The session says why it stops, and can be taken up again. */
static void stops_with_a_message(void **unused) {
    (void)unused;
    bench b = open_bench_of(torn_block(), "2x1x1", 1, NULL);
    lar_snapshot *snapshot = NULL;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    DONE(lar_session_start(b.session, &failure));
    for (int again = 0; again < 3; again++) {
        lar_session_status status = await(&b, LAR_SESSION_STOPPED, 200);
        numbers_are_finite(&status);
        assert_non_null(strstr(status.message, "element"));
        assert_int_equal(status.error, LAR_ERROR_UNSTABLE);
        lar_session_play(b.session); /* in vain */
        lar_session_step(b.session, 10);
        assert_int_equal(lar_session_save(b.session, LAR_TEST_BUILD "/torn", &failure),
                         LAR_ERROR_UNSTABLE);
        assert_int_equal(lar_session_record(b.session, LAR_TEST_BUILD "/torn", &failure),
                         LAR_ERROR_UNSTABLE);
        assert_int_equal(access(LAR_TEST_BUILD "/torn", F_OK), -1);
        lar_status shown = lar_session_snapshot(b.session, snapshot, 30, &failure);
        assert_true(shown == LAR_OK || shown == LAR_ERROR_UNSTABLE);
        assert_int_equal(status_of(&b).state, LAR_SESSION_STOPPED);
        DONE(lar_session_reset(b.session, &failure));
        assert_true(status_of(&b).step < 200);
    }
    lar_snapshot_destroy(snapshot);
    close_bench(&b);
}

/* ---- everybody at once --------------------------------------------------------------------- */

typedef struct crowd {
    bench *bench;
    int number;
    bool over; /* atomic */
    int snapshots;
} crowd;

static void *press_all_buttons(void *argument) {
    crowd *c = argument;
    lar_session *session = c->bench->session;
    lar_snapshot *snapshot = NULL;
    lar_session_status status;
    lar_tool_force force;
    float kept[100][3];
    uint64_t last = 0;
    if (lar_snapshot_create(session, &snapshot, NULL)) return NULL;
    for (int i = 0; !__atomic_load_n(&c->over, __ATOMIC_RELAXED); i++) {
        const lar_tool_pose pose =
            pose_at(0.02 + 1e-5 * c->number, 0.01, 0.02 + 1e-4 * (i % 90), i % 100 < 50);
        lar_session_tool_move(session, c->number % TOOLS, &pose, NULL);
        c->snapshots += lar_session_snapshot(session, snapshot, 30, NULL) == LAR_OK;
        lar_session_tool_force(session, i % TOOLS, NULL, &force, NULL);
        lar_session_force_history(session, i % TOOLS, last, 100, kept, &last);
        lar_session_status_get(session, &status);
        if (i % 20 == c->number) lar_session_pause(session);
        if (i % 20 == c->number + 1) lar_session_play(session);
        if (i % 50 == 10 * c->number) lar_session_reset(session, NULL);
    }
    lar_snapshot_destroy(snapshot);
    return NULL;
}

static void everybody_at_once(void **unused) {
    (void)unused;
    enum { CROWD = 8 };
    bench b = open_bench("2x1x1", 1, NULL);
    pthread_t thread[CROWD];
    crowd c[CROWD] = {{0}};
    DONE(lar_session_start(b.session, &failure));
    for (int i = 0; i < CROWD; i++) {
        c[i] = (crowd){.bench = &b, .number = i};
        assert_int_equal(pthread_create(&thread[i], NULL, press_all_buttons, &c[i]), 0);
    }
    nap(0.4);
    for (int i = 0; i < CROWD; i++) __atomic_store_n(&c[i].over, true, __ATOMIC_RELAXED);
    lar_session_play(b.session);
    for (int i = 0; i < CROWD; i++) {
        assert_int_equal(pthread_join(thread[i], NULL), 0);
        assert_true(c[i].snapshots > 0);
    }
    assert_true(status_of(&b).state != LAR_SESSION_STOPPED);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(plays_pauses_and_steps),
                                       cmocka_unit_test(waits_when_it_starts_paused),
                                       cmocka_unit_test(has_its_simulation_for_itself),
                                       cmocka_unit_test(keeps_its_pace),
                                       cmocka_unit_test(listens_in_slow_motion),
                                       cmocka_unit_test(slow_motion_is_announced),
                                       cmocka_unit_test(status_is_finite_and_complete),
                                       cmocka_unit_test(snapshots_are_of_one_step),
                                       cmocka_unit_test(snapshots_of_others_are_refused),
                                       cmocka_unit_test(late_snapshots_are_refused),
                                       cmocka_unit_test(polled_snapshots_come_by_and_by),
                                       cmocka_unit_test(tools_are_felt),
                                       cmocka_unit_test(wrong_calls_are_refused),
                                       cmocka_unit_test(endless_ticks_are_refused),
                                       cmocka_unit_test(ticks_of_small_steps_are_shorter),
                                       cmocka_unit_test(goes_back_and_on),
                                       cmocka_unit_test(stops_with_a_message),
                                       cmocka_unit_test(everybody_at_once)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
