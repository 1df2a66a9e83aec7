#include "base/memory.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

/* ---- the host's, or the C library's --------------------------------------------------------- */

/* Set before anything else is asked for, and never again: what one allocates the other cannot free.
 */
static lar_memory_hooks host;
static bool used; /* atomic: there was memory already */

lar_status lar_memory_set(const lar_memory_hooks *hooks, lar_error *error) {
    if (!hooks || !hooks->allocate || !hooks->resize || !hooks->release)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_memory_set needs functions that allocate, resize and release; none "
                        "may be NULL");
    if (__atomic_exchange_n(&used, true, __ATOMIC_ACQ_REL))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the library has asked for memory already, or been given functions for "
                        "it; call lar_memory_set before all other calls, and once");
    host = *hooks;
    return LAR_OK;
}

static bool is_hosted(void) {
    if (!__atomic_load_n(&used, __ATOMIC_ACQUIRE)) __atomic_store_n(&used, true, __ATOMIC_RELEASE);
    return host.allocate != NULL;
}

void *lar_host_malloc(size_t bytes) {
    return is_hosted() ? host.allocate(host.context, bytes, _Alignof(max_align_t))
                       : (malloc)(bytes);
}

void *lar_host_calloc(size_t count, size_t size) {
    if (!is_hosted()) return (calloc)(count, size);
    if (size != 0 && count > SIZE_MAX / size) return NULL;
    void *memory = lar_host_malloc(count * size);
    return memory ? memset(memory, 0, count * size) : NULL;
}

void *lar_host_realloc(void *memory, size_t bytes) {
    if (!is_hosted()) return (realloc)(memory, bytes);
    return memory ? host.resize(host.context, memory, bytes) : lar_host_malloc(bytes);
}

void *lar_host_aligned(size_t alignment, size_t bytes) {
    return is_hosted() ? host.allocate(host.context, bytes, alignment)
                       : (aligned_alloc)(alignment, bytes);
}

void lar_host_free(void *memory) {
    if (host.allocate) {
        if (memory) host.release(host.context, memory);
    } else {
        (free)(memory);
    }
}

/* ---- ours ------------------------------------------------------------------------------------ */

void *lar_calloc(size_t count, size_t size) {
    if (count == 0 || size == 0) return calloc(1, 1);
    return calloc(count, size);
}

void *lar_calloc_aligned(size_t count, size_t size) {
    enum { CACHE_LINE = 64, HUGE_PAGE = 2 << 20 };
    if (size != 0 && count > (SIZE_MAX - HUGE_PAGE) / size) return NULL;
    size_t bytes = count * size, alignment = CACHE_LINE;
    /* Large arrays are walked through in every step: huge pages save 4 % at a million elements. */
    if (bytes >= 2 * (size_t)HUGE_PAGE) alignment = HUGE_PAGE;
    bytes = (bytes + alignment - 1) / alignment * alignment;
    if (bytes == 0) bytes = alignment;
    void *memory = aligned_alloc(alignment, bytes);
    if (!memory) return NULL;
    if (alignment == HUGE_PAGE) madvise(memory, bytes, MADV_HUGEPAGE); /* a hint; may be refused */
    return memset(memory, 0, bytes);
}

char *lar_strndup(const char *text, size_t length) {
    char *copy = malloc(length + 1);
    if (!copy) return NULL;
    memcpy(copy, text, length);
    copy[length] = '\0';
    return copy;
}

char *lar_strdup(const char *text) {
    return lar_strndup(text, strlen(text));
}

bool lar_grow_array(void *array, size_t *capacity, size_t count, size_t size) {
    if (count < *capacity) return true;
    size_t wanted = *capacity < 8 ? 16 : *capacity * 2;
    if (wanted > SIZE_MAX / size) return false;
    void *old;
    memcpy(&old, array, sizeof old);
    void *grown = realloc(old, wanted * size);
    if (!grown) return false;
    memcpy(array, &grown, sizeof grown);
    *capacity = wanted;
    return true;
}

lar_status lar_bytes_read(const char *path, lar_bytes *out, lar_error *error) {
    /* Opening a pipe would wait for somebody who writes into it: looked at before. */
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return lar_fail(error, LAR_ERROR_IO, "%s: is not a regular file; name a file", path);
    FILE *file = fopen(path, "rb");
    if (!file)
        return lar_fail(error, LAR_ERROR_IO, "%s: cannot be opened: %s; check the path", path,
                        strerror(errno));
    if (fstat(fileno(file), &info) != 0 || !S_ISREG(info.st_mode)) {
        fclose(file);
        return lar_fail(error, LAR_ERROR_IO, "%s: is not a regular file; name a file", path);
    }
    if (info.st_size == 0) {
        fclose(file);
        return lar_fail(error, LAR_ERROR_FORMAT, "%s: the file is empty; write it again", path);
    }
    size_t size = (size_t)info.st_size;
    unsigned char *data = malloc(size + 1);
    if (!data) {
        fclose(file);
        return lar_fail_memory(error, size, path);
    }
    size_t got = fread(data, 1, size, file);
    bool failed = ferror(file) != 0;
    fclose(file);
    if (failed || got != size) {
        free(data);
        return lar_fail(error, LAR_ERROR_IO,
                        "%s: could be read only up to byte %zu of %zu; copy it to a disk that can "
                        "be read and try again",
                        path, got, size);
    }
    data[size] = 0;
    out->data = data;
    out->size = size;
    return LAR_OK;
}

void lar_bytes_free(lar_bytes *bytes) {
    free(bytes->data);
    bytes->data = NULL;
    bytes->size = 0;
}

char *lar_path_beside(const char *base_file, const char *relative) {
    const char *slash = strrchr(base_file, '/');
    if (relative[0] == '/' || !slash) return lar_strdup(relative);
    size_t folder = (size_t)(slash - base_file) + 1;
    size_t length = strlen(relative);
    char *path = malloc(folder + length + 1);
    if (!path) return NULL;
    memcpy(path, base_file, folder);
    memcpy(path + folder, relative, length + 1);
    return path;
}

const char *lar_path_extension(const char *path) {
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash ? slash : path, '.');
    return dot ? dot + 1 : "";
}
