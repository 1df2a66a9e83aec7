/* Recordings that are played in a session or cut short, and rings that run full. */
#define NAME "played"
#include "session/recording_test.h"

static lar_session_status play_for(const bench *b, double seconds) {
    lar_session_play(b->session);
    nap(seconds);
    lar_session_pause(b->session);
    return await(b, LAR_SESSION_PAUSED, 0);
}

/* A recording that has ended by itself costs nothing any more. */
static void full_rings_are_not_hashed_for(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.record = PATH;
    options.hash_every = 20;
    bench b = open_bench(NULL, 0, &options);
    const lar_record any = {.kind = LAR_RECORD_HASH};
    DONE(lar_session_start(b.session, &failure));
    play_for(&b, 0.05);
    assert_int_equal(status_of(&b).recording, 1);
    while (lar_recorder_put(b.session->recorder, &any)) continue; /* the engine sleeps */
    assert_int_equal(play_for(&b, 0.1).recording, 0);
    uint64_t hashed = b.session->hashed;
    assert_true(play_for(&b, 0.1).step > hashed + 3 * options.hash_every);
    assert_true(b.session->hashed == hashed);
    assert_int_equal(lar_session_record(b.session, NULL, &failure), LAR_ERROR_IO);
    assert_non_null(strstr(failure.message, "too slow"));
    close_bench(&b);
    remove(PATH);
}

/* Waits until what is played rests at a moment, which may lie behind its end. */
static lar_session_status rest_at(const bench *b, double seconds) {
    lar_session_status status = {0};
    for (int i = 0; i < 4000; i++) {
        status = status_of(b);
        if (status.state == LAR_SESSION_PAUSED &&
            fabs(status.replay_time - fmin(seconds, status.replay_length)) < 1.5e-4)
            return status;
        nap(0.005);
    }
    fail_msg("it does not come to rest, at %g of %g s", status.replay_time, status.replay_length);
    return status;
}

static uint64_t hash_at(const bench *b, double seconds) {
    lar_snapshot *snapshot = NULL;
    lar_session_seek(b->session, seconds);
    rest_at(b, seconds);
    DONE(lar_snapshot_create(b->session, &snapshot, &failure));
    DONE(lar_session_snapshot(b->session, snapshot, 10, &failure));
    uint64_t hash = snapshot->hash;
    lar_snapshot_destroy(snapshot);
    return hash;
}

/* In a session: with play and pause, to any place and to the same bits, and out of it. */
static void is_played_in_a_session(void **unused) {
    (void)unused;
    record(NULL, 1);
    lar_session_options options = lar_session_options_default();
    options.pace = 0;
    bench b = open_bench(NULL, 1, &options);
    DONE(lar_session_start(b.session, &failure));
    DONE(lar_session_replay(b.session, PATH, &failure));
    const lar_session_status status = rest_at(&b, 1e9);
    assert_string_equal(status.message, "");
    assert_true(status.replaying && status.replay_length > 0.05);
    assert_true(status.replay_time == status.replay_length);
    const double inside = 0.6 * status.replay_length;
    const uint64_t end = hash_at(&b, 1e9), middle = hash_at(&b, inside), begin = hash_at(&b, 0);
    assert_true(end != middle && middle != begin);
    assert_true(hash_at(&b, inside) == middle);
    assert_true(hash_at(&b, 1e9) == end);
    for (int i = 0; i < 20; i++) { /* where it rests, and elsewhere before it has answered */
        lar_session_seek(b.session, 1e9);
        lar_session_seek(b.session, inside);
        rest_at(&b, inside);
        lar_session_seek(b.session, 1e9);
        rest_at(&b, 1e9);
    }
    assert_int_not_equal(lar_session_record(b.session, "other.recording", &failure), LAR_OK);
    assert_non_null(strstr(failure.message, "is being played"));
    DONE(lar_session_replay(b.session, NULL, &failure)); /* and on from there */
    assert_false(status_of(&b).replaying);
    DONE(lar_session_replay(b.session, PATH, &failure));
    DONE(lar_session_reset(b.session, &failure));
    assert_false(status_of(&b).replaying);
    assert_int_not_equal(lar_session_replay(b.session, "none.recording", &failure), LAR_OK);
    close_bench(&b);
}

static int few(void *context, uint64_t step) {
    (void)step;
    return ++*(int *)context < 5;
}

static void replays_can_be_ended(void **unused) {
    (void)unused;
    record(NULL, 0);
    lar_recording_info info;
    DONE(lar_recording_inspect(PATH, &info, &failure));
    assert_int_equal(info.hands, 2);
    assert_int_equal(info.tick_steps, 10);
    lar_model *model = hanging_block();
    lar_simulation *simulation = NULL;
    lar_options options = lar_options_default();
    options.time_step = info.time_step;
    options.hands = info.hands;
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    int ticks = 0;
    lar_replay_report report;
    DONE(lar_replay(simulation, PATH, few, &ticks, &report, &failure));
    assert_int_equal(ticks, 5);
    assert_true(report.steps <= 50 && report.steps > 0);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_rings_are_not_hashed_for),
        cmocka_unit_test(is_played_in_a_session),
        cmocka_unit_test(replays_can_be_ended),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
