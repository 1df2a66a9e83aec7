/* Activation: by curves, by waves and set while a simulation runs. A block that contracts against
 * the closed form, waves that are where they should be, every joule, and the same bits everywhere.
 */
#include "engine/same_bits_test.h"
#include "mechanics/stress.h"
#include "model/rest.h"
#include "simulation/checkpoint.h"
#include "step/activation.h"

#define PATH LAR_TEST_BUILD "/active.checkpoint"

static void along_x(lar_model *model) {
    lar_mesh *mesh = &model->mesh;
    lar_error error;
    mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    assert_non_null(mesh->fibre);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        mesh->fibre[e][0] = 1;
        mesh->fibre[e][1] = 0.1 * (e % 3);
    }
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
}

static const lar_wave wave = {
    .speed = 0.5, .direction = {1, 0, 0}, .length = 0.03, .every = 0.08, .rest = 0.1};

/* Tools, supports, loads, all laws: one follows a curve, one a wave, one both, one is viscous. */
static lar_model *active_tool_model(const brick *b) {
    static const double beat[4][2] = {{0, 0}, {0.02, 1}, {0.05, 0.2}, {0.09, 1}};
    lar_model *model = tool_model_of(b);
    lar_material *m = model->material;
    int table = add_table(model, LAR_CURVE_SMOOTH, 4, beat);
    m[LAR_LAW_neo_hookean].fibre = (lar_fibre){.law = LAR_FIBRE_EXP_LINEAR,
                                               .parameter = {100, 10, 3000, 1.1},
                                               .isochoric = true,
                                               .along = 600};
    m[LAR_LAW_neo_hookean].activation.curve = table + 1;
    m[LAR_LAW_yeoh].fibre =
        (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {500, 1, 2}, .across = 400};
    m[LAR_LAW_yeoh].activation.wave = wave;
    m[LAR_LAW_ogden].fibre = (lar_fibre){.along = 800};
    m[LAR_LAW_ogden].activation = (lar_activation){.curve = table + 1, .wave = wave};
    m[LAR_LAW_mooney_rivlin].fibre = (lar_fibre){.along = 300, .across = 300};
    m[LAR_LAW_neo_hookean].viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share = {0.6}, .time = {0.05}};
    along_x(model);
    return model;
}

/* ---- the same bits -------------------------------------------------------------------------- */

static same_bits body = {active_tool_model, PATH, {0x297c53cb03983345, 0xe1c37cc104c063bf}};

static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&body);
    lar_model *faster = active_tool_model(&tool_brick);
    lar_error error;
    faster->material[LAR_LAW_yeoh].activation.wave.speed = 0.6;
    lar_simulation *wrong = start_with(faster, setting(NULL, 0));
    assert_int_not_equal(lar_simulation_load(wrong, PATH, &error), LAR_OK);
    assert_non_null(strstr(error.message, "material"));
    finish(wrong, faster);
}

/* ---- what is set ---------------------------------------------------------------------------- */

static void activate(lar_simulation *simulation, int32_t material, double value) {
    lar_error error;
    if (lar_simulation_activate(simulation, material, value, &error)) fail_msg("%s", error.message);
}

/* A muscle that is set to rest, and gravity that is taken away, before the first step: nothing acts
 * on the body, and nothing moves it. Velocities are of half a step before the start. */
static void what_is_set_first_is_what_it_starts_with(void **unused) {
    (void)unused;
    static const char *const grid[] = {"1x1x1", "2x1x1"};
    for (int k = 0; k < 2; k++) {
        const brick b = {{4, 3, 3}, 0.01, 0, LAR_LAW_neo_hookean, 5e3, 5e4, 1000};
        lar_model *model = brick_model(&b);
        model->material[0].fibre = (lar_fibre){.along = 3e4};
        model->gravity[2] = -9.81;
        along_x(model);
        lar_options options = lar_options_default();
        options.grid = grid[k];
        lar_simulation *simulation = start_with(model, options);
        lar_energy e;
        activate(simulation, -1, 0);
        assert_int_equal(lar_simulation_set_gravity(simulation, (double[]){0, 0, 0}, NULL), LAR_OK);
        advance(simulation, 50);
        double v[80][3];
        lar_simulation_velocities(simulation, v);
        for (int32_t n = 0; n < model->mesh.node_count; n++) assert_true(lar_length(v[n]) == 0);
        lar_simulation_energy(simulation, &e);
        assert_true(e.kinetic == 0 && e.external == 0);
        lar_simulation_reset(simulation, NULL);
        activate(simulation, -1, 0);
        assert_int_equal(lar_simulation_set_gravity(simulation, (double[]){0, 0, -5}, NULL),
                         LAR_OK);
        advance(simulation, 1);
        lar_simulation_velocities(simulation, v);
        assert_below(fabs(v[7][2] + 2.5 * lar_simulation_time_step(simulation)), 1e-12);
        finish(simulation, model);
    }
}

/* Another value for something in every tick of about a millisecond. */
static void live(lar_simulation *simulation, int first, int end) {
    for (int i = first; i < end; i++) {
        uint64_t random = (uint64_t)i * 0x9e3779b97f4a7c15ULL >> 40;
        static const int32_t of[4] = {LAR_LAW_neo_hookean, LAR_LAW_yeoh, LAR_LAW_ogden, -1};
        activate(simulation, of[i % 4], i % 5 ? (double)(random % 1000) / 999 : 0);
        act(simulation, i, i + 1);
    }
}

static void live_changes_have_the_same_bits(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "2x2x1", "2x2x3"};
    static const lar_isa isas[] = {LAR_ISA_C, LAR_ISA_AVX2, LAR_ISA_AVX512, LAR_ISA_AUTO};
    lar_model *model = active_tool_model(&tool_brick);
    const lar_kernels *kernels;
    uint64_t expected = 0;
    lar_error error;
    for (int g = 0; g < 5; g++)
        for (int i = 0; i < 4; i++) {
            if (lar_kernels_find(isas[i], &kernels, NULL) || (g > 0 && i < 3)) continue;
            lar_options options = setting(grids[g], g % 3);
            options.isa = isas[i];
            lar_simulation *simulation = start_with(model, options);
            live(simulation, 0, 10);
            assert_int_equal(lar_simulation_save(simulation, PATH, &error), LAR_OK);
            live(simulation, 10, 20);
            if (expected == 0) expected = lar_simulation_hash(simulation);
            is_at(simulation, expected);
            lar_simulation_destroy(simulation);
            simulation = start_with(model, setting(grids[(g + 2) % 5], 1));
            if (lar_simulation_load(simulation, PATH, &error)) fail_msg("%s", error.message);
            live(simulation, 10, 20);
            is_at(simulation, expected);
            lar_simulation_destroy(simulation);
        }
    lar_model_destroy(model);
}

static uint32_t version_of_file(void) {
    lar_bytes bytes;
    uint32_t version;
    assert_int_equal(lar_bytes_read(PATH, &bytes, NULL), LAR_OK);
    memcpy(&version, bytes.data + 8, sizeof version);
    lar_bytes_free(&bytes);
    return version;
}

/* As if nobody had been there: settings of 1 are none. */
static void what_was_set_is_kept_and_forgotten(void **unused) {
    (void)unused;
    lar_model *model = active_tool_model(&tool_brick);
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    lar_error error;
    act(simulation, 0, 1); /* before a tool presses */
    assert_int_equal(lar_simulation_save(simulation, PATH, &error), LAR_OK);
    assert_int_equal(version_of_file(), 6);
    activate(simulation, LAR_LAW_ogden, 0.25);
    assert_true(lar_simulation_activation(simulation, LAR_LAW_ogden) == 0.25);
    assert_true(lar_simulation_activation(simulation, LAR_LAW_yeoh) == 1);
    assert_true(lar_simulation_activation(simulation, -1) == 0);
    assert_int_equal(lar_simulation_save(simulation, PATH, &error), LAR_OK);
    assert_int_equal(version_of_file(), 10);
    assert_int_equal(lar_simulation_set_force(simulation, 3, (const double[]){0.001, 0, 0}, &error),
                     LAR_OK);
    assert_int_equal(lar_simulation_save(simulation, PATH, &error), LAR_OK);
    activate(simulation, -1, 1);
    assert_int_equal(lar_simulation_load(simulation, PATH, &error), LAR_OK);
    assert_true(lar_simulation_activation(simulation, LAR_LAW_ogden) == 0.25);
    assert_int_equal(lar_simulation_reset(simulation, &error), LAR_OK);
    assert_true(lar_simulation_activation(simulation, LAR_LAW_ogden) == 1);
    act(simulation, 0, 8);
    is_at(simulation, body.golden.middle);
    finish(simulation, model);
}

/* Activations of a file behind the other settings: of the first material, and of the last. */
static void forged_files_are_refused(void **unused) {
    (void)unused;
    static const double wrong[4] = {-0.1, 1.5, NAN, INFINITY};
    lar_model *model = active_tool_model(&tool_brick);
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    lar_bytes good, bad;
    lar_error error;
    activate(simulation, -1, 0.5);
    assert_int_equal(lar_simulation_pack(simulation, "memory", &good, &error), LAR_OK);
    for (int i = 0; i < 8; i++) {
        bad = (lar_bytes){lar_calloc(good.size, 1), good.size};
        memcpy(bad.data, good.data, good.size);
        memcpy(bad.data + 752 + (i % 2 ? 63 * 8 : 0), &wrong[i / 2], 8);
        uint64_t sum = lar_checkpoint_sum(bad.data, bad.size / 8 - 1);
        memcpy(bad.data + bad.size - 8, &sum, 8);
        assert_int_equal(lar_simulation_unpack(simulation, "memory", &bad, &error),
                         LAR_ERROR_FORMAT);
        assert_non_null(strstr(error.message, "a setting that cannot be so"));
        lar_bytes_free(&bad);
    }
    assert_int_equal(lar_simulation_unpack(simulation, "memory", &good, &error), LAR_OK);
    lar_bytes_free(&good);
    finish(simulation, model);
}

static void expect_bad(lar_simulation *simulation, int32_t material, double value,
                       const char *words) {
    lar_error error;
    assert_int_equal(lar_simulation_activate(simulation, material, value, &error),
                     LAR_ERROR_ARGUMENT);
    if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void what_cannot_be_set_is_refused(void **unused) {
    (void)unused;
    lar_model *model = active_tool_model(&tool_brick), *still = brick_model(&soft_brick);
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    uint64_t before = lar_simulation_hash(simulation);
    expect_bad(simulation, 999, 0.5, "there is no material 999");
    expect_bad(simulation, -2, 0.5, "there is no material -2");
    expect_bad(simulation, LAR_LAW_yeoh, NAN, "an activation of nan");
    expect_bad(simulation, LAR_LAW_yeoh, -0.1, "from 0, nothing is active, to 1");
    expect_bad(simulation, LAR_LAW_yeoh, 1.001, "from 0");
    expect_bad(simulation, LAR_LAW_veronda_westmann, 0.5, "this material has no active stress");
    expect_bad(NULL, 0, 0.5, "");
    is_at(simulation, before);
    assert_true(lar_simulation_activation(simulation, LAR_LAW_yeoh) == 1);
    finish(simulation, model);
    simulation = start(still);
    expect_bad(simulation, -1, 0.5, "no material has any active stress");
    finish(simulation, still);
}

/* ---- closed forms --------------------------------------------------------------------------- */

/* A cube whose sides are free, contracting along x: law and active stress have no stress together.
 * By a curve, by a value that is set, and by both. */
static void a_block_contracts_as_far_as_it_should(void **unused) {
    (void)unused;
    static const double share[3] = {0.8, 0.5, 0.4};
    static const double rise[2][2] = {{0, 0}, {0.1, 0.8}};
    for (int how = 0; how < 3; how++) {
        const brick b = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 1e3, 2e4, 1000};
        lar_model *model = brick_model(&b);
        lar_material *m = &model->material[0];
        m->fibre.along = 1500;
        if (how != 1) m->activation.curve = 1 + add_table(model, LAR_CURVE_SMOOTH, 2, rise);
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_X);
        fix_nodes(model, brick_side(&b, 1, 0), LAR_AXIS_Y);
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_Z);
        model->mesh.fibre = lar_calloc(8, sizeof *model->mesh.fibre);
        for (int e = 0; e < 8; e++) model->mesh.fibre[e][0] = 3;
        model->damping = 100;
        lar_error error;
        if (lar_model_check(model, &error)) fail_msg("%s", error.message);
        lar_simulation *simulation = start(model);
        if (how > 0) activate(simulation, 0, 0.5);
        while (lar_simulation_time(simulation) < 0.8) advance(simulation, 100);
        lar_material at = *m;
        at.fibre.along *= share[how];
        double L = 0.8, t = 1.1, P[3][3], h = 1e-6;
        const double a[3] = {1, 0, 0};
        for (int i = 0; i < 400; i++) { /* one after the other: no stress along, none across */
            double F[3][3] = {{L - h, 0, 0}, {0, t, 0}, {0, 0, t}}, below;
            lar_material_stress(&at, a, (const double(*)[3])F, P);
            below = P[0][0];
            F[0][0] = L + h;
            lar_material_stress(&at, a, (const double(*)[3])F, P);
            L -= 0.5 * (P[0][0] + below) / (P[0][0] - below) * 2 * h;
            F[0][0] = L;
            F[1][1] = F[2][2] = t - h;
            lar_material_stress(&at, a, (const double(*)[3])F, P);
            below = P[1][1];
            F[1][1] = F[2][2] = t + h;
            lar_material_stress(&at, a, (const double(*)[3])F, P);
            t -= 0.5 * (P[1][1] + below) / (P[1][1] - below) * 2 * h;
        }
        lar_lid end = simulation->domain.layout.local[brick_node(&b, 2, 2, 2)];
        double now = 1 + lar_simulation_state(simulation)->u[end] / 0.02;
        print_message("activation %g: %.6f of its length, %.6f by the formula\n", share[how], now,
                      L);
        assert_below(fabs(now - L), 1e-5);
        finish(simulation, model);
    }
}

/* A pulse enters at time 0, is at its highest half its length later, and leaves; another follows.
 */
static void waves_are_where_they_should_be(void **unused) {
    (void)unused;
    const brick b = {{40, 1, 1}, 0.001, 0, LAR_LAW_neo_hookean, 1e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    lar_wave *w = &model->material[0].activation.wave;
    model->material[0].fibre.along = 100;
    *w = (lar_wave){.speed = 0.1, .direction = {1, 0, 0}, .length = 0.01, .rest = 0.25};
    along_x(model);
    assert_below(fabs(w->start - 0.0005), 1e-12);
    assert_below(fabs(w->span - 0.039), 1e-12);
    assert_below(fabs(lar_model_loads_end(model) - 0.49), 1e-9);
    lar_simulation *simulation = start(model);
    const lar_domain *domain = &simulation->domain;
    for (int e = 0; e < 40; e += 13) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        double comes = ((corner[0][0] + corner[6][0]) / 2 - w->start) / w->speed;
        assert_true(lar_activation_at(domain, e, comes - 1e-9) == 0.25);
        assert_below(fabs(lar_activation_at(domain, e, comes + 0.05) - 1), 1e-12);
        for (int i = 0; i <= 20; i++) {
            double phase = i / 20.0, wanted = sin(M_PI * phase) * sin(M_PI * phase);
            double found = lar_activation_at(domain, e, comes + 0.1 * phase);
            assert_below(fabs(found - (0.25 + 0.75 * wanted)), 1e-12);
        }
        assert_true(lar_activation_at(domain, e, comes + 0.1 + 1e-9) == 0.25);
        assert_true(lar_activation_at(domain, e, comes + 7) == 0.25);
    }
    w->every = 0.3;
    assert_below(fabs(lar_activation_at(domain, 5, 3.14) - lar_activation_at(domain, 5, 0.14)),
                 1e-9);
    assert_true(lar_activation_at(domain, 5, 0) == 0.25); /* none before time 0 */
    finish(simulation, model);
}

/* ---- energy --------------------------------------------------------------------------------- */

/* 0 curve, 1 wave, 2 what is set at random every millisecond, 3 all of them; from 4 on on two
 * processors, and stiffer so that steps are divided. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    static const double beat[4][2] = {{0, 0}, {0.1, 1}, {0.2, 0.1}, {0.3, 1}};
    for (int how = 0; how < 8; how++) {
        lar_model *model = brick_model(&soft_brick);
        lar_material *m = &model->material[0];
        m->fibre = (lar_fibre){.along = 1500, .across = how % 2 ? 400 : 0};
        if (how % 4 == 0 || how % 4 == 3)
            m->activation.curve = 1 + add_table(model, LAR_CURVE_SMOOTH, 4, beat);
        if (how % 4 == 1 || how % 4 == 3) m->activation.wave = wave;
        fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_ALL);
        along_x(model);
        model->damping = 2;
        lar_options options = lar_options_default();
        options.time_step = 1e-4;
        options.grid = how < 4 ? NULL : "2x1x1";
        lar_simulation *simulation = start_with(model, options);
        lar_energy first, e;
        lar_error error;
        if (how >= 4) lar_simulation_set_stiffness(simulation, 0, 2.5, &error);
        if (how % 4 == 2) activate(simulation, 0, 0);
        lar_simulation_energy(simulation, &first);
        double worst = 0, largest = 0;
        for (int n = 0; n < 400; n++) {
            advance(simulation, 10);
            if (how % 4 >= 2) activate(simulation, 0, (n * 7919 % 100) / 99.0);
            lar_simulation_energy(simulation, &e);
            largest = fmax(largest, fmax(e.kinetic + fabs(e.strain), fabs(e.external)));
            worst = fmax(worst, fabs(sum_of(&e) - e.external - sum_of(&first) + first.external));
        }
        print_message("active %d: open by %.2g of %.2g J\n", how, worst, largest);
        assert_below(worst, (how % 4 < 2 ? 1e-4 : 2e-3) * largest);
        finish(simulation, model);
    }
}

/* Fields see what is active now. */
static void stress_follows_activation(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_error error;
    model->material[0].fibre.along = 1500;
    along_x(model);
    size_t nodes = (size_t)model->mesh.node_count;
    double(*u)[3] = lar_calloc(nodes, sizeof *u), full, none, half, cauchy[6];
    lar_simulation *simulation = start(model);
    lar_simulation_element_value(simulation, LAR_FIELD_VON_MISES, 0, (const double(*)[3])u, &full,
                                 &error);
    activate(simulation, 0, 0.5);
    lar_simulation_element_value(simulation, LAR_FIELD_VON_MISES, 0, (const double(*)[3])u, &half,
                                 &error);
    lar_measure_stress(&simulation->domain, &simulation->state, 0, cauchy);
    activate(simulation, 0, 0);
    lar_simulation_element_value(simulation, LAR_FIELD_VON_MISES, 0, (const double(*)[3])u, &none,
                                 &error);
    assert_below(fabs(full - 1500), 1e-6);
    assert_below(fabs(half - 750), 1e-6);
    assert_below(fabs(cauchy[0] - 750), 1e-6);
    assert_below(none, 1e-9);
    free(u);
    finish(simulation, model);
}

/* ---- what cannot be ------------------------------------------------------------------------- */

static void what_cannot_be_is_refused(void **unused) {
    (void)unused;
    static const double large[2][2] = {{0, 0}, {0.1, 1.2}}, negative[2][2] = {{0, 0}, {0.1, -0.1}};
    for (int i = 0; i < 4; i++) {
        lar_model *model = brick_model(&soft_brick);
        lar_activation *a = &model->material[0].activation;
        lar_error error;
        model->material[0].fibre = (lar_fibre){.along = 100, .across = 100, .line = 7};
        a->curve = i == 3 ? 5 : 1 + add_table(model, LAR_CURVE_LINEAR, 2, i ? negative : large);
        if (i == 2) {
            a->curve = 0;
            a->wave = wave;
            model->until_rest = true;
        }
        assert_int_not_equal(lar_model_check(model, &error), LAR_OK);
        assert_non_null(strstr(error.message, ":7: the active stress"));
        assert_non_null(strstr(error.message, i == 3   ? "does not exist"
                                              : i == 2 ? "never rests"
                                                       : "below 0 or above 1"));
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SAME_BITS_TESTS(body),
        cmocka_unit_test(a_saved_run_goes_on),
        cmocka_unit_test(live_changes_have_the_same_bits),
        cmocka_unit_test(what_is_set_first_is_what_it_starts_with),
        cmocka_unit_test(what_was_set_is_kept_and_forgotten),
        cmocka_unit_test(forged_files_are_refused),
        cmocka_unit_test(what_cannot_be_set_is_refused),
        cmocka_unit_test(a_block_contracts_as_far_as_it_should),
        cmocka_unit_test(waves_are_where_they_should_be),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(stress_follows_activation),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
