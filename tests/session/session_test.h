/* What the tests of sessions share: a small soft block that sags, with a session over it. */
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

/* A block that is held at its left side and hangs under its weight. */
TEST_UNUSED static lar_model *hanging_block(void) {
    lar_model *model = brick_model(&soft_brick);
    fix_nodes(model, brick_side(&soft_brick, 0, 0), 7);
    model->gravity[2] = -9.81;
    return model;
}

TEST_UNUSED static bench open_bench(const char *grid, int threads,
                                    const lar_session_options *session_options) {
    bench b = {.model = hanging_block()};
    lar_options options = lar_options_default();
    options.time_step = 1e-4;
    options.grid = grid;
    options.threads = threads;
    options.hands = 2;
    DONE(lar_simulation_create(b.model, &options, &b.simulation, &failure));
    DONE(lar_session_open(b.simulation, session_options, &b.session, &failure));
    return b;
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
    usleep((useconds_t)(1e6 * seconds));
}

/* Waits until the session is in that state, a few seconds at most. */
TEST_UNUSED static lar_session_status await_state(const bench *b, lar_session_state state) {
    lar_session_status status = status_of(b);
    for (int i = 0; i < 20000 && status.state != state; i++) {
        nap(0.0005);
        status = status_of(b);
    }
    assert_int_equal(status.state, state);
    return status;
}

#endif
