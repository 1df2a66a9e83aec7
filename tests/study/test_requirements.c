/* The thesis's tables, number by number, and what is counted from models. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "model/model.h"
#include "study/bench/kernel.h"
#include "study/requirements/requirements.h"

/* ---- chapter 4 as printed ------------------------------------------------------------------ */

/* Whether a number, rounded to so many digits, is what is printed. */
static void prints_as(double value, double printed, int digits) {
    char text[40];
    snprintf(text, sizeof text, "%.*e", digits - 1, value);
    if (fabs(strtod(text, NULL) - printed) > 1e-9 * printed)
        fail_msg("%.6g is %s with %d digits, not %g", value, text, digits, printed);
}

static void table_4_1(void **state) {
    (void)state;
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_quantities q = lar_thesis_quantities();
    lar_formula_matrix(24, row);
    const double printed[LAR_FORMULA_ROWS][2] = {{25 * 24, 31 * 24},     {5 * 24 * 30, 6 * 24 * 30},
                                                 {2 * 24 * 11, 24 * 33}, {576, 0},
                                                 {5 * 24, 7 * 24},       {5424, 6024}};
    for (int i = 0; i < LAR_FORMULA_ROWS; i++) {
        assert_true(row[i].additions == printed[i][0]);
        assert_true(row[i].multiplications == printed[i][1]);
    }
    /* The printed totals and eq. 4.4, for elements with other nodes too. */
    for (double df = 12; df <= 81; df += 3) {
        lar_formula_matrix(df, row);
        q.df_el = df;
        assert_true(fabs(row[5].additions - (20.0 / 3 * df * df + 66 * df)) < 1e-9 * df * df);
        assert_true(fabs(row[5].multiplications - (7 * df * df + 83 * df)) < 1e-9 * df * df);
        assert_true(fabs(lar_formula_N_K(&q) - 8 * (41.0 / 3 * df * df + 149 * df)) < 1e-6);
    }
    q = lar_thesis_quantities();
    assert_true(lar_formula_N_K(&q) == 91584);
    prints_as(lar_formula_N_K(&q), 9e4, 1); /* "90,000" */
}

static void table_4_2(void **state) {
    (void)state;
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_quantities q = lar_thesis_quantities();
    lar_formula_vector(24, row);
    const double printed[LAR_FORMULA_ROWS][2] = {
        {25 * 24, 31 * 24},        {11 * 24 + 24, 12 * 24 + 36},
        {5 * 24 + 9, 6 * 24 + 27}, {24, 0},
        {5 * 24, 7 * 24},          {1161, 1407}};
    for (int i = 0; i < LAR_FORMULA_ROWS; i++) {
        assert_true(row[i].additions == printed[i][0]);
        assert_true(row[i].multiplications == printed[i][1]);
    }
    for (double df = 12; df <= 81; df += 3) {
        lar_formula_vector(df, row);
        q.df_el = df;
        assert_true(row[5].additions == 47 * df + 33 && row[5].multiplications == 56 * df + 63);
        assert_true(lar_formula_N_Ku(&q) == 8 * (103 * df + 96));
    }
    q = lar_thesis_quantities();
    assert_true(lar_formula_N_Ku(&q) == 20544); /* "more than 20'000" */
}

static void table_4_3(void **state) {
    (void)state;
    const lar_quantities q = lar_thesis_quantities();
    double operations[LAR_METHODS], rate[LAR_METHODS];
    for (int m = 0; m < LAR_METHODS; m++) {
        operations[m] = lar_formula_operations((lar_method)m, &q);
        rate[m] = operations[m] / lar_formula_step((lar_method)m, &q);
    }
    assert_true(lar_freedoms(&q) == 7584);
    assert_true(fabs(lar_formula_N_g(&q) - 2 * 7584 * 131.8) < 1e-6);
    /* Exact, from eqs. 4.1, 4.9, 4.11, 4.12. */
    assert_true(fabs(operations[LAR_METHOD_IMPLICIT] - 368428800) < 1e-3);
    assert_true(fabs(operations[LAR_METHOD_MATRIX] - 169580294.4) < 1e-3);
    assert_true(fabs(operations[LAR_METHOD_VECTOR] - 37851014.4) < 1e-3);
    assert_true(fabs(operations[LAR_METHOD_HOURGLASS] - 1551494.4) < 1e-3);
    /* As printed. */
    prints_as(operations[LAR_METHOD_VECTOR], 38e6, 2);
    prints_as(operations[LAR_METHOD_HOURGLASS], 1.6e6, 2);
    prints_as(rate[LAR_METHOD_MATRIX], 1.7e12, 2);
    prints_as(rate[LAR_METHOD_VECTOR], 379e9, 3);
    prints_as(rate[LAR_METHOD_HOURGLASS], 16e9, 2);
    /* Its 167 M comes from N_K = 90,000, its 339 M and 17 GFLOPS from an N_K without the
     * multiplications 83 df_el of table 4.1. */
    prints_as(operations[LAR_METHOD_MATRIX] + 1840 * (90000 - lar_formula_N_K(&q)), 167e6, 3);
    double lost = operations[LAR_METHOD_IMPLICIT] - 1840.0 * 8 * 83 * 24;
    prints_as(lost, 339e6, 3);
    prints_as(lost / q.step_im, 17e9, 2);
    /* 36 processors, from the rounded 16 GFLOPS. */
    assert_true(round(lar_formula_alphas(16e9)) == 36);
    assert_true(ceil(lar_formula_alphas(rate[LAR_METHOD_HOURGLASS])) == 35);
}

static void table_4_4(void **state) {
    (void)state;
    const lar_quantities q = lar_thesis_quantities();
    double implicit = lar_formula_values(LAR_METHOD_IMPLICIT, &q);
    assert_true(fabs(lar_formula_C_K(&q) - 61.4 * 7584) < 1e-6);
    assert_true(lar_formula_C_g(&q) == 121);
    assert_true(fabs(implicit - 477757.6) < 1e-6);
    assert_true(floor(implicit / 1000) == 477); /* cut off */
    prints_as(8 * implicit / q.step_im, 191e6, 3);
    for (int m = LAR_METHOD_MATRIX; m < LAR_METHODS; m++) {
        double values = lar_formula_values((lar_method)m, &q);
        assert_true(fabs(values - 5460.48) < 1e-6);
        prints_as(values, 5.5e3, 2);
        prints_as(8 * values / q.step_ex, 437e6, 3);
    }
}

/* What the command shows as the thesis's own is what the thesis has. */
static void printed_numbers(void **state) {
    (void)state;
    static const double table[LAR_METHODS][4] = {{339e6, 17e9, 477e3, 191e6},
                                                 {167e6, 1.7e12, 5.5e3, 437e6},
                                                 {38e6, 379e9, 5.5e3, 437e6},
                                                 {1.6e6, 16e9, 5.5e3, 437e6}};
    for (int m = 0; m < LAR_METHODS; m++) {
        const lar_thesis_print *t = &lar_thesis_printed[m];
        assert_true(t->operations == table[m][0] && t->operations_per_second == table[m][1]);
        assert_true(t->values == table[m][2] && t->bytes_per_second == table[m][3]);
    }
}

static void examples_of_3_7(void **state) {
    (void)state;
    const lar_quantities q = lar_thesis_quantities();
    assert_int_equal(lar_formula_edge(&q), 5);
    assert_true(lar_formula_vectors_all(5) == 296);
    assert_true(lar_formula_vectors_local(5) == 216);
    for (int64_t n = 1; n < 30; n++) {
        const int64_t table[LAR_FORMULA_SCHEMES][2] = {{6 * (n + 1) * (n + 1), 12 * n + 20},
                                                       {6 * (n + 1) * (n + 1), 0},
                                                       {6 * n * n, 6 * n + 2},
                                                       {6 * (n * n + 2 * n - 1), 8}};
        for (int s = 0; s < LAR_FORMULA_SCHEMES; s++) {
            lar_formula_traffic row = lar_formula_scheme(s, n);
            assert_int_equal(row.local, table[s][0]);
            assert_int_equal(row.global, table[s][1]);
        }
        assert_true((double)(table[0][0] + table[0][1]) == lar_formula_vectors_all((double)n));
        assert_true((double)table[1][0] == lar_formula_vectors_local((double)n));
    }
}

/* ---- counted from models ------------------------------------------------------------------- */

static lar_model *block_of(int32_t x, int32_t y, int32_t z, bool general) {
    const int32_t edge[3] = {x, y, z};
    lar_model *model = NULL;
    assert_int_equal(lar_bench_block(edge, general, &model, NULL), LAR_OK);
    return model;
}

/* Along an axis of e elements e + 1 nodes have 3 e + 1 neighbours, with themselves. */
static void a_block_has_so_many_neighbours(void **state) {
    (void)state;
    static const int32_t edges[][3] = {{1, 1, 1}, {2, 1, 1}, {3, 4, 5}, {7, 2, 6}};
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        const int32_t *e = edges[i];
        lar_model *model = block_of(e[0], e[1], e[2], true);
        const lar_requirements_options options = {.grid = "1x1x1"};
        lar_requirements r;
        double nodes = 1, pairs = 1;
        for (int k = 0; k < 3; k++) {
            nodes *= e[k] + 1;
            pairs *= 3 * e[k] + 1;
        }
        assert_int_equal(lar_requirements_of(model, &options, &r, NULL), LAR_OK);
        const lar_quantities q = r.quantities;
        assert_true(q.n_el == e[0] * e[1] * e[2] && q.n_k == nodes && q.df_el == 24);
        assert_true(q.n_eav == 8 * q.n_el / nodes);
        assert_true(fabs(q.df_eav - 3 * pairs / nodes) < 1e-12 * pairs);
        assert_true(q.n_pav == 1);
        lar_requirements_clear(&r);
        lar_model_destroy(model);
    }
}

/* The processor in the middle of 27 sends what T 3.7 computes, in packets to 6 or 26 others with
 * 16 bytes at their ends. */
static void schedules_send_the_examples(void **state) {
    (void)state;
    lar_model *model = block_of(15, 15, 15, false);
    const lar_requirements_options options = {.grid = "3x3x3"};
    lar_requirements r;
    lar_error error;
    assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_OK);
    assert_int_equal(r.elements_max, 125);
    assert_true(r.quantities.n_p == 27);
    assert_string_equal(r.sent[0].scheme, "all");
    assert_int_equal(r.sent[0].bytes_max, 296 * 24 + 26 * 16);
    assert_string_equal(r.sent[1].scheme, "local");
    assert_int_equal(r.sent[1].bytes_max, 216 * 24 + 6 * 16);
    for (int s = 0; s < LAR_REQUIREMENTS_SCHEMES; s++)
        assert_int_equal(r.sent[s].bytes, 24 * r.sent[s].vectors + 16 * r.sent[s].packets);
    for (int s = 0; s < LAR_REQUIREMENTS_SCHEMES; s++) {
        int64_t bytes = 0, of_middle = 0;
        for (int64_t i = 0; i < r.sent[s].packets; i++) {
            const lar_requirements_packet *packet = &r.sent[s].packet[i];
            assert_in_range(packet->from, 0, 26);
            assert_true(packet->to >= 0 && packet->to < 27 && packet->to != packet->from);
            bytes += packet->bytes;
            of_middle += packet->from == 13 ? packet->bytes : 0;
        }
        assert_int_equal(bytes, r.sent[s].bytes);
        assert_int_equal(of_middle, r.sent[s].bytes_max);
    }
    /* Eq. 4.8 is the scheme `one`: every processor but one sends a part and gets the sum. */
    double estimate = 8 * lar_formula_values(LAR_METHOD_HOURGLASS, &r.quantities);
    assert_true(fabs(estimate - 24.0 * (double)r.sent[2].vectors) < 1e-6 * estimate);
    assert_false(r.measured || r.demonstration || r.why_not.status);
    lar_requirements_clear(&r);
    lar_model_destroy(model);
}

static void steps_cost_their_elements_and_nodes(void **state) {
    (void)state;
    for (int general = 0; general < 2; general++) {
        lar_model *model = block_of(5, 4, 3, general);
        const lar_requirements_options options = {
            .grid = "1x1x1", .iterations = 7, .implicit_step = 0.5};
        lar_requirements r;
        lar_error error;
        assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_OK);
        double nodes = 6 * 5 * 4, elements = 5 * 4 * 3;
        const lar_requirements_kernel *k = r.kernel;
        assert_int_equal(r.shape_count, 1);
        assert_int_equal(r.shape[0].kind, general ? LAR_KERNEL_HEX8 : LAR_KERNEL_HEX8_BOX);
        assert_int_equal(r.shape[0].elements, 60);
        assert_true(r.shape[0].lanes >= 60 && r.shape[0].lanes % 8 == 0);
        assert_true(k[LAR_NEEDS_HEX8].floating == elements * (general ? 540 : 216) + 18 * nodes);
        assert_true(k[LAR_NEEDS_HEX8].operations == elements * (general ? 630 : 306) + 18 * nodes);
        assert_true(k[LAR_NEEDS_HEX8].bytes == elements * (general ? 328 : 112) + 152 * nodes);
        assert_true(k[LAR_NEEDS_FULL].operations == elements * 8296 + 18 * nodes);
        assert_true(k[LAR_NEEDS_MATRIX].operations == elements * 119504 + 18 * nodes);
        assert_true(r.quantities.n_it == 7 && r.quantities.step_im == 0.5);
        /* One processor sends nothing. */
        assert_true(r.quantities.n_pav == 1);
        assert_true(lar_formula_values(LAR_METHOD_HOURGLASS, &r.quantities) == 0);
        for (int s = 0; s < LAR_REQUIREMENTS_SCHEMES; s++) assert_int_equal(r.sent[s].bytes, 0);
        lar_requirements_clear(&r);
        lar_model_destroy(model);
    }
}

static void measuring_fills_the_figures(void **state) {
    (void)state;
    lar_model *model = block_of(4, 3, 3, true);
    const lar_requirements_options options = {.measure = true};
    lar_requirements r;
    lar_error error;
    assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_OK);
    assert_true(r.quantities.n_p == 12); /* the thesis's, not asked for */
    assert_true(r.measured && r.peak_gflops > 0 && r.nanoseconds > 0 && r.isa);
    for (int k = 0; k < LAR_NEEDS; k++) assert_true(r.kernel[k].seconds > 0);
    lar_requirements_clear(&r);
    lar_model_destroy(model);
}

static void small_models_and_nonsense(void **state) {
    (void)state;
    lar_model *model = block_of(2, 1, 1, true);
    lar_requirements_options options = {.grid = NULL};
    lar_requirements r;
    lar_error error;
    assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_OK);
    assert_true(r.quantities.n_p == 1);
    options.grid = "3x2x2";
    assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_ERROR_ARGUMENT);
    options.grid = "3by2";
    assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_ERROR_ARGUMENT);
    options.grid = NULL;
    options.distribution = "no such file";
    assert_int_equal(lar_requirements_of(model, &options, &r, &error), LAR_ERROR_IO);
    lar_requirements_clear(&r);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(table_4_1),
                                       cmocka_unit_test(table_4_2),
                                       cmocka_unit_test(table_4_3),
                                       cmocka_unit_test(table_4_4),
                                       cmocka_unit_test(printed_numbers),
                                       cmocka_unit_test(examples_of_3_7),
                                       cmocka_unit_test(a_block_has_so_many_neighbours),
                                       cmocka_unit_test(schedules_send_the_examples),
                                       cmocka_unit_test(steps_cost_their_elements_and_nodes),
                                       cmocka_unit_test(measuring_fills_the_figures),
                                       cmocka_unit_test(small_models_and_nonsense)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
