/* Workers of a pool all do their part of a job, in short turns; the caller's are as long afterwards
 * as they were before. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

#include <cmocka.h>

#include "base/thread.h"
#include "base/thread_pool.h"

enum { WORKERS = 3, JOBS = 200 };

typedef struct seen {
    int32_t times;
    uint64_t longer; /* than what a pool asks for [ns]; 0: no longer, or nobody can say */
} seen;

static void look(void *context, int32_t worker) {
    seen *own = (seen *)context + worker;
    own->times++;
    own->longer = lar_thread_shorten_slice();
}

static void workers_take_short_turns_and_the_caller_only_meanwhile(void **state) {
    (void)state;
    lar_thread_pool *pool;
    lar_error error;
    seen worker[WORKERS] = {0};
    uint64_t before = lar_thread_shorten_slice();
    lar_thread_restore_slice(before);
    if (!before) print_message("this system gives no thread slices of its own, or short ones\n");
    if (lar_thread_pool_create(WORKERS, false, 0, &pool, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < JOBS; i++) lar_thread_pool_run(pool, look, worker);
    for (int i = 0; i < WORKERS; i++) {
        assert_int_equal(worker[i].times, JOBS);
        assert_true(worker[i].longer == 0);
    }
    lar_thread_pool_destroy(pool);
    uint64_t after = lar_thread_shorten_slice();
    lar_thread_restore_slice(after);
    assert_true(after == before);
}

static void tell_priority(void *context, int32_t worker) {
    ((int *)context)[worker] = lar_thread_priority();
}

/* Workers that go before others do their part asleep or awake, and are as before in the end. */
static void workers_go_before_others_for_a_while(void **state) {
    (void)state;
    enum { URGENT = 3 };
    const struct timespec long_asleep = {0, 5000000};
    lar_thread_pool *pool;
    lar_error error;
    int priority[WORKERS], own = lar_thread_priority();
    bool may = lar_thread_set_priority(URGENT) == 0;
    lar_thread_set_priority(own);
    if (!may) print_message("this system lets no thread go before others\n");
    if (lar_thread_pool_create(WORKERS, false, 0, &pool, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < JOBS; i++) {
        int wanted = i % 4 < 2 ? URGENT : 0;
        if (i % 2 == 0) lar_thread_pool_go_before(pool, wanted);
        if (i % 10 == 0) nanosleep(&long_asleep, NULL);
        if (i % 3 == 0) lar_thread_pool_rouse(pool);
        lar_thread_pool_run(pool, tell_priority, priority);
        assert_int_equal(priority[0], own);
        for (int w = 1; w < WORKERS; w++)
            assert_int_equal(priority[w], wanted && may ? wanted : own);
    }
    lar_thread_pool_destroy(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(workers_take_short_turns_and_the_caller_only_meanwhile),
        cmocka_unit_test(workers_go_before_others_for_a_while)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
