/* From files to meshes by the public calls: figures, options, refusals. */
#include "testing.h"

#include "image_file.h"
#include "lariat.h"
#include "shapes.h"

#define ELLIPSOID LAR_TEST_BUILD "/meshing_ellipsoid.nrrd"
#define BALLS     LAR_TEST_BUILD "/meshing_balls.nrrd"
#define SPECK     LAR_TEST_BUILD "/meshing_speck.nrrd"
#define BLOCKS    LAR_TEST_BUILD "/meshing_blocks.nrrd"
#define TOMATO    LAR_TEST_BUILD "/meshing_tomato.nrrd"
#define TORUS     LAR_TEST_BUILD "/meshing_torus.vtp"
#define NUT       LAR_TEST_BUILD "/meshing_nut.vtp"

static lar_error error;

static int speck_label(const double x[3]) {
    return fabs(x[0]) < 1e-3 && fabs(x[1]) < 1e-3 && fabs(x[2]) < 1e-3;
}

/* A ball with three furrows, in more than a hundred blocks of 7 voxels. */
static int block_label(const double x[3]) {
    const double furrow = fmin(fabs(x[0]), fmin(fabs(x[1] + 4e-3), fabs(x[2] - 6e-3)));
    const double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (r > 19.3e-3 || (r > 6e-3 && furrow < 1.1e-3)) return 0;
    int at[3];
    for (int i = 0; i < 3; i++) at[i] = (int)floor((x[i] + 21.5e-3) / 7e-3);
    return 1 + at[0] + 7 * at[1] + 49 * at[2];
}

/* A ball of 18 mm with eight chambers. */
static int tomato_label(const double x[3]) {
    double chamber = 0, ball = 0;
    for (int i = 0; i < 3; i++) {
        chamber += (fabs(x[i]) - 7e-3) * (fabs(x[i]) - 7e-3);
        ball += x[i] * x[i];
    }
    return ball < 18e-3 * 18e-3 && chamber > 3.7e-3 * 3.7e-3;
}

static void write_surface(lar_triangles *surface, const char *path) {
    if (lar_vtp_write(path, surface, &error)) fail_msg("%s", error.message);
    lar_triangles_clear(surface);
}

static int write_files(void **state) {
    (void)state;
    static const char *const names[] = {"liver", "left rib"};
    lar_image image;
    lar_triangles surface;
    shape_image(&image, &shape_ellipsoid, 2e-3, SHAPE_OBLIQUE);
    image_file(&image, ELLIPSOID, names, 1);
    lar_image_clear(&image);
    shape_image(&image, &shape_balls, 2e-3, SHAPE_STRAIGHT);
    image_file(&image, BALLS, names, 2);
    lar_image_clear(&image);
    const int32_t size[3] = {9, 9, 9};
    const double spacing[3] = {2e-3, 2e-3, 2e-3};
    shape_image_of(&image, speck_label, size, spacing, SHAPE_STRAIGHT);
    image_file(&image, SPECK, NULL, 0);
    lar_image_clear(&image);
    const int32_t many[3] = {44, 44, 44};
    const double voxel[3] = {1e-3, 1e-3, 1e-3};
    shape_image_of(&image, block_label, many, voxel, SHAPE_STRAIGHT);
    image_file(&image, BLOCKS, NULL, 0);
    lar_image_clear(&image);
    shape_image_of(&image, tomato_label, many, voxel, SHAPE_STRAIGHT);
    image_file(&image, TOMATO, NULL, 0);
    lar_image_clear(&image);
    const double centre[3] = {0, 0, 0}, half[3] = {30, 24, 18};
    shape_torus_surface(&surface, 22, 8, centre, 24);
    write_surface(&surface, TORUS);
    shape_ellipsoid_surface(&surface, half, centre, 24);
    write_surface(&surface, NUT);
    return 0;
}

static lar_meshing *made(const char *path, const lar_meshing_options *options) {
    lar_meshing *meshing = NULL;
    if (lar_meshing_create(&path, 1, options, &meshing, &error)) fail_msg("%s", error.message);
    return meshing;
}

/* Whether it is refused with these words, and nothing is set. */
static void refused(const char *const *paths, int32_t count, const lar_meshing_options *options,
                    lar_status status, const char *words) {
    lar_meshing *meshing = NULL;
    error = (lar_error){0};
    assert_int_equal(lar_meshing_create(paths, count, options, &meshing, &error), status);
    assert_null(meshing);
    assert_int_equal(error.status, status);
    if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void check_quality(const lar_meshing_info *info, double true_volume) {
    const lar_mesh_quality *q = &info->quality;
    int32_t sum = 0;
    for (int b = 0; b < 10; b++) sum += q->jacobian_bin[b];
    assert_int_equal(sum, info->elements);
    assert_true(q->above_02 == 1);
    assert_true(q->above_05 > 0.9);
    assert_below(fabs(q->volume / true_volume - 1), 0.02);
    assert_below(fabs(q->volume / q->true_volume - 1), 0.02);
    assert_below(q->deviation_mean, 0.15 * info->size);
    assert_true(q->deviation_mean > 0);
    assert_true(q->deviation_mean <= q->deviation_max);
    assert_true(q->deviation_95 <= q->deviation_max);
    assert_below(fabs(q->mean_edge / info->size - 1), 0.2);
}

static void an_image_becomes_a_mesh(void **state) {
    (void)state;
    lar_meshing_options options = lar_meshing_options_default();
    lar_meshing_info info;
    lar_region_info region;
    options.elements = 1000;
    lar_meshing *meshing = made(ELLIPSOID, &options);
    lar_meshing_inspect(meshing, &info);
    assert_string_equal(info.title, "liver");
    assert_string_equal(info.name, "liver");
    assert_string_equal(info.fix, "back");
    assert_in_range(info.elements, 950, 1050);
    assert_int_equal(info.regions, 1);
    assert_int_equal(info.cuts, 0);
    assert_true(info.fixed_nodes > 0 && info.fixed_nodes < info.nodes / 2);
    check_quality(&info, shape_ellipsoid.volume);
    assert_int_equal(lar_meshing_region(meshing, 0, &region, &error), LAR_OK);
    assert_string_equal(region.name, "liver");
    assert_string_equal(region.tissue, "liver");
    assert_int_equal(region.tag, 1);
    assert_int_equal(region.elements, info.elements);
    assert_int_equal(region.held, 0);
    assert_below(fabs(region.volume / info.quality.volume - 1), 1e-9);
    assert_below(fabs(region.bulk_modulus / region.shear_modulus - 2 * 1.45 / 0.3), 1e-9);
    lar_meshing_destroy(meshing);
    lar_meshing_destroy(NULL);
}

/* Six times the volume within a region's true boundary, which is closed. */
static double enclosed(const lar_meshing *meshing, int32_t index) {
    lar_surface_arrays s;
    int32_t count = lar_meshing_region_boundary(meshing, index, NULL, NULL);
    assert_true(count > 0);
    int32_t(*triangle)[3] = lar_calloc((size_t)count, sizeof *triangle);
    double volume = 0, area[3] = {0};
    assert_int_equal(lar_meshing_region_boundary(meshing, index, triangle, &s), count);
    assert_int_equal(s.triangles, count);
    for (int32_t t = 0; t < count; t++) {
        const double *a = s.vertex[triangle[t][0]], *b = s.vertex[triangle[t][1]],
                     *c = s.vertex[triangle[t][2]];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            volume += a[i] * (b[j] * c[k] - b[k] * c[j]);
            area[i] += (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
        }
    }
    for (int i = 0; i < 3; i++) assert_below(fabs(area[i]), 1e-12);
    free(triangle);
    return volume;
}

static void regions_may_be_chosen_and_fused(void **state) {
    (void)state;
    static const char *const second[] = {"LEFT RIB"};
    lar_meshing_options options = lar_meshing_options_default();
    lar_meshing_info info;
    lar_region_info region;
    options.elements = 600;
    lar_meshing *meshing = made(BALLS, &options);
    lar_meshing_inspect(meshing, &info);
    assert_int_equal(info.regions, 2);
    assert_string_equal(info.title, "meshing_balls");
    check_quality(&info, shape_balls.volume);
    assert_int_equal(lar_meshing_region(meshing, 1, &region, &error), LAR_OK);
    assert_string_equal(region.tissue, "bone");
    assert_int_equal(region.held, 1);
    assert_below(fabs(region.volume / (shape_balls.volume / 2) - 1), 0.02);
    int32_t held = info.fixed_nodes;
    for (int32_t i = 0; i < 2; i++)
        assert_below(fabs(enclosed(meshing, i) / (6 * shape_balls.volume / 2) - 1), 0.01);
    assert_int_equal(lar_meshing_region_boundary(meshing, 2, NULL, NULL), -1);
    assert_int_equal(lar_meshing_region(meshing, 2, &region, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_meshing_region(meshing, -1, &region, &error), LAR_ERROR_ARGUMENT);
    lar_meshing_destroy(meshing);

    options.fuse = 1;
    meshing = made(BALLS, &options);
    lar_meshing_inspect(meshing, &info);
    assert_int_equal(info.regions, 1);
    assert_true(info.fixed_nodes < held);
    lar_meshing_destroy(meshing);

    options.fuse = 0;
    options.labels = second;
    options.label_count = 1;
    options.title = "Ball / two";
    options.fix = "none";
    meshing = made(BALLS, &options);
    lar_meshing_inspect(meshing, &info);
    assert_int_equal(info.regions, 1);
    assert_string_equal(info.title, "Ball / two");
    assert_string_equal(info.name, "Ball___two");
    assert_int_equal(info.fixed_nodes, info.nodes); /* all bone */
    lar_meshing_destroy(meshing);
}

static void surfaces_become_meshes(void **state) {
    (void)state;
    static const char *const both[] = {NUT, TORUS};
    lar_meshing_options options = lar_meshing_options_default();
    lar_meshing_info info;
    lar_meshing *meshing = NULL;
    options.elements = 0;
    options.size = 4e-3;
    options.scale = 1e-3;
    options.fix = "bottom";
    meshing = made(TORUS, &options);
    lar_meshing_inspect(meshing, &info);
    assert_string_equal(info.name, "meshing_torus");
    assert_string_equal(info.fix, "bottom");
    assert_true(info.size == 4e-3);
    check_quality(&info, info.quality.true_volume);
    assert_below(fabs(info.quality.true_volume / shape_torus.volume - 1), 0.03);
    lar_meshing_destroy(meshing);
    assert_int_equal(lar_meshing_create(both, 2, &options, &meshing, &error), LAR_OK);
    lar_meshing_inspect(meshing, &info);
    assert_int_equal(info.regions, 2);
    assert_string_equal(info.title, "meshing_nut");
    lar_meshing_destroy(meshing);
}

static void cubes_stay_cubes(void **state) {
    (void)state;
    lar_meshing_options options = {.voxel = 1};
    lar_meshing_info info;
    lar_meshing *meshing = made(ELLIPSOID, &options);
    lar_meshing_inspect(meshing, &info);
    assert_below(fabs(info.size - 2e-3), 1e-9);
    assert_int_equal(info.quality.jacobian_bin[9], info.elements);
    assert_below(fabs(info.quality.mean_edge - info.size), 1e-9);
    assert_below(fabs(info.elements * 8e-9 / shape_ellipsoid.volume - 1), 0.02);
    lar_meshing_destroy(meshing);
    options.elements = 300;
    options.principal = 1;
    meshing = made(ELLIPSOID, &options);
    lar_meshing_inspect(meshing, &info);
    assert_in_range(info.elements, 280, 320);
    assert_int_equal(info.quality.jacobian_bin[9], info.elements);
    lar_meshing_destroy(meshing);
}

static void what_makes_no_sense_is_refused(void **state) {
    (void)state;
    static const char *const image[] = {ELLIPSOID}, *const mixed[] = {TORUS, ELLIPSOID},
                             *const torus[] = {TORUS}, *const none[] = {"none.stl"},
                             *const text[] = {"a.txt"}, *const empty[] = {""},
                             *const speck[] = {SPECK}, *const label[] = {"7"};
    const lar_meshing_options plain = lar_meshing_options_default();
    const lar_status argument = LAR_ERROR_ARGUMENT;
    lar_meshing_options o = plain;
    refused(NULL, 1, NULL, argument, "at least one file");
    refused(image, 0, NULL, argument, "at least one file");
    assert_int_equal(lar_meshing_create(image, 1, NULL, NULL, &error), argument);
    refused(mixed, 2, NULL, argument, "mesh one image");
    refused(none, 1, NULL, LAR_ERROR_IO, "none.stl");
    refused(text, 1, NULL, argument, ".nrrd");
    refused(empty, 1, NULL, argument, "empty");
    refused(speck, 1, NULL, LAR_ERROR_MODEL, "1 voxel");
    o.size = 1e-3;
    refused(image, 1, &o, argument, "both given");
    o = (lar_meshing_options){.size = NAN};
    refused(image, 1, &o, argument, "finite");
    o = (lar_meshing_options){.size = -1};
    refused(image, 1, &o, argument, "not negative");
    o = (lar_meshing_options){.scale = 0.001};
    refused(image, 1, &o, argument, "for surfaces only");
    o = (lar_meshing_options){.labels = label, .label_count = 1};
    refused(torus, 1, &o, argument, "no labels");
    refused(image, 1, &o, LAR_ERROR_MODEL, "7");
    o = (lar_meshing_options){.label_count = 1};
    refused(image, 1, &o, argument, "NULL");
    o = (lar_meshing_options){.fuse = 1};
    refused(torus, 1, &o, argument, "fused");
    o = (lar_meshing_options){.names = "names.csv"};
    refused(torus, 1, &o, argument, "names");
    o = (lar_meshing_options){.title = ""};
    refused(image, 1, &o, argument, "title");
    o = (lar_meshing_options){.voxel = 1, .principal = 1};
    refused(image, 1, &o, argument, "principal");
    o = (lar_meshing_options){.elements = 100, .fix = "sideways"};
    refused(image, 1, &o, argument, "there are left, right");
    o.fix = "cut";
    refused(image, 1, &o, argument, "flat cut");
    o = (lar_meshing_options){.elements = 2};
    refused(image, 1, &o, LAR_ERROR_MODEL, "more elements");
    o = (lar_meshing_options){.size = 0.2};
    refused(image, 1, &o, LAR_ERROR_MODEL, "smaller size");
    assert_int_equal(lar_meshing_region(NULL, 0, NULL, &error), argument);
    assert_int_equal(lar_meshing_write(NULL, "x", NULL, &error), argument);
}

typedef struct patience {
    int told, max;
} patience;

static int progress(void *context, const char *what, double part) {
    patience *p = context;
    assert_true(*what && part >= 0 && part <= 1);
    return p->told++ < p->max;
}

static void it_can_be_stopped(void **state) {
    (void)state;
    static const char *const image[] = {ELLIPSOID};
    patience p = {.max = 1000000};
    lar_meshing_options o = {.elements = 200, .progress = progress, .context = &p};
    lar_meshing_destroy(made(ELLIPSOID, &o));
    int all = p.told;
    assert_true(all >= 5);
    for (int max = 0; max<all; max += all> 20 ? all / 10 : 1) {
        p = (patience){.max = max};
        refused(image, 1, &o, LAR_ERROR_ARGUMENT, "stopped");
        assert_int_equal(p.told, max + 1);
    }
}

/* Where regions are hardly larger than elements, outer faces that lie where a neighbour's boundary
 * is are drawn to that one. */
static void small_regions_follow_the_body(void **state) {
    (void)state;
    lar_meshing_options options = lar_meshing_options_default();
    options.elements = 800;
    lar_meshing *meshing = made(BLOCKS, &options);
    lar_meshing_info info;
    lar_meshing_inspect(meshing, &info);
    assert_true(info.regions > 100);
    assert_int_equal(info.quality.crossings, 0);
    if (!(info.quality.deviation_mean < 0.1 * info.quality.mean_edge))
        fail_msg("%.3f of an edge", info.quality.deviation_mean / info.quality.mean_edge);
    lar_meshing_destroy(meshing);
}

/* ---- without files ----------------------------------------------------------------------------
 */

/* Hollows that are filled are told, and the outer surface stays where it is. */
static void filled_hollows_move_nothing_else(void **state) {
    (void)state;
    lar_meshing_options options = lar_meshing_options_default();
    lar_meshing_info info;
    const double ball = 4.0 / 3 * M_PI * pow(18e-3, 3), chambers = 8 * ball * pow(3.7 / 18, 3);
    for (int coarse = 0; coarse < 2; coarse++) { /* where no cell sees a chamber */
        options.elements = coarse ? 100 : 1000;
        lar_meshing *meshing = made(TOMATO, &options);
        lar_meshing_inspect(meshing, &info);
        assert_int_equal(info.pinholes, 8);
        assert_true(coarse == (info.pinhole_cells == 0));
        assert_below(fabs(info.quality.volume / ball - 1), 0.015);
        assert_below(fabs(info.quality.true_volume / (ball - chambers) - 1), 0.01);
        assert_below(info.quality.deviation_mean, 0.08 * info.size);
        lar_meshing_destroy(meshing);
    }
}

static void same_mesh(const lar_meshing *left, const lar_meshing *right) {
    lar_mesh_arrays a, b;
    lar_surface_arrays s, t;
    lar_meshing_arrays(left, &a, &s);
    lar_meshing_arrays(right, &b, &t);
    assert_int_equal(a.nodes, b.nodes);
    assert_int_equal(a.elements, b.elements);
    assert_memory_equal(a.position, b.position, (size_t)a.nodes * sizeof *a.position);
    assert_memory_equal(a.element, b.element, (size_t)a.elements * sizeof *a.element);
    assert_int_equal(a.sets, b.sets);
    for (int32_t i = 0; i < a.sets; i++) {
        assert_string_equal(a.set[i].name, b.set[i].name);
        assert_string_equal(a.set[i].kind, b.set[i].kind);
        assert_int_equal(a.set[i].count, b.set[i].count);
    }
    assert_int_equal(s.triangles, t.triangles);
    assert_memory_equal(s.vertex, t.vertex, (size_t)s.vertices * sizeof *s.vertex);
}

static void images_in_memory_become_what_their_files_do(void **state) {
    (void)state;
    static const char *const names[] = {"liver"};
    const int32_t named[] = {1};
    lar_meshing_options options = lar_meshing_options_default();
    options.elements = 400;
    lar_meshing *of_file = made(ELLIPSOID, &options), *of_memory = NULL;
    lar_image *image = NULL, *copy = NULL;
    lar_image_info info;
    assert_int_equal(lar_image_open(ELLIPSOID, &image, &error), LAR_OK);
    lar_image_inspect(image, &info);
    info.names = 1;
    assert_int_equal(lar_image_create(&info, names, named, &copy, &error), LAR_OK);
    lar_image_destroy(image);
    assert_string_equal(lar_image_name(copy, 0, NULL), "liver");
    assert_int_equal(lar_meshing_of_image(copy, &options, &of_memory, &error), LAR_OK);
    same_mesh(of_file, of_memory);
    lar_image_destroy(copy);

    /* And the model, which is that of the files. */
    const char *scene = NULL, *path = NULL;
    lar_mesh_arrays mesh;
    lar_model *model[2] = {NULL, NULL};
    uint64_t hash[2];
    lar_meshing_arrays(of_memory, &mesh, NULL);
    assert_int_equal(lar_meshing_scene(of_memory, &scene, &error), LAR_OK);
    if (lar_model_from_arrays(&mesh, scene, &model[0], &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_meshing_write(of_file, LAR_TEST_BUILD "/meshing_of_memory", &path, &error),
                     LAR_OK);
    if (lar_model_open(path, &model[1], &error)) fail_msg("%s", error.message);
    for (int i = 0; i < 2; i++) {
        lar_simulation *simulation = NULL;
        assert_int_equal(lar_simulation_create(model[i], NULL, &simulation, &error), LAR_OK);
        assert_int_equal(lar_simulation_advance(simulation, 50, &error), LAR_OK);
        hash[i] = lar_simulation_hash(simulation);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model[i]);
    }
    assert_true(hash[0] == hash[1]);
    lar_meshing_destroy(of_file);
    lar_meshing_destroy(of_memory);
}

static void surfaces_in_memory_become_what_their_files_do(void **state) {
    (void)state;
    lar_triangles read;
    lar_meshing_options options = lar_meshing_options_default();
    options.elements = 400;
    options.title = "torus";
    if (lar_triangles_read(TORUS, 1, &read, &error)) fail_msg("%s", error.message);
    const lar_surface_arrays surface = {"meshing_torus", read.vertex_count, read.triangle_count,
                                        (const double(*)[3])read.vertex,
                                        (const int32_t(*)[3])read.corner};
    lar_meshing *of_memory = NULL, *of_file = made(TORUS, &options);
    assert_int_equal(lar_meshing_of_surfaces(&surface, 1, &options, &of_memory, &error), LAR_OK);
    same_mesh(of_file, of_memory);
    lar_meshing_destroy(of_file);
    lar_meshing_destroy(of_memory);
    lar_triangles_clear(&read);
}

static void what_is_none_in_memory_is_refused(void **state) {
    (void)state;
    static const int32_t triangle[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 4}};
    static const double vertex[4][3] = {{0}, {1}, {0, 1}, {0, 0, 1}};
    const uint16_t label[8] = {1};
    lar_surface_arrays surface = {NULL, 4, 4, vertex, triangle};
    lar_image_info info = {.size = {2, 2, 2}, .label = label};
    lar_meshing *meshing = NULL;
    lar_image *image = NULL;
    const char *scene = NULL;
    assert_int_equal(lar_meshing_of_surfaces(&surface, 1, NULL, &meshing, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "triangle 3 has the vertex 4"));
    surface.triangles = 3;
    assert_int_equal(lar_meshing_of_surfaces(&surface, 1, NULL, &meshing, &error),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_meshing_of_surfaces(NULL, 1, NULL, &meshing, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_meshing_of_surfaces(&surface, 0, NULL, &meshing, &error),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_meshing_of_image(NULL, NULL, &meshing, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_meshing_scene(NULL, &scene, &error), LAR_ERROR_ARGUMENT);
    lar_meshing_arrays(NULL, NULL, &surface);
    assert_int_equal(surface.triangles, 0);
    assert_int_equal(lar_image_create(&info, NULL, NULL, &image, &error), LAR_ERROR_FORMAT);
    for (int a = 0; a < 3; a++) info.to_world[a][a] = 0.001;
    info.names = 1;
    assert_int_equal(lar_image_create(&info, NULL, NULL, &image, &error), LAR_ERROR_ARGUMENT);
    info.size[1] = 100000;
    assert_int_equal(lar_image_create(&info, NULL, NULL, &image, &error), LAR_ERROR_ARGUMENT);
    assert_null(meshing);
    assert_null(image);
    info = (lar_image_info){.size = {2, 2, 2}, .label = label};
    for (int a = 0; a < 3; a++) info.to_world[a][a] = 0.001;
    assert_int_equal(lar_image_create(&info, NULL, NULL, &image, &error), LAR_OK);
    const lar_meshing_options options = {.names = "names.csv"};
    assert_int_equal(lar_meshing_of_image(image, &options, &meshing, &error), LAR_ERROR_ARGUMENT);
    lar_image_destroy(image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_image_becomes_a_mesh),
        cmocka_unit_test(regions_may_be_chosen_and_fused),
        cmocka_unit_test(surfaces_become_meshes),
        cmocka_unit_test(cubes_stay_cubes),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(small_regions_follow_the_body),
        cmocka_unit_test(filled_hollows_move_nothing_else),
        cmocka_unit_test(it_can_be_stopped),
        cmocka_unit_test(images_in_memory_become_what_their_files_do),
        cmocka_unit_test(surfaces_in_memory_become_what_their_files_do),
        cmocka_unit_test(what_is_none_in_memory_is_refused)};
    return cmocka_run_group_tests(tests, write_files, NULL);
}
