/* Faces that go through each other, that only touch, and how near they may come. */
#include "testing.h"

#include "base/memory.h"
#include "meshing/fit/crossing.h"
#include "meshing/meshing.h"
#include "model/triangles/triangles.h"

static double depth(const double (*x)[3], const int32_t a[4], const int32_t b[4], double gap) {
    const double one = lar_faces_cross(x, a, b, gap), other = lar_faces_cross(x, b, a, gap);
    assert_below(fabs(one - other), 1e-12);
    return one;
}

/* The first face: a square of 2 in the plane z = 0, its corner 2 lifted by `lift`. */
static double against(double lift, const double (*second)[3], const int32_t name[4], double gap) {
    const int32_t first[4] = {0, 1, 2, 3};
    double x[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, lift}, {0, 2, 0}};
    memcpy(x + 4, second, 4 * sizeof x[0]);
    return depth((const double(*)[3])x, first, name, gap);
}

static void test_pairs(void **state) {
    (void)state;
    const struct {
        double lift, second[4][3];
        int32_t name[4];
        double depth; /* 0: apart */
    } rows[] = {
        {0, {{1, 1, -1}, {3, 1, -1}, {3, 1, 3}, {1, 1, 3}}, {4, 5, 6, 7}, 1},  /* through it */
        {0, {{1, 1, 0}, {3, 1, 1}, {3, 3, 2}, {1, 3, 1}}, {4, 5, 6, 7}, 0},    /* touches */
        {0, {{1, 1, 0.01}, {3, 1, 1}, {3, 3, 2}, {1, 3, 1}}, {4, 5, 6, 7}, 0}, /* above it */
        {0, {{2, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 2, 0}}, {4, 5, 6, 7}, 0},    /* beside it */
        {0, {{0}, {4, 0, 0}, {4, 2, 0}, {0}}, {1, 5, 6, 2}, 0},                /* a neighbour */
        {0, {{0}, {1, 0, 1e-3}, {1, 2, 1e-3}, {0}}, {1, 5, 6, 2}, 0},          /* folded */
        {0, {{0}, {4, 2, 0}, {4, 4, 0}, {2, 4, 0}}, {2, 5, 6, 7}, 0},          /* at a corner */
        {0, {{0}, {0.5, 1, -0.5}, {0.5, 0.5, 0.5}, {1, 0.5, 0.5}}, {2, 5, 6, 7}, 0.5},
        /* Lifted, the face is below z = 0.5 in its middle along the one diagonal, and at 1 along
         * the other one. */
        {2, {{0.9, 0.9, 0.4}, {1.1, 0.9, 0.4}, {1.1, 1.1, 0.6}, {0.9, 1.1, 0.6}}, {4, 5, 6, 7}, 0},
        {2,
         {{0.9, 0.9, -1}, {1.1, 0.9, -1}, {1.1, 0.9, 0.5}, {0.9, 0.9, 0.5}},
         {4, 5, 6, 7},
         0.2 * sqrt(0.5)},
        {2,
         {{0.9, 1.1, 0.5}, {1.1, 1.1, 0.5}, {1.1, 1.1, 3}, {0.9, 1.1, 3}},
         {4, 5, 6, 7},
         0.2 * sqrt(0.5)},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        const double found = against(rows[r].lift, rows[r].second, rows[r].name, 0);
        if ((found > 0) != (rows[r].depth > 0) || fabs(found - rows[r].depth) > 1e-9)
            fail_msg("row %zu: %g deep, not %g", r, found, rows[r].depth);
    }
}

static double chance(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / (1 << 24);
}

/* Two faces with `shared` common nodes, as a mesh has them, and bent. */
static void bend_faces(uint32_t *seed, int shared, double x[8][3], int32_t name[4]) {
    static const double corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const double turn = 6 * chance(seed), lift = 0.3 * chance(seed);
    for (int k = 0; k < 4; k++) {
        const double u = corner[k][0], v = corner[k][1];
        const double second[3] = {shared > 0 ? u * cos(turn) : u + 0.6 * chance(seed),
                                  shared > 1 ? v : v + 0.3 * chance(seed),
                                  shared > 0 ? u * sin(turn) : lift + 0.5 * chance(seed)};
        name[k] = 4 + k;
        for (int i = 0; i < 3; i++) {
            x[k][i] = (i < 2 ? corner[k][i] : 0) + 0.5 * (chance(seed) - 0.5);
            x[4 + k][i] = second[i] + 0.5 * (chance(seed) - 0.5);
        }
    }
    if (shared > 0) name[0] = 0;
    if (shared > 1) name[3] = 3;
}

/* All of their triangles, by all directions. */
static bool cross_plainly(const double (*x)[3], const int32_t a[4], const int32_t b[4],
                          double gap) {
    static const int half[4][3] = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}, {1, 3, 0}};
    for (int s = 0; s < 16; s++) {
        double one[3][3], other[3][3];
        int same = 0;
        for (int i = 0; i < 3; i++) {
            memcpy(one[i], x[a[half[s / 4][i]]], sizeof one[i]);
            memcpy(other[i], x[b[half[s % 4][i]]], sizeof other[i]);
            for (int k = 0; k < 3; k++) same += a[half[s / 4][i]] == b[half[s % 4][k]];
        }
        if (same < 2 &&
            lar_triangle_overlap((const double(*)[3])one, (const double(*)[3])other, gap) > 0)
            return true;
    }
    return false;
}

/* What is seen at a glance is what all directions say; and who goes less far than the clearance
 * crosses nothing. */
static void test_clearance(void **state) {
    (void)state;
    enum { FACES = 3000, WAYS = 20 };
    const int32_t first[4] = {0, 1, 2, 3};
    uint32_t seed = 7;
    for (int shared = 0; shared < 3; shared++) {
        int crossing = 0, known = 0;
        const double gap = shared ? 0 : 0.05;
        for (int f = 0; f < FACES; f++) {
            double x[8][3], moved[8][3];
            int32_t name[4];
            bend_faces(&seed, shared, x, name);
            const double(*at)[3] = (const double(*)[3])x;
            const bool plainly = cross_plainly(at, first, name, gap);
            /* With a gap these directions are not all, and say too little of it. */
            if (lar_faces_cross(at, first, name, gap) > 0)
                assert_true(plainly);
            else
                assert_false(cross_plainly(at, first, name, 0));
            const double clearance = lar_faces_clearance(at, first, name, gap);
            crossing += plainly;
            known += clearance > 0;
            if (lar_faces_cross(at, first, name, gap) > 0) assert_true(clearance == 0);
            for (int w = 0; clearance > 0 && w < WAYS; w++) {
                const double part = chance(&seed),
                             max[2] = {part * clearance, (1 - part) * clearance};
                for (int k = 0; k < 8; k++) {
                    /* A node of both faces goes no farther than the shorter way. */
                    const bool both = (shared > 0 && k == 0) || (shared > 1 && k == 3);
                    const double far = both ? fmin(max[0], max[1]) : max[k / 4];
                    const double z = 2 * chance(&seed) - 1, turn = 6.2831853 * chance(&seed);
                    const double r = sqrt(1 - z * z);
                    const double way[3] = {r * cos(turn), r * sin(turn), z};
                    for (int i = 0; i < 3; i++) moved[k][i] = x[k][i] + far * way[i];
                }
                if (cross_plainly((const double(*)[3])moved, first, name, 0))
                    fail_msg("%d shared, face %d: they cross within a clearance of %g", shared, f,
                             clearance);
            }
        }
        if (!(crossing > FACES / 50 && known > FACES / 20))
            fail_msg("%d shared: %d cross, %d have a clearance", shared, crossing, known);
    }
}

/* A gap is asked of faces without a common node only. */
static void test_gap(void **state) {
    (void)state;
    const double above[4][3] = {{0, 0, 0.1}, {2, 0, 0.1}, {2, 2, 0.1}, {0, 2, 0.1}};
    const int32_t apart[4] = {4, 5, 6, 7}, joined[4] = {1, 5, 6, 2};
    assert_true(against(0, above, apart, 0) == 0);
    assert_true(against(0, above, apart, 0.09) == 0);
    assert_below(fabs(against(0, above, apart, 0.12) - 0.02), 1e-12);
    const double beside[4][3] = {{0}, {4, 0, 0.1}, {4, 2, 0.1}, {0}};
    assert_true(against(0, beside, joined, 0.5) == 0);
}

/* n x n faces in a plane, and one more that stands in their middle, through four of them and the
 * edges between them, or above. */
static void test_all_pairs(void **state) {
    (void)state;
    enum { N = 40, FACES = N * N + 1, NODES = (N + 1) * (N + 1) + 4 };
    double(*x)[3] = lar_calloc(NODES, sizeof *x);
    int32_t(*face)[4] = lar_calloc(FACES, sizeof *face);
    bool *crosses = lar_calloc(FACES, sizeof *crosses);
    assert_true(x && face && crosses);
    for (int n = 0; n < (N + 1) * (N + 1); n++) x[n][0] = n % (N + 1), x[n][1] = n / (N + 1);
    for (int f = 0; f < N * N; f++) {
        const int32_t n = f / N * (N + 1) + f % N;
        const int32_t node[4] = {n, n + 1, n + N + 2, n + N + 1};
        memcpy(face[f], node, sizeof node);
    }
    for (int k = 0; k < 4; k++) face[N * N][k] = (N + 1) * (N + 1) + k;
    for (int above = 0; above < 2; above++) {
        lar_face_crossings found;
        lar_error error = {0};
        const double at[4][3] = {
            {19.5, 20.4, -0.5}, {20.5, 19.6, -0.5}, {20.5, 19.6, 1}, {19.5, 20.4, 1}};
        memcpy(x + (N + 1) * (N + 1), at, sizeof at);
        for (int k = 0; above && k < 4; k++) x[(N + 1) * (N + 1) + k][2] += 1;
        lar_face_boxes boxes = {0};
        assert_int_equal(lar_face_boxes_create((const double(*)[3])x, (const int32_t(*)[4])face,
                                               FACES, &boxes, &error),
                         LAR_OK);
        assert_int_equal(lar_faces_find_crossings((const double(*)[3])x, (const int32_t(*)[4])face,
                                                  FACES, 0, above ? NULL : &boxes, crosses, &found,
                                                  &error),
                         LAR_OK);
        lar_face_boxes_clear(&boxes);
        int marked = 0;
        for (int f = 0; f < FACES; f++) marked += crosses[f];
        assert_int_equal(found.pairs, above ? 0 : 2);
        assert_int_equal(marked, above ? 0 : 3);
        assert_true((found.deepest > 0) == !above);
    }
    free(x);
    free(face);
    free(crosses);
}

/* Two cubes, the one pushed into the other: what a mesh's quality says. */
static void test_of_a_mesh(void **state) {
    (void)state;
    double x[16][3];
    int32_t element[2][8];
    for (int n = 0; n < 16; n++) {
        element[n / 8][n % 8] = n;
        for (int i = 0; i < 3; i++) x[n][i] = (lar_node_sign[n % 8][i] > 0) + (n / 8) * 1.01;
    }
    lar_mesh mesh = {.node_count = 16, .element_count = 2, .position = x, .element = element};
    lar_error error = {0};
    for (int inside = 0; inside < 2; inside++) {
        lar_mesh_quality quality = {0};
        for (int n = 8; n < 16; n++)
            for (int i = 0; inside && i < 3; i++) x[n][i] -= 0.26;
        if (lar_quality_measure(&mesh, NULL, &quality, &error)) fail_msg("%s", error.message);
        assert_int_equal(quality.crossings, inside ? 6 : 0);
        assert_below(fabs(quality.crossing_depth - (inside ? 0.25 : 0)), 1e-9);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs),     cmocka_unit_test(test_clearance),
        cmocka_unit_test(test_gap),       cmocka_unit_test(test_all_pairs),
        cmocka_unit_test(test_of_a_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
