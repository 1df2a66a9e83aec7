/* What jumps while it runs, where bodies touch: a run ends, or goes on, the same on any number of
 * processors, however fast a node becomes within a step. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"

enum { AT = 20, AFTER = 12, TEXT = 1016 };
static const double forces[] = {0.5, 1.5, 2.5, 5, 8};

/* A cube on a bed that is held, and what tugs at its last corner, if anything. */
static lar_model *cube_on_a_bed(const lar_curve *curve, double force) {
    static const brick bed = {{6, 6, 3}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 4e4, 1050};
    static const brick cube = {{3, 3, 3}, 0.008, 0, LAR_LAW_neo_hookean, 2e3, 4e4, 1050};
    lar_model *model = empty_model(&bed);
    add_brick(model, &bed, (double[]){0, 0, 0});
    fix_nodes(model, brick_side(&bed, 2, 0), LAR_AXIS_ALL);
    add_brick(model, &cube, (double[]){0.018, 0.018, 0.0302});
    touch_self(model);
    model->damping = 2;
    if (!curve) return model;
    load_nodes(model, single_node(model->mesh.node_count - 1), force, force, force,
               add_table(model, curve->shape, curve->count, (const double(*)[2])curve->point));
    return model;
}

/* The end of a run: hash, or the sentence. */
static void run(const lar_model *model, const char *grid, int threads, bool sets, double force,
                char text[TEXT]) {
    lar_options options = lar_options_default();
    lar_error error;
    options.grid = grid;
    options.threads = threads;
    lar_simulation *s = start_with(model, options);
    const int32_t corner = model->mesh.node_count - 1;
    lar_status status = lar_simulation_advance(s, AT, &error);
    assert_int_equal(status, LAR_OK);
    if (sets) {
        assert_int_equal(lar_simulation_set_stiffness(s, -1, 2, &error), LAR_OK);
        assert_int_equal(
            lar_simulation_set_force(s, corner, (const double[]){force, force, force}, &error),
            LAR_OK);
    }
    status = lar_simulation_advance(s, AFTER, &error);
    if (status)
        snprintf(text, TEXT, "%s", error.message);
    else
        snprintf(text, TEXT, "%016llx", (unsigned long long)lar_simulation_hash(s));
    lar_simulation_destroy(s);
}

/* How many of these runs end early. */
static int compare(const lar_model *model, bool sets, double force) {
    char whole[TEXT], other[TEXT];
    run(model, NULL, 0, sets, force, whole);
    run(model, NULL, 2, sets, force, other);
    assert_string_equal(other, whole);
    run(model, "2x1x1", 0, sets, force, other);
    assert_string_equal(other, whole);
    run(model, "1x2x2", 0, sets, force, other);
    assert_string_equal(other, whole);
    return strncmp(whole, "unstable", 8) == 0;
}

static void forces_that_are_set(void **unused) {
    (void)unused;
    int broken = 0, all = (int)(sizeof forces / sizeof *forces);
    lar_model *model = cube_on_a_bed(NULL, 0);
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    for (int i = 0; i < all; i++) broken += compare(model, true, forces[i]);
    print_message("%d of %d runs end early\n", broken, all);
    assert_true(broken > 0 && broken < all);
    lar_model_destroy(model);
}

static void loads_that_jump(void **unused) {
    (void)unused;
    int broken = 0, all = (int)(sizeof forces / sizeof *forces);
    double point[][2] = {{0, 0}, {0.0121, 0}, {0.0121, 1}};
    const lar_curve jump = {.shape = LAR_CURVE_LINEAR, .count = 3, .point = point};
    for (int i = 0; i < all; i++) {
        lar_model *model = cube_on_a_bed(&jump, forces[i]);
        assert_int_equal(lar_model_check(model, NULL), LAR_OK);
        broken += compare(model, false, 0);
        lar_model_destroy(model);
    }
    print_message("%d of %d runs end early\n", broken, all);
    assert_true(broken > 0 && broken < all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_that_are_set),
        cmocka_unit_test(loads_that_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
