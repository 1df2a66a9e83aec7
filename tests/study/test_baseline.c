/* Figures against earlier ones: better and worse on both sides, and files that are no earlier run.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "study/bench/baseline.h"
#include "testing.h"

static const char PATH[] = LAR_TEST_BUILD "/baseline.json";

static const char GOOD[] =
    "{\n  \"bench\": \"kernel\",\n  \"options\": {\"elements\": 1840, \"shape\": \"box\"},\n"
    "  \"machine\": {\"cpu\": \"one: with a colon, \\\"quoted\\\"\", \"load_average\": [1, 2, "
    "3]},\n"
    "  \"figures\": [\n"
    "    {\"name\": \"time\", \"unit\": \"ns\", \"value\": 10, \"judged\": true},\n"
    "    {\"name\": \"rate\", \"unit\": \"\", \"value\": 1e2, \"judged\": true},\n"
    "    {\"name\": \"longest\", \"unit\": \"ns\", \"value\": 10, \"judged\": false},\n"
    "    {\"name\": \"none\", \"unit\": \"\", \"value\": 0, \"judged\": true}]\n}\n";

static void put(const char *text, size_t length) {
    FILE *file = fopen(PATH, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

static lar_baseline *open_good(void) {
    lar_baseline *baseline = NULL;
    lar_error error;
    put(GOOD, sizeof GOOD - 1);
    if (lar_baseline_open(PATH, &baseline, &error)) fail_msg("%s", error.message);
    return baseline;
}

static lar_bench_report report_of(const char *bench, double elements, const char *shape) {
    lar_bench_report report = {.bench = bench};
    lar_bench_set_number(&report, "elements", elements);
    lar_bench_set_text(&report, "shape", shape);
    return report;
}

static lar_comparison compare(const char *name, double value, bool more, bool judged,
                              double tolerance) {
    lar_baseline *baseline = open_good();
    lar_bench_report report = {.bench = "kernel"};
    lar_bench_figure *figure = lar_bench_add(&report, "", value, judged, "%s", name);
    figure->more = more;
    lar_comparison made = lar_baseline_compare(baseline, figure, tolerance);
    lar_baseline_close(baseline);
    return made;
}

static void a_time_is_worse_when_it_is_longer(void **unused) {
    (void)unused;
    lar_comparison c = compare("time", 12, false, true, 10);
    assert_true(c.known && c.failed && c.earlier == 10);
    assert_true(fabs(c.ratio - 1.2) < 1e-12 && fabs(c.worse - 20) < 1e-9);
    assert_false(compare("time", 12, false, true, 21).failed);
    assert_false(compare("time", 10, false, true, 0).failed);
    assert_true(compare("time", 10.001, false, true, 0).failed);
    c = compare("time", 5, false, true, 0);
    assert_true(!c.failed && fabs(c.worse + 50) < 1e-9);
}

static void a_rate_is_worse_when_it_is_lower(void **unused) {
    (void)unused;
    lar_comparison c = compare("rate", 80, true, true, 10);
    assert_true(c.failed && fabs(c.ratio - 0.8) < 1e-12 && fabs(c.worse - 25) < 1e-9);
    assert_false(compare("rate", 80, true, true, 26).failed);
    assert_false(compare("rate", 200, true, true, 0).failed);
    assert_true(compare("rate", 0, true, true, 1e6).failed);
}

static void what_is_not_judged_never_fails(void **unused) {
    (void)unused;
    lar_comparison c = compare("longest", 1e9, false, false, 0);
    assert_true(c.known && !c.failed);
    c = compare("never seen", 1e9, false, true, 0);
    assert_true(!c.known && !c.failed);
}

static void against_nothing_there_is_no_ratio(void **unused) {
    (void)unused;
    lar_comparison c = compare("none", 0, false, true, 10);
    assert_true(c.known && !c.failed && c.ratio == 0 && c.worse == 0);
    c = compare("none", 1e-3, false, true, 10);
    assert_true(c.failed && c.ratio == 0 && c.worse == 0);
}

static void other_runs_are_refused(void **unused) {
    (void)unused;
    lar_baseline *baseline = open_good();
    lar_error error;
    lar_bench_report same = report_of("kernel", 1840, "box");
    assert_int_equal(lar_baseline_match(baseline, &same, &error), LAR_OK);
    lar_bench_report other = report_of("comm", 1840, "box");
    assert_int_equal(lar_baseline_match(baseline, &other, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "kernel"));
    other = report_of("kernel", 1841, "box");
    assert_int_equal(lar_baseline_match(baseline, &other, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "1841"));
    other = report_of("kernel", 1840, "general");
    assert_int_equal(lar_baseline_match(baseline, &other, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "shape \"box\""));
    lar_bench_set_text(&same, "isa", "c");
    assert_int_equal(lar_baseline_match(baseline, &same, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "isa unknown"));
    lar_baseline_close(baseline);
}

static void a_judged_figure_must_be_there(void **unused) {
    (void)unused;
    lar_baseline *baseline = open_good();
    lar_bench_report report = {.bench = "kernel"};
    lar_bench_add(&report, "", 1, true, "time");
    lar_bench_add(&report, "", 1, true, "none");
    char missing[LAR_BENCH_TEXT];
    assert_true(lar_baseline_missing(baseline, &report, missing));
    assert_string_equal(missing, "rate");
    lar_bench_add(&report, "", 1, true, "%s", "rate");
    assert_false(lar_baseline_missing(baseline, &report, missing));
    lar_baseline_close(baseline);
}

static void texts_are_found_by_their_path(void **unused) {
    (void)unused;
    lar_baseline *baseline = open_good();
    char text[64];
    assert_true(lar_baseline_text(baseline, "machine.cpu", text, sizeof text));
    assert_string_equal(text, "one: with a colon, \"quoted\"");
    assert_true(lar_baseline_text(baseline, "options.elements", text, sizeof text));
    assert_string_equal(text, "1840");
    assert_true(lar_baseline_text(baseline, "options.elements", text, 3));
    assert_string_equal(text, "18");
    assert_false(lar_baseline_text(baseline, "machine", text, sizeof text));
    assert_false(lar_baseline_text(baseline, "machine.cpu.name", text, sizeof text));
    assert_false(lar_baseline_text(baseline, "date", text, sizeof text));
    lar_baseline_close(baseline);
}

static void refused(const char *text, size_t length) {
    lar_baseline *baseline = NULL;
    lar_error error = {.message = ""};
    put(text, length);
    if (!lar_baseline_open(PATH, &baseline, &error))
        fail_msg("taken for an earlier run: %.*s", (int)length, text);
    assert_null(baseline);
    assert_non_null(strstr(error.message, "baseline.json"));
}

static void every_file_that_is_cut_off_is_refused(void **unused) {
    (void)unused;
    for (size_t length = 0; length < sizeof GOOD - 3; length++) refused(GOOD, length);
}

static void files_of_something_else_are_refused(void **unused) {
    (void)unused;
    static const char *const text[] = {
        "[1, 2]",
        "\"bench\"",
        "{}",
        "{\"bench\": \"kernel\", \"options\": {}}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": []}",
        "{\"bench\": 7, \"options\": {}, \"figures\": [{\"name\": \"a\", \"value\": 1, "
        "\"judged\": true}]}",
        "{\"bench\": \"kernel\", \"options\": [], \"figures\": [{\"name\": \"a\", \"value\": 1, "
        "\"judged\": true}]}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": [{\"name\": \"a\", \"value\": "
        "\"1\", \"judged\": true}]}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": [{\"name\": \"a\", \"value\": null, "
        "\"judged\": true}]}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": [{\"name\": \"a\", \"value\": nan, "
        "\"judged\": true}]}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": [{\"name\": [], \"value\": 1, "
        "\"judged\": true}]}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": [{\"name\": \"a\", \"value\": 1}]}",
        "{\"bench\": \"kernel\", \"options\": {}, \"figures\": [7]}"};
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) refused(text[i], strlen(text[i]));
    lar_baseline *baseline = NULL;
    assert_int_equal(lar_baseline_open(LAR_TEST_BUILD "/no such file", &baseline, NULL),
                     LAR_ERROR_IO);
    assert_null(baseline);
    lar_baseline_close(NULL);
}

/* Nothing is written behind the end, however much there is. */
static void reports_are_bounded(void **unused) {
    (void)unused;
    lar_bench_report report = {.bench = "kernel"};
    char longer[2 * LAR_BENCH_TEXT];
    memset(longer, 'x', sizeof longer);
    longer[sizeof longer - 1] = '\0';
    for (int i = 0; i < LAR_BENCH_SETTINGS_MAX + 3; i++)
        lar_bench_set_text(&report, "title", longer);
    for (int i = 0; i < LAR_BENCH_FIGURES_MAX + 3; i++)
        lar_bench_add(&report, "", i, true, "%s", longer)->more = true;
    lar_bench_add(&report, "", NAN, true, "no number");
    assert_int_equal(report.settings, LAR_BENCH_SETTINGS_MAX);
    assert_int_equal(report.figures, LAR_BENCH_FIGURES_MAX);
    assert_int_equal(strlen(report.setting[0].text), LAR_BENCH_TEXT - 1);
    assert_int_equal(strlen(report.figure[0].name), LAR_BENCH_TEXT - 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_time_is_worse_when_it_is_longer),
                                       cmocka_unit_test(a_rate_is_worse_when_it_is_lower),
                                       cmocka_unit_test(what_is_not_judged_never_fails),
                                       cmocka_unit_test(against_nothing_there_is_no_ratio),
                                       cmocka_unit_test(other_runs_are_refused),
                                       cmocka_unit_test(a_judged_figure_must_be_there),
                                       cmocka_unit_test(texts_are_found_by_their_path),
                                       cmocka_unit_test(every_file_that_is_cut_off_is_refused),
                                       cmocka_unit_test(files_of_something_else_are_refused),
                                       cmocka_unit_test(reports_are_bounded)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
