/* When a body is at rest: swinging, creeping, moved and free ones, on every grid. */
#include "engine/engine_test.h"
#include "simulation/rest.h"
#include "model/rest.h"

/* A brick held at one end that sinks under gravity; the damping in shares of the critical guess. */
static lar_model *hanging(double share) {
    lar_model *model = brick_model(&soft_brick);
    fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_ALL);
    model->gravity[2] = -9.81;
    model->damping = share * lar_model_rest_damping(model);
    return model;
}

static lar_rest follow(lar_simulation *simulation, uint64_t max) {
    lar_rest rest;
    lar_rest_begin(&rest, simulation);
    while (!lar_rest_look(&rest, simulation) && rest.next <= max)
        advance(simulation, rest.next - lar_simulation_steps(simulation));
    return rest;
}

static void positions(const lar_simulation *simulation, double (*u)[3]) {
    lar_simulation_displacements(simulation, u);
}

/* Largest difference between the displacements now and those after ten times as long. */
static double still_to_go(lar_simulation *simulation, const lar_model *model, double *largest) {
    int32_t nodes = model->mesh.node_count;
    double(*before)[3] = lar_calloc((size_t)nodes, sizeof *before), max = 0;
    double(*after)[3] = lar_calloc((size_t)nodes, sizeof *after);
    positions(simulation, before);
    advance(simulation, 10 * lar_simulation_steps(simulation));
    positions(simulation, after);
    *largest = 0;
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            max = fmax(max, fabs(after[n][i] - before[n][i]));
            *largest = fmax(*largest, fabs(after[n][i]));
        }
    free(before);
    free(after);
    return max;
}

/* From a tenth of the critical damping, where it swings, to twelve times as much, where it creeps:
 * what is left of the way is below 0.02 %. */
static void rest_is_rest_at_any_damping(void **state) {
    (void)state;
    const double shares[] = {0.1, 1, 5, 12};
    for (int i = 0; i < 4; i++) {
        lar_model *model = hanging(shares[i]);
        lar_simulation *simulation = start(model);
        lar_rest rest = follow(simulation, UINT64_MAX / 2);
        uint64_t found = lar_simulation_steps(simulation);
        double largest, left = still_to_go(simulation, model, &largest);
        print_message("damping %g of critical: %d steps, %.2g of the way left\n", shares[i],
                      (int)found, left / largest);
        assert_true(rest.reached && rest.looked && rest.left <= rest.share);
        assert_true(found < rest.limit);
        assert_below(left / largest, 2e-4);
        finish(simulation, model);
    }
}

/* Where it turns round it stands still, and is not at rest. */
static void a_turning_point_is_no_rest(void **state) {
    (void)state;
    lar_model *model = hanging(0);
    lar_simulation *simulation = start(model);
    lar_rest rest = follow(simulation, 20000);
    assert_int_equal(rest.reached, 0);
    assert_true(rest.looked && rest.left > 0.01);
    finish(simulation, model);
}

static void nothing_rests_before_its_loads_are_complete(void **state) {
    (void)state;
    lar_model *model = hanging(1);
    static const double late[3][2] = {{0, 1}, {3, 1}, {3.5, 2}};
    model->gravity_curve[2] = add_table(model, LAR_CURVE_LINEAR, 3, late);
    lar_simulation *simulation = start(model);
    lar_rest rest = follow(simulation, UINT64_MAX / 2);
    assert_true(rest.since == 3.5);
    assert_int_equal(rest.reached, 1);
    assert_true(lar_simulation_time(simulation) > 3.5);
    finish(simulation, model);
}

static void creep_in(lar_model *model, double time) {
    model->material[0].viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share[0] = 4, .time[0] = time};
}

/* A body whose terms are slow has next to no kinetic energy, and most of its way to go. */
static void creeping_material_is_no_rest(void **state) {
    (void)state;
    lar_model *model = hanging(1);
    lar_simulation *simulation = start(model);
    assert_int_equal(follow(simulation, UINT64_MAX / 2).reached, 1);
    const lar_gid end = model->mesh.node_count - 1;
    const double elastic = node_u(simulation, end)[2];
    finish(simulation, model);

    model = hanging(1);
    creep_in(model, 0.05);
    simulation = start(model);
    assert_int_equal(follow(simulation, UINT64_MAX / 2).reached, 1);
    assert_below(fabs(node_u(simulation, end)[2] / elastic - 1), 1e-4);
    finish(simulation, model);

    model = hanging(1);
    creep_in(model, 1e5);
    for (int i = 0; i < 2; i++) {
        lar_options options = lar_options_default();
        options.grid = i ? "2x1x1" : "1x1x1";
        simulation = start_with(model, options);
        lar_rest rest = follow(simulation, 20000);
        assert_true(rest.kinetic < 1e-12 * rest.strain); /* its motion alone would be rest */
        assert_int_equal(rest.reached, 0);
        assert_int_equal(rest.looked, 2);
        assert_true(rest.left > 0.1 && rest.left < 10);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* A free body falls for ever; one that nothing pulls is at rest. */
static void free_bodies(void **state) {
    (void)state;
    lar_model *model = brick_model(&soft_brick);
    model->damping = lar_model_rest_damping(model);
    lar_simulation *simulation = start(model);
    assert_int_equal(follow(simulation, 20000).reached, 1);
    finish(simulation, model);

    model = brick_model(&soft_brick);
    model->damping = lar_model_rest_damping(model);
    model->gravity[0] = 1;
    simulation = start(model);
    lar_rest rest = follow(simulation, 20000);
    assert_int_equal(rest.reached, 0);
    assert_true(rest.limit > 20000 && rest.limit < 100000000);
    finish(simulation, model);
}

/* A brick held at one end whose load returns to nothing, so that it comes back to its own shape. */
static lar_model *pulled_and_let_go(double share) {
    static const double pulse[3][2] = {{0, 0}, {0.1, 1}, {0.2, 0}};
    lar_model *model = hanging(share);
    model->gravity[2] = 0;
    load_nodes(model, brick_side(&soft_brick, 0, 1), 0, 0, 0.0005,
               add_table(model, LAR_CURVE_LINEAR, 3, pulse));
    return model;
}

/* One that is hit: at first it moves, and nothing strains it. */
static lar_model *hit(double share) {
    lar_model *model = hanging(share);
    model->gravity[2] = 0;
    throw_node(model, brick_node(&soft_brick, 3, 1, 1), (double[]){0, 0.05, 0.02});
    return model;
}

static double largest_displacement(const lar_simulation *simulation, const lar_model *model) {
    double max = 0;
    for (int32_t g = 0; g < model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) max = fmax(max, fabs(node_u(simulation, g)[i]));
    return max;
}

/* There is no strain energy at rest that the motion could be compared with: what both have then is
 * rounding. */
static void back_in_its_own_shape(void **state) {
    (void)state;
    static lar_model *(*const made[])(double) = {pulled_and_let_go, hit};
    const double shares[] = {0.1, 1, 5, 12};
    for (int i = 0; i < 8; i++) {
        lar_model *model = made[i / 4](shares[i % 4]);
        lar_simulation *simulation = start(model);
        lar_rest rest = follow(simulation, 100000);
        double far = largest_displacement(simulation, model);
        print_message("damping %g of critical: %d steps, %.2g m from its shape, left %.2g\n",
                      shares[i % 4], (int)lar_simulation_steps(simulation), far, rest.left);
        assert_true(rest.reached && rest.left <= rest.share);
        assert_below(far, 1e-10 * soft_brick.edge);
        finish(simulation, model);
    }
}

/* It goes through its own shape twice in a period, fast. */
static void swinging_through_its_own_shape(void **state) {
    (void)state;
    static lar_model *(*const made[])(double) = {pulled_and_let_go, hit};
    for (int i = 0; i < 2; i++) {
        lar_model *model = made[i](0);
        lar_simulation *simulation = start(model);
        lar_rest rest = follow(simulation, 20000);
        assert_int_equal(rest.reached, 0);
        assert_true(rest.looked && rest.left > 0.01);
        finish(simulation, model);
    }
}

static uint64_t step_of_rest(const lar_model *model, lar_options options, uint64_t *hash) {
    lar_simulation *simulation = start_with(model, options);
    lar_rest rest = follow(simulation, UINT64_MAX / 2);
    assert_int_equal(rest.reached, 1);
    uint64_t step = lar_simulation_steps(simulation);
    *hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return step;
}

/* The energies are compared to the bit too: a step would be the same by luck. */
static void the_same_step_on_every_grid(void **state) {
    (void)state;
    lar_model *model = everything_model(&soft_brick);
    model->damping = lar_model_rest_damping(model);
    lar_options options = lar_options_default();
    uint64_t wanted_hash, hash;
    uint64_t wanted = step_of_rest(model, options, &wanted_hash);
    static const char *const grid[] = {"1x1x1", "2x1x1", "1x2x1", "2x2x1"};
    for (int i = 0; i < 4; i++) {
        options.grid = grid[i];
        options.threads = i % 2 ? 1 : 2;
        assert_true(step_of_rest(model, options, &hash) == wanted);
        assert_true(hash == wanted_hash);
    }
    options = lar_options_default();
    options.isa = LAR_ISA_C;
    assert_true(step_of_rest(model, options, &hash) == wanted && hash == wanted_hash);

    lar_model *back = pulled_and_let_go(1);
    wanted = step_of_rest(back, lar_options_default(), &wanted_hash);
    assert_true(step_of_rest(back, options, &hash) == wanted && hash == wanted_hash);
    options = lar_options_default();
    options.grid = grid[3];
    assert_true(step_of_rest(back, options, &hash) == wanted && hash == wanted_hash);
    lar_model_destroy(back);

    lar_simulation *alone = start(model);
    options = lar_options_default();
    options.grid = grid[3];
    lar_simulation *divided = start_with(model, options);
    for (int i = 0; i < 20; i++) {
        double kinetic[2], strain[2];
        advance(alone, 37);
        advance(divided, 37);
        lar_rest_energies(&alone->domain, lar_simulation_state(alone), &kinetic[0], &strain[0]);
        lar_rest_energies(&divided->domain, lar_simulation_state(divided), &kinetic[1], &strain[1]);
        assert_true(kinetic[0] == kinetic[1] && strain[0] == strain[1] && kinetic[0] > 0);
    }
    lar_simulation_destroy(divided);
    finish(alone, model);
}

/* Twenty times as long as thick, clamped at one end: 3.516 sqrt(EI / m) / L^2. Where a plane of
 * symmetry cuts it, half of it has the same motion. */
static void a_slender_body_is_damped_by_its_bending(void **state) {
    (void)state;
    const double young = 9 * 2e4 * 2e3 / (3 * 2e4 + 2e3);
    const double slowest = 3.516 * sqrt(young / 1000) * 0.01 / sqrt(12) / (0.2 * 0.2);
    for (int half = 0; half < 2; half++) {
        const brick slender = {
            {40, half ? 1 : 2, 2}, 0.005, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        lar_model *model = brick_model(&slender);
        fix_nodes(model, brick_side(&slender, 0, 0), LAR_AXIS_ALL);
        if (half) fix_nodes(model, brick_side(&slender, 1, 0), LAR_AXIS_Y);
        model->gravity[2] = -0.005;
        model->damping = lar_model_rest_damping(model);
        assert_int_equal(lar_model_damp_itself(&model, NULL), LAR_OK);
        assert_true(model->damping == lar_model_rest_damping(model)); /* as somebody said */
        model->damps_itself = true;
        assert_int_equal(lar_model_damp_itself(&model, NULL), LAR_OK);
        assert_below(fabs(model->damping / (1.8 * slowest) - 1), 0.05);
        assert_int_equal(model->notice_count, 1);
        lar_simulation *simulation = start(model);
        assert_int_equal(follow(simulation, 200000).reached, 1);
        assert_below(lar_simulation_time(simulation) * slowest, 25);
        finish(simulation, model);
    }
}

/* What is not held, or can still turn about a node, has no slowest motion to go by. */
static void loose_bodies_are_damped_as_by_their_length(void **state) {
    (void)state;
    for (int pinned = 0; pinned < 2; pinned++) {
        lar_model *model = brick_model(&soft_brick);
        if (pinned) fix_nodes(model, single_node(0), LAR_AXIS_ALL);
        assert_true(lar_rest_damping(model) == lar_model_rest_damping(model));
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_is_rest_at_any_damping),
        cmocka_unit_test(a_turning_point_is_no_rest),
        cmocka_unit_test(nothing_rests_before_its_loads_are_complete),
        cmocka_unit_test(creeping_material_is_no_rest),
        cmocka_unit_test(free_bodies),
        cmocka_unit_test(back_in_its_own_shape),
        cmocka_unit_test(swinging_through_its_own_shape),
        cmocka_unit_test(the_same_step_on_every_grid),
        cmocka_unit_test(a_slender_body_is_damped_by_its_bending),
        cmocka_unit_test(loose_bodies_are_damped_as_by_their_length),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
