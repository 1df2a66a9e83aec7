/* A run that a hand breaks goes back to a sound state and on from there. */
#include "session/session.h"
#include "session/session_test.h"

#define PATH  LAR_TEST_BUILD "/recovery.recording"
#define SAVED LAR_TEST_BUILD "/recovery.checkpoint"

static const char *const grids[] = {NULL, "2x1x1"};
enum { GRIDS = sizeof grids / sizeof grids[0] };

/* Paused, as fast as it goes: every test says itself which steps are done. */
static lar_session_options in_steps(void) {
    lar_session_options options = lar_session_options_default();
    options.paused = 1;
    options.pace = 0;
    return options;
}

static bench start_bench(const char *grid, const lar_session_options *options) {
    bench b = open_bench(grid, 1, options);
    DONE(lar_session_start(b.session, &failure));
    return b;
}

/* So many seconds of the simulation, whether the run goes back meanwhile or not. */
static lar_session_status play_for(const bench *b, double seconds) {
    uint64_t tick = b->session->tick_steps;
    uint64_t steps = (uint64_t)(seconds / b->session->time_step + 0.5);
    uint64_t ticks = status_of(b).ticks + (steps + tick - 1) / tick;
    lar_session_status status = {0};
    lar_session_step(b->session, steps);
    for (int i = 0; i < 60000; i++) {
        status = status_of(b);
        if (status.state == LAR_SESSION_STOPPED) break;
        if (status.state == LAR_SESSION_PAUSED && status.ticks >= ticks) break;
        nap(0.0005);
    }
    return status;
}

static lar_session_status play_until(const bench *b, double time) {
    return play_for(b, time - status_of(b).time);
}

static void move(const bench *b, int32_t tool, double x, double y, double z, double opening) {
    const lar_tool_pose pose = pose_at(x, y, z, opening);
    DONE(lar_session_tool_move(b->session, tool, &pose, &failure));
}

static lar_tool_pose pose_of(const bench *b, int32_t tool) {
    lar_tool_pose pose;
    DONE(lar_session_tool_force(b->session, tool, &pose, NULL, &failure));
    return pose;
}

static int32_t held_by(const bench *b, int32_t tool) {
    lar_tool_force force;
    DONE(lar_session_tool_force(b->session, tool, NULL, &force, &failure));
    return force.held;
}

/* The engine sleeps: its next tick finds that the run has broken off. */
static void forge_break(const bench *b) {
    b->simulation->fault =
        (lar_fault){.kind = LAR_FAULT_LOAD, .step = lar_simulation_steps(b->simulation)};
}

/* Somebody moves a tool, far from the block, and the run breaks at `time`. Returns where it went.
 */
static double break_at(const bench *b, double time) {
    uint64_t recoveries = status_of(b).recoveries;
    move(b, BALL, 0.02, 0.01, 0.2 + 0.01 * time, 1);
    play_until(b, time);
    forge_break(b);
    double tick = (double)b->session->tick_steps * b->session->time_step;
    lar_session_status status = play_for(b, tick);
    assert_int_equal(status.state, LAR_SESSION_PAUSED);
    assert_true(status.recoveries == recoveries + 1);
    assert_int_equal(status.error, LAR_OK);
    assert_string_equal(status.message, "");
    return status.time - tick;
}

#define ASSERT_TIME(time, wanted)                                                                  \
    do {                                                                                           \
        double found = time;                                                                       \
        if (fabs(found - (wanted)) > 1e-6) fail_msg("%.9g s, not %g s", found, (double)(wanted));  \
    } while (0)

/* ---- a hand that breaks the run ------------------------------------------------------------ */

/* 6 x 4 x 3 cm, held at its bottom. A hand that is rammed down with what it holds turns no element
 * of it inside out; that is planted. */
static const brick rammed_brick = {{6, 4, 3}, 0.01, 0.05, LAR_LAW_neo_hookean, 4e3, 2e5, 1000};
static const double top[3] = {0.03, 0.02, 0.03};
enum { RAM = 0 }; /* its only tool, a hand */

static bench ram_bench(const char *grid) {
    bench b = {.model = brick_model(&rammed_brick)};
    lar_options options = lar_options_default();
    lar_session_options session = in_steps();
    fix_nodes(b.model, brick_side(&rammed_brick, 2, 0), LAR_AXIS_ALL);
    DONE(lar_model_check(b.model, &failure));
    options.grid = grid;
    options.hands = 1;
    session.record = PATH;
    session.tool_speed = 4;
    session.hand_force = 1e6;
    DONE(lar_simulation_create(b.model, &options, &b.simulation, &failure));
    DONE(lar_session_open(b.simulation, &session, &b.session, &failure));
    DONE(lar_session_start(b.session, &failure));
    return b;
}

static void ram(const bench *b, double down, double opening) {
    move(b, RAM, top[0], top[1], top[2] - down, opening);
    play_for(b, (double)b->session->tick_steps * b->session->time_step);
}

/* The engine sleeps: below the hand a node lies elsewhere, and its elements are inside out. */
static void tear(const bench *b) {
    lar_simulation *simulation = b->simulation;
    const lar_mesh *mesh = &b->model->mesh;
    lar_gid node = 0;
    double nearest = INFINITY;
    for (lar_gid n = 0; n < mesh->node_count; n++) {
        double square = 0;
        for (int k = 0; k < 3; k++) square += pow(mesh->position[n][k] - top[k], 2);
        if (!(square < nearest)) continue;
        nearest = square;
        node = n;
    }
    DONE(lar_simulation_gather(simulation, &failure));
    simulation->state
        .u[lar_state_at(&simulation->state, simulation->domain.layout.local[node], 2)] -= 1;
    DONE(lar_simulation_take_up(simulation, &failure));
}

/* Takes hold, goes down and up for a while, and then the run breaks. */
static lar_session_status ram_down(const bench *b) {
    uint64_t recoveries = status_of(b).recoveries;
    static const double WAY = 0.1; /* [m] */
    ram(b, 0, 1);
    ram(b, 0, 0);
    assert_true(held_by(b, RAM) > 0);
    for (int i = 0; status_of(b).time < 1.3; i++) ram(b, i / 20 % 2 ? -WAY : WAY, 0);
    assert_true(held_by(b, RAM) > 0);
    assert_true(status_of(b).recoveries == recoveries);
    tear(b);
    ram(b, WAY, 0);
    lar_session_status status = status_of(b);
    assert_int_equal(status.state, LAR_SESSION_PAUSED);
    assert_true(status.recoveries == recoveries + 1);
    return status;
}

/* The tool is sent there in every tick. Returns how fast it goes at most [m/s]. */
static double fastest(const bench *b, int32_t tool, double x, double y, double z, double opening,
                      double seconds) {
    double tick = (double)b->session->tick_steps * b->session->time_step, max = 0;
    for (double time = 0; time < seconds - tick / 2; time += tick) {
        const lar_tool_pose before = pose_of(b, tool);
        move(b, tool, x, y, z, opening);
        play_for(b, tick);
        const lar_tool_pose now = pose_of(b, tool);
        double square = 0;
        for (int k = 0; k < 3; k++) square += pow(now.position[k] - before.position[k], 2);
        max = fmax(max, sqrt(square) / tick);
    }
    return max;
}

static uint64_t hash_of(const bench *b) {
    lar_snapshot *snapshot = NULL;
    DONE(lar_snapshot_create(b->session, &snapshot, &failure));
    DONE(lar_session_snapshot(b->session, snapshot, 30, &failure));
    uint64_t hash = snapshot->hash;
    lar_snapshot_destroy(snapshot);
    return hash;
}

/* PATH, on this grid. Returns the hash at its end. */
static uint64_t replayed_hash(lar_model *model, lar_options options, const char *grid) {
    lar_simulation *simulation = NULL;
    lar_replay_report report;
    options.grid = grid;
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    DONE(lar_replay(simulation, PATH, NULL, NULL, &report, &failure));
    assert_true(report.different == UINT64_MAX);
    assert_true(report.hashes > 10);
    assert_int_equal(report.broken, 0);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static void a_hand_ends_no_session(void **unused) {
    (void)unused;
    uint64_t hash[GRIDS];
    lar_options options = lar_options_default();
    options.hands = 1;
    for (int g = 0; g < GRIDS; g++) {
        bench b = ram_bench(grids[g]);
        play_until(&b, 1.1);
        lar_session_status status = ram_down(&b);
        print_message("%s\n", status.recovery);
        assert_non_null(strstr(status.recovery, "went back 0."));
        assert_non_null(strstr(status.recovery, "to step "));
        assert_non_null(strstr(status.recovery, "tool hand"));
        assert_non_null(strstr(status.recovery, "element"));
        assert_true(status.time > 0.99 && status.time < 1.01);
        assert_int_equal(held_by(&b, RAM), 0);
        /* Again, at once: it takes hold, and follows slowly. */
        ram(&b, 0, 1);
        ram(&b, 0, 0);
        assert_true(held_by(&b, RAM) > 0);
        assert_true(fastest(&b, RAM, top[0], top[1], top[2] - 1, 0, 0.1) < 0.1 * 1.001);
        hash[g] = hash_of(&b);
        DONE(lar_session_close(b.session, &failure));
        lar_simulation_destroy(b.simulation);
        for (int r = 0; r < GRIDS; r++)
            assert_true(replayed_hash(b.model, options, grids[r]) == hash[g]);
        lar_model_destroy(b.model);
    }
    assert_true(hash[0] == hash[1]);
}

/* ---- where to ------------------------------------------------------------------------------ */

static void repeated_breaks_go_further_back(void **unused) {
    (void)unused;
    for (int g = 0; g < GRIDS; g++) {
        const lar_session_options options = in_steps();
        bench b = start_bench(grids[g], &options);
        ASSERT_TIME(break_at(&b, 2.6), 2.0); /* that at 2.5 s is too young */
        ASSERT_TIME(break_at(&b, 2.1), 1.5);
        ASSERT_TIME(break_at(&b, 2.3), 1.0);
        ASSERT_TIME(break_at(&b, 1.9), 0); /* four are kept: 1.0, 1.5, 2.0, 2.5 */
        ASSERT_TIME(break_at(&b, 2.9), 2.5);
        ASSERT_TIME(break_at(&b, 4.3), 4.0); /* this one is another */
        ASSERT_TIME(break_at(&b, 4.1), 3.5);
        ASSERT_TIME(break_at(&b, 3.6), 3.0);
        close_bench(&b);
    }
}

/* Behind the same place it breaks again, however long that takes. */
static void the_same_break_goes_further_back(void **unused) {
    (void)unused;
    const lar_session_options options = in_steps();
    bench b = start_bench(NULL, &options);
    ASSERT_TIME(break_at(&b, 3.2), 2.5);
    ASSERT_TIME(break_at(&b, 3.1), 2.0);
    ASSERT_TIME(break_at(&b, 3.2), 1.5);
    ASSERT_TIME(break_at(&b, 3.2), 0);
    ASSERT_TIME(break_at(&b, 3.2), 0);
    close_bench(&b);
}

/* From the start tools rest; when the run breaks all the same, no hand is the cause. */
static void what_no_hand_does_stops(void **unused) {
    (void)unused;
    for (int g = 0; g < GRIDS; g++) {
        const lar_session_options options = in_steps();
        bench b = start_bench(grids[g], &options);
        ASSERT_TIME(break_at(&b, 0.3), 0);
        ASSERT_TIME(break_at(&b, 0.3), 0);
        const lar_tool_pose rest = pose_of(&b, BALL);
        move(&b, BALL, 0.02, 0.01, 0.2, 1);
        play_until(&b, 0.3);
        const lar_tool_pose still = pose_of(&b, BALL);
        assert_memory_equal(&still, &rest, sizeof rest);
        forge_break(&b);
        lar_session_status status = play_for(&b, 0.001);
        assert_int_equal(status.state, LAR_SESSION_STOPPED);
        assert_int_equal(status.error, LAR_ERROR_UNSTABLE);
        assert_true(status.recoveries == 2);
        lar_session_pause(b.session);
        DONE(lar_session_reset(b.session, &failure));
        lar_session_pause(b.session);
        await(&b, LAR_SESSION_PAUSED, 0);
        ASSERT_TIME(break_at(&b, 1.0), 0.5);
        close_bench(&b);
    }
}

/* A state that was loaded has been sound, however short ago that is. */
static void goes_back_to_what_was_loaded(void **unused) {
    (void)unused;
    const lar_session_options options = in_steps();
    bench b = start_bench("2x1x1", &options);
    play_until(&b, 0.7);
    DONE(lar_session_save(b.session, SAVED, &failure));
    play_until(&b, 2.0);
    DONE(lar_session_load(b.session, SAVED, &failure));
    ASSERT_TIME(break_at(&b, 0.8), 0.7);
    ASSERT_TIME(break_at(&b, 2.0), 1.7);
    ASSERT_TIME(break_at(&b, 1.8), 1.2);
    ASSERT_TIME(break_at(&b, 1.3), 0.7);
    ASSERT_TIME(break_at(&b, 0.8), 0);
    ASSERT_TIME(break_at(&b, 1.2), 0.5);
    close_bench(&b);
}

/* ---- tools --------------------------------------------------------------------------------- */

/* A tool rests where the state has it until somebody moves it, and is slow for a second. */
static void tools_follow_slowly(void **unused) {
    (void)unused;
    const lar_session_options options = in_steps();
    bench b = start_bench(NULL, &options);
    move(&b, BALL, 0.02, 0.01, 0.05, 1);
    play_until(&b, 1.2);
    move(&b, BALL, 0.02, 0.01, 0.5, 1);
    play_until(&b, 1.4);
    assert_true(fabs(pose_of(&b, BALL).position[2] - 0.2) < 0.1);
    forge_break(&b);
    play_for(&b, 0.1);
    ASSERT_TIME(status_of(&b).time, 1.1);
    assert_true(fabs(pose_of(&b, BALL).position[2] - 0.05) < 1e-6);
    double slow = fastest(&b, BALL, 0.02, 0.01, 0.5, 1, 0.9);
    assert_true(slow > 0.09 && slow < 0.1 * 1.001);
    assert_true(pose_of(&b, BALL).position[2] < 0.05 + 0.09 * 1.001);
    assert_true(fastest(&b, BALL, 0.02, 0.01, 0.5, 1, 0.1) > 0.9);
    close_bench(&b);
}

/* ---- hands --------------------------------------------------------------------------------- */

static const double end_of_block[3] = {0.03, 0.01, 0.01};

static void put_hand(const bench *b, double away, double opening) {
    move(b, HAND, end_of_block[0] + away, end_of_block[1], end_of_block[2], opening);
    play_for(b, 0.005);
}

/* And a hand that is still closed takes hold of nothing before it has opened. The recording of it
 * ends with the hash that the session had. */
static void hands_let_go(void **unused) {
    (void)unused;
    for (int g = 0; g < GRIDS; g++) {
        lar_session_options options = in_steps();
        options.record = PATH;
        bench b = start_bench(grids[g], &options);
        put_hand(&b, 0, 1);
        put_hand(&b, 0, 0);
        assert_true(held_by(&b, HAND) > 0);
        put_hand(&b, 0.002, 0);
        ASSERT_TIME(break_at(&b, 1.3), 1.0);
        assert_int_equal(held_by(&b, HAND), 0);
        assert_true(pose_of(&b, HAND).opening == 1);
        const lar_tool_pose there = pose_of(&b, HAND);
        for (int i = 0; i < 20; i++) put_hand(&b, 0.001 * (i % 2), 0);
        const lar_tool_pose still = pose_of(&b, HAND);
        assert_memory_equal(&still, &there, sizeof there);
        ASSERT_TIME(break_at(&b, 1.4), 0.5); /* it had hold there, too */
        for (int i = 0; i < 3; i++) put_hand(&b, 0, 0);
        assert_int_equal(held_by(&b, HAND), 0);
        put_hand(&b, 0, 1);
        put_hand(&b, 0, 0);
        assert_true(held_by(&b, HAND) > 0);
        play_for(&b, 0.2);
        uint64_t hash = hash_of(&b);
        DONE(lar_session_close(b.session, &failure));
        lar_simulation_destroy(b.simulation);
        for (int r = 0; r < GRIDS; r++)
            assert_true(replayed_hash(b.model, block_options(NULL, 0), grids[r]) == hash);
        lar_model_destroy(b.model);
    }
}

/* ---- what is not gone back for ------------------------------------------------------------- */

static void stops_when_asked_to(void **unused) {
    (void)unused;
    lar_session_options options = in_steps();
    options.stop_when_unstable = 1;
    bench b = start_bench(NULL, &options);
    move(&b, BALL, 0.02, 0.01, 0.2, 1);
    play_until(&b, 1.3);
    forge_break(&b);
    lar_session_status status = play_for(&b, 0.001);
    assert_int_equal(status.state, LAR_SESSION_STOPPED);
    assert_int_equal(status.error, LAR_ERROR_UNSTABLE);
    assert_true(status.recoveries == 0);
    assert_string_equal(status.recovery, "");
    close_bench(&b);
}

static void lost_processors_stop(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    lar_error error = {LAR_ERROR_PEER, "processor 1 is lost"};
    b.session->tool[BALL].led = true;
    lar_simulation_reserve_here(b.simulation); /* as in its thread */
    assert_false(lar_session_recover(b.session, &error));
    assert_int_equal(error.status, LAR_ERROR_PEER);
    error = (lar_error){LAR_ERROR_UNSTABLE, "element 7"};
    assert_true(lar_session_recover(b.session, &error));
    assert_string_equal(b.session->status.recovery, "went back 0.00 s to the start: element 7");
    lar_simulation_reserve_here(NULL);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hand_ends_no_session),
        cmocka_unit_test(repeated_breaks_go_further_back),
        cmocka_unit_test(the_same_break_goes_further_back),
        cmocka_unit_test(what_no_hand_does_stops),
        cmocka_unit_test(goes_back_to_what_was_loaded),
        cmocka_unit_test(tools_follow_slowly),
        cmocka_unit_test(hands_let_go),
        cmocka_unit_test(stops_when_asked_to),
        cmocka_unit_test(lost_processors_stop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
