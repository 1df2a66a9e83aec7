/* surface_000000.vtp, ... and surface.pvd: the embedded surface, where it is. */
#ifndef LAR_SIMULATION_RESULTS_SURFACE_H
#define LAR_SIMULATION_RESULTS_SURFACE_H

#include "simulation/results_series.h"
#include "simulation/simulation.h"

typedef struct lar_surface_results {
    lar_series series;
    double (*u)[3];       /* [nodes of the model] */
    lar_triangles placed; /* its vertices are its own, the rest is the model's */
} lar_surface_results;

/* Whether or not there will be one again: see lar_series_forget_earlier; with a simulation that
 * goes on, but for lar_series_take_up. */
lar_status lar_surface_results_forget_earlier(lar_surface_results *results, const char *folder,
                                              const char *taken, const lar_simulation *going_on,
                                              const lar_model *model, lar_error *error);

/* Without an embedded surface all of these do nothing. `taken`: the name of the frames of the mesh,
 * which stays theirs. The caller closes in any case. */
lar_status lar_surface_results_open(lar_surface_results *results, const char *folder,
                                    const char *taken, const lar_model *model, lar_error *error);
lar_status lar_surface_results_add(lar_surface_results *results, const lar_simulation *simulation,
                                   lar_error *error);
/* Completes the series. Idempotent. */
lar_status lar_surface_results_close(lar_surface_results *results, lar_error *error);

#endif
