/* A sparse matrix of blocks, laid out, factorised and solved, against the same one kept dense. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshing/starter/elastic_factor.h"

enum { MAX = 40, ROWS = MAX * LAR_FACTOR_BLOCK };

typedef struct problem {
    int32_t count, place[MAX];
    int32_t pair[8 * MAX][2];
    size_t pairs;
    double dense[ROWS][ROWS]; /* by columns of the factor */
    lar_factor factor;
    lar_error error;
} problem;

/* -1 .. 1, the same on every machine. */
static double any(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / (1 << 23) - 1;
}

static void know(problem *p, int32_t a, int32_t b) {
    p->pair[p->pairs][0] = a;
    p->pair[p->pairs++][1] = b;
}

static void lay(problem *p) {
    bool taken[MAX] = {false};
    assert_int_equal(lar_factor_lay(p->count, (const int32_t(*)[2])p->pair, p->pairs, p->place,
                                    &p->factor, &p->error),
                     LAR_OK);
    for (int32_t i = 0; i < p->count; i++) {
        assert_in_range(p->place[i], 0, p->count - 1);
        assert_false(taken[p->place[i]]);
        taken[p->place[i]] = true;
    }
}

static void put(problem *p, int32_t row, int32_t column, int i, int k, double value) {
    const int32_t r = row * LAR_FACTOR_BLOCK + i, c = column * LAR_FACTOR_BLOCK + k;
    if (row < column || (row == column && i < k)) return;
    (*lar_factor_at(&p->factor, row, column))[i][k] += value;
    p->dense[r][c] += value;
    if (r != c) p->dense[c][r] += value;
}

/* Each pair is held together by springs v v^T, each unknown to the ground by some stiffness. */
static void fill(problem *p, uint32_t seed, double ground) {
    for (size_t s = 0; s < p->pairs; s++)
        for (int spring = 0; spring < LAR_FACTOR_BLOCK; spring++) {
            double v[2][LAR_FACTOR_BLOCK];
            const int32_t at[2] = {p->place[p->pair[s][0]], p->place[p->pair[s][1]]};
            for (int e = 0; e < 2; e++)
                for (int i = 0; i < LAR_FACTOR_BLOCK; i++) v[e][i] = any(&seed);
            for (int e = 0; e < 2; e++)
                for (int f = 0; f < 2; f++)
                    for (int i = 0; i < LAR_FACTOR_BLOCK; i++)
                        for (int k = 0; k < LAR_FACTOR_BLOCK; k++)
                            put(p, at[e], at[f], i, k, v[e][i] * v[f][k]);
        }
    for (int32_t n = 0; n < p->count; n++)
        for (int i = 0; i < LAR_FACTOR_BLOCK; i++) put(p, n, n, i, i, ground);
}

/* The largest that is left of the loads. */
static double solve(problem *p) {
    static lar_pair x[ROWS], f[ROWS];
    uint32_t seed = 5;
    double max = 0;
    const int32_t rows = p->count * LAR_FACTOR_BLOCK;
    for (int32_t r = 0; r < rows; r++)
        for (int l = 0; l < 2; l++) x[r][l] = f[r][l] = any(&seed);
    lar_factor_solve(&p->factor, x);
    for (int32_t r = 0; r < rows; r++)
        for (int l = 0; l < 2; l++) {
            double left = f[r][l];
            for (int32_t c = 0; c < rows; c++) left -= p->dense[r][c] * x[c][l];
            max = fmax(max, fabs(left));
        }
    return max;
}

static void check(problem *p, uint32_t seed) {
    lay(p);
    fill(p, seed, 0.3);
    assert_int_equal(lar_factor_compute(&p->factor, &p->error), LAR_OK);
    assert_true(solve(p) < 1e-10);
    lar_factor_clear(&p->factor);
}

static void it_solves_what_a_dense_matrix_says(void **state) {
    (void)state;
    for (uint32_t seed = 1; seed < 8; seed++) {
        static problem p;
        memset(&p, 0, sizeof p);
        p.count = MAX;
        uint32_t next = seed;
        for (int k = 0; k < 3 * MAX; k++) {
            int32_t a = (int32_t)((any(&next) + 1) / 2 * MAX);
            int32_t b = (int32_t)((any(&next) + 1) / 2 * MAX);
            if (a != b) know(&p, a, b); /* some twice, some in both directions */
        }
        check(&p, seed);
    }
}

static void a_star_and_a_chain_stay_as_sparse_as_they_are(void **state) {
    (void)state;
    static problem p;
    for (int star = 0; star < 2; star++) {
        memset(&p, 0, sizeof p);
        p.count = MAX;
        /* In their own order the hub, first, would make all others know each other. */
        for (int32_t i = 1; i < MAX; i++) know(&p, star ? 0 : i - 1, i);
        lay(&p);
        assert_int_equal(p.factor.start[MAX], 2 * MAX - 1);
        lar_factor_clear(&p.factor);
        check(&p, 3);
    }
}

static void pieces_and_single_ones_are_solved_each_for_itself(void **state) {
    (void)state;
    static problem p;
    memset(&p, 0, sizeof p);
    p.count = 9;
    know(&p, 8, 0), know(&p, 0, 3), know(&p, 3, 8), know(&p, 2, 7);
    check(&p, 11);
    memset(&p, 0, sizeof p);
    p.count = 1;
    check(&p, 12);
    memset(&p, 0, sizeof p);
    lay(&p);
    assert_int_equal(lar_factor_compute(&p.factor, &p.error), LAR_OK);
    lar_factor_solve(&p.factor, NULL);
    lar_factor_clear(&p.factor);
}

/* A number that follows from another one has no stiffness of its own. */
static void what_depends_on_others_is_left_out(void **state) {
    (void)state;
    static lar_pair x[2 * LAR_FACTOR_BLOCK];
    static problem p;
    memset(&p, 0, sizeof p);
    p.count = 2;
    know(&p, 0, 1);
    lay(&p);
    for (int n = 0; n < 2; n++)
        for (int i = 0; i < LAR_FACTOR_BLOCK - 1; i++) put(&p, n, n, i, i, 2);
    put(&p, 1, 0, 2, 1, 2); /* 2 of column 1 is 1 of column 0 again */
    assert_int_equal(lar_factor_compute(&p.factor, &p.error), LAR_OK);
    for (int r = 0; r < 2 * LAR_FACTOR_BLOCK; r++)
        for (int l = 0; l < 2; l++) x[r][l] = 1;
    lar_factor_solve(&p.factor, x);
    for (int r = 0; r < 2 * LAR_FACTOR_BLOCK; r++)
        for (int l = 0; l < 2; l++) {
            const bool left_out =
                r % LAR_FACTOR_BLOCK == LAR_FACTOR_BLOCK - 1 || r == LAR_FACTOR_BLOCK + 2;
            assert_true(fabs(x[r][l] - (left_out ? 0 : 0.5)) < 1e-12);
        }
    lar_factor_clear(&p.factor);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_solves_what_a_dense_matrix_says),
        cmocka_unit_test(a_star_and_a_chain_stay_as_sparse_as_they_are),
        cmocka_unit_test(pieces_and_single_ones_are_solved_each_for_itself),
        cmocka_unit_test(what_depends_on_others_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
