#include "simulation/results_surface.h"

#include <stdlib.h>
#include <string.h>

/* Of the series; the frames of the mesh have `taken` theirs. */
static const char *name_beside(const char *taken) {
    return strcmp(taken, "surface") == 0 ? "fine_surface" : "surface";
}

lar_status lar_surface_results_forget_earlier(lar_surface_results *results, const char *folder,
                                              const char *taken, const lar_simulation *going_on,
                                              const lar_model *model, lar_error *error) {
    lar_series other = {0}, *series = results->series.list ? &results->series : &other;
    lar_status status = LAR_OK;
    if (series == &other)
        status = lar_series_open(series, folder, name_beside(taken), ".vtp", error);
    if (!status && going_on)
        lar_series_take_up(series, lar_simulation_time(going_on),
                           lar_simulation_time_step(going_on));
    if (!status) status = lar_series_forget_earlier(series, model, error);
    lar_series_clear(&other);
    return status;
}

lar_status lar_surface_results_open(lar_surface_results *results, const char *folder,
                                    const char *taken, const lar_model *model, lar_error *error) {
    *results = (lar_surface_results){0};
    if (!lar_model_embedded(model, NULL)) return LAR_OK;
    lar_triangles *placed = &results->placed;
    *placed = model->embedded.surface;
    size_t vertices = (size_t)placed->vertex_count, nodes = (size_t)model->mesh.node_count;
    placed->vertex = lar_calloc(vertices, sizeof *placed->vertex);
    results->u = lar_calloc(nodes, sizeof *results->u);
    if (!placed->vertex || !results->u)
        return lar_fail_memory(error, 24 * (vertices + nodes),
                               "the places of the embedded surface");
    return lar_series_open(&results->series, folder, name_beside(taken), ".vtp", error);
}

lar_status lar_surface_results_add(lar_surface_results *results, const lar_simulation *simulation,
                                   lar_error *error) {
    const lar_model *model = simulation->domain.model;
    if (!results->series.list) return LAR_OK;
    char *path = lar_series_next(&results->series);
    if (!path) return lar_fail_memory(error, 64, "a frame's name");
    lar_status status = lar_results_spare(path, model, error);
    if (!status) {
        lar_simulation_displacements(simulation, results->u);
        lar_model_embedded_move(model, (const double(*)[3])results->u, results->placed.vertex);
        status = lar_vtp_write_small(path, &results->placed, error);
    }
    free(path);
    if (status) return status;
    return lar_series_add(&results->series, lar_simulation_time(simulation), error);
}

lar_status lar_surface_results_close(lar_surface_results *results, lar_error *error) {
    lar_status status = lar_series_complete(&results->series, error);
    lar_series_clear(&results->series);
    free(results->placed.vertex);
    free(results->u);
    *results = (lar_surface_results){0};
    return status;
}
