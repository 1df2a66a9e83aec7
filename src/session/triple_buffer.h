/* Triple buffers between the engine's thread and all others: the latest value wins, and neither
 * side ever waits for the other.
 *
 *     writer: back --publish.           .--newest- front :reader
 *                            > ready <                         three slots, exchanged by their
 *             (own slot)    (one atomic word)    (own slot)    numbers; no value is copied
 *
 * A sender writes into a slot that nobody else has and exchanges it with the ready one; a reader
 * exchanges its own slot with the ready one when there is something new in it. So a value is read
 * whole or not at all, without a lock, and what is not read in time is overwritten: right for
 * positions, forces and pictures, of which only the newest matters.
 *
 * One of the two sides is the engine's thread. The other may be many threads: they take turns with
 * lar_triple_buffer_lock, which the engine never touches.
 */
#ifndef LAR_SESSION_TRIPLE_BUFFER_H
#define LAR_SESSION_TRIPLE_BUFFER_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"

typedef struct lar_triple_buffer {
    unsigned char *memory; /* three slots, each a multiple of 64 bytes */
    size_t stride;
    uint32_t back, front; /* slots of the sender and the reader */
    uint32_t ready;       /* atomic: slot, and whether it is new */
    pthread_mutex_t turn; /* of the side that is many threads */
} lar_triple_buffer;

/* All slots zero. `what` names it in the message when memory is refused. */
lar_status lar_triple_buffer_create(lar_triple_buffer *buffer, size_t size, const char *what,
                                    lar_error *error);
void lar_triple_buffer_destroy(lar_triple_buffer *buffer); /* idempotent; a zeroed one is fine */

/* The sender's own slot: it holds some older value and is to be overwritten whole. */
void *lar_triple_buffer_back(lar_triple_buffer *buffer);
void lar_triple_buffer_publish(lar_triple_buffer *buffer);

/* The newest value, the reader's until it asks again. *fresh (may be NULL): it was not seen
 * before. */
void *lar_triple_buffer_newest(lar_triple_buffer *buffer, bool *fresh);

static inline void lar_triple_buffer_lock(lar_triple_buffer *buffer) {
    pthread_mutex_lock(&buffer->turn);
}

static inline void lar_triple_buffer_unlock(lar_triple_buffer *buffer) {
    pthread_mutex_unlock(&buffer->turn);
}

#endif
