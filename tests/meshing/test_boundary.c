/* The true boundary: closed, with the volume of its voxels, the same body in every frame. */
#include "shapes.h"

#include <unistd.h>

#include "base/vector.h"
#include "meshing/boundary/boundary.h"
#include "model/triangles/tree.h"

static const shape *const shapes[] = {&shape_ellipsoid, &shape_torus, &shape_balls, &shape_sheet,
                                      &shape_holes};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static void make(const lar_image *image, const lar_label_choice *choice, lar_boundary *boundary) {
    lar_error error = {0};
    if (lar_boundary_from_image(image, choice, boundary, &error)) fail_msg("%s", error.message);
}

/* The triangles around a region, corners counter-clockwise seen from outside of it. */
static void around(const lar_boundary *boundary, int region, lar_triangles *out) {
    const lar_triangles *all = &boundary->triangles;
    shape_surface_begin(out, all->vertex_count, all->triangle_count);
    memcpy(out->vertex, all->vertex, (size_t)all->vertex_count * sizeof *all->vertex);
    out->triangle_count = 0;
    for (int32_t t = 0; t < all->triangle_count; t++) {
        const int32_t *c = all->corner[t];
        if (boundary->side[t][1] == region)
            shape_triangle(out, out->triangle_count++, c[0], c[1], c[2]);
        else if (boundary->side[t][0] == region)
            shape_triangle(out, out->triangle_count++, c[0], c[2], c[1]);
    }
}

static int by_edge(const void *a, const void *b) {
    const int32_t *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Every edge is used as often forth as back; gives the number of edges. */
static int check_closed(const lar_triangles *surface) {
    size_t count = 3 * (size_t)surface->triangle_count;
    int32_t(*edge)[3] = lar_calloc(count, sizeof *edge);
    for (size_t e = 0; e < count; e++) {
        const int32_t *c = surface->corner[e / 3];
        int32_t from = c[e % 3], to = c[(e + 1) % 3];
        assert_int_not_equal(from, to);
        edge[e][0] = from < to ? from : to;
        edge[e][1] = from < to ? to : from;
        edge[e][2] = from < to ? 1 : -1;
    }
    qsort(edge, count, sizeof *edge, by_edge);
    int edges = 0, sum = 0;
    for (size_t e = 0; e < count; e++) {
        sum += edge[e][2];
        if (e + 1 < count && by_edge(edge[e], edge[e + 1]) == 0) continue;
        if (sum != 0) fail_msg("edge %d-%d is open", (int)edge[e][0], (int)edge[e][1]);
        edges++;
    }
    free(edge);
    return edges;
}

static int count_vertices(const lar_triangles *surface) {
    bool *used = lar_calloc((size_t)surface->vertex_count, sizeof *used);
    int count = 0;
    for (int32_t t = 0; t < surface->triangle_count; t++)
        for (int c = 0; c < 3; c++) used[surface->corner[t][c]] = true;
    for (int32_t v = 0; v < surface->vertex_count; v++) count += used[v];
    free(used);
    return count;
}

/* Closed, and the volume is that of the voxels: the part by which it is off. */
static double check_regions(const lar_boundary *boundary) {
    double worst = 0;
    for (int r = 1; r <= boundary->region_count; r++) {
        lar_triangles surface;
        around(boundary, r, &surface);
        check_closed(&surface);
        double off = lar_triangles_volume(&surface) / boundary->region[r].volume - 1;
        worst = fmax(worst, fabs(off));
        lar_triangles_clear(&surface);
    }
    return worst;
}

static void test_shapes(void **state) {
    (void)state;
    for (int s = 0; s < SHAPES; s++)
        for (int frame = 0; frame < 3; frame++) {
            lar_image image;
            lar_boundary boundary;
            shape_image(&image, shapes[s], 2e-3, (shape_frame)frame);
            make(&image, NULL, &boundary);
            assert_int_equal(boundary.region_count, shapes[s]->labels);
            assert_int_equal(boundary.cut_count, 0);
            double volume = 0;
            for (int r = 1; r <= boundary.region_count; r++) volume += boundary.region[r].volume;
            assert_below(fabs(volume / shapes[s]->volume - 1), 0.025);
            assert_below(check_regions(&boundary), 1e-3);
            if (shapes[s]->labels == 1) { /* a closed surface has twice the body's characteristic */
                int edges = check_closed(&boundary.triangles);
                assert_int_equal(count_vertices(&boundary.triangles) - edges +
                                     boundary.triangles.triangle_count,
                                 2 * shapes[s]->euler);
            }
            for (int a = 0; a < 3; a++) assert_below(fabs(lar_length(boundary.axis[a]) - 1), 1e-12);
            double third[3];
            lar_cross(boundary.axis[0], boundary.axis[1], third);
            assert_below(fabs(lar_dot(third, boundary.axis[2]) - 1), 1e-12);
            lar_boundary_clear(&boundary);
            lar_boundary_clear(&boundary);
            lar_image_clear(&image);
        }
}

/* How far the smoothed boundary lies from the body that the voxels were taken from. */
static void test_distance(void **state) {
    (void)state;
    lar_triangles truth;
    shape_ellipsoid_surface(&truth, shape_ellipsoid.half, (double[3]){0}, 48);
    lar_triangle_tree *tree = NULL;
    assert_int_equal(lar_triangle_tree_create(&truth, NULL, truth.triangle_count, &tree, NULL), 0);
    for (int frame = 0; frame < 3; frame++) {
        lar_image image;
        lar_boundary boundary;
        shape_image(&image, &shape_ellipsoid, 2e-3, (shape_frame)frame);
        make(&image, NULL, &boundary);
        double mean = 0, max = 0;
        for (int32_t v = 0; v < boundary.triangles.vertex_count; v++) {
            lar_nearest near;
            lar_triangle_tree_nearest(tree, boundary.triangles.vertex[v], INFINITY, &near);
            mean += near.distance / boundary.triangles.vertex_count;
            max = fmax(max, near.distance);
        }
        assert_below(mean, 0.1 * 2e-3); /* measured: 0.06 voxels; the voxels themselves: 0.3 */
        assert_below(max, 0.5 * 2e-3);
        lar_boundary_clear(&boundary);
        lar_image_clear(&image);
    }
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&truth);
}

/* A left-handed image has the same body in the world, vertex by vertex, and so outwards normals. */
static void test_mirrored(void **state) {
    (void)state;
    lar_image image[2];
    lar_boundary boundary[2];
    for (int i = 0; i < 2; i++) {
        shape_image(&image[i], &shape_holes, 2e-3, i ? SHAPE_MIRRORED : SHAPE_STRAIGHT);
        make(&image[i], NULL, &boundary[i]);
    }
    lar_triangle_tree *tree = NULL;
    const lar_triangles *first = &boundary[0].triangles, *second = &boundary[1].triangles;
    assert_int_equal(first->vertex_count, second->vertex_count);
    assert_int_equal(lar_triangle_tree_create(first, NULL, first->triangle_count, &tree, NULL), 0);
    for (int32_t v = 0; v < second->vertex_count; v++) {
        lar_nearest near;
        lar_triangle_tree_nearest(tree, second->vertex[v], INFINITY, &near);
        assert_below(near.distance, 1e-9);
    }
    lar_triangle_tree_destroy(tree);
    assert_true(lar_triangles_volume(first) > 0 && lar_triangles_volume(second) > 0);
    for (int i = 0; i < 2; i++) {
        lar_boundary_clear(&boundary[i]);
        lar_image_clear(&image[i]);
    }
}

/* ---- where the image ends in the body ------------------------------------------------------- */

/* The ellipsoid in an image of 15 voxels along k, which cuts it at z = 15 mm above and below, and
 * of 16 along i, which cuts it at x = 16 mm on both sides. */
static void cut_image(lar_image *image, shape_frame frame) {
    shape_image_of(image, shape_ellipsoid_label, (int32_t[3]){16, 30, 15},
                   (double[3]){2e-3, 2e-3, 2e-3}, frame);
}

static void test_cuts(void **state) {
    (void)state;
    for (int frame = 0; frame < 3; frame++) {
        lar_image image;
        lar_boundary boundary;
        cut_image(&image, (shape_frame)frame);
        make(&image, NULL, &boundary);
        assert_int_equal(boundary.cut_count, 4);
        static const char *const name[6] = {"left", "right", "", "", "bottom", "top"};
        double area[LAR_CUTS] = {0};
        for (int s = 0; s < LAR_CUTS; s++) {
            bool turned = frame == SHAPE_MIRRORED && s < 2;
            assert_string_equal(boundary.cut[s].name, name[turned ? 1 - s : s]);
        }
        for (int32_t t = 0; t < boundary.triangles.triangle_count; t++) {
            if (boundary.side[t][0] < LAR_REGION_CUT) continue;
            int s = boundary.side[t][0] - LAR_REGION_CUT;
            const lar_cut *cut = &boundary.cut[s];
            const int32_t *corner = boundary.triangles.corner[t];
            double x[3][3], n[3];
            for (int c = 0; c < 3; c++) {
                lar_minus(boundary.triangles.vertex[corner[c]], cut->through, x[c]);
                assert_below(fabs(lar_dot(x[c], cut->normal)), 1e-12);
            }
            lar_minus(x[1], x[0], x[1]);
            lar_minus(x[2], x[0], x[2]);
            lar_cross(x[1], x[2], n);
            assert_true(lar_dot(n, cut->normal) >= 0);
            area[s] += lar_length(n) / 2;
        }
        if (frame != SHAPE_OBLIQUE) {
            /* Sharp: a cut is as large as the section through the middle of the last voxels, the
             * ellipse at x = 15 mm (half axes 20.8 and 15.6 mm) within z = 15 mm. */
            assert_below(fabs(area[0] / 1.013e-3 - 1), 0.02);
            assert_below(fabs(area[0] / area[1] - 1), 1e-9);
        }
        assert_below(check_regions(&boundary), 1e-3);
        lar_boundary_clear(&boundary);
        lar_image_clear(&image);
    }
}

/* Voxels of 3.05 x 3.05 x 10 mm, as chest scans have them. */
static int large_ball(const double x[3]) {
    return lar_dot(x, x) < 0.05 * 0.05 ? x[0] < 0.01 ? 1 : 7 : 0;
}

static void test_flat_voxels(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    shape_image_of(&image, large_ball, (int32_t[3]){36, 36, 12},
                   (double[3]){3.05e-3, 3.05e-3, 1e-2}, SHAPE_OBLIQUE);
    make(&image, NULL, &boundary);
    assert_int_equal(boundary.region_count, 2);
    assert_int_equal(boundary.region[2].tag, 7);
    assert_below(check_regions(&boundary), 1e-3);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* Axes that are not square to each other: volumes are right all the same, and so are the cuts. */
static void test_sheared(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    cut_image(&image, SHAPE_STRAIGHT);
    image.to_world[0][1] = 0.5e-3;
    image.to_world[1][2] = -0.4e-3;
    make(&image, NULL, &boundary);
    assert_below(check_regions(&boundary), 1e-3);
    for (int a = 0; a < 3; a++)
        assert_below(fabs(lar_dot(boundary.axis[a], boundary.axis[(a + 1) % 3])), 1e-12);
    for (int32_t t = 0; t < boundary.triangles.triangle_count; t++) {
        if (boundary.side[t][0] < LAR_REGION_CUT) continue;
        const lar_cut *cut = &boundary.cut[boundary.side[t][0] - LAR_REGION_CUT];
        for (int c = 0; c < 3; c++) {
            double x[3];
            lar_minus(boundary.triangles.vertex[boundary.triangles.corner[t][c]], cut->through, x);
            assert_below(fabs(lar_dot(x, cut->normal)), 1e-12);
        }
    }
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* ---- small and awkward ---------------------------------------------------------------------- */

static int (*index_label)(int i, int j, int k);

/* An image of 8 x 8 x 8 unit voxels by index. */
static int by_index(const double x[3]) {
    return index_label((int)lround(x[0] + 3.5), (int)lround(x[1] + 3.5), (int)lround(x[2] + 3.5));
}

static void index_image(lar_image *image, int (*label)(int i, int j, int k)) {
    index_label = label;
    shape_image_of(image, by_index, (int32_t[3]){8, 8, 8}, (double[3]){1, 1, 1}, SHAPE_STRAIGHT);
}

/* Two blocks that meet in an edge, two that meet in a corner, a lone voxel, a hollow. */
static int touching(int i, int j, int k) {
    if (i >= 1 && i < 4 && j >= 1 && j < 4 && k >= 1 && k < 4) return !(i == 2 && j == 2 && k == 2);
    if (i >= 4 && i < 6 && j >= 4 && j < 6 && k >= 2 && k < 4) return 1;
    if (i >= 4 && i < 6 && j >= 2 && j < 4 && k >= 4 && k < 6) return 2;
    return i == 6 && j == 6 && k == 6 ? 3 : 0;
}

static void test_touching(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    index_image(&image, touching);
    make(&image, NULL, &boundary);
    assert_int_equal(boundary.region_count, 3);
    assert_below(fabs(boundary.region[1].volume - 34), 1e-9);
    assert_below(fabs(boundary.region[3].volume - 1), 1e-9);
    assert_below(check_regions(&boundary), 1e-3);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* A rod of one voxel's width on a plate of one voxel's thickness beside a block. */
static int thin(int i, int j, int k) {
    if (i >= 1 && i < 7 && j >= 1 && j < 7 && k == 1) return 1;
    if (i >= 1 && i < 4 && j >= 1 && j < 4 && k < 4 && k >= 1) return 1;
    return i == 5 && j == 5 && k < 7 && k >= 1;
}

/* Smoothing eats up neither, though volumes could be made up for elsewhere. */
static void test_thin(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    index_image(&image, thin);
    make(&image, NULL, &boundary);
    assert_below(check_regions(&boundary), 1e-3);
    int rod = 0;
    for (int32_t v = 0; v < boundary.triangles.vertex_count; v++) {
        const double *x = boundary.triangles.vertex[v];
        double beside[2] = {fabs(x[0] - 1.5), fabs(x[1] - 1.5)};
        if (x[2] < -1.6 || beside[0] > 1 || beside[1] > 1) continue;
        rod++;
        for (int a = 0; a < 2; a++) assert_true(beside[a] > 0.249 && beside[a] < 0.751);
    }
    assert_int_equal(rod, 4 * 5);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* All of the image is body: cut on all sides, nothing moves. */
static int everything(int i, int j, int k) {
    (void)i, (void)j, (void)k;
    return 5;
}

static void test_all_cut(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    index_image(&image, everything);
    make(&image, NULL, &boundary);
    assert_int_equal(boundary.cut_count, 6);
    assert_int_equal(boundary.triangles.triangle_count, 2 * 6 * 64);
    assert_below(fabs(lar_triangles_volume(&boundary.triangles) - 512), 1e-9);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

static void refuse(const lar_image *image, const char *word, const char *said) {
    lar_boundary boundary;
    lar_error error = {0};
    lar_label_choice choice = {.count = word ? 1 : 0, .word = &word};
    assert_int_equal(lar_boundary_from_image(image, &choice, &boundary, &error), LAR_ERROR_MODEL);
    if (!strstr(error.message, said)) fail_msg("\"%s\" lacks \"%s\"", error.message, said);
    assert_null(boundary.triangles.vertex);
}

static int nothing(int i, int j, int k) {
    return 0 * (i + j + k);
}

static int lone(int i, int j, int k) {
    return i == 3 && j == 3 && k == 3 ? 9 : 0;
}

static void test_refused(void **state) {
    (void)state;
    lar_image image;
    index_image(&image, touching);
    refuse(&image, "4", "label \"4\" has no voxel; there are 1, 2, 3");
    refuse(&image, "liver", "no label \"liver\"; there are 1, 2, 3");
    refuse(&image, "0", "label 0");
    refuse(&image, "3", "label 3 (label_3) has 1 voxel only");
    refuse(&image, "99999999999999999999", "no label");
    lar_image_clear(&image);
    index_image(&image, nothing);
    refuse(&image, NULL, "no voxel has a label");
    lar_image_clear(&image);
    index_image(&image, lone);
    refuse(&image, NULL, "label 9 (label_9) has 1 voxel only");
    lar_image_clear(&image);
}

static int checkers(const double x[3]) {
    return 1 + ((int)lround(x[0] + x[1] + x[2] + 1000) & 1);
}

/* A picture, read as a label map: bounded memory, and a sentence. */
static void test_noise(void **state) {
    (void)state;
    lar_image image;
    shape_image_of(&image, checkers, (int32_t[3]){181, 181, 181}, (double[3]){1, 1, 1},
                   SHAPE_STRAIGHT);
    refuse(&image, NULL, "as noise has");
    lar_image_clear(&image);
}

static void test_choice(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    index_image(&image, touching);
    image.name = lar_calloc(1, sizeof *image.name);
    image.name_count = 1;
    image.name[0] = (lar_label_name){.label = 2, .name = lar_strdup("Spleen")};
    const char *words[] = {"spleen", "1", "2"};
    make(&image, &(lar_label_choice){.count = 3, .word = words}, &boundary);
    assert_int_equal(boundary.region_count, 2); /* in the order they were asked for */
    assert_string_equal(boundary.region[1].name, "Spleen");
    assert_string_equal(boundary.region[2].name, "label_1");
    assert_int_equal(boundary.region_of_label[1], 2);
    assert_int_equal(boundary.region_of_label[3], 0);
    lar_boundary_clear(&boundary);
    make(&image, &(lar_label_choice){.count = 2, .word = words, .fuse = true}, &boundary);
    assert_int_equal(boundary.region_count, 1);
    assert_string_equal(boundary.region[1].name, "body");
    assert_below(fabs(boundary.region[1].volume - 42), 1e-9);
    for (int32_t t = 0; t < boundary.triangles.triangle_count; t++)
        assert_true(lar_boundary_between(&boundary, t, 1, 0));
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* ---- surfaces ------------------------------------------------------------------------------- */

static void test_surfaces(void **state) {
    (void)state;
    lar_triangles surface[3];
    const double large[3] = {0.03, 0.024, 0.018}, small[3] = {0.01, 0.01, 0.01};
    const double off[3] = {0.03, 0, 0};
    shape_ellipsoid_surface(&surface[0], large, (double[3]){0}, 24);
    shape_ellipsoid_surface(&surface[1], small, (double[3]){0.001, 0.002, 0}, 24);
    shape_ellipsoid_surface(&surface[2], small, off, 24); /* half of it outside */
    double volume[2] = {lar_triangles_volume(&surface[0]), lar_triangles_volume(&surface[1])};
    const char *const names[] = {"liver", "tumour", "gallbladder"};
    lar_boundary boundary;
    lar_error error = {0};
    if (lar_boundary_from_surfaces(surface, names, 3, &boundary, &error))
        fail_msg("%s", error.message);
    assert_null(surface[0].vertex);
    assert_true(boundary.nested && boundary.region_count == 3);
    assert_string_equal(boundary.region[2].name, "tumour");
    assert_below(fabs(boundary.region[2].volume / volume[1] - 1), 2e-3);
    assert_true(boundary.region[1].volume < volume[0] - 1.2 * volume[1]);
    assert_true(boundary.region[1].volume > volume[0] - 1.6 * volume[1]);

    lar_triangles outer;
    assert_int_equal(lar_boundary_outer(&boundary, &outer, NULL), LAR_OK);
    int32_t seen[4] = {0};
    for (int32_t t = 0; t < outer.triangle_count; t++) seen[outer.tag[t]]++;
    int32_t each = 4 * 24 * 23;
    assert_true(seen[1] > each / 2 && seen[1] < each); /* but where the gallbladder has the place */
    assert_int_equal(seen[2], 0);
    assert_true(seen[3] > each / 4 && seen[3] < each);
    lar_triangles_clear(&outer);

    assert_true(lar_boundary_between(&boundary, 0, 1, 0));
    assert_false(lar_boundary_between(&boundary, 0, 1, 2));
    assert_true(lar_boundary_between(&boundary, each, 1, 2));
    assert_true(lar_boundary_between(&boundary, 2 * each, 3, 0));
    lar_boundary_clear(&boundary);
}

/* The area that is seen of each of two boxes. */
static void see_boxes(const double lower[2][3], const double upper[2][3], double area[2]) {
    const char *const name[2] = {"one", "other"};
    lar_triangles surface[2], outer;
    lar_boundary boundary;
    lar_error error = {0};
    for (int b = 0; b < 2; b++) shape_box_surface(&surface[b], lower[b], upper[b]);
    if (lar_boundary_from_surfaces(surface, name, 2, &boundary, &error) ||
        lar_boundary_outer(&boundary, &outer, &error))
        fail_msg("%s", error.message);
    area[0] = area[1] = 0;
    for (int32_t t = 0; t < outer.triangle_count; t++) {
        double normal[3];
        lar_triangles_normal(&outer, t, normal);
        area[outer.tag[t] - 1] += lar_length(normal) / 2;
    }
    lar_triangles_clear(&outer);
    lar_boundary_clear(&boundary);
}

/* Surfaces that lie on each other exactly: boxes side by side, along each axis and in both orders,
 * and one in the other's corner. */
static void test_surfaces_that_touch(void **state) {
    (void)state;
    double area[2];
    for (int axis = 0; axis < 3; axis++)
        for (int order = 0; order < 2; order++) {
            double lower[2][3] = {{0}}, upper[2][3] = {{2, 2, 2}, {2, 2, 2}};
            lower[!order][axis] = 2;
            upper[!order][axis] = 5;
            see_boxes((const double(*)[3])lower, (const double(*)[3])upper, area);
            assert_below(fabs(area[order] - 5 * 4), 1e-9);
            assert_below(fabs(area[!order] - (4 + 4 * 6)), 1e-9);
        }
    see_boxes((const double[][3]){{0, 0, 0}, {0, 0, 0}}, (const double[][3]){{4, 4, 4}, {2, 2, 2}},
              area);
    assert_below(fabs(area[1] - 3 * 4), 1e-9);
}

static void test_one_surface(void **state) {
    (void)state;
    lar_triangles surface;
    const char *const name = "torus";
    lar_boundary boundary;
    shape_torus_surface(&surface, 0.022, 0.008, (double[3]){0}, 24);
    double volume = lar_triangles_volume(&surface);
    assert_int_equal(lar_boundary_from_surfaces(&surface, &name, 1, &boundary, NULL), LAR_OK);
    assert_false(boundary.nested);
    assert_true(boundary.region[1].volume == volume);
    for (int a = 0; a < 3; a++) assert_true(boundary.axis[a][a] == 1);
    lar_boundary_clear(&boundary);

    shape_torus_surface(&surface, 0.022, 0.008, (double[3]){0}, 24);
    surface.triangle_count -= 3;
    lar_error error = {0};
    assert_int_not_equal(lar_boundary_from_surfaces(&surface, &name, 1, &boundary, &error), LAR_OK);
    assert_null(surface.vertex);
    assert_true(strlen(error.message) > 10);
}

/* The longest axis of an ellipsoid in an oblique image is the image's i. */
static int turned_ellipsoid(const double x[3]) {
    double direction[3][3], along[3] = {0};
    shape_directions(SHAPE_OBLIQUE, direction);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) along[b] += direction[a][b] * x[a];
    return shape_ellipsoid_label(along);
}

static void test_principal_axes(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    double direction[3][3], spacing = 2e-3;
    shape_directions(SHAPE_OBLIQUE, direction);
    shape_image_of(&image, turned_ellipsoid, (int32_t[3]){34, 34, 34},
                   (double[3]){spacing, spacing, spacing}, SHAPE_STRAIGHT);
    make(&image, NULL, &boundary);
    assert_int_equal(lar_boundary_principal_axes(&boundary, NULL), LAR_OK);
    for (int b = 0; b < 3; b++) {
        double along = 0;
        for (int a = 0; a < 3; a++) along += direction[a][b] * boundary.axis[b][a];
        assert_below(1 - fabs(along), 2e-3);
    }
    double third[3];
    lar_cross(boundary.axis[0], boundary.axis[1], third);
    assert_below(fabs(lar_dot(third, boundary.axis[2]) - 1), 1e-9);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* ---- real images ---------------------------------------------------------------------------- */

/* A chest of 3.05 x 3.05 x 10 mm voxels, where all seven organs meet: closed, volumes within 0.1 %,
 * and cut off at the sides where the image ends. */
static void test_chest(void **state) {
    (void)state;
    static const char path[] = LAR_TEST_SHARED "/data/labels/slicerio_chest.seg.nrrd";
    if (access(path, R_OK) != 0) {
        print_message("skipped: no shared data\n");
        return;
    }
    lar_image image;
    lar_boundary boundary;
    lar_error error = {0};
    if (lar_image_read(path, &image, &error)) fail_msg("%s", error.message);
    make(&image, NULL, &boundary);
    assert_int_equal(boundary.region_count, 7);
    assert_int_equal(boundary.cut_count, 3);
    assert_below(check_regions(&boundary), 1e-3);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_distance),
        cmocka_unit_test(test_mirrored),
        cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_flat_voxels),
        cmocka_unit_test(test_sheared),
        cmocka_unit_test(test_touching),
        cmocka_unit_test(test_thin),
        cmocka_unit_test(test_all_cut),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_choice),
        cmocka_unit_test(test_surfaces),
        cmocka_unit_test(test_one_surface),
        cmocka_unit_test(test_surfaces_that_touch),
        cmocka_unit_test(test_principal_axes),
        cmocka_unit_test(test_chest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
