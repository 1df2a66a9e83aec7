/* The precision study computes what it says: double is production, mixed stays near it, and single
 * precision loses what docs/precision.md says it loses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "simulation/simulation.h"
#include "study/precision/precision.h"
#include "study/precision/precision_cases.h"
#include "study/precision/single.h"
#include "study/precision/single_domain.h"

static lar_precision_result compare(lar_precision_case what, uint64_t steps, lar_isa isa) {
    const lar_precision_options options = {
        .what = what, .elements = 60, .steps = steps, .isa = isa};
    lar_precision_result result;
    lar_error error;
    if (lar_precision_compare(&options, &result, &error)) fail_msg("%s", error.message);
    for (int w = 0; w < LAR_PRECISION_COUNT; w++) assert_true(result.way[w].went);
    return result;
}

static void double_is_production(void **state) {
    (void)state;
    lar_precision_result r = compare(LAR_CASE_VIBRATION, 400, LAR_ISA_C);
    assert_true(r.way[LAR_PRECISION_DOUBLE].difference_max == 0);
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_options options = lar_options_default();
    lar_error error;
    options.isa = LAR_ISA_C;
    assert_int_equal(lar_precision_block(LAR_CASE_VIBRATION, 60, 1, &model, &error), LAR_OK);
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    lar_precision_start(LAR_CASE_VIBRATION, simulation);
    assert_int_equal(lar_simulation_advance(simulation, 400, &error), LAR_OK);
    assert_true(r.way[LAR_PRECISION_DOUBLE].hash == lar_simulation_hash(simulation));
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void mixed_stays_near(void **state) {
    (void)state;
    static const lar_precision_case all[] = {LAR_CASE_VIBRATION, LAR_CASE_REST,  LAR_CASE_PATH,
                                             LAR_CASE_TURN,      LAR_CASE_CREEP, LAR_CASE_FAR};
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        lar_precision_result r = compare(all[k], 2000, LAR_ISA_C);
        const lar_precision_way *mixed = &r.way[LAR_PRECISION_MIXED];
        assert_true(mixed->difference_max < 1e-4);
        assert_true(mixed->difference_max > 0);
        assert_true(fabs(mixed->drift) < 1e-4);
    }
}

/* Increments below half a unit in the last place of one metre: nothing moves any more. */
static void single_stands_still_far_away(void **state) {
    (void)state;
    lar_precision_result r = compare(LAR_CASE_FAR, 2000, LAR_ISA_C);
    assert_true(r.way[LAR_PRECISION_SINGLE].difference > 0.5);
    assert_true(r.way[LAR_PRECISION_MIXED].difference < 1e-4);
    r = compare(LAR_CASE_CREEP, 2000, LAR_ISA_C);
    assert_true(r.way[LAR_PRECISION_SINGLE].difference < 1e-3);
}

/* A state of floats is made of floats. */
static void single_state_is_float(void **state) {
    (void)state;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_single_domain adopted;
    lar_options options = lar_options_default();
    lar_error error;
    options.isa = LAR_ISA_C;
    assert_int_equal(lar_precision_block(LAR_CASE_TURN, 60, 1, &model, &error), LAR_OK);
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    assert_int_equal(lar_single_adopt(&simulation->domain, true, &adopted, &error), LAR_OK);
    lar_precision_start(LAR_CASE_TURN, simulation);
    assert_int_equal(lar_simulation_advance(simulation, 50, &error), LAR_OK);
    for (size_t k = 0; k < 3 * simulation->state.stride; k++) {
        assert_true(simulation->state.u[k] == (float)simulation->state.u[k]);
        assert_true(simulation->state.v[k] == (float)simulation->state.v[k]);
    }
    lar_simulation_destroy(simulation);
    lar_single_release(&adopted);
    lar_model_destroy(model);
}

/* One lane or sixteen: the same bits, as with double. */
static void instruction_sets_agree(void **state) {
    (void)state;
    const lar_kernels *kernels;
    lar_error error;
    if (!lar_single_kernels_find("avx512", false) ||
        lar_kernels_find(LAR_ISA_AVX512, &kernels, &error))
        skip();
    static const lar_precision_case all[] = {LAR_CASE_VIBRATION, LAR_CASE_TURN};
    for (size_t k = 0; k < 2; k++) {
        lar_precision_result c = compare(all[k], 300, LAR_ISA_C);
        lar_precision_result wide = compare(all[k], 300, LAR_ISA_AVX512);
        for (int w = 0; w < LAR_PRECISION_COUNT; w++)
            assert_true(c.way[w].hash == wide.way[w].hash);
    }
}

static void all_ways_bear_the_same_step(void **state) {
    (void)state;
    const lar_precision_options options = {.elements = 8, .steps = 300, .isa = LAR_ISA_C};
    double ratio[LAR_PRECISION_COUNT];
    lar_error error;
    assert_int_equal(lar_precision_stable(&options, ratio, &error), LAR_OK);
    assert_true(ratio[LAR_PRECISION_DOUBLE] >= 1);
    for (int w = 0; w < LAR_PRECISION_COUNT; w++)
        assert_true(fabs(ratio[w] / ratio[LAR_PRECISION_DOUBLE] - 1) < 0.01);
}

static void what_cannot_be_is_refused(void **state) {
    (void)state;
    lar_precision_options options = {.elements = 60, .steps = 5};
    lar_precision_result result;
    lar_error error;
    assert_int_equal(lar_precision_compare(&options, &result, &error), LAR_ERROR_ARGUMENT);
    options = (lar_precision_options){.what = LAR_CASE_MODEL, .steps = 100};
    assert_int_equal(lar_precision_compare(&options, &result, &error), LAR_ERROR_ARGUMENT);
    const lar_kernels *kernels;
    options = (lar_precision_options){.elements = 60, .steps = 100, .isa = LAR_ISA_AVX2};
    if (lar_kernels_find(LAR_ISA_AVX2, &kernels, &error)) return;
    assert_int_equal(lar_precision_compare(&options, &result, &error), LAR_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.message, "--isa"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(double_is_production),
        cmocka_unit_test(mixed_stays_near),
        cmocka_unit_test(single_stands_still_far_away),
        cmocka_unit_test(single_state_is_float),
        cmocka_unit_test(instruction_sets_agree),
        cmocka_unit_test(all_ways_bear_the_same_step),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
