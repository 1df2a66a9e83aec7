#include "study/output.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

lar_status lar_output_begin(const char *path, lar_output *o, lar_error *error) {
    size_t length = strlen(path) + 6;
    o->part = lar_calloc(length, 1);
    if (!o->part) return lar_fail_memory(error, length, "a path");
    snprintf(o->part, length, "%s.part", path);
    o->file = fopen(o->part, "w");
    if (o->file) return LAR_OK;
    lar_status status =
        lar_fail(error, LAR_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
    free(o->part);
    return status;
}

lar_status lar_output_end(const char *path, lar_output *o, lar_error *error) {
    bool good = !ferror(o->file);
    good = fclose(o->file) == 0 && good;
    good = good && rename(o->part, path) == 0;
    lar_status status = LAR_OK;
    if (!good) {
        status = lar_fail(error, LAR_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
        remove(o->part);
    }
    free(o->part);
    return status;
}
