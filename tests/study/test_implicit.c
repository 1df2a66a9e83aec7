/* Implicit integration against the engine: the same body, loads and masses, the same answer; what
 * the linear solvers say; what an implicit step cannot solve. */
#include "engine/engine_test.h"

#include "study/implicit/bench_implicit.h"

enum { NODES_MAX = 200 };

static lar_linear_solver *open_solver(const char *method, const char *preconditioner) {
    lar_linear_options options = lar_linear_options_default();
    lar_linear_solver *solver = NULL;
    lar_error error;
    options.method = method;
    options.preconditioner = preconditioner;
    lar_status status = lar_linear_solver_open(&options, &solver, &error);
    if (status == LAR_ERROR_UNSUPPORTED) return NULL;
    assert_int_equal(status, LAR_OK);
    return solver;
}

/* Fixed on one side, pulled, pushed and moved elsewhere, slowly, damped: all that acts. */
static lar_model *slow_model(lar_law law) {
    brick b = soft_brick;
    b.law = law;
    lar_model *model = brick_model(&b);
    int ramp = add_ramp(model, 0.4);
    model->damping = 30;
    model->gravity[2] = -2;
    model->gravity_curve[2] = ramp;
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_X | LAR_AXIS_Y | LAR_AXIS_Z);
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 0.006, ramp);
    load_nodes(model, single_node(brick_node(&b, 3, 2, 2)), 0, 0.01, 0.02, ramp);
    press(model, 5, 60, ramp);
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    return model;
}

static void explicitly(const lar_model *model, double until, double (*u)[3]) {
    lar_simulation *simulation;
    assert_int_equal(lar_simulation_create(model, NULL, &simulation, NULL), LAR_OK);
    double dt = lar_simulation_time_step(simulation);
    assert_int_equal(lar_simulation_advance(simulation, (uint64_t)llround(until / dt), NULL),
                     LAR_OK);
    lar_simulation_displacements(simulation, u);
    lar_simulation_destroy(simulation);
}

static lar_implicit_tally implicitly(const lar_model *model, double until, double step,
                                     bool quasi_static, lar_linear_solver *solver, double (*u)[3]) {
    lar_implicit_options options = lar_implicit_options_default();
    lar_implicit *implicit;
    lar_error error = {0};
    options.time_step = step;
    options.quasi_static = quasi_static;
    options.solver = solver;
    assert_int_equal(lar_implicit_create(model, &options, &implicit, &error), LAR_OK);
    lar_status status = lar_implicit_advance(implicit, until, &error);
    if (status) fail_msg("%s", error.message);
    lar_implicit_displacements(implicit, u);
    lar_implicit_tally tally = *lar_implicit_count(implicit);
    lar_implicit_destroy(implicit);
    return tally;
}

/* Largest difference against the largest displacement. */
static double apart(int32_t nodes, const double (*a)[3], const double (*b)[3]) {
    double max = 0, difference = 0;
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            max = fmax(max, fabs(b[n][i]));
            difference = fmax(difference, fabs(a[n][i] - b[n][i]));
        }
    return difference / max;
}

typedef const double (*rows)[3];

static void agrees_with_the_engine(void **state) {
    (void)state;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_model *model = slow_model((lar_law)law);
        lar_linear_solver *solver = open_solver("own", NULL);
        double u[NODES_MAX][3], w[NODES_MAX][3], still[NODES_MAX][3];
        int32_t nodes = model->mesh.node_count;
        explicitly(model, 0.3, u);
        lar_implicit_tally tally = implicitly(model, 0.3, 0.01, false, solver, w);
        print_message("%s, under way: %.2e apart, %d iterations in %d steps\n", lar_law_name[law],
                      apart(nodes, (rows)w, (rows)u), (int)tally.newton, (int)tally.steps);
        assert_true(apart(nodes, (rows)w, (rows)u) < 2e-3);
        assert_true(tally.steps == 30 && tally.newton <= 4 * tally.steps && tally.halved == 0);

        explicitly(model, 1.2, u);
        tally = implicitly(model, 1.2, 0.1, true, solver, still);
        print_message("%s, at rest: %.2e apart, %d iterations in %d steps\n", lar_law_name[law],
                      apart(nodes, (rows)still, (rows)u), (int)tally.newton, (int)tally.steps);
        assert_true(apart(nodes, (rows)still, (rows)u) < 1e-3);
        lar_linear_solver_close(solver);
        lar_model_destroy(model);
    }
}

/* The scheme itself: a body that flies free keeps its momentum, and one mass point on its elements
 * swings as fast as explicitly. Second order: half the step, a quarter of the error. */
static void second_order_in_time(void **state) {
    (void)state;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_X | LAR_AXIS_Y | LAR_AXIS_Z);
    int start = add_ramp(model, 0.02);
    load_nodes(model, single_node(brick_node(&b, 3, 2, 2)), 0, 0.005, 0.01, start);
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    lar_linear_solver *solver = open_solver("own", NULL);
    double fine[NODES_MAX][3], one[NODES_MAX][3], half[NODES_MAX][3];
    int32_t nodes = model->mesh.node_count;
    implicitly(model, 0.04, 0.00025, false, solver, fine);
    implicitly(model, 0.04, 0.002, false, solver, one);
    implicitly(model, 0.04, 0.001, false, solver, half);
    double ratio = apart(nodes, (rows)one, (rows)fine) / apart(nodes, (rows)half, (rows)fine);
    print_message("half the step: error divided by %.2f\n", ratio); /* (64 - 1) / (16 - 1) = 4.2 */
    assert_true(ratio > 3.6 && ratio < 4.8);
    lar_linear_solver_close(solver);
    lar_model_destroy(model);
}

/* A body that nothing holds: no equilibrium for the implicit solver without masses, and a sentence
 * that says so; with masses both ways fall alike. */
static void free_body(void **state) {
    (void)state;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    model->gravity[2] = -9.81;
    assert_int_equal(lar_model_check(model, NULL), LAR_OK);
    lar_linear_solver *solver = open_solver("own", NULL);
    lar_implicit_options options = lar_implicit_options_default();
    lar_implicit *implicit;
    lar_error error;
    options.quasi_static = true;
    options.solver = solver;
    options.halvings_max = 3;
    assert_int_equal(lar_implicit_create(model, &options, &implicit, &error), LAR_OK);
    assert_int_equal(lar_implicit_advance(implicit, 0.1, &error), LAR_ERROR_UNSTABLE);
    print_message("%s\n", error.message);
    assert_non_null(strstr(error.message, "finds no equilibrium"));
    assert_int_equal(lar_implicit_count(implicit)->halved, 3);
    assert_true(lar_implicit_time(implicit) == 0);
    lar_implicit_destroy(implicit);

    double u[NODES_MAX][3];
    implicitly(model, 0.1, 0.01, false, solver, u);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        assert_true(fabs(u[n][2] + 0.5 * 9.81 * 0.01) < 1e-9);
    lar_linear_solver_close(solver);
    lar_model_destroy(model);
}

/* Every solver and preconditioner gives the same x, and A x = b. */
static void solvers_agree(void **state) {
    (void)state;
    static const char *const method[][2] = {{"own", NULL},  {"cg", "jacobi"}, {"cg", "icc"},
                                            {"cg", "gamg"}, {"bcgs", "ilu"},  {"bcgs", "jacobi"}};
    lar_model *model = slow_model(LAR_LAW_neo_hookean);
    double first[NODES_MAX][3], u[NODES_MAX][3];
    for (size_t k = 0; k < sizeof method / sizeof method[0]; k++) {
        lar_linear_solver *solver = open_solver(method[k][0], method[k][1]);
        if (!solver) {
            print_message("without PETSc: own solver only\n");
            break;
        }
        lar_implicit_tally tally = implicitly(model, 0.2, 0.05, true, solver, k ? u : first);
        print_message("%s: %d iterations\n", lar_linear_solver_name(solver), (int)tally.linear);
        if (k) assert_true(apart(model->mesh.node_count, (rows)u, (rows)first) < 1e-6);
        lar_linear_solver_close(solver);
    }
    lar_model_destroy(model);
}

static void indefinite_matrix_is_told(void **state) {
    (void)state;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    lar_sparse A;
    lar_linear_result result;
    assert_int_equal(lar_sparse_create(&model->mesh, &A, NULL), LAR_OK);
    assert_int_equal(A.rows, 3 * model->mesh.node_count);
    double x[3 * NODES_MAX], right[3 * NODES_MAX];
    for (int32_t r = 0; r < A.rows; r++) {
        *lar_sparse_at(&A, r, r) = 1;
        right[r] = 1;
    }
    lar_linear_solver *solver = open_solver("own", NULL);
    assert_int_equal(lar_linear_solve(solver, &A, right, x, &result, NULL), LAR_OK);
    assert_true(result.solved && fabs(x[5] - 1) < 1e-12);
    *lar_sparse_at(&A, 0, 3) = *lar_sparse_at(&A, 3, 0) = -2; /* eigenvalues 3 and -1 */
    assert_int_equal(lar_linear_solve(solver, &A, right, x, &result, NULL), LAR_OK);
    assert_false(result.solved);
    assert_non_null(strstr(result.reason, "not positive definite"));
    lar_linear_solver_close(solver);
    lar_sparse_destroy(&A);
    lar_model_destroy(model);
}

static void contact_is_refused(void **state) {
    (void)state;
    lar_model *model = slow_model(LAR_LAW_neo_hookean);
    lar_implicit_options options = lar_implicit_options_default();
    lar_implicit *implicit = NULL;
    lar_error error;
    lar_contact *contact = LAR_MODEL_APPEND(model, contact);
    contact->kind = LAR_CONTACT_PLANE;
    assert_int_equal(lar_implicit_create(model, &options, &implicit, &error),
                     LAR_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.message, "neither contact nor tools"));
    assert_null(implicit);
    lar_model_destroy(model);
}

static lar_bench_implicit_result bench(lar_implicit_case which, bool quasi_static) {
    lar_bench_implicit_options options = {.linear = lar_linear_options_default(),
                                          .implicit = lar_implicit_options_default()};
    lar_bench_implicit_result result;
    lar_error error;
    options.linear.tolerance = options.implicit.tolerance = 1e-4;
    options.implicit.time_step = 0.02;
    options.implicit.quasi_static = quasi_static;
    options.implicit.halvings_max = 3;
    assert_int_equal(lar_implicit_case_create(which, &options.model, NULL), LAR_OK);
    lar_tool *tool = LAR_MODEL_APPEND(options.model, tool); /* left out, and there afterwards */
    tool->radius = 0.01;
    if (lar_bench_implicit(&options, &result, &error)) fail_msg("%s", error.message);
    assert_int_equal(result.left_out, 1);
    assert_int_equal(options.model->tool_count, 1);
    lar_model_destroy(options.model);
    return result;
}

/* Table 2.1: the same answers within 1 % where loading is slow; where the tangent becomes singular,
 * or nothing holds a piece, the explicit way goes on alone. */
static void cases(void **state) {
    (void)state;
    lar_bench_implicit_result slow = bench(LAR_IMPLICIT_SLOW, false);
    assert_true(!slow.failed && slow.apart >= 0 && slow.apart < 0.01);
    assert_true(slow.largest > 1e-3 && slow.reached == slow.until);
    lar_bench_implicit_result buckle = bench(LAR_IMPLICIT_BUCKLE, true);
    assert_true(buckle.failed && buckle.reached > 0.1 && buckle.reached < 0.6);
    assert_non_null(strstr(buckle.reason, "finds no equilibrium"));
    assert_true(buckle.largest > 0.01 && buckle.until >= 1); /* the run went on */
    lar_bench_implicit_result loose = bench(LAR_IMPLICIT_LOOSE, true);
    assert_true(loose.failed && loose.reached == 0 && loose.apart == -1);
    loose = bench(LAR_IMPLICIT_LOOSE, false);
    assert_true(!loose.failed && loose.apart >= 0 && loose.apart < 0.01);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_the_engine),
        cmocka_unit_test(second_order_in_time),
        cmocka_unit_test(free_body),
        cmocka_unit_test(solvers_agree),
        cmocka_unit_test(indefinite_matrix_is_told),
        cmocka_unit_test(contact_is_refused),
        cmocka_unit_test(cases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
