/* What `lariat run` says at its end: a table for people, one JSON object for machines. */
#ifndef LAR_CLI_REPORT_RUN_H
#define LAR_CLI_REPORT_RUN_H

#include <stdio.h>

#include "lariat.h"
#include "study/parallel.h"
#include "study/bench/step_clock.h"

typedef struct run_report {
    const char *scene; /* the file */
    const lar_model *model;
    lar_model_info info;
    const char *element; /* kind */
    bool interrupted;
    bool verify; /* steps have verified the schedules */
    const lar_parallel *parallel;
    const char *folder; /* of the results, NULL: none */
    int frames;
    const lar_rest *rest; /* NULL: the run was not to end at rest */
    const lar_simulation *simulation;
    lar_energy began; /* as it was before the first step */
    const lar_step_clock *clock;
    double elapsed; /* wall time from the first step to the last, frames included [s] */
} run_report;

/* Keys: docs/cli.md. */
void run_report_json(const run_report *report, FILE *out);
/* How long steps took [us], in a unit that fits the median. */
void run_report_steps(double p50, double p99, double p999, double longest, FILE *out);
void run_report_table(const run_report *report, FILE *out);

#endif
