/* Writing schedules, and the folder with those of all processors. */
#include "divide/schedule/file.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file/folder.h"
#include "divide/text_file.h"

char *lar_schedule_path(const char *folder, int32_t processor) {
    char name[40];
    snprintf(name, sizeof name, "processor-%04d.schedule", (int)processor);
    return lar_folder_join(folder, name);
}

/* ---- writing ---------------------------------------------------------------------------- */

/* "KEY COUNT  NUMBER ...", nothing without numbers; long lists go on in lines further in. */
static void print_list(FILE *file, int indent, const char *key, const int32_t *array,
                       lar_range span) {
    enum { WIDTH = 100 };
    if (span.count == 0) return;
    int column = fprintf(file, "%*s%s %d ", indent, "", key, (int)span.count);
    for (int32_t i = 0; i < span.count && !ferror(file); i++) {
        char text[16];
        int length = snprintf(text, sizeof text, " %d", (int)array[span.first + i]);
        if (column + length > WIDTH) column = fprintf(file, "\n%*s", indent + 3, "") - 1;
        column += fprintf(file, "%s", text);
    }
    fputc('\n', file);
}

static void print_transfers(FILE *file, const char *key, const lar_schedule *s, lar_range span) {
    for (int32_t i = 0; i < span.count && !ferror(file); i++) {
        const lar_transfer *t = &s->transfer[span.first + i];
        int32_t added = t->vectors.count - t->whole;
        fprintf(file, "  %s %d stage %d offset %" PRId64 "\n", key, (int)t->peer, (int)t->stage,
                t->offset);
        print_list(file, 4, "add", s->vector, (lar_range){t->vectors.first, added});
        print_list(file, 4, "whole", s->vector, (lar_range){t->vectors.first + added, t->whole});
    }
}

static void print_schedule(FILE *file, const void *context) {
    const lar_schedule *s = context;
    char grid[LAR_GRID_TEXT];
    lar_grid_format(&s->grid, grid);
    fprintf(file, "lariat-schedule 1\ngrid %s\nprocessor %d\nthreads %d\n", grid, (int)s->processor,
            (int)s->threads);
    fprintf(file, "scheme %s\nchannels %s\n", lar_scheme_name[s->scheme],
            lar_channel_use_name[s->channels]);
    fprintf(file, "mesh %016" PRIx64 "\ndivision %016" PRIx64 "\n", s->mesh, s->division);
    fprintf(file, "receive-bytes %" PRId64 "\nbatches %d\n", s->receive_bytes, (int)s->batch_count);
    for (int32_t t = 0; t < s->threads && !ferror(file); t++) {
        int32_t first = s->thread_first[t], end = s->thread_first[t + 1];
        fprintf(file, "\nthread %d batches %d\n", (int)t, (int)(end - first));
        for (int32_t i = first; i < end && !ferror(file); i++) {
            const lar_batch *b = &s->batch[i];
            fprintf(file, "batch %d\n", (int)i);
            print_list(file, 2, "recover", s->element, b->elements);
            print_list(file, 2, "wait", s->wait, b->waits);
            print_transfers(file, "receive", s, b->receives);
            print_list(file, 2, "move", s->node, b->positions);
            print_transfers(file, "send", s, b->sends);
        }
    }
    fputs("\nend\n", file);
}

lar_status lar_schedule_write(const char *folder, const lar_schedule_set *set, lar_error *error) {
    lar_status status = lar_folder_make(folder, error);
    for (int32_t p = 0; p < set->count && !status; p++) {
        char *path = lar_schedule_path(folder, p);
        if (!path) return lar_fail_memory(error, 1, folder);
        status = lar_text_file_write(path, print_schedule, &set->of[p], error);
        free(path);
    }
    return status;
}

/* ---- reading ---------------------------------------------------------------------------- */

/* Whether a file belongs to that of processor 0. */
static lar_status check_family(const char *path, const lar_schedule *s, const lar_schedule *first,
                               int32_t p, lar_error *error) {
    if (s->processor != p)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: holds the schedule of processor %d; name it after that, or write the "
                        "folder again with lariat partition",
                        path, (int)s->processor);
    const char *other = NULL;
    if (s->grid.edge[0] != first->grid.edge[0] || s->grid.edge[1] != first->grid.edge[1] ||
        s->grid.edge[2] != first->grid.edge[2])
        other = "grid";
    else if (s->scheme != first->scheme)
        other = "scheme";
    else if (s->channels != first->channels)
        other = "use of channels";
    else if (s->division != first->division)
        other = "division";
    if (!other) return LAR_OK;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: is of another %s than the file of processor 0 beside it; write the folder "
                    "again with lariat partition",
                    path, other);
}

static lar_status read_one(const char *path, const lar_mesh *mesh, int32_t p, lar_schedule_set *set,
                           lar_error *error) {
    lar_schedule s = {0};
    lar_error why = {0};
    lar_status status = lar_schedule_read(path, mesh, &s, &why);
    if (status == LAR_ERROR_IO)
        return lar_fail(error, status,
                        "%s; a folder of schedules has one such file for every processor of the "
                        "grid, lariat partition writes it",
                        why.message);
    if (status) return lar_fail(error, status, "%s", why.message);
    status = check_family(path, &s, p == 0 ? &s : &set->of[0], p, error);
    if (!status && p == 0) {
        set->of = lar_calloc((size_t)s.grid.count, sizeof *set->of);
        if (!set->of) status = lar_fail_memory(error, (size_t)s.grid.count * sizeof *set->of, path);
    }
    if (status) {
        lar_schedule_clear(&s);
        return status;
    }
    if (p == 0) set->count = s.grid.count;
    set->of[p] = s;
    return LAR_OK;
}

lar_status lar_schedule_read_all(const char *folder, const lar_mesh *mesh, lar_schedule_set *out,
                                 lar_error *error) {
    lar_schedule_set set = {0};
    lar_status status = LAR_OK;
    for (int32_t p = 0; (p == 0 || p < set.count) && !status; p++) {
        char *path = lar_schedule_path(folder, p);
        status = path ? read_one(path, mesh, p, &set, error) : lar_fail_memory(error, 1, folder);
        free(path);
    }
    if (status)
        lar_schedule_set_clear(&set);
    else
        *out = set;
    return status;
}
