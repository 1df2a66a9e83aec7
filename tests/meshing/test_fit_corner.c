/* The energy of a corner, its derivatives, and a sweep over one cube. */
#include "shapes.h"

#include "base/vector.h"
#include "meshing/fit/work.h"

static double energy_moved(const lar_fit_law *law, const double edge[3][3], int moves, int axis,
                           double by) {
    double moved[3][3];
    for (int k = 0; k < 3; k++) memcpy(moved[k], edge[k], sizeof moved[k]);
    for (int k = 0; k < 3; k++) {
        if (moves == LAR_FIT_MOVES_CORNER)
            moved[k][axis] -= by;
        else if (moves == k)
            moved[k][axis] += by;
    }
    return lar_fit_corner_energy(law, (const double(*)[3])moved);
}

static void assert_derivatives(const lar_fit_law *law, const double edge[3][3], int moves) {
    const double by = 1e-4;
    const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    lar_fit_newton newton = {0};
    lar_fit_corner_newton(law, edge, moves, &newton);
    const double value = lar_fit_corner_energy(law, edge);
    assert_below(fabs(newton.value - value), 1e-12 * (1 + fabs(value)));
    for (int i = 0; i < 3; i++) {
        double up = energy_moved(law, edge, moves, i, by);
        double down = energy_moved(law, edge, moves, i, -by);
        double slope = (up - down) / (2 * by), curve = (up - 2 * value + down) / (by * by);
        assert_below(fabs(slope - newton.gradient[i]), 1e-4 * (1 + fabs(slope)));
        assert_below(fabs(curve - newton.hessian[i]), 1e-3 * (1 + fabs(curve)));
        for (int j = 0; j < 3; j++) {
            if (i == j) continue;
            lar_fit_newton ahead = {0}, behind = {0};
            double moved[2][3][3];
            for (int side = 0; side < 2; side++)
                for (int k = 0; k < 3; k++)
                    for (int c = 0; c < 3; c++) {
                        double change = c != j                          ? 0
                                        : moves == LAR_FIT_MOVES_CORNER ? -by
                                        : moves == k                    ? by
                                                                        : 0;
                        moved[side][k][c] = edge[k][c] + (side ? -change : change);
                    }
            lar_fit_corner_newton(law, (const double(*)[3])moved[0], moves, &ahead);
            lar_fit_corner_newton(law, (const double(*)[3])moved[1], moves, &behind);
            double mixed = (ahead.gradient[i] - behind.gradient[i]) / (2 * by);
            assert_below(fabs(mixed - newton.hessian[place[i][j]]), 1e-3 * (1 + fabs(mixed)));
        }
    }
}

static void test_energy_and_its_derivatives(void **state) {
    (void)state;
    const lar_fit_law law = {.shape = 0.7, .steep = 1.3, .aim = 0.9, .floor = 0.1};
    const double cube[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double bent[3][3] = {{1.1, 0.2, -0.1}, {0.4, 0.7, 0.3}, {-0.2, 0.5, 0.9}};
    const double straight[3][3] = {{0.8, 0.1, 0}, {-0.1, 1.2, 0.1}, {0, 0.05, 0.9}};
    const double flat[3][3] = {{1, 0, 0}, {0, 1, 0}, {0.9, 0.9, 0.1}};
    const double turned[3][3] = {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
    assert_below(fabs(lar_fit_corner_energy(&law, cube)), 1e-14);
    for (int moves = 0; moves <= LAR_FIT_MOVES_CORNER; moves++) {
        assert_derivatives(&law, cube, moves);
        assert_derivatives(&law, bent, moves);
        assert_derivatives(&law, straight, moves);
    }
    assert_true(isinf(lar_fit_corner_energy(&law, flat)));
    assert_true(isinf(lar_fit_corner_energy(&law, turned)));
}

typedef struct one_cube {
    int32_t element[1][8], start[9], around[8], none[9], point[8][3], row[5], ahead[4];
    double x[8][3];
    bool awake[8], checked[8], differs[8];
    lar_fit_action action[8 * LAR_FIT_SWEEPS];
    lar_mesh mesh;
    lar_fit_work work;
} one_cube;

static void lay_cube(one_cube *c) {
    *c = (one_cube){.row = {0, 2, 4, 6, 8}};
    for (int a = 0; a < 8; a++) {
        c->element[0][a] = c->around[a] = c->start[a] = a;
        c->awake[a] = true;
        for (int i = 0; i < 3; i++) c->x[a][i] = c->point[a][i] = lar_node_sign[a][i] > 0;
    }
    c->start[8] = 8;
    c->mesh = (lar_mesh){.node_count = 8, .element_count = 1, .element = c->element};
    c->work = (lar_fit_work){
        .mesh = &c->mesh,
        .x = c->x,
        .element_start = c->start,
        .element_around = c->around,
        .face_start = c->none,
        .slot_start = c->none,
        .point_start = c->none,
        .law = {.shape = 1, .steep = 1, .aim = 0.5, .floor = 0.1},
        .awake = c->awake,
        .apart = {.checked = c->checked},
        .record = {.action = c->action, .differs = c->differs},
        .rows = {(const int32_t(*)[3])c->point, 4, c->row, c->ahead, {1, 1, 1}, {1, 1, 1}}};
}

/* One cube, a node of which is at no place: the sweep ends, and nothing has moved. */
static void test_a_node_at_nan_ends_the_sweep(void **state) {
    (void)state;
    static one_cube cube;
    double before[8][3];
    lay_cube(&cube);
    cube.x[6][1] = NAN;
    memcpy(before, cube.x, sizeof before);
    assert_int_equal(lar_fit_sweep(&cube.work), 0);
    assert_memory_equal(before, cube.x, sizeof before);
}

/* Two sweeps from where it begins. */
static void do_again(one_cube *cube, const double from[8][3]) {
    memcpy(cube->x, from, sizeof cube->x);
    memset(cube->awake, true, sizeof cube->awake);
    lar_fit_sweep_again(&cube->work);
    for (int sweep = 0; sweep < 2; sweep++) lar_fit_sweep(&cube->work);
}

/* Nobody asks the energy, which is another one by then, before somebody near is watched. */
static void test_a_round_that_is_done_again_is_as_before_where_nothing_differs(void **state) {
    (void)state;
    static one_cube cube;
    double from[8][3], once[8][3];
    lay_cube(&cube);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) cube.x[a][i] += 0.1 * sin(3 * a + i);
    memcpy(from, cube.x, sizeof from);
    do_again(&cube, (const double(*)[3])from);
    memcpy(once, cube.x, sizeof once);
    assert_memory_not_equal(once, from, sizeof once);
    cube.work.law.steep = 100;
    cube.work.law.aim = 0.99;
    do_again(&cube, (const double(*)[3])from);
    assert_memory_equal(once, cube.x, sizeof once);
    cube.checked[0] = true;
    do_again(&cube, (const double(*)[3])from);
    assert_memory_not_equal(once, cube.x, sizeof once);
    cube.work.law.steep = 1;
    cube.work.law.aim = 0.5;
    cube.checked[0] = false;
    cube.checked[1] = true;
    cube.work.record.sweep = 0; /* a new round */
    do_again(&cube, (const double(*)[3])from);
    assert_memory_equal(once, cube.x, sizeof once);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_energy_and_its_derivatives),
        cmocka_unit_test(test_a_node_at_nan_ends_the_sweep),
        cmocka_unit_test(test_a_round_that_is_done_again_is_as_before_where_nothing_differs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
