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

/* A good model with one contact of the whole surface with itself, or against `against`. */
static lar_model *touching_model(int kind, int32_t against) {
    lar_model *model = good_model();
    lar_contact *contact = LAR_MODEL_APPEND(model, contact);
    contact->kind = kind;
    contact->face_count = model->surface.face_count - 1;
    contact->face = lar_calloc((size_t)contact->face_count, sizeof(int32_t));
    for (int32_t i = 0; i < contact->face_count; i++) contact->face[i] = model->surface.face[i + 1];
    contact->against_count = 1;
    contact->against = lar_calloc(1, sizeof(int32_t));
    contact->against[0] = against;
    contact->normal[2] = 1;
    return model;
}

static void test_contacts(void **state) {
    (void)state;
    lar_model *model = touching_model(LAR_CONTACT_SELF, 0);
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    model->contact[0].face[3] = 1; /* between the first two elements */
    refused_and_destroyed(model,
                          "test.yaml: contact entry 1: its faces must be in ascending order");
    model = touching_model(LAR_CONTACT_SELF, 0);
    model->contact[0].face[0] = 1;
    refused_and_destroyed(model, "contact entry 1: face 1 of element 101 is inside the body");
    model = touching_model(LAR_CONTACT_SELF, 0);
    model->contact[0].face_count = 0;
    refused_and_destroyed(model, "contact entry 1: there is no face in this contact");
    model = touching_model(LAR_CONTACT_SELF, 0);
    model->contact[0].face[22] = 6 * BRICK_ELEMENTS;
    refused_and_destroyed(model, "contact entry 1: there is no face 48 in the mesh");
    model = touching_model(LAR_CONTACT_BETWEEN, 0);
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    model->contact[0].against[0] = model->surface.face[23];
    refused_and_destroyed(model, "have 1 in common (one is face 5 of element 108)");
    model = touching_model(LAR_CONTACT_BETWEEN, -1);
    refused_and_destroyed(model, "contact entry 1: there is no face -1 in the mesh");
    model = touching_model(LAR_CONTACT_PLANE, 0);
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    model->contact[0].normal[0] = 1;
    refused_and_destroyed(model, "contact entry 1: the plane needs a finite point and a normal");
    model = touching_model(LAR_CONTACT_PLANE, 0);
    model->contact[0].through[1] = NAN;
    refused_and_destroyed(model, "contact entry 1: the plane needs a finite point");
    model = touching_model(LAR_CONTACT_PLANE, 0);
    model->contact[0].through[2] = 0.012;
    refused_and_destroyed(model, "lies 0.012 m behind this plane at the start");
}

static lar_tool *add_tool(lar_model *model, const char *name) {
    lar_tool *tool = LAR_MODEL_APPEND(model, tool);
    *tool = (lar_tool){.name = lar_strdup(name),
                       .shape = LAR_TOOL_GRASPER,
                       .radius = 0.001,
                       .length = 0.02,
                       .spread = 1,
                       .rest = {.position = {0, 0, 1}, .orientation = {1, 0, 0, 0}, .opening = 1}};
    return tool;
}

static void test_tools(void **state) {
    (void)state;
#define REFUSED(change, words)                                                                     \
    do {                                                                                           \
        lar_model *model = good_model();                                                           \
        lar_tool *tool = add_tool(model, "jaws");                                                  \
        assert_int_equal(lar_model_check(model, NULL), LAR_OK);                                    \
        change;                                                                                    \
        refused_and_destroyed(model, "test.yaml: tool entry 1: " words);                           \
    } while (0)
    REFUSED(tool->radius = 0, "the radius must be finite and more than zero");
    REFUSED(tool->radius = INFINITY, "the radius must be finite");
    REFUSED(tool->length = -1, "the length must be finite and more than zero");
    REFUSED(tool->length = NAN, "the length must be finite");
    REFUSED(tool->spread = 0, "the spread must be more than zero and less than 180 degrees");
    REFUSED(tool->spread = 3.2, "the spread must be");
    REFUSED(tool->shape = LAR_TOOL_SPHERE, "a sphere has no length");
    REFUSED(tool->shape = LAR_TOOL_CAPSULE, "only a grasper has a spread");
    REFUSED(tool->shape = LAR_TOOL_HAND, "the shape must be a sphere, a capsule or a grasper");
    REFUSED(tool->rest.position[1] = NAN, "its place must be finite");
    REFUSED(tool->rest.position[0] = 1e300, "its place must be finite and within 1e9 m");
    REFUSED(tool->rest.position[0] = 2e9, "its place must be finite and within 1e9 m");
    REFUSED(tool->rest.orientation[1] = 1, "its orientation must be a quaternion of length one");
    REFUSED(tool->rest.opening = 1.5, "its opening must be between 0 and 1");
    REFUSED(tool->rest.position[2] = 0.02, "the tool would begin");
    REFUSED((free(tool->name), tool->name = NULL), "the name of a tool has 1 to 63 bytes");
    REFUSED(strcpy(tool->name, "hand"), "\"hand\" is the name of the hand");
    lar_model *two = good_model();
    add_tool(two, "jaws");
    add_tool(two, "jaws");
    refused_and_destroyed(two, "tool entry 2: tool entry 1 is called \"jaws\" too");
    lar_model *many = good_model();
    for (int i = 0; i <= LAR_MODEL_TOOLS_MAX; i++) add_tool(many, (char[]){(char)('a' + i), 0});
    refused_and_destroyed(many, "test.yaml: 33 tools; there can be 32");
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
    model->move[0].screw_count = 1;
    model->move[0].screw = lar_calloc(1, sizeof *model->move[0].screw);
    model->move[0].screw[0].axis[1] = 1.5;
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
        cmocka_unit_test(test_materials),       cmocka_unit_test(test_contacts),
        cmocka_unit_test(test_tools),           cmocka_unit_test(test_conflicts),
        cmocka_unit_test(test_ranges),          cmocka_unit_test(test_numbers_and_curves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
