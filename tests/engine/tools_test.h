/* What the tests of tools, checkpoints and sessions share: a body with tools, and hands that do
 * something with them, tick after tick, the same every time.
 *
 * Include engine_test.h first. */
#ifndef LAR_TESTS_TOOLS_TEST_H
#define LAR_TESTS_TOOLS_TEST_H

enum { TICK_STEPS = 10, TEST_BALL = 0, TEST_ROD, TEST_GRASPER, TEST_HAND, TEST_TOOLS };

/* Slightly irregular, no row of it straight; big enough for twelve processors. 6 x 5 x 4 cm. */
static const brick tool_brick = {{6, 5, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

TEST_UNUSED static void add_tool(lar_model *model, const char *name, lar_tool_shape shape, double x,
                                 double y, double z) {
    *(lar_tool *)LAR_MODEL_APPEND(model, tool) =
        (lar_tool){.name = lar_strdup(name),
                   .shape = shape,
                   .radius = 0.008,
                   .length = shape == LAR_TOOL_SPHERE ? 0 : 0.03,
                   .spread = shape == LAR_TOOL_GRASPER ? 0.6 : 0,
                   .rest = {.position = {x, y, z}, .orientation = {1, 0, 0, 0}, .opening = 1}};
}

/* All nodes of a body become one rigid body, with all freedom. */
TEST_UNUSED static lar_tool *bind_nodes(lar_model *model, int32_t first, int32_t end) {
    lar_node_list nodes = {end - first, lar_calloc((size_t)(end - first), 4)};
    double x[3] = {0};
    for (int32_t n = first; n < end; n++) {
        nodes.node[n - first] = n;
        for (int i = 0; i < 3; i++) x[i] += model->mesh.position[n][i] / (end - first);
    }
    add_tool(model, "stone", LAR_TOOL_RIGID, x[0], x[1], x[2]);
    *(lar_move *)LAR_MODEL_APPEND(model, move) =
        (lar_move){.nodes = nodes, .axes = LAR_AXIS_ALL, .tool = model->tool_count};
    lar_tool *tool = &model->tool[model->tool_count - 1];
    tool->free = LAR_AXIS_ALL | LAR_FREE_TURNS;
    return tool;
}

/* The same body, so fine that its state is more than one packet between processes. */
static const brick fine_tool_brick = {{12, 10, 8}, 0.005, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

/* everything_model, on a ground, with a ball, a rod and an open grasper above its top. */
TEST_UNUSED static lar_model *tool_model_of(const brick *b) {
    lar_model *model = everything_model(b);
    fix_nodes(model, brick_side(b, 2, 0), LAR_AXIS_X | LAR_AXIS_Z); /* it does not sag away */
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.03, 0.025, 0.052);
    add_tool(model, "rod", LAR_TOOL_CAPSULE, 0.045, 0.01, 0.052);
    add_tool(model, "grasper", LAR_TOOL_GRASPER, 0.03, 0.015, 0.095);
    model->tool[TEST_GRASPER].radius = 0.003;
    return model;
}

TEST_UNUSED static void place_tool(lar_simulation *simulation, int32_t tool, double x, double y,
                                   double z, double opening, uint64_t steps) {
    lar_tool_pose pose = {{x, y, z}, {1, 0, 0, 0}, opening};
    lar_error error;
    if (lar_simulation_tool_move(simulation, tool, &pose, steps, &error))
        fail_msg("%s", error.message);
}

TEST_UNUSED static lar_model *tool_model(void) {
    return tool_model_of(&tool_brick);
}

/* What happens at the beginning of a tick: the ball is pressed into the top and drawn along it, the
 * rod dips and turns away, the grasper comes down, closes, pulls and lets go, the hand takes hold
 * of a corner and shakes it. Who stops after tick 7 stops in the middle of the ways, which nobody
 * renews in tick 8. The options need a hand. */
TEST_UNUSED static void act_at(lar_simulation *simulation, int tick) {
    uint64_t steps = tick == 7 ? TICK_STEPS + 5 : TICK_STEPS;
    if (tick == 8) return;
    double t = tick, down = t < 6 ? 0.0015 * t : 0.009;
    place_tool(simulation, TEST_BALL, 0.03 + 0.0006 * t, 0.025, 0.052 - down, 1, steps);
    place_tool(simulation, TEST_ROD, 0.045, 0.01 + 0.0004 * t, 0.052 - 0.5 * down, 1, steps);
    double height = t < 5 ? 0.095 - 0.0054 * t : 0.068 + 0.0008 * (t - 5);
    place_tool(simulation, TEST_GRASPER, 0.03, 0.015, height, tick < 6 || tick > 16 ? 1 : 0.1,
               steps);
    double pull = tick < 4 ? 0 : 0.0006 * (t - 4);
    place_tool(simulation, TEST_HAND, 0.06 + pull, 0.05, 0.04 + pull, tick < 3 || tick > 14 ? 1 : 0,
               steps);
}

/* tool_model with tools that rub. */
TEST_UNUSED static lar_model *touched(double friction) {
    lar_model *model = tool_model();
    for (int i = 0; i < model->tool_count; i++) model->tool[i].friction = friction;
    return model;
}

/* So gently that steps are seldom divided: ball and rod dip into the top and are drawn along it,
 * the hand pulls at a corner, the grasper comes down with its jaws open. */
TEST_UNUSED static void act_gently(lar_simulation *simulation, int tick) {
    double t = tick, down = fmin(t, 8) * 0.0003;
    place_tool(simulation, TEST_BALL, 0.03 + 0.0002 * t, 0.025, 0.0485 - down, 1, TICK_STEPS);
    place_tool(simulation, TEST_ROD, 0.045, 0.01 + 0.0002 * t, 0.0485 - down, 1, TICK_STEPS);
    if (tick == 0) place_tool(simulation, TEST_GRASPER, 0.03, 0.015, 0.0705, 1, 20 * TICK_STEPS);
    const double corner[3] = {0.06, 0.05, 0.04};
    if (tick == 0)
        assert_int_equal(lar_simulation_grasp(simulation, TEST_HAND, corner, 1, NULL, NULL), 0);
    place_tool(simulation, TEST_HAND, 0.06 + 0.0001 * t, 0.05, 0.04, 0, TICK_STEPS);
}

/* Ticks first .. last - 1. */
TEST_UNUSED static void act(lar_simulation *simulation, int first, int last) {
    for (int tick = first; tick < last; tick++) {
        act_at(simulation, tick);
        advance(simulation, TICK_STEPS);
    }
}

#endif
