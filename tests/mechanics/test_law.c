/* The material laws against their own energies, against symmetry, against small strains and
 * against homogeneous states that other programs computed. */
#include "mechanics_test.h"

enum { STATES = 200 };

/* P is the derivative of the energy. */
static void stress_is_energy_slope(void **state) {
    (void)state;
    uint64_t seed = 11;
    double worst = 0;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 1000, 5000);
        for (int n = 0; n < STATES; n++) {
            double F[3][3], P[3][3], slope[3][3];
            random_deformation(&seed, 0.4, F);
            lar_law_stress(&material, (rows)F, P);
            for (int k = 0; k < 9; k++) {
                const double step = 1e-5;
                double *value = &F[k / 3][k % 3], kept = *value;
                *value = kept + step;
                double above = lar_law_energy(&material, (rows)F);
                *value = kept - step;
                slope[k / 3][k % 3] = (above - lar_law_energy(&material, (rows)F)) / (2 * step);
                *value = kept;
            }
            double error = largest_difference(&P[0][0], &slope[0][0], 9) / largest(&P[0][0], 9);
            worst = fmax(worst, error);
            assert_below(error, 1e-7);
        }
    }
    print_message("worst difference to the energy's slope %.1e\n", worst);
}

static void no_stress_at_rest_and_rotated(void **state) {
    (void)state;
    uint64_t seed = 12;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 4e3, 2e6);
        for (int n = 0; n < STATES; n++) {
            double R[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, P[3][3];
            if (n) random_rotation(&seed, R);
            double J = lar_law_stress(&material, (rows)R, P);
            assert_below(fabs(J - 1), 1e-14);
            assert_below(largest(&P[0][0], 9) / layer_modulus(&material), 1e-12);
            assert_below(fabs(lar_law_energy(&material, (rows)R)) / layer_modulus(&material),
                         1e-14);
        }
    }
}

/* P(Q F) = Q P(F), and for these isotropic laws P(F Q) = P(F) Q. */
static void objective_and_isotropic(void **state) {
    (void)state;
    uint64_t seed = 13;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 4e3, 2e5);
        for (int n = 0; n < STATES; n++) {
            double F[3][3], Q[3][3], P[3][3], turned[3][3], expected[3][3], found[3][3];
            random_deformation(&seed, 0.5, F);
            random_rotation(&seed, Q);
            lar_law_stress(&material, (rows)F, P);
            double scale = 1e-12 * (layer_modulus(&material) + largest(&P[0][0], 9));
            multiply((rows)Q, (rows)F, turned);
            multiply((rows)Q, (rows)P, expected);
            lar_law_stress(&material, (rows)turned, found);
            assert_below(largest_difference(&expected[0][0], &found[0][0], 9), scale);
            multiply((rows)F, (rows)Q, turned);
            multiply((rows)P, (rows)Q, expected);
            lar_law_stress(&material, (rows)turned, found);
            assert_below(largest_difference(&expected[0][0], &found[0][0], 9), scale);
        }
    }
}

/* Slopes of the stress at rest are the moduli that the rest of the program counts with. */
static void small_strain_moduli(void **state) {
    (void)state;
    const double step = 1e-5;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 1000, 5000);
        double above[3][3], below[3][3];
        const double shear[2][3][3] = {{{1, step, 0}, {0, 1, 0}, {0, 0, 1}},
                                       {{1, -step, 0}, {0, 1, 0}, {0, 0, 1}}};
        lar_law_stress(&material, shear[0], above);
        lar_law_stress(&material, shear[1], below);
        double G = (above[0][1] - below[0][1]) / (2 * step);
        assert_below(fabs(G / lar_material_shear(&material) - 1), 1e-8);
        assert_below(fabs(G / 1000 - 1), 1e-8);

        double grow = 1 + step, shrink = 1 - step;
        const double dilate[2][3][3] = {{{grow, 0, 0}, {0, grow, 0}, {0, 0, grow}},
                                        {{shrink, 0, 0}, {0, shrink, 0}, {0, 0, shrink}}};
        lar_law_stress(&material, dilate[0], above);
        lar_law_stress(&material, dilate[1], below);
        double K = (above[0][0] - below[0][0]) / (2 * step) / 3;
        assert_below(fabs(K / lar_material_bulk(&material) - 1), 1e-8);
        assert_below(fabs(K / 5000 - 1), 1e-8);
    }
}

/* The number returned beside the stress must not be below |P|^2 (in order of magnitude): the
 * kernels use it to keep the fixed-point sums from overflowing. */
static void overflow_guard(void **state) {
    (void)state;
    uint64_t seed = 14;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 4e3, 2e6);
        for (int n = 0; n < STATES; n++) {
            double F[3][3], P[9], square = 0, bound;
            const double *f = (const double *)F;
            random_deformation(&seed, 0.2 + 2.0 * n / STATES, F);
            double J = lar_lane_cofactor(f, P), I1 = lar_lane_square_sum(f);
            bound = lar_law_table[law].stress(f, P, J, I1, material.parameter);
            for (int k = 0; k < 9; k++) square += P[k] * P[k];
            assert_below(square, 4 * bound);
        }
    }
}

/* ---- lane functions against long double ------------------------------------------------------ */

static double ulps(double found, long double exact) {
    double size = fabs((double)exact);
    return (double)(fabsl(found - exact) / (nextafter(size, INFINITY) - size));
}

static void lane_functions(void **state) {
    (void)state;
    uint64_t seed = 15;
    double worst_root = 0, worst_log = 0;
    for (int n = 0; n < 200000; n++) {
        /* near one, ordinary, and anything normal */
        double width = n % 3 == 0 ? 1e-3 : n % 3 == 1 ? 3 : 700;
        double J = exp(width * random_value(&seed));
        worst_root = fmax(worst_root, ulps(lar_lane_rcbrt(J), 1 / cbrtl(J)));
        worst_log = fmax(worst_log, ulps(lar_lane_log(J), logl(J)));
    }
    print_message("J^(-1/3): %.2f ulp, ln J: %.2f ulp\n", worst_root, worst_log);
    assert_below(worst_root, 2);
    assert_below(worst_log, 2);
    assert_true(lar_lane_log(1) == 0);
    assert_true(lar_lane_rcbrt(1) == 1);
}

static void lane_exponentials(void **state) {
    (void)state;
    uint64_t seed = 18;
    double worst = 0, worst_less = 0;
    for (int n = 0; n < 400000; n++) {
        /* near zero, ordinary, all that there is, and down to nothing */
        double width = n % 4 == 0 ? 1e-3 : n % 4 == 1 ? 3 : 708;
        double x =
            width * random_value(&seed) * (n % 4 == 3 ? exp(-700 * fabs(random_value(&seed))) : 1);
        worst = fmax(worst, ulps(lar_lane_exp(x), expl(x)));
        if (fabs(x) > 1e-290) worst_less = fmax(worst_less, ulps(lar_lane_expm1(x), expm1l(x)));
    }
    print_message("e^x: %.2f ulp, e^x - 1: %.2f ulp\n", worst, worst_less);
    assert_below(worst, 1.1);
    assert_below(worst_less, 2.2);
    assert_true(lar_lane_exp(0) == 1 && lar_lane_expm1(0) == 0);
    assert_true(lar_lane_expm1(0x1p-1000) == 0x1p-1000 && lar_lane_expm1(-1e-300) == -1e-300);
    const double beyond[] = {708.5, 1e4, 1e300, INFINITY};
    for (int n = 0; n < 4; n++) {
        assert_true(lar_lane_exp(beyond[n]) == lar_lane_exp(708));
        assert_true(lar_lane_exp(-beyond[n]) == lar_lane_exp(-708));
        assert_true(lar_lane_expm1(-beyond[n]) == -1);
    }
    assert_true(lar_lane_sign(-0.0) == -1 && lar_lane_sign(0) == 1 && lar_lane_sign(-3e300) == -1);
}

/* Powers of stretches, as Ogden's law makes them: off by the size of their exponent besides. */
static void lane_powers(void **state) {
    (void)state;
    uint64_t seed = 19;
    for (int n = 0; n < 100000; n++) {
        double stretch = exp(2 * random_value(&seed)), m = 25 * random_value(&seed);
        double found = lar_lane_exp(m * lar_lane_log(stretch));
        assert_below(ulps(found, powl(stretch, m)), 2 + 5 * fabs(m * log(stretch)));
    }
}

/* ---- stress measures ------------------------------------------------------------------------- */

static void cauchy_measures(void **state) {
    (void)state;
    const double I[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double P[3][3] = {{1, 4, 6}, {4, 2, 5}, {6, 5, 3}};
    double cauchy[6];
    lar_cauchy_stress(I, P, 1, cauchy);
    for (int n = 0; n < 6; n++) assert_true(cauchy[n] == n + 1);
    assert_true(lar_mean_pressure(cauchy) == -2);
    const double pull[6] = {7, 0, 0, 0, 0, 0}, shear[6] = {0, 0, 0, 0, 2, 0};
    assert_below(fabs(lar_von_mises(pull) - 7), 1e-14);
    assert_below(fabs(lar_von_mises(shear) - 2 * sqrt(3)), 1e-14);

    /* sigma = P F^T / J is symmetric for any F: its six numbers tell all */
    uint64_t seed = 16;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 4e3, 2e5);
        double F[3][3], stress[3][3];
        random_deformation(&seed, 0.5, F);
        double J = lar_law_stress(&material, (rows)F, stress);
        lar_cauchy_stress((rows)F, (rows)stress, J, cauchy);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3;
            double other = 0;
            for (int k = 0; k < 3; k++) other += stress[j][k] * F[i][k] / J;
            assert_below(fabs(other - cauchy[3 + i]), 1e-12 * layer_modulus(&material));
        }
    }
}

/* ---- homogeneous states of other programs -----------------------------------------------------
 */

/* The unit cube stretched to 1.5 with free sides: lateral stretch and force as in static.tsv. */
static void uniaxial_reference(void **state) {
    (void)state;
    FILE *file = open_reference("static.tsv");
    if (!file) skip();
    char line[512];
    int rows_found = 0;
    while (fgets(line, sizeof line, file)) {
        double bulk = 0, side = 0, force = 0;
        if (strncmp(line, "a_uniax_inh_nu45\t", 17) == 0) bulk = 10000;
        if (strncmp(line, "a_uniax_inh_nu49\t", 17) == 0) bulk = 50000;
        const char *at = strstr(line, "lateral_stretch=");
        if (bulk == 0 || !at || sscanf(at, "lateral_stretch=%lf Fx=%lf", &side, &force) != 2)
            continue;
        double poisson = bulk == 10000 ? 0.45 : 0.49;
        lar_material material = {.law = LAR_LAW_neo_hookean, .density = 1000};
        lar_material_from_young(&material, 3000, poisson);
        assert_below(fabs(lar_material_bulk(&material) - bulk), 1e-6);
        const double F[3][3] = {{1.5, 0, 0}, {0, side, 0}, {0, 0, side}};
        double P[3][3];
        lar_law_stress(&material, F, P);
        assert_below(fabs(P[0][0] - force), 1e-4 + 1.5e-7 * bulk); /* digits given */
        assert_below(fabs(P[1][1]), 1e-4 + 1.5e-7 * bulk);
        rows_found++;
    }
    fclose(file);
    assert_true(rows_found >= 2);
}

/* Yeoh's law pulled along one axis, sides free, beside what is in every textbook for a body that
 * keeps its volume: sigma = 2 (L^2 - 1/L) (c1 + 2 c2 x + 3 c3 x^2), x = L^2 + 2/L - 3. Constants of
 * FEBio's deck ma61 (a rubber), with a bulk modulus a million times as large. */
static void yeoh_uniaxial(void **state) {
    (void)state;
    const lar_material material = {
        .law = LAR_LAW_yeoh, .density = 1, .parameter = {0.57382, -0.074744, 0.011321, 1e6}};
    for (double L = 0.5; L < 4.1; L += 0.25) {
        double x = L * L + 2 / L - 3;
        double sigma = 2 * (L * L - 1 / L) * (0.57382 - 2 * 0.074744 * x + 3 * 0.011321 * x * x);
        double low = 0.99 / sqrt(L), high = 1.01 / sqrt(L), P[3][3], J = 1;
        for (int n = 0; n < 60; n++) { /* the side stretch without side stress */
            double side = 0.5 * (low + high);
            const double F[3][3] = {{L, 0, 0}, {0, side, 0}, {0, 0, side}};
            J = lar_law_stress(&material, F, P);
            *(P[1][1] > 0 ? &high : &low) = side;
        }
        assert_below(fabs(J - 1), 1e-4);
        assert_below(fabs(P[0][0] * L / J - sigma), 2e-4 * fabs(sigma) + 1e-9);
    }
}

/* Simple shear by tan 60 degrees: Cauchy stresses as in static.tsv. */
static void shear_reference(void **state) {
    (void)state;
    FILE *file = open_reference("static.tsv");
    if (!file) skip();
    char line[512];
    int rows_found = 0;
    while (fgets(line, sizeof line, file)) {
        double poisson = strncmp(line, "e1_shear_inh_nu45\t", 18) == 0   ? 0.45
                         : strncmp(line, "e1_shear_inh_nu49\t", 18) == 0 ? 0.49
                                                                         : 0;
        const char *tau = strstr(line, "R/A)="), *normal = strstr(line, "szz(center)=");
        if (poisson == 0 || !tau || !normal) continue;
        lar_material material = {.law = LAR_LAW_neo_hookean, .density = 1000};
        lar_material_from_young(&material, 3000, poisson);
        const double F[3][3] = {{1, 0, sqrt(3)}, {0, 1, 0}, {0, 0, 1}};
        double P[3][3], cauchy[6];
        double J = lar_law_stress(&material, F, P);
        lar_cauchy_stress(F, (rows)P, J, cauchy);
        assert_below(fabs(cauchy[5] - strtod(tau + 5, NULL)), 1e-2);
        assert_below(fabs(cauchy[2] - strtod(normal + 12, NULL)), 1e-3);
        rows_found++;
    }
    fclose(file);
    assert_true(rows_found >= 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_is_energy_slope),  cmocka_unit_test(no_stress_at_rest_and_rotated),
        cmocka_unit_test(objective_and_isotropic), cmocka_unit_test(small_strain_moduli),
        cmocka_unit_test(overflow_guard),          cmocka_unit_test(lane_functions),
        cmocka_unit_test(lane_exponentials),       cmocka_unit_test(lane_powers),

        cmocka_unit_test(cauchy_measures),         cmocka_unit_test(uniaxial_reference),
        cmocka_unit_test(shear_reference),         cmocka_unit_test(yeoh_uniaxial),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
