/* Homogeneous states against CalculiX and FEBio: a stretched cube and a sheared one. Every element
 * must have them exactly; what is compared is the material law. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "step/measure.h"
#include "validation/reference.h"

static const lar_element_kind kinds[2] = {LAR_ELEMENT_HEX8, LAR_ELEMENT_HEX8_FULL};
static const char *const kind_names[2] = {"hex8", "hex8-full"};

static lar_model *material_model(const char *mesh, int poisson) {
    return reference_model(mesh, 1, poisson == 45 ? 1034.482759 : 1006.711409,
                           poisson == 45 ? 10000 : 50000, 1000);
}

static void sum_reactions(lar_simulation *simulation, lar_node_list nodes, double sum[3]) {
    lar_measure_reaction(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                         &nodes, false, NULL, sum, NULL);
}

/* ---- a cube stretched to 1.5, sides free --------------------------------------------------- */

static void stretch(int poisson, int kind) {
    char name[64], title[64];
    snprintf(name, sizeof name, "a_uniax_inh_nu%d", poisson);
    snprintf(title, sizeof title, "uniaxial stretch, nu 0.%d", poisson);
    lar_model *model = material_model("a_2x2x2", poisson);
    for (int axis = 0; axis < 3; axis++) fix_nodes(model, nodes_at(model, axis, 0), 1u << axis);
    move_nodes_by(model, nodes_at(model, 0, 1), LAR_AXIS_X, 0.5, add_ramp(model, 0, 1, 0, 1));
    model->damping = 6;
    lar_simulation *simulation = start(model, kinds[kind]);
    begin_report();
    run_until(simulation, 1);
    run_to_rest(simulation, 1e-12, 20);

    double force[3], side = 1 + displacement(simulation, node_near(model, 1, 1, 1), 1);
    lar_node_list left = nodes_at(model, 0, 0);
    sum_reactions(simulation, left, force);
    double off_side = report(title, kind_names[kind], "2x2x2", "lateral stretch",
                             reference_value(name, "C3D8", 1, "lateral_stretch"), side, simulation);
    double off_force = report(title, kind_names[kind], "2x2x2", "force [N]",
                              reference_value(name, "C3D8", 1, "Fx"), -force[0], simulation);
    assert_within(off_side, 0.00001);
    assert_within(off_force, 0.0001);
    free(left.node);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void a_stretched_cube_thins_and_pulls_as_elsewhere(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    for (int poisson = 45; poisson <= 49; poisson += 4)
        for (int kind = 0; kind < 2; kind++) stretch(poisson, kind);
}

/* ---- a cube sheared by 60 degrees ------------------------------------------------------------ */

static void move_boundary(lar_model *model, int curve) {
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double *at = model->mesh.position[n];
        bool inside = true;
        for (int i = 0; i < 3; i++) inside = inside && at[i] > 1e-6 && at[i] < 0.1 - 1e-6;
        if (inside) continue;
        for (int moved = 0; moved < 2; moved++) {
            lar_node_list one = {1, lar_calloc(1, sizeof(int32_t))};
            assert_non_null(one.node);
            one.node[0] = n;
            if (moved)
                move_nodes_by(model, one, LAR_AXIS_X, at[2] * sqrt(3.0), curve);
            else
                fix_nodes(model, one, LAR_AXIS_Y | LAR_AXIS_Z);
        }
    }
}

static void shear(int poisson, int kind) {
    char name[64], title[64];
    snprintf(name, sizeof name, "e1_shear_inh_nu%d", poisson);
    snprintf(title, sizeof title, "simple shear 60 deg, nu 0.%d", poisson);
    lar_model *model = material_model("e1_cube_4x4x4", poisson);
    move_boundary(model, add_ramp(model, 0, 1, 0, 1));
    model->damping = 60;
    lar_simulation *simulation = start(model, kinds[kind]);
    begin_report();
    run_until(simulation, 1);
    run_to_rest(simulation, 1e-14, 20);

    int32_t top = node_near(model, 0.05, 0.05, 0.1);
    double force[3], cauchy[6], worst = 0;
    sum_reactions(simulation, (lar_node_list){1, &top}, force);
    lar_measure_stress(&simulation->domain, &simulation->state, 21, cauchy);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++) {
            double exact = i == 0 ? model->mesh.position[n][2] * sqrt(3.0) : 0;
            worst = fmax(worst, fabs(displacement(simulation, n, i) - exact));
        }
    double off_shear =
        report(title, kind_names[kind], "4x4x4", "shear traction [Pa]",
               reference_value(name, "full", 1, "R/A)"), force[0] / (0.025 * 0.025), simulation);
    double off_normal =
        report(title, kind_names[kind], "4x4x4", "szz [Pa]",
               reference_value(name, "full", 1, "szz(center)"), cauchy[2], simulation);
    assert_within(off_shear, 0.0001);
    assert_within(off_normal, 0.0001);
    assert_within(worst / 0.1, 1e-6);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void a_sheared_cube_is_homogeneous_and_pushes_as_elsewhere(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    for (int poisson = 45; poisson <= 49; poisson += 4)
        for (int kind = 0; kind < 2; kind++) shear(poisson, kind);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stretched_cube_thins_and_pulls_as_elsewhere),
        cmocka_unit_test(a_sheared_cube_is_homogeneous_and_pushes_as_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
