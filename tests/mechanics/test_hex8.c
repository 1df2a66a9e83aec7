/* The production element as plain C (hex8.h): geometry, energy, rigid motion, patch test,
 * hourglass stiffness and frequency bound. */
#include "mechanics_test.h"

#include "mechanics/hex8.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hexahedron.h"

enum { ELEMENTS = 60 };
static const double size = 0.01; /* m */

static double characteristic_force(const lar_material *material) {
    return layer_modulus(material) * size * size;
}

/* h_m(a) of hex8.h, m = 0..6. */
static double mode(int m, int a) {
    double s[3] = {lar_node_sign[a][0], lar_node_sign[a][1], lar_node_sign[a][2]};
    return m < 3 ? s[m] : m < 6 ? s[(m - 2) % 3] * s[(m - 1) % 3] : s[0] * s[1] * s[2];
}

/* B_a = sum_m h_m(a) B_m is the mean gradient, exactly: by the Gauss rule, which is exact here,
 * and by the patch condition sum_a x_a (x) B_a = I. */
static void volume_and_mean_gradient(void **state) {
    (void)state;
    uint64_t seed = 41;
    double worst = 0;
    for (int e = 0; e < 10 * ELEMENTS; e++) {
        lar_material material = test_material(0, 4e3, 2e6);
        lar_hex8 element;
        double corner[8][3], mean[8][3] = {{0}}, volume = 0;
        random_corners(&seed, size, 0.25, corner);
        for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
            double at[3], slope[8][3];
            lar_gauss_point(g, at);
            double det = lar_hexahedron_gradients((rows)corner, at, slope);
            volume += det;
            for (int k = 0; k < 24; k++) mean[k / 3][k % 3] += det * slope[k / 3][k % 3];
        }
        lar_hex8_prepare((rows)corner, &material, &element);
        assert_below(fabs(element.volume / volume - 1), 1e-13);
        double product[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
        for (int a = 0; a < 8; a++)
            for (int j = 0; j < 3; j++) {
                double B = 0;
                for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
                    B += mode(m, a) * element.gradient[m][j];
                assert_below(fabs(B - mean[a][j] / volume) * size, 1e-13);
                for (int i = 0; i < 3; i++) product[i][j] += corner[a][i] * B;
            }
        worst = fmax(worst, largest(&product[0][0], 9));
    }
    print_message("worst patch condition %.1e\n", worst);
    assert_below(worst, 1e-13);
}

static double all_energy(const lar_hex8 *element, const lar_material *material, rows u) {
    double hourglass;
    double strain = lar_hex8_energy(element, material, u, &hourglass);
    return strain + hourglass;
}

static void force_is_energy_slope(void **state) {
    (void)state;
    uint64_t seed = 42;
    double worst = 0;
    for (int e = 0; e < ELEMENTS; e++) {
        lar_material material = test_material(e % LAR_LAW_COUNT, 1000, 5000);
        lar_hex8 element;
        double corner[8][3], u[8][3], force[8][3], slope[8][3];
        random_corners(&seed, size, 0.2, corner);
        lar_hex8_prepare((rows)corner, &material, &element);
        random_fill(&seed, 0.12 * size, &u[0][0], 24);
        assert_true(lar_hex8_force(&element, &material, (rows)u, force) > 0.05);
        for (int k = 0; k < 24; k++) {
            const double step = 1e-5 * size;
            double kept = u[k / 3][k % 3];
            u[k / 3][k % 3] = kept + step;
            double above = all_energy(&element, &material, (rows)u);
            u[k / 3][k % 3] = kept - step;
            slope[k / 3][k % 3] = (above - all_energy(&element, &material, (rows)u)) / (2 * step);
            u[k / 3][k % 3] = kept;
        }
        double error = largest_difference(&force[0][0], &slope[0][0], 24);
        worst = fmax(worst, error / characteristic_force(&material));
        assert_true(lar_hex8_energy(&element, &material, (rows)u, NULL) > 0);
    }
    print_message("worst difference to the energy's slope %.1e\n", worst);
    assert_below(worst, 1e-7);
}

static void rigid_motion_and_balance(void **state) {
    (void)state;
    uint64_t seed = 43;
    double worst = 0;
    for (int e = 0; e < 10 * ELEMENTS; e++) {
        lar_material material = test_material(e % LAR_LAW_COUNT, 4e3, 2e6);
        lar_hex8 element;
        double corner[8][3], R[3][3], shift[3], u[8][3], force[8][3], extra[8][3], hourglass;
        double scale = characteristic_force(&material);
        random_corners(&seed, size, 0.2, corner);
        lar_hex8_prepare((rows)corner, &material, &element);
        random_rotation(&seed, R);
        random_fill(&seed, size, shift, 3);
        affine((rows)R, shift, 8, (rows)corner, u);
        double J = lar_hex8_force(&element, &material, (rows)u, force);
        assert_below(fabs(J - 1), 1e-13);
        worst = fmax(worst, largest(&force[0][0], 24) / scale);
        lar_hex8_energy(&element, &material, (rows)u, &hourglass);
        assert_below(hourglass, 1e-24 * scale * size);

        random_fill(&seed, 0.1 * size, &extra[0][0], 24);
        for (int k = 0; k < 24; k++) u[k / 3][k % 3] += extra[k / 3][k % 3];
        lar_hex8_force(&element, &material, (rows)u, force);
        double bound = 1e-12 * (scale + largest(&force[0][0], 24));
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double sum = 0, moment = 0;
            for (int a = 0; a < 8; a++) {
                sum += force[a][i];
                moment +=
                    (corner[a][j] + u[a][j]) * force[a][k] - (corner[a][k] + u[a][k]) * force[a][j];
            }
            assert_below(fabs(sum), bound);
            assert_below(fabs(moment), bound * size);
        }
    }
    print_message("worst force of a rigid motion %.1e of the characteristic force\n", worst);
    assert_below(worst, 1e-12);
}

/* Eight strongly distorted hexahedra around an inner node, deformed affinely. */
static void patch(void **state) {
    (void)state;
    uint64_t seed = 44;
    const double none[3] = {0};
    for (int n = 0; n < ELEMENTS; n++) {
        lar_material material = test_material(n % LAR_LAW_COUNT, 1000, 50000);
        double F[3][3], P[3][3], sum[3] = {0};
        double x[27][3], u[27][3];
        for (int p = 0; p < 27; p++) {
            const int at[3] = {p % 3, p / 3 % 3, p / 9};
            for (int i = 0; i < 3; i++) x[p][i] = size * (at[i] + 0.24 * random_value(&seed));
        }
        random_deformation(&seed, 0.4, F);
        double J = lar_law_stress(&material, (rows)F, P);
        double modulus = layer_modulus(&material) + largest(&P[0][0], 9);
        affine((rows)F, none, 27, (rows)x, u);
        for (int e = 0; e < 8; e++) {
            lar_hex8 element;
            double corner[8][3], here[8][3], force[8][3], exact[8][3], found[3][3], hourglass;
            int inner = 0;
            for (int a = 0; a < 8; a++) {
                int p = 0, stride = 1;
                for (int i = 0; i < 3; i++, stride *= 3)
                    p += stride * ((e >> i & 1) + (lar_node_sign[a][i] > 0));
                memcpy(corner[a], x[p], sizeof x[p]);
                memcpy(here[a], u[p], sizeof u[p]);
                if (p == 13) inner = a;
            }
            lar_hex8_prepare((rows)corner, &material, &element);
            lar_hex8_gradient(&element, (rows)here, found);
            assert_below(largest_difference(&found[0][0], &F[0][0], 9), 1e-13);
            assert_below(fabs(lar_hex8_force(&element, &material, (rows)here, force) - J), 1e-12);
            double energy = lar_hex8_energy(&element, &material, (rows)here, &hourglass);
            assert_below(fabs(energy / (element.volume * lar_law_energy(&material, (rows)F)) - 1),
                         1e-11);
            assert_below(hourglass, 1e-24 * modulus * size * size * size);
            /* eight points and constant strain: no hourglass force has crept in */
            lar_hex8_full_force((rows)corner, &material, (rows)here, exact);
            assert_below(largest_difference(&force[0][0], &exact[0][0], 24),
                         1e-12 * modulus * size * size);
            for (int i = 0; i < 3; i++) sum[i] += force[inner][i];
        }
        assert_below(largest(sum, 3), 1e-12 * modulus * size * size);
    }
}

/* Of a box the hourglass stiffnesses are known: harmonic mean of 4V/(3L^2) along the two
 * directions of the mode, times k G / 64; for xi eta zeta of a cube 8 L/9. None sees K. */
static void hourglass_of_a_box(void **state) {
    (void)state;
    const double length[2][3] = {{size, size, size}, {size, 2 * size, 5 * size}};
    for (int box = 0; box < 2; box++)
        for (int stiff = 0; stiff < 2; stiff++) {
            const double *L = length[box], G = 4e3;
            lar_material material = test_material(0, G, stiff ? 2e9 : 2e4);
            lar_hex8 element;
            double corner[8][3], V = L[0] * L[1] * L[2];
            box_corners(L[0], L[1], L[2], corner);
            lar_hex8_prepare((rows)corner, &material, &element);
            for (int m = 0; m < 3; m++) {
                double a = 4 * V / (3 * L[(m + 1) % 3] * L[(m + 1) % 3]);
                double b = 4 * V / (3 * L[(m + 2) % 3] * L[(m + 2) % 3]);
                double exact = LAR_HOURGLASS_FACTOR * G * (2 * a * b / (a + b)) / 64;
                assert_below(fabs(element.stiffness[m] / exact - 1), 1e-13);
            }
            if (box) continue;
            assert_below(
                fabs(element.stiffness[0] / (LAR_HOURGLASS_FACTOR * G * 4 * size / 3 / 64) - 1),
                1e-13);
            assert_below(
                fabs(element.stiffness[3] / (LAR_HOURGLASS_FACTOR * G * 8 * size / 9 / 64) - 1),
                1e-13);
        }
}

/* Each of the twelve modes is resisted with c_m |q_m|, in its own direction on a box and with
 * positive work on any element. */
static void hourglass_modes_resisted(void **state) {
    (void)state;
    uint64_t seed = 45;
    for (int e = 0; e < ELEMENTS; e++) {
        lar_material material = test_material(e % LAR_LAW_COUNT, 4e3, 2e6);
        lar_hex8 element;
        double corner[8][3];
        if (e < 3)
            box_corners(size, size, size, corner);
        else
            random_corners(&seed, size, 0.2, corner);
        lar_hex8_prepare((rows)corner, &material, &element);
        for (int m = 3; m < 7; m++)
            for (int i = 0; i < 3; i++) {
                double u[8][3] = {{0}}, force[8][3], work = 0, s = 1e-3 * size;
                for (int a = 0; a < 8; a++) u[a][i] = s * mode(m, a);
                lar_hex8_force(&element, &material, (rows)u, force);
                for (int a = 0; a < 8; a++) work += force[a][i] * u[a][i];
                double min = 64 * element.stiffness[m - 3] * s * s;
                assert_true(min > 0.5 * (LAR_HOURGLASS_FACTOR * 4e3 * 8 * size / 9) * s * s * 0.5);
                assert_true(work > 0.5 * min);
                if (e >= 3) continue;
                assert_below(fabs(work / min - 1), 1e-9);
                for (int a = 0; a < 8; a++)
                    assert_below(
                        fabs(force[a][i] / (8 * element.stiffness[m - 3] * s * mode(m, a)) - 1),
                        1e-9);
            }
    }
}

/* Linear stiffness at rest by central differences, added at nodes `node` of K. */
static void stiffness_at_rest(const lar_hex8 *element, const lar_material *material, double *K,
                              int stride, const int *node) {
    const double step = 1e-6 * size;
    for (int m = 0; m < 24; m++) {
        double u[8][3] = {{0}}, above[8][3], below[8][3];
        u[m / 3][m % 3] = step;
        lar_hex8_force(element, material, (rows)u, above);
        u[m / 3][m % 3] = -step;
        lar_hex8_force(element, material, (rows)u, below);
        for (int n = 0; n < 24; n++)
            K[(3 * node[n / 3] + n % 3) * stride + 3 * node[m / 3] + m % 3] +=
                (above[n / 3][n % 3] - below[n / 3][n % 3]) / (2 * step);
    }
}

/* The bound of one element against its exact highest frequency: boxes from cubes to slabs and
 * needles, distorted elements, nearly incompressible to auxetic (K < G / 3, Poisson's ratio down
 * to -0.997), where shear, volume and hourglass modes lie close together. */
static void frequency_of_one(void **state) {
    (void)state;
    static const int own[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    static const double shape[6][3] = {{1, 1, 1}, {1, 1, 9},    {1, 9, 9},
                                       {1, 2, 4}, {1, 1, 1.01}, {5, 6, 7}};
    uint64_t seed = 46;
    double tight = 0;
    for (int e = 0; e < 400; e++) {
        const double bulk[8] = {5, 200, 500, 1333, 3000, 1e4, 2e5, 2e6};
        lar_material material = test_material(e % LAR_LAW_COUNT, 4e3, bulk[e / 6 % 8]);
        lar_hex8 element;
        double corner[8][3], K[24 * 24] = {0};
        const double *L = shape[e % 6];
        if (e < 48)
            box_corners(L[0] * size, L[1] * size, L[2] * size, corner);
        else
            random_corners(&seed, size, 0.25, corner);
        lar_hex8_prepare((rows)corner, &material, &element);
        stiffness_at_rest(&element, &material, K, 24, own);
        double exact = sqrt(jacobi_largest(K, 24) / (material.density * element.volume / 8));
        double omega = lar_hex8_frequency(&element, &material);
        assert_below(exact, omega * (1 + 1e-7));
        tight = fmax(tight, omega / exact);
    }
    print_message("bound at most %.6f of the exact frequency\n", tight);
    assert_below(tight, 1.001);
}

/* No two elements together are faster than the faster one alone. */
static void frequency_of_two(void **state) {
    (void)state;
    uint64_t seed = 47;
    double closest = INFINITY;
    for (int pair = 0; pair < 24; pair++) {
        lar_material material = test_material(pair % LAR_LAW_COUNT, 4e3, pair % 2 ? 2e6 : 1e4);
        double x[PAIR_NODES][3], mass[PAIR_NODES] = {0}, K[PAIR_FREEDOMS * PAIR_FREEDOMS] = {0};
        double bound = 0;
        random_pair(&seed, size, pair < 2 ? 0 : 0.2, x);
        for (int e = 0; e < 2; e++) {
            lar_hex8 element;
            double corner[8][3];
            pair_corners((rows)x, e, corner);
            lar_hex8_prepare((rows)corner, &material, &element);
            stiffness_at_rest(&element, &material, K, PAIR_FREEDOMS, pair_node[e]);
            for (int a = 0; a < 8; a++)
                mass[pair_node[e][a]] += material.density * element.volume / 8;
            bound = fmax(bound, lar_hex8_frequency(&element, &material));
        }
        for (int n = 0; n < PAIR_FREEDOMS; n++)
            for (int m = 0; m < PAIR_FREEDOMS; m++)
                K[n * PAIR_FREEDOMS + m] /= sqrt(mass[n / 3] * mass[m / 3]);
        double joined = sqrt(jacobi_largest(K, PAIR_FREEDOMS));
        assert_below(joined, bound);
        closest = fmin(closest, bound / joined);
    }
    print_message("bound at least %.3f of two elements' frequency\n", closest);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volume_and_mean_gradient), cmocka_unit_test(force_is_energy_slope),
        cmocka_unit_test(rigid_motion_and_balance), cmocka_unit_test(patch),
        cmocka_unit_test(hourglass_of_a_box),       cmocka_unit_test(hourglass_modes_resisted),
        cmocka_unit_test(frequency_of_one),         cmocka_unit_test(frequency_of_two),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
