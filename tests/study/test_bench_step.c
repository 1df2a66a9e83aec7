/* Timed steps are those of a run: how long they take is not tested. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "model/model.h"
#include "study/bench/scaling.h"
#include "study/bench/step.h"

static uint64_t hash_of_run(const lar_model *model, uint64_t steps) {
    lar_simulation *simulation = NULL;
    assert_int_equal(lar_simulation_create(model, NULL, &simulation, NULL), LAR_OK);
    assert_int_equal(lar_simulation_advance(simulation, steps, NULL), LAR_OK);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static void check_shape(const lar_bench_step_result *r) {
    const lar_spread *s = &r->microseconds;
    assert_int_equal(r->timed, r->steps * (uint64_t)r->repeat);
    assert_true(s->min > 0 && s->min <= s->p25 && s->p25 <= s->median);
    assert_true(s->median <= s->p75 && s->p75 <= s->p95 && s->p95 <= s->max);
    assert_true(r->p50 > 0 && r->p50 <= r->p99 && r->p99 <= r->p999 && r->p999 <= r->longest);
    assert_true(r->mean > 0 && r->mean <= r->longest);
}

static void samples_do_the_steps_of_a_run(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_bench_step_result r;
    assert_int_equal(lar_bench_scaling_block(27, &model, NULL), LAR_OK);
    const uint64_t steps[] = {1, 7, 100}, warm_up[] = {0, 3, UINT64_MAX};
    for (int i = 0; i < 3; i++) {
        const lar_bench_step_options wanted = {
            .model = model, .steps = steps[i], .warm_up = warm_up[i], .repeat = 1 + 2 * i};
        assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_OK);
        assert_int_equal(r.steps, steps[i]);
        assert_int_equal(r.warm_up, i < 2 ? warm_up[i] : 20);
        assert_int_equal(r.repeat, 1 + 2 * i);
        assert_true(r.hash == hash_of_run(model, r.warm_up + r.steps));
        assert_true(r.info.elements == 27 && r.time_step > 0);
        check_shape(&r);
    }
    lar_model_destroy(model);
}

static void a_number_of_steps_is_found(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_bench_step_result r;
    assert_int_equal(lar_bench_scaling_block(1, &model, NULL), LAR_OK);
    const lar_bench_step_options wanted = {.model = model, .warm_up = UINT64_MAX, .repeat = 1};
    assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_OK);
    uint64_t digits = r.steps;
    while (digits % 10 == 0) digits /= 10;
    assert_true(digits == 1 || digits == 2 || digits == 5);
    assert_int_equal(r.warm_up, (r.steps + 4) / 5);
    check_shape(&r);
    lar_model_destroy(model);
}

/* Advances end where a run writes frames, be there more of them than steps or one in the end. The
 * demonstration organ, whose scene has some, is in tests/cli/bench.sh. */
static void frames_change_no_step(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_bench_step_result r;
    assert_int_equal(lar_bench_scaling_block(8, &model, NULL), LAR_OK);
    const lar_bench_step_options wanted = {.model = model, .steps = 60, .warm_up = 5, .repeat = 1};
    const uint64_t hash = hash_of_run(model, 65);
    assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_OK);
    const double steps[] = {1e-9, 0.3, 1, 1.5, 7.3, 64.9, 65, 1e9, 1e300};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        model->output.every = steps[i] * r.time_step;
        assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_OK);
        assert_true(r.hash == hash);
        check_shape(&r);
    }
    lar_model_destroy(model);
}

static void impossible_options_are_refused(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_bench_step_result r;
    assert_int_equal(lar_bench_scaling_block(1, &model, NULL), LAR_OK);
    lar_bench_step_options wanted = {.model = model, .steps = 1, .repeat = 0};
    assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_ERROR_ARGUMENT);
    wanted.repeat = LAR_BENCH_REPEAT_MAX + 1;
    assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_ERROR_ARGUMENT);
    wanted.repeat = 1;
    wanted.steps = LAR_BENCH_STEP_STEPS_MAX + 1;
    assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_ERROR_ARGUMENT);
    wanted.steps = 1;
    wanted.warm_up = LAR_BENCH_STEP_STEPS_MAX + 1;
    assert_int_equal(lar_bench_step(&wanted, &r, NULL), LAR_ERROR_ARGUMENT);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(samples_do_the_steps_of_a_run),
                                       cmocka_unit_test(a_number_of_steps_is_found),
                                       cmocka_unit_test(frames_change_no_step),
                                       cmocka_unit_test(impossible_options_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
