/* What the tests of recordings share: a short session in which everything happens, and its replay.
 * Who includes it says first how its files are called, as NAME, for tests run side by side. */
#ifndef LAR_TESTS_RECORDING_TEST_H
#define LAR_TESTS_RECORDING_TEST_H

#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "base/file/folder.h"
#include "session/recording/record.h"
#include "session/recording/words.h"
#include "session/session.h"
#include "session/session_test.h"

#define PATH  LAR_TEST_BUILD "/" NAME ".recording"
#define STATE LAR_TEST_BUILD "/" NAME ".checkpoint"
#define BAD   LAR_TEST_BUILD "/" NAME "_bad.recording"

/* Leads the first hand along a line for so many steps: closed from the third place on. */
TEST_UNUSED static void lead(const bench *b, uint64_t steps) {
    uint64_t end = status_of(b).step + steps;
    for (int i = 0; status_of(b).step < end; i++) {
        const lar_tool_pose pose = pose_at(0.03 + 1e-4 * i, 0.02, 0.02 + 2e-5 * i, i < 3);
        DONE(lar_session_tool_move(b->session, HAND, &pose, &failure));
        nap(0.002);
    }
}

/* A short session in which everything happens. */
TEST_UNUSED static uint64_t record(const char *grid, int threads) {
    lar_session_options options = lar_session_options_default();
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_bench(grid, threads, &options);
    DONE(lar_session_start(b.session, &failure));
    assert_int_equal(status_of(&b).recording, 1);
    lead(&b, 500);
    DONE(lar_session_save(b.session, STATE, &failure));
    lead(&b, 300);
    lar_session_pause(b.session);
    await(&b, LAR_SESSION_PAUSED, 0);
    lar_session_step(b.session, 3);
    lar_session_play(b.session);
    DONE(lar_session_reset(b.session, &failure));
    lead(&b, 300);
    DONE(lar_session_load(b.session, STATE, &failure));
    lead(&b, 300);
    lar_saved *saved = NULL;
    DONE(lar_saved_create(b.simulation, &saved, &failure));
    DONE(lar_session_save_to(b.session, saved, &failure));
    lead(&b, 200);
    DONE(lar_session_load_from(b.session, saved, &failure));
    lar_saved_destroy(saved);
    lead(&b, 200);
    uint64_t step = status_of(&b).step;
    close_bench(&b);
    return step;
}

TEST_UNUSED static lar_status replay(const char *path, const char *grid, int threads,
                                     lar_replay_report *report) {
    lar_model *model = hanging_block();
    lar_simulation *simulation = NULL;
    const lar_options options = block_options(grid, threads);
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    lar_status status = lar_replay(simulation, path, NULL, NULL, report, &failure);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return status;
}

#endif
