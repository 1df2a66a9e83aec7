/* Processors that leave before their time, or never come: nobody waits for them for ever. Two
 * processors, each with a simulation of its own as in two processes, but in two threads. */
#include <fcntl.h>
#include <pthread.h>

#include "comm/backend.h"
#include "divide/schedule/file.h"
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

/* ---- at the start -------------------------------------------------------------------------- */

/* Schedules in which processor 1 moves its nodes in two batches: right, but not for this engine. */
static void write_odd_schedules(const lar_model *model, const char *folder) {
    lar_incidence incidence = {0};
    lar_grid grid;
    lar_distribution distribution = {0};
    lar_schedule_set set = {0};
    lar_schedule_options options = lar_schedule_options_default();
    lar_error error;
    if (lar_incidence_build(&model->mesh, &incidence, &error) ||
        lar_grid_make(2, 1, 1, &grid, &error) ||
        lar_distribution_cut(&model->mesh, &grid, &distribution, &error) ||
        lar_schedule_build(&model->mesh, &incidence, &distribution, &options, &set, &error))
        fail_msg("%s", error.message);
    lar_schedule *s = &set.of[1];
    lar_batch *longer = lar_calloc((size_t)s->batch_count + 1, sizeof *longer);
    memcpy(longer, s->batch, (size_t)s->batch_count * sizeof *longer);
    lar_range *early = &longer[s->batch_count - 1].positions,
              *late = &longer[s->batch_count].positions;
    *late = (lar_range){early->first + 1, early->count - 1};
    early->count = 1;
    free(s->batch);
    s->batch = longer;
    s->thread_first[1] = ++s->batch_count;
    if (lar_schedule_write(folder, &set, &error)) fail_msg("%s", error.message);
    lar_schedule_set_clear(&set);
    lar_distribution_clear(&distribution);
    lar_incidence_clear(&incidence);
}

/* Who is compiled does not go to a rendezvous to which the other cannot come: its limit is 20 s. */
static void who_cannot_be_compiled_is_not_waited_for(void **unused) {
    (void)unused;
    static const char folder[] = LAR_TEST_BUILD "/odd-schedules";
    lar_model *model = everything_model(&body);
    write_odd_schedules(model, folder);
    lar_options options = lar_options_default();
    options.schedules = folder;
    lar_simulation *simulation = NULL;
    lar_error error;
    double begin = lar_comm_now();
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error),
                     LAR_ERROR_UNSUPPORTED);
    assert_true(lar_comm_now() - begin < lar_comm_options_default().start_timeout);
    assert_non_null(strstr(error.message, "processor 1"));
    assert_null(simulation);
    lar_model_destroy(model);
}

/* Whatever is wrong with the options, and whoever they are for. */
static void the_listener_is_taken_over_in_any_case(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&body);
    for (int i = 0; i < 5; i++) {
        lar_options options = lar_options_default();
        lar_simulation *simulation = NULL;
        lar_error error;
        char master[LAR_COMM_ADDRESS_TEXT];
        assert_int_equal(lar_comm_listen("127.0.0.1:0", &options.listener, master, &error), LAR_OK);
        if (i > 0) options.grid = i < 4 ? "2x2" : "1x1x1"; /* 0: not divided at all */
        if (i == 1) options.threads = -1;
        if (i == 2) options.time_step = 1e9;
        if (i == 4) options.comm = "tcp";
        assert_int_equal(lar_simulation_create(model, &options, &simulation, &error) == LAR_OK,
                         i == 0 || i == 4);
        lar_simulation_destroy(simulation);
        assert_int_equal(fcntl(options.listener, F_GETFD), -1);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_end_is_no_loss),
        cmocka_unit_test(the_others_hear_of_a_failure_of_zero),
        cmocka_unit_test(zero_hears_of_one_who_does_not_serve),
        cmocka_unit_test(who_cannot_be_compiled_is_not_waited_for),
        cmocka_unit_test(the_listener_is_taken_over_in_any_case),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
