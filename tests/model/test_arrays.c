/* Models from arrays in memory: the same as from a file to the last bit, and every mistake said in
 * one sentence. Only public calls. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lariat.h"

#define SCENE                                                                                      \
    "lariat: 1\n"                                                                                  \
    "gravity: [0, 0, -9.81]\n"                                                                     \
    "time_step: auto\n"                                                                            \
    "damping: 2.0\n"                                                                               \
    "materials:\n"                                                                                 \
    "  - { cells: all, law: neo-hookean, density: 1050, youngs_modulus: 1.0e5, "                   \
    "poisson_ratio: 0.45 }\n"

static lar_error error;

/* Two cubes of 10 mm, one on the other along x; the second one has the tag 7. */
static const double place[12][3] = {{0, 0, 0},       {0.01, 0, 0},       {0.02, 0, 0},
                                    {0, 0.01, 0},    {0.01, 0.01, 0},    {0.02, 0.01, 0},
                                    {0, 0, 0.01},    {0.01, 0, 0.01},    {0.02, 0, 0.01},
                                    {0, 0.01, 0.01}, {0.01, 0.01, 0.01}, {0.02, 0.01, 0.01}};
static const int32_t cube[2][8] = {{0, 1, 4, 3, 6, 7, 10, 9}, {1, 2, 5, 4, 7, 8, 11, 10}};
static const int32_t tags[2] = {0, 7};
static const int32_t left[4] = {9, 6, 3, 0}, whole[2] = {0, 1}, end_face[1] = {7};
static const lar_array_set sets[3] = {
    {"wall", NULL, 4, left}, {"both", "elements", 2, whole}, {"tip", "faces", 1, end_face}};

static lar_mesh_arrays two_cubes(void) {
    return (lar_mesh_arrays){12, 2, 3, place, cube, tags, sets, NULL, NULL};
}

static uint64_t hash_after(const lar_model *model, uint64_t steps) {
    lar_simulation *simulation = NULL;
    if (lar_simulation_create(model, NULL, &simulation, &error) ||
        lar_simulation_advance(simulation, steps, &error))
        fail_msg("%s", error.message);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static void what_a_file_says_arrays_say_too(void **unused) {
    (void)unused;
    lar_model *file = NULL, *model = NULL;
    assert_int_equal(lar_model_open(LAR_TEST_EXAMPLES "/beam.yaml", &file, &error), LAR_OK);
    int32_t nodes = lar_model_node_count(file), elements = lar_model_element_count(file);
    double(*position)[3] = calloc((size_t)nodes, sizeof *position);
    int32_t(*element)[8] = calloc((size_t)elements, sizeof *element);
    assert_true(position && element);
    memcpy(position, lar_model_positions(file), (size_t)nodes * sizeof *position);
    for (int32_t e = 0; e < elements; e++)
        memcpy(element[e], lar_model_element_nodes(file, e), sizeof element[e]);
    lar_mesh_arrays arrays = {.nodes = nodes,
                              .elements = elements,
                              .position = (const double(*)[3])position,
                              .element = (const int32_t(*)[8])element};
    static const char scene[] =
        SCENE "mesh: given\n"
              "sets:\n  - { name: wall, nodes: { box: [[-0.001, -1, -1], [0.001, 1, 1]] } }\n"
              "fix: [ { nodes: wall, axes: xyz } ]\n";
    if (lar_model_from_arrays(&arrays, scene, &model, &error)) fail_msg("%s", error.message);
    memset(position, 0, (size_t)nodes * sizeof *position); /* copied */
    memset(element, 0, (size_t)elements * sizeof *element);
    assert_true(hash_after(model, 300) == hash_after(file, 300));
    assert_string_equal(lar_model_source(model), "model");
    assert_true(lar_model_node_id(model, 3) == 3 && lar_model_element_id(model, 2) == 2);
    free(position);
    free(element);
    lar_model_destroy(file);
    lar_model_destroy(model);
}

static void sets_and_tags_are_found_by_the_scene(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_model_info about;
    lar_set_info set;
    lar_mesh_arrays arrays = two_cubes();
    static const char scene[] = "lariat: 1\nscale: 2\nfix: [ { nodes: wall, axes: xyz } ]\n"
                                "materials:\n"
                                "  - { cells: 0, law: neo-hookean, density: 1000, shear_modulus: "
                                "2e3, bulk_modulus: 2e4 }\n"
                                "  - { cells: 7, law: neo-hookean, density: 3000, shear_modulus: "
                                "2e3, bulk_modulus: 2e4 }\n"
                                "load: [ { faces: tip, pressure: 10, over: 0.1 } ]\n";
    if (lar_model_from_arrays(&arrays, scene, &model, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_model_inspect(model, &about, &error), LAR_OK);
    assert_int_equal(about.fixed_nodes, 4);
    assert_int_equal(about.thin_elements, 2); /* two cubes side by side */
    assert_true(fabs(about.mass - 8e-6 * 4000) < 1e-12);
    assert_int_equal(lar_model_set_count(model), 3);
    assert_int_equal(lar_model_set(model, 2, &set, &error), LAR_OK);
    assert_string_equal(set.kind, "faces");
    assert_true(hash_after(model, 10) != 0);
    lar_model_destroy(model);
}

/* The word means everything; who has a set of that name is told how to write it. In quotes, which
 * JSON has around every word, it is the set, where there is one. */
static void a_set_named_all_is_not_the_word(void **unused) {
    (void)unused;
    static const lar_array_set own[2] = {{"all", NULL, 4, left}, {"all", "elements", 2, whole}};
    static const struct {
        const char *scene;
        int sets, fixed, notices;
    } cases[] = {{SCENE "fix: [ { nodes: all, axes: xyz } ]\n", 2, 12, 1},
                 {SCENE "fix: [ { nodes: { set: all }, axes: xyz } ]\n", 2, 4, 0},
                 {SCENE "fix: [ { nodes: \"all\", axes: xyz } ]\n", 2, 4, 0},
                 {SCENE "fix: [ { nodes: \"all\", axes: xyz } ]\n", 0, 12, 0}};
    for (int i = 0; i < 4; i++) {
        lar_mesh_arrays arrays = two_cubes();
        arrays.sets = cases[i].sets;
        arrays.set = own;
        lar_model *model = NULL;
        lar_model_info about;
        if (lar_model_from_arrays(&arrays, cases[i].scene, &model, &error))
            fail_msg("%s", error.message);
        assert_int_equal(lar_model_inspect(model, &about, &error), LAR_OK);
        assert_int_equal(about.fixed_nodes, cases[i].fixed);
        assert_int_equal(lar_model_notice_count(model), cases[i].notices);
        if (!i && !strstr(lar_model_notice_text(model, 0), "scene:7: all means everything here"))
            fail_msg("%s", lar_model_notice_text(model, 0));
        lar_model_destroy(model);
    }
}

static void without_a_scene_it_is_soft_and_free(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_mesh_arrays arrays = {.nodes = 12, .elements = 2, .position = place, .element = cube};
    if (lar_model_from_arrays(&arrays, NULL, &model, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_model_material_count(model), 1);
    assert_int_equal(lar_model_set_count(model), 0);
    lar_model_destroy(model);
}

/* One sentence, which has both words in it; nothing is made. */
static void refused(const lar_mesh_arrays *arrays, const char *scene, const char *word,
                    const char *other) {
    lar_model *model = NULL;
    lar_status status = lar_model_from_arrays(arrays, scene, &model, &error);
    assert_int_not_equal(status, LAR_OK);
    assert_int_equal(status, error.status);
    assert_null(model);
    if (!strstr(error.message, word) || !strstr(error.message, other))
        fail_msg("no \"%s\" or \"%s\" in: %s", word, other, error.message);
    assert_int_equal(lar_model_from_arrays(arrays, scene, &model, NULL), status);
}

#define FIBRES(direction)                                                                          \
    "lariat: 1\ngravity: [0, 0, -9.81]\nfix: [ { nodes: wall, axes: xyz } ]\nmaterials:\n"         \
    "  - { cells: all, law: neo-hookean, density: 1050, shear_modulus: 3e3, bulk_modulus: 1e5,\n"  \
    "      fibres: { law: exp-linear, part: isochoric, c3: 5e3, c4: 12, c5: 4e4, lam_max: 1.2,\n"  \
    "                direction: " direction " } }\n"

static void directions_of_fibres_are_those_of_the_arrays(void **unused) {
    (void)unused;
    static const double along[2][3] = {{0, 0, 2}, {0, 0, 2}}, one[2][3] = {{0, 0, 2}};
    lar_mesh_arrays a = two_cubes();
    lar_model *rule = NULL, *model = NULL;
    if (lar_model_from_arrays(&a, FIBRES("{ axis: [0, 0, 1] }"), &rule, &error))
        fail_msg("%s", error.message);
    refused(&a, FIBRES("mesh"), "scene:7", "no mesh has directions");
    a.fibre = one;
    refused(&a, FIBRES("mesh"), "element 1", "direction");
    a.fibre = along;
    if (lar_model_from_arrays(&a, FIBRES("mesh"), &model, &error)) fail_msg("%s", error.message);
    assert_true(hash_after(model, 300) == hash_after(rule, 300));
    lar_model_destroy(rule);
    lar_model_destroy(model);
}

#define PAIR(direction, second)                                                                    \
    "lariat: 1\ngravity: [0, 0, -9.81]\nfix: [ { nodes: wall, axes: xyz } ]\nmaterials:\n"         \
    "  - { cells: all, law: neo-hookean, density: 1050, shear_modulus: 3e3, bulk_modulus: 1e5,\n"  \
    "      fibres: { law: hgo, part: isochoric, k1: 2e4, k2: 0.8, kappa: 0.1,\n"                   \
    "                direction: " direction ", second: " second " } }\n"

/* Both families: as by a rule, as from a file, and as the other way round. */
static void so_are_those_of_a_second_family(void **unused) {
    (void)unused;
    static const double first[2][3] = {{0, 3, 4}, {0, 3, 4}}, second[2][3] = {{2, 0, 0}, {1, 0, 0}};
    lar_mesh_arrays a = two_cubes();
    lar_model *rule = NULL, *model = NULL, *file = NULL, *turned = NULL;
    if (lar_model_from_arrays(&a, PAIR("{ axis: [0, 3, 4] }", "{ axis: [1, 0, 0] }"), &rule,
                              &error))
        fail_msg("%s", error.message);
    a.fibre = first;
    refused(&a, PAIR("mesh", "mesh"), "second: mesh", "lar_model_from_arrays");
    a.fibre2 = second;
    if (lar_model_from_arrays(&a, PAIR("mesh", "mesh"), &model, &error))
        fail_msg("%s", error.message);
    uint64_t hash = hash_after(model, 300);
    assert_true(hash == hash_after(rule, 300));
    a.fibre2 = first;
    if (lar_model_from_arrays(&a, PAIR("mesh", "mesh"), &turned, &error))
        fail_msg("%s", error.message);
    assert_true(hash != hash_after(turned, 300));
    /* The same through a file. */
    lar_results *results = NULL;
    lar_simulation *simulation = NULL;
    const char *const folder = LAR_TEST_BUILD "/arrays_pair";
    if (lar_simulation_create(model, NULL, &simulation, &error) ||
        lar_results_open(folder, simulation, &results, &error) ||
        lar_results_add(results, simulation, &error) || lar_results_close(results, &error))
        fail_msg("%s", error.message);
    FILE *scene = fopen(LAR_TEST_BUILD "/arrays_pair/pair.yaml", "w");
    assert_non_null(scene);
    fputs(PAIR("mesh", "mesh") "mesh: model_000000.vtu\n", scene);
    fclose(scene);
    if (lar_model_open(LAR_TEST_BUILD "/arrays_pair/pair.yaml", &file, &error))
        fail_msg("%s", error.message);
    assert_true(hash == hash_after(file, 300));
    lar_simulation_destroy(simulation);
    lar_model_destroy(rule);
    lar_model_destroy(model);
    lar_model_destroy(turned);
    lar_model_destroy(file);
}

static void mistakes_are_named(void **unused) {
    (void)unused;
    lar_mesh_arrays a = two_cubes();
    double moved[12][3];
    int32_t corner[2][8], index[4] = {0, 3, 12, 6};
    memcpy(moved, place, sizeof moved);
    memcpy(corner, cube, sizeof corner);
    moved[5][2] = NAN;
    a.position = (const double(*)[3])moved;
    refused(&a, NULL, "node 5", "z coordinate");
    memcpy(moved, place, sizeof moved);
    moved[10][0] = -0.02;
    refused(&a, NULL, "element 0", "Jacobian");
    a = two_cubes();
    a.element = (const int32_t(*)[8])corner;
    corner[1][6] = 12;
    refused(&a, NULL, "element 1", "node 12");
    corner[1][6] = -1;
    refused(&a, NULL, "element 1", "node -1");
    corner[1][6] = 8;
    refused(&a, NULL, "node 11", "no element");
    a = two_cubes();
    a.elements = 0;
    refused(&a, NULL, "0 elements", "one element");
    a = two_cubes();
    a.position = NULL;
    refused(&a, NULL, "positions", "NULL");
    a = two_cubes();
    a.sets = -1;
    refused(&a, NULL, "-1 sets", "0 or more");
    lar_array_set bad = {"wall", NULL, 4, index};
    a = two_cubes();
    a.sets = 1;
    a.set = &bad;
    refused(&a, NULL, "'wall'", "index 12");
    bad = (lar_array_set){"wall", "edges", 4, left};
    refused(&a, NULL, "'wall'", "edges");
    bad = (lar_array_set){"wall", NULL, 0, left};
    refused(&a, NULL, "'wall'", "nothing");
    bad = (lar_array_set){"", NULL, 4, left};
    refused(&a, NULL, "set 0", "name");
    const lar_array_set twice[2] = {sets[0], sets[0]};
    a.sets = 2;
    a.set = twice;
    refused(&a, NULL, "two node sets", "'wall'");
}

static void a_negative_number_of_rays_is_named(void **unused) {
    (void)unused;
    const double zero[3] = {0}, up[3] = {0, 0, 1};
    const lar_mesh_arrays a = two_cubes();
    lar_model *model;
    lar_ray_hit hit;
    assert_int_equal(lar_model_from_arrays(&a, NULL, &model, &error), LAR_OK);
    lar_status status = lar_model_rays(model, NULL, -1, &zero, &up, 1, &hit, &error);
    assert_int_equal(status, LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "-1 rays"));
    assert_null(strstr(error.message, "NULL"));
    lar_model_destroy(model);
}

static void so_are_those_of_the_scene(void **unused) {
    (void)unused;
    lar_mesh_arrays a = two_cubes();
    refused(&a, SCENE "fix: [ { nodes: wal, axes: xyz } ]\n", "scene:7", "wall");
    refused(&a, SCENE "mesh: organ.vtu\n", "scene:7", "mesh: given");
    refused(&a, SCENE "surface: organ.stl\n", "scene:7", "reads no file");
    refused(&a, "", "scene", "nothing");
    refused(NULL, NULL, "needs a mesh", "NULL");
    assert_int_equal(lar_model_from_arrays(&a, NULL, NULL, &error), LAR_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_file_says_arrays_say_too),
        cmocka_unit_test(sets_and_tags_are_found_by_the_scene),
        cmocka_unit_test(a_set_named_all_is_not_the_word),
        cmocka_unit_test(without_a_scene_it_is_soft_and_free),
        cmocka_unit_test(directions_of_fibres_are_those_of_the_arrays),
        cmocka_unit_test(so_are_those_of_a_second_family),
        cmocka_unit_test(mistakes_are_named),
        cmocka_unit_test(a_negative_number_of_rays_is_named),
        cmocka_unit_test(so_are_those_of_the_scene)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
