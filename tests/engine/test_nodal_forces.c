/* Forces on nodes by cause: a tool's sum up to what the tool feels, to the last bit; bodies' to
 * nothing; all together are mass times acceleration. Looking changes nothing, and finds the same on
 * every grid. */
#include <float.h>

#include "base/vector.h"
#include "engine/body_contact_test.h"
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"
#include "engine/tools_test.h"

typedef double (*vectors)[3];

static vectors new_vectors(const lar_model *model) {
    return lar_calloc((size_t)model->mesh.node_count, 3 * sizeof(double));
}

static void forces_by(const lar_simulation *simulation, lar_cause cause, int32_t tool,
                      vectors force) {
    lar_error error;
    if (lar_simulation_nodal_forces(simulation, cause, tool, force, &error))
        fail_msg("%s", error.message);
}

/* Exact: the order does not matter. */
static void add_up(const lar_model *model, const double (*force)[3], double sum[3]) {
    int32_t nodes = model->mesh.node_count;
    double back[3] = {0, 0, 0};
    memset(sum, 0, 3 * sizeof *sum);
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            sum[i] += force[n][i];
            back[i] += force[nodes - 1 - n][i];
        }
    assert_memory_equal(sum, back, sizeof back);
}

/* ---- tools ---------------------------------------------------------------------------------- */

typedef struct felt {
    double force[3], torque[3];
    bool limited;
} felt;

static void look_at_tool(const lar_simulation *simulation, int32_t tool, vectors force, felt *f) {
    const lar_model *model = simulation->domain.model;
    double torque[3] = {0, 0, 0};
    lar_tool_pose pose;
    lar_tool_force last;
    vectors u = new_vectors(model);
    lar_simulation_displacements(simulation, u);
    lar_simulation_tool_pose(simulation, tool, &pose, NULL);
    lar_simulation_tool_force(simulation, tool, &last, NULL);
    forces_by(simulation, LAR_CAUSE_TOOL, tool, force);
    add_up(model, (const double(*)[3])force, f->force);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double arm[3], turn[3];
        for (int i = 0; i < 3; i++)
            arm[i] = model->mesh.position[n][i] + u[n][i] - pose.position[i];
        lar_cross(arm, force[n], turn);
        for (int i = 0; i < 3; i++) torque[i] += turn[i];
    }
    memcpy(f->torque, torque, sizeof torque);
    f->limited = last.limited != 0;
    free(u);
}

/* After a step that was not divided, of a tool whose way was not decided anew. Returns whether it
 * felt something. */
static bool feels_the_same(const lar_simulation *simulation, int32_t tool, const felt *f) {
    lar_tool_force force;
    double largest = 0;
    lar_simulation_tool_force(simulation, tool, &force, NULL);
    if (force.limited || f->limited) return false;
    for (int i = 0; i < 3; i++) {
        if (force.force[i] != -f->force[i])
            fail_msg("tool %d: %.17g instead of %.17g", (int)tool, -f->force[i], force.force[i]);
        if (!(fabs(force.torque[i] + f->torque[i]) <= 1e-12))
            fail_msg("tool %d: torque %.17g instead of %.17g", (int)tool, -f->torque[i],
                     force.torque[i]);
        largest = fmax(largest, fabs(force.force[i]));
    }
    return largest > 1e-6;
}

/* act_gently, and then the grasper closes on what is between its jaws, and lifts it. */
static void act_and_grasp(lar_simulation *simulation, int tick) {
    if (tick < 22) act_gently(simulation, tick);
    if (tick == 22) place_tool(simulation, TEST_GRASPER, 0.03, 0.015, 0.0705, 0, 20 * TICK_STEPS);
    if (tick == 44) place_tool(simulation, TEST_GRASPER, 0.03, 0.015, 0.0715, 0, 20 * TICK_STEPS);
}

static void press_with_tools(double friction, const char *grid) {
    lar_model *model = touched(friction);
    lar_options options = lar_options_default();
    options.hands = 1;
    options.grid = grid;
    lar_simulation *simulation = start_with(model, options);
    vectors force = new_vectors(model);
    int compared[TEST_TOOLS] = {0}, held = 0;
    for (int step = 0; step < 64 * TICK_STEPS; step++) {
        felt f[TEST_TOOLS];
        if (step % TICK_STEPS == 0) act_and_grasp(simulation, step / TICK_STEPS);
        if (step % 3) { /* every third step is looked at */
            advance(simulation, 1);
            continue;
        }
        for (int t = 0; t < TEST_TOOLS; t++) look_at_tool(simulation, t, force, &f[t]);
        uint64_t divided = lar_simulation_divided_steps(simulation, NULL);
        int32_t parts = lar_simulation_step_parts(simulation);
        advance(simulation, 1);
        if (parts > 1 || lar_simulation_divided_steps(simulation, NULL) > divided) continue;
        for (int t = 0; t < TEST_TOOLS; t++) compared[t] += feels_the_same(simulation, t, &f[t]);
        lar_tool_force grasped;
        lar_simulation_tool_force(simulation, TEST_GRASPER, &grasped, NULL);
        held += grasped.held > 0;
    }
    print_message("friction %g, grid %s: %d %d %d %d steps, %d with tissue in the jaws\n", friction,
                  grid ? grid : "none", compared[0], compared[1], compared[2], compared[3], held);
    for (int t = 0; t < TEST_TOOLS; t++) assert_true(compared[t] > 20);
    assert_true(held > 20);
    free(force);
    finish(simulation, model);
}

static void a_tool_feels_what_nodes_get(void **unused) {
    (void)unused;
    for (int rough = 0; rough < 2; rough++) {
        press_with_tools(rough ? 0.3 : 0, "1x1x1");
        press_with_tools(rough ? 0.3 : 0, "2x1x1");
    }
}

/* ---- all causes ----------------------------------------------------------------------------- */

static void add_all(const lar_simulation *simulation, vectors total, int32_t *busy) {
    const lar_model *model = simulation->domain.model;
    vectors force = new_vectors(model);
    memset(total, 0, (size_t)model->mesh.node_count * sizeof *total);
    for (int cause = LAR_CAUSE_ELEMENTS; cause <= LAR_CAUSE_DAMPING; cause++) {
        int32_t tools = cause == LAR_CAUSE_TOOL ? lar_simulation_tool_count(simulation) : 1;
        for (int32_t tool = 0; tool < tools; tool++) {
            bool acts = false;
            forces_by(simulation, (lar_cause)cause, tool, force);
            for (int32_t n = 0; n < model->mesh.node_count; n++)
                for (int i = 0; i < 3; i++) {
                    total[n][i] += force[n][i];
                    acts = acts || force[n][i] != 0;
                }
            busy[cause] += acts;
            if (cause != LAR_CAUSE_BODIES) continue;
            double sum[3]; /* what one body gets, others give */
            add_up(model, (const double(*)[3])force, sum);
            for (int i = 0; i < 3; i++) assert_true(sum[i] == 0);
        }
    }
    free(force);
}

static double mass_of(const lar_simulation *simulation, int32_t n) {
    return simulation->domain.mass[simulation->domain.layout.local[n]];
}

static const double SIZE = 0.03; /* of both scenes: planes put nodes where places round [m] */

/* One step. False: it was divided, and is not compared. */
static bool moves_as_forces_say(lar_simulation *simulation, int32_t *busy) {
    const lar_model *model = simulation->domain.model;
    vectors total = new_vectors(model), before = new_vectors(model), after = new_vectors(model);
    const lar_step_division *division = &simulation->tools.division;
    bool before_was = division->since > 0 && division->since == lar_simulation_steps(simulation);
    int32_t parts = lar_simulation_step_parts(simulation);
    uint64_t divided = lar_simulation_divided_steps(simulation, NULL);
    uint64_t hash = lar_simulation_hash(simulation);
    add_all(simulation, total, busy);
    assert_int_equal(lar_simulation_hash(simulation), hash);
    lar_simulation_velocities(simulation, before);
    advance(simulation, 1);
    lar_simulation_velocities(simulation, after);
    bool whole =
        parts == 1 && !before_was && lar_simulation_divided_steps(simulation, NULL) == divided;
    double dt = lar_simulation_time_step(simulation);
    for (int32_t n = 0; n < model->mesh.node_count && whole; n++)
        for (int i = 0; i < 3; i++) {
            double impulse = mass_of(simulation, n) * (after[n][i] - before[n][i]);
            double speed = fmax(fmax(fabs(after[n][i]), fabs(before[n][i])), 1e-3);
            double error = fabs(impulse - dt * total[n][i]);
            if (!(error <= mass_of(simulation, n) * (1e-11 * speed + 4 * DBL_EPSILON * SIZE / dt)))
                fail_msg("step %llu, node %d, axis %d: %.17g N s instead of %.17g",
                         (unsigned long long)lar_simulation_steps(simulation), (int)n, i,
                         dt * total[n][i], impulse);
        }
    free(total);
    free(before);
    free(after);
    return whole;
}

static void set_a_force(lar_simulation *simulation, int step) {
    const double force[3] = {0.01, 0.003, -0.002};
    if (step == 100) assert_int_equal(lar_simulation_set_force(simulation, 40, force, NULL), 0);
    if (step % 60 == 30) /* compared in the step that stops it, and in that which lets it go */
        assert_int_equal(lar_simulation_set_support(simulation, 50, LAR_AXIS_X | LAR_AXIS_Z,
                                                    step % 120 == 30, NULL),
                         0);
}

static void all_are_mass_times_acceleration(void **unused) {
    (void)unused;
    for (int rough = 0; rough < 2; rough++) {
        lar_model *model = touched(rough ? 0.3 : 0);
        lar_options options = lar_options_default();
        options.hands = 1;
        lar_simulation *simulation = start_with(model, options);
        int32_t busy[LAR_CAUSE_DAMPING + 1] = {0}, compared = 0;
        for (int step = 0; step < 30 * TICK_STEPS; step++) {
            if (step % TICK_STEPS == 0) act_gently(simulation, step / TICK_STEPS);
            set_a_force(simulation, step);
            if (step % 3)
                advance(simulation, 1);
            else
                compared += moves_as_forces_say(simulation, busy);
        }
        assert_true(compared > 60);
        for (int cause = 0; cause <= LAR_CAUSE_DAMPING; cause++)
            if (cause != LAR_CAUSE_BODIES && cause != LAR_CAUSE_PLANES)
                assert_true(busy[cause] > 60);
        finish(simulation, model);
    }
}

/* A brick falls on another one, which lies on a plane; rough or smooth, with mass that does not
 * weigh, and nodes of the lower one held along one axis. */
static lar_model *heap(bool rough) {
    static const brick lower = {{4, 4, 2}, 0.01, 0.05, LAR_LAW_neo_hookean, 4e3, 2e4, 1000};
    static const brick upper = {{2, 2, 2}, 0.007, 0.05, LAR_LAW_neo_hookean, 2e3, 1e4, 1000};
    lar_model *model = two_bricks(&lower, &upper, 0.004, false);
    add_plane(model, (double[]){0, 0, -0.002}, (double[]){0.1, 0, 1});
    fix_nodes(model, brick_side(&lower, 0, 0), LAR_AXIS_Y);
    for (int i = 0; i < model->contact_count; i++) model->contact[i].friction = rough ? 0.4 : 0;
    memcpy(model->gravity, (double[]){0.5, 0.3, -9.81}, 24);
    model->damping = 5;
    model->time_step = 0.8 * stable_step_of(model); /* the shorter it is the more places round */
    return model;
}

/* Nodes of the lower one are held on some axes, and let go, while they lie on the plane. (Along x
 * alone it would push ten times as hard, and round so.) */
static void hold_some(lar_simulation *simulation, int step) {
    static const unsigned axes[] = {LAR_AXIS_X, LAR_AXIS_Y, LAR_AXIS_X | LAR_AXIS_Y,
                                    LAR_AXIS_X | LAR_AXIS_Z, LAR_AXIS_ALL};
    for (int32_t n = 0; n < 20 && step % 500 == 250; n++)
        assert_int_equal(
            lar_simulation_set_support(simulation, n, axes[n % 5], step % 1000 == 250, NULL), 0);
}

static void also_of_bodies_on_planes(void **unused) {
    (void)unused;
    for (int rough = 0; rough < 2; rough++) {
        lar_model *model = heap(rough == 1);
        lar_simulation *simulation = start(model);
        int32_t busy[LAR_CAUSE_DAMPING + 1] = {0}, compared = 0;
        for (int step = 0; step < 4000; step++) {
            hold_some(simulation, step);
            if (step % 5)
                advance(simulation, 1);
            else
                compared += moves_as_forces_say(simulation, busy);
        }
        print_message("heap: %d steps, %d with bodies, %d with planes\n", compared,
                      busy[LAR_CAUSE_BODIES], busy[LAR_CAUSE_PLANES]);
        assert_true(compared > 300);
        assert_true(busy[LAR_CAUSE_BODIES] > 30 && busy[LAR_CAUSE_PLANES] > 50);
        assert_true(busy[LAR_CAUSE_TOOL] == 0 && busy[LAR_CAUSE_LOADS] == 0);
        finish(simulation, model);
    }
}

/* ---- everywhere the same -------------------------------------------------------------------- */

static void compare_grids(const lar_model *model, void (*go)(lar_simulation *), int32_t hands) {
    static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "1x2x2"};
    size_t bytes = (size_t)model->mesh.node_count * sizeof(double[3]);
    vectors wanted[LAR_CAUSE_DAMPING + 1], found = new_vectors(model);
    for (int cause = 0; cause <= LAR_CAUSE_DAMPING; cause++) wanted[cause] = new_vectors(model);
    for (int grid = 0; grid < 4; grid++) {
        lar_options options = lar_options_default();
        options.grid = grids[grid];
        options.hands = hands;
        lar_simulation *simulation = start_with(model, options);
        go(simulation);
        for (int cause = 0; cause <= LAR_CAUSE_DAMPING; cause++) {
            if (cause == LAR_CAUSE_TOOL && hands == 0) continue;
            forces_by(simulation, (lar_cause)cause, 0, grid ? found : wanted[cause]);
            if (grid) assert_memory_equal(found, wanted[cause], bytes);
        }
        lar_simulation_destroy(simulation);
    }
    for (int cause = 0; cause <= LAR_CAUSE_DAMPING; cause++) free(wanted[cause]);
    free(found);
}

static void act_for_a_while(lar_simulation *simulation) {
    act(simulation, 0, 8);
    for (int32_t n = 0; n < 60; n += 7)
        assert_int_equal(
            lar_simulation_set_support(simulation, n, 1u + (unsigned)n % 7, n % 2, NULL), 0);
    advance(simulation, 3);
}

static void fall_in_a_heap(lar_simulation *simulation) {
    advance(simulation, 1250);
    hold_some(simulation, 1250);
    advance(simulation, 251);
}

static void the_same_on_every_grid(void **unused) {
    (void)unused;
    lar_model *model = touched(0.3);
    compare_grids(model, act_for_a_while, 1);
    lar_model_destroy(model);
    model = heap(true);
    compare_grids(model, fall_in_a_heap, 0);
    lar_model_destroy(model);
}

/* ---- per area ------------------------------------------------------------------------------- */

/* What stands on a plane presses on all of its base alike, up to the rim; no face looks aside. */
static void a_block_presses_alike(void **unused) {
    (void)unused;
    const brick b = {{3, 4, 5}, 0.01, 0, LAR_LAW_neo_hookean, 2e5, 4e5 / 3, 1000}; /* nu = 0 */
    lar_model *model = brick_model(&b);
    model->gravity[2] = -9.81;
    model->damping = 200;
    add_plane(model, (double[]){0, 0, 0}, (double[]){0, 0, 1});
    lar_simulation *simulation = start(model);
    vectors traction = new_vectors(model);
    double *pressure = lar_calloc((size_t)model->mesh.node_count, sizeof *pressure);
    lar_error error;
    advance(simulation, 20000);
    if (lar_simulation_contact_pressure(simulation, traction, NULL, &error) ||
        lar_simulation_contact_pressure(simulation, NULL, pressure, &error))
        fail_msg("%s", error.message);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double want = n < 4 * 5 ? 1000 * 9.81 * 0.05 : 0;
        assert_below(fabs(pressure[n] - want), 0.01 * 490);
        assert_below(fabs(traction[n][2] - pressure[n]), 1e-9 * 490);
        assert_below(fabs(traction[n][0]) + fabs(traction[n][1]), 1e-9 * 490);
    }
    free(pressure);
    free(traction);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tool_feels_what_nodes_get), cmocka_unit_test(a_block_presses_alike),
        cmocka_unit_test(all_are_mass_times_acceleration),
        cmocka_unit_test(also_of_bodies_on_planes), cmocka_unit_test(the_same_on_every_grid)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
