/* Binding a thread, letting go one that it started, and putting it back. */
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/pin.h"

static int allowed(void) {
    cpu_set_t set;
    return sched_getaffinity(0, sizeof set, &set) ? 0 : CPU_COUNT(&set);
}

static void *started_by_a_bound_one(void *context) {
    int *seen = context;
    seen[0] = allowed();
    lar_pin_nowhere();
    seen[1] = allowed();
    return NULL;
}

static void a_thread_of_a_bound_one_can_be_free(void **state) {
    (void)state;
    int before = allowed(), seen[2];
    pthread_t thread;
    if (lar_pin_cores() < 2) {
        print_message("skipped: no cores to choose from, or no hwloc\n");
        return;
    }
    lar_pin *pin = lar_pin_remember();
    assert_true(lar_pin_to(0));
    assert_int_equal(pthread_create(&thread, NULL, started_by_a_bound_one, seen), 0);
    pthread_join(thread, NULL);
    assert_int_equal(seen[0], 1);
    assert_int_equal(seen[1], before);
    assert_int_equal(allowed(), 1);
    lar_pin_restore(pin);
    assert_int_equal(allowed(), before);
    assert_false(lar_pin_to(lar_pin_cores()));
    assert_false(lar_pin_to(-1));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_thread_of_a_bound_one_can_be_free)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
