/* Cook's membrane against CalculiX and FEBio: bending and shear of a tapered, distorted mesh,
 * almost incompressible (nu = 0.4999). Where elements lock, they lock here. */
#include "validation/cook.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *case_name(bool plane_strain, int cells) {
    static char name[64];
    snprintf(name, sizeof name, "b_cook_%s_%d", plane_strain ? "ps" : "3d", cells);
    return name;
}

static double report_tip(bool plane_strain, int cells, const char *element, double reference,
                         const lar_model *model, const lar_simulation *simulation) {
    char mesh[32];
    snprintf(mesh, sizeof mesh, "%dx%dx1", cells, cells);
    return report(plane_strain ? "Cook, plane strain" : "Cook, 3D", element, mesh, "tip uy [m]",
                  reference, displacement(simulation, cook_tip(model), 1), simulation);
}

static void hex8_reaches_the_converged_membrane(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    int finest = test_in_full() ? 32 : 16; /* the finest takes a minute */
    for (int plane_strain = 1; plane_strain >= 0; plane_strain--)
        for (int cells = 8; cells <= finest; cells *= 2) {
            lar_model *model = cook_model(cells, plane_strain);
            lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8);
            begin_report();
            run_to_rest(simulation, 1e-7, 100 / COOK_DAMPING);
            double converged = plane_strain ? 6.90e-3 : 8.38e-3;
            double error = report_tip(plane_strain, cells, "hex8", converged, model, simulation);
            assert_within(error, cells == 8 ? 0.10 : cells == 16 ? 0.05 : 0.02);
            if (cells >= 16) assert_within(hourglass_share(simulation), 0.05);
            lar_simulation_destroy(simulation);
            lar_model_destroy(model);
        }
}

/* hex8-full is CalculiX's C3D8, locking included. The coarse mesh from rest, the middle one from
 * CalculiX's own displacements, where it must stay. */
static void full_is_c3d8(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    for (int plane_strain = 1; plane_strain >= 0; plane_strain--)
        for (int cells = 8; cells <= 16; cells *= 2) {
            lar_model *model = cook_model(cells, plane_strain);
            lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8_FULL);
            begin_report();
            if (cells == 16) {
                char file[96];
                double(*u)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *u);
                assert_non_null(u);
                snprintf(file, sizeof file, "%s_C3D8_t1.txt", case_name(plane_strain, cells));
                reference_field(file, 1e-3, model->mesh.node_count, u);
                set_displacements(simulation, u);
                set_ramp(model, 0, -1, 0.5, 0, 1);
                free(u);
            }
            run_to_rest(simulation, 1e-7, 100 / COOK_DAMPING);
            double reference =
                1e-3 * reference_value(case_name(plane_strain, cells), "C3D8", 1, "tip_uy");
            double difference =
                report_tip(plane_strain, cells, "hex8-full", reference, model, simulation);
            assert_within(difference, 0.005);
            lar_simulation_destroy(simulation);
            lar_model_destroy(model);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hex8_reaches_the_converged_membrane),
        cmocka_unit_test(full_is_c3d8),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
