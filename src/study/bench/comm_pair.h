/* Inside the communication benchmark: two ends, and the packets between them.
 *
 *     a pair    two ends joined by one word, by hand (copy, tail, poll), or by a backend
 *     a job     what both ends do at the same time; end 0 measures
 *
 * The ends are two threads here, each bound to a core; or, started by mpirun, two processes, of
 * which each runs its own end, and both run the same jobs in the same order: whatever decides on
 * the order (how long a job took) goes from end 0 to end 1.
 */
#ifndef LAR_STUDY_BENCH_COMM_PAIR_H
#define LAR_STUDY_BENCH_COMM_PAIR_H

#include "comm/comm.h"
#include "comm/job.h"

/* Packets lie one after the other in blocks, at most so many and so long. */
enum {
    LAR_PAIR_BLOCK_BYTES = 65536,
    LAR_PAIR_BLOCK_MAX = 64,
    LAR_PAIR_HALF_BYTES = LAR_PAIR_BLOCK_BYTES + 8 * LAR_PAIR_BLOCK_MAX + 64,
    LAR_PAIR_PACKET_MAX = 16384
};

typedef enum lar_pair_kind { LAR_PAIR_WORD, LAR_PAIR_HAND, LAR_PAIR_COMM } lar_pair_kind;

typedef struct lar_pair {
    lar_pair_kind kind;
    const char *backend;
    lar_comm_start start;   /* of the backend's processors */
    lar_comm_job *launched; /* the ends are processes of mpirun, one is here; else NULL: both are */
    lar_comm *comm[2];
    lar_comm_team *team;
    int listener;
    char master[LAR_COMM_ADDRESS_TEXT];
    unsigned char *buffer[2]; /* by hand: two halves each */
    uint64_t *word;           /* alone in its cache line */
    uint64_t step[2];         /* of each end */
    uint64_t arrived;         /* atomic: the step whose packets lie there (time in receive) */
    unsigned char *payload;
} lar_pair;

typedef struct lar_pair_job {
    lar_pair *with;
    lar_status (*run)(struct lar_pair_job *job, int end, lar_error *error);
    const int *cores; /* [2] */
    size_t bytes;     /* of a packet */
    int packets;      /* of a block */
    uint64_t rounds;
    void *context;
    double seconds, part; /* of all rounds: in all, and in what is measured besides */
    lar_status status[2];
    lar_error error[2];
} lar_pair_job;

/* Monotonic clock [s]. */
double lar_pair_now(void);

/* Binds the calling thread; does nothing for core -1. */
void lar_pair_bind(int core);

/* Of zeroed memory with kind, backend, start and launched set. Closing accepts what is half open.
 */
lar_status lar_pair_open(lar_pair *pair, const int cores[2], lar_error *error);
void lar_pair_close(lar_pair *pair, const int cores[2]);

/* The block of this end's step, packet after packet; and the other end's. */
lar_status lar_pair_put(lar_pair_job *job, int end, lar_error *error);
lar_status lar_pair_await(lar_pair_job *job, int end, lar_error *error);

/* With twice the rounds again and again until it takes `min` seconds. *rounds is where to begin
 * and what was found. */
lar_status lar_pair_measure(lar_pair_job *job, double min, uint64_t *rounds, lar_error *error);

#endif
