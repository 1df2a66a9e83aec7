/* The answer of a fit for machines: what `lariat fit --json` prints and fit.json holds. */
#ifndef LAR_STUDY_INVERSE_JSON_H
#define LAR_STUDY_INVERSE_JSON_H

#include <stdio.h>

#include "study/inverse/result.h"

void lar_inverse_json(const lar_inverse_problem *problem, const lar_inverse_result *result,
                      FILE *out);

#endif
