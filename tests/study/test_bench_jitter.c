/* Ticks are counted and add up; their jitter is not tested. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/deadline_clock.h"
#include "study/bench/jitter.h"

static void check_percentiles(const lar_percentiles *p) {
    assert_true(p->p50 >= 0 && p->p50 <= p->p99 && p->p99 <= p->p999 && p->p999 <= p->max);
}

/* Ticks that are given up are not among them. */
static void every_tick_is_counted(void **unused) {
    (void)unused;
    lar_bench_jitter_result r;
    const lar_bench_jitter_options wanted = {.seconds = 0.05, .repeat = 3};
    assert_int_equal(lar_bench_jitter(&wanted, &r, NULL), LAR_OK);
    assert_true(r.ticks >= 3 && r.ticks <= 150);
    if (r.skipped == 0) assert_int_equal(r.ticks, 150);
    assert_true(r.misses <= r.ticks);
    assert_true(fabs(r.missed - (double)r.misses / (double)r.ticks) < 1e-12);
    assert_true(r.missed_of.min <= r.missed && r.missed <= r.missed_of.max);
    check_percentiles(&r.late);
    check_percentiles(&r.done);
    assert_true(r.done.max >= r.late.max);
    assert_true(r.period == 1000 && r.repeat == 3);
}

/* Of ticks that come many milliseconds late a histogram does not tell 0.1 ms, and other tests may
 * run beside this one: up to five times. */
static void computation_comes_on_top(void **unused) {
    (void)unused;
    lar_bench_jitter_result r = {0};
    const lar_bench_jitter_options wanted = {.seconds = 0.02, .repeat = 1, .load = 100};
    for (int i = 0; i < 5 && !(r.done.p50 > r.late.p50); i++) {
        assert_int_equal(lar_bench_jitter(&wanted, &r, NULL), LAR_OK);
        assert_true(r.done.p50 >= r.late.p50);
    }
    assert_true(r.done.p50 > r.late.p50);
}

/* More to compute than there is time for: every tick is a miss, and what cannot be made up for is
 * given up. */
static void too_much_is_always_missed(void **unused) {
    (void)unused;
    lar_bench_jitter_result r;
    const lar_bench_jitter_options wanted = {.seconds = 0.1, .repeat = 1, .load = 40000};
    assert_int_equal(lar_bench_jitter(&wanted, &r, NULL), LAR_OK);
    assert_int_equal(r.misses, r.ticks);
    assert_true(r.missed == 1);
}

static void a_priority_is_given_or_refused_with_a_sentence(void **unused) {
    (void)unused;
    lar_bench_jitter_result r;
    lar_error error;
    const lar_bench_jitter_options wanted = {.seconds = 0.01, .repeat = 1, .priority = 1};
    lar_status status = lar_bench_jitter(&wanted, &r, &error);
    if (!status) return;
    assert_int_equal(status, LAR_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.message, "ulimit -r"));
}

static void impossible_options_are_refused(void **unused) {
    (void)unused;
    static const lar_bench_jitter_options wrong[] = {
        {.seconds = 0, .repeat = 1},
        {.seconds = NAN, .repeat = 1},
        {.seconds = 3601, .repeat = 1},
        {.seconds = 0.01, .repeat = 0},
        {.seconds = 0.01, .repeat = LAR_BENCH_REPEAT_MAX + 1},
        {.seconds = 0.01, .repeat = 1, .load = -1},
        {.seconds = 0.01, .repeat = 1, .load = NAN},
        {.seconds = 0.01, .repeat = 1, .load = 2 * LAR_BENCH_JITTER_LOAD_MAX},
        {.seconds = 0.01, .repeat = 1, .priority = 100},
        {.seconds = 0.01, .repeat = 1, .priority = -1}};
    lar_bench_jitter_result r;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(lar_bench_jitter(&wrong[i], &r, NULL), LAR_ERROR_ARGUMENT);
}

/* The deadline clock itself, played without a clock; tests/session/test_pace.c has it with pauses
 * and pace.
 */
static void a_late_clock_makes_up_and_gives_up(void **unused) {
    (void)unused;
    enum { MS = 1000000 };
    lar_deadline_clock deadline = {.period = MS + 0.25};
    lar_deadline_clock_restart(&deadline, 5 * MS);
    for (int i = 0; i < 4; i++)
        assert_false(lar_deadline_clock_next(&deadline, deadline.due + MS / 2));
    assert_int_equal(deadline.due, 9 * MS + 1); /* four quarters of a nanosecond */
    assert_false(lar_deadline_clock_next(&deadline, deadline.due + MS));
    assert_true(lar_deadline_clock_next(&deadline, deadline.due + MS + 1));
    int64_t due = deadline.due;
    assert_int_equal(lar_deadline_clock_give_up(&deadline, due + 100 * MS), 0);
    assert_int_equal(deadline.due, due);
    assert_int_equal(lar_deadline_clock_give_up(&deadline, due + 103 * MS), 3 * MS);
    assert_int_equal(deadline.due, due + 3 * MS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_tick_is_counted),
        cmocka_unit_test(computation_comes_on_top),
        cmocka_unit_test(too_much_is_always_missed),
        cmocka_unit_test(a_priority_is_given_or_refused_with_a_sentence),
        cmocka_unit_test(impossible_options_are_refused),
        cmocka_unit_test(a_late_clock_makes_up_and_gives_up)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
