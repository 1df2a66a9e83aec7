#include "session/exchange.h"

#include <stdlib.h>

enum { FRESH = 4, SLOT = 3 };

lar_status lar_mailbox_create(lar_mailbox *box, size_t size, const char *what, lar_error *error) {
    *box = (lar_mailbox){.stride = (size + 63) / 64 * 64, .draft = 0, .middle = 1, .desk = 2};
    box->memory = lar_calloc_aligned(3, box->stride);
    if (!box->memory) return lar_fail_memory(error, 3 * box->stride, what);
    pthread_mutex_init(&box->turn, NULL);
    return LAR_OK;
}

void lar_mailbox_destroy(lar_mailbox *box) {
    if (!box->memory) return;
    pthread_mutex_destroy(&box->turn);
    free(box->memory);
    *box = (lar_mailbox){0};
}

void *lar_mailbox_draft(lar_mailbox *box) {
    return box->memory + box->draft * box->stride;
}

void lar_mailbox_send(lar_mailbox *box) {
    box->draft = SLOT & __atomic_exchange_n(&box->middle, box->draft | FRESH, __ATOMIC_ACQ_REL);
}

void *lar_mailbox_newest(lar_mailbox *box, bool *fresh) {
    bool is_new = __atomic_load_n(&box->middle, __ATOMIC_RELAXED) & FRESH;
    if (is_new) box->desk = SLOT & __atomic_exchange_n(&box->middle, box->desk, __ATOMIC_ACQ_REL);
    if (fresh) *fresh = is_new;
    return box->memory + box->desk * box->stride;
}
