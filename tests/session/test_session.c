/* A session starts, plays, pauses, steps and ends; snapshots are of one step. */
#include "session/session_test.h"

static void plays_and_pauses(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    assert_int_equal(status_of(&b).state, LAR_SESSION_IDLE);
    DONE(lar_session_start(b.session, &failure));
    nap(0.1);
    lar_session_pause(b.session);
    lar_session_status status = await_state(&b, LAR_SESSION_PAUSED);
    assert_true(status.step > 100);
    assert_int_equal(status.step % 10, 0);
    lar_session_step(b.session, 7);
    for (int i = 0; i < 5000 && status_of(&b).step < status.step + 7; i++) nap(0.001);
    assert_int_equal(await_state(&b, LAR_SESSION_PAUSED).step, status.step + 7);
    close_bench(&b);
}

static void snapshots_are_of_one_step(void **unused) {
    (void)unused;
    static const struct {
        const char *grid;
        int threads;
    } divided[] = {{NULL, 0}, {"2x1x1", 1}, {"2x1x1", 2}};
    for (int k = 0; k < 3; k++) {
        bench b = open_bench(divided[k].grid, divided[k].threads, NULL);
        lar_model *model = hanging_block();
        lar_simulation *plain = NULL;
        lar_options options = lar_options_default();
        options.time_step = 1e-4;
        DONE(lar_simulation_create(model, &options, &plain, &failure));
        lar_snapshot *snapshot = NULL;
        DONE(lar_snapshot_create(b.session, &snapshot, &failure));
        double(*u)[3] = lar_calloc((size_t)snapshot->nodes, sizeof *u);
        DONE(lar_session_start(b.session, &failure));
        for (int i = 0; i < 10; i++) {
            DONE(lar_session_snapshot(b.session, snapshot, 5, &failure));
            uint64_t now = lar_simulation_steps(plain);
            assert_true(snapshot->step >= now);
            DONE(lar_simulation_advance(plain, snapshot->step - now, &failure));
            assert_true(snapshot->hash == lar_simulation_hash(plain));
            lar_simulation_displacements(plain, u);
            assert_memory_equal(u, snapshot->u, (size_t)snapshot->nodes * sizeof *u);
            nap(0.003);
        }
        free(u);
        lar_snapshot_destroy(snapshot);
        close_bench(&b);
        lar_simulation_destroy(plain);
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(plays_and_pauses),
                                       cmocka_unit_test(snapshots_are_of_one_step)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
