/* The kernels that move nodes: every instruction set against the formula of hex8_block.h, bit by
 * bit. */
#include "mechanics_test.h"

#include "mechanics/hex8_block.h"

enum { NODES = 32, TOGETHER = LAR_NODES_TOGETHER, STRIDE = NODES + TOGETHER, VALUES = 3 * STRIDE };

/* Value k is of node k % STRIDE; those behind the last node are of none. */
static bool is_moved(int k, int first, int end) {
    return k % STRIDE >= first && k % STRIDE < end;
}

typedef struct nodes {
    double u[VALUES] __attribute__((aligned(64)));
    double v[VALUES] __attribute__((aligned(64)));
    int64_t force[VALUES] __attribute__((aligned(64)));
    double push[NODES] __attribute__((aligned(64))), mass[NODES] __attribute__((aligned(64)));
} nodes;

/* Plain C twice where fma() may be an instruction or a call. */
extern const lar_kernels lar_kernels_c;
static const lar_kernels *kernels[5];
static int kernel_count;

static int find_kernels(void **state) {
    static const lar_isa wanted[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    (void)state;
    kernels[kernel_count++] = &lar_kernels_c;
    for (int i = 0; i < 4; i++)
        if (lar_kernels_find(wanted[i], &kernels[kernel_count], NULL) == LAR_OK)
            print_message("kernels: %s\n", kernels[kernel_count++]->name);
    return 0;
}

static const lar_leapfrog falling = {0.9998, 1e-4, 50, {0.1e-4, -0.3e-4, -9.81e-4}, 1};

static void make_nodes(uint64_t *seed, nodes *n) {
    memset(n, 0, sizeof *n);
    for (int k = 0; k < VALUES; k++) {
        n->u[k] = 0.01 * random_value(seed);
        n->v[k] = random_value(seed);
        n->force[k] = (int64_t)random_bits(seed) >> (4 + random_bits(seed) % 50);
    }
    for (int p = 0; p < NODES; p++) {
        n->push[p] = p % 7 == 3 ? 0 : 0x1p-62 * (1.5 + random_value(seed)); /* 0: a fixed node */
        n->mass[p] = 1e-3 * (1.5 + random_value(seed));
    }
}

static bool move(int k, const lar_leapfrog *leapfrog, int first, int end, nodes *n,
                 double *damped) {
    double fastest = 0;
    return kernels[k]->update(leapfrog, first, end, STRIDE, n->u, n->v, n->force, n->push,
                              damped ? n->mass : NULL, damped, &fastest);
}

/* The formula, written down once more. */
static double formula(const lar_leapfrog *leapfrog, int first, int end, nodes *n) {
    double damped = 0;
    for (int k = 0; k < VALUES; k++) {
        if (!is_moved(k, first, end)) continue;
        double before = n->v[k], after = fma(leapfrog->keep, before, leapfrog->drift[k / STRIDE]);
        after = fma(-(double)n->force[k], n->push[k % STRIDE], after);
        n->v[k] = after;
        n->u[k] = fma(leapfrog->dt, after, n->u[k]);
        n->force[k] = 0;
        damped += n->mass[k % STRIDE] * (before + after) * (before + after);
    }
    return damped;
}

/* Any range of nodes, with and without the damping sum: the bits of the formula inside, nothing
 * touched outside. */
static void same_bits_everywhere(void **state) {
    (void)state;
    static nodes start, expected, n;
    uint64_t seed = 61;
    double worst = 0;
    for (int round = 0; round < 300; round++) {
        int first = TOGETHER * ((int)(random_bits(&seed) >> 40) % (NODES / TOGETHER));
        int end =
            first + TOGETHER * ((int)(random_bits(&seed) >> 40) % ((NODES - first) / TOGETHER + 1));
        make_nodes(&seed, &start);
        expected = start;
        double exact = formula(&falling, first, end, &expected);
        for (int k = 0; k < kernel_count; k++)
            for (int sum = 0; sum < 2; sum++) {
                double damped = 3;
                n = start;
                assert_true(move(k, &falling, first, end, &n, sum ? &damped : NULL));
                assert_memory_equal(n.u, expected.u, sizeof n.u);
                assert_memory_equal(n.v, expected.v, sizeof n.v);
                assert_memory_equal(n.force, expected.force, sizeof n.force);
                if (sum)
                    worst = fmax(worst, fabs(damped - 3 - exact) / (3 + exact));
                else
                    assert_true(damped == 3);
            }
    }
    print_message("damping sums differ by %.1e at most\n", worst);
    assert_below(worst, 1e-14);
}

/* Gravity alone gives every node the same. */
static void free_fall(void **state) {
    (void)state;
    static nodes n;
    const lar_leapfrog fall = {1, 1e-3, 1e3, {0, 0, -9.81e-3}, 1};
    for (int k = 0; k < kernel_count; k++) {
        memset(&n, 0, sizeof n);
        for (int step = 0; step < 1000; step++) assert_true(move(k, &fall, 0, NODES, &n, NULL));
        for (int p = 0; p < NODES; p++) {
            assert_below(fabs(n.v[2 * STRIDE + p] + 9.81), 1e-11);
            assert_below(fabs(n.u[2 * STRIDE + p] + 9.81 * 0.5 * 1.001), 1e-11); /* n (n+1) / 2 */
            assert_true(n.u[p] == 0 && n.u[STRIDE + p] == 0);
            assert_true(n.v[p] == 0 && n.v[STRIDE + p] == 0);
        }
    }
}

static double kinetic(const nodes *n) {
    double sum = 0;
    for (int k = 0; k < VALUES; k++)
        if (is_moved(k, 0, NODES)) sum += 0.5 * n->mass[k % STRIDE] * n->v[k] * n->v[k];
    return sum;
}

/* m |v + v'|^2 is what damping takes: (1 - keep)/(1 + keep)/2 of it is the kinetic energy lost. */
static void damping_energy(void **state) {
    (void)state;
    static nodes n;
    const lar_leapfrog brake = {0.9, 1e-4, 1e3, {0}, 1};
    uint64_t seed = 62;
    for (int k = 0; k < kernel_count; k++) {
        double before = 0, after = 0, damped = 0;
        make_nodes(&seed, &n);
        memset(n.force, 0, sizeof n.force);
        before = kinetic(&n);
        assert_true(move(k, &brake, 0, NODES, &n, &damped));
        after = kinetic(&n);
        assert_below(fabs((before - after) / (0.5 * (1 - 0.9) / (1 + 0.9) * damped) - 1), 1e-13);
    }
}

/* The limit holds for every value of every node, in both directions, and for what is no number. */
static void speed_limit(void **state) {
    (void)state;
    static nodes n;
    const lar_leapfrog still = {1, 1e-4, 10, {0}, 1};
    const double bad[] = {10, -10, 10.5, -1e300, INFINITY, -INFINITY, NAN};
    const double good[] = {9.999999999, -9.999999999, 0};
    for (int k = 0; k < kernel_count; k++)
        for (int i = 0; i < VALUES; i++) {
            if (!is_moved(i, 0, NODES)) continue;
            for (int b = 0; b < 7; b++) {
                double damped = 0;
                memset(&n, 0, sizeof n);
                n.v[i] = bad[b];
                assert_false(move(k, &still, 0, NODES, &n, NULL));
                memset(&n, 0, sizeof n);
                n.v[i] = bad[b];
                assert_false(move(k, &still, 0, NODES, &n, &damped));
            }
            for (int g = 0; g < 3; g++) {
                memset(&n, 0, sizeof n);
                n.v[i] = good[g];
                assert_true(move(k, &still, 0, NODES, &n, NULL));
            }
        }
}

/* The largest velocity of all that were moved, and none that was not; what was there stays when it
 * is more. */
static void the_fastest_value(void **state) {
    (void)state;
    static nodes n;
    uint64_t seed = 64;
    const lar_leapfrog still = {1, 1e-4, 1e3, {0}, 1};
    for (int k = 0; k < kernel_count; k++)
        for (int i = 0; i < VALUES; i++) {
            make_nodes(&seed, &n);
            memset(n.force, 0, sizeof n.force);
            int first = TOGETHER, end = NODES - TOGETHER;
            bool moved = is_moved(i, first, end);
            double max = 0, fastest = 0, more = 1e6;
            n.v[i] = i % 2 ? 500 : -500;
            for (int j = 0; j < VALUES; j++)
                if (is_moved(j, first, end)) max = fmax(max, fabs(n.v[j]));
            assert_true(moved ? max == 500 : max < 500);
            kernels[k]->update(&still, first, end, STRIDE, n.u, n.v, n.force, n.push, NULL, NULL,
                               &fastest);
            assert_true(fastest == max);
            kernels[k]->update(&still, first, end, STRIDE, n.u, n.v, n.force, n.push, NULL, NULL,
                               &more);
            assert_true(more == 1e6);
        }
}

/* Force sums become doubles with one rounding, to nearest, halves to even, over the whole range. */
static void integers_to_doubles(void **state) {
    (void)state;
    static nodes n;
    static const int64_t special[] = {0,
                                      1,
                                      0x7fffffffLL,
                                      0x80000000LL,
                                      0xffffffffLL,
                                      0x100000000LL,
                                      (1LL << 53) - 1,
                                      (1LL << 53) + 1, /* half: down to even */
                                      (1LL << 53) + 3, /* half: up to even */
                                      (1LL << 54) + 2,
                                      (1LL << 54) + 3,
                                      (1LL << 54) + 6,
                                      (1LL << 60) + 128,
                                      (1LL << 60) + 129,
                                      (1LL << 60) + 384,
                                      0x7ffffffffffffdffLL,
                                      0x7ffffffffffffe00LL,
                                      INT64_MAX};
    enum { SPECIAL = sizeof special / sizeof special[0] };
    const lar_leapfrog as_is = {0, 1, INFINITY, {0}, 1};
    uint64_t seed = 63;
    for (int round = 0; round < 2000; round++) {
        int64_t values[VALUES];
        for (int i = 0; i < VALUES; i++) {
            int64_t value = special[(i + round) % SPECIAL];
            if (round >= 2 * SPECIAL)
                value = (int64_t)random_bits(&seed) >> (random_bits(&seed) % 63);
            values[i] = round % 2 ? -value : value;
            if (round == 2 * SPECIAL) values[i] = INT64_MIN;
        }
        for (int k = 0; k < kernel_count; k++) {
            memset(&n, 0, sizeof n);
            memcpy(n.force, values, sizeof values);
            for (int p = 0; p < NODES; p++) n.push[p] = -1;
            assert_true(move(k, &as_is, 0, NODES, &n, NULL));
            for (int i = 0; i < VALUES; i++) {
                if (!is_moved(i, 0, NODES)) continue;
                assert_true(n.u[i] == (double)values[i]);
                assert_true(n.force[i] == 0);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_bits_everywhere), cmocka_unit_test(free_fall),
        cmocka_unit_test(damping_energy),       cmocka_unit_test(speed_limit),
        cmocka_unit_test(the_fastest_value),    cmocka_unit_test(integers_to_doubles),
    };
    return cmocka_run_group_tests(tests, find_kernels, NULL);
}
