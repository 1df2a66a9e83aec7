/* One processor of the parallel computer: its part of the model, its compiled schedule and the
 * threads that go through it (T 6.1, 6.5.3.2).
 *
 *     lar_schedule (global elements and nodes)      lar_processor
 *     recover 12 13 17 ...                  ---->   runs of blocks of the domain
 *     receive 5 stage 0: nodes 100 101      ---->   offset, bytes, indices into the force sums
 *     move 5 6 ...                          ---->   a range of local nodes
 *
 * u and v belong to the processor: every thread reads them, the thread that owns a node writes it.
 * Force sums belong to the threads, one array each (divide/schedule/schedule.h, "sums").
 */
#ifndef LAR_PARALLEL_PROCESSOR_H
#define LAR_PARALLEL_PROCESSOR_H

#include "comm/comm.h"
#include "divide/schedule/schedule.h"
#include "step/guard.h"
#include "step/mass/needs.h"
#include "step/step.h"
#include "parallel/verification.h"

/* A transfer of the schedule, compiled. */
typedef struct lar_packet_plan {
    int32_t peer;
    int32_t added, whole; /* vectors; the whole ones come last */
    int32_t first;        /* in processor->node */
    size_t offset;        /* in a half of the receiver's buffer */
    size_t bytes;         /* signal word and vectors */
} lar_packet_plan;

typedef struct lar_batch_plan {
    int32_t run_first, run_count; /* of the domain */
    lar_range waits;              /* in the schedule's list: batches of other threads */
    lar_range receives, sends;    /* in processor->packet */
    bool moves;                   /* the thread's nodes */
} lar_batch_plan;

/* The round in which a batch was last finished, alone in its cache line: others poll it. */
typedef struct lar_batch_sequence {
    uint64_t round;
} __attribute__((aligned(64))) lar_batch_sequence;

/* What one thread has for the nodes that another moves: packed, because the few cache lines of a
 * reduction come over much faster than those of all the nodes, and stay out of each other's way. */
typedef struct lar_reduction_buffer {
    int32_t batch; /* packed at its end: the one that the other waits for; -1: nothing */
    int32_t count;
    int32_t *node;   /* [count] local nodes */
    int64_t *vector; /* [3 count] for each layer */
} lar_reduction_buffer;

struct lar_processor;
struct lar_contact_exchange;

/* One thread of a processor. */
typedef struct lar_worker {
    struct lar_processor *processor;
    int32_t thread;
    int32_t batch_first, batch_end;
    lar_state state; /* u, v, history: the processor's; force, step and work are its own */
    uint64_t round;  /* steps gone through since the start. Packets and flags are counted by it, so
                        that they go on when the state is set back (docs/parallel.md) */
    lar_surroundings surroundings; /* compiled for its nodes and faces */
    lar_interactions interactions;
    lar_condition_context context;   /* the nodes that it moves */
    lar_reduction_buffer *reduction; /* [threads] for each of them */
    int32_t shared_count;
    int32_t *shared_node; /* local: moved here, and summed where it is (thread_reduction.h) */
    int32_t foreign_count;
    int32_t *foreign; /* local nodes: read here, moved by others */
    lar_fault fault;
    unsigned char *gather; /* for packets to peers whose memory cannot be written from here */
    uint64_t random;       /* of the delays; 0: none */
    lar_needs needs;       /* of its elements, where strained ones may be heavier */
    bool follows;          /* it failed because another thread of the processor had */
} __attribute__((aligned(64))) lar_worker;

typedef struct lar_processor {
    int32_t self, thread_count;
    lar_domain domain;
    lar_strained strained; /* each thread has the places of its runs */
    lar_worker *worker;    /* [thread_count] */
    int32_t batch_count, packet_count;
    lar_batch_plan *batch;        /* [batch_count] thread after thread */
    lar_batch_sequence *sequence; /* [batch_count], atomic */
    lar_packet_plan *packet;
    int32_t *node;           /* local, of all packets */
    int32_t *wait;           /* of all batches */
    int32_t layers;          /* of sums: forces, and what tools press (contact/tool_friction.h) */
    lar_comm *comm;          /* not owned */
    const size_t *shift;     /* [processors] bytes before the schedule's part of each buffer */
    lar_verification *check; /* NULL: real forces. Not owned */
    uint64_t stop;           /* atomic: the round before which everyone stops; 0: none asked for */
    uint64_t failed;         /* atomic: a thread has given up, its siblings must */
    int64_t ahead;           /* steps of the state minus rounds, for messages */
    struct lar_contact_exchange
        *exchange; /* of contact between bodies (contact_exchange.h), or NULL */
} lar_processor;

/* What is common to all processors of a computer. */
typedef struct lar_processor_setting {
    const lar_domain *whole;              /* outlives the processor, as the next one */
    const lar_interactions *interactions; /* of the whole: its tools, how it searches */
    const int32_t *reporter; /* [nodes of the model] the processor that accounts for a node */
    lar_verification *check; /* or NULL */
    const size_t *shift;     /* as above; outlives the processor */
    uint64_t delays;         /* seed of random delays, 0: none */
    bool low_latency;        /* packets arrive within a fraction of a microsecond */
} lar_processor_setting;

/* As many layers of sums travel: packets and buffers are so many times as long. */
int32_t lar_processor_layers(const lar_interactions *whole, bool checking);

/* Compiles a schedule that has been checked against the mesh (read or built). `comm` may be set
 * later. */
lar_status lar_processor_create(const lar_processor_setting *setting, const lar_schedule *schedule,
                                lar_processor *processor, lar_error *error);
void lar_processor_destroy(lar_processor *processor); /* idempotent */

/* Displacements, velocities and step of the whole model into the part, at rest or between two
 * advances; sums, work and faults begin anew. Rounds go on: nobody mistakes packets. */
void lar_processor_scatter(lar_processor *processor, const lar_domain *whole,
                           const lar_state *state);

/* After a stretch of steps, when none of its threads computes: what messages say of it. */
void lar_processor_pause(lar_processor *processor);

/* Asks all processors to stop before a round: earlier requests stand. */
void lar_processor_ask_stop(lar_processor *processor, uint64_t round);

/* Waits until another thread of the processor has set its flag (atomic) to `round` or further. */
lar_status lar_processor_await(const lar_processor *processor, const uint64_t *sequence,
                               uint64_t round, lar_error *error);

/* One step of one thread: batches, packets, waits (batch.c). Fails when a peer is lost, another
 * thread of the processor failed, or verification finds a difference; the processor is then of no
 * more use. A fault is no failure: the step is completed. */
lar_status lar_worker_step(lar_worker *worker, lar_error *error);

#endif
