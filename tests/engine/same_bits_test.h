/* Bodies whose materials need more than a law, led about by tools: the same bits with any set of
 * instructions, on any grid, with blocks of both kinds, after saving and loading, and in processes.
 */
#ifndef LAR_TESTS_ENGINE_SAME_BITS_TEST_H
#define LAR_TESTS_ENGINE_SAME_BITS_TEST_H

#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"

/* Hashes after 8 and after 20 ticks. */
typedef struct course {
    uint64_t middle, end;
} course;

typedef struct same_bits {
    lar_model *(*model)(const brick *b);
    const char *path; /* of a checkpoint */
    course golden;    /* of tool_brick */
} same_bits;

static lar_options setting(const char *grid, int threads) {
    lar_options options = lar_options_default();
    options.grid = grid;
    options.threads = threads;
    options.delays = grid ? 29 : 0;
    options.hands = 1;
    return options;
}

static course course_with(const lar_model *model, lar_options options) {
    lar_simulation *simulation = start_with(model, options);
    course c;
    act(simulation, 0, 8);
    c.middle = lar_simulation_hash(simulation);
    act(simulation, 8, 20);
    c.end = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return c;
}

static void the_hash_is_golden(void **state) {
    const same_bits *body = *state;
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    lar_model *model = body->model(&tool_brick);
    const lar_kernels *kernels;
    int wrong = 0;
    for (int i = 0; i < 4; i++) {
        if (lar_kernels_find(sets[i], &kernels, NULL)) continue;
        lar_options options = setting(NULL, 0);
        options.isa = sets[i];
        course c = course_with(model, options);
        if (c.middle == body->golden.middle && c.end == body->golden.end) continue;
        print_message("%s: 0x%016llx, 0x%016llx\n", kernels->name, (unsigned long long)c.middle,
                      (unsigned long long)c.end);
        wrong++;
    }
    assert_int_equal(wrong, 0);
    lar_model_destroy(model);
}

static void grids_and_threads_agree(void **state) {
    const same_bits *body = *state;
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1", "1x2x3"};
    lar_model *model = body->model(&tool_brick);
    for (int grid = 0; grid < 4; grid++)
        for (int threads = 1; threads <= 2; threads++) {
            course c = course_with(model, setting(grids[grid], threads));
            assert_int_equal(c.middle, body->golden.middle);
            assert_int_equal(c.end, body->golden.end);
        }
    lar_model_destroy(model);
}

static void lean_blocks_and_whole_ones_agree(void **state) {
    const same_bits *body = *state;
    lar_model *model = body->model(&tool_brick);
    setenv("LARIAT_BLOCKS", "lean", 1);
    course c = course_with(model, setting(NULL, 0));
    unsetenv("LARIAT_BLOCKS");
    assert_int_equal(c.end, body->golden.end);
    lar_model_destroy(model);
}

static void is_at(const lar_simulation *simulation, uint64_t hash) {
    assert_int_equal(lar_simulation_hash(simulation), hash);
}

/* Saved to a file and in memory after 8 ticks; goes on, and back as sessions do, and on again. */
static lar_saved *save_on(const same_bits *body, const lar_model *model, lar_options options) {
    lar_simulation *simulation = start_with(model, options);
    lar_state kept;
    lar_tools tools;
    lar_saved *saved;
    lar_error error;
    assert_int_equal(lar_state_create(&kept, simulation->state.node_count,
                                      simulation->state.history_count, &error),
                     LAR_OK);
    act(simulation, 0, 8);
    assert_int_equal(lar_simulation_save(simulation, body->path, &error), LAR_OK);
    assert_int_equal(lar_saved_create(simulation, &saved, &error), LAR_OK);
    assert_int_equal(lar_simulation_save_to(simulation, saved, &error), LAR_OK);
    assert_int_equal(lar_simulation_copy(simulation, &kept, &tools, &error), LAR_OK);
    act(simulation, 8, 20);
    is_at(simulation, body->golden.end);
    assert_int_equal(lar_simulation_go_back(simulation, &kept, &tools, &error), LAR_OK);
    is_at(simulation, body->golden.middle);
    act(simulation, 8, 20);
    is_at(simulation, body->golden.end);
    lar_state_destroy(&kept);
    lar_simulation_destroy(simulation);
    return saved;
}

/* Taken up from the file, from memory, and from the beginning. */
static void load_on(const same_bits *body, const lar_model *model, lar_options options,
                    const lar_saved *saved) {
    lar_simulation *simulation = start_with(model, options);
    lar_error error;
    if (lar_simulation_load(simulation, body->path, &error)) fail_msg("%s", error.message);
    is_at(simulation, body->golden.middle);
    act(simulation, 8, 20);
    is_at(simulation, body->golden.end);
    if (lar_simulation_load_from(simulation, saved, &error)) fail_msg("%s", error.message);
    is_at(simulation, body->golden.middle);
    act(simulation, 8, 20);
    is_at(simulation, body->golden.end);
    assert_int_equal(lar_simulation_reset(simulation, &error), LAR_OK);
    act(simulation, 0, 8);
    is_at(simulation, body->golden.middle);
    lar_simulation_destroy(simulation);
}

static void check_saved_runs(const same_bits *body) {
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1"};
    lar_model *model = body->model(&tool_brick);
    for (int from = 0; from < 3; from++) {
        int to = (from + 1) % 3;
        lar_saved *saved = save_on(body, model, setting(grids[from], from ? 1 : 0));
        load_on(body, model, setting(grids[to], to ? 2 : 0), saved);
        lar_saved_destroy(saved);
    }
    lar_model_destroy(model);
}

/* What processes tell each other: of a finer body more than one packet. */
static void processes_agree(void **state) {
    const same_bits *body = *state;
    for (int fine = 0; fine < 2; fine++) {
        lar_model *model = body->model(fine ? &fine_tool_brick : &tool_brick);
        course straight = course_with(model, setting(NULL, 0));
        lar_options options = setting(fine ? "2x1x1" : "2x2x1", 1);
        lar_error error;
        options.comm = fine ? "tcp" : "shm";
        fleet f;
        start_fleet(&f, model, options, fine ? 2 : 4, NULL);
        act(f.zero, 0, 8);
        is_at(f.zero, straight.middle);
        assert_int_equal(lar_simulation_save(f.zero, body->path, &error), LAR_OK);
        act(f.zero, 8, 20);
        is_at(f.zero, straight.end);
        if (lar_simulation_load(f.zero, body->path, &error)) fail_msg("%s", error.message);
        act(f.zero, 8, 20);
        is_at(f.zero, straight.end);
        end_fleet(&f);
        lar_model_destroy(model);
    }
}

/* For the list of a program's tests: those that are the same for every body. */
#define SAME_BITS_TESTS(body)                                                                      \
    cmocka_unit_test_prestate(the_hash_is_golden, &(body)),                                        \
        cmocka_unit_test_prestate(grids_and_threads_agree, &(body)),                               \
        cmocka_unit_test_prestate(lean_blocks_and_whole_ones_agree, &(body)),                      \
        cmocka_unit_test_prestate(processes_agree, &(body))

/* What is in a body or has left it; the account is even where it grows as `external` does. */
static double sum_of(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass + e->damping + e->contact + e->viscous;
}

/* By how much the account of a body on its way is open at most [J], looked at 60 times in 6,000
 * steps; and the largest energy there was. */
TEST_UNUSED static double account_open(lar_simulation *simulation, double *largest) {
    lar_energy start_energy, e;
    double worst = 0;
    lar_simulation_energy(simulation, &start_energy);
    *largest = 0;
    for (int n = 0; n < 60; n++) {
        advance(simulation, 100);
        lar_simulation_energy(simulation, &e);
        *largest = fmax(*largest, sum_of(&e));
        worst = fmax(worst, fabs(sum_of(&e) - e.external - sum_of(&start_energy)));
    }
    return worst;
}

#endif
