/* Memory for set-up and input: checked sizes, growable arrays, whole files.
 *
 * Nothing here is called from the step loop. Sizes that come from a file must be checked
 * against the file's own length BEFORE they reach lar_calloc (a 1 kB header may claim
 * 10 GB): lar_claim_fits is the test every reader uses.
 */
#ifndef LAR_BASE_MEMORY_H
#define LAR_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#include "base/error.h"

/* Memory comes from the host where it gives functions for that (lar_memory_set). Every file of the
 * library is compiled with this header in front (src/CMakeLists.txt), so that none asks for memory,
 * or gives it back, beside it. What the C library allocates, as open_memstream does, goes back to
 * it by (free)(memory). Other libraries have their own ways. liblariat-fit does as this one. */
void *lar_host_malloc(size_t bytes);
void *lar_host_calloc(size_t count, size_t size);
void *lar_host_realloc(void *memory, size_t bytes);
void *lar_host_aligned(size_t alignment, size_t bytes);
void lar_host_free(void *memory);
#if defined(LARIAT_LIBRARY) || defined(LARIAT_FIT_LIBRARY)
#define malloc(bytes)                   lar_host_malloc(bytes)
#define calloc(count, size)             lar_host_calloc(count, size)
#define realloc(memory, bytes)          lar_host_realloc(memory, bytes)
#define aligned_alloc(alignment, bytes) lar_host_aligned(alignment, bytes)
#define free(memory)                    lar_host_free(memory)
#endif

/* calloc that refuses an overflowing product. count == 0 gives a valid pointer. NULL on
 * failure. Free with free(). */
void *lar_calloc(size_t count, size_t size);

/* Like lar_calloc, aligned to 64 bytes (one cache line, one AVX-512 vector); large arrays to huge
 * pages where the system has them. Free with free(). */
void *lar_calloc_aligned(size_t count, size_t size);

/* A copy of a string or of its first `length` bytes, or NULL. */
char *lar_strdup(const char *text);
char *lar_strndup(const char *text, size_t length);

/* Makes room for one more entry in a growing array: doubles *capacity when count reaches it.
 * `array` is the address of the array pointer. False when memory is refused; the old array is
 * then still valid. */
bool lar_grow_array(void *array, size_t *capacity, size_t count, size_t size);
#define LAR_GROW(array, capacity, count)                                                           \
    lar_grow_array(&(array), &(capacity), (size_t)(count), sizeof *(array))

/* True when `count` items of at least `bytes_each` input bytes can be present in `available`
 * bytes of input. */
static inline bool lar_claim_fits(unsigned long long count, size_t bytes_each, size_t available) {
    return bytes_each == 0 || count <= available / bytes_each;
}

/* A whole file in memory. data[size] is always a zero byte, so text may be scanned. */
typedef struct lar_bytes {
    unsigned char *data;
    size_t size;
} lar_bytes;

/* Reads a regular file. Errors name the path and the reason (missing, a folder, unreadable,
 * empty). The caller frees with lar_bytes_free. */
lar_status lar_bytes_read(const char *path, lar_bytes *out, lar_error *error);
void lar_bytes_free(lar_bytes *bytes);

/* "folder of `base_file`" joined with `relative`; an absolute `relative` is returned as it is.
 * NULL when memory is refused. Free with free(). */
char *lar_path_beside(const char *base_file, const char *relative);

/* The part of `path` after the last dot of its last component, or "" (not allocated). */
const char *lar_path_extension(const char *path);

#endif
