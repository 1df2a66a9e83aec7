/* A fine surface embedded in a coarse mesh: where it is bound, that it is exact at rest and under
 * affine movements, and what is refused. */
#include "testing.h"

#include "brick.h"
#include "meshing/shapes.h"
#include "model/model.h"

enum { BALL = 24 };

/* The brick of brick.h, 20 mm wide, its inner node moved so that no element is a box. */
static lar_mesh twisted_brick(void) {
    lar_mesh mesh = {0};
    assert_int_equal(brick_read("brick.vtu", 1.0, &mesh, NULL), LAR_OK);
    for (int i = 0; i < 3; i++) mesh.position[13][i] += 0.001 * (i + 1);
    for (int n = 0; n < BRICK_NODES; n++) {
        double *x = mesh.position[n];
        x[0] += 0.1 * x[1] + 4 * x[2] * x[2];
        x[2] += 3 * x[0] * x[1];
    }
    return mesh;
}

static lar_embedded_surface bind_ball(const lar_mesh *mesh, double radius) {
    static const double centre[3] = {0.0115, 0.0102, 0.0104};
    lar_triangles ball;
    lar_embedded_surface embedded;
    lar_error error = {0};
    shape_ellipsoid_surface(&ball, (double[3]){radius, radius, radius}, centre, BALL);
    if (lar_embedded_surface_bind(mesh, &ball, &embedded, &error)) fail_msg("%s", error.message);
    assert_null(ball.vertex);
    return embedded;
}

static double distance(const double a[3], const double b[3]) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The place that the weights alone give. */
static void weighted(const lar_embedded_surface *embedded, const lar_mesh *mesh, int32_t v,
                     double place[3]) {
    const int32_t *node = mesh->element[embedded->element[v]];
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int a = 0; a < 8; a++)
            place[i] += (double)embedded->weight[v][a] * mesh->position[node[a]][i];
    }
}

static void expect_exact(const lar_mesh *mesh, double radius, bool outside) {
    lar_embedded_surface embedded = bind_ball(mesh, radius);
    int32_t count = embedded.surface.vertex_count;
    double(*place)[3] = lar_calloc((size_t)count, sizeof *place);
    double(*u)[3] = lar_calloc((size_t)mesh->node_count, sizeof *u);
    assert_true(outside == (embedded.farthest > 0));
    assert_below(embedded.farthest, 0.01);
    lar_embedded_surface_move(&embedded, mesh, NULL, place);
    assert_memory_equal(place, embedded.surface.vertex, (size_t)count * sizeof *place);
    for (int32_t v = 0; v < count; v++) {
        double sum = 0, here[3];
        for (int a = 0; a < 8; a++) sum += (double)embedded.weight[v][a];
        assert_below(fabs(sum - 1), 1e-6);
        weighted(&embedded, mesh, v, here);
        assert_below(distance(here, embedded.surface.vertex[v]), 0.02e-6);
    }
    /* Turned, stretched, sheared and shifted: every vertex follows. */
    static const double f[3][3] = {{0.3, -1.1, 0.2}, {0.9, 0.4, 0.3}, {-0.1, 0.2, 1.4}};
    static const double shift[3] = {0.3, -0.2, 0.1};
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) {
            u[n][i] = shift[i] - mesh->position[n][i];
            for (int k = 0; k < 3; k++) u[n][i] += f[i][k] * mesh->position[n][k];
        }
    lar_embedded_surface_move(&embedded, mesh, (const double(*)[3])u, place);
    for (int32_t v = 0; v < count; v++) {
        double expected[3];
        for (int i = 0; i < 3; i++) {
            expected[i] = shift[i];
            for (int k = 0; k < 3; k++) expected[i] += f[i][k] * embedded.surface.vertex[v][k];
        }
        assert_below(distance(place[v], expected), 0.3e-6);
    }
    free(place);
    free(u);
    lar_embedded_surface_clear(&embedded);
    lar_embedded_surface_clear(&embedded);
    assert_int_equal(embedded.surface.vertex_count, 0);
}

static void test_inside(void **state) {
    (void)state;
    lar_mesh mesh = twisted_brick();
    expect_exact(&mesh, 0.0085, false);
    lar_mesh_clear(&mesh);
}

/* A ball that sticks out of the brick's faces and lies within its corners. */
static void test_partly_outside(void **state) {
    (void)state;
    lar_mesh mesh = twisted_brick();
    expect_exact(&mesh, 0.0145, true);
    lar_mesh_clear(&mesh);
}

/* A vertex inside an element is bound to that one, with weights of 0..1. */
static void test_inside_weights(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    assert_int_equal(brick_read("brick.vtu", 1.0, &mesh, NULL), LAR_OK);
    lar_embedded_surface embedded = bind_ball(&mesh, 0.007);
    for (int32_t v = 0; v < embedded.surface.vertex_count; v++) {
        const double *x = embedded.surface.vertex[v];
        int32_t e = (x[0] > 0.01) + 2 * (x[1] > 0.01) + 4 * (x[2] > 0.01);
        assert_int_equal(embedded.element[v], e);
        for (int a = 0; a < 8; a++)
            assert_true(embedded.weight[v][a] >= 0 && embedded.weight[v][a] <= 1);
    }
    lar_embedded_surface_clear(&embedded);
    lar_mesh_clear(&mesh);
}

/* The nodes of the mesh as a surface: each is at its node, whichever element has it. */
static void test_on_nodes(void **state) {
    (void)state;
    lar_mesh mesh = twisted_brick();
    lar_triangles surface;
    lar_embedded_surface embedded;
    shape_surface_begin(&surface, BRICK_NODES, BRICK_NODES - 2);
    memcpy(surface.vertex, mesh.position, BRICK_NODES * sizeof *surface.vertex);
    for (int t = 0; t < BRICK_NODES - 2; t++) shape_triangle(&surface, t, t, t + 1, t + 2);
    assert_int_equal(lar_embedded_surface_bind(&mesh, &surface, &embedded, NULL), LAR_OK);
    for (int32_t v = 0; v < BRICK_NODES; v++)
        for (int a = 0; a < 8; a++) {
            bool itself = mesh.element[embedded.element[v]][a] == v;
            assert_below(fabs((double)embedded.weight[v][a] - itself), 1e-6);
        }
    assert_below(embedded.farthest, 0);
    lar_embedded_surface_clear(&embedded);
    lar_mesh_clear(&mesh);
}

/* Far from the world's origin, as scans are. */
static void test_far_from_origin(void **state) {
    (void)state;
    lar_mesh mesh = twisted_brick();
    lar_embedded_surface near = bind_ball(&mesh, 0.0145), far;
    for (int n = 0; n < BRICK_NODES; n++) mesh.position[n][1] += 5;
    lar_triangles ball;
    shape_ellipsoid_surface(&ball, (double[3]){0.0145, 0.0145, 0.0145},
                            (double[3]){0.0115, 5.0102, 0.0104}, BALL);
    assert_int_equal(lar_embedded_surface_bind(&mesh, &ball, &far, NULL), LAR_OK);
    for (int32_t v = 0; v < near.surface.vertex_count; v++)
        if (near.element[v] == far.element[v])
            for (int a = 0; a < 8; a++)
                assert_below(fabs((double)(near.weight[v][a] - far.weight[v][a])), 1e-5);
    lar_embedded_surface_clear(&near);
    lar_embedded_surface_clear(&far);
    lar_mesh_clear(&mesh);
}

static void expect_refused(const double half, const double centre[3], const char *part) {
    lar_mesh mesh = twisted_brick();
    lar_triangles ball;
    lar_embedded_surface embedded;
    lar_error error = {0};
    shape_ellipsoid_surface(&ball, (double[3]){half, half, half}, centre, 8);
    assert_int_equal(lar_embedded_surface_bind(&mesh, &ball, &embedded, &error), LAR_ERROR_MODEL);
    if (!strstr(error.message, part)) fail_msg("'%s' is not in: %s", part, error.message);
    assert_null(ball.vertex);
    assert_null(embedded.surface.vertex);
    assert_null(embedded.weight);
    lar_mesh_clear(&mesh);
}

static void test_another_body(void **state) {
    (void)state;
    expect_refused(0.005, (double[3]){0.01, 0.01, 0.06}, "shape.stl: the vertex at (");
    expect_refused(8.5, (double[3]){11.5, 10.2, 10.4}, "another unit");
    expect_refused(NAN, (double[3]){0, 0, 0}, "not finite");
}

static void test_model_without(void **state) {
    (void)state;
    lar_model *model = lar_model_create();
    lar_embedded_info info;
    assert_int_equal(lar_model_embedded(NULL, &info), 0);
    assert_int_equal(lar_model_embedded(model, &info), 0);
    lar_model_embedded_move(model, NULL, NULL);
    lar_model_embedded_move(NULL, NULL, NULL);
    assert_null(lar_model_element_nodes(model, 0));
    assert_null(lar_model_element_nodes(NULL, 0));
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_inside),          cmocka_unit_test(test_partly_outside),
        cmocka_unit_test(test_inside_weights),  cmocka_unit_test(test_on_nodes),
        cmocka_unit_test(test_far_from_origin), cmocka_unit_test(test_another_body),
        cmocka_unit_test(test_model_without)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
