/* A deck may count in any units that go together: what it says does not depend on which. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"
#include "step/stable_step.h"

/* A block that falls on a cushion from a height, at 1 m/s; `length`, `modulus` and `density`: units
 * of the deck in a metre, a pascal and a kilogram per cubic metre. */
static lar_model *falling(double length, double modulus, double density) {
    brick cushion = {{5, 5, 3},     0.01 * length, 0, LAR_LAW_neo_hookean, 1e4 * modulus,
                     3e4 * modulus, 100 * density};
    brick block = {{2, 2, 2},     0.015 * length, 0, LAR_LAW_neo_hookean, 5e4 * modulus,
                   1e5 * modulus, 1000 * density};
    lar_model *model = empty_model(&cushion);
    model->own_units = true;
    add_brick(model, &cushion, (double[]){0, 0, 0});
    lar_material *material = LAR_MODEL_APPEND(model, material);
    *material = model->material[0];
    material->name = lar_strdup("block");
    material->density = block.density;
    lar_material_from_shear_bulk(material, block.shear, block.bulk);
    fix_nodes(model, brick_side(&cushion, 2, 0), LAR_AXIS_ALL);
    const int32_t nodes = model->mesh.node_count, elements = model->mesh.element_count;
    add_brick(model, &block, (double[]){0.012 * length, 0.008 * length, 0.032 * length});
    for (int32_t e = elements; e < model->mesh.element_count; e++) model->element_material[e] = 1;
    throw_nodes(model, nodes, model->mesh.node_count, (double[]){0, 0, -length});
    model->gravity[2] = -9.81 * length;
    touch_between(model, elements);
    return model;
}

static void a_fall_is_one_in_metres_and_in_millimetres(void **unused) {
    (void)unused;
    double deepest[2][2];
    for (int k = 0; k < 2; k++) {
        const double length = k ? 1e3 : 1;
        lar_model *model = falling(length, k ? 1e-6 : 1, k ? 1e-12 : 1);
        lar_simulation *s = start(model);
        const int32_t last = model->mesh.node_count - 1;
        double low = 0, z = 0, (*u)[3] = malloc((size_t)(last + 1) * sizeof *u);
        assert_non_null(u);
        while (lar_simulation_time(s) < 0.05) {
            advance(s, 8);
            lar_simulation_displacements(s, u);
            z = u[last][2] / length;
            low = fmin(low, z);
        }
        deepest[k][0] = low, deepest[k][1] = z;
        free(u);
        finish(s, model);
    }
    print_message("deepest %.9f and %.9f m, at the end %.9f and %.9f m\n", deepest[0][0],
                  deepest[1][0], deepest[0][1], deepest[1][1]);
    assert_true(deepest[0][0] < -0.004);
    assert_below(fabs(deepest[1][0] - deepest[0][0]), 1e-6 * fabs(deepest[0][0]));
    /* What rounding begins contact makes larger. */
    assert_below(fabs(deepest[1][1] - deepest[0][1]), 1e-4 * fabs(deepest[0][0]));
}

/* Units of force go by the stiffest element; they are finer where tissue is beside what is far
 * stiffer, and the same for tissue alone. */
static void metal_has_finer_units(void **unused) {
    (void)unused;
    static const double shear[] = {2e3, 1e5, 2e5, 8e5, 8e10};
    static const int finer[] = {0, 0, 1, 3, 4};
    for (int i = 0; i < 5; i++) {
        const brick gel = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        lar_model *model = empty_model(&gel);
        double scale;
        add_brick(model, &gel, (double[]){0, 0, 0});
        const int32_t elements = model->mesh.element_count;
        lar_material *other = LAR_MODEL_APPEND(model, material);
        *other = model->material[0];
        other->name = NULL;
        lar_material_from_shear_bulk(other, shear[i], 10 * shear[i]);
        add_brick(model, &gel, (double[]){0.1, 0, 0});
        for (int32_t e = elements; e < model->mesh.element_count; e++)
            model->element_material[e] = 1;
        assert_int_equal(lar_force_scale_choose(model, &scale), finer[i]);
        const double units = scale * (10 + 4.0 / 3) * shear[i] * 0.01 * 0.01;
        assert_true(units >= ldexp(1, 45 + finer[i]) && units <= ldexp(1, 46 + finer[i]));
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fall_is_one_in_metres_and_in_millimetres),
        cmocka_unit_test(metal_has_finer_units),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
