#include "simulation/results_probe.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "step/measure.h"

static lar_status fail_to(const lar_probe_file *file, const char *verb, int cause,
                          lar_error *error) {
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: cannot be %s: %s; check the folder, its permissions and the free space",
                    file->path, verb, strerror(cause));
}

/* ---- lines ------------------------------------------------------------------------------ */

/* A CSV field after RFC 4180: quoted when it holds a separator, a quote or a line end. */
static void print_name(FILE *line, const char *name, char axis, const char *unit) {
    bool quote = strpbrk(name, ",;\"\r\n") != NULL;
    if (quote) fputc('"', line);
    for (const char *c = name; *c; c++) {
        if (*c == '"') fputc('"', line);
        fputc(*c, line);
    }
    fprintf(line, " %c [%s]", axis, unit);
    if (quote) fputc('"', line);
}

static void print_header(FILE *line, const lar_model *model) {
    fprintf(line, "time [s]");
    for (int i = 0; i < model->output.probe_count; i++) {
        const lar_probe *probe = &model->output.probe[i];
        for (char axis = 'x'; axis <= 'z'; axis++) {
            fputc(',', line);
            print_name(line, probe->name ? probe->name : "probe", axis,
                       probe->what == LAR_PROBE_REACTION ? "N" : "m");
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

static lar_status print_values(FILE *line, const lar_simulation *simulation, lar_error *error) {
    const lar_output *output = &simulation->domain.model->output;
    fprintf(line, "%.10g", lar_simulation_time(simulation));
    for (int i = 0; i < output->probe_count; i++) {
        const lar_probe *probe = &output->probe[i];
        double value[3];
        lar_status status = LAR_OK;
        if (probe->what == LAR_PROBE_REACTION)
            status = lar_measure_reaction(&simulation->domain, &simulation->scratch->measure,
                                          &simulation->state, &probe->nodes, false, value, error);
        else
            mean_displacement(simulation, &probe->nodes, value);
        if (status) return status;
        fprintf(line, ",%.17g,%.17g,%.17g", value[0], value[1], value[2]);
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

/* The header (without a simulation) or a line of values. */
static lar_status add_line(lar_probe_file *file, const lar_model *model,
                           const lar_simulation *simulation, lar_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *line = open_memstream(&text, &size);
    lar_status status = line ? LAR_OK : lar_fail_memory(error, BUFSIZ, "a line of probes.csv");
    if (line) {
        locale_t before = uselocale(lar_text_locale());
        if (simulation)
            status = print_values(line, simulation, error);
        else
            print_header(line, model);
        uselocale(before);
        bool complete = !ferror(line);
        /* glibc 2.36 says nothing when it has no memory for the text at the end. */
        if ((fclose(line) != 0 || !complete || !text || size == 0) && !status)
            status = lar_fail_memory(error, size, "a line of probes.csv");
    }
    if (!status) status = append(file, text, size, error);
    (free)(text); /* the C library's own */
    return status;
}

/* ---- the file --------------------------------------------------------------------------- */

lar_status lar_probe_file_open(lar_probe_file *file, char *path, const lar_model *model,
                               lar_error *error) {
    *file = (lar_probe_file){.path = path, .descriptor = -1};
    if (!path) return lar_fail_memory(error, 1, "the path of probes.csv");
    /* A pipe without a reader is an error, nothing to wait for; one with a reader may be slow. */
    file->descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, 0666);
    if (file->descriptor >= 0) fcntl(file->descriptor, F_SETFL, O_WRONLY);
    if (file->descriptor < 0) return fail_to(file, "opened for writing", errno, error);
    return add_line(file, model, NULL, error);
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
