/* Friction on planes: a block on a slope starts to slide where Coulomb says and stops where he
 * says, and the energy account closes on the way. */
#include "engine/friction_test.h"

/* On the plane z = 0. */
static lar_model *block_model(double friction, double angle) {
    lar_model *model = brick_model(&block);
    add_plane(model, (double[]){0, 0, 0}, (double[]){0, 0, 1});
    tilt(model, friction, angle);
    return model;
}

static void mean_slide(const lar_simulation *s, double *way, double *speed) {
    mean_slide_of(s, 0, way, speed);
}

static void a_block_starts_to_slide_at_the_angle_of_friction(void **unused) {
    (void)unused;
    const slope plane = {.make = block_model, .first = 0, .settled = 0.6};
    starts_to_slide_at_the_angle_of_friction(&plane);
}

/* Set going down a slope that is not steep enough, with v' = -a - c v, it goes
 * v / c - a / c^2 ln(1 + c v / a); without damping v^2 / 2 a. */
static void stop(double friction, double damping, double within) {
    static const double angle = 0.1, first_speed = 0.3;
    lar_model *model = block_model(friction, angle);
    fall(model, (double[]){first_speed, 0, 0});
    model->damping = damping;
    lar_simulation *s = start(model);
    lar_energy e;
    /* How an account begins in which nodes have a speed from nowhere is another matter. */
    advance(s, 1);
    double first = body_energy(s, &e) + e.damping + e.contact - e.external, highest = 0, way, speed;
    double taken = e.contact, backwards = 0, error = 0;
    double a = weight * (friction * cos(angle) - sin(angle)), v = first_speed, c = damping;
    double wanted = c > 0 ? v / c - a / c / c * log(1 + c * v / a) : v * v / 2 / a;
    while (lar_simulation_time(s) < 0.4) {
        advance(s, 5);
        double now = body_energy(s, &e); /* what the slope has given is in `external` */
        highest = fmax(highest, now - e.external);
        error = fmax(error, fabs(now + e.damping + e.contact - e.external - first) / first);
        backwards = fmax(backwards, taken - e.contact);
        taken = e.contact;
    }
    mean_slide(s, &way, &speed);
    print_message(
        "friction %.1f, damping %3.0f: stops after %.3e m, wanted %.3e m (%+.2f %%), then "
        "%.1e m/s; energy at most %.5f of the start, account %.1e, given back %.1e\n",
        friction, damping, way, wanted, 100 * (way / wanted - 1), speed, highest / first, error,
        backwards / first);
    assert_below(fabs(way / wanted - 1), within);
    assert_below(fabs(speed), 2e-3 * first_speed);
    assert_below(highest, 1.001 * first);
    assert_below(backwards, 1e-9 * first);
    assert_below(error, 2e-3);
    finish(s, model);
}

/* An elastic block trembles when it slides without damping, sticks now and then, and loses less. */
static void a_block_stops_where_it_must(void **unused) {
    (void)unused;
    stop(0.2, 100, 0.001);
    stop(0.4, 100, 0.001);
    stop(0.2, 0, 0.03);
    stop(0.4, 0, 0.03);
}

/* The lowest nodes of a block at rest on a slope stay where they are, but for rounding. */
static void what_sticks_does_not_creep(void **unused) {
    (void)unused;
    lar_model *model = block_model(0.5, 0.3);
    model->damping = 100;
    model->contact[0].through[2] = -1e-5;
    model->gravity_curve[0] = add_ramp(model, 0.2);
    lar_simulation *s = start(model);
    while (lar_simulation_time(s) < 0.5) advance(s, 100);
    double before[35][3];
    for (int32_t n = 0; n < 35; n++) memcpy(before[n], node_u(s, n), sizeof before[n]);
    while (lar_simulation_time(s) < 1) advance(s, 100);
    for (int32_t n = 0; n < 35; n++)
        for (int i = 0; i < 2; i++) assert_below(fabs(node_u(s, n)[i] - before[n][i]), 1e-14);
    finish(s, model);
}

/* Friction takes energy in every step, whatever the step and however it trembles: on one plane, and
 * in the corner of three, where it may bring nodes from one to another. */
static void friction_takes_energy(void **unused) {
    (void)unused;
    static const double shares[] = {0.2, 0.8, 0.999};
    for (int k = 0; k < 6; k++) {
        brick soft = block;
        soft.shear = 4e4;
        soft.bulk = 1e6;
        soft.shift = 0.1;
        lar_model *model = brick_model(&soft);
        for (int i = 0; i < (k < 3 ? 1 : 3); i++) {
            add_plane(model, (double[]){-0.002, -0.002, -0.002},
                      (double[]){i == 1, i == 2, i == 0});
            model->contact[i].friction = 0.4 + 0.3 * i;
        }
        throw_body(model, (double[]){-0.6, -0.4, -0.5}, (double[]){3, -20, 5}, 0.05);
        lar_options options = lar_options_default();
        options.time_step = shares[k % 3] * stable_step_of(model);
        lar_simulation *s = start_with(model, options);
        lar_energy e;
        double first = body_energy(s, &e), highest = 0, error = 0, last = e.contact, given = 0;
        while (lar_simulation_time(s) < 0.03) {
            advance(s, 1);
            double now = body_energy(s, &e);
            highest = fmax(highest, now / first);
            given = fmax(given, (last - e.contact) / first);
            last = e.contact;
            error = fmax(error, fabs(now + e.damping + e.contact - e.external - first) / first);
        }
        print_message("%d planes, %.3f of the stable step: at most %.6f of the energy, ends with "
                      "%.3f, account %.1e, given in a step %.1e\n",
                      model->contact_count, shares[k % 3], highest, body_energy(s, &e) / first,
                      error, given);
        assert_below(highest, 1.001);
        assert_below(given, k < 3 ? 1e-6 : 1e-4);
        assert_below(error, shares[k % 3] < 0.5 ? 2e-3 : 5e-2);
        finish(s, model);
    }
}

/* A tilted plane and nodes that are held along one axis: these stay held, and slow down along the
 * others. */
static void held_axes_stay_held(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&block);
    add_plane(model, (double[]){0, 0, 0}, (double[]){0, 0, 1});
    model->contact[0].friction = 0.4;
    fix_nodes(model, brick_side(&block, 1, 0), LAR_AXIS_Y);
    model->gravity[2] = -weight;
    fall(model, (double[]){0.2, 0, 0});
    lar_simulation *s = start(model);
    double way, speed, wanted = 0.2 * 0.2 / 2 / weight / 0.4;
    while (lar_simulation_time(s) < 0.15) advance(s, 20);
    mean_slide(s, &way, &speed);
    for (int i = 0; i < 7; i++) assert_true(node_u(s, brick_node(&block, i, 0, 0))[1] == 0);
    print_message("held along y: stops after %.3e m, wanted %.3e m\n", way, wanted);
    assert_below(fabs(way / wanted - 1), 0.03);
    finish(s, model);
}

/* ---- the same bits --------------------------------------------------------------------------- */

static const halves run = {150, 300};

/* Irregular, and on its way. */
static lar_model *sliding_model(void) {
    brick b = block;
    b.shift = 0.1;
    b.shear = 2e4;
    lar_model *model = brick_model(&b);
    add_plane(model, (double[]){0, 0, -0.002}, (double[]){0.1, 0, 1});
    add_plane(model, (double[]){0.064, 0, 0}, (double[]){-1, 0.1, 0});
    for (int i = 0; i < 2; i++) model->contact[i].friction = 0.4;
    memcpy(model->gravity, (double[]){1, 0, -9.81}, sizeof model->gravity);
    throw_body(model, (double[]){0.3, 0.1, -0.1}, (double[]){0, 0, 3}, 0.02);
    return model;
}

static void the_same_bits_everywhere(void **unused) {
    (void)unused;
    const char *path = LAR_TEST_BUILD "/friction_plane.lar";
    lar_model *model = sliding_model();
    lar_simulation *s = start(model);
    lar_error error;
    advance(s, run.half_way);
    lar_contact_info info;
    lar_simulation_contact(s, &info);
    assert_true(info.touching > 0);
    if (lar_simulation_save(s, path, &error)) fail_msg("%s", error.message);
    advance(s, run.end - run.half_way);
    uint64_t hash = lar_simulation_hash(s);
    lar_simulation_destroy(s);
    has_the_same_bits(model, path, run, hash);
    model->contact[0].friction = model->contact[1].friction = 0;
    assert_true(hash_of(model, lar_options_default(), NULL, run) != hash);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_starts_to_slide_at_the_angle_of_friction),
        cmocka_unit_test(a_block_stops_where_it_must),
        cmocka_unit_test(what_sticks_does_not_creep),
        cmocka_unit_test(friction_takes_energy),
        cmocka_unit_test(held_axes_stay_held),
        cmocka_unit_test(the_same_bits_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
