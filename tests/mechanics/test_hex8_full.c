/* The eight-point element: patch test, slopes of the energy, stress, frequency, and equilibrium
 * of the fields that FEBio and CalculiX found with the same element. */
#include "mechanics_test.h"

#include "mechanics/hex8_full.h"
#include "mechanics/hexahedron.h"

enum { ELEMENTS = 60 };
static const double size = 0.01; /* m */

/* What forces are measured by: the modulus of a layer times the area of a face. */
static double characteristic_force(const lar_material *material) {
    return layer_modulus(material) * size * size;
}

/* The 2x2x2 rule: sum of gradients zero, sum x_a (x) grad N_a = I, volumes right. */
static void geometry(void **state) {
    (void)state;
    uint64_t seed = 21;
    for (int e = 0; e < ELEMENTS; e++) {
        double corner[8][3], volume = 0;
        if (e)
            random_corners(&seed, size, 0.2, corner);
        else
            box_corners(0.01, 0.02, 0.03, corner);
        for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
            double at[3], slope[8][3], J[3][3];
            lar_gauss_point(g, at);
            double det = lar_hexahedron_gradients((rows)corner, at, slope);
            lar_hexahedron_jacobian((rows)corner, at, J);
            assert_below(fabs(det - determinant((rows)J)), 1e-15 * size * size * size);
            assert_true(det > 0);
            volume += det;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    double sum = 0, product = 0;
                    for (int a = 0; a < 8; a++) {
                        sum += slope[a][j];
                        product += corner[a][i] * slope[a][j];
                    }
                    assert_below(fabs(sum) * size, 1e-13);
                    assert_below(fabs(product - (i == j)), 1e-13);
                }
        }
        if (e == 0) assert_below(fabs(volume - 6e-6), 1e-20);
    }
}

static void force_is_energy_slope(void **state) {
    (void)state;
    uint64_t seed = 22;
    double worst = 0;
    for (int e = 0; e < ELEMENTS; e++) {
        lar_material material = test_material(e % LAR_LAW_COUNT, 1000, 5000);
        double corner[8][3], u[8][3], force[8][3], slope[8][3];
        random_corners(&seed, size, 0.2, corner);
        random_fill(&seed, 0.08 * size, &u[0][0], 24);
        double J = lar_hex8_full_force((rows)corner, &material, (rows)u, force);
        assert_true(J > 0.05);
        for (int k = 0; k < 24; k++) {
            const double step = 1e-5 * size;
            double kept = u[k / 3][k % 3];
            u[k / 3][k % 3] = kept + step;
            double above = lar_hex8_full_energy((rows)corner, &material, (rows)u);
            u[k / 3][k % 3] = kept - step;
            double below = lar_hex8_full_energy((rows)corner, &material, (rows)u);
            u[k / 3][k % 3] = kept;
            slope[k / 3][k % 3] = (above - below) / (2 * step);
        }
        double error = largest_difference(&force[0][0], &slope[0][0], 24);
        worst = fmax(worst, error / characteristic_force(&material));
    }
    print_message("worst difference to the energy's slope %.1e\n", worst);
    assert_below(worst, 1e-7);
}

/* Translation and any rotation: no force. Forces always add up to zero, and so do moments about
 * the deformed positions. */
static void rigid_motion_and_balance(void **state) {
    (void)state;
    uint64_t seed = 23;
    for (int e = 0; e < ELEMENTS; e++) {
        lar_material material = test_material(e % LAR_LAW_COUNT, 4e3, 2e6);
        double corner[8][3], R[3][3], shift[3], u[8][3], force[8][3];
        double scale = characteristic_force(&material);
        random_corners(&seed, size, 0.2, corner);
        random_rotation(&seed, R);
        random_fill(&seed, size, shift, 3);
        affine((rows)R, shift, 8, (rows)corner, u);
        lar_hex8_full_force((rows)corner, &material, (rows)u, force);
        assert_below(largest(&force[0][0], 24), 1e-12 * scale);

        double strain[8][3];
        random_fill(&seed, 0.05 * size, &strain[0][0], 24);
        for (int k = 0; k < 24; k++) u[k / 3][k % 3] += strain[k / 3][k % 3];
        lar_hex8_full_force((rows)corner, &material, (rows)u, force);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double sum = 0, moment = 0;
            for (int a = 0; a < 8; a++) {
                sum += force[a][i];
                moment +=
                    (corner[a][j] + u[a][j]) * force[a][k] - (corner[a][k] + u[a][k]) * force[a][j];
            }
            assert_below(fabs(sum), 1e-12 * scale);
            assert_below(fabs(moment), 1e-12 * scale * size);
        }
    }
}

/* Eight distorted elements around one inner node, deformed affinely: the inner node feels nothing
 * and every element reports the same stress. */
static void patch(void **state) {
    (void)state;
    uint64_t seed = 24;
    const double none[3] = {0};
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 1000, 50000);
        double x[27][3], u[27][3], sum[3] = {0}, F[3][3], P[3][3], exact[6];
        for (int n = 0; n < 27; n++) {
            const int at[3] = {n % 3, n / 3 % 3, n / 9};
            for (int i = 0; i < 3; i++) x[n][i] = size * (at[i] + 0.2 * random_value(&seed));
        }
        random_deformation(&seed, 0.3, F);
        double J = lar_law_stress(&material, (rows)F, P);
        lar_cauchy_stress((rows)F, (rows)P, J, exact);
        affine((rows)F, none, 27, (rows)x, u);
        for (int e = 0; e < 8; e++) {
            double corner[8][3], here[8][3], force[8][3], cauchy[6];
            int inner = 0;
            for (int a = 0; a < 8; a++) {
                int n = 0, stride = 1;
                for (int i = 0; i < 3; i++, stride *= 3)
                    n += stride * ((e >> i & 1) + (lar_node_sign[a][i] > 0));
                memcpy(corner[a], x[n], sizeof x[n]);
                memcpy(here[a], u[n], sizeof u[n]);
                if (n == 13) inner = a;
            }
            double min = lar_hex8_full_force((rows)corner, &material, (rows)here, force);
            assert_below(fabs(min - J), 1e-12 * J);
            for (int i = 0; i < 3; i++) sum[i] += force[inner][i];
            lar_hex8_full_stress((rows)corner, &material, (rows)here, cauchy);
            assert_below(largest_difference(cauchy, exact, 6),
                         1e-12 * (layer_modulus(&material) + largest(exact, 6)));
        }
        assert_below(largest(sum, 3),
                     1e-12 * (largest(&P[0][0], 9) + layer_modulus(&material)) * size * size);
    }
}

/* Linear stiffness by central differences of the force at rest. */
static void stiffness_at_rest(rows corner, const lar_material *material, double *K, int stride,
                              const int *node) {
    const double step = 1e-6 * size;
    for (int m = 0; m < 24; m++) {
        double u[8][3] = {{0}}, above[8][3], below[8][3];
        u[m / 3][m % 3] = step;
        lar_hex8_full_force(corner, material, (rows)u, above);
        u[m / 3][m % 3] = -step;
        lar_hex8_full_force(corner, material, (rows)u, below);
        for (int n = 0; n < 24; n++)
            K[(3 * node[n / 3] + n % 3) * stride + 3 * node[m / 3] + m % 3] +=
                (above[n / 3][n % 3] - below[n / 3][n % 3]) / (2 * step);
    }
}

static double volume_of(rows corner) {
    double volume = 0, at[3], slope[8][3];
    for (int g = 0; g < LAR_GAUSS_POINTS; g++) {
        lar_gauss_point(g, at);
        volume += lar_hexahedron_gradients(corner, at, slope);
    }
    return volume;
}

/* The bound holds for the element alone, closely, and for any two elements together. */
static void frequency(void **state) {
    (void)state;
    static const int own[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    uint64_t seed = 25;
    double closest = INFINITY;
    for (int pair = 0; pair < 12; pair++) {
        lar_material material = test_material(pair % LAR_LAW_COUNT, 4e3, pair % 2 ? 2e6 : 1e4);
        double x[PAIR_NODES][3], mass[PAIR_NODES] = {0}, both[PAIR_FREEDOMS * PAIR_FREEDOMS] = {0};
        double bound = 0;
        random_pair(&seed, size, pair ? 0.2 : 0, x);
        for (int e = 0; e < 2; e++) {
            double corner[8][3], single[24 * 24] = {0};
            pair_corners((rows)x, e, corner);
            double node_mass = material.density * volume_of((rows)corner) / 8;
            double omega = lar_hex8_full_frequency((rows)corner, &material);
            stiffness_at_rest((rows)corner, &material, single, 24, own);
            double exact = sqrt(jacobi_largest(single, 24) / node_mass);
            assert_below(exact, omega * (1 + 1e-7));
            assert_below(omega, 1.002 * exact);
            stiffness_at_rest((rows)corner, &material, both, PAIR_FREEDOMS, pair_node[e]);
            for (int a = 0; a < 8; a++) mass[pair_node[e][a]] += node_mass;
            bound = fmax(bound, omega);
        }
        for (int n = 0; n < PAIR_FREEDOMS; n++)
            for (int m = 0; m < PAIR_FREEDOMS; m++)
                both[n * PAIR_FREEDOMS + m] /= sqrt(mass[n / 3] * mass[m / 3]);
        double joined = sqrt(jacobi_largest(both, PAIR_FREEDOMS));
        assert_below(joined, bound);
        closest = fmin(closest, bound / joined);
    }
    print_message("bound at least %.3f of two elements' frequency\n", closest);
}

/* A determinant that is not a number, at any Gauss point, is not hidden by the others. */
static void bad_deformation_shows(void **state) {
    (void)state;
    double corner[8][3], force[8][3];
    box_corners(size, size, size, corner);
    for (int n = 0; n < 8 * LAR_LAW_COUNT; n++) {
        lar_material material = test_material(n / 8, 4e3, 2e5);
        double u[8][3] = {{0}}, *x = u[n % 8];
        x[0] = -2.5 * lar_node_sign[n % 8][0] * size;
        assert_true(lar_hex8_full_force((rows)corner, &material, (rows)u, force) < 0);
        x[0] = NAN;
        assert_true(isnan(lar_hex8_full_force((rows)corner, &material, (rows)u, force)));
    }
}

/* The displacements of another program are in equilibrium here: internal forces of all elements
 * equal its reactions plus `weight` per volume in -z, to the digits of the file. */
static void check_equilibrium(const char *mesh, const char *field, double bulk, double weight,
                              double tolerance) {
    static reference r;
    if (!read_reference(mesh, field, &r)) skip();
    lar_material material = {.law = LAR_LAW_neo_hookean, .density = 1000};
    lar_material_from_shear_bulk(&material, bulk == 10000 ? 3000 / 2.9 : 3000 / 2.98, bulk);
    double(*rest)[3] = calloc((size_t)r.nodes, sizeof *rest), max = 0, total = 0;
    assert_non_null(rest);
    for (int e = 0; e < r.elements; e++) {
        double corner[8][3], u[8][3], force[8][3];
        for (int a = 0; a < 8; a++) {
            memcpy(corner[a], r.x[r.element[e][a]], sizeof corner[a]);
            memcpy(u[a], r.u[r.element[e][a]], sizeof u[a]);
        }
        assert_true(lar_hex8_full_force((rows)corner, &material, (rows)u, force) > 0);
        double share = weight * volume_of((rows)corner) / 8;
        for (int a = 0; a < 8; a++) {
            for (int i = 0; i < 3; i++) rest[r.element[e][a]][i] += force[a][i];
            rest[r.element[e][a]][2] += share; /* no other force: f = reaction - share e_z */
        }
    }
    for (int n = 0; n < r.nodes; n++)
        for (int i = 0; i < 3; i++) {
            max = fmax(max, fabs(rest[n][i] - r.reaction[n][i]));
            total = fmax(total, fabs(r.reaction[n][i]));
        }
    free(rest);
    print_message("%s: out of balance by %.1e of the largest reaction\n", field, max / total);
    assert_below(max, tolerance * total);
}

static void febio_beam(void **state) {
    (void)state;
    check_equilibrium("c_beam_20x2x2", "c_beam_inh_nu45_20x2x2_full_t0.01", 10000, 98.1, 1e-5);
    check_equilibrium("c_beam_20x2x2", "c_beam_inh_nu49_20x2x2_full_t1", 50000, 9810, 1e-5);
}

static void calculix_cube(void **state) {
    (void)state;
    check_equilibrium("e1_cube_4x4x4", "e1_shear_inh_nu45_C3D8_t1", 10000, 0, 1e-5);
    check_equilibrium("a_2x2x2", "a_uniax_inh_nu49_C3D8_t1", 50000, 0, 1e-5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(geometry),
        cmocka_unit_test(force_is_energy_slope),
        cmocka_unit_test(rigid_motion_and_balance),
        cmocka_unit_test(patch),
        cmocka_unit_test(frequency),
        cmocka_unit_test(bad_deformation_shows),
        cmocka_unit_test(febio_beam),
        cmocka_unit_test(calculix_cube),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
