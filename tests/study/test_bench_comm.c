/* The communication benchmark: every way is there, and its figures are possible. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "comm/comm.h"
#include "study/bench/comm.h"

static void check_figures(const lar_bench_comm_figures *at, double portion) {
    assert_true(at->latency > 0);
    assert_true(at->half_duplex > 0 && at->full_duplex > 0);
    assert_true(at->send > 0 && at->receive > 0);
    /* What else runs on the machine may make a difference of two times negative. */
    double delay = at->slowdown * portion - at->delay;
    assert_true(delay < 1e-3 && delay > -1e-3);
}

static void figures_are_possible(void **state) {
    (void)state;
    lar_bench_comm_options options = {.bytes = 200, .repeat = 3, .quick = true};
    lar_bench_comm_result r;
    lar_error error;
    assert_int_equal(lar_bench_comm(&options, &r, &error), LAR_OK);
    assert_int_equal(r.sizes, 3);
    assert_true(r.size[0] == 8 && r.size[1] == 200 && r.size[2] == 16384 && r.asked == 1);
    assert_true(r.portion > 0);
    assert_string_equal(r.row[0].name, "core to core");
    assert_string_equal(r.row[1].name, "by hand");
    assert_true(r.row[1].over_hand == 1); /* itself */
    for (int i = 0; i < r.rows; i++) {
        const lar_bench_comm_row *row = &r.row[i];
        lar_comm_backend_info info;
        if (i >= 2) {
            assert_true(lar_comm_backend_list(i - 2, &info));
            assert_string_equal(row->name, info.name);
            assert_int_equal(row->missing == NULL,
                             !info.missing && info.start != LAR_COMM_BY_LAUNCHER);
        }
        if (row->missing) continue;
        assert_true(0 < row->latency.min && row->latency.min <= row->latency.median &&
                    row->latency.median <= row->latency.max);
        assert_int_equal(row->moves_packets, i > 0);
        if (!row->moves_packets) continue;
        assert_true(row->over_hand > 0);
        assert_true(row->half_bandwidth_bytes >= 8 &&
                    row->half_bandwidth_bytes <= LAR_BENCH_COMM_BYTES_MAX);
        for (int size = 0; size < r.sizes; size++) check_figures(&row->at[size], r.portion);
        assert_true(row->at[1].latency == row->latency.median);
    }
}

static void only_some_are_measured(void **state) {
    (void)state;
    lar_bench_comm_options options = {
        .bytes = 8, .repeat = 1, .quick = true, .backends = "shm,threads"};
    lar_bench_comm_result r;
    lar_error error;
    assert_int_equal(lar_bench_comm(&options, &r, &error), LAR_OK);
    assert_int_equal(r.rows, 4);
    assert_string_equal(r.row[2].name, "threads");
    assert_string_equal(r.row[3].name, "shm");
    assert_int_equal(r.sizes, 2);
    options.backends = "shm,thread";
    assert_int_equal(lar_bench_comm(&options, &r, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "no communication backend thread;"));
    options.backends = "";
    assert_int_equal(lar_bench_comm(&options, &r, &error), LAR_ERROR_ARGUMENT);
}

static void nonsense_is_refused(void **state) {
    (void)state;
    lar_bench_comm_options options = {.bytes = 0, .repeat = 3};
    lar_bench_comm_result r;
    assert_int_equal(lar_bench_comm(&options, &r, NULL), LAR_ERROR_ARGUMENT);
    options.bytes = 8;
    options.repeat = 0;
    assert_int_equal(lar_bench_comm(&options, &r, NULL), LAR_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(figures_are_possible),
                                       cmocka_unit_test(only_some_are_measured),
                                       cmocka_unit_test(nonsense_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
