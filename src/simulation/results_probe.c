#include "simulation/results_probe.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "base/vector.h"
#include "step/measure.h"

static lar_status fail_to(const lar_probe_file *file, const char *verb, int cause,
                          lar_error *error) {
    return lar_fail(error, LAR_ERROR_IO, "%s: cannot be %s: %s; %s", file->path, verb,
                    strerror(cause), lar_remedy(cause, LAR_FILE_REMEDY));
}

/* ---- lines ------------------------------------------------------------------------------ */

/* A CSV field after RFC 4180: quoted when it holds a separator, a quote or a line end. */
static void print_name(FILE *line, const char *name, const char *what, const char *unit) {
    bool quote = name[strcspn(name, ",;\"\r\n")] != '\0';
    if (quote) fputc('"', line);
    for (const char *c = name; *c; c++) {
        if (*c == '"') fputc('"', line);
        fputc(*c, line);
    }
    fprintf(line, "%s%s [%s]", *what ? " " : "", what, unit);
    if (quote) fputc('"', line);
}

enum { COLUMNS = 9 }; /* of one probe, at most */

/* What a mean is of; nothing where the probe's name says so already, as one that is made does. */
static const char *field_of(const lar_probe *probe) {
    const char *field = lar_cell_field_table[probe->field].name;
    size_t own = probe->name ? strlen(probe->name) : 0, size = strlen(field);
    return own >= size && strcmp(probe->name + own - size, field) == 0 ? "" : field;
}

/* Returns their number; `what` and `unit` of column k. */
static int column_of(const lar_model *model, const lar_probe *probe, int k, char what[32],
                     const char **unit) {
    static const char *const axis[] = {"x", "y", "z"};
    static const char *const component[] = {"xx", "yy", "zz", "xy", "yz", "zx"};
    static const char *const energy[] = {"kinetic", "strain",  "hourglass", "external",
                                         "damping", "contact", "viscous"};
    const lar_cell_field_row *mean = &lar_cell_field_table[probe->field];
    switch (probe->what) {
    case LAR_PROBE_MEAN:
        snprintf(what, 32, "%s%s%s", field_of(probe),
                 mean->components > 1 && *field_of(probe) ? " " : "",
                 mean->components > 1 ? component[k] : "");
        *unit = mean->unit;
        return mean->components;
    case LAR_PROBE_TOOL:
        snprintf(what, 32, "%s%s", k < 3 ? "" : k < 6 ? "force " : "torque ", axis[k % 3]);
        *unit = k < 3 ? "m" : k < 6 ? "N" : "N m";
        return model->tool[probe->tool].shape == LAR_TOOL_RIGID ? 9 : 6;
    case LAR_PROBE_ENERGY:
        snprintf(what, 32, "%s", energy[k]);
        *unit = "J";
        return 7;
    default:
        snprintf(what, 32, "%s%s", k < 3 ? "" : "moment ", axis[k % 3]);
        *unit = probe->what == LAR_PROBE_DISPLACEMENT ? "m" : k < 3 ? "N" : "N m";
        return probe->moment ? 6 : 3;
    }
}

static void print_header(FILE *line, const lar_model *model) {
    fprintf(line, "time [s]");
    for (int i = 0; i < model->output.probe_count; i++) {
        const lar_probe *probe = &model->output.probe[i];
        for (int k = 0, count = 1; k < count; k++) {
            char what[32];
            const char *unit;
            count = column_of(model, probe, k, what, &unit);
            fputc(',', line);
            print_name(line, probe->name ? probe->name : "probe", what, unit);
        }
    }
    fputc('\n', line);
}

static void mean_displacement(const lar_simulation *simulation, const lar_node_list *nodes,
                              double mean[3]) {
    memset(mean, 0, 3 * sizeof *mean);
    for (int32_t i = 0; i < nodes->count; i++) {
        double u[3];
        lar_state_displacement(&simulation->state, simulation->domain.layout.local[nodes->node[i]],
                               u);
        for (int axis = 0; axis < 3; axis++) mean[axis] += u[axis] / nodes->count;
    }
}

/* The mean of a field over elements, by their volumes at rest. */
static void mean_field(const lar_simulation *simulation, const lar_probe *probe, double mean[6]) {
    const lar_domain *domain = &simulation->domain;
    lar_state state = lar_state_measured(simulation);
    double sum[6] = {0}, volume = 0;
    for (int32_t i = 0; i < probe->nodes.count; i++) {
        double corner[8][3], value[LAR_CELL_FIELDS][6];
        lar_gid e = probe->nodes.node[i];
        lar_mesh_corners(&domain->model->mesh, e, corner);
        double part = lar_hexahedron_volume((const double(*)[3])corner);
        lar_element_fields(domain, &state, e, 1U << probe->field, value);
        for (int k = 0; k < 6; k++) sum[k] += part * value[probe->field][k];
        volume += part;
    }
    for (int k = 0; k < 6; k++) mean[k] = sum[k] / volume;
}

static lar_status forces_of(const lar_simulation *simulation, lar_cause cause, int tool,
                            double (*force)[3], lar_error *error) {
    return lar_measure_nodal_forces(&simulation->domain, &simulation->scratch->measure,
                                    &simulation->state, cause, tool, force, error);
}

/* What a cause does to some nodes is added to the sum, and its moments. */
static lar_status add_forces(const lar_simulation *simulation, lar_cause cause,
                             const lar_probe *probe, double sum[6], lar_error *error) {
    const lar_node_list *nodes = &probe->nodes;
    const lar_gid count = simulation->domain.model->mesh.node_count;
    double(*force)[3] = lar_calloc((size_t)count, sizeof *force);
    if (!force)
        return lar_fail_memory(error, (size_t)count * sizeof *force, "the forces of a probe");
    lar_status status = forces_of(simulation, cause, 0, force, error);
    for (int32_t i = 0; !status && i < nodes->count; i++)
        lar_measure_add(&simulation->domain, &simulation->state, nodes->node[i],
                        force[nodes->node[i]], probe->about, sum);
    free(force);
    return status;
}

/* Where a tool is, and the force and torque that tissue begins the next step with on it. */
static lar_status measure_tool(const lar_simulation *simulation, int tool, double value[9],
                               lar_error *error) {
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    lar_tool_pose pose;
    double(*force)[3] = lar_calloc((size_t)mesh->node_count, sizeof *force);
    if (!force)
        return lar_fail_memory(error, (size_t)mesh->node_count * sizeof *force,
                               "the forces of a probe");
    lar_status status = lar_simulation_tool_pose(simulation, tool, &pose, error);
    if (!status) status = forces_of(simulation, LAR_CAUSE_TOOL, tool, force, error);
    for (int axis = 0; !status && axis < 3; axis++) value[axis] = pose.position[axis];
    for (lar_gid n = 0; n < mesh->node_count && !status; n++)
        lar_measure_add(&simulation->domain, &simulation->state, n, force[n], pose.position,
                        value + 3);
    for (int i = 3; i < 9; i++) value[i] = 0.0 - value[i]; /* on the tool; never -0 */
    free(force);
    return status;
}

static void measure_energy(const lar_simulation *simulation, double value[COLUMNS]) {
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    const double all[COLUMNS] = {e.kinetic, e.strain,  e.hourglass, e.external,
                                 e.damping, e.contact, e.viscous};
    memcpy(value, all, sizeof all);
}

static lar_status measure(const lar_simulation *simulation, const lar_probe *probe,
                          double value[COLUMNS], lar_error *error) {
    lar_status status = LAR_OK;
    memset(value, 0, COLUMNS * sizeof *value);
    switch (probe->what) {
    case LAR_PROBE_REACTION: /* a deck that has no mass has none that is stopped at its end */
        return lar_measure_reaction(
            &simulation->domain, &simulation->scratch->measure, &simulation->state, &probe->nodes,
            simulation->domain.model->by_material_time, probe->about, value, error);
    case LAR_PROBE_CONTACT:
        status = add_forces(simulation, LAR_CAUSE_BODIES, probe, value, error);
        return status ? status : add_forces(simulation, LAR_CAUSE_PLANES, probe, value, error);
    case LAR_PROBE_TOOL:
        return measure_tool(simulation, probe->tool, value, error);
    case LAR_PROBE_MEAN:
        mean_field(simulation, probe, value);
        break;
    case LAR_PROBE_ENERGY:
        measure_energy(simulation, value);
        break;
    default:
        mean_displacement(simulation, &probe->nodes, value);
    }
    return status;
}

static lar_status print_values(FILE *line, const lar_simulation *simulation, lar_error *error) {
    const lar_output *output = &simulation->domain.model->output;
    fprintf(line, "%.10g", lar_simulation_time(simulation));
    for (int i = 0; i < output->probe_count; i++) {
        const lar_probe *probe = &output->probe[i];
        double value[COLUMNS];
        lar_status status = measure(simulation, probe, value, error);
        if (status) return status;
        char what[32];
        const char *unit;
        const int count = column_of(simulation->domain.model, probe, 0, what, &unit);
        for (int k = 0; k < count; k++) fprintf(line, ",%.17g", value[k]);
    }
    fputc('\n', line);
    return LAR_OK;
}

/* Appends a line, whole or not at all. */
static lar_status append(lar_probe_file *file, const char *text, size_t size, lar_error *error) {
    for (size_t done = 0; done < size;) {
        ssize_t written = write(file->descriptor, text + done, size - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            int cause = errno;
            if (ftruncate(file->descriptor, file->size) == 0)
                lseek(file->descriptor, file->size, SEEK_SET);
            return fail_to(file, "written", cause, error);
        }
        done += (size_t)written;
    }
    file->size += (long long)size;
    return LAR_OK;
}

/* The header (without a simulation) or a line of values; *text is the C library's own. */
static lar_status print_line(const lar_model *model, const lar_simulation *simulation, char **text,
                             size_t *size, lar_error *error) {
    FILE *line = open_memstream(text, size);
    if (!line) return lar_fail_memory(error, BUFSIZ, "a line of probes.csv");
    lar_status status = LAR_OK;
    locale_t before = uselocale(lar_text_locale());
    if (simulation)
        status = print_values(line, simulation, error);
    else
        print_header(line, model);
    uselocale(before);
    bool complete = !ferror(line);
    /* glibc 2.36 says nothing when it has no memory for the text at the end. */
    if ((fclose(line) != 0 || !complete || !*text || *size == 0) && !status)
        status = lar_fail_memory(error, *size, "a line of probes.csv");
    return status;
}

static lar_status add_line(lar_probe_file *file, const lar_model *model,
                           const lar_simulation *simulation, lar_error *error) {
    char *text = NULL;
    size_t size = 0;
    lar_status status = print_line(model, simulation, &text, &size, error);
    if (!status) status = append(file, text, size, error);
    (free)(text);
    return status;
}

/* ---- going on --------------------------------------------------------------------------- */

lar_status lar_probe_file_fits(const char *path, const lar_model *model, lar_error *error) {
    lar_bytes bytes = {0};
    char *text = NULL;
    size_t size = 0;
    if (lar_bytes_read(path, &bytes, NULL)) return LAR_OK; /* or nobody can write there either */
    lar_status status = print_line(model, NULL, &text, &size, error);
    if (!status && (bytes.size < size || memcmp(bytes.data, text, size) != 0))
        status = lar_fail(error, LAR_ERROR_IO,
                          "%s: has other columns than the probes of this scene, and cannot go on; "
                          "give the scene the same probes again, or choose another folder",
                          path);
    lar_bytes_free(&bytes);
    (free)(text);
    return status;
}

/* How many bytes of the file stay: its header, `kept`, and whole lines up to that time. */
static size_t kept_of(const char *path, size_t kept, double until) {
    lar_bytes bytes;
    lar_span line, time, rest;
    if (lar_bytes_read(path, &bytes, NULL)) return 0;
    const char *begin = (const char *)bytes.data;
    lar_text text = {begin + (kept < bytes.size ? kept : bytes.size), begin + bytes.size, 1};
    if (kept > bytes.size) kept = 0;
    while (kept > 0 && lar_text_line(&text, &line)) {
        double at;
        lar_span_split(line, ',', &time, &rest);
        if (text.at[-1] != '\n' || !lar_span_double(time, &at) || !(at <= until)) break;
        kept = (size_t)(text.at - begin);
    }
    lar_bytes_free(&bytes);
    return kept;
}

static lar_status find_kept(const char *path, const lar_model *model, double until, size_t *kept,
                            lar_error *error) {
    char *header = NULL;
    lar_status status = until >= 0 ? print_line(model, NULL, &header, kept, error) : LAR_OK;
    (free)(header);
    if (!status && *kept > 0) *kept = kept_of(path, *kept, until);
    return status;
}

/* ---- the file --------------------------------------------------------------------------- */

lar_status lar_probe_file_open(lar_probe_file *file, char *path, const lar_model *model,
                               double until, lar_error *error) {
    *file = (lar_probe_file){.path = path, .descriptor = -1};
    if (!path) return lar_fail_memory(error, 1, "the path of probes.csv");
    size_t kept = 0;
    lar_status status = find_kept(path, model, until, &kept, error);
    if (status) return status;
    /* A pipe without a reader is an error, nothing to wait for; one with a reader may be slow. */
    const int fresh = kept > 0 ? 0 : O_TRUNC;
    file->descriptor = open(path, O_WRONLY | O_CREAT | fresh | O_CLOEXEC | O_NONBLOCK, 0666);
    if (file->descriptor >= 0) fcntl(file->descriptor, F_SETFL, O_WRONLY);
    if (file->descriptor < 0) return fail_to(file, "opened for writing", errno, error);
    if (kept == 0) return add_line(file, model, NULL, error);
    file->size = (long long)kept;
    if (ftruncate(file->descriptor, file->size) != 0 ||
        lseek(file->descriptor, file->size, SEEK_SET) < 0)
        return fail_to(file, "written", errno, error);
    return LAR_OK;
}

lar_status lar_probe_file_add(lar_probe_file *file, const lar_simulation *simulation,
                              lar_error *error) {
    return add_line(file, simulation->domain.model, simulation, error);
}

lar_status lar_probe_file_close(lar_probe_file *file, lar_error *error) {
    lar_status status = LAR_OK;
    if (file->path && file->descriptor >= 0 && close(file->descriptor) != 0)
        status = fail_to(file, "closed", errno, error);
    free(file->path);
    *file = (lar_probe_file){.descriptor = -1};
    return status;
}
