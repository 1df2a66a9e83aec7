/* What `lariat view` says at its end. */
#ifndef LAR_CLI_VIEW_REPORT_H
#define LAR_CLI_VIEW_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "lariat.h"
#include "study/parallel.h"

typedef struct view_report {
    const char *scene, *url;
    lar_model_info info;
    const lar_parallel *parallel;
    const lar_simulation *simulation; /* after the session */
    lar_session_status status;        /* of the end */
    double tick, pace, elapsed;       /* [s] simulated, factor asked for at the start, [s] */
    int64_t slow_times;               /* that slow motion began */
    int32_t viewers_most;             /* at once */
} view_report;

void view_report_json(const view_report *report, FILE *out);
void view_report_table(const view_report *report, FILE *out);

#endif
