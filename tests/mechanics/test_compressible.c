/* How fast strained elements of compressible tissue are, against all eigenvalues of the tangent. */
#include "step/mass/compressible.h"

#include <math.h>
#include <string.h>

#include "mechanics/hex8_guard.h"
#include "mechanics/mechanics_test.h"

/* The largest eigenvalue of a symmetric matrix, by turning pairs (Jacobi). */
static double largest_eigenvalue(double M[9][9]) {
    double most = -INFINITY;
    for (int turn = 0; turn < 50; turn++)
        for (int p = 0; p < 9; p++)
            for (int q = p + 1; q < 9; q++) {
                if (M[p][q] == 0) continue;
                double theta = (M[q][q] - M[p][p]) / (2 * M[p][q]);
                double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                double c = 1 / sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 9; k++) {
                    double a = M[k][p], b = M[k][q];
                    M[k][p] = c * a - s * b, M[k][q] = s * a + c * b;
                }
                for (int k = 0; k < 9; k++) {
                    double a = M[p][k], b = M[q][k];
                    M[p][k] = c * a - s * b, M[q][k] = s * a + c * b;
                }
            }
    for (int i = 0; i < 9; i++) most = fmax(most, M[i][i]);
    return most;
}

static lar_material material_of(int law, double shear, double poisson) {
    lar_material material = {.law = (lar_law)law, .density = 1000};
    double bulk = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson));
    lar_law_table[law].from_moduli(shear, bulk, material.parameter);
    return material;
}

static double numbers_of(const double F[3][3], float strain[LAR_STRAIN_NUMBERS]) {
    double J = 0, length = 0, area = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
            double cof = F[k][m] * F[l][n] - F[k][n] * F[l][m];
            if (i == 0) J += F[0][j] * cof;
            length += F[i][j] * F[i][j];
            area += cof * cof;
        }
    memcpy(strain, (float[]){(float)J, (float)length, (float)area, 0}, 4 * sizeof *strain);
    return J;
}

static void random_gradient(uint64_t *random, double size, double F[3][3]) {
    double R[3][3], S[3][3];
    random_rotation(random, R);
    random_fill(random, size, S[0], 9);
    for (int i = 0; i < 3; i++) S[i][i] += 1;
    multiply((rows)R, (rows)S, F);
}

/* Of a cube it is what all eigenvalues of the tangent say, whatever the law. */
static void it_is_the_largest_eigenvalue(void **unused) {
    (void)unused;
    uint64_t random = 4;
    const double limit = lar_compressible_limit(LAR_STRAINED_AREA);
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        double off = 0, means = 0;
        for (int n = 0; n < 4000; n++) {
            const double poisson = 0.35 * fabs(random_value(&random)), shear = 2e3;
            lar_material material = material_of(law, shear, poisson);
            double bulk = lar_material_instant_bulk(&material), F[3][3], A[9][9];
            float strain[LAR_STRAIN_NUMBERS];
            random_gradient(&random, 0.02 * (n % 20), F);
            double J = numbers_of((rows)F, strain);
            if (J < 0.35 || strain[LAR_STRAIN_AREA] > 12 * J * J) continue;
            lar_law_table[law].tangent(material.parameter, &F[0][0], A);
            double exact = largest_eigenvalue(A) / fmax(3 * bulk, 2 * shear);
            double growth = lar_compressible_growth(&material, limit, strain);
            lar_hex8_stiff stiff;
            lar_hex8_stiff_begin(&material, &stiff);
            lar_hex8_stiff_of(&material, strain, &stiff);
            off = fmax(off, fabs(growth / exact - 1));
            means = fmax(means, exact / lar_hex8_growth(&stiff, strain[LAR_STRAIN_AREA] / 3.0));
        }
        print_message("%-20s off by %.1e at most; means over directions by a factor of %.2f\n",
                      lar_law_name[law], off, means);
        assert_below(off, 2e-3);
    }
}

/* At rest nothing has grown, of flat elements neither; and they are told from others. */
static void at_rest_it_is_one(void **unused) {
    (void)unused;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int n = 0; n < 8; n++) {
            lar_material material = material_of(law, 1e3, 0.05 * n);
            const float strain[LAR_STRAIN_NUMBERS] = {1, 3, 3, 0};
            double cube = lar_compressible_limit(LAR_STRAINED_AREA);
            double flat = lar_compressible_limit(3.3);
            assert_true(cube < flat && flat < -3);
            assert_true(lar_material_compressible(&material) == (0.05 * n < 0.385));
            assert_below(fabs(lar_compressible_growth(&material, cube, strain) - 1), 1e-3);
            assert_below(fabs(lar_compressible_growth(&material, flat, strain) - 1), 1e-3);
        }
}

/* Terms that relax stand beside: of the whole stress nothing changes, of the isochoric part shear
 * is as much stiffer as at rest. */
static void terms_count_at_once(void **unused) {
    (void)unused;
    uint64_t random = 5;
    const double limit = lar_compressible_limit(LAR_STRAINED_AREA);
    for (int n = 0; n < 1000; n++) {
        lar_material material = material_of(LAR_LAW_neo_hookean, 1e3, 0.2), more = material;
        lar_material stiffer = material;
        float strain[LAR_STRAIN_NUMBERS];
        double F[3][3];
        random_gradient(&random, 0.3, F);
        if (numbers_of((rows)F, strain) < 0.4) continue;
        more.viscosity = (lar_viscosity){.terms = 1, .rest = 1, .share = {2}, .time = {1}};
        double elastic = lar_compressible_growth(&material, limit, strain);
        assert_below(fabs(lar_compressible_growth(&more, limit, strain) / elastic - 1), 1e-12);
        more.viscosity.isochoric = true;
        stiffer.parameter[0] *= 3;
        double isochoric = lar_compressible_growth(&stiffer, limit, strain);
        assert_below(fabs(lar_compressible_growth(&more, limit, strain) / isochoric - 1), 1e-6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_the_largest_eigenvalue),
        cmocka_unit_test(at_rest_it_is_one),
        cmocka_unit_test(terms_count_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
