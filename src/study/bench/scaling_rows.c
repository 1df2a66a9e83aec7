#include "study/bench/scaling_rows.h"

#include <stdlib.h>
#include <string.h>

#include "comm/comm.h"
#include "divide/grid_choice.h"
#include "model/model.h"

static const char NONE[] = "none", THREADS[] = "threads";

/* ---- lists ---------------------------------------------------------------------------------- */

/* The next word of a list, "a,b,c"; false at its end. An empty word is a word. */
static bool next_word(const char **list, char *word, size_t room) {
    if (!*list) return false;
    size_t length = strcspn(*list, ",");
    size_t kept = length < room ? length : room - 1;
    memcpy(word, *list, kept);
    word[kept] = '\0';
    *list = (*list)[length] ? *list + length + 1 : NULL;
    return true;
}

static lar_status read_count(const char *word, int32_t most, const char *what, int32_t *count,
                             lar_error *error) {
    char *end;
    long value = strtol(word, &end, 10);
    if (end == word || *end || value < 1 || value > most)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s are no number of %s from 1 to %d; give a list such as 1,2,4",
                        *word ? word : "blanks", what, (int)most);
    *count = (int32_t)value;
    return LAR_OK;
}

/* ---- rows ----------------------------------------------------------------------------------- */

static lar_status add_row(lar_bench_scaling_result *r, const char *grid, int32_t processors,
                          int32_t threads, const char *comm, const char *missing,
                          lar_error *error) {
    if (r->rows == LAR_BENCH_SCALING_ROWS)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "more than %d ways side by side; give shorter lists",
                        LAR_BENCH_SCALING_ROWS);
    lar_bench_scaling_row *row = &r->row[r->rows++];
    *row = (lar_bench_scaling_row){
        .comm = comm, .processors = processors, .threads = threads, .missing = missing};
    strcpy(row->grid, grid);
    return LAR_OK;
}

static bool find_backend(const char *name, lar_comm_backend_info *info) {
    for (int i = 0; lar_comm_backend_list(i, info); i++)
        if (strcmp(info->name, name) == 0) return true;
    return false;
}

static const char *why_missing(const lar_comm_backend_info *info, int32_t launched) {
    if (info->missing) return info->missing;
    if (launched > 1 && info->start == LAR_COMM_BY_TEAM)
        return "mpirun has started processes; without it threads are measured";
    if (launched == 1 && info->start == LAR_COMM_BY_LAUNCHER)
        return "mpirun -n N lariat bench scaling measures it";
    return NULL;
}

/* One grid: with a schedule only, or by every way to communicate. */
static lar_status add_grid(const lar_bench_scaling_options *options, const lar_grid *grid,
                           int32_t launched, lar_bench_scaling_result *r, lar_error *error) {
    char text[LAR_GRID_TEXT], word[32];
    const char *list = options->comm ? options->comm : launched > 1 ? "mpi" : "threads,shm";
    lar_status status = LAR_OK;
    lar_comm_backend_info info;
    lar_grid_format(grid, text);
    if (grid->count == 1) return add_row(r, text, 1, 1, THREADS, NULL, error);
    if (launched > 1 && grid->count != launched)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d processes were started for a grid of %d processors; start as many as "
                        "the grid has, or change --grid",
                        (int)launched, (int)grid->count);
    while (!status && next_word(&list, word, sizeof word)) {
        if (!find_backend(word, &info))
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "there is no communication by %s; there are threads, shm, ucx, mpi "
                            "and tcp",
                            word);
        status = add_row(r, text, grid->count, 1, info.name, why_missing(&info, launched), error);
    }
    return status;
}

static lar_status add_grids(const lar_bench_scaling_options *options, int32_t launched,
                            lar_bench_scaling_result *r, lar_error *error) {
    char word[LAR_GRID_TEXT];
    lar_status status = LAR_OK;
    lar_grid grid;
    for (const char *list = options->grids; !status && next_word(&list, word, sizeof word);) {
        status = lar_grid_parse(word, &grid, error);
        if (!status) status = add_grid(options, &grid, launched, r, error);
    }
    return status;
}

static lar_status add_counts(const lar_bench_scaling_options *options, int32_t launched,
                             lar_bench_scaling_result *r, lar_error *error) {
    char word[32];
    lar_status status = LAR_OK;
    lar_grid grid;
    int32_t count = 0;
    for (const char *list = options->processors; !status && next_word(&list, word, sizeof word);) {
        status = read_count(word, LAR_GRID_MOST, "processors", &count, error);
        if (!status && launched > 1 && count > 1) count = launched;
        if (!status) status = lar_grid_cheapest(&options->model->mesh, count, &grid, error);
        if (!status) status = add_grid(options, &grid, launched, r, error);
    }
    return status;
}

lar_status lar_scaling_rows(const lar_bench_scaling_options *options, int32_t launched,
                            lar_bench_scaling_result *r, lar_error *error) {
    enum { THREADS_MOST = 16 };
    char word[32];
    int32_t count = 0;
    lar_status status = add_row(r, NONE, 1, 1, NONE, NULL, error);
    if (!status)
        status = options->grids ? add_grids(options, launched, r, error)
                                : add_counts(options, launched, r, error);
    /* The other processes of mpirun, while they wait, keep cores busy. */
    const char *list = launched > 1 ? NULL : options->threads;
    while (!status && next_word(&list, word, sizeof word)) {
        status = read_count(word, THREADS_MOST, "threads", &count, error);
        if (!status && count > 1) status = add_row(r, "1x1x1", 1, count, THREADS, NULL, error);
    }
    return status;
}

bool lar_scaling_by_processes(const lar_bench_scaling_row *row) {
    return strcmp(row->comm, NONE) != 0 && strcmp(row->comm, THREADS) != 0;
}
