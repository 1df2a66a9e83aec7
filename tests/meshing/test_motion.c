/* How bodies will move, against beams that books have the answer for. */
#include "testing.h"

#include "meshing/motion.h"

static lar_error error;

enum { WIDE = 4, LONG = 80 };
static const double SIDE = 0.01, LENGTH = 0.2, SHEAR = 3000, DENSITY = 1000;

/* A bar along x. */
static lar_meshing bar(double height) {
    static lar_region_info region;
    static int32_t element[LONG * WIDE * WIDE][8], tag[LONG * WIDE * WIDE];
    static double position[(LONG + 1) * (WIDE + 1) * (WIDE + 1)][3];
    lar_meshing m = {.region = &region};
    region = (lar_region_info){.tag = 1, .shear_modulus = SHEAR, .density = DENSITY};
    m.info.regions = 1;
    m.info.size = LENGTH / LONG;
    m.mesh.position = position;
    m.mesh.element = element;
    m.mesh.element_tag = tag;
    for (int i = 0; i <= LONG; i++)
        for (int j = 0; j <= WIDE; j++)
            for (int k = 0; k <= WIDE; k++) {
                double *x = position[m.mesh.node_count++];
                x[0] = LENGTH * i / LONG;
                x[1] = SIDE * j / WIDE;
                x[2] = height * k / WIDE;
            }
    for (int i = 0; i < LONG; i++)
        for (int j = 0; j < WIDE; j++)
            for (int k = 0; k < WIDE; k++) {
                int32_t *node = element[m.mesh.element_count];
                tag[m.mesh.element_count++] = 1;
                for (int a = 0; a < 8; a++) {
                    int at[3];
                    for (int c = 0; c < 3; c++) at[c] = lar_node_sign[a][c] > 0;
                    node[a] = ((i + at[0]) * (WIDE + 1) + j + at[1]) * (WIDE + 1) + k + at[2];
                }
            }
    return m;
}

/* Held at the left end, pulled at the right one along an axis. */
static lar_motion motion_of(double height, int axis) {
    lar_meshing m = bar(height);
    lar_motion motion;
    bool held[(LONG + 1) * (WIDE + 1) * (WIDE + 1)] = {false};
    bool handle[(LONG + 1) * (WIDE + 1) * (WIDE + 1)] = {false};
    for (int32_t n = 0; n < m.mesh.node_count; n++) {
        held[n] = m.mesh.position[n][0] == 0;
        handle[n] = m.mesh.position[n][0] == LENGTH;
    }
    if (lar_motion_estimate(&m, held, handle, axis, &motion, &error)) fail_msg("%s", error.message);
    return motion;
}

/* The slowest of a clamped bar: 3.516 sqrt(EI / m) / L^2, over its height. */
static double slowest(double height) {
    double stiffness = 3 * SHEAR * SIDE * pow(height, 3) / 12, mass = DENSITY * SIDE * height;
    return 3.516 * sqrt(stiffness / mass) / (LENGTH * LENGTH);
}

static void a_bar_swings_as_it_is_thick(void **state) {
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        double height = flat ? SIDE / 4 : SIDE;
        double ratio = motion_of(height, 2).slowest / slowest(height);
        assert_true(ratio > 0.5 && ratio < 1.4);
    }
}

static void a_bar_gives_way_across_much_more_than_along(void **state) {
    (void)state;
    lar_motion along = motion_of(SIDE, 0), across = motion_of(SIDE, 2);
    double bent = pow(LENGTH, 3) / (3 * 3 * SHEAR * pow(SIDE, 4) / 12);
    assert_true(across.compliance > 0.7 * bent && across.compliance < 3.5 * bent);
    assert_below(along.compliance, 0.02 * across.compliance);
    assert_below(fabs(along.reach / LENGTH - 1), 0.01);
}

static void what_nothing_holds_is_not_guessed_at(void **state) {
    (void)state;
    lar_meshing m = bar(SIDE);
    lar_motion motion;
    bool none[(LONG + 1) * (WIDE + 1) * (WIDE + 1)] = {false};
    assert_int_equal(lar_motion_estimate(&m, none, none, 0, &motion, &error), LAR_OK);
    assert_true(motion.slowest == 0 && motion.compliance == 0 && motion.reach == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bar_swings_as_it_is_thick),
        cmocka_unit_test(a_bar_gives_way_across_much_more_than_along),
        cmocka_unit_test(what_nothing_holds_is_not_guessed_at),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
