/* Regions as bodies of their own: nothing in common, nothing in each other, and contact between
 * them that pushes and does not pull. */
#include "lariat.h"
#include "meshing/meshing.h"
#include "shapes.h"

static lar_error error;

static lar_meshing *made(const shape *body, int32_t elements, bool apart) {
    lar_image image;
    lar_meshing *meshing = NULL;
    lar_meshing_options options = lar_meshing_options_default();
    options.elements = elements;
    options.apart = apart;
    shape_image(&image, body, 1e-3, SHAPE_OBLIQUE);
    if (lar_meshing_of_image(&image, &options, &meshing, &error)) fail_msg("%s", error.message);
    lar_image_clear(&image);
    return meshing;
}

/* Three thick slices of a ball, the middle one a wedge that ends within it. */
static int slices_label(const double x[3]) {
    if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] >= 0.024 * 0.024) return 0;
    if (fabs(x[0]) < 0.5 * (0.012 - x[2])) return 2;
    return x[0] < 0 ? 1 : 3;
}

static const shape slices = {
    "slices", slices_label, {0.024, 0.024, 0.024}, 4.0 / 3 * SHAPE_PI * 1.3824e-5, 3, 1};

static int32_t count_bodies(const lar_mesh *mesh) {
    int32_t count = 0, *body = calloc((size_t)mesh->node_count, sizeof *body);
    assert_non_null(body);
    lar_mesh_bodies(mesh, body);
    for (int32_t n = 0; n < mesh->node_count; n++) count += body[n] == n;
    free(body);
    return count;
}

static void check_tags(const lar_mesh *mesh) {
    int32_t *tag = calloc((size_t)mesh->node_count, sizeof *tag);
    assert_non_null(tag);
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) {
            int32_t *of_node = &tag[mesh->element[e][a]];
            assert_true(*of_node == 0 || *of_node == mesh->element_tag[e]);
            *of_node = mesh->element_tag[e];
        }
    free(tag);
}

static void regions_have_no_node_in_common(void **state) {
    (void)state;
    static const shape *const shapes[] = {&shape_balls, &slices};
    for (int i = 0; i < 2; i++) {
        lar_meshing *whole = made(shapes[i], 900, false), *parted = made(shapes[i], 900, true);
        lar_meshing_info info;
        lar_region_info region;
        lar_meshing_inspect(parted, &info);
        assert_int_equal(count_bodies(&whole->mesh), 1);
        assert_int_equal(count_bodies(&parted->mesh), shapes[i]->labels);
        check_tags(&parted->mesh);
        assert_true(info.parted > 0);
        assert_int_equal(info.nodes, whole->mesh.node_count + info.parted);
        assert_int_equal(info.elements, whole->mesh.element_count);
        assert_int_equal(info.quality.crossings, 0);
        for (int32_t r = 0; r < info.regions; r++) {
            assert_int_equal(lar_meshing_region(parted, r, &region, &error), LAR_OK);
            assert_below(fabs(region.volume / region.true_volume - 1), 0.02);
        }
        const lar_set *all = lar_mesh_find_set(&parted->mesh, "surface", LAR_SET_FACES);
        const lar_set *before = lar_mesh_find_set(&whole->mesh, "surface", LAR_SET_FACES);
        assert_non_null(all);
        assert_true(all->count > before->count);
        lar_meshing_destroy(whole);
        lar_meshing_destroy(parted);
    }
}

/* The starter scene runs, and without its pull nothing presses on anything. */
static void bodies_do_not_push_each_other_at_rest(void **state) {
    (void)state;
    static const shape *const shapes[] = {&shape_balls, &slices};
    for (int i = 0; i < 2; i++) {
        lar_meshing *meshing = made(shapes[i], 900, true);
        const char *scene = NULL;
        lar_mesh_arrays mesh;
        lar_surface_arrays surface;
        lar_model *model = NULL;
        lar_simulation *simulation = NULL;
        lar_energy energies;
        lar_meshing_arrays(meshing, &mesh, &surface);
        assert_int_equal(surface.triangles, 0);
        assert_int_equal(lar_meshing_scene(meshing, &scene, &error), LAR_OK);
        assert_non_null(strstr(scene, "\ncontact: [ { self: true } ]"));
        assert_null(strstr(scene, "surface: \""));
        char *still = lar_strdup(scene), *load = strstr(still, "\nload:");
        assert_non_null(load);
        memcpy(load, "\ndata:", 6); /* an unknown key is refused */
        assert_int_equal(lar_model_from_arrays(&mesh, still, &model, &error), LAR_ERROR_FORMAT);
        char *end = strstr(load, "\n# Instruments");
        memmove(load, end, strlen(end) + 1);
        if (lar_model_from_arrays(&mesh, still, &model, &error)) fail_msg("%s", error.message);
        assert_int_equal(lar_simulation_create(model, NULL, &simulation, &error), LAR_OK);
        assert_int_equal(lar_simulation_advance(simulation, 200, &error), LAR_OK);
        lar_simulation_energy(simulation, &energies);
        assert_true(energies.kinetic == 0 && energies.strain == 0 && energies.contact == 0);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
        free(still);
        lar_meshing_destroy(meshing);
    }
}

/* The mean displacement along x of each ball after the left one was pulled. */
static void pull(const lar_mesh_arrays *mesh, double force, double mean[2]) {
    char scene[2000];
    snprintf(scene, sizeof scene,
             "lariat: 1\ntime_step: auto\ndamping: 60\ncontact: [ { self: true } ]\n"
             "materials:\n"
             "  - { name: a, cells: [1, 2], density: 1000, law: neo-hookean, shear_modulus: 3000,\n"
             "      bulk_modulus: 30000 }\n"
             "fix:\n"
             "  - { nodes: { box: [[-1, -1, -1], [1, -0.016, 1]] }, axes: xyz }\n"
             "load:\n"
             "  - { nodes: { all: [ { tag: 1 }, { box: [[-1, 0.008, -1], [1, 1, 1]] } ] },\n"
             "      force: [%g, 0, 0], over: 0.1 }\n",
             force);
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    if (lar_model_from_arrays(mesh, scene, &model, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_simulation_create(model, NULL, &simulation, &error), LAR_OK);
    while (lar_simulation_time(simulation) < 0.4)
        if (lar_simulation_advance(simulation, 100, &error)) fail_msg("%s", error.message);
    double(*u)[3] = calloc((size_t)mesh->nodes, sizeof *u);
    lar_simulation_displacements(simulation, u);
    int32_t count[2] = {0};
    mean[0] = mean[1] = 0;
    for (int32_t e = 0; e < mesh->elements; e++)
        for (int a = 0; a < 8; a++) {
            int ball = mesh->tag[e] - 1;
            mean[ball] += u[mesh->element[e][a]][0];
            count[ball]++;
        }
    for (int ball = 0; ball < 2; ball++) mean[ball] /= count[ball];
    free(u);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void they_push_and_do_not_pull(void **state) {
    (void)state;
    lar_image image;
    lar_meshing *meshing = NULL;
    lar_meshing_options options = lar_meshing_options_default();
    lar_mesh_arrays mesh;
    double towards[2], away[2];
    options.elements = 600;
    options.apart = 1;
    shape_image(&image, &shape_balls, 1e-3, SHAPE_STRAIGHT);
    if (lar_meshing_of_image(&image, &options, &meshing, &error)) fail_msg("%s", error.message);
    lar_image_clear(&image);
    lar_meshing_arrays(meshing, &mesh, NULL);
    pull(&mesh, 0.05, towards);
    pull(&mesh, -0.05, away);
    print_message("towards: %.3g and %.3g mm; away: %.3g and %.3g mm\n", 1e3 * towards[0],
                  1e3 * towards[1], 1e3 * away[0], 1e3 * away[1]);
    assert_true(towards[0] > 5e-4 && towards[1] > 0.2 * towards[0]);
    assert_true(away[0] < -5e-4 && fabs(away[1]) < 1e-3 * -away[0]);
    assert_true(-away[0] > towards[0]);
    lar_meshing_destroy(meshing);
}

static void what_is_written_has_no_true_surface(void **state) {
    (void)state;
    const char *scene = NULL;
    char path[1000];
    lar_meshing *meshing = made(&shape_balls, 300, true);
    lar_model *model = NULL;
    if (lar_meshing_write(meshing, LAR_TEST_BUILD "/meshing_apart", &scene, &error))
        fail_msg("%s", error.message);
    if (lar_model_open(scene, &model, &error)) fail_msg("%s", error.message);
    snprintf(path, sizeof path, "%.*s_surface.vtp", (int)(strlen(scene) - strlen(".yaml")), scene);
    FILE *file = fopen(path, "rb");
    assert_null(file);
    lar_model_destroy(model);
    lar_meshing_destroy(meshing);
}

static void fused_regions_cannot_be_apart(void **state) {
    (void)state;
    lar_image image;
    lar_meshing *meshing = NULL;
    lar_meshing_options options = lar_meshing_options_default();
    options.apart = options.fuse = 1;
    shape_image(&image, &shape_balls, 2e-3, SHAPE_STRAIGHT);
    assert_int_equal(lar_meshing_of_image(&image, &options, &meshing, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "apart"));
    lar_image_clear(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regions_have_no_node_in_common),
        cmocka_unit_test(bodies_do_not_push_each_other_at_rest),
        cmocka_unit_test(they_push_and_do_not_pull),
        cmocka_unit_test(what_is_written_has_no_true_surface),
        cmocka_unit_test(fused_regions_cannot_be_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
