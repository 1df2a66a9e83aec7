/* The model: appending, notices, small questions, and the check across its parts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "brick.h"
#include "model/model.h"

/* A brick that passes the check: one material, nine nodes fixed, nine moved. */
static lar_model *good_model(void) {
    lar_model *model = lar_model_create();
    assert_non_null(model);
    assert_int_equal(brick_read("brick.vtu", 1.0, &model->mesh, NULL), LAR_OK);
    model->source = lar_strdup("test.yaml");
    model->element_material = lar_calloc(BRICK_ELEMENTS, sizeof(int32_t));
    lar_material *material = LAR_MODEL_APPEND(model, material);
    material->density = 1050.0;
    lar_material_from_shear_bulk(material, 4.0e3, 4.0e5);
    lar_curve *curve = LAR_MODEL_APPEND(model, curve);
    curve->over = 0.2;
    lar_fix *fix = LAR_MODEL_APPEND(model, fix);
    fix->axes = LAR_AXIS_ALL;
    fix->nodes.node = lar_calloc(9, sizeof(int32_t));
    lar_move *move = LAR_MODEL_APPEND(model, move);
    move->axes = LAR_AXIS_X;
    move->by = 0.01;
    move->nodes.node = lar_calloc(9, sizeof(int32_t));
    for (int i = 0; i < 9; i++) {
        fix->nodes.node[fix->nodes.count++] = i;
        move->nodes.node[move->nodes.count++] = 18 + i;
    }
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    return model;
}

static void refused_and_destroyed(lar_model *model, const char *part) {
    lar_error error = {0};
    assert_int_equal(lar_model_check(model, &error), LAR_ERROR_MODEL);
    if (!strstr(error.message, part)) fail_msg("\"%s\" lacks \"%s\"", error.message, part);
    lar_model_destroy(model);
}

static void test_append(void **state) {
    (void)state;
    lar_model *model = lar_model_create();
    for (int i = 0; i < 1000; i++) {
        lar_fix *fix = LAR_MODEL_APPEND(model, fix);
        assert_non_null(fix);
        assert_int_equal(fix->axes, 0);
        fix->axes = (unsigned)i;
    }
    assert_int_equal(model->fix_count, 1000);
    for (int i = 0; i < 1000; i++) assert_int_equal(model->fix[i].axes, i);
    model->fix_count = 1000;
    lar_model_destroy(model);
    lar_model_destroy(NULL);
}

static void test_notices(void **state) {
    (void)state;
    lar_model *model = lar_model_create();
    assert_int_equal(lar_model_notice(model, NULL, "%s is %d", "damping", 3), LAR_OK);
    assert_int_equal(lar_model_notice(model, NULL, "two"), LAR_OK);
    assert_int_equal(model->notice_count, 2);
    assert_string_equal(model->notice[0], "damping is 3");
    lar_model_destroy(model);
}

static void test_small_questions(void **state) {
    (void)state;
    lar_model *model = good_model();
    assert_ptr_equal(lar_model_positions(model), model->mesh.position);
    model->output.every = 0.02;
    assert_true(lar_model_output_interval(model) == 0.02);
    assert_true(lar_model_duration(model) == 0.2);
    model->duration = 1.5;
    assert_true(lar_model_duration(model) == 1.5);
    for (int i = 0; i < 3; i++) assert_int_equal(model->gravity_curve[i], -1);
    lar_model_destroy(model);
}

static void test_empty_model(void **state) {
    (void)state;
    refused_and_destroyed(lar_model_create(), "no elements");
}

static void test_materials(void **state) {
    (void)state;
    lar_model *model = good_model();
    model->element_material[3] = -1;
    refused_and_destroyed(model, "element 104 (tag 1) has no material");
    model = good_model();
    model->element_material[7] = 1;
    refused_and_destroyed(model, "element 108");
    model = good_model();
    model->material[0].name = lar_strdup("liver");
    model->material[0].density = 0.0;
    refused_and_destroyed(model, "test.yaml: material 1 liver: the density");
}

static void test_conflicts(void **state) {
    (void)state;
    lar_model *model = good_model();
    model->move[0].nodes.node[4] = 8;
    refused_and_destroyed(model, "node 9 is moved by move entry 1 and fixed");
    model = good_model();
    model->move[0].nodes.node[4] = 8;
    model->fix[0].axes = LAR_AXIS_Y | LAR_AXIS_Z;
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    lar_move *move = LAR_MODEL_APPEND(model, move);
    move->axes = LAR_AXIS_X;
    move->nodes.node = lar_calloc(1, sizeof(int32_t));
    move->nodes.node[0] = 26;
    move->nodes.count = 1;
    refused_and_destroyed(model, "node 27 is moved by move entry 2 and moved by another entry");
}

static void test_ranges(void **state) {
    (void)state;
    lar_model *model = good_model();
    model->fix[0].nodes.node[0] = BRICK_NODES;
    refused_and_destroyed(model, "names index 27");
    model = good_model();
    model->fix[0].nodes.node[0] = -1;
    refused_and_destroyed(model, "names index -1");
    model = good_model();
    model->move[0].curve = 1;
    refused_and_destroyed(model, "move entry 1");
    model = good_model();
    model->fix[0].axes = 8;
    refused_and_destroyed(model, "fix entry 1");
    model = good_model();
    lar_nodal_load *load = LAR_MODEL_APPEND(model, load);
    load->force[1] = NAN;
    refused_and_destroyed(model, "nodal load entry 1");
    model = good_model();
    lar_pressure_load *pressure = LAR_MODEL_APPEND(model, pressure);
    pressure->face = lar_calloc(1, sizeof(int32_t));
    pressure->face[0] = 6 * BRICK_ELEMENTS;
    pressure->count = 1;
    refused_and_destroyed(model, "pressure entry 1 names index 48");
    model = good_model();
    lar_initial_velocity *initial = LAR_MODEL_APPEND(model, initial);
    initial->velocity[0] = INFINITY;
    refused_and_destroyed(model, "initial velocity entry 1");
    model = good_model();
    lar_probe *probe = LAR_MODEL_APPEND(model, output.probe);
    probe->nodes.count = 1;
    refused_and_destroyed(model, "probe entry 1 has no list");
}

static void test_numbers_and_curves(void **state) {
    (void)state;
    lar_model *model = good_model();
    model->gravity[2] = NAN;
    refused_and_destroyed(model, "gravity");
    model = good_model();
    model->gravity_curve[1] = 5;
    refused_and_destroyed(model, "gravity");
    model = good_model();
    model->damping = -1.0;
    refused_and_destroyed(model, "damping");
    model = good_model();
    model->time_step = INFINITY;
    refused_and_destroyed(model, "time step");
    model = good_model();
    model->curve[0].kind = LAR_CURVE_TABLE;
    refused_and_destroyed(model, "curve 1");
    model = good_model();
    model->curve[0].kind = LAR_CURVE_TABLE;
    model->curve[0].point = lar_calloc(2, sizeof *model->curve[0].point);
    model->curve[0].point[0][0] = 1.0;
    model->curve[0].count = 2;
    refused_and_destroyed(model, "ascending");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_append),          cmocka_unit_test(test_notices),
        cmocka_unit_test(test_small_questions), cmocka_unit_test(test_empty_model),
        cmocka_unit_test(test_materials),       cmocka_unit_test(test_conflicts),
        cmocka_unit_test(test_ranges),          cmocka_unit_test(test_numbers_and_curves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
