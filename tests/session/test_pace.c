/* The clock of a session: when ticks are due, what is late, what is given up, and what it comes
 * to. Time is played. */
#include "base/clock.h"
#include "session/pace.h"
#include "testing.h"

enum { MS = 1000000 }; /* [ns] */

static lar_pace pace;
static int64_t now;

static void begin_with(double wanted) {
    pace = (lar_pace){.pace = wanted};
    now = 1000 * MS;
    lar_pace_start(&pace, now);
}

/* A tick of `seconds` whose steps take `engine` ns: begins when it is due, or at once. */
static void tick(double seconds, int64_t engine) {
    if (pace.pace > 0 && now < pace.deadline.due) now = pace.deadline.due;
    lar_pace_begin(&pace, seconds, now);
    now += engine;
    lar_pace_computed(&pace, 10, engine, engine);
    lar_pace_answered(&pace, now);
}

static lar_session_status report(void) {
    lar_session_status status = {0};
    lar_pace_report(&pace, true, now, &status);
    return status;
}

static void near(double value, double wanted, double share) {
    assert_below(fabs(value - wanted), share * wanted);
}

static void ticks_come_when_they_are_due(void **unused) {
    (void)unused;
    begin_with(0.5);
    lar_pace_start(&pace, now + 7); /* once is enough */
    for (int i = 0; i < 200; i++) {
        assert_int_equal(pace.deadline.due, (1000 + 4 * i) * MS);
        tick(0.002, 200000);
    }
    lar_pace_stop(&pace, now);
    lar_session_status status = report();
    assert_int_equal(status.ticks, 200);
    assert_int_equal(status.misses, 0);
    near(status.real_time_factor, 0.5, 1e-12);
    near(status.step_p50, 2e-5, 0.02);
    near(status.tick_p99, 2e-4, 0.02);
    assert_true(status.tick_max == 2e-4);
    /* All of them in the bin that they lie in, by its edges. */
    for (int i = 0; i < LAR_TIME_BINS; i++) {
        assert_int_equal(status.step_bins[i],
                         lar_time_bin(i) <= 2e-5 && 2e-5 < lar_time_bin(i + 1) ? 200 : 0);
        assert_int_equal(status.tick_bins[i],
                         lar_time_bin(i) <= 2e-4 && 2e-4 < lar_time_bin(i + 1) ? 200 : 0);
    }
}

static void waiting_ends_when_a_tick_is_due(void **unused) {
    (void)unused;
    begin_with(1);
    pace.deadline.due = lar_clock_ns() + 3 * MS;
    lar_pace_wait(&pace);
    assert_true(lar_clock_ns() >= pace.deadline.due);
    pace.pace = 0;
    pace.deadline.due = lar_clock_ns() + (int64_t)3600000 * MS;
    lar_pace_wait(&pace);
}

/* 3 ticks per 10 us of the clock are 300,000 a second. */
static void fractions_are_not_lost(void **unused) {
    (void)unused;
    begin_with(3);
    int64_t first = pace.deadline.due;
    for (int i = 0; i < 300000; i++) tick(1e-5, 1000);
    assert_below(fabs((double)(pace.deadline.due - first - 1000 * MS)), 2);
}

static void late_ticks_are_misses(void **unused) {
    (void)unused;
    begin_with(1);
    tick(0.001, 1000000); /* just in time */
    assert_int_equal(report().misses, 0);
    tick(0.001, 10 * MS);
    assert_int_equal(report().misses, 1);
    near(report().lag, 0.009, 1e-9);
    for (int i = 0; i < 20; i++) tick(0.001, 100000); /* catches up */
    assert_int_equal(report().misses, 10);
    assert_true(report().lag == 0);
    assert_true(report().skipped == 0);
    assert_false(report().slow_motion);
}

/* Twice too slow: what is late from then on nobody could have kept, and times are those of a tick.
 */
static void late_in_slow_motion_is_no_miss(void **unused) {
    (void)unused;
    begin_with(1);
    for (int i = 0; i < 3000; i++) tick(0.001, 2 * MS);
    lar_session_status status = report();
    assert_true(status.slow_motion);
    assert_int_equal(status.misses, 0);
    assert_int_equal(status.slow_ticks, 3000);
    near(status.tick_p50, 0.002, 0.02);
    for (int i = 0; i < 2000; i++) tick(0.001, 100000); /* catches up, and is punctual again */
    assert_false(report().slow_motion);
    tick(0.001, 5 * MS);
    assert_int_equal(report().misses, 1);
    /* A miss that was made up for stays one, whatever comes behind it. */
    for (int i = 0; i < 100; i++) tick(0.001, 100000);
    uint64_t missed = report().misses;
    tick(0.001, 200 * MS);
    tick(0.001, 100000);
    assert_true(report().slow_motion);
    assert_int_equal(report().misses, missed);
}

/* What a step takes when nothing is in its way: the least of the last second, of a processor. */
static void the_least_step_of_the_last_second_is_known(void **unused) {
    (void)unused;
    begin_with(1);
    assert_true(report().step_min == 0);
    for (int i = 0; i < 30; i++) {
        if (now < pace.deadline.due) now = pace.deadline.due;
        lar_pace_begin(&pace, 0.1, now);
        lar_pace_computed(&pace, 10, 90 * MS, (i == 5 ? 1 : i == 25 ? 3 : 4) * MS);
        now += 90 * MS;
        lar_pace_answered(&pace, now);
        lar_pace_look(&pace, now);
    }
    near(report().step_min, 3e-4, 1e-9);
    lar_pace_forget_min(&pace);
    assert_true(report().step_min == 0);
}

static void too_much_is_given_up(void **unused) {
    (void)unused;
    begin_with(1);
    tick(0.001, 151 * MS);
    tick(0.001, 0);
    lar_session_status status = report();
    near(status.skipped, 0.05, 1e-9);
    assert_true(status.slow_motion);
    near(status.lag, 0.099, 1e-9);
    for (int i = 0; i < 1000; i++) tick(0.001, 2 * MS); /* half as fast as asked for */
    status = report();
    assert_true(status.slow_motion);
    near(status.skipped, 0.05 + 0.998, 0.01);
    assert_below(status.lag, 0.101 + 1e-9); /* of the next tick */
    assert_below(status.real_time_factor, 0.5);
    for (int i = 0; i < 1200; i++) tick(0.001, 100000);
    assert_false(report().slow_motion);
}

static void pauses_do_not_count(void **unused) {
    (void)unused;
    begin_with(1);
    for (int i = 0; i < 3; i++) {
        lar_pace_start(&pace, now);
        tick(0.010, 100000);
        lar_pace_stop(&pace, now);
        lar_pace_stop(&pace, now + 50 * MS);
        assert_true(report().lag == 0);
        now += 500 * MS;
    }
    near(report().real_time_factor, 1, 1e-9);
    lar_pace_start(&pace, now);
    tick(0.010, 100000);
    now += 300 * MS; /* a state was loaded */
    lar_pace_restart(&pace, now);
    assert_true(report().lag == 0);
    tick(0.010, 100000);
    lar_pace_stop(&pace, now);
    near(report().real_time_factor, 1, 1e-9);
    assert_true(report().skipped == 0);
}

static void without_pace_nothing_is_due(void **unused) {
    (void)unused;
    begin_with(0);
    for (int i = 0; i < 100; i++) tick(1, 20 * MS);
    lar_pace_stop(&pace, now);
    lar_session_status status = report();
    assert_int_equal(status.misses, 0);
    assert_true(status.lag == 0 && status.skipped == 0);
    near(status.real_time_factor, 50, 1e-9);
    near(status.tick_p50, 0.02, 0.02);
    lar_pace_set(&pace, 1, now);
    lar_pace_start(&pace, now);
    tick(1, MS);
    assert_int_equal(pace.deadline.due, now - MS + 1000 * MS);
}

/* A pace holds from now on, also in the middle of a tick that would have lasted longer; and no pace
 * is so slow that its ticks are beyond all numbers. */
static void another_pace_holds_at_once(void **unused) {
    (void)unused;
    begin_with(0.001);
    tick(0.001, MS);
    assert_int_equal(pace.deadline.due, 2000 * MS);
    lar_pace_set(&pace, 1, now);
    assert_int_equal(pace.deadline.due, now + 999000);
    lar_pace_set(&pace, 0.5, now);
    assert_int_equal(pace.deadline.due, now + 2 * 999000);
    lar_pace_set(&pace, 1e-300, now);
    assert_true(pace.deadline.due > now && pace.deadline.due < INT64_MAX / 2);
    tick(0.001, MS);
    assert_true(pace.deadline.due > now && pace.deadline.due < INT64_MAX / 2);
}

static void rates_are_of_the_last_second(void **unused) {
    (void)unused;
    begin_with(1);
    assert_true(lar_pace_look(&pace, now));
    assert_false(lar_pace_look(&pace, now + 99 * MS));
    assert_true(report().engine_rate == 0);
    for (int i = 0; i < 30; i++) {
        now += 100 * MS;
        pace.total.steps += i < 19 ? 5 : 100;
        pace.total.exchanges += 50;
        pace.total.snapshots += 3;
        pace.total.simulated += 0.05;
        assert_true(lar_pace_look(&pace, now));
    }
    lar_session_status status = report();
    near(status.engine_rate, 1000, 1e-9);
    near(status.haptic_rate, 500, 1e-9);
    near(status.snapshot_rate, 30, 1e-9);
    near(status.real_time_factor_now, 0.5, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ticks_come_when_they_are_due),
                                       cmocka_unit_test(waiting_ends_when_a_tick_is_due),
                                       cmocka_unit_test(fractions_are_not_lost),
                                       cmocka_unit_test(late_ticks_are_misses),
                                       cmocka_unit_test(late_in_slow_motion_is_no_miss),
                                       cmocka_unit_test(the_least_step_of_the_last_second_is_known),
                                       cmocka_unit_test(too_much_is_given_up),
                                       cmocka_unit_test(pauses_do_not_count),
                                       cmocka_unit_test(without_pace_nothing_is_due),
                                       cmocka_unit_test(another_pace_holds_at_once),
                                       cmocka_unit_test(rates_are_of_the_last_second)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
