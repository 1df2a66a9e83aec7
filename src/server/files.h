/* The viewer's files, read once into memory. A request is looked up among the names that were found
 * then, so nothing else on the disk can be reached, whatever the request says. */
#ifndef LAR_SERVER_FILES_H
#define LAR_SERVER_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef struct lar_file {
    char *path;       /* "/assets/index.js" */
    const char *type; /* of its content */
    bool lasting;     /* its name changes with its content */
    unsigned char *data;
    size_t size;
} lar_file;

typedef struct lar_files {
    int32_t count;
    lar_file *file;
} lar_files;

/* Reads what lies in a folder: regular files, no links, nothing whose name begins with a dot.
 * `folder` NULL: the one that belongs to this library, and a page that says how to get the viewer
 * when there is none. */
lar_status lar_files_read(const char *folder, lar_files *files, lar_error *error);
void lar_files_clear(lar_files *files); /* idempotent */

/* NULL: there is none. "/" is "/index.html". */
const lar_file *lar_files_find(const lar_files *files, const char *path);

#endif
