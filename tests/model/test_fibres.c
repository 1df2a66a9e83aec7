/* Fibres of materials and their directions, from scenes, meshes and FEBio decks; and what is said
 * where they cannot be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "brick.h"
#include "model/format/mesh_io.h"
#include "model/scene/scene.h"

#define TISSUE "cells: all, law: yeoh, density: 1000, shear_modulus: 1e3, bulk_modulus: 1e5"
#define SCENE(fibres)                                                                              \
    "lariat: 1\nmesh: brick.vtu\nmaterials:\n  - {" TISSUE ", fibres: {" fibres "}}\n"
#define POW    "law: exp-pow, part: isochoric, ksi: 300, alpha: 1.5, beta: 2.5, "
#define LINEAR "law: exp-linear, part: whole, c3: 40, c4: 12, c5: 3e3, lam_max: 1.2, "

static lar_status parse(const char *text, lar_model **model, lar_error *error) {
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_status status = lar_scene_parse_with("s.yaml", &bytes, brick_read, model, error);
    lar_bytes_free(&bytes);
    return status;
}

static lar_model *scene(const char *text) {
    lar_model *model = NULL;
    lar_error error = {0};
    if (parse(text, &model, &error)) fail_msg("%s", error.message);
    return model;
}

static void near(const double a[3], double x, double y, double z) {
    if (!(fabs(a[0] - x) + fabs(a[1] - y) + fabs(a[2] - z) < 1e-12))
        fail_msg("%g %g %g instead of %g %g %g", a[0], a[1], a[2], x, y, z);
}

static void scenes_say_laws_and_directions(void **state) {
    (void)state;
    lar_model *model = scene(SCENE(POW "direction: {axis: [0, 3, 4]}"));
    const lar_fibre *f = &model->material[0].fibre;
    assert_true(f->law == LAR_FIBRE_EXP_POW && f->isochoric && f->line == 4);
    assert_true(f->parameter[0] == 300 && f->parameter[1] == 1.5 && f->parameter[2] == 2.5);
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        near(lar_model_fibre(model, e), 0, 0.6, 0.8);
    lar_model_destroy(model);
    model = scene(SCENE(LINEAR "direction: {around: {point: [0.01, 0.01, 0], axis: [0, 0, 2]}}"));
    f = &model->material[0].fibre;
    assert_true(f->law == LAR_FIBRE_EXP_LINEAR && !f->isochoric && f->parameter[3] == 1.2);
    lar_model_destroy(model);
    model = scene(SCENE("law: pow-linear, part: whole, E: 2e3, lam0: 1.05, beta: 2.5, direction: "
                        "{around: {point: [0.01, 0.01, 0], axis: [0, 0, 2]}}"));
    f = &model->material[0].fibre;
    assert_true(f->law == LAR_FIBRE_POW_LINEAR && !f->isochoric && f->parameter[0] == 2e3);
    assert_true(f->parameter[1] == 1.05 && f->parameter[2] == 2.5);
    const double s = sqrt(0.5); /* element 0 lies at -x -y of the axis */
    near(lar_model_fibre(model, 0), s, -s, 0);
    lar_model_destroy(model);
}

#define HGO "law: hgo, part: isochoric, k1: 2e3, k2: 1.5, kappa: 0.2, "

static void scenes_say_a_second_family(void **state) {
    (void)state;
    lar_model *model = scene(SCENE(HGO "direction: {axis: [0, 3, 4]}, second: {axis: [0, 3, -4]}"));
    const lar_fibre *f = &model->material[0].fibre;
    double both[6];
    assert_true(f->law == LAR_FIBRE_HGO && f->isochoric && f->paired);
    assert_true(f->parameter[0] == 2e3 && f->parameter[1] == 1.5 && f->parameter[2] == 0.2);
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        lar_model_fibres(model, e, both);
        near(both, 0, 0.6, 0.8);
        near(both + 3, 0, 0.6, -0.8);
    }
    lar_model_destroy(model);
    model = scene(SCENE(HGO "direction: {axis: [1, 0, 0]}, active: {along: 50}, second: {around: "
                            "{point: [0.01, 0.01, 0], axis: [0, 0, 2]}}"));
    assert_true(model->material[0].fibre.paired && model->material[0].fibre.along == 50);
    const double s = sqrt(0.5);
    near(model->mesh.second[0], s, -s, 0);
    lar_model_destroy(model);
    model = scene(SCENE(HGO "direction: {axis: [1, 0, 0]}"));
    assert_true(!model->material[0].fibre.paired && !model->mesh.second);
    lar_model_destroy(model);
}

static void scenes_say_what_is_active(void **state) {
    (void)state;
    lar_model *model = scene(SCENE("active: {along: 2e3}, direction: {axis: [0, 0, 1]}"));
    const lar_fibre *f = &model->material[0].fibre;
    assert_true(f->law == LAR_FIBRE_NONE && f->along == 2e3 && f->across == 0);
    lar_model_destroy(model);
    model = scene(SCENE(POW "active: {along: 2e3, across: 1e3}, direction: {axis: [0, 0, 1]}"));
    f = &model->material[0].fibre;
    assert_true(f->law == LAR_FIBRE_EXP_POW && f->along == 2e3 && f->across == 1e3);
    lar_model_destroy(model);
}

static void scenes_say_when_it_is_active(void **state) {
    (void)state;
    lar_model *model = scene(
        SCENE("active: {along: 2e3, curve: {points: [[0, 0], [0.1, 1]]}, wave: {direction: [0, 0, "
              "2], speed: 0.5, length: 0.02, every: 0.1, rest: 0.2}}, direction: {axis: [0, 0, "
              "1]}"));
    const lar_activation *a = &model->material[0].activation;
    assert_int_equal(a->curve, 1);
    assert_int_equal(model->curve[0].count, 2);
    assert_true(a->wave.speed == 0.5 && a->wave.length == 0.02 && a->wave.every == 0.1);
    assert_true(a->wave.rest == 0.2 && a->wave.direction[2] == 1);
    lar_model_destroy(model);
    model = scene(SCENE("active: {along: 2e3, over: 0.3}, direction: {axis: [0, 0, 1]}"));
    assert_int_equal(model->material[0].activation.curve, 1);
    assert_true(model->curve[0].over == 0.3 && lar_model_duration(model) == 0.3);
    lar_model_destroy(model);
}

static void the_last_material_has_its_own_rule(void **state) {
    (void)state;
    lar_model *model =
        scene(SCENE(POW "direction: {axis: [1, 0, 0]}") "  - {cells: 2, law: yeoh, "
                                                        "density: 1000, shear_modulus: 1e3, "
                                                        "bulk_modulus: 1e5, fibres: {" POW
                                                        "direction: {axis: [0, 1, 0]}}}\n");
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        near(lar_model_fibre(model, e), model->element_material[e] == 0, model->element_material[e],
             0);
    lar_model_destroy(model);
}

#define WAVE "direction: mesh, active: {along: 1, wave: {direction: [1, 0, 0], "
static void scenes_say_what_is_wrong(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {SCENE("part: whole"), "fibres needs the key \"law\""},
        {SCENE("part: whole, direction: mesh, active: {along: 1}"),
         "part: of fibres that are only active there is none; remove it"},
        {SCENE("law: exp-pow, part: whole, ksi: 1, alpha: 0, beta: 2"),
         "fibres needs the key \"direction\""},
        {SCENE("law: exp-pov, part: whole, direction: mesh"), "did you mean exp-pow"},
        {SCENE("law: exp-pow, part: deviator, direction: mesh"), "the parts are: isochoric, whole"},
        {SCENE("law: exp-pow, part: whole, ksi: 1, alpha: 0, direction: mesh"),
         "need beta; add it"},
        {SCENE("law: pow-linear, part: whole, E: 1, lam0: 1.1, direction: mesh"),
         "fibres of the law pow-linear need beta; add it"},
        {SCENE("law: pow-linear, part: whole, E: 1, beta: 2, direction: mesh"), "need lam0"},
        {SCENE("law: pow-linear, part: whole, lam0: 1.1, beta: 2, direction: mesh"), "need E"},
        {SCENE("law: pow-linear, part: whole, E: 1, lam0: 1.1, beta: 2, alpha: 1, direction: mesh"),
         "alpha is no parameter of the law pow-linear"},
        {SCENE(POW "lam0: 1.1, direction: mesh"), "lam0 is no parameter of the law exp-pow"},
        {SCENE(LINEAR "beta: 2, direction: mesh"), "beta is no parameter of the law exp-linear"},
        {SCENE("law: pow-linear, part: whole, E: -1, lam0: 1.1, beta: 2, direction: mesh"),
         "E is -1"},
        {SCENE("law: pow-linear, part: whole, E: .nan, lam0: 1.1, beta: 2, direction: mesh"),
         "not a finite number"},
        {SCENE("law: pow-linear, part: whole, E: 1e3, lam0: 1, beta: 2, direction: {axis: [1, 0, "
               "0]}"),
         "lam0 must be above 1, and at most 20"},
        {SCENE("law: pow-linear, part: whole, E: 1e3, lam0: 1.1, beta: 1.9, direction: {axis: [1, "
               "0, 0]}"),
         "beta must be between 2 and 20"},
        {SCENE("law: pow-linear, part: whole, E: 1e14, lam0: 1.1, beta: 2, direction: {axis: [1, "
               "0, 0]}"),
         "E, in pascal, must not be negative, nor a million"},
        {SCENE(POW "c3: 1, direction: mesh"), "c3 is no parameter of the law exp-pow"},
        {SCENE("active: {}, direction: mesh"), "give \"along\" or \"across\" the fibres"},
        {SCENE("active: {along: -1}, direction: mesh"), "along is -1"},
        {SCENE("active: {along: 1}, ksi: 3, direction: mesh"),
         "ksi is no parameter of the law none"},
        {SCENE("active: {along: 1, curve: 2}, direction: mesh"), "curve"},
        {SCENE("active: {along: 1, over: 1, curve: {points: [[0, 0]]}}, direction: mesh"),
         "say the same thing in two ways"},
        {SCENE("active: {along: 1, curve: {points: [[0, 0], [1, 2]]}}, direction: {axis: [1, 0, "
               "0]}"),
         "follows a curve with values below 0 or above 1"},
        {SCENE("active: {along: 1, curve: {points: [[0, .nan]]}}, direction: mesh"),
         "not a finite number"},
        {SCENE("active: {along: 1, wave: {}}, direction: mesh"), "needs the key \"direction\""},
        {SCENE("active: {along: 1, wave: 3}, direction: mesh"), "a wave"},
        {SCENE(WAVE "speed: 1, length: 0}}"), "length is 0"},
        {SCENE(WAVE "speed: 1, length: -1}}"), "length is -1"},
        {SCENE(WAVE "speed: 0, length: 1}}"), "speed is 0"},
        {SCENE(WAVE "speed: -1, length: 1}}"), "speed is -1"},
        {SCENE(WAVE "speed: .nan, length: 1}}"), "not a finite number"},
        {SCENE(WAVE "speed: 1, length: 1, every: 0.5}}"), "pulses do not overlap"},
        {SCENE(WAVE "speed: 1, length: 1, rest: 1.5}}"), "rest: 1.5"},
        {SCENE(WAVE "speed: 1, length: 1, turns: 2}}"), "turns"},
        {SCENE("direction: mesh, active: {along: 1, wave: {direction: [0, 0, 0], speed: 1, "
               "length: 1}}"),
         "direction"},
        {SCENE(POW "twist: 1, direction: mesh"), "twist"},
        {SCENE(HGO "kappa: 0.1, direction: mesh"), "kappa"},
        {SCENE("law: hgo, part: isochoric, k1: 1, k2: 1, direction: mesh"), "need kappa; add it"},
        {SCENE("law: hgo, part: whole, k1: 1, k2: 1, kappa: 0, direction: {axis: [1, 0, 0]}"),
         "one of the isochoric part of the stretch"},
        {SCENE("law: hgo, part: isochoric, k1: 1, k2: 1, kappa: 0.4, direction: {axis: [1, 0, 0]}"),
         "kappa must be between 0"},
        {SCENE("law: hgo, part: isochoric, k1: -1, k2: 1, kappa: 0, direction: {axis: [1, 0, 0]}"),
         "k1 is -1"},
        {SCENE("law: hgo, part: isochoric, k1: 1, k2: 2e4, kappa: 0, direction: {axis: [1, 0, 0]}"),
         "k2 must be between 0 and 10000"},
        {SCENE(POW "k2: 1, direction: mesh"), "k2 is no parameter of the law exp-pow"},
        {SCENE(HGO "direction: {axis: [1, 0, 0]}, second: mesh"), "cell array \"fibre2\""},
        {SCENE(HGO "direction: {axis: [1, 0, 0]}, second: {}"), "second: expected mesh, {axis"},
        {SCENE(HGO "direction: {axis: [1, 0, 0]}, second: {axis: [0, 0, 0]}"), "axis"},
        {SCENE(HGO "direction: {axis: [1, 0, 0]}, second: {around: {point: [0.005, 0.005, 0], "
                   "axis: [0, 0, 1]}}"),
         "the centre of element 101 lies on the axis, and nothing leads around it there"},
        {SCENE("active: {along: 1}, direction: mesh, second: mesh"),
         "only fibres of the law hgo can have a second family"},
        {SCENE(POW "direction: {axis: [1, 0, 0]}, second: {axis: [0, 1, 0]}"),
         "only fibres of the law hgo can have a second family"},
        {SCENE(POW "direction: mesh"), "no mesh has directions"},
        {SCENE(POW "direction: {}"), "direction: expected mesh, {axis: [x, y, z]}"},
        {SCENE(POW "direction: {axis: [0, 0, 0]}"), "axis"},
        {SCENE(POW "direction: {axis: [1, 0]}"), "axis"},
        {SCENE(POW "direction: {axis: [.nan, 0, 1]}"), "not a finite number"},
        {SCENE(POW "direction: {around: {point: [0.005, 0.005, 0], axis: [0, 0, 1]}}"),
         "the centre of element 101 lies on the axis, and nothing leads around it there"},
        {SCENE("law: exp-pow, part: whole, ksi: 300, alpha: 1, beta: 1.5, direction: {axis: [1, 0, "
               "0]}"),
         "beta must be between 2 and 20"},
        {SCENE("law: exp-pow, part: whole, ksi: -3, alpha: 1, beta: 2, direction: {axis: [1, 0, "
               "0]}"),
         "ksi is -3"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lar_model *model = NULL;
        lar_error error = {0};
        assert_int_not_equal(parse(wrong[i][0], &model, &error), LAR_OK);
        if (!strstr(error.message, wrong[i][1]) || strncmp(error.message, "s.yaml:4:", 9) != 0)
            fail_msg("\"%s\" lacks \"%s\"", error.message, wrong[i][1]);
    }
}

/* ---- VTU ------------------------------------------------------------------------------------ */

#define FILE_NAME LAR_TEST_BUILD "/fibres.vtu"

static void write_fibres(double first) {
    lar_mesh mesh = {0};
    lar_error error;
    assert_int_equal(brick_read("brick.vtu", 1, &mesh, &error), LAR_OK);
    double *value = lar_calloc((size_t)mesh.element_count, 3 * sizeof *value);
    for (int32_t e = 0; e < mesh.element_count; e++) {
        value[3 * e] = e == 3 ? first : 2;
        value[3 * e + 1] = e == 3 ? 0 : e;
    }
    const lar_vtu_array array = {"fibre", 3, value};
    const lar_vtu_frame frame = {.mesh = &mesh, .cell_array = &array, .cell_array_count = 1};
    if (lar_vtu_write(FILE_NAME, &frame, &error)) fail_msg("%s", error.message);
    free(value);
    lar_mesh_clear(&mesh);
}

static void meshes_bring_directions(void **state) {
    (void)state;
    static const char text[] =
        "lariat: 1\nmesh: [" FILE_NAME ", " FILE_NAME "]\nmaterials:\n  - {" TISSUE
        ", fibres: {" POW "direction: mesh}}\n";
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_model *model = NULL;
    lar_error error;
    write_fibres(2);
    if (lar_scene_parse("s.yaml", &bytes, &model, &error)) fail_msg("%s", error.message);
    int32_t half = model->mesh.element_count / 2;
    for (int32_t e = 0; e < 2 * half; e++) {
        double y = e % half == 3 ? 0 : e % half, length = sqrt(4 + y * y);
        near(lar_model_fibre(model, e), 2 / length, y / length, 0);
    }
    lar_model_destroy(model);
    const double bad[2] = {0, NAN};
    for (int i = 0; i < 2; i++) {
        write_fibres(bad[i]);
        assert_int_not_equal(lar_scene_parse("s.yaml", &bytes, &model, &error), LAR_OK);
        assert_non_null(strstr(error.message, i ? "direction is not finite" : "is 0, 0, 0"));
        assert_non_null(strstr(error.message, "element 3 "));
    }
    lar_bytes_free(&bytes);
}

/* Two meshes, of which the second one has no second family, written and read once more. */
static void meshes_bring_second_families(void **state) {
    (void)state;
    lar_mesh mesh = {0}, back = {0};
    lar_error error;
    assert_int_equal(brick_read("brick.vtu", 1, &mesh, &error), LAR_OK);
    size_t count = (size_t)mesh.element_count;
    mesh.fibre = lar_calloc(count, sizeof *mesh.fibre);
    mesh.second = lar_calloc(count, sizeof *mesh.second);
    for (size_t e = 0; e < count; e++) mesh.fibre[e][2] = mesh.second[e][1] = 1 + (double)e;
    const lar_vtu_frame frame = {.mesh = &mesh};
    if (lar_vtu_write(FILE_NAME, &frame, &error)) fail_msg("%s", error.message);
    if (lar_mesh_read(FILE_NAME, 1, &back, &error)) fail_msg("%s", error.message);
    for (size_t e = 0; e < count; e++) {
        near(back.fibre[e], 0, 0, 1 + (double)e);
        near(back.second[e], 0, 1 + (double)e, 0);
    }
    lar_mesh_clear(&mesh);
    lar_mesh_clear(&back);
    static const char text[] =
        "lariat: 1\nmesh: [" FILE_NAME ", " FILE_NAME "]\nmaterials:\n  - {" TISSUE
        ", fibres: {" HGO "direction: mesh, second: mesh}}\n";
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_model *model = NULL;
    if (lar_scene_parse("s.yaml", &bytes, &model, &error)) fail_msg("%s", error.message);
    assert_int_equal(model->mesh.element_count, 2 * count);
    near(model->mesh.second[2 * count - 1], 0, 1, 0);
    lar_model_destroy(model);
    lar_bytes_free(&bytes);
}

/* ---- decks ---------------------------------------------------------------------------------- */

#define NODES                                                                                      \
    "<Nodes name=\"all\"><node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node>"                   \
    "<node id=\"3\">1,1,0</node><node id=\"4\">0,1,0</node><node id=\"5\">0,0,1</node>"            \
    "<node id=\"6\">1,0,1</node><node id=\"7\">1,1,1</node><node id=\"8\">0,1,1</node>"            \
    "<node id=\"9\">2,0,0</node><node id=\"10\">2,1,0</node><node id=\"11\">2,0,1</node>"          \
    "<node id=\"12\">2,1,1</node></Nodes>\n"
#define PARTS                                                                                      \
    "<Elements type=\"hex8\" name=\"left\"><elem id=\"1\">1,2,3,4,5,6,7,8</elem>"                  \
    "<elem id=\"2\">2,9,10,3,6,11,12,7</elem></Elements>\n"                                        \
    "<ElementSet name=\"back\">2,1</ElementSet>\n"
#define DECK(type, material, data)                                                                 \
    "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Module type=\"solid\"/>\n<Material>"  \
    "<material id=\"1\" name=\"soft\" type=\"" type "\"><density>1000</density>\n" material        \
    "</material></Material>\n<Mesh>\n" NODES PARTS "</Mesh>\n<MeshDomains><SolidDomain "           \
    "name=\"left\" mat=\"soft\"/></MeshDomains>\n<MeshData>" data "</MeshData></febio_spec>\n"
#define ISO                                                                                        \
    "<k>9e4</k><c1>500</c1><c2>100</c2><c3>40</c3><c4>12</c4><c5>3e3</c5><lam_max>1.2</lam_max>"
#define SOLID "<solid type=\"neo-Hookean\"><E>3000</E><v>0.25</v></solid>"
#define EXP   "<ksi>300</ksi><alpha>1.5</alpha><beta>2.5</beta>"
#define ALONG "<fiber type=\"vector\">0,3,4</fiber>"

#define MOONEY "<solid type=\"Mooney-Rivlin\"><c1>500</c1><c2>0</c2></solid>"
#define FIBER(part)                                                                                \
    "<solid type=\"fiber-pow-linear" part "\"><E>700</E><lam0>1.03</lam0><beta>2.5</beta>" ALONG   \
    "</solid>"

static lar_status read_deck(const char *text, lar_model **model, lar_error *error) {
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_status status = lar_feb_parse("deck.feb", &bytes, model, error);
    lar_bytes_free(&bytes);
    return status;
}

static lar_model *deck(const char *text) {
    lar_model *model = NULL;
    lar_error error = {0};
    if (read_deck(text, &model, &error)) fail_msg("%s", error.message);
    return model;
}

static void decks_say_laws_and_directions(void **state) {
    (void)state;
    lar_model *model = deck(DECK("trans iso Mooney-Rivlin", ISO ALONG, ""));
    const lar_fibre *f = &model->material[0].fibre;
    assert_true(model->material[0].law == LAR_LAW_mooney_rivlin);
    assert_true(f->law == LAR_FIBRE_EXP_LINEAR && f->isochoric && f->parameter[2] == 3e3);
    near(lar_model_fibre(model, 1), 0, 0.6, 0.8);
    lar_model_destroy(model);

    model = deck(DECK("solid mixture",
                      SOLID "<solid type=\"fiber-exp-pow\">" EXP "<mat_axis type=\"local\">1,7,3"
                            "</mat_axis></solid>",
                      ""));
    f = &model->material[0].fibre;
    assert_true(model->material[0].law == LAR_LAW_coupled_neo_hookean);
    assert_true(f->law == LAR_FIBRE_EXP_POW && !f->isochoric && f->parameter[1] == 1.5);
    const double s = sqrt(1.0 / 3);
    near(lar_model_fibre(model, 0), s, s, s);
    lar_model_destroy(model);

    for (int uncoupled = 0; uncoupled < 2; uncoupled++) {
        model = deck(
            uncoupled ? DECK("uncoupled solid mixture", "<k>1e5</k>" MOONEY FIBER("-uncoupled"), "")
                      : DECK("solid mixture", SOLID FIBER(""), ""));
        f = &model->material[0].fibre;
        assert_true(f->law == LAR_FIBRE_POW_LINEAR && f->isochoric == (uncoupled == 1));
        assert_true(f->parameter[0] == 700 && f->parameter[1] == 1.03 && f->parameter[2] == 2.5);
        lar_model_destroy(model);
    }

    model = deck(DECK("trans iso Mooney-Rivlin",
                      ISO "<fiber type=\"angles\"><theta>90</theta><phi>45</phi></fiber>", ""));
    near(lar_model_fibre(model, 0), 0, sqrt(0.5), sqrt(0.5));
    lar_model_destroy(model);

    /* lid counts in the order of the set. */
    model = deck(DECK("trans iso Mooney-Rivlin", ISO "<fiber type=\"user\"/>",
                      "<ElementData type=\"fiber\" elem_set=\"back\"><e lid=\"1\">0,0,5</e>"
                      "<e lid=\"2\">2,0,0</e></ElementData>"));
    near(lar_model_fibre(model, 0), 1, 0, 0);
    near(lar_model_fibre(model, 1), 0, 0, 1);
    lar_model_destroy(model);
    model = deck(DECK("trans iso Mooney-Rivlin", ISO ALONG,
                      "<ElementData type=\"mat_axis\" elem_set=\"left\"><e lid=\"2\"><a>1,0,0</a>"
                      "<d>0,1,0</d></e></ElementData>"));
    near(lar_model_fibre(model, 0), 0, 0.6, 0.8);
    near(lar_model_fibre(model, 1), 0, 0.6, 0.8);
    lar_model_destroy(model);
}

/* A direction is one in the axes around it, which elements may have of their own. */
static void axes_turn_directions(void **state) {
    (void)state;
#define AXES "<mat_axis type=\"vector\"><a>0,2,0</a><d>-1,5,0</d></mat_axis>" /* y, -x, z */
#define DATA(type, values)                                                                         \
    "<ElementData type=\"" type "\" elem_set=\"back\"><e lid=\"1\">" values "</e></ElementData>"
#define CALCIUM            "<active_contraction type=\"active_contraction\"/>"
#define TURNED             "<fiber type=\"angles\"><theta>90</theta><phi>90</phi></fiber>"
#define EXP_ALONG          "<solid type=\"fiber-exp-pow\">" EXP ALONG "</solid>"
#define OWN_AXES           DATA("mat_axis", "<a>0,0,1</a><d>0,1,0</d>") /* z, y, -x */
#define TI(material, data) DECK("trans iso Mooney-Rivlin", ISO material, data)
    static const struct {
        const char *text;
        double first[3], second[3]; /* of both elements; the set has the second one first */
    } decks[] = {
        {TI(AXES ALONG, ""), {-0.6, 0, 0.8}, {-0.6, 0, 0.8}},
        {TI(ALONG AXES, OWN_AXES), {-0.6, 0, 0.8}, {-0.8, 0.6, 0}},
        {TI(ALONG, OWN_AXES), {0, 0.6, 0.8}, {-0.8, 0.6, 0}},
        {TI(AXES, OWN_AXES), {0, 1, 0}, {0, 0, 1}},
        {TI(ALONG AXES, OWN_AXES DATA("fiber", "0,0,3")), {-0.6, 0, 0.8}, {-1, 0, 0}},
        {TI(ALONG AXES, DATA("fiber", "0,0,3")), {-0.6, 0, 0.8}, {0, 0, 1}},
        {TI(AXES TURNED CALCIUM, ""), {-1, 0, 0}, {-1, 0, 0}},
        {DECK("solid mixture", AXES SOLID EXP_ALONG, ""), {-0.6, 0, 0.8}, {-0.6, 0, 0.8}},
    };
    for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
        lar_model *model = deck(decks[i].text);
        const double *f = decks[i].first, *s = decks[i].second;
        near(lar_model_fibre(model, 0), f[0], f[1], f[2]);
        near(lar_model_fibre(model, 1), s[0], s[1], s[2]);
        lar_model_destroy(model);
    }
}

#define HGO_DECK "<c>800</c><k1>2500</k1><k2>1.4</k2><kappa>0.1</kappa><gamma>30</gamma><k>9e4</k>"
#define HGO_TYPE "Holzapfel-Gasser-Ogden"

static bool says(const lar_model *model, const char *words) {
    for (int i = 0; i < model->notice_count; i++)
        if (strstr(model->notice[i], words)) return true;
    return false;
}

/* Both families, at +30 and -30 degrees. */
static void hold_pair(const lar_model *model, int32_t e, const double e1[3], const double e2[3]) {
    const double c = sqrt(0.75), s = 0.5;
    const double *first = lar_model_fibre(model, e), *second = model->mesh.second[e];
    near(first, c * e1[0] + s * e2[0], c * e1[1] + s * e2[1], c * e1[2] + s * e2[2]);
    near(second, c * e1[0] - s * e2[0], c * e1[1] - s * e2[1], c * e1[2] - s * e2[2]);
}

static void decks_say_two_families(void **state) {
    (void)state;
    const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    lar_model *model = deck(DECK(HGO_TYPE, HGO_DECK, ""));
    const lar_material *m = &model->material[0];
    const lar_fibre *f = &m->fibre;
    assert_true(m->law == LAR_LAW_neo_hookean && lar_material_shear(m) == 800);
    assert_true(lar_material_bulk(m) == 9e4);
    assert_true(f->law == LAR_FIBRE_HGO && f->isochoric && f->paired);
    assert_true(f->parameter[0] == 2500 && f->parameter[1] == 1.4 && f->parameter[2] == 0.1);
    hold_pair(model, 1, x, y);
    assert_true(says(model, "answers a change of volume by K/2 (J - 1)^2"));
    lar_model_destroy(model);
    model = deck(DECK(HGO_TYPE,
                      HGO_DECK "<mat_axis type=\"vector\"><a>0,0,3</a><d>1,0,7</d></mat_axis>"
                               "<pressure_model>Abaqus</pressure_model>",
                      ""));
    hold_pair(model, 0, z, x);
    assert_false(says(model, "a change of volume"));
    lar_model_destroy(model);
    model = deck(DECK(HGO_TYPE,
                      HGO_DECK "<mat_axis type=\"local\">1,5,2</mat_axis>"
                               "<pressure_model>default</pressure_model>",
                      ""));
    assert_true(model->material[0].law == LAR_LAW_mooney_rivlin);
    assert_true(fabs(lar_material_shear(&model->material[0]) - 800) < 1e-9);
    hold_pair(model, 1, z, x);
    lar_model_destroy(model);
    model = deck(DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"user\"/>",
                      "<ElementData type=\"mat_axis\" elem_set=\"back\"><e lid=\"1\"><a>0,2,0</a>"
                      "<d>0,0,1</d></e><e lid=\"2\"><a>0,0,1</a><d>0,3,0</d></e></ElementData>"));
    hold_pair(model, 0, z, y);
    hold_pair(model, 1, y, z);
    lar_model_destroy(model);
}

#define CONTRACTS(lc)                                                                              \
    SOLID "<solid type=\"prescribed uniaxial active contraction\"><T0" lc ">200</T0>" ALONG        \
          "</solid>"
#define CURVE(points)                                                                              \
    "</MeshData><LoadData><load_controller id=\"3\" type=\"loadcurve\"><interpolate>LINEAR"        \
    "</interpolate><points>" points "</points></load_controller></LoadData><MeshData>"

/* A curve above 1 makes the stress larger, and the curve a part of it. */
static void decks_say_when_it_is_active(void **state) {
    (void)state;
    lar_model *model = deck(DECK("solid mixture", CONTRACTS(" lc=\"3\""),
                                 CURVE("<pt>0,0</pt><pt>1,5</pt><pt>2,1</pt>")));
    const lar_material *m = &model->material[0];
    assert_true(m->fibre.along == 1000 && m->activation.curve > 0);
    const lar_curve *curve = &model->curve[m->activation.curve - 1];
    assert_true(lar_curve_value(curve, 1) == 1 && lar_curve_value(curve, 2) == 0.2);
    lar_model_destroy(model);
    model = deck(DECK("solid mixture", CONTRACTS(""), ""));
    assert_true(model->material[0].fibre.along == 200 && model->material[0].activation.curve == 0);
    lar_model_destroy(model);
}

static void decks_say_what_is_wrong(void **state) {
    (void)state;
#define OF(material, data) DECK("trans iso Mooney-Rivlin", material, data)
#define MIX(material)      DECK("solid mixture", material, "")
    static const char *const wrong[][2] = {
        {OF(ISO, ""), "nothing says along what; give it a direction, as <fiber> of its material"},
        {OF(ISO "<fiber type=\"user\"/>", ""), "nothing says along what"},
        {OF(ISO "<fiber type=\"map\">grain</fiber>", ""), "the map 'grain' of directions is not"},
        {OF(ISO "<fiber type=\"vector\">0,0,0</fiber>", ""), "their direction is 0, 0, 0"},
        {OF(ISO "<fiber type=\"polar\">0,0,0</fiber>", ""),
         "a direction of type 'polar' is not read"},
        {OF(ISO "<fiber type=\"local\">1,9</fiber>", ""), "one corner to another, of 1 to 8"},
        {OF(ISO ALONG "<active_contraction><ascl lc=\"1\">1</ascl></active_contraction>", ""),
         "<active_contraction>, which follows calcium"},
        {OF(ISO ALONG "<active_contraction type=\"magic\"/>", ""), "of type 'magic' is not read"},
        {OF(ISO ALONG "<active_contraction><T0/></active_contraction>", ""), "take a prescribed"},
        {OF("<k>9</k><c1>1</c1><c3>1</c3>" ALONG, ""), "no parameter <c4>"},
        {DECK("solid mixture", CONTRACTS(" lc=\"3\""), CURVE("<pt>0,0</pt><pt>1,-1</pt>")),
         "has values below 0"},
        {DECK("solid mixture", CONTRACTS(" lc=\"3\""), ""), "names the load controller 3"},
        {OF(ISO ALONG, "<ElementData type=\"fiber\" elem_set=\"none\"/>"),
         "names the element set 'none'"},
        {OF(ISO ALONG,
            "<ElementData type=\"fiber\" elem_set=\"back\"><e lid=\"3\">1,0,0</e></ElementData>"),
         "lid 3 is no element of its set, which has 2"},
        {OF(ISO ALONG,
            "<ElementData type=\"fiber\" elem_set=\"back\"><e lid=\"1\">1,0</e></ElementData>"),
         "deck.feb:"},
        {MIX(EXP_ALONG), "no law besides its fibres"},
        {MIX(SOLID SOLID), "a second law in a solid mixture"},
        {MIX(SOLID EXP_ALONG EXP_ALONG), "a second family of fibres in a solid mixture"},
        {MIX("<solid type=\"neo-Hookean\"><E>3000</E><v>0.25</v>" AXES "</solid>" EXP_ALONG),
         "a second direction within one material"},
        {OF(ISO ALONG "<mat_axis type=\"local\">1,2,4</mat_axis>", ""),
         "a <mat_axis> of type 'local' around a <fiber> is not read"},
        {OF(ISO ALONG, DATA("mat_axis", "<a>0,0,1</a>")), "give it <a> and <d>"},
        {OF(ISO ALONG, OWN_AXES OWN_AXES), "a second <mat_axis> for element 2; keep one"},
        {MIX(SOLID "<solid type=\"fiber-exp-pow\">" EXP ALONG "<lam0>1.1</lam0></solid>"),
         "<lam0> of fibres is 1.1, which is not read; give it 1"},
        {MIX(SOLID "<solid type=\"ellipsoidal fiber distribution\"/>"), "is not read"},
        {MIX(SOLID "<solid type=\"" HGO_TYPE "\"/>"), "is read where it stands alone"},
        {DECK(HGO_TYPE, "<c>800</c><k1>2500</k1><k2>1.4</k2><kappa>0.1</kappa><k>9e4</k>", ""),
         "no parameter <gamma>"},
        {DECK(HGO_TYPE, HGO_DECK "<pressure_model>NIKE3D</pressure_model>", ""),
         "pressure_model 'NIKE3D' of a material"},
        {DECK(HGO_TYPE, HGO_DECK ALONG, ""), "give it a <mat_axis>"},
        {DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"vector\"><a>1,0,0</a></mat_axis>", ""),
         "needs <a> and <d>"},
        {DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"vector\"><a>1,0,0</a><d>2,0,0</d></mat_axis>",
              ""),
         "span no plane"},
        {DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"local\">1,2,9</mat_axis>", ""),
         "names three corners"},
        {DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"cylindrical\"/>", ""), "is not read"},
        {DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"user\"/>", ""), "direction is 0, 0, 0"},
        {DECK(HGO_TYPE, HGO_DECK "<mat_axis type=\"user\"/>",
              "<ElementData type=\"fiber\" elem_set=\"back\"><e lid=\"1\">0,0,5</e>"
              "</ElementData>"),
         "give it <a> and <d>"},
        {DECK(HGO_TYPE " unconstrained", HGO_DECK, ""), "is not read; of FEBio's, Lariat has"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lar_model *model = NULL;
        lar_error error = {0};
        assert_int_not_equal(read_deck(wrong[i][0], &model, &error), LAR_OK);
        if (!strstr(error.message, wrong[i][1]))
            fail_msg("\"%s\" lacks \"%s\"", error.message, wrong[i][1]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_say_laws_and_directions),
        cmocka_unit_test(scenes_say_a_second_family),
        cmocka_unit_test(scenes_say_what_is_active),
        cmocka_unit_test(scenes_say_when_it_is_active),
        cmocka_unit_test(the_last_material_has_its_own_rule),
        cmocka_unit_test(scenes_say_what_is_wrong),
        cmocka_unit_test(meshes_bring_directions),
        cmocka_unit_test(meshes_bring_second_families),
        cmocka_unit_test(decks_say_laws_and_directions),
        cmocka_unit_test(axes_turn_directions),
        cmocka_unit_test(decks_say_two_families),
        cmocka_unit_test(decks_say_when_it_is_active),
        cmocka_unit_test(decks_say_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
