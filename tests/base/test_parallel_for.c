/* Every item is done once, whoever does it. */
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/parallel_for.h"

enum { MAX = 1000 };

typedef struct work {
    int done[MAX]; /* written by whoever has the item */
    int32_t count, portion;
    int bad; /* atomic: portions that are none */
    int calls;
} work;

static void count_up(void *context, int32_t first, int32_t end) {
    work *w = context;
    if (first % w->portion != 0 || end <= first || end - first > w->portion || end > w->count)
        __atomic_fetch_add(&w->bad, 1, __ATOMIC_RELAXED);
    __atomic_fetch_add(&w->calls, 1, __ATOMIC_RELAXED);
    for (int32_t i = first; i < end; i++) w->done[i]++;
}

static void every_item_is_done_once(void **state) {
    (void)state;
    const int32_t counts[] = {0, 1, 2, 7, 999, 1000}, portions[] = {1, 3, 64, 1000, INT32_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (size_t k = 0; k < sizeof portions / sizeof *portions; k++) {
            work w = {.count = counts[i], .portion = portions[k]};
            lar_parallel_for(w.count, w.portion, count_up, &w);
            assert_int_equal(w.bad, 0);
            assert_int_equal(w.calls, ((int64_t)w.count + w.portion - 1) / w.portion);
            for (int32_t n = 0; n < MAX; n++) assert_int_equal(w.done[n], n < w.count);
        }
}

typedef struct nest {
    work row[8];
} nest;

static void share_rows(void *context, int32_t first, int32_t end) {
    nest *all = context;
    for (int32_t r = first; r < end; r++) {
        all->row[r] = (work){.count = MAX, .portion = 10};
        lar_parallel_for(MAX, 10, count_up, &all->row[r]);
    }
}

static void calls_can_be_nested(void **state) {
    (void)state;
    static nest all;
    memset(&all, 0, sizeof all);
    lar_parallel_for(8, 1, share_rows, &all);
    for (int r = 0; r < 8; r++)
        for (int32_t n = 0; n < MAX; n++) assert_int_equal(all.row[r].done[n], 1);
}

/* Waits for another one who is at work at the same time, and no longer than ten seconds. */
static void meet(void *context, int32_t first, int32_t end) {
    int *here = context;
    (void)first, (void)end;
    __atomic_fetch_add(here, 1, __ATOMIC_SEQ_CST);
    for (int waits = 0; waits < 10000 && __atomic_load_n(here, __ATOMIC_SEQ_CST) < 2; waits++)
        usleep(1000);
    if (__atomic_load_n(here, __ATOMIC_SEQ_CST) == 2) return;
    __atomic_fetch_add(here, 100, __ATOMIC_SEQ_CST);
}

static void two_cores_are_at_work_at_once(void **state) {
    (void)state;
    cpu_set_t allowed;
    int here = 0;
    if (sched_getaffinity(0, sizeof allowed, &allowed) || CPU_COUNT(&allowed) < 2) {
        print_message("skipped: one core\n");
        return;
    }
    lar_parallel_for(2, 1, meet, &here);
    assert_int_equal(here, 2);
}

/* Portions are taken in ascending order: each waits for the one before it, or this never ends. */
static void wait_for_before(void *context, int32_t first, int32_t end) {
    int32_t *done = context;
    for (int32_t n = first; n < end; n++) {
        while (n > 0 && !__atomic_load_n(&done[n - 1], __ATOMIC_ACQUIRE)) usleep(1);
        __atomic_store_n(&done[n], 1, __ATOMIC_RELEASE);
    }
}

static void an_item_may_wait_for_lower_ones(void **state) {
    (void)state;
    for (int32_t threads = 1; threads <= 5; threads++) {
        int32_t done[100] = {0};
        lar_parallel_for_threads(threads);
        lar_parallel_for(100, 1, wait_for_before, done);
        assert_int_equal(done[99], 1);
    }
    lar_parallel_for_threads(0);
}

static void put(const char *folder, const char *name, const char *text) {
    char path[256];
    for (const char *at = folder; (at = strchr(at + 1, '/'));) { /* and those above it */
        snprintf(path, sizeof path, "%.*s", (int)(at - folder), folder);
        mkdir(path, 0777);
    }
    mkdir(folder, 0777);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* A container's limits, of both versions of control groups. */
static void groups_limit_cores(void **state) {
    (void)state;
    const char *none = "groups/none", *list = "groups/list";
    unlink("groups/two/a/cpu.max"); /* of an earlier run */
    put("groups", "list", "0::/a/b\n");
    assert_true(isinf(lar_cores_of_groups(none, "groups/two")));
    assert_true(isinf(lar_cores_of_groups(list, "groups/nothing")));
    put("groups/two/a/b", "cpu.max", "max 100000\n");
    assert_true(isinf(lar_cores_of_groups(list, "groups/two")));
    put("groups/two/a/b", "cpu.max", "250000 100000\n");
    assert_true(lar_cores_of_groups(list, "groups/two") == 2.5);
    put("groups/two/a", "cpu.max", "150000 100000\n"); /* above it */
    assert_true(lar_cores_of_groups(list, "groups/two") == 1.5);
    put("groups/own", "cpu.max", "50000 100000\n"); /* a container sees its own as the root */
    assert_true(lar_cores_of_groups(list, "groups/own") == 0.5);
    put("groups", "list", "7:memory:/c\n4:cpu,cpuacct:/c\n3:cpuset:/\n0::/\n");
    put("groups/one/cpu/c", "cpu.cfs_quota_us", "-1\n");
    put("groups/one/cpu/c", "cpu.cfs_period_us", "100000\n");
    assert_true(isinf(lar_cores_of_groups(list, "groups/one")));
    put("groups/one/cpu/c", "cpu.cfs_quota_us", "300000\n");
    assert_true(lar_cores_of_groups(list, "groups/one") == 3);
    assert_true(lar_usable_cores() >= 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(groups_limit_cores),
        cmocka_unit_test(every_item_is_done_once),
        cmocka_unit_test(calls_can_be_nested),
        cmocka_unit_test(two_cores_are_at_work_at_once),
        cmocka_unit_test(an_item_may_wait_for_lower_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
