/* What keeps flat elements from folding, as plain numbers: forces are the derivative of the energy
 * and turn with the element, and nothing happens where nothing should. That the kernels say the
 * same is in tests/engine/test_fold.c. */
#include "mechanics/fold/hex8_fold.h"
#include "mechanics/mechanics_test.h"

static const double SIDE = 0.01, SHEAR = 1e3;

/* No box, flat along its last axis. */
static void flat_corners(uint64_t *random, double flat, double corner[8][3]) {
    random_fill(random, 0.05, corner[0], 24);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            corner[a][i] = SIDE * (corner[a][i] + 0.5 * lar_node_sign[a][i]) / (i == 2 ? flat : 1);
}

static lar_material tissue(double bulk) {
    lar_material material = {.law = LAR_LAW_neo_hookean, .density = 1000};
    lar_material_from_shear_bulk(&material, SHEAR, SHEAR * bulk);
    return material;
}

/* Pressed together by so much of the volume, and bent. */
static void pressed_displacements(uint64_t *random, const double corner[8][3], double pressed,
                                  double bent, double u[8][3]) {
    random_fill(random, bent, u[0], 24);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            u[a][i] = u[a][i] * fabs(corner[a][i]) - pressed / 3 * corner[a][i];
}

static void forces_are_the_derivative_of_the_energy(void **unused) {
    (void)unused;
    const lar_material material = tissue(100);
    const double step = 1e-8 * SIDE, scale = 100 * SHEAR * SIDE * SIDE;
    uint64_t random = 1;
    int active = 0;
    for (int n = 0; n < 200; n++) {
        double corner[8][3], u[8][3], force[8][3] = {{0}}, worst = 0;
        flat_corners(&random, 2 + n % 5, corner);
        pressed_displacements(&random, (rows)corner, 0.02 * (n % 7), 0.3, u);
        active += lar_hex8_fold_force((rows)corner, &material, (rows)u, force) > 0;
        for (int k = 0; k < 24; k++) {
            double *value = &u[k / 3][k % 3], at = *value;
            *value = at + step;
            double ahead = lar_hex8_fold_force((rows)corner, &material, (rows)u, NULL);
            *value = at - step;
            double behind = lar_hex8_fold_force((rows)corner, &material, (rows)u, NULL);
            *value = at;
            worst = fmax(worst, fabs((ahead - behind) / (2 * step) - force[k / 3][k % 3]));
        }
        assert_below(worst, 1e-7 * scale);
    }
    print_message("%d of 200 at work\n", active);
    assert_true(active > 100);
}

static void it_turns_with_the_element(void **unused) {
    (void)unused;
    const lar_material material = tissue(100);
    uint64_t random = 2;
    for (int n = 0; n < 50; n++) {
        double corner[8][3], u[8][3], turned[8][3], R[3][3], force[8][3] = {{0}},
                                                             other[8][3] = {{0}};
        flat_corners(&random, 4, corner);
        pressed_displacements(&random, (rows)corner, 0.1, 0.2, u);
        random_rotation(&random, R);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                turned[a][i] = -corner[a][i];
                for (int j = 0; j < 3; j++) turned[a][i] += R[i][j] * (corner[a][j] + u[a][j]);
            }
        double energy = lar_hex8_fold_force((rows)corner, &material, (rows)u, force);
        assert_below(
            fabs(lar_hex8_fold_force((rows)corner, &material, (rows)turned, other) - energy),
            1e-12 * 100 * SHEAR * SIDE * SIDE * SIDE);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) other[a][i] -= R[i][j] * force[a][j];
                assert_below(fabs(other[a][i]), 1e-12 * 100 * SHEAR * SIDE * SIDE);
            }
    }
}

/* Energy of an element so flat, so pressed and bent along what is flat, of tissue so
 * incompressible. */
static double energy_of(double flat, double bulk, double pressed, double bent) {
    const lar_material material = tissue(bulk);
    uint64_t random = 3;
    double corner[8][3], u[8][3];
    flat_corners(&random, flat, corner);
    pressed_displacements(&random, (rows)corner, pressed, 0, u);
    for (int a = 0; a < 8; a++)
        u[a][2] += 0.5 * bent * SIDE / flat * lar_node_sign[a][0] * lar_node_sign[a][2];
    return lar_hex8_fold_force((rows)corner, &material, (rows)u, NULL);
}

static void nothing_happens_elsewhere(void **unused) {
    (void)unused;
    assert_true(energy_of(4, 100, 0.05, 0.1) > 0);
    assert_true(energy_of(4, 100, 0.05, 0) == 0);     /* pressed alone */
    assert_true(energy_of(4, 100, -0.05, 0.1) == 0);  /* pulled */
    assert_true(energy_of(4, 100, 0, 0.03) == 0);     /* bent a little */
    assert_true(energy_of(4, 100, 0, 0.2) > 0);       /* and more */
    assert_true(energy_of(1.2, 100, 0.05, 0.1) == 0); /* not flat */
    assert_true(energy_of(4, 19, 0.05, 0.1) == 0);    /* not so incompressible */
    assert_true(energy_of(0.4, 100, 0.05, 0.1) > 0);  /* long is flat as well */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_the_derivative_of_the_energy),
        cmocka_unit_test(it_turns_with_the_element),
        cmocka_unit_test(nothing_happens_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
