/* Tools that are added and removed in a session: with what a hand does to them they are played
 * again to the same bits, they stay when a run goes back, and nobody moves what is not there. */
#include "session/session.h"
#include "session/session_test.h"

#define PATH  LAR_TEST_BUILD "/tools.recording"
#define STATE LAR_TEST_BUILD "/session_tools.checkpoint"

enum { FIRST = TOOLS, SPARES = 2 };

static lar_options with_spares(const char *grid, int32_t spares) {
    lar_options options = block_options(grid, 1);
    options.spares = spares;
    return options;
}

static bench open_with(const char *grid, int32_t spares, const lar_session_options *session) {
    bench b = {.model = hanging_block()};
    lar_options options = with_spares(grid, spares);
    DONE(lar_simulation_create(b.model, &options, &b.simulation, &failure));
    DONE(lar_session_open(b.simulation, session, &b.session, &failure));
    DONE(lar_session_start(b.session, &failure));
    return b;
}

static int32_t add(const bench *b, lar_tool_shape shape, double radius, double length) {
    const lar_tool_info wanted = {.shape = shape, .radius = radius, .length = length};
    int32_t tool = -1;
    DONE(lar_session_add_tool(b->session, &wanted, &tool, &failure));
    return tool;
}

static lar_tool_info info_of(const bench *b, int32_t tool) {
    lar_tool_info info;
    DONE(lar_session_tool_info(b->session, tool, &info, &failure));
    return info;
}

static lar_tool_force force_of(const bench *b, int32_t tool) {
    lar_tool_force force;
    DONE(lar_session_tool_force(b->session, tool, NULL, &force, &failure));
    return force;
}

/* Goes down from where it was added for so many steps, and stays there. */
static void push(const bench *b, int32_t tool, double down, uint64_t steps) {
    lar_tool_info info = info_of(b, tool);
    uint64_t begin = status_of(b).step, now = begin;
    while (now < begin + steps) {
        lar_tool_pose pose = info.rest;
        double share = fmin(1, 2 * (double)(now - begin) / (double)steps);
        pose.position[2] -= share * down;
        DONE(lar_session_tool_move(b->session, tool, &pose, &failure));
        nap(0.002);
        now = status_of(b).step;
    }
}

/* ---- what it is ----------------------------------------------------------------------------- */

static void they_are_moved_as_the_scenes(void **unused) {
    (void)unused;
    bench b = open_with("2x1x1", SPARES, NULL);
    assert_int_equal(info_of(&b, FIRST).shape, LAR_TOOL_NONE);
    const lar_tool_pose pose = pose_at(0, 0, 0.1, 1);
    assert_int_equal(lar_session_tool_move(b.session, FIRST, &pose, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "is not there"));
    assert_int_equal(lar_session_attach(b.session, FIRST, "udp:127.0.0.1:0", &failure),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "is not there"));
    assert_int_equal(add(&b, LAR_TOOL_SPHERE, 0.004, 0), FIRST);
    lar_tool_info info = info_of(&b, FIRST);
    assert_string_equal(info.name, "sphere 1");
    assert_int_equal(force_of(&b, FIRST).touching, 0);
    push(&b, FIRST, info.rest.position[2] - 0.021, 3000);
    lar_tool_force force = force_of(&b, FIRST);
    assert_true(force.touching > 0 && force.force[2] > 1e-4 && force.limit > 0);
    lar_tool_load load;
    DONE(lar_session_tool_load(b.session, FIRST, &load, &failure));
    assert_true(load.force > 0);
    DONE(lar_session_remove_tool(b.session, FIRST, &failure));
    assert_int_equal(info_of(&b, FIRST).shape, LAR_TOOL_NONE);
    force = force_of(&b, FIRST);
    assert_true(force.force[2] == 0 && force.touching == 0 && force.limit == 0);
    /* Another one in its place rests where it was added, and begins with no load. */
    assert_int_equal(add(&b, LAR_TOOL_GRASPER, 0.003, 0.01), FIRST);
    lar_tool_pose place;
    info = info_of(&b, FIRST);
    uint64_t step = status_of(&b).step;
    await(&b, LAR_SESSION_PLAYING, step + 50);
    DONE(lar_session_tool_force(b.session, FIRST, &place, NULL, &failure));
    assert_memory_equal(place.position, info.rest.position, sizeof place.position);
    DONE(lar_session_tool_load(b.session, FIRST, &load, &failure));
    assert_true(load.force == 0);
    close_bench(&b);
}

/* Who looks at a place later knows that another tool is there. */
static void places_are_told_apart(void **unused) {
    (void)unused;
    bench b = open_with(NULL, SPARES, NULL);
    assert_int_equal(info_of(&b, BALL).serial, 0);
    assert_int_equal(add(&b, LAR_TOOL_SPHERE, 0.004, 0), FIRST);
    int32_t serial = info_of(&b, FIRST).serial;
    assert_true(serial > 0);
    DONE(lar_session_remove_tool(b.session, FIRST, &failure));
    assert_int_equal(add(&b, LAR_TOOL_SPHERE, 0.004, 0), FIRST);
    assert_int_equal(info_of(&b, FIRST).serial, serial + 1);
    close_bench(&b);
}

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    bench b = open_with(NULL, 1, NULL);
    const lar_tool_info thin = {.shape = LAR_TOOL_SPHERE, .radius = 1e-6};
    const lar_tool_info hand = {.shape = LAR_TOOL_HAND, .radius = 0.01};
    assert_int_equal(lar_session_add_tool(b.session, &thin, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "too thin"));
    assert_int_equal(lar_session_add_tool(b.session, &hand, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_add_tool(b.session, NULL, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_add_tool(NULL, &thin, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_remove_tool(b.session, BALL, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "belongs to the scene"));
    assert_int_equal(lar_session_remove_tool(b.session, 99, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_tool_info(b.session, 99, NULL, &failure), LAR_ERROR_ARGUMENT);
    add(&b, LAR_TOOL_SPHERE, 0.004, 0);
    const lar_tool_info ball = {.shape = LAR_TOOL_SPHERE, .radius = 0.004};
    assert_int_equal(lar_session_add_tool(b.session, &ball, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "no place is left"));
    DONE(lar_session_attach(b.session, FIRST, "udp:127.0.0.1:0", &failure));
    assert_int_equal(lar_session_remove_tool(b.session, FIRST, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "sphere 1 has a device"));
    close_bench(&b);
}

static void paused_sessions_show_them_at_once(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.paused = 1;
    bench b = open_with(NULL, SPARES, &options);
    assert_int_equal(add(&b, LAR_TOOL_CAPSULE, 0.003, 0.05), FIRST);
    assert_int_equal(info_of(&b, FIRST).shape, LAR_TOOL_CAPSULE);
    lar_tool_pose pose;
    DONE(lar_session_tool_force(b.session, FIRST, &pose, NULL, &failure));
    assert_true(pose.position[2] > 0.02);
    close_bench(&b);
}

/* ---- recordings ----------------------------------------------------------------------------- */

static lar_status replay(const char *grid, int32_t spares, lar_replay_report *report) {
    lar_model *model = hanging_block();
    lar_simulation *simulation = NULL;
    const lar_options options = with_spares(grid, spares);
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    lar_status status = lar_replay(simulation, PATH, NULL, NULL, report, &failure);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return status;
}

/* Added, pressed in, removed while it presses, another one in its place; saved with it, reset,
 * loaded; also while it is paused. */
static void record(const char *grid) {
    lar_session_options options = lar_session_options_default();
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_with(grid, SPARES, &options);
    const int32_t ball = add(&b, LAR_TOOL_SPHERE, 0.004, 0);
    push(&b, ball, info_of(&b, ball).rest.position[2] - 0.021, 600);
    const int32_t shaft = add(&b, LAR_TOOL_CAPSULE, 0.003, 0.05);
    assert_int_equal(shaft, FIRST + 1);
    DONE(lar_session_remove_tool(b.session, ball, &failure));
    push(&b, shaft, 0.008, 300);
    DONE(lar_session_save(b.session, STATE, &failure));
    DONE(lar_session_reset(b.session, &failure));
    assert_int_equal(info_of(&b, shaft).shape, LAR_TOOL_CAPSULE);
    lar_session_pause(b.session);
    await(&b, LAR_SESSION_PAUSED, 0);
    assert_int_equal(add(&b, LAR_TOOL_GRASPER, 0.003, 0.01), ball);
    lar_session_play(b.session);
    push(&b, ball, 0.01, 300);
    DONE(lar_session_load(b.session, STATE, &failure));
    assert_int_equal(info_of(&b, ball).shape, LAR_TOOL_NONE);
    assert_int_equal(info_of(&b, shaft).shape, LAR_TOOL_CAPSULE);
    push(&b, shaft, 0.01, 200);
    close_bench(&b);
}

static void they_are_played_to_the_same_bits(void **unused) {
    (void)unused;
    record("2x1x1");
    lar_recording_info info;
    DONE(lar_recording_inspect(PATH, &info, &failure));
    assert_int_equal(info.tools, TOOLS);
    assert_int_equal(info.hands, 2);
    assert_int_equal(info.spares, SPARES);
    for (int grid = 0; grid < 3; grid++) {
        static const char *const grids[] = {NULL, "2x1x1", "2x2x1"};
        lar_replay_report report;
        DONE(replay(grids[grid], SPARES + grid, &report));
        assert_true(report.hashes > 15 && report.different == UINT64_MAX);
    }
    assert_int_equal(replay(NULL, 1, NULL), LAR_ERROR_MODEL);
    assert_non_null(strstr(failure.message, "options.spares = 2"));
}

/* In a session everybody sees them come and go; a place that is sought has those of then. */
static void a_session_plays_them(void **unused) {
    (void)unused;
    record(NULL);
    bench b = open_with(NULL, 4, NULL);
    add(&b, LAR_TOOL_GRASPER, 0.003, 0.01); /* which was not there */
    DONE(lar_session_replay(b.session, PATH, &failure));
    const lar_tool_info ball = {.shape = LAR_TOOL_SPHERE, .radius = 0.004};
    assert_int_equal(lar_session_add_tool(b.session, &ball, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "is being played"));
    await(&b, LAR_SESSION_PAUSED, 0);
    assert_string_equal(status_of(&b).message, "");
    assert_int_equal(info_of(&b, FIRST).shape, LAR_TOOL_NONE);
    assert_int_equal(info_of(&b, FIRST + 1).shape, LAR_TOOL_CAPSULE);
    lar_session_seek(b.session, 0.05);
    for (int i = 0; i < 10000 && info_of(&b, FIRST).shape != LAR_TOOL_SPHERE; i++) nap(0.001);
    assert_int_equal(info_of(&b, FIRST).shape, LAR_TOOL_SPHERE);
    for (int i = 0; i < 10000 && status_of(&b).replay_time < 0.05; i++) nap(0.001);
    DONE(lar_session_replay(b.session, NULL, &failure));
    DONE(lar_session_remove_tool(b.session, FIRST, &failure));
    close_bench(&b);
}

/* ---- going back ----------------------------------------------------------------------------- */

static void play_for(const bench *b, double seconds) {
    uint64_t steps = (uint64_t)(seconds / b->session->time_step + 0.5);
    uint64_t ticks = status_of(b).ticks + steps / b->session->tick_steps;
    lar_session_step(b->session, steps);
    for (int i = 0; i < 60000; i++) {
        lar_session_status status = status_of(b);
        if (status.state == LAR_SESSION_PAUSED && status.ticks >= ticks) return;
        nap(0.0005);
    }
}

/* One that was there and is still is where the state has it; those that were added since come to
 * stand above, those that were removed are not there again. */
static void they_stay_when_a_run_goes_back(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.paused = 1;
    options.pace = 0;
    options.record = PATH;
    bench b = open_with("2x1x1", 4, &options);
    assert_int_equal(add(&b, LAR_TOOL_SPHERE, 0.004, 0), FIRST);
    assert_int_equal(add(&b, LAR_TOOL_CAPSULE, 0.003, 0.05), FIRST + 1);
    lar_tool_pose pose = info_of(&b, FIRST + 1).rest;
    pose.position[2] += 0.01;
    DONE(lar_session_tool_move(b.session, FIRST + 1, &pose, &failure));
    play_for(&b, 1.2);
    DONE(lar_session_remove_tool(b.session, FIRST, &failure));
    assert_int_equal(add(&b, LAR_TOOL_GRASPER, 0.003, 0.01), FIRST);
    assert_int_equal(add(&b, LAR_TOOL_SPHERE, 0.005, 0), FIRST + 2);
    DONE(lar_session_remove_tool(b.session, FIRST, &failure));
    play_for(&b, 0.1);
    b.simulation->fault =
        (lar_fault){.kind = LAR_FAULT_LOAD, .step = lar_simulation_steps(b.simulation)};
    play_for(&b, 1e-3);
    assert_true(status_of(&b).recoveries == 1 && status_of(&b).time < 1.2);
    assert_int_equal(info_of(&b, FIRST).shape, LAR_TOOL_NONE);
    assert_int_equal(info_of(&b, FIRST + 1).shape, LAR_TOOL_CAPSULE);
    lar_tool_info ball = info_of(&b, FIRST + 2);
    assert_true(ball.shape == LAR_TOOL_SPHERE && ball.radius == 0.005);
    lar_tool_pose place;
    DONE(lar_session_tool_force(b.session, FIRST + 1, &place, NULL, &failure));
    assert_true(fabs(place.position[2] - pose.position[2]) < 1e-4);
    DONE(lar_session_tool_force(b.session, FIRST + 2, &place, NULL, &failure));
    assert_memory_equal(place.position, ball.rest.position, sizeof place.position);
    play_for(&b, 0.1);
    close_bench(&b);
    lar_replay_report report;
    DONE(replay(NULL, 4, &report));
    assert_true(report.hashes > 5 && report.different == UINT64_MAX);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_moved_as_the_scenes),
        cmocka_unit_test(places_are_told_apart),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(paused_sessions_show_them_at_once),
        cmocka_unit_test(they_are_played_to_the_same_bits),
        cmocka_unit_test(a_session_plays_them),
        cmocka_unit_test(they_stay_when_a_run_goes_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
