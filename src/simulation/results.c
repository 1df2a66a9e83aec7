/* Results in a folder: frames NAME_000000.vtu, ... , the series NAME.pvd and probes.csv; where the
 * model has an embedded surface also that, when it is asked for (results_surface.h).
 *
 * After every frame the folder can be opened as it is: frames and series appear whole (written
 * beside and renamed). Positions are those of the reference; the point array "displacement"
 * moves them (ParaView: Warp By Vector). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "base/text.h"
#include "simulation/results_probe.h"
#include "simulation/results_surface.h"
#include "simulation/simulation.h"
#include "model/format/mesh_io.h"

struct lar_results {
    const lar_model *model;
    lar_series series;
    lar_surface_results surface;
    double (*displacement)[3], (*velocity)[3]; /* NULL when not asked for */
    double (*traction)[3], *contact_pressure;  /* the same, both */
    double *cell[LAR_CELL_FIELDS];             /* the same */
    int families;                              /* of fibres that are written */
    double (*fibre[2])[3], *stretch[2];        /* along what they run now, and how long: or NULL */
    lar_probe_file probes;
    int lock;      /* on the folder (base/file/folder.h) */
    pid_t process; /* that has it */
};

/* ---- opening and closing ---------------------------------------------------------------- */

/* The model's file without folder and extension. */
static char *series_name(const lar_model *model) {
    const char *source = lar_model_source(model);
    const char *slash = strrchr(source, '/');
    const char *base = slash ? slash + 1 : source;
    const char *dot = strrchr(base, '.');
    return lar_strndup(base, dot && dot > base ? (size_t)(dot - base) : strlen(base));
}

/* The list of frames is XML, in UTF-8 and without control characters: it must name the files. */
static lar_status check_name(const char *name, lar_error *error) {
    const unsigned char *at = (const unsigned char *)name;
    for (size_t left = strlen(name); left > 0;) {
        int bytes = *at < ' ' ? 0 : lar_utf8_length(at, left);
        if (bytes == 0)
            return lar_fail(error, LAR_ERROR_IO,
                            "results are called after the scene's file, whose name has %s; a .pvd "
                            "could not list them: rename the file",
                            *at < ' ' ? "a line end or another control character"
                                      : "characters that are no UTF-8");
        at += bytes;
        left -= (size_t)bytes;
    }
    return LAR_OK;
}

/* Where fibres are asked for and there are some. */
static bool prepare_fibres(lar_results *results, const lar_model *model) {
    const lar_gid elements = model->mesh.element_count;
    const unsigned fields = model->output.fields;
    if (!(fields & (LAR_OUTPUT_FIBRES | LAR_OUTPUT_STRETCH))) return true;
    for (lar_gid e = 0; e < elements && results->families < 2; e++) {
        int32_t here = lar_model_element_fibres(model, e, NULL);
        if (here > results->families) results->families = here;
    }
    bool complete = true;
    for (int k = 0; k < results->families; k++) {
        if (fields & LAR_OUTPUT_FIBRES)
            results->fibre[k] = lar_calloc((size_t)elements, sizeof *results->fibre[k]);
        if (fields & LAR_OUTPUT_STRETCH)
            results->stretch[k] = lar_calloc((size_t)elements, sizeof *results->stretch[k]);
        complete = complete && (results->fibre[k] || !(fields & LAR_OUTPUT_FIBRES)) &&
                   (results->stretch[k] || !(fields & LAR_OUTPUT_STRETCH));
    }
    return complete;
}

static lar_status prepare_arrays(lar_results *results, const lar_model *model, lar_error *error) {
    unsigned fields = model->output.fields;
    size_t nodes = (size_t)model->mesh.node_count, elements = (size_t)model->mesh.element_count;
    bool complete = true;
    if (fields & LAR_FIELD_DISPLACEMENT) {
        results->displacement = lar_calloc(nodes, sizeof *results->displacement);
        complete = complete && results->displacement;
    }
    if (fields & LAR_FIELD_VELOCITY) {
        results->velocity = lar_calloc(nodes, sizeof *results->velocity);
        complete = complete && results->velocity;
    }
    if (fields & LAR_OUTPUT_CONTACT) {
        results->traction = lar_calloc(nodes, sizeof *results->traction);
        results->contact_pressure = lar_calloc(nodes, sizeof *results->contact_pressure);
        complete = complete && results->traction && results->contact_pressure;
    }
    for (int i = 0; i < LAR_CELL_FIELDS; i++)
        if (fields & lar_cell_field_table[i].bit) {
            results->cell[i] = lar_calloc(elements * (size_t)lar_cell_field_table[i].components,
                                          sizeof *results->cell[i]);
            complete = complete && results->cell[i];
        }
    complete = complete && prepare_fibres(results, model);
    return complete ? LAR_OK
                    : lar_fail_memory(error, 48 * nodes + 200 * elements, "the fields of a frame");
}

/* What the folder has of an earlier run goes, or, where `going_on` is that one, what is later than
 * the state that it goes on from. Then *until is how far its lines stay. */
static lar_status clear_folder(lar_results *results, const char *folder, const char *name,
                               const lar_simulation *going_on, const char *probes, double *until,
                               lar_error *error) {
    const lar_model *model = results->model;
    double step = going_on ? lar_simulation_time_step(going_on) : 0;
    double time = going_on ? lar_simulation_time(going_on) : 0;
    bool stays = going_on && lar_series_take_up(&results->series, time, step);
    lar_status status = stays ? lar_probe_file_fits(probes, model, error) : LAR_OK;
    if (stays) *until = time + 0.5 * step;
    if (!status) status = lar_series_forget_earlier(&results->series, model, error);
    return status ? status
                  : lar_surface_results_forget_earlier(&results->surface, folder, name,
                                                       stays ? going_on : NULL, model, error);
}

static lar_status open_folder(lar_results *results, const char *folder,
                              const lar_simulation *going_on, bool surface, lar_error *error) {
    const lar_model *model = results->model;
    char *name = series_name(model), *probes = lar_folder_join(folder, "probes.csv");
    double until = -1;
    lar_status status =
        name && probes ? LAR_OK : lar_fail_memory(error, strlen(folder), "the paths of results");
    if (!status) status = check_name(name, error);
    if (!status) status = lar_series_open(&results->series, folder, name, ".vtu", error);
    if (!status && (surface || model->output.surface))
        status = lar_surface_results_open(&results->surface, folder, name, model, error);
    if (!status) status = lar_folder_make(folder, error);
    if (!status) status = lar_folder_lock(folder, &results->lock, error);
    if (!status) status = clear_folder(results, folder, name, going_on, probes, &until, error);
    free(name);
    if (!status) status = prepare_arrays(results, model, error);
    if (!status) status = lar_results_spare(probes, model, error);
    if (!status) return lar_probe_file_open(&results->probes, probes, model, until, error);
    free(probes);
    return status;
}

static lar_status open_results(const char *folder, const lar_simulation *simulation, bool going_on,
                               bool surface, lar_results **results, lar_error *error) {
    if (!folder || !*folder || !simulation || !results)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_results_open needs a folder, a simulation and a place for the "
                        "results; none may be NULL or empty");
    lar_results *made = lar_calloc(1, sizeof *made);
    if (!made) return lar_fail_memory(error, sizeof *made, "the results");
    made->model = simulation->domain.model;
    made->probes.descriptor = made->lock = -1;
    made->process = getpid();
    lar_status status = open_folder(made, folder, going_on ? simulation : NULL, surface, error);
    if (status)
        lar_results_close(made, NULL);
    else
        *results = made;
    return status;
}

lar_status lar_results_open(const char *folder, const lar_simulation *simulation,
                            lar_results **results, lar_error *error) {
    return open_results(folder, simulation, false, false, results, error);
}

lar_status lar_results_open_surface(const char *folder, const lar_simulation *simulation,
                                    lar_results **results, lar_error *error) {
    return open_results(folder, simulation, false, true, results, error);
}

lar_status lar_results_resume(const char *folder, const lar_simulation *simulation, int surface,
                              lar_results **results, lar_error *error) {
    return open_results(folder, simulation, true, surface, results, error);
}

int lar_results_frames(const lar_results *results) {
    return results ? results->series.count : 0;
}

/* The last of all: nobody else writes there before. */
static void let_go(const lar_results *results) {
    if (results->process == getpid())
        lar_folder_unlock(results->lock);
    else if (results->lock >= 0)
        close(results->lock);
}

lar_status lar_results_close(lar_results *results, lar_error *error) {
    if (!results) return LAR_OK;
    lar_status status = lar_series_complete(&results->series, error);
    lar_error later;
    lar_status closed = lar_surface_results_close(&results->surface, &later);
    if (!status && closed) status = lar_fail(error, closed, "%s", later.message);
    closed = lar_probe_file_close(&results->probes, &later);
    if (!status && closed) status = lar_fail(error, closed, "%s", later.message);
    for (int i = 0; i < LAR_CELL_FIELDS; i++) free(results->cell[i]);
    for (int k = 0; k < 2; k++) {
        free(results->fibre[k]);
        free(results->stretch[k]);
    }
    lar_series_clear(&results->series);
    free(results->displacement);
    free(results->velocity);
    free(results->traction);
    free(results->contact_pressure);
    let_go(results);
    free(results);
    return status;
}

/* ---- a frame ---------------------------------------------------------------------------- */

static void measure_cells(lar_results *results, const lar_simulation *simulation) {
    unsigned wanted = 0;
    for (int i = 0; i < LAR_CELL_FIELDS; i++) wanted |= results->cell[i] ? 1U << i : 0;
    if (!wanted) return;
    const lar_state state = lar_state_measured(simulation);
    for (lar_gid e = 0; e < simulation->domain.model->mesh.element_count; e++) {
        double value[LAR_CELL_FIELDS][6];
        lar_element_fields(&simulation->domain, &state, e, wanted, value);
        for (int i = 0; i < LAR_CELL_FIELDS; i++) {
            int components = lar_cell_field_table[i].components;
            for (int k = 0; results->cell[i] && k < components; k++)
                results->cell[i][components * e + k] = value[i][k];
        }
    }
}

/* F a: along the fibres as they are now, as long as they are stretched. */
static void turn_fibres(lar_results *results, const lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    for (lar_gid e = 0; results->families > 0 && e < domain->model->mesh.element_count; e++) {
        double F[3][3], fibre[2][3];
        lar_model_element_fibres(domain->model, e, fibre);
        lar_element_gradient(domain, &simulation->state, e, F);
        for (int k = 0; k < results->families; k++) {
            double now[3];
            for (int i = 0; i < 3; i++)
                now[i] = F[i][0] * fibre[k][0] + F[i][1] * fibre[k][1] + F[i][2] * fibre[k][2];
            if (results->fibre[k]) memcpy(results->fibre[k][e], now, sizeof now);
            if (results->stretch[k])
                results->stretch[k][e] = sqrt(now[0] * now[0] + now[1] * now[1] + now[2] * now[2]);
        }
    }
}

static lar_status check_finite(const lar_simulation *simulation, lar_error *error) {
    const lar_domain *domain = &simulation->domain;
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) {
            size_t at = lar_state_at(&simulation->state, domain->layout.local[g], i);
            if (!isfinite(simulation->state.u[at]) || !isfinite(simulation->state.v[at]))
                return lar_fail(error, LAR_ERROR_UNSTABLE,
                                "node %lld has left the range of numbers; this state is not "
                                "written, the frames before it are good; use a smaller time step, "
                                "or slower or smaller loads and motions",
                                (long long)domain->model->mesh.node_id[g]);
        }
    return LAR_OK;
}

static lar_status write_frame(lar_results *results, const lar_simulation *simulation,
                              const char *path, lar_error *error) {
    static const char *const fibre_name[] = {"fibre_now", "fibre2_now"};
    static const char *const stretch_name[] = {"fibre_stretch", "fibre2_stretch"};
    lar_vtu_array point[4], cell[LAR_CELL_FIELDS + 4];
    lar_vtu_frame frame = {.mesh = &simulation->domain.model->mesh,
                           .point_array = point,
                           .cell_array = cell,
                           .time = lar_simulation_time(simulation)};
    if (results->displacement) {
        lar_simulation_displacements(simulation, results->displacement);
        point[frame.point_array_count++] =
            (lar_vtu_array){"displacement", 3, &results->displacement[0][0]};
    }
    if (results->velocity) {
        lar_simulation_velocities(simulation, results->velocity);
        point[frame.point_array_count++] = (lar_vtu_array){"velocity", 3, &results->velocity[0][0]};
    }
    if (results->traction) {
        lar_status status = lar_simulation_contact_pressure(simulation, results->traction,
                                                            results->contact_pressure, error);
        if (status) return status;
        point[frame.point_array_count++] =
            (lar_vtu_array){"contact_traction", 3, &results->traction[0][0]};
        point[frame.point_array_count++] =
            (lar_vtu_array){"contact_pressure", 1, results->contact_pressure};
    }
    measure_cells(results, simulation);
    for (int i = 0; i < LAR_CELL_FIELDS; i++)
        if (results->cell[i])
            cell[frame.cell_array_count++] = (lar_vtu_array){
                lar_cell_field_table[i].name, lar_cell_field_table[i].components, results->cell[i]};
    turn_fibres(results, simulation);
    for (int k = 0; k < results->families; k++) {
        if (results->fibre[k])
            cell[frame.cell_array_count++] =
                (lar_vtu_array){fibre_name[k], 3, &results->fibre[k][0][0]};
        if (results->stretch[k])
            cell[frame.cell_array_count++] =
                (lar_vtu_array){stretch_name[k], 1, results->stretch[k]};
    }
    return lar_vtu_write(path, &frame, error);
}

/* Writes the frame and puts it at the end of the list; on failure nothing is listed. */
static lar_status add_frame(lar_results *results, const lar_simulation *simulation,
                            lar_error *error) {
    char *path = lar_series_next(&results->series);
    if (!path) return lar_fail_memory(error, 64, "a frame's name");
    lar_status status = lar_results_spare(path, simulation->domain.model, error);
    if (!status) status = write_frame(results, simulation, path, error);
    free(path);
    if (status) return status;
    return lar_series_add(&results->series, lar_simulation_time(simulation), error);
}

lar_status lar_results_add(lar_results *results, const lar_simulation *simulation,
                           lar_error *error) {
    if (!results || !simulation)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_results_add needs results and a simulation; neither may be NULL");
    if (simulation->domain.model != results->model)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "these results are of another model; open some for this simulation");
    lar_status status = lar_simulation_check_zero(simulation, "lar_results_add", error);
    if (!status) lar_simulation_state(simulation);
    if (!status) status = check_finite(simulation, error);
    if (!status) status = add_frame(results, simulation, error);
    if (!status) status = lar_surface_results_add(&results->surface, simulation, error);
    if (!status) status = lar_probe_file_add(&results->probes, simulation, error);
    return status;
}
