#include "mesh_test.h"

#include <math.h>

#include "model/mesh/builder.h"

/* Two cubes side by side along x, nodes in an order of their own: node id = 100 * x + 10 * y + z
 * plus `base`. */
static lar_mesh_builder *two_cubes(int64_t base) {
    lar_mesh_builder *builder = lar_mesh_builder_create("two.msh");
    assert_non_null(builder);
    lar_error error;
    for (int x = 2; x >= 0; x--)
        for (int y = 0; y < 2; y++)
            for (int z = 0; z < 2; z++) {
                double position[3] = {x, y, z};
                assert_int_equal(lar_mesh_builder_node(builder, base + 100 * x + 10 * y + z,
                                                       position, 10, &error),
                                 LAR_OK);
            }
    for (int e = 0; e < 2; e++) {
        static const int corner[8] = {0, 100, 110, 10, 1, 101, 111, 11};
        int64_t ids[8];
        for (int a = 0; a < 8; a++) ids[a] = base + 100 * e + corner[a];
        assert_int_equal(lar_mesh_builder_hexahedron(builder, 7 + e, 3, ids, 20 + e, &error),
                         LAR_OK);
    }
    return builder;
}

static void finish_good(lar_mesh_builder *builder, lar_mesh *mesh) {
    lar_error error = {0};
    *mesh = (lar_mesh){0};
    if (lar_mesh_builder_finish(builder, mesh, &error)) fail_msg("refused: %s", error.message);
    lar_mesh_builder_destroy(builder);
}

static void finish_bad(lar_mesh_builder *builder, const char *part) {
    lar_error error = {0};
    lar_mesh mesh = {0};
    assert_int_equal(lar_mesh_builder_finish(builder, &mesh, &error), LAR_ERROR_FORMAT);
    assert_says(&error, part);
    assert_null(mesh.position);
    lar_mesh_builder_destroy(builder);
}

static void resolves_ids(void **state) {
    (void)state;
    /* Dense ids take the table, a far one more the sorted list. */
    for (int sparse = 0; sparse < 2; sparse++) {
        lar_mesh_builder *builder = two_cubes(1);
        double position[3] = {9, 9, 9};
        if (sparse)
            assert_int_equal(lar_mesh_builder_node(builder, INT64_MAX, position, 30, NULL), LAR_OK);
        lar_mesh mesh;
        finish_good(builder, &mesh);
        assert_int_equal(mesh.node_count, 12);
        assert_int_equal(mesh.element_count, 2);
        assert_int_equal(mesh.dropped_node_count, sparse);
        assert_int_equal(mesh.element_id[1], 8);
        assert_int_equal(mesh.element_tag[1], 3);
        assert_int_equal(mesh.node_id[0], 201);
        assert_true(mesh_volume(&mesh) == 2);
        assert_int_equal(lar_mesh_check(&mesh, NULL), LAR_OK);
        lar_mesh_clear(&mesh);
    }
}

static void sets(void **state) {
    (void)state;
    lar_mesh_builder *builder = two_cubes(0);
    double position[3] = {5, 5, 5};
    /* The set comes first, the node that no element uses later. */
    assert_int_equal(lar_mesh_builder_set(builder, "end", LAR_SET_NODES, NULL), LAR_OK);
    static const int64_t ids[] = {211, 77, 200, 211};
    for (int i = 0; i < 4; i++)
        assert_int_equal(lar_mesh_builder_set_id(builder, ids[i], 40, NULL), LAR_OK);
    assert_int_equal(lar_mesh_builder_node(builder, 77, position, 30, NULL), LAR_OK);
    assert_int_equal(lar_mesh_builder_set(builder, "end", LAR_SET_FACES, NULL), LAR_OK);
    assert_int_equal(lar_mesh_builder_set_face(builder, 8, 1, 41, NULL), LAR_OK);
    assert_int_equal(lar_mesh_builder_set(builder, "sides", LAR_SET_FACES, NULL), LAR_OK);
    assert_int_equal(lar_mesh_builder_set_quad(builder, (int64_t[]){110, 11, 111, 10}, 42, NULL),
                     LAR_OK);
    /* The face between both cubes belongs to the first. */
    assert_int_equal(lar_mesh_builder_set_quad(builder, (int64_t[]){100, 101, 111, 110}, 43, NULL),
                     LAR_OK);
    assert_int_equal(lar_mesh_builder_set(builder, "end", LAR_SET_NODES, NULL), LAR_OK);
    assert_int_equal(lar_mesh_builder_set_id(builder, 201, 44, NULL), LAR_OK);

    lar_mesh mesh;
    finish_good(builder, &mesh);
    assert_int_equal(mesh.set_count, 3);
    ASSERT_SET(&mesh, "end", LAR_SET_NODES, 0, 1, 3);
    ASSERT_SET(&mesh, "end", LAR_SET_FACES, 6 + 1);
    ASSERT_SET(&mesh, "sides", LAR_SET_FACES, 3, 1);
    lar_mesh_clear(&mesh);
}

static void refuses(void **state) {
    (void)state;
    double position[3] = {0, 0, 0};
    static const int64_t ids[8] = {0, 100, 110, 10, 1, 101, 111, 11};

    lar_mesh_builder *builder = two_cubes(0);
    lar_mesh_builder_node(builder, 110, position, 99, NULL);
    finish_bad(builder, "two.msh:99: node 110 is given twice (first in line 10)");

    builder = two_cubes(0);
    lar_mesh_builder_hexahedron(builder, 7, 0, ids, 0, NULL);
    finish_bad(builder, "two.msh: element 7 is given twice (first in line 20)");

    /* The same among ids that are far apart. */
    builder = two_cubes(0);
    lar_mesh_builder_node(builder, INT64_MIN, position, 98, NULL);
    lar_mesh_builder_node(builder, INT64_MIN, position, 99, NULL);
    finish_bad(builder, "two.msh:99: node -9223372036854775808 is given twice (first in line 98)");

    builder = two_cubes(0);
    lar_mesh_builder_hexahedron(builder, 9, 0, (int64_t[8]){0, 1, 2, 3, 4, 5, 6, 7}, 50, NULL);
    finish_bad(builder, "two.msh:50: element 9 names node 2, which the file does not define");

    builder = two_cubes(0);
    lar_mesh_builder_set(builder, "s", LAR_SET_ELEMENTS, NULL);
    lar_mesh_builder_set_id(builder, 99, 60, NULL);
    finish_bad(builder, "two.msh:60: set 's' names element 99");

    builder = two_cubes(0);
    lar_mesh_builder_set(builder, "s", LAR_SET_FACES, NULL);
    lar_mesh_builder_set_quad(builder, (int64_t[]){0, 100, 110, 1}, 61, NULL);
    finish_bad(builder, "two.msh:61: the quadrilateral 0 100 110 1 of set 's' is not a face");

    builder = two_cubes(0);
    lar_error error = {0};
    assert_int_equal(lar_mesh_builder_node(builder, 5, (double[3]){0, NAN, 0}, 62, &error),
                     LAR_ERROR_FORMAT);
    assert_says(&error, "two.msh:62: node 5 has the y coordinate nan");
    assert_int_equal(lar_mesh_builder_set_id(builder, 1, 63, &error), LAR_ERROR_ARGUMENT);
    lar_mesh_builder_set(builder, "s", LAR_SET_FACES, NULL);
    assert_int_equal(lar_mesh_builder_set_face(builder, 7, 6, 64, &error), LAR_ERROR_FORMAT);
    assert_says(&error, "two.msh:64: face 7 of element 7 does not exist");
    lar_mesh_builder_destroy(builder);
    lar_mesh_builder_destroy(NULL);
}

static void nothing_added(void **state) {
    (void)state;
    lar_mesh mesh;
    finish_good(lar_mesh_builder_create("none.msh"), &mesh);
    lar_error error;
    assert_int_equal(lar_mesh_check(&mesh, &error), LAR_ERROR_MODEL);
    assert_says(&error, "none.msh: holds no eight-node hexahedra");
    lar_mesh_clear(&mesh);
}

/* ---- reference meshes --------------------------------------------------------------------- */

static void reads_reference(const char *name, int32_t nodes, int32_t elements) {
    char path[1000];
    snprintf(path, sizeof path, "%s/reference/meshes/%s.txt", LAR_TEST_SHARED, name);
    need_shared(path);
    FILE *file = fopen(path, "r");
    lar_mesh_builder *builder = lar_mesh_builder_create(path);
    char line[256];
    for (int number = 1; fgets(line, sizeof line, file); number++) {
        double x[3];
        long long id, n[8];
        if (sscanf(line, "n %lld %lf %lf %lf", &id, &x[0], &x[1], &x[2]) == 4)
            lar_mesh_builder_node(builder, id, x, number, NULL);
        if (sscanf(line, "e %lld %lld %lld %lld %lld %lld %lld %lld %lld", &id, &n[0], &n[1], &n[2],
                   &n[3], &n[4], &n[5], &n[6], &n[7]) == 9) {
            int64_t ids[8];
            for (int a = 0; a < 8; a++) ids[a] = n[a];
            lar_mesh_builder_hexahedron(builder, id, 0, ids, number, NULL);
        }
    }
    fclose(file);
    lar_mesh mesh;
    finish_good(builder, &mesh);
    assert_int_equal(mesh.node_count, nodes);
    assert_int_equal(mesh.element_count, elements);
    assert_int_equal(lar_mesh_check(&mesh, NULL), LAR_OK);
    lar_mesh_clear(&mesh);
}

static void reference_meshes(void **state) {
    (void)state;
    reads_reference("a_2x2x2", 27, 8);
    reads_reference("b_cook_16x16x1", 17 * 17 * 2, 256);
    reads_reference("c_beam_40x4x4", 41 * 25, 640);
    reads_reference("e1_cube_4x4x4", 125, 64);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(resolves_ids),     cmocka_unit_test(sets),
        cmocka_unit_test(refuses),          cmocka_unit_test(nothing_added),
        cmocka_unit_test(reference_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
