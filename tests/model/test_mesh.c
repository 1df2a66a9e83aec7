#include "mesh_test.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

static const double cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

/* A cube, or two side by side along x, with ids 11, 12, ... and elements 5, 6. */
static lar_mesh boxes(int count) {
    lar_mesh mesh = {
        .source = lar_strdup("box.vtu"), .node_count = 4 * (count + 1), .element_count = count};
    mesh.position = lar_calloc((size_t)mesh.node_count, sizeof *mesh.position);
    mesh.node_id = lar_calloc((size_t)mesh.node_count, sizeof *mesh.node_id);
    mesh.element = lar_calloc((size_t)count, sizeof *mesh.element);
    mesh.element_id = lar_calloc((size_t)count, sizeof *mesh.element_id);
    mesh.element_tag = lar_calloc((size_t)count, sizeof *mesh.element_tag);
    static const int corner[4] = {0, 3, 7, 4}; /* the layer x = 0 */
    for (int n = 0; n < mesh.node_count; n++) {
        memcpy(mesh.position[n], cube[corner[n % 4]], sizeof mesh.position[n]);
        mesh.position[n][0] = n / 4;
        mesh.node_id[n] = 11 + n;
    }
    for (int e = 0; e < count; e++) {
        static const int local[4] = {0, 1, 2, 3};
        for (int i = 0; i < 4; i++) {
            static const int near[4] = {0, 3, 7, 4}, far[4] = {1, 2, 6, 5};
            mesh.element[e][near[i]] = 4 * e + local[i];
            mesh.element[e][far[i]] = 4 * e + 4 + local[i];
        }
        mesh.element_id[e] = 5 + e;
    }
    return mesh;
}

static void faces_look_outward(void **state) {
    (void)state;
    for (int f = 0; f < 6; f++) {
        double normal[3], u[3], v[3];
        for (int i = 0; i < 3; i++) {
            u[i] = cube[lar_face_node[f][1]][i] - cube[lar_face_node[f][0]][i];
            v[i] = cube[lar_face_node[f][3]][i] - cube[lar_face_node[f][0]][i];
        }
        normal[0] = u[1] * v[2] - u[2] * v[1];
        normal[1] = u[2] * v[0] - u[0] * v[2];
        normal[2] = u[0] * v[1] - u[1] * v[0];
        for (int i = 0; i < 3; i++) {
            double expected = i != f / 2 ? 0 : f % 2 ? 1 : -1;
            assert_true(normal[i] == expected);
        }
        for (int a = 0; a < 4; a++)
            assert_int_equal(lar_node_sign[lar_face_node[f][a]][f / 2], f % 2 ? 1 : -1);
    }
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) assert_true(lar_node_sign[a][i] == 2 * cube[a][i] - 1);
}

/* Volume by two Gauss points per axis, which integrate the trilinear Jacobian exactly. */
static double gauss_volume(const double corner[8][3]) {
    double volume = 0, g = 1 / sqrt(3.0);
    for (int q = 0; q < 8; q++) {
        double xi[3] = {lar_node_sign[q][0] * g, lar_node_sign[q][1] * g, lar_node_sign[q][2] * g};
        double j[3][3] = {{0}};
        for (int a = 0; a < 8; a++)
            for (int k = 0; k < 3; k++) {
                double gradient = lar_node_sign[a][k] / 8.0;
                for (int m = 0; m < 3; m++)
                    if (m != k) gradient *= 1 + lar_node_sign[a][m] * xi[m];
                for (int i = 0; i < 3; i++) j[k][i] += gradient * corner[a][i];
            }
        volume += j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
                  j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
                  j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
    }
    return volume;
}

static void volume_is_exact(void **state) {
    (void)state;
    assert_true(lar_hexahedron_volume(cube) == 1);
    uint32_t random = 1;
    for (int trial = 0; trial < 100; trial++) {
        double corner[8][3];
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                random = random * 1664525u + 1013904223u;
                corner[a][i] = 3 + cube[a][i] + 0.8 * (random / 4294967296.0 - 0.5);
            }
        const double(*x)[3] = (const double(*)[3])corner;
        assert_true(fabs(lar_hexahedron_volume(x) - gauss_volume(x)) < 1e-13);
    }
}

static void scaled_jacobian(void **state) {
    (void)state;
    assert_true(lar_scaled_jacobian(cube) == 1);
    double corner[8][3];
    memcpy(corner, cube, sizeof corner);
    /* A sheared box: the determinant of unit edges is the cosine of 45 degrees. */
    for (int a = 0; a < 8; a++) corner[a][0] += corner[a][2];
    assert_true(fabs(lar_scaled_jacobian((const double(*)[3])corner) - sqrt(0.5)) < 1e-15);
    memcpy(corner, cube, sizeof corner);
    for (int a = 0; a < 8; a++) corner[a][0] = -corner[a][0];
    assert_true(lar_scaled_jacobian((const double(*)[3])corner) == -1);
    memcpy(corner[0], corner[1], sizeof corner[0]);
    assert_true(lar_scaled_jacobian((const double(*)[3])corner) <= 0);
}

static void boundary(void **state) {
    (void)state;
    lar_mesh mesh = boxes(2);
    lar_error error;
    int32_t *faces = NULL, count = 0;
    assert_int_equal(lar_mesh_check(&mesh, &error), LAR_OK);
    assert_int_equal(lar_mesh_boundary(&mesh, &faces, &count, &error), LAR_OK);
    static const int32_t expected[10] = {0, 2, 3, 4, 5, 7, 8, 9, 10, 11};
    assert_int_equal(count, 10);
    assert_memory_equal(faces, expected, sizeof expected);
    free(faces);
    lar_mesh_clear(&mesh);
    lar_mesh_clear(&mesh);
}

static int32_t *list(int count, const int32_t *index) {
    int32_t *copy = lar_calloc((size_t)count, sizeof *copy);
    memcpy(copy, index, (size_t)count * sizeof *copy);
    return copy;
}

static void sets(void **state) {
    (void)state;
    lar_mesh mesh = boxes(2);
    lar_error error;
    int32_t *index = list(5, (int32_t[]){7, 3, 7, 0, 3});
    assert_int_equal(lar_mesh_add_set(&mesh, "a", LAR_SET_NODES, index, 5, &error), LAR_OK);
    ASSERT_SET(&mesh, "a", LAR_SET_NODES, 0, 3, 7);
    index = list(5, (int32_t[]){9, 2, 9, 4, 2});
    assert_int_equal(lar_mesh_add_set(&mesh, "a", LAR_SET_FACES, index, 5, &error), LAR_OK);
    ASSERT_SET(&mesh, "a", LAR_SET_FACES, 9, 2, 4);
    assert_null(lar_mesh_find_set(&mesh, "a", LAR_SET_ELEMENTS));

    index = list(1, (int32_t[]){1});
    assert_int_equal(lar_mesh_add_set(&mesh, "a", LAR_SET_NODES, index, 1, &error),
                     LAR_ERROR_FORMAT);
    assert_says(&error, "box.vtu: there are two node sets named 'a'");

    index = list(1, (int32_t[]){12});
    assert_int_equal(lar_mesh_add_set(&mesh, "far", LAR_SET_FACES, index, 1, &error), LAR_OK);
    assert_int_equal(lar_mesh_check(&mesh, &error), LAR_ERROR_FORMAT);
    assert_says(&error, "box.vtu: set 'far' holds the number 12, but only 0 to 11 exist");
    lar_mesh_clear(&mesh);
}

static void set_limit(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    lar_error error;
    for (int s = 0; s <= LAR_MESH_SETS_MAX; s++) {
        char name[16];
        snprintf(name, sizeof name, "%d", s);
        lar_status status = lar_mesh_add_set(&mesh, name, LAR_SET_NODES, NULL, 0, &error);
        assert_int_equal(status, s < LAR_MESH_SETS_MAX ? LAR_OK : LAR_ERROR_UNSUPPORTED);
    }
    assert_says(&error, "more than 4096 named sets");
    lar_mesh_clear(&mesh);
}

static void assert_check_fails(lar_mesh *mesh, lar_status status, const char *part) {
    lar_error error = {0};
    assert_int_equal(lar_mesh_check(mesh, &error), status);
    assert_says(&error, part);
    lar_mesh_clear(mesh);
}

static void swap(double (*a)[3], double (*b)[3]) {
    double kept[3];
    memcpy(kept, *a, sizeof kept);
    memcpy(*a, *b, sizeof kept);
    memcpy(*b, kept, sizeof kept);
}

static void check_refuses(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "holds no eight-node hexahedra");

    mesh = boxes(2);
    mesh.position[3][1] = NAN;
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "box.vtu: node 14 has the y coordinate nan");
    mesh = boxes(2);
    mesh.position[3][2] = 1e300;
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "box.vtu: node 14 has the z coordinate 1e+300");

    mesh = boxes(2);
    mesh.element[1][2] = 12;
    assert_check_fails(&mesh, LAR_ERROR_FORMAT, "box.vtu: element 6 refers to node number 12");
    mesh = boxes(2);
    mesh.element[1][2] = -1;
    assert_check_fails(&mesh, LAR_ERROR_FORMAT, "box.vtu: element 6 refers to node number -1");

    mesh = boxes(2);
    mesh.element[1][1] = mesh.element[1][0];
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "box.vtu: element 6 has node 15 twice");

    /* The same element once more, turned a quarter around the vertical axis. */
    mesh = boxes(2);
    for (int a = 0; a < 8; a++) mesh.element[1][a] = mesh.element[0][a % 4 == 3 ? a - 3 : a + 1];
    assert_check_fails(&mesh, LAR_ERROR_MODEL,
                       "box.vtu: elements 5 and 6 have the same eight nodes");

    mesh = boxes(2);
    for (int n = 8; n < 12; n++) mesh.position[n][0] = 1;
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "box.vtu: element 6 has no volume");

    mesh = boxes(2);
    swap(&mesh.position[8], &mesh.position[9]);
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "box.vtu: element 6 is inverted or too distorted");

    mesh = boxes(2);
    for (int n = 8; n < 12; n++) mesh.position[n][0] = 0.5;
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "box.vtu: element 6 is inside out");

    /* A positive volume does not save a corner that is pushed in too far. */
    mesh = boxes(1);
    for (int i = 0; i < 3; i++) mesh.position[0][i] = 0.7;
    assert_check_fails(&mesh, LAR_ERROR_MODEL, "element 5 is inverted or too distorted");

    mesh = boxes(2);
    mesh.collapsed_count = 1;
    mesh.collapsed_name = "four-node tetrahedron";
    mesh.collapsed_id = 6;
    assert_check_fails(&mesh, LAR_ERROR_UNSUPPORTED,
                       "box.vtu: element 6 is a four-node tetrahedron, but");
}

/* A mirrored mesh has its own corners and faces in the end; one that is mirrored in part stays. */
static void turns(void **state) {
    (void)state;
    lar_mesh mesh = boxes(2);
    lar_error error;
    int32_t *face = lar_calloc(4, sizeof *face);
    for (int i = 0; i < 4; i++) face[i] = (const int32_t[4]){4, 5, 0, 11}[i];
    assert_int_equal(lar_mesh_add_set(&mesh, "some", LAR_SET_FACES, face, 4, &error), LAR_OK);
    lar_mesh_turn(&mesh);
    assert_false(mesh.turned);
    for (int n = 0; n < 12; n++) mesh.position[n][1] *= -1;
    assert_int_equal(lar_mesh_check(&mesh, &error), LAR_ERROR_MODEL);
    int32_t corner[4], low = mesh.element[0][0];
    for (int c = 0; c < 4; c++) corner[c] = mesh.element[0][lar_face_node[4][c]];
    lar_mesh_turn(&mesh);
    assert_true(mesh.turned);
    assert_int_equal(mesh.element[0][4], low);
    assert_int_equal(lar_mesh_check(&mesh, &error), LAR_OK);
    const lar_set *set = lar_mesh_find_set(&mesh, "some", LAR_SET_FACES);
    for (int i = 0; i < 4; i++)
        assert_int_equal(set->index[i], ((const int32_t[4]){5, 4, 0, 10}[i]));
    for (int c = 0; c < 4; c++) {
        bool there = false;
        for (int k = 0; k < 4; k++)
            there = there || mesh.element[0][lar_face_node[5][k]] == corner[c];
        assert_true(there);
    }
    lar_mesh_clear(&mesh);
}

static void doubled_nodes(void **state) {
    (void)state;
    lar_mesh mesh = boxes(2);
    lar_error error;
    int32_t doubled = -1, *leader = NULL;
    assert_int_equal(lar_mesh_doubled_nodes(&mesh, &doubled, NULL, &error), LAR_OK);
    assert_int_equal(doubled, 0);
    memcpy(mesh.position[9], mesh.position[2], sizeof mesh.position[9]);
    mesh.position[9][0] += 1e-8;
    assert_int_equal(lar_mesh_doubled_nodes(&mesh, &doubled, &leader, &error), LAR_OK);
    assert_int_equal(doubled, 1);
    for (int n = 0; n < 12; n++) assert_int_equal(leader[n], n == 9 ? 2 : n);
    free(leader);
    lar_mesh_clear(&mesh);
    mesh = boxes(2); /* the ends of an element's edge are connected, however short it is */
    for (int n = 0; n < 12; n++) mesh.position[n][2] *= 1e-9;
    assert_int_equal(lar_mesh_doubled_nodes(&mesh, &doubled, NULL, &error), LAR_OK);
    assert_int_equal(doubled, 0);
    lar_mesh_clear(&mesh);
}

/* A thin layer and a very small or large mesh are good meshes. */
static void check_accepts(void **state) {
    (void)state;
    static const double scales[3][3] = {{1, 1, 1e-6}, {1e-9, 1e-9, 1e-9}, {1e9, 1e9, 1e9}};
    for (int s = 0; s < 3; s++) {
        lar_mesh mesh = boxes(2);
        lar_error error = {0};
        for (int n = 0; n < 12; n++)
            for (int i = 0; i < 3; i++) mesh.position[n][i] *= scales[s][i];
        assert_int_equal(lar_mesh_check(&mesh, &error), LAR_OK);
        lar_mesh_clear(&mesh);
    }
}

/* ---- lar_mesh_read ------------------------------------------------------------------------ */

static const char *const inp_cube = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n"
                                    "5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
                                    "*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n";

static void write_file(char *path, size_t size, const char *name, const void *data, size_t length) {
    snprintf(path, size, "%s/test_mesh.%ld.%s", LAR_TEST_BUILD, (long)getpid(), name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, length, file), length);
    fclose(file);
}

static void assert_read_fails(const char *name, const void *data, size_t size, double scale,
                              const char *part) {
    char path[1000];
    lar_mesh mesh = {0};
    lar_error error = {0};
    write_file(path, sizeof path, name, data, size);
    assert_int_not_equal(lar_mesh_read(path, scale, &mesh, &error), LAR_OK);
    unlink(path);
    assert_says(&error, part);
    assert_says(&error, name);
    assert_null(mesh.position);
}

static void read_scales(void **state) {
    (void)state;
    char path[1000];
    lar_mesh mesh = {0};
    lar_error error = {0};
    write_file(path, sizeof path, "cube.INP", inp_cube, strlen(inp_cube));
    assert_int_equal(lar_mesh_read(path, 0.001, &mesh, &error), LAR_OK);
    assert_true(fabs(mesh_volume(&mesh) - 1e-9) < 1e-21);
    assert_string_equal(mesh.source, path);
    lar_mesh_clear(&mesh);
    unlink(path);
}

static void read_refuses(void **state) {
    (void)state;
    static const char png[] = "\x89PNG\r\n\x1a\n and so on";
    size_t length = strlen(inp_cube);
    assert_read_fails("a.vtu", png, sizeof png, 1, "it looks like a PNG picture");
    assert_read_fails("a.vtk", inp_cube, length, 1, "it looks like an Abaqus input file");
    assert_read_fails("a.msh", "hello", 5, 1, "is not a Gmsh mesh");
    assert_read_fails("a.stl", inp_cube, length, 1, "the known ones are .vtu .vtk .msh .inp .feb");
    assert_read_fails("none", inp_cube, length, 1, "the known ones are");
    assert_read_fails("empty.inp", "", 0, 1, "empty");
    assert_read_fails("blank.inp", " \n", 2, 1, "is not an Abaqus input file");
    assert_read_fails("a.inp", inp_cube, length, 0, "the scale 0 is not a positive number");
    assert_read_fails("a.inp", inp_cube, length, NAN, "is not a positive number");
    lar_mesh mesh = {0};
    lar_error error = {0};
    assert_int_equal(lar_mesh_read("nowhere/at/all.msh", 1, &mesh, &error), LAR_ERROR_IO);
    assert_says(&error, "nowhere/at/all.msh");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faces_look_outward),
        cmocka_unit_test(volume_is_exact),
        cmocka_unit_test(scaled_jacobian),
        cmocka_unit_test(boundary),
        cmocka_unit_test(sets),
        cmocka_unit_test(set_limit),
        cmocka_unit_test(turns),
        cmocka_unit_test(doubled_nodes),
        cmocka_unit_test(check_refuses),
        cmocka_unit_test(check_accepts),
        cmocka_unit_test(read_scales),
        cmocka_unit_test(read_refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
