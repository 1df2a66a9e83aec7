/* What lariat requirements prints. */
#ifndef LAR_CLI_REPORT_REQUIREMENTS_H
#define LAR_CLI_REPORT_REQUIREMENTS_H

#include "study/requirements/requirements.h"

typedef struct requirements_report {
    const char *title;         /* of the model; NULL: there is none, only the thesis's quantities */
    const lar_requirements *r; /* without a model only `quantities` */
    bool thesis;               /* with the thesis's numbers beside ours */
} requirements_report;

void requirements_print(const requirements_report *report);
void requirements_write_json(const requirements_report *report);

#endif
