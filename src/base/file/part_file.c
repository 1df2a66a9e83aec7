#include "base/file/part_file.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/file/folder.h"

static lar_status failed(lar_part_file *out, const char *what) {
    const int cause = errno ? errno : EIO;
    return lar_fail(out->error, LAR_ERROR_IO, "%s: cannot be written: %s%s; %s", out->path, what,
                    strerror(cause), lar_remedy(cause, LAR_FILE_REMEDY));
}

lar_status lar_part_open(lar_part_file *out, const char *path, lar_error *error) {
    static const char suffix[] = ".part";
    size_t length = strlen(path);
    *out = (lar_part_file){.path = path, .error = error};
    lar_status status = lar_file_replaceable(path, error);
    if (status) return status;
    out->part = malloc(length + sizeof suffix);
    if (!out->part) return lar_fail_memory(error, length + sizeof suffix, path);
    memcpy(out->part, path, length);
    memcpy(out->part + length, suffix, sizeof suffix);
    errno = 0; /* what is found at the end is of the writing */
    out->file = fopen(out->part, "wb");
    return out->file ? LAR_OK : failed(out, "");
}

lar_status lar_part_close(lar_part_file *out, lar_status status) {
    if (out->file) {
        bool whole = fflush(out->file) == 0 && !ferror(out->file);
        if (!status && !whole) status = failed(out, "");
        if (fclose(out->file) != 0 && !status) status = failed(out, "");
        if (!status && rename(out->part, out->path) != 0)
            status = failed(out, "it cannot be given its name: ");
        if (status) remove(out->part);
    }
    free(out->part);
    *out = (lar_part_file){0};
    return status;
}

lar_status lar_part_write(lar_part_file *out, const void *data, size_t size) {
    return fwrite(data, 1, size, out->file) == size ? LAR_OK : failed(out, "");
}

lar_status lar_part_print(lar_part_file *out, const char *format, ...) {
    va_list args;
    va_start(args, format);
    int written = vfprintf(out->file, format, args);
    lar_status status = written >= 0 ? LAR_OK : failed(out, "");
    va_end(args);
    return status;
}
