/* A tick asks for no memory and waits for no lock, whatever others want of the session meanwhile.
 * The engine's thread only tries locks. */
#include "session/session.h"
#include "session/session_test.h"

static pthread_t engine;
static bool counting; /* atomic */
static int calls;     /* atomic: of the engine's thread */

static void count(void) {
    if (__atomic_load_n(&counting, __ATOMIC_ACQUIRE) && pthread_equal(pthread_self(), engine))
        __atomic_fetch_add(&calls, 1, __ATOMIC_RELAXED);
}

#define WRAP(result, name, parameters, arguments)                                                  \
    result __real_##name parameters;                                                               \
    result __wrap_##name parameters;                                                               \
    result __wrap_##name parameters {                                                              \
        count();                                                                                   \
        return __real_##name arguments;                                                            \
    }

WRAP(void *, malloc, (size_t size), (size))
WRAP(void *, calloc, (size_t n, size_t size), (n, size))
WRAP(void *, realloc, (void *old, size_t size), (old, size))
WRAP(void *, aligned_alloc, (size_t align, size_t size), (align, size))
WRAP(void, free, (void *memory), (memory))
WRAP(int, pthread_mutex_lock, (pthread_mutex_t * lock), (lock))
WRAP(int, pthread_cond_wait, (pthread_cond_t * bell, pthread_mutex_t *lock), (bell, lock))
WRAP(int, pthread_cond_timedwait,
     (pthread_cond_t * bell, pthread_mutex_t *lock, const struct timespec *until),
     (bell, lock, until))

static void ticks_are_quiet(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.record = LAR_TEST_BUILD "/quiet.recording";
    options.hash_every = 20;
    bench b = open_bench(NULL, 0, &options);
    lar_snapshot *snapshot = NULL;
    lar_tool_force force;
    float kept[100][3];
    uint64_t last = 0;
    DONE(lar_snapshot_create(b.session, &snapshot, &failure));
    DONE(lar_session_start(b.session, &failure));
    engine = b.session->thread.own;
    uint64_t begin = await(&b, LAR_SESSION_PLAYING, 100).step; /* warm */
    __atomic_store_n(&counting, true, __ATOMIC_RELEASE);
    /* Long enough for a state that is kept, one every half second. */
    for (int i = 0; status_of(&b).step < begin + 6000; i++) {
        const lar_tool_pose pose = pose_at(0.02, 0.01, 0.03 - 1e-4 * (i % 100), 0);
        DONE(lar_session_tool_move(b.session, BALL, &pose, &failure));
        DONE(lar_session_snapshot(b.session, snapshot, 30, &failure));
        DONE(lar_session_tool_force(b.session, BALL, NULL, &force, &failure));
        lar_session_force_history(b.session, BALL, last, 100, kept, &last);
        lar_session_play(b.session);
        lar_session_set_pace(b.session, 1 + i % 2);
    }
    __atomic_store_n(&counting, false, __ATOMIC_RELEASE);
    assert_int_equal(__atomic_load_n(&calls, __ATOMIC_RELAXED), 0);
    /* The counter counts: in a pause the engine sleeps on its lock. */
    __atomic_store_n(&counting, true, __ATOMIC_RELEASE);
    lar_session_pause(b.session);
    await(&b, LAR_SESSION_PAUSED, 0);
    nap(0.01);
    lar_session_play(b.session);
    await(&b, LAR_SESSION_PLAYING, 0);
    __atomic_store_n(&counting, false, __ATOMIC_RELEASE);
    assert_true(__atomic_load_n(&calls, __ATOMIC_RELAXED) > 0);
    lar_snapshot_destroy(snapshot);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ticks_are_quiet)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
