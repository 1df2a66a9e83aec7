/* What `lariat info` says of a model. */
#ifndef LAR_CLI_REPORT_INFO_H
#define LAR_CLI_REPORT_INFO_H

#include "cli/report/mesh_quality.h"

typedef struct info_report {
    const char *path;
    const lar_model *model;
    lar_model_info info;
    lar_mesh_quality quality;
    bool timed; /* the speed was asked for */
    cli_speed speed;
} info_report;

void info_report_table(const info_report *report);
void info_report_json(const info_report *report);

#endif
