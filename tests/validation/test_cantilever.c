/* The cantilever against CalculiX and FEBio: nearly incompressible, gently to extremely bent. The
 * case in which elements lock or hourglass. */
#include "validation/beam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LEVELS = 5 };
static const double level[LEVELS] = {0.001, 0.01, 0.05, 0.1, 1};

static const char *case_name(int poisson, const char *mesh) {
    static char name[64];
    snprintf(name, sizeof name, "c_beam_inh_nu%d_%s", poisson, mesh);
    return name;
}

/* What the tip tends to on ever finer meshes: the geometric series through FEBio's three-field
 * element (mean dilatation, no locking). Three meshes at nu = 0.45; at 0.49, where there are two,
 * with the ratio of 0.45. */
static double converged(int poisson, double t, const char *key) {
    double tip[3];
    for (int m = 0; m < 3; m++)
        tip[m] = reference_value(case_name(45, beam_meshes[m].name), "three-field", t, key);
    double ratio = (tip[2] - tip[1]) / (tip[1] - tip[0]);
    if (poisson == 45) return tip[2] + (tip[2] - tip[1]) * ratio / (1 - ratio);
    for (int m = 0; m < 2; m++)
        tip[m] = reference_value(case_name(49, beam_meshes[m].name), "three-field", t, key);
    return tip[1] + (tip[1] - tip[0]) * ratio / (1 - ratio);
}

/* The larger relative error of the tip's two displacements. */
static double report_level(int poisson, const beam_mesh *mesh, double t, const lar_model *model,
                           const lar_simulation *simulation) {
    char title[64], quantity[32];
    snprintf(title, sizeof title, "beam nu 0.%d", poisson);
    snprintf(quantity, sizeof quantity, "tip uz at %g g [m]", t);
    double down = report(title, "hex8", mesh->name, quantity, converged(poisson, t, "tip_uz"),
                         displacement(simulation, beam_tip(model), 2), simulation);
    if (t < 0.05) return down; /* the tip moves along the beam only when it is bent far */
    snprintf(quantity, sizeof quantity, "tip ux at %g g [m]", t);
    return fmax(down, report(title, "hex8", mesh->name, quantity, converged(poisson, t, "tip_ux"),
                             displacement(simulation, beam_tip(model), 0), simulation));
}

/* One load level on one mesh: from the answer of the coarser mesh, or from the level before. (At 1
 * g the clamped end folds so sharply that interpolation would crush the smallest elements.) */
static void bend(const lar_model *model, const beam_mesh *mesh, int l, lar_simulation *simulation,
                 const beam_mesh *coarse, double (*answer)[3]) {
    double time = lar_simulation_time(simulation);
    if (coarse) {
        double(*guess)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *guess);
        assert_non_null(guess);
        beam_refine(coarse, answer, mesh, guess);
        set_displacements(simulation, guess);
        set_ramp((lar_model *)model, 0, time - 1, 1, 0, level[l]);
        free(guess);
    } else {
        set_ramp((lar_model *)model, 0, time, 1, l ? level[l - 1] : 0, level[l]);
        run_until(simulation, time + 1);
    }
    run_to_rest(simulation, 1e-7, 20);
}

static void bend_all(int poisson) {
    double(*answer[LEVELS])[3] = {0};
    const beam_mesh *coarse = NULL;
    int meshes = test_in_full() ? 3 : 2; /* the finest takes minutes */
    for (int m = 0; m < meshes; m++) {
        const beam_mesh *mesh = &beam_meshes[m];
        lar_model *model = beam_model(mesh, poisson);
        lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8);
        for (int l = 0; l < LEVELS; l++) {
            begin_report();
            bend(model, mesh, l, simulation, l < LEVELS - 1 ? coarse : NULL, answer[l]);
            double error = report_level(poisson, mesh, level[l], model, simulation);
            free(answer[l]);
            answer[l] = lar_calloc((size_t)model->mesh.node_count, sizeof *answer[l]);
            assert_non_null(answer[l]);
            lar_simulation_displacements(simulation, answer[l]);
            if (m == 1) assert_within(error, 0.05);
            if (m == 2) assert_within(error, 0.02);
            if (m >= 1) assert_within(hourglass_share(simulation), 0.05);
        }
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
        coarse = mesh;
    }
    for (int l = 0; l < LEVELS; l++) free(answer[l]);
}

static void hex8_bends_as_the_converged_beam_45(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    bend_all(45);
}

static void hex8_bends_as_the_converged_beam_49(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    bend_all(49);
}

/* hex8-full is FEBio's `full`: the same element, hence the same answer on the same mesh, locking
 * included. On the coarse mesh from rest. */
static void full_is_febios_full(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    for (int poisson = test_in_full() ? 45 : 49; poisson <= 49; poisson += 4) {
        lar_model *model = beam_model(&beam_meshes[0], poisson);
        lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8_FULL);
        for (int l = 0; l < LEVELS; l++) {
            char title[64], quantity[32];
            begin_report();
            bend(model, &beam_meshes[0], l, simulation, NULL, NULL);
            snprintf(title, sizeof title, "beam nu 0.%d", poisson);
            snprintf(quantity, sizeof quantity, "tip uz at %g g [m]", level[l]);
            double difference =
                report(title, "hex8-full", "20x2x2", quantity,
                       reference_value(case_name(poisson, "20x2x2"), "full", level[l], "tip_uz"),
                       displacement(simulation, beam_tip(model), 2), simulation);
            assert_within(difference, 0.005);
        }
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
}

/* The same on the middle mesh, from FEBio's own displacements: it must stay where FEBio is. */
static void full_stays_where_febio_is(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    for (int l = 1; l < LEVELS; l += 3) {
        char file[96], quantity[32];
        lar_model *model = beam_model(&beam_meshes[1], 45);
        lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8_FULL);
        double(*u)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *u);
        assert_non_null(u);
        snprintf(file, sizeof file, "c_beam_inh_nu45_40x4x4_full_t%g.txt", level[l]);
        reference_field(file, 1, model->mesh.node_count, u);
        set_displacements(simulation, u);
        set_ramp(model, 0, -1, 0.5, 0, level[l]);
        begin_report();
        run_to_rest(simulation, 1e-7, 20);
        snprintf(quantity, sizeof quantity, "tip uz at %g g [m]", level[l]);
        double difference =
            report("beam nu 0.45", "hex8-full", "40x4x4", quantity,
                   reference_value(case_name(45, "40x4x4"), "full", level[l], "tip_uz"),
                   displacement(simulation, beam_tip(model), 2), simulation);
        assert_within(difference, 0.005);
        free(u);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hex8_bends_as_the_converged_beam_45),
        cmocka_unit_test(hex8_bends_as_the_converged_beam_49),
        cmocka_unit_test(full_is_febios_full),
        cmocka_unit_test(full_stays_where_febio_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
