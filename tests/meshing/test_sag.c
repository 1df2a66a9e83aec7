/* How bodies will move, against beams that books have the answer for. */
#include "bars.h"

#include "meshing/starter/sag.h"

static lar_error error;
static bool held[BAR_NODES], handle[BAR_NODES];
static double sag[BAR_NODES];

/* Held at the left end, pulled at the right one along an axis. */
static lar_sag motion_of(double height, int axis) {
    lar_meshing m = bar(height);
    lar_sag motion;
    bar_mark(&m, 0, held);
    bar_mark(&m, BAR_LENGTH, handle);
    if (lar_sag_estimate(&m, held, handle, axis, &motion, sag, &error))
        fail_msg("%s", error.message);
    return motion;
}

/* The slowest of a clamped bar: 3.516 sqrt(EI / m) / L^2, over its height. */
static void a_bar_swings_as_it_is_thick(void **state) {
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        double height = flat ? BAR_SIDE / 4 : BAR_SIDE, mass = BAR_DENSITY * BAR_SIDE * height;
        double slowest = 3.516 * sqrt(bar_bending(height) / mass) / (BAR_LENGTH * BAR_LENGTH);
        assert_below(fabs(motion_of(height, 0).slowest / slowest - 1), 0.05);
        assert_below(fabs(motion_of(height, 2).slowest / slowest - 1), 0.05);
    }
}

static void a_bar_gives_way_as_a_beam_does(void **state) {
    (void)state;
    double along = motion_of(BAR_SIDE, 0).compliance, across = motion_of(BAR_SIDE, 2).compliance;
    double bent = pow(BAR_LENGTH, 3) / (3 * bar_bending(BAR_SIDE));
    double drawn = BAR_LENGTH / (2.9 * BAR_SHEAR * BAR_SIDE * BAR_SIDE);
    assert_below(fabs(across / bent - 1), 0.06);
    assert_below(fabs(along / drawn - 1), 0.04); /* its end is held all around */
}

/* m g L^4 / 8 E I at the end, nothing where it is held; the flat way is the worst. */
static void its_end_sags_most(void **state) {
    (void)state;
    const double height = BAR_SIDE / 2, weight = BAR_DENSITY * BAR_SIDE * height * 9.81;
    motion_of(height, 0);
    double expected = weight * pow(BAR_LENGTH, 4) / (8 * bar_bending(height)), max = 0;
    for (int n = 0; n < BAR_NODES; n++) {
        max = fmax(max, sag[n]);
        if (held[n]) assert_true(sag[n] == 0);
    }
    assert_below(fabs(max / expected - 1), 0.06);
    assert_true(sag[BAR_NODES - 1] > 0.95 * max);
}

static void what_nothing_holds_is_left_out(void **state) {
    (void)state;
    lar_meshing m = bar(BAR_SIDE);
    lar_sag motion;
    bool none[BAR_NODES] = {false};
    assert_int_equal(lar_sag_estimate(&m, none, none, 0, &motion, sag, &error), LAR_OK);
    assert_true(motion.slowest == 0 && motion.compliance == 0 && sag[0] == 0);
    bar_mark(&m, 0, held);
    bar_mark(&m, BAR_LENGTH, handle);
    m.region[0].held = true; /* bone, all of it */
    assert_int_equal(lar_sag_estimate(&m, held, handle, 0, &motion, NULL, &error), LAR_OK);
    assert_true(motion.slowest == 0 && motion.compliance == 0);
}

/* Bent by its left half and its end, the end goes 10 times as far as most: the half is pulled. */
static void what_sits_on_something_thin_is_not_pulled(void **state) {
    (void)state;
    lar_meshing m = bar(BAR_SIDE);
    lar_sag motion, half;
    for (int whole = 1; whole >= 0; whole--) {
        bar_mark(&m, 0, held);
        for (int n = 0; n < BAR_NODES; n++) {
            const double x = m.mesh.position[n][0] / BAR_LENGTH;
            handle[n] = (x > 0 && x < 0.2) || (whole && x > 0.99);
        }
        assert_int_equal(
            lar_sag_estimate(&m, held, handle, 2, whole ? &motion : &half, sag, &error), LAR_OK);
        assert_false(handle[BAR_NODES - 1]);
        assert_true(handle[BAR_NODES / 10]);
    }
    assert_true(motion.compliance == half.compliance);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bar_swings_as_it_is_thick),
        cmocka_unit_test(a_bar_gives_way_as_a_beam_does),
        cmocka_unit_test(its_end_sags_most),
        cmocka_unit_test(what_nothing_holds_is_left_out),
        cmocka_unit_test(what_sits_on_something_thin_is_not_pulled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
