/* The grid that nobody asked for by name (lar_grid_choose, grid "auto"): which one it is depends on
 * the machine, what comes of it does not. */
#include <stdlib.h>

#include "base/share.h"
#include "divide/grid.h"
#include "engine/engine_test.h"

static const brick big = {{10, 10, 8}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static lar_model *falling(const brick *b) {
    lar_model *model = brick_model(b);
    model->gravity[2] = -9.81;
    return model;
}

static lar_grid_choice choose(const lar_model *model, const lar_options *options,
                              const lar_grid_aim *aim) {
    lar_grid_choice choice;
    lar_error error;
    lar_grid grid;
    assert_int_equal(lar_grid_choose(model, options, aim, &choice, &error), LAR_OK);
    assert_int_equal(lar_grid_parse(choice.grid, &grid, &error), LAR_OK);
    assert_int_equal(grid.count, choice.processors);
    assert_true(choice.processors <= choice.cores || getenv("LARIAT_GRID"));
    assert_true(choice.reason[0]);
    return choice;
}

static void what_is_measured_is_told(void **unused) {
    (void)unused;
    lar_model *model = falling(&big);
    const lar_grid_aim aims[] = {{0}, {.tick = 1e-3}};
    for (size_t i = 0; i < sizeof aims / sizeof aims[0]; i++) {
        lar_grid_choice choice = choose(model, NULL, &aims[i]);
        if (lar_share_cores() < 2) {
            assert_int_equal(choice.tried, 0);
            continue;
        }
        assert_true(choice.tried >= 1);
        assert_true(choice.alone > 0 && choice.chosen > 0);
        assert_true(choice.processors == 1 ? choice.chosen == choice.alone
                                           : choice.chosen < choice.alone);
    }
    lar_model_destroy(model);
}

static void what_cannot_gain_is_not_measured(void **unused) {
    (void)unused;
    lar_model *small = falling(&soft_brick), *model = falling(&big);
    lar_grid_choice choice = choose(small, NULL, NULL);
    assert_int_equal(choice.processors, 1);
    assert_int_equal(choice.tried, 0);
    choice = choose(model, NULL, &(lar_grid_aim){.steps = 2});
    assert_int_equal(choice.processors, 1);
    assert_true(choice.tried <= 1);
    lar_options options = lar_options_default();
    options.verify = 1;
    choice = choose(model, &options, NULL);
    assert_int_equal(choice.tried, 0);
    lar_model_destroy(small);
    lar_model_destroy(model);
}

static void the_environment_decides(void **unused) {
    (void)unused;
    lar_model *model = falling(&big);
    lar_grid_choice choice;
    lar_error error;
    setenv("LARIAT_GRID", "2x1x2", 1);
    choice = choose(model, NULL, NULL);
    assert_string_equal(choice.grid, "2x1x2");
    assert_int_equal(choice.tried, 0);
    setenv("LARIAT_GRID", "1024x1x1", 1);
    assert_int_equal(choose(model, NULL, NULL).processors, 1);
    setenv("LARIAT_GRID", "two", 1);
    assert_int_equal(lar_grid_choose(model, NULL, NULL, &choice, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "LARIAT_GRID: 'two'"));
    unsetenv("LARIAT_GRID");
    lar_model_destroy(model);
}

static uint64_t hash_with(const lar_model *model, const char *grid, int32_t *processors) {
    lar_options options = lar_options_default();
    lar_simulation *simulation = NULL;
    lar_error error;
    options.grid = grid;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    assert_int_equal(lar_simulation_advance(simulation, 30, &error), LAR_OK);
    *processors = lar_simulation_processors(simulation);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static void auto_computes_the_same_bits(void **unused) {
    (void)unused;
    lar_model *model = falling(&big);
    int32_t processors;
    uint64_t alone = hash_with(model, NULL, &processors);
    assert_int_equal(processors, 1);
    assert_int_equal(hash_with(model, "auto", &processors), alone);
    assert_in_range(processors, 1, lar_share_cores());
    setenv("LARIAT_GRID", "1x3x1", 1);
    assert_int_equal(hash_with(model, "auto", &processors), alone);
    assert_int_equal(processors, 3);
    unsetenv("LARIAT_GRID");
    lar_model_destroy(model);
}

static void what_contradicts_is_refused(void **unused) {
    (void)unused;
    lar_model *model = falling(&big);
    lar_grid_choice choice;
    lar_simulation *simulation = NULL;
    lar_error error;
    lar_options options = lar_options_default();
    options.grid = "auto";
    options.comm = "shm";
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "say which"));
    options.comm = NULL;
    options.schedules = "schedules";
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "schedules has its own grid"));
    assert_int_equal(lar_grid_choose(NULL, NULL, NULL, &choice, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_grid_choose(model, NULL, NULL, NULL, &error), LAR_ERROR_ARGUMENT);
    lar_grid_take(NULL, &options);
    lar_grid_take(&choice, NULL);
    lar_model_destroy(model);
}

int main(void) {
    unsetenv("LARIAT_GRID");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_measured_is_told),
        cmocka_unit_test(what_cannot_gain_is_not_measured),
        cmocka_unit_test(the_environment_decides),
        cmocka_unit_test(auto_computes_the_same_bits),
        cmocka_unit_test(what_contradicts_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
