/* Friction between bodies: a block on a slab of tissue starts to slide where Coulomb says and stops
 * where he says; momentum and moments are kept, and energy never rises. */
#include "engine/body_contact_test.h"
#include "engine/fleet_test.h"
#include "engine/friction_test.h"

static const brick slab = {{12, 6, 2}, 0.0125, 0, LAR_LAW_neo_hookean, 1e5, 4e5, 1000};

/* The block's first node. */
static int32_t first_of(const lar_model *model) {
    (void)model;
    return (slab.cells[0] + 1) * (slab.cells[1] + 1) * (slab.cells[2] + 1);
}

/* A block above a slab, which stands on its fixed lowest nodes; gravity is turned instead. */
static lar_model *block_model(double friction, double angle) {
    lar_model *model = two_bricks(&slab, &block, 1e-4, true);
    tilt(model, friction, angle);
    return model;
}

static void mean_slide(const lar_simulation *s, double *way, double *speed) {
    mean_slide_of(s, first_of(s->domain.model), way, speed);
}

static void a_block_starts_to_slide_at_the_angle_of_friction(void **unused) {
    (void)unused;
    const slope tissue = {.make = block_model, .first = first_of(NULL), .settled = 0.7};
    starts_to_slide_at_the_angle_of_friction(&tissue);
}

/* The block is set going on a level slab; damping keeps both from trembling. With v' = -a - c v it
 * goes v / c - a / c^2 ln(1 + c v / a). */
static void a_block_stops_where_it_must(void **unused) {
    (void)unused;
    static const double frictions[] = {0.2, 0.4}, c = 20, speed = 0.25;
    for (int i = 0; i < 2; i++) {
        lar_model *model = block_model(frictions[i], 0);
        model->damping = c;
        lar_simulation *s = start(model);
        while (lar_simulation_time(s) < 0.3) advance(s, 100);
        double before, way, v, a = weight * frictions[i];
        mean_slide(s, &before, &v);
        for (int32_t n = first_of(model); n < model->mesh.node_count; n++)
            s->state.v[node_at(s, n, 0)] += speed;
        while (lar_simulation_time(s) < 0.6) advance(s, 100);
        mean_slide(s, &way, &v);
        double wanted = speed / c - a / c / c * log(1 + c * speed / a);
        print_message(
            "friction %.1f: stops after %.3e m, wanted %.3e m (%+.2f %%), then %.1e m/s\n",
            frictions[i], way - before, wanted, 100 * ((way - before) / wanted - 1), v);
        assert_below(fabs((way - before) / wanted - 1), 0.02);
        assert_below(fabs(v), 1e-3 * speed);
        finish(s, model);
    }
}

/* Nodes of a block at rest on a steep slab stay where they are, and so does what they remember. */
static void what_sticks_does_not_creep(void **unused) {
    (void)unused;
    lar_model *model = block_model(0.5, 0.3);
    model->damping = 100;
    model->gravity_curve[0] = add_ramp(model, 0.2);
    lar_simulation *s = start(model);
    double way, later, speed;
    while (lar_simulation_time(s) < 0.7) advance(s, 100);
    mean_slide(s, &way, &speed);
    while (lar_simulation_time(s) < 1.2) advance(s, 100);
    mean_slide(s, &later, &speed);
    print_message("sticks: %.1e m in 0.5 s, %.1e m/s\n", later - way, speed);
    assert_below(fabs(later - way), 1e-12);
    finish(s, model);
}

/* ---- what is kept ---------------------------------------------------------------------------- */

static void motion_of(const lar_simulation *s, double momentum[3], double moment[3],
                      double *friction) {
    for (int i = 0; i < 3; i++) momentum[i] = moment[i] = 0;
    *friction = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++) {
        double m = s->domain.mass[s->domain.layout.local[n]], x[3];
        const double *v = node_v(s, n), *u = node_u(s, n);
        for (int i = 0; i < 3; i++) x[i] = s->domain.model->mesh.position[n][i] + u[i];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            momentum[i] += m * v[i];
            moment[i] += m * (x[j] * v[k] - x[k] * v[j]);
            *friction += m * fabs(v[i]);
        }
    }
}

/* Two soft bricks that fly free are thrown on each other aslant. */
static lar_model *flying_model(double friction, double height) {
    brick lower = slab, upper = block;
    lower.shift = upper.shift = 0.1;
    lower.shear = upper.shear = 2e4;
    lar_model *model = two_bricks(&lower, &upper, height, false);
    model->contact[0].friction = friction;
    throw_nodes(model, first_of(model), model->mesh.node_count, (double[]){0.8, 0.3, -0.6});
    return model;
}

/* A soft pad on a firmer one of the same outline, pressed: it widens more, so that corners of both
 * are past the ends of the other's surface, each beside two of its faces that are as close. */
static lar_model *pads_of_one_outline(void) {
    const brick firm = {{6, 6, 3}, 0.01, 0, LAR_LAW_coupled_neo_hookean, 4.545e5, 4.167e5, 150};
    const brick soft = {{6, 6, 3}, 0.01, 0, LAR_LAW_coupled_neo_hookean, 4.545e4, 4.167e4, 150};
    lar_model *model = empty_model(&firm);
    add_brick(model, &firm, (double[]){-0.03, -0.03, 0});
    const int32_t split = model->mesh.element_count, layer = 7 * 7;
    const int32_t first = add_brick(model, &soft, (double[]){-0.03, -0.03, 0.03});
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double *z = &model->mesh.position[n][2];
        *z = n < first ? *z / 1.5 : 0.02 + (*z - 0.03) / 3;
    }
    lar_material *second = LAR_MODEL_APPEND(model, material);
    second->law = soft.law;
    second->density = soft.density;
    lar_material_from_shear_bulk(second, soft.shear, soft.bulk);
    for (int32_t e = split; e < model->mesh.element_count; e++) model->element_material[e] = 1;
    touch_between(model, split);
    model->contact[0].friction = 0.5;
    fix_nodes(model, brick_side(&firm, 2, 0), LAR_AXIS_ALL);
    const int ramp = add_ramp(model, 0.05);
    for (int32_t n = model->mesh.node_count - layer; n < model->mesh.node_count; n++) {
        const double *x = model->mesh.position[n];
        const double share = (fabs(x[0]) > 0.029 ? 0.5 : 1) * (fabs(x[1]) > 0.029 ? 0.5 : 1);
        lar_node_list one = {1, lar_calloc(1, sizeof(int32_t))};
        one.node[0] = n;
        load_nodes(model, one, 0, 0, -0.5 * share, ramp);
    }
    model->damping = 100;
    model->until_rest = true; /* with the step for that */
    return model;
}

static void pads_of_one_outline_come_to_rest(void **unused) {
    (void)unused;
    lar_model *model = pads_of_one_outline();
    lar_simulation *s = start(model);
    lar_energy e;
    while (lar_simulation_time(s) < 0.4) advance(s, 200);
    lar_simulation_energy(s, &e);
    print_message("pads: kinetic over strain energy %.1e\n", e.kinetic / e.strain);
    assert_below(1e-4, e.strain);
    assert_below(fabs(e.kinetic), 1e-10 * e.strain);
    finish(s, model);
}

static void momentum_and_moments_are_kept(void **unused) {
    (void)unused;
    double rubbed[2];
    for (int rough = 0; rough < 2; rough++) {
        lar_model *model = flying_model(rough ? 0.6 : 0, 3e-3);
        lar_simulation *s = start(model);
        double p[3], l[3], p0[3], l0[3], size, drift = 0, turn = 0;
        motion_of(s, p0, l0, &size);
        while (lar_simulation_time(s) < 0.03) advance(s, 20);
        motion_of(s, p, l, &size);
        for (int i = 0; i < 3; i++) {
            drift = fmax(drift, fabs(p[i] - p0[i]) / size);
            turn = fmax(turn, fabs(l[i] - l0[i]) / (0.06 * size));
        }
        mean_slide(s, &rubbed[rough], &size);
        print_message("friction %.1f: momentum %.1e, moment of momentum %.1e; %.3f m/s\n",
                      rough ? 0.6 : 0, drift, turn, size);
        rubbed[rough] = size;
        assert_below(drift, 1e-11);
        assert_below(turn, 1e-10);
        finish(s, model);
    }
    assert_below(rubbed[1], 0.8 * rubbed[0]);
}

static void energy_never_rises(void **unused) {
    (void)unused;
    static const double shares[] = {0.2, 0.8, 0.999}, frictions[] = {0.2, 0.6, 2};
    for (int k = 0; k < 9; k++) {
        lar_model *model = flying_model(frictions[k / 3], 3e-3);
        lar_options options = lar_options_default();
        options.time_step = shares[k % 3] * stable_step_of(model);
        lar_simulation *s = start_with(model, options);
        lar_energy e;
        double first = body_energy(s, &e), highest = 0, error = 0, lowest = 0;
        while (lar_simulation_time(s) < 0.05) {
            advance(s, 1);
            double now = body_energy(s, &e);
            highest = fmax(highest, now / first);
            lowest = fmin(lowest, e.contact / first);
            error = fmax(error, fabs(now + e.damping + e.contact - e.external - first) / first);
        }
        print_message("friction %.1f, %.3f of the stable step: at most %.6f of the energy, ends "
                      "with %.3f, account %.1e, contact at least %.1e\n",
                      frictions[k / 3], shares[k % 3], highest, body_energy(s, &e) / first, error,
                      lowest);
        assert_below(highest, 1.001);
        assert_below(-lowest, 1e-6);
        assert_below(error, shares[k % 3] < 0.5 ? 2e-3 : 5e-2);
        finish(s, model);
    }
}

/* ---- the same bits --------------------------------------------------------------------------- */

static const halves run = {24, 60};

static void the_same_bits_everywhere(void **unused) {
    (void)unused;
    const char *path = LAR_TEST_BUILD "/friction_body.lar";
    lar_model *model = flying_model(0.4, 3e-3);
    lar_simulation *s = start(model);
    lar_saved *saved;
    lar_error error;
    advance(s, run.half_way);
    lar_contact_info info;
    lar_simulation_contact(s, &info);
    assert_true(info.touching > 0);
    if (lar_simulation_save(s, path, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_saved_create(s, &saved, &error), LAR_OK);
    assert_int_equal(lar_simulation_save_to(s, saved, &error), LAR_OK);
    advance(s, run.end - run.half_way);
    uint64_t hash = lar_simulation_hash(s);
    if (lar_simulation_load_from(s, saved, &error)) fail_msg("%s", error.message);
    advance(s, run.end - run.half_way);
    assert_true(lar_simulation_hash(s) == hash);
    lar_saved_destroy(saved);
    lar_simulation_destroy(s);
    has_the_same_bits(model, path, run, hash);
    lar_options always = lar_options_default();
    always.search_always = true;
    assert_true(hash_of(model, always, NULL, run) == hash);
    model->contact[0].friction = 0;
    assert_true(hash_of(model, lar_options_default(), NULL, run) != hash);
    lar_model_destroy(model);
}

static void processes_tell_each_other_what_sticks(void **unused) {
    (void)unused;
    const char *path = LAR_TEST_BUILD "/friction_body_processes.lar";
    lar_model *model = flying_model(0.4, 3e-3);
    uint64_t hash = hash_of(model, lar_options_default(), NULL, run);
    lar_options options = lar_options_default();
    lar_error error;
    options.grid = "2x2x1";
    options.comm = "shm";
    fleet f;
    start_fleet(&f, model, options, 4, NULL);
    advance(f.zero, run.half_way);
    if (lar_simulation_save(f.zero, path, &error)) fail_msg("%s", error.message);
    advance(f.zero, run.end - run.half_way);
    assert_true(lar_simulation_hash(f.zero) == hash);
    if (lar_simulation_load(f.zero, path, &error)) fail_msg("%s", error.message);
    advance(f.zero, run.end - run.half_way);
    assert_true(lar_simulation_hash(f.zero) == hash);
    end_fleet(&f);
    assert_true(hash_of(model, lar_options_default(), path, run) == hash);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_starts_to_slide_at_the_angle_of_friction),
        cmocka_unit_test(a_block_stops_where_it_must),
        cmocka_unit_test(what_sticks_does_not_creep),
        cmocka_unit_test(pads_of_one_outline_come_to_rest),
        cmocka_unit_test(momentum_and_moments_are_kept),
        cmocka_unit_test(energy_never_rises),
        cmocka_unit_test(the_same_bits_everywhere),
        cmocka_unit_test(processes_tell_each_other_what_sticks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
