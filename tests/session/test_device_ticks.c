/* The coupling in ticks longer than 1 ms: a hand that is still feels the whole force, and no hand
 * gets more than the account has. */
#include "coupling_test.h"

static const double TICKS[] = {0.001, 0.002, 0.004, 0.005, 0.008, 0.0111, 0.0167, 0.033, 0.25};
enum { TICK_COUNT = sizeof TICKS / sizeof *TICKS };

static const lar_tool_info PROBE = {
    .name = "probe", .shape = LAR_TOOL_SPHERE, .radius = 0.005, .rest = {.orientation = {1}}};

/* From 0 to 1 without a jump, nor one of the speed. */
static double rise(double x) {
    x = fmin(1, x);
    return x * x * x * (10 - 15 * x + 6 * x * x);
}

/* ---- at rest --------------------------------------------------------------------------------- */

/* Lifts a weight by 5 cm within a second, and holds it. */
static void test_held_weight_is_felt(void **state) {
    (void)state;
    for (int i = 0; i < TICK_COUNT; i++) {
        const double t = TICKS[i], weights[] = {0.05, 0.265, 1, 2, 5};
        for (int k = 0; k < 5; k++) {
            world w = start_at(&PROBE, 0, 0, t);
            w.wall.weight = weights[k];
            int ticks = (int)(4 / t);
            for (int n = 1; n <= ticks; n++) tick(&w, 0, 0.05 * rise(n * t));
            if (fabs(w.felt.force[2] + weights[k]) > 1e-3 * weights[k])
                fail_msg("ticks of %g s: %.4f of %.4f N", t, -w.felt.force[2], weights[k]);
        }
    }
}

/* Presses on tissue, slowly and fast, deep and not, and rests; with what a steady hand trembles. */
static void test_held_press_is_felt(void **state) {
    (void)state;
    const double stiffness[] = {30, 300, 3000, 20000}, speed[] = {0.01, 0.05, 0.15, 0.3};
    for (int run = 0; run < TICK_COUNT * 4 * 4 * 2; run++) {
        const double t = TICKS[run % TICK_COUNT], v = speed[run / TICK_COUNT % 4];
        const bool trembles = run / TICK_COUNT / 16;
        world w = start_at(&PROBE, stiffness[run / TICK_COUNT / 4 % 4], 0.005, t);
        double z = 0.005, felt = 0, spring = 0;
        seed = (uint64_t)run;
        while (z > -0.004) tick(&w, 0, z = fmax(-0.004, z - v * t));
        for (int n = 0; n < 20 + 4 / t; n++) {
            tick(&w, 0, z + (trembles ? 1e-5 * (any() - 0.5) : 0));
            if (n < 10 + 2 / t) continue;
            felt += w.felt.force[2];
            spring -= w.coupling.spring[2];
        }
        if (!(felt > 0.97 * spring) || !(spring > 0))
            fail_msg("ticks of %g s, %g m/s: %.4f of %.4f is felt", t, v, felt, spring);
    }
}

/* A torque of the side, that no turn has paid for. */
static void test_held_torque_is_felt(void **state) {
    (void)state;
    for (int i = 0; i < TICK_COUNT; i++) {
        world w = start_at(&PROBE, 0, 0, TICKS[i]);
        const lar_tool_force tissue = {.torque = {0.1, 0, 0.15}};
        for (int n = 0; n < 50; n++) {
            lar_coupling_follow(&w.coupling, &w.hand, NULL, &w.tool);
            lar_coupling_feel(&w.coupling, &tissue, TICKS[i], &w.felt);
        }
        assert_true(fabs(w.felt.torque[0] - 0.1) < 1e-9 && fabs(w.felt.torque[2] - 0.15) < 1e-9);
    }
}

/* ---- energy ---------------------------------------------------------------------------------- */

static const double REFILL = 1e-3; /* of the account [W] */

/* Where a hand is at time t: jumps in the air and in tissue, noise, a saw, a tremble. */
static double wild_motion(int motion, double t) {
    double deep = -0.008 * fmin(1, t);
    if (motion == 0) return fmod(25 * t, 1) < 0.5 ? 0.05 : 0.08;
    if (motion == 1) return 0.05 + 0.01 * (any() - 0.5);
    if (t < 1) return deep;
    if (motion == 2) return deep - 0.004 * fmod(20 * t, 1);
    if (motion == 3) return deep + 0.0005 * sin(2 * M_PI * 37 * t);
    if (motion == 4) return deep + 0.01 * (any() - 0.5);
    return fmod(t, 1) < 0.7 ? deep : 0.002; /* rests, jumps off, comes back */
}

/* No motion gets more than the account has, but for one way that is longer than all before in its
 * direction. (Ticks of 1 ms: test_device_coupling.c.) */
static void test_no_motion_is_fed(void **state) {
    (void)state;
    enum { MOTIONS = 6, LONGER = TICK_COUNT - 1 };
    for (int run = 0; run < MOTIONS * LONGER; run++) {
        const double t = TICKS[1 + run % LONGER];
        const int motion = run / LONGER;
        seed = 7;
        world w = start_at(&PROBE, 300, wild_motion(motion, 0), t);
        double min = 0, credit = w.coupling.credit, farthest[2] = {0}, once = 0;
        for (int i = 1; i < 8 / t; i++) {
            double z = wild_motion(motion, i * t), way = z - w.hand.position[2];
            double *far = &farthest[way > 0];
            if (fabs(way) > *far) once = fmax(once, w.felt.force[2] * way);
            *far = fmax(*far, fabs(way));
            tick(&w, 0, z);
            min = fmin(min, w.hand_work + REFILL * t * i);
        }
        if (min < -1.25 * credit - once)
            fail_msg("ticks of %g s, motion %d: gets %.3g J, %.3g J at once", t, motion, -min,
                     once);
    }
}

/* A hand that changes its speed by 1.5 m/s^2 at most, at 90 Hz, against soft walls and hard ones:
 * no more than the credit, and what the largest force does on the way of one such change. */
static void test_smooth_hand_at_90_hz(void **state) {
    (void)state;
    const double t = 0.0111, strength = 1.5;
    double min = 0;
    for (int run = 0; run < 200; run++) {
        seed = (uint64_t)run + 1;
        world w = start_at(&PROBE, pow(10, 2 + 3 * any()), 0.01, t);
        double v = 0, to = 0;
        for (int i = 0; i < 1000; i++) {
            if (any() < 0.2) to = 0.04 * (any() - 0.6);
            double wanted = fmax(-0.2, fmin(0.2, 5 * (to - w.hand.position[2])));
            v += fmax(-strength * t, fmin(strength * t, wanted - v));
            tick(&w, 0, w.hand.position[2] + v * t);
            min = fmin(min, w.hand_work);
        }
    }
    printf("least energy of a smooth hand at 90 Hz %.3g J\n", min);
    assert_true(min >= -(5e-4 + 8 * strength * t * t));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_held_weight_is_felt),  cmocka_unit_test(test_held_press_is_felt),
        cmocka_unit_test(test_held_torque_is_felt),  cmocka_unit_test(test_no_motion_is_fed),
        cmocka_unit_test(test_smooth_hand_at_90_hz),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
