/* Percentiles of step times: exact where values are small, to a bin's width elsewhere. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/histogram.h"

static lar_histogram *empty(void) {
    lar_histogram *histogram = calloc(1, sizeof *histogram);
    assert_non_null(histogram);
    return histogram;
}

static void nothing_added_is_zero(void **state) {
    (void)state;
    lar_histogram *h = empty();
    assert_true(lar_histogram_quantile(h, 0.5) == 0);
    free(h);
}

static void small_values_are_exact(void **state) {
    (void)state;
    lar_histogram *h = empty();
    for (uint64_t i = 1; i <= 60; i++) lar_histogram_add(h, i);
    assert_true(lar_histogram_quantile(h, 0) == 1);
    assert_true(lar_histogram_quantile(h, 0.5) == 30);
    assert_true(lar_histogram_quantile(h, 0.9) == 54);
    assert_true(lar_histogram_quantile(h, 1) == 60);
    assert_int_equal(h->count, 60);
    assert_int_equal(h->sum, 60 * 61 / 2);
    free(h);
}

/* Two bins per octave from 2^10 on: [1, 1.5) and [1.5, 2) times its beginning. */
static void halves_of_octaves_are_counted(void **state) {
    (void)state;
    static const uint64_t value[] = {3, 1000, 1024, 1535, 1536, 2047, 2048, 5000, 1u << 20};
    static const int at[] = {0, 0, 0, 0, 1, 1, 2, 4, 9};
    uint32_t out[10], wanted[10] = {0};
    lar_histogram *h = empty();
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
        lar_histogram_add(h, value[i]);
        wanted[at[i]]++;
    }
    lar_histogram_halves(h, 10, 10, out);
    assert_memory_equal(out, wanted, sizeof out);
    free(h);
}

static void two_become_one(void **state) {
    (void)state;
    lar_histogram *a = empty(), *b = empty(), *both = empty(), *nothing = empty();
    for (uint64_t i = 1; i <= 500; i++) {
        lar_histogram_add(i % 3 ? a : b, 17 * i);
        lar_histogram_add(both, 17 * i);
    }
    lar_histogram_merge(a, nothing);
    lar_histogram_merge(a, b);
    lar_histogram_merge(nothing, both);
    assert_memory_equal(a, both, sizeof *a);
    assert_memory_equal(nothing, both, sizeof *a);
    free(a);
    free(b);
    free(both);
    free(nothing);
}

static void every_size_is_known_to_a_bin(void **state) {
    (void)state;
    for (double value = 70; value < 1e12; value *= 1.37) {
        lar_histogram *h = empty();
        for (int i = 0; i < 3; i++) lar_histogram_add(h, (uint64_t)(value / 100));
        for (int i = 0; i < 3; i++) lar_histogram_add(h, (uint64_t)value);
        for (int i = 0; i < 3; i++) lar_histogram_add(h, (uint64_t)(value * 100));
        double median = lar_histogram_quantile(h, 0.5);
        assert_true(fabs(median - floor(value)) <= value / 64);
        assert_true(lar_histogram_quantile(h, 1) <= floor(value * 100));
        free(h);
    }
}

static void tails_are_found(void **state) {
    (void)state;
    lar_histogram *h = empty();
    for (int i = 0; i < 9989; i++) lar_histogram_add(h, 20000);
    for (int i = 0; i < 10; i++) lar_histogram_add(h, 500000);
    lar_histogram_add(h, 7000000);
    assert_true(fabs(lar_histogram_quantile(h, 0.5) - 20000) < 400);
    assert_true(fabs(lar_histogram_quantile(h, 0.998) - 20000) < 400);
    assert_true(fabs(lar_histogram_quantile(h, 0.9995) - 500000) < 8000);
    assert_true(h->max == 7000000 && h->min == 20000);
    free(h);
}

static void values_beyond_the_last_bin_are_counted(void **state) {
    (void)state;
    lar_histogram *h = empty();
    lar_histogram_add(h, UINT64_MAX);
    lar_histogram_add(h, 0);
    assert_int_equal(h->count, 2);
    assert_true(lar_histogram_quantile(h, 0.1) == 0);
    assert_true(lar_histogram_quantile(h, 1) > 1e12);
    free(h);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_added_is_zero),
                                       cmocka_unit_test(small_values_are_exact),
                                       cmocka_unit_test(halves_of_octaves_are_counted),
                                       cmocka_unit_test(two_become_one),
                                       cmocka_unit_test(every_size_is_known_to_a_bin),
                                       cmocka_unit_test(tails_are_found),
                                       cmocka_unit_test(values_beyond_the_last_bin_are_counted)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
