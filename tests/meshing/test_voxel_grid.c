/* Grids over shapes whose volume and topology are known. */
#include "shapes.h"
#include "solid_test.h"

#include "base/vector.h"
#include "meshing/grid/voxel_grid_thin.h"

static void boundary_of(const shape *body, shape_frame frame, lar_image *image,
                        lar_boundary *boundary) {
    lar_error error = {0};
    shape_image(image, body, 1.5e-3, frame);
    if (lar_boundary_from_image(image, NULL, boundary, &error)) fail_msg("%s", error.message);
}

static void surface_boundary(lar_triangles *surface, int32_t count, lar_boundary *boundary) {
    static const char *const names[] = {"first", "second", "third"};
    lar_error error = {0};
    if (lar_boundary_from_surfaces(surface, names, count, boundary, &error))
        fail_msg("%s", error.message);
}

static size_t cell_count(const lar_voxel_grid *voxel_grid) {
    return (size_t)voxel_grid->cells[0] * (size_t)voxel_grid->cells[1] *
           (size_t)voxel_grid->cells[2];
}

static int inside_count(const lar_voxel_grid *voxel_grid) {
    int inside = 0;
    for (size_t c = 0; c < cell_count(voxel_grid); c++) inside += voxel_grid->region[c] != 0;
    return inside;
}

static double share_volume(const lar_voxel_grid *voxel_grid) {
    double sum = 0;
    for (size_t c = 0; c < cell_count(voxel_grid); c++) sum += voxel_grid->share[c] / 255.0;
    return sum * pow(voxel_grid->size, 3);
}

static void middle_of(const lar_voxel_grid *voxel_grid, int i, int j, int k, double x[3]) {
    const double at[3] = {i + 0.5, j + 0.5, k + 0.5};
    for (int b = 0; b < 3; b++) {
        x[b] = voxel_grid->origin[b];
        for (int a = 0; a < 3; a++) x[b] += voxel_grid->size * at[a] * voxel_grid->axis[a][b];
    }
}

static int region_at(const lar_voxel_grid *voxel_grid, int i, int j, int k) {
    if (i < 0 || j < 0 || k < 0 || i >= voxel_grid->cells[0] || j >= voxel_grid->cells[1] ||
        k >= voxel_grid->cells[2])
        return 0;
    return voxel_grid->region[lar_voxel_grid_cell(voxel_grid, i, j, k)];
}

/* Euler characteristic of the closed cells together: corners - edges + faces - cells. A corner, an
 * edge or a face is there when one of the cells around it is. */
static int euler_of(const lar_voxel_grid *voxel_grid) {
    int sum = 0;
    for (int k = 0; k <= voxel_grid->cells[2]; k++)
        for (int j = 0; j <= voxel_grid->cells[1]; j++)
            for (int i = 0; i <= voxel_grid->cells[0]; i++)
                for (int kind = 0; kind < 8; kind++) { /* bit a: extends along axis a */
                    bool there = false;
                    for (int around = 0; around < 8; around++) {
                        if (around & kind) continue;
                        there |= region_at(voxel_grid, i - (around & 1), j - (around >> 1 & 1),
                                           k - (around >> 2)) != 0;
                    }
                    int dimension = (kind & 1) + (kind >> 1 & 1) + (kind >> 2);
                    sum += there ? dimension % 2 ? -1 : 1 : 0;
                }
    return sum;
}

static void test_shapes(void **state) {
    (void)state;
    const shape *const shapes[] = {&shape_ellipsoid, &shape_torus, &shape_balls, &shape_sheet,
                                   &shape_holes};
    for (int s = 0; s < 5; s++)
        for (int frame = 0; frame < 3; frame++) {
            lar_image image;
            lar_boundary boundary;
            lar_voxel_grid voxel_grid = {0};
            boundary_of(shapes[s], (shape_frame)frame, &image, &boundary);
            double volume = 0;
            for (int r = 1; r <= boundary.region_count; r++) volume += boundary.region[r].volume;
            assert_int_equal(lar_voxel_grid_fill_count(&boundary, 5000, &voxel_grid, NULL), LAR_OK);
            assert_int_equal(voxel_grid.repaired, 0);
            assert_below(fabs(share_volume(&voxel_grid) / volume - 1), 5e-3);
            int inside = inside_count(&voxel_grid);
            /* Whole layers of cells of the flat shapes come and go. */
            assert_below(abs(inside - 5000), s < 3 ? 100 : 800);
            assert_int_equal(euler_of(&voxel_grid), shapes[s]->euler);
            for (size_t c = 0; c < cell_count(&voxel_grid); c++) {
                assert_true(voxel_grid.region[c] == 0 ||
                            voxel_grid.region[c] == voxel_grid.inner[c]);
                assert_true((voxel_grid.inner[c] != 0) == (voxel_grid.share[c] > 0) ||
                            voxel_grid.share[c] == 0);
                assert_true((voxel_grid.region[c] != 0) == (voxel_grid.share[c] > 127) ||
                            voxel_grid.share[c] == 127 || voxel_grid.share[c] == 128);
            }
            lar_voxel_grid_clear(&voxel_grid);
            lar_voxel_grid_clear(&voxel_grid);
            lar_boundary_clear(&boundary);
            lar_image_clear(&image);
        }
}

/* A ring of empty cells, and none more. */
static void test_ring(void **state) {
    (void)state;
    lar_triangles surface;
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    shape_torus_surface(&surface, 0.022, 0.008, (double[3]){0.5, -2, 7}, 24);
    surface_boundary(&surface, 1, &boundary);
    assert_int_equal(lar_voxel_grid_fill(&boundary, 0.003, &voxel_grid, NULL), LAR_OK);
    bool met[3] = {false};
    for (int k = 0; k < voxel_grid.cells[2]; k++)
        for (int j = 0; j < voxel_grid.cells[1]; j++)
            for (int i = 0; i < voxel_grid.cells[0]; i++) {
                size_t c = lar_voxel_grid_cell(&voxel_grid, i, j, k);
                int at[3] = {i, j, k};
                for (int a = 0; a < 3; a++) {
                    bool ring = at[a] == 0 || at[a] == voxel_grid.cells[a] - 1;
                    bool next = at[a] == 1 || at[a] == voxel_grid.cells[a] - 2;
                    if (ring) assert_int_equal(voxel_grid.share[c], 0);
                    met[a] |= next && voxel_grid.share[c] > 0;
                }
            }
    assert_true(met[0] && met[1] && met[2]);
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
}

/* A box of 8 x 6 x 4 cells lies on the grid's planes and its edges on lines: all exact. */
static void test_exact_box(void **state) {
    (void)state;
    lar_triangles surface;
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    shape_box_surface(&surface, (double[3]){-1, 2, 3}, (double[3]){7, 8, 7});
    surface_boundary(&surface, 1, &boundary);
    assert_int_equal(lar_voxel_grid_fill(&boundary, 1, &voxel_grid, NULL), LAR_OK);
    assert_int_equal(inside_count(&voxel_grid), 192);
    assert_int_equal(voxel_grid.cells[0], 10);
    for (size_t c = 0; c < cell_count(&voxel_grid); c++)
        assert_int_equal(voxel_grid.share[c], voxel_grid.region[c] ? 255 : 0);
    lar_voxel_grid_clear(&voxel_grid);
    /* Turned by 45 degrees the box's edges and diagonals run along lines of the grid. */
    for (int a = 0; a < 2; a++) {
        boundary.axis[0][a] = sqrt(0.5);
        boundary.axis[1][a] = a ? sqrt(0.5) : -sqrt(0.5);
    }
    assert_int_equal(lar_voxel_grid_fill(&boundary, sqrt(0.5), &voxel_grid, NULL), LAR_OK);
    assert_int_equal(voxel_grid.repaired, 0);
    assert_below(fabs(share_volume(&voxel_grid) / 192 - 1), 0.01);
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
}

static void test_counts(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    boundary_of(&shape_torus, SHAPE_OBLIQUE, &image, &boundary);
    static const int wanted[] = {200, 1000, 5000, 20000, 100000};
    for (int i = 0; i < 5; i++) {
        lar_voxel_grid voxel_grid = {0};
        assert_int_equal(lar_voxel_grid_fill_count(&boundary, wanted[i], &voxel_grid, NULL),
                         LAR_OK);
        assert_below(abs(inside_count(&voxel_grid) - wanted[i]), wanted[i] / 50);
        lar_voxel_grid_clear(&voxel_grid);
    }
    lar_voxel_grid voxel_grid = {0}; /* so few that the tube is thinner than half a cell */
    assert_int_equal(lar_voxel_grid_fill_count(&boundary, 1, &voxel_grid, NULL), LAR_OK);
    assert_true(inside_count(&voxel_grid) > 0);
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* Each half of the cells belongs to its ball. */
static void test_regions(void **state) {
    (void)state;
    lar_image image;
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    boundary_of(&shape_balls, SHAPE_STRAIGHT, &image, &boundary);
    assert_int_equal(lar_voxel_grid_fill_count(&boundary, 4000, &voxel_grid, NULL), LAR_OK);
    int count[3] = {0};
    for (int k = 0; k < voxel_grid.cells[2]; k++)
        for (int j = 0; j < voxel_grid.cells[1]; j++)
            for (int i = 0; i < voxel_grid.cells[0]; i++) {
                double x[3];
                int region = region_at(&voxel_grid, i, j, k);
                middle_of(&voxel_grid, i, j, k, x);
                count[region]++;
                if (region && fabs(x[0]) > 0.1 * voxel_grid.size)
                    assert_int_equal(region, x[0] < 0 ? 1 : 2);
            }
    assert_below(abs(count[1] - count[2]), 250); /* a layer of cells may lie on the interface */
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
    lar_image_clear(&image);
}

/* A ball in a ball, and one that sticks out: the later one has the place. */
static void test_nested(void **state) {
    (void)state;
    const double radius[3][3] = {{0.03, 0.03, 0.03}, {0.012, 0.012, 0.012}, {0.012, 0.012, 0.012}};
    const double centre[3][3] = {{0}, {0.006, 0, 0}, {-0.03, 0, 0}};
    lar_triangles surface[3];
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    for (int s = 0; s < 3; s++) shape_ellipsoid_surface(&surface[s], radius[s], centre[s], 24);
    surface_boundary(surface, 3, &boundary);
    assert_int_equal(lar_voxel_grid_fill(&boundary, 0.002, &voxel_grid, NULL), LAR_OK);
    double volume[4] = {0}, sum = 0;
    for (int k = 0; k < voxel_grid.cells[2]; k++)
        for (int j = 0; j < voxel_grid.cells[1]; j++)
            for (int i = 0; i < voxel_grid.cells[0]; i++) {
                double x[3];
                int region = region_at(&voxel_grid, i, j, k), expected = 0;
                volume[region] += pow(voxel_grid.size, 3);
                middle_of(&voxel_grid, i, j, k, x);
                bool near = false; /* to a sphere */
                for (int s = 0; s < 3; s++) {
                    double from[3];
                    lar_minus(x, centre[s], from);
                    near |= fabs(lar_length(from) - radius[s][0]) < voxel_grid.size;
                    if (lar_length(from) < radius[s][0]) expected = s + 1;
                }
                if (!near) assert_int_equal(region, expected);
            }
    for (int r = 1; r <= 3; r++) {
        assert_below(fabs(volume[r] / boundary.region[r].volume - 1), 0.03);
        sum += boundary.region[r].volume;
    }
    assert_below(fabs(share_volume(&voxel_grid) / sum - 1), 5e-3);
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
}

/* Some triangles of a closed surface lost: lines through the hole are left out, no streak stays. */
static void test_hole_in_surface(void **state) {
    (void)state;
    lar_triangles surface;
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    shape_ellipsoid_surface(&surface, shape_ellipsoid.half, (double[3]){0}, 24);
    surface_boundary(&surface, 1, &boundary);
    double volume = boundary.region[1].volume;
    for (int32_t t = 0; t < boundary.triangles.triangle_count; t++) {
        const double *x = boundary.triangles.vertex[boundary.triangles.corner[t][0]];
        double beside[2] = {x[1] - 0.004, x[2] - 0.003};
        if (x[0] > 0 && beside[0] * beside[0] + beside[1] * beside[1] < 9e-6)
            boundary.triangles.corner[t][0] = boundary.triangles.corner[t][1];
    }
    assert_int_equal(lar_voxel_grid_fill(&boundary, 0.0015, &voxel_grid, NULL), LAR_OK);
    assert_true(voxel_grid.repaired > 50); /* whole rows of cells among them */
    assert_below(fabs(inside_count(&voxel_grid) * pow(voxel_grid.size, 3) / volume - 1), 0.02);
    for (int k = 0; k < voxel_grid.cells[2]; k++)
        for (int j = 0; j < voxel_grid.cells[1]; j++)
            for (int i = 0; i < voxel_grid.cells[0]; i++) {
                double x[3], sum = 0;
                middle_of(&voxel_grid, i, j, k, x);
                for (int a = 0; a < 3; a++) sum += pow(x[a] / shape_ellipsoid.half[a], 2);
                if (sum > 1.3) assert_int_equal(region_at(&voxel_grid, i, j, k), 0);
                if (sum < 0.7) assert_int_equal(region_at(&voxel_grid, i, j, k), 1);
            }
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
}

/* The image's sides through the body lie between cells. */
static void check_cuts(const lar_boundary *boundary, const lar_voxel_grid *voxel_grid, int min) {
    int on_plane = 0;
    for (int s = 0; s < LAR_CUTS; s++) {
        const lar_cut *cut = &boundary->cut[s];
        if (!cut->name[0]) continue;
        double from[3];
        lar_minus(cut->through, voxel_grid->origin, from);
        double cells = fabs(lar_dot(from, cut->normal)) / voxel_grid->size;
        on_plane += fabs(cells - round(cells)) < 1e-6;
    }
    assert_true(on_plane >= min);
}

static void test_cuts(void **state) {
    (void)state;
    for (int frame = 0; frame < 3; frame++) {
        lar_image image;
        lar_boundary boundary;
        lar_voxel_grid voxel_grid = {0};
        /* Cut above and below, 30 mm apart, and at x = 16 mm on both sides. */
        shape_image_of(&image, shape_ellipsoid_label, (int32_t[3]){16, 30, 15},
                       (double[3]){2e-3, 2e-3, 2e-3}, (shape_frame)frame);
        assert_int_equal(lar_boundary_from_image(&image, NULL, &boundary, NULL), LAR_OK);
        assert_int_equal(lar_voxel_grid_fill_count(&boundary, 3000, &voxel_grid, NULL), LAR_OK);
        check_cuts(&boundary, &voxel_grid, 2); /* one of each pair */
        lar_voxel_grid_clear(&voxel_grid);
        /* 2.02 mm: 15 x 2 mm is near for both ends below and above, 8 x 2 mm x 2 too. */
        assert_int_equal(lar_voxel_grid_fill(&boundary, 2.015e-3, &voxel_grid, NULL), LAR_OK);
        check_cuts(&boundary, &voxel_grid, 4);
        assert_below(fabs(voxel_grid.size - 2e-3), 1e-12);
        lar_voxel_grid_clear(&voxel_grid);
        lar_boundary_clear(&boundary);
        lar_image_clear(&image);
    }
}

/* The voxels themselves, each where it is in the world. */
static void test_from_image(void **state) {
    (void)state;
    for (int frame = 0; frame < 3; frame++) {
        lar_image image;
        lar_boundary boundary;
        lar_voxel_grid voxel_grid = {0};
        boundary_of(&shape_holes, (shape_frame)frame, &image, &boundary);
        assert_int_equal(lar_voxel_grid_from_image(&image, &boundary, &voxel_grid, NULL), LAR_OK);
        assert_below(
            fabs(inside_count(&voxel_grid) * pow(voxel_grid.size, 3) / boundary.region[1].volume -
                 1),
            1e-9);
        int different = 0;
        for (int k = 0; k < voxel_grid.cells[2]; k++)
            for (int j = 0; j < voxel_grid.cells[1]; j++)
                for (int i = 0; i < voxel_grid.cells[0]; i++) {
                    double x[3];
                    middle_of(&voxel_grid, i, j, k, x);
                    different += shape_holes_label(x) != region_at(&voxel_grid, i, j, k);
                }
        assert_below(different, 3); /* voxels whose middle lies on a side, by rounding */
        double third[3];
        lar_cross(voxel_grid.axis[0], voxel_grid.axis[1], third);
        assert_below(fabs(lar_dot(third, voxel_grid.axis[2]) - 1), 1e-12);
        lar_voxel_grid_clear(&voxel_grid);
        image.to_world[0][0] *= 1.01, image.to_world[1][0] *= 1.01, image.to_world[2][0] *= 1.01;
        lar_error error = {0};
        assert_int_equal(lar_voxel_grid_from_image(&image, &boundary, &voxel_grid, &error),
                         LAR_ERROR_MODEL);
        assert_non_null(strstr(error.message, "no cubes"));
        assert_null(voxel_grid.region);
        lar_boundary_clear(&boundary);
        lar_image_clear(&image);
    }
}

/* Two boxes 0.3 cells apart, with the gap in the middle of a layer of cells: by majority the layer
 * were full. */
static void test_slot(void **state) {
    (void)state;
    lar_triangles surface[2];
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    shape_box_surface(&surface[0], (double[3]){0, 0, 0}, (double[3]){6.35, 8, 8});
    shape_box_surface(&surface[1], (double[3]){6.65, 0, 0}, (double[3]){12, 8, 8});
    surface_boundary(surface, 2, &boundary);
    assert_int_equal(lar_voxel_grid_fill(&boundary, 1, &voxel_grid, NULL), LAR_OK);
    assert_int_equal(voxel_grid.cells[0], 14);
    for (int k = 1; k <= 8; k++)
        for (int j = 1; j <= 8; j++)
            for (int i = 1; i <= 12; i++)
                assert_int_equal(region_at(&voxel_grid, i, j, k), i < 7 ? 1 : i == 7 ? 0 : 2);
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
}

/* Turned about z and then about x [degrees]. */
static void turn(lar_triangles *surface, const double by[2]) {
    const double a = by[0] * SHAPE_PI / 180, b = by[1] * SHAPE_PI / 180;
    for (int32_t v = 0; v < surface->vertex_count; v++) {
        double *x = surface->vertex[v];
        const double across = x[0] * sin(a) + x[1] * cos(a), up = x[2];
        x[0] = x[0] * cos(a) - x[1] * sin(a);
        x[1] = across * cos(b) - up * sin(b);
        x[2] = across * sin(b) + up * cos(b);
    }
}

/* Two plates with a gap of three quarters of a cell and more stay two, however the gap lies in the
 * grid. */
static void test_gap_aslant(void **state) {
    (void)state;
    static const double gap[] = {0.75, 0.9, 1.0, 1.3, 1.7};
    static const double tilt[][2] = {{0, 0}, {20, 30}, {35, 35}, {40, 20}, {30, 30}, {45, 35.26}};
    for (int c = 0; c < 5 * 6; c++) {
        const double g = gap[c % 5], thick = 3 + 0.03 * c;
        lar_triangles surface[2];
        lar_boundary boundary;
        lar_voxel_grid voxel_grid = {0};
        lar_cleaning cleaning;
        shape_box_surface(&surface[0], (double[3]){-thick, 0, 0}, (double[3]){0, 11, 8});
        shape_box_surface(&surface[1], (double[3]){g, 0, 0}, (double[3]){g + 3.4, 11, 8});
        for (int s = 0; s < 2; s++) turn(&surface[s], tilt[c / 5 % 6]);
        surface_boundary(surface, 2, &boundary);
        assert_int_equal(lar_voxel_grid_fill(&boundary, 1, &voxel_grid, NULL), LAR_OK);
        assert_int_equal(lar_voxel_grid_clean(&voxel_grid, &cleaning, NULL), LAR_OK);
        const solid_surface solid = solid_judge_voxel_grid(&voxel_grid, 0);
        if (solid.shells != 2 || solid.euler != 4)
            fail_msg("a gap of %g, turned by %g and %g: %d bodies, Euler characteristic %d", g,
                     tilt[c / 5 % 6][0], tilt[c / 5 % 6][1], solid.shells, solid.euler);
        lar_voxel_grid_clear(&voxel_grid);
        lar_boundary_clear(&boundary);
    }
}

/* A sheet of a third of a cell is a layer of cells, and no thicker. */
static void test_thin_part(void **state) {
    (void)state;
    lar_triangles surface;
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    shape_box_surface(&surface, (double[3]){0, 0, 0}, (double[3]){9, 7, 0.33});
    surface_boundary(&surface, 1, &boundary);
    assert_int_equal(lar_voxel_grid_fill(&boundary, 1, &voxel_grid, NULL), LAR_OK);
    int layer[64] = {0};
    assert_below(voxel_grid.cells[2], 64);
    for (int k = 0; k < voxel_grid.cells[2]; k++)
        for (int j = 0; j < voxel_grid.cells[1]; j++)
            for (int i = 0; i < voxel_grid.cells[0]; i++)
                layer[k] += region_at(&voxel_grid, i, j, k) != 0;
    assert_int_equal(layer[1], 63);
    assert_int_equal(inside_count(&voxel_grid), 63);
    lar_voxel_grid_clear(&voxel_grid);
    lar_boundary_clear(&boundary);
}

/* Nothing of an ellipsoid is thin, and neither are the edges of a box. */
static void test_nothing_thin(void **state) {
    (void)state;
    lar_triangles surface[2];
    shape_ellipsoid_surface(&surface[0], shape_ellipsoid.half, (double[3]){0}, 24);
    shape_box_surface(&surface[1], (double[3]){0, 0, 0}, (double[3]){0.03, 0.02, 0.01});
    for (int s = 0; s < 2; s++) {
        lar_boundary boundary;
        lar_thin thin = {0};
        surface_boundary(&surface[s], 1, &boundary);
        assert_int_equal(lar_thin_find(&boundary, 0.003, &thin, NULL), LAR_OK);
        assert_int_equal(thin.count, 0);
        lar_thin_clear(&thin);
        lar_boundary_clear(&boundary);
    }
}

static void test_refused(void **state) {
    (void)state;
    lar_triangles surface;
    lar_boundary boundary;
    lar_voxel_grid voxel_grid = {0};
    lar_error error = {0};
    shape_box_surface(&surface, (double[3]){0, 0, 0}, (double[3]){0.1, 0.1, 0.0003});
    surface_boundary(&surface, 1, &boundary);
    assert_int_equal(lar_voxel_grid_fill(&boundary, 0.003, &voxel_grid, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "thinner"));
    assert_int_equal(lar_voxel_grid_fill(&boundary, 1e-6, &voxel_grid, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "larger size"));
    static const double none[] = {0, -1, 1e300, INFINITY, NAN, 1e-300};
    for (int i = 0; i < 6; i++)
        assert_int_not_equal(lar_voxel_grid_fill(&boundary, none[i], &voxel_grid, &error), LAR_OK);
    assert_int_equal(lar_voxel_grid_fill_count(&boundary, 0, &voxel_grid, &error),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_voxel_grid_fill_count(&boundary, INT32_MAX, &voxel_grid, &error),
                     LAR_ERROR_ARGUMENT);
    assert_null(voxel_grid.region);
    lar_boundary_clear(&boundary);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes),          cmocka_unit_test(test_ring),
        cmocka_unit_test(test_exact_box),       cmocka_unit_test(test_counts),
        cmocka_unit_test(test_regions),         cmocka_unit_test(test_nested),
        cmocka_unit_test(test_hole_in_surface), cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_from_image),      cmocka_unit_test(test_slot),
        cmocka_unit_test(test_gap_aslant),      cmocka_unit_test(test_thin_part),
        cmocka_unit_test(test_nothing_thin),    cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
