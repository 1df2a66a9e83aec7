/* probes.csv: a column for each probed value, one line per frame.
 *
 *     time [s],fundus x [m],fundus y [m],fundus z [m],cervix x [N],cervix y [N],cervix z [N]
 *     0,0,0,0,0,0,0
 *
 * Every line reaches the file in one piece: what a full disk cuts off is taken back.
 */
#ifndef LAR_SIMULATION_RESULTS_PROBE_H
#define LAR_SIMULATION_RESULTS_PROBE_H

#include "simulation/simulation.h"

typedef struct lar_probe_file {
    char *path;
    int descriptor; /* -1: not open */
    long long size; /* bytes of whole lines */
} lar_probe_file;

/* Whether a file that is there begins with the line that this model's would: else LAR_ERROR_IO. */
lar_status lar_probe_file_fits(const char *path, const lar_model *model, lar_error *error);

/* Makes the file new, with its header; or, where there are lines of it, goes on behind those up to
 * `until` (-1: none). Takes ownership of `path`, also on failure; the caller closes in any case. */
lar_status lar_probe_file_open(lar_probe_file *file, char *path, const lar_model *model,
                               double until, lar_error *error);

/* Adds the line of the present state. */
lar_status lar_probe_file_add(lar_probe_file *file, const lar_simulation *simulation,
                              lar_error *error);

/* Idempotent. */
lar_status lar_probe_file_close(lar_probe_file *file, lar_error *error);

#endif
