/* Forces on nodes, activation and points of contact in a session: done between two ticks, recorded,
 * replayed on another grid, and refused where settings are. */
#include "engine/body_contact_test.h"
#include "session/session_test.h"

#define PATH LAR_TEST_BUILD "/calls.recording"

/* The block with the last side of an axis as the set "end". */
static lar_model *block_with_end(int axis) {
    lar_model *model = hanging_block();
    lar_node_list end = brick_side(&soft_brick, axis, -1);
    DONE(lar_mesh_add_set(&model->mesh, "end", LAR_SET_NODES, end.node, end.count, &failure));
    return model;
}

static lar_model *named_block(void) {
    return block_with_end(0);
}

/* Sets are numbers in a recording: where the number is that of other nodes, it says so. */
static void refuses_other_set(void) {
    lar_replay_report report;
    lar_model *model = block_with_end(1);
    lar_simulation *simulation = NULL;
    const lar_options options = block_options(NULL, 1);
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    lar_error why;
    assert_int_equal(lar_replay(simulation, PATH, NULL, NULL, &report, &why), LAR_ERROR_MODEL);
    if (!strstr(why.message, "on the nodes of set 0, which has others here"))
        fail_msg("%s", why.message);
    assert_true(report.different == UINT64_MAX);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void wait_steps(const bench *b, uint64_t steps) {
    uint64_t end = status_of(b).step + steps;
    while (status_of(b).step < end) nap(0.001);
}

static void forces_are_played(void **unused) {
    (void)unused;
    const double up[3] = {0, 0, 0.01}, aside[3] = {0.004, 0, 0}, none[3] = {0};
    lar_session_options options = lar_session_options_default();
    lar_saved *saved = NULL;
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_bench_of(named_block(), "2x1x1", 1, &options);
    DONE(lar_saved_create(b.simulation, &saved, &failure));
    DONE(lar_session_set_force(b.session, 3, aside, &failure)); /* before the start */
    DONE(lar_session_start(b.session, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_set_force_on(b.session, "end", up, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_save_to(b.session, saved, &failure));
    DONE(lar_session_set_force(b.session, -1, NULL, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_load_from(b.session, saved, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_set_force(b.session, 3, none, &failure));
    assert_int_equal(lar_session_set_force(b.session, 99999, aside, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_set_force(b.session, -1, aside, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_set_force_on(b.session, "start", up, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_set_force_on(NULL, "end", up, &failure), LAR_ERROR_ARGUMENT);
    wait_steps(&b, 100);
    lar_saved_destroy(saved);
    close_bench(&b);
    for (int grid = 0; grid < 2; grid++) {
        lar_replay_report report;
        lar_model *model = named_block();
        lar_simulation *simulation = NULL;
        const lar_options divided = block_options(grid ? "2x2x1" : NULL, 1);
        double force[3];
        DONE(lar_simulation_create(model, &divided, &simulation, &failure));
        DONE(lar_replay(simulation, PATH, NULL, NULL, &report, &failure));
        assert_true(report.hashes > 5 && report.different == UINT64_MAX);
        lar_simulation_force(simulation, brick_node(&soft_brick, 3, 1, 1), force);
        assert_memory_equal(force, up, sizeof up);
        lar_simulation_force(simulation, 3, force);
        assert_true(force[0] == 0);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
    refuses_other_set();
    options.record = NULL;
    b = open_bench_of(named_block(), NULL, 0, &options);
    DONE(lar_session_start(b.session, &failure));
    DONE(lar_session_replay(b.session, PATH, &failure));
    await(&b, LAR_SESSION_PAUSED, 0);
    assert_string_equal(status_of(&b).message, "");
    assert_int_equal(lar_session_set_force(b.session, 3, up, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "is being played"));
    close_bench(&b);
}

/* The block lets go of the wall, a stitch holds it, and comes off again. */
static void supports_are_played(void **unused) {
    (void)unused;
    const int32_t stitch = brick_node(&soft_brick, 2, 1, 1), end = brick_node(&soft_brick, 3, 1, 1);
    lar_session_options options = lar_session_options_default();
    lar_saved *saved = NULL;
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_bench_of(named_block(), "2x1x1", 1, &options);
    DONE(lar_saved_create(b.simulation, &saved, &failure));
    DONE(lar_session_set_support(b.session, stitch, LAR_AXIS_ALL, 1, &failure)); /* before */
    DONE(lar_session_start(b.session, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_set_support_on(b.session, "end", LAR_AXIS_Y | LAR_AXIS_Z, 1, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_save_to(b.session, saved, &failure));
    DONE(lar_session_set_support(b.session, stitch, LAR_AXIS_ALL, 0, &failure));
    DONE(lar_session_set_support(b.session, 0, LAR_AXIS_ALL, 0, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_load_from(b.session, saved, &failure));
    wait_steps(&b, 100);
    DONE(lar_session_set_support(b.session, end, LAR_AXIS_Z, 0, &failure));
    assert_int_equal(lar_session_set_support(b.session, 99999, 7, 1, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_set_support(b.session, 0, 0, 1, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_set_support_on(b.session, "start", 7, 1, &failure),
                     LAR_ERROR_ARGUMENT);
    wait_steps(&b, 100);
    lar_saved_destroy(saved);
    close_bench(&b);
    for (int grid = 0; grid < 2; grid++) {
        lar_replay_report report;
        lar_model *model = named_block();
        lar_simulation *simulation = NULL;
        const lar_options divided = block_options(grid ? "2x2x1" : NULL, 1);
        DONE(lar_simulation_create(model, &divided, &simulation, &failure));
        DONE(lar_replay(simulation, PATH, NULL, NULL, &report, &failure));
        assert_true(report.hashes > 5 && report.different == UINT64_MAX);
        assert_int_equal(lar_simulation_support(simulation, stitch), LAR_AXIS_ALL);
        assert_int_equal(lar_simulation_support(simulation, end), LAR_AXIS_Y);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
    refuses_other_set();
}

/* The block as a muscle that shortens along the axis on which it hangs. */
static lar_model *muscle(void) {
    lar_model *model = named_block();
    lar_mesh *mesh = &model->mesh;
    mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    assert_non_null(mesh->fibre);
    for (int32_t e = 0; e < mesh->element_count; e++) mesh->fibre[e][0] = 1;
    model->material[0].fibre.along = 800;
    model->material[0].activation.wave =
        (lar_wave){.speed = 1, .direction = {1, 0, 0}, .length = 0.02, .every = 0.05, .rest = 0.3};
    DONE(lar_model_check(model, &failure));
    return model;
}

/* At random, once in a few ticks; saved and taken up again on the way. */
static void activations_are_played(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    lar_saved *saved = NULL;
    options.record = PATH;
    options.hash_every = 20;
    bench b = open_bench_of(muscle(), "2x1x1", 1, &options);
    DONE(lar_saved_create(b.simulation, &saved, &failure));
    DONE(lar_session_activate(b.session, 0, 0, &failure)); /* before the start */
    DONE(lar_session_start(b.session, &failure));
    for (int i = 0; i < 60; i++) {
        wait_steps(&b, 5);
        DONE(lar_session_activate(b.session, i % 2 - 1, (i * 37 % 50) / 49.0, &failure));
        if (i == 20) DONE(lar_session_save_to(b.session, saved, &failure));
        if (i == 40) DONE(lar_session_load_from(b.session, saved, &failure));
    }
    DONE(lar_session_activate(b.session, 0, 0.5, &failure));
    wait_steps(&b, 50);
    assert_true(lar_session_activation(b.session, 0) == 0.5);
    assert_true(lar_session_activation(b.session, 1) == 0);
    assert_int_equal(lar_session_activate(b.session, 0, NAN, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_activate(b.session, 0, -1, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_activate(b.session, 7, 1, &failure), LAR_ERROR_ARGUMENT);
    lar_saved_destroy(saved);
    close_bench(&b);
    for (int grid = 0; grid < 3; grid++) {
        static const char *const grids[] = {NULL, "2x2x1", "2x1x1"};
        lar_replay_report report;
        lar_model *model = muscle();
        lar_simulation *simulation = NULL;
        const lar_options divided = block_options(grids[grid], 1);
        DONE(lar_simulation_create(model, &divided, &simulation, &failure));
        DONE(lar_replay(simulation, PATH, NULL, NULL, &report, &failure));
        assert_true(report.hashes > 5 && report.different == UINT64_MAX);
        assert_true(lar_simulation_activation(simulation, 0) == 0.5);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
}

static void touches_are_told_between_ticks(void **unused) {
    (void)unused;
    static lar_touch touch[300];
    const lar_tool_pose pose = {{0.02, 0.01, 0.021}, {1, 0, 0, 0}, 1};
    int32_t count = -1;
    lar_session_options options = lar_session_options_default();
    bench b = open_bench_of(named_block(), "2x1x1", 1, &options);
    DONE(lar_session_tool_touches(b.session, BALL, 300, touch, &count, &failure));
    assert_int_equal(count, 0);
    DONE(lar_session_start(b.session, &failure));
    DONE(lar_session_tool_move(b.session, BALL, &pose, &failure));
    for (int i = 0; i < 20000 && count == 0; i++) {
        nap(0.001);
        DONE(lar_session_tool_touches(b.session, BALL, 300, touch, &count, &failure));
    }
    assert_true(count > 0 && touch[0].depth > 0 && touch[0].node[0] >= 0);
    assert_int_equal(lar_session_tool_touches(b.session, 99, 300, touch, &count, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_tool_touches(b.session, BALL, 3, NULL, &count, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_tool_touches(b.session, BALL, 3, touch, NULL, &failure),
                     LAR_ERROR_ARGUMENT);
    close_bench(&b);
}

/* Bodies that rub: what they remember is in recordings, also behind a state that was taken up. */
static lar_model *rubbing_bricks(void) {
    static const brick lower = {{4, 3, 2}, 0.0125, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};
    static const brick upper = {{2, 2, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};
    lar_model *model = two_bricks(&lower, &upper, 1e-3, true);
    model->contact[0].friction = 0.5;
    model->gravity[0] = 4;
    model->gravity[2] = -9.81;
    DONE(lar_model_check(model, &failure));
    return model;
}

static void friction_is_replayed(void **unused) {
    (void)unused;
    static const char *const path = LAR_TEST_BUILD "/friction.recording";
    static const char *const state = LAR_TEST_BUILD "/friction.checkpoint";
    lar_session_options options = lar_session_options_default();
    options.record = path;
    options.hash_every = 50;
    bench b = open_bench_of(rubbing_bricks(), "2x1x1", 1, &options);
    DONE(lar_session_start(b.session, &failure));
    while (status_of(&b).step < 400) nap(0.002);
    DONE(lar_session_save(b.session, state, &failure));
    while (status_of(&b).step < 600) nap(0.002);
    DONE(lar_session_load(b.session, state, &failure));
    uint64_t taken_up = status_of(&b).step;
    while (status_of(&b).step < taken_up + 200) nap(0.002);
    close_bench(&b);
    for (int k = 0; k < 3; k++) {
        static const char *const grids[] = {NULL, "2x2x1", "1x1x2"};
        lar_model *model = rubbing_bricks();
        lar_simulation *simulation = NULL;
        const lar_options how = block_options(grids[k], k);
        lar_replay_report report;
        DONE(lar_simulation_create(model, &how, &simulation, &failure));
        DONE(lar_replay(simulation, path, NULL, NULL, &report, &failure));
        assert_true(report.hashes > 8 && report.different == UINT64_MAX);
        assert_true(report.recorded_hash == report.replayed_hash);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(friction_is_replayed), cmocka_unit_test(activations_are_played),
        cmocka_unit_test(forces_are_played), cmocka_unit_test(supports_are_played),
        cmocka_unit_test(touches_are_told_between_ticks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
