/* The benchmark measures what it says: the block's shape, its motion, the peak's loop. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <stdlib.h>

#include <cmocka.h>

#include "model/model.h"
#include "study/bench/laws.h"
#include "study/bench/fma_peak.h"

static void edges_are_exact_where_they_can_be(void **state) {
    (void)state;
    static const int32_t exact[] = {1, 8, 12, 27, 64, 1840, 1000, 4096, 100000, 1000000};
    for (size_t i = 0; i < sizeof exact / sizeof exact[0]; i++) {
        int32_t edge[3];
        lar_bench_edges(exact[i], edge);
        assert_int_equal((int64_t)edge[0] * edge[1] * edge[2], exact[i]);
    }
    int32_t edge[3];
    lar_bench_edges(1840, edge);
    assert_int_equal(edge[0], 23);
    assert_int_equal(edge[1], 10);
    assert_int_equal(edge[2], 8);
}

static void edges_are_near_where_not(void **state) {
    (void)state;
    for (int32_t wanted = 1; wanted < 30000; wanted = wanted * 5 / 4 + 1) {
        int32_t edge[3];
        lar_bench_edges(wanted, edge);
        int64_t product = (int64_t)edge[0] * edge[1] * edge[2];
        assert_true(edge[0] >= 1 && edge[1] >= 1 && edge[2] >= 1);
        assert_true(edge[0] <= 3 * edge[2]);
        assert_true(llabs(product - wanted) <= 1 + wanted / 8);
    }
}

/* The greatest difference between opposite edges, over the shortest edge: 0 for a
 * parallelepiped. */
static double crookedness(const double corner[8][3]) {
    static const int pairs[9][4] = {{0, 1, 3, 2}, {0, 1, 4, 5}, {0, 1, 7, 6},
                                    {0, 3, 1, 2}, {0, 3, 4, 7}, {0, 3, 5, 6},
                                    {0, 4, 1, 5}, {0, 4, 2, 6}, {0, 4, 3, 7}};
    double max = 0;
    for (int k = 0; k < 9; k++)
        for (int i = 0; i < 3; i++) {
            double first = corner[pairs[k][1]][i] - corner[pairs[k][0]][i];
            double second = corner[pairs[k][3]][i] - corner[pairs[k][2]][i];
            max = fmax(max, fabs(first - second));
        }
    return max;
}

static void general_blocks_have_no_parallelepiped(void **state) {
    (void)state;
    static const int32_t edge[3] = {9, 8, 7};
    for (int general = 0; general < 2; general++) {
        lar_model *model = NULL;
        lar_error error;
        assert_int_equal(lar_bench_block(edge, general, &model, &error), LAR_OK);
        assert_int_equal(model->mesh.element_count, 9 * 8 * 7);
        for (int32_t e = 0; e < model->mesh.element_count; e++) {
            double corner[8][3];
            lar_mesh_corners(&model->mesh, e, corner);
            if (general) {
                assert_true(crookedness(corner) > 1e-4); /* of 5 mm */
                assert_true(lar_scaled_jacobian(corner) > 0.3);
            } else {
                assert_true(crookedness(corner) < 1e-15);
            }
        }
        lar_model_destroy(model);
    }
}

static void figures_fit_together(void **state) {
    (void)state;
    lar_bench_kernel_options options = {.elements = 216, .general = true, .repeat = 3};
    lar_bench_kernel_result r;
    lar_error error;
    assert_int_equal(lar_bench_kernel(&options, &r, &error), LAR_OK);
    assert_int_equal(r.elements, 216);
    assert_int_equal(r.nodes, 343);
    assert_true(0 < r.nanoseconds.min && r.nanoseconds.min <= r.nanoseconds.median &&
                r.nanoseconds.median <= r.nanoseconds.max);
    assert_true(0 < r.peak_gflops.min && r.peak_gflops.min <= r.peak_gflops.max);
    double share = 816 / r.nanoseconds.median / r.peak_gflops.median;
    assert_true(fabs(share - r.fraction_of_peak) < 1e-12);
    /* Eighteen gradients at least. */
    assert_true(r.bytes_per_element > 144 && r.bytes_per_element < 2000);
}

/* As soft at rest as the block's own, and every term of a law at work. */
static void materials_of_laws_compare(void **state) {
    (void)state;
    lar_material material;
    lar_error error;
    const char *words;
    int count = 0;
    for (; (words = lar_bench_law_words(count)); count++) {
        assert_int_equal(lar_bench_law_material(words, &material, &error), LAR_OK);
        assert_int_equal(lar_material_check(&material, words, &error), LAR_OK);
        assert_true(fabs(lar_material_shear(&material) / 1.5e3 - 1) < 1e-12);
        for (int k = 0; k < lar_law_table[material.law].count; k++)
            assert_true(material.parameter[k] != 0);
    }
    assert_int_equal(count, LAR_LAW_COUNT + LAR_FIBRE_LAWS + LAR_BENCH_TERMS + 1);
    assert_int_equal(lar_bench_law_material("active+exp-linear", &material, &error), LAR_OK);
    assert_true(material.fibre.along > 0 && material.fibre.law == LAR_FIBRE_EXP_LINEAR);
    assert_int_equal(lar_bench_law_material("active+active", &material, &error),
                     LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_bench_law_material("hgo-pair+viscous-2+yeoh", &material, &error), LAR_OK);
    assert_true(material.law == LAR_LAW_yeoh && material.fibre.law == LAR_FIBRE_HGO &&
                material.fibre.paired && material.viscosity.terms == 2);
    assert_int_equal(lar_bench_law_material("hgo+", &material, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_bench_law_material("hgo+exp-pow", &material, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "'exp-pow' is one too many"));
}

static void times_of_laws_fit_together(void **state) {
    (void)state;
    lar_bench_kernel_options options = {.elements = 216, .general = true, .repeat = 3};
    lar_bench_law_row row;
    lar_error error;
    assert_int_equal(lar_bench_law(&options, "ogden+hgo-pair+viscous-3", &row, &error), LAR_OK);
    assert_int_equal(row.elements, 216);
    assert_true(0 < row.ratio.min && row.ratio.min <= row.ratio.median &&
                row.ratio.median <= row.ratio.max && row.beside.min > 0);
    assert_true(row.ratio.max > 1.2); /* it takes some four times as long */
    options.repeat = 0;
    assert_int_equal(lar_bench_law(&options, "ogden", &row, &error), LAR_ERROR_ARGUMENT);
}

static void nonsense_is_refused(void **state) {
    (void)state;
    lar_bench_kernel_options options = {.elements = 0, .repeat = 3};
    lar_bench_kernel_result r;
    lar_error error;
    assert_int_equal(lar_bench_kernel(&options, &r, &error), LAR_ERROR_ARGUMENT);
    options.elements = 8;
    options.repeat = LAR_BENCH_REPEAT_MAX + 1;
    assert_int_equal(lar_bench_kernel(&options, &r, &error), LAR_ERROR_ARGUMENT);
}

/* Every accumulator follows x' = (x + 1)/2 towards 1: the sum tells that no round was left out. */
static void the_peak_computes_what_it_counts(void **state) {
    (void)state;
    const lar_fma_peak *peak = lar_fma_peak_find("c");
    assert_non_null(peak);
    assert_null(lar_fma_peak_find("z80"));
    double accumulators = peak->run(1000);
    assert_true(accumulators == floor(accumulators) && accumulators >= 8);
    assert_true(peak->operations % (2 * (int)accumulators) == 0);
    int repeats = peak->operations / (2 * (int)accumulators);
    double expected = 0;
    for (int i = 0; i < (int)accumulators; i++)
        expected += 1 - (1 - 1.0 / (i + 2)) * pow(0.5, 2 * repeats);
    assert_true(fabs(peak->run(2) - expected) < 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(edges_are_exact_where_they_can_be),
                                       cmocka_unit_test(edges_are_near_where_not),
                                       cmocka_unit_test(general_blocks_have_no_parallelepiped),
                                       cmocka_unit_test(figures_fit_together),
                                       cmocka_unit_test(materials_of_laws_compare),
                                       cmocka_unit_test(times_of_laws_fit_together),
                                       cmocka_unit_test(nonsense_is_refused),
                                       cmocka_unit_test(the_peak_computes_what_it_counts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
