/* What the two halves of the backend ucx share: ucx_open.c brings the processors together, ucx.c
 * has the idea, and everything after that. Only where UCX is there. */
#ifndef LAR_COMM_UCX_STATE_H
#define LAR_COMM_UCX_STATE_H

#include <sched.h>
#include <stdatomic.h>

#include "comm/backend.h"
#include "comm/ucx_calls.h"

enum { MESSAGE_NOTE = 1, MESSAGE_PACKET = 2 };

typedef enum ucx_way { WAY_DIRECT, WAY_PUT, WAY_MESSAGE } ucx_way;

typedef struct packet_head {
    uint64_t token, offset, bytes, step;
} packet_head;

typedef enum note_kind { NOTE_HELLO = 1, NOTE_BYE } note_kind;
typedef struct note {
    uint64_t token;
    int32_t self;
    uint16_t kind, direct;
} note;

typedef struct ucx_link {
    ucp_ep_h endpoint; /* NULL: none, or cut */
    ucp_rkey_h key;
    uint64_t receive; /* where the peer has its receive buffer */
    ucx_way way;      /* of packets to it */
    bool writes;      /* it writes into our memory: nothing of it comes through UCX */
    bool severable;   /* may be closed by force */
    bool greeted, left;
    int failed;        /* atomic */
    uint64_t tails[2]; /* what the puts under way read, by parity */
    int puts[2];       /* of tails, under way */
    note hello, bye;
} ucx_link;

typedef struct ucx_state {
    ucp_context_h context;
    ucp_worker_h worker;
    ucp_mem_h memory;
    ucx_link *links;           /* [count] */
    ucx_way first;             /* that may be chosen */
    bool remote;               /* packets to or from somebody go through UCX */
    bool connecting;           /* not everyone has heard everyone yet */
    struct ucx_state *earlier; /* that stays */
    int pending;               /* notes, flushes and closings under way */
    atomic_int putters;
    atomic_flag lock; /* over all above that changes, and all of UCX */
} ucx_state;

static inline void lock(ucx_state *state) {
    atomic_fetch_add_explicit(&state->putters, 1, memory_order_relaxed);
    while (atomic_flag_test_and_set_explicit(&state->lock, memory_order_acquire)) sched_yield();
    atomic_fetch_sub_explicit(&state->putters, 1, memory_order_relaxed);
}

static inline void unlock(ucx_state *state) {
    atomic_flag_clear_explicit(&state->lock, memory_order_release);
}

/* In either direction. */
static inline bool goes_through_ucx(const ucx_link *link) {
    return !link->writes || link->way != WAY_DIRECT;
}

/* A note of `link`, which stays until it has left. */
void lar_ucx_send_note(ucx_state *state, ucx_link *link, const note *n);

typedef bool (*condition)(const lar_comm *comm);

/* Lets UCX work; false at the deadline. */
bool lar_ucx_work_until(lar_comm *comm, condition fulfilled, double deadline);

lar_status lar_ucx_open(lar_comm *comm, lar_error *error);
lar_status lar_ucx_connect(lar_comm *comm, lar_error *error);

#endif
