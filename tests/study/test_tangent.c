/* The consistent tangent: against finite differences of the element's own forces, symmetric, blind
 * to rigid motion where there is no stress; for every law, on distorted and deformed elements. */
#include "mechanics/mechanics_test.h"

#include "study/implicit/tangent.h"

enum { ELEMENTS = 40 };
static const double size = 0.01; /* m */

/* Distorted elements of three laws, far from rest: F about 1 + 0.25 random. */
static void random_element(uint64_t *seed, int law, double amount, lar_material *material,
                           lar_hex8 *element, double u[8][3]) {
    double corner[8][3];
    *material = test_material(law, 4e3, 1e5);
    random_corners(seed, size, 0.25, corner);
    lar_hex8_prepare((rows)corner, material, element);
    random_fill(seed, amount * size, &u[0][0], 24);
}

/* Central differences of fourth order, (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12h: with h = 1e-4
 * of the element's size the error of the differences is near 1e-12 of the stiffness, and that of
 * rounding, too. */
static void difference(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                       int column, double slope[24]) {
    static const double weight[4] = {8, -8, -1, 1}, at[4] = {1, -1, 2, -2};
    double h = 1e-4 * size;
    memset(slope, 0, 24 * sizeof slope[0]);
    for (int n = 0; n < 4; n++) {
        double moved[8][3], force[8][3];
        memcpy(moved, u, sizeof moved);
        moved[column / 3][column % 3] += at[n] * h;
        lar_hex8_force(element, material, (rows)moved, force);
        for (int r = 0; r < 24; r++) slope[r] += weight[n] * force[r / 3][r % 3] / (12 * h);
    }
}

static void derivative_of_the_forces(void **state) {
    (void)state;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        uint64_t seed = 7;
        double worst = 0, skew = 0;
        for (int e = 0; e < ELEMENTS; e++) {
            lar_material material;
            lar_hex8 element;
            double u[8][3], K[24][24], slope[24];
            random_element(&seed, law, 0.15, &material, &element, u);
            assert_true(lar_hex8_tangent(&element, &material, (rows)u, K) > 0);
            double scale = largest(&K[0][0], 24 * 24);
            for (int c = 0; c < 24; c++) {
                difference(&element, &material, (rows)u, c, slope);
                for (int r = 0; r < 24; r++) {
                    worst = fmax(worst, fabs(K[r][c] - slope[r]) / scale);
                    skew = fmax(skew, fabs(K[r][c] - K[c][r]) / scale);
                }
            }
        }
        print_message("%s: differences %.1e, asymmetry %.1e\n", lar_law_name[law], worst, skew);
        assert_below(worst, 1e-9);
        assert_below(skew, 1e-14);
    }
}

/* At rest: Hooke's law by the moduli of the material, the same for every law. */
static void at_rest_all_laws_agree(void **state) {
    (void)state;
    static const double one[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 4e3, 1e5);
        double A[9][9], G = lar_material_shear(&material), K = lar_material_bulk(&material);
        lar_law_tangent(&material, one, A);
        for (int r = 0; r < 9; r++)
            for (int s = 0; s < 9; s++) {
                int i = r / 3, j = r % 3, k = s / 3, l = s % 3;
                double hooke = (i == j && k == l) * (K - 2 * G / 3) +
                               G * ((i == k && j == l) + (i == l && j == k));
                assert_below(fabs(A[r][s] - hooke), 1e-10 * K);
            }
    }
}

/* Without stress no force answers to a small translation or rotation. */
static void rigid_motion_is_free(void **state) {
    (void)state;
    uint64_t seed = 11;
    double worst = 0;
    for (int e = 0; e < ELEMENTS; e++) {
        lar_material material = test_material(e % LAR_LAW_COUNT, 4e3, 1e5);
        lar_hex8 element;
        double corner[8][3], K[24][24], motion[24], still[8][3] = {{0}}, move[3], turn[3];
        random_corners(&seed, size, 0.25, corner);
        lar_hex8_prepare((rows)corner, &material, &element);
        lar_hex8_tangent(&element, &material, (rows)still, K);
        random_fill(&seed, size, move, 3);
        random_fill(&seed, 1, turn, 3);
        for (int k = 0; k < 24; k++) {
            int i = k % 3, j = (i + 1) % 3, m = (i + 2) % 3;
            motion[k] = move[i] + turn[j] * corner[k / 3][m] - turn[m] * corner[k / 3][j];
        }
        double scale = largest(&K[0][0], 24 * 24) * size;
        for (int r = 0; r < 24; r++) {
            double force = 0;
            for (int c = 0; c < 24; c++) force += K[r][c] * motion[c];
            worst = fmax(worst, fabs(force) / scale);
        }
    }
    assert_below(worst, 1e-13);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivative_of_the_forces),
        cmocka_unit_test(at_rest_all_laws_agree),
        cmocka_unit_test(rigid_motion_is_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
