/* Triple buffers and the history of forces between threads that never wait for each other: what is
 * read is whole, the newest, and never goes back. */
#include <pthread.h>
#include <sched.h>

#include "session/triple_buffer.h"
#include "session/history.h"
#include "testing.h"

static lar_error failure;

enum { WORDS = 100, VALUES = 200000 };

typedef struct value {
    uint64_t word[WORDS];
} value;

static void *write_values(void *argument) {
    lar_triple_buffer *box = argument;
    for (uint64_t n = 1; n <= VALUES; n++) {
        value *draft = lar_triple_buffer_back(box);
        for (int i = 0; i < WORDS; i++) {
            draft->word[i] = n;
            if (n % 100 == 0 && i == WORDS / 2) sched_yield(); /* also where there is one core */
        }
        lar_triple_buffer_publish(box);
    }
    return NULL;
}

static void values_are_whole(void **unused) {
    (void)unused;
    lar_triple_buffer box;
    pthread_t writer;
    assert_int_equal(lar_triple_buffer_create(&box, sizeof(value), "a test", &failure), LAR_OK);
    bool fresh = true;
    lar_triple_buffer_newest(&box, &fresh);
    assert_false(fresh);
    assert_int_equal(pthread_create(&writer, NULL, write_values, &box), 0);
    uint64_t last = 0, seen = 0;
    while (last < VALUES) {
        const value *newest = lar_triple_buffer_newest(&box, &fresh);
        uint64_t n = newest->word[0];
        if (fresh ? n <= last : n != last) fail_msg("%d behind %d", (int)n, (int)last);
        for (int i = 0; i < WORDS; i++) {
            if (i == WORDS / 2) sched_yield();
            if (newest->word[i] != n) fail_msg("a torn value: %d and %d", (int)n, i);
        }
        seen += fresh;
        last = n;
    }
    assert_true(seen > 0);
    pthread_join(writer, NULL);
    lar_triple_buffer_destroy(&box);
    lar_triple_buffer_destroy(&box);
}

/* ---- the history --------------------------------------------------------------------------- */

enum { TICKS = 60000 };

static void *write_history(void *argument) {
    lar_history *history = argument;
    for (int n = 1; n <= TICKS; n++) {
        lar_history_begin(history);
        lar_history_put(history, 0, (double[]){n, -n, 2 * n});
        lar_history_put(history, 1, (double[]){0, 0, n});
        lar_history_end(history);
    }
    return NULL;
}

static void histories_are_whole(void **unused) {
    (void)unused;
    static float force[LAR_HISTORY_TICKS][3];
    lar_history history;
    pthread_t writer;
    assert_int_equal(lar_history_create(2, &history, &failure), LAR_OK);
    assert_int_equal(pthread_create(&writer, NULL, write_history, &history), 0);
    for (uint64_t after = 0, last = 0; after < TICKS; after = last) {
        int32_t count = lar_history_copy(&history, 0, after, LAR_HISTORY_TICKS, force, &last);
        assert_true(last >= after);
        for (int32_t i = 0; i < count; i++) {
            float n = (float)(last - (uint64_t)(count - 1 - i));
            if (force[i][0] != n || force[i][1] != -n || force[i][2] != 2 * n)
                fail_msg("tick %g holds %g %g %g", n, force[i][0], force[i][1], force[i][2]);
        }
    }
    pthread_join(writer, NULL);
    lar_history_destroy(&history);
}

static void old_ticks_are_left_out(void **unused) {
    (void)unused;
    static float force[LAR_HISTORY_TICKS + 10][3];
    lar_history history;
    uint64_t last = 0;
    assert_int_equal(lar_history_create(2, &history, &failure), LAR_OK);
    assert_int_equal(lar_history_copy(&history, 1, 0, 10, force, &last), 0);
    assert_int_equal(last, 0);
    write_history(&history);
    assert_int_equal(lar_history_copy(&history, 1, 0, LAR_HISTORY_TICKS + 10, force, &last),
                     LAR_HISTORY_TICKS);
    assert_int_equal(last, TICKS);
    assert_true(force[0][2] == TICKS - LAR_HISTORY_TICKS + 1);
    assert_int_equal(lar_history_copy(&history, 1, TICKS - 3, 2, force, &last), 2);
    assert_int_equal(last, TICKS - 1);
    assert_true(force[1][2] == TICKS - 1);
    assert_int_equal(lar_history_copy(&history, 1, TICKS, 2, force, &last), 0);
    assert_int_equal(lar_history_copy(&history, 1, UINT64_MAX - 1, 2, force, &last), 0);
    assert_true(last == UINT64_MAX - 1);
    assert_int_equal(lar_history_copy(&history, 1, 0, -1, force, &last), 0);
    lar_history_destroy(&history);
    lar_history_destroy(&history);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(values_are_whole),
                                       cmocka_unit_test(histories_are_whole),
                                       cmocka_unit_test(old_ticks_are_left_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
