/* What `lariat fit` says. */
#ifndef LAR_CLI_REPORT_FIT_H
#define LAR_CLI_REPORT_FIT_H

#include <stdio.h>

#include "study/inverse/inverse.h"

void fit_report_table(const lar_inverse_problem *problem, const lar_inverse_result *result,
                      FILE *out);

#endif
