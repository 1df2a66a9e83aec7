/* What `lariat view` says at its end. */
#ifndef LAR_CLI_REPORT_VIEW_H
#define LAR_CLI_REPORT_VIEW_H

#include <stdbool.h>
#include <stdio.h>

#include "lariat.h"
#include "study/parallel.h"

enum { VIEW_DEVICES = 20, VIEW_TOOLS = 20 };

/* A tool that is no hand, and what it had to bear. */
typedef struct view_tool {
    const char *name; /* the simulation's */
    lar_tool_load load;
} view_tool;

/* A tool that has a device. */
typedef struct view_device {
    const char *tool;         /* the simulation's */
    char name[128];           /* as it was attached */
    lar_device_status status; /* of the end; its own name has gone with the session */
} view_device;

typedef struct view_report {
    const char *scene, *url;
    lar_model_info info;
    const lar_parallel *parallel;
    const lar_simulation *simulation; /* after the session */
    lar_session_status status;        /* of the end */
    double pace, elapsed;             /* asked for at the start; [s] */
    int64_t slow_times;               /* that slow motion began */
    lar_slow_cause slow_cause;        /* of the last time */
    int32_t viewers_max;              /* at once */
    int32_t tools;
    view_tool tool[VIEW_TOOLS];
    int32_t devices;
    view_device device[VIEW_DEVICES];
} view_report;

void view_report_json(const view_report *report, FILE *out);
void view_report_table(const view_report *report, FILE *out);

#endif
