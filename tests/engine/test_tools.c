/* Tools of a simulation: what may be asked of them, the same bits on every grid, what they feel. */
#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"

static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "2x2x1", "1x2x3"};
static const char *const schemes[] = {NULL, "all", "local", "one", "two"};
enum { GRIDS = 5, TICKS = 20 };

static lar_options setting(int grid) {
    lar_options options = lar_options_default();
    options.grid = grids[grid];
    options.scheme = schemes[grid];
    options.threads = grid ? 1 + grid % 2 : 0;
    options.delays = grid ? (uint64_t)(5 + grid) : 0;
    options.hands = 1;
    return options;
}

/* ---- the same everywhere -------------------------------------------------------------------- */

/* What all tools have felt in all ticks, and the state at the end. */
typedef struct course {
    lar_tool_force felt[TICKS][TEST_TOOLS];
    uint64_t hash;
} course;

static void follow(lar_simulation *simulation, course *c) {
    lar_error error;
    for (int tick = 0; tick < TICKS; tick++) {
        act(simulation, tick, tick + 1);
        for (int32_t t = 0; t < TEST_TOOLS; t++)
            if (lar_simulation_tool_force(simulation, t, &c->felt[tick][t], &error))
                fail_msg("%s", error.message);
    }
    c->hash = lar_simulation_hash(simulation);
}

static void compare(const course *found, const course *wanted) {
    assert_int_equal(found->hash, wanted->hash);
    for (int tick = 0; tick < TICKS; tick++)
        for (int t = 0; t < TEST_TOOLS; t++) {
            const lar_tool_force *a = &found->felt[tick][t], *b = &wanted->felt[tick][t];
            for (int i = 0; i < 3; i++)
                if (a->force[i] != b->force[i] || a->torque[i] != b->torque[i])
                    fail_msg("tool %d, tick %d: %.17g N, %.17g N m instead of %.17g N, %.17g N m",
                             t, tick, a->force[i], a->torque[i], b->force[i], b->torque[i]);
            assert_int_equal(a->touching, b->touching);
            assert_int_equal(a->held, b->held);
        }
}

static bool felt_something(const course *c, int32_t tool) {
    for (int tick = 0; tick < TICKS; tick++)
        for (int i = 0; i < 3; i++)
            if (c->felt[tick][tool].force[i] != 0) return true;
    return false;
}

/* Forces are sums of whole numbers: to the bit, too. */
static void tools_do_and_feel_the_same_on_every_grid(void **unused) {
    (void)unused;
    static course wanted, found;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    follow(simulation, &wanted);
    lar_simulation_destroy(simulation);
    assert_true(felt_something(&wanted, TEST_BALL));
    assert_true(felt_something(&wanted, TEST_ROD));
    for (int grid = 1; grid < GRIDS; grid++) {
        simulation = start_with(model, setting(grid));
        follow(simulation, &found);
        compare(&found, &wanted);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* What is not for processors other than zero. */
static lar_status try_what_is_zeros(lar_simulation *simulation) {
    lar_tool_pose pose = {{0}, {1, 0, 0, 0}, 1};
    lar_error error;
    bool refused =
        lar_simulation_tool_move(simulation, 0, &pose, 10, &error) == LAR_ERROR_ARGUMENT &&
        lar_simulation_reset(simulation, &error) == LAR_ERROR_ARGUMENT &&
        lar_simulation_save(simulation, "nowhere", &error) == LAR_ERROR_ARGUMENT &&
        lar_simulation_load(simulation, "nowhere", &error) == LAR_ERROR_ARGUMENT;
    return refused ? LAR_OK : LAR_ERROR_ARGUMENT;
}

/* Tools travel with the orders, forces with the answers. */
static void tools_reach_other_processes(void **unused) {
    (void)unused;
    static course wanted, found;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    follow(simulation, &wanted);
    lar_simulation_destroy(simulation);
    for (int i = 0; i < 2; i++) {
        lar_options options = setting(2);
        options.comm = i ? "tcp" : "shm";
        fleet f;
        start_fleet(&f, model, options, 2, try_what_is_zeros);
        follow(f.zero, &found);
        end_fleet(&f);
        compare(&found, &wanted);
    }
    lar_model_destroy(model);
}

/* What another process sends is looked at before it is used: the number of a face or tool that is
 * not there. */
static void holds_of_others_are_looked_at(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    static const int32_t wrong[4][2] = {{-1, 0}, {TEST_TOOLS, 0}, {0, -1}, {0, 1 << 20}};
    for (int i = 0; i < 4; i++) {
        lar_error error;
        lar_options options = setting(2);
        options.comm = "shm";
        fleet f;
        start_fleet(&f, model, options, 2, NULL);
        lar_tools tools = f.zero->tools;
        tools.grasp_count = 1;
        tools.grasps[0] = (lar_grasp){.tool = wrong[i][0], .face = wrong[i][1]};
        const lar_order order = {LAR_ORDER_ADVANCE, 0};
        assert_int_equal(lar_control_order(f.zero->computer->control, &order, &tools,
                                           lar_tools_bytes(&tools), &error),
                         LAR_OK);
        leave_fleet(&f);
        assert_int_equal(f.other[1].status, LAR_ERROR_PEER);
        if (!strstr(f.other[1].error.message, "does not know"))
            fail_msg("%s", f.other[1].error.message);
    }
    lar_model_destroy(model);
}

/* ---- where they are ------------------------------------------------------------------------- */

static lar_tool_pose pose_of(const lar_simulation *simulation, int32_t tool) {
    lar_tool_pose pose;
    lar_error error;
    if (lar_simulation_tool_pose(simulation, tool, &pose, &error)) fail_msg("%s", error.message);
    return pose;
}

static void a_tool_moves_evenly_and_rests(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    for (int grid = 0; grid < 3; grid += 2) {
        lar_simulation *simulation = start_with(model, setting(grid));
        lar_error error;
        advance(simulation, 7);
        lar_tool_pose there = {{0.04, 0.02, 0.08}, {1, 0, 0, 0}, 0.5};
        there.orientation[0] = there.orientation[3] = sqrt(0.5) * (1 + 4e-7);
        assert_int_equal(lar_simulation_tool_move(simulation, TEST_ROD, &there, 20, &error),
                         LAR_OK);
        lar_tool_pose rest = model->tool[TEST_ROD].rest, now = pose_of(simulation, TEST_ROD);
        assert_memory_equal(&now, &rest, sizeof now);
        advance(simulation, 5);
        now = pose_of(simulation, TEST_ROD);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(now.position[i] -
                             (0.75 * rest.position[i] + 0.25 * there.position[i])) < 1e-15);
        assert_true(fabs(now.opening - 0.875) < 1e-15);
        advance(simulation, 15);
        now = pose_of(simulation, TEST_ROD);
        assert_memory_equal(now.position, there.position, sizeof now.position);
        double length = 0;
        for (int i = 0; i < 4; i++) length += now.orientation[i] * now.orientation[i];
        assert_true(fabs(length - 1) < 1e-15);
        advance(simulation, 3);
        lar_tool_pose later = pose_of(simulation, TEST_ROD);
        assert_memory_equal(&later, &now, sizeof now);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

static void refuse(lar_simulation *simulation, int32_t tool, lar_tool_pose pose, uint64_t steps,
                   const char *why) {
    lar_tool_pose before = pose_of(simulation, tool < 0 || tool >= TEST_TOOLS ? 0 : tool);
    lar_error error = {0};
    assert_int_equal(lar_simulation_tool_move(simulation, tool, &pose, steps, &error),
                     LAR_ERROR_ARGUMENT);
    if (!strstr(error.message, why)) fail_msg("'%s' lacks '%s'", error.message, why);
    lar_tool_pose after = pose_of(simulation, tool < 0 || tool >= TEST_TOOLS ? 0 : tool);
    assert_memory_equal(&after, &before, sizeof after);
    assert_int_equal(simulation->tools.motion[0].end, 0);
}

static void senseless_motions_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    lar_tool_pose rest = model->tool[TEST_BALL].rest, pose = rest;
    refuse(simulation, TEST_TOOLS, rest, 10, "no tool 4");
    refuse(simulation, -1, rest, 10, "no tool -1");
    refuse(simulation, TEST_BALL, rest, 0, "ball: a way takes");
    refuse(simulation, TEST_BALL, rest, UINT64_MAX, "ball: a way takes");
    pose.position[1] = NAN;
    refuse(simulation, TEST_BALL, pose, 10, "finite");
    pose = rest;
    pose.position[0] = INFINITY;
    refuse(simulation, TEST_BALL, pose, 10, "finite");
    pose = rest;
    pose.orientation[1] = 0.2;
    refuse(simulation, TEST_BALL, pose, 10, "ball: the orientation has length 1.0198039");
    pose.orientation[1] = NAN;
    refuse(simulation, TEST_BALL, pose, 10, "length");
    pose = rest;
    pose.opening = 1.01;
    refuse(simulation, TEST_BALL, pose, 10, "opening of 1.01");
    pose.opening = NAN;
    refuse(simulation, TEST_BALL, pose, 10, "opening");
    pose = rest; /* the radius is 8 mm: 4 mm in a step */
    pose.position[2] += 0.041;
    refuse(simulation, TEST_BALL, pose, 10, "half its radius");
    assert_int_equal(lar_simulation_tool_move(simulation, TEST_BALL, &pose, 11, NULL), LAR_OK);
    lar_simulation_reset(simulation, NULL);
    /* Turned around its tip, the far end of the rod goes farther: 6 cm. */
    pose = model->tool[TEST_ROD].rest;
    pose.orientation[0] = 0;
    pose.orientation[1] = 1;
    refuse(simulation, TEST_ROD, pose, 14, "half its radius");
    assert_int_equal(lar_simulation_tool_move(simulation, TEST_ROD, &pose, 16, NULL), LAR_OK);
    lar_simulation_reset(simulation, NULL);
    /* Jaws that close go 9 mm at their ends; the radius is 3 mm. */
    pose = model->tool[TEST_GRASPER].rest;
    pose.opening = 0;
    refuse(simulation, TEST_GRASPER, pose, 5, "half its radius");
    assert_int_equal(lar_simulation_tool_move(simulation, TEST_GRASPER, &pose, 7, NULL), LAR_OK);
    /* A hand that holds nothing may be put anywhere. */
    pose = (lar_tool_pose){{100, -100, 3}, {1, 0, 0, 0}, 1};
    assert_int_equal(lar_simulation_tool_move(simulation, TEST_HAND, &pose, 1, NULL), LAR_OK);
    advance(simulation, 1);
    lar_tool_pose now = pose_of(simulation, TEST_HAND);
    assert_memory_equal(&now, &pose, sizeof now);
    finish(simulation, model);
}

/* ---- what they feel ------------------------------------------------------------------------- */

/* A mean over the steps of the last advance, whatever was looked at in between, and nothing before
 * the first. */
static void forces_are_means_of_the_last_advance(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    lar_tool_force force, single, sum = {0};
    lar_error error;
    memset(&force, 1, sizeof force);
    assert_int_equal(lar_simulation_tool_force(simulation, TEST_BALL, &force, &error), LAR_OK);
    assert_true(force.force[2] == 0 && force.torque[0] == 0 && force.touching == 0);
    act(simulation, 0, 6);
    assert_int_equal(lar_simulation_save(simulation, LAR_TEST_BUILD "/tools.checkpoint", &error),
                     LAR_OK);
    advance(simulation, 8);
    lar_simulation_tool_force(simulation, TEST_BALL, &force, &error);
    assert_true(force.force[2] > 0 && force.touching > 0);
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    lar_tool_force again;
    lar_simulation_tool_force(simulation, TEST_BALL, &again, &error);
    assert_memory_equal(&again, &force, sizeof again);
    assert_int_equal(lar_simulation_load(simulation, LAR_TEST_BUILD "/tools.checkpoint", &error),
                     LAR_OK);
    lar_simulation_tool_force(simulation, TEST_BALL, &again, &error);
    assert_true(again.force[2] == 0);
    for (int i = 0; i < 8; i++) {
        advance(simulation, 1);
        lar_simulation_tool_force(simulation, TEST_BALL, &single, &error);
        sum.force[2] += single.force[2] / 8;
        sum.torque[1] += single.torque[1] / 8;
    }
    assert_true(fabs(sum.force[2] - force.force[2]) < 1e-9 * force.force[2]);
    assert_true(fabs(sum.torque[1] - force.torque[1]) < 1e-9 * force.force[2]);
    finish(simulation, model);
}

/* A hundred seconds of a firm grip, of four threads: more than 64 bits. */
static void long_advances_add_up(void **unused) {
    (void)unused;
    static lar_interactions interactions;
    static const lar_tool_list list = {.count = 2};
    const lar_state state = {.contact = 0.25};
    lar_report sum = {0};
    interactions.tool_contact.list = &list;
    interactions.tool_contact.sum[1] = (lar_tool_sum){.touching = 2};
    for (int step = 0; step < 1000; step++) {
        interactions.tool_contact.sum[1].force[0] -= (int64_t)1 << 60;
        interactions.tool_contact.sum[1].torque[2] += (int64_t)1 << 60;
    }
    for (int thread = 0; thread < 4; thread++) lar_report_add(&sum, &interactions, &state);
    assert_true(sum.taken == 1);
    assert_true((double)sum.tool[1].force[0] == -4000 * 0x1p60);
    assert_true((double)sum.tool[1].torque[2] == 4000 * 0x1p60);
    assert_int_equal(sum.tool[1].touching, 8);
    lar_report_begin(&interactions);
    assert_true(interactions.tool_contact.sum[1].force[0] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tools_do_and_feel_the_same_on_every_grid),
        cmocka_unit_test(tools_reach_other_processes),
        cmocka_unit_test(holds_of_others_are_looked_at),
        cmocka_unit_test(a_tool_moves_evenly_and_rests),
        cmocka_unit_test(senseless_motions_are_refused),
        cmocka_unit_test(forces_are_means_of_the_last_advance),
        cmocka_unit_test(long_advances_add_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
