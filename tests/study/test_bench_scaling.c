/* The scaling benchmark: the right ways side by side, figures that fit together, one hash. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "study/bench/scaling.h"

static lar_model *block;

static int make_block(void **state) {
    (void)state;
    return lar_bench_scaling_block(216, &block, NULL) ? -1 : 0;
}

static int destroy_block(void **state) {
    (void)state;
    lar_model_destroy(block);
    return 0;
}

static lar_bench_scaling_options quick(void) {
    return (lar_bench_scaling_options){.model = block,
                                       .processors = "1,2",
                                       .threads = "2",
                                       .comm = "threads",
                                       .quick = true,
                                       .repeat = 2,
                                       .command = "bench scaling"};
}

/* The hash of the plain loop after as many steps, made without the benchmark. */
static uint64_t plain_hash(uint64_t steps) {
    lar_simulation *simulation = NULL;
    assert_int_equal(lar_simulation_create(block, NULL, &simulation, NULL), LAR_OK);
    assert_int_equal(lar_simulation_advance(simulation, steps, NULL), LAR_OK);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static void check_row(const lar_bench_scaling_row *row, const char *grid, const char *comm,
                      int32_t processors, int32_t threads) {
    assert_string_equal(row->grid, grid);
    assert_string_equal(row->comm, comm);
    assert_int_equal(row->processors, processors);
    assert_int_equal(row->threads, threads);
    assert_null(row->missing);
    const lar_spread *time = &row->microseconds;
    assert_true(0 < time->min && time->min <= time->median && time->median <= time->max);
    assert_true(fabs(row->over_plain * row->speed_up - 1) < 1e-12);
    assert_true(fabs(row->efficiency * processors * threads - row->speed_up) < 1e-12);
}

static void figures_fit_together(void **state) {
    (void)state;
    lar_bench_scaling_options options = quick();
    lar_bench_scaling_result r;
    assert_int_equal(lar_bench_scaling(&options, &r, NULL), LAR_OK);
    assert_int_equal(r.rows, 4);
    check_row(&r.row[0], "none", "none", 1, 1);
    check_row(&r.row[1], "1x1x1", "threads", 1, 1);
    check_row(&r.row[3], "1x1x1", "threads", 1, 2);
    assert_int_equal(r.row[2].processors, 2);
    assert_true(r.row[0].over_plain == 1);
    double ratio = r.row[2].microseconds.median / r.row[0].microseconds.median;
    assert_true(fabs(r.row[2].over_plain - ratio) < 1e-12);
    assert_true(r.core_to_core.min > 0);
    assert_int_equal(r.info.elements, 216);
    assert_true(r.steps > 0 && r.repeat == 2);
    assert_true(r.hash == plain_hash(r.warm_up + r.steps));
}

/* A body at rest would compute with zeros, and hash the same whatever was lost. */
static void every_node_moves(void **state) {
    (void)state;
    lar_simulation *simulation = NULL;
    lar_model_info info;
    double velocity[343][3];
    assert_int_equal(lar_model_inspect(block, &info, NULL), LAR_OK);
    assert_int_equal(info.nodes, 343);
    assert_int_equal(lar_simulation_create(block, NULL, &simulation, NULL), LAR_OK);
    lar_simulation_velocities(simulation, velocity);
    for (int n = 0; n < 343; n++)
        assert_true(velocity[n][0] != 0 && velocity[n][1] != 0 && velocity[n][2] != 0);
    lar_simulation_destroy(simulation);
}

/* The block has 6 x 6 x 6 elements: cut twice it is better than cut into four slices. */
static void grids_have_little_communication(void **state) {
    (void)state;
    lar_bench_scaling_options options = quick();
    lar_bench_scaling_result r;
    options.processors = "4";
    options.threads = NULL;
    options.repeat = 1;
    assert_int_equal(lar_bench_scaling(&options, &r, NULL), LAR_OK);
    assert_int_equal(r.rows, 2);
    lar_grid grid;
    assert_int_equal(lar_grid_parse(r.row[1].grid, &grid, NULL), LAR_OK);
    assert_int_equal(grid.count, 4);
    for (int i = 0; i < 3; i++) assert_true(grid.edge[i] <= 2);
    check_row(&r.row[1], r.row[1].grid, "threads", 4, 1);
}

static void grids_are_taken_as_given(void **state) {
    (void)state;
    lar_bench_scaling_options options = quick();
    lar_bench_scaling_result r;
    options.grids = "1x3x1,1x1x2";
    options.comm = "threads,mpi";
    options.threads = "3";
    options.scheme = "local";
    options.distribution = "random";
    options.repeat = 1;
    assert_int_equal(lar_bench_scaling(&options, &r, NULL), LAR_OK);
    assert_int_equal(r.rows, 6);
    check_row(&r.row[1], "1x3x1", "threads", 3, 1);
    check_row(&r.row[3], "1x1x2", "threads", 2, 1);
    check_row(&r.row[5], "1x1x1", "threads", 1, 3);
    assert_string_equal(r.row[2].comm, "mpi");
    assert_non_null(r.row[2].missing); /* nobody has called mpirun */
}

static void refused(lar_bench_scaling_options options, const char *why) {
    lar_bench_scaling_result r;
    lar_error error;
    assert_int_equal(lar_bench_scaling(&options, &r, &error), LAR_ERROR_ARGUMENT);
    if (!strstr(error.message, why)) fail_msg("'%s' lacks '%s'", error.message, why);
}

static void nonsense_is_refused(void **state) {
    (void)state;
    lar_bench_scaling_options options = quick();
    options.processors = "1,two";
    refused(options, "two");
    options.processors = "1,,2";
    refused(options, "list");
    options.processors = "217"; /* more than elements */
    refused(options, "217");
    options = quick();
    options.comm = "pigeons";
    refused(options, "no communication by pigeons");
    options = quick();
    options.threads = "2,17";
    refused(options, "17");
    options = quick();
    options.grids = "2x2";
    refused(options, "2x2");
    options = quick();
    options.repeat = 0;
    refused(options, "samples");
    options = quick();
    options.grids = "1x1x1,1x1x1,1x1x1,1x1x1,1x1x1,1x1x1,1x1x1,1x1x1";
    char many[8 * 64];
    many[0] = '\0';
    for (int i = 0; i < 8; i++) {
        strcat(many, options.grids);
        if (i < 7) strcat(many, ",");
    }
    options.grids = many;
    refused(options, "shorter lists");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_fit_together), cmocka_unit_test(every_node_moves),
        cmocka_unit_test(grids_have_little_communication),
        cmocka_unit_test(grids_are_taken_as_given), cmocka_unit_test(nonsense_is_refused)};
    return cmocka_run_group_tests(tests, make_block, destroy_block);
}
