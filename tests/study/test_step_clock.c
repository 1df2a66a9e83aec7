/* Measured and paced steps: nothing changes in the run, every step is counted. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "study/bench/kernel.h"
#include "study/bench/step_clock.h"

typedef struct fixture {
    lar_model *model;
    lar_simulation *simulation;
    lar_step_clock clock;
} fixture;

static int set_up(void **state) {
    static const int32_t edge[3] = {4, 4, 4};
    fixture *f = calloc(1, sizeof *f);
    if (!f || lar_bench_block(edge, true, &f->model, NULL) ||
        lar_simulation_create(f->model, NULL, &f->simulation, NULL))
        return -1;
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    lar_simulation_destroy(f->simulation);
    lar_model_destroy(f->model);
    free(f);
    return 0;
}

static void every_step_is_measured(void **state) {
    fixture *f = *state;
    lar_error error;
    lar_step_clock_start(&f->clock, f->simulation, false);
    assert_int_equal(lar_step_clock_advance(&f->clock, f->simulation, 100, NULL, NULL, &error),
                     LAR_OK);
    assert_int_equal(lar_simulation_steps(f->simulation), 100);
    assert_int_equal(f->clock.times.count, 100);
    assert_int_equal(f->clock.misses, 0);
    double busy = lar_step_clock_busy(&f->clock);
    assert_true(busy > 0 && busy <= lar_step_clock_elapsed(&f->clock) + 1e-6);
    assert_true(lar_step_clock_quantile(&f->clock, 0.5) <= lar_step_clock_longest(&f->clock));
}

static void steps_are_those_of_an_unmeasured_run(void **state) {
    fixture *f = *state;
    lar_simulation *other = NULL;
    assert_int_equal(lar_simulation_create(f->model, NULL, &other, NULL), LAR_OK);
    lar_step_clock_start(&f->clock, f->simulation, false);
    lar_step_clock_advance(&f->clock, f->simulation, 50, NULL, NULL, NULL);
    lar_simulation_advance(other, 50, NULL);
    assert_true(lar_simulation_hash(other) == lar_simulation_hash(f->simulation));
    lar_simulation_destroy(other);
}

static bool look_three_times(void *context) {
    int *looks = context;
    return ++*looks < 3;
}

static void it_returns_when_asked(void **state) {
    fixture *f = *state;
    volatile sig_atomic_t stop = 1;
    lar_step_clock_start(&f->clock, f->simulation, false);
    assert_int_equal(lar_step_clock_advance(&f->clock, f->simulation, 1000, NULL, &stop, NULL),
                     LAR_OK);
    assert_int_equal(lar_simulation_steps(f->simulation), 0);
    int looks = 0;
    const lar_step_glance glance = {0.001, look_three_times, &looks};
    assert_int_equal(
        lar_step_clock_advance(&f->clock, f->simulation, 1000000000, &glance, NULL, NULL), LAR_OK);
    assert_int_equal(looks, 3);
    assert_true(lar_simulation_steps(f->simulation) > 0);
    assert_true(lar_simulation_steps(f->simulation) < 1000000000);
}

static void a_paced_run_takes_its_time(void **state) {
    fixture *f = *state;
    lar_step_clock_start(&f->clock, f->simulation, true);
    lar_step_clock_advance(&f->clock, f->simulation, 200, NULL, NULL, NULL);
    double elapsed = lar_step_clock_elapsed(&f->clock);
    double simulated = lar_simulation_time(f->simulation);
    assert_true(elapsed >= simulated - 1e-6);
    assert_true(f->clock.misses <= 200);
}

/* A tick that lies in the past is missed, by every step until the run has caught up. */
static void late_steps_are_misses(void **state) {
    fixture *f = *state;
    lar_step_clock_start(&f->clock, f->simulation, true);
    f->clock.start -= 3600;
    lar_step_clock_advance(&f->clock, f->simulation, 20, NULL, NULL, NULL);
    assert_int_equal(f->clock.misses, 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_step_is_measured, set_up, tear_down),
        cmocka_unit_test_setup_teardown(steps_are_those_of_an_unmeasured_run, set_up, tear_down),
        cmocka_unit_test_setup_teardown(it_returns_when_asked, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_paced_run_takes_its_time, set_up, tear_down),
        cmocka_unit_test_setup_teardown(late_steps_are_misses, set_up, tear_down)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
