/* Thin tools that stand deep in tissue, where faces are folded around them: they do no work, and
 * the tissue comes to rest. */
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"

static const brick block = {{8, 8, 4}, 0.005, 0, LAR_LAW_neo_hookean, 4e3, 2e5, 1050};
static const double upright[4] = {1, 0, 0, 0}, height = 0.02;
static const double along_x[4] = {0.70710678118654752, 0, -0.70710678118654752, 0};

static lar_simulation *pressed(lar_model *model, double part, double x, double y, double deep) {
    const double radius = model->tool[0].radius;
    lar_options options = lar_options_default();
    options.time_step = part * stable_step_of(model);
    lar_simulation *simulation = start_with(model, options);
    const double to[3] = {x, y, height + radius - deep};
    place(simulation, 0, to, upright, 1, (uint64_t)(0.3 / options.time_step));
    while (lar_simulation_time(simulation) < 1.7) advance(simulation, 100);
    return simulation;
}

/* A shaft, tip down, off the middle of a face. */
static void stand(double radius, double x, double y, double deep, double part) {
    lar_model *model = brick_model(&block);
    fix_nodes(model, brick_side(&block, 2, 0), LAR_AXIS_ALL);
    touch_tool(model, "shaft",
               (lar_tool){.shape = LAR_TOOL_CAPSULE, .radius = radius, .length = 0.1},
               (double[]){x, y, height + radius + 0.001});
    model->damping = 20;
    lar_simulation *simulation = pressed(model, part, x, y, deep);
    lar_tool_force force, later;
    lar_energy then, now;
    lar_error error;
    double most = 0;
    advance(simulation, 1);
    lar_simulation_energy(simulation, &then);
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, &error), LAR_OK);
    for (int i = 0; i < 500; i++) {
        advance(simulation, 1);
        assert_int_equal(lar_simulation_tool_force(simulation, 0, &later, &error), LAR_OK);
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(later.force[k] - force.force[k]));
    }
    lar_simulation_energy(simulation, &now);
    print_message("radius %g mm, %g mm deep, %g of the stable step: (%.3g %.3g %.3g) N, within "
                  "%.1e N; kinetic %.1e of strain, external grew by %.1e of it\n",
                  1e3 * radius, 1e3 * deep, part, force.force[0], force.force[1], force.force[2],
                  most, now.kinetic / now.strain, (now.external - then.external) / now.strain);
    assert_true(force.force[2] > 0.1 && force.limited == 0);
    assert_below(now.kinetic, 1e-9 * now.strain);
    assert_below(fabs(now.external - then.external), 1e-8 * now.strain);
    assert_below(most, 1e-4 * force.force[2]);
    finish(simulation, model);
}

static void tissue_comes_to_rest(void **unused) {
    (void)unused;
    stand(0.0007, 0.0213, 0.0221, 0.008, 0.8);
    stand(0.001, 0.0213, 0.0221, 0.008, 0.8);
    stand(0.002, 0.0213, 0.0221, 0.008, 0.8);
    stand(0.001, 0.0213, 0.0221, 0.004, 0.8);
    stand(0.002, 0.0224, 0.021, 0.008, 0.8);
    stand(0.002, 0.0213, 0.0221, 0.008, 0.3);
}

/* Two shafts that pinch a cube from both sides in line with its middle push along their line. */
static void a_pinch_is_straight(void **unused) {
    (void)unused;
    static const brick cube = {{6, 6, 6}, 0.01 / 3, 0, LAR_LAW_neo_hookean, 4e3, 2e5, 1050};
    static const double radius = 0.002, middle = 0.01;
    lar_model *model = brick_model(&cube);
    lar_tool tool = {.shape = LAR_TOOL_CAPSULE, .radius = radius, .length = 0.1};
    touch_tool(model, "below", tool, (double[]){middle, middle, -0.0025});
    touch_tool(model, "above", tool, (double[]){middle, middle, 0.0225});
    memcpy(model->tool[0].rest.orientation, (double[]){0, 1, 0, 0}, sizeof upright);
    model->damping = 20;
    lar_simulation *simulation = start(model);
    uint64_t steps = (uint64_t)(0.3 / lar_simulation_time_step(simulation));
    place(simulation, 0, (double[]){middle, middle, middle - 0.006}, (double[]){0, 1, 0, 0}, 1,
          steps);
    place(simulation, 1, (double[]){middle, middle, middle + 0.006}, upright, 1, steps);
    while (lar_simulation_time(simulation) < 1.5) advance(simulation, 100);
    double most = 0, push = 0;
    for (int i = 0; i < 100; i++) {
        advance(simulation, 1);
        for (int t = 0; t < 2; t++) {
            lar_tool_force force;
            lar_error error;
            lar_simulation_tool_force(simulation, t, &force, &error);
            most = fmax(most, hypot(force.force[0], force.force[1]));
            push = fabs(force.force[2]);
        }
    }
    print_message("a pinch of %.3g N, across it %.1e N\n", push, most);
    assert_true(push > 0.1);
    assert_below(most, 1e-6 * push);
    finish(simulation, model);
}

/* A bar along x at some place over a pad that stands on a ground. */
static lar_model *bar_over(brick pad, double E, double nu, const lar_tool *bar,
                           const double at[3]) {
    pad.shear = E / 2 / (1 + nu);
    pad.bulk = E / 3 / (1 - 2 * nu);
    lar_model *model = brick_model(&pad);
    fix_nodes(model, brick_side(&pad, 2, 0), LAR_AXIS_ALL);
    touch_tool(model, "bar", *bar, at);
    memcpy(model->tool[0].rest.orientation, along_x, sizeof along_x);
    return model;
}

/* A bar across a pad of foam stands over the pad's ends, whose faces look along it: they are in the
 * bar although they do not look at it. The same on every grid. */
static uint64_t lie(double nu, double y, const char *grid) {
    static const double E = 2e5, deep = 0.01, radius = 0.015;
    static const brick pad = {{8, 8, 4}, 0.005, 0, LAR_LAW_coupled_neo_hookean, 0, 0, 80};
    const lar_tool bar = {.shape = LAR_TOOL_CAPSULE, .radius = radius, .length = 0.06};
    lar_model *model = bar_over(pad, E, nu, &bar, (double[]){0.05, y, height + radius + 0.0002});
    model->damping = 20;
    lar_options options = lar_options_default();
    options.grid = grid;
    lar_simulation *simulation = start_with(model, options);
    uint64_t steps = (uint64_t)(0.3 / lar_simulation_time_step(simulation));
    place(simulation, 0, (double[]){0.05, y, height + radius - deep}, along_x, 1, steps);
    while (lar_simulation_time(simulation) < 0.5) advance(simulation, 100);
    lar_energy then, now;
    lar_tool_force force;
    lar_error error;
    lar_simulation_energy(simulation, &then);
    while (lar_simulation_time(simulation) < 0.6) advance(simulation, 100);
    lar_simulation_energy(simulation, &now);
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, &error), LAR_OK);
    print_message("a bar on a pad, nu %g, y = %g mm: %.4g N; kinetic %.1e of strain, external grew "
                  "by %.1e of it\n",
                  nu, 1e3 * y, force.force[2], now.kinetic / now.strain,
                  (now.external - then.external) / now.strain);
    assert_true(force.force[2] > 30 && force.limited == 0);
    assert_below(fabs(now.kinetic), 1e-6 * now.strain);
    assert_below(fabs(now.external - then.external), 1e-4 * now.strain);
    uint64_t hash = lar_simulation_hash(simulation);
    finish(simulation, model);
    return hash;
}

static void what_looks_elsewhere_comes_to_rest(void **unused) {
    (void)unused;
    uint64_t hash = lie(0.3, 0.02, NULL);
    assert_true(lie(0.3, 0.02, "2x2x1") == hash);
    lie(0.2, 0.036, NULL); /* along another end as well */
    lie(0, 0.02, NULL);
}

/* A bar that lies along faces is as near to one end of them as to the other, wherever it pushes. */
static void lie_along(double nu, lar_law law, double deep) {
    static const double E = 2e4, radius = 0.008;
    const brick pad = {{5, 7, 3}, 0.01, 0, law, 0, 0, 100};
    const lar_tool bar = {.shape = LAR_TOOL_CAPSULE, .radius = radius, .length = 0.09};
    lar_model *model = bar_over(pad, E, nu, &bar, (double[]){0.07, 0.035, 0.03 + radius + 1e-4});
    model->damping = 380;
    lar_simulation *simulation = start(model);
    uint64_t steps = (uint64_t)(0.2 / lar_simulation_time_step(simulation));
    place(simulation, 0, (double[]){0.07, 0.035, 0.03 + radius - deep}, along_x, 1, steps);
    while (lar_simulation_time(simulation) < 0.5) advance(simulation, 100);
    double fastest = 0, v[3];
    lar_tool_force force;
    lar_error error;
    for (int i = 0; i < 20; i++) {
        advance(simulation, 1);
        const lar_state *state = lar_simulation_state(simulation);
        for (int32_t node = 0; node < 6 * 8 * 4; node++) {
            lar_state_velocity(state, node, v);
            fastest = fmax(fastest, fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2]))));
        }
    }
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, &error), LAR_OK);
    print_message("a bar along faces, nu %g, %g mm deep: %.4g N, %.1e m/s\n", nu, 1e3 * deep,
                  force.force[2], fastest);
    assert_true(force.force[2] > 5 && force.limited == 0);
    assert_below(fastest, 1e-6);
    finish(simulation, model);
}

static void what_lies_along_faces_comes_to_rest(void **unused) {
    (void)unused;
    lie_along(0, LAR_LAW_coupled_neo_hookean, 0.012);
    lie_along(0.35, LAR_LAW_coupled_neo_hookean, 0.011);
    lie_along(0.35, LAR_LAW_coupled_neo_hookean, 0.012);
    lie_along(0.35, LAR_LAW_coupled_neo_hookean, 0.015);
    lie_along(0.45, LAR_LAW_neo_hookean, 0.012);
}

/* Foam, and what is as stiff as a hard plastic: however fast the ball comes, it is pressed with the
 * same force in the end, in every step. */
static void light_and_stiff_bodies_come_to_rest(void **unused) {
    (void)unused;
    static const brick bodies[] = {
        {{8, 8, 4}, 0.005, 0, LAR_LAW_coupled_neo_hookean, 5e4, 1.5e5, 30},
        {{8, 8, 4}, 0.005, 0, LAR_LAW_neo_hookean, 1e8, 2e9, 1000}};
    static const double speeds[] = {0.3, 1, 3}, radius = 0.008;
    for (int b = 0; b < 2; b++) {
        double slow = 0;
        for (int v = 0; v < 3; v++) {
            lar_model *model = brick_model(&bodies[b]);
            fix_nodes(model, brick_side(&bodies[b], 2, 0), LAR_AXIS_ALL);
            touch_tool(model, "ball", (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = radius},
                       (double[]){0.02, 0.02, height + radius + 0.0005});
            model->damping = b == 0 ? 300 : 3e4;
            lar_simulation *simulation = start(model);
            const double to[3] = {0.02, 0.02, height + radius - 0.003};
            double step = lar_simulation_time_step(simulation);
            place(simulation, 0, to, upright, 1, (uint64_t)(0.0035 / speeds[v] / step));
            advance(simulation, (uint64_t)(0.0035 / 0.3 / step) + 8000);
            lar_tool_force force, next;
            advance(simulation, 1);
            assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, NULL), LAR_OK);
            advance(simulation, 1);
            assert_int_equal(lar_simulation_tool_force(simulation, 0, &next, NULL), LAR_OK);
            assert_below(fabs(next.force[2] - force.force[2]), 1e-6 * force.force[2]);
            if (v == 0) slow = force.force[2];
            assert_below(fabs(force.force[2] - slow), 1e-6 * slow);
            finish(simulation, model);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_and_stiff_bodies_come_to_rest),
        cmocka_unit_test(tissue_comes_to_rest),
        cmocka_unit_test(a_pinch_is_straight),
        cmocka_unit_test(what_looks_elsewhere_comes_to_rest),
        cmocka_unit_test(what_lies_along_faces_comes_to_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
