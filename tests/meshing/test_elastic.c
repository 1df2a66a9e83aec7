/* Small displacements against the production element, and solutions against their own equations. */
#include "bars.h"

#include "base/parallel_for.h"
#include "base/vector.h"
#include "mechanics/hex8.h"
#include "meshing/starter/elastic_coarse.h"

static lar_error error;
static const double G = 3000, K = 29000;

static lar_mesh cube_mesh(double (*x)[3], int32_t (*element)[8], double distortion) {
    for (int a = 0; a < 8; a++) {
        element[0][a] = a;
        for (int i = 0; i < 3; i++)
            x[a][i] = 0.005 * lar_node_sign[a][i] + distortion * sin(7.0 * a + 3.1 * i);
    }
    return (lar_mesh){.node_count = 8, .element_count = 1, .element = element, .position = x};
}

/* The largest difference to the production element's forces under small displacements, over the
 * largest force. `linear`: displacements of a linear field, otherwise any. */
static double difference(double distortion, bool linear, bool own) {
    double x[8][3], u[8][3], exact[8][3], matrix[24][24], max = 0, apart = 0;
    int32_t element[1][8];
    uint8_t held[8] = {LAR_AXIS_ALL};
    const lar_elastic_material soft = {G, K, own};
    lar_mesh mesh = cube_mesh(x, element, distortion);
    lar_elastic elastic;
    lar_hex8 production;
    lar_material material = {.law = LAR_LAW_coupled_neo_hookean, .density = 1};
    assert_int_equal(lar_elastic_create(&mesh, &soft, held, NULL, &elastic, &error), LAR_OK);
    lar_elastic_element_matrix(elastic.element, matrix);
    lar_material_from_shear_bulk(&material, G, K);
    lar_hex8_prepare((const double(*)[3])x, &material, &production);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            u[a][i] = linear ? 1e-6 * (x[a][0] - 2 * x[a][1] * (i + 1) + 0.3 * i * x[a][2])
                             : 1e-9 * sin(3.7 * a + 1.9 * i);
    lar_hex8_force(&production, &material, (const double(*)[3])u, exact);
    for (int row = 0; row < 24; row++) {
        double sum = 0;
        for (int k = 0; k < 24; k++) sum += matrix[row][k] * u[k / 3][k % 3];
        max = fmax(max, fabs(exact[row / 3][row % 3]));
        apart = fmax(apart, fabs(sum - exact[row / 3][row % 3]));
    }
    free(elastic.element);
    return apart / max;
}

static void it_is_the_production_element(void **state) {
    (void)state;
    assert_below(difference(0, false, false), 1e-5);      /* a cube */
    assert_below(difference(0.0008, true, false), 1e-5);  /* any shape, its mean strain */
    assert_below(difference(0.0008, false, false), 0.05); /* hourglass springs as in a cube */
    assert_below(difference(0.0008, false, true), 1e-5);  /* its own */
}

static uint8_t *still_of(const bool *held) {
    static uint8_t still[BAR_NODES];
    for (int n = 0; n < BAR_NODES; n++) still[n] = held[n] ? LAR_AXIS_ALL : 0;
    return still;
}

/* The body's forces under all loads, two at a time. */
static void find_forces(const lar_elastic *elastic, const lar_load_vectors *u,
                        lar_load_vectors *f) {
    static lar_pair_vectors two[BAR_NODES], back[BAR_NODES];
    for (int k = 0; k < LAR_PAIRS; k++) {
        for (int n = 0; n < BAR_NODES; n++)
            for (int i = 0; i < 3; i++)
                for (int l = 0; l < 2; l++) two[n][i][l] = u[n][i][2 * k + l];
        lar_elastic_forces(elastic, (const lar_pair_vectors *)two, back);
        for (int n = 0; n < BAR_NODES; n++)
            for (int i = 0; i < 3; i++)
                for (int l = 0; l < 2; l++) f[n][i][2 * k + l] = back[n][i][l];
    }
}

/* Every load does the work that it is said to, and the equations hold in the mean; so it does when
 * the same is solved again after others, on any number of cores. */
static void solutions_fulfil_their_equations(void **state) {
    (void)state;
    static lar_load_vectors f[BAR_NODES], u[BAR_NODES], back[BAR_NODES];
    static lar_elastic_material soft[BAR_LONG * BAR_WIDE * BAR_WIDE];
    static bool held[BAR_NODES];
    lar_meshing m = bar(BAR_SIDE);
    lar_elastic elastic;
    lar_elastic_solver *solver = NULL;
    double work[LAR_LOADS], again[LAR_LOADS];
    for (int32_t e = 0; e < m.mesh.element_count; e++)
        soft[e] = (lar_elastic_material){G, K, false};
    bar_mark(&m, 0, held);
    for (int n = 0; n < BAR_NODES; n++)
        for (int i = 0; i < 3; i++)
            LAR_EACH_LOAD f[n][i][l] = i == l ? 1e-6 : l == 3 ? 1e-6 * sin(n + i) : 0;
    assert_int_equal(lar_elastic_create(&m.mesh, soft, still_of(held), NULL, &elastic, &error),
                     LAR_OK);
    assert_int_equal(lar_elastic_solver_create(&elastic, &solver, &error), LAR_OK);
    assert_int_equal(lar_elastic_solve(solver, (const lar_load_vectors *)f, u, work, &error),
                     LAR_OK);
    find_forces(&elastic, (const lar_load_vectors *)u, back);
    LAR_EACH_LOAD {
        double done = 0, stored = 0;
        for (int n = 0; n < BAR_NODES; n++)
            for (int i = 0; i < 3; i++) {
                done += f[n][i][l] * u[n][i][l];
                stored += back[n][i][l] * u[n][i][l];
            }
        assert_below(fabs(work[l] / done - 1), 1e-6);
        assert_below(fabs(stored / done - 1), 1e-6);
    }
    /* What of the force is not balanced would move it by little more. */
    double rest[LAR_LOADS];
    for (int n = 0; n < BAR_NODES; n++)
        for (int i = 0; i < 3; i++)
            LAR_EACH_LOAD back[n][i][l] = held[n] ? 0 : f[n][i][l] - back[n][i][l];
    assert_int_equal(lar_elastic_solve(solver, (const lar_load_vectors *)back, u, rest, &error),
                     LAR_OK);
    LAR_EACH_LOAD assert_below(rest[l], 0.02 * work[l]);
    for (int threads = 1; threads <= 3; threads++) {
        lar_parallel_for_threads(threads);
        assert_int_equal(lar_elastic_solve(solver, (const lar_load_vectors *)f, u, again, &error),
                         LAR_OK);
        assert_memory_equal(again, work, sizeof work);
    }
    lar_parallel_for_threads(0);
    lar_elastic_solver_destroy(solver);
    free(elastic.element);
}

/* A motion of every group as a rigid body is found at once from the forces that it needs. */
static void motions_of_groups_are_solved_directly(void **state) {
    (void)state;
    static lar_pair_vectors u[BAR_NODES], f[BAR_NODES], z[BAR_NODES];
    static lar_pair way[LAR_RIGID * BAR_NODES];
    static lar_elastic_material soft[BAR_LONG * BAR_WIDE * BAR_WIDE];
    static bool held[BAR_NODES];
    lar_meshing m = bar(BAR_SIDE);
    lar_elastic elastic;
    lar_coarse coarse;
    double apart = 0;
    memset(z, 0, sizeof z);
    for (int32_t e = 0; e < m.mesh.element_count; e++)
        soft[e] = (lar_elastic_material){G, K, false};
    bar_mark(&m, 0, held);
    assert_int_equal(lar_elastic_create(&m.mesh, soft, still_of(held), NULL, &elastic, &error),
                     LAR_OK);
    assert_int_equal(lar_coarse_create(&elastic, &coarse, &error), LAR_OK);
    assert_in_range(coarse.group_count, 10, 400);
    for (int n = 0; n < BAR_NODES; n++) {
        const int32_t g = coarse.group[n];
        assert_true(held[n] ? g < 0 : g >= 0);
        for (int l = 0; l < 2; l++) {
            const double turn[3] = {sin(g + l), cos(2.0 * g), sin(3.0 * g - l)};
            double turned[3];
            lar_cross(turn, coarse.arm[n], turned);
            for (int i = 0; i < 3; i++) u[n][i][l] = g < 0 ? 0 : cos(5.0 * g + i * l) + turned[i];
        }
    }
    lar_elastic_forces(&elastic, (const lar_pair_vectors *)u, f);
    lar_coarse_add(&coarse, way, (const lar_pair_vectors *)f, z);
    for (int n = 0; n < BAR_NODES; n++)
        for (int i = 0; i < 3; i++)
            for (int l = 0; l < 2; l++) apart = fmax(apart, fabs(z[n][i][l] - u[n][i][l]));
    assert_below(apart, 1e-6);
    lar_coarse_clear(&coarse);
    free(elastic.element);
}

static void what_hangs_loose_is_still(void **state) {
    (void)state;
    double x[16][3];
    int32_t element[2][8];
    uint8_t held[16] = {LAR_AXIS_ALL, LAR_AXIS_ALL, LAR_AXIS_ALL, LAR_AXIS_ALL};
    const lar_elastic_material soft[2] = {{G, K, false}, {G, K, false}};
    cube_mesh(x, element, 0);
    cube_mesh(x + 8, element + 1, 0);
    for (int a = 0; a < 8; a++) element[1][a] += 8;
    const lar_mesh mesh = {.node_count = 16, .element_count = 2, .element = element, .position = x};
    lar_elastic elastic;
    assert_int_equal(lar_elastic_create(&mesh, soft, held, NULL, &elastic, &error), LAR_OK);
    assert_int_equal(elastic.element_count, 1);
    for (int n = 0; n < 16; n++)
        assert_int_equal(elastic.still[n], n < 4 || n > 7 ? LAR_AXIS_ALL : 0);
    free(elastic.element);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_the_production_element),
        cmocka_unit_test(solutions_fulfil_their_equations),
        cmocka_unit_test(motions_of_groups_are_solved_directly),
        cmocka_unit_test(what_hangs_loose_is_still),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
