#include "study/frames/list.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/file/folder.h"
#include "base/memory.h"
#include "base/text.h"

enum { FRAMES_MAX = 1000000, DIGITS_MAX = 15 };

/* Takes `path`, NULL where memory was refused. */
static lar_status append(const char *source, lar_frame_list *list, size_t *capacity, char *path,
                         int64_t number, lar_error *error) {
    if (path && list->count < FRAMES_MAX && LAR_GROW(list->frame, *capacity, list->count)) {
        list->frame[list->count++] = (lar_frame){path, number};
        return LAR_OK;
    }
    free(path);
    if (list->count == FRAMES_MAX)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%s: more than %d frames; leave some out",
                        source, FRAMES_MAX);
    return lar_fail_memory(error, sizeof *list->frame, source);
}

/* ---- a folder -------------------------------------------------------------------------------- */

/* The number that a name ends with, before the dot; -1: it has none. */
static int64_t number_of(const char *path) {
    const char *dot = strrchr(path, '.'), *from = dot;
    while (from > path && isdigit((unsigned char)from[-1])) from--;
    return from == dot || dot - from > DIGITS_MAX ? -1 : strtoll(from, NULL, 10);
}

static int by_number(const void *a, const void *b) {
    const lar_frame *x = a, *y = b;
    if (x->number != y->number) return x->number < y->number ? -1 : 1;
    return strcmp(x->path, y->path);
}

static lar_status read_entries(const char *path, DIR *folder, lar_frame_list *list,
                               lar_error *error) {
    size_t capacity = 0;
    lar_status status = LAR_OK;
    for (const struct dirent *entry; !status && (entry = readdir(folder));) {
        const char *extension = lar_path_extension(entry->d_name);
        if (strcasecmp(extension, "png") != 0 && strcasecmp(extension, "pgm") != 0) continue;
        if (entry->d_name[0] == '.') continue; /* what some systems hide beside a file */
        char *whole = lar_folder_join(path, entry->d_name);
        status = append(path, list, &capacity, whole, number_of(entry->d_name), error);
    }
    return status;
}

static lar_status order(const char *path, lar_frame_list *list, lar_error *error) {
    if (list->count == 0)
        return lar_fail(error, LAR_ERROR_IO,
                        "%s: there is no image (.png, .pgm) in this folder; give the one with the "
                        "frames",
                        path);
    qsort(list->frame, (size_t)list->count, sizeof *list->frame, by_number);
    for (int32_t i = 0; i < list->count; i++) {
        lar_frame *f = &list->frame[i];
        if (f->number < 0)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: frames of a folder are ordered by the number that their names end "
                            "with, and this one has none; rename it, or give a list (.txt)",
                            f->path);
        if (i > 0 && f->number == f[-1].number)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the number %lld is that of %s, too; remove one of them", f->path,
                            (long long)f->number, f[-1].path);
    }
    const int64_t first = list->frame[0].number;
    for (int32_t i = 0; i < list->count; i++) list->frame[i].number -= first;
    return LAR_OK;
}

static lar_status read_folder(const char *path, lar_frame_list *list, lar_error *error) {
    DIR *folder = opendir(path);
    if (!folder) return lar_fail(error, LAR_ERROR_IO, "cannot read %s: %s", path, strerror(errno));
    lar_status status = read_entries(path, folder, list, error);
    closedir(folder);
    return status ? status : order(path, list, error);
}

/* ---- a list ---------------------------------------------------------------------------------- */

static lar_status read_list(const char *path, lar_frame_list *list, lar_error *error) {
    lar_bytes bytes;
    size_t capacity = 0;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    lar_text text;
    status = lar_text_open(path, &bytes, &text, error);
    for (lar_span line; !status && lar_text_line(&text, &line);) {
        line = lar_span_trim(line);
        if (line.length == 0 || line.at[0] == '#') continue;
        char *name = lar_strndup(line.at, line.length);
        char *whole = name ? lar_path_beside(path, name) : NULL;
        free(name);
        status = append(path, list, &capacity, whole, list->count, error);
    }
    lar_bytes_free(&bytes);
    if (!status && list->count == 0)
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s: no image is named in it; write the name of one on each line", path);
    return status;
}

lar_status lar_frame_list_read(const char *path, lar_frame_list *list, lar_error *error) {
    struct stat info;
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return read_folder(path, list, error);
    if (strcasecmp(lar_path_extension(path), "txt") == 0) return read_list(path, list, error);
    if (stat(path, &info) != 0)
        return lar_fail(error, LAR_ERROR_IO, "cannot read %s: %s", path, strerror(errno));
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: it is neither a folder of images nor a list of them (.txt)", path);
}

void lar_frame_list_clear(lar_frame_list *list) {
    for (int32_t i = 0; i < list->count; i++) free(list->frame[i].path);
    free(list->frame);
    *list = (lar_frame_list){0};
}
