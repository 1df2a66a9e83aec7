/* How fast processors can talk here: the thesis's figures 7.4 to 7.8 for every backend, in one run.
 *
 *     core to core   one word goes back and forth between two cores: what the machine can do
 *     by hand        copy, store-release of the tail, poll: what put and wait cannot beat
 *     threads, shm, tcp, ...
 *
 * Two ends, two threads, on two cores of their own where there are two. Samples of all rows take
 * turns, because virtual cores move and figures of different minutes do not compare; the median
 * counts. Half duplex: a block of packets goes over, then back. Full duplex: both ways at once,
 * both counted. Send: time in put. Receive: time in wait when the packet has arrived already.
 */
#ifndef LAR_STUDY_BENCH_COMM_H
#define LAR_STUDY_BENCH_COMM_H

#include <stdbool.h>

#include "study/bench_kernel.h"

enum { LAR_BENCH_COMM_ROWS = 12, LAR_BENCH_COMM_BYTES_MOST = 16384 };

typedef struct lar_bench_comm_options {
    int32_t bytes; /* of a packet, 1..LAR_BENCH_COMM_BYTES_MOST */
    int repeat;    /* samples, 1..LAR_BENCH_REPEAT_MOST */
} lar_bench_comm_options;

typedef struct lar_bench_comm_row {
    const char *name;
    const char *missing;         /* NULL, or how to get this backend; nothing else is set then */
    lar_spread latency;          /* one way [ns] */
    bool moves_packets;          /* not only a word: the rest is set */
    double half_duplex;          /* [MB/s] */
    double full_duplex;          /* both directions together [MB/s] */
    double send, receive;        /* [ns] */
    double best_half_duplex;     /* of all packet sizes [MB/s] */
    double half_bandwidth_bytes; /* packet size that reaches half of it */
} lar_bench_comm_row;

typedef struct lar_bench_comm_result {
    int32_t bytes;
    int repeat;
    int cores[2]; /* the ends' cores, -1: not bound */
    int rows;
    lar_bench_comm_row row[LAR_BENCH_COMM_ROWS];
} lar_bench_comm_result;

lar_status lar_bench_comm(const lar_bench_comm_options *options, lar_bench_comm_result *result,
                          lar_error *error);

#endif
