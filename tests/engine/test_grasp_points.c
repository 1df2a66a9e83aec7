/* Grasps: what hands and graspers take, that taking hold moves nothing, what pulling does, and that
 * letting go lets go. */
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"

/* 6 x 4 x 3 cm, held at its bottom. */
static const brick block = {{6, 4, 3}, 0.01, 0.05, LAR_LAW_neo_hookean, 4e3, 2e5, 1000};

static lar_model *block_model(const brick *b) {
    lar_model *model = brick_model(b);
    fix_nodes(model, brick_side(b, 2, 0), LAR_AXIS_ALL);
    model->damping = 30;
    return model;
}

static lar_simulation *with_hands(const lar_model *model, int hands) {
    lar_options options = lar_options_default();
    options.hands = hands;
    return start_with(model, options);
}

static void hand(lar_simulation *simulation, int32_t tool, double x, double y, double z,
                 double opening, uint64_t steps) {
    place(simulation, tool, (double[]){x, y, z}, (double[]){1, 0, 0, 0}, opening, steps);
}

static lar_tool_force felt(const lar_simulation *simulation, int32_t tool) {
    lar_tool_force force;
    lar_error error;
    assert_int_equal(lar_simulation_tool_force(simulation, tool, &force, &error), LAR_OK);
    return force;
}

static void a_hand_takes_hold_pulls_and_lets_go(void **unused) {
    (void)unused;
    lar_model *model = block_model(&block);
    lar_simulation *simulation = with_hands(model, 1);
    uint64_t still = lar_simulation_hash(simulation);
    hand(simulation, 0, 0.03, 0.02, 0.03, 0, 1);
    int32_t held = felt(simulation, 0).held;
    assert_true(held >= 4);
    advance(simulation, 10);
    lar_simulation *other = start(model);
    advance(other, 10);
    assert_true(lar_simulation_hash(simulation) == lar_simulation_hash(other)); /* moved nothing */
    assert_true(lar_simulation_hash(simulation) != still);
    lar_simulation_destroy(other);
    for (int k = 0; k < 3; k++) assert_true(fabs(felt(simulation, 0).force[k]) < 1e-9);

    hand(simulation, 0, 0.03, 0.02, 0.033, 0, 500); /* 3 mm up, then wait */
    advance(simulation, 4000);
    lar_tool_force force = felt(simulation, 0);
    double up = node_u(simulation, brick_node(&block, 3, 2, 3))[2];
    print_message("%d points held; 3 mm pull: %.3g N, surface %.2g mm up\n", (int)held,
                  -force.force[2], 1e3 * up);
    assert_true(-force.force[2] > 0.1 && up > 0.001 && up < 0.004);
    assert_int_equal(force.held, held);

    hand(simulation, 0, 0.03, 0.02, 0.033, 1, 1);
    advance(simulation, 1);
    assert_int_equal(felt(simulation, 0).held, 0);
    advance(simulation, 6000);
    assert_true(fabs(node_u(simulation, brick_node(&block, 3, 2, 3))[2]) < 1e-5);
    for (int k = 0; k < 3; k++) assert_true(felt(simulation, 0).force[k] == 0);
    finish(simulation, model);
}

static void a_hand_beside_the_surface_takes_the_nearest_point(void **unused) {
    (void)unused;
    lar_model *model = block_model(&block);
    lar_simulation *simulation = with_hands(model, 2);
    hand(simulation, 0, 0.03, 0.02, 0.042, 0, 1); /* 12 mm above: between one and two radii */
    hand(simulation, 1, 0.03, 0.02, 0.05, 0, 1);  /* out of reach */
    assert_int_equal(felt(simulation, 0).held, 1);
    assert_int_equal(felt(simulation, 1).held, 0);
    const lar_grasp *grasp = &simulation->tools.grasps[0];
    assert_true(fabs(grasp->weight[0] + grasp->weight[1] + grasp->weight[2] + grasp->weight[3] -
                     1) < 1e-14);
    assert_true(grasp->anchor[2] < -0.01 && fabs(grasp->anchor[0]) < 0.005);
    /* Closed upon nothing it takes nothing later either, until it has been opened. */
    hand(simulation, 1, 0.03, 0.02, 0.03, 0, 1000);
    assert_int_equal(felt(simulation, 1).held, 0);
    hand(simulation, 1, 0.03, 0.02, 0.03, 1, 1);
    hand(simulation, 1, 0.03, 0.02, 0.03, 0.3, 1); /* half closed is open still */
    assert_int_equal(felt(simulation, 1).held, 0);
    hand(simulation, 1, 0.03, 0.02, 0.03, 0.2, 1);
    assert_true(felt(simulation, 1).held > 0);
    hand(simulation, 1, 0.03, 0.02, 0.03, 0.4, 1); /* and closed still */
    assert_true(felt(simulation, 1).held > 0);
    finish(simulation, model);
}

static void hands_share_the_room_for_holds(void **unused) {
    (void)unused;
    brick fine = {{16, 16, 2}, 0.0025, 0, LAR_LAW_neo_hookean, 4e3, 2e5, 1000};
    lar_model *model = block_model(&fine);
    lar_simulation *simulation = with_hands(model, 4);
    for (int t = 0; t < 4; t++) {
        hand(simulation, t, 0.01 + 0.02 * (t % 2), 0.01 + 0.02 * (t / 2), 0.005, 0, 1);
        int32_t held = felt(simulation, t).held;
        assert_true(held > 24 && held <= LAR_GRASPS_MAX / 4);
    }
    double total = 0;
    for (int32_t i = 0; i < simulation->tools.grasp_count; i++)
        total += simulation->tools.grasps[i].stiffness;
    assert_true(fabs(total / 4 - 600) < 1e-9);
    finish(simulation, model);
}

static void a_grasper_takes_what_is_between_its_jaws(void **unused) {
    (void)unused;
    lar_model *model = block_model(&block);
    /* A fold of tissue: the edge at the top. The jaws come from above, one on either side. */
    lar_tool jaws = {.shape = LAR_TOOL_GRASPER, .radius = 0.002, .length = 0.02, .spread = 1.6};
    touch_tool(model, "jaws", jaws, (double[]){0.03, 0.0, 0.055});
    lar_simulation *simulation = start(model);
    const double turned[4] = {cos(0.3), sin(0.3), 0, 0}; /* about x: down and into the body */
    place(simulation, 0, (double[]){0.03, -0.006, 0.042}, turned, 1, 400);
    advance(simulation, 400);
    place(simulation, 0, (double[]){0.03, -0.006, 0.042}, turned, 0, 400);
    lar_tool_force force = felt(simulation, 0);
    print_message("jaws hold %d points\n", (int)force.held);
    assert_true(force.held > 0);
    for (int32_t i = 0; i < simulation->tools.grasp_count; i++) {
        const double *p = simulation->tools.grasps[i].anchor;
        assert_true(p[2] <= 0 && p[2] >= -0.022 && fabs(p[1]) <= 0.004);
    }
    advance(simulation, 400);
    place(simulation, 0, (double[]){0.03, -0.012, 0.05}, turned, 0, 1500);
    advance(simulation, 3000);
    force = felt(simulation, 0);
    print_message("and pull with %.3g %.3g %.3g N\n", -force.force[0], -force.force[1],
                  -force.force[2]);
    assert_true(force.force[2] < -0.05);
    place(simulation, 0, (double[]){0.03, -0.012, 0.05}, turned, 1, 100);
    advance(simulation, 100);
    assert_int_equal(felt(simulation, 0).held, 0);
    finish(simulation, model);
}

/* Pulled away a metre and torn to and fro: the grasp slips, or the run stops and says why. */
static void no_pull_explodes(void **unused) {
    (void)unused;
    static const double ways[4][3] = {{0, 0, 1}, {1, 0, 0.2}, {0.1, -1, 0}, {0, 0, -0.2}};
    for (int w = 0; w < 4; w++) {
        lar_model *model = block_model(&block);
        model->damping = 0;
        lar_simulation *simulation = with_hands(model, 1);
        lar_error error = {0};
        lar_status status = LAR_OK;
        hand(simulation, 0, 0.03, 0.02, 0.03, 0, 1);
        for (int tick = 0; tick < 300 && !status; tick++) {
            double way = (tick < 100 ? tick : 200 - tick) * 0.01;
            hand(simulation, 0, 0.03 + way * ways[w][0], 0.02 + way * ways[w][1],
                 0.03 + way * ways[w][2], 0, 40);
            status = lar_simulation_advance(simulation, 10, &error);
        }
        double fastest = 0;
        for (int32_t n = 0; n < model->mesh.node_count; n++)
            for (int i = 0; i < 3; i++) fastest = fmax(fastest, fabs(node_v(simulation, n)[i]));
        print_message("way %d: %s, %.2g m/s\n", w, status ? error.message : "holds", fastest);
        assert_true(status == LAR_OK || status == LAR_ERROR_UNSTABLE);
        if (status) assert_non_null(strstr(error.message, "hand"));
        if (!status) assert_true(fastest < 20);
        finish(simulation, model);
    }
}

static uint64_t pulled_hash(const lar_model *model, lar_options options) {
    options.hands = 2;
    lar_simulation *simulation = start_with(model, options);
    hand(simulation, 0, 0.03, 0.02, 0.03, 0, 1);
    hand(simulation, 1, 0.0, 0.02, 0.015, 0, 1);
    for (int tick = 0; tick < 30; tick++) {
        hand(simulation, 0, 0.03 + 0.0003 * tick, 0.02, 0.03 + 0.0002 * tick, 0, 10);
        hand(simulation, 1, -0.0004 * tick, 0.02, 0.015, tick > 20, 10);
        advance(simulation, 10);
    }
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static void the_hash_is_the_same_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1"};
    lar_model *model = block_model(&block);
    uint64_t wanted = pulled_hash(model, lar_options_default());
    for (int g = 0; g < 3; g++)
        for (int threads = 1; threads <= 2; threads++) {
            lar_options options = lar_options_default();
            options.grid = grids[g];
            options.threads = threads;
            assert_int_equal(pulled_hash(model, options), wanted);
        }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hand_takes_hold_pulls_and_lets_go),
        cmocka_unit_test(a_hand_beside_the_surface_takes_the_nearest_point),
        cmocka_unit_test(hands_share_the_room_for_holds),
        cmocka_unit_test(a_grasper_takes_what_is_between_its_jaws),
        cmocka_unit_test(no_pull_explodes),
        cmocka_unit_test(the_hash_is_the_same_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
