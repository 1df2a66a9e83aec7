/* The nearest of many triangles, against asking all of them with another formula. */
#include "model/triangle_shapes.h"

#include "model/triangles/tree.h"

static const double origin[3] = {0, 0, 0};

/* Squared distance from p to a triangle, by following the edges down in the plane of distances:
 * dense sampling of weights, then refined around the best one. Slow and simple. */
static double brute_distance(const lar_triangles *s, int32_t t, const double p[3]) {
    double best = INFINITY, mid[2] = {1.0 / 3, 1.0 / 3}, width = 1;
    for (int round = 0; round < 60; round++, width *= 0.6) {
        double from[2] = {mid[0], mid[1]};
        for (int i = -4; i <= 4; i++)
            for (int k = -4; k <= 4; k++) {
                double v = fmin(fmax(from[0] + i * width / 4, 0), 1);
                double w = fmin(fmax(from[1] + k * width / 4, 0), 1 - v);
                double square = 0;
                for (int d = 0; d < 3; d++) {
                    const int32_t *c = s->corner[t];
                    double at = (1 - v - w) * s->vertex[c[0]][d] + v * s->vertex[c[1]][d] +
                                w * s->vertex[c[2]][d];
                    square += (at - p[d]) * (at - p[d]);
                }
                if (square < best) best = square, mid[0] = v, mid[1] = w;
            }
    }
    return sqrt(best);
}

/* The answer's own parts agree: weights, point, distance. */
static void check_answer(const lar_triangles *s, const double p[3], const lar_nearest *found) {
    double sum = 0, at[3] = {0}, away[3];
    for (int a = 0; a < 3; a++) {
        assert_true(found->weight[a] >= 0 && found->weight[a] <= 1);
        sum += found->weight[a];
        for (int i = 0; i < 3; i++)
            at[i] += found->weight[a] * s->vertex[s->corner[found->triangle][a]][i];
    }
    assert_below(fabs(sum - 1), 1e-14);
    double size = 1 + lar_length(found->point);
    lar_minus(at, found->point, away);
    assert_below(lar_length(away), 1e-13 * size);
    lar_minus(p, found->point, away);
    assert_below(fabs(lar_length(away) - found->distance), 1e-13 * (size + lar_length(p)));
}

static lar_triangle_tree *tree_of(const lar_triangles *s, const int32_t *index, int32_t count) {
    lar_triangle_tree *tree = NULL;
    lar_error error = {0};
    assert_int_equal(lar_triangle_tree_create(s, index, count, &tree, &error), LAR_OK);
    return tree;
}

/* Random triangles, some without area, some lying twice there. */
static lar_triangles random_soup(int32_t count, uint64_t seed) {
    lar_triangles soup;
    shape_surface_begin(&soup, 3 * count, count);
    for (int32_t t = 0; t < count; t++) {
        double size = t % 5 == 0 ? 1 : 0.05;
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < 3; i++) {
                double *base = soup.vertex[3 * t];
                soup.vertex[3 * t + a][i] =
                    a == 0 ? shape_random(&seed) : base[i] + size * (shape_random(&seed) - 0.5);
            }
        shape_triangle(&soup, t, 3 * t, 3 * t + 1, 3 * t + 2);
        double(*v)[3] = soup.vertex + 3 * t;
        if (t % 7 == 1) memcpy(v[1], v[0], sizeof *v);                                /* a needle */
        if (t % 7 == 2) memcpy(v[1], v[0], sizeof *v), memcpy(v[2], v[0], sizeof *v); /* a point */
        if (t % 7 == 3)
            for (int i = 0; i < 3; i++) v[2][i] = 0.5 * (v[0][i] + v[1][i]); /* in a line */
        if (t % 7 == 4 && t > 1) memcpy(soup.corner[t], soup.corner[t - 1], sizeof *soup.corner);
    }
    return soup;
}

static void test_soup_against_all(void **state) {
    (void)state;
    lar_triangles soup = random_soup(150, 7);
    lar_triangle_tree *tree = tree_of(&soup, NULL, 0);
    uint64_t seed = 3;
    for (int n = 0; n < 60; n++) {
        double p[3], min = INFINITY, far = n % 6 == 0 ? 1e6 : 2;
        for (int i = 0; i < 3; i++) p[i] = 0.5 + far * (shape_random(&seed) - 0.5);
        for (int32_t t = 0; t < soup.triangle_count; t++)
            min = fmin(min, brute_distance(&soup, t, p));
        lar_nearest found;
        assert_true(lar_triangle_tree_nearest(tree, p, INFINITY, &found));
        check_answer(&soup, p, &found);
        assert_below(fabs(found.distance - min), 1e-7 * (min + 1e-3));
        assert_below(fabs(brute_distance(&soup, found.triangle, p) - min), 1e-7 * (min + 1e-3));
        assert_false(lar_triangle_tree_nearest(tree, p, 0.999 * found.distance, &found));
        assert_true(lar_triangle_tree_nearest(tree, p, 1.001 * found.distance, &found));
        assert_false(lar_triangle_tree_is_near(tree, p, 0.999 * found.distance));
        assert_true(lar_triangle_tree_is_near(tree, p, 1.001 * found.distance));
        assert_true(lar_triangle_tree_is_near(tree, p, INFINITY));
    }
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&soup);
}

/* The same answer, bit for bit, as from one tree per triangle: ties go to the smallest index. */
static void test_ties_go_to_the_smallest_index(void **state) {
    (void)state;
    lar_triangles ball;
    shape_ellipsoid_surface(&ball, (double[]){1, 1, 1}, origin, 12);
    lar_triangle_tree *tree = tree_of(&ball, NULL, 0);
    lar_triangle_tree **one = lar_calloc((size_t)ball.triangle_count, sizeof *one);
    assert_non_null(one);
    for (int32_t t = 0; t < ball.triangle_count; t++) one[t] = tree_of(&ball, &t, 1);
    uint64_t seed = 11;
    for (int n = 0; n < 600; n++) {
        double p[3];
        const int32_t *c = ball.corner[n % ball.triangle_count];
        double along = n % 4 == 0 ? 1 : n % 4 == 1 ? 0.5 : shape_random(&seed);
        double lift = n % 3 == 0 ? 0 : n % 3 == 1 ? 0.4 : -0.7; /* on, above, below the surface */
        for (int i = 0; i < 3; i++) {
            double edge = along * ball.vertex[c[0]][i] + (1 - along) * ball.vertex[c[1]][i];
            p[i] = n % 5 == 4 ? 0 : (1 + lift) * edge;
        }
        lar_nearest found, best = {.triangle = -1}, other;
        double min = INFINITY; /* squared: two squares may have one root */
        for (int32_t t = 0; t < ball.triangle_count; t++) {
            assert_true(lar_triangle_tree_nearest(one[t], p, INFINITY, &other));
            double away[3];
            lar_minus(p, other.point, away);
            if (!(lar_dot(away, away) < min)) continue;
            min = lar_dot(away, away);
            best = other;
        }
        assert_true(lar_triangle_tree_nearest(tree, p, INFINITY, &found));
        assert_int_equal(found.triangle, best.triangle);
        assert_memory_equal(found.point, best.point, sizeof best.point);
        assert_memory_equal(found.weight, best.weight, sizeof best.weight);
    }
    for (int32_t t = 0; t < ball.triangle_count; t++) lar_triangle_tree_destroy(one[t]);
    free(one);
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&ball);
}

static void test_few_triangles(void **state) {
    (void)state;
    lar_triangles one;
    shape_surface_begin(&one, 3, 1);
    shape_triangle(&one, 0, 0, 1, 2);
    one.vertex[1][0] = 2;
    one.vertex[2][1] = 2;
    lar_triangle_tree *none = tree_of(&one, (const int32_t[]){0}, 0);
    lar_nearest found;
    assert_false(lar_triangle_tree_nearest(none, origin, INFINITY, &found));
    lar_triangle_tree_destroy(none);
    lar_triangle_tree_destroy(NULL);

    lar_triangle_tree *tree = tree_of(&one, NULL, 0);
    static const struct {
        double asked[3], point[3], weight[3];
    } rows[] = {
        {{0.5, 0.5, 3}, {0.5, 0.5, 0}, {0.5, 0.25, 0.25}}, /* above the inside */
        {{-1, -4, 2}, {0, 0, 0}, {1, 0, 0}},               /* a corner */
        {{1, -1, 1}, {1, 0, 0}, {0.5, 0.5, 0}},            /* an edge */
        {{3, 3, 0}, {1, 1, 0}, {0, 0.5, 0.5}},             /* the slanted edge, in the plane */
        {{1e9, 0, 0}, {2, 0, 0}, {0, 1, 0}},               /* from far away */
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        assert_true(lar_triangle_tree_nearest(tree, rows[r].asked, INFINITY, &found));
        for (int i = 0; i < 3; i++) {
            assert_below(fabs(found.point[i] - rows[r].point[i]), 1e-15);
            assert_below(fabs(found.weight[i] - rows[r].weight[i]), 1e-15);
        }
    }
    assert_true(lar_triangle_tree_nearest(tree, (double[]){0.5, 0.5, 2}, 2, &found));
    assert_false(lar_triangle_tree_nearest(tree, (double[]){0.5, 0.5, 2}, 1.999, &found));
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&one);
}

/* All centres at one place: there is nothing to cut by; and sizes that shrink for ever. */
static void test_hard_to_divide(void **state) {
    (void)state;
    enum { COUNT = 500 };
    lar_triangles nested;
    shape_surface_begin(&nested, 3 * COUNT, COUNT);
    for (int32_t t = 0; t < COUNT; t++) {
        double size = t < COUNT / 2 ? 1 : pow(0.25, t - COUNT / 2);
        double shift = t < COUNT / 2 ? 0 : 4 * size;
        for (int a = 0; a < 3; a++) nested.vertex[3 * t + a][0] = shift;
        nested.vertex[3 * t + 1][1] = size;
        nested.vertex[3 * t + 2][1] = -size;
        shape_triangle(&nested, t, 3 * t, 3 * t + 1, 3 * t + 2);
    }
    lar_triangle_tree *tree = tree_of(&nested, NULL, 0);
    lar_nearest found;
    assert_true(lar_triangle_tree_nearest(tree, (double[]){0, 0.5, 0.1}, INFINITY, &found));
    assert_int_equal(found.triangle, 0);
    assert_true(lar_triangle_tree_nearest(tree, (double[]){4, 0.5, 0.1}, INFINITY, &found));
    assert_int_equal(found.triangle, COUNT / 2);
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&nested);
}

typedef struct tally {
    int seen[200], left;
} tally;

static bool count_visit(void *context, int32_t triangle) {
    tally *counts = context;
    counts->seen[triangle]++;
    return --counts->left > 0;
}

static void test_boxes(void **state) {
    (void)state;
    lar_triangles soup = random_soup(200, 5);
    lar_triangle_tree *tree = tree_of(&soup, NULL, 0);
    const double lower[3] = {0.3, 0.2, 0.4}, upper[3] = {0.5, 0.6, 0.5}, margin = 0.05;
    tally counts = {.left = 1000};
    lar_triangle_tree_boxes(tree, lower, upper, margin, count_visit, &counts);
    int members = 0;
    for (int32_t t = 0; t < soup.triangle_count; t++) {
        bool meets = true;
        for (int i = 0; i < 3; i++) {
            double low = INFINITY, high = -INFINITY;
            for (int a = 0; a < 3; a++) {
                low = fmin(low, soup.vertex[soup.corner[t][a]][i]);
                high = fmax(high, soup.vertex[soup.corner[t][a]][i]);
            }
            meets = meets && low <= upper[i] + margin && high >= lower[i] - margin;
        }
        assert_int_equal(counts.seen[t], meets);
        members += meets;
    }
    assert_true(members > 5 && members < 150);
    counts = (tally){.left = 2};
    lar_triangle_tree_boxes(tree, lower, upper, margin, count_visit, &counts);
    assert_int_equal(counts.left, 0);
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&soup);
}

/* A tree over some triangles names them by their number in the whole surface. */
static void test_part_of_a_surface(void **state) {
    (void)state;
    lar_triangles ball;
    shape_ellipsoid_surface(&ball, (double[]){1, 1, 1}, origin, 10);
    int32_t half[400], count = 0;
    for (int32_t t = 0; t < ball.triangle_count; t++)
        if (ball.vertex[ball.corner[t][0]][2] > 0.2) half[count++] = t;
    lar_triangle_tree *tree = tree_of(&ball, half, count);
    lar_nearest found;
    assert_true(lar_triangle_tree_nearest(tree, (double[]){0.1, 0.2, -3}, INFINITY, &found));
    assert_true(ball.vertex[ball.corner[found.triangle][0]][2] > 0.2);
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&ball);
}

/* Where the line meets a triangle, by the formula of Moeller and Trumbore; INFINITY: it does not.
 */
static double brute_line(const lar_triangles *s, int32_t t, const double from[3],
                         const double along[3]) {
    const int32_t *c = s->corner[t];
    double e[3], f[3], p[3], q[3], away[3];
    lar_minus(s->vertex[c[1]], s->vertex[c[0]], e);
    lar_minus(s->vertex[c[2]], s->vertex[c[0]], f);
    lar_cross(along, f, p);
    const double det = lar_dot(e, p);
    if (fabs(det) < 1e-12) return INFINITY;
    lar_minus(from, s->vertex[c[0]], away);
    lar_cross(away, e, q);
    const double v = lar_dot(away, p) / det, w = lar_dot(along, q) / det;
    return v >= 0 && w >= 0 && v + w <= 1 ? lar_dot(f, q) / det : INFINITY;
}

typedef struct line_seen {
    bool *seen;
    int32_t left; /* visits until it is to end */
} line_seen;

static bool see(void *context, int32_t triangle) {
    line_seen *line = context;
    assert_false(line->seen[triangle]);
    line->seen[triangle] = true;
    return --line->left != 0;
}

static void test_lines(void **state) {
    (void)state;
    enum { COUNT = 300 };
    lar_triangles soup = random_soup(COUNT, 11);
    lar_triangle_tree *tree = tree_of(&soup, NULL, 0);
    uint64_t seed = 5;
    int met = 0, visits = 0;
    for (int k = 0; k < 200; k++) {
        double from[3], along[3];
        const double reach = k % 3 ? INFINITY : 0.9;
        for (int i = 0; i < 3; i++) {
            const double aim =
                soup.vertex[3 * k][i] + soup.vertex[3 * k + 1][i] + soup.vertex[3 * k + 2][i];
            from[i] = k % 7 == i ? aim / 3 : 3 * shape_random(&seed) - 1; /* in a plane of axes */
            along[i] = aim / 3 - from[i];
        }
        bool seen[COUNT] = {false};
        line_seen line = {seen, 0};
        lar_triangle_tree_line(tree, from, along, &reach, see, &line);
        for (int32_t t = 0; t < COUNT; t++) {
            const double at = brute_line(&soup, t, from, along);
            if (at >= 0 && at <= reach && at < INFINITY) {
                assert_true(seen[t]);
                met++;
            }
            visits += seen[t];
        }
        bool once[COUNT] = {false};
        lar_triangle_tree_line(tree, from, along, &reach, see, &(line_seen){once, 1});
    }
    assert_true(met > 50 && visits < 200 * COUNT / 3);
    lar_triangle_tree_destroy(tree);
    lar_triangles_clear(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines),
        cmocka_unit_test(test_soup_against_all),
        cmocka_unit_test(test_ties_go_to_the_smallest_index),
        cmocka_unit_test(test_few_triangles),
        cmocka_unit_test(test_hard_to_divide),
        cmocka_unit_test(test_boxes),
        cmocka_unit_test(test_part_of_a_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
