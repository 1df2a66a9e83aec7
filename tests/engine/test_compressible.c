/* Compressible tissue that is strained, with all laws and shapes of elements: the automatic step
 * follows it as in a quarter of the step, the account of energy stays closed, and the bits are the
 * same on every grid and from a checkpoint. */
#include "engine/engine_test.h"

static const double OVER = 0.2; /* seconds */

typedef enum strain { CONFINED, PRESSED, PULLED, SHEARED } strain;
static const char *const strain_name[] = {"confined", "pressed", "pulled", "sheared"};

/* A block of cells `flat` times as long as high, or, below 1, as high as long, on three planes. */
static lar_model *block(lar_law law, double poisson, double flat, strain way) {
    const double shear = 1e4, bulk = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson));
    const brick b = {{3, 3, 4}, 0.01, 0, law, shear, bulk, 1000};
    lar_model *model = brick_model(&b);
    for (int32_t n = 0; n < model->mesh.node_count; n++) model->mesh.position[n][2] /= flat;
    const double height = 4 * b.edge / flat;
    int curve = add_ramp(model, OVER);
    if (way == SHEARED) {
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
        fix_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Y | LAR_AXIS_Z);
        move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_X, 0.8 * height, curve);
    } else {
        for (int axis = 0; axis < 3; axis++) fix_nodes(model, brick_side(&b, axis, 0), 1u << axis);
        for (int axis = 0; axis < 2 && way == CONFINED; axis++)
            fix_nodes(model, brick_side(&b, axis, -1), 1u << axis);
        double by = way == PULLED ? 0.5 : way == CONFINED ? -0.4 : -0.3;
        move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, by * height, curve);
    }
    model->damping = 40;
    return model;
}

static void the_step_follows_compressible_tissue(void **unused) {
    (void)unused;
    static const double ratios[] = {0, 0.15, 0.3}, flats[] = {0.5, 1, 1.5, 3};
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 4; k++)
                for (strain way = CONFINED; way <= SHEARED; way++) {
                    lar_model *model = block((lar_law)law, ratios[i], flats[k], way);
                    lar_simulation *s = start(model);
                    lar_energy e = balanced_after(s, 1.2 * OVER);
                    double step = 0.25 * s->domain.time_step;
                    lar_simulation_destroy(s);
                    s = start_with(model, (lar_options){.time_step = step});
                    lar_energy exact = balanced_after(s, 1.2 * OVER);
                    print_message("%s, nu %g, 1 : %g, %s: strain %g J, in a quarter of the step "
                                  "%g\n",
                                  lar_law_name[law], ratios[i], flats[k], strain_name[way],
                                  e.strain, exact.strain);
                    assert_below(fabs(e.strain - exact.strain), 1e-3 * exact.strain);
                    finish(s, model);
                }
}

static void bits_do_not_depend_on_the_division(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "1x2x2", "3x1x1"};
    uint64_t hash = 0;
    for (size_t i = 0; i < sizeof grids / sizeof grids[0]; i++) {
        lar_model *model = block(LAR_LAW_mooney_rivlin, 0.1, 1, CONFINED);
        lar_simulation *s = start_with(model, (lar_options){.grid = grids[i]});
        balanced_after(s, 1.2 * OVER);
        assert_true(s->tools.division.since > 0); /* it was divided */
        if (i == 0) hash = lar_simulation_hash(s);
        assert_true(lar_simulation_hash(s) == hash);
        finish(s, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_step_follows_compressible_tissue),
        cmocka_unit_test(bits_do_not_depend_on_the_division),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
