/* The grid of processors: places, distances, neighbours, and what it refuses. */
#include "brick_mesh.h"

static void place_and_inverse(void **state) {
    (void)state;
    lar_grid g = grid_of(2, 3, 4);
    assert_int_equal(g.count, 24);
    for (int32_t p = 0; p < g.count; p++) {
        int32_t c[3];
        lar_grid_place(&g, p, c);
        assert_int_equal(lar_grid_processor(&g, c), p);
    }
    int32_t c[3];
    lar_grid_place(&g, 1 + 2 * (2 + 3 * 3), c);
    assert_int_equal(c[0], 1);
    assert_int_equal(c[1], 2);
    assert_int_equal(c[2], 3);
    assert_int_equal(lar_grid_processor(&g, (int32_t[3]){2, 0, 0}), -1);
    assert_int_equal(lar_grid_processor(&g, (int32_t[3]){0, -1, 0}), -1);
}

/* Against the definitions, pair by pair. */
static void distances(void **state) {
    (void)state;
    lar_grid g = grid_of(3, 2, 4);
    int32_t greatest = 0;
    for (int32_t p = 0; p < g.count; p++)
        for (int32_t q = 0; q < g.count; q++) {
            int32_t sum = 0, along = 0, a[3], b[3];
            lar_grid_place(&g, p, a);
            lar_grid_place(&g, q, b);
            for (int axis = 0; axis < 3; axis++) {
                int32_t d = lar_grid_distance_along(&g, axis, p, q);
                assert_int_equal(d, abs(a[axis] - b[axis]));
                sum += d;
                along += lar_grid_neighbours_along(&g, axis, p, q);
            }
            assert_int_equal(lar_grid_distance(&g, p, q), sum);
            assert_int_equal(lar_grid_neighbours(&g, p, q), sum == 1);
            assert_int_equal(along, sum == 1);
            if (sum > greatest) greatest = sum;
        }
    assert_int_equal(lar_grid_diameter(&g), greatest);
}

static void spread_is_the_greatest_of_all_pairs(void **state) {
    (void)state;
    lar_grid g = grid_of(4, 4, 4);
    uint32_t seed = 7;
    for (int round = 0; round < 500; round++) {
        int32_t set[6], count = round % 7 < 6 ? round % 7 : 6, max[3] = {0};
        for (int i = 0; i < count; i++) set[i] = (int32_t)((seed = seed * 1664525 + 1) >> 26);
        for (int i = 0; i < count; i++)
            for (int j = 0; j < count; j++) {
                for (int axis = 0; axis < 3; axis++) {
                    int32_t d = lar_grid_distance_along(&g, axis, set[i], set[j]);
                    if (d > max[axis]) max[axis] = d;
                }
            }
        int32_t spread[3];
        lar_grid_spread_along(&g, set, count, spread);
        assert_memory_equal(spread, max, sizeof max);
    }
}

static void text(void **state) {
    (void)state;
    lar_grid g;
    char again[LAR_GRID_TEXT];
    assert_int_equal(lar_grid_parse("2x2x3", &g, NULL), LAR_OK);
    assert_int_equal(g.count, 12);
    lar_grid_format(&g, again);
    assert_string_equal(again, "2x2x3");
    static const char *const wrong[] = {"",
                                        "2",
                                        "2x2",
                                        "2x2x",
                                        "x2x2",
                                        "2x2x3x",
                                        "2x2x3x4",
                                        "2x2x-3",
                                        "0x2x2",
                                        "2 x2x2",
                                        "2X2X3",
                                        "2.0x1x1",
                                        "2x2x1025",
                                        "11x10x10",
                                        "2x2x3\n",
                                        "+2x2x2",
                                        "axbxc",
                                        "1024x2x1",
                                        "99999999999999999999x1x1"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lar_error error = {0};
        if (lar_grid_parse(wrong[i], &g, &error) != LAR_ERROR_ARGUMENT)
            fail_msg("'%s' was accepted", wrong[i]);
        assert_true(strlen(error.message) > 20);
    }
    assert_int_equal(g.count, 12);
    lar_error error;
    assert_int_equal(lar_grid_parse("1x65536x1", &g, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "65536")); /* all digits */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(place_and_inverse),
        cmocka_unit_test(distances),
        cmocka_unit_test(spread_is_the_greatest_of_all_pairs),
        cmocka_unit_test(text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
