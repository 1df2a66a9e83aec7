/* Mass scaling: which elements get how much, what that leaves as it is (weight, what is at rest,
 * the balance of energy, the same bits on every grid), what it changes (slow frequencies, by no
 * more than is told), and what is refused. */
#include "engine/body_contact_test.h"
#include "engine/engine_test.h"

#define assert_within(value, wanted, error) assert_below(fabs((value) - (wanted)), error)

/* A bar of 12 x 2 x 2 cells with a layer of flat elements at one place. */
static const brick bar = {{12, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

enum { FLAT = 8 }; /* its layer */

/* The flat layer is so much of a cell, the next so much thicker. */
static void flatten(lar_model *model, const brick *b, double thickness) {
    for (int k = 0; k <= b->cells[2]; k++)
        for (int j = 0; j <= b->cells[1]; j++)
            model->mesh.position[brick_node(b, FLAT + 1, j, k)][0] -= (1 - thickness) * b->edge;
}

static lar_model *flat_bar(double thickness) {
    lar_model *model = brick_model(&bar);
    flatten(model, &bar, thickness);
    model->mass_share = 1;
    return model;
}

static double stable(const lar_model *model) {
    double step;
    lar_gid worst;
    assert_int_equal(lar_stable_step(model, LAR_ELEMENT_HEX8, &step, &worst, NULL), LAR_OK);
    return step;
}

static double mass_of(const lar_domain *domain, bool moves) {
    double sum = 0;
    for (lar_lid n = 0; n < domain->layout.node_padded; n++)
        sum += moves ? domain->mass[n] : lar_domain_weighs(domain, n);
    return sum;
}

static lar_mass_scaling told(lar_model *model) {
    lar_model_info info;
    lar_error error;
    assert_int_equal(lar_model_check(model, &error), LAR_OK);
    if (lar_model_inspect(model, &info, &error)) fail_msg("%s", error.message);
    return info.mass_scaling;
}

/* ---- how much ------------------------------------------------------------------------------- */

static void the_step_is_reached_and_no_more_is_added(void **unused) {
    (void)unused;
    static const lar_element_kind kinds[] = {LAR_ELEMENT_HEX8, LAR_ELEMENT_HEX8_FULL};
    for (int kind = 0; kind < 2; kind++) {
        lar_model *plain = flat_bar(0.5), *scaled = flat_bar(0.5);
        lar_options options = lar_options_default();
        options.element = kinds[kind];
        lar_simulation *a = start_with(plain, options);
        scaled->mass_step = 1.3 * a->domain.stable_step;
        lar_simulation *b = start_with(scaled, options);
        const lar_domain *one = &a->domain, *other = &b->domain;
        assert_within(other->stable_step, scaled->mass_step, 1e-15 * scaled->mass_step * 4);
        assert_within(other->time_step, 0.8 * scaled->mass_step, 1e-15);
        assert_null(one->added);
        double volume = 0.01 * 0.01 * 0.005;
        for (lar_gid e = 0; e < plain->mesh.element_count; e++) {
            bool flat = e % bar.cells[0] == FLAT;
            double factor = other->rate[e].mass / one->rate[e].mass;
            assert_true(flat == (factor > 1));
            if (flat) assert_within(factor, 1.69, 1e-9); /* 1.3^2 */
            if (flat) assert_within(8 * other->rate[e].added, 0.69 * 1000 * volume, 1e-12);
            if (!flat) assert_memory_equal(&other->rate[e], &one->rate[e], sizeof one->rate[e]);
        }
        for (lar_gid n = 0; n < plain->mesh.node_count; n++) {
            int i = n % (bar.cells[0] + 1);
            double before = one->mass[one->layout.local[n]];
            double after = other->mass[other->layout.local[n]];
            if (i == FLAT || i == FLAT + 1)
                assert_true(after > before);
            else
                assert_true(after == before);
        }
        assert_within(mass_of(other, false), mass_of(one, true), 1e-15);
        assert_within(mass_of(other, true) - mass_of(one, true), 4 * 0.69 * 1000 * volume, 1e-14);
        finish(a, plain);
        finish(b, scaled);
    }
}

static void what_is_told_is_what_is(void **unused) {
    (void)unused;
    lar_model *model = flat_bar(0.5);
    double step = stable(model);
    lar_mass_scaling t = told(model);
    assert_true(t.time_step == 0 && t.elements == 0 && t.added == 0 && t.factor == 1);
    assert_true(t.stable_step == step && t.largest_share == 1 && t.slowing == 0);
    model->mass_step = 1.3 * step;
    t = told(model);
    assert_int_equal(t.elements, 4);
    assert_int_equal(t.worst % bar.cells[0], FLAT);
    assert_within(t.factor, 1.69, 1e-9);
    assert_within(t.added, 4 * 0.69 * 0.0005, 1e-12);
    assert_within(t.share, t.added / (48 * 0.001), 1e-9);
    assert_within(t.stable_step, step, 1e-18);
    assert_true(t.slowing > 0.5 * t.share / 2 && t.slowing < 0.2);
    /* The longest step that a share allows takes that share. */
    model->mass_share = 0.08;
    model->mass_step = told(model).possible_step;
    assert_within(told(model).share, 0.08, 1e-5);
    /* Nothing to do. */
    model->mass_step = 0.9 * step;
    t = told(model);
    assert_true(t.elements == 0 && t.share == 0 && stable(model) == step);
    lar_model_destroy(model);
}

static void too_much_is_refused(void **unused) {
    (void)unused;
    lar_model *model = flat_bar(0.5);
    double step = stable(model);
    lar_model_info info;
    lar_error error;
    lar_simulation *simulation;
    lar_options options = lar_options_default();
    model->mass_share = 0.025;
    model->mass_step = 1.3 * step;
    assert_int_equal(lar_model_check(model, &error), LAR_OK);
    assert_int_equal(lar_model_inspect(model, &info, &error), LAR_ERROR_MODEL);
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_ERROR_MODEL);
    static const char *const words[] = {"mass_scaling", "2.87 % more mass",
                                        "largest_share of 2.5 %",
                                        "element 9 alone needs 1.69 times", "time_step can be"};
    for (int i = 0; i < 5; i++)
        if (!strstr(error.message, words[i])) fail_msg("'%s' lacks '%s'", error.message, words[i]);
    /* A step beyond what mass was added for. */
    model->mass_share = 1;
    options.time_step = 1.35 * step;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "above the stable step"));
    model->time_step = 1.25 * step; /* one below is taken */
    lar_simulation *good = start(model);
    assert_true(lar_simulation_time_step(good) == 1.25 * step);
    lar_simulation_destroy(good);
    static const double bad[][2] = {{NAN, 0.05}, {-1e-4, 0.05}, {2, 0.05},       {1e-4, 0},
                                    {1e-4, NAN}, {1e-4, 1.01},  {INFINITY, 0.05}};
    for (int i = 0; i < 7; i++) {
        model->mass_step = bad[i][0];
        model->mass_share = bad[i][1];
        assert_int_equal(lar_model_check(model, &error), LAR_ERROR_MODEL);
    }
    lar_model_destroy(model);
}

/* ---- what stays ----------------------------------------------------------------------------- */

static lar_model *hanging_bar(double scaling) {
    lar_model *model = flat_bar(0.4);
    memcpy(model->gravity, (double[]){1, 0.5, -0.6}, 24);
    fix_nodes(model, brick_side(&bar, 0, 0), LAR_AXIS_ALL);
    model->damping = 8;
    if (scaling > 1) model->mass_step = scaling * stable(model);
    return model;
}

static void what_is_at_rest_is_the_same(void **unused) {
    (void)unused;
    lar_model *model[2] = {hanging_bar(1), hanging_bar(2)};
    lar_simulation *simulation[2];
    double sum[2][3];
    for (int i = 0; i < 2; i++) {
        simulation[i] = start(model[i]);
        advance(simulation[i], (uint64_t)(12 / lar_simulation_time_step(simulation[i])));
        lar_node_list held = brick_side(&bar, 0, 0);
        lar_error error;
        assert_int_equal(
            lar_measure_reaction(&simulation[i]->domain, &simulation[i]->scratch->measure,
                                 &simulation[i]->state, &held, false, NULL, sum[i], &error),
            LAR_OK);
        free(held.node);
        for (int k = 0; k < 3; k++) /* 48 g, whatever moves */
            assert_within(sum[i][k], -0.048 * model[i]->gravity[k], 1e-9);
    }
    double largest = 0, most = 0;
    for (int32_t n = 0; n < model[0]->mesh.node_count; n++)
        for (int k = 0; k < 3; k++) {
            double a = node_u(simulation[0], n)[k], b = node_u(simulation[1], n)[k];
            largest = fmax(largest, fabs(a));
            most = fmax(most, fabs(a - b));
        }
    assert_true(largest > 0.01); /* a real deflection */
    assert_below(most, 1e-10 * largest);
    for (int i = 0; i < 2; i++) finish(simulation[i], model[i]);
}

/* In free fall only the weight pulls, and all mass gets away. */
static void momentum_is_that_of_the_weight(void **unused) {
    (void)unused;
    lar_model *model = flat_bar(0.3);
    memcpy(model->gravity, (double[]){0, 2, -3}, 24);
    model->mass_step = 2.5 * stable(model);
    lar_simulation *simulation = start(model);
    const lar_domain *domain = &simulation->domain;
    advance(simulation, 1000);
    double time = (1000 - 0.5) * lar_simulation_time_step(simulation), momentum[3] = {0};
    for (lar_gid n = 0; n < model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++)
            momentum[i] += domain->mass[domain->layout.local[n]] * node_v(simulation, n)[i];
    double weight = mass_of(domain, false);
    assert_below(1.05 * weight, mass_of(domain, true));
    for (int i = 0; i < 3; i++)
        assert_within(momentum[i], weight * model->gravity[i] * time, 1e-10 * weight);
    finish(simulation, model);
}

static double imbalance(bool varies, bool changes) {
    static const double up_and_down[4][2] = {{0, 0}, {0.1, 1}, {0.2, -0.5}, {0.3, 0.8}};
    lar_model *model = hanging_bar(2);
    lar_options options = lar_options_default();
    int table = add_table(model, LAR_CURVE_SMOOTH, 4, up_and_down);
    for (int i = 0; i < 3 && varies; i++) model->gravity_curve[i] = table;
    move_nodes(model, brick_side(&bar, 0, -1), LAR_AXIS_Y, 0.004, table);
    options.time_step = 5e-5;
    lar_simulation *simulation = start_with(model, options);
    double worst = 0, work = 0;
    while (lar_simulation_time(simulation) < 0.3) {
        lar_energy e;
        lar_error error;
        if (changes && lar_simulation_steps(simulation) == 2000)
            assert_int_equal(lar_simulation_set_gravity(simulation, (double[]){0, 2, 0.5}, &error),
                             LAR_OK);
        if (changes && lar_simulation_steps(simulation) == 3000)
            assert_int_equal(lar_simulation_set_stiffness(simulation, 0, 2, &error), LAR_OK);
        advance(simulation, 10);
        lar_simulation_energy(simulation, &e);
        worst = fmax(worst, fabs(e.kinetic + e.strain + e.hourglass + e.damping - e.external));
        work = fmax(work, fabs(e.external));
    }
    finish(simulation, model);
    return worst / work;
}

static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    for (int i = 0; i < 4; i++) {
        double error = imbalance(i & 1, i & 2);
        print_message("gravity %s, %s: %.2g of the work is missing\n", i & 1 ? "varies" : "stays",
                      i & 2 ? "changed on the way" : "unchanged", error);
        assert_below(error, 1e-4);
    }
}

/* ---- the same bits -------------------------------------------------------------------------- */

static uint64_t hash_on(const lar_model *model, const char *grid, int threads, lar_isa isa) {
    lar_options options = lar_options_default();
    options.grid = grid;
    options.threads = threads;
    options.isa = isa;
    lar_simulation *simulation = start_with(model, options), *clone = NULL;
    lar_error error;
    advance(simulation, 300);
    if (!grid) assert_int_equal(lar_simulation_clone(simulation, &clone, &error), LAR_OK);
    advance(simulation, 300);
    uint64_t hash = lar_simulation_hash(simulation);
    if (clone) advance(clone, 300);
    if (clone) assert_int_equal(lar_simulation_hash(clone), hash);
    lar_simulation_destroy(clone);
    lar_simulation_destroy(simulation);
    return hash;
}

static void grids_threads_and_lanes_agree(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1"};
    brick b = soft_brick;
    b.cells[0] = 12; /* more than any law's element, and the flat layer */
    lar_model *model = everything_model(&b);
    flatten(model, &b, 0.4);
    model->mass_share = 1;
    uint64_t plain = hash_on(model, NULL, 0, LAR_ISA_C);
    model->mass_step = 1.6 * stable(model);
    uint64_t hash = hash_on(model, NULL, 0, LAR_ISA_C);
    assert_true(hash != plain);
    assert_int_equal(hash_on(model, NULL, 0, LAR_ISA_AUTO), hash);
    for (int grid = 0; grid < 3; grid++)
        for (int threads = 1; threads <= 2; threads++)
            assert_int_equal(hash_on(model, grids[grid], threads, LAR_ISA_AUTO), hash);
    lar_model_destroy(model);
}

#define PATH LAR_TEST_BUILD "/mass_scaling.checkpoint"

static void checkpoints_know_it(void **unused) {
    (void)unused;
    lar_model *scaled = hanging_bar(2), *plain = hanging_bar(1);
    lar_error error;
    lar_options options = lar_options_default();
    options.time_step = 1e-4;
    lar_simulation *a = start_with(scaled, options), *b = start_with(scaled, options),
                   *c = start_with(plain, options);
    advance(a, 100);
    assert_int_equal(lar_simulation_save(a, PATH, &error), LAR_OK);
    assert_int_equal(lar_simulation_load(b, PATH, &error), LAR_OK);
    assert_int_equal(lar_simulation_load(c, PATH, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "material"));
    advance(a, 100);
    advance(b, 100);
    assert_int_equal(lar_simulation_hash(a), lar_simulation_hash(b));
    lar_simulation_destroy(b);
    finish(a, scaled);
    finish(c, plain);
}

/* ---- bodies that meet ----------------------------------------------------------------------- */

/* A free brick with a flat layer and a viscous one in it, thrown at one that is so as well. */
static lar_model *collision(bool scaled, bool heavy) {
    static const brick lower = {{10, 4, 2}, 0.01, 0.05, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
    static const brick upper = {{10, 2, 2}, 0.006, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
    lar_model *model = two_bricks(&lower, &upper, 0.001, heavy);
    int32_t first = 11 * 5 * 3;
    flatten(model, &lower, 0.4);
    throw_nodes(model, first, model->mesh.node_count, (double[]){0.1, -0.1, -0.8});
    lar_material *viscous = LAR_MODEL_APPEND(model, material);
    *viscous = model->material[0];
    viscous->viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share = {0.5}, .time = {0.004}};
    for (lar_gid e = 0; e < 40; e++) model->element_material[e] = heavy;
    if (heavy) memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    model->mass_share = 1;
    if (scaled) model->mass_step = 1.8 * stable(model);
    return model;
}

static double add_momentum(const lar_simulation *s, double sum[3]) {
    const lar_domain *domain = &s->domain;
    memset(sum, 0, 3 * sizeof *sum);
    for (lar_gid n = 0; n < domain->model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++)
            sum[i] += domain->mass[domain->layout.local[n]] * node_v(s, n)[i];
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

/* At the longest step that there is: springs of contact see the mass that moves. */
static void bodies_that_meet_keep_momentum_and_gain_nothing(void **unused) {
    (void)unused;
    static const double shares[] = {0.5, 0.8, 0.999};
    for (int share = 0; share < 3; share++) {
        lar_model *model = collision(true, false);
        lar_options options = lar_options_default();
        options.time_step = shares[share] * model->mass_step;
        lar_simulation *s = start_with(model, options);
        lar_energy e;
        lar_contact_info info;
        double before[3], after[3], size = add_momentum(s, before), most = 0;
        lar_simulation_energy(s, &e);
        double had = e.kinetic, touched = 0, missing = 0;
        while (lar_simulation_time(s) < 0.15) {
            advance(s, 5);
            lar_simulation_contact(s, &info);
            touched = fmax(touched, info.touching);
            lar_simulation_energy(s, &e);
            double sum = e.kinetic + e.strain + e.hourglass;
            most = fmax(most, sum);
            missing = fmax(missing, fabs(sum + e.contact + e.damping - had));
        }
        assert_true(touched > 10);
        add_momentum(s, after);
        for (int i = 0; i < 3; i++) assert_within(after[i], before[i], 1e-10 * size);
        print_message("collision at %g of the stable step: %.4f of the energy at most, %.2g of it "
                      "missing in the account\n",
                      shares[share], most / had, missing / had);
        assert_below(most / had, 1.001);
        assert_below(missing / had, 1e-3);
        finish(s, model);
    }
}

static void heavy_viscous_bodies_that_meet_have_the_same_bits(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1"};
    lar_model *model = collision(true, true), *plain = collision(false, true);
    uint64_t hash = hash_on(model, NULL, 0, LAR_ISA_C);
    assert_true(hash != hash_on(plain, NULL, 0, LAR_ISA_C));
    for (int grid = 0; grid < 3; grid++)
        for (int threads = 1; threads <= 2; threads++)
            assert_int_equal(hash_on(model, grids[grid], threads, LAR_ISA_AUTO), hash);
    lar_model_destroy(model);
    lar_model_destroy(plain);
}

/* ---- what becomes slower -------------------------------------------------------------------- */

/* Mean time between the moments at which the middle of the far end passes its place upwards [s]. */
static double period_of(lar_model *model, int periods) {
    int32_t tip = brick_node(&bar, bar.cells[0], 1, 1);
    double length = bar.cells[0] * bar.edge;
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double x = model->mesh.position[n][0] / length;
        throw_node(model, n, (double[]){0, 0, 1e-3 * x * x * (2 - x)});
    }
    fix_nodes(model, brick_side(&bar, 0, 0), LAR_AXIS_ALL);
    lar_options options = lar_options_default();
    options.time_step = 1e-4;
    lar_simulation *simulation = start_with(model, options);
    double before = 0, first = 0, last = 0;
    for (int passed = 0; passed <= periods;) {
        advance(simulation, 1);
        double now = node_u(simulation, tip)[2];
        assert_true(lar_simulation_time(simulation) < 40);
        if (before < 0 && now >= 0) {
            last = lar_simulation_time(simulation) - 1e-4 * now / (now - before);
            if (passed++ == 0) first = last;
        }
        before = now;
    }
    lar_simulation_destroy(simulation);
    return (last - first) / periods;
}

/* A held bar that swings, with flat elements near its end, and with stiff ones there. */
static void slow_motions_are_slowed_by_no_more_than_told(void **unused) {
    (void)unused;
    for (int stiff = test_every(2) - 1; stiff < 2; stiff++) {
        double period[2];
        lar_mass_scaling t = {0};
        for (int i = 0; i < 2; i++) {
            lar_model *model = flat_bar(stiff ? 1 : 0.3);
            lar_material *second = LAR_MODEL_APPEND(model, material);
            *second = model->material[0];
            lar_material_from_shear_bulk(second, 8e3, 8e4);
            for (lar_gid e = 0; e < model->mesh.element_count && stiff; e++)
                model->element_material[e] = e % bar.cells[0] == FLAT;
            if (i) model->mass_step = (stiff ? 1.8 : 2.5) * stable(model);
            period[i] = period_of(model, 8);
            if (i) t = told(model);
            lar_model_destroy(model);
        }
        double slower = 1 - period[0] / period[1];
        print_message("%s layer: %.3g %% more mass, %.2f %% slower (periods of %.4f and %.4f s), "
                      "told up to %.2f %%\n",
                      stiff ? "stiff" : "flat", 100 * t.share, 100 * slower, period[0], period[1],
                      100 * t.slowing);
        assert_true(t.share > 0.05);
        assert_true(slower > 0.5 * t.slowing && slower < t.slowing);
    }
}

/* Where all elements get the same factor, every frequency falls by the same: no more, no less. */
static void a_uniform_body_is_slowed_by_what_is_told(void **unused) {
    (void)unused;
    lar_model *model = flat_bar(1);
    model->mass_step = sqrt(1.5) * stable(model);
    fix_nodes(model, brick_side(&bar, 0, 0), LAR_AXIS_X);
    lar_mass_scaling t = told(model);
    assert_within(t.share, 0.5, 1e-9);
    assert_true(t.slowing >= 1 - 1 / sqrt(1.5));
    assert_within(t.slowing, 1 - 1 / sqrt(1.5), 1e-3);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_step_is_reached_and_no_more_is_added),
        cmocka_unit_test(what_is_told_is_what_is),
        cmocka_unit_test(too_much_is_refused),
        cmocka_unit_test(what_is_at_rest_is_the_same),
        cmocka_unit_test(momentum_is_that_of_the_weight),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(grids_threads_and_lanes_agree),
        cmocka_unit_test(checkpoints_know_it),
        cmocka_unit_test(bodies_that_meet_keep_momentum_and_gain_nothing),
        cmocka_unit_test(heavy_viscous_bodies_that_meet_have_the_same_bits),
        cmocka_unit_test(slow_motions_are_slowed_by_no_more_than_told),
        cmocka_unit_test(a_uniform_body_is_slowed_by_what_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
