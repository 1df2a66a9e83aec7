#include "study/bench/baseline.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "model/scene/yaml_tree.h"

struct lar_baseline {
    char *path;
    lar_yaml_tree tree;
    const lar_yaml *bench, *options, *figures;
};

/* ---- reports -------------------------------------------------------------------------------- */

static lar_bench_setting *add_setting(lar_bench_report *report, const char *name) {
    static lar_bench_setting none;
    if (report->settings == LAR_BENCH_SETTINGS_MAX) return &none;
    lar_bench_setting *setting = &report->setting[report->settings++];
    setting->name = name;
    return setting;
}

void lar_bench_set_text(lar_bench_report *report, const char *name, const char *text) {
    lar_bench_setting *setting = add_setting(report, name);
    setting->number = false;
    snprintf(setting->text, sizeof setting->text, "%s", text);
}

void lar_bench_set_number(lar_bench_report *report, const char *name, double value) {
    lar_bench_setting *setting = add_setting(report, name);
    setting->number = true;
    snprintf(setting->text, sizeof setting->text, "%.17g", value);
}

lar_bench_figure *lar_bench_add(lar_bench_report *report, const char *unit, double value,
                                bool judged, const char *format, ...) {
    static lar_bench_figure none;
    bool room = report->figures < LAR_BENCH_FIGURES_MAX && isfinite(value);
    lar_bench_figure *figure = room ? &report->figure[report->figures++] : &none;
    *figure = (lar_bench_figure){.unit = unit, .value = value, .judged = judged};
    va_list args;
    va_start(args, format);
    vsnprintf(figure->name, sizeof figure->name, format, args);
    va_end(args);
    return figure;
}

/* ---- reading -------------------------------------------------------------------------------- */

static bool read_number(const lar_yaml *node, double *value) {
    return node && node->kind == LAR_YAML_SCALAR && !node->quoted &&
           lar_span_double((lar_span){node->text, strlen(node->text)}, value) && isfinite(*value);
}

static bool is_text(const lar_yaml *node) {
    return node && node->kind == LAR_YAML_SCALAR && node->quoted && *node->text;
}

/* What must be known of every figure. */
static lar_status check_figures(const lar_baseline *b, lar_error *error) {
    for (const lar_yaml *figure = b->figures->first; figure; figure = figure->next) {
        double value;
        const lar_yaml *judged = lar_yaml_get(figure, "judged");
        if (!is_text(lar_yaml_get(figure, "name")) ||
            !read_number(lar_yaml_get(figure, "value"), &value) || !judged ||
            judged->kind != LAR_YAML_SCALAR)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: a figure needs a name, a value that is a number, and whether "
                            "it is judged; write the file anew with --json",
                            b->path, figure->line);
    }
    return LAR_OK;
}

static lar_status check(lar_baseline *b, lar_error *error) {
    b->bench = lar_yaml_get(b->tree.root, "bench");
    b->options = lar_yaml_get(b->tree.root, "options");
    b->figures = lar_yaml_get(b->tree.root, "figures");
    if (!is_text(b->bench) || !b->options || b->options->kind != LAR_YAML_MAPPING || !b->figures ||
        b->figures->kind != LAR_YAML_LIST || !b->figures->first)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is not what a benchmark writes with --json: \"bench\", \"options\" "
                        "and \"figures\" must be in it",
                        b->path);
    return check_figures(b, error);
}

static lar_status read(lar_baseline *b, const char *path, lar_error *error) {
    lar_bytes bytes = {0};
    lar_error cause;
    b->path = lar_strdup(path);
    if (!b->path) return lar_fail_memory(error, strlen(path), "a path");
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (!status && (status = lar_yaml_parse(path, &bytes, &b->tree, &cause)))
        lar_fail(error, status, "the earlier run is damaged, write it anew with --json: %s",
                 cause.message);
    lar_bytes_free(&bytes);
    return status ? status : check(b, error);
}

lar_status lar_baseline_open(const char *path, lar_baseline **baseline, lar_error *error) {
    lar_baseline *made = lar_calloc(1, sizeof *made);
    if (!made) return lar_fail_memory(error, sizeof *made, "the earlier run");
    lar_status status = read(made, path, error);
    if (status)
        lar_baseline_close(made);
    else
        *baseline = made;
    return status;
}

void lar_baseline_close(lar_baseline *baseline) {
    if (!baseline) return;
    lar_yaml_clear(&baseline->tree);
    free(baseline->path);
    free(baseline);
}

const char *lar_baseline_text(const lar_baseline *baseline, const char *path) {
    const lar_yaml *node = baseline->tree.root;
    lar_span left = {path, strlen(path)}, key;
    char name[LAR_BENCH_TEXT];
    for (bool more = true; node && more;) {
        more = lar_span_split(left, '.', &key, &left);
        snprintf(name, sizeof name, "%.*s", (int)key.length, key.at);
        node = lar_yaml_get(node, name);
    }
    return node && node->kind == LAR_YAML_SCALAR ? node->text : NULL;
}

/* ---- comparing ------------------------------------------------------------------------------ */

lar_status lar_baseline_match(const lar_baseline *b, const lar_bench_report *report,
                              lar_error *error) {
    if (strcmp(b->bench->text, report->bench) != 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is of the benchmark %.40s; compare %s with an earlier run of itself",
                        b->path, b->bench->text, report->bench);
    for (int i = 0; i < report->settings; i++) {
        const lar_bench_setting *now = &report->setting[i];
        const lar_yaml *then = lar_yaml_get(b->options, now->name);
        if (then && then->kind == LAR_YAML_SCALAR && strcmp(then->text, now->text) == 0) continue;
        char shown[LAR_YAML_SHOWN];
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: was measured with %s %s, and now it is %s: such figures do not "
                        "compare; give the same options",
                        b->path, now->name, then ? lar_yaml_show(then, shown) : "unknown",
                        *now->text ? now->text : "nothing");
    }
    return LAR_OK;
}

static const lar_yaml *find(const lar_baseline *b, const char *name) {
    for (const lar_yaml *figure = b->figures->first; figure; figure = figure->next)
        if (strcmp(lar_yaml_get(figure, "name")->text, name) == 0) return figure;
    return NULL;
}

lar_comparison lar_baseline_compare(const lar_baseline *b, const lar_bench_figure *figure,
                                    double tolerance) {
    lar_comparison made = {0};
    const lar_yaml *then = find(b, figure->name);
    if (!then || !read_number(lar_yaml_get(then, "value"), &made.earlier)) return made;
    double good = figure->more ? figure->value : made.earlier;
    double bad = figure->more ? made.earlier : figure->value;
    made.known = true;
    if (made.earlier > 0) made.ratio = figure->value / made.earlier;
    if (good > 0 && isfinite(bad / good)) made.worse = 100 * (bad / good - 1);
    made.failed = figure->judged && (good > 0 ? bad / good > 1 + 0.01 * tolerance : bad > good);
    return made;
}

const char *lar_baseline_missing(const lar_baseline *b, const lar_bench_report *report) {
    for (const lar_yaml *figure = b->figures->first; figure; figure = figure->next) {
        const char *name = lar_yaml_get(figure, "name")->text;
        bool there = strcmp(lar_yaml_get(figure, "judged")->text, "true") != 0;
        for (int i = 0; i < report->figures && !there; i++)
            there = strcmp(report->figure[i].name, name) == 0;
        if (!there) return name;
    }
    return NULL;
}
