/* Folders and files for what a run writes. */
#ifndef LAR_BASE_FILE_FOLDER_H
#define LAR_BASE_FILE_FOLDER_H

#include "base/error.h"

/* Makes a folder and those above it that are missing; one that is there already is fine. Errors
 * name the path and the reason. */
lar_status lar_folder_make(const char *folder, lar_error *error);

/* Keeps other writers out of a folder that is there. *lock: for lar_folder_unlock, or -1 where the
 * folder may not be read or its file system has no locks. LAR_ERROR_IO when somebody writes there
 * already, in this process or another. It ends with the process, however that ends, and leaves
 * nothing behind. */
lar_status lar_folder_lock(const char *folder, int *lock, lar_error *error);
/* -1 is fine. A forked child only closes (close) what it has of its parent's. */
void lar_folder_unlock(int lock);

/* "folder/name" or NULL when memory is refused. Free with free(). */
char *lar_folder_join(const char *folder, const char *name);

/* What a new file takes the place of must be a plain file: a device, a pipe or a link would be
 * lost, and a link's user means the file behind it. Nothing there is fine. Else LAR_ERROR_IO. */
lar_status lar_file_replaceable(const char *path, lar_error *error);

/* A mesh or a scene that is named by mistake stays as it is: what stands at `path` must be empty or
 * begin with the 8 bytes `magic`, or else "is there and is `what`" (LAR_ERROR_IO). Nothing there is
 * fine. */
lar_status lar_file_spare(const char *path, const void *magic, const char *what, lar_error *error);

#endif
