/* Scenes that are right: every key, every selector, what ends up in the model. The meshes are the
 * bricks of brick.h. */
#include "model/settings.h"
#include "model/scene_test.h"

static void test_node_selectors(void **state) {
    (void)state;
    selects("nodes", "{box: [[0, 0, 0], [0.02, 0, 0]]}", "0 1 2");
    selects("nodes", "{box: [[-1, -1, 0.015], [1, 0.005, 1]]}", "18 19 20");
    selects("nodes", "{sphere: {center: [0.01, 0.01, 0.01], radius: 0.0101}}",
            "4 10 12 13 14 16 22");
    selects("nodes", "{plane: {point: [0, 0, 0.02], normal: [0, 0, 5]}}",
            "18 19 20 21 22 23 24 25 26");
    selects("nodes", "{plane: {point: [0, 0, 0], normal: [1, 1, 1], tolerance: 0.006}}", "0 1 3 9");
    selects("nodes", "{nearest: [9, 9, -9]}", "8");
    selects("nodes", "{list: [27, 1, 1]}", "0 26");
    selects("nodes", "{all: [{tag: 1}, {tag: 2}]}", "9 10 11 12 13 14 15 16 17");
    selects("nodes", "{set: bottom}", "0 1 2 3 4 5 6 7 8");
    selects("nodes", "{set: lid}", "18 19 20 21 22 23 24 25 26");
    selects("nodes", "{set: upper}", "9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26");
    selects("nodes", "{not: {surface: true}}", "13");
    selects("nodes", "{any: [edge, {nearest: [0, 0, 1]}]}", "0 1 2 18");
    selects("nodes", "{all: [bottom, {not: edge}, {not: {nearest: [1, 1, 0]}}]}", "3 4 5 6 7");
}

/* A material that is covered from end to end. */
static void a_material_without_elements_is_told(void **state) {
    (void)state;
    const char *const law = "law: neo-hookean, density: 1, shear_modulus: 1, bulk_modulus: 9}\n";
    const char *const cells[][2] = {{"{tag: 1}, name: fat", "all"}, {"all", "{tag: 1}"}};
    for (int i = 0; i < 2; i++) {
        char text[600];
        snprintf(text, sizeof text, HEAD "materials:\n- {cells: %s, %s- {cells: %s, %s",
                 cells[i][0], law, cells[i][1], law);
        lar_model *model = scene(text);
        assert_int_equal(model->notice_count, 1 - i);
        if (i == 0 && !strstr(model->notice[0], ":4: the material 'fat' has no elements: later "
                                                "ones (the last in line 5) have them all; put"))
            fail_msg("%s", model->notice[0]);
        lar_model_destroy(model);
    }
}

static void test_element_selectors(void **state) {
    (void)state;
    selects("elements", "{box: [[0, 0, 0], [0.02, 0.01, 0.01]]}", "0 1");
    selects("elements", "{sphere: {center: [0.005, 0.005, 0.005], radius: 0.001}}", "0");
    selects("elements", "{plane: {point: [0.005, 0, 0], normal: [1, 0, 0]}}", "0 2 4 6");
    selects("elements", "{nearest: [1, 1, 1]}", "7");
    selects("elements", "{list: [108, 101]}", "0 7");
    selects("elements", "{tag: 2}", "4 5 6 7");
    selects("elements", "upper", "4 5 6 7");
    selects("elements", "{set: lid}", "4 5 6 7");
    selects("elements", "{not: {set: upper}}", "0 1 2 3");
    selects("elements", "{surface: true}", "0 1 2 3 4 5 6 7");
    selects("elements", "{any: [{list: [101]}, {all: [upper, {tag: 2}]}]}", "0 4 5 6 7");
}

static void test_elements_of_a_node_set(void **state) {
    (void)state;
    lar_model *model =
        scene(HEAD MATERIAL "sets:\n"
                            "  - {name: low, nodes: {box: [[0, 0, 0], [0.02, 0.01, 0.01]]}}\n"
                            "  - {name: low, elements: low}\n");
    const lar_set *set = lar_mesh_find_set(&model->mesh, "low", LAR_SET_ELEMENTS);
    assert_int_equal(set->count, 2);
    assert_int_equal(set->index[1], 1);
    lar_model_destroy(model);
}

static void test_line_ends_and_byte_order_mark(void **state) {
    (void)state;
    lar_model *model = scene("\xef\xbb\xbflariat: 1\r\nmesh: brick.vtu\r\n" MATERIAL
                             "fix:\r\n- nodes: bottom\r\n  axes: y\r\n");
    assert_int_equal(model->fix[0].axes, LAR_AXIS_Y);
    lar_model_destroy(model);
}

static void test_face_selectors(void **state) {
    (void)state;
    selects("faces", "{box: [[-1, -1, 0.02], [1, 1, 0.02]]}", "29 35 41 47");
    selects("faces", "{plane: {point: [0, 0, 0], normal: [1, 0, 0]}}", "0 12 24 36");
    selects("faces", "{set: bottom}", "4 10 16 22");
    selects("faces", "lid", "29 35 41 47");
    selects("faces", "{nearest: [0.02, 0.015, 0.005]}", "19");
    selects("faces",
            "{all: [{surface: true}, {set: upper}, {not: lid}, {not: {box: [[0, 0, 0], "
            "[1, 0, 1]]}}, {not: {plane: {point: [0.02, 0, 0], normal: [1, 0, 0]}}}]}",
            "24 36 39 45");
    selects("faces", "{all: [{tag: 1}, {set: bottom}]}", "4 10 16 22");
    selects("faces", "{sphere: {center: [0.005, 0.005, 0], radius: 0.008}}", "4");
}

static void test_whole_selections(void **state) {
    (void)state;
    lar_model *model =
        scene(HEAD MATERIAL "fix:\n"
                            "  - {nodes: all, axes: x}\n"
                            "  - {nodes: 3, axes: y}\n"
                            "  - {nodes: [27, bottom, {nearest: [0, 0, 1]}], axes: zx}\n"
                            "load: [{faces: all, pressure: 1}, {faces: [lid, {set: bottom}], "
                            "pressure: -2}]\n");
    assert_int_equal(model->fix_count, 3);
    assert_int_equal(model->fix[0].nodes.count, 27);
    assert_int_equal(model->fix[0].axes, LAR_AXIS_X);
    assert_int_equal(model->fix[1].nodes.count, 1);
    assert_int_equal(model->fix[1].nodes.node[0], 2);
    assert_int_equal(model->fix[2].nodes.count, 11);
    assert_int_equal(model->fix[2].axes, LAR_AXIS_X | LAR_AXIS_Z);
    assert_int_equal(model->pressure[0].count, 24);
    assert_int_equal(model->pressure[1].count, 8);
    same(model->pressure[1].pressure, -2.0);
    lar_model_destroy(model);
}

static void test_springs(void **state) {
    (void)state;
    lar_model *model = scene(HEAD MATERIAL "springs:\n"
                                           "  - {nodes: bottom, stiffness: 18}\n"
                                           "  - {faces: lid, stiffness: 16}\n"
                                           "  - {faces: lid, stiffness_per_area: 4.0e4}\n");
    assert_int_equal(model->spring_count, 3);
    for (int i = 0; i < 3; i++) {
        const lar_spring_bed *bed = &model->spring[i];
        assert_int_equal(bed->nodes.count, 9);
        for (int k = 0; k < 9; k++) { /* corner, edge, ... of 20 x 20 mm */
            static const double share[9] = {1, 2, 1, 2, 4, 2, 1, 2, 1};
            assert_int_equal(bed->nodes.node[k], i ? 18 + k : k);
            same(bed->stiffness[k], i ? share[k] : 2);
        }
    }
    lar_model_destroy(model);
}

static void test_gravity_with_a_course(void **state) {
    (void)state;
    double g[3];
    lar_model *model = scene(HEAD MATERIAL "gravity: {acceleration: [1, 0, -8], over: 0.2}\n");
    same(lar_model_duration(model), 0.2);
    lar_gravity_at(model, NULL, 0.1, 0, g);
    same(g[0], 0.5);
    same(g[1], 0);
    same(g[2], -4);
    lar_model_destroy(model);
    model =
        scene(HEAD MATERIAL "gravity:\n"
                            "  - {acceleration: [0, 0, -8], curve: {points: [[0, 1], [2, 0]]}}\n"
                            "  - {acceleration: [4, 0, 0], curve: {points: [[0, 0], [1, 1]]}}\n");
    lar_gravity_at(model, NULL, 0.5, 0, g);
    same(g[0], 2);
    same(g[1], 0);
    same(g[2], -6);
    lar_model_destroy(model);
    model = scene(HEAD MATERIAL "gravity: {acceleration: [0, 0, -8]}\n");
    lar_gravity_at(model, NULL, 0, 0, g);
    same(g[2], -8);
    lar_model_destroy(model);
}

static void test_plain_values(void **state) {
    (void)state;
    lar_model *model = scene(HEAD MATERIAL "title: 'A: brick'\nscale: 0.001\n"
                                           "gravity: [0, 0, -9.81]\ntime_step: 1.0e-5\n"
                                           "damping: 2.0\nduration: 3\nview: [0, 3, 4]\n"
                                           "mass_scaling: {time_step: 2e-5}\n");
    assert_string_equal(model->title, "A: brick");
    assert_string_equal(model->source, "s.yaml");
    same(model->mesh.position[26][0], 2e-5);
    same(model->gravity[2], -9.81);
    same(model->time_step, 1e-5);
    same(model->mass_step, 2e-5);
    same(model->mass_share, 0.05);
    same(model->damping, 2.0);
    same(lar_model_duration(model), 3.0);
    same(model->view[1], 0.6);
    same(model->view[2], 0.8);
    lar_model_destroy(model);
    model = scene(HEAD MATERIAL "time_step: auto\n"
                                "mass_scaling: {largest_share: 0.5, time_step: 1.0e-3}\n");
    same(model->mass_step, 1e-3);
    same(model->mass_share, 0.5);
    lar_model_destroy(model);
    model = scene(HEAD MATERIAL "mass_scaling: {strained: 0.02}\n");
    same(model->mass_step, 0.0);
    same(model->strained_share, 0.02);
    lar_model_destroy(model);
    model = scene(HEAD MATERIAL "time_step: auto\n");
    same(model->mass_step, 0.0);
    same(model->strained_share, 0.0);
    assert_string_equal(model->title, "s.yaml");
    same(model->time_step, 0.0);
    same(model->gravity[2], 0.0);
    same(hypot(model->view[0], hypot(model->view[1], model->view[2])), 0.0);
    same(lar_model_output_interval(model), 0.0);
    lar_model_destroy(model);
}

static void test_stiffening_laws(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD "materials:\n"
             "  - {cells: all, law: ogden, density: 1, c1: 2e3, m1: 1.3, c3: -5, m3: -2, "
             "bulk_modulus: 1e5}\n"
             "  - {cells: 2, law: arruda-boyce, density: 1, mu: 1e3, N: 8, bulk_modulus: 1e5}\n"
             "  - {cells: {list: [102]}, law: veronda-westmann, density: 1, c1: 300, c2: 2.5, "
             "bulk_modulus: 1e5}\n"
             "  - {cells: {list: [104]}, law: holmes-mow, density: 1, mu: 3e3, lambda: 1e3, beta: "
             "0.5}\n");
    assert_memory_equal(model->material[0].parameter, ((double[]){2e3, 1.3, 0, 0, -5, -2, 1e5}),
                        56);
    assert_memory_equal(model->material[1].parameter, ((double[]){1e3, 8, 1e5}), 24);
    same(lar_material_shear(&model->material[2]), 750);
    assert_memory_equal(model->material[3].parameter, ((double[]){3e3, 1e3, 0.5}), 24);
    lar_model_destroy(model);
}

static void test_materials(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD "materials:\n"
             "  - {cells: all, law: neo-hookean, density: 1000, youngs_modulus: 12e3, "
             "poisson_ratio: 0.45}\n"
             "  - {cells: 2, law: mooney-rivlin, density: 1100, c1: 1e3, c2: 5e2, "
             "bulk_modulus: 1e5, name: stiff}\n"
             "  - {cells: [{nearest: [0, 0, 0]}, {list: [108]}], law: coupled-neo-hookean, "
             "density: 1200, mu: 3e3, lambda: 5e3}\n"
             "  - {cells: {list: [102]}, law: coupled-neo-hookean, density: 1, shear_modulus: 3e3, "
             "bulk_modulus: 1e3}\n"
             "  - {cells: {list: [104]}, law: yeoh, density: 1, c1: 600, c2: -75, c3: 11, "
             "bulk_modulus: 1e5}\n"
             "  - {cells: {list: [103]}, law: yeoh, density: 1, youngs_modulus: 3e3, "
             "poisson_ratio: 0.25}\n");
    const int32_t expected[BRICK_ELEMENTS] = {2, 3, 5, 4, 1, 1, 1, 2};
    assert_memory_equal(model->element_material, expected, sizeof expected);
    same(lar_material_shear(&model->material[0]), 12e3 / 2.9);
    same(lar_material_bulk(&model->material[0]), 12e3 / 0.3);
    assert_string_equal(model->material[1].name, "stiff");
    same(model->material[1].parameter[1], 500.0);
    same(model->material[2].parameter[1], 5e3);
    same(model->material[3].parameter[1], -1e3);
    assert_memory_equal(model->material[4].parameter, ((double[]){600, -75, 11, 1e5}), 32);
    assert_memory_equal(model->material[5].parameter, ((double[]){600, 0, 0, 2e3}), 32);
    lar_model_destroy(model);
}

static void test_viscosity(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD "materials:\n"
             "  - {cells: all, law: neo-hookean, density: 1000, youngs_modulus: 12e3, "
             "poisson_ratio: 0.45, viscous: {part: isochoric, terms: [{g: 0.5, time: 0.1}, "
             "{time: 3, g: 1.5}]}}\n"
             "  - cells: 2\n    law: holmes-mow\n    density: 1000\n    mu: 1e3\n    lambda: 500\n"
             "    beta: 1\n    viscous:\n      part: whole\n      g0: 0.5\n      terms:\n"
             "        - {g: 0.25, time: 1e-2}\n");
    const lar_viscosity *v = &model->material[0].viscosity;
    assert_true(v->terms == 2 && v->isochoric && v->rest == 1);
    assert_true(v->share[0] == 0.5 && v->time[0] == 0.1 && v->share[1] == 1.5 && v->time[1] == 3);
    same(lar_material_instant_shear(&model->material[0]), 3 * 12e3 / 2.9);
    same(lar_material_instant_bulk(&model->material[0]), 12e3 / 0.3);
    v = &model->material[1].viscosity;
    assert_true(v->terms == 1 && !v->isochoric && v->rest == 0.5 && v->share[0] == 0.25);
    same(lar_material_shear(&model->material[1]), 500);
    same(lar_material_instant_shear(&model->material[1]), 750);
    lar_model_destroy(model);
}

static void test_rigid_motion(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL
        "move: [{nodes: lid, rigid: {axis: [0, 0, 2], point: [1, 2, 3], degrees: 90, over: 0.2}},\n"
        "       {nodes: bottom, rigid: [{axis: [1, 0, 0], by: 0.01, over: 1}, {axis: [0, 1, 0], "
        "point: [0, 0, 0], degrees: -30, by: 0.5, curve: {points: [[0, 0], [1, 1]], shape: "
        "spline}}]}]\n");
    assert_int_equal(model->move_count, 2);
    const lar_move *lid = &model->move[0], *bottom = &model->move[1];
    assert_int_equal(lid->screw_count, 1);
    assert_int_equal(lid->axes, LAR_AXIS_ALL);
    same(lid->screw[0].axis[2], 1);
    same(lid->screw[0].point[1], 2);
    same(lid->screw[0].angle, LAR_PI / 2);
    same(lid->screw[0].slide, 0);
    same(model->curve[lid->screw[0].curve].over, 0.2);
    assert_int_equal(bottom->screw_count, 2);
    same(bottom->screw[0].slide, 0.01);
    same(bottom->screw[0].angle, 0);
    same(bottom->screw[1].slide, 0.5);
    assert_int_equal(model->curve[bottom->screw[1].curve].shape, LAR_CURVE_SPLINE);
    lar_model_destroy(model);
}

static void test_motion_and_loads(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL
        "fix: [{nodes: bottom, axes: xyz}]\n"
        "move: [{nodes: lid, axes: z, by: -0.002, over: 0.25},\n"
        "       {nodes: lid, axes: x, by: 1.0e-3, curve: {points: [[0, 0], [0.1, 1], [0.4, 0.5]], "
        "shape: smooth}}]\n"
        "load: [{nodes: lid, force: [0, 9, -0.9]},\n"
        "       {nodes: 14, force_per_node: [1, 2, 3], over: 0.1},\n"
        "       {faces: lid, pressure: 500, curve: {points: [[0, 1], [0.2, 3]], shape: step}}]\n"
        "initial: [{nodes: 14, velocity: [0, 0, 0.5]}]\n");
    assert_int_equal(model->move_count, 2);
    same(model->move[0].by, -0.002);
    same(lar_curve_value(&model->curve[model->move[0].curve], 0.125), 0.5);
    same(lar_curve_value(&model->curve[model->move[1].curve], 0.05), 0.5);
    same(lar_curve_value(&model->curve[model->move[1].curve], 9.0), 0.5);
    assert_int_equal(model->load_count, 2);
    assert_int_equal(model->load[0].nodes.count, 9);
    same(model->load[0].force[1], 1.0);
    same(model->load[0].force[2], -0.1);
    same(lar_curve_value(&model->curve[model->load[0].curve], 0.0), 1.0);
    same(model->load[1].force[2], 3.0);
    same(lar_curve_value(&model->curve[model->load[1].curve], 0.05), 0.5);
    assert_int_equal(model->pressure_count, 1);
    same(lar_curve_value(&model->curve[model->pressure[0].curve], 0.1999), 1.0);
    same(lar_curve_value(&model->curve[model->pressure[0].curve], 0.2), 3.0);
    same(model->initial[0].velocity[2], 0.5);
    same(lar_model_duration(model), 0.4);
    lar_model_destroy(model);
}

/* A slanted plate in the brick, written in millimetres. */
#define PLATE LAR_TEST_BUILD "/scene_plate.obj"

static void has_embedded(const char *scene_text, double scale) {
    lar_model *model = scene(scene_text);
    lar_embedded_info info;
    double place[4][3];
    assert_int_equal(lar_model_embedded(model, &info), 1);
    assert_int_equal(info.vertices, 4);
    assert_int_equal(info.triangles, 2);
    same(info.rest[2][0], 18 * scale);
    same(info.rest[2][2], 14 * scale);
    lar_model_embedded_move(model, NULL, place);
    assert_memory_equal(place, info.rest, sizeof place);
    const int32_t *node = lar_model_element_nodes(model, info.element[2]);
    assert_memory_equal(node, model->mesh.element[info.element[2]], sizeof model->mesh.element[0]);
    lar_model_destroy(model);
}

static void write_plate(const char *text) {
    FILE *file = fopen(PLATE, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static void test_surface(void **state) {
    (void)state;
    write_plate("v 1 1 6\nv 18 2 8\nv 18 19 14\nv 1 18 10\nf 1 2 3 4\n");
    has_embedded(HEAD MATERIAL "surface: {file: " PLATE ", scale: 0.001}\n", 0.001);
    has_embedded(HEAD MATERIAL "surface: {file: " PLATE ", scale: 1.1e-3}\n", 0.0011);
    has_embedded(HEAD MATERIAL "scale: 1000\nsurface: {file: " PLATE ", scale: 1}\n", 1);
    const char *text = HEAD MATERIAL "surface: " PLATE "\n";
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_model *model = NULL;
    lar_error error = {0};
    assert_int_equal(lar_scene_parse_with("s.yaml", &bytes, brick_read, &model, &error),
                     LAR_ERROR_MODEL);
    lar_bytes_free(&bytes);
    assert_int_equal(strncmp(error.message, "s.yaml:4:10: ", 13), 0);
    assert_non_null(strstr(error.message, "another unit (scale)"));
    /* Without a scale of its own it has the scene's. */
    write_plate(
        "v 1e-3 1e-3 6e-3\nv .018 2e-3 8e-3\nv .018 .019 .014\nv 1e-3 .018 .01\nf 1 2 3 4\n");
    has_embedded(HEAD MATERIAL "scale: 10\nsurface: " PLATE "\n", 0.01);
    has_embedded(HEAD MATERIAL "scale: 10\nsurface: {file: " PLATE "}\n", 0.01);
    model = scene(HEAD MATERIAL);
    assert_int_equal(lar_model_embedded(model, NULL), 0);
    lar_model_destroy(model);
    remove(PLATE);
}

static void test_output(void **state) {
    (void)state;
    lar_model *model = scene(
        HEAD MATERIAL "output:\n  every: 0.02\n  fields: [velocity, pressure, energy]\n"
                      "  probes: [{node: 12}, {set: bottom, sum: reaction}, {nodes: bottom},\n"
                      "           {nodes: {tag: 1}, name: low}, {nodes: [1, 2]}]\n");
    same(lar_model_output_interval(model), 0.02);
    assert_int_equal(model->output.fields,
                     LAR_FIELD_VELOCITY | LAR_FIELD_PRESSURE | LAR_FIELD_ENERGY);
    assert_int_equal(model->output.probe_count, 5);
    const char *const names[] = {"node 12", "bottom reaction", "bottom", "low", "probe 5"};
    const int counts[] = {1, 9, 9, 18, 2};
    for (int i = 0; i < 5; i++) {
        assert_string_equal(model->output.probe[i].name, names[i]);
        assert_int_equal(model->output.probe[i].nodes.count, counts[i]);
        assert_int_equal(model->output.probe[i].what,
                         i == 1 ? LAR_PROBE_REACTION : LAR_PROBE_DISPLACEMENT);
    }
    assert_int_equal(model->output.probe[0].nodes.node[0], 11);
    assert_int_equal(model->notice_count, 1);
    assert_non_null(strstr(model->notice[0], "\"bottom reaction\" sums reactions, but none"));
    lar_model_destroy(model);
    model = scene(HEAD MATERIAL "fix: [{nodes: 1, axes: y}]\n"
                                "output: {probes: [{set: bottom, sum: reaction}]}\n");
    assert_int_equal(model->notice_count, 0);
    lar_model_destroy(model);
    /* What is asked for and is not there, and what is there. */
    model = scene(HEAD MATERIAL "output: {fields: [fibre_stretch], surface: true,\n"
                                "  probes: [{cells: all, mean: stress, name: mean}]}\n");
    assert_int_equal(model->notice_count, 2);
    assert_non_null(strstr(model->notice[0], "frames hold no fibres"));
    assert_non_null(strstr(model->notice[1], "frames hold no surface"));
    assert_int_equal(model->output.probe[0].what, LAR_PROBE_MEAN);
    assert_int_equal(model->output.probe[0].field, LAR_CELL_STRESS);
    assert_int_equal(model->output.probe[0].nodes.count, model->mesh.element_count);
    lar_model_destroy(model);
    model =
        scene(HEAD MATERIAL
              "tools: [{name: rod, shape: sphere, radius: 1, at: [0, 0, 9]},\n"
              "        {name: ball, shape: sphere, radius: 1, at: [0, 0, 9]}]\n"
              "output: {probes: [{tool: ball}, {energy: all},\n"
              "    {set: bottom, sum: contact, about: [1, 2, 3]}, {energy: all, name: joules}]}\n");
    const char *const called[] = {"ball", "energy", "bottom contact", "joules"};
    const int what[] = {LAR_PROBE_TOOL, LAR_PROBE_ENERGY, LAR_PROBE_CONTACT, LAR_PROBE_ENERGY};
    assert_int_equal(model->notice_count, 0);
    for (int i = 0; i < 4; i++) {
        assert_string_equal(model->output.probe[i].name, called[i]);
        assert_int_equal(model->output.probe[i].what, what[i]);
    }
    assert_int_equal(model->output.probe[0].tool, 1);
    assert_int_equal(model->output.probe[2].nodes.count, 9);
    assert_true(model->output.probe[2].moment && model->output.probe[2].about[2] == 3);
    lar_model_destroy(model);
}

static void laws_that_give_way_are_told(void **state) {
    (void)state;
    static const char *const bulk[] = {"2.6e3", "2.7e3"};
    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 HEAD "materials: [{cells: all, law: holmes-mow, density: 1, shear_modulus: 1e3, "
                      "bulk_modulus: %s}]\n",
                 bulk[i]);
        lar_model *model = scene(text);
        assert_int_equal(model->notice_count, i);
        if (i) assert_non_null(strstr(model->notice[0], "above 2667 Pa, 8/3 of the shear modulus"));
        lar_model_destroy(model);
    }
    for (int i = 0; i < 4; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 HEAD "materials: [{cells: all, law: %s, density: 1, youngs_modulus: 1e3, "
                      "poisson_ratio: %s}]\n",
                 i < 2 ? "holmes-mow" : "coupled-neo-hookean", i % 2 ? "-0.1" : "0");
        lar_model *model = scene(text);
        assert_int_equal(model->notice_count, i % 2);
        if (i % 2) assert_non_null(strstr(model->notice[0], i < 2 ? "stretched" : "pressed"));
        lar_model_destroy(model);
    }
    for (int i = 0; i < 2; i++) { /* once, however many materials */
        const char *const poisson = i ? "0.29" : "0.3";
        char text[512];
        snprintf(text, sizeof text,
                 HEAD "materials:\n"
                      "  - {cells: all, law: neo-hookean, density: 1, youngs_modulus: 1e3, "
                      "poisson_ratio: %s}\n"
                      "  - {cells: 2, law: neo-hookean, density: 1, youngs_modulus: 2e3, "
                      "poisson_ratio: %s}\n",
                 poisson, poisson);
        lar_model *model = scene(text);
        assert_int_equal(model->notice_count, i);
        if (i) assert_non_null(strstr(model->notice[0], "collapses when it is pressed"));
        lar_model_destroy(model);
    }
}

static void test_several_meshes(void **state) {
    (void)state;
    lar_model *model = scene("lariat: 1\nmesh: [brick.vtu, {file: two.vtu, tag: 9}]\n" MATERIAL
                             "fix: [{nodes: [28, 54], axes: xyz}]\n"
                             "sets: [{name: all_lids, faces: lid}]\n");
    const lar_mesh *mesh = &model->mesh;
    assert_int_equal(mesh->node_count, 2 * BRICK_NODES);
    assert_int_equal(mesh->element_count, 2 * BRICK_ELEMENTS);
    assert_int_equal(mesh->node_id[27], 28);
    assert_int_equal(mesh->element_id[8], 109);
    assert_int_equal(mesh->element[8][0], 27);
    assert_int_equal(mesh->element_tag[7], 2);
    assert_int_equal(mesh->element_tag[8], 9);
    assert_int_equal(mesh->set_count, 4);
    assert_int_equal(lar_mesh_find_set(mesh, "bottom", LAR_SET_NODES)->count, 18);
    assert_int_equal(lar_mesh_find_set(mesh, "bottom", LAR_SET_NODES)->index[9], 27);
    assert_int_equal(lar_mesh_find_set(mesh, "lid", LAR_SET_FACES)->index[7], 15 * 6 + 5);
    assert_int_equal(lar_mesh_find_set(mesh, "upper", LAR_SET_ELEMENTS)->index[4], 12);
    assert_int_equal(model->fix[0].nodes.node[1], 53);
    lar_model_destroy(model);
}

static void test_mesh_stands_beside_the_scene(void **state) {
    (void)state;
    const char *text = "lariat: 1\nmesh: bad.vtu\n" MATERIAL;
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_model *model = NULL;
    lar_error error = {0};
    assert_int_equal(lar_scene_parse_with("a/b/s.yaml", &bytes, brick_read, &model, &error),
                     LAR_ERROR_IO);
    assert_string_equal(error.message,
                        "a/b/s.yaml:2:7: a/b/bad.vtu: cannot be opened: gone; check the path");
    assert_null(model);
    lar_bytes_free(&bytes);
}

/* Every key of a scene at once, as the design of the format has them. */
static void test_every_key(void **state) {
    (void)state;
    lar_model *model = scene(
        "lariat: 1\n"
        "title: Uterus\n"
        "mesh: uterus.vtu            # relative to this file\n"
        "scale: 1.0                  # e.g. 0.001 when the mesh is in mm\n"
        "gravity: [0, 0, -9.81]\n"
        "time_step: auto             # or seconds\n"
        "damping: 2.0                # 1/s, mass-proportional\n"
        "materials:\n"
        "  - { cells: all, law: neo-hookean, density: 1050, shear_modulus: 4.0e3, "
        "bulk_modulus: 2.0e6 }\n"
        "sets:\n"
        "  - { name: base, nodes: { box: [[-1,-1,-0.001],[1,1,0.001]] } }\n"
        "  - { name: top, nodes: { box: [[-1,-1,0.019],[1,0.001,0.021]] } }\n"
        "  - { name: tip, nodes: { nearest: [0.02,0.02,0.02] } }\n"
        "  - { name: front, faces: { plane: { point: [0,0,0], normal: [0,1,0] } } }\n"
        "fix:    [ { nodes: base, axes: xyz } ]\n"
        "move:   [ { nodes: top, axes: x, by: 0.01, over: 0.2 } ]\n"
        "load:   [ { nodes: tip, force: [0,0,-0.1], over: 0.1 }, { faces: front, pressure: 500, "
        "over: 0.1 } ]\n"
        "contact: [ { self: true } ]\n"
        "tools:  [ { name: probe, shape: sphere, radius: 0.005, at: [0,0,0.1] } ]\n"
        "output: { every: 0.02, fields: [displacement, velocity, von_mises, pressure], "
        "probes: [ { node: 12 }, { set: base, sum: reaction } ] }\n");
    assert_int_equal(model->contact_count, 1);
    assert_int_equal(model->contact[0].face_count, 24);
    assert_int_equal(model->tool_count, 1);
    assert_string_equal(model->tool[0].name, "probe");
    lar_model_destroy(model);
}

/* The examples of docs/formats.md are scenes of the brick. */
static void test_documented_examples(void **state) {
    (void)state;
    lar_bytes docs = {0};
    lar_error error = {0};
    if (lar_bytes_read(LAR_TEST_FORMATS, &docs, &error)) fail_msg("%s", error.message);
    int examples = 0;
    const char *at = (const char *)docs.data;
    char *chapter_end = strstr((char *)docs.data, "\n## Gmsh");
    assert_non_null(chapter_end);
    *chapter_end = '\0';
    while ((at = strstr(at, "```yaml\n")) != NULL) {
        at += strlen("```yaml\n");
        const char *stop = strstr(at, "```");
        assert_non_null(stop);
        char *text = lar_strndup(at, (size_t)(stop - at));
        lar_model_destroy(scene(text));
        free(text);
        at = stop + 3;
        examples++;
    }
    assert_int_equal(examples, 4);
    lar_bytes_free(&docs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_node_selectors),
        cmocka_unit_test(laws_that_give_way_are_told),
        cmocka_unit_test(a_material_without_elements_is_told),
        cmocka_unit_test(test_element_selectors),
        cmocka_unit_test(test_elements_of_a_node_set),
        cmocka_unit_test(test_line_ends_and_byte_order_mark),
        cmocka_unit_test(test_face_selectors),
        cmocka_unit_test(test_whole_selections),
        cmocka_unit_test(test_springs),
        cmocka_unit_test(test_gravity_with_a_course),
        cmocka_unit_test(test_plain_values),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_stiffening_laws),
        cmocka_unit_test(test_viscosity),
        cmocka_unit_test(test_motion_and_loads),
        cmocka_unit_test(test_rigid_motion),
        cmocka_unit_test(test_surface),
        cmocka_unit_test(test_output),
        cmocka_unit_test(test_several_meshes),
        cmocka_unit_test(test_mesh_stands_beside_the_scene),
        cmocka_unit_test(test_every_key),
        cmocka_unit_test(test_documented_examples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
