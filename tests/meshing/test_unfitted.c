#include "solid_test.h"

#include "shapes.h"

#include "base/vector.h"

/* A grid of which only the regions matter. */
static lar_voxel_grid voxel_grid_of(int ni, int nj, int nk, const uint8_t *inside) {
    lar_voxel_grid voxel_grid = {
        .cells = {ni + 2, nj + 2, nk + 2}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .size = 1};
    const size_t cells = (size_t)(ni + 2) * (size_t)(nj + 2) * (size_t)(nk + 2);
    for (int d = 0; d < 3; d++) voxel_grid.origin[d] = -1;
    voxel_grid.region = lar_calloc(cells, 1);
    voxel_grid.inner = lar_calloc(cells, 1);
    voxel_grid.share = lar_calloc(cells, 1);
    for (int k = 0; k < nk; k++)
        for (int j = 0; j < nj; j++)
            for (int i = 0; i < ni; i++)
                voxel_grid.region[lar_voxel_grid_cell(&voxel_grid, i + 1, j + 1, k + 1)] =
                    *inside++;
    return voxel_grid;
}

static bool meets(const lar_unfitted_mesh *unfitted, int32_t n, int a, int b) {
    for (int32_t m = unfitted->meet_start[n]; m < unfitted->meet_start[n + 1]; m++)
        if (unfitted->meet[m][0] == a && unfitted->meet[m][1] == b) return true;
    return false;
}

static int32_t node_at(const lar_mesh *mesh, double x, double y, double z) {
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (hypot(hypot(mesh->position[n][0] - x, mesh->position[n][1] - y),
                  mesh->position[n][2] - z) < 1e-9)
            return n;
    return -1;
}

static int32_t meeting(const lar_unfitted_mesh *unfitted, int32_t n) {
    return unfitted->meet_start[n + 1] - unfitted->meet_start[n];
}

static void cubes_of_two_regions(void **state) {
    (void)state;
    /* Two layers of 3 x 2 x 3 cells: region 1 left, 2 right. */
    uint8_t inside[18];
    for (int c = 0; c < 18; c++) inside[c] = c % 3 < 2 ? 1 : 2;
    lar_voxel_grid voxel_grid = voxel_grid_of(3, 2, 3, inside);
    lar_boundary boundary = {0};
    lar_unfitted_mesh unfitted;
    lar_error error;
    assert_int_equal(lar_unfitted_create(&voxel_grid, &boundary, &unfitted, &error), LAR_OK);
    const lar_mesh *mesh = &unfitted.mesh;
    assert_int_equal(mesh->node_count, 48);
    assert_int_equal(mesh->element_count, 18);
    assert_true(unfitted.size == 1);
    if (lar_mesh_check(mesh, &error)) fail_msg("%s", error.message);
    for (int32_t n = 0; n < 48; n++) {
        assert_int_equal(mesh->node_id[n], n + 1);
        assert_int_equal(n, node_at(mesh, n % 4, n / 4 % 3, n / 12));
    }
    for (int32_t e = 0; e < 18; e++) {
        assert_int_equal(mesh->element_id[e], e + 1);
        assert_int_equal(mesh->element_tag[e], inside[e]);
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        for (int d = 0; d < 3; d++)
            assert_true(corner[0][d] == (d == 0 ? e % 3 : d == 1 ? e / 3 % 2 : e / 6));
    }
    assert_int_equal(meeting(&unfitted, node_at(mesh, 1, 1, 1)), 0);
    const int32_t middle = node_at(mesh, 2, 1, 1), edge = node_at(mesh, 2, 0, 1);
    assert_int_equal(meeting(&unfitted, middle), 1);
    assert_true(meets(&unfitted, middle, 1, 2));
    assert_int_equal(meeting(&unfitted, edge), 3);
    assert_true(meets(&unfitted, edge, 0, 1) && meets(&unfitted, edge, 0, 2) &&
                meets(&unfitted, edge, 1, 2));
    assert_int_equal(meeting(&unfitted, node_at(mesh, 3, 2, 3)), 1);
    lar_unfitted_clear(&unfitted);
    lar_voxel_grid_clear(&voxel_grid);
}

/* Corners across of cells i k, a 1 for each that is inside, one deep along j. */
static int32_t slots_of(int ni, int nk, const uint8_t *inside) {
    lar_voxel_grid voxel_grid = voxel_grid_of(ni, 1, nk, inside);
    lar_boundary boundary = {0};
    lar_unfitted_mesh unfitted;
    lar_error error;
    assert_int_equal(lar_unfitted_create(&voxel_grid, &boundary, &unfitted, &error), LAR_OK);
    for (int32_t s = 0; s < unfitted.slot_count; s++) {
        double edge[3][3], across[3];
        for (int e = 0; e < 3; e++)
            lar_minus(unfitted.mesh.position[unfitted.slot[s][e]],
                      unfitted.mesh.position[unfitted.slot[s][3]], edge[e]);
        lar_cross(edge[0], edge[1], across);
        assert_true(fabs(lar_dot(across, edge[2]) - 1) < 1e-9); /* right-handed, of a cell */
    }
    const int32_t slots = unfitted.slot_count;
    lar_unfitted_clear(&unfitted);
    lar_voxel_grid_clear(&voxel_grid);
    return slots;
}

static void corners_across_slots(void **state) {
    (void)state;
    /* The rows are k = 0, 1, ... A slot that is open above: its upper corners, not those at its
     * end. */
    assert_int_equal(slots_of(3, 2, (const uint8_t[]){1, 1, 1, 1, 0, 1}), 4);
    assert_int_equal(slots_of(3, 3, (const uint8_t[]){1, 1, 1, 1, 0, 1, 1, 0, 1}), 12);
    /* A hole has ends all around, a step none. */
    assert_int_equal(slots_of(3, 3, (const uint8_t[]){1, 1, 1, 1, 0, 1, 1, 1, 1}), 0);
    assert_int_equal(slots_of(3, 2, (const uint8_t[]){1, 1, 1, 1, 0, 0}), 0);
    /* Nothing goes across what is two cells wide. */
    assert_int_equal(slots_of(4, 2, (const uint8_t[]){1, 1, 1, 1, 1, 0, 0, 1}), 0);
}

static int32_t set_count(const lar_mesh *mesh, const char *name, lar_set_kind kind) {
    const lar_set *set = lar_mesh_find_set(mesh, name, kind);
    return set ? set->count : -1;
}

static void sets_of_the_mesh(void **state) {
    (void)state;
    uint8_t inside[18];
    for (int c = 0; c < 18; c++) inside[c] = c % 3 < 2 ? 1 : 2;
    lar_voxel_grid voxel_grid = voxel_grid_of(3, 2, 3, inside);
    lar_region region[4] = {{0},
                            {.name = "Left lobe", .tag = 7},
                            {.name = "Left-lobe", .tag = 5},
                            {.name = "absent", .tag = 9}};
    lar_boundary boundary = {.region_count = 3, .region = region};
    lar_unfitted_mesh unfitted;
    lar_mesh mesh = {0};
    lar_error error;
    assert_int_equal(lar_unfitted_create(&voxel_grid, &boundary, &unfitted, &error), LAR_OK);
    assert_int_equal(lar_unfitted_finish(&unfitted, &boundary, NULL, &mesh, &error), LAR_OK);
    assert_int_equal(mesh.element_tag[0], 7);
    assert_int_equal(mesh.element_tag[2], 5);
    assert_int_equal(set_count(&mesh, "surface", LAR_SET_FACES), 42);
    assert_int_equal(set_count(&mesh, "Left_lobe", LAR_SET_ELEMENTS), 12);
    assert_int_equal(set_count(&mesh, "Left_lobe_2", LAR_SET_ELEMENTS), 6);
    assert_int_equal(set_count(&mesh, "Left_lobe_surface", LAR_SET_FACES), 26);
    assert_int_equal(set_count(&mesh, "Left_lobe_surface_2", LAR_SET_FACES), 16);
    assert_int_equal(set_count(&mesh, "absent", LAR_SET_ELEMENTS), -1);
    const lar_set *interface = lar_mesh_find_set(&mesh, "Left_lobe_Left_lobe", LAR_SET_FACES);
    assert_non_null(interface);
    assert_int_equal(interface->count, 6);
    for (int32_t f = 0; f < interface->count; f++) {
        assert_int_equal(mesh.element_tag[interface->index[f] / 6], 7);
        assert_int_equal(interface->index[f] % 6, 1);
    }
    assert_int_equal(unfitted.mesh.element_count, 0);
    lar_unfitted_clear(&unfitted);
    lar_mesh_clear(&mesh);
    lar_voxel_grid_clear(&voxel_grid);
}

/* A box whose top is a flat cut: the nodes and the faces there know it, those of its sides do not,
 * also where the grid does not lie along the cut. */
static void the_cut_has_its_number(void **state) {
    (void)state;
    for (int oblique = 0; oblique < 2; oblique++) {
        lar_boundary boundary = {.cut_count = 1};
        shape_box_surface(&boundary.triangles, (const double[]){0, 0, 0},
                          (const double[]){8, 8, 8});
        boundary.side = lar_calloc(12, sizeof *boundary.side);
        for (int t = 0; t < 12; t++) {
            boundary.side[t][0] = t >= 10 ? LAR_REGION_CUT + 5 : 0;
            boundary.side[t][1] = 1;
        }
        boundary.cut[5] = (lar_cut){{0, 0, 8}, {0, 0, 1}, "top"};
        boundary.region_count = 1;
        boundary.region = lar_calloc(2, sizeof *boundary.region);
        boundary.region[1] = (lar_region){.name = lar_strdup("box"), .tag = 1};
        for (int d = 0; d < 3; d++) boundary.axis[d][d] = 1;
        if (oblique) {
            const double c = cos(0.4), s = sin(0.4);
            const double axis[3][3] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
            memcpy(boundary.axis, axis, sizeof axis);
        }
        lar_voxel_grid voxel_grid = {0};
        lar_cleaning cleaning;
        lar_unfitted_mesh unfitted;
        lar_mesh mesh = {0};
        lar_error error;
        assert_int_equal(lar_voxel_grid_fill(&boundary, 1, &voxel_grid, &error), LAR_OK);
        assert_int_equal(lar_voxel_grid_clean(&voxel_grid, &cleaning, &error), LAR_OK);
        assert_int_equal(lar_unfitted_create(&voxel_grid, &boundary, &unfitted, &error), LAR_OK);
        for (int32_t n = 0; n < unfitted.mesh.node_count; n++) {
            const double height = unfitted.mesh.position[n][2] - 8;
            /* Staircases reach down to the cell below. */
            if (fabs(height) > 1.6) assert_false(meets(&unfitted, n, 1, LAR_REGION_CUT + 5));
            const double *x = unfitted.mesh.position[n];
            const bool away = fabs(x[0] - 4) < 2 && fabs(x[1] - 4) < 2;
            if (height > -0.4 && away) {
                assert_true(meets(&unfitted, n, 1, LAR_REGION_CUT + 5));
                assert_false(meets(&unfitted, n, 0, 1));
            }
        }
        assert_int_equal(lar_unfitted_finish(&unfitted, &boundary, NULL, &mesh, &error), LAR_OK);
        const int32_t faces = set_count(&mesh, "cut_top", LAR_SET_FACES);
        if (oblique)
            assert_in_range(faces, 30, 90);
        else
            assert_int_equal(faces, 64);
        lar_unfitted_clear(&unfitted);
        lar_mesh_clear(&mesh);
        lar_voxel_grid_clear(&voxel_grid);
        lar_boundary_clear(&boundary);
    }
}

static void an_empty_voxel_grid_is_refused(void **state) {
    (void)state;
    const uint8_t inside[8] = {0};
    lar_voxel_grid voxel_grid = voxel_grid_of(2, 2, 2, inside);
    lar_boundary boundary = {0};
    lar_unfitted_mesh unfitted;
    lar_error error;
    assert_int_equal(lar_unfitted_create(&voxel_grid, &boundary, &unfitted, &error),
                     LAR_ERROR_MODEL);
    lar_unfitted_clear(&unfitted);
    lar_voxel_grid_clear(&voxel_grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_of_two_regions),
        cmocka_unit_test(corners_across_slots),
        cmocka_unit_test(sets_of_the_mesh),
        cmocka_unit_test(the_cut_has_its_number),
        cmocka_unit_test(an_empty_voxel_grid_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
