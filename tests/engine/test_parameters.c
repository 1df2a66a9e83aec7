/* Parameters of materials that are set while a simulation runs: a body becomes that of a model that
 * had them from the start, every joule is accounted for, what steps cannot bear is refused, and the
 * bits are the same on every grid, in processes, through checkpoints and after going back. */
#include "simulation/checkpoint.h"
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"
#include "engine/changes_test.h"
#include "engine/tools_test.h"

#define PATH LAR_TEST_BUILD "/parameters.checkpoint"

static lar_error failure;

static void set(lar_simulation *simulation, int32_t material, const char *name, double value) {
    if (lar_simulation_set_parameter(simulation, material, name, value, &failure))
        fail_msg("%s", failure.message);
}

/* ---- what they do --------------------------------------------------------------------------- */

/* The parameters of the first material of everything_model, and how they are changed. */
static const char *const name[] = {"shear_modulus", "bulk_modulus"};
static const double part[] = {2.5, 0.6};

/* As a model whose materials have them, but for the rounding of forces. */
static void the_body_is_that_of_a_model_with_them(void **unused) {
    (void)unused;
    for (int kind = 0; kind <= LAR_ELEMENT_HEX8_MATRIX; kind++)
        for (int k = 0; k < 2; k++) {
            double u[2] = {0}, usual = 0;
            brick b = soft_brick;
            for (int changed = 0; changed < 2; changed++) {
                lar_model *model = everything_model(&b);
                int m = 0;
                while (strcmp(lar_law_name[model->material[m].law], "neo-hookean") != 0) m++;
                double value = part[k] * model->material[m].parameter[k];
                usual = model->material[m].parameter[k];
                if (!changed) model->material[m].parameter[k] = value;
                lar_options options = lar_options_default();
                options.element = (lar_element_kind)kind;
                options.time_step = 2e-4;
                lar_simulation *simulation = start_with(model, options);
                if (changed) set(simulation, m, name[k], value);
                assert_true(lar_simulation_parameter(simulation, m, name[k]) == value);
                advance(simulation, 200);
                u[changed] = node_u(simulation, brick_node(&b, 2, 1, 1))[1];
                finish(simulation, model);
            }
            assert_true(fabs(u[0]) > 1e-5 && usual > 0);
            assert_below(fabs(u[1] / u[0] - 1), 1e-7);
        }
}

/* A bar that hangs stretches by its own weight: as the shear modulus says, after the change too. */
static void a_body_settles_as_they_say(void **unused) {
    (void)unused;
    brick b = {{8, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 4e4, 1000};
    double length[2];
    lar_model *model = brick_model(&b);
    model->damping = 30;
    model->gravity[0] = 5;
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    lar_simulation *simulation = start(model);
    for (int i = 0; i < 2; i++) {
        if (i) set(simulation, 0, "shear_modulus", 4e3);
        for (double end = lar_simulation_time(simulation) + 2;
             lar_simulation_time(simulation) < end;)
            advance(simulation, 10);
        length[i] = node_u(simulation, brick_node(&b, 8, 1, 1))[0];
    }
    print_message("%.3f and %.3f mm\n", 1e3 * length[0], 1e3 * length[1]);
    assert_below(fabs(length[0] / length[1] - 2), 0.1);
    finish(simulation, model);
}

/* Stiffness goes on top, in either order; both bounds hold together. */
static void stiffness_goes_on_top(void **unused) {
    (void)unused;
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        lar_model *model = everything_model(&soft_brick);
        lar_simulation *simulation = start(model);
        advance(simulation, 11);
        if (i) set(simulation, 0, "shear_modulus", 3e3);
        assert_int_equal(lar_simulation_set_stiffness(simulation, 0, 1.5, NULL), LAR_OK);
        if (!i) set(simulation, 0, "shear_modulus", 3e3);
        assert_true(lar_simulation_parameter(simulation, 0, "shear_modulus") == 3e3);
        assert_true(lar_simulation_stiffness(simulation, 0) == 1.5);
        advance(simulation, 50);
        hash[i] = lar_simulation_hash(simulation);
        set(simulation, 0, "bulk_modulus",
            2 * lar_simulation_parameter(simulation, 0, "bulk_modulus"));
        assert_int_equal(lar_simulation_set_stiffness(simulation, 0, 3, &failure),
                         LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(failure.message, "together"));
        assert_true(lar_simulation_stiffness(simulation, 0) == 1.5);
        set(simulation, 0, NULL, 0);
        assert_int_equal(lar_simulation_set_stiffness(simulation, 0, 3, NULL), LAR_OK);
        finish(simulation, model);
    }
    assert_int_equal(hash[0], hash[1]);
}

/* ---- steps ---------------------------------------------------------------------------------- */

/* With a step near the limit of the model as it is, up to what may be asked for. */
static void a_faster_body_stays_stable(void **unused) {
    (void)unused;
    static const char *const which[] = {"bulk_modulus", "shear_modulus"};
    for (int k = 0; k < 2; k++) {
        lar_model *model = brick_model(&soft_brick);
        fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_ALL);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 1, 0}, 0.05);
        model->damping = 2;
        lar_simulation *simulation = start_near_limit(model, 0.97);
        lar_energy before, after;
        advance(simulation, 101); /* in the middle of an interval */
        lar_simulation_energy(simulation, &before);
        double value = lar_simulation_parameter(simulation, 0, which[k]);
        while (lar_simulation_set_parameter(simulation, 0, which[k], 1.05 * value, &failure) ==
               LAR_OK)
            value *= 1.05;
        assert_int_equal(failure.status, LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(failure.message, "divided"));
        assert_true(lar_simulation_parameter(simulation, 0, which[k]) == value);
        print_message("%s up to %g Pa\n", which[k], value);
        advance(simulation, 3);
        assert_int_equal(lar_simulation_step_parts(simulation), 2);
        advance(simulation, 2000);
        lar_simulation_energy(simulation, &after);
        assert_below(after.kinetic + after.strain + after.hourglass,
                     30 * (before.kinetic + before.strain + before.hourglass));
        set(simulation, 0, NULL, 0); /* steps stay divided for a second */
        advance(simulation, (uint64_t)(1.01 / lar_simulation_time_step(simulation)));
        assert_int_equal(lar_simulation_step_parts(simulation), 1);
        finish(simulation, model);
    }
}

/* What changes no frequency to speak of divides no step, where that has room. */
static void shear_of_what_keeps_its_volume_is_free(void **unused) {
    (void)unused;
    brick b = soft_brick;
    b.bulk = 200 * b.shear;
    for (int tight = 0; tight < 2; tight++) {
        lar_model *model = brick_model(&b);
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 1, 0}, 0.05);
        lar_simulation *simulation = start_near_limit(model, tight ? 0.999 : 0.8);
        advance(simulation, 50);
        set(simulation, 0, "shear_modulus", 2.5 * b.shear);
        advance(simulation, 1000);
        assert_int_equal(lar_simulation_step_parts(simulation), tight ? 2 : 1);
        finish(simulation, model);
    }
}

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_simulation *simulation = start(model);
    static const double bad[] = {0, -1, 1e12, INFINITY, NAN, 1e307, 1e308};
    const lar_tools before = simulation->tools;
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 7; i++)
            assert_int_equal(lar_simulation_set_parameter(simulation, 0, name[k], bad[i], &failure),
                             LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_set_parameter(simulation, 0, "c1", 1, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "shear_modulus, bulk_modulus"));
    assert_int_equal(lar_simulation_set_parameter(simulation, 0, "fibres.ksi", 1, &failure),
                     LAR_ERROR_ARGUMENT);
    for (int32_t m = -1; m < 2; m += 2) {
        assert_int_equal(lar_simulation_set_parameter(simulation, m, name[0], 1e3, &failure),
                         LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(failure.message, "there is no material"));
    }
    assert_int_equal(lar_simulation_set_parameter(NULL, 0, name[0], 1e3, NULL), LAR_ERROR_ARGUMENT);
    assert_true(isnan(lar_simulation_parameter(simulation, 0, "c1")));
    assert_true(isnan(lar_simulation_parameter(simulation, 1, name[0])));
    assert_true(isnan(lar_simulation_parameter(NULL, 0, name[0])));
    assert_true(isnan(lar_simulation_parameter(simulation, 0, NULL)));
    set(simulation, 0, name[0], lar_simulation_parameter(simulation, 0, name[0]));
    set(simulation, 0, NULL, 0);
    assert_memory_equal(&before, &simulation->tools, sizeof before);
    finish(simulation, model);
}

/* Scenes give Lame's material the two moduli, and so may who sets them: the other one stays, and
 * both together are what a scene with them has, to the last bit. */
static void moduli_of_lames_numbers(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&soft_brick);
    int32_t m = 0;
    lar_material *material = &model->material[m];
    material->law = LAR_LAW_coupled_neo_hookean;
    lar_material_from_shear_bulk(material, 3e3, 3e4);
    material->fibre = (lar_fibre){0};
    if (lar_model_check(model, &failure)) fail_msg("%s", failure.message);
    lar_simulation *simulation = start(model);
    assert_true(lar_simulation_parameter(simulation, m, name[0]) == 3e3);
    assert_below(fabs(lar_simulation_parameter(simulation, m, name[1]) / 3e4 - 1), 1e-15);
    set(simulation, m, name[0], 2e3);
    assert_true(lar_simulation_parameter(simulation, m, "mu") == 2e3);
    assert_below(fabs(lar_simulation_parameter(simulation, m, name[1]) / 3e4 - 1), 1e-15);
    set(simulation, m, name[1], 2e4);
    assert_true(lar_simulation_parameter(simulation, m, name[0]) == 2e3);
    assert_true(lar_simulation_parameter(simulation, m, "lambda") == 2e4 - 2.0 * 2e3 / 3.0);
    for (int k = 0; k < 2; k++)
        assert_int_equal(lar_simulation_set_parameter(simulation, m, name[k], -1, &failure),
                         LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_set_parameter(simulation, m, "c1", 1, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "mu, lambda, shear_modulus, bulk_modulus"));
    finish(simulation, model);
}

/* As many materials as there are places, and one more. */
static void places_are_counted(void **unused) {
    (void)unused;
    brick b = {{LAR_MATERIALS_SET_MAX + 1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    for (int m = 1; m <= LAR_MATERIALS_SET_MAX; m++) {
        lar_material *other = LAR_MODEL_APPEND(model, material);
        *other = model->material[0];
        other->name = lar_strdup("other");
        model->element_material[m] = m;
    }
    lar_simulation *simulation = start(model);
    for (int m = LAR_MATERIALS_SET_MAX; m > 0; m--) set(simulation, m, name[0], 1e3 + m);
    assert_int_equal(lar_simulation_set_parameter(simulation, 0, name[0], 1e3, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "16 materials"));
    set(simulation, 5, NULL, 0);
    set(simulation, 0, name[0], 1e3);
    for (int m = 0; m <= LAR_MATERIALS_SET_MAX; m++)
        assert_true(lar_simulation_parameter(simulation, m, name[0]) == (m == 5   ? 2e3
                                                                         : m == 0 ? 1e3
                                                                                  : 1e3 + m));
    advance(simulation, 10);
    finish(simulation, model);
}

/* The first material has fibres, active ones, and relaxes besides. */
static lar_model *tissue_model(const brick *b) {
    lar_model *model = everything_model(b);
    lar_mesh *mesh = &model->mesh;
    mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    assert_non_null(mesh->fibre);
    for (int32_t e = 0; e < mesh->element_count; e++) mesh->fibre[e][1] = 1;
    model->material[0].fibre = (lar_fibre){
        .law = LAR_FIBRE_EXP_POW, .isochoric = true, .parameter = {800, 1, 2}, .along = 200};
    model->material[0].viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share = {0.6}, .time = {0.05}};
    return model;
}

/* The name of a material's first parameter. */
static const char *first_of(const lar_simulation *simulation, int m) {
    return lar_law_table[simulation->domain.model->material[m].law].parameter[0].name;
}

/* ---- energy --------------------------------------------------------------------------------- */

static void change_often(lar_simulation *simulation, int i) {
    const lar_material *material = simulation->domain.model->material;
    int m = i % 3;
    if (i % 4 == 2)
        set(simulation, m, first_of(simulation, m),
            (i % 8 == 2 ? 1.6 : 0.5) * material[m].parameter[0]);
    if (i % 12 == 9 && material[0].fibre.law != LAR_FIBRE_NONE)
        set(simulation, 0, "fibres.ksi", i % 24 == 9 ? 2e3 : 100);
    if (i % 30 == 7) set(simulation, m, NULL, 0);
}

static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_FULL; kind++)
        for (int grid = 0; grid < 2; grid++) {
            lar_model *model = kind ? everything_model(&soft_brick) : tissue_model(&soft_brick);
            lar_options options = lar_options_default();
            options.element = (lar_element_kind)kind;
            options.time_step = 5e-5;
            options.grid = grid ? "2x1x1" : NULL;
            lar_simulation *simulation = start_with(model, options);
            assert_below(changed_account(simulation, change_often), 3e-4);
            finish(simulation, model);
        }
}

/* ---- the same bits -------------------------------------------------------------------------- */

static const brick larger = {{6, 5, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

/* What is done before the steps of part `i` of a run, at odd steps, in the middle of intervals. */
static void change(lar_simulation *simulation, int i) {
    double bulk = lar_simulation_parameter(simulation, 0, "bulk_modulus");
    if (i == 1) set(simulation, 0, "shear_modulus", 5e3);
    if (i == 2) set(simulation, 0, "bulk_modulus", 3 * bulk);
    if (i == 3) lar_simulation_set_stiffness(simulation, -1, 0.7, NULL);
    if (i == 4) set(simulation, 1, first_of(simulation, 1), 700);
    if (i == 4) set(simulation, 0, "fibres.ksi", 3e3);
    if (i == 5) set(simulation, 0, NULL, 0);
    if (i == 6) set(simulation, 1, NULL, 0);
}

enum { PARTS = 8 };

static lar_model *everything(void) {
    return tissue_model(&larger);
}

static const changed_run changed = {everything, change, PARTS, 13, 1, true, PATH};

static void the_hash_is_the_same_everywhere(void **unused) {
    (void)unused;
    changed_run every = changed;
    every.grid_stride = test_every(2);
    check_changed_everywhere(&every);
}

static void processes_agree(void **unused) {
    (void)unused;
    check_changed_in_processes(&changed);
}

static void set_others(lar_simulation *simulation) {
    set(simulation, 0, "shear_modulus", 1.2e3);
    set(simulation, 2, first_of(simulation, 2), 900);
}

static void a_loaded_run_goes_on_with_them(void **unused) {
    (void)unused;
    check_changed_goes_on(&changed, set_others, NULL);
}

static void clones_and_resets_have_what_they_should(void **unused) {
    (void)unused;
    lar_model *model = everything();
    lar_simulation *simulation = start(model), *clone = NULL;
    advance(simulation, 40);
    uint64_t begin = lar_simulation_hash(simulation);
    run_changed(&changed, simulation, 0, 4);
    assert_int_equal(lar_simulation_clone(simulation, &clone, NULL), LAR_OK);
    assert_true(lar_simulation_parameter(clone, 0, "shear_modulus") == 5e3);
    run_changed(&changed, simulation, 4, PARTS);
    assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
    assert_true(lar_simulation_parameter(simulation, 0, "shear_modulus") ==
                model->material[0].parameter[0]);
    advance(simulation, 40);
    assert_int_equal(lar_simulation_hash(simulation), begin);
    run_changed(&changed, simulation, 0, 4);
    run_changed(&changed, simulation, 4, PARTS);
    run_changed(&changed, clone, 4, PARTS);
    assert_int_equal(lar_simulation_hash(clone), lar_simulation_hash(simulation));
    lar_simulation_destroy(clone);
    finish(simulation, model);
}

/* A file says what is set; one that says what cannot be is refused. */
static void forged_checkpoints_are_refused(void **unused) {
    (void)unused;
    enum { VERSION = 8, ENTRY = 144 + 56 + 1064 + 8 + 24 + 8 };
    lar_model *model = everything_model(&larger);
    lar_simulation *simulation = start(model);
    set(simulation, 1, NULL, 0);
    set(simulation, 0, "shear_modulus", 5e3);
    lar_bytes bytes = {0};
    assert_int_equal(lar_simulation_pack(simulation, "memory", &bytes, NULL), LAR_OK);
    int32_t count, version;
    memcpy(&version, bytes.data + VERSION, 4);
    memcpy(&count, bytes.data + ENTRY, 4);
    assert_int_equal(version, 16);
    assert_int_equal(count, 1);
    static const struct {
        size_t at;
        double value;
    } forged[] = {{16, 5.0}, {16, -1}, {16, NAN}, {24, -5e3}, {24, INFINITY}, {32, 0}};
    for (int i = 0; i < 6; i++) {
        double kept;
        memcpy(&kept, bytes.data + ENTRY + forged[i].at, 8);
        memcpy(bytes.data + ENTRY + forged[i].at, &forged[i].value, 8);
        uint64_t sum = lar_checkpoint_sum(bytes.data, bytes.size / 8 - 1);
        memcpy(bytes.data + bytes.size - 8, &sum, 8);
        assert_int_equal(lar_simulation_unpack(simulation, "memory", &bytes, &failure),
                         LAR_ERROR_FORMAT);
        assert_non_null(strstr(failure.message, "setting that cannot be"));
        memcpy(bytes.data + ENTRY + forged[i].at, &kept, 8);
    }
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

/* A ball on a block, as if the block had been made `made` times as stiff and then set to `set`. */
static lar_tool_force pressed(double made, double set) {
    const brick b = {{6, 6, 3}, 0.01, 0, LAR_LAW_neo_hookean, 2e3 * made, 4e4 * made, 1000};
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
    model->damping = 20;
    touch_tool(model, "ball", (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = 0.01},
               (double[]){0.03, 0.03, 0.045});
    lar_simulation *simulation = start(model);
    double step = lar_simulation_time_step(simulation);
    if (set != 1) assert_int_equal(lar_simulation_set_stiffness(simulation, -1, set, NULL), LAR_OK);
    place(simulation, 0, (double[]){0.03, 0.03, 0.036}, (double[]){1, 0, 0, 0}, 1,
          (uint64_t)(0.2 / step));
    advance(simulation, (uint64_t)(1.5 / step));
    lar_tool_force force;
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, NULL), LAR_OK);
    finish(simulation, model);
    return force;
}

/* Whatever springs tools have: with stiffer tissue that is set they push as tissue that was made so
 * pushes them, and bear as much. */
static void tools_are_as_hard_as_tissue_that_is_set(void **unused) {
    (void)unused;
    static const double times[] = {1.5, 3, 4};
    for (int i = 0; i < 3; i++) {
        const lar_tool_force made = pressed(times[i], 1), set = pressed(1, times[i]);
        print_message("%g times as stiff: %.6g N, set %.6g N; limits %.4g and %.4g N\n", times[i],
                      made.force[2], set.force[2], made.limit, set.limit);
        assert_true(made.force[2] > 0.1);
        assert_below(fabs(set.force[2] / made.force[2] - 1), 1e-3);
        assert_below(fabs(set.depth / made.depth - 1), 0.01);
        assert_below(fabs(set.limit / made.limit - 1), 1e-3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_body_is_that_of_a_model_with_them),
        cmocka_unit_test(a_body_settles_as_they_say),
        cmocka_unit_test(stiffness_goes_on_top),
        cmocka_unit_test(a_faster_body_stays_stable),
        cmocka_unit_test(shear_of_what_keeps_its_volume_is_free),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(moduli_of_lames_numbers),
        cmocka_unit_test(places_are_counted),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(the_hash_is_the_same_everywhere),
        cmocka_unit_test(processes_agree),
        cmocka_unit_test(a_loaded_run_goes_on_with_them),
        cmocka_unit_test(clones_and_resets_have_what_they_should),
        cmocka_unit_test(forged_checkpoints_are_refused),
        cmocka_unit_test(tools_are_as_hard_as_tissue_that_is_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
