/* Processors that leave before their time: nobody waits for them for ever. Two processors, each
 * with a simulation of its own as in two processes, but in two threads. */
#include <pthread.h>

#include "engine/engine_test.h"

/* One that notices the end of a connection by itself, and one that does not. */
static const char *const backends[] = {"tcp", "shm"};
enum { BACKENDS = 2 };

static const brick body = {{4, 3, 2}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

/* What a processor does with its simulation once both have met. */
typedef lar_status conduct(lar_simulation *simulation, lar_error *error);

typedef struct participant {
    const lar_model *model;
    lar_options options;
    conduct *acts;
    lar_status status;
    lar_error error;
} participant;

static void *take_part(void *context) {
    participant *p = context;
    lar_simulation *simulation = NULL;
    p->status = lar_simulation_create(p->model, &p->options, &simulation, &p->error);
    if (!p->status) p->status = p->acts(simulation, &p->error);
    lar_simulation_destroy(simulation);
    return NULL;
}

static void run_both(const char *backend, conduct *zero, conduct *one, participant both[2]) {
    lar_model *model = everything_model(&body);
    lar_error error;
    char master[LAR_COMM_ADDRESS_TEXT];
    int listener;
    pthread_t thread[2];
    if (lar_comm_listen("127.0.0.1:0", &listener, master, &error)) fail_msg("%s", error.message);
    for (int p = 0; p < 2; p++) {
        both[p] = (participant){.model = model, .acts = p ? one : zero};
        both[p].options = lar_options_default();
        both[p].options.grid = "2x1x1";
        both[p].options.comm = backend;
        both[p].options.processor = p;
        both[p].options.master = master;
        if (p == 0) both[p].options.listener = listener;
        assert_int_equal(pthread_create(&thread[p], NULL, take_part, &both[p]), 0);
    }
    for (int p = 0; p < 2; p++) pthread_join(thread[p], NULL);
    lar_model_destroy(model);
}

static lar_status advances(lar_simulation *simulation, lar_error *error) {
    return lar_simulation_advance(simulation, 10, error);
}

/* As after a failure that no other processor has heard of. */
static lar_status breaks(lar_simulation *simulation, lar_error *error) {
    lar_status status = lar_simulation_advance(simulation, 10, error);
    simulation->computer->broken = true;
    return status;
}

static lar_status leaves(lar_simulation *simulation, lar_error *error) {
    (void)simulation, (void)error;
    return LAR_OK;
}

static void the_end_is_no_loss(void **unused) {
    (void)unused;
    participant both[2];
    for (int i = 0; i < BACKENDS; i++) {
        run_both(backends[i], advances, lar_simulation_serve, both);
        for (int p = 0; p < 2; p++)
            if (both[p].status) fail_msg("processor %d: %s", p, both[p].error.message);
    }
}

static void assert_lost(const participant *p, const char *who) {
    assert_int_equal(p->status, LAR_ERROR_PEER);
    if (!strstr(p->error.message, who)) fail_msg("'%s' lacks '%s'", p->error.message, who);
}

static void the_others_hear_of_a_failure_of_zero(void **unused) {
    (void)unused;
    participant both[2];
    for (int i = 0; i < BACKENDS; i++) {
        run_both(backends[i], breaks, lar_simulation_serve, both);
        assert_int_equal(both[0].status, LAR_OK);
        assert_lost(&both[1], "processor 0");
    }
}

static void zero_hears_of_one_who_does_not_serve(void **unused) {
    (void)unused;
    participant both[2];
    for (int i = 0; i < BACKENDS; i++) {
        run_both(backends[i], advances, leaves, both);
        assert_lost(&both[0], "processor 1");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_end_is_no_loss),
        cmocka_unit_test(the_others_hear_of_a_failure_of_zero),
        cmocka_unit_test(zero_hears_of_one_who_does_not_serve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
