#include "base/file/folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

/* The error number of mkdir for one folder; 0 when it is there afterwards. */
static int make_one(const char *path) {
    struct stat found;
    if (mkdir(path, 0777) == 0) return 0;
    int cause = errno;
    if (stat(path, &found) != 0) return cause;
    return S_ISDIR(found.st_mode) ? 0 : ENOTDIR;
}

lar_status lar_folder_make(const char *folder, lar_error *error) {
    char *path = lar_strdup(folder);
    if (!path) return lar_fail_memory(error, strlen(folder) + 1, folder);
    int cause = *folder ? 0 : ENOENT;
    for (char *at = path; !cause && *at; at++) {
        bool ends_here = *at != '/' && (at[1] == '/' || at[1] == '\0');
        if (!ends_here) continue;
        char kept = at[1];
        at[1] = '\0';
        cause = make_one(path);
        at[1] = kept;
    }
    free(path);
    if (!cause) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO, "%s: cannot be used as a folder: %s; %s", folder,
                    cause == EEXIST ? "it is a link that leads nowhere" : strerror(cause),
                    lar_remedy(cause, "choose another one or check the permissions"));
}

lar_status lar_folder_lock(const char *folder, int *lock, lar_error *error) {
    *lock = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (*lock < 0 || flock(*lock, LOCK_EX | LOCK_NB) == 0) return LAR_OK;
    bool taken = errno == EWOULDBLOCK;
    close(*lock);
    *lock = -1;
    if (!taken) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: another run is writing its results there, and both would be mixed; choose "
                    "another folder, or wait until it has ended (results that this program has "
                    "open there: close them)",
                    folder);
}

void lar_folder_unlock(int lock) {
    if (lock < 0) return;
    flock(lock, LOCK_UN); /* a forked child may have a copy */
    close(lock);
}

char *lar_folder_join(const char *folder, const char *name) {
    size_t length = strlen(folder), size = length + strlen(name) + 2;
    char *path = lar_calloc(size, 1);
    const char *slash = length > 0 && folder[length - 1] == '/' ? "" : "/";
    if (path) snprintf(path, size, "%s%s%s", folder, slash, name);
    return path;
}

lar_status lar_file_replaceable(const char *path, lar_error *error) {
    struct stat there;
    if (lstat(path, &there) != 0 || S_ISREG(there.st_mode)) return LAR_OK;
    return lar_fail(
        error, LAR_ERROR_IO,
        "%s: is there and is no plain file (a folder, link or device?); choose another name", path);
}

lar_status lar_file_spare(const char *path, const void *magic, const char *what, lar_error *error) {
    char begin[8];
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return LAR_OK; /* none there, or writing will tell */
    ssize_t got = read(file, begin, sizeof begin);
    close(file);
    if (got == 0 || (got == (ssize_t)sizeof begin && memcmp(begin, magic, sizeof begin) == 0))
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: is there and is %s; it is not overwritten, choose another name", path,
                    what);
}
