/* Contact and tools of scenes. */
#include "model/scene_test.h"

static void test_contact(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL "contact:\n"
                      "  - {self: true}\n"
                      "  - {self: lid}\n"
                      "  - {self: all}\n"
                      "  - {between: [lid, bottom]}\n"
                      "  - {faces: [lid, bottom], plane: {through: [0, 0, -0.001], normal: "
                      "[0, 0, 2]}}\n"
                      "  - {faces: all, plane: {through: [5, 0, 0.02], normal: [0, 0, -1]}}\n");
    assert_int_equal(model->contact_count, 6);
    const lar_contact *c = model->contact;
    const int kind[] = {LAR_CONTACT_SELF,    LAR_CONTACT_SELF,  LAR_CONTACT_SELF,
                        LAR_CONTACT_BETWEEN, LAR_CONTACT_PLANE, LAR_CONTACT_PLANE};
    const int faces[] = {24, 4, 24, 4, 8, 24};
    for (int i = 0; i < 6; i++) {
        assert_int_equal(c[i].kind, kind[i]);
        assert_int_equal(c[i].face_count, faces[i]);
        assert_int_equal(c[i].against_count, i == 3 ? 4 : 0);
    }
    assert_memory_equal(c[0].face, model->surface.face, 24 * sizeof(int32_t));
    assert_memory_equal(c[2].face, model->surface.face, 24 * sizeof(int32_t));
    assert_int_equal(c[3].face[0], 4 * 6 + 5);
    assert_int_equal(c[3].against[0], 4);
    same(c[4].through[2], -0.001);
    same(c[4].normal[2], 1);
    same(c[5].normal[2], -1);
    lar_model_destroy(model);
}

/* Where a tool's axis `axis` points. */
static void axis_of(const lar_tool *tool, int axis, double out[3]) {
    const double *q = tool->rest.orientation;
    double column[3][3] = {{1 - 2 * (q[2] * q[2] + q[3] * q[3]), 2 * (q[1] * q[2] + q[0] * q[3]),
                            2 * (q[1] * q[3] - q[0] * q[2])},
                           {2 * (q[1] * q[2] - q[0] * q[3]), 1 - 2 * (q[1] * q[1] + q[3] * q[3]),
                            2 * (q[2] * q[3] + q[0] * q[1])},
                           {2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]),
                            1 - 2 * (q[1] * q[1] + q[2] * q[2])}};
    memcpy(out, column[axis], sizeof column[axis]);
}

static void points(const lar_tool *tool, int axis, double x, double y, double z) {
    double v[3], length = sqrt(x * x + y * y + z * z);
    axis_of(tool, axis, v);
    same(v[0], x / length);
    same(v[1], y / length);
    same(v[2], z / length);
}

/* It stands in the middle of the nodes that it moves, as a part of the list of motions. */
static void test_rigid_tools(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL
        "tools:\n"
        "  - {name: base, shape: rigid, nodes: {box: [[-1, -1, -1], [1, 1, 0.001]]}}\n"
        "  - {name: top, shape: rigid, nodes: {box: [[-1, -1, 0.019], [1, 1, 1]]},\n"
        "     at: [0.01, 0.01, 0.05], path: [[0, 0.01, 0.01, 0.05], [1, 0.01, 0.02, 0.05]]}\n");
    assert_int_equal(model->tool_count, 2);
    assert_int_equal(model->move_count, 2);
    const lar_tool *tool = model->tool;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(tool[i].shape, LAR_TOOL_RIGID);
        assert_int_equal(model->move[i].tool, i + 1);
        assert_int_equal(model->move[i].nodes.count, 9);
        assert_int_equal(model->move[i].axes, LAR_AXIS_ALL);
        same(tool[i].radius, 0.01);
        for (int k = 0; k < 2; k++) same(tool[i].rest.position[k], 0.01);
    }
    same(tool[0].rest.position[2], 0);
    same(tool[0].length, 0.01 * sqrt(2));
    same(tool[1].rest.position[2], 0.05);
    same(tool[1].length, sqrt(0.0009 + 0.0002));
    lar_model_destroy(model);
}

static void test_tools(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL
        "tools:\n"
        "  - {name: probe, shape: sphere, radius: 0.005, at: [0.01, 0.01, 0.025]}\n"
        "  - {name: stick, shape: capsule, radius: 0.003, length: 0.2, at: [-0.01, 0, 0], towards: "
        "[2, 0, 0]}\n"
        "  - {name: up, shape: capsule, radius: 0.003, length: 0.2, at: [0, 0, -0.01], towards: "
        "[0, 0, 1]}\n"
        "  - {name: any, shape: capsule, radius: 0.003, length: 0.2, at: [1, 1, 1], towards: "
        "[-3, 2, 6]}\n"
        "  - {name: jaws, shape: grasper, radius: 0.001, length: 0.02, at: [0, 0, 0.1]}\n"
        "  - {name: turned, shape: grasper, radius: 0.001, length: 0.02, spread: 90, turn: 90,\n"
        "     at: [0, 0, 0.1], towards: [0, 1, 0]}\n");
    assert_int_equal(lar_model_tool_count(model), 6);
    const char *const names[] = {"probe", "stick", "up", "any", "jaws", "turned"};
    lar_tool_info info;
    for (int i = 0; i < 6; i++) {
        assert_int_equal(lar_model_tool(model, i, &info, NULL), LAR_OK);
        assert_string_equal(info.name, names[i]);
        same(info.rest.opening, 1);
    }
    const lar_tool *tool = model->tool;
    assert_int_equal(tool[0].shape, LAR_TOOL_SPHERE);
    assert_int_equal(tool[1].shape, LAR_TOOL_CAPSULE);
    assert_int_equal(tool[4].shape, LAR_TOOL_GRASPER);
    same(tool[0].radius, 0.005);
    same(tool[0].length, 0);
    same(tool[0].rest.position[2], 0.025);
    same(tool[1].length, 0.2);
    same(tool[1].spread, 0);
    same(tool[4].spread, acos(-1) / 3);
    same(tool[5].spread, acos(-1) / 2);
    points(&tool[0], 2, 0, 0, 1);
    points(&tool[1], 2, -1, 0, 0); /* the shaft lies behind the tip */
    points(&tool[2], 2, 0, 0, -1);
    points(&tool[3], 2, 3, -2, -6);
    points(&tool[4], 0, 1, 0, 0); /* the jaws open along the tool's own x */
    points(&tool[5], 2, 0, -1, 0);
    points(&tool[5], 0, 0, 0, 1);
    lar_model_destroy(model);
}

static void free_scene(const char *free, const char *contact, lar_model **model, lar_error *error) {
    char text[900];
    snprintf(text, sizeof text,
             HEAD MATERIAL
             "contact: [{faces: %s, plane: {through: [0, 0, -1], normal: [0, 0, 1]}}]\n"
             "tools: [{name: base, shape: rigid,\n"
             "  nodes: {box: [[-1, -1, -1], [1, 1, 0.001]]}, free: %s}]\n",
             contact, free);
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    *model = NULL;
    lar_scene_parse_with("s.yaml", &bytes, brick_read, model, error);
    lar_bytes_free(&bytes);
}

/* What nobody leads: along axes, about a point, about an axis; planes stop it as a body. */
static void test_free_bodies(void **state) {
    (void)state;
    static const struct {
        const char *free;
        unsigned bits;
    } known[] = {{"all", LAR_AXIS_ALL | LAR_FREE_TURNS},
                 {"z", LAR_AXIS_Z},
                 {"xyz", LAR_AXIS_ALL},
                 {"{point: [1, 2, 3]}", LAR_FREE_TURNS},
                 {"{point: [1, 2, 3], axis: [0, 2, 0]}", LAR_FREE_TURNS}};
    static const char *const wrong[][2] = {
        {"true", "free: expected some of the letters x, y, z"},
        {"{axis: [0, 0, 1]}", "a joint needs the key \"point\""},
        {"{point: 1}", "point"},
        {"{point: [0, 0, 0], axis: [0, 0, 0]}", "axis"},
        {"all, path: [[0, 0, 0, 0], [1, 0, 0, 0.1]]", "a body that has a path is led"}};
    lar_model *model;
    lar_error error;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        free_scene(known[i].free, "lid", &model, &error);
        if (!model) fail_msg("%s", error.message);
        const lar_tool *tool = model->tool;
        assert_int_equal(tool->free, known[i].bits);
        assert_int_equal(model->notice_count, 0);
        assert_int_equal(tool->planes, 0);
        if (known[i].bits == LAR_FREE_TURNS) same(tool->point[2], 3);
        same(tool->axis[1], i == 4 ? 1 : 0);
        lar_model_destroy(model);
    }
    free_scene("all", "bottom", &model, &error);
    assert_int_equal(model->notice_count, 0);
    assert_int_equal(model->tool[0].planes, 1);
    lar_model_destroy(model);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        free_scene(wrong[i][0], "lid", &model, &error);
        assert_null(model);
        if (!strstr(error.message, wrong[i][1])) fail_msg("%s", error.message);
    }
}

/* Tools that just touch, at faces, edges and corners, and in between jaws, are outside. */
static void test_tools_beside_the_body(void **state) {
    (void)state;
    static const char *const beside[] = {
        "shape: sphere, radius: 0.005, at: [-0.005, 0.013, 0.007]",
        "shape: sphere, radius: 0.005, at: [-0.003, 0.01, -0.004]",
        "shape: sphere, radius: 0.007, at: [0.022, 0.023, -0.006]",
        "shape: capsule, radius: 0.002, length: 1, at: [0.5, 0.01, 0.022], towards: [1, 0, 0]",
        ("shape: capsule, radius: 0.0141421356, length: 1, at: [0.265, 0.28, -0.22], "
         "towards: [1, 1, -1]"),
        "shape: grasper, radius: 0.001, length: 0.04, spread: 120, at: [0.01, 0.01, 0.037]"};
    for (size_t i = 0; i < sizeof beside / sizeof beside[0]; i++) {
        char text[600];
        snprintf(text, sizeof text, HEAD MATERIAL "tools: [{name: a, %s}]\n", beside[i]);
        lar_model_destroy(scene(text));
    }
}

/* A thin tool finds its way between the points at which a face of 10 mm feels it. */
static void test_thin_tools(void **state) {
    (void)state;
    lar_model *model =
        scene(HEAD MATERIAL "tools:\n"
                            "  - {name: enough, shape: sphere, radius: 0.0012, at: [0, 0, 1]}\n"
                            "  - {name: thin, shape: sphere, radius: 0.0011, at: [0, 0, 1]}\n");
    assert_int_equal(model->notice_count, 1);
    assert_string_equal(model->notice[0],
                        "s.yaml: the tool \"thin\" has a radius of 0.0011 m, and the surface has "
                        "edges of up to 0.01 m: large faces feel it only where it meets one of "
                        "their 36 points; give it a radius of 0.0012 m, or refine the mesh");
    lar_model_destroy(model);
}

/* A plane stops the bodies whose faces its entry names, and no others, however the scene is
 * written: in one line, here. */
static void test_planes_of_bodies(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL
        "contact: [{faces: bottom, plane: {through: [0, 0, -1], normal: [0, 0, 1]}}, {faces: all, "
        "restitution: 0.5, plane: {through: [0, 0, -2], normal: [0, 0, 1]}}]\n"
        "tools: [{name: base, shape: rigid, nodes: {box: [[-1, -1, -1], [1, 1, 0.001]]}, free: "
        "all}, "
        "{name: top, shape: rigid, nodes: {box: [[-1, -1, 0.019], [1, 1, 1]]}, free: all}]\n");
    assert_int_equal(model->tool[0].planes, 3);
    assert_int_equal(model->tool[1].planes, 2);
    same(model->contact[1].restitution, 0.5);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_contact),          cmocka_unit_test(test_tools),
        cmocka_unit_test(test_rigid_tools),      cmocka_unit_test(test_tools_beside_the_body),
        cmocka_unit_test(test_thin_tools),       cmocka_unit_test(test_free_bodies),
        cmocka_unit_test(test_planes_of_bodies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
