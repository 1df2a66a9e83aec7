/* The files of a meshing: a scene that reads, runs, and holds what it says it holds. */
#include "testing.h"

#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

#include "image_file.h"
#include "lariat.h"
#include "model/format/mesh_io.h"
#include "model/model.h"
#include "shapes.h"

#define BALLS  LAR_TEST_BUILD "/starter_balls.nrrd"
#define TORUS  LAR_TEST_BUILD "/starter_torus.vtp"
#define RING   LAR_TEST_BUILD "/starter_ring.vtp"
#define PAIR   LAR_TEST_BUILD "/starter_pair.nrrd"
#define CUT    LAR_TEST_BUILD "/starter_cut.nrrd"
#define ORGANS LAR_TEST_SHARED "/data/labels/totalseg_abdomen_pelvis_3mm.nii.gz"
#define FOLDER LAR_TEST_BUILD "/starter/deep"

static lar_error error;

/* Two balls of one label with a gap between them, along x. */
static int pair_label(const double x[3]) {
    double from_centre = fabs(x[0]) - 0.015;
    return from_centre * from_centre + x[1] * x[1] + x[2] * x[2] < 0.012 * 0.012;
}

/* A block that leaves the image at its low x, in two halves along x. */
static int cut_label(const double x[3]) {
    if (fabs(x[1]) > 0.01 || fabs(x[2]) > 0.01 || x[0] > 0.012) return 0;
    return x[0] < -0.002 ? 1 : 2;
}

static int write_files(void **state) {
    (void)state;
    /* What a file may call its segments: quotes, backslashes, bytes that are no text. */
    static const char *const names[] = {"li\"v\\er: # {x}", "bone \xff\x01 \xc3\xa9"};
    lar_image image;
    lar_triangles torus;
    shape_image(&image, &shape_balls, 2e-3, SHAPE_STRAIGHT);
    image_file(&image, BALLS, names, 2);
    lar_image_clear(&image);
    shape_image_of(&image, pair_label, (const int32_t[]){32, 16, 16},
                   (const double[]){2e-3, 2e-3, 2e-3}, SHAPE_STRAIGHT);
    image_file(&image, PAIR, NULL, 0);
    lar_image_clear(&image);
    static const char *const misleading[] = {"cut", "left"};
    shape_image_of(&image, cut_label, (const int32_t[]){16, 16, 16},
                   (const double[]){2e-3, 2e-3, 2e-3}, SHAPE_STRAIGHT);
    image_file(&image, CUT, misleading, 2);
    lar_image_clear(&image);
    const double centre[3] = {0, 0, 0};
    shape_torus_surface(&torus, 0.022, 0.008, centre, 16);
    if (lar_vtp_write(TORUS, &torus, &error)) fail_msg("%s", error.message);
    lar_triangles_clear(&torus);
    return 0;
}

/* Meshes, writes and opens. */
static lar_model *model_of(const char *path, lar_meshing_options options, lar_meshing_info *info) {
    lar_meshing *meshing = NULL;
    lar_model *model = NULL;
    const char *scene;
    if (!options.elements) options.elements = 400;
    if (lar_meshing_create(&path, 1, &options, &meshing, &error) ||
        lar_meshing_write(meshing, FOLDER, &scene, &error) || lar_model_open(scene, &model, &error))
        fail_msg("%s", error.message);
    lar_meshing_inspect(meshing, info);
    lar_meshing_destroy(meshing);
    return model;
}

static int32_t set_size(const lar_model *model, const char *name) {
    lar_set_info set;
    for (int32_t i = 0; !lar_model_set(model, i, &set, NULL); i++)
        if (strcmp(set.name, name) == 0 && strcmp(set.kind, "nodes") == 0) return set.count;
    return 0;
}

static void check_run(const lar_model *model, double seconds, double *moved) {
    lar_simulation *simulation = NULL;
    lar_model_info info;
    if (lar_model_inspect(model, &info, &error) ||
        lar_simulation_create(model, NULL, &simulation, &error) ||
        lar_simulation_advance(simulation, (uint64_t)(seconds / info.time_step), &error))
        fail_msg("%s", error.message);
    double(*u)[3] = calloc((size_t)info.nodes, sizeof *u);
    lar_simulation_displacements(simulation, u);
    *moved = 0;
    for (int32_t n = 0; n < info.nodes; n++)
        *moved = fmax(*moved, hypot(hypot(u[n][0], u[n][1]), u[n][2]));
    free(u);
    lar_simulation_destroy(simulation);
}

/* Instruments wait where they touch nothing: outside of the ball around the mesh, jaws and all. */
static void check_tools(const lar_model *model) {
    lar_simulation *simulation = NULL;
    lar_model_info info;
    if (lar_model_inspect(model, &info, &error) ||
        lar_simulation_create(model, NULL, &simulation, &error))
        fail_msg("%s", error.message);
    assert_int_equal(lar_simulation_tool_count(simulation), 2);
    double diagonal[3], radius = 0;
    for (int i = 0; i < 3; i++) diagonal[i] = info.upper[i] - info.lower[i];
    radius = 0.5 * hypot(hypot(diagonal[0], diagonal[1]), diagonal[2]);
    for (int32_t t = 0; t < 2; t++) {
        lar_tool_info tool;
        lar_simulation_tool(simulation, t, &tool, NULL);
        assert_string_equal(tool.name, t ? "grasper" : "probe");
        double far[3];
        for (int i = 0; i < 3; i++)
            far[i] = tool.rest.position[i] - 0.5 * (info.upper[i] + info.lower[i]);
        double room = hypot(hypot(far[0], far[1]), far[2]) - radius - tool.length - tool.radius;
        if (room < 0.02 * radius || room > radius)
            fail_msg("%s is %g m beside a body of %g m", tool.name, room, radius);
    }
    lar_simulation_destroy(simulation);
}

/* Coarse meshes have large faces, which feel only thick instruments: they wait farther away. */
static void instruments_wait_beside_coarse_meshes_too(void **state) {
    (void)state;
    static const int32_t elements[] = {30, 100, 2000};
    for (size_t i = 0; i < sizeof elements / sizeof elements[0]; i++) {
        lar_meshing_info info;
        lar_model *model = model_of(BALLS, (lar_meshing_options){.elements = elements[i]}, &info);
        check_tools(model);
        lar_model_destroy(model);
    }
}

static void a_scene_of_two_regions_runs(void **state) {
    (void)state;
    lar_meshing_info info;
    lar_model_info model_info;
    lar_material_info material;
    lar_embedded_info fine;
    lar_model *model = model_of(BALLS, (lar_meshing_options){.title = "two # balls"}, &info);
    assert_int_equal(lar_model_inspect(model, &model_info, &error), LAR_OK);
    assert_string_equal(model_info.title, "two # balls");
    assert_int_equal(model_info.elements, info.elements);
    assert_int_equal(model_info.fixed_nodes, info.fixed_nodes);
    assert_int_equal(model_info.materials, 2);
    assert_int_equal(lar_model_material(model, 0, &material, &error), LAR_OK);
    assert_string_equal(material.name, "li\"v\\er: # {x}");
    assert_true(material.elements > 100);
    check_tools(model);
    assert_int_equal(lar_model_material(model, 1, &material, &error), LAR_OK);
    assert_string_equal(material.name, "bone ?  \xc3\xa9");
    assert_true(lar_model_embedded(model, &fine));
    assert_true(fine.triangles > 1000);
    assert_true(set_size(model, "support") > 0);
    assert_true(set_size(model, "handle") > 0);
    double moved;
    check_run(model, 0.5, &moved); /* while it is pulled */
    assert_true(moved > 1e-4 && moved < 0.03);
    lar_model_destroy(model);
}

/* The pull lets go, and it is at rest again at the end. */
static void a_pull_grows_and_lets_go(void **state) {
    (void)state;
    lar_meshing_info info;
    double pulled, after;
    lar_model *model = model_of(TORUS, (lar_meshing_options){.fix = "left"}, &info);
    check_tools(model);
    assert_true(lar_model_duration(model) >= 2);
    check_run(model, 0.7, &pulled);
    check_run(model, lar_model_duration(model), &after);
    assert_true(pulled > 5e-4 && pulled < 0.04);
    assert_below(after, 0.01 * pulled);
    lar_model_destroy(model);
}

/* The mean way of the handle while it is pulled, as part of the body's length. */
static double way_of_handle(int32_t elements) {
    const char *const path[] = {ORGANS}, *const pancreas[] = {"7"};
    const lar_meshing_options options = {
        .elements = elements, .labels = pancreas, .label_count = 1};
    lar_meshing *meshing = NULL;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_model_info info;
    const char *scene;
    if (lar_meshing_create(path, 1, &options, &meshing, &error) ||
        lar_meshing_write(meshing, FOLDER, &scene, &error) ||
        lar_model_open(scene, &model, &error) || lar_model_inspect(model, &info, &error) ||
        lar_simulation_create(model, NULL, &simulation, &error) ||
        lar_simulation_advance(simulation, (uint64_t)(0.75 / info.time_step), &error))
        fail_msg("%s", error.message);
    double(*u)[3] = calloc((size_t)info.nodes, sizeof *u);
    const lar_set *handle = lar_mesh_find_set(&model->mesh, "handle", LAR_SET_NODES);
    double way = 0, length = 0;
    assert_non_null(handle);
    lar_simulation_displacements(simulation, u);
    for (int32_t i = 0; i < handle->count; i++) way += u[handle->index[i]][1] / handle->count;
    for (int i = 0; i < 3; i++) length = fmax(length, info.upper[i] - info.lower[i]);
    free(u);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    lar_meshing_destroy(meshing);
    return way / length;
}

/* A pancreas has a thin end, whose elements have another cross-section on every mesh, and extra
 * supports near it; the way is the same. It is some 6 % more than the 2 % of the length that the
 * pull is chosen for, by the stiffness at rest: drawn out, the thin end gets softer. */
static void a_pull_is_alike_on_every_mesh(void **state) {
    (void)state;
    static const int32_t elements[] = {500, 600, 800, 1000, 2500};
    if (access(ORGANS, R_OK) != 0) {
        print_message("skipped: no shared data\n");
        skip();
    }
#ifndef LAR_TEST_NIFTI
    print_message("skipped: built without libnifti\n");
    skip();
#endif
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++) {
        const double way = way_of_handle(elements[i]);
        if (!(fabs(way - 0.0213) < 0.0013))
            fail_msg("%d elements: %.4f of the length", elements[i], way);
    }
}

/* A thin ring bends easily and slowly; the scene pulls at it with less, and waits longer. */
static void a_thin_body_is_at_rest_at_the_end(void **state) {
    (void)state;
    lar_triangles ring;
    lar_meshing_info info;
    double pulled, after;
    const double centre[3] = {0, 0, 0};
    shape_torus_surface(&ring, 0.04, 0.004, centre, 16);
    if (lar_vtp_write(RING, &ring, &error)) fail_msg("%s", error.message);
    lar_triangles_clear(&ring);
    lar_model *model = model_of(RING, (lar_meshing_options){.fix = "left"}, &info);
    assert_true(lar_model_duration(model) > 2);
    check_run(model, 0.8, &pulled);
    check_run(model, lar_model_duration(model), &after);
    assert_true(pulled > 8e-4 && pulled < 0.06);
    assert_below(after, 0.01 * pulled);
    lar_model_destroy(model);
}

/* What holds it without being told bears its weight, from wherever it comes: a thin ring gets extra
 * supports for it. */
static void a_thin_body_bears_its_weight(void **state) {
    (void)state;
    lar_meshing_info info;
    double moved;
    lar_model *model = model_of(RING, (lar_meshing_options){0}, &info);
    assert_string_equal(info.fix, "back");
    assert_in_range(info.extra_supports, 1, 12);
    const lar_set *extra_supports = lar_mesh_find_set(&model->mesh, "pads", LAR_SET_NODES);
    assert_non_null(extra_supports);
    assert_int_equal(set_size(model, "support") + extra_supports->count, info.fixed_nodes);
    assert_true(info.fixed_nodes < info.nodes / 4);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) model->gravity[k] = k == i ? -9.81 : 0;
        check_run(model, i == 1 ? 2 : 0.5, &moved); /* towards the back for long */
        assert_true(moved > 1e-5 && moved < 0.04);
    }
    lar_model_destroy(model);
    model = model_of(RING, (lar_meshing_options){.fix = "back"}, &info);
    assert_int_equal(info.extra_supports, 0); /* somebody said what holds it */
    assert_int_equal(set_size(model, "pads"), 0);
    lar_model_destroy(model);
}

/* Longer than a file's name may be. */
static void a_long_title_is_cut_for_the_files(void **state) {
    (void)state;
    lar_meshing_info info;
    lar_model_info model_info;
    char title[1001] = {0};
    for (int i = 0; i < 1000; i++) title[i] = 'x';
    lar_model *model = model_of(TORUS, (lar_meshing_options){.title = title}, &info);
    assert_int_equal(lar_model_inspect(model, &model_info, &error), LAR_OK);
    assert_string_equal(model_info.title, title);
    lar_model_destroy(model);
}

/* Pulled on both sides, so that it stays about where it is. */
static void what_nothing_holds_is_stretched(void **state) {
    (void)state;
    lar_meshing_info info;
    double pulled;
    lar_model *model = model_of(TORUS, (lar_meshing_options){.fix = "none"}, &info);
    assert_int_equal(info.fixed_nodes, 0);
    assert_int_equal(set_size(model, "support"), 0);
    assert_true(set_size(model, "handle") > 0 && set_size(model, "handle_opposite") > 0);
    check_run(model, 0.7, &pulled);
    assert_true(pulled > 2e-4 && pulled < 0.03);
    lar_model_destroy(model);
}

static void sides_are_where_they_are_said_to_be(void **state) {
    (void)state;
    static const struct {
        const char *fix;
        int axis;
        double sign;
    } side[] = {{"left", 0, -1}, {"right", 0, 1},   {"back", 1, -1},
                {"front", 1, 1}, {"bottom", 2, -1}, {"top", 2, 1}};
    for (int s = 0; s < 6; s++) {
        lar_meshing_info info;
        lar_model_info box;
        lar_model *model = model_of(TORUS, (lar_meshing_options){.fix = side[s].fix}, &info);
        lar_simulation *simulation = NULL;
        assert_int_equal(lar_model_inspect(model, &box, &error), LAR_OK);
        assert_int_equal(lar_simulation_create(model, NULL, &simulation, &error), LAR_OK);
        uint64_t steps = (uint64_t)(0.3 / box.time_step);
        assert_int_equal(lar_simulation_advance(simulation, steps, &error), LAR_OK);
        double(*u)[3] = calloc((size_t)box.nodes, sizeof *u);
        lar_simulation_displacements(simulation, u);
        const double(*x)[3] = lar_model_positions(model);
        double middle = (box.lower[side[s].axis] + box.upper[side[s].axis]) / 2;
        int32_t still = 0;
        for (int32_t n = 0; n < box.nodes; n++) {
            if (u[n][0] != 0 || u[n][1] != 0 || u[n][2] != 0) continue;
            assert_true(side[s].sign * (x[n][side[s].axis] - middle) > 0);
            still++;
        }
        assert_int_equal(still, info.fixed_nodes);
        free(u);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
}

/* The left ball's support is the body's tenth at the left; the right one, which that does not
 * reach, is held at its own left end. */
static void a_loose_piece_is_held_at_its_own_end(void **state) {
    (void)state;
    lar_meshing_info info;
    lar_model *model = model_of(PAIR, (lar_meshing_options){.fix = "left"}, &info);
    const lar_set *support = lar_mesh_find_set(&model->mesh, "support", LAR_SET_NODES);
    assert_non_null(support);
    assert_int_equal(support->count, info.fixed_nodes);
    int32_t left = 0, right = 0;
    for (int32_t i = 0; i < support->count; i++) {
        double x = model->mesh.position[support->index[i]][0];
        assert_true(x < -0.0195 || (x > 0 && x < 0.010));
        left += x < 0;
        right += x > 0;
    }
    assert_true(left > 3 && right >= 8);
    lar_model_destroy(model);
    model = model_of(PAIR, (lar_meshing_options){.fix = "none"}, &info);
    assert_int_equal(info.fixed_nodes, 0);
    lar_model_destroy(model);
}

/* Where regions "cut" and "left" touch their set of faces is called as the second cut at the left
 * would be. */
static void an_interface_is_no_cut(void **state) {
    (void)state;
    lar_meshing_info info;
    lar_model *model = model_of(CUT, (lar_meshing_options){.fix = "cut"}, &info);
    assert_non_null(lar_mesh_find_set(&model->mesh, "cut_left_2", LAR_SET_FACES));
    const lar_set *support = lar_mesh_find_set(&model->mesh, "support", LAR_SET_NODES);
    assert_non_null(support);
    for (int32_t i = 0; i < support->count; i++)
        assert_true(model->mesh.position[support->index[i]][0] < -0.012);
    lar_model_destroy(model);
}

static void quality_of_a_model_is_that_of_its_meshing(void **state) {
    (void)state;
    lar_meshing_info info;
    lar_mesh_quality embedded, file, scaled;
    lar_model *model = model_of(TORUS, (lar_meshing_options){0}, &info);
    assert_int_equal(lar_model_quality(model, NULL, 1, &embedded, &error), LAR_OK);
    assert_int_equal(lar_model_quality(model, TORUS, 1, &file, &error), LAR_OK);
    assert_int_equal(lar_model_quality(model, TORUS, 1.01, &scaled, &error), LAR_OK);
    assert_below(fabs(embedded.volume / info.quality.volume - 1), 1e-12);
    assert_below(fabs(embedded.deviation_mean / info.quality.deviation_mean - 1), 1e-6);
    assert_below(fabs(file.deviation_mean / info.quality.deviation_mean - 1), 1e-6);
    assert_below(fabs(file.true_volume / info.quality.true_volume - 1), 1e-3);
    assert_below(fabs(scaled.true_volume / file.true_volume - 1.01 * 1.01 * 1.01), 1e-6);
    assert_true(scaled.deviation_mean > file.deviation_mean);
    error = (lar_error){0};
    assert_int_equal(lar_model_quality(model, TORUS, 0, &file, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_model_quality(model, TORUS, NAN, &file, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_model_quality(NULL, TORUS, 1, &file, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_model_quality(model, TORUS, 1, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_model_quality(model, "none.stl", 1, &file, &error), LAR_ERROR_IO);
    lar_model_destroy(model);
}

static void a_folder_that_cannot_be_is_told(void **state) {
    (void)state;
    static const char *const path[] = {TORUS};
    lar_meshing_options options = {.elements = 200};
    lar_meshing *meshing = NULL;
    const char *scene = NULL;
    assert_int_equal(lar_meshing_create(path, 1, &options, &meshing, &error), LAR_OK);
    assert_int_equal(lar_meshing_write(meshing, TORUS "/x", &scene, &error), LAR_ERROR_IO);
    assert_int_equal(lar_meshing_write(meshing, "", &scene, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_meshing_write(meshing, NULL, &scene, &error), LAR_ERROR_ARGUMENT);
    assert_null(scene);
    /* Twice is fine; the scene's path may be left out. */
    assert_int_equal(lar_meshing_write(meshing, FOLDER, NULL, &error), LAR_OK);
    assert_int_equal(lar_meshing_write(meshing, FOLDER, &scene, &error), LAR_OK);
    struct stat file;
    assert_int_equal(stat(scene, &file), 0);
    lar_meshing_destroy(meshing);
}

/* A rule for fibres: the scene has it, a mesh read alone has what it gives, bones have none. With
 * braces around it or without, on one line or on several. */
static void fibres_run_by_a_rule(void **state) {
    (void)state;
    static const char *const rules[] = {"wall: {axis: [1, 2, 3],\n\tangle: {inner: 30, outer: 90}}",
                                        "{around: {point: [0.001, 0, 0], axis: [0, 1, 0]}}"};
    lar_meshing_info info;
    for (int r = 0; r < 2; r++) {
        lar_mesh mesh = {0};
        lar_model *model =
            model_of(BALLS, (lar_meshing_options){.title = "fibres", .fibres = rules[r]}, &info);
        if (lar_mesh_read(FOLDER "/fibres.vtu", 1, &mesh, &error)) fail_msg("%s", error.message);
        int soft = 0;
        for (int32_t e = 0; e < mesh.element_count; e++) {
            const double *found = lar_model_fibre(model, e), *a = mesh.fibre[e];
            double length = hypot(hypot(a[0], a[1]), a[2]);
            bool bone = mesh.element_tag[e] == 2;
            if (bone) assert_true(length == 0 && !lar_fibre_here(&model->material[1].fibre));
            if (bone) continue;
            soft++;
            for (int i = 0; i < 3; i++) assert_below(fabs(a[i] / length - found[i]), 1e-12);
        }
        assert_true(soft > 100 && soft < mesh.element_count);
        assert_true(model->material[0].fibre.parameter[0] ==
                    0.75 * lar_material_shear(model->material));
        lar_mesh_clear(&mesh);
        lar_model_destroy(model);
    }
    /* One region of two. */
    const lar_meshing_options one = {
        .title = "fibres", .fibre_region = "left", .fibres = "axis: [0, 2, 0]"};
    lar_model *named = model_of(CUT, one, &info);
    assert_true(!lar_fibre_here(&named->material[0].fibre));
    assert_true(lar_fibre_here(&named->material[1].fibre));
    for (int32_t e = 0; e < named->mesh.element_count; e++)
        assert_true(lar_model_fibre(named, e)[1] == (named->mesh.element_tag[e] == 2 ? 1 : 0));
    lar_model_destroy(named);
    static const char *const wrong[][2] = {
        {"axis: [0, 0, 0]", "fibres:1:20: axis: this vector has no direction"},
        {"path: {from: support, to: away}", "the set \"away\" is unknown"},
        {"axis: [0, 0, 1]} # {", "this is not YAML"},
        {"mesh", "the key \"mesh\" is unknown"},
        {"axis: [1, 0, 0]", "fibres are asked for in \"right\", but the regions are starter_torus"},
        {"", "direction: expected mesh, {axis: [x, y, z]}"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *path = TORUS;
        lar_meshing *meshing = NULL;
        lar_meshing_options options = {.elements = 200, .fibres = wrong[i][0]};
        if (strcmp(wrong[i][0], "axis: [1, 0, 0]") == 0) options.fibre_region = "right";
        assert_int_not_equal(lar_meshing_create(&path, 1, &options, &meshing, &error), LAR_OK);
        if (!strstr(error.message, wrong[i][1]))
            fail_msg("\"%s\" lacks \"%s\"", error.message, wrong[i][1]);
    }
}

/* The same bytes where a comma is the decimal point. Where no such locale is installed the test
 * still holds. */
static void numbers_have_a_point_everywhere(void **state) {
    (void)state;
    const char *path[] = {TORUS}, *scene;
    const lar_meshing_options options = {.elements = 200};
    lar_meshing *meshing = NULL;
    lar_bytes text[2];
    if (lar_meshing_create(path, 1, &options, &meshing, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < 2; i++) {
        setlocale(LC_ALL, i ? "de_DE.UTF-8" : "C");
        lar_status status = lar_meshing_write(meshing, FOLDER, &scene, &error);
        setlocale(LC_ALL, "C");
        if (status || lar_bytes_read(scene, &text[i], &error)) fail_msg("%s", error.message);
    }
    assert_string_equal((const char *)text[0].data, (const char *)text[1].data);
    for (int i = 0; i < 2; i++) lar_bytes_free(&text[i]);
    lar_meshing_destroy(meshing);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_scene_of_two_regions_runs),
                                       cmocka_unit_test(fibres_run_by_a_rule),
                                       cmocka_unit_test(instruments_wait_beside_coarse_meshes_too),
                                       cmocka_unit_test(a_pull_grows_and_lets_go),
                                       cmocka_unit_test(a_pull_is_alike_on_every_mesh),
                                       cmocka_unit_test(a_thin_body_is_at_rest_at_the_end),
                                       cmocka_unit_test(a_thin_body_bears_its_weight),
                                       cmocka_unit_test(a_long_title_is_cut_for_the_files),
                                       cmocka_unit_test(what_nothing_holds_is_stretched),
                                       cmocka_unit_test(sides_are_where_they_are_said_to_be),
                                       cmocka_unit_test(a_loose_piece_is_held_at_its_own_end),
                                       cmocka_unit_test(an_interface_is_no_cut),
                                       cmocka_unit_test(quality_of_a_model_is_that_of_its_meshing),
                                       cmocka_unit_test(numbers_have_a_point_everywhere),
                                       cmocka_unit_test(a_folder_that_cannot_be_is_told)};
    return cmocka_run_group_tests(tests, write_files, NULL);
}
