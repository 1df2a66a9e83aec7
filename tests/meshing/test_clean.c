#include "solid_test.h"

/* ---- shapes, in a box of 24 cells -------------------------------------------------------- */

static double squared(const double x[3], double cx, double cy, double cz) {
    return (x[0] - cx) * (x[0] - cx) + (x[1] - cy) * (x[1] - cy) + (x[2] - cz) * (x[2] - cz);
}

static int ellipsoid(const double x[3]) {
    const double a = (x[0] - 12.3) / 10, b = (x[1] - 12.1) / 8, c = (x[2] - 11.9) / 5.5;
    return a * a + b * b + c * c < 1;
}

static int torus(const double x[3]) {
    const double ring = hypot(x[0] - 12.2, x[1] - 11.7) - 7.3;
    return ring * ring + (x[2] - 12.4) * (x[2] - 12.4) < 2.4 * 2.4;
}

static int holes(const double x[3]) {
    const bool box = fabs(x[0] - 12) < 9 && fabs(x[1] - 12) < 7 && fabs(x[2] - 12) < 6;
    return box && !(hypot(x[0] - 12, x[1] - 12) < 2.6);
}

static int hollow(const double x[3]) {
    const double d = squared(x, 12.2, 11.9, 12.1);
    return d < 10 * 10 && d > 4.3 * 4.3;
}

static int touching_balls(const double x[3]) {
    return squared(x, 7.0, 12.2, 12.1) < 5.2 * 5.2 || squared(x, 16.8, 12.1, 12.3) < 5.2 * 5.2;
}

static int two_balls(const double x[3]) {
    if (squared(x, 8.4, 12.2, 12.1) < 5.2 * 5.2 && x[0] < 12.5) return 1;
    return squared(x, 16.4, 12.1, 12.3) < 5.2 * 5.2 ? 2 : 0;
}

static int thin_sheet(const double x[3]) {
    return fabs(x[0] - 12) < 9 && fabs(x[1] - 12) < 9 && fabs(x[2] - 12.45) < 0.6;
}

static int curved_sheet(const double x[3]) {
    const double radius = sqrt(squared(x, 12, 12, -4));
    return fabs(x[0] - 12) < 8 && fabs(x[1] - 12) < 8 && x[2] > 0 && fabs(radius - 16) < 0.8;
}

static int bar(const double x[3]) {
    return fabs(x[0] - 12) < 9 && fabs(x[1] - 12.5) < 0.6 && fabs(x[2] - 12.45) < 0.6;
}

static solid_surface cleaned(solid_function *function, lar_voxel_grid *voxel_grid,
                             lar_cleaning *cleaning) {
    lar_error error;
    *voxel_grid = solid_voxel_grid(function, 24, 24, 24);
    if (lar_voxel_grid_clean(voxel_grid, cleaning, &error)) fail_msg("%s", error.message);
    const solid_surface surface = solid_judge_voxel_grid(voxel_grid, 0);
    assert_manifold(surface);
    return surface;
}

static void shapes_keep_their_topology(void **state) {
    (void)state;
    static const struct {
        const char *name;
        solid_function *function;
        int shells, euler;
        double max; /* flipped, part of the cells */
    } shape[] = {{"ellipsoid", ellipsoid, 1, 2, 0.02},       {"torus", torus, 1, 0, 0.03},
                 {"box with a hole", holes, 1, 0, 0.01},     {"hollow ball", hollow, 2, 4, 0.02},
                 {"two balls", two_balls, 1, 2, 0.03},       {"sheet", thin_sheet, 1, 2, 0},
                 {"curved sheet", curved_sheet, 1, 2, 0.15}, {"bar", bar, 1, 2, 0}};
    for (size_t s = 0; s < sizeof shape / sizeof *shape; s++) {
        lar_voxel_grid voxel_grid;
        lar_cleaning cleaning;
        const solid_surface surface = cleaned(shape[s].function, &voxel_grid, &cleaning);
        const double cells = (double)solid_cells(&voxel_grid);
        assert_int_equal(surface.shells, shape[s].shells);
        assert_int_equal(surface.euler, shape[s].euler);
        assert_below(cleaning.added + cleaning.removed, shape[s].max * cells);
        lar_voxel_grid_clear(&voxel_grid);
    }
}

static void touching_balls_become_one_solid(void **state) {
    (void)state;
    lar_voxel_grid voxel_grid;
    lar_cleaning cleaning;
    const solid_surface surface = cleaned(touching_balls, &voxel_grid, &cleaning);
    assert_int_equal(surface.euler, 2 * surface.shells);
    assert_in_range(surface.shells, 1, 2);
    lar_voxel_grid_clear(&voxel_grid);
}

/* A ball that a wavy surface divides: each region by itself is manifold too. */
static int two_regions(const double x[3]) {
    if (squared(x, 12, 12, 12) > 10.3 * 10.3) return 0;
    return x[2] < 12 + 3 * sin(0.9 * x[0]) * cos(1.1 * x[1]) ? 1 : 2;
}

static void regions_are_manifold(void **state) {
    (void)state;
    lar_voxel_grid voxel_grid = solid_voxel_grid(two_regions, 24, 24, 24);
    const solid_surface raw = solid_judge_voxel_grid(&voxel_grid, 2);
    assert_true(raw.bad_edges + raw.bad_nodes > 0);
    lar_voxel_grid_clear(&voxel_grid);
    lar_cleaning cleaning;
    cleaned(two_regions, &voxel_grid, &cleaning);
    for (int32_t region = 1; region <= 2; region++) {
        const solid_surface surface = solid_judge_voxel_grid(&voxel_grid, region);
        assert_manifold(surface);
        assert_int_equal(surface.shells, 1);
        assert_int_equal(surface.euler, 2);
    }
    lar_voxel_grid_clear(&voxel_grid);
}

/* A large ball, one of 3 % beside it, and a speck; with a thin stalk between the balls, or none. */
static bool has_stalk;

static int balls_on_a_stalk(const double x[3]) {
    if (has_stalk && hypot(x[1] - 12.5, x[2] - 12.5) < 0.35 && x[0] > 9 && x[0] < 20) return 1;
    return squared(x, 8, 12, 12) < 6.2 * 6.2 || squared(x, 20, 12.5, 12.5) < 2 * 2 ||
           squared(x, 20.5, 20.5, 20.5) < 0.8 * 0.8;
}

static void islands_are_joined_kept_or_left_out(void **state) {
    (void)state;
    for (int stalk = 0; stalk < 2; stalk++) {
        lar_voxel_grid voxel_grid;
        lar_cleaning cleaning;
        has_stalk = stalk;
        const solid_surface surface = cleaned(balls_on_a_stalk, &voxel_grid, &cleaning);
        assert_int_equal(surface.shells, stalk ? 1 : 2);
        assert_int_equal(surface.euler, stalk ? 2 : 4);
        assert_int_equal(cleaning.islands, 1);
        assert_int_equal(cleaning.island_cells, 1);
        assert_int_equal(voxel_grid.region[lar_voxel_grid_cell(&voxel_grid, 20, 20, 20)], 0);
        lar_voxel_grid_clear(&voxel_grid);
    }
}

/* A ball of region 1 in which are a speck of region 2, a small hollow and a large one. */
static int ball_with_specks(const double x[3]) {
    if (squared(x, 12, 12, 12) > 10 * 10) return 0;
    if (fabs(x[0] - 12.5) < 0.4 && fabs(x[1] - 12.5) < 0.4 && fabs(x[2] - 7.5) < 0.4) return 2;
    if (fabs(x[0] - 7) < 1.9 && fabs(x[1] - 12.5) < 0.4 && fabs(x[2] - 12.5) < 0.4) return 0;
    if (squared(x, 15.5, 12, 13.5) < 3 * 3) return 0;
    return squared(x, 12, 20, 12) < 3 * 3 ? 2 : 1;
}

static void pinholes_are_filled(void **state) {
    (void)state;
    lar_voxel_grid voxel_grid;
    lar_cleaning cleaning;
    const solid_surface surface = cleaned(ball_with_specks, &voxel_grid, &cleaning);
    assert_int_equal(surface.shells, 2);
    assert_int_equal(cleaning.pinholes, 1);
    assert_int_equal(cleaning.pinhole_cells, 4);
    assert_int_equal(cleaning.islands, 0);
    assert_int_equal(voxel_grid.region[lar_voxel_grid_cell(&voxel_grid, 7, 12, 12)], 1);
    assert_int_equal(voxel_grid.region[lar_voxel_grid_cell(&voxel_grid, 12, 12, 7)], 1);
    assert_int_equal(voxel_grid.region[lar_voxel_grid_cell(&voxel_grid, 15, 12, 13)], 0);
    assert_manifold(solid_judge_voxel_grid(&voxel_grid, 1));
    assert_manifold(solid_judge_voxel_grid(&voxel_grid, 2));
    lar_voxel_grid_clear(&voxel_grid);
}

static int nothing(const double x[3]) {
    (void)x;
    return 0;
}

/* Every cell at random: the worst there is. */
static void noise_ends_manifold(void **state) {
    (void)state;
    uint32_t random = 12345;
    for (int seed = 0; seed < 200; seed++) {
        lar_voxel_grid voxel_grid = solid_voxel_grid(nothing, 10, 9, 8);
        const uint32_t level = (uint32_t)(20 + seed % 8 * 30), regions = 1 + (uint32_t)seed % 3;
        for (int k = 1; k < 7; k++)
            for (int j = 1; j < 8; j++)
                for (int i = 1; i < 9; i++) {
                    const size_t c = lar_voxel_grid_cell(&voxel_grid, i, j, k);
                    random = random * 1664525u + 1013904223u;
                    voxel_grid.share[c] = (uint8_t)(random >> 24);
                    voxel_grid.inner[c] =
                        (uint8_t)(voxel_grid.share[c] ? 1 + (random >> 16 & 0xff) % regions : 0);
                    voxel_grid.region[c] = voxel_grid.share[c] > level ? voxel_grid.inner[c] : 0;
                }
        lar_cleaning cleaning;
        lar_error error;
        const lar_status status = lar_voxel_grid_clean(&voxel_grid, &cleaning, &error);
        for (int c = 0; c < 90; c++) assert_int_equal(voxel_grid.region[c], 0);
        if (status == LAR_OK)
            assert_manifold(solid_judge_voxel_grid(&voxel_grid, 0));
        else
            assert_int_equal(status, LAR_ERROR_MODEL);
        lar_voxel_grid_clear(&voxel_grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_keep_their_topology),
        cmocka_unit_test(touching_balls_become_one_solid),
        cmocka_unit_test(regions_are_manifold),
        cmocka_unit_test(islands_are_joined_kept_or_left_out),
        cmocka_unit_test(pinholes_are_filled),
        cmocka_unit_test(noise_ends_manifold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
