/* Tools on free bodies: what is touched is felt, what is held does not creep, what slides has
 * Coulomb's force, and the bits are the same everywhere. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"
#include "engine/tools_test.h"

static const brick stone = {{4, 4, 4}, 0.005, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 2000};
static const double half = 0.01, radius = 0.004, gravity = 9.81, outside = 1e-6;
static const double weight = 0.02 * 0.02 * 0.02 * 2000 * 9.81;
enum { RODS = 2, STONE_NODES = 125 };

/* A stone between two upright rods that nothing but their friction keeps from falling. */
static lar_model *held_stone(double friction) {
    lar_model *model = empty_model(&stone);
    add_brick(model, &stone, (double[]){-half, -half, -half});
    for (int i = 0; i < RODS; i++) {
        const double x = (i ? 1 : -1) * (half + radius + outside);
        add_tool(model, i ? "right" : "left", LAR_TOOL_CAPSULE, x, 0, -0.015);
        model->tool[i].radius = radius;
        model->tool[i].friction = friction;
    }
    bind_nodes(model, 0, STONE_NODES);
    model->gravity[2] = -gravity;
    return model;
}

/* The rods go to where they are so deep in the stone, and up. */
static void go(lar_simulation *s, double depth, double up, double seconds) {
    const uint64_t steps = (uint64_t)(seconds / lar_simulation_time_step(s));
    for (int i = 0; i < RODS; i++)
        place_tool(s, i, (i ? 1 : -1) * (half + radius - depth), 0, up - 0.015, 1, steps);
    advance(s, steps);
}

/* Sums of what the rods feel on average of some steps: pressed apart, and pulled down [N]. */
static void feel(lar_simulation *s, uint64_t steps, double *apart, double *down) {
    *apart = *down = 0;
    advance(s, steps);
    for (int i = 0; i < RODS; i++) {
        lar_tool_force felt;
        assert_int_equal(lar_simulation_tool_force(s, i, &felt, NULL), LAR_OK);
        *apart += fabs(felt.force[0]);
        *down -= felt.force[2];
    }
}

/* Upwards. */
static double speed_of(const lar_simulation *s) {
    double v[STONE_NODES][3];
    lar_simulation_velocities(s, v);
    return v[0][2];
}

static void what_is_held_does_not_creep(void **unused) {
    (void)unused;
    lar_model *model = held_stone(0.5);
    lar_simulation *s = start(model);
    double apart, down;
    go(s, 0.0005, 0, 0.01);
    go(s, 0.0005, 0.05, 0.3);
    go(s, 0.0005, 0.05, 0.2);
    const double before = node_u(s, 0)[2];
    go(s, 0.0005, 0.05, 0.5);
    const double after = node_u(s, 0)[2];
    feel(s, 100, &apart, &down);
    print_message("lifted by %.3f mm, creeps by %.2g mm in half a second; %.6f N of %.6f N\n",
                  1e3 * after, 1e3 * (before - after), down, weight);
    assert_below(fabs(after - 0.05), 5e-4);
    assert_below(fabs(after - before), 1e-9);
    assert_below(fabs(down - weight), 1e-6 * weight);
    finish(s, model);
}

/* Rods that press so little that friction bears only a part: it falls as that says. */
static void what_slides_has_coulombs_force(void **unused) {
    (void)unused;
    const double friction = 0.02;
    lar_model *model = held_stone(friction);
    lar_simulation *s = start(model);
    double apart, down;
    go(s, 5e-5, 0, 0.01);
    const double before = speed_of(s);
    const double t = lar_simulation_time(s);
    feel(s, 50, &apart, &down);
    const double fall = (before - speed_of(s)) / (lar_simulation_time(s) - t);
    print_message("%.4f N press, %.4f N of friction; falls with %.4f, %.4f m/s^2\n", apart, down,
                  fall, gravity * (1 - friction * apart / weight));
    assert_below(fabs(down - friction * apart), 1e-2 * down); /* some presses sideways */
    assert_below(fabs(fall - gravity * (1 - down / weight)), 1e-2 * fall);
    finish(s, model);
}

/* Balls of 4 mm press a stone of n^3 elements from both sides, at a height: what one feels [N]. */
static double press_balls(int n, double height, double depth) {
    const brick b = {{n, n, n}, 0.02 / n, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 2000};
    lar_model *model = empty_model(&b);
    add_brick(model, &b, (double[]){-half, -half, -half});
    for (int i = 0; i < RODS; i++) {
        const double x = (i ? 1 : -1) * (half + radius + outside);
        add_tool(model, i ? "right" : "left", LAR_TOOL_SPHERE, x, height, height);
        model->tool[i].radius = radius;
    }
    bind_nodes(model, 0, (n + 1) * (n + 1) * (n + 1));
    lar_options options = lar_options_default();
    options.time_step = 1e-4;
    lar_simulation *s = start_with(model, options);
    for (int i = 0; i < RODS; i++)
        place_tool(s, i, (i ? 1 : -1) * (half + radius - depth), height, height, 1, 200);
    advance(s, 600);
    lar_tool_force felt;
    assert_int_equal(lar_simulation_tool_force(s, 1, &felt, NULL), LAR_OK);
    finish(s, model);
    return felt.force[0];
}

/* A ball that is small beside a face is felt as soon as it touches, wherever on it, and as hard on
 * a coarse stone as on a fine one: what it moves is all of it. */
static void what_is_touched_is_felt(void **unused) {
    (void)unused;
    const double like = press_balls(4, 0, 5e-5);
    for (int n = 2; n <= 8; n *= 2)
        for (int k = 0; k < 3; k++) {
            const double force = press_balls(n, 0.00125 * k, 5e-5);
            print_message("%d^3 elements, %.2f mm beside the middle: %.3f N\n", n, 1.25 * k, force);
            assert_true(force > 0.3 * like && force < 3 * like);
        }
}

static uint64_t hash_with(lar_options options, bool saves) {
    lar_model *model = held_stone(0.5);
    lar_simulation *s = start_with(model, options);
    go(s, 0.0005, 0, 0.01);
    go(s, 0.0005, 0.01, 0.05);
    if (saves) {
        const char *path = LAR_TEST_BUILD "/grip.checkpoint";
        assert_int_equal(lar_simulation_save(s, path, NULL), LAR_OK);
        lar_simulation_destroy(s);
        s = start_with(model, options);
        assert_int_equal(lar_simulation_load(s, path, NULL), LAR_OK);
    }
    go(s, 0.0004, 0.02, 0.05);
    const uint64_t hash = lar_simulation_hash(s);
    finish(s, model);
    return hash;
}

static void bits_are_the_same_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {"2x1x1", "1x3x1", "2x2x3"};
    lar_options options = lar_options_default();
    const uint64_t whole = hash_with(options, false);
    assert_true(hash_with(options, true) == whole);
    for (int g = 0; g < 3; g++) {
        options.grid = grids[g];
        assert_true(hash_with(options, g == 1) == whole);
    }
}

/* A ball on a way at 1 m/s meets a stone that lies before it: the blow holds it back for a
 * millisecond, then it is where it is led. Before, it went on at half the speed for ever. */
static void a_fast_tool_catches_up(void **unused) {
    (void)unused;
    static const brick b = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 1e5, 1e6, 2500};
    lar_model *model = empty_model(&b);
    add_brick(model, &b, (double[]){-half, -half, -half});
    add_tool(model, "ball", LAR_TOOL_SPHERE, -half - 0.007, 0, -0.002);
    model->tool[0].radius = 0.005;
    bind_nodes(model, 0, 27);
    lar_simulation *s = start(model);
    const uint64_t steps = (uint64_t)(0.05 / lar_simulation_time_step(s));
    const double way = (double)steps * lar_simulation_time_step(s); /* at 1 m/s */
    lar_tool_force felt;
    bool limited = false;
    place_tool(s, 0, -half - 0.007 + way, 0, -0.002, 1, steps);
    for (uint64_t i = 0; i < steps; i++) {
        advance(s, 1);
        assert_int_equal(lar_simulation_tool_force(s, 0, &felt, NULL), LAR_OK);
        limited = limited || felt.limited;
    }
    lar_tool_pose pose;
    assert_int_equal(lar_simulation_tool_pose(s, 0, &pose, NULL), LAR_OK);
    print_message("the ball is %.3f mm from where it is led, the stone went %.1f mm\n",
                  1e3 * felt.apart, 1e3 * node_u(s, 0)[0]);
    assert_true(limited);
    assert_true(!felt.limited && felt.apart == 0);
    assert_below(fabs(pose.position[0] - (-half - 0.007 + way)), 1e-9);
    assert_true(node_u(s, 0)[0] > 0.02);
    finish(s, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_held_does_not_creep),
        cmocka_unit_test(what_slides_has_coulombs_force),
        cmocka_unit_test(what_is_touched_is_felt),
        cmocka_unit_test(bits_are_the_same_everywhere),
        cmocka_unit_test(a_fast_tool_catches_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
