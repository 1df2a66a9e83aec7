#include "simulation/results_series.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "base/text.h"
#include "model/format/mesh_io.h"

static char *path_with(const lar_series *series, const char *ending) {
    size_t size = strlen(series->name) + strlen(ending) + 1;
    char *name = lar_calloc(size, 1);
    if (!name) return NULL;
    snprintf(name, size, "%s%s", series->name, ending);
    char *path = lar_folder_join(series->folder, name);
    free(name);
    return path;
}

lar_status lar_series_open(lar_series *series, const char *folder, const char *name,
                           const char *extension, lar_error *error) {
    *series = (lar_series){
        .folder = lar_strdup(folder), .name = lar_strdup(name), .extension = extension};
    if (series->folder && series->name) series->list = path_with(series, ".pvd");
    return series->list ? LAR_OK : lar_fail_memory(error, strlen(folder), "the paths of results");
}

void lar_series_clear(lar_series *series) {
    for (int i = 0; i < series->count; i++) free(series->file[i]);
    free(series->file);
    free(series->time);
    free(series->list);
    free(series->name);
    free(series->folder);
    *series = (lar_series){0};
}

static void frame_ending(const lar_series *series, int frame, char ending[32]) {
    snprintf(ending, 32, "_%06d%s", frame, series->extension);
}

static char *frame_path(const lar_series *series, int frame) {
    char ending[32];
    frame_ending(series, frame, ending);
    return path_with(series, ending);
}

char *lar_series_next(const lar_series *series) {
    return frame_path(series, series->count);
}

/* The next frame is there. */
static lar_status append(lar_series *series, double time, lar_error *error) {
    char ending[32];
    frame_ending(series, series->count, ending);
    size_t size = strlen(series->name) + sizeof ending;
    bool room = LAR_GROW(series->file, series->file_capacity, series->count) &&
                LAR_GROW(series->time, series->time_capacity, series->count);
    char *file = room ? lar_calloc(size, 1) : NULL;
    if (!file) return lar_fail_memory(error, size, "a frame's name");
    snprintf(file, size, "%s%s", series->name, ending);
    series->file[series->count] = file;
    series->time[series->count++] = time;
    return LAR_OK;
}

lar_status lar_series_add(lar_series *series, double time, lar_error *error) {
    lar_status status = append(series, time, error);
    if (status) return status;
    if (series->count - series->listed <= series->count / 1000) return LAR_OK;
    return lar_series_complete(series, error);
}

lar_status lar_series_complete(lar_series *series, lar_error *error) {
    if (series->listed == series->count) return LAR_OK;
    series->listed = series->count;
    return lar_pvd_write(series->list, (const char *const *)series->file, series->time,
                         series->count, error);
}

/* ---- earlier runs --------------------------------------------------------------------------- */

/* Of a line of the list that names the next frame; false: it does not, or that is not there. */
static bool read_listed(const lar_series *series, lar_span line, double *time) {
    static const char BEGIN[] = "<DataSet timestep=\"";
    lar_span number, rest;
    char ending[32 + 4];
    frame_ending(series, series->count, ending);
    strcat(ending, "\"/>");
    const size_t begin = sizeof BEGIN - 1, end = strlen(ending);
    if (line.length < begin + end || memcmp(line.at, BEGIN, begin) != 0 ||
        memcmp(line.at + line.length - end, ending, end) != 0)
        return false;
    lar_span_split((lar_span){line.at + begin, line.length - begin}, '"', &number, &rest);
    char *path = frame_path(series, series->count);
    bool there = path && access(path, F_OK) == 0;
    free(path);
    return there && lar_span_double(number, time);
}

bool lar_series_take_up(lar_series *series, double time, double step) {
    lar_bytes bytes;
    lar_span line;
    double at, last = -1;
    if (lar_bytes_read(series->list, &bytes, NULL)) return false;
    lar_text text = lar_text_from(&bytes);
    while (lar_text_line(&text, &line))
        if (read_listed(series, line, &at) && at > last && at < time + 0.5 * step &&
            !append(series, at, NULL))
            last = at;
    lar_bytes_free(&bytes);
    if (last > time - 0.5 * step) return true;
    while (series->count > 0) free(series->file[--series->count]);
    return false;
}

static lar_status remove_file(const char *path, lar_error *error) {
    lar_status status = lar_file_replaceable(path, error);
    if (status) return status;
    if (unlink(path) == 0 || errno == ENOENT) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: is of an earlier run and cannot be removed: %s; check the folder and its "
                    "permissions, or choose another one",
                    path, strerror(errno));
}

/* Looks whether `frame` may go, or removes it. *there: it was. */
static lar_status forget_frame(const lar_series *series, int frame, const lar_model *model,
                               bool removes, bool *there, lar_error *error) {
    struct stat file;
    char *path = frame_path(series, frame);
    if (!path) return lar_fail_memory(error, 64, "a frame's name");
    *there = lstat(path, &file) == 0;
    lar_status status = LAR_OK;
    if (*there) status = removes ? remove_file(path, error) : lar_results_spare(path, model, error);
    free(path);
    return status;
}

lar_status lar_series_forget_earlier(lar_series *series, const lar_model *model, lar_error *error) {
    lar_status status = LAR_OK;
    for (int removes = 0; removes < 2; removes++) {
        if (removes)
            status = series->count > 0 ? lar_series_complete(series, error)
                                       : remove_file(series->list, error);
        bool there = true;
        for (int frame = series->count; there && !status; frame++)
            status = forget_frame(series, frame, model, removes, &there, error);
        if (status) return status;
    }
    return LAR_OK;
}

/* ---- what the model was read from ----------------------------------------------------------- */

static bool same_file(const struct stat *file, const char *path) {
    struct stat other;
    return path && stat(path, &other) == 0 && file->st_dev == other.st_dev &&
           file->st_ino == other.st_ino;
}

lar_status lar_results_spare(const char *path, const lar_model *model, lar_error *error) {
    struct stat file;
    if (stat(path, &file) != 0) return LAR_OK;
    bool mesh = same_file(&file, model->mesh.source);
    for (int i = 0; i < model->mesh_file_count; i++)
        mesh = mesh || same_file(&file, model->mesh_file[i]);
    if (!mesh && !same_file(&file, model->embedded.surface.source)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: is the %s of this model and will not be overwritten by results; choose "
                    "another folder for the results",
                    path, mesh ? "mesh" : "embedded surface");
}
