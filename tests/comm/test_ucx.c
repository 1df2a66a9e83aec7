/* What is particular to UCX: every way for a packet over every transport that a plain machine has,
 * packets of all sizes, and a library that keeps to itself. */
#include "fleet.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/time.h>

enum { SIZES = 5, ROOM = 140000 };
static const size_t sizes[SIZES] = {0, 8, 424, 9000, 120000};

static uint64_t word_of(uint64_t from, uint64_t step, uint64_t packet, uint64_t i) {
    return from << 56 ^ step << 32 ^ packet << 24 ^ i;
}

static lar_status put_all(lar_comm *comm, uint64_t step, uint64_t *words, lar_error *error) {
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    lar_status status = LAR_OK;
    for (int32_t p = 0; p < count; p++) {
        size_t offset = ROOM * (size_t)self;
        for (size_t k = 0; k < SIZES && p != self && !status; k++) {
            for (size_t i = 0; i < sizes[k] / 8; i++)
                words[i] = word_of((uint64_t)self, step, k, i);
            status = lar_comm_put(comm, p, offset, words, sizes[k], step, error);
            offset += lar_comm_packet_bytes(sizes[k]);
            memset(words, 0xee, sizes[k]); /* may be used again */
        }
    }
    return status;
}

/* Everyone sends everyone packets of all sizes before it looks at what has come: the large ones
 * only leave while those of the others are taken in. */
static const char *all_sizes(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    static _Thread_local uint64_t words[120000 / 8];
    lar_error error;
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    for (uint64_t step = 1; step <= 30; step++) {
        if (put_all(comm, step, words, &error)) return fleet_say(text, "%s", error.message);
        for (int32_t p = 0; p < count; p++) {
            size_t offset = ROOM * (size_t)p;
            for (size_t k = 0; k < SIZES && p != self; k++) {
                const void *payload;
                if (lar_comm_wait(comm, p, offset, sizes[k], step, &payload, &error))
                    return fleet_say(text, "%s", error.message);
                for (size_t i = 0; i < sizes[k] / 8; i++)
                    if (((const uint64_t *)payload)[i] != word_of((uint64_t)p, step, k, i))
                        return fleet_say(text, "step %d, packet %d of processor %d, word %d",
                                         (int)step, (int)k, (int)p, (int)i);
                offset += lar_comm_packet_bytes(sizes[k]);
            }
        }
    }
    return NULL;
}

static void every_way_over_every_transport(void **state) {
    (void)state;
    static const char *const ways[] = {"", "put", "message"};
    static const char *const transports[] = {"all", "tcp", "posix,self", "sysv,self"};
    char texts[3][FLEET_TEXT];
    fleet f = {.backend = "ucx", .count = 3, .bytes = 3 * ROOM, .body = all_sizes};
    for (int w = 0; w < 3; w++)
        for (int t = 0; t < 4; t++) {
            setenv("LARIAT_UCX", ways[w], 1);
            setenv("UCX_TLS", transports[t], 1);
            fleet_fork(f, texts);
            for (int p = 0; p < 3; p++)
                if (texts[p][0])
                    print_error("LARIAT_UCX=%s UCX_TLS=%s: %s\n", ways[w], transports[t], texts[p]);
            fleet_expect_good("all sizes", &f, texts);
        }
    unsetenv("LARIAT_UCX");
    unsetenv("UCX_TLS");
}

/* Goes on until somebody is lost; processor 1 dies. */
static const char *dying(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    int32_t peer = 1 - lar_comm_self(comm);
    for (uint64_t step = 1;; step++) {
        if (lar_comm_self(comm) == 1 && step == 100) kill(getpid(), SIGKILL);
        if (lar_comm_put(comm, peer, 0, "", 1, step, &error) ||
            lar_comm_wait(comm, peer, 0, 1, step, NULL, &error))
            return fleet_say(text, "%s", error.message);
    }
}

/* Before the library is used, in each process. */
static void record(void *context, int32_t self, bool closed) {
    (void)self;
    int file = closed ? -1 : open(context, O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (file < 0) return;
    dup2(file, 1);
    dup2(file, 2);
    close(file);
}

static void a_loss_is_told_by_us_alone(void **state) {
    (void)state;
    char path[] = "/tmp/lariat-test-ucx-XXXXXX";
    static const char *const ways[] = {"", "put", "message"};
    for (int w = 0; w < 3; w++) {
        char text[FLEET_TEXT], nothing[FLEET_TEXT];
        fleet_processes running;
        struct stat written;
        setenv("LARIAT_UCX", ways[w], 1);
        memcpy(path + sizeof path - 7, "XXXXXX", 6);
        int file = mkstemp(path);
        assert_true(file >= 0);
        fleet_launch((fleet){.backend = "ucx",
                             .count = 2,
                             .bytes = 64,
                             .body = dying,
                             .context = path,
                             .around = record},
                     &running);
        fleet_reap(&running, 0, text);
        fleet_reap(&running, 1, nothing);
        assert_non_null(strstr(text, "processor 1 is lost"));
        assert_int_equal(fstat(file, &written), 0);
        assert_int_equal(written.st_size, 0);
        close(file);
        unlink(path);
    }
    unsetenv("LARIAT_UCX");
}

/* Zero is told to end at some moment of the start. UCX must not end a process for it: in every
 * sixteenth such start endpoints were closed while they still connected. */
static int moment; /* [us] */

static void call_off(int signal_number) {
    (void)signal_number;
    lar_comm_interrupt();
}

static void call_off_soon(void *context, int32_t self, bool closed) {
    (void)context;
    struct itimerval once = {.it_value.tv_usec = closed ? 0 : moment};
    if (self > 0) return;
    signal(SIGALRM, call_off);
    setitimer(ITIMER_REAL, &once, NULL);
}

static const char *nothing_to_do(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)comm, (void)context, (void)text;
    return NULL;
}

static void a_start_that_is_called_off_ends(void **state) {
    (void)state;
    for (moment = 500; moment < 40000; moment += 500) {
        fleet_processes running;
        fleet_launch((fleet){.backend = "ucx",
                             .count = 2,
                             .bytes = 64000,
                             .body = nothing_to_do,
                             .around = call_off_soon},
                     &running);
        for (int p = 0; p < 2; p++) {
            char text[FLEET_TEXT];
            int status = fleet_reap(&running, p, text);
            if (!WIFEXITED(status)) print_error("processor %d, after %d us\n", p, moment);
            assert_true(WIFEXITED(status));
        }
    }
}

static void settings_are_checked(void **state) {
    (void)state;
    lar_comm *comm = NULL;
    lar_error error;
    lar_comm_options o = lar_comm_options_default();
    o.backend = "ucx";
    setenv("LARIAT_UCX", "pigeons", 1);
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "put or message"));
    unsetenv("LARIAT_UCX");
    setenv("UCX_TLS", "carrier_pigeon", 1);
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "UCX cannot"));
    unsetenv("UCX_TLS");
    assert_null(comm);
}

static const char *catcher[4]; /* library of the handler, at the start: cmocka has its own */

static void look_at_signals(void) {
    static const int signals[] = {SIGILL, SIGSEGV, SIGBUS, SIGFPE};
    for (int i = 0; i < 4; i++) {
        struct sigaction action;
        Dl_info of;
        void *handler;
        sigaction(signals[i], NULL, &action);
        memcpy(&handler, &action.sa_sigaction, sizeof handler);
        catcher[i] = dladdr(handler, &of) && of.dli_fname ? of.dli_fname : "";
    }
}

/* Who crashes in our own code must not end in UCX's handler. */
static void signals_are_left_alone(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) assert_null(strstr(catcher[i], "libucs"));
}

int main(void) {
    look_at_signals();
    lar_comm_backend_info info;
    for (int row = 0; lar_comm_backend_list(row, &info); row++)
        if (strcmp(info.name, "ucx") == 0 && info.missing) {
            printf("skipped: no UCX\n");
            return 77;
        }
    const struct CMUnitTest tests[] = {cmocka_unit_test(signals_are_left_alone),
                                       cmocka_unit_test(settings_are_checked),
                                       cmocka_unit_test(a_start_that_is_called_off_ends),
                                       cmocka_unit_test(a_loss_is_told_by_us_alone),
                                       cmocka_unit_test(every_way_over_every_transport)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
