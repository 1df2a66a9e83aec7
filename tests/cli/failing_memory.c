/* Preloaded: some allocations of a process fail. They are numbered from 0.
 *
 *     LD_PRELOAD=failing_memory.so FAIL_AT=588 FAIL_COUNT=1 lariat run small.yaml
 *
 * FAIL_TALLY=FILE: how many there were, written at the end. */
#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

/* The C library's own, under other names. */
void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *old, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);

/* Constant but in `begin`, before which none fails. */
static atomic_long tally;
static long first = -1, last = -1;

static long number_in(const char *name, long otherwise) {
    const char *text = getenv(name);
    return text ? strtol(text, NULL, 10) : otherwise;
}

__attribute__((constructor)) static void begin(void) {
    long at = number_in("FAIL_AT", -1);
    if (at >= 0) last = at + number_in("FAIL_COUNT", 1) - 1;
    first = at;
    atomic_store(&tally, 0);
}

__attribute__((destructor)) static void end(void) {
    const char *name = getenv("FAIL_TALLY");
    long count = atomic_load(&tally);
    FILE *file = name ? fopen(name, "w") : NULL;
    if (!file) return;
    fprintf(file, "%ld\n", count);
    fclose(file);
}

static bool fails(void) {
    long number = atomic_fetch_add(&tally, 1);
    if (first < 0 || number < first || number > last) return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t bytes) {
    return fails() ? NULL : __libc_malloc(bytes);
}

void *calloc(size_t count, size_t bytes) {
    return fails() ? NULL : __libc_calloc(count, bytes);
}

void *realloc(void *old, size_t bytes) {
    return fails() ? NULL : __libc_realloc(old, bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes) {
    return fails() ? NULL : __libc_memalign(alignment, bytes);
}

int posix_memalign(void **out, size_t alignment, size_t bytes) {
    void *memory = fails() ? NULL : __libc_memalign(alignment, bytes);
    if (!memory) return ENOMEM;
    *out = memory;
    return 0;
}
