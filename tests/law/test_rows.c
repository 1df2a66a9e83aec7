/* Every row of the table of laws, whatever laws there are: its words are complete, and what it says
 * of stress, tangent and moduli is one law. (Energy, objectivity, moduli at rest and the guard of
 * overflow: tests/mechanics/test_law.c, for every row as well.) */
#include "law/every_term.h"
#include "mechanics/hex8_guard.h"
#include "mechanics/mechanics_test.h"

enum { STATES = 100 };

static void check_words(const lar_law_parameter *parameter, int count, const char *of) {
    for (int i = 0; i < count; i++) {
        assert_non_null(parameter[i].name);
        if (parameter[i].name[0] == '\0') fail_msg("%s: parameter %d has no name", of, i);
        for (int j = 0; j < i; j++)
            if (strcmp(parameter[i].name, parameter[j].name) == 0)
                fail_msg("%s: two parameters %s", of, parameter[i].name);
    }
}

static void check_dialect(const lar_law_dialect *dialect, const char *of) {
    if (!dialect->name) {
        assert_int_equal(dialect->count, 0);
        return;
    }
    if (dialect->count < 1 || !dialect->read) fail_msg("%s as %s", of, dialect->name);
    check_words(dialect->parameter, dialect->count, of);
}

static void words_are_complete(void **state) {
    (void)state;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        const lar_law_row *row = &lar_law_table[law];
        assert_ptr_equal(row->name, lar_law_name[law]);
        for (int other = 0; other < law; other++)
            assert_string_not_equal(row->name, lar_law_name[other]);
        assert_true(row->name[0] && row->title[0]);
        assert_in_range(row->count, 1, LAR_LAW_PARAMETERS);
        check_words(row->parameter, row->count, row->name);
        check_dialect(row->febio, row->name);
        check_dialect(row->abaqus, row->name);
    }
}

/* What another program's deck says gives parameters of which every one has its own number, and
 * moduli. */
static void decks_reach_every_parameter(void **state) {
    (void)state;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        const lar_law_row *row = &lar_law_table[law];
        const lar_law_dialect *const dialects[] = {row->febio, row->abaqus};
        for (int d = 0; d < 2; d++) {
            const lar_law_dialect *dialect = dialects[d];
            if (!dialect->name) continue;
            double given[LAR_LAW_GIVEN] = {0}, first[LAR_LAW_PARAMETERS] = {0};
            for (int i = 0; i < dialect->count; i++) {
                static const double value[] = {1000, 1000, 1000, 0.3, 1e-6, 0, 2, 3};
                given[i] = value[dialect->parameter[i].value] * (1 + 0.1 * i);
            }
            dialect->read(given, first);
            assert_true(row->shear(first) > 0 && row->bulk(first) > 0);
            bool moved[LAR_LAW_PARAMETERS] = {false};
            for (int i = 0; i < dialect->count; i++) {
                double second[LAR_LAW_PARAMETERS] = {0}, kept = given[i];
                given[i] *= 1.01;
                dialect->read(given, second);
                given[i] = kept;
                for (int k = 0; k < row->count; k++) moved[k] |= second[k] != first[k];
            }
            for (int k = 0; k < row->count; k++)
                if (!moved[k])
                    fail_msg("%s as %s: %s", row->name, dialect->name, row->parameter[k].name);
        }
    }
}

static void parameters_come_back(void **state) {
    (void)state;
    uint64_t seed = 21;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        const lar_law_row *row = &lar_law_table[law];
        for (int n = 0; n < STATES; n++) {
            double shear = exp(8 + 4 * random_value(&seed)),
                   bulk = shear * exp(4 * random_value(&seed));
            lar_material material = {.law = (lar_law)law, .density = 1000};
            lar_material_from_shear_bulk(&material, shear, bulk);
            assert_below(fabs(row->shear(material.parameter) / shear - 1), 1e-14);
            assert_below(fabs(row->bulk(material.parameter) / bulk - 1), 1e-13);
            every_term(&material, 0.3);
            assert_below(fabs(row->shear(material.parameter) / shear - 1), 1e-14);
            assert_below(fabs(row->bulk(material.parameter) / bulk - 1), 1e-13);
            /* What moduli determine comes back from them. */
            lar_material again = {.law = (lar_law)law, .density = 1000};
            lar_material_from_shear_bulk(&again, shear, bulk);
            double P[3][3], Q[3][3], F[3][3] = {{1 + 1e-7, 2e-7, 0}, {0, 1, 0}, {0, 0, 1}};
            lar_law_stress(&material, (rows)F, P);
            lar_law_stress(&again, (rows)F, Q);
            assert_below(largest_difference(&P[0][0], &Q[0][0], 9), 1e-12 * (shear + bulk));
        }
    }
}

/* dP/dF by differences of fourth order. */
static void differences(const lar_material *material, const double F[3][3], int column,
                        double slope[9]) {
    static const double weight[4] = {8, -8, -1, 1}, at[4] = {1, -1, 2, -2}, h = 1e-3;
    memset(slope, 0, 9 * sizeof *slope);
    for (int n = 0; n < 4; n++) {
        double moved[3][3], P[3][3];
        memcpy(moved, F, sizeof moved);
        moved[column / 3][column % 3] += at[n] * h;
        lar_law_stress(material, (rows)moved, P);
        for (int r = 0; r < 9; r++) slope[r] += weight[n] * (&P[0][0])[r] / (12 * h);
    }
}

static void tangent_is_stress_slope(void **state) {
    (void)state;
    uint64_t seed = 22;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = {.law = (lar_law)law, .density = 1000};
        lar_material_from_shear_bulk(&material, 1000, 5000);
        every_term(&material, 0.3);
        double worst = 0, skew = 0;
        for (int n = 0; n < STATES; n++) {
            double F[3][3], A[9][9], slope[9];
            random_deformation(&seed, 0.4, F);
            if (determinant((rows)F) < 0.4) continue; /* differences of ln J and J^(-2/3) */
            lar_law_table[law].tangent(material.parameter, &F[0][0], A);
            double scale = largest(&A[0][0], 81);
            for (int c = 0; c < 9; c++) {
                differences(&material, (rows)F, c, slope);
                for (int r = 0; r < 9; r++) {
                    worst = fmax(worst, fabs(A[r][c] - slope[r]) / scale);
                    skew = fmax(skew, fabs(A[r][c] - A[c][r]) / scale);
                }
            }
        }
        print_message("%s: differences %.1e, asymmetry %.1e\n", lar_law_name[law], worst, skew);
        assert_below(worst, 1e-7);
        assert_below(skew, 1e-14);
    }
}

/* Blocks hold parameters times a volume and a unit: stress and energy go with them. */
static void a_common_factor_goes_through(void **state) {
    (void)state;
    uint64_t seed = 23;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int n = 0; n < STATES; n++) {
            lar_material material = {.law = (lar_law)law, .density = 1000}, twice;
            lar_material_from_shear_bulk(&material, 1000, 5000);
            every_term(&material, 0.3);
            twice = material;
            for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
                if (lar_law_scales((lar_law)law, k)) twice.parameter[k] *= 0x1p20;
            double F[3][3], P[3][3], Q[3][3];
            random_deformation(&seed, 0.4, F);
            lar_law_stress(&material, (rows)F, P);
            lar_law_stress(&twice, (rows)F, Q);
            for (int k = 0; k < 9; k++) assert_true((&Q[0][0])[k] == 0x1p20 * (&P[0][0])[k]);
            assert_true(lar_law_energy(&twice, (rows)F) ==
                        0x1p20 * lar_law_energy(&material, (rows)F));
        }
}

static double stiffest(const lar_material *material, const double F[3][3]) {
    double A[9][9];
    lar_law_table[material->law].tangent(material->parameter, &F[0][0], A);
    return jacobi_largest(&A[0][0], 9);
}

/* How much faster an element is than at rest, which the stable step follows, is the root of how
 * much the largest eigenvalue of dP/dF has grown. What the step counts with is an estimate: of laws
 * whose shear does not stiffen half of that growth where volume gives way easily (K = 3 G). A law
 * that stiffens and says nothing of it would be far below. */
static void strained_is_as_stiff_as_it_says(void **state) {
    (void)state;
    static const double rest[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    uint64_t seed = 24;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        double min = INFINITY, max = 0;
        for (int n = 0; n < 20 * STATES; n++) {
            lar_material material = {.law = (lar_law)law, .density = 1000};
            lar_material_from_shear_bulk(&material, 1000, n % 2 ? 3000 : 1e5);
            every_term(&material, 0.3);
            double F[3][3], cof[9];
            random_deformation(&seed, 0.4, F);
            double J = lar_lane_cofactor((const double *)F, cof);
            const float strain[LAR_STRAIN_NUMBERS] = {(float)J,
                                                      (float)lar_lane_square_sum((const double *)F),
                                                      (float)lar_lane_square_sum(cof)};
            double growth = stiffest(&material, (rows)F) / stiffest(&material, rest);
            if (J < 0.5 || J > 1.3 || strain[LAR_STRAIN_AREA] > 20 || growth < 1.5) continue;
            lar_hex8_stiff stiff;
            lar_hex8_stiff_begin(&material, &stiff);
            lar_hex8_stiff_of(&material, strain, &stiff);
            double ratio = lar_hex8_growth(&stiff, strain[LAR_STRAIN_AREA] / 3.0) / growth;
            min = fmin(min, ratio);
            max = fmax(max, ratio);
        }
        print_message("%s: said over true growth %.2f to %.2f\n", lar_law_name[law], min, max);
        assert_below(0.45, min);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_are_complete),
        cmocka_unit_test(decks_reach_every_parameter),
        cmocka_unit_test(parameters_come_back),
        cmocka_unit_test(tangent_is_stress_slope),
        cmocka_unit_test(a_common_factor_goes_through),
        cmocka_unit_test(strained_is_as_stiff_as_it_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
