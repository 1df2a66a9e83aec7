#include "study/parallel.h"

#include <stdlib.h>
#include <string.h>

#include "comm/comm.h"
#include "divide/schedule/file.h"
#include "parallel/division.h"
#include "step/domain.h"
#include "model/model.h"

static lar_status check_comm(const char *name, lar_error *error) {
    lar_comm_backend_info info;
    for (int i = 0; lar_comm_backend_list(i, &info); i++) {
        if (strcmp(info.name, name) != 0) continue;
        if (!info.missing) return LAR_OK;
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "communication by %s: %s", name,
                        info.missing);
    }
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no communication by %s; there are threads, shm, ucx, mpi and tcp",
                    name);
}

static void describe_schedule(const lar_schedule *schedule, lar_grid *grid, lar_parallel *out) {
    *grid = schedule->grid;
    out->threads = schedule->threads;
    out->scheme = lar_scheme_name[schedule->scheme];
    out->channels = lar_channel_use_name[schedule->channels];
}

/* The files of all processors agree with the first, or are refused later. */
static lar_status look_into_schedule(const lar_model *model, const char *folder, lar_grid *grid,
                                     lar_parallel *out, lar_error *error) {
    lar_schedule schedule = {0};
    char *path = lar_schedule_path(folder, 0);
    if (!path) return lar_fail_memory(error, strlen(folder), "a path");
    lar_status status = lar_schedule_read(path, &model->mesh, &schedule, error);
    if (!status) describe_schedule(&schedule, grid, out);
    lar_schedule_clear(&schedule);
    free(path);
    return status;
}

static lar_status find_grid(const lar_model *model, const lar_options *options, lar_grid *grid,
                            lar_error *error) {
    lar_distribution distribution = {0};
    lar_status status;
    if (!options->grid && lar_distribution_is_file(options->distribution)) {
        status = lar_distribution_read(options->distribution, &model->mesh, &distribution, error);
        if (!status) *grid = distribution.grid;
    } else {
        status = lar_grid_parse(options->grid ? options->grid : "1x1x1", grid, error);
        /* Only to hear whether there are elements enough. */
        if (!status) status = lar_distribution_create(&model->mesh, grid, &distribution, error);
    }
    lar_distribution_clear(&distribution);
    return status;
}

lar_status lar_parallel_find(const lar_model *model, const lar_options *options, lar_parallel *out,
                             lar_error *error) {
    lar_parallel found = {.processors = 1,
                          .threads = options->threads > 1 ? options->threads : 1,
                          .grid = "1x1x1",
                          .scheme = "none",
                          .channels = "none",
                          .comm = "none",
                          .reason = ""};
    found.divided = lar_division_asked(options);
    lar_status status = LAR_OK;
    if (found.divided) {
        lar_grid grid;
        found.scheme = options->scheme ? options->scheme : lar_scheme_name[0];
        found.channels = options->channels ? options->channels : lar_channel_use_name[0];
        found.comm = options->comm ? options->comm : "threads";
        status = check_comm(found.comm, error);
        if (!status && options->schedules)
            status = look_into_schedule(model, options->schedules, &grid, &found, error);
        else if (!status)
            status = find_grid(model, options, &grid, error);
        if (status) return status;
        lar_grid_format(&grid, found.grid);
        found.processors = grid.count;
    }
    *out = found;
    return status;
}

lar_status lar_parallel_check_environment(lar_error *error) {
    const char *asked = getenv("LARIAT_GRID");
    lar_grid grid;
    lar_error why;
    if (!asked || !*asked || strcmp(asked, "auto") == 0) return LAR_OK;
    if (!lar_grid_parse(asked, &grid, &why)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "LARIAT_GRID: %s", why.message);
}
