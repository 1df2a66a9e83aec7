/* Triangles that go through each other, that only touch, and how deep. */
#include "model/triangle_shapes.h"

static const double origin[3] = {0, 0, 0};

static lar_crossings crossings_of(const lar_triangles *s) {
    lar_crossings found;
    lar_error error = {0};
    assert_int_equal(lar_triangles_find_crossings(s, &found, &error), LAR_OK);
    assert_int_equal(lar_triangles_check_crossing(s, &error), found.deep > 0 ? LAR_ERROR_MODEL : 0);
    if (found.deep > 0) {
        assert_non_null(strstr(error.message, "the surface goes through itself"));
        char number[24];
        snprintf(number, sizeof number, " %d pair", found.deep);
        assert_non_null(strstr(error.message, number));
    }
    return found;
}

/* Two triangles; the second may name corners of the first. */
static lar_crossings pair(const double (*corner)[3], const int32_t second[3], double scale,
                          double shift) {
    lar_triangles two;
    shape_surface_begin(&two, 6, 2);
    for (int v = 0; v < 6; v++)
        for (int i = 0; i < 3; i++) two.vertex[v][i] = shift + scale * corner[v][i];
    shape_triangle(&two, 0, 0, 1, 2);
    shape_triangle(&two, 1, second[0], second[1], second[2]);
    lar_crossings found = crossings_of(&two);
    lar_triangles_clear(&two);
    return found;
}

static void test_pairs(void **state) {
    (void)state;
    static const struct {
        double second[3][3]; /* the first one: (0 0 0) (4 0 0) (0 4 0) */
        int32_t name[3];
        double depth; /* 0: they do not cross */
    } rows[] = {
        {{{1, 1, -1}, {1, 1, 2}, {6, 6, 2}}, {3, 4, 5}, 1},     /* through it */
        {{{1, 1, -0.1}, {2, 1, 3}, {1, 2, 3}}, {3, 4, 5}, 0.1}, /* a tip */
        {{{10.2, -5, -5}, {-9.8, 5, -5}, {0.2, 0, 10}}, {3, 4, 5}, 0.0894427190999916}, /* by it */
        {{{1, 1, 0}, {2, 1, 3}, {1, 2, 3}}, {3, 4, 5}, 0},                  /* the tip touches */
        {{{1, 1, 1e-3}, {2, 1, 3}, {1, 2, 3}}, {3, 4, 5}, 0},               /* a gap */
        {{{1, 0, 0}, {2, 0, 0}, {1, -1, 1}}, {3, 4, 5}, 0},                 /* an edge touches */
        {{{1, 1, 0}, {6, 1, 0}, {1, 6, 0}}, {3, 4, 5}, 1.4142135623730951}, /* in one plane */
        {{{1, 1, 0}, {1, 6, 0}, {6, 1, 0}}, {3, 4, 5}, 0}, /* the same, looking at each other */
        {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {3, 4, 5}, 2.8284271247461903}, /* the same twice */
        {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {1, 2, 0}, 2.8284271247461903}, /* by its corners */
        {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {1, 0, 2}, 0},                  /* a leaf */
        {{{2, 2, -1}, {2, 2, 1}, {5, 5, 0}}, {3, 4, 5}, 0},   /* beside the long edge */
        {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {0, 3, 1}, 0},    /* a common edge */
        {{{2, 1, -1}, {2, 1, 1}, {0, 0, 0}}, {0, 3, 4}, 1},   /* common corner */
        {{{-2, 1, -1}, {-2, 1, 1}, {0, 0, 0}}, {0, 3, 4}, 0}, /* the same, away */
        {{{-1, 2, 0}, {-1, -1, 0}, {0, 0, 0}}, {0, 3, 4}, 0}, /* in one plane */
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        double corner[6][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
        memcpy(corner + 3, rows[r].second, sizeof rows[r].second);
        lar_crossings found = pair((const double(*)[3])corner, rows[r].name, 1, 0);
        assert_int_equal(found.deep + found.shallow, rows[r].depth > 0);
        /* Small, and far from the origin: the same answer, less exactly. */
        lar_crossings moved = pair((const double(*)[3])corner, rows[r].name, 1e-3, 0.125);
        assert_int_equal(moved.deep, found.deep);
        assert_below(fabs(1e3 * moved.deepest - found.deepest), 1e-9);
        if (rows[r].depth > 0) assert_below(fabs(found.deepest - rows[r].depth), 1e-12);
    }
}

static void test_closed_shapes(void **state) {
    (void)state;
    lar_triangles body;
    shape_torus_surface(&body, 3, 1, origin, 24);
    assert_int_equal(crossings_of(&body).deep, 0);
    assert_int_equal(crossings_of(&body).shallow, 0);
    lar_triangles_clear(&body);
    shape_torus_surface(&body, 3, 1, origin, 24);
    for (int32_t v = 0; v < body.vertex_count; v++) /* pressed through itself from both sides */
        body.vertex[v][1] -= 2.3 * tanh(body.vertex[v][1]);
    assert_true(crossings_of(&body).deep > 20);
    lar_triangles_clear(&body);
    shape_ellipsoid_surface(&body, (double[]){1, 2, 1e-3}, origin, 24); /* thin as a leaf */
    assert_int_equal(crossings_of(&body).deep + crossings_of(&body).shallow, 0);
    lar_triangles_clear(&body);
}

/* Two balls of 1, from apart to deep in each other; symmetrical, where edges meet edges, or not. */
static void test_two_balls(void **state) {
    (void)state;
    static const struct {
        double distance, aside;
        int deep, shallow; /* 0: none, 1: some */
    } rows[] = {
        {2.5, 0, 0, 0},     {2, 0, 0, 0},     {1.999, 0, 0, 1}, {1.95, 0, 1, 0}, {1.5, 0, 1, 0},
        {1.5, 0.017, 1, 1}, {0.4, 0.1, 1, 1}, {0, 0, 1, 0}, /* the same ball twice */
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        lar_triangles a, b;
        shape_ellipsoid_surface(&a, (double[]){1, 1, 1}, origin, 16);
        shape_ellipsoid_surface(&b, (double[]){1, 1, 1},
                                (double[]){rows[r].distance, rows[r].aside, 2 * rows[r].aside}, 16);
        lar_triangles both = shape_both(&a, &b);
        lar_crossings found = crossings_of(&both);
        assert_int_equal(found.deep > 0, rows[r].deep);
        if (found.deep == 0) assert_int_equal(found.shallow > 0, rows[r].shallow);
        if (found.deep > 0) assert_true(found.pair[0] < found.pair[1]);
        lar_triangles_clear(&both);
    }
}

/* Two boxes side by side in line, so that their sides lie in common planes. */
static void test_boxes_in_line(void **state) {
    (void)state;
    for (int way = 0; way < 3; way++) {
        lar_triangles a, b;
        double from = 0.5 + 0.5 * way; /* overlapping, touching, apart */
        shape_box_surface(&a, origin, (double[]){1, 1, 1});
        shape_box_surface(&b, (double[]){from, 0, 0}, (double[]){from + 1, 1, 1});
        lar_triangles both = shape_both(&a, &b);
        lar_crossings found = crossings_of(&both);
        assert_int_equal(found.deep > 0, way == 0);
        assert_int_equal(found.shallow, 0);
        lar_triangles_clear(&both);
    }
}

/* Hundreds of triangles through one place: looking ends after LAR_CROSSINGS_MAX. */
static void test_many(void **state) {
    (void)state;
    enum { FAN = 300 };
    lar_triangles fan;
    lar_error error = {0};
    shape_surface_begin(&fan, 3 * FAN, FAN);
    for (int32_t t = 0; t < FAN; t++) {
        double turn = SHAPE_PI * t / FAN;
        for (int a = 0; a < 3; a++) {
            double *at = fan.vertex[3 * t + a], along = a == 0 ? -1 : 1;
            at[0] = along * cos(turn), at[1] = along * sin(turn), at[2] = a == 2;
        }
        shape_triangle(&fan, t, 3 * t, 3 * t + 1, 3 * t + 2);
    }
    assert_int_equal(crossings_of(&fan).deep, LAR_CROSSINGS_MAX);
    assert_int_equal(lar_triangles_check_crossing(&fan, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "more than 10000 pairs"));
    lar_triangles_clear(&fan);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs),     cmocka_unit_test(test_closed_shapes),
        cmocka_unit_test(test_two_balls), cmocka_unit_test(test_boxes_in_line),
        cmocka_unit_test(test_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
