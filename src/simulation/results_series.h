/* Frames of a run and the list of them: NAME_000000.EXTENSION, ... and NAME.pvd.
 *
 * The list names only frames that are there. From the thousandth frame on it may miss the last
 * thousandth of them until it is completed: written anew for each, a long run would spend its time
 * there.
 */
#ifndef LAR_SIMULATION_RESULTS_SERIES_H
#define LAR_SIMULATION_RESULTS_SERIES_H

#include "model/model.h"

typedef struct lar_series {
    char *folder, *name, *list; /* `list`: the path of the .pvd */
    const char *extension;      /* ".vtu" */
    int count;                  /* frames so far */
    int listed;                 /* of them in the file */
    size_t file_capacity, time_capacity;
    char **file; /* [count] names without the folder */
    double *time;
} lar_series;

/* Names are copied, but for the extension. Writes nothing. The caller clears in any case. */
lar_status lar_series_open(lar_series *series, const char *folder, const char *name,
                           const char *extension, lar_error *error);
void lar_series_clear(lar_series *series); /* idempotent; a zeroed one is fine */

/* Of a run that goes on from `time`: takes up the frames of its first part that the list has, up to
 * then, provided that one is of that time, to within half a step: whose state goes on. False: there
 * are none, or no memory for them, and the series stays empty. */
bool lar_series_take_up(lar_series *series, double time, double step);

/* Removes list and frames of an earlier run with this name, 000000 and so on, but for those that
 * were taken up: they would look like those of a run that ends early. Nothing goes when the model
 * was read from one of them. */
lar_status lar_series_forget_earlier(lar_series *series, const lar_model *model, lar_error *error);

/* Where the next frame goes; NULL without memory. The caller frees it. */
char *lar_series_next(const lar_series *series);
/* The next frame has been written: it belongs to the series now. */
lar_status lar_series_add(lar_series *series, double time, lar_error *error);
/* Lists frames that are not listed yet. Failure is told once: it is not tried again. */
lar_status lar_series_complete(lar_series *series, lar_error *error);

/* LAR_ERROR_IO when a result would overwrite what the model was read from: it may have been read
 * from results of an earlier run there, or a link may lead to it. */
lar_status lar_results_spare(const char *path, const lar_model *model, lar_error *error);

#endif
