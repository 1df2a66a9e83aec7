/* The figures of a benchmark against those of an earlier run, which its --json wrote.
 *
 *     { "bench": "kernel",                          which it is,
 *       "options": { "shape": "box", ... },         what it was asked for,
 *       "figures": [ { "name": "ns_per_element",    and what came out
 *                      "value": 8.7, "better": "less", "judged": true }, ... ], ... }
 *
 * Every benchmark's JSON has these three besides keys of its own; only they are looked at. A figure
 * that is judged is worse when it is so many per cent of the earlier one away on its bad side: a
 * time that is 1.2 of the earlier one and a rate that is 1/1.2 of it are both 20 % worse. What is
 * not judged (the longest step of a run) says more about the moment than about the machine.
 */
#ifndef LAR_STUDY_BENCH_BASELINE_H
#define LAR_STUDY_BENCH_BASELINE_H

#include <stdbool.h>
#include <stddef.h>

#include "lariat.h"

enum {
    LAR_BENCH_SETTINGS_MAX = 12,
    LAR_BENCH_FIGURES_MAX = 192,
    LAR_BENCH_TEXT = 96 /* bytes of a name or a setting, with the end */
};

/* Something that the benchmark was asked for. Figures compare only where these are the same. */
typedef struct lar_bench_setting {
    const char *name;
    char text[LAR_BENCH_TEXT];
    bool number; /* written without quotes */
} lar_bench_setting;

typedef struct lar_bench_figure {
    char name[LAR_BENCH_TEXT];
    const char *unit; /* "ns", "" */
    double value;
    bool more;   /* is better */
    bool judged; /* too much worse is a failure */
} lar_bench_figure;

typedef struct lar_bench_report {
    const char *bench; /* "kernel" */
    int settings, figures;
    lar_bench_setting setting[LAR_BENCH_SETTINGS_MAX];
    lar_bench_figure figure[LAR_BENCH_FIGURES_MAX];
} lar_bench_report;

/* What does not fit is cut off or left out. */
void lar_bench_set_text(lar_bench_report *report, const char *name, const char *text);
void lar_bench_set_number(lar_bench_report *report, const char *name, double value);
lar_bench_figure *lar_bench_add(lar_bench_report *report, const char *unit, double value,
                                bool judged, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

typedef struct lar_baseline lar_baseline;

/* Reads the file; fails with a sentence when it is none of a benchmark. */
lar_status lar_baseline_open(const char *path, lar_baseline **baseline, lar_error *error);
void lar_baseline_close(lar_baseline *baseline);

/* Fails when the file is of another benchmark or other settings than the report (figures may still
 * be missing). */
lar_status lar_baseline_match(const lar_baseline *baseline, const lar_bench_report *report,
                              lar_error *error);

/* A number or text of the file by its path, as in "machine.cpu", cut to text[size]; false: it is
 * not there. */
bool lar_baseline_text(const lar_baseline *baseline, const char *path, char *text, size_t size);

/* Of one figure. */
typedef struct lar_comparison {
    bool known;     /* the earlier run has it; nothing below is set otherwise */
    double earlier; /* its value then */
    double ratio;   /* now / then; 0: there is none, the earlier is 0 */
    double worse;   /* by so many per cent; below 0: better; 0 where it cannot be said */
    bool failed;    /* judged, and worse by more than the tolerance, or worse than nothing */
} lar_comparison;

lar_comparison lar_baseline_compare(const lar_baseline *baseline, const lar_bench_figure *figure,
                                    double tolerance);

/* The name of the first figure that the file judges and the report lacks; false: there is none. */
bool lar_baseline_missing(const lar_baseline *baseline, const lar_bench_report *report,
                          char name[LAR_BENCH_TEXT]);

#endif
