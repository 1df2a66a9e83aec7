/* How a schedule comes about; only for the files beside it.
 *
 *     packets   who sends what to whom, from the scheme           packets.c
 *     plan      for one processor: batches in an order of time    plan.c
 *                 units    a batch that sends to one peer what it has of its own
 *                 relays   a batch that receives first what it sends on
 *                 gaps     what is recovered before a relay, or before the last receives
 *     threads   who takes which unit (T 6.7)                      threads.c
 *     shares    gaps filled, elements handed to threads           shares.c
 *     waits     and the schedule written down                     waits.c, emit.c
 *
 * A batch of the plan has a rank, its number. What it waits for has a lower one: units only wait
 * for units before them, a relay for the units and the gap before it. So there is no cycle within
 * a processor, and as a packet of a stage is received after all earlier stages have been sent,
 * none over several.
 *
 * Where things go is noted with the things: the batch of an element, of a packet.
 */
#ifndef LAR_DIVIDE_SCHEDULE_PLAN_H
#define LAR_DIVIDE_SCHEDULE_PLAN_H

#include "divide/schedule/schedule.h"

/* ---- packets of all processors ---------------------------------------------------------- */

typedef struct lar_plan_packet {
    int32_t from, to, stage;
    int32_t count, whole; /* vectors; the last `whole` of them are whole forces */
    int32_t distance;     /* channels between the two */
    int32_t onward;       /* most ways that one of its vectors still has to go after this one */
    int64_t first;        /* in node[] */
    int64_t offset;       /* in the receiver's buffer */
    int32_t sent_in;      /* batch of the sender's plan, or LAR_AT_START */
    int32_t received_in;  /* batch of the receiver's plan */
} lar_plan_packet;

enum { LAR_NOWHERE = -1, LAR_AT_START = -2 };

typedef struct lar_packets {
    int32_t count;
    lar_plan_packet *packet; /* by sender, then stage, then receiver */
    int32_t *sent_first;     /* [processors + 1] */
    int32_t *received;       /* packets by receiver, then stage, then sender */
    int32_t *received_first; /* [processors + 1] */
    int32_t *node;           /* added ones ascending, then whole ones, packet after packet */
    int64_t *room;           /* [processors] bytes of half a receive buffer */
} lar_packets;

lar_status lar_packets_build(const lar_sharing *sharing, const lar_schedule_options *options,
                             lar_packets *out, lar_error *error);
void lar_packets_clear(lar_packets *packets);

/* ---- what all plans share --------------------------------------------------------------- */

typedef struct lar_plan_site {
    const lar_mesh *mesh;
    const lar_incidence *incidence;
    const lar_distribution *distribution;
    const lar_schedule_options *options;
    lar_sharing sharing;
    lar_packets packets;
    double (*centre)[3];    /* [elements] */
    int32_t *element;       /* [elements] by processor, ascending */
    int32_t *element_first; /* [processors + 1] */
    int32_t *node;          /* by processor, ascending */
    int64_t *node_first;    /* [processors + 1] */
    int32_t *batch;         /* [elements] batch of the plan of its processor, or LAR_NOWHERE */
    uint64_t *kind;         /* [elements] scratch, 0 */
    int32_t *place;         /* [nodes] number within the processor that is planned now */
} lar_plan_site;

/* ---- one processor ---------------------------------------------------------------------- */

typedef struct lar_plan_batch {
    int32_t thread;
    int32_t elements;
    int64_t finish; /* of a unit, as far as it is foreseen (threads.c) */
} lar_plan_batch;

/* What all threads recover together, each in a batch of its own: before something is received, or
 * before what is too much for one thread is sent. In one of the batches, the relay, packets may be
 * received and sent on. */
typedef struct lar_plan_gap {
    int32_t batch[LAR_THREADS_MAX];
    int32_t relay;  /* LAR_NOWHERE: none */
    int32_t first;  /* of the elements in plan->pool that must be recovered here */
    int32_t needed; /* how many */
    int32_t before; /* elements recovered since the exchange before */
    bool receives;  /* something, so that there is latency to hide */
} lar_plan_gap;

enum { LAR_GAPS_MAX = 64 };

typedef struct lar_plan {
    lar_plan_site *site;
    int32_t processor, threads;
    const int32_t *element;
    const int32_t *node;
    int32_t element_count, node_count;
    size_t batch_capacity;
    int32_t batch_count;
    lar_plan_batch *batch;          /* in the order of rank */
    int32_t first_unit;             /* batches up to the last gap */
    int32_t since;                  /* elements recovered since packets of others may come */
    int64_t clock[LAR_THREADS_MAX]; /* when each thread is through with its units since then */
    int64_t tried;                  /* assignments of units */
    int32_t gap_count;              /* the last gap is before the last receives */
    lar_plan_gap gap[LAR_GAPS_MAX];
    int32_t last[LAR_THREADS_MAX]; /* the batch that moves nodes; a gate follows */
    int32_t pooled;
    int32_t *pool;    /* [element_count] elements of gaps; those that no send needs come last */
    int32_t *arrival; /* [node_count] first stage that brings something, LAR_STAGES: none */
    int32_t *mark;    /* [node_count] scratch, 0 */
    int32_t *owner;   /* [node_count] thread that moves the node */
} lar_plan;

lar_status lar_plan_build(lar_plan_site *site, int32_t processor, lar_plan *plan, lar_error *error);
void lar_plan_clear(lar_plan *plan);

enum {
    LAR_POOLED = -2, /* of an element: in the pool, not yet in a batch */
    /* A unit with fewer elements than the widest vector has lanes takes the next one in. */
    LAR_UNIT_MIN = 8,
};

/* Batch number of a new, empty batch; LAR_NOWHERE without memory. */
int32_t lar_plan_add_batch(lar_plan *plan, int32_t thread);

/* Elements at the nodes of a packet that have no batch yet get `batch`. Returns how many; they are
 * written to list[] when that is not NULL. */
int32_t lar_plan_claim(lar_plan *plan, const lar_plan_packet *packet, int32_t batch, int32_t *list);

/* One batch for each of these packets, which need nothing from others and are equally urgent, on
 * the thread and in the order that are best; small ones share a batch. */
lar_status lar_plan_units(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                          lar_error *error);

/* The same where units would leave threads uneven: all threads recover a part of what the packets
 * need, then the packets are sent. */
lar_status lar_plan_split(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                          lar_error *error);

/* Elements in a gap get a batch. Decides about all gaps at once. */
lar_status lar_plan_shares(lar_plan *plan, lar_error *error);

/* The plan as schedule of its processor. */
lar_status lar_plan_emit(const lar_plan *plan, lar_schedule *out, lar_error *error);

/* Fills the waits of a schedule that is whole otherwise. rank[batch_count] are the batches of the
 * plan: nothing waits for a higher one. place[nodes] as in the site. */
lar_status lar_schedule_find_waits(const lar_mesh *mesh, const int32_t *place, const int32_t *rank,
                                   lar_schedule *schedule, lar_error *error);

#endif
