/* Mailboxes between the engine's thread and all others: the latest value wins, and neither side
 * ever waits for the other.
 *
 *     writer: draft --send--.           .--newest-- desk :reader
 *                            > middle <                        three slots, exchanged by their
 *             (own slot)    (one atomic word)    (own slot)    numbers; no letter is copied
 *
 * A sender writes into a slot that nobody else has and exchanges it with the middle one; a reader
 * exchanges its own slot with the middle one when there is something new in it. So a letter is read
 * whole or not at all, without a lock, and what is not read in time is overwritten: right for
 * positions, forces and pictures, of which only the newest matters.
 *
 * One of the two sides is the engine's thread. The other may be many threads: they take turns with
 * lar_mailbox_lock, which the engine never touches.
 */
#ifndef LAR_SESSION_EXCHANGE_H
#define LAR_SESSION_EXCHANGE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"

typedef struct lar_mailbox {
    unsigned char *memory; /* three slots, each a multiple of 64 bytes */
    size_t stride;
    uint32_t draft, desk; /* slots of the sender and the reader */
    uint32_t middle;      /* atomic: slot, and whether it is new */
    pthread_mutex_t turn; /* of the side that is many threads */
} lar_mailbox;

/* All slots zero. `what` names it in the message when memory is refused. */
lar_status lar_mailbox_create(lar_mailbox *box, size_t size, const char *what, lar_error *error);
void lar_mailbox_destroy(lar_mailbox *box); /* idempotent; a zeroed one is fine */

/* The sender's own slot: it holds some older letter and is to be overwritten whole. */
void *lar_mailbox_draft(lar_mailbox *box);
void lar_mailbox_send(lar_mailbox *box);

/* The newest letter, the reader's until it asks again. *fresh (may be NULL): it was not seen
 * before. */
void *lar_mailbox_newest(lar_mailbox *box, bool *fresh);

static inline void lar_mailbox_lock(lar_mailbox *box) {
    pthread_mutex_lock(&box->turn);
}

static inline void lar_mailbox_unlock(lar_mailbox *box) {
    pthread_mutex_unlock(&box->turn);
}

#endif
