/* Checkpoints on the disk: whole or not at all, whoever else writes there, whatever was left. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "simulation/checkpoint.h"

static bool write_all(int file, const unsigned char *data, size_t bytes) {
    while (bytes > 0) {
        ssize_t written = write(file, data, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        data += written;
        bytes -= (size_t)written;
    }
    return true;
}

/* A name is safe when its folder is. */
static void sync_folder(const char *path) {
    char *folder = lar_path_beside(path, ".");
    int file = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (file >= 0) {
        fsync(file);
        close(file);
    }
    free(folder);
}

/* A file of a name that nobody else has, "PATH.PROCESS-NUMBER.part" in `part` (`size` bytes):
 * several may save to one path at once. Names that are there were left by a process that was
 * killed. */
static int open_part(const char *path, char *part, size_t size) {
    static unsigned latest; /* atomic */
    enum { TRIES = 1000 };
    int file = -1;
    errno = EEXIST;
    for (int i = 0; i < TRIES && file < 0 && errno == EEXIST; i++) {
        unsigned number = __atomic_add_fetch(&latest, 1, __ATOMIC_RELAXED);
        snprintf(part, size, "%s.%ld-%u.part", path, (long)getpid(), number);
        file = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    }
    return file;
}

/* Whether a name in the folder of `name` is that of a part of it whose process is gone. Another
 * machine may write to the same folder, and its processes are not known here: a part that has just
 * been written to stays. */
static bool is_left_over(int folder, const char *name, const char *found) {
    static const double SURELY = 60; /* [s] */
    size_t length = strlen(name);
    long process = 0;
    unsigned number;
    char end[8] = "";
    struct stat about;
    if (strncmp(found, name, length) != 0 ||
        sscanf(found + length, ".%ld-%u.%7s", &process, &number, end) != 3 ||
        strcmp(end, "part") != 0 || process < 1)
        return false;
    bool gone = kill((pid_t)process, 0) != 0 && errno == ESRCH;
    return gone && fstatat(folder, found, &about, AT_SYMLINK_NOFOLLOW) == 0 &&
           S_ISREG(about.st_mode) && difftime(time(NULL), about.st_mtime) > SURELY;
}

/* What processes have left that were killed while they saved to this path. */
static void clean_up(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    char *above = slash ? lar_strndup(path, (size_t)(slash - path) + 1) : lar_strdup(".");
    DIR *folder = above ? opendir(above) : NULL;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;)
        if (is_left_over(dirfd(folder), name, entry->d_name))
            unlinkat(dirfd(folder), entry->d_name, 0);
    if (folder) closedir(folder);
    free(above);
}

static lar_status write_file(const char *path, const unsigned char *data, size_t bytes,
                             lar_error *error) {
    size_t size = strlen(path) + sizeof ".-9223372036854775807-4294967295.part";
    char *part = lar_calloc(size, 1);
    if (!part) return lar_fail_memory(error, size, path);
    int file = open_part(path, part, size);
    bool good = file >= 0 && write_all(file, data, bytes) && fsync(file) == 0;
    int cause = errno;
    if (file >= 0 && close(file) != 0 && good) {
        good = false;
        cause = errno;
    }
    if (good && rename(part, path) != 0) {
        good = false;
        cause = errno;
    }
    if (good) sync_folder(path);
    if (good) clean_up(path);
    if (file >= 0 && !good) remove(part);
    free(part);
    if (good) return LAR_OK;
    if (!cause) cause = EIO;
    return lar_fail(error, LAR_ERROR_IO, "%s: cannot be written: %s; %s", path, strerror(cause),
                    lar_remedy(cause, LAR_FILE_REMEDY));
}

lar_status lar_checkpoint_store(const char *path, const lar_bytes *bytes, lar_error *error) {
    lar_status status = lar_file_replaceable(path, error);
    if (!status) status = lar_file_spare(path, LAR_CHECKPOINT_MAGIC, "not a checkpoint", error);
    return status ? status : write_file(path, bytes->data, bytes->size, error);
}
