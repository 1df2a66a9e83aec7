/* Timer jitter and scheduling latency: a thread that wakes a thousand times a second, as a
 * session's does (base/deadline_clock.h), and does nothing, or computes for a given time.
 *
 *     due          due          due          due
 *      |.|==load==|  |...|==load==|  |.|==load==|  |.........|==load=|      --seconds, --repeat
 * turns late          late            late          late: done after the next was due, a miss
 *
 * What it cannot do no engine can do on this machine: the floor of every real-time figure. The
 * computation is a number of multiply-adds (fma_peak.h), counted out when the benchmark begins; a
 * loop that looks at the clock would not notice when its core is taken away.
 */
#ifndef LAR_STUDY_BENCH_JITTER_H
#define LAR_STUDY_BENCH_JITTER_H

#include "study/bench/kernel.h"

enum { LAR_BENCH_JITTER_LOAD_MAX = 100000 }; /* [us] */

typedef struct lar_bench_jitter_options {
    double seconds; /* of a turn, up to 3600 */
    int repeat;     /* turns, 1..LAR_BENCH_REPEAT_MAX */
    double load;    /* computed in every tick [us], 0..LAR_BENCH_JITTER_LOAD_MAX */
    int priority;   /* of the thread, SCHED_FIFO 1..99; 0: ordinary */
} lar_bench_jitter_options;

/* Percentiles of all ticks [us], known to 1.6 %; the last is exact. */
typedef struct lar_percentiles {
    double p50, p99, p999, max;
} lar_percentiles;

typedef struct lar_bench_jitter_result {
    double period; /* of the ticks [us] */
    int repeat;
    uint64_t ticks, misses;
    double missed;        /* misses of ticks, 0..1 */
    double skipped;       /* given up [s] */
    lar_percentiles late; /* from due to awake */
    lar_percentiles done; /* from due to the end of the computation */
    lar_spread late_p50;  /* over the turns [us] */
    lar_spread late_p99;
    lar_spread missed_of; /* misses of ticks of each turn */
} lar_bench_jitter_result;

/* Fails for options out of range, and where the system forbids the priority. */
lar_status lar_bench_jitter(const lar_bench_jitter_options *options,
                            lar_bench_jitter_result *result, lar_error *error);

#endif
