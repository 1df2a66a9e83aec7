/* Laws beside what their papers and textbooks have for them: pulled along one axis, pulled along
 * two, sheared. Without change of volume a law's pressure is not in differences of its stresses. */
#include "mechanics/mechanics_test.h"

/* Stresses of one law of the parameters p, for the stretch or shear L. */
typedef struct closed_form {
    lar_law law;
    double p[LAR_LAW_PARAMETERS];
    double (*pulled)(const double *p, double L);      /* sigma_1 - sigma_2 of (L, L^-1/2, L^-1/2) */
    double (*spread)(const double *p, double L);      /* sigma_1 - sigma_3 of (L, L, L^-2) */
    double (*sheared)(const double *p, double shear); /* sigma_12 */
} closed_form;

/* Of energies of I1 and I2: 2 (w_1 + w_2 / L) (L^2 - 1/L) and its kin (Ogden 1984, 4.4). */
static double pulled(double w1, double w2, double L) {
    return 2 * (w1 + w2 / L) * (L * L - 1 / L);
}
static double spread(double w1, double w2, double L) {
    return 2 * (w1 + w2 * L * L) * (L * L - pow(L, -4));
}
static double pulled_I1(double L) {
    return L * L + 2 / L;
}
static double spread_I1(double L) {
    return 2 * L * L + pow(L, -4);
}

/* The chain's series, term by term as in the paper. */
static double chain(const double *p, double I1) {
    static const double C[] = {1.0 / 2, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
    double slope = 0;
    for (int i = 1; i <= 5; i++) slope += i * C[i - 1] * pow(I1 / p[1], i - 1);
    return p[0] * slope;
}
static double chain_pulled(const double *p, double L) {
    return pulled(chain(p, pulled_I1(L)), 0, L);
}
static double chain_spread(const double *p, double L) {
    return spread(chain(p, spread_I1(L)), 0, L);
}
static double chain_sheared(const double *p, double shear) {
    return 2 * chain(p, 3 + shear * shear) * shear;
}

static double skin(const double *p, double I1) {
    return p[0] * p[1] * exp(p[1] * (I1 - 3));
}
static double skin_pulled(const double *p, double L) {
    return pulled(skin(p, pulled_I1(L)), -p[0] * p[1] / 2, L);
}
static double skin_spread(const double *p, double L) {
    return spread(skin(p, spread_I1(L)), -p[0] * p[1] / 2, L);
}
static double skin_sheared(const double *p, double shear) {
    return 2 * (skin(p, 3 + shear * shear) - p[0] * p[1] / 2) * shear;
}

/* sum c / m (a^m - b^m). */
static double ogden(const double *p, double a, double b) {
    double sum = 0;
    for (int i = 0; i < 6; i += 2)
        if (p[i] != 0) sum += p[i] / p[i + 1] * (pow(a, p[i + 1]) - pow(b, p[i + 1]));
    return sum;
}
static double ogden_pulled(const double *p, double L) {
    return ogden(p, L, 1 / sqrt(L));
}
static double ogden_spread(const double *p, double L) {
    return ogden(p, L, 1 / (L * L));
}
static double ogden_sheared(const double *p, double shear) {
    double L = shear / 2 + sqrt(1 + shear * shear / 4);
    return ogden(p, L, 1 / L) / (L + 1 / L);
}

static const closed_form forms[] = {
    {LAR_LAW_arruda_boyce, {700, 4, 1e5}, chain_pulled, chain_spread, chain_sheared},
    {LAR_LAW_veronda_westmann, {300, 2.5, 1e5}, skin_pulled, skin_spread, skin_sheared},
    {LAR_LAW_ogden, {800, 3.5, 0, 0, 0, 0, 1e5}, ogden_pulled, ogden_spread, ogden_sheared},
    {LAR_LAW_ogden, {900, 1.3, 40, 5, -60, -2, 1e5}, ogden_pulled, ogden_spread, ogden_sheared},
    {LAR_LAW_ogden, {600, -7, 300, 0.02, 0, 0, 1e5}, ogden_pulled, ogden_spread, ogden_sheared}};

static void stress_of(const closed_form *form, const double F[3][3], double cauchy[6]) {
    lar_material material = {.law = form->law, .density = 1000};
    lar_error error = {0};
    double P[3][3];
    memcpy(material.parameter, form->p, sizeof material.parameter);
    if (lar_material_check(&material, "here", &error)) fail_msg("%s", error.message);
    double J = lar_law_stress(&material, F, P);
    lar_cauchy_stress(F, (rows)P, J, cauchy);
}

static void without_change_of_volume(void **state) {
    (void)state;
    for (size_t n = 0; n < sizeof forms / sizeof *forms; n++)
        for (double L = 0.4; L < 2.3; L += 0.13) {
            const closed_form *form = &forms[n];
            double stress[6], side = 1 / sqrt(L), shear = 1.5 * (L - 1);
            const double along[3][3] = {{L, 0, 0}, {0, side, 0}, {0, 0, side}};
            const double wide[3][3] = {{L, 0, 0}, {0, L, 0}, {0, 0, 1 / (L * L)}};
            const double skewed[3][3] = {{1, shear, 0}, {0, 1, 0}, {0, 0, 1}};
            double scale = 1e-11 * (1e5 + lar_law_table[form->law].shear(form->p));
            double expected = form->pulled(form->p, L);
            stress_of(form, along, stress);
            assert_below(fabs(stress[0] - stress[1] - expected), scale + 1e-12 * fabs(expected));
            expected = form->spread(form->p, L);
            stress_of(form, wide, stress);
            assert_below(fabs(stress[0] - stress[2] - expected), scale + 1e-12 * fabs(expected));
            expected = form->sheared(form->p, shear);
            stress_of(form, skewed, stress);
            assert_below(fabs(stress[3] - expected), scale + 1e-12 * fabs(expected));
        }
}

/* Cartilage in a tight ring, pressed: H_A / 2 (L^2 - 1) / L^(2 beta + 1) e^(beta (L^2 - 1))
 * (Holmes and Mow 1990); sheared: mu shear e^(2 mu beta / H_A shear^2). */
static void cartilage(void **state) {
    (void)state;
    for (double mu = 100; mu < 2e4; mu *= 5)
        for (double beta = 0.1; beta < 4; beta *= 3)
            for (double L = 0.5; L < 1.6; L += 0.07) {
                double lambda = 7e3, HA = lambda + 2 * mu, shear = 1.2 * (L - 1), stress[6];
                const closed_form form = {LAR_LAW_holmes_mow, {mu, lambda, beta}, 0, 0, 0};
                const double ring[3][3] = {{L, 0, 0}, {0, 1, 0}, {0, 0, 1}};
                const double skewed[3][3] = {{1, shear, 0}, {0, 1, 0}, {0, 0, 1}};
                double expected =
                    HA / 2 * (L * L - 1) * pow(L, -2 * beta - 1) * exp(beta * (L * L - 1));
                stress_of(&form, ring, stress);
                assert_below(fabs(stress[0] - expected), 1e-12 * (HA + fabs(expected)));
                expected = mu * shear * exp(2 * mu * beta / HA * shear * shear);
                stress_of(&form, skewed, stress);
                assert_below(fabs(stress[3] - expected), 1e-12 * (HA + fabs(expected)));
            }
}

/* Laws go over into others: Ogden's with m = 2 into what is neo-Hookean in shape, with 2 and -2
 * into Mooney-Rivlin; a chain of many links is next to neo-Hookean. */
static void laws_meet(void **state) {
    (void)state;
    uint64_t seed = 41;
    const lar_material mooney = {.law = LAR_LAW_mooney_rivlin, .parameter = {500, 120, 7e3}};
    const lar_material both = {.law = LAR_LAW_ogden, .parameter = {2000, 2, 480, -2, 0, 0, 7e3}};
    const lar_material yeoh = {.law = LAR_LAW_yeoh, .parameter = {500, 0, 0, 7e3}};
    const lar_material links = {.law = LAR_LAW_arruda_boyce, .parameter = {1000, 1000, 7e3}};
    for (int n = 0; n < 2000; n++) {
        double F[3][3], P[3][3], Q[3][3];
        random_deformation(&seed, 0.5, F);
        lar_law_stress(&mooney, (rows)F, P);
        lar_law_stress(&both, (rows)F, Q);
        assert_below(largest_difference(&P[0][0], &Q[0][0], 9), 1e-13 * largest(&P[0][0], 9));
        double W = lar_law_energy(&mooney, (rows)F);
        assert_below(fabs(lar_law_energy(&both, (rows)F) - W), 1e-12 * W);
        lar_law_stress(&yeoh, (rows)F, P);
        lar_law_stress(&links, (rows)F, Q);
        assert_below(largest_difference(&P[0][0], &Q[0][0], 9), 3e-3 * largest(&P[0][0], 9));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_change_of_volume),
        cmocka_unit_test(cartilage),
        cmocka_unit_test(laws_meet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
