/* Tools that lag behind their hands, and steps that are divided: decided at the beginning of
 * intervals from whole numbers, so nothing of it depends on who computes, on where an advance ends
 * or on whether the run was saved in between. With an argument, the share of the mass that strained
 * elements may have more, all of it again: who is heavier is decided there too. */
#include "base/hash.h"
#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"

/* Two tests run this program, at the same time. */
#define PATH                                                                                       \
    (strained_share > 0 ? LAR_TEST_BUILD "/divided_heavier.checkpoint"                             \
                        : LAR_TEST_BUILD "/divided.checkpoint")

/* 3 x 3 x 1.5 cm, nearly incompressible, as an organ is: intervals of several steps. */
static const brick organ_brick = {{10, 10, 5}, 0.003, 0.1, LAR_LAW_neo_hookean, 5e3, 3e5, 1000};

static double strained_share;

enum { MOVE_STEPS = 60, STEPS = 8 * MOVE_STEPS, LONG_RUN = 20 * MOVE_STEPS, BALL = 0, ROD, HAND };

/* On its ground, with a ball above its top, a rod beside it and a hand. */
static lar_model *organ(void) {
    lar_model *model = brick_model(&organ_brick);
    fix_nodes(model, brick_side(&organ_brick, 2, 0), LAR_AXIS_ALL);
    model->damping = 3;
    model->strained_share = strained_share;
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.0155, 0.0148, 0.0195);
    model->tool[BALL].radius = 0.004;
    add_tool(model, "rod", LAR_TOOL_CAPSULE, 0.034, 0.012, 0.008);
    model->tool[ROD].radius = 0.003;
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    return model;
}

/* Asks for what the hands want at step `step`, a multiple of MOVE_STEPS: the ball goes deep into
 * the organ, stays and comes back, the rod is pushed into its side, the hand draws at an edge. */
static void ask(lar_simulation *simulation) {
    uint64_t step = lar_simulation_steps(simulation);
    double t = (double)(step / MOVE_STEPS + 1), down = t < 7 ? t : t < 9 ? 7 : fmax(7 - (t - 8), 1);
    place_tool(simulation, BALL, 0.0155 + 1e-4 * t, 0.0148, 0.0195 - 0.0021 * down, 1, MOVE_STEPS);
    place_tool(simulation, ROD, 0.034 - 0.0004 * t, 0.012, 0.008, 1, MOVE_STEPS);
    place_tool(simulation, HAND, 0.03, 0.03, 0.015 + 1e-4 * t, t < 3 ? 1 : 0, MOVE_STEPS);
}

/* On to step `end`, `size` steps at once. */
static void go(lar_simulation *simulation, uint64_t end, uint64_t size) {
    for (uint64_t step; (step = lar_simulation_steps(simulation)) < end;) {
        if (step % MOVE_STEPS == 0) ask(simulation);
        uint64_t until = (step / MOVE_STEPS + 1) * MOVE_STEPS;
        if (until > end) until = end;
        advance(simulation, until - step < size ? until - step : size);
    }
}

/* The state, and where tools are and go, to the bit. */
static uint64_t hash_of(const lar_simulation *simulation) {
    const lar_tools *tools = &simulation->tools;
    uint64_t hash = lar_simulation_hash(simulation);
    for (size_t i = 0; i < sizeof *tools / 8; i++) {
        uint64_t word;
        memcpy(&word, (const char *)tools + 8 * i, 8);
        hash = lar_hash_word(hash, word);
    }
    return hash;
}

/* In the middle of an interval and of a way, while the ball lags and steps are divided. */
static uint64_t middle;

typedef struct course {
    uint64_t middle, end, late; /* late: the ball has come back */
} course;

static lar_options setting(const char *grid, int threads) {
    lar_options options = lar_options_default();
    options.grid = grid;
    options.threads = grid ? threads : 0;
    options.hands = 1;
    return options;
}

static course run(lar_simulation *simulation, uint64_t size) {
    course c;
    go(simulation, middle, size);
    c.middle = hash_of(simulation);
    go(simulation, STEPS, size);
    c.end = hash_of(simulation);
    return c;
}

/* The run that all others are compared with, step by step: something must happen in it. */
static course plain(const lar_model *model) {
    static course known;
    if (known.end) return known;
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    const lar_tools *tools = &simulation->tools;
    uint64_t interval = simulation->domain.interval;
    int32_t max = 1, changes = 0, before = 1, came_back = 0, lagged = 0, barriers = 0, heavier = 0;
    while (lar_simulation_steps(simulation) < LONG_RUN) {
        uint64_t step = lar_simulation_steps(simulation);
        int32_t lagging = tools->follower[BALL].lagging;
        go(simulation, step + 1, 1);
        came_back += lagging && !tools->follower[BALL].lagging;
        lagged += tools->follower[BALL].lagging;
        changes += tools->division.parts != before;
        before = tools->division.parts;
        if (before > max) max = before;
        lar_heavier now;
        lar_simulation_heavier(simulation, &now);
        heavier += now.elements > 0;
        assert_true(now.share <= strained_share && (now.elements > 0) == (now.share > 0));
        const lar_domain *d = &simulation->domain;
        for (int32_t r = 0; r < d->run_count; r++) barriers += simulation->strained.count[r];
        if (!middle && before > 1 && lagging && (step + 1) % interval == interval / 2 &&
            (now.elements > 0 || strained_share == 0))
            if (tools->follower[BALL].felt.steps > 0 && step % MOVE_STEPS > 5) middle = step + 1;
    }
    assert_true(interval > 2 && middle > 0);
    assert_true(max >= (strained_share > 0 ? 3 : 4) && changes >= 2);
    assert_true(strained_share > 0 ? heavier > 100 : heavier == 0);
    assert_true(lagged > 20 && came_back > 0 && barriers > 0);
    uint64_t late = hash_of(simulation);
    lar_simulation_destroy(simulation);
    simulation = start_with(model, setting(NULL, 0));
    known = run(simulation, 1);
    known.late = late;
    lar_simulation_destroy(simulation);
    return known;
}

static void expect(const char *what, course is, course should) {
    if (is.middle != should.middle) fail_msg("%s differs in the middle", what);
    if (is.end != should.end) fail_msg("%s differs at the end", what);
}

/* ---- on any grid, however many steps at once ------------------------------------------------ */

static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "2x2x1"};
static const uint64_t sizes[] = {1, 7, 10};
enum { GRIDS = 4, SIZES = 3 };

static void grids_and_sizes_of_advances_change_nothing(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    for (int i = test_every(2); i < 9; i += test_every(5)) {
        int grid = i / 2 % GRIDS, threads = 1 + i % 2;
        char what[80];
        lar_simulation *simulation = start_with(model, setting(grids[grid], threads));
        snprintf(what, sizeof what, "%s, %d threads, %d steps", grid ? grids[grid] : "alone",
                 threads, (int)sizes[i % SIZES]);
        expect(what, run(simulation, sizes[i % SIZES]), c);
        if (threads == 1) {
            go(simulation, LONG_RUN, sizes[i % SIZES]);
            assert_true(hash_of(simulation) == c.late);
        }
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* What is sound is left alone until nodes can have gone far enough (step/guard.c): a bound, and
 * no estimate. */
static void looking_at_all_that_is_strained_changes_nothing(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    lar_options options = setting(NULL, 0);
    options.search_always = 1;
    lar_simulation *simulation = start_with(model, options);
    assert_false(simulation->strained.follows);
    expect("looking at all", run(simulation, 7), c);
    lar_simulation_destroy(simulation);
    simulation = start_with(model, setting(NULL, 0));
    assert_true(simulation->strained.follows);
    go(simulation, STEPS, 10);
    assert_true(simulation->strained.travel > 0 && hash_of(simulation) == c.end);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void processes_change_nothing(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    for (int i = 0; i < 2; i++) {
        lar_options options = setting(grids[2 + i], 2 - i);
        options.comm = "shm";
        char what[80];
        fleet f;
        start_fleet(&f, model, options, 2 + 2 * i, NULL);
        snprintf(what, sizeof what, "%s, %d threads, %d steps", options.grid, (int)options.threads,
                 (int)sizes[2 - i]);
        expect(what, run(f.zero, sizes[2 - i]), c);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

/* The other process has what is strained, a little: whether that is looked at in every step must
 * be told, though nothing else changes. */
static void processes_know_what_is_strained(void **unused) {
    (void)unused;
    lar_model *model = organ();
    model->tool[BALL].rest.position[0] = 0.023;
    lar_options options = setting("2x1x1", 1);
    options.comm = "shm";
    fleet f;
    lar_simulation *alone = start_with(model, setting(NULL, 0));
    start_fleet(&f, model, options, 2, NULL);
    place_tool(alone, BALL, 0.023, 0.0148, 0.0156, 1, 200);
    place_tool(f.zero, BALL, 0.023, 0.0148, 0.0156, 1, 200);
    for (int i = 0; i < 20; i++) {
        advance(alone, 10);
        advance(f.zero, 10);
        assert_true(hash_of(alone) == hash_of(f.zero));
    }
    assert_true(alone->tools.division.lately > 0.3);
    lar_simulation_destroy(alone);
    end_fleet(&f);
    lar_model_destroy(model);
}

static void instruction_sets_change_nothing(void **unused) {
    (void)unused;
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    lar_model *model = organ();
    course c = plain(model);
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        const lar_kernels *kernels;
        if (lar_kernels_find(sets[i], &kernels, NULL)) continue;
        lar_options options = setting(NULL, 0);
        options.isa = sets[i];
        lar_simulation *simulation = start_with(model, options);
        expect(kernels->name, run(simulation, 10), c);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* Nothing is decided twice. */
static void no_steps_are_nothing(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    for (int grid = 0; grid < 3; grid += test_every(2)) {
        lar_simulation *simulation = start_with(model, setting(grids[grid], 1));
        while (lar_simulation_steps(simulation) < middle) {
            go(simulation, lar_simulation_steps(simulation) + 1, 1);
            advance(simulation, 0);
        }
        assert_true(hash_of(simulation) == c.middle);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- saved and taken up --------------------------------------------------------------------- */

static void save(lar_simulation *simulation) {
    lar_error error;
    if (lar_simulation_save(simulation, PATH, &error)) fail_msg("%s", error.message);
}

static void load(lar_simulation *simulation) {
    lar_error error;
    if (lar_simulation_load(simulation, PATH, &error)) fail_msg("%s", error.message);
}

/* From a file of another grid, into a simulation that has been elsewhere: nothing was strained. */
static void take_up(lar_simulation *simulation, const course *c) {
    go(simulation, 20, 10);
    load(simulation);
    assert_true(hash_of(simulation) == c->middle);
    go(simulation, STEPS, 7);
    assert_true(hash_of(simulation) == c->end);
    load(simulation);
    go(simulation, STEPS, 10);
    assert_true(hash_of(simulation) == c->end);
}

static void a_saved_run_goes_on_with_the_same_bits(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grids[grid], 1 + grid % 2));
        go(simulation, middle, 10);
        save(simulation);
        go(simulation, STEPS, 10);
        assert_true(hash_of(simulation) == c.end);
        lar_simulation_destroy(simulation);
        simulation = start_with(model, setting(grids[(grid + 1) % GRIDS], 1));
        take_up(simulation, &c);
        lar_simulation_destroy(simulation);
    }
    lar_options options = setting("2x1x1", 1);
    options.comm = "shm";
    fleet f;
    start_fleet(&f, model, options, 2, NULL);
    take_up(f.zero, &c);
    end_fleet(&f);
    lar_model_destroy(model);
}

/* After every step around an interval, so that no place in it is special. */
static void a_run_may_be_saved_anywhere(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    for (int grid = test_every(3) - 1; grid < 3; grid += 2) {
        lar_simulation *simulation = start_with(model, setting(grids[grid], 2));
        for (uint64_t step = 9; step < STEPS; step += step % 3 ? 5 : 31) {
            go(simulation, step, 10);
            save(simulation);
            advance(simulation, 3);
            load(simulation);
        }
        go(simulation, STEPS, 10);
        assert_true(hash_of(simulation) == c.end);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* What a session goes back to when its run breaks off, even between the parts of a step. */
static void copies_hold_all_of_it(void **unused) {
    (void)unused;
    lar_model *model = organ();
    course c = plain(model);
    for (int grid = 0; grid < 3; grid += test_every(2)) {
        lar_simulation *simulation = start_with(model, setting(grids[grid], 2));
        lar_state state;
        lar_tools *tools = calloc(1, sizeof *tools);
        lar_error error;
        assert_int_equal(lar_state_create(&state, simulation->state.node_count, 0, NULL), LAR_OK);
        go(simulation, middle, 10);
        assert_int_equal(lar_simulation_copy(simulation, &state, tools, NULL), LAR_OK);
        go(simulation, middle + 90, 10);
        if (lar_simulation_reset(simulation, &error)) fail_msg("%s", error.message);
        go(simulation, 20, 10);                /* nothing is strained */
        simulation->state.part = grid ? 0 : 1; /* a fault leaves it so */
        if (lar_simulation_go_back(simulation, &state, tools, &error))
            fail_msg("%s", error.message);
        assert_true(hash_of(simulation) == c.middle);
        go(simulation, STEPS, 10);
        assert_true(hash_of(simulation) == c.end);
        free(tools);
        lar_state_destroy(&state);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- what is felt --------------------------------------------------------------------------- */

/* A hand that holds for a long time does not count without end. */
static void what_hands_feel_is_forgotten(void **unused) {
    (void)unused;
    lar_model *model = organ();
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    go(simulation, 6 * MOVE_STEPS, 10);
    assert_true(simulation->tools.grasp_count > 0);
    for (int32_t t = 0; t < simulation->tools.count; t++)
        assert_true(simulation->tools.follower[t].felt.steps <= simulation->domain.interval);
    finish(simulation, model);
}

/* A heavily damped organ that swings while a ball keeps its steps divided: the largest error of the
 * account, as a part of all that is in it. */
static double account_error(const char *grid) {
    lar_model *model = organ();
    model->damping = 60;
    lar_simulation *simulation = start_with(model, setting(grid, 2));
    double worst = 0, max = 0, swing = 0;
    int32_t divided = 0;
    while (lar_simulation_steps(simulation) < LONG_RUN) {
        uint64_t step = lar_simulation_steps(simulation);
        if (step == 6 * MOVE_STEPS)
            assert_int_equal(lar_simulation_set_gravity(simulation, (double[]){40, 0, 0}, NULL),
                             LAR_OK);
        go(simulation, step + 5, 5);
        lar_energy e;
        lar_simulation_energy(simulation, &e);
        double in = e.kinetic + e.strain + e.hourglass + e.damping;
        max = fmax(max, in);
        worst = fmax(worst, fabs(in + e.contact - e.external));
        if (lar_simulation_step_parts(simulation) == 1) continue;
        swing = fmax(swing, e.kinetic);
        divided++;
    }
    finish(simulation, model);
    printf("%s: error %.3g J of %.3g J, swinging with %.3g J; %d looks at divided steps\n",
           grid ? grid : "plain", worst, max, swing, divided);
    assert_true(divided > 50);
    return worst / max;
}

static void the_account_of_energy_closes(void **unused) {
    (void)unused;
    assert_true(account_error(NULL) < 1e-4);
    assert_true(account_error("2x1x1") < 1e-4);
}

int main(int count, char **argument) {
    strained_share = count > 1 ? atof(argument[1]) : 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grids_and_sizes_of_advances_change_nothing),
        cmocka_unit_test(looking_at_all_that_is_strained_changes_nothing),
        cmocka_unit_test(processes_change_nothing),
        cmocka_unit_test(processes_know_what_is_strained),
        cmocka_unit_test(instruction_sets_change_nothing),
        cmocka_unit_test(no_steps_are_nothing),
        cmocka_unit_test(a_saved_run_goes_on_with_the_same_bits),
        cmocka_unit_test(a_run_may_be_saved_anywhere),
        cmocka_unit_test(copies_hold_all_of_it),
        cmocka_unit_test(what_hands_feel_is_forgotten),
        cmocka_unit_test(the_account_of_energy_closes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
