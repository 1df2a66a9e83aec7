/* A processor that dies, stops or fails: everyone else ends within two seconds with a message that
 * names it, and nothing is left behind. */
#include "fleet.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <time.h>

static double now(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* Our objects that nobody alive owns; those of tests that run beside this one are locked. */
static int leftovers(void) {
    int count = 0;
    DIR *folder = opendir("/dev/shm");
    if (!folder) return 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strncmp(entry->d_name, "lariat-comm-", 12) != 0) continue;
        char path[300];
        snprintf(path, sizeof path, "/dev/shm/%s", entry->d_name);
        int object = open(path, O_RDWR);
        if (object >= 0 && flock(object, LOCK_EX | LOCK_NB) == 0) count++;
        if (object >= 0) close(object);
    }
    closedir(folder);
    return count;
}

typedef struct trouble {
    int32_t victim;
    uint64_t at_step; /* 0: never */
    int kind;         /* a signal to itself; CUT, FAIL, HANG */
    int announced;    /* pipe end: a byte when the victim is about to go */
} trouble;
enum { CUT = -1, FAIL = -2, HANG = -3 };

/* Cuts every connection of this process, as a pulled cable would. */
static void cut_sockets(void) {
    for (int fd = 3; fd < 256; fd++) shutdown(fd, SHUT_RDWR);
}

static void happen(lar_comm *comm, const trouble *t) {
    if (write(t->announced, "", 1) < 0) return;
    if (t->kind > 0) kill(getpid(), t->kind);
    if (t->kind == CUT) cut_sockets();
    if (t->kind == FAIL) lar_comm_abort(comm);
    if (t->kind == HANG) usleep(2600000);
}

/* Exchange with both neighbours of a ring, for ever. */
static const char *ring(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    const trouble *t = context;
    lar_error error;
    char data[200] = {0};
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    int32_t next = (self + 1) % count, last = (self + count - 1) % count;
    for (uint64_t step = 1;; step++) {
        if (self == t->victim && step == t->at_step) {
            happen(comm, t);
            if (t->kind == FAIL) return "its own failure";
        }
        if (lar_comm_put(comm, next, 0, data, 200, step, &error) ||
            lar_comm_put(comm, last, 256, data, 200, step, &error) ||
            lar_comm_wait(comm, last, 0, 200, step, NULL, &error) ||
            lar_comm_wait(comm, next, 256, 200, step, NULL, &error))
            return fleet_say(text, "%s", error.message);
    }
}

static void lose(const char *backend, int32_t victim, int kind) {
    int announced[2];
    char byte, texts[5][FLEET_TEXT], expected[40];
    assert_int_equal(pipe(announced), 0);
    trouble t = {.victim = victim, .at_step = 1000, .kind = kind, .announced = announced[1]};
    fleet_processes running;
    fleet_launch((fleet){.backend = backend, .count = 5, .bytes = 512, .body = ring, .context = &t},
                 &running);
    assert_int_equal(read(announced[0], &byte, 1), 1);
    double begin = now(), last = begin;
    snprintf(expected, sizeof expected, "processor %d is lost", (int)victim);
    int wrong = 0;
    for (int32_t p = 0; p < 5; p++) {
        if (p == victim) continue;
        fleet_reap(&running, p, texts[p]);
        last = now();
        if (strstr(texts[p], expected) && strstr(texts[p], "the last complete step")) continue;
        print_error("%s, victim %d, kind %d, processor %d says: %s\n", backend, (int)victim, kind,
                    (int)p, texts[p]);
        wrong++;
    }
    if (kind == SIGSTOP) kill(running.pid[victim], SIGKILL);
    fleet_reap(&running, victim, texts[victim]);
    close(announced[0]);
    close(announced[1]);
    print_message("%s, processor %d, kind %d: all stopped after %.2f s\n", backend, (int)victim,
                  kind, last - begin);
    assert_int_equal(wrong, 0);
    assert_true(last - begin < 2.0);
    assert_int_equal(leftovers(), 0);
}

static void lose_everywhere(int kind) {
    static const char *const backends[] = {"shm", "tcp"};
    for (int i = 0; i < 2; i++) {
        lose(backends[i], 0, kind);
        lose(backends[i], 2, kind);
    }
}

static void a_killed_processor_is_named(void **state) {
    (void)state;
    lose_everywhere(SIGKILL);
}
static void a_stopped_processor_is_named(void **state) {
    (void)state;
    lose_everywhere(SIGSTOP);
}
static void a_cut_processor_is_named(void **state) {
    (void)state;
    lose_everywhere(CUT);
}
static void a_failing_processor_is_named(void **state) {
    (void)state;
    lose_everywhere(FAIL);
}
static void a_hanging_processor_is_named(void **state) {
    (void)state;
    lose_everywhere(HANG);
}

/* Threads cannot be killed; they fail or hang. */
static void threads_that_fail_or_hang_are_named(void **state) {
    (void)state;
    int nowhere[2];
    assert_int_equal(pipe(nowhere), 0);
    for (int kind = FAIL; kind >= HANG; kind--) {
        char texts[4][FLEET_TEXT];
        trouble t = {.victim = 1, .at_step = 100, .kind = kind, .announced = nowhere[1]};
        fleet_threads((fleet){.backend = "threads",
                              .count = 4,
                              .bytes = 512,
                              .body = ring,
                              .context = &t,
                              .patience = 0.5},
                      texts);
        for (int p = 0; p < 4; p++)
            if (p != 1) assert_non_null(strstr(texts[p], "processor 1 is lost"));
    }
    close(nowhere[0]);
    close(nowhere[1]);
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
    if (argc > 1) cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_killed_processor_is_named),
                                       cmocka_unit_test(a_stopped_processor_is_named),
                                       cmocka_unit_test(a_cut_processor_is_named),
                                       cmocka_unit_test(a_failing_processor_is_named),
                                       cmocka_unit_test(a_hanging_processor_is_named),
                                       cmocka_unit_test(threads_that_fail_or_hang_are_named),
                                       cmocka_unit_test(who_does_not_come_is_named),
                                       cmocka_unit_test(strangers_are_shown_out),
                                       cmocka_unit_test(leftovers_of_a_crash_are_removed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
