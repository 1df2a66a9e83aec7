/* How fast processors can talk here: the thesis's figures 7.4 to 7.8 and 7.18 for every backend, in
 * one run.
 *
 *     core to core   one word goes back and forth between two cores: what the machine can do
 *     by hand        copy, store-release of the tail, poll: what put and wait cannot beat
 *     threads, shm, tcp, ...
 *
 * Two ends, two threads, on two cores of their own where there are two. Samples of all rows take
 * turns, because virtual cores move and figures of different minutes do not compare; the median
 * counts. Started by mpirun -n 2, the ends are processes, and the rows are what joins processes,
 * mpi among them.
 *
 *     latency        half of there and back, one packet (7.6)
 *     half duplex    a block of packets goes over, then back (7.4)
 *     full duplex    both ways at once, both counted (7.5)
 *     send           time in put (7.7)
 *     receive        time in wait when the packet has arrived already (7.8)
 *     delay          of a computation of 20 us by a packet that goes and one that comes (7.18):
 *
 *         put | compute, in the first-level cache | wait      against      compute
 */
#ifndef LAR_STUDY_BENCH_COMM_H
#define LAR_STUDY_BENCH_COMM_H

#include <stdbool.h>

#include "study/bench/kernel.h"

enum {
    LAR_BENCH_COMM_ROWS = 12,
    LAR_BENCH_COMM_BYTES_MAX = 16384,
    LAR_BENCH_COMM_SIZES = 13 /* 8, 16, ... 16384 and the one asked for */
};

typedef struct lar_bench_comm_options {
    int32_t bytes;        /* of a packet, 1..LAR_BENCH_COMM_BYTES_MAX */
    int repeat;           /* samples at this size, 1..LAR_BENCH_REPEAT_MAX; a third at others */
    const char *backends; /* "shm,tcp": only these; NULL: all */
    bool quick;           /* short samples of few sizes: whether it works, not how fast it is */
} lar_bench_comm_options;

/* Figures for one size of packet: medians. */
typedef struct lar_bench_comm_figures {
    double latency;       /* one way [ns] */
    double half_duplex;   /* [MB/s] */
    double full_duplex;   /* both directions together [MB/s] */
    double send, receive; /* [ns] */
    double delay;         /* [ns]; may come out below 0 where it is lost in the noise */
    double slowdown;      /* delay as a part of the computation */
} lar_bench_comm_figures;

typedef struct lar_bench_comm_row {
    const char *name;
    const char *missing;         /* NULL, or how to get this backend; nothing else is set then */
    bool moves_packets;          /* not only a word: all is set; otherwise latency alone */
    lar_spread latency;          /* of the size asked for, one way [ns] */
    double over_hand;            /* latency over that by hand, of each turn, median; 0: unknown */
    double best_half_duplex;     /* of all packet sizes [MB/s] */
    double half_bandwidth_bytes; /* packet size that reaches half of it */
    lar_bench_comm_figures at[LAR_BENCH_COMM_SIZES];
} lar_bench_comm_row;

typedef struct lar_bench_comm_result {
    int32_t bytes;
    int repeat;
    int cores[2];                       /* the ends' cores, -1: not bound */
    int32_t size[LAR_BENCH_COMM_SIZES]; /* ascending */
    int sizes, asked;                   /* how many; which is `bytes` */
    double portion;                     /* of computation to a packet [ns] */
    int rows;                           /* 0 at the second process of mpirun: the first has them */
    lar_bench_comm_row row[LAR_BENCH_COMM_ROWS];
} lar_bench_comm_result;

lar_status lar_bench_comm(const lar_bench_comm_options *options, lar_bench_comm_result *result,
                          lar_error *error);

#endif
