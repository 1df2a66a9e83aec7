/* A file that appears whole or not at all: written to PATH.part, which gets its name at the end. No
 * fsync: a power cut may cost what was written last, but not a run's speed. What is at PATH and is
 * no plain file (/dev/null, a pipe, a link) stays, and opening fails.
 *
 *     lar_part_file out;
 *     lar_status status = lar_part_open(&out, path, error);
 *     if (!status) fprintf(out.file, ...);
 *     return lar_part_close(&out, status);
 */
#ifndef LAR_BASE_FILE_PART_FILE_H
#define LAR_BASE_FILE_PART_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "base/error.h"

typedef struct lar_part_file {
    const char *path;
    char *part;
    FILE *file; /* NULL: not open */
    lar_error *error;
} lar_part_file;

lar_status lar_part_open(lar_part_file *out, const char *path, lar_error *error);

/* Ends the writing: with LAR_OK so far the file gets its name, else nothing stays; also when
 * something was written to out->file past the functions below and has failed. Returns the final
 * status. */
lar_status lar_part_close(lar_part_file *out, lar_status status);

lar_status lar_part_write(lar_part_file *out, const void *data, size_t size);
lar_status lar_part_print(lar_part_file *out, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
