/* Threads from the host: all that there are, in meshing, grids, sessions, recordings and servers;
 * each is waited for; and where there is none, loops do without and the rest says so. */
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "lariat.h"

#define RECORDING LAR_TEST_BUILD "/host_threads.recording"

static long started, alive, refuse_from; /* atomic; refuse_from: 0: none */
static int highest;                      /* priority */
static lar_error error;

/* A thread of the host: runs what it gets, and is counted while it does. */
typedef struct hosted {
    pthread_t thread;
    void *(*run)(void *);
    void *data;
} hosted;

static void *work(void *argument) {
    const hosted *own = argument;
    own->run(own->data);
    return NULL;
}

static int start(void *context, int priority, void *(*run)(void *), void *data, void **thread) {
    if (context != &started) abort();
    if (refuse_from && __atomic_load_n(&started, __ATOMIC_RELAXED) + 1 >= refuse_from)
        return EAGAIN;
    hosted *own = malloc(sizeof *own);
    *own = (hosted){.run = run, .data = data};
    if (priority > highest) highest = priority;
    if (pthread_create(&own->thread, NULL, work, own) != 0) abort();
    __atomic_add_fetch(&started, 1, __ATOMIC_RELAXED);
    __atomic_add_fetch(&alive, 1, __ATOMIC_RELAXED);
    *thread = own;
    return 0;
}

static void join(void *context, void *thread) {
    if (context != &started) abort();
    hosted *own = thread;
    pthread_join(own->thread, NULL);
    __atomic_sub_fetch(&alive, 1, __ATOMIC_RELAXED);
    free(own);
}

static const lar_thread_hooks hooks = {start, join, &started};

/* Of this process, this one included. */
static long threads_now(void) {
    DIR *folder = opendir("/proc/self/task");
    long count = 0;
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder));) count += entry->d_name[0] != '.';
    closedir(folder);
    return count;
}

#define DONE(call) assert_int_equal(call, LAR_OK)

/* Number of threads with which a mesh was made. */
static long mesh(void) {
    enum { SIDE = 40 };
    static uint16_t label[SIDE * SIDE * SIDE];
    const lar_image_info from = {
        .size = {SIDE, SIDE, SIDE},
        .to_world = {{0.002, 0, 0, 0}, {0, 0.002, 0, 0}, {0, 0, 0.002, 0}},
        .label = label,
    };
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        double x = i % SIDE - 19.5, y = i / SIDE % SIDE - 19.5, z = i / SIDE / SIDE - 19.5;
        label[i] = x * x + y * y + z * z < 15 * 15;
    }
    lar_meshing_options options = lar_meshing_options_default();
    lar_image *image = NULL;
    lar_meshing *meshing = NULL;
    long before = started;
    options.elements = 1500;
    DONE(lar_image_create(&from, NULL, NULL, &image, &error));
    DONE(lar_meshing_of_image(image, &options, &meshing, &error));
    lar_meshing_destroy(meshing);
    lar_image_destroy(image);
    return started - before;
}

static void all_threads_are_the_hosts(void **unused) {
    (void)unused;
    lar_options options = lar_options_default();
    lar_session_options urgent = lar_session_options_default();
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_session *session = NULL;
    lar_server *server = NULL;
    DONE(lar_threads_set(&hooks, &error));
    mesh();
    assert_int_equal(alive, 0);
    options.grid = "2x1x1";
    options.threads = 2;
    urgent.priority = 7;
    urgent.record = RECORDING;
    DONE(lar_model_open(LAR_TEST_EXAMPLES "/beam.yaml", &model, &error));
    DONE(lar_simulation_create(model, &options, &simulation, &error));
    assert_int_equal(alive, 3);
    DONE(lar_simulation_advance(simulation, 20, &error));
    DONE(lar_session_open(simulation, &urgent, &session, &error));
    DONE(lar_session_start(session, &error));
    assert_int_equal(highest, 7);
    lar_status served = lar_server_open(session, model, NULL, &server, &error);
    assert_true(served == LAR_OK || served == LAR_ERROR_UNSUPPORTED);
    assert_true(alive >= 5);
    assert_int_equal(threads_now(), alive + 1);
    lar_server_close(server);
    DONE(lar_session_close(session, &error));
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    assert_int_equal(alive, 0);
    assert_int_equal(threads_now(), 1);
    DONE(lar_threads_set(NULL, &error));
    long before = started;
    mesh();
    assert_int_equal(started, before);
}

static void where_there_is_none_it_is_said(void **unused) {
    (void)unused;
    lar_options options = lar_options_default();
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_session *session = NULL;
    DONE(lar_threads_set(&hooks, &error));
    refuse_from = 1;
    assert_int_equal(mesh(), 0);
    DONE(lar_model_open(LAR_TEST_EXAMPLES "/beam.yaml", &model, &error));
    options.grid = "2x1x1";
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_ERROR_MEMORY);
    assert_non_null(strstr(error.message, "no thread"));
    DONE(lar_simulation_create(model, NULL, &simulation, &error));
    DONE(lar_session_open(simulation, NULL, &session, &error));
    assert_true(lar_session_start(session, &error) != LAR_OK);
    DONE(lar_session_tick(session, &error)); /* in the thread that there is */
    DONE(lar_session_close(session, &error));
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    refuse_from = 0;
    assert_int_equal(alive, 0);
    const lar_thread_hooks half = {start, NULL, NULL};
    assert_int_equal(lar_threads_set(&half, &error), LAR_ERROR_ARGUMENT);
    DONE(lar_threads_set(NULL, &error));
}

/* A child has no threads but its own: what needs others says so instead of waiting for them. */
static void a_forked_child_is_told(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_options options = {.grid = "2x1x1"};
    lar_simulation *divided = NULL, *plain = NULL;
    DONE(lar_model_open(LAR_TEST_EXAMPLES "/beam.yaml", &model, &error));
    DONE(lar_simulation_create(model, &options, &divided, &error));
    options.grid = "1x1x1";
    DONE(lar_simulation_create(model, &options, &plain, &error));
    DONE(lar_simulation_advance(divided, 20, &error));
    pid_t child = fork();
    if (child == 0) {
        alarm(20);
        bool told = lar_simulation_advance(divided, 5, &error) == LAR_ERROR_PEER &&
                    strstr(error.message, "forked") &&
                    lar_simulation_advance(plain, 25, &error) == LAR_OK;
        _exit(told ? 0 : 1);
    }
    int status = -1;
    assert_true(child > 0 && waitpid(child, &status, 0) == child);
    assert_int_equal(status, 0);
    DONE(lar_simulation_advance(divided, 5, &error));
    DONE(lar_simulation_advance(plain, 25, &error));
    assert_true(lar_simulation_hash(divided) == lar_simulation_hash(plain));
    lar_simulation_destroy(divided);
    lar_simulation_destroy(plain);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_threads_are_the_hosts),
        cmocka_unit_test(where_there_is_none_it_is_said),
        cmocka_unit_test(a_forked_child_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
