/* What the tests of sessions share: a small soft block that sags, a ball beside it, two hands, and
 * a session over all of it. */
#ifndef LAR_TESTS_SESSION_TEST_H
#define LAR_TESTS_SESSION_TEST_H

#include <pthread.h>
#include <unistd.h>

#include "base/clock.h"
#include "engine/engine_test.h"

typedef struct bench {
    lar_model *model;
    lar_simulation *simulation;
    lar_session *session;
} bench;

static lar_error failure;

#define DONE(call)                                                                                 \
    do {                                                                                           \
        failure.message[0] = '\0';                                                                 \
        if (call) fail_msg("%s", failure.message);                                                 \
    } while (0)

enum { BALL = 0, HAND = 1, TOOLS = 3 };

/* A block that is held at its left side and hangs under its weight; above it a ball. */
TEST_UNUSED static lar_model *hanging_block(void) {
    lar_model *model = brick_model(&soft_brick);
    fix_nodes(model, brick_side(&soft_brick, 0, 0), 7);
    model->gravity[2] = -1;
    model->damping = 20;
    *(lar_tool *)LAR_MODEL_APPEND(model, tool) =
        (lar_tool){.name = lar_strdup("ball"),
                   .shape = LAR_TOOL_SPHERE,
                   .radius = 0.004,
                   .rest = {.position = {0.02, 0.01, 0.03}, .orientation = {1, 0, 0, 0}}};
    if (lar_model_check(model, &failure)) fail_msg("%s", failure.message);
    return model;
}

/* The same, torn apart by a force that sets in at step 200. */
TEST_UNUSED static lar_model *torn_block(void) {
    static const double points[3][2] = {{0, 0}, {0.02, 0}, {0.021, 1}};
    lar_model *model = hanging_block();
    load_nodes(model, brick_side(&soft_brick, 0, -1), 1e4, 0, 0,
               add_table(model, LAR_CURVE_LINEAR, 3, points));
    return model;
}

TEST_UNUSED static lar_options block_options(const char *grid, int threads) {
    lar_options options = lar_options_default();
    options.time_step = 1e-4;
    options.grid = grid;
    options.threads = threads;
    options.hands = 2;
    return options;
}

TEST_UNUSED static bench open_bench_of(lar_model *model, const char *grid, int threads,
                                       const lar_session_options *session_options) {
    bench b = {.model = model};
    lar_options options = block_options(grid, threads);
    DONE(lar_simulation_create(b.model, &options, &b.simulation, &failure));
    DONE(lar_session_open(b.simulation, session_options, &b.session, &failure));
    return b;
}

TEST_UNUSED static bench open_bench(const char *grid, int threads,
                                    const lar_session_options *session_options) {
    return open_bench_of(hanging_block(), grid, threads, session_options);
}

TEST_UNUSED static void close_bench(bench *b) {
    DONE(lar_session_close(b->session, &failure));
    lar_simulation_destroy(b->simulation);
    lar_model_destroy(b->model);
}

TEST_UNUSED static lar_session_status status_of(const bench *b) {
    lar_session_status status;
    lar_session_status_get(b->session, &status);
    return status;
}

TEST_UNUSED static void nap(double seconds) {
    lar_clock_sleep_until(lar_clock_ns() + (int64_t)(1e9 * seconds));
}

/* Waits until the session is in that state and at that step at least; long enough for any machine.
 */
TEST_UNUSED static lar_session_status await(const bench *b, lar_session_state state,
                                            uint64_t step) {
    lar_session_status status = status_of(b);
    for (int i = 0; i < 30000 && (status.state != state || status.step < step); i++) {
        nap(0.001);
        status = status_of(b);
    }
    assert_int_equal(status.state, state);
    assert_true(status.step >= step);
    return status;
}

TEST_UNUSED static lar_tool_pose pose_at(double x, double y, double z, double opening) {
    return (lar_tool_pose){.position = {x, y, z}, .orientation = {1, 0, 0, 0}, .opening = opening};
}

#endif
