/* Predicted steps: what can be worked out by hand, the thesis's own figures, larger grids from the
 * schedules of small ones, schedules that do not fit together. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "parallel/division.h"
#include "model/model.h"
#include "study/bench/kernel.h"
#include "study/predict/network_trace.h"
#include "study/predict/predict.h"

static lar_model *organ, *block;

static int make_models(void **state) {
    (void)state;
    const int32_t edge[3] = {6, 4, 4};
    if (lar_demo_write("network-demo", NULL)) return -1;
    if (lar_model_open("network-demo/uterus.yaml", &organ, NULL)) return -1;
    return lar_bench_block(edge, false, &block, NULL) ? -1 : 0;
}

static int destroy_models(void **state) {
    (void)state;
    lar_model_destroy(organ);
    lar_model_destroy(block);
    return 0;
}

static lar_cluster machine_named(const char *name) {
    lar_cluster m;
    assert_int_equal(lar_cluster_find(name, &m, NULL), LAR_OK);
    return m;
}

static lar_prediction predict(const lar_model *model, const char *grid, int32_t threads,
                              const lar_cluster *machine) {
    lar_prediction p;
    lar_error error;
    lar_options options = lar_options_default();
    options.grid = grid;
    options.threads = threads;
    if (lar_predict_model(model, &options, machine, 0, &p, &error)) fail_msg("%s", error.message);
    return p;
}

static double step_of(const char *grid, int32_t threads, const char *machine) {
    lar_cluster m = machine_named(machine);
    lar_prediction p = predict(organ, grid, threads, &m);
    double step = p.network.step;
    lar_prediction_clear(&p);
    return step;
}

static void near(double a, double b) {
    if (!(fabs(a - b) <= 1e-9 * fabs(b))) fail_msg("%.17g is not %.17g", a, b);
}

/* ---- the thesis ----------------------------------------------------------------------------- */

/* The thesis's "just under 200 us". A narrow bound, for without any communication it would still be
 * 163; and docs/prediction.md's table of what each price contributes. */
static void the_cluster_needs_two_hundred_microseconds(void **state) {
    (void)state;
    enum { LINKS = 1 << LAR_CLUSTER_LATENCY | 1 << LAR_CLUSTER_GAP | 1 << LAR_CLUSTER_BANDWIDTH };
    const int sent =
        LINKS | 1 << LAR_CLUSTER_OVERHEAD | 1 << LAR_CLUSTER_BYTE | 1 << LAR_CLUSTER_RECEIVE;
    const struct {
        int free; /* of cost */
        double step;
    } part[] = {{0, 202.9},
                {1 << LAR_CLUSTER_NODE, 194.2},
                {1 << LAR_CLUSTER_VECTOR, 187.3},
                {1 << LAR_CLUSTER_OVERHEAD, 199.9},
                {1 << LAR_CLUSTER_BYTE, 183.9},
                {1 << LAR_CLUSTER_RECEIVE, 201.3},
                {1 << LAR_CLUSTER_JOIN, 201.9},
                {LINKS, 202.9},
                {sent, 179.3},
                {sent | 1 << LAR_CLUSTER_VECTOR | 1 << LAR_CLUSTER_JOIN, 163.4}};
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        lar_cluster m = machine_named("thesis");
        for (int k = 0; k < LAR_CLUSTER_NUMBERS; k++)
            if (part[i].free & 1 << k) m.number[k] = k == LAR_CLUSTER_BANDWIDTH ? 1e18 : 0;
        lar_prediction p = predict(organ, "2x2x3", 2, &m);
        if (fabs(1e6 * p.network.step - part[i].step) > 0.051)
            fail_msg("part %d: %g us, not %g", (int)i, 1e6 * p.network.step, part[i].step);
        lar_prediction_clear(&p);
    }
}

/* Figures 5.2 to 5.4: all have the same peak, the faster their processors the shorter the step. */
static void fast_processors_are_better_than_many(void **state) {
    (void)state;
    double fast_two = step_of("2x2x3", 2, "thesis"), fast_one = step_of("2x3x4", 1, "thesis");
    double moderate_two = step_of("2x3x4", 2, "thesis-moderate");
    double moderate_one = step_of("3x4x4", 1, "thesis-moderate");
    double slow_two = step_of("3x4x4", 2, "thesis-slow");
    assert_true(fast_two < fast_one && fast_two < moderate_two);
    assert_true(fast_one < moderate_one && moderate_two < moderate_one);
    assert_true(moderate_one < slow_two);
}

/* ---- by hand -------------------------------------------------------------------------------- */

static void one_processor_only_computes(void **state) {
    (void)state;
    lar_cluster m = machine_named("thesis");
    lar_prediction p = predict(block, "1x1x1", 1, &m);
    near(p.network.step, 96 * 2e-6 + 7 * 5 * 5 * 0.04e-6);
    near(p.alone, p.network.step);
    near(p.efficiency, 1);
    assert_int_equal(p.network.of[0].packets, 0);
    assert_true(p.network.of[0].wait == 0 && p.network.occupation == 0);
    lar_prediction_clear(&p);
}

/* Two halves of 48 elements that share 25 nodes: one packet each way. Without a network in between
 * a step is half of the elements and the nodes of one; every other number adds what it says. */
static void two_processors_by_hand(void **state) {
    (void)state;
    enum { BYTES = 8 + 25 * 24 + 8, NODES = 4 * 25 };
    lar_cluster m = {.name = "by hand"};
    m.number[LAR_CLUSTER_ELEMENT] = 1e-6;
    m.number[LAR_CLUSTER_NODE] = 1e-8;
    m.number[LAR_CLUSTER_BANDWIDTH] = 1e18;
    const double nothing = 48e-6 + NODES * 1e-8;
    lar_prediction p = predict(block, "2x1x1", 1, &m);
    near(p.network.step, nothing);
    assert_int_equal(p.network.of[0].bytes_sent, BYTES);
    assert_int_equal(p.network.of[1].bytes_received, BYTES);
    assert_int_equal(p.network.of[1].packets, 1);
    lar_prediction_clear(&p);
    m.number[LAR_CLUSTER_OVERHEAD] = 3e-6;
    m.number[LAR_CLUSTER_BYTE] = 1e-9;
    m.number[LAR_CLUSTER_VECTOR] = 2e-8;
    m.number[LAR_CLUSTER_RECEIVE] = 5e-7;
    m.number[LAR_CLUSTER_STEP] = 7e-7;
    const double busy = nothing + 3e-6 + BYTES * 1e-9 + 2 * 25 * 2e-8 + 5e-7 + 7e-7;
    p = predict(block, "2x1x1", 1, &m);
    near(p.network.step, busy);
    near(p.network.of[0].compute, nothing + 7e-7);
    near(p.network.of[0].exchange, busy - nothing - 7e-7);
    lar_prediction_clear(&p);
    /* 16 elements at the border go first, 32 hide the way of the packet; a link that is slower. */
    m.number[LAR_CLUSTER_LATENCY] = 40e-6;
    p = predict(block, "2x1x1", 1, &m);
    near(p.network.step, busy + 8e-6);
    near(p.network.of[1].wait, 8e-6);
    lar_prediction_clear(&p);
    m.number[LAR_CLUSTER_BANDWIDTH] = BYTES / 10e-6;
    m.number[LAR_CLUSTER_GAP] = 2e-6; /* behind the packet: delays nobody */
    p = predict(block, "2x1x1", 1, &m);
    near(p.network.step, busy + 18e-6);
    near(p.network.occupation, 12e-6 / (busy + 18e-6));
    lar_prediction_clear(&p);
}

/* ---- figures that fit together -------------------------------------------------------------- */

static void check_spans(const lar_network_result *r) {
    double *until = calloc((size_t)(r->processors * (r->threads + 1)), sizeof *until);
    double links = 0, slices = 0;
    assert_non_null(until);
    assert_true(r->span_count > 0);
    for (size_t i = 0; i < r->span_count; i++) {
        const lar_network_span *s = &r->span[i];
        double *last = &until[s->processor * (r->threads + 1) + s->thread + 1];
        assert_true(s->begin >= *last - 1e-12 && s->end > s->begin && s->end <= r->step * 1.5);
        *last = s->end;
        if (s->kind == LAR_SPAN_LINK) links += s->end - s->begin;
    }
    for (int i = 0; i < LAR_NETWORK_SLICES; i++) {
        assert_true(r->slice[i] >= 0 && r->slice[i] <= 1 + 1e-12);
        slices += r->slice[i] / LAR_NETWORK_SLICES;
    }
    assert_true(fabs(slices - links / r->processors / r->step) < 0.02);
    free(until);
}

static void times_and_bytes_add_up(void **state) {
    (void)state;
    lar_cluster m = machine_named("thesis");
    for (int32_t threads = 1; threads <= 3; threads++) {
        lar_prediction p = predict(organ, "2x2x2", threads, &m);
        const lar_network_result *r = &p.network;
        int64_t sent = 0, received = 0;
        double elements = 0;
        for (int32_t i = 0; i < r->processors; i++) {
            const lar_network_processor *of = &r->of[i];
            sent += of->bytes_sent;
            received += of->bytes_received;
            elements += of->compute;
            double all = of->compute + of->exchange + of->wait;
            assert_true(fabs(all / (threads * r->step) - 1) < 0.02);
        }
        assert_int_equal(sent, received);
        assert_true(elements > 1840 * 2e-6 && elements < 1.03 * p.alone);
        check_spans(r);
        lar_prediction_clear(&p);
    }
}

static void a_slower_network_is_never_better(void **state) {
    (void)state;
    double last = 0;
    for (double latency = 0; latency < 1e-3; latency = 2 * latency + 1e-6) {
        lar_cluster m = machine_named("thesis");
        m.number[LAR_CLUSTER_LATENCY] = latency;
        lar_prediction p = predict(block, "2x2x2", 1, &m);
        assert_true(p.network.step >= last * (1 - 1e-9));
        last = p.network.step;
        lar_prediction_clear(&p);
    }
    assert_true(last > 0.5e-3);
}

/* ---- how many steps ------------------------------------------------------------------------- */

/* Eight steps say 80.1 us. */
static void simulates_until_the_start_is_forgotten(void **state) {
    (void)state;
    lar_cluster m = machine_named("thesis");
    lar_options options = lar_options_default();
    options.grid = "4x6x8";
    options.threads = 2;
    lar_prediction found = predict(organ, "4x6x8", 2, &m), few, many;
    assert_int_equal(lar_predict_model(organ, &options, &m, 8, &few, NULL), LAR_OK);
    assert_int_equal(lar_predict_model(organ, &options, &m, 200, &many, NULL), LAR_OK);
    assert_true(found.network.settled && !few.network.settled);
    assert_int_equal(few.network.steps, 8);
    assert_true(found.network.steps > 8 && found.network.fastest <= found.network.step &&
                found.network.step <= found.network.slowest);
    assert_true(few.network.step > 1.04 * many.network.step);
    assert_true(fabs(found.network.step / many.network.step - 1) < 0.005);
    lar_prediction_clear(&found);
    lar_prediction_clear(&few);
    lar_prediction_clear(&many);
}

/* Where it would take too long it ends, and says so. */
static void too_many_processors_do_not_settle(void **state) {
    (void)state;
    lar_cluster m = machine_named("ethernet");
    lar_block_prediction b;
    const lar_block_options options = {.elements = 1000, .processors = 50000, .scheme = 1};
    assert_int_equal(lar_predict_block(&options, &m, &b, NULL), LAR_OK);
    assert_true(!b.settled && b.steps == 8);
    assert_true(b.fastest <= b.step && b.step <= b.slowest);
}

/* The first step, which all begin together: its packets are all there, and nothing else. */
static void occupation_is_from_a_common_start(void **state) {
    (void)state;
    lar_cluster m = machine_named("thesis");
    lar_prediction p = predict(organ, "2x2x3", 2, &m);
    const lar_network_result *r = &p.network;
    double busy = 0, sum = 0;
    for (int32_t i = 0; i < r->processors; i++)
        busy += (double)r->of[i].packets * m.number[LAR_CLUSTER_GAP] +
                (double)r->of[i].bytes_sent / m.number[LAR_CLUSTER_BANDWIDTH];
    for (int i = 0; i < LAR_NETWORK_START_SLICES; i++)
        sum += r->start_slice[i] * r->start_step / LAR_NETWORK_START_SLICES * r->processors;
    near(sum, busy);
    assert_true(r->start_slice[0] == 0 && r->start_slice[LAR_NETWORK_START_SLICES - 1] == 0);
    lar_prediction_clear(&p);
}

/* ---- larger grids --------------------------------------------------------------------------- */

/* 4 x 4 x 4 blocks of 2 x 2 x 2 elements, with schedules of their own. */
static double step_of_whole_body(int scheme, int32_t threads, const lar_cluster *machine) {
    static const char *const name[] = {"all", "local", "local", "one", "two"};
    const int32_t edge[3] = {8, 8, 8};
    lar_model *model;
    lar_prediction p;
    lar_options options = lar_options_default();
    options.grid = "4x4x4";
    options.threads = threads;
    options.scheme = name[scheme];
    options.channels = scheme == 2 ? "concurrent" : NULL;
    assert_int_equal(lar_bench_block(edge, false, &model, NULL), LAR_OK);
    assert_int_equal(lar_predict_model(model, &options, machine, 0, &p, NULL), LAR_OK);
    double step = p.network.step;
    lar_prediction_clear(&p);
    lar_model_destroy(model);
    return step;
}

/* Exactly so with one thread; with several, ties between their batches may fall otherwise. */
static void kinds_stand_for_their_like(void **state) {
    (void)state;
    lar_cluster m = machine_named("thesis");
    for (int i = 0; i < 2 * LAR_PREDICT_SCHEMES; i++) {
        const lar_block_options options = {
            .elements = 8, .processors = 64, .threads = 1 + i % 2, .scheme = i / 2};
        lar_block_prediction b;
        assert_int_equal(lar_predict_block(&options, &m, &b, NULL), LAR_OK);
        assert_int_equal(b.grid[0] * b.edge[0], 8);
        near(64 * options.threads * b.alone, lar_cluster_alone(&m, 8 * 8 * 8, 9 * 9 * 9));
        near(b.efficiency, b.alone / b.step);
        double whole = step_of_whole_body(options.scheme, options.threads, &m);
        if (fabs(b.step / whole - 1) > (options.threads == 1 ? 1e-9 : 0.01))
            fail_msg("%s, %d threads: %g us from kinds, %g us from the whole",
                     lar_predict_scheme_name[options.scheme], (int)options.threads, 1e6 * b.step,
                     1e6 * whole);
    }
}

static void grids_are_cubes_where_they_can(void **state) {
    (void)state;
    static const int32_t wanted[][4] = {
        {1, 1, 1, 1}, {7, 1, 1, 7}, {100, 4, 5, 5}, {1000, 10, 10, 10}, {10000, 20, 20, 25}};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        int32_t grid[3];
        lar_predict_grid(wanted[i][0], grid);
        assert_memory_equal(grid, &wanted[i][1], sizeof grid);
    }
}

static void large_blocks_are_efficient(void **state) {
    (void)state;
    lar_cluster m = machine_named("thesis-slow");
    lar_critical critical;
    const lar_critical_options options = {.machine = &m,
                                          .machines = 1,
                                          .processors = 27,
                                          .threads = 1,
                                          .edge_max = 8,
                                          .efficiency = 0.9};
    assert_int_equal(lar_predict_critical(&options, &critical, NULL), LAR_OK);
    for (int scheme = 0; scheme < LAR_PREDICT_SCHEMES; scheme++) {
        lar_block_prediction b;
        lar_block_options block_options = {.processors = 27, .scheme = scheme};
        assert_in_range(critical.elements[scheme], 8, 343);
        block_options.elements = critical.elements[scheme];
        assert_int_equal(lar_predict_block(&block_options, &m, &b, NULL), LAR_OK);
        assert_true(b.efficiency >= 0.9 && b.efficiency <= 1);
        near(b.efficiency, critical.efficiency[scheme]);
        block_options.elements = 1;
        assert_int_equal(lar_predict_block(&block_options, &m, &b, NULL), LAR_OK);
        assert_true(b.efficiency < 0.9);
    }
}

/* ---- the thesis, on itself ------------------------------------------------------------------ */

static double block_efficiency(int32_t processors, int32_t elements, int32_t threads, int scheme) {
    lar_cluster m = machine_named("thesis");
    lar_block_prediction b;
    const lar_block_options options = {
        .elements = elements, .processors = processors, .threads = threads, .scheme = scheme};
    assert_int_equal(lar_predict_block(&options, &m, &b, NULL), LAR_OK);
    return b.efficiency;
}

/* T 8.3.1: 90 % with sub-domains of 150 elements where nodes have at most four neighbours, as with
 * the scheme `local` (1) on 12 processors, and about three times as many inside a larger grid. With
 * two threads to a sub-domain it does not come out (docs/prediction.md). */
static void critical_sub_domains_are_as_the_thesis_says(void **state) {
    (void)state;
    assert_true(block_efficiency(12, 100, 1, 1) < 0.9 && block_efficiency(12, 125, 1, 1) > 0.9);
    assert_true(block_efficiency(125, 252, 1, 1) < 0.9 && block_efficiency(125, 294, 1, 1) > 0.9);
    assert_true(block_efficiency(12, 180, 1, 0) < 0.9 && block_efficiency(12, 216, 1, 0) > 0.9);
    assert_true(block_efficiency(125, 512, 1, 0) < 0.9 && block_efficiency(125, 576, 1, 0) > 0.9);
    assert_true(block_efficiency(12, 150, 2, 0) < 0.85);
    assert_true(block_efficiency(12, 294, 2, 0) < 0.9 && block_efficiency(12, 392, 2, 0) > 0.9);
}

/* ---- what cannot be ------------------------------------------------------------------------- */

static lar_status simulate_spoilt(void (*spoil)(lar_schedule_set *), lar_error *error) {
    lar_cluster m = machine_named("thesis");
    lar_division division;
    lar_network_result result = {0};
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    options.threads = 2;
    assert_int_equal(lar_division_create(block, &options, &division, NULL), LAR_OK);
    spoil(&division.schedules);
    const lar_network_options simulated = {.machine = &m, .schedules = &division.schedules};
    lar_status status = lar_network_simulate(&simulated, &result, error);
    lar_network_clear(&result);
    lar_division_destroy(&division);
    return status;
}

static void leave_it(lar_schedule_set *set) {
    (void)set;
}

static void send_less(lar_schedule_set *set) {
    for (int32_t b = 0; b < set->of[0].batch_count; b++) set->of[0].batch[b].sends.count = 0;
}

static void receive_less(lar_schedule_set *set) {
    for (int32_t b = 0; b < set->of[1].batch_count; b++) set->of[1].batch[b].receives.count = 0;
}

/* The first batch of either thread waits for the last of the other. */
static void wait_in_a_circle(lar_schedule_set *set) {
    lar_schedule *s = &set->of[1];
    for (int t = 0; t < 2; t++) {
        s->wait[t] = s->thread_first[2 - t] - 1;
        s->batch[s->thread_first[t]].waits = (lar_range){t, 1};
    }
}

static void bad_schedules_are_refused(void **state) {
    (void)state;
    lar_error error;
    assert_int_equal(simulate_spoilt(leave_it, &error), LAR_OK);
    assert_int_equal(simulate_spoilt(send_less, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "nobody sends"));
    assert_int_equal(simulate_spoilt(receive_less, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "nobody receives"));
    assert_int_equal(simulate_spoilt(wait_in_a_circle, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "waits for ever"));
}

/* ---- machines ------------------------------------------------------------------------------- */

static lar_status read_text(const char *text, lar_cluster *m, lar_error *error) {
    FILE *file = fopen("network.machine", "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return lar_cluster_find("network.machine", m, error);
}

static void machines_from_files(void **state) {
    (void)state;
    lar_cluster m;
    lar_error error;
    assert_int_equal(read_text("# mine\nelement 2.5 # us\nbandwidth 125\n\nlatency 1e1", &m, NULL),
                     LAR_OK);
    near(m.number[LAR_CLUSTER_ELEMENT], 2.5e-6);
    near(m.number[LAR_CLUSTER_BANDWIDTH], 125e6);
    near(m.number[LAR_CLUSTER_LATENCY], 10e-6);
    assert_true(m.number[LAR_CLUSTER_NODE] == 0);
    assert_int_equal(read_text("element 2\nbandwith 3\n", &m, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "network.machine:2: 'bandwith'"));
    assert_int_equal(read_text("element\n2", &m, &error), LAR_ERROR_FORMAT);
    assert_int_equal(read_text("element nan bandwidth 1", &m, &error), LAR_ERROR_FORMAT);
    assert_int_equal(read_text("element 1", &m, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "bandwidth"));
    assert_int_equal(read_text("element 1 bandwidth 1 latency -1", &m, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_cluster_find("abacus", &m, &error), LAR_ERROR_ARGUMENT);
}

static void every_number_has_a_source(void **state) {
    (void)state;
    for (int i = 0; lar_cluster_at(i); i++) {
        const lar_cluster *m = lar_cluster_at(i);
        assert_int_equal(lar_cluster_check(m, NULL), LAR_OK);
        for (int k = 0; k < LAR_CLUSTER_NUMBERS; k++)
            if (!m->source[k] || !*m->source[k])
                fail_msg("%s has no source of %s", m->name, lar_cluster_number_name[k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cluster_needs_two_hundred_microseconds),
        cmocka_unit_test(fast_processors_are_better_than_many),
        cmocka_unit_test(one_processor_only_computes),
        cmocka_unit_test(two_processors_by_hand),
        cmocka_unit_test(times_and_bytes_add_up),
        cmocka_unit_test(a_slower_network_is_never_better),
        cmocka_unit_test(simulates_until_the_start_is_forgotten),
        cmocka_unit_test(too_many_processors_do_not_settle),
        cmocka_unit_test(occupation_is_from_a_common_start),
        cmocka_unit_test(kinds_stand_for_their_like),
        cmocka_unit_test(grids_are_cubes_where_they_can),
        cmocka_unit_test(large_blocks_are_efficient),
        cmocka_unit_test(critical_sub_domains_are_as_the_thesis_says),
        cmocka_unit_test(bad_schedules_are_refused),
        cmocka_unit_test(machines_from_files),
        cmocka_unit_test(every_number_has_a_source),
    };
    return cmocka_run_group_tests(tests, make_models, destroy_models);
}
