/* Flat elements that are pressed flatter, with all laws: the automatic step follows them, the
 * account of energy stays closed, and the bits are the same on every grid. */
#include "engine/engine_test.h"

static const double SHUT = -0.45; /* of the height, over */
static const double OVER = 0.2;   /* seconds */

/* A plate of cells `flat` times as long as high, or, below 1, as high as long, that slides on three
 * planes and is pressed together. */
static lar_model *plate(lar_law law, double flat) {
    const brick b = {{4, 4, 3}, 0.01, 0, law, 1e4, 5e5, 1000};
    lar_model *model = brick_model(&b);
    for (int32_t n = 0; n < model->mesh.node_count; n++) model->mesh.position[n][2] /= flat;
    for (int axis = 0; axis < 3; axis++) fix_nodes(model, brick_side(&b, axis, 0), 1u << axis);
    double height = 3 * b.edge / flat;
    move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, SHUT * height, add_ramp(model, OVER));
    model->damping = 40;
    return model;
}

static void the_step_follows_flat_elements(void **unused) {
    (void)unused;
    static const double flats[] = {0.25, 1.5, 2, 3};
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (size_t i = 0; i < sizeof flats / sizeof flats[0]; i++) {
            lar_model *model = plate((lar_law)law, flats[i]);
            lar_simulation *s = start(model);
            lar_energy e = balanced_after(s, 1.2 * OVER);
            double step = 0.25 * s->domain.time_step;
            lar_simulation_destroy(s);
            s = start_with(model, (lar_options){.time_step = step});
            lar_energy exact = balanced_after(s, 1.2 * OVER);
            print_message("%s, 1 : %g: strain %g J, in a quarter of the step %g\n",
                          lar_law_name[law], flats[i], e.strain, exact.strain);
            assert_below(fabs(e.strain - exact.strain), 1e-3 * exact.strain);
            assert_below(e.contact, 1e-4 * e.external);
            finish(s, model);
        }
}

/* Held on all sides, tissue that may change its volume stiffens as its volume shrinks, before its
 * areas say so. As elements become flat no larger strain is needed to be looked at. */
static void the_step_follows_volumes(void **unused) {
    (void)unused;
    static const double flats[] = {1, 2.5, 4, 10};
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (size_t i = 0; i < sizeof flats / sizeof flats[0]; i++) {
            const brick b = {{3, 3, 4}, 0.01, 0, (lar_law)law, 1e4, 1e5, 1000};
            if (law == LAR_LAW_holmes_mow)
                continue; /* with such moduli no material that is stable */
            lar_model *model = brick_model(&b);
            for (int32_t n = 0; n < model->mesh.node_count; n++)
                model->mesh.position[n][2] /= flats[i];
            for (int axis = 0; axis < 3; axis++)
                fix_nodes(model, brick_side(&b, axis, 0), 1u << axis);
            for (int axis = 0; axis < 2; axis++)
                fix_nodes(model, brick_side(&b, axis, -1), 1u << axis);
            double height = 4 * b.edge / flats[i];
            move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, -0.4 * height,
                       add_ramp(model, OVER));
            model->damping = 40;
            lar_simulation *s = start(model);
            lar_energy e = balanced_after(s, 1.2 * OVER);
            assert_below(e.contact, 1e-9 * e.external);
            assert_below(e.hourglass, 1e-9 * e.external); /* all alike */
            finish(s, model);
        }
}

static void bits_do_not_depend_on_the_division(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "1x2x2", "4x1x1"};
    uint64_t hash = 0;
    for (size_t i = 0; i < sizeof grids / sizeof grids[0]; i++) {
        lar_model *model = plate(LAR_LAW_neo_hookean, 4);
        lar_simulation *s = start_with(model, (lar_options){.grid = grids[i]});
        balanced_after(s, 1.2 * OVER);
        assert_true(s->tools.division.since > 0); /* it was divided */
        if (i == 0) hash = lar_simulation_hash(s);
        assert_true(lar_simulation_hash(s) == hash);
        finish(s, model);
    }
}

/* Neighbours that are slower take a part of what an element would do alone. */
static void neighbours_share(void **unused) {
    (void)unused;
    const brick b = {{5, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 1e4, 1e5, 1000};
    lar_model *model = brick_model(&b);
    for (int32_t n = 0; n < model->mesh.node_count; n++) /* the third one is flat */
        if (model->mesh.position[n][0] > 0.025) model->mesh.position[n][0] -= 0.007;
    lar_simulation *s = start(model);
    const lar_element_rate *rate = s->domain.rate;
    for (int e = 0; e < 5; e++) assert_true(e == 2 ? rate[e].share < 1 : rate[e].share == 1);
    assert_true(rate[2].share * rate[2].square > rate[1].square);
    finish(s, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_step_follows_flat_elements),
        cmocka_unit_test(the_step_follows_volumes),
        cmocka_unit_test(bits_do_not_depend_on_the_division),
        cmocka_unit_test(neighbours_share),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
