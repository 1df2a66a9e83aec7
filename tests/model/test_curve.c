/* Curves: ramps and the shapes of tables, at points, between them and outside. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "model/curve.h"

static double three[3][2] = {{1.0, 2.0}, {2.0, 6.0}, {4.0, -2.0}};

static lar_curve table(lar_curve_shape shape) {
    return (lar_curve){.kind = LAR_CURVE_TABLE, .shape = shape, .count = 3, .point = three};
}

static void expect(const lar_curve *curve, double time, double value) {
    assert_true(lar_curve_value(curve, time) == value);
}

static void test_ramp(void **state) {
    (void)state;
    lar_curve ramp = {.kind = LAR_CURVE_RAMP, .over = 0.5};
    expect(&ramp, -1.0, 0.0);
    expect(&ramp, 0.0, 0.0);
    expect(&ramp, 0.125, 0.15625); /* 3/16 - 2/64 */
    expect(&ramp, 0.25, 0.5);
    expect(&ramp, 0.5, 1.0);
    expect(&ramp, 9.0, 1.0);
    assert_true(lar_curve_end(&ramp) == 0.5);
    lar_curve sudden = {.kind = LAR_CURVE_RAMP};
    expect(&sudden, 0.0, 1.0);
    assert_true(lar_curve_end(&sudden) == 0.0);
}

static void test_table_is_held_outside(void **state) {
    (void)state;
    const lar_curve_shape shapes[] = {LAR_CURVE_LINEAR, LAR_CURVE_STEP, LAR_CURVE_SMOOTH,
                                      LAR_CURVE_HOLD, LAR_CURVE_SPLINE};
    for (int i = 0; i < 5; i++) {
        lar_curve curve = table(shapes[i]);
        expect(&curve, 0.0, 2.0);
        expect(&curve, 1.0, 2.0);
        expect(&curve, 4.0, -2.0);
        expect(&curve, 5.0, -2.0);
        assert_true(lar_curve_end(&curve) == 4.0);
    }
}

static void test_a_table_repeats(void **state) {
    (void)state;
    lar_curve curve = table(LAR_CURVE_LINEAR), breath;
    curve.repeats = true;
    expect(&curve, 0.0, 2.0);
    expect(&curve, 1.5, 4.0);
    expect(&curve, 4.0, 2.0); /* the first point again */
    expect(&curve, 4.5, 4.0);
    expect(&curve, 1.5 + 3e6, 4.0);
    assert_true(lar_curve_end(&curve) == 4.0);
    static double round[3][2] = {{0, 0}, {0.25, 1}, {1, 0}};
    breath = (lar_curve){.kind = LAR_CURVE_TABLE,
                         .shape = LAR_CURVE_HOLD,
                         .repeats = true,
                         .count = 3,
                         .point = round};
    expect(&breath, 7.25, 1.0);
    expect(&breath, 7.125, 0.0);
    expect(&breath, 8.0, 0.0);
}

static void test_shapes(void **state) {
    (void)state;
    lar_curve linear = table(LAR_CURVE_LINEAR), next = table(LAR_CURVE_STEP);
    lar_curve smooth = table(LAR_CURVE_SMOOTH), hold = table(LAR_CURVE_HOLD);
    expect(&linear, 1.5, 4.0);
    expect(&linear, 2.0, 6.0);
    expect(&linear, 3.0, 2.0);
    expect(&next, 1.5, 6.0);
    expect(&next, 2.0, -2.0);
    expect(&next, 3.0, -2.0);
    expect(&hold, 1.5, 2.0);
    expect(&hold, 2.0, 6.0);
    expect(&hold, 3.999, 6.0);
    expect(&smooth, 1.25, 2.0 + 4.0 * 0.15625);
    expect(&smooth, 1.5, 4.0);
    expect(&smooth, 2.0, 6.0);
}

static void test_odd_tables(void **state) {
    (void)state;
    double jump[4][2] = {{0.0, 0.0}, {1.0, 1.0}, {1.0, 5.0}, {2.0, 5.0}};
    lar_curve curve = {.kind = LAR_CURVE_TABLE, .count = 4, .point = jump};
    expect(&curve, 0.5, 0.5);
    expect(&curve, 1.0, 5.0);
    expect(&curve, 1.5, 5.0);
    curve.count = 1;
    expect(&curve, 7.0, 0.0);
    curve.count = 0;
    expect(&curve, 7.0, 1.0);
    assert_true(lar_curve_end(&curve) == 0.0);
}

static void test_values_have_fixed_bits(void **state) {
    (void)state;
    lar_curve ramp = {.kind = LAR_CURVE_RAMP, .over = 0.3};
    expect(&ramp, 0.1, 0x1.097b425ed097cp-2); /* 7/27 in IEEE arithmetic, operation by operation */
}

static void test_hold_from(void **state) {
    (void)state;
    const lar_curve_shape shapes[] = {LAR_CURVE_LINEAR, LAR_CURVE_STEP, LAR_CURVE_HOLD};
    const double times[] = {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 7; k++) {
            double points[3][2] = {{1.0, 2.0}, {2.0, 6.0}, {4.0, -2.0}};
            lar_curve whole = table(shapes[i]), held = whole;
            held.point = points;
            lar_curve_hold_from(&held, times[k]);
            assert_true(lar_curve_end(&held) <= times[k]);
            for (double t = 0; t < times[k]; t += 0.25)
                expect(&held, t, lar_curve_value(&whole, t));
            expect(&held, times[k], lar_curve_value(&whole, times[k]));
            expect(&held, 20.0, lar_curve_value(&whole, times[k]));
        }
}

/* Without a kink, never beyond its points, straight where they are, round and round where it
 * repeats. */
static void test_splines(void **state) {
    (void)state;
    static double key[6][2] = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {3.5, 0.5}, {5, 0}};
    lar_curve curve = {
        .kind = LAR_CURVE_TABLE, .shape = LAR_CURVE_SPLINE, .count = 6, .point = key};
    for (int i = 0; i < 6; i++) expect(&curve, key[i][0], key[i][1]);
    expect(&curve, 1.25, 1.25);
    expect(&curve, 1.5, 1.5);
    for (int repeats = 0; repeats < 2; repeats++) {
        curve.repeats = repeats;
        const double h = 1e-4, far = repeats ? 11 : 6;
        double before = lar_curve_value(&curve, h) - lar_curve_value(&curve, 0);
        for (double t = h; t < far; t += h) {
            double value = lar_curve_value(&curve, t),
                   step = lar_curve_value(&curve, t + h) - value;
            assert_true(value >= -1e-15 && value <= 3.0 + 1e-15);
            assert_true(step - before < 100 * h * h && before - step < 100 * h * h);
            before = step;
        }
    }
}

/* Whatever a step is, the means over all steps keep the impulse of a short pulse; what is slower
 * has its values. */
static void test_means_keep_impulses(void **state) {
    (void)state;
    static double pulses[][3][2] = {
        {{0.5, 0}, {0.5, 1}, {0.52, 0}}, /* a jump that decays */
        {{0.5, 0}, {0.51, 1}, {0.52, 0}},
        {{0.501, 0}, {0.5011, 1}, {0.503, 0}},
    };
    static const double area[] = {0.01, 0.01, 0.001};
    for (int k = 0; k < 3; k++)
        for (double dt = 1e-4; dt < 0.1; dt *= 1.37) {
            lar_curve curve = {.kind = LAR_CURVE_TABLE, .count = 3, .point = pulses[k]};
            double sum = 0.5 * dt * lar_curve_mean(&curve, 0, dt);
            for (int n = 1; n * dt < 0.7; n++) sum += dt * lar_curve_mean(&curve, n * dt, dt);
            assert_true(fabs(sum / area[k] - 1) < (dt > 0.002 ? 1e-12 : 0.06));
        }
    static double train[][2] = {{0, 1}, {0.001, 1}, {0.001, 0}, {0.01, 0}}; /* again and again */
    for (double dt = 7e-5; dt < 2; dt *= 1.37) {
        const lar_curve curve = {
            .kind = LAR_CURVE_TABLE, .repeats = true, .count = 4, .point = train};
        double sum = 0.5 * dt * lar_curve_mean(&curve, 0, dt), end = 0.5 * dt;
        for (int n = 1; end < 5; n++, end += dt) sum += dt * lar_curve_mean(&curve, n * dt, dt);
        const double whole = floor(end / 0.01), left = fmin(end - 0.01 * whole, 0.001);
        assert_true(fabs(sum - (0.001 * whole + left)) < (dt > 0.64 ? 2e-3 : 1e-9));
    }
    static double slow[][2] = {{0, 0}, {0.3, 1}, {0.5, -2}};
    const lar_curve curve = {.kind = LAR_CURVE_TABLE, .count = 3, .point = slow};
    for (double t = 0; t < 0.6; t += 0.01)
        assert_true(lar_curve_mean(&curve, t, 0.01) == lar_curve_value(&curve, t));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_table_is_held_outside),
        cmocka_unit_test(test_a_table_repeats),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_splines),
        cmocka_unit_test(test_odd_tables),
        cmocka_unit_test(test_hold_from),
        cmocka_unit_test(test_means_keep_impulses),
        cmocka_unit_test(test_values_have_fixed_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
