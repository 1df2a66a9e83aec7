/* Closed or not, and which way round: holes, turned triangles, shells in shells, one-sided bands.
 */
#include "model/triangle_shapes.h"

static const double origin[3] = {0, 0, 0};

static lar_triangles ball(double x, double radius) {
    lar_triangles made;
    shape_ellipsoid_surface(&made, (double[]){radius, radius, radius}, (double[]){x, 0, 0}, 10);
    return made;
}

static void turn(lar_triangles *s, int32_t t) {
    int32_t swapped = s->corner[t][0];
    s->corner[t][0] = s->corner[t][1];
    s->corner[t][1] = swapped;
}

static void turn_all(lar_triangles *s) {
    for (int32_t t = 0; t < s->triangle_count; t++) turn(s, t);
}

/* Closes it; the number of turned triangles. Then nothing is left to turn. */
static int32_t closed(lar_triangles *s) {
    int32_t turned = -1, again = -1;
    lar_error error = {0};
    if (lar_triangles_close(s, &turned, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_triangles_close(s, &again, NULL), LAR_OK);
    assert_int_equal(again, 0);
    return turned;
}

static void not_closed(lar_triangles *s, const char *words) {
    lar_error error = {0};
    assert_int_equal(lar_triangles_close(s, NULL, &error), LAR_ERROR_MODEL);
    if (!strstr(error.message, words)) fail_msg("'%s' is not in: %s", words, error.message);
    assert_non_null(strstr(error.message, "shape.stl: "));
}

static void test_turned_triangles(void **state) {
    (void)state;
    lar_triangles torus;
    shape_torus_surface(&torus, 3, 1, origin, 16);
    double volume = lar_triangles_volume(&torus);
    assert_int_equal(closed(&torus), 0);
    for (int32_t t = 0; t < torus.triangle_count; t += 7) turn(&torus, t);
    int32_t some = (torus.triangle_count + 6) / 7;
    assert_int_equal(closed(&torus), some);
    assert_below(fabs(lar_triangles_volume(&torus) - volume), 1e-12);
    turn_all(&torus);
    assert_int_equal(closed(&torus), torus.triangle_count);
    uint64_t seed = 5;
    for (int32_t t = 0; t < torus.triangle_count; t++)
        if (shape_random(&seed) < 0.7) turn(&torus, t);
    closed(&torus);
    assert_below(fabs(lar_triangles_volume(&torus) - volume), 1e-12);
    lar_triangles_clear(&torus);
}

static void test_open(void **state) {
    (void)state;
    lar_triangles box;
    shape_box_surface(&box, origin, (double[]){1, 1, 1});
    box.triangle_count--;
    not_closed(&box, "3 open edges, one at (");
    not_closed(&box, "close the holes in a mesh editor");
    box.triangle_count -= 9;
    not_closed(&box, "4 open edges");
    lar_triangles_clear(&box);
    /* An inner wall: its edges have three triangles. */
    lar_triangles made = ball(0, 1);
    lar_triangles walled;
    shape_surface_begin(&walled, made.vertex_count, made.triangle_count + 1);
    memcpy(walled.vertex, made.vertex, (size_t)made.vertex_count * sizeof *made.vertex);
    memcpy(walled.corner, made.corner, (size_t)made.triangle_count * sizeof *made.corner);
    shape_triangle(&walled, made.triangle_count, 1, 60, 100);
    not_closed(&walled, "3 open edges");
    lar_triangles_clear(&walled);
    lar_triangles_clear(&made);
}

/* A torus that is closed with a twist (Klein's bottle, as far as edges know): it has no inside. */
static void test_one_sided(void **state) {
    (void)state;
    enum { AROUND = 12, TUBE = 8 };
    lar_triangles bottle;
    shape_surface_begin(&bottle, AROUND * TUBE, 2 * AROUND * TUBE);
    for (int32_t v = 0; v < bottle.vertex_count; v++)
        bottle.vertex[v][0] = v / TUBE, bottle.vertex[v][1] = v % TUBE;
    for (int32_t i = 0; i < AROUND; i++)
        for (int32_t k = 0; k < TUBE; k++) {
            bool seam = i == AROUND - 1;
            int32_t next = (i + 1) % AROUND * TUBE, up = (k + 1) % TUBE;
            int32_t b = next + (seam ? (TUBE - k) % TUBE : k);
            int32_t c = next + (seam ? (TUBE - up) % TUBE : up), a = i * TUBE + k;
            shape_triangle(&bottle, 2 * a, a, b, c);
            shape_triangle(&bottle, 2 * a + 1, a, c, i * TUBE + up);
        }
    not_closed(&bottle, "the surface has no inside");
    lar_triangles_clear(&bottle);
}

static void test_shells(void **state) {
    (void)state;
    const double pi4 = 4 * SHAPE_PI / 3;
    /* What is given: outward (+) or inward (-) for: a ball of 1, a ball of 0.5 within it, one of
     * 0.25 within that, and a ball of 1 beside. What comes out: signs again, 0: left out. */
    static const struct {
        int given[4], wanted[4];
    } rows[] = {
        {{1, -1, 1, 1}, {1, -1, 1, 1}},   /* as it should be: a hollow with a stone in it */
        {{-1, 1, -1, 1}, {1, -1, 1, 1}},  /* the first body inside out */
        {{-1, 1, -1, -1}, {1, -1, 1, 1}}, /* all */
        {{1, 1, 1, -1}, {1, 0, 0, 1}},    /* nested without hollows: the inner ones bound nothing */
        {{-1, -1, -1, 1}, {1, 0, 0, 1}},  /* the same inside out */
        {{1, 1, -1, 1}, {1, 0, 0, 1}},    /* a hollow in what is there twice */
        {{1, -1, -1, 1}, {1, -1, 0, 1}},  /* a hollow in a hollow */
    };
    static const double radius[4] = {1, 0.5, 0.25, 1}, place[4] = {0, 0, 0, 3};
    enum { ROWS = sizeof rows / sizeof *rows };
    for (size_t run = 0; run < 2 * ROWS; run++) {
        size_t r = run % ROWS;
        bool torn = run >= ROWS; /* the inner shell's first triangle is turned against the others */
        lar_triangles all;
        for (int k = 0; k < 4; k++) {
            /* Centres a little apart, or exactly so that rays run through corners. */
            lar_triangles one = ball(place[k] + (r % 2 ? 0 : 0.01 * k), radius[k]);
            if (rows[r].given[k] < 0) turn_all(&one);
            if (torn && k == 1) turn(&one, 0);
            all = k == 0 ? one : shape_both(&all, &one);
        }
        int32_t each = all.triangle_count / 4, wanted = 0, left = 0;
        for (int k = 0; k < 4; k++) {
            wanted += rows[r].given[k < 3 ? 0 : 3] < 0 ? each : 0; /* with the outermost */
            left += rows[r].wanted[k] != 0 ? each : 0;
        }
        int32_t turned = closed(&all);
        if (!torn) assert_int_equal(turned, wanted);
        assert_int_equal(all.triangle_count, left);
        double volume = 0;
        for (int k = 0; k < 4; k++) volume += rows[r].wanted[k] * pi4 * pow(radius[k], 3);
        assert_below(fabs(lar_triangles_volume(&all) / volume - 1), 0.05);
        lar_triangles_clear(&all);
    }
}

/* The line from the inner shell to +x runs exactly through the outer one's tip, and the faces on
 * the other side reach beside it. */
static void test_hollow_behind_a_tip(void **state) {
    (void)state;
    lar_triangles outer, inner;
    shape_surface_begin(&outer, 6, 8);
    for (int v = 0; v < 6; v++) outer.vertex[v][v / 2] = v % 2 ? 30 : -30;
    for (int f = 0; f < 8; f++) {
        int x = f & 1, y = f >> 1 & 1, z = f >> 2;
        bool even = (x + y + z) % 2;
        shape_triangle(&outer, f, x, even ? 2 + y : 4 + z, even ? 4 + z : 2 + y);
    }
    shape_surface_begin(&inner, 4, 4);
    static const double place[4][3] = {{-1, -1, -1}, {-1, 2, -1}, {-1, -1, 2}, {-2, 0, 0}};
    memcpy(inner.vertex, place, sizeof place);
    static const int face[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    for (int f = 0; f < 4; f++) shape_triangle(&inner, f, face[f][0], face[f][1], face[f][2]);
    double outside = lar_triangles_volume(&outer), inside = lar_triangles_volume(&inner);
    assert_true(outside > 0 && inside > 0);
    turn_all(&outer);
    lar_triangles both = shape_both(&outer, &inner);
    assert_int_equal(closed(&both), 12);
    assert_below(fabs(lar_triangles_volume(&both) - (outside - inside)), 1e-9);
    lar_triangles_clear(&both);
}

/* A ball in the hole of a ring is in its box, not in it. */
static void test_ball_in_a_ring(void **state) {
    (void)state;
    lar_triangles ring, stone = ball(0.01, 0.5);
    shape_torus_surface(&ring, 3, 1, origin, 16);
    int32_t triangles = ring.triangle_count;
    turn_all(&ring);
    lar_triangles both = shape_both(&ring, &stone);
    assert_int_equal(closed(&both), triangles);
    lar_triangles_clear(&both);
}

/* Two boxes that share an edge, or a whole face: four triangles meet there. Which way round one of
 * them is can be told from the other one's only at an edge. */
static void test_touching_boxes(void **state) {
    (void)state;
    for (int way = 0; way < 8; way++) {
        lar_triangles a, b;
        lar_error error;
        bool face = way & 4;
        if (way == 5 || way == 6) continue;
        shape_box_surface(&a, origin, (double[]){1, 1, 1});
        shape_box_surface(&b, (double[]){1, face ? 0 : 1, 0}, (double[]){2, face ? 1 : 2, 1});
        if (way & 1) turn_all(&a);
        if (way & 2) turn_all(&b);
        lar_triangles both = shape_both(&a, &b);
        assert_int_equal(lar_triangles_join(&both, &error), LAR_OK);
        assert_int_equal(both.vertex_count, face ? 12 : 14);
        closed(&both);
        assert_below(fabs(lar_triangles_volume(&both) - 2), 1e-12);
        lar_triangles_clear(&both);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turned_triangles), cmocka_unit_test(test_open),
        cmocka_unit_test(test_one_sided),        cmocka_unit_test(test_shells),
        cmocka_unit_test(test_touching_boxes),   cmocka_unit_test(test_hollow_behind_a_tip),
        cmocka_unit_test(test_ball_in_a_ring),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
