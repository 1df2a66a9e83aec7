/* A processor that dies, stops or fails: everyone else ends within two seconds with a message that
 * names it, and nothing is left behind. With the argument "every" each processor in turn is the
 * victim. */
#include "loss.h"

enum { PROCESSORS = 4, BACKENDS_MAX = 8 };

typedef struct scene {
    const char *backend;
    loss_results *results;
    fleet_processes running;
} scene;

static void launch(scene *s, const char *backend, int32_t victim, loss_kind kind, int cut) {
    s->backend = backend;
    s->results = loss_results_create(victim, kind);
    s->results->cut = cut;
    fleet_launch((fleet){.backend = backend,
                         .count = PROCESSORS,
                         .bytes = LOSS_BYTES,
                         .body = loss_ring,
                         .context = s->results,
                         .around = loss_around},
                 &s->running);
    loss_await_steps(s->results, PROCESSORS, 100);
}

/* Takes all words, then looks at what is left. Returns how many things are wrong. */
static int finish(scene *s, loss_control *control) {
    char texts[PROCESSORS][FLEET_TEXT];
    int32_t victim = s->results->victim;
    int wrong = 0;
    for (int32_t p = 0; p < PROCESSORS; p++)
        if (p != victim) fleet_reap(&s->running, p, texts[p]);
    double late = loss_control_stop(control), last = 0;
    __atomic_store_n(&s->results->released, 1, __ATOMIC_RELEASE);
    if (s->results->kind == LOSS_STOP) kill(s->running.pid[victim], SIGKILL);
    fleet_reap(&s->running, victim, texts[victim]);
    for (int32_t p = 0; p < PROCESSORS; p++) {
        if (p == victim) continue;
        wrong += loss_check(s->results, s->backend, p, texts[p], late);
        if (s->results->entries[p].ended > last) last = s->results->entries[p].ended;
    }
    print_message("%s, processor %d, kind %d: all stopped after %.2f s\n", s->backend, (int)victim,
                  (int)s->results->kind, last - s->results->began);
    bool cut = s->results->kind == LOSS_CUT || s->results->kind == LOSS_CUT_ONE;
    if (cut && s->results->entries[victim].status != LAR_ERROR_PEER) {
        print_error("processor %d, cut off, says: %s\n", (int)victim, texts[victim]);
        wrong++;
    }
    if (loss_sockets_left(s->running.master)) print_error("sockets are left\n"), wrong++;
    munmap(s->results, sizeof *s->results);
    return wrong;
}

/* The same trouble over every backend at once: most of the time is waiting. */
static void lose(int32_t victim, loss_kind kind, int cut) {
    scene scenes[BACKENDS_MAX];
    loss_control controls[BACKENDS_MAX];
    lar_comm_backend_info info;
    int count = 0, wrong = 0;
    for (int i = 0; fleet_backend(i, &info); i++)
        /* Which of its sockets carry packets is UCX's own affair. */
        if (info.start == LAR_COMM_BY_ADDRESS && count < BACKENDS_MAX &&
            !(kind == LOSS_CUT_ONE && strcmp(info.name, "ucx") == 0))
            launch(&scenes[count++], info.name, victim, kind, cut);
    for (int i = 0; i < count; i++) {
        loss_control_start(&controls[i]);
        loss_begin(scenes[i].results, scenes[i].running.pid[victim]);
    }
    for (int i = 0; i < count; i++) wrong += finish(&scenes[i], &controls[i]);
    assert_int_equal(wrong, 0);
    assert_int_equal(loss_objects_left(), 0);
}

static bool every_victim; /* or only processor zero and one other */

static void lose_each(loss_kind kind) {
    for (int32_t victim = 0; victim < PROCESSORS; victim++) {
        if (!every_victim && victim % 2) continue;
        lose(victim, kind, 0);
    }
}

static void a_killed_processor_is_named(void **state) {
    (void)state;
    lose_each(LOSS_KILL);
}
static void a_stopped_processor_is_named(void **state) {
    (void)state;
    lose_each(LOSS_STOP);
}
static void a_cut_processor_is_named(void **state) {
    (void)state;
    lose_each(LOSS_CUT);
}
/* Some lead to processor zero, some (tcp) to neighbours. */
static void one_cut_connection_is_enough(void **state) {
    (void)state;
    for (int cut = 0; cut < (every_victim ? 5 : 3); cut++) lose(1, LOSS_CUT_ONE, cut);
}
static void a_failing_processor_is_named(void **state) {
    (void)state;
    lose_each(LOSS_FAIL);
}
static void a_hanging_processor_is_named(void **state) {
    (void)state;
    if (every_victim)
        lose_each(LOSS_HANG);
    else
        lose(2, LOSS_HANG, 0);
}

/* ---- suspended together ---------------------------------------------------------------------- */

/* For longer than the silence, and the patience, after which somebody is given up. */
static void signal_all(scene *scenes, int count, int signal) {
    for (int i = 0; i < count; i++)
        for (int32_t p = 0; p < PROCESSORS; p++) kill(scenes[i].running.pid[p], signal);
}

static void a_job_suspended_as_a_whole_goes_on(void **state) {
    (void)state;
    scene scenes[BACKENDS_MAX];
    loss_control controls[BACKENDS_MAX];
    lar_comm_backend_info info;
    int count = 0, wrong = 0;
    for (int i = 0; fleet_backend(i, &info); i++)
        if (info.start == LAR_COMM_BY_ADDRESS && count < BACKENDS_MAX)
            launch(&scenes[count++], info.name, 1, LOSS_KILL, 0);
    for (int times = 0; times < 2; times++) {
        signal_all(scenes, count, SIGSTOP);
        usleep(3000000);
        signal_all(scenes, count, SIGCONT);
        for (int i = 0; i < count; i++) {
            uint64_t step = __atomic_load_n(&scenes[i].results->entries[0].step, __ATOMIC_ACQUIRE);
            loss_await_steps(scenes[i].results, PROCESSORS, step + 100);
        }
    }
    usleep(2000000); /* who was accused would be given up by now */
    for (int i = 0; i < count; i++) {
        loss_control_start(&controls[i]);
        loss_begin(scenes[i].results, scenes[i].running.pid[1]);
    }
    for (int i = 0; i < count; i++) wrong += finish(&scenes[i], &controls[i]);
    assert_int_equal(wrong, 0);
}

/* In one process; `at_step` the victim fails, or hangs until the others have ended. */
typedef struct mishap {
    bool fails;
    int ended; /* atomic: processors */
} mishap;

static const char *mishap_ring(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    mishap *m = context;
    lar_error error;
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    int32_t next = (self + 1) % count, last = (self + count - 1) % count;
    for (uint64_t step = 1;; step++) {
        if (self == 1 && step == 100 && m->fails) {
            lar_comm_abort(comm);
            return "its own failure";
        }
        while (self == 1 && step == 100 && __atomic_load_n(&m->ended, __ATOMIC_ACQUIRE) < count - 1)
            usleep(1000);
        if (lar_comm_put(comm, next, 0, "", 1, step, &error) ||
            lar_comm_put(comm, last, 256, "", 1, step, &error) ||
            lar_comm_wait(comm, last, 0, 1, step, NULL, &error) ||
            lar_comm_wait(comm, next, 256, 1, step, NULL, &error)) {
            __atomic_fetch_add(&m->ended, 1, __ATOMIC_ACQ_REL);
            return fleet_say(text, "%s", error.message);
        }
    }
}

/* Threads cannot be killed; they fail or hang. */
static void threads_that_fail_or_hang_are_named(void **state) {
    (void)state;
    for (int fails = 0; fails < 2; fails++) {
        char texts[4][FLEET_TEXT];
        mishap m = {.fails = fails};
        fleet_threads((fleet){.backend = "threads",
                              .count = 4,
                              .bytes = 512,
                              .body = mishap_ring,
                              .context = &m,
                              .patience = 0.5},
                      texts);
        for (int p = 0; p < 4; p++)
            if (p != 1) assert_non_null(strstr(texts[p], "processor 1 is lost"));
    }
}

static const char *nothing(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)comm, (void)context, (void)text;
    return NULL;
}

/* Processor 1 never comes. */
static void who_does_not_come_is_named(void **state) {
    (void)state;
    lar_error error;
    fleet f = {.backend = "tcp", .count = 3, .bytes = 64, .body = nothing, .start_timeout = 0.3};
    fleet_prepare(&f);
    fleet_member two = {.of = &f, .self = 2};
    assert_int_equal(pthread_create(&two.thread, NULL, fleet_thread, &two), 0);
    lar_comm_options o = fleet_options(&f, 0);
    lar_comm *comm = NULL;
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_PEER);
    assert_non_null(strstr(error.message, "processor 1 did not come"));
    pthread_join(two.thread, NULL);
    assert_string_equal(two.text, error.message);
}

/* A stranger who connects first and talks nonsense, or nothing, does not prevent the start. */
static void strangers_are_shown_out(void **state) {
    (void)state;
    fleet f = {.backend = "shm", .count = 2, .bytes = 64, .body = nothing};
    fleet_prepare(&f);
    char command[200];
    snprintf(command, sizeof command,
             "exec 3<>/dev/tcp/127.0.0.1/%s; echo GET / HTTP/1.0 >&3; sleep 0.3",
             strrchr(f.master, ':') + 1);
    pid_t stranger = fork();
    if (stranger == 0) {
        execlp("bash", "bash", "-c", command, (char *)NULL);
        _exit(127);
    }
    fleet_member members[2];
    usleep(100000);
    for (int32_t p = 0; p < 2; p++) {
        members[p] = (fleet_member){.of = &f, .self = p};
        assert_int_equal(pthread_create(&members[p].thread, NULL, fleet_thread, &members[p]), 0);
    }
    for (int p = 0; p < 2; p++) {
        pthread_join(members[p].thread, NULL);
        assert_string_equal(members[p].text, "");
    }
    waitpid(stranger, NULL, 0);
}

/* What a crash during start-up left goes with the next start; what somebody owns stays. */
static void leftovers_of_a_crash_are_removed(void **state) {
    (void)state;
    int orphan = shm_open("/lariat-comm-test-orphan", O_CREAT | O_RDWR, 0600);
    int owned = shm_open("/lariat-comm-test-owned", O_CREAT | O_RDWR, 0600);
    assert_true(orphan >= 0 && owned >= 0);
    close(orphan);
    assert_int_equal(flock(owned, LOCK_EX), 0);
    char texts[2][FLEET_TEXT];
    fleet_fork((fleet){.backend = "shm", .count = 2, .bytes = 64, .body = nothing}, texts);
    assert_string_equal(texts[0], "");
    assert_int_equal(shm_open("/lariat-comm-test-orphan", O_RDWR, 0), -1);
    int again = shm_open("/lariat-comm-test-owned", O_RDWR, 0);
    assert_true(again >= 0);
    close(again);
    close(owned);
    shm_unlink("/lariat-comm-test-owned");
}

int main(int argc, char **argv) {
    every_victim = argc > 1 && strcmp(argv[1], "every") == 0;
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_killed_processor_is_named),
                                       cmocka_unit_test(a_stopped_processor_is_named),
                                       cmocka_unit_test(a_cut_processor_is_named),
                                       cmocka_unit_test(one_cut_connection_is_enough),
                                       cmocka_unit_test(a_failing_processor_is_named),
                                       cmocka_unit_test(a_hanging_processor_is_named),
                                       cmocka_unit_test(a_job_suspended_as_a_whole_goes_on),
                                       cmocka_unit_test(threads_that_fail_or_hang_are_named),
                                       cmocka_unit_test(who_does_not_come_is_named),
                                       cmocka_unit_test(strangers_are_shown_out),
                                       cmocka_unit_test(leftovers_of_a_crash_are_removed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
