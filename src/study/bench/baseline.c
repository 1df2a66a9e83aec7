#include "study/bench/baseline.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json/read.h"
#include "base/memory.h"
#include "base/text.h"

struct lar_baseline {
    char *path;
    lar_bytes bytes;
    lar_json_reader root, options, figures; /* into `bytes`; figures: behind their '[' */
    char bench[LAR_BENCH_TEXT];
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

typedef struct earlier_figure {
    char name[LAR_BENCH_TEXT];
    double value;
    bool judged;
} earlier_figure;

static bool read_text(lar_json_reader value, char text[LAR_BENCH_TEXT]) {
    return value.at && lar_json_next(&value) == '"' &&
           lar_json_take_string(&value, text, LAR_BENCH_TEXT, NULL) && *text;
}

static bool read_figure(lar_json_reader in, earlier_figure *out) {
    lar_json_reader value = lar_json_member(in, "value"), judged = lar_json_member(in, "judged");
    return read_text(lar_json_member(in, "name"), out->name) && value.at && judged.at &&
           lar_json_take_number(&value, &out->value) &&
           lar_json_take_boolean(&judged, &out->judged);
}

/* Figures one after the other: begins with a copy of b->figures. */
static bool next_figure(lar_json_reader *list, earlier_figure *out) {
    lar_json_reader figure;
    return lar_json_element(list, &figure) && read_figure(figure, out);
}

static int line_of(const lar_baseline *b, const char *at) {
    int line = 1;
    for (const char *c = (const char *)b->bytes.data; c < at; c++) line += *c == '\n';
    return line;
}

/* What must be known of every figure. */
static lar_status check_figures(const lar_baseline *b, lar_error *error) {
    lar_json_reader list = b->figures, in;
    earlier_figure figure;
    while (lar_json_element(&list, &in))
        if (!read_figure(in, &figure))
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: a figure needs a name, a value that is a number, and whether "
                            "it is judged; write the file anew with --json",
                            b->path, line_of(b, in.at));
    return LAR_OK;
}

static lar_status check(lar_baseline *b, lar_error *error) {
    b->options = lar_json_member(b->root, "options");
    b->figures = lar_json_member(b->root, "figures");
    if (!read_text(lar_json_member(b->root, "bench"), b->bench) || !b->options.at ||
        lar_json_next(&b->options) != '{' || !b->figures.at || !lar_json_take(&b->figures, '[') ||
        lar_json_next(&b->figures) == ']')
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is not what a benchmark writes with --json: \"bench\", \"options\" "
                        "and \"figures\" must be in it",
                        b->path);
    return check_figures(b, error);
}

static lar_status read(lar_baseline *b, const char *path, lar_error *error) {
    b->path = lar_strdup(path);
    if (!b->path) return lar_fail_memory(error, strlen(path), "a path");
    lar_status status = lar_bytes_read(path, &b->bytes, error);
    if (status) return status;
    const char *text = (const char *)b->bytes.data;
    b->root = (lar_json_reader){text, text + b->bytes.size};
    lar_json_reader whole = b->root;
    if (!lar_json_is_whole(&whole))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "the earlier run is damaged, write it anew with --json: %s:%d: this is no "
                        "JSON",
                        path, line_of(b, whole.at));
    return check(b, error);
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
    lar_bytes_free(&baseline->bytes);
    free(baseline->path);
    free(baseline);
}

bool lar_baseline_text(const lar_baseline *baseline, const char *path, char *text, size_t size) {
    lar_json_reader value = baseline->root;
    lar_span left = {path, strlen(path)}, key;
    char name[LAR_BENCH_TEXT];
    for (bool more = true; more;) {
        more = lar_span_split(left, '.', &key, &left);
        snprintf(name, sizeof name, "%.*s", (int)key.length, key.at);
        value = lar_json_member(value, name);
    }
    return lar_json_scalar(value, text, size);
}

/* ---- comparing ------------------------------------------------------------------------------ */

lar_status lar_baseline_match(const lar_baseline *b, const lar_bench_report *report,
                              lar_error *error) {
    if (strcmp(b->bench, report->bench) != 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is of the benchmark %.40s; compare %s with an earlier run of itself",
                        b->path, b->bench, report->bench);
    for (int i = 0; i < report->settings; i++) {
        const lar_bench_setting *now = &report->setting[i];
        lar_json_reader then = lar_json_member(b->options, now->name);
        char text[LAR_BENCH_TEXT], shown[LAR_BENCH_TEXT + 2] = "unknown";
        if (lar_json_scalar(then, text, sizeof text)) {
            if (strcmp(text, now->text) == 0) continue;
            snprintf(shown, sizeof shown, "\"%s\"", text);
        }
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: was measured with %s %s, and now it is %s: such figures do not "
                        "compare; give the same options",
                        b->path, now->name, shown, *now->text ? now->text : "nothing");
    }
    return LAR_OK;
}

static bool find(const lar_baseline *b, const char *name, earlier_figure *found) {
    lar_json_reader list = b->figures;
    while (next_figure(&list, found))
        if (strcmp(found->name, name) == 0) return true;
    return false;
}

lar_comparison lar_baseline_compare(const lar_baseline *b, const lar_bench_figure *figure,
                                    double tolerance) {
    lar_comparison made = {0};
    earlier_figure then;
    if (!find(b, figure->name, &then)) return made;
    made.earlier = then.value;
    double good = figure->more ? figure->value : made.earlier;
    double bad = figure->more ? made.earlier : figure->value;
    made.known = true;
    if (made.earlier > 0) made.ratio = figure->value / made.earlier;
    if (good > 0 && isfinite(bad / good)) made.worse = 100 * (bad / good - 1);
    made.failed = figure->judged && (good > 0 ? bad / good > 1 + 0.01 * tolerance : bad > good);
    return made;
}

bool lar_baseline_missing(const lar_baseline *b, const lar_bench_report *report,
                          char name[LAR_BENCH_TEXT]) {
    lar_json_reader list = b->figures;
    for (earlier_figure figure; next_figure(&list, &figure);) {
        bool there = !figure.judged;
        for (int i = 0; i < report->figures && !there; i++)
            there = strcmp(report->figure[i].name, figure.name) == 0;
        if (there) continue;
        memcpy(name, figure.name, LAR_BENCH_TEXT);
        return true;
    }
    return false;
}
