/* How a model is divided: from what the user asked for to schedules (T 6.7, fig. 6.16).
 *
 *     grid --> distribution (cut, searched, METIS, random, a file) --> schedules
 *                                                         a folder of schedule files --^
 */
#ifndef LAR_PARALLEL_DIVISION_H
#define LAR_PARALLEL_DIVISION_H

#include "divide/schedule/schedule.h"
#include "lariat.h"

typedef struct lar_division {
    lar_grid grid;
    lar_schedule_set schedules;
    int32_t *reporter;  /* [nodes] the processor that accounts for a node: the first that has it */
    int32_t *recoverer; /* [elements] the processor that recovers an element */
    int32_t *distance;  /* [processors * processors] steps that two can be apart (T 6.5.2) */
    int32_t spread;     /* the greatest of them */
} lar_division;

/* What they say of threads, scheme and channels; an error names the word that is none. */
lar_status lar_division_options(const lar_options *options, lar_schedule_options *out,
                                lar_error *error);

/* Whether a distribution is a file's path: not NULL, and not the name of a way to make one. */
bool lar_distribution_is_file(const char *distribution);

/* From the parallel part of lar_options. Schedules from files are proved before they are used. */
lar_status lar_division_create(const lar_model *model, const lar_options *options,
                               lar_division *division, lar_error *error);
/* From a distribution, with what the options of another division said of schedules. */
lar_status lar_division_from(const lar_model *model, const lar_distribution *distribution,
                             const lar_schedule_options *wanted, lar_division *division,
                             lar_error *error);
void lar_division_destroy(lar_division *division); /* idempotent */

#endif
