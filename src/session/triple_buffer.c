#include "session/triple_buffer.h"

#include <stdlib.h>

enum { FRESH = 4, SLOT = 3 };

lar_status lar_triple_buffer_create(lar_triple_buffer *buffer, size_t size, const char *what,
                                    lar_error *error) {
    *buffer =
        (lar_triple_buffer){.stride = (size + 63) / 64 * 64, .back = 0, .ready = 1, .front = 2};
    buffer->memory = lar_calloc_aligned(3, buffer->stride);
    if (!buffer->memory) return lar_fail_memory(error, 3 * buffer->stride, what);
    pthread_mutex_init(&buffer->turn, NULL);
    return LAR_OK;
}

void lar_triple_buffer_destroy(lar_triple_buffer *buffer) {
    if (!buffer->memory) return;
    pthread_mutex_destroy(&buffer->turn);
    free(buffer->memory);
    *buffer = (lar_triple_buffer){0};
}

void *lar_triple_buffer_back(lar_triple_buffer *buffer) {
    return buffer->memory + buffer->back * buffer->stride;
}

void lar_triple_buffer_publish(lar_triple_buffer *buffer) {
    buffer->back =
        SLOT & __atomic_exchange_n(&buffer->ready, buffer->back | FRESH, __ATOMIC_ACQ_REL);
}

void *lar_triple_buffer_newest(lar_triple_buffer *buffer, bool *fresh) {
    bool is_new = __atomic_load_n(&buffer->ready, __ATOMIC_RELAXED) & FRESH;
    if (is_new)
        buffer->front = SLOT & __atomic_exchange_n(&buffer->ready, buffer->front, __ATOMIC_ACQ_REL);
    if (fresh) *fresh = is_new;
    return buffer->memory + buffer->front * buffer->stride;
}
