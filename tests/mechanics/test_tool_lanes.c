/* What tools do to four nodes beside each other, against the same one by one. */
#include "mechanics/tool_lanes.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/contact.h"
#include "mechanics/mechanics_test.h"

typedef struct one {
    int64_t force[3], torque[3], rest[3];
} one;

static void find_torques(const double arm[3], one *of) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double torque = -(arm[j] * (double)of->force[k] - arm[k] * (double)of->force[j]);
        of->torque[i] = of->rest[i] = 0;
        if (!(fabs(torque) < 0x1p56)) continue;
        of->torque[i] = (int64_t)floor(torque);
        of->rest[i] = llrint((torque - floor(torque)) / LAR_TORQUE_REST);
    }
}

static bool push_one(double scale, const double force[3][4], const double x[4][3],
                     const double tip[3], int a, one *of) {
    double arm[3];
    for (int i = 0; i < 3; i++) {
        if (!(fabs(force[i][a] * scale) < 0x1p56)) return false;
        of->force[i] = llrint(force[i][a] * scale);
        arm[i] = x[a][i] - tip[i];
    }
    find_torques(arm, of);
    return true;
}

static void rub_one(const lar_leapfrog *leapfrog, const lar_tool_rubs *r, int t, one *of) {
    double press[3], along[3], before[3], arm[3];
    for (int i = 0; i < 3; i++) {
        double ahead =
            leapfrog->keep * r->v[i][t] + leapfrog->drift[i] - r->unit[t] * r->force[i][t];
        before[i] = r->v[i][t] - r->velocity[i][t];
        along[i] = ahead - r->velocity[i][t];
        press[i] = r->press[i][t];
        arm[i] = r->arm[i][t];
    }
    double square = lar_dot(press, press), across = lar_dot(press, along) / square;
    for (int i = 0; i < 3; i++) along[i] -= press[i] * across;
    double part =
        lar_friction_part(r->unit[t] * sqrt(square), lar_dot(along, along), lar_dot(along, before));
    for (int i = 0; i < 3; i++) {
        double wanted = -part / r->unit[t] * along[i];
        of->force[i] = fabs(wanted) < 0x1p56 ? llrint(wanted) : 0;
    }
    find_torques(arm, of);
}

static void same(const lar_tool_pushes *pushes, int t, const one *of) {
    for (int i = 0; i < 3; i++) {
        assert_true((int64_t)pushes->force[i][t] == of->force[i]);
        assert_true((int64_t)pushes->torque[i][t] == of->torque[i]);
        assert_true((int64_t)pushes->rest[i][t] == of->rest[i]);
    }
}

#if defined(__x86_64__)
#define FOURS_HERE __builtin_cpu_supports("avx2")
#else
#define FOURS_HERE          false
#define lar_tool_push_fours lar_tool_push_pairs
#define lar_tool_rub_fours  lar_tool_rub_pairs
#endif

/* Of any size, from below a unit to beyond what sums take, small ones most often. */
static double any_size(uint64_t *random, double most) {
    return random_value(random) * exp2(most * random_value(random));
}

static void pushes_are_those_one_by_one(void **unused) {
    (void)unused;
    uint64_t random = 17;
    int beyond = 0;
    for (int n = 0; n < 200000; n++) {
        double force[3][4], x[4][3], tip[3];
        const double scale = exp2(n % 40), most = n % 50 == 0 ? 60 : 40 - n % 40;
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) {
                force[i][a] = any_size(&random, most);
                x[a][i] = any_size(&random, n % 100 == 1 ? 70 : 4);
                tip[i] = random_value(&random);
            }
        if (n % 7 == 0) force[n % 3][n % 4] = ((double[]){0, -0.0, 0.5, 1.5})[n % 4] / scale;
        if (n % 1001 == 0) force[n % 3][n % 4] = ((double[]){NAN, INFINITY, -INFINITY})[n % 3];
        one of[4];
        bool fit = true;
        for (int a = 0; a < 4; a++) fit &= push_one(scale, force, (rows)x, tip, a, &of[a]);
        for (int way = 0; way < 3; way++) {
            lar_tool_pushes pushes;
            if (way == 2 && !FOURS_HERE) continue;
            bool fits = (way == 0   ? lar_tool_push_lanes
                         : way == 1 ? lar_tool_push_pairs
                                    : lar_tool_push_fours)(scale, force, (rows)x, tip, &pushes);
            assert_true(fits == fit);
            for (int a = 0; a < 4 && fit; a++) same(&pushes, a, &of[a]);
        }
        beyond += !fit;
    }
    assert_true(beyond > 100 && beyond < 20000);
}

static void friction_is_that_one_by_one(void **unused) {
    (void)unused;
    uint64_t random = 18;
    int sticking = 0, sliding = 0;
    for (int n = 0; n < 200000; n++) {
        lar_tool_rubs rubs[2] = {0};
        lar_leapfrog leapfrog = {.keep = 1 - 0.1 * fabs(random_value(&random)), .push = 1};
        random_fill(&random, 1e-3, leapfrog.drift, 3);
        for (int t = 0; t < 8; t++) {
            lar_tool_rubs *r = &rubs[t / 4];
            r->unit[t % 4] = exp2(-36 + 4 * random_value(&random));
            for (int i = 0; i < 3; i++) {
                r->press[i][t % 4] = rint(any_size(&random, n % 30) * 1e9) + (i == 0);
                r->force[i][t % 4] = rint(any_size(&random, n % 30) * 1e9);
                r->v[i][t % 4] = any_size(&random, 10);
                r->velocity[i][t % 4] = n % 3 ? any_size(&random, 10) : 0;
                r->arm[i][t % 4] = any_size(&random, n % 100 ? 4 : 70);
            }
        }
        one of[8];
        for (int t = 0; t < 8; t++) rub_one(&leapfrog, &rubs[t / 4], t % 4, &of[t]);
        for (int way = 0; way < 3; way++) {
            lar_tool_rubs out[2];
            memcpy(out, rubs, sizeof out);
            if (way == 2 && !FOURS_HERE) continue;
            (way == 0   ? lar_tool_rub_lanes
             : way == 1 ? lar_tool_rub_pairs
                        : lar_tool_rub_fours)(&leapfrog, out, 2);
            for (int t = 0; t < 8; t++) same(&out[t / 4].friction, t % 4, &of[t]);
        }
        for (int t = 0; t < 8; t++) {
            double force[3], press[3];
            for (int i = 0; i < 3; i++) {
                force[i] = (double)of[t].force[i];
                press[i] = rubs[t / 4].press[i][t % 4];
            }
            bool slides = lar_length(force) > 0.999999 * lar_length(press);
            sliding += slides;
            sticking += !slides;
        }
    }
    assert_true(sticking > 10000 && sliding > 10000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pushes_are_those_one_by_one),
        cmocka_unit_test(friction_is_that_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
