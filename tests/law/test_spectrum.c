/* Functions of C = F^T F by its principal stretches, lane by lane: against what is known of them
 * without eigenvalues, where these are apart, two of them meet, and all three do. */
#include "law/kinematics.h"
#include "law/spectrum.h"
#include "mechanics/mechanics_test.h"

enum { STATES = 100000 };

static void product(const double A[6], const double B[6], double C[3][3]) {
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            C[i][j] = 0;
            for (int k = 0; k < 3; k++) C[i][j] += A[at[i][k]] * B[at[k][j]];
        }
}

/* R diag(stretch) Q with random rotations; what sets stretches apart goes down to nothing. */
static void random_state(uint64_t *seed, int n, double F[3][3]) {
    double R[3][3], Q[3][3], half[3][3], apart = exp(-40 * fabs(random_value(seed)));
    double stretch[3];
    for (int a = 0; a < 3; a++)
        stretch[a] = n % 4 == 0   ? exp(random_value(seed))
                     : n % 4 == 1 ? 1 + apart * random_value(seed)
                     : n % 4 == 2 ? (a == 0 ? exp(random_value(seed)) : 0.8)
                                  : (a ? 1.3 + a * apart : exp(random_value(seed)));
    random_rotation(seed, R);
    random_rotation(seed, Q);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) half[i][j] = R[i][j] * stretch[j];
    multiply((rows)half, (rows)Q, F);
}

/* C from its own values, and U = C^(1/2) by U U = C; |C| is at most some 20. */
static void functions_of_c(void **state) {
    (void)state;
    static const double one[6] = {1, 0, 0, 1, 0, 1};
    uint64_t seed = 31;
    double worst = 0, worst_root = 0, worst_product = 0;
    for (int n = 0; n < STATES; n++) {
        double F[3][3], C[3][3], U[6], same[6], root[3], back[3][3];
        lar_lane_spectrum s;
        random_state(&seed, n, F);
        const double *f = (const double *)F;
        double I1 = lar_lane_square_sum(f), J = determinant((rows)F);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                C[i][j] = f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j];
        lar_lane_spectrum_of(f, I1, &s);
        for (int a = 0; a < 3; a++) root[a] = sqrt(s.c[a]);
        lar_lane_spectral(&s, s.c, same);
        lar_lane_spectral(&s, root, U);
        product(same, one, back);
        worst = fmax(worst, largest_difference(&back[0][0], &C[0][0], 9) / I1);
        product(U, U, back);
        worst_root = fmax(worst_root, largest_difference(&back[0][0], &C[0][0], 9) / I1);
        worst_product =
            fmax(worst_product, fabs(s.c[0] * s.c[1] * s.c[2] - J * J) / (I1 * I1 * I1));
    }
    print_message("C %.1e, U U %.1e, product of the three %.1e\n", worst, worst_root,
                  worst_product);
    assert_below(worst, 3e-15);
    assert_below(worst_root, 3e-15);
    assert_below(worst_product, 1e-15);
}

static void a_rotation_gives_one(void **state) {
    (void)state;
    uint64_t seed = 32;
    for (int n = 0; n < STATES; n++) {
        double R[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, S[6], f[3];
        lar_lane_spectrum s;
        if (n) random_rotation(&seed, R);
        if (n % 3 == 1) R[0][1] += 1e-150 * n; /* a shear that squares to nothing */
        const double *r = (const double *)R;
        lar_lane_spectrum_of(r, lar_lane_square_sum(r), &s);
        for (int a = 0; a < 3; a++) {
            assert_below(fabs(s.c[a] - 1), 4e-15);
            f[a] = 1 / s.c[a];
        }
        lar_lane_spectral(&s, f, S);
        for (int k = 0; k < 6; k++) assert_below(fabs(S[k] - (k == 0 || k == 3 || k == 5)), 1e-14);
    }
}

/* For estimates: squares of the stretches from the three invariants. */
static void stretches_from_invariants(void **state) {
    (void)state;
    uint64_t seed = 33;
    for (int n = 0; n < STATES; n++) {
        double F[3][3], cof[9], c[3];
        lar_lane_spectrum s;
        random_state(&seed, n, F);
        const double *f = (const double *)F;
        double J = lar_lane_cofactor(f, cof), I1 = lar_lane_square_sum(f);
        lar_lane_spectrum_of(f, I1, &s);
        lar_lane_stretch_squares(I1, lar_lane_square_sum(cof), J, c);
        assert_below(c[1] - c[0], 1e-14 * I1);
        assert_below(c[2] - c[1], 1e-14 * I1);
        assert_true(c[2] > 0);
        double most = fmax(s.c[0], s.c[1]), least = fmin(s.c[0], s.c[2]);
        assert_below(fabs(c[0] - most), 1e-5 * I1);
        assert_below(fabs(c[2] - least), 1e-5 * I1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(functions_of_c),
        cmocka_unit_test(a_rotation_gives_one),
        cmocka_unit_test(stretches_from_invariants),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
