/* A forked child has none of its parent's threads, and nothing that it destroys is missed by the
 * parent: neither its threads, nor other processes, nor a file that is being written. */
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "comm/backend.h"
#include "engine/engine_test.h"
#include "engine/fleet_test.h"

#define PATH LAR_TEST_BUILD "/fork.recording"

static const brick body = {{4, 3, 2}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
static lar_error error;

/* What is done in a child, which says 0 where all is well. */
typedef int conduct(void *context);

static void in_a_child(conduct *acts, void *context) {
    pid_t child = fork();
    if (child == 0) {
        for (int s = 1; s < 32; s++) signal(s, SIG_DFL);
        alarm(20);
        _exit(acts(context));
    }
    int status = -1;
    assert_true(child > 0 && waitpid(child, &status, 0) == child);
    assert_int_equal(status, 0);
}

static int destroys(void *context) {
    lar_simulation_destroy(context);
    return 0;
}

static int tries_and_destroys(void *context) {
    bool told = lar_simulation_advance(context, 5, &error) == LAR_ERROR_PEER &&
                strstr(error.message, "forked") && lar_simulation_reset(context, &error);
    return told ? destroys(context) : 1;
}

static void threads_stay_the_parents(void **unused) {
    (void)unused;
    static const struct {
        const char *grid;
        int32_t threads;
    } ways[] = {{"2x1x1", 1}, {"1x1x1", 2}, {NULL, 2}, {"2x1x1", 2}, {NULL, 0}};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        lar_options options = lar_options_default();
        options.grid = ways[i].grid;
        options.threads = ways[i].threads;
        lar_model *model = everything_model(&body);
        lar_simulation *divided = start_with(model, options), *plain = start(model);
        advance(divided, 20);
        in_a_child(destroys, divided);
        struct timespec asleep = {0, 20000000}; /* as they are soon after a stretch */
        nanosleep(&asleep, NULL);
        in_a_child(destroys, divided);
        advance(divided, 20);
        advance(plain, 40);
        assert_true(lar_simulation_hash(divided) == lar_simulation_hash(plain));
        lar_simulation_destroy(divided);
        finish(plain, model);
    }
}

static void other_processes_stay_the_parents(void **unused) {
    (void)unused;
    static const char *const backends[] = {"tcp", "shm"};
    for (int i = 0; i < 2; i++) {
        lar_model *model = everything_model(&body);
        lar_options options = lar_options_default();
        options.grid = "2x1x1";
        options.comm = backends[i];
        fleet f;
        start_fleet(&f, model, options, 2, NULL);
        advance(f.zero, 20);
        in_a_child(destroys, f.zero);
        in_a_child(tries_and_destroys, f.zero);
        advance(f.zero, 20);
        lar_simulation *plain = start(model);
        advance(plain, 40);
        assert_true(lar_simulation_hash(f.zero) == lar_simulation_hash(plain));
        end_fleet(&f);
        finish(plain, model);
    }
}

typedef struct session_and_server {
    lar_session *session;
    lar_server *server;
    lar_simulation *simulation;
} session_and_server;

static int closes(void *context) {
    session_and_server *all = context;
    lar_server_close(all->server);
    if (lar_session_close(all->session, &error)) return 1;
    return destroys(all->simulation);
}

static void sessions_stay_the_parents(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&body);
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    session_and_server all = {.simulation = start_with(model, options)};
    lar_session_options asked = lar_session_options_default();
    asked.record = PATH;
    asked.hash_every = 1; /* often in the middle of a buffer */
    assert_int_equal(lar_session_open(all.simulation, &asked, &all.session, &error), LAR_OK);
    assert_int_equal(lar_session_start(all.session, &error), LAR_OK);
    lar_status served = lar_server_open(all.session, model, NULL, &all.server, &error);
    assert_true(served == LAR_OK || served == LAR_ERROR_UNSUPPORTED);
    for (int i = 0; i < 3; i++) {
        struct timespec tick = {0, 30000000};
        nanosleep(&tick, NULL);
        in_a_child(closes, &all);
    }
    lar_server_close(all.server);
    assert_int_equal(lar_session_close(all.session, &error), LAR_OK);
    lar_simulation_destroy(all.simulation);
    lar_replay_report report;
    lar_simulation *again = start(model);
    if (lar_replay(again, PATH, NULL, NULL, &report, &error)) fail_msg("%s", error.message);
    assert_true(report.hashes > 5 && report.different == UINT64_MAX);
    finish(again, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_stay_the_parents),
        cmocka_unit_test(other_processes_stay_the_parents),
        cmocka_unit_test(sessions_stay_the_parents),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
