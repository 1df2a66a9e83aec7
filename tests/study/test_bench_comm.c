/* The communication benchmark: every way is there, and its figures are possible. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "study/bench_comm.h"

static void figures_are_possible(void **state) {
    (void)state;
    static const char *const names[] = {"core to core", "by hand", "threads", "shm", "tcp"};
    lar_bench_comm_options options = {.bytes = 200, .repeat = 3};
    lar_bench_comm_result r;
    lar_error error;
    assert_int_equal(lar_bench_comm(&options, &r, &error), LAR_OK);
    size_t found = 0;
    for (int i = 0; i < r.rows; i++) {
        const lar_bench_comm_row *row = &r.row[i];
        if (row->missing) continue;
        assert_string_equal(row->name, names[found++]);
        assert_true(0 < row->latency.least && row->latency.least <= row->latency.median &&
                    row->latency.median <= row->latency.most);
        if (!row->moves_packets) continue;
        assert_true(row->half_duplex > 0 && row->full_duplex > 0);
        assert_true(row->send > 0 && row->receive > 0);
        assert_true(row->half_bandwidth_bytes >= 8 &&
                    row->half_bandwidth_bytes <= LAR_BENCH_COMM_BYTES_MOST);
    }
    assert_int_equal(found, sizeof names / sizeof names[0]);
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
                                       cmocka_unit_test(nonsense_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
