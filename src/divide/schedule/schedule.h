/* What every thread of every processor does in one step, in order (T 6.6, figs. 6.15, 6.17).
 *
 *     processor p                    a batch, each part optional
 *     +-----------+-----------+        recover    elements, into the thread's own force sums
 *     | thread 0  | thread 1  |        wait       for batches of other threads of p in this step
 *     |  batch 0 <--- batch 4 |        receive    packets: their vectors are added to the sums
 *     |  batch 1  |  batch 5  |        positions  sums complete: these nodes move
 *     |  ...      |  ...      |        send       packets: sums as they stand now
 *     |  gate     |  gate     |
 *     +-----------+-----------+      The last batch of a thread moves the nodes that it owns; a
 * gate that only waits for the other threads' last batches follows where there are several threads:
 * nobody begins the next step before all nodes here have moved.
 *
 * Sums. Every thread of a processor has force sums of its own for all nodes, zero when a step
 * begins. The force of a node is the sum over the threads: integers, so the order does not matter
 * (docs/determinism.md). Whoever sends a node, or moves it, adds the threads' sums up then; what
 * must be in them by then, and what must not yet be, is what batches wait for.
 *
 * For one node, in the order of time (s = stage of a packet, traffic.h):
 *
 *     elements   send 0   receive 0   send 1   receive 1   send 2   receive 2   positions
 *
 * A batch with one of these waits for the batches of other threads that have an earlier one for
 * the same node. Equal ones commute. A `whole` vector replaces the sums of all threads.
 *
 * Order of batches. Nodes that travel on come first, elements go to the first batch that needs
 * them; what nobody waits for is spread over the gaps between sending and receiving, so that the
 * latency of each exchange hides behind work (T 6.6.2). Which thread takes which batch is searched
 * for (T 6.7).
 *
 * Offsets in the receive buffer are given out here; a place belongs to one packet of one sender.
 * Every packet begins with a signal word of 8 bytes, which is the engine's, and ends with comm's
 * tail. Where data flows between two processors in one direction only, an empty packet (the signal
 * word alone) flows back in every step: buffering by the parity of the step needs both directions
 * (T 6.4).
 */
#ifndef LAR_DIVIDE_SCHEDULE_SCHEDULE_H
#define LAR_DIVIDE_SCHEDULE_SCHEDULE_H

#include "divide/traffic.h"

enum {
    LAR_THREADS_MAX = 16,  /* of a processor */
    LAR_SIGNAL_BYTES = 8,  /* before the vectors of a packet */
    LAR_TAIL_BYTES = 8,    /* behind them */
    LAR_PACKET_ALIGN = 64, /* of offsets: no two packets share a cache line */
};

typedef struct lar_schedule_options {
    lar_scheme scheme;
    lar_channel_use channels;
    int32_t threads; /* of every processor, 1..LAR_THREADS_MAX */
    int64_t search;  /* assignments of batches to threads that are tried at most, per processor */
} lar_schedule_options;

/* all, sequential, 1 thread, a search of some milliseconds. */
lar_schedule_options lar_schedule_options_default(void);

/* Entries first .. first + count - 1 of an array of the schedule. */
typedef struct lar_range {
    int32_t first, count;
} lar_range;

/* One packet, as its sender or its receiver sees it. Sender, receiver and stage name it. */
typedef struct lar_transfer {
    int32_t peer;  /* where it goes to, or comes from */
    int32_t stage; /* 0 .. LAR_STAGES - 1 */
    int32_t whole; /* so many of its vectors, the last ones, are whole forces */
    lar_range
        vectors;    /* in schedule->vector: nodes, the added ones ascending, then the whole ones */
    int64_t offset; /* in a half of the RECEIVER's buffer */
} lar_transfer;

typedef struct lar_batch {
    lar_range elements;  /* in schedule->element, ascending */
    lar_range waits;     /* in schedule->wait */
    lar_range receives;  /* in schedule->transfer */
    lar_range positions; /* in schedule->node, ascending */
    lar_range sends;     /* in schedule->transfer */
} lar_batch;

/* One processor's schedule. Elements and nodes are those of the mesh. */
typedef struct lar_schedule {
    lar_grid grid;
    int32_t processor;
    int32_t threads;
    lar_scheme scheme;
    lar_channel_use channels;
    uint64_t mesh;         /* lar_mesh_fingerprint */
    uint64_t division;     /* the same for all schedules that belong together, for no others */
    int64_t receive_bytes; /* of one half of the buffer, a multiple of LAR_PACKET_ALIGN */

    int32_t batch_count;
    lar_batch *batch;                          /* thread after thread */
    int32_t thread_first[LAR_THREADS_MAX + 1]; /* [threads + 1] first batch of a thread */
    int32_t element_count, wait_count, transfer_count, node_count, vector_count;
    int32_t *element;       /* [element_count] every element of the processor once */
    int32_t *wait;          /* [wait_count] batches of other threads */
    lar_transfer *transfer; /* [transfer_count] */
    int32_t *node;          /* [node_count] every node of the processor once */
    int32_t *vector;        /* [vector_count] nodes of packets */
} lar_schedule;

typedef struct lar_schedule_set {
    int32_t count;
    lar_schedule *of; /* [count] by processor */
} lar_schedule_set;

/* The thread that has a batch. */
static inline int32_t lar_batch_thread(const lar_schedule *schedule, int32_t batch) {
    int32_t thread = 0;
    while (batch >= schedule->thread_first[thread + 1]) thread++;
    return thread;
}

static inline int64_t lar_packet_payload(int32_t vectors) {
    return LAR_SIGNAL_BYTES + (int64_t)LAR_VECTOR_BYTES * vectors;
}

/* The schedules of all processors for a distribution. The same everywhere for the same input.
 * LAR_ERROR_ARGUMENT for options that make no sense. Cleared with lar_schedule_set_clear. */
lar_status lar_schedule_build(const lar_mesh *mesh, const lar_incidence *incidence,
                              const lar_distribution *distribution,
                              const lar_schedule_options *options, lar_schedule_set *out,
                              lar_error *error);
void lar_schedule_set_clear(lar_schedule_set *set); /* idempotent */
void lar_schedule_clear(lar_schedule *schedule);    /* idempotent */

/* Vectors and packets that the schedule sends, counted from its transfers; empty packets are no
 * packets here. */
void lar_schedule_traffic(const lar_schedule *schedule, lar_traffic *traffic);

#endif
