/* Springs between nodes and where these are at rest: the same bits everywhere, saved and taken up;
 * a body on them swings and rests as it should, no joule is lost, steps know how stiff they are. */
#include "engine/same_bits_test.h"
#include "simulation/rest.h"

/* On every node of the list so much for each kilogram of its mass. */
static void hold_by(lar_model *model, lar_node_list nodes, double square) {
    double *mass = lar_calloc((size_t)model->mesh.node_count, sizeof *mass);
    lar_spring_bed *bed = LAR_MODEL_APPEND(model, spring);
    *bed = (lar_spring_bed){nodes, lar_calloc((size_t)nodes.count, sizeof(double)), 7};
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        for (int a = 0; a < 8; a++)
            mass[model->mesh.element[e][a]] +=
                lar_model_material_of(model, e)->density * lar_hexahedron_volume(corner) / 8;
    }
    for (int32_t k = 0; k < nodes.count; k++) bed->stiffness[k] = square * mass[nodes.node[k]];
    free(mass);
}

static lar_node_list all_nodes(const lar_model *model) {
    size_t count = (size_t)model->mesh.node_count;
    lar_node_list list = {model->mesh.node_count, lar_calloc(count, sizeof *list.node)};
    for (int32_t n = 0; n < list.count; n++) list.node[n] = n;
    return list;
}

/* Two beds, which share an edge. */
static lar_model *sprung_tool_model(const brick *b) {
    lar_model *model = tool_model_of(b);
    hold_by(model, brick_side(b, 1, 0), 3e3);
    hold_by(model, brick_side(b, 2, -1), 1e3);
    return model;
}

static same_bits body = {sprung_tool_model,
                         LAR_TEST_BUILD "/springs.checkpoint",
                         {0x7d7d6f90590e180c, 0x2bcb4a4e747261a2}};

/* Other springs are other supports. */
static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&body);
    lar_model *other = sprung_tool_model(&tool_brick);
    lar_error error;
    other->spring[1].stiffness[0] *= 1.001;
    lar_simulation *wrong = start_with(other, setting(NULL, 0));
    assert_int_not_equal(lar_simulation_load(wrong, body.path, &error), LAR_OK);
    if (!strstr(error.message, "its supports, loads")) fail_msg("%s", error.message);
    finish(wrong, other);
}

/* Springs like the nodes' masses: the body swings as one, and half the step is a quarter of the
 * error. */
static void a_body_swings_as_one(void **unused) {
    (void)unused;
    const double omega = 50, v0[3] = {0.1, -0.2, 0.4}, end = 0.1;
    double error[2];
    for (int half = 0; half < 2; half++) {
        lar_model *model = brick_model(&soft_brick);
        hold_by(model, all_nodes(model), omega * omega);
        throw_body(model, v0, (double[]){0, 0, 0}, 0);
        lar_options options = lar_options_default();
        options.time_step = half ? 1e-4 : 2e-4;
        lar_simulation *simulation = start_with(model, options);
        advance(simulation, half ? 1000 : 500);
        for (int32_t n = 0; n < model->mesh.node_count; n++)
            for (int i = 0; i < 3; i++)
                assert_below(
                    fabs(node_u(simulation, n)[i] / v0[i] - node_u(simulation, 0)[0] / v0[0]),
                    1e-9);
        error[half] = node_u(simulation, 5)[2] - v0[2] / omega * sin(omega * end);
        finish(simulation, model);
    }
    assert_below(fabs(error[1]), 1e-5);
    assert_below(fabs(error[0] / error[1] - 4), 0.05);
}

/* So damping that is to bring it to rest goes by them. */
static void its_slowest_motion_is_known(void **unused) {
    (void)unused;
    const double omega = 5;
    lar_model *model = brick_model(&soft_brick);
    lar_error error;
    hold_by(model, all_nodes(model), omega * omega);
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    assert_below(fabs(lar_rest_damping(model) / (1.8 * omega) - 1), 0.02);
    lar_model_destroy(model);
}

/* What bears the weight is told as a reaction, beside what is fixed. */
static void they_bear_the_weight(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_model_info info;
    model->gravity[2] = -9.81;
    model->damping = 60;
    fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_Z);
    hold_by(model, brick_side(&soft_brick, 2, 0), 2e4);
    lar_simulation *simulation = start(model);
    advance(simulation, 20000);
    assert_int_equal(lar_model_inspect(model, &info, NULL), LAR_OK);
    lar_node_list all = all_nodes(model);
    double sum[3];
    lar_measure_reaction(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                         &all, false, NULL, sum, NULL);
    assert_below(fabs(sum[2] / (9.81 * info.mass) - 1), 1e-6);
    free(all.node);
    finish(simulation, model);
}

/* As stiff as they may be, at the stable step. */
static void steps_know_them(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_model_info bare, info;
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_model_inspect(model, &bare, &error), LAR_OK);
    double square = 4 / (bare.stable_step * bare.stable_step);
    hold_by(model, all_nodes(model), 0.11 * square);
    throw_body(model, (double[]){0.1, 0, 0}, (double[]){5, 9, -7}, 0.2);
    assert_int_equal(lar_model_inspect(model, &info, &error), LAR_OK);
    assert_below(fabs(info.stable_step / bare.stable_step - 1 / sqrt(1.11)), 1e-9);
    lar_options options = lar_options_default();
    options.time_step = 0.999 * info.stable_step;
    lar_simulation *simulation = start_with(model, options);
    double largest;
    assert_below(account_open(simulation, &largest), 0.01 * largest);
    lar_simulation_destroy(simulation);
    for (int32_t k = 0; k < model->spring[0].nodes.count; k++) model->spring[0].stiffness[k] *= 1.1;
    assert_int_equal(lar_simulation_create(model, NULL, &simulation, &error), LAR_ERROR_MODEL);
    if (!strstr(error.message, ":7: springs of ") || !strstr(error.message, "0.9"))
        fail_msg("%s", error.message);
    lar_model_destroy(model);
}

static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    hold_by(model, brick_side(&soft_brick, 1, 0), 2e4);
    model->gravity[1] = 4;
    throw_body(model, (double[]){0.3, 0, 0}, (double[]){5, 9, -7}, 0.1);
    lar_options options = lar_options_default();
    options.time_step = 2e-4;
    lar_simulation *simulation = start_with(model, options);
    double largest;
    assert_below(account_open(simulation, &largest), 1e-4 * largest);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SAME_BITS_TESTS(body),
        cmocka_unit_test(a_saved_run_goes_on),
        cmocka_unit_test(a_body_swings_as_one),
        cmocka_unit_test(its_slowest_motion_is_known),
        cmocka_unit_test(they_bear_the_weight),
        cmocka_unit_test(steps_know_them),
        cmocka_unit_test(every_joule_is_accounted_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
