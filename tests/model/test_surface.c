/* The outer surface: which faces and nodes are on it, where they look, and how they are found. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "brick.h"
#include "model/demo/demo.h"
#include "model/model.h"

static void build(const char *name, lar_mesh *mesh, lar_surface *surface) {
    *mesh = (lar_mesh){0};
    *surface = (lar_surface){0};
    assert_int_equal(brick_read(name, 1.0, mesh, NULL), LAR_OK);
    assert_int_equal(lar_surface_build(mesh, surface, NULL), LAR_OK);
}

/* A third of the sum of corner-wise x . n dA is the volume when every face looks outside. */
static double volume_inside(const lar_mesh *mesh, const lar_surface *surface) {
    double sum = 0;
    for (int32_t f = 0; f < surface->face_count; f++)
        for (int half = 0; half < 2; half++) {
            const double *a = mesh->position[surface->corner[f][0]];
            const double *b = mesh->position[surface->corner[f][1 + half]];
            const double *c = mesh->position[surface->corner[f][2 + half]];
            sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
    return sum / 6;
}

static void test_brick(void **state) {
    (void)state;
    lar_mesh mesh;
    lar_surface surface;
    build("brick.vtu", &mesh, &surface);
    assert_int_equal(surface.face_count, 24);
    assert_int_equal(surface.node_count, 26); /* all but the middle one */
    for (int32_t i = 0, n = 0; n < BRICK_NODES; n++) {
        assert_int_equal(surface.index_of[n], n == 13 ? -1 : i);
        if (n != 13) assert_int_equal(surface.node[i++], n);
    }
    for (int32_t f = 0; f < 24; f++) {
        if (f) assert_true(surface.face[f] > surface.face[f - 1]);
        assert_int_equal(surface.element[f], surface.face[f] / 6);
        for (int a = 0; a < 4; a++)
            assert_int_equal(
                surface.corner[f][a],
                mesh.element[surface.element[f]][lar_face_node[surface.face[f] % 6][a]]);
    }
    assert_true(fabs(volume_inside(&mesh, &surface) - 8e-6) < 1e-18);
    lar_surface_clear(&surface);
    lar_surface_clear(&surface);
    assert_int_equal(surface.face_count, 0);
    lar_mesh_clear(&mesh);
}

static void test_find(void **state) {
    (void)state;
    lar_mesh mesh;
    lar_surface surface;
    build("brick.vtu", &mesh, &surface);
    int found = 0;
    for (int32_t face = -3; face < 6 * BRICK_ELEMENTS + 3; face++) {
        int32_t index = lar_surface_find(&surface, face);
        if (index < 0) continue;
        assert_int_equal(surface.face[index], face);
        found++;
    }
    assert_int_equal(found, 24);
    assert_int_equal(lar_surface_find(&surface, 1), -1); /* between elements 0 and 1 */
    assert_int_equal(lar_surface_find(&(lar_surface){0}, 0), -1);
    lar_surface_clear(&surface);
    lar_mesh_clear(&mesh);
}

/* Building again replaces what was there. */
static void test_again(void **state) {
    (void)state;
    lar_mesh mesh;
    lar_surface surface;
    build("brick.vtu", &mesh, &surface);
    mesh.element_count = 4; /* the lower half */
    assert_int_equal(lar_surface_build(&mesh, &surface, NULL), LAR_OK);
    assert_int_equal(surface.face_count, 16);
    assert_int_equal(surface.node_count, 18);
    mesh.element_count = BRICK_ELEMENTS;
    lar_surface_clear(&surface);
    lar_mesh_clear(&mesh);
}

static void test_demonstration_organ(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    lar_surface surface = {0};
    assert_int_equal(lar_demo_mesh(&mesh, NULL), LAR_OK);
    assert_int_equal(lar_surface_build(&mesh, &surface, NULL), LAR_OK);
    /* A closed surface of quadrilaterals: every edge twice, in opposite directions. */
    int64_t edge_sum = 0;
    for (int32_t f = 0; f < surface.face_count; f++)
        for (int a = 0; a < 4; a++) {
            int64_t from = surface.corner[f][a], to = surface.corner[f][(a + 1) % 4];
            edge_sum += from * from * to - to * to * from;
        }
    assert_int_equal(edge_sum, 0);
    assert_true(volume_inside(&mesh, &surface) > 0);
    lar_surface_clear(&surface);
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brick),
        cmocka_unit_test(test_find),
        cmocka_unit_test(test_again),
        cmocka_unit_test(test_demonstration_organ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
