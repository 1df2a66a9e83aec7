/* The parallel computer: processors, the threads they run on, and how they are told what to do
 * (T 5.3.1, 6.1).
 *
 *     one process (threads)               several processes (shm, tcp, ucx, mpi)
 *       caller   processor 0, thread 0      process 0: caller, processor 0     \  control.h:
 *       pool     0.1, 1.0, 1.1, ...         process 1: lar_computer_serve()    /  advance, gather
 *
 * The caller belongs to processor zero and computes with it. The whole model's domain and state
 * stay beside the parts: the state of the parts is gathered into it on demand, and everything that
 * looks at a simulation (hash, energies, results) looks there.
 *
 * Stopping early. Processors are a step apart from their neighbours, so they cannot simply stop.
 * Who wants to stop (an element turned inside out, the caller was interrupted) names a step that
 * all can hear of in time, and packets carry that number on from neighbour to neighbour: a step
 * later they know it, and so on, for `spread` steps. All stop before the same step, as the thesis's
 * snapshots are taken in the same one (T 6.5.1). Numbers are of rounds: a step that is divided has
 * as many as parts, and nodes that a blow throws far within one get new lists of contact between
 * them.
 */
#ifndef LAR_PARALLEL_COMPUTER_H
#define LAR_PARALLEL_COMPUTER_H

#include <sys/types.h>

#include "base/thread_pool.h"
#include "parallel/contact_exchange.h"
#include "parallel/control.h"
#include "parallel/division.h"
#include "step/interval.h"
#include "parallel/processor.h"
#include "parallel/sudden.h"
#include "step/report.h"

/* One thread of one processor of this process: number = processor * threads + thread. */
typedef struct lar_thread_result {
    lar_status status;
    lar_error error;
} lar_thread_result;

/* Contact of bodies (computer_contact.c). */
typedef struct lar_computer_contact {
    lar_contact_map map; /* map.surface NULL: there is none */
    size_t *shift;       /* [processors] bytes of a receive buffer before contact's */
    /* of processor zero: */
    lar_contact_search *search;     /* the whole model's, not owned */
    double (*x)[3], (*searched)[3]; /* [contact nodes] places at the search under way, and at the
                                       last one [m] */
    double *allow;                  /* [contact nodes] of the last one's list */
    double skin;                    /* likewise [m] */
    double moved, way;              /* since then, and in the last step, at most [m] */
    double looked, look_at;         /* what `moved` was when somebody looked, and what it may
                                       become before somebody does again [m] */
    double taking;                  /* what it takes to hand a list out [s] */
    double steps;                   /* that the list is good for, as it looked then */
    double since;                   /* what had moved when the search under way began [m] */
    uint64_t stretch;               /* steps between the last two stops */
    bool searching;                 /* a search is under way */
    bool valid;                     /* the search belongs to the state */
    bool too_many_pairs;            /* it had to be made with a thinner skin than asked for */
    bool always;                    /* search in every step */
    lar_sudden sudden;
    lar_contact_info info; /* what concerns all processors together */
} lar_computer_contact;

/* What elements cost, and whether another division would be faster (redivide.c). */
typedef struct lar_balance {
    bool adapts;      /* the division may become another one */
    bool samples;     /* the stretch under way is timed */
    uint64_t count;   /* stretches since `since` */
    double *busy;     /* [processors] in those that were timed [s] */
    double computed;  /* what those took [s] */
    double since;     /* when the counting began, and */
    double next;      /* when it is looked at again, by the clock [s] */
    double pause;     /* until the next look, at least [s] */
    double corrected; /* what strained and pushed elements cost, times what they should */
    double before;    /* how uneven it was before the last change; 0: that is known */
    uint64_t times;   /* that the division was made anew */
} lar_balance;

typedef struct lar_computer {
    lar_division division;
    lar_schedule_options wanted; /* of `options`, */
    lar_options kept;            /* and all of them but the strings */
    lar_balance balance;
    lar_verification check;
    bool checking;
    int32_t threads;       /* of a processor */
    int32_t first, hosted; /* the processors of this process */
    lar_processor *processor;
    lar_comm_team *team;  /* comm threads only */
    lar_control *control; /* several processes only */
    lar_thread_pool *pool;
    lar_thread_result *result; /* [hosted * threads] */
    size_t *shift;             /* [processors] what control needs of their buffers */
    uint64_t *clock;           /* [processors] atomic: rounds done, of those in this process */
    uint64_t until;            /* the round before which this stretch ends: batch.c */
    lar_computer_contact contact;
    lar_step_callback *callback;
    void *callback_context;
    bool called_off;     /* by the callback */
    pid_t process;       /* that has the threads */
    lar_report report;   /* of the last advance; at processor zero, of all processors */
    lar_state *state;    /* of the whole model: gathered into at zero, scattered from elsewhere */
    bool gathered;       /* at zero: `state` is what the processors have */
    lar_tools *tools;    /* of this process: zero's are those that count */
    lar_tool_list *list; /* of this process: its spares follow `tools` */
    lar_interval interval;
    bool tools_sent; /* to the other processes, as they are */
    /* Before every step and every part of a divided one, when all that is decided is: where free
     * bodies go. NULL: there are none. */
    lar_status (*lead)(void *leader, lar_error *error);
    void *leader;
    bool broken;   /* a processor failed: nothing goes on */
    bool finished; /* processor zero has let everyone go */
    /* for opening */
    const lar_options *options;
    const lar_domain *whole;
    lar_interactions *interactions; /* of the whole: searches for contact of bodies */
    uint64_t identity;
} lar_computer;

/* Divides, compiles, starts threads and meets the other processes. `whole`, `interactions` and
 * `state` are those of the whole model at the start; they, `tools` and `list` must outlive the
 * computer. Takes
 * options->listener over, whatever it returns. */
lar_status lar_computer_create(const lar_domain *whole, lar_interactions *interactions,
                               lar_state *state, lar_tools *tools, lar_tool_list *list,
                               const lar_options *options, lar_computer **computer,
                               lar_error *error);
/* Ends the other processes' serve; after a failure, or by one of them before that, everyone's work.
 * Accepts NULL. A forked child only frees what it has of its parent's. */
void lar_computer_destroy(lar_computer *computer);

/* Advances all processors by `steps`, or fewer when `callback` (may be NULL) returns 0 or a fault
 * stopped everyone: *fault is then the first one. `first`: of the portions of an advance, which
 * have one report together. Processor zero only. */
lar_status lar_computer_advance(lar_computer *computer, uint64_t steps, bool first,
                                lar_step_callback *callback, void *context, lar_fault *fault,
                                lar_error *error);

/* The state of all processors into that of the whole model, where it is not yet, and back to all
 * processors: they go on from there, whatever faults there were before. Processor zero only. */
lar_status lar_computer_gather(lar_computer *computer, lar_error *error);
lar_status lar_computer_scatter(lar_computer *computer, lar_error *error);
/* Of a state that was gathered, and in which nothing else has changed, what elements remember. */
lar_status lar_computer_remember(lar_computer *computer, lar_error *error);

/* Between advances: LAR_ERROR_PEER when a processor of another process has been lost meanwhile. */
lar_status lar_computer_look(lar_computer *computer, lar_error *error);

/* Every other process: does what processor zero says until it ends. */
lar_status lar_computer_serve(lar_computer *computer, lar_error *error);

/* Between advances, of processors that are threads: where some elements have come to cost so much
 * more than others that another division is faster, *computer becomes another one, with the same
 * state and the same bits; true then. What there is no memory for is not made. `whole` is the
 * computer's. */
bool lar_computer_redivide(lar_computer **computer, lar_domain *whole);
/* The same with any distribution for its grid; after a failure *computer is as it was. */
lar_status lar_computer_redistribute(lar_computer **computer, lar_domain *whole,
                                     const lar_distribution *distribution, lar_error *error);

/* ---- between computer.c, computer_*.c and redivide.c ----------------------------------------- */

static inline int32_t lar_all_threads(const lar_computer *computer) {
    return computer->hosted * computer->threads;
}
static inline lar_processor *lar_processor_of(const lar_computer *computer, int32_t number) {
    return &computer->processor[number / computer->threads];
}
lar_status lar_first_failure(lar_computer *computer, lar_error *error);

/* Another computer with another distribution takes over the state, the threads and what was
 * counted; the old one is destroyed, or stays after a failure. */
lar_status lar_computer_create_like(lar_computer *old, const lar_distribution *distribution,
                                    lar_computer **computer, lar_error *error);

lar_status lar_balance_create(lar_balance *balance, int32_t processors, lar_error *error);
/* Counts anew. `cost`: what the last look took, with a new computer where one was made [s]. */
void lar_balance_begin(lar_computer *computer, double cost);
/* Before a stretch: whether it is timed; after it, what a processor took for it, waits included. */
void lar_balance_sample(lar_computer *computer);
void lar_balance_note(lar_computer *computer, const lar_processor *p, double seconds);

/* Before the processors are made; what cannot be made is cleared by lar_contact_close. */
lar_status lar_contact_open(lar_computer *computer, lar_error *error);
void lar_contact_close(lar_computer *computer); /* idempotent */
/* Processor zero, before a stretch: looks and searches where that is due. *fault: too many pairs.
 */
lar_status lar_contact_refresh(lar_computer *computer, lar_fault *fault, lar_error *error);
/* Between advances, while nobody waits: what there will be to search soon, up to `until` by
 * lar_clock_seconds. Threads only. */
lar_status lar_contact_work_ahead(lar_computer *computer, double until, lar_error *error);
/* The step before which a stretch from `step` towards `end` stops; `step` itself: after one round.
 */
uint64_t lar_contact_until(const lar_computer *computer, uint64_t step, uint64_t end);
/* After a stretch of so many steps. */
void lar_contact_count(lar_computer *computer, uint64_t steps);
/* Another process: takes what processor zero found. */
lar_status lar_contact_execute(lar_computer *computer, const void *payload, size_t bytes,
                               lar_error *error);

/* Whether it can go on: not after a failure, nor, where processes belong to it, in a forked child.
 */
lar_status lar_computer_check(const lar_computer *computer, lar_error *error);
/* Another process: answers a round of gathering; takes a scattered state. */
lar_status lar_computer_answer_nodes(lar_computer *computer, uint64_t round, lar_error *error);
lar_status lar_computer_answer_history(lar_computer *computer, uint64_t round, lar_error *error);
lar_status lar_computer_take_state(lar_computer *computer, uint64_t step, const void *payload,
                                   size_t bytes, lar_error *error);

#endif
