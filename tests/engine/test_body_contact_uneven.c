/* A heavy, stiff block on a thin, light layer, side over side: what its nodes and the points of its
 * edges add to the layer's nodes is no more than these bear, so both come to rest. */
#include "engine/body_contact_test.h"

static void fix_all(lar_model *model, unsigned axes) {
    lar_node_list all = {model->mesh.node_count, lar_calloc((size_t)model->mesh.node_count, 4)};
    for (int32_t n = 0; n < all.count; n++) all.node[n] = n;
    fix_nodes(model, all, axes);
}

static lar_node_list shifted(lar_node_list nodes, int32_t by) {
    for (int32_t i = 0; i < nodes.count; i++) nodes.node[i] += by;
    return nodes;
}

/* `times` as many elements along an edge of the block as along one of the layer. */
static lar_model *block_on_layer(int times, double flat) {
    const double edge = 0.01;
    const brick
        layer = {{4, 4, 4}, edge, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000},
        block = {{4 * times, 4 * times, 2}, edge / times, 0, LAR_LAW_neo_hookean, 2e6, 2e7, 5000};
    lar_model *model = empty_model(&layer);
    lar_material *stiff = LAR_MODEL_APPEND(model, material);
    stiff->law = block.law;
    stiff->density = block.density;
    lar_material_from_shear_bulk(stiff, block.shear, block.bulk);
    add_brick(model, &layer, (double[]){0, 0, 0});
    for (int32_t n = 0; n < model->mesh.node_count; n++) model->mesh.position[n][2] *= flat;
    int32_t split = model->mesh.element_count;
    int32_t first = add_brick(model, &block, (double[]){0, 0, 4 * edge * flat});
    for (int32_t e = split; e < model->mesh.element_count; e++) model->element_material[e] = 1;
    touch_between(model, split);
    fix_all(model, LAR_AXIS_X | LAR_AXIS_Y);
    fix_nodes(model, brick_side(&layer, 2, 0), LAR_AXIS_Z);
    move_nodes(model, shifted(brick_side(&block, 2, -1), first), LAR_AXIS_Z, -0.01 * edge,
               add_ramp(model, 0.02));
    model->damping = 500;
    return model;
}

static void both_come_to_rest(void **unused) {
    (void)unused;
    static const int times[] = {1, 2, 3};
    static const double part[] = {0.8, 0.3};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) {
            lar_model *model = block_on_layer(times[i], 0.1);
            lar_options options = lar_options_default();
            int32_t worst;
            assert_int_equal(
                lar_stable_step(model, LAR_ELEMENT_HEX8, &options.time_step, &worst, NULL), LAR_OK);
            options.time_step *= part[k];
            lar_simulation *s = start_with(model, options);
            lar_energy e;
            while (lar_simulation_time(s) < 0.1) advance(s, 100);
            lar_simulation_energy(s, &e);
            print_message("%d times as fine, %g of the stable step: kinetic over strain energy "
                          "%.2g\n",
                          times[i], part[k], e.kinetic / e.strain);
            assert_below(0, e.strain);
            assert_below(fabs(e.kinetic), 1e-9 * e.strain);
            finish(s, model);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(both_come_to_rest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
