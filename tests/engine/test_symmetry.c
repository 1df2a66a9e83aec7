/* Half of a symmetric model is as good as the whole: contact of bodies and of tools in a plane of
 * symmetry is what it is within a body. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"
#include "engine/tools_test.h"

static const double edge = 0.0015;

/* A block, and with `wedge` a brick that stands on one of its edges, which is led down into it. The
 * whole, from -width to width along y, or the half of that which is held across y = 0. */
static lar_model *pressed_model(bool whole, bool wedge) {
    brick block = {{8, whole ? 6 : 3, 4}, edge, 0, LAR_LAW_neo_hookean, 1e3, 9.6e3, 1000};
    brick upper = {{4, whole ? 6 : 3, 4}, edge, 0, LAR_LAW_neo_hookean, 1e3, 9.6e3, 1000};
    lar_model *model = empty_model(&block);
    const double low = whole ? -3 * edge : 0;
    add_brick(model, &block, (double[]){-4 * edge, low, -4 * edge});
    const int32_t nodes = model->mesh.node_count, elements = model->mesh.element_count;
    lar_node_list base = brick_side(&block, 2, 0), plane = {0, NULL};
    if (wedge) add_brick(model, &upper, (double[]){0, low, 0});
    plane.node = lar_calloc((size_t)model->mesh.node_count, sizeof(int32_t));
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        if (model->mesh.position[n][1] == 0 && n < nodes) plane.node[plane.count++] = n;
    fix_nodes(model, base, LAR_AXIS_ALL);
    if (!whole) fix_nodes(model, plane, LAR_AXIS_Y);
    if (whole) free(plane.node);
    model->damping = 100;
    if (!wedge) return model;
    const double c = cos(0.5), s = sin(0.5);
    const int32_t count = model->mesh.node_count - nodes;
    lar_node_list moved = {count, lar_calloc((size_t)count, sizeof(int32_t))}, still = moved;
    still.node = lar_calloc((size_t)count, sizeof(int32_t));
    for (int32_t n = nodes; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n], turned = c * x[0] - s * x[2];
        x[2] = s * x[0] + c * x[2];
        x[0] = turned;
        moved.node[n - nodes] = still.node[n - nodes] = n;
    }
    fix_nodes(model, still, LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, moved, LAR_AXIS_Z, -2 * edge, add_ramp(model, 0.05));
    touch_between(model, elements);
    return model;
}

/* Down, on all nodes of what presses, and how deep it is at most. */
static double force_of(lar_simulation *s, const lar_model *model, lar_cause cause) {
    double(*force)[3] = calloc((size_t)model->mesh.node_count, sizeof *force), sum = 0;
    assert_non_null(force);
    assert_int_equal(lar_simulation_nodal_forces(s, cause, 0, force, NULL), LAR_OK);
    for (int32_t n = 0; n < model->mesh.node_count; n++) sum -= fmin(force[n][2], 0);
    free(force);
    return sum;
}

static void half_a_wedge_is_pressed_in_with_half_the_force(void **unused) {
    (void)unused;
    double force[2];
    for (int half = 0; half < 2; half++) {
        lar_model *model = pressed_model(!half, true);
        lar_simulation *s = start(model);
        while (lar_simulation_time(s) < 0.08) advance(s, 8);
        force[half] = force_of(s, model, LAR_CAUSE_BODIES);
        finish(s, model);
    }
    print_message("a wedge: %.5f mN, half of it twice %.5f mN\n", 1e3 * force[0], 2e3 * force[1]);
    assert_true(force[0] > 0);
    assert_below(fabs(2 * force[1] / force[0] - 1), 5e-3);
}

/* A plate on a block is led down and across the plane where that ends, two rows of nodes beyond it:
 * what the block feels across the plane and down [N]. */
static void press_plate(double force[2]) {
    static const brick block = {{8, 3, 4}, edge, 0, LAR_LAW_neo_hookean, 1e3, 9.6e3, 1000};
    static const brick plate = {{4, 6, 1}, edge, 0, LAR_LAW_neo_hookean, 1e3, 9.6e3, 1000};
    lar_model *model = empty_model(&block);
    add_brick(model, &block, (double[]){-4 * edge, 0, -4 * edge});
    const int32_t nodes = model->mesh.node_count, elements = model->mesh.element_count;
    fix_nodes(model, brick_side(&block, 2, 0), LAR_AXIS_ALL);
    fix_nodes(model, brick_side(&block, 1, 0), LAR_AXIS_Y);
    add_brick(model, &plate, (double[]){-2 * edge, 0.5 * edge, 0});
    lar_node_list moved = {model->mesh.node_count - nodes, NULL}, across = moved, still = moved;
    moved.node = lar_calloc((size_t)moved.count, sizeof(int32_t));
    across.node = lar_calloc((size_t)across.count, sizeof(int32_t));
    still.node = lar_calloc((size_t)still.count, sizeof(int32_t));
    for (int32_t n = nodes; n < model->mesh.node_count; n++)
        moved.node[n - nodes] = across.node[n - nodes] = still.node[n - nodes] = n;
    fix_nodes(model, still, LAR_AXIS_X);
    move_nodes(model, moved, LAR_AXIS_Z, -0.5 * edge, add_ramp(model, 0.05));
    move_nodes(model, across, LAR_AXIS_Y, -2 * edge, add_ramp(model, 0.05));
    touch_between(model, elements);
    model->damping = 100;
    lar_simulation *s = start(model);
    while (lar_simulation_time(s) < 0.08) advance(s, 8);
    double(*all)[3] = calloc((size_t)model->mesh.node_count, sizeof *all);
    assert_non_null(all);
    assert_int_equal(lar_simulation_nodal_forces(s, LAR_CAUSE_BODIES, 0, all, NULL), LAR_OK);
    force[0] = force[1] = 0;
    for (int32_t n = 0; n < nodes; n++) {
        force[0] += all[n][1];
        force[1] -= all[n][2];
    }
    free(all);
    finish(s, model);
}

static void nothing_is_pushed_across_the_plane(void **unused) {
    (void)unused;
    double force[2];
    press_plate(force);
    print_message("a plate beyond the plane: %.4f mN across, %.4f down\n", 1e3 * force[0],
                  1e3 * force[1]);
    assert_true(force[1] > 0);
    assert_below(fabs(force[0]), 0.05 * force[1]);
}

/* A sphere in the plane of symmetry. */
static void half_a_sphere_is_as_hard(void **unused) {
    (void)unused;
    double force[2];
    for (int half = 0; half < 2; half++) {
        lar_model *model = pressed_model(!half, false);
        add_tool(model, "ball", LAR_TOOL_SPHERE, 0, 0, 0.004);
        model->tool[0].radius = 0.004;
        lar_simulation *s = start(model);
        for (int k = 1; k <= 100; k++) {
            place_tool(s, 0, 0, 0, 0.004 - 1e-5 * k, 1, 8);
            advance(s, 8);
        }
        advance(s, 1000);
        force[half] = force_of(s, model, LAR_CAUSE_TOOL);
        finish(s, model);
    }
    print_message("a sphere: %.5f mN, half of it twice %.5f mN\n", 1e3 * force[0], 2e3 * force[1]);
    assert_true(force[0] > 0);
    assert_below(fabs(2 * force[1] / force[0] - 1), 1e-6);
}

/* Rays along the diagonals of regular meshes meet edges exactly: of bodies that are far apart
 * nothing is inside. */
static void who_is_far_away_is_not_inside(void **unused) {
    (void)unused;
    static const brick large = {{2, 2, 2}, 0.002, 0, LAR_LAW_neo_hookean, 1e3, 1e4, 1000},
                       small = {{2, 2, 2}, 0.001, 0, LAR_LAW_neo_hookean, 1e3, 1e4, 1000};
    for (int k = 0; k < 64; k++) {
        lar_model *model = empty_model(&large);
        const double at[3] = {1e-3 * (k % 4), 1e-3 * (k / 4 % 4), 0.005 + 1e-3 * (k / 16)};
        add_brick(model, &large, (double[]){0, 0, 0});
        add_brick(model, &small, at);
        fix_nodes(model, brick_side(&large, 2, 0), LAR_AXIS_ALL);
        touch_self(model);
        finish(start(model), model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_a_wedge_is_pressed_in_with_half_the_force),
        cmocka_unit_test(nothing_is_pushed_across_the_plane),
        cmocka_unit_test(half_a_sphere_is_as_hard),
        cmocka_unit_test(who_is_far_away_is_not_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
