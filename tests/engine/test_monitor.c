/* Instabilities are caught: refused before the run, or stopped with a sentence that names element
 * or node, place, time and cause. Never a NaN, whatever one does to a body. */
#include "engine/engine_test.h"

static void assert_says(const lar_error *error, const char *words) {
    if (!strstr(error->message, words))
        fail_msg("\"%s\" does not say \"%s\"", error->message, words);
}

static void assert_finite(const lar_simulation *simulation) {
    const lar_state *state = &simulation->state;
    for (size_t i = 0; i < 3 * state->stride; i++)
        if (!isfinite(state->u[i]) || !isfinite(state->v[i]))
            fail_msg("value %d is u %g, v %g", (int)i, state->u[i], state->v[i]);
}

static void a_step_above_the_bound_is_refused(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_model_info info;
    lar_error error;
    lar_simulation *simulation = NULL;
    assert_int_equal(lar_model_inspect(model, &info, &error), LAR_OK);
    lar_options options = lar_options_default();
    options.time_step = 1.001 * info.stable_step;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_ERROR_MODEL);
    assert_null(simulation);
    assert_says(&error, "above the stable step");
    char element[32];
    snprintf(element, sizeof element, "element %lld",
             (long long)model->mesh.element_id[info.stable_worst]);
    assert_says(&error, element);
    options.time_step = 0.999 * info.stable_step;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    lar_simulation_destroy(simulation);
    for (int i = 0; i < 3; i++) {
        options.time_step = (double[]){NAN, -1e-4, 1e-320}[i];
        assert_int_equal(lar_simulation_create(model, &options, &simulation, &error),
                         LAR_ERROR_ARGUMENT);
        assert_says(&error, "1e-15 s at least");
    }
    lar_model_destroy(model);
}

/* The bound is a bound: at it, a small shake stays small. */
static void the_bound_is_stable(void **unused) {
    (void)unused;
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_FULL; kind++) {
        lar_model *model = brick_model(&soft_brick);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 0, 0}, 1e-4);
        lar_model_info info;
        assert_int_equal(lar_model_inspect(model, &info, NULL), LAR_OK);
        lar_options options = lar_options_default();
        options.element = (lar_element_kind)kind;
        lar_simulation *probe = start_with(model, options);
        options.time_step = 0.999 * probe->domain.stable_step;
        lar_simulation *simulation = start_with(model, options);
        advance(simulation, 3000);
        lar_energy energy;
        lar_simulation_energy(simulation, &energy);
        assert_below(energy.strain + energy.hourglass, 1e-8 * info.mass);
        lar_simulation_destroy(probe);
        finish(simulation, model);
    }
}

/* Advances until it is stopped, and gives the sentence. */
static void run_until_stopped(lar_simulation *simulation, lar_error *error) {
    lar_status status = LAR_OK;
    for (int i = 0; i < 200 && !status; i++) {
        status = lar_simulation_advance(simulation, 50, error);
        assert_finite(simulation);
    }
    assert_int_equal(status, LAR_ERROR_UNSTABLE);
    assert_says(error, "unstable at step");
    assert_says(error, " s): ");
    assert_says(error, " near (");
    uint64_t steps = lar_simulation_steps(simulation);
    assert_int_equal(lar_simulation_advance(simulation, 50, error), LAR_ERROR_UNSTABLE);
    assert_true(lar_simulation_steps(simulation) == steps); /* it stays where it was */
}

static void an_element_turned_inside_out_is_named(void **unused) {
    (void)unused;
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_FULL; kind++) {
        brick b = {{1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        lar_model *model = brick_model(&b);
        model->mesh.element_id[0] = 4711;
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
        move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_ALL & ~LAR_AXIS_X & ~LAR_AXIS_Y, -0.012,
                   add_ramp(model, 0.5));
        fix_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_X | LAR_AXIS_Y);
        lar_options options = lar_options_default();
        options.element = (lar_element_kind)kind;
        lar_simulation *simulation = start_with(model, options);
        lar_error error;
        run_until_stopped(simulation, &error);
        assert_says(&error, "element 4711");
        assert_says(&error, "turned inside out or crushed");
        finish(simulation, model);
    }
}

/* A law that stiffens a hundredfold and more as it is stretched: the step follows. */
static void a_law_that_stiffens_is_followed(void **unused) {
    (void)unused;
    brick b = {{4, 4, 4}, 0.005, 0, LAR_LAW_yeoh, 1e3, 5e3, 1000};
    lar_model *model = brick_model(&b);
    double *p = model->material[0].parameter;
    p[1] = 0;
    p[2] = 5e3;
    model->damping = 30;
    for (int axis = 0; axis < 3; axis++) fix_nodes(model, brick_side(&b, axis, 0), 1U << axis);
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 0.03, add_ramp(model, 0.3));
    lar_simulation *simulation = start(model);
    advance(simulation, (uint64_t)(0.6 / lar_simulation_time_step(simulation)));
    assert_true(lar_simulation_time(simulation) > 0.5);
    finish(simulation, model);
}

/* A cube of 4x4x4 pulled to `stretch` times its length, at the automatic step; damped, so that what
 * would grow is no swing. Returns how much work is not accounted for, as a part of the energy. */
static double pull(lar_law law, const double *p, double stretch) {
    brick b = {{4, 4, 4}, 0.005, 0, law, 1e3, 5e3, 1000};
    lar_model *model = brick_model(&b);
    memcpy(model->material[0].parameter, p, sizeof model->material[0].parameter);
    model->damping = 30;
    for (int axis = 0; axis < 3; axis++) fix_nodes(model, brick_side(&b, axis, 0), 1U << axis);
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 0.02 * (stretch - 1),
               add_ramp(model, 0.3));
    lar_simulation *simulation = start(model);
    advance(simulation, (uint64_t)(0.6 / lar_simulation_time_step(simulation)));
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    double inside = energy.kinetic + energy.strain + energy.hourglass;
    double left = fabs(energy.external - energy.damping - energy.contact - inside) / inside;
    finish(simulation, model);
    return left;
}

/* Laws that stiffen tenfold to a thousandfold and more on the way. */
static void the_step_follows_every_law_that_stiffens(void **unused) {
    (void)unused;
    static const struct {
        lar_law law;
        double stretch, p[LAR_LAW_PARAMETERS];
    } pulls[] = {{LAR_LAW_arruda_boyce, 2.5, {500, 1.5, 5e3}},
                 {LAR_LAW_arruda_boyce, 0.5, {500, 1.5, 5e3}},
                 {LAR_LAW_veronda_westmann, 2.2, {500, 2, 5e3}},
                 {LAR_LAW_veronda_westmann, 1.6, {100, 10, 5e4}},
                 {LAR_LAW_veronda_westmann, 0.5, {500, 2, 5e3}},
                 {LAR_LAW_holmes_mow, 2, {1e3, 1e3, 1}},
                 {LAR_LAW_holmes_mow, 1.5, {1e3, 1e3, 4}},
                 {LAR_LAW_holmes_mow, 0.5, {1e3, 1e3, 1}},
                 {LAR_LAW_ogden, 2.5, {2e3, 9, 0, 0, 0, 0, 5e3}},
                 {LAR_LAW_ogden, 1.6, {2e3, 25, 0, 0, 0, 0, 5e4}},
                 {LAR_LAW_ogden, 0.5, {2e3, 9, 0, 0, 0, 0, 5e3}},
                 {LAR_LAW_ogden, 0.7, {2e3, -9, 0, 0, 0, 0, 5e3}},
                 {LAR_LAW_ogden, 2.5, {1e3, 1.3, 200, 8, -50, -2, 5e4}}};
    double worst = 0;
    for (size_t n = 0; n < sizeof pulls / sizeof *pulls; n++) {
        double left = pull(pulls[n].law, pulls[n].p, pulls[n].stretch);
        print_message("%s to %g: %.1e\n", lar_law_name[pulls[n].law], pulls[n].stretch, left);
        worst = fmax(worst, left);
    }
    assert_below(worst, 1e-3);
}

/* Ogden's law with m = -9 pulls hard where an edge is short: at 0.55 of its height this cube falls
 * in on itself. Barriers and divided steps hold it; what they take up and give back is told in its
 * account, which is wider there. */
static void a_cube_that_falls_in_is_held(void **unused) {
    (void)unused;
    const double p[LAR_LAW_PARAMETERS] = {2e3, -9, 0, 0, 0, 0, 5e3};
    assert_below(pull(LAR_LAW_ogden, p, 0.5), 5e-3);
}

static void a_node_that_is_too_fast_is_named(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    int32_t node = brick_node(&b, 3, 2, 2);
    model->mesh.node_id[node] = 815;
    lar_simulation *simulation = start(model);
    double limit = simulation->domain.leapfrog.speed;
    lar_simulation_destroy(simulation);
    throw_node(model, node, (double[]){0, 1.5 * limit, 0});
    simulation = start(model);
    lar_error error;
    run_until_stopped(simulation, &error);
    assert_says(&error, "node 815");
    assert_says(&error, "elements per time step");
    finish(simulation, model);
}

static void a_support_that_is_too_fast_is_caught(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 1, add_ramp(model, 0.02));
    lar_simulation *simulation = start(model);
    lar_error error;
    run_until_stopped(simulation, &error);
    finish(simulation, model);
}

/* All kinds of violence, at random: either it works or it is stopped; the numbers stay numbers and
 * the energies can be asked for. */
static void violence_never_makes_nan(void **unused) {
    (void)unused;
    int stopped = 0, fine = 0;
    for (uint32_t round = 0; round < 120; round += (uint32_t)test_every(3)) {
        brick b = soft_brick;
        b.law = (lar_law)(round % LAR_LAW_COUNT);
        lar_model *model = brick_model(&b);
        double size = pow(10, 2 * noise(5 * round)); /* 0.01 .. 100 */
        int ramp = add_ramp(model, round % 2 ? 0 : 0.05);
        if (round & 1) fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        if (round & 2) press(model, -1, 2e3 * size * noise(5 * round + 1), ramp);
        if (round & 4)
            move_nodes(model, single_node(brick_node(&b, 3, 1, 1)), LAR_AXIS_ALL,
                       0.01 * size * noise(5 * round + 2), ramp);
        if (round & 8)
            load_nodes(model, brick_side(&b, 2, -1), 0, 0.1 * size * noise(5 * round + 3), 0, ramp);
        if (round & 16) throw_body(model, (double[]){0, 0, 0}, (double[]){0, 0, 0}, size);
        lar_simulation *simulation = start(model);
        for (int i = 0; i < 10; i++) {
            lar_error error;
            lar_status status = lar_simulation_advance(simulation, 50, &error);
            assert_true(status == LAR_OK || status == LAR_ERROR_UNSTABLE);
            assert_finite(simulation);
            if (status == LAR_OK) continue;
            assert_says(&error, "unstable at step");
            stopped++;
            break;
        }
        fine += simulation->fault.kind == LAR_FAULT_NONE;
        finish(simulation, model);
    }
    print_message("violence: %d runs went well, %d were stopped\n", fine, stopped);
    assert_true(fine > 10 / test_every(3) && stopped > 10 / test_every(3));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_above_the_bound_is_refused),
        cmocka_unit_test(the_bound_is_stable),
        cmocka_unit_test(an_element_turned_inside_out_is_named),
        cmocka_unit_test(a_law_that_stiffens_is_followed),
        cmocka_unit_test(the_step_follows_every_law_that_stiffens),
        cmocka_unit_test(a_cube_that_falls_in_is_held),
        cmocka_unit_test(a_node_that_is_too_fast_is_named),
        cmocka_unit_test(a_support_that_is_too_fast_is_caught),
        cmocka_unit_test(violence_never_makes_nan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
