/* lar_model_open: scenes, bare meshes and what it refuses, with files on the disk. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "model/model.h"

#define FOLDER LAR_TEST_BUILD "/open"

static const char mesh_text[] = "# vtk DataFile Version 3.0\none cube\nASCII\n"
                                "DATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
                                "0 0 0 10 0 0 10 10 0 0 10 0\n0 0 10 10 0 10 10 10 10 0 10 10\n"
                                "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n";

static void write_file(const char *name, const char *text) {
    char path[600];
    mkdir(FOLDER, 0777);
    snprintf(path, sizeof path, "%s/%s", FOLDER, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    fclose(file);
}

static lar_status open_model(const char *name, lar_model **model, lar_error *error) {
    char path[600];
    snprintf(path, sizeof path, "%s/%s", FOLDER, name);
    *model = NULL;
    return lar_model_open(path, model, error);
}

static void test_scene_with_its_mesh(void **state) {
    (void)state;
    static const char *const names[] = {"cube.yaml", "cube.YML"};
    for (int i = 0; i < 2; i++) {
        lar_model *model;
        lar_error error = {0};
        write_file("cube.vtk", mesh_text);
        write_file(names[i], "lariat: 1\nmesh: cube.vtk\nscale: 0.001\n"
                             "materials: [{cells: all, law: neo-hookean, density: 1000, "
                             "shear_modulus: 4e3, bulk_modulus: 4e5}]\n"
                             "fix: [{nodes: {box: [[0, 0, 0], [0.01, 0.01, 0]]}, axes: xyz}]\n");
        if (open_model(names[i], &model, &error)) fail_msg("%s", error.message);
        assert_int_equal(model->mesh.node_count, 8);
        assert_int_equal(model->fix[0].nodes.count, 4);
        assert_true(lar_model_positions(model)[6][2] == 0.01);
        lar_model_destroy(model);
    }
}

static void test_bare_mesh(void **state) {
    (void)state;
    lar_model *model;
    lar_error error = {0};
    write_file("cube.vtk", mesh_text);
    if (open_model("cube.vtk", &model, &error)) fail_msg("%s", error.message);
    assert_string_equal(model->title, "cube.vtk");
    assert_int_equal(model->material_count, 1);
    assert_int_equal(model->element_material[0], 0);
    assert_int_equal(model->material[0].law, LAR_LAW_neo_hookean);
    assert_true(model->material[0].density == 1050.0);
    assert_true(lar_material_shear(&model->material[0]) == 4.0e3);
    assert_true(lar_material_bulk(&model->material[0]) == 4.0e5);
    assert_int_equal(model->fix_count + model->move_count + model->load_count, 0);
    assert_true(lar_model_duration(model) == 0.0);
    lar_model_destroy(model);
}

static void refuses(const char *name, lar_status status, const char *words) {
    lar_model *model;
    lar_error error = {0};
    assert_int_equal(open_model(name, &model, &error), status);
    assert_null(model);
    if (!strstr(error.message, words)) fail_msg("\"%s\" lacks \"%s\"", error.message, words);
}

static void test_refusals(void **state) {
    (void)state;
    write_file("empty.yaml", "");
    write_file("model.stl", "solid");
    write_file("noext", "x");
    write_file("lost.yaml", "lariat: 1\nmesh: lost.vtu\nmaterials: []\n");
    write_file("self.yaml", "lariat: 1\nmesh: self.yaml\nmaterials: []\n");
    write_file("wrong.vtk", "# vtk DataFile Version 3.0\n");
    refuses("missing.yaml", LAR_ERROR_IO, "missing.yaml: cannot be opened");
    refuses("missing.vtk", LAR_ERROR_IO, "missing.vtk: cannot be opened");
    refuses("empty.yaml", LAR_ERROR_FORMAT, "empty");
    refuses("model.stl", LAR_ERROR_ARGUMENT, "the extension \".stl\" is not known; give a scene");
    refuses("noext", LAR_ERROR_ARGUMENT, "has no extension");
    refuses("lost.yaml", LAR_ERROR_IO, "lost.yaml:2:7: ");
    refuses("lost.yaml", LAR_ERROR_IO, "lost.vtu: cannot be opened");
    lar_model *model;
    lar_error error = {0};
    assert_int_not_equal(open_model("self.yaml", &model, &error), LAR_OK);
    assert_non_null(strstr(error.message, "self.yaml:2:7: "));
    assert_int_not_equal(open_model("wrong.vtk", &model, &error), LAR_OK);
    assert_null(model);
    assert_int_equal(lar_model_open(NULL, &model, NULL), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_model_open("x.yaml", NULL, NULL), LAR_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scene_with_its_mesh),
        cmocka_unit_test(test_bare_mesh),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
