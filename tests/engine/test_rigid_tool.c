/* Tools that move nodes as one rigid body: where these are, what the tool feels of them, the work
 * that it does, what is refused, and the same bits everywhere. */
#include "engine/same_bits_test.h"

/* The shaft of tool_model moves some nodes within the body in its place. */
static lar_model *carried_model(const brick *b) {
    lar_model *model = tool_model_of(b);
    lar_tool *rod = &model->tool[TEST_ROD];
    lar_node_list core = brick_side(b, 0, b->cells[0] / 2);
    int32_t kept = 0;
    for (int32_t k = 0; k < core.count; k++)
        if (model->mesh.position[core.node[k]][2] > 0.015) core.node[kept++] = core.node[k];
    core.count = kept;
    rod->shape = LAR_TOOL_RIGID;
    *(lar_move *)LAR_MODEL_APPEND(model, move) =
        (lar_move){.nodes = core, .axes = LAR_AXIS_ALL, .tool = TEST_ROD + 1};
    return model;
}

/* A bar, held at one end; a tool 2 cm behind the other one moves that. */
static const brick bar = {{12, 4, 4}, 0.005, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
static const double tip[3] = {0.08, 0.01, 0.01};

static lar_model *bar_model(void) {
    lar_model *model = brick_model(&bar);
    model->damping = 60;
    fix_nodes(model, brick_side(&bar, 0, 0), LAR_AXIS_ALL);
    add_tool(model, "clamp", LAR_TOOL_RIGID, tip[0], tip[1], tip[2]);
    *(lar_move *)LAR_MODEL_APPEND(model, move) =
        (lar_move){.nodes = brick_side(&bar, 0, -1), .axes = LAR_AXIS_ALL, .tool = 1};
    return model;
}

/* About the bar's axis, and forwards. */
static lar_tool_pose pose_at(double angle, double x) {
    return (lar_tool_pose){.position = {tip[0] + x, tip[1], tip[2]},
                           .orientation = {cos(angle / 2), sin(angle / 2)},
                           .opening = 1};
}

static void lead(lar_simulation *simulation, double angle, double x, int ticks) {
    for (int t = 1; t <= ticks; t++) {
        const lar_tool_pose pose = pose_at(angle * t / ticks, x * t / ticks);
        lar_error error;
        if (lar_simulation_tool_move(simulation, 0, &pose, 50, &error))
            fail_msg("%s", error.message);
        advance(simulation, 50);
    }
}

static void its_nodes_are_where_it_takes_them(void **unused) {
    (void)unused;
    lar_model *model = bar_model();
    lar_simulation *simulation = start(model);
    lead(simulation, 1.5, 0.004, 60);
    for (int j = 0; j <= 4; j++)
        for (int k = 0; k <= 4; k++) {
            const int32_t n = brick_node(&bar, 12, j, k);
            const double *x = model->mesh.position[n], y = x[1] - 0.01, z = x[2] - 0.01;
            const double want[3] = {0.004, cos(1.5) * y - sin(1.5) * z - y,
                                    sin(1.5) * y + cos(1.5) * z - z};
            for (int i = 0; i < 3; i++)
                assert_below(fabs(node_u(simulation, n)[i] - want[i]), 1e-16);
        }
    finish(simulation, model);
}

/* The work that it does is what the body stores and loses. At rest the bar pulls back with what it
 * is stretched by, and turns back with half of what twisting it took, per radian. */
static void it_feels_what_it_moves(void **unused) {
    (void)unused;
    lar_model *model = bar_model();
    lar_simulation *simulation = start(model);
    lar_tool_force felt;
    lar_energy e;
    lead(simulation, 0.3, 0, 60);
    advance(simulation, 16000);
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &felt, NULL), LAR_OK);
    lar_simulation_energy(simulation, &e);
    assert_below(fabs(-felt.torque[0] * 0.3 / 2 / (e.strain + e.hourglass) - 1), 0.01);
    assert_below(fabs(sum_of(&e) / e.external - 1), 1e-6);
    lead(simulation, 0.3, 0.002, 60); /* turned back first, in one tick */
    advance(simulation, 16000);
    lar_simulation_tool_force(simulation, 0, &felt, NULL);
    lar_simulation_energy(simulation, &e);
    assert_below(fabs(felt.force[0] / (-3 * 2e3 * 4e-4 * 0.002 / 0.06) - 1), 0.06);
    assert_below(fabs(felt.force[1]) + fabs(felt.force[2]), 1e-6);
    assert_below(fabs(sum_of(&e) / e.external - 1), 1e-6);
    finish(simulation, model);
}

/* The end of the bar goes down evenly, on a path of so many rows. */
static lar_simulation *on_a_path(lar_model **model, int rows) {
    *model = bar_model();
    lar_model *plain = bar_model();
    lar_simulation *simulation = start(plain);
    const double dt = lar_simulation_time_step(simulation);
    finish(simulation, plain);
    lar_tool_script *path = &(*model)->tool[0].path;
    for (int k = 0; k <= rows; k++) {
        const double part = (double)k / rows;
        const lar_tool_script_row row = {1000 * part * dt, pose_at(0, -0.004 * part)};
        assert_true(lar_tool_script_insert(path, (size_t)k, &row));
    }
    return start(*model);
}

/* What is looked at where a row ends is what the next step begins with. */
static void rows_of_a_path_do_not_show(void **unused) {
    (void)unused;
    lar_model *model[2];
    lar_simulation *simulation[2] = {on_a_path(&model[0], 1), on_a_path(&model[1], 10)};
    const size_t nodes = (size_t)model[0]->mesh.node_count;
    double(*force)[3] = lar_calloc(nodes, sizeof *force);
    lar_energy e[2];
    for (int k = 1; k < 10; k++) {
        double sum[2] = {0};
        for (int s = 0; s < 2; s++) {
            advance(simulation[s], 100);
            lar_simulation_energy(simulation[s], &e[s]);
            const int status =
                lar_simulation_nodal_forces(simulation[s], LAR_CAUSE_TOOL, 0, force, NULL);
            assert_int_equal(status, LAR_OK);
            for (size_t n = 0; n < nodes; n++) sum[s] += force[n][0];
        }
        assert_below(fabs(sum[1] - sum[0]), 1e-6 * fabs(sum[0]));
        assert_below(fabs(e[1].kinetic - e[0].kinetic), 1e-6 * e[0].kinetic);
        assert_below(fabs(e[1].external - e[0].external), 1e-6 * e[0].external);
    }
    free(force);
    for (int s = 0; s < 2; s++) finish(simulation[s], model[s]);
}

/* Forces on nodes: the tool's are minus what it feels, and all causes sum up to mass times
 * acceleration, as lar_simulation_nodal_forces says. */
static void forces_on_nodes_are_its_own(void **unused) {
    (void)unused;
    lar_model *model = bar_model();
    model->gravity[2] = -9.81;
    lar_simulation *simulation = start(model);
    const int32_t nodes = model->mesh.node_count;
    double(*force)[3] = lar_calloc((size_t)nodes, sizeof *force), sum[3] = {0}, turn[3] = {0};
    lead(simulation, 0.7, 0.003, 20);
    assert_int_equal(lar_simulation_nodal_forces(simulation, LAR_CAUSE_TOOL, 0, force, NULL), 0);
    lar_tool_pose pose;
    lar_tool_force felt;
    lar_simulation_tool_pose(simulation, 0, &pose, NULL);
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const double *x = model->mesh.position[n], *u = node_u(simulation, n);
            sum[i] -= force[n][i];
            turn[i] -= (x[j] + u[j] - pose.position[j]) * force[n][k] -
                       (x[k] + u[k] - pose.position[k]) * force[n][j];
        }
    advance(simulation, 1);
    lar_simulation_tool_force(simulation, 0, &felt, NULL);
    for (int i = 0; i < 3; i++) {
        assert_true(felt.force[i] == sum[i]);
        assert_below(fabs(felt.torque[i] - turn[i]), 1e-12);
    }
    assert_true(fabs(sum[0]) > 0.01 && fabs(turn[0]) > 1e-4);
    free(force);
    finish(simulation, model);
}

/* Nodes that are let go are not its any more; a reset gives them back. */
static void nodes_may_be_let_go(void **unused) {
    (void)unused;
    lar_model *model = bar_model();
    lar_simulation *simulation = start(model);
    lar_tool_force felt;
    lar_error error;
    const int32_t node = brick_node(&bar, 12, 2, 2);
    for (int j = 0; j <= 4; j++)
        for (int k = 0; k <= 4; k++)
            if (lar_simulation_set_support(simulation, brick_node(&bar, 12, j, k), LAR_AXIS_ALL, 0,
                                           &error))
                fail_msg("%s", error.message);
    lead(simulation, 0, 0.004, 20);
    lar_simulation_tool_force(simulation, 0, &felt, NULL);
    assert_true(node_u(simulation, node)[0] == 0 && felt.force[0] == 0);
    assert_int_equal(lar_simulation_reset(simulation, &error), LAR_OK);
    lead(simulation, 0, 0.004, 20);
    assert_below(fabs(node_u(simulation, node)[0] - 0.004), 1e-16);
    finish(simulation, model);
}

static void it_is_told_what_it_cannot_do(void **unused) {
    (void)unused;
    lar_model *model = bar_model();
    lar_simulation *simulation = start(model);
    lar_error error;
    lar_tool_pose pose = pose_at(0, 0.05);
    assert_int_equal(lar_simulation_tool_move(simulation, 0, &pose, 1, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "clamp"));
    pose = pose_at(3, 0); /* the tip stays where it is */
    assert_int_equal(lar_simulation_tool_move(simulation, 0, &pose, 1, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_grasp(simulation, 0, tip, 1, NULL, &error), LAR_ERROR_ARGUMENT);
    const lar_tool_info wanted = {.shape = LAR_TOOL_RIGID, .radius = 0.01};
    assert_int_equal(lar_simulation_add_tool(simulation, &wanted, NULL, &error),
                     LAR_ERROR_ARGUMENT);
    lar_simulation_destroy(simulation);
    fix_nodes(model, brick_side(&bar, 1, 0), LAR_AXIS_Y);
    assert_int_equal(lar_model_check(model, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "clamp"));
    lar_model_destroy(model);
}

static same_bits carried = {carried_model,
                            LAR_TEST_BUILD "/rigid_tool.checkpoint",
                            {0x7f89f5b5cb197972, 0x888df44e3bd9c417}};

static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&carried);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(its_nodes_are_where_it_takes_them),
        cmocka_unit_test(it_feels_what_it_moves),
        cmocka_unit_test(rows_of_a_path_do_not_show),
        cmocka_unit_test(forces_on_nodes_are_its_own),
        cmocka_unit_test(nodes_may_be_let_go),
        cmocka_unit_test(it_is_told_what_it_cannot_do),
        SAME_BITS_TESTS(carried),
        cmocka_unit_test(a_saved_run_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
