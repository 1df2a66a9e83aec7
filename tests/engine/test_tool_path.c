/* A tool whose scene has a path goes where calls at its rows would send it, on every grid, however
 * the run is divided, and after a checkpoint in the middle of a way. */
#include "engine/engine_test.h"
#include "engine/tools_test.h"

#include "simulation/simulation.h"

#define CHECKPOINT LAR_TEST_BUILD "/tool_path.checkpoint"

enum { STEPS = 160 };

static const double ball_row[][4] = {/* steps, and where */
                                     {0, 0.03, 0.025, 0.052},
                                     {50, 0.03, 0.025, 0.044},
                                     {70.3, 0.032, 0.025, 0.044},
                                     {70.4, 0.032, 0.025, 0.044}, /* no step of its own */
                                     {120, 0.036, 0.028, 0.044}};
static const double grasper_row[][5] = {{0, 0.03, 0.015, 0.095, 1},
                                        {60, 0.03, 0.015, 0.068, 1},
                                        {100, 0.03, 0.015, 0.068, 0},
                                        {150, 0.03, 0.015, 0.074, 0}};

static void add_row(lar_tool *tool, double time, const double at[3], double opening) {
    lar_tool_script_row row = {.time = time,
                               .pose = {.orientation = {1, 0, 0, 0}, .opening = opening}};
    memcpy(row.pose.position, at, sizeof row.pose.position);
    assert_true(lar_tool_script_insert(&tool->path, tool->path.count, &row));
}

/* The step is the model's own: paths are in seconds. */
static lar_model *path_model(bool paths, lar_options *options) {
    lar_model *model = tool_model();
    *options = lar_options_default();
    options->hands = 1;
    options->time_step = 2e-4;
    if (!paths) return model;
    for (size_t i = 0; i < sizeof ball_row / sizeof ball_row[0]; i++)
        add_row(&model->tool[TEST_BALL], ball_row[i][0] * options->time_step, ball_row[i] + 1, 1);
    for (size_t i = 0; i < sizeof grasper_row / sizeof grasper_row[0]; i++)
        add_row(&model->tool[TEST_GRASPER], grasper_row[i][0] * options->time_step,
                grasper_row[i] + 1, grasper_row[i][4]);
    return model;
}

static uint64_t follow(const char *grid, int32_t threads, const uint64_t *portion) {
    lar_options options;
    lar_model *model = path_model(true, &options);
    options.grid = grid;
    options.threads = threads;
    lar_simulation *simulation = start_with(model, options);
    for (int i = 0; lar_simulation_steps(simulation) < STEPS; i++) {
        uint64_t left = STEPS - lar_simulation_steps(simulation), steps = portion[i % 3];
        advance(simulation, (int)(steps < left ? steps : left));
    }
    uint64_t hash = lar_simulation_hash(simulation);
    finish(simulation, model);
    return hash;
}

/* Calls at the rows, in pieces of a millisecond (five steps) where jaws move. */
static uint64_t call(void) {
    lar_options options;
    lar_model *model = path_model(false, &options);
    lar_simulation *simulation = start_with(model, options);
    for (int step = 0; step < STEPS; step++) {
        if (step == 0) place_tool(simulation, TEST_BALL, 0.03, 0.025, 0.044, 1, 50);
        if (step == 50) place_tool(simulation, TEST_BALL, 0.032, 0.025, 0.044, 1, 20);
        if (step == 70) place_tool(simulation, TEST_BALL, 0.036, 0.028, 0.044, 1, 50);
        if (step == 0) place_tool(simulation, TEST_GRASPER, 0.03, 0.015, 0.068, 1, 60);
        if (step >= 60 && step < 100 && step % 5 == 0) {
            lar_tool_script_row rows[2] = {{60 * options.time_step, {.opening = 1}},
                                           {100 * options.time_step, {.opening = 0}}};
            lar_tool_pose pose = {.opening = 0};
            if (step < 95) lar_tool_script_between(rows, (step + 5) * options.time_step, &pose);
            place_tool(simulation, TEST_GRASPER, 0.03, 0.015, 0.068, pose.opening, 5);
        }
        if (step == 100) place_tool(simulation, TEST_GRASPER, 0.03, 0.015, 0.074, 0, 50);
        advance(simulation, 1);
    }
    lar_tool_force force;
    lar_simulation_tool_force(simulation, TEST_GRASPER, &force, NULL);
    assert_true(force.held > 0);
    uint64_t hash = lar_simulation_hash(simulation);
    finish(simulation, model);
    return hash;
}

static void goes_where_calls_would_send_it(void **state) {
    (void)state;
    uint64_t expected = call();
    assert_int_equal(follow(NULL, 1, (const uint64_t[]){1, 1, 1}), expected);
    assert_int_equal(follow(NULL, 1, (const uint64_t[]){STEPS, 1, 1}), expected);
    assert_int_equal(follow(NULL, 1, (const uint64_t[]){3, 45, 7}), expected);
    assert_int_equal(follow("2x1x1", 1, (const uint64_t[]){STEPS, 1, 1}), expected);
    assert_int_equal(follow("3x2x1", 1, (const uint64_t[]){17, 2, 40}), expected);
    assert_int_equal(follow("2x1x1", 2, (const uint64_t[]){STEPS, 1, 1}), expected);
}

/* In the middle of a way, and where a row begins. */
static void goes_on_after_a_checkpoint(void **state) {
    (void)state;
    uint64_t expected = follow(NULL, 1, (const uint64_t[]){STEPS, 1, 1});
    for (int kept = 50; kept <= 72; kept += 11) {
        lar_options options;
        lar_error error;
        lar_model *model = path_model(true, &options);
        lar_simulation *first = start_with(model, options), *second = start_with(model, options);
        advance(first, kept);
        assert_int_equal(lar_simulation_save(first, CHECKPOINT, &error), LAR_OK);
        if (lar_simulation_load(second, CHECKPOINT, &error)) fail_msg("%s", error.message);
        advance(second, STEPS - kept);
        assert_int_equal(lar_simulation_hash(second), expected);
        assert_int_equal(lar_simulation_reset(second, &error), LAR_OK);
        advance(second, STEPS);
        assert_int_equal(lar_simulation_hash(second), expected);
        lar_simulation_destroy(first);
        finish(second, model);
    }
}

/* A checkpoint of another path is refused: the run would go elsewhere. */
static void paths_belong_to_the_model(void **state) {
    (void)state;
    lar_options options;
    lar_error error;
    lar_model *model = path_model(true, &options), *other = path_model(true, &options);
    other->tool[TEST_BALL].path.row[4].pose.position[0] += 1e-4;
    lar_simulation *simulation = start_with(model, options),
                   *different = start_with(other, options);
    assert_int_equal(lar_simulation_save(simulation, CHECKPOINT, &error), LAR_OK);
    assert_int_not_equal(lar_simulation_load(different, CHECKPOINT, &error), LAR_OK);
    assert_non_null(strstr(error.message, "tools"));
    finish(simulation, model);
    finish(different, other);
}

static void too_fast_is_refused(void **state) {
    (void)state;
    lar_options options;
    lar_error error;
    lar_simulation *simulation = NULL;
    lar_model *model = path_model(true, &options);
    model->tool[TEST_BALL].path.row[1].time = options.time_step;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "tool ball: its path goes 0.008 m from 0 to 0.0002 s"));
    assert_null(simulation);
    lar_model_destroy(model);
}

/* What moves a tool otherwise holds until the path's next row; it never fails for being far. */
static void others_may_move_it(void **state) {
    (void)state;
    lar_options options;
    lar_model *model = path_model(true, &options);
    lar_simulation *simulation = start_with(model, options);
    lar_tool_pose pose;
    advance(simulation, 10);
    place_tool(simulation, TEST_BALL, 0.1, 0.025, 0.13, 1, 40);
    advance(simulation, 40);
    lar_simulation_tool_pose(simulation, TEST_BALL, &pose, NULL);
    assert_below(fabs(pose.position[0] - 0.1), 1e-12);
    advance(simulation, STEPS);
    lar_simulation_tool_pose(simulation, TEST_BALL, &pose, NULL);
    assert_below(fabs(pose.position[0] - 0.036), 1e-3);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(goes_where_calls_would_send_it),
        cmocka_unit_test(goes_on_after_a_checkpoint),
        cmocka_unit_test(paths_belong_to_the_model),
        cmocka_unit_test(too_fast_is_refused),
        cmocka_unit_test(others_may_move_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
