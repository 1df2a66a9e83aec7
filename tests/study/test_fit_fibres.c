/* Fits of parameters of fibres: bars pulled along and across them, what presses tells nothing of
 * them, the strength of a muscle; and tissue files with fibres. */
#include "fit_twin.h"

#include "study/inverse/output.h"
#include "study/inverse/parameters.h"

#define FACE(point, normal) "{ plane: { point: [" point "], normal: [" normal "] } }"
#define BAR(by)                                                                                    \
    "fix: [ { nodes: " FACE("0, 0, 0", "0, 0, 1") ", axes: z }, { nodes: " FACE(                   \
        "0, 0, 0",                                                                                 \
        "1, 0, 0") ", axes: x }, { nodes: " FACE("0, 0, 0",                                        \
                                                 "0, 1, 0") ", axes: y } ]\n"                      \
                                                            "move: [ { nodes: " FACE(              \
                                                                "0, 0, 0.02",                      \
                                                                "0, 0, 1") ", axes: z, by: " by    \
                                                                           ", over: 1 } ]\n"
#define MATRIX "law: neo-hookean, density: 1050, shear_modulus: 1.5e3, bulk_modulus: 4.0e4"
#define FIBROUS(axis)                                                                              \
    MATRIX ", fibres: { law: exp-pow, part: isochoric, ksi: 1.0e3, alpha: 5, beta: 2, "            \
           "direction: { axis: [" axis "] } }"

enum { ROWS = 6 };
static const double SIZE[3] = {0.01, 0.01, 0.02};
static const double WAY[ROWS] = {0.0005, 0.001, 0.002, 0.003, 0.004, 0.005};

static void write_table(const char *data, const double *force) {
    char text[TWIN_TEXT] = "displacement,force\n";
    for (int i = 0; i < ROWS; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%.9g,%.12g\n", WAY[i], force ? force[i] : 1);
    }
    twin_write(data, text);
}

/* A bar of one element, for the strain is the same everywhere, and what it would measure. */
static void write_bar(const char *name, const char *material, const char *by, const char *kind,
                      const char *freed, const double *truth) {
    char scene[64], data[64], fit[64];
    double force[ROWS];
    snprintf(scene, sizeof scene, "fibres_%s.yaml", name);
    snprintf(data, sizeof data, "fibres_%s.csv", name);
    snprintf(fit, sizeof fit, "fibres_%s_fit.yaml", name);
    twin_block("fibres.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_scene(scene, "fibres.vtk", material, by);
    write_table(data, NULL);
    write_fit(fit, freed, kind, scene, data, "");
    twin_measure(fit, truth, force);
    write_table(data, force);
}

static void near(const lar_inverse_result *r, int j, double truth) {
    assert_true(r->estimate[j].told);
    assert_below(fabs(r->estimate[j].value / truth - 1), 0.01);
}

/* Along the fibres both carry, across them the matrix alone: together they tell three numbers. */
static void bars_along_and_across_tell_both(void **state) {
    (void)state;
    static const char FREED[] = FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5")
        FREE("fibres.ksi", "1.0e3", "1.0e1", "1.0e5") FREE("fibres.alpha", "4", "0.5", "60");
    const double truth[3] = {2.1e3, 700, 12};
    char text[TWIN_TEXT];
    lar_inverse_result r;
    write_bar("along", FIBROUS("0, 0, 1"), BAR("1"), "tension", FREED, truth);
    write_bar("across", FIBROUS("1, 0, 0"), BAR("1"), "tension", FREED, truth);
    snprintf(text, sizeof text,
             "lariat-fit: 1\nparameters:\n%s\nexperiments:\n"
             "  - { kind: tension, scene: %s, data: %s }\n"
             "  - { kind: tension, scene: %s, data: %s }\n",
             FREED, twin_path("fibres_along.yaml"), twin_path("fibres_along.csv"),
             twin_path("fibres_across.yaml"), twin_path("fibres_across.csv"));
    twin_write("fibres_both_fit.yaml", text);
    twin_fit("fibres_both_fit.yaml", &r);
    print_message("fibres: %.6g, %.6g, %.6g, %d runs, %.3g s\n", r.estimate[0].value,
                  r.estimate[1].value, r.estimate[2].value, r.runs, r.seconds);
    for (int j = 0; j < 3; j++) near(&r, j, truth[j]);
    lar_inverse_result_clear(&r);
}

/* Fibres carry tension only: who presses along them learns nothing of them, and is told so. */
static void pressing_tells_nothing_of_them(void **state) {
    (void)state;
    static const char FREED[] = FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5")
        FREE("fibres.ksi", "1.0e3", "1.0e1", "1.0e5");
    const double truth[2] = {2.1e3, 700};
    lar_inverse_result r;
    write_bar("pressed", FIBROUS("0, 0, 1"), BAR("-1"), "compression", FREED, truth);
    twin_fit("fibres_pressed_fit.yaml", &r);
    near(&r, 0, truth[0]);
    assert_false(r.estimate[1].told);
    lar_inverse_result_clear(&r);
}

/* A muscle that is held: how hard it pulls. */
static void the_strength_of_a_muscle_is_fitted(void **state) {
    (void)state;
    static const char FREED[] = FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5")
        FREE("fibres.along", "3.0e3", "1.0e2", "1.0e5");
    const double truth[2] = {2.1e3, 5.5e3};
    lar_inverse_result r;
    write_bar("muscle",
              MATRIX ", fibres: { direction: { axis: [0, 0, 1] }, active: { along: 2.0e3 } }",
              BAR("1"), "tension", FREED, truth);
    twin_fit("fibres_muscle_fit.yaml", &r);
    for (int j = 0; j < 2; j++) near(&r, j, truth[j]);
    lar_inverse_result_clear(&r);
}

static void unknown_names_are_answered_with_those_there(void **state) {
    (void)state;
    lar_inverse_problem problem = {0};
    lar_error error = {0};
    const double truth[1] = {700};
    write_bar("named", FIBROUS("0, 0, 1"), BAR("1"), "tension",
              FREE("fibres.ksi", "1.0e3", "1.0e1", "1.0e5"), truth);
    write_fit("fibres_named_fit.yaml", FREE("fibres.c3", "1.0e3", "1.0e1", "1.0e5"), "tension",
              "fibres_named.yaml", "fibres_named.csv", "");
    assert_int_not_equal(
        lar_inverse_problem_read(twin_path("fibres_named_fit.yaml"), &problem, &error), LAR_OK);
    assert_non_null(strstr(error.message, "fibres.ksi, fibres.alpha, fibres.beta"));
    lar_inverse_problem_clear(&problem);
    lar_material m = {.fibre = {.law = LAR_FIBRE_EXP_POW, .along = 1}};
    assert_string_equal(lar_inverse_unit(&m, "fibres.ksi"), "Pa");
    assert_string_equal(lar_inverse_unit(&m, "fibres.alpha"), "");
    assert_string_equal(lar_inverse_unit(&m, "fibres.along"), "Pa");
}

/* ---- tissue files ---------------------------------------------------------------------------- */

static lar_status open_with(const char *entry, lar_model **model, lar_error *error) {
    char text[TWIN_TEXT];
    snprintf(text, sizeof text,
             "lariat: 1\nmesh: %s\nmaterials: [ { cells: all, tissue: %s%s } ]\n",
             twin_path("fibres.vtk"), twin_path("fibres.tissue.yaml"), entry);
    twin_write("fibres_to.yaml", text);
    *model = NULL;
    return lar_model_open(twin_path("fibres_to.yaml"), model, error);
}

static void refused(const char *entry, const char *sentence) {
    lar_model *model;
    lar_error error = {0};
    assert_int_not_equal(open_with(entry, &model, &error), LAR_OK);
    if (!strstr(error.message, sentence)) fail_msg("%s", error.message);
}

static void write_tissue(const char *fibres) {
    char text[TWIN_TEXT];
    snprintf(text, sizeof text,
             "lariat-tissue: 1\nlaw: yeoh\ndensity: 1000\nshear_modulus: 1e3\nbulk_modulus: 1e5\n"
             "fibres: { %s }\n",
             fibres);
    twin_write("fibres.tissue.yaml", text);
}

/* Written by a fit, taken by a scene, which says along what they run. */
static void tissue_files_have_fibres(void **state) {
    (void)state;
    static const char MUSCLE[] =
        MATRIX ", fibres: { law: pow-linear, part: whole, E: 2.0e4, lam0: 1.1, beta: 2.5, "
               "direction: { axis: [0, 0, 1] }, active: { along: 2.0e3 } }";
    const double truth[1] = {3e4};
    lar_inverse_problem problem;
    lar_error error = {0};
    lar_model *model;
    write_bar("tissue", MUSCLE, BAR("1"), "tension", FREE("fibres.E", "1.0e4", "1.0e3", "1.0e5"),
              truth);
    twin_read("fibres_tissue_fit.yaml", &problem);
    lar_inverse_result r = {
        .estimate = {{.value = 3.5e4, .low = 3.4e4, .high = 3.6e4, .told = true}}};
    if (lar_inverse_write_tissue(twin_path("fibres.tissue.yaml"), &problem, &r, "gel", &error))
        fail_msg("%s", error.message);
    lar_inverse_problem_clear(&problem);
    if (open_with(", fibres: { direction: { axis: [1, 0, 0] }, active: { over: 0.5 } }", &model,
                  &error))
        fail_msg("%s", error.message);
    const lar_fibre *f = &model->material[0].fibre;
    assert_true(f->law == LAR_FIBRE_POW_LINEAR && !f->isochoric && f->along == 2e3);
    assert_true(f->parameter[0] == 3.5e4 && f->parameter[1] == 1.1 && f->parameter[2] == 2.5);
    assert_true(lar_model_fibre(model, 0)[0] == 1 && model->material[0].activation.curve > 0);
    lar_model_destroy(model);
    refused("", "say along what they run");
    refused(", fibres: { law: exp-pow, direction: { axis: [1, 0, 0] } }", "law");
    refused(", fibres: { active: { along: 1 } }", "direction");
}

static void tissue_files_know_no_directions(void **state) {
    (void)state;
    twin_block("fibres.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_tissue("law: exp-pow, part: whole, ksi: 1e3, alpha: 1, beta: 2, "
                 "direction: { axis: [1, 0, 0] }");
    refused("", "say it in the scene, beside tissue");
    write_tissue("active: { along: 1e3, over: 1 }");
    refused("", "over");
    write_tissue("law: exp-pow, part: whole, ksi: 1e3, alpha: 1, beta: 1");
    refused(", fibres: { direction: { axis: [1, 0, 0] } }", "beta must be between 2 and 20");
    write_tissue("");
    refused(", fibres: { direction: { axis: [1, 0, 0] } }", "law");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unknown_names_are_answered_with_those_there),
        cmocka_unit_test(bars_along_and_across_tell_both),
        cmocka_unit_test(pressing_tells_nothing_of_them),
        cmocka_unit_test(the_strength_of_a_muscle_is_fitted),
        cmocka_unit_test(tissue_files_have_fibres),
        cmocka_unit_test(tissue_files_know_no_directions)};
    return cmocka_run_group_tests(tests, twin_needs_cminpack, NULL);
}
