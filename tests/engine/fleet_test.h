/* What the tests of computers of several processes share: every process is a thread of the test
 * that serves, with a simulation of its own; the test plays processor zero.
 *
 * Include engine_test.h first. */
#ifndef LAR_TESTS_FLEET_TEST_H
#define LAR_TESTS_FLEET_TEST_H

#include <pthread.h>

enum { FLEET_MAX = 4 };

typedef struct participant {
    const lar_model *model;
    lar_options options;
    /* What it tries before it serves; NULL: nothing. */
    lar_status (*first)(lar_simulation *simulation);
    lar_error error;
    lar_status status;
} participant;

typedef struct fleet {
    int count;
    participant other[FLEET_MAX]; /* from 1 on */
    pthread_t thread[FLEET_MAX];
    lar_simulation *zero;
} fleet;

TEST_UNUSED static void *fleet_serve(void *context) {
    participant *p = context;
    lar_simulation *simulation = NULL;
    p->status = lar_simulation_create(p->model, &p->options, &simulation, &p->error);
    if (!p->status && p->first) p->status = p->first(simulation);
    if (!p->status) p->status = lar_simulation_serve(simulation, &p->error);
    lar_simulation_destroy(simulation);
    return NULL;
}

/* Starts `count` processors with these options, which name a grid and a backend. */
TEST_UNUSED static void start_fleet(fleet *f, const lar_model *model, lar_options options,
                                    int count, lar_status (*first)(lar_simulation *)) {
    lar_error error;
    char master[LAR_COMM_ADDRESS_TEXT];
    int listener;
    f->count = count;
    if (lar_comm_listen("127.0.0.1:0", &listener, master, &error)) fail_msg("%s", error.message);
    options.master = master;
    for (int p = 1; p < count; p++) {
        f->other[p] = (participant){.model = model, .options = options, .first = first};
        f->other[p].options.processor = p;
        assert_int_equal(pthread_create(&f->thread[p], NULL, fleet_serve, &f->other[p]), 0);
    }
    options.listener = listener;
    f->zero = NULL;
    if (lar_simulation_create(model, &options, &f->zero, &error)) fail_msg("%s", error.message);
}

/* Lets all go and waits for them: their statuses are to be looked at. */
TEST_UNUSED static void leave_fleet(fleet *f) {
    lar_simulation_destroy(f->zero);
    for (int p = 1; p < f->count; p++) pthread_join(f->thread[p], NULL);
}

/* The same when all went well. */
TEST_UNUSED static void end_fleet(fleet *f) {
    leave_fleet(f);
    for (int p = 1; p < f->count; p++)
        if (f->other[p].status) fail_msg("processor %d: %s", p, f->other[p].error.message);
}

#endif
