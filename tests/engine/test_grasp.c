/* Jaws that hold tissue: what they press it with, that opening lets go without a jump, and that two
 * of them stretch an organ between them. */
#include "engine/engine_test.h"
#include "engine/touch_test.h"

static const double upright[4] = {1, 0, 0, 0};

/* A fold of tissue, 6 mm thick, that stands up from what holds it at its bottom. */
static const brick fold = {{2, 8, 6}, 0.003, 0, LAR_LAW_neo_hookean, 3e3, 6e4, 1000};
static const lar_tool jaws = {
    .shape = LAR_TOOL_GRASPER, .radius = 0.002, .length = 0.02, .spread = 0.8726646259971648};
static const double middle[3] = {0.003, 0.012, 0.018}; /* of its upper edge */

static lar_model *fold_model(void) {
    lar_model *model = brick_model(&fold);
    fix_nodes(model, brick_side(&fold, 2, 0), LAR_AXIS_ALL);
    model->damping = 40;
    return model;
}

static lar_tool_force felt(const lar_simulation *simulation, int32_t tool) {
    lar_tool_force force;
    lar_error error;
    if (lar_simulation_tool_force(simulation, tool, &force, &error)) fail_msg("%s", error.message);
    return force;
}

static uint64_t steps_of(const lar_simulation *simulation, double seconds) {
    return (uint64_t)(seconds / lar_simulation_time_step(simulation));
}

/* Asks a tool to be somewhere, and waits. */
static void bring(lar_simulation *simulation, int32_t tool, const double position[3],
                  double opening, double seconds) {
    uint64_t steps = steps_of(simulation, seconds);
    place(simulation, tool, position, upright, opening, steps);
    advance(simulation, steps);
}

static double fastest(const lar_simulation *simulation) {
    double most = 0;
    for (int32_t n = 0; n < simulation->domain.model->mesh.node_count; n++) {
        const double *v = node_v(simulation, n);
        most = fmax(most, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return most;
}

/* ---- what they press with ------------------------------------------------------------------- */

/* Capsules where the jaws are feel what the jaws feel, each its own. */
static void grasp_is_what_one_jaw_is_pushed_with(void **unused) {
    (void)unused;
    const double above[3] = {0.003, 0.012, 0.0335};
    double opening = 0.62, half = 0.5 * jaws.spread * opening, capsule[2];
    lar_model *model = fold_model();
    touch_tool(model, "jaws", jaws, above);
    lar_simulation *simulation = start(model);
    assert_true(felt(simulation, 0).grasp == 0);
    bring(simulation, 0, above, opening, 0.5);
    advance(simulation, steps_of(simulation, 0.5));
    lar_tool_force grasped = felt(simulation, 0);
    assert_int_equal(grasped.limited, 0);
    assert_int_equal(grasped.held, 0);
    const lar_tool_sum *sum = &simulation->report.tool[0];
    double share = (double)(sum->jaw[0] - sum->jaw[1]) / (double)(sum->jaw[0] + sum->jaw[1]);
    finish(simulation, model);

    model = fold_model();
    lar_tool half_jaw = {.shape = LAR_TOOL_CAPSULE, .radius = jaws.radius, .length = jaws.length};
    for (int s = 0; s < 2; s++) {
        touch_tool(model, s ? "left" : "right", half_jaw,
                   (double[]){above[0] + (s ? -0.006 : 0.006), above[1], above[2]});
        /* Its shaft along the jaw: a turn about y, by pi less half of the angle between them. */
        double turn = acos(-1) + (s ? half : -half);
        memcpy(model->tool[s].rest.orientation, (double[]){cos(turn / 2), 0, sin(turn / 2), 0},
               sizeof upright);
    }
    simulation = start(model);
    for (int s = 0; s < 2; s++)
        place(simulation, s, above, model->tool[s].rest.orientation, 1, steps_of(simulation, 0.5));
    advance(simulation, steps_of(simulation, 1));
    for (int s = 0; s < 2; s++) {
        lar_tool_force force = felt(simulation, s);
        assert_true(force.grasp == 0); /* it has no jaws */
        capsule[s] = (s ? -1 : 1) * force.force[0] * cos(half) + force.force[2] * sin(half);
    }
    finish(simulation, model);
    print_message("jaws grasp with %.4g N, capsules in their place with %.4g and %.4g N; the jaws "
                  "differ by %.1g; the grasper has %.2g N across\n",
                  grasped.grasp, capsule[0], capsule[1], share, grasped.force[0]);
    assert_true(grasped.grasp > 0.05);
    assert_below(fabs(share), 1e-6); /* action and reaction */
    assert_below(fabs(grasped.force[0]), 1e-6 * grasped.grasp);
    for (int s = 0; s < 2; s++)
        assert_below(fabs(capsule[s] - grasped.grasp), 0.01 * grasped.grasp);
}

/* ---- letting go ----------------------------------------------------------------------------- */

/* Jaws that close on the fold and draw it up by `way`. */
static lar_simulation *held_and_drawn(lar_model *model, double way) {
    const double above[3] = {middle[0], middle[1], 0.0335};
    lar_simulation *simulation = start(model);
    bring(simulation, 0, above, 0, 0.4);
    bring(simulation, 0, (double[]){above[0], above[1], above[2] + way}, 0, 0.3);
    advance(simulation, steps_of(simulation, 0.5));
    return simulation;
}

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void opening_lets_go_without_a_jump(void **unused) {
    (void)unused;
    static const double ways[2] = {0.002, 0.005}, opens[2] = {0.01, 0.1};
    for (int w = 0; w < 2; w++)
        for (int o = 0; o < 2; o++) {
            lar_model *model = fold_model();
            touch_tool(model, "jaws", jaws, (double[]){middle[0], middle[1], 0.0335});
            lar_simulation *simulation = held_and_drawn(model, ways[w]);
            lar_tool_force held = felt(simulation, 0);
            lar_tool_pose pose;
            lar_energy energy;
            lar_simulation_energy(simulation, &energy);
            lar_simulation_tool_pose(simulation, 0, &pose, NULL);
            place(simulation, 0, (double[]){middle[0], middle[1], 0.0335 + ways[w]}, upright, 1,
                  steps_of(simulation, opens[o]));
            double most = 0, speed = 0, drop = 0, before = length_of(held.force);
            const double force = before;
            for (int i = 0; i < 400; i++) {
                advance(simulation, steps_of(simulation, 0.001));
                double now = length_of(felt(simulation, 0).force);
                most = fmax(most, now);
                drop = fmax(drop, before - now);
                before = now;
                speed = fmax(speed, fastest(simulation));
            }
            print_message(
                "held %d points with %.3g N, grasp %.3g N at %.2f, strain %.2g mJ; opened "
                "in %g s: %.3g N at most, a fall of %.2g N in a ms, %.3g m/s; left %.2g N\n",
                (int)held.held, force, held.grasp, pose.opening, 1e3 * energy.strain, opens[o],
                most, drop, speed, before);
            finish(simulation, model);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grasp_is_what_one_jaw_is_pushed_with),
        cmocka_unit_test(opening_lets_go_without_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
