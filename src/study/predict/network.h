/* A step on a parallel computer that is not there: discrete-event simulation over real schedules
 * (T 5.1.7).
 *
 *     thread     recover | wait for threads | receive | positions | send        batch after batch
 *     packet     sender's link -> latency -> receiver's link -> seen            cluster.h
 *
 * Every thread of every processor goes through the batches of its schedule as parallel/batch.c
 * does, but that its work is a time of the machine instead of work. Links carry one packet after
 * the other, in the order in which packets come to them. Processors run apart as far as their
 * packets allow: all begin the first step together, and that is forgotten after some more, so
 * several are simulated and the later half counts.
 *
 * How many. A start is forgotten from neighbour to neighbour: the inside of a large grid steps
 * evenly at a wrong pace until what its surface does has come to it, so the step alone does not
 * show whether it will change. That all processors go at the same pace does: in a system where
 * only "not before" holds, the pace that it comes to lies between the slowest and the fastest that
 * any processor has over any stretch (Collatz and Wielandt's bound; Baccelli et al.,
 * Synchronization and Linearity, 1992, chapter 3). Links that serve whoever comes first are not
 * quite such a system. Steps are doubled from 8 until both differ by a quarter of a percent at
 * most.
 *
 * Larger grids than have schedules. In a body of equal blocks, one per processor, what a processor
 * does depends on its neighbours alone: whether it is at the lower end, the upper end or between
 * along each axis. A grid of 3 x 3 x 3 has one of each kind. All processors of a grid as large as
 * one likes are simulated, each with the schedule of its kind:
 *
 *     0 1 1 1 1 1 2     kinds along an axis of seven; 0 1 2 are the places that have schedules
 */
#ifndef LAR_STUDY_PREDICT_NETWORK_H
#define LAR_STUDY_PREDICT_NETWORK_H

#include "divide/schedule/schedule.h"
#include "study/predict/cluster.h"

enum {
    LAR_NETWORK_SLICES = 20,
    LAR_NETWORK_START_SLICES = 100,
    LAR_NETWORK_STEPS_MIN = 8,
    LAR_NETWORK_STEPS_MAX = 1000,
    LAR_NETWORK_PROCESSORS_MAX = 100000
};

typedef struct lar_network_options {
    const lar_cluster *machine;
    const lar_schedule_set *schedules;
    int32_t grid[3]; /* of processors; an edge is that of the schedules, or longer where theirs is
                        3. All 0: that of the schedules */
    int32_t steps;   /* simulated, 2 to LAR_NETWORK_STEPS_MAX; the later half counts. 0: until all
                        processors go at the same pace, or it would take too long */
    bool record;     /* keep the spans of a step */
} lar_network_options;

typedef enum lar_span_kind {
    LAR_SPAN_COMPUTE = 0, /* elements and nodes */
    LAR_SPAN_EXCHANGE,    /* sending, receiving */
    LAR_SPAN_WAIT,        /* for packets or threads */
    LAR_SPAN_LINK,        /* the processor's link sends a packet */
    LAR_SPAN_KINDS
} lar_span_kind;

/* "compute", "exchange", "wait", "link". */
extern const char *const lar_span_kind_name[LAR_SPAN_KINDS];

typedef struct lar_network_span {
    int32_t processor, thread; /* thread -1: the link */
    lar_span_kind kind;
    int32_t peer;      /* that the packet goes to, -1 */
    double begin, end; /* [s] from when the last thread ended the step before */
} lar_network_span;

/* Of one processor, per step; times added up over its threads [s]. */
typedef struct lar_network_processor {
    double compute, exchange, wait;
    int64_t packets, bytes_sent, bytes_received; /* with signal words and tails; packets sent, the
                                                    empty ones too */
} lar_network_processor;

typedef struct lar_network_result {
    int32_t grid[3], processors, threads;
    int32_t steps;                    /* simulated */
    double step;                      /* [s] mean of the later half */
    double fastest, slowest;          /* [s] the same of any one processor */
    bool settled;                     /* both differ by a quarter of a percent at most */
    double occupation;                /* of the links, mean over the step */
    double slice[LAR_NETWORK_SLICES]; /* the same over its course; recorded only */
    double start_step;                /* [s] the first step, which all begin together */
    double start_slice[LAR_NETWORK_START_SLICES]; /* occupation over it; recorded only */
    lar_network_processor *of;                    /* [processors], owned as span is */
    lar_network_span *span;                       /* of one step, cut to 0..step; recorded only */
    size_t span_count;
} lar_network_result;

/* Fails for schedules that do not belong together or wait for each other for ever, and without
 * memory. Clear the result with lar_network_clear. */
lar_status lar_network_simulate(const lar_network_options *options, lar_network_result *result,
                                lar_error *error);
void lar_network_clear(lar_network_result *result); /* idempotent */

#endif
