/* Slices, one element between two planes: what is pressed together stays outside, also of tissue
 * whose volume gives way, and of a body that touches itself. */
#include "engine/body_contact_test.h"

static void hold_in_planes(lar_model *model) {
    int32_t count = model->mesh.node_count;
    lar_node_list all = {count, lar_calloc((size_t)count, sizeof(int32_t))};
    for (int32_t n = 0; n < count; n++) all.node[n] = n;
    fix_nodes(model, all, LAR_AXIS_Y);
}

static double height_of(const lar_simulation *s, int32_t node) {
    return s->domain.model->mesh.position[node][2] + node_u(s, node)[2];
}

static lar_simulation *at_rest(lar_model *model) {
    model->damping = 50;
    lar_simulation *s = start(model);
    while (lar_simulation_time(s) < 0.5) advance(s, 50);
    return s;
}

/* Two blocks, a little apart, pressed together by a twelfth of their height. Returns how far the
 * lower nodes of the upper one are above the upper ones of the other in the mean, in elements. */
static double pressed_apart(const brick *block) {
    const double edge = block->edge, gap = 0.1 * edge, top = edge * block->cells[2];
    lar_model *model = empty_model(block);
    add_brick(model, block, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count, nodes = model->mesh.node_count;
    int32_t first = add_brick(model, block, (double[]){0, 0, top + gap});
    touch_between(model, split);
    hold_in_planes(model);
    fix_nodes(model, brick_side(block, 2, 0), LAR_AXIS_X | LAR_AXIS_Z);
    lar_node_list above = brick_side(block, 2, -1);
    for (int32_t i = 0; i < above.count; i++) above.node[i] += first;
    move_nodes(model, above, LAR_AXIS_Z, -2 * top / 12 - gap, add_ramp(model, 0.1));
    lar_simulation *s = at_rest(model);
    double apart = 0;
    int32_t count = 0;
    for (int32_t n = 0; n < nodes; n++) {
        if (model->mesh.position[n][2] == top) apart -= height_of(s, n), count++;
        if (model->mesh.position[n + first][2] == top + gap) apart += height_of(s, n + first);
    }
    finish(s, model);
    return apart / count / edge;
}

static void soft_slices_stay_outside(void **state) {
    (void)state;
    static const double bulk[] = {3e3, 1e4, 3e4};
    for (int k = 0; k < 9; k += test_every(4)) {
        const int thick = 1 + k / 3, i = k % 3;
        const brick block = {{6, thick, 4}, 0.0016, 0, LAR_LAW_neo_hookean, 3e3, bulk[i], 1060};
        double apart = pressed_apart(&block);
        print_message("%d elements thick, K = %g G: %.3f elements apart\n", thick, bulk[i] / 3e3,
                      apart);
        assert_below(-0.1, apart);
    }
}

/* A block with a slot of one element from its right side to its left wall. */
static lar_model *slotted(void) {
    const brick block = {{8, 1, 5}, 0.002, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1060};
    lar_model *model = brick_model(&block);
    lar_mesh *mesh = &model->mesh;
    int32_t kept = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const double *x = mesh->position[mesh->element[e][0]];
        bool slot = x[0] > 1.5 * block.edge && fabs(x[2] - 2 * block.edge) < 1e-6;
        if (!slot) memmove(mesh->element[kept++], mesh->element[e], sizeof *mesh->element);
    }
    mesh->element_count = kept;
    for (int32_t n = 0; n < mesh->node_count; n++) /* its tips are not flush */
        if (mesh->position[n][2] > 2.9 * block.edge) mesh->position[n][0] *= 0.95;
    fix_nodes(model, brick_side(&block, 2, 0), LAR_AXIS_X | LAR_AXIS_Z);
    lar_node_list above = brick_side(&block, 2, -1);
    int32_t count = 0;
    for (int32_t i = 0; i < above.count; i++)
        if (mesh->position[above.node[i]][0] > 0.008) above.node[count++] = above.node[i];
    above.count = count;
    move_nodes(model, above, LAR_AXIS_Z, -1.15 * block.edge, add_ramp(model, 0.1));
    hold_in_planes(model);
    touch_self(model);
    return model;
}

static void a_slice_touches_itself(void **state) {
    (void)state;
    lar_model *model = slotted();
    lar_simulation *s = at_rest(model);
    uint64_t steps = lar_simulation_steps(s), hash = lar_simulation_hash(s);
    double upper = INFINITY, lower = -INFINITY;
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double *x = model->mesh.position[n];
        if (x[0] < 0.0115) continue;
        if (fabs(x[2] - 0.004) < 1e-6) lower = fmax(lower, height_of(s, n));
        if (fabs(x[2] - 0.006) < 1e-6) upper = fmin(upper, height_of(s, n));
    }
    print_message("the slot is %.3f mm wide\n", 1e3 * (upper - lower));
    assert_below(-1e-4, upper - lower);
    lar_simulation_destroy(s);
    for (int k = 0; k < 2; k++) {
        lar_options options = lar_options_default();
        options.grid = k ? "3x1x2" : "2x1x1";
        s = start_with(model, options);
        advance(s, (int)steps);
        assert_int_equal(lar_simulation_hash(s), hash);
        lar_simulation_destroy(s);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soft_slices_stay_outside),
        cmocka_unit_test(a_slice_touches_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
