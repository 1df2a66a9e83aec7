/* The element of stiffness matrices: its products are the forces of the eight-point element, and
 * at rest it is the linear stiffness matrix. */
#include "mechanics_test.h"

#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"

static const double size = 0.01; /* m */

static double characteristic_force(const lar_material *material) {
    return layer_modulus(material) * size * size;
}

/* Random deformations from tiny to very strong, every law: the same forces and det F. */
static void agrees_with_direct_calculation(void **state) {
    (void)state;
    uint64_t seed = 31;
    double worst = 0;
    int strong = 0;
    for (int n = 0; n < 300; n++) {
        lar_material material = test_material(n % LAR_LAW_COUNT, 4e3, n % 2 ? 2e6 : 2e4);
        double corner[8][3], u[8][3], direct[8][3], product[8][3];
        random_corners(&seed, size, 0.2, corner);
        double amount = pow(10, -8 + 8.0 * n / 300) * size;
        double J;
        do {
            random_fill(&seed, amount, &u[0][0], 24);
            J = lar_hex8_full_force((rows)corner, &material, (rows)u, direct);
            amount *= 0.9;
        } while (!(J > 0.05));
        double same = lar_hex8_matrix_force((rows)corner, &material, (rows)u, product);
        assert_below(fabs(J - same), 1e-13);
        double scale = largest(&direct[0][0], 24), tiny = 1e-3 * characteristic_force(&material);
        double error = largest_difference(&direct[0][0], &product[0][0], 24);
        worst = fmax(worst, error / fmax(scale, tiny));
        strong += J < 0.6;
    }
    print_message("worst relative difference to direct calculation %.1e\n", worst);
    assert_below(worst, 2e-12);
    assert_true(strong > 10);
}

/* Turned by any angle and then deformed: E has no trace of the rotation, K u must cancel it. */
static void agrees_when_turned(void **state) {
    (void)state;
    uint64_t seed = 32;
    const double none[3] = {0};
    for (int n = 0; n < 60; n++) {
        lar_material material = test_material(n % LAR_LAW_COUNT, 4e3, 2e6);
        double corner[8][3], R[3][3], u[8][3], extra[8][3], direct[8][3], product[8][3];
        double scale = characteristic_force(&material);
        random_corners(&seed, size, 0.2, corner);
        random_rotation(&seed, R);
        affine((rows)R, none, 8, (rows)corner, u);
        lar_hex8_matrix_force((rows)corner, &material, (rows)u, product);
        assert_below(largest(&product[0][0], 24), 1e-12 * scale);
        random_fill(&seed, 0.05 * size, &extra[0][0], 24);
        for (int k = 0; k < 24; k++) u[k / 3][k % 3] += extra[k / 3][k % 3];
        lar_hex8_full_force((rows)corner, &material, (rows)u, direct);
        lar_hex8_matrix_force((rows)corner, &material, (rows)u, product);
        assert_below(largest_difference(&direct[0][0], &product[0][0], 24),
                     1e-12 * (scale + largest(&direct[0][0], 24)));
    }
}

/* At rest K is symmetric and the slope of the force; six motions of a rigid body give nothing. */
static void linear_at_rest(void **state) {
    (void)state;
    static const double none[8][3];
    uint64_t seed = 33;
    for (int n = 0; n < 12; n++) {
        lar_material material = test_material(n % LAR_LAW_COUNT, 4e3, 2e5);
        double corner[8][3], K[24][24], scale = layer_modulus(&material) * size;
        random_corners(&seed, size, 0.2, corner);
        assert_below(fabs(lar_hex8_matrix_build((rows)corner, &material, none, K) - 1), 1e-15);
        for (int m = 0; m < 24; m++) {
            const double step = 1e-6 * size;
            double u[8][3] = {{0}}, above[8][3], below[8][3];
            u[m / 3][m % 3] = step;
            lar_hex8_full_force((rows)corner, &material, (rows)u, above);
            u[m / 3][m % 3] = -step;
            lar_hex8_full_force((rows)corner, &material, (rows)u, below);
            for (int k = 0; k < 24; k++) {
                double slope = (above[k / 3][k % 3] - below[k / 3][k % 3]) / (2 * step);
                assert_below(fabs(K[k][m] - slope), 1e-8 * scale);
                assert_below(fabs(K[k][m] - K[m][k]), 1e-14 * scale);
            }
        }
        for (int k = 0; k < 24; k++) {
            double spin[3] = {0};
            for (int i = 0; i < 3; i++) {
                int j = (i + 1) % 3;
                double shift = 0;
                for (int a = 0; a < 8; a++) {
                    shift += K[k][3 * a + i];
                    spin[i] += K[k][3 * a + j] * corner[a][i] - K[k][3 * a + i] * corner[a][j];
                }
                assert_below(fabs(shift), 1e-13 * scale);
                assert_below(fabs(spin[i]), 1e-13 * scale * size);
            }
        }
    }
}

/* The forces are the slope of the energy. */
static void force_is_energy_slope(void **state) {
    (void)state;
    uint64_t seed = 34;
    for (int n = 0; n < 12; n++) {
        lar_material material = test_material(n % LAR_LAW_COUNT, 1000, 5000);
        double corner[8][3], u[8][3], force[8][3];
        random_corners(&seed, size, 0.2, corner);
        random_fill(&seed, 0.08 * size, &u[0][0], 24);
        lar_hex8_matrix_force((rows)corner, &material, (rows)u, force);
        for (int k = 0; k < 24; k++) {
            const double step = 1e-5 * size;
            double kept = u[k / 3][k % 3];
            u[k / 3][k % 3] = kept + step;
            double above = lar_hex8_full_energy((rows)corner, &material, (rows)u);
            u[k / 3][k % 3] = kept - step;
            double slope =
                (above - lar_hex8_full_energy((rows)corner, &material, (rows)u)) / (2 * step);
            u[k / 3][k % 3] = kept;
            assert_below(fabs(slope - force[k / 3][k % 3]), 1e-7 * characteristic_force(&material));
        }
    }
}

/* Affine deformation of a distorted element: constant stress, and the virtual work of every
 * affine motion is that of V P. */
static void affine_forces(void **state) {
    (void)state;
    uint64_t seed = 35;
    const double none[3] = {0};
    for (int n = 0; n < 30; n++) {
        lar_material material = test_material(n % LAR_LAW_COUNT, 4e3, 2e5);
        double corner[8][3], F[3][3], P[3][3], u[8][3], force[8][3], cauchy[6], exact[6];
        random_corners(&seed, size, 0.2, corner);
        random_deformation(&seed, 0.3, F);
        double J = lar_law_stress(&material, (rows)F, P);
        affine((rows)F, none, 8, (rows)corner, u);
        assert_below(fabs(lar_hex8_matrix_force((rows)corner, &material, (rows)u, force) - J),
                     1e-12);
        double bound = 1e-12 * (layer_modulus(&material) + largest(&P[0][0], 9));
        lar_cauchy_stress((rows)F, (rows)P, J, exact);
        lar_hex8_full_stress((rows)corner, &material, (rows)u, cauchy);
        assert_below(largest_difference(cauchy, exact, 6), bound / J);

        /* virtual work of any affine motion: sum f (x) x = V P */
        double volume = 0, work[3][3] = {{0}}, unit[8][3], press[3][3];
        lar_material fluid = test_material(LAR_LAW_neo_hookean, 1, 1);
        const double swell[3][3] = {{1.5, 0, 0}, {0, 1.5, 0}, {0, 0, 1.5}};
        double energy = lar_law_energy(&fluid, swell);
        affine(swell, none, 8, (rows)corner, unit);
        volume = lar_hex8_full_energy((rows)corner, &fluid, (rows)unit) / energy;
        memcpy(press, P, sizeof press);
        for (int k = 0; k < 9; k++) {
            for (int a = 0; a < 8; a++) work[k / 3][k % 3] += force[a][k / 3] * corner[a][k % 3];
            press[k / 3][k % 3] *= volume;
        }
        assert_below(largest_difference(&work[0][0], &press[0][0], 9), 4 * bound * volume);
    }
}

static void a_nan_stays(void **state) {
    (void)state;
    uint64_t seed = 36;
    lar_material material = test_material(0, 4e3, 2e5);
    double corner[8][3], bad[8][3] = {{NAN}}, force[8][3];
    random_corners(&seed, size, 0.2, corner);
    assert_true(isnan(lar_hex8_matrix_force((rows)corner, &material, (rows)bad, force)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_direct_calculation),
        cmocka_unit_test(agrees_when_turned),
        cmocka_unit_test(linear_at_rest),
        cmocka_unit_test(force_is_energy_slope),
        cmocka_unit_test(affine_forces),
        cmocka_unit_test(a_nan_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
