/* Fibres in one point (law/fibre_stress.h): stress against energy, rotations, closed forms, and
 * that the bound of their stiffness is none too low. */
#include "law/fibre_stress.h"
#include "mechanics/hex8.h"
#include "mechanics/hex8_guard.h"
#include "mechanics/mechanics_test.h"

/* One of each, in pascal beside a law of G = 1000. */
static const lar_fibre FIBRES[] = {
    {.law = LAR_FIBRE_EXP_POW, .parameter = {400, 1.5, 2}},
    {.law = LAR_FIBRE_EXP_POW, .parameter = {900, 0, 3.3}, .isochoric = true},
    {.law = LAR_FIBRE_EXP_POW, .parameter = {250, 0.7, 2.5}, .along = 300, .across = 120},
    {.law = LAR_FIBRE_EXP_LINEAR, .parameter = {80, 12, 2000, 1.15}, .isochoric = true},
    {.law = LAR_FIBRE_EXP_LINEAR, .parameter = {120, 6, 900, 1.3}, .isochoric = false},
    {.law = LAR_FIBRE_NONE, .along = 500, .across = 0},
    {.law = LAR_FIBRE_EXP_LINEAR,
     .parameter = {80, 12, 2000, 1.15},
     .isochoric = true,
     .along = 700},
    {.law = LAR_FIBRE_POW_LINEAR, .parameter = {900, 1.12, 2.6}},
    {.law = LAR_FIBRE_POW_LINEAR, .parameter = {1500, 1.08, 2}, .isochoric = true},
    {.law = LAR_FIBRE_POW_LINEAR, .parameter = {700, 1.01, 4}, .along = 200},
    {.law = LAR_FIBRE_HGO, .parameter = {600, 1.2, 0}, .isochoric = true},
    {.law = LAR_FIBRE_HGO, .parameter = {800, 0, 0.226}, .isochoric = true, .along = 250},
    {.law = LAR_FIBRE_HGO, .parameter = {500, 3, 1.0 / 3}, .isochoric = true},
    {.law = LAR_FIBRE_HGO, .parameter = {900, 0.8, 0.1}, .isochoric = true, .paired = true},
    {.law = LAR_FIBRE_HGO,
     .parameter = {400, 1.5, 0},
     .isochoric = true,
     .paired = true,
     .along = 150},
    {.law = LAR_FIBRE_HGO, .parameter = {700, 0, 0.15}, .isochoric = true, .paired = true},
};
enum { FAMILIES = sizeof FIBRES / sizeof *FIBRES, STATES = 100 };

static lar_material material_with(int family, lar_law law) {
    lar_material material = test_material(law, 1000, 5000);
    material.fibre = FIBRES[family];
    return material;
}

static void random_unit(uint64_t *seed, double a[3]) {
    double R[3][3];
    random_rotation(seed, R);
    for (int i = 0; i < 3; i++) a[i] = R[i][0];
}

/* Of two families; the second one is drawn only where there are two. */
static void random_units(uint64_t *seed, const lar_fibre *fibre, double a[6]) {
    for (int k = 0; k < lar_fibre_families(fibre); k++) random_unit(seed, a + 3 * k);
}

static void stress_is_energy_slope(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (int family = 0; family < FAMILIES; family++)
        for (int n = 0; n < STATES; n++) {
            lar_material material = material_with(family, (lar_law)(n % LAR_LAW_COUNT));
            double F[3][3], P[3][3], a[6], slope[9];
            random_units(&seed, &material.fibre, a);
            random_deformation(&seed, 0.3, F);
            lar_material_stress(&material, a, (rows)F, P);
            for (int k = 0; k < 9; k++) {
                const double step = 1e-5;
                double *value = &F[k / 3][k % 3], kept = *value;
                *value = kept + step;
                double above = lar_material_energy(&material, a, (rows)F);
                *value = kept - step;
                slope[k] = (above - lar_material_energy(&material, a, (rows)F)) / (2 * step);
                *value = kept;
            }
            assert_below(largest_difference(&P[0][0], slope, 9) / largest(&P[0][0], 9), 1e-7);
        }
}

/* P(Q F) = Q P(F), and with fibres that are turned as well P(F Q', Q a) = P(F, a) Q'. */
static void turned_with_the_body(void **state) {
    (void)state;
    uint64_t seed = 6;
    for (int family = 0; family < FAMILIES; family++)
        for (int n = 0; n < STATES; n++) {
            lar_material material = material_with(family, (lar_law)(n % LAR_LAW_COUNT));
            double F[3][3], Q[3][3], P[3][3], a[6] = {0}, b[6], QF[3][3], QP[3][3], FQ[3][3],
                                              PQ[3][3];
            double found[3][3];
            random_units(&seed, &material.fibre, a);
            random_deformation(&seed, 0.4, F);
            random_rotation(&seed, Q);
            for (int i = 0; i < 6; i++) {
                const double *c = a + i / 3 * 3, *row = Q[i % 3];
                b[i] = row[0] * c[0] + row[1] * c[1] + row[2] * c[2];
            }
            lar_material_stress(&material, a, (rows)F, P);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    QF[i][j] = QP[i][j] = FQ[i][j] = PQ[i][j] = 0;
                    for (int k = 0; k < 3; k++) {
                        QF[i][j] += Q[i][k] * F[k][j];
                        QP[i][j] += Q[i][k] * P[k][j];
                        FQ[i][j] += F[i][k] * Q[j][k];
                        PQ[i][j] += P[i][k] * Q[j][k];
                    }
                }
            double size = largest(&P[0][0], 9) + 1000;
            lar_material_stress(&material, a, (rows)QF, found);
            assert_below(largest_difference(&found[0][0], &QP[0][0], 9) / size, 1e-11);
            lar_material_stress(&material, b, (rows)FQ, found);
            assert_below(largest_difference(&found[0][0], &PQ[0][0], 9) / size, 1e-11);
        }
}

/* Not a bit of stress, and no energy. */
static void pressed_fibres_do_nothing(void **state) {
    (void)state;
    static const double F[3][3] = {{0.8, 0, 0}, {0, 1.2, 0.1}, {0, 0, 1.1}};
    static const double a[6] = {1, 0, 0, 0.96, 0.28, 0};
    for (int family = 0; family < FAMILIES; family++) {
        lar_material material = material_with(family, LAR_LAW_neo_hookean);
        if (material.fibre.law == LAR_FIBRE_HGO && material.fibre.parameter[2] > 0.3)
            continue; /* some of them are always pulled */
        double P[3][3], law[3][3];
        material.fibre.along = material.fibre.across = 0;
        lar_material_stress(&material, a, F, P);
        lar_law_stress(&material, F, law);
        assert_memory_equal(P, law, sizeof P);
        assert_true(lar_material_energy(&material, a, F) == lar_law_energy(&material, F));
    }
}

/* Pulled along the fibres at constant volume: sigma_1 - sigma_2 of the fibres is s by the formulas
 * of the papers, and 0 across. */
static void pulled_along_and_across(void **state) {
    (void)state;
    for (int family = 0; family < FAMILIES; family++)
        for (double L = 0.85; L < 1.5; L += 0.05) {
            lar_material material = material_with(family, LAR_LAW_neo_hookean), bare = material;
            const lar_fibre *f = &material.fibre;
            const double *p = f->parameter;
            double side = 1 / sqrt(L);
            const double F[3][3] = {{L, 0, 0}, {0, side, 0}, {0, 0, side}};
            double a[6] = {1, 0, 0, 1, 0, 0}, P[3][3], Q[3][3], wanted = 0;
            bare.fibre = (lar_fibre){0};
            lar_material_stress(&material, a, F, P);
            lar_material_stress(&bare, a, F, Q);
            double found = L * (P[0][0] - Q[0][0]) - side * (P[1][1] - Q[1][1]);
            if (f->law == LAR_FIBRE_EXP_POW && L > 1)
                wanted =
                    2 * L * L * p[0] * pow(L * L - 1, p[2] - 1) * exp(p[1] * pow(L * L - 1, p[2]));
            if (f->law == LAR_FIBRE_HGO) {
                double mean = p[2] * (L * L + 2 / L) + (1 - 3 * p[2]) * L * L;
                double E = fmax(mean - 1, 0), spread = p[2] * (L * L - 1 / L);
                wanted = 2 * p[0] * E * exp(p[1] * E * E) * (spread + (1 - 3 * p[2]) * L * L);
            }
            if (f->law == LAR_FIBRE_EXP_LINEAR && L > 1)
                wanted = L < p[3] ? p[0] * expm1(p[1] * (L - 1))
                                  : p[2] * L + p[0] * expm1(p[1] * (p[3] - 1)) - p[2] * p[3];
            if (f->law == LAR_FIBRE_POW_LINEAR && L > 1) { /* E, lam0, beta of FEBio's manual */
                double I0 = p[1] * p[1], xi, B;
                xi = p[0] / (4 * (p[2] - 1)) * pow(I0, -1.5) * pow(I0 - 1, 2 - p[2]);
                B = xi * pow(I0 - 1, p[2] - 1) + p[0] / (2 * p[1]);
                wanted =
                    L < p[1] ? 2 * L * L * xi * pow(L * L - 1, p[2] - 1) : 2 * B * L * L - p[0] * L;
            }
            wanted = lar_fibre_families(f) * wanted + f->along * L * L - f->across / L;
            assert_below(fabs(found - wanted), 1e-12 * (fabs(wanted) + 1000));
        }
}

/* Without spread hgo is exp-pow with beta = 2, and spread evenly it knows no direction. */
static void the_limits_of_spread(void **state) {
    (void)state;
    uint64_t seed = 9;
    for (int n = 0; n < STATES; n++) {
        double F[3][3], P[3][3], Q[3][3], a[6], b[6];
        lar_material m = material_with(0, LAR_LAW_neo_hookean), power = m;
        m.fibre = (lar_fibre){LAR_FIBRE_HGO, .isochoric = true, .parameter = {700, 0.9, 0}};
        power.fibre = (lar_fibre){LAR_FIBRE_EXP_POW, .isochoric = true, .parameter = {700, 0.9, 2}};
        m.fibre.paired = power.fibre.paired = n % 2 == 1;
        for (int k = 0; k < 6; k += 3) random_unit(&seed, a + k), random_unit(&seed, b + k);
        random_deformation(&seed, 0.3, F);
        lar_material_stress(&m, a, (rows)F, P);
        lar_material_stress(&power, a, (rows)F, Q);
        double size = largest(&P[0][0], 9);
        assert_below(largest_difference(&P[0][0], &Q[0][0], 9) / size, 1e-12);
        double energy = lar_material_energy(&m, a, (rows)F);
        assert_below(fabs(energy / lar_material_energy(&power, a, (rows)F) - 1), 1e-12);
        m.fibre.parameter[2] = 1.0 / 3;
        lar_material_stress(&m, a, (rows)F, P);
        lar_material_stress(&m, b, (rows)F, Q);
        assert_below(largest_difference(&P[0][0], &Q[0][0], 9) / size, 1e-12);
    }
}

/* Where the straight part of a law begins, stress and modulus go on; and the answer of fibres says
 * the slope of their tension on both sides. */
static void toes_end_smoothly(void **state) {
    (void)state;
    for (int family = 0; family < FAMILIES; family++) {
        const lar_fibre *f = &FIBRES[family];
        if (f->law != LAR_FIBRE_POW_LINEAR) continue;
        double p[4], end = f->parameter[1], h = 1e-7;
        memcpy(p, f->parameter, sizeof p);
        for (double l = 1.001; l < 1.4; l += 0.007) {
            double low = (l - h) * (l - h), high = (l + h) * (l + h);
            lar_fibre_answer now = lar_fibre_tension(f->law, l * l, p);
            double rise = lar_fibre_tension(f->law, high, p).tension -
                          lar_fibre_tension(f->law, low, p).tension;
            assert_below(fabs(rise / (2 * h) - now.slope), 1e-5 * now.slope + 1e-3);
        }
        lar_fibre_answer before = lar_fibre_tension(f->law, (end - 1e-9) * (end - 1e-9), p);
        lar_fibre_answer after = lar_fibre_tension(f->law, (end + 1e-9) * (end + 1e-9), p);
        assert_below(fabs(after.tension - before.tension), 1e-8 * after.slope);
        assert_below(fabs(after.slope / before.slope - 1), 1e-5);
    }
}

/* The second derivative of the fibres' energy, times a direction. */
static void curve(const lar_material *material, const double a[3], double F[3][3],
                  const double *way, double *image) {
    const double step = 1e-6;
    double above[3][3], below[3][3], law[3][3], kept[9];
    memcpy(kept, F, sizeof kept);
    for (int k = 0; k < 9; k++) (&F[0][0])[k] = kept[k] + step * way[k];
    lar_material_stress(material, a, (rows)F, above);
    lar_law_stress(material, (rows)F, law);
    for (int k = 0; k < 9; k++) (&above[0][0])[k] -= (&law[0][0])[k];
    for (int k = 0; k < 9; k++) (&F[0][0])[k] = kept[k] - step * way[k];
    lar_material_stress(material, a, (rows)F, below);
    lar_law_stress(material, (rows)F, law);
    for (int k = 0; k < 9; k++) (&below[0][0])[k] -= (&law[0][0])[k];
    memcpy(F, kept, sizeof kept);
    for (int k = 0; k < 9; k++) image[k] = ((&above[0][0])[k] - (&below[0][0])[k]) / (2 * step);
}

/* Largest eigenvalue by power iteration, shifted so that the lowest does not win. */
static double stiffest(const lar_material *material, const double a[3], double F[3][3],
                       double shift) {
    double way[9], image[9], value = 0;
    for (int k = 0; k < 9; k++) way[k] = 0.3 + 0.17 * k - 0.03 * k * k;
    for (int n = 0; n < 300; n++) {
        double norm = 0;
        for (int k = 0; k < 9; k++) norm += way[k] * way[k];
        for (int k = 0; k < 9; k++) way[k] /= sqrt(norm);
        curve(material, a, F, way, image);
        value = 0;
        for (int k = 0; k < 9; k++) value += way[k] * image[k];
        for (int k = 0; k < 9; k++) way[k] = image[k] + shift * way[k];
    }
    return value;
}

static void the_bound_of_stiffness_holds(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int family = 0; family < FAMILIES; family++) {
        double closest = 0;
        lar_material material = material_with(family, LAR_LAW_neo_hookean);
        material.fibre.along = material.fibre.across = 0;
        if (material.fibre.law == LAR_FIBRE_NONE) continue;
        for (int n = 0; n < STATES; n++) {
            double F[3][3], a[6], g[3], p[4], cof[9], bound = 0, pulled = 0;
            random_units(&seed, &material.fibre, a);
            random_deformation(&seed, 0.25, F);
            int kind = lar_fibre_kind_single(&material.fibre);
            double J = lar_lane_cofactor((const double *)F, cof);
            memcpy(p, material.fibre.parameter, sizeof p);
            for (int k = 0; k < lar_fibre_families(&material.fibre); k++) {
                double length = lar_fibre_push((const double *)F, a + 3 * k, g);
                if (material.fibre.law == LAR_FIBRE_HGO)
                    length = lar_fibre_mean((const double *)F, length, p[2]);
                double square = lar_fibre_square(kind, length, J);
                lar_fibre_answer now = lar_fibre_tension(material.fibre.law, square, p);
                double area = lar_lane_square_sum(cof);
                bound += material.fibre.law == LAR_FIBRE_HGO
                             ? lar_fibre_spread_stiffness(&now, square, length,
                                                          lar_lane_square_sum((const double *)F),
                                                          p[2], J, area)
                             : lar_fibre_stiffness(kind, &now, square, length, J, area);
                pulled = fmax(pulled, square);
            }
            double found = stiffest(&material, a, F, bound);
            if (pulled < 1.0001) continue;
            assert_below(found, bound * (1 + 1e-4));
            closest = fmax(closest, found / bound);
        }
        print_message("fibres %d: at most %.3f of the bound\n", family, closest);
        assert_true(closest > 0.6);
    }
}

/* An element pulled along its fibres by so little that it is as at rest: no mode is faster than its
 * frequency says, and some mode is nearly as fast. */
static void frequency_counts_fibres(void **state) {
    (void)state;
    uint64_t seed = 8;
    double closest = 0;
    for (int family = 0; family < FAMILIES; family++)
        for (int n = 0; n < 20; n++) {
            lar_material material = material_with(family, LAR_LAW_neo_hookean);
            double corner[8][3], u[8][3], above[8][3], below[8][3], way[24], omega = 0;
            lar_hex8 element;
            random_corners(&seed, 0.01, 0.2, corner);
            for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
                if (lar_fibre_scales(material.fibre.law, k)) material.fibre.parameter[k] *= 5;
            lar_hex8_prepare((rows)corner, &material, &element);
            random_units(&seed, &material.fibre, element.fibre);
            for (int k = 0; k < 24; k++) way[k] = 1 + 0.3 * k - 0.05 * k * (k % 5);
            double mass = material.density * element.volume / 8, edge = cbrt(element.volume);
            for (int round = 0; round < 200; round++) {
                double norm = 0;
                for (int k = 0; k < 24; k++) norm += way[k] * way[k];
                for (int sign = -1; sign < 2; sign += 2) {
                    double(*force)[3] = sign < 0 ? below : above;
                    for (int b = 0; b < 8; b++)
                        for (int i = 0; i < 3; i++) {
                            u[b][i] = sign * 1e-6 * edge * way[3 * b + i] / sqrt(norm);
                            for (int k = 0; k < 6; k += 3) {
                                double along = 0, *a = element.fibre + k;
                                for (int j = 0; j < 3; j++) along += a[j] * corner[b][j];
                                u[b][i] += 1e-4 * along * a[i];
                            }
                        }
                    lar_hex8_force(&element, &material, (rows)u, force);
                }
                omega = 0;
                for (int k = 0; k < 24; k++) {
                    double image = ((&above[0][0])[k] - (&below[0][0])[k]) / (2e-6 * edge);
                    omega += way[k] / sqrt(norm) * image;
                    way[k] = image;
                }
            }
            double bound = lar_hex8_frequency(&element, &material);
            assert_below(omega / mass, 1.005 * bound * bound);
            closest = fmax(closest, omega / mass / (bound * bound));
        }
    print_message("at most %.3f of the bound of the square\n", closest);
    assert_true(closest > 0.8);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_is_energy_slope),    cmocka_unit_test(turned_with_the_body),
        cmocka_unit_test(pressed_fibres_do_nothing), cmocka_unit_test(pulled_along_and_across),
        cmocka_unit_test(toes_end_smoothly),         cmocka_unit_test(the_bound_of_stiffness_holds),
        cmocka_unit_test(frequency_counts_fibres),   cmocka_unit_test(the_limits_of_spread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
