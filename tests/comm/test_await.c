/* Waiting between commands: as long as it takes, without processor time, but not for the dead. */
#include "fleet.h"

#include "comm/backend.h"

#include <time.h>

static double clock_of(clockid_t id) {
    struct timespec at;
    clock_gettime(id, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* Processor 0 lets the others wait for several times their patience. */
static const char *quiet_time(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    for (uint64_t command = 1; command <= 3; command++) {
        if (self == 0) {
            usleep(command == 2 ? 400000 : 1000);
            for (int32_t p = 1; p < count; p++)
                if (lar_comm_put(comm, p, 8, &command, 8, command, &error))
                    return fleet_say(text, "%s", error.message);
            for (int32_t p = 1; p < count; p++)
                if (lar_comm_await(comm, p, 32 * (size_t)p, 0, command, NULL, &error))
                    return fleet_say(text, "%s", error.message);
            continue;
        }
        const void *payload;
        double begin = clock_of(CLOCK_MONOTONIC), busy = clock_of(CLOCK_THREAD_CPUTIME_ID);
        if (lar_comm_await(comm, 0, 8, 8, command, &payload, &error))
            return fleet_say(text, "%s", error.message);
        begin = clock_of(CLOCK_MONOTONIC) - begin;
        busy = clock_of(CLOCK_THREAD_CPUTIME_ID) - busy;
        if (*(const uint64_t *)payload != command) return "another command";
        if (command == 2 && !(busy < 0.5 * begin))
            return fleet_say(text, "busy for %g s of %g s", busy, begin);
        if (lar_comm_put(comm, 0, 32 * (size_t)self, NULL, 0, command, &error))
            return fleet_say(text, "%s", error.message);
    }
    return NULL;
}

static void quiet_time_may_be_long(void **state) {
    (void)state;
    fleet_everywhere("quiet time",
                     (fleet){.count = 3, .bytes = 256, .body = quiet_time, .patience = 0.1});
}

typedef struct loss {
    int32_t victim;
    bool team; /* threads: nobody can be killed alone */
} loss;

/* Everyone else awaits what never comes; the victim goes after a while. */
static const char *await_for_ever(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    const loss *l = context;
    int32_t self = lar_comm_self(comm);
    lar_error error;
    if (self == l->victim) {
        usleep(50000);
        if (!l->team) kill(getpid(), SIGKILL);
        lar_comm_abort(comm);
        return NULL;
    }
    /* The lost one itself, or another who lives. */
    int32_t peer = self == 0 ? 1 : 0;
    lar_status status = lar_comm_await(comm, peer, 0, 8, 1, NULL, &error);
    return status == LAR_ERROR_PEER ? fleet_say(text, "%s", error.message) : "no failure";
}

static void the_dead_are_not_awaited(void **state) {
    (void)state;
    lar_comm_backend_info info;
    for (int32_t victim = 0; victim < 3; victim++)
        for (int i = 0; fleet_backend(i, &info); i++) {
            char texts[3][FLEET_TEXT], expected[40];
            loss l = {.victim = victim, .team = fleet_is_team(info.name)};
            fleet f = {.backend = info.name,
                       .count = 3,
                       .bytes = 64,
                       .body = await_for_ever,
                       .context = &l};
            (info.start == LAR_COMM_BY_TEAM ? fleet_threads : fleet_fork)(f, texts);
            snprintf(expected, sizeof expected, "processor %d is lost", (int)victim);
            for (int p = 0; p < 3; p++) {
                if (p == victim) continue;
                if (!strstr(texts[p], expected))
                    print_error("%s, %d: %s\n", info.name, p, texts[p]);
                assert_non_null(strstr(texts[p], expected));
                assert_null(strstr(texts[p], "step"));
            }
        }
}

static const char *nonsense(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context, (void)text;
    lar_error e;
    if (lar_comm_await(comm, 2, 0, 8, 1, NULL, &e) != LAR_ERROR_ARGUMENT) return "nobody";
    if (lar_comm_await(comm, 1, 0, 64, 1, NULL, &e) != LAR_ERROR_ARGUMENT) return "beyond";
    if (lar_comm_await(comm, 1, 0, 8, 0, NULL, &e) != LAR_ERROR_ARGUMENT) return "step 0";
    return NULL;
}

static void nonsense_is_refused(void **state) {
    (void)state;
    fleet_everywhere("nonsense", (fleet){.count = 2, .bytes = 64, .body = nonsense});
}

/* Packets are counted by rounds, messages name steps. */
static const char *wait_by_another_name(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    if (lar_comm_self(comm) == 1) {
        lar_comm_abort(comm);
        return NULL;
    }
    lar_comm_number_steps(comm, 1000);
    if (lar_comm_wait(comm, 1, 0, 8, 5, NULL, &error) != LAR_ERROR_PEER) return "no failure";
    return strstr(error.message, "is 1004;") ? NULL : fleet_say(text, "%s", error.message);
}

static void messages_name_steps_not_rounds(void **state) {
    (void)state;
    fleet_everywhere("names", (fleet){.count = 2, .bytes = 64, .body = wait_by_another_name});
}

/* Patience is counted from the first look, wherever the clock stands: that of a machine begins at
 * zero when it boots. */
static void patience_does_not_ask_how_long_the_machine_runs(void **state) {
    (void)state;
    static const double begins[] = {0, 0.5, 70, 1e6};
    for (size_t i = 0; i < sizeof begins / sizeof begins[0]; i++) {
        lar_comm_waited waited = {0};
        for (int second = 0; second <= 120; second += 40)
            assert_false(lar_comm_waited_for(&waited, begins[i] + second, 120));
        assert_true(lar_comm_waited_for(&waited, begins[i] + 121, 120));
        /* held up itself */
        assert_false(lar_comm_waited_for(&waited, begins[i] + 1000, 120));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patience_does_not_ask_how_long_the_machine_runs),
        cmocka_unit_test(quiet_time_may_be_long), cmocka_unit_test(the_dead_are_not_awaited),
        cmocka_unit_test(nonsense_is_refused), cmocka_unit_test(messages_name_steps_not_rounds)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
