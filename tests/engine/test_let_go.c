/* Barriers of corners go where no tool has touched anything for a tenth of a second: on every grid
 * in the same step, with the account of energy closed, and not where something else presses. */
#include "engine/engine_test.h"
#include "engine/tools_test.h"

/* Soft, and in honey: what is thrown is folded for longer than that. */
static const brick block = {{4, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 1, 10, 1000};

static lar_model *thrown(void) {
    lar_model *model = brick_model(&block);
    fix_nodes(model, brick_side(&block, 0, 0), LAR_AXIS_ALL);
    throw_node(model, brick_node(&block, 4, 2, 2), (double[]){-1.8, -1, -1.4});
    model->damping = 100;
    return model;
}

/* As if a tool had touched it before, if there is one. */
static lar_simulation *run(const lar_model *model, const char *grid, double until) {
    lar_simulation *s = start_with(model, (lar_options){.grid = grid, .time_step = 2e-5});
    s->tools.division.untouched = 1;
    while (lar_simulation_time(s) < until) advance(s, 10);
    return s;
}

static void only_what_was_touched_counts(void **unused) {
    (void)unused;
    lar_model *model = thrown();
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.2, 0.2, 0.2);
    lar_simulation *s = start_with(model, (lar_options){.time_step = 2e-5});
    while (lar_simulation_time(s) < 0.2) advance(s, 10);
    assert_int_equal(s->tools.division.untouched, 0);
    finish(s, model);
}

/* Of the account of energy [J]; `outside`: what came from there. */
static double missing(lar_simulation *s, double *outside) {
    lar_energy e;
    lar_simulation_energy(s, &e);
    *outside = e.external;
    return e.kinetic + e.strain + e.hourglass + e.damping + e.contact - e.external;
}

static void barriers_go_everywhere_alike(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1", "4x1x1"};
    lar_model *model = thrown();
    lar_simulation *s = start_with(model, (lar_options){.time_step = 2e-5});
    while (lar_simulation_time(s) < 0.2) advance(s, 10);
    double before, outside, kept = missing(s, &before);
    uint64_t hash = lar_simulation_hash(s), gone = hash;
    lar_simulation_destroy(s);
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.2, 0.2, 0.2);
    for (size_t i = 0; i < sizeof grids / sizeof grids[0]; i++) {
        s = run(model, grids[i], 0.08);
        assert_in_range(s->tools.division.untouched, 3000, 4500);
        lar_simulation_destroy(s);
        s = run(model, grids[i], 0.2);
        assert_int_equal(s->tools.division.untouched, LAR_UNTOUCHED_LONG);
        double without = missing(s, &outside);
        outside -= before;
        print_message("from outside %.3g J, account %.3g J off\n", outside, without - kept);
        assert_true(outside != 0);
        assert_below(fabs(without - kept), 0.05 * fabs(outside));
        if (i == 0) gone = lar_simulation_hash(s);
        assert_true(gone != hash && lar_simulation_hash(s) == gone);
        lar_simulation_destroy(s);
    }
    lar_model_destroy(model);
}

/* A load, a support that moves, a pressure or gravity may press without any tool. */
static void barriers_stay_where_something_presses(void **unused) {
    (void)unused;
    for (int i = 0; i < 4; i++) {
        lar_model *model = thrown();
        add_tool(model, "ball", LAR_TOOL_SPHERE, 0.2, 0.2, 0.2);
        if (i == 0)
            load_nodes(model, single_node(brick_node(&block, 4, 0, 0)), 1e-6, 0, 0,
                       add_ramp(model, 0.1));
        if (i == 1)
            move_nodes(model, single_node(brick_node(&block, 4, 0, 0)), LAR_AXIS_X, 1e-6,
                       add_ramp(model, 0.1));
        if (i == 2) press(model, 0, 1e-3, add_ramp(model, 0.1));
        if (i == 3) model->gravity[2] = -1e-3;
        lar_simulation *s = run(model, NULL, 0.2);
        assert_int_equal(s->tools.division.untouched, 1);
        finish(s, model);
    }
}

/* What counts goes into checkpoints. */
static void a_restart_counts_on(void **unused) {
    (void)unused;
    static const char path[] = LAR_TEST_BUILD "/let_go.checkpoint";
    lar_error error;
    lar_model *model = thrown();
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.2, 0.2, 0.2);
    lar_simulation *s = run(model, NULL, 0.08);
    assert_int_equal(lar_simulation_save(s, path, &error), LAR_OK);
    while (lar_simulation_time(s) < 0.3) advance(s, 10);
    lar_simulation *again = run(model, NULL, 0);
    assert_int_equal(lar_simulation_load(again, path, &error), LAR_OK);
    assert_in_range(again->tools.division.untouched, 3000, 4500);
    while (lar_simulation_time(again) < 0.3) advance(again, 10);
    assert_true(lar_simulation_hash(again) == lar_simulation_hash(s));
    lar_simulation_destroy(again);
    finish(s, model);
}

/* While a tool touches, and for a tenth of a second after. */
static void tools_that_touch_are_seen(void **unused) {
    (void)unused;
    lar_model *model = thrown();
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.02, 0.0285, 0.01);
    lar_simulation *s = run(model, NULL, 0.05);
    s->tools.division.untouched = 0;
    place_tool(s, 0, 0.02, 0.026, 0.01, 1, 50);
    bool seen = false;
    while (lar_simulation_time(s) < 0.1) {
        advance(s, 1);
        seen = seen || s->tools.division.untouched == 1;
    }
    assert_true(seen);
    place_tool(s, 0, 0.02, 0.2, 0.01, 1, 50);
    while (lar_simulation_time(s) < 0.15) advance(s, 10);
    assert_in_range(s->tools.division.untouched, 2, 4999);
    while (lar_simulation_time(s) < 0.25) advance(s, 10);
    assert_int_equal(s->tools.division.untouched, LAR_UNTOUCHED_LONG);
    finish(s, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(only_what_was_touched_counts),
                                       cmocka_unit_test(barriers_go_everywhere_alike),
                                       cmocka_unit_test(barriers_stay_where_something_presses),
                                       cmocka_unit_test(a_restart_counts_on),
                                       cmocka_unit_test(tools_that_touch_are_seen)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
