/* Saving, loading and going back: from then on everything is as if nothing had been. */
#define PATH LAR_TEST_BUILD "/test.checkpoint"
#include "engine/checkpoint_test.h"

/* Hashes of a run that nothing interrupts, after 0, 8 and 20 ticks. */
typedef struct course {
    uint64_t start, middle, end;
    lar_energy energy; /* at the end */
} course;

static course straight_course(const lar_model *model) {
    lar_simulation *simulation = start_with(model, setting(0));
    course c = {.start = lar_simulation_hash(simulation)};
    act(simulation, 0, 8);
    c.middle = lar_simulation_hash(simulation);
    act(simulation, 8, 20);
    c.end = lar_simulation_hash(simulation);
    lar_simulation_energy(simulation, &c.energy);
    lar_simulation_destroy(simulation);
    return c;
}

/* Saved on one grid, taken up on another: with tools and what they hold. */
static void a_loaded_run_goes_on_as_if_never_stopped(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    course c = straight_course(model);
    for (int from = 0; from < GRIDS; from += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(from));
        act(simulation, 0, 8);
        save(simulation, PATH);
        assert_int_equal(lar_simulation_hash(simulation), c.middle);
        act(simulation, 8, 20);
        assert_int_equal(lar_simulation_hash(simulation), c.end);
        lar_simulation_destroy(simulation);

        int to = (from + 1) % GRIDS;
        lar_simulation *other = start_with(model, setting(to));
        if (from % 2) { /* wherever it has been before, in the same step too */
            act(other, 0, 5);
            advance(other, 3 * TICK_STEPS);
        }
        load(other, PATH);
        assert_int_equal(lar_simulation_steps(other), 8 * TICK_STEPS);
        assert_int_equal(lar_simulation_hash(other), c.middle);
        act(other, 8, 20);
        assert_int_equal(lar_simulation_hash(other), c.end);
        lar_energy energy;
        lar_simulation_energy(other, &energy);
        double scale = c.energy.strain + c.energy.kinetic + fabs(c.energy.external);
        assert_true(fabs(energy.external - c.energy.external) <= 1e-10 * scale);
        assert_true(fabs(energy.damping - c.energy.damping) <= 1e-10 * scale);
        lar_simulation_destroy(other);
    }
    lar_model_destroy(model);
}

/* Saved in memory on one grid, taken up on all; tools feel there what they felt. */
static void many_runs_go_on_from_one_state(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    course c = straight_course(model);
    lar_simulation *first = start_with(model, setting(1));
    act(first, 0, 8);
    lar_saved *saved = save_to(first);
    lar_tool_force before[TEST_TOOLS], after[TEST_TOOLS];
    int felt = 0;
    for (int32_t t = 0; t < TEST_TOOLS; t++) {
        assert_int_equal(lar_simulation_tool_force(first, t, &before[t], NULL), LAR_OK);
        felt += before[t].touching + before[t].held;
    }
    assert_true(felt > 0);
    act(first, 8, 20);
    assert_int_equal(lar_simulation_hash(first), c.end);
    lar_simulation_destroy(first);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        for (int again = 0; again < 2; again++) {
            act(simulation, 0, again);
            load_from(simulation, saved);
            for (int32_t t = 0; t < TEST_TOOLS; t++)
                assert_int_equal(lar_simulation_tool_force(simulation, t, &after[t], NULL), LAR_OK);
            assert_memory_equal(before, after, sizeof before);
            assert_int_equal(lar_simulation_steps(simulation), 8 * TICK_STEPS);
            assert_int_equal(lar_simulation_hash(simulation), c.middle);
            act(simulation, 8, 20);
            assert_int_equal(lar_simulation_hash(simulation), c.end);
            reset(simulation);
        }
        lar_simulation_destroy(simulation);
    }
    lar_saved_destroy(saved);
    lar_model_destroy(model);
}

static void check_rest(const lar_simulation *simulation, int32_t tool) {
    lar_tool_info info;
    lar_tool_pose pose;
    assert_int_equal(lar_simulation_tool(simulation, tool, &info, NULL), LAR_OK);
    assert_int_equal(lar_simulation_tool_pose(simulation, tool, &pose, NULL), LAR_OK);
    assert_memory_equal(&pose, &info.rest, sizeof pose);
}

/* Back and forth between past and future, after even and odd numbers of steps, so that packets of
 * every round have met those of another: rounds that were steps would take old packets for new. */
static void time_may_go_back_again_and_again(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    course c = straight_course(model);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        for (int i = 0; i < 3; i++) {
            act(simulation, 0, 2);
            advance(simulation, (uint64_t)(1 + i));
            reset(simulation);
            assert_int_equal(lar_simulation_steps(simulation), 0);
            assert_int_equal(lar_simulation_hash(simulation), c.start);
            for (int32_t t = 0; t < TEST_TOOLS; t++) check_rest(simulation, t);
            lar_contact_info contact;
            lar_simulation_contact(simulation, &contact);
            assert_true(contact.steps == 0 && contact.tested == 0 && contact.touching == 0);
            advance(simulation, 1);
            lar_simulation_contact(simulation, &contact);
            assert_int_equal(contact.steps, 1);
            reset(simulation);
        }
        act(simulation, 0, 8);
        assert_int_equal(lar_simulation_hash(simulation), c.middle);
        save(simulation, PATH);
        lar_saved *saved = save_to(simulation);
        for (int i = 0; i < 6; i++) {
            advance(simulation, (uint64_t)(2 + i));
            if (i % 2)
                load(simulation, PATH);
            else
                load_from(simulation, saved);
            assert_int_equal(lar_simulation_hash(simulation), c.middle);
        }
        lar_saved_destroy(saved);
        act(simulation, 8, 20);
        assert_int_equal(lar_simulation_hash(simulation), c.end);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- runs that have broken off -------------------------------------------------------------- */

/* One node is thrown into the body. */
static lar_model *crashing_model(void) {
    lar_model *model = everything_model(&tool_brick);
    static const double crash[3] = {-200, 0, 0};
    throw_node(model, brick_node(&tool_brick, 3, 2, 2), crash);
    return model;
}

static void break_and_take_up(lar_simulation *simulation) {
    lar_error error;
    uint64_t begin = lar_simulation_hash(simulation);
    lar_saved *saved = save_to(simulation);
    save(simulation, PATH);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(lar_simulation_advance(simulation, 500, &error), LAR_ERROR_UNSTABLE);
        assert_int_equal(lar_simulation_advance(simulation, 1, &error), LAR_ERROR_UNSTABLE);
        assert_int_equal(lar_simulation_save(simulation, PATH ".no", &error), LAR_ERROR_UNSTABLE);
        /* What was saved before stays. */
        assert_int_equal(lar_simulation_save_to(simulation, saved, &error), LAR_ERROR_UNSTABLE);
        if (i % 3 == 0)
            reset(simulation);
        else if (i % 3 == 1)
            load(simulation, PATH);
        else
            load_from(simulation, saved);
        assert_int_equal(lar_simulation_hash(simulation), begin);
        if (lar_simulation_advance(simulation, 1, &error)) fail_msg("%s", error.message);
    }
    lar_saved_destroy(saved);
    assert_int_equal(access(PATH ".no", F_OK), -1);
}

static void a_broken_run_is_taken_up_again(void **unused) {
    (void)unused;
    lar_model *model = crashing_model();
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        break_and_take_up(simulation);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- other processes: two simulations in two threads ---------------------------------------- */

static void go_back_and_forth(lar_simulation *simulation, const course *c) {
    act(simulation, 0, 3);
    advance(simulation, 1);
    reset(simulation);
    assert_int_equal(lar_simulation_hash(simulation), c->start);
    act(simulation, 0, 8);
    assert_int_equal(lar_simulation_hash(simulation), c->middle);
    save(simulation, PATH);
    lar_saved *saved = save_to(simulation);
    act(simulation, 9, 10);
    advance(simulation, 7);
    load(simulation, PATH);
    assert_int_equal(lar_simulation_hash(simulation), c->middle);
    advance(simulation, 5);
    load_from(simulation, saved);
    lar_saved_destroy(saved);
    assert_int_equal(lar_simulation_hash(simulation), c->middle);
    act(simulation, 8, 20);
    assert_int_equal(lar_simulation_hash(simulation), c->end);
}

static void processes_go_back_together(void **unused) {
    (void)unused;
    static const char *const backends[] = {"shm", "tcp", "shm"};
    static const char *const grid[] = {"2x1x1", "2x1x1", "2x2x1"};
    for (int i = 0; i < 3; i++) {
        lar_model *model = tool_model_of(i == 0 ? &fine_tool_brick : &tool_brick);
        course c = straight_course(model);
        lar_options options = setting(1);
        options.grid = grid[i];
        options.threads = 1 + i % 2;
        options.comm = backends[i];
        fleet f;
        start_fleet(&f, model, options, i == 2 ? 4 : 2, NULL);
        go_back_and_forth(f.zero, &c);
        end_fleet(&f);
        lar_model_destroy(model);
    }
}

static void processes_that_broke_off_are_taken_up_again(void **unused) {
    (void)unused;
    lar_model *model = crashing_model();
    lar_options options = setting(1);
    options.comm = "shm";
    fleet f;
    start_fleet(&f, model, options, 2, NULL);
    break_and_take_up(f.zero);
    end_fleet(&f);
    lar_model_destroy(model);
}

/* ---- bodies in contact ---------------------------------------------------------------------- */

static const brick anvil = {{6, 4, 2}, 0.01, 0.08, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
static const brick hammer = {{4, 3, 2}, 0.008, 0.05, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};

/* Of a run that nothing interrupts: after 30 steps, when the bodies touch, and after 150. */
typedef struct impact {
    uint64_t begin, middle, end;
} impact;

static impact straight_impact(const lar_model *model) {
    lar_simulation *simulation = start_with(model, setting(0));
    impact w = {.begin = lar_simulation_hash(simulation)};
    lar_contact_info info;
    advance(simulation, 30);
    lar_simulation_contact(simulation, &info);
    assert_true(info.touching > 0);
    w.middle = lar_simulation_hash(simulation);
    save(simulation, PATH);
    advance(simulation, 120);
    w.end = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return w;
}

/* From near by and, with `far`, from a state in which other faces are near each other. Also in the
 * step that the state is of, where nothing else tells that it is another one. */
static void take_up_impact(lar_simulation *simulation, const impact *w, bool far) {
    lar_error error;
    lar_tool_pose aside = {{1, 1, 1}, {1, 0, 0, 0}, 1};
    for (int i = 1; i >= !far; i--) {
        advance(simulation, i ? 31 : 600);
        if (i == 1) reset(simulation);
        if (i == 1) advance(simulation, 30);
        if (lar_simulation_tool_move(simulation, 0, &aside, 5, &error))
            fail_msg("%s", error.message);
        load(simulation, PATH);
        assert_int_equal(lar_simulation_hash(simulation), w->middle);
        advance(simulation, 120);
        assert_int_equal(lar_simulation_hash(simulation), w->end);
        reset(simulation);
        assert_int_equal(lar_simulation_hash(simulation), w->begin);
        advance(simulation, 150);
        assert_int_equal(lar_simulation_hash(simulation), w->end);
    }
}

static void bodies_in_contact_are_taken_up_in_the_middle(void **unused) {
    (void)unused;
    lar_model *model = two_bricks(&anvil, &hammer, 0.002, true);
    int32_t first = (anvil.cells[0] + 1) * (anvil.cells[1] + 1) * (anvil.cells[2] + 1);
    throw_nodes(model, first, model->mesh.node_count, (double[]){0.15, 0.05, -0.3});
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    impact w = straight_impact(model);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        take_up_impact(simulation, &w, grid > 1);
        lar_simulation_destroy(simulation);
    }
    for (int i = 0; i < 2; i++) {
        lar_options options = setting(i + 1);
        options.comm = i ? "shm" : "tcp";
        fleet f;
        start_fleet(&f, model, options, i ? 4 : 2, NULL);
        take_up_impact(f.zero, &w, false);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loaded_run_goes_on_as_if_never_stopped),
        cmocka_unit_test(time_may_go_back_again_and_again),
        cmocka_unit_test(many_runs_go_on_from_one_state),
        cmocka_unit_test(a_broken_run_is_taken_up_again),
        cmocka_unit_test(processes_go_back_together),
        cmocka_unit_test(processes_that_broke_off_are_taken_up_again),
        cmocka_unit_test(bodies_in_contact_are_taken_up_in_the_middle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
