/* A stamp with a sharp end, pressed into a pad and held: where its edge ends the pad's faces lie
 * along it, are gone through by it or stand before it, and which of these they do changes as they
 * give way. The force goes over, so that all comes to rest (docs/theory.md, sharp edges). */
#include "engine/body_contact_test.h"

static const double EDGE = 4e-4, SOFT = 1e5, BULK = 24.67e5;

/* Its lower side is a roof upside down, of 120 degrees; turned about its height, the near end of
 * the ridge is at (x, y). */
static void sharpen(lar_mesh *mesh, int32_t first, double x, double y) {
    const double half = 2 * EDGE, height = 3 * EDGE, steep = tan(M_PI / 6), turn = 0.3;
    const double c = cos(turn), s = sin(turn);
    for (int32_t n = first; n < mesh->node_count; n++) {
        double *at = mesh->position[n], roof = steep * fabs(at[0]);
        const double along[2] = {at[0], at[1] + half};
        at[2] = roof + at[2] / height * (height + steep * half - roof);
        at[0] = x + c * along[0] - s * along[1];
        at[1] = y + s * along[0] + c * along[1];
    }
}

static lar_model *stamped(double x, double y, double deep) {
    const brick pad = {{10, 10, 4}, EDGE, 0, LAR_LAW_neo_hookean, SOFT, BULK, 1000};
    const brick stamp = {{4, 4, 3}, EDGE, 0, LAR_LAW_neo_hookean, SOFT, BULK, 1000};
    lar_model *model = empty_model(&pad);
    add_brick(model, &pad, (double[]){-5 * EDGE, -5 * EDGE, -4 * EDGE});
    const int32_t split = model->mesh.element_count;
    const int32_t first = add_brick(model, &stamp, (double[]){-2 * EDGE, -2 * EDGE, 0});
    sharpen(&model->mesh, first, x, y);
    touch_between(model, split);
    const int32_t count = model->mesh.node_count - first;
    lar_node_list all = {count, lar_calloc((size_t)count, sizeof(int32_t))}, moved = all;
    moved.node = lar_calloc((size_t)count, sizeof(int32_t));
    for (int32_t n = 0; n < count; n++) all.node[n] = moved.node[n] = first + n;
    fix_nodes(model, brick_side(&pad, 2, 0), LAR_AXIS_ALL);
    fix_nodes(model, all, LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, moved, LAR_AXIS_Z, -deep, add_ramp(model, 0.01));
    model->damping = 400;
    return model;
}

static void it_comes_to_rest(void **unused) {
    (void)unused;
    static const double place[][3] = {
        {1e-4, -6.5e-4, 2e-4}, {0, -10e-4, 4e-4}, {-0.5e-4, -7.5e-4, 2e-4}};
    for (int i = 0; i < 3; i += test_every(2)) {
        lar_model *model = stamped(place[i][0], place[i][1], place[i][2]);
        lar_simulation *s = start(model);
        lar_energy e;
        while (lar_simulation_time(s) < 0.06) advance(s, 100);
        lar_simulation_energy(s, &e);
        print_message("%.1f mm deep: kinetic over strain energy %.2g, contact %.2g J\n",
                      1e3 * place[i][2], e.kinetic / e.strain, e.contact);
        assert_below(1e-6, e.strain);
        assert_below(fabs(e.kinetic), 1e-9 * e.strain);
        finish(s, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(it_comes_to_rest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
