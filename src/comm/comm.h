/* How processors talk: one primitive, everything else stands on it (T 6.4, 7.4, 7.5).
 *
 *     PUT these bytes at that offset of the peer's receive buffer, and after them the TAIL.
 *
 *     receive buffer of a processor: two halves, chosen by the parity of the step
 *
 *       even steps | payload     |tail| payload |tail| ...          odd steps | the same layout |
 *                   offset        offset + bytes, padded to 8
 *
 * The tail is the number of the step, 64 bits, 8-byte aligned. It is written after the payload is
 * there, so a receiver that polls the tail and finds its step may read the payload. One copy that
 * holds both is not enough on processors of today: it tears. Tails are zero before the first step,
 * steps count from 1, and nothing is ever reset: what stands at an offset has the same size and
 * the same sender in every step.
 *
 * No acknowledgement. A half is written again two steps later. That is safe when the two sides
 * hear from each other in every step (T 6.4): who has received the peer's packet of step n + 1
 * knows that the peer is done with step n. An edge with data in one direction only needs an empty
 * packet (bytes = 0: a tail alone) in the other.
 *
 * Waiting. About 50 polls, then the processor is yielded, so that 12 processors on 2 cores make
 * progress. Every poll lets the backend work where it must (sockets). Every wait has a deadline.
 *
 * Who is lost. Processors of one process share a word. Processes keep the connections of the
 * start-up open, a star around processor zero; a thread of its own in each process (heartbeat.h)
 * says ten times a second that it lives and hears who does not. The first verdict holds for
 * everyone: all waits end with a message that names the same processor. The step loop itself only
 * reads a word in memory.
 *
 * Threads. Several threads of a processor may put and wait at the same time, each on its own
 * packets. Opening, closing and lar_comm_abort belong to one thread.
 *
 * Backends are rows of one table (backend.h, which also says how to add one).
 */
#ifndef LAR_COMM_COMM_H
#define LAR_COMM_COMM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

enum { LAR_COMM_PROCESSORS_MAX = 4096, LAR_COMM_ADDRESS_TEXT = 80 };

/* One processor's end of the parallel computer. */
typedef struct lar_comm lar_comm;

/* What processors that are threads of one process share. */
typedef struct lar_comm_team lar_comm_team;

typedef struct lar_comm_options {
    const char *backend;  /* "threads", "shm", "ucx", "mpi", "tcp" */
    int32_t self, count;  /* this processor, 0..count-1 */
    size_t receive_bytes; /* of one half of the own receive buffer, tails included */
    uint64_t identity;    /* hash of model, schedule and whatever else must agree */
    double time_step;     /* [s] part of that, for a refusal with the reason; 0: not told */
    lar_comm_team *team;  /* backend threads only */
    const char *master;   /* otherwise: "host:port" where processor zero listens (job.h: by MPI) */
    int listener;         /* processor zero: from lar_comm_listen, or -1 to listen at `master`.
                             Taken over by lar_comm_open, whatever it returns */
    double start_timeout; /* for all to come together [s] */
    double timeout;       /* until a dead or silent processor is given up, at most [s] */
    double patience;      /* a wait for a processor that lives [s] */
} lar_comm_options;

/* Backend threads, 1 processor, no team; 20 s to start, 2 s for the dead, 1.7 s
 * for the slow (a report takes up to 0.2 s more). */
lar_comm_options lar_comm_options_default(void);

/* The room in which `count` threads meet. Receive buffers live here: destroy it after all ends are
 * closed. */
lar_status lar_comm_team_create(int32_t count, lar_comm_team **team, lar_error *error);
void lar_comm_team_destroy(lar_comm_team *team);
/* Nobody shall wait for a processor that could not open. The first verdict stands. */
void lar_comm_team_give_up(lar_comm_team *team, int32_t processor);

/* Opens a listening socket for processor zero before the processes start. `address` is
 * "host:port", port 0 takes a free one; *bound gets the address to give to the others. The caller
 * owns *listener until lar_comm_open takes it. */
lar_status lar_comm_listen(const char *address, int *listener, char bound[LAR_COMM_ADDRESS_TEXT],
                           lar_error *error);

/* What lar_comm_open says at processor zero when the listener was shut down (shutdown) by whoever
 * else has it, and knows more: that a processor will not come. */
extern const char lar_comm_called_off[];

/* Ends every wait for others to come, now and later, with the sentence below; who is refused by one
 * that was interrupted gets it too. For signal handlers: safe in them. True while lar_comm_open
 * waits in this process: then it returns within about a second, and has cleaned up. */
bool lar_comm_interrupt(void);
extern const char lar_comm_interrupted[];
/* LAR_ERROR_PEER after lar_comm_interrupt. */
lar_status lar_comm_check_interrupt(lar_error *error);

/* Meets the others and returns when all can write to all. Fails, with the same sentence for
 * everyone, when one does not come in time, or comes with another version, backend, number of
 * processors or identity. */
lar_status lar_comm_open(const lar_comm_options *options, lar_comm **comm, lar_error *error);

/* Leaves. What was put before still arrives. Accepts NULL. A forked child closes its copies of
 * what its parent has, which stays in contact. */
void lar_comm_close(lar_comm *comm);

/* Tells the others that this processor stops because of a failure of its own; their waits end with
 * a message that names it. Then close. */
void lar_comm_abort(lar_comm *comm);

int32_t lar_comm_self(const lar_comm *comm);
int32_t lar_comm_count(const lar_comm *comm);

/* Room that a packet takes in the receive buffer: payload, padding, tail. */
static inline size_t lar_comm_padded(size_t bytes) {
    return (bytes + 7) & ~(size_t)7;
}
static inline size_t lar_comm_packet_bytes(size_t bytes) {
    return lar_comm_padded(bytes) + 8;
}

/* The primitive. `offset` is a multiple of 8 in the half of `step` (1, 2, ...) of the peer's
 * buffer. When it returns, `data` may be used again. A processor may put to itself. */
lar_status lar_comm_put(lar_comm *comm, int32_t peer, size_t offset, const void *data, size_t bytes,
                        uint64_t step, lar_error *error);

/* Where a packet may be gathered in place, so that lar_comm_put with data = that pointer copies
 * nothing: the peer's memory, where it can be written from here. NULL: gather elsewhere. */
void *lar_comm_room(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step);

/* Hints, for places that are right. Where processors share memory they prefetch cache lines while
 * something else is computed: parts of a packet that will be put soon; whether a packet has come
 * (without letting the backend work), and then parts of it. Before that its lines are the sender's
 * to write. */
void lar_comm_prepare(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step);
bool lar_comm_expect(lar_comm *comm, size_t offset, size_t bytes, uint64_t step);
void lar_comm_fetch(lar_comm *comm, size_t offset, size_t bytes, uint64_t step);

/* Waits for the packet of `step` from `peer` at `offset` of the own buffer. *payload (may be NULL)
 * is valid until this processor's first packet of step + 1 to that peer: with it the peer may go
 * on to step + 2. Errors: LAR_ERROR_PEER, naming the lost processor and the last complete step. */
lar_status lar_comm_wait(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step,
                         const void **payload, lar_error *error);

/* The same for the quiet time between commands: no limit while everyone lives (a loss ends it as
 * above; who closed without an abort is no loss), and after 2.5 ms of polling it sleeps, 50 us at
 * first, 1 ms at last, so that waiting costs no processor time and an answer may then come up to 1
 * ms late; what follows within a session's tick is heard at once. `step` counts the packets at this
 * offset, which need not be steps of a simulation: the message of a loss names the step
 * that lar_comm_complete has told, if any. */
lar_status lar_comm_await(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step,
                          const void **payload, lar_error *error);

/* Whether lar_comm_wait is timed from now on; how long it has waited since [s]. For the thread that
 * waits, or while nobody does. */
void lar_comm_time_waits(lar_comm *comm, bool times);
double lar_comm_time_waited(const lar_comm *comm);

/* What messages call the packets of step n: step n + ahead, for who counts packets otherwise than
 * the steps of a simulation (0 at first). While nobody waits. */
void lar_comm_number_steps(lar_comm *comm, int64_t ahead);
/* This processor has completed so many steps and sends none now: what messages say of it while it
 * waits for orders or answers. No other thread uses the connection meanwhile. */
void lar_comm_complete(lar_comm *comm, uint64_t steps);

/* LAR_ERROR_PEER with the sentence when a processor is known to be lost: for who waits for nothing
 * just now. */
lar_status lar_comm_look(lar_comm *comm, lar_error *error);

/* ---- the backends of this build ---------------------------------------------------------- */

/* How its processors are started, and by what they find each other. */
typedef enum lar_comm_start {
    LAR_COMM_BY_ADDRESS, /* as processes (or threads) that know options.master */
    LAR_COMM_BY_TEAM,    /* as threads of one process that share options.team */
    LAR_COMM_BY_LAUNCHER /* as processes of mpirun or srun, which say who is who */
} lar_comm_start;

typedef struct lar_comm_backend_info {
    const char *name;
    const char *summary;
    const char *missing; /* NULL: it is there; otherwise how to get it */
    lar_comm_start start;
} lar_comm_backend_info;

/* Row `index` of the table, default first; false beyond the last. */
bool lar_comm_backend_list(int index, lar_comm_backend_info *info);

#endif
