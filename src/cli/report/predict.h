/* What lariat predict prints: tables for people, JSON for machines. */
#ifndef LAR_CLI_REPORT_PREDICT_H
#define LAR_CLI_REPORT_PREDICT_H

#include "base/json/write.h"
#include "study/predict/predict_check.h"

typedef struct predict_report {
    const lar_cluster *machine;
    const char *scheme, *channels;
    const lar_prediction *prediction;
    const lar_predict_check *check; /* or NULL */
} predict_report;

void predict_report_json(const predict_report *report);
void predict_report_print(const predict_report *report);

/* One line per machine and number. */
void predict_machines_json(void);
void predict_machines_print(void);

typedef struct predict_scaling {
    const lar_cluster *machine;
    int32_t threads, rows;
    int schemes[LAR_PREDICT_SCHEMES], scheme_count;
    const int32_t *processors;       /* [rows] */
    const lar_block_prediction *row; /* [rows * scheme_count] */
} predict_scaling;

void predict_scaling_json(const predict_scaling *scaling);
void predict_scaling_print(const predict_scaling *scaling);

void predict_critical_json(const lar_critical_options *options, const lar_critical *critical);
void predict_critical_print(const lar_critical_options *options, const lar_critical *critical);

#endif
