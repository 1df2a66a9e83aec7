#include "solid_test.h"

#include "meshing/deviation.h"
#include "shapes.h"

/* n x n x n cells of a cube around the origin, its surface drawn onto the unit sphere. */
static lar_mesh ball(int n) {
    const int points = n + 1;
    lar_mesh mesh = {.node_count = points * points * points, .element_count = n * n * n};
    mesh.position = lar_calloc((size_t)mesh.node_count, sizeof *mesh.position);
    mesh.element = lar_calloc((size_t)mesh.element_count, sizeof *mesh.element);
    for (int p = 0; p < mesh.node_count; p++) {
        const int at[3] = {p % points, p / points % points, p / points / points};
        double largest = 0, length = 0, x[3];
        for (int d = 0; d < 3; d++) {
            /* Equal angles, not equal lengths, make the faces on the sphere about equal. */
            x[d] = tan(SHAPE_PI / 4 * (2.0 * at[d] / n - 1));
            largest = fmax(largest, fabs(x[d]));
            length += x[d] * x[d];
        }
        for (int d = 0; d < 3; d++)
            mesh.position[p][d] = length > 0 ? x[d] * largest / sqrt(length) : 0;
    }
    for (int e = 0; e < mesh.element_count; e++)
        for (int a = 0; a < 8; a++) {
            const int i = e % n + (lar_node_sign[a][0] > 0);
            const int j = e / n % n + (lar_node_sign[a][1] > 0);
            const int k = e / n / n + (lar_node_sign[a][2] > 0);
            mesh.element[e][a] = (k * points + j) * points + i;
        }
    return mesh;
}

static lar_deviation deviation_of(const lar_mesh *mesh, const lar_triangles *surface) {
    lar_error error;
    lar_deviation deviation;
    int32_t *face, count;
    assert_int_equal(lar_mesh_boundary(mesh, &face, &count, &error), LAR_OK);
    if (lar_deviation_measure(mesh, face, count, surface, &deviation, &error))
        fail_msg("%s", error.message);
    free(face);
    return deviation;
}

static void a_ball_of_faces_in_a_sphere(void **state) {
    (void)state;
    lar_triangles sphere;
    shape_ellipsoid_surface(&sphere, (const double[]){1, 1, 1}, (const double[]){0, 0, 0}, 150);
    for (int n = 4; n <= 8; n += 4) {
        lar_mesh mesh = ball(n);
        /* How far the bilinear faces lie inside the sphere, by a walk over them. */
        int32_t *face, count;
        lar_error error;
        double mean = 0, area = 0, max = 0;
        assert_int_equal(lar_mesh_boundary(&mesh, &face, &count, &error), LAR_OK);
        for (int32_t f = 0; f < count; f++)
            for (int s = 0; s < 400; s++) {
                const double u = (s % 20 + 0.5) / 20, v = (s / 20 + 0.5) / 20;
                const double weight[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
                double x[3] = {0}, du[3] = {0}, dv[3] = {0};
                for (int a = 0; a < 4; a++)
                    for (int d = 0; d < 3; d++) {
                        const double y =
                            mesh.position[mesh.element[face[f] / 6][lar_face_node[face[f] % 6][a]]]
                                         [d];
                        x[d] += weight[a] * y;
                        du[d] += (a == 1 || a == 2 ? 1 : -1) * (a < 2 ? 1 - v : v) * y;
                        dv[d] += (a == 2 || a == 3 ? 1 : -1) * (a == 0 || a == 3 ? 1 - u : u) * y;
                    }
                const double own =
                    hypot(hypot(du[1] * dv[2] - du[2] * dv[1], du[2] * dv[0] - du[0] * dv[2]),
                          du[0] * dv[1] - du[1] * dv[0]);
                const double distance = 1 - hypot(hypot(x[0], x[1]), x[2]);
                area += own;
                mean += own * distance;
                max = fmax(max, distance);
            }
        mean /= area;
        const lar_deviation deviation = deviation_of(&mesh, &sphere);
        /* The sphere's own triangles lie up to 1e-4 inside. */
        assert_below(fabs(deviation.mean - mean), 0.02 * mean + 1e-4);
        assert_below(fabs(deviation.hausdorff - max), 0.03 * max + 1e-4);
        assert_true(deviation.mean < deviation.max_95 && deviation.max_95 <= deviation.hausdorff);
        free(face);
        lar_mesh_clear(&mesh);
    }
    lar_triangles_clear(&sphere);
}

/* One cube, its top against a square beside it. */
static lar_deviation top_against_square(double aside, double above) {
    lar_triangles square;
    shape_surface_begin(&square, 4, 2);
    static const double corner[4][3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    for (int v = 0; v < 4; v++) {
        memcpy(square.vertex[v], corner[v], sizeof corner[v]);
        square.vertex[v][0] += aside;
        square.vertex[v][2] += above;
    }
    shape_triangle(&square, 0, 0, 1, 2);
    shape_triangle(&square, 1, 0, 2, 3);
    double position[8][3];
    int32_t element[1][8];
    for (int a = 0; a < 8; a++) {
        element[0][a] = a;
        for (int d = 0; d < 3; d++) position[a][d] = 0.5 + 0.5 * lar_node_sign[a][d];
    }
    const lar_mesh mesh = {
        .node_count = 8, .position = position, .element_count = 1, .element = element};
    const int32_t top = 5;
    lar_deviation deviation;
    lar_error error;
    assert_int_equal(lar_deviation_measure(&mesh, &top, 1, &square, &deviation, &error), LAR_OK);
    lar_triangles_clear(&square);
    return deviation;
}

static void squares_apart(void **state) {
    (void)state;
    lar_deviation deviation = top_against_square(0, 0.25);
    assert_below(fabs(deviation.mean - 0.25), 1e-12);
    assert_below(fabs(deviation.max_95 - 0.25), 1e-12);
    assert_below(fabs(deviation.hausdorff - 0.25), 1e-12);
    /* Shifted in its own plane: the strip beside has distances 0 .. s, in both directions. */
    deviation = top_against_square(0.5, 0);
    assert_below(fabs(deviation.mean - 0.125), 0.01);
    assert_below(fabs(deviation.max_95 - 0.45), 0.03);
    assert_below(fabs(deviation.hausdorff - 0.5), 1e-12);
}

static void nothing_to_compare(void **state) {
    (void)state;
    const lar_mesh mesh = {0};
    const lar_triangles none = {0};
    lar_deviation deviation;
    lar_error error;
    assert_int_equal(lar_deviation_measure(&mesh, NULL, 0, &none, &deviation, &error),
                     LAR_ERROR_MODEL);
}

static void jacobians(void **state) {
    (void)state;
    lar_mesh mesh = ball(6);
    lar_jacobians jacobians;
    lar_jacobians_count(&mesh, &jacobians);
    int32_t sum = 0, high = 0;
    for (int b = 0; b < 10; b++) {
        sum += jacobians.bin[b];
        if (b >= 5) high += jacobians.bin[b];
    }
    assert_int_equal(sum, 216);
    assert_below(fabs(jacobians.above_05 - high / 216.0), 1e-12);
    double corner[8][3];
    lar_mesh_corners(&mesh, jacobians.worst, corner);
    assert_true(lar_scaled_jacobian((const double(*)[3])corner) == jacobians.min);
    assert_true(jacobians.min < jacobians.mean && jacobians.mean < 1);
    /* Turned inside out all are in the first bin. */
    for (int n = 0; n < mesh.node_count; n++) mesh.position[n][0] = -mesh.position[n][0];
    lar_jacobians_count(&mesh, &jacobians);
    assert_int_equal(jacobians.bin[0], 216);
    assert_true(jacobians.above_02 == 0 && jacobians.min < 0);
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_of_faces_in_a_sphere),
        cmocka_unit_test(squares_apart),
        cmocka_unit_test(nothing_to_compare),
        cmocka_unit_test(jacobians),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
