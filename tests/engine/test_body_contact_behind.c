/* Who comes behind the faces of another body from the back is not pushed by them: a little block
 * deep inside a large one, farther than contact looks, leaves it as if nothing were there. (Scenes
 * begin outside of each other, so it is led there at once, and out again; a surface that is folded
 * through itself turns its back to who is outside, and that is the same to contact.) */
#include "engine/body_contact_test.h"

static const brick large = {{8, 8, 8}, 0.01, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
static const brick little = {{1, 1, 1}, 0.004, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
/* By so much it starts below its place at rest, and comes back within so long [m] [s]. */
static const double DOWN = 0.1, LONG = 0.2;

static lar_model *hidden(int32_t *first) {
    const double course[][2] = {{0, 1}, {LONG, 0}};
    lar_model *model = empty_model(&large);
    add_brick(model, &large, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    *first = add_brick(model, &little, (double[]){0.043, 0.043, 0.05 + DOWN});
    touch_between(model, split);
    lar_node_list nodes = {0, lar_calloc(8, sizeof *nodes.node)};
    while (nodes.count < 8) {
        nodes.node[nodes.count] = *first + nodes.count;
        nodes.count++;
    }
    move_nodes(model, nodes, LAR_AXIS_Z, -DOWN, add_table(model, LAR_CURVE_LINEAR, 2, course));
    return model;
}

static uint64_t leave(const lar_model *model, int32_t first, const lar_options *options) {
    lar_simulation *s = start_with(model, *options);
    lar_energy energy;
    int32_t inside = 0, node = -1;
    lar_error error;
    advance(s, 1);
    if (lar_simulation_contact_inside(s, &inside, &node, &error)) fail_msg("%s", error.message);
    assert_true(inside == 8 && node >= first);
    lar_simulation_energy(s, &energy);
    const double before = energy.kinetic;
    while (lar_simulation_time(s) < 0.12) {
        advance(s, 10);
        lar_simulation_energy(s, &energy);
        assert_below(energy.kinetic + energy.strain, before * (1 + 1e-9));
    }
    double lowest = INFINITY;
    for (int32_t n = first; n < model->mesh.node_count; n++)
        lowest = fmin(lowest, model->mesh.position[n][2] + node_u(s, n)[2]);
    assert_true(lowest > 0.08 + 0.01); /* out, and out of reach */
    if (lar_simulation_contact_inside(s, &inside, &node, &error)) fail_msg("%s", error.message);
    assert_true(inside == 0 && node == -1);
    uint64_t hash = lar_simulation_hash(s);
    lar_simulation_destroy(s);
    return hash;
}

static void the_back_of_a_face_does_not_push(void **unused) {
    (void)unused;
    int32_t first;
    lar_model *model = hidden(&first);
    lar_options options = lar_options_default();
    uint64_t hash = leave(model, first, &options);
    options.search_always = 1;
    assert_true(leave(model, first, &options) == hash);
    options.search_always = 0;
    options.grid = "1x1x2";
    assert_true(leave(model, first, &options) == hash);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_back_of_a_face_does_not_push)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
