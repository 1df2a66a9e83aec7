/* The file of `lariat fit` (docs/formats.md): read and checked, with the scenes and tables that it
 * names. */
#ifndef LAR_STUDY_INVERSE_EXPERIMENT_H
#define LAR_STUDY_INVERSE_EXPERIMENT_H

#include "study/inverse/problem.h"

/* Into a zeroed one; the caller clears in any case. */
lar_status lar_inverse_problem_read(const char *path, lar_inverse_problem *problem,
                                    lar_error *error);

#endif
