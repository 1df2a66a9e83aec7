/* The file of `lariat fit` (docs/formats.md): read and checked, with the scenes and tables that it
 * names. */
#ifndef LAR_STUDY_INVERSE_EXPERIMENT_H
#define LAR_STUDY_INVERSE_EXPERIMENT_H

#include "base/memory.h"
#include "study/inverse/problem.h"

/* Into a zeroed one; the caller clears in any case. */
lar_status lar_inverse_problem_read(const char *path, lar_inverse_problem *problem,
                                    lar_error *error);

/* The same from memory: `path` is what messages call it, and what it
 * names lies beside that. */
lar_status lar_inverse_problem_parse(const char *path, const lar_bytes *text,
                                     lar_inverse_problem *problem, lar_error *error);

#endif
