#include "study/bench_comm.h"

#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "comm/comm.h"
#include "comm/job.h"

enum { BLOCK_BYTES = 65536, BLOCK_MOST = 64, HALF_BYTES = BLOCK_BYTES + 8 * BLOCK_MOST + 64 };
static const double SAMPLE_TIME = 2e-3; /* [s] at least */

static double now(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* ---- two ends and what is between them ----------------------------------------------------- */

typedef enum pair_kind { PAIR_WORD, PAIR_HAND, PAIR_COMM } pair_kind;

typedef struct pair {
    pair_kind kind;
    const char *backend;
    lar_comm *comm[2];
    lar_comm_team *team;
    int listener;
    char master[LAR_COMM_ADDRESS_TEXT];
    unsigned char *buffer[2]; /* by hand: two halves each */
    uint64_t *word;           /* the word of the core-to-core probe, 64 bytes from its neighbours */
    uint64_t step[2];         /* of each end */
    uint64_t arrived;         /* atomic: the step whose packets lie there (time in receive) */
    unsigned char *payload;
    lar_comm_job *launched; /* the ends are processes of mpirun, one is here; else NULL: both are */
} pair;

/* A job is done by both ends; end 0 measures. */
typedef struct job {
    pair *with;
    lar_status (*run)(struct job *job, int end, lar_error *error);
    const int *cores;
    size_t bytes;
    int packets; /* of a block */
    uint64_t rounds;
    double seconds, send, receive; /* of all rounds */
    lar_status status[2];
    lar_error error[2];
} job;

static void bind_to(int core) {
    cpu_set_t one;
    if (core < 0) return;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    sched_setaffinity(0, sizeof one, &one);
}

static void *other_end(void *context) {
    job *j = context;
    bind_to(j->cores[1]);
    j->status[1] = j->run(j, 1, &j->error[1]);
    return NULL;
}

static lar_status run_both(job *j, lar_error *error) {
    pthread_t thread;
    if (j->with->launched) return j->run(j, j->with->launched->self, error);
    if (pthread_create(&thread, NULL, other_end, j) != 0)
        return lar_fail(error, LAR_ERROR_MEMORY,
                        "no second thread could be started; raise the "
                        "limit on threads");
    j->status[0] = j->run(j, 0, &j->error[0]);
    pthread_join(thread, NULL);
    for (int end = 0; end < 2; end++) {
        if (!j->status[end]) continue;
        if (error) *error = j->error[end];
        return j->status[end];
    }
    return LAR_OK;
}

/* ---- put and wait -------------------------------------------------------------------------- */

static uint64_t *tail_at(unsigned char *buffer, size_t offset, size_t bytes, uint64_t step) {
    return (uint64_t *)(void *)(buffer + (step & 1 ? HALF_BYTES : 0) + offset +
                                lar_comm_padded(bytes));
}

/* Polls; yields only when the other end seems to wait for this very core. */
static void poll_for(const uint64_t *word, uint64_t value) {
    for (int polls = 1; __atomic_load_n(word, __ATOMIC_ACQUIRE) != value; polls++) {
        if (polls % 10000 == 0) sched_yield();
#if defined(__x86_64__)
        __builtin_ia32_pause(); /* two threads of one core: leave it to the other */
#endif
    }
}

static lar_status put(pair *p, int end, size_t offset, size_t bytes, lar_error *error) {
    uint64_t step = p->step[end];
    if (p->kind == PAIR_COMM)
        return lar_comm_put(p->comm[end], 1 - end, offset, p->payload, bytes, step, error);
    if (p->kind == PAIR_HAND) {
        unsigned char *there = p->buffer[1 - end];
        memcpy(there + (step & 1 ? HALF_BYTES : 0) + offset, p->payload, bytes);
        __atomic_store_n(tail_at(there, offset, bytes, step), step, __ATOMIC_RELEASE);
    } else {
        __atomic_store_n(p->word, 2 * step + (uint64_t)end, __ATOMIC_RELEASE);
    }
    return LAR_OK;
}

static lar_status await(pair *p, int end, size_t offset, size_t bytes, lar_error *error) {
    uint64_t step = p->step[end];
    if (p->kind == PAIR_COMM)
        return lar_comm_wait(p->comm[end], 1 - end, offset, bytes, step, NULL, error);
    if (p->kind == PAIR_HAND)
        poll_for(tail_at(p->buffer[end], offset, bytes, step), step);
    else
        poll_for(p->word, 2 * step + (uint64_t)(1 - end));
    return LAR_OK;
}

static lar_status put_block(job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    size_t each = lar_comm_packet_bytes(j->bytes);
    for (int i = 0; i < j->packets && !status; i++)
        status = put(j->with, end, (size_t)i * each, j->bytes, error);
    return status;
}

static lar_status await_block(job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    size_t each = lar_comm_packet_bytes(j->bytes);
    for (int i = 0; i < j->packets && !status; i++)
        status = await(j->with, end, (size_t)i * each, j->bytes, error);
    return status;
}

/* ---- jobs ------------------------------------------------------------------------------------ */

/* There and back, the whole block. Blocks of one packet: latency. The first round, before the clock
 * starts, waits until the other thread runs. */
static lar_status half_duplex(job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    double begin = 0;
    for (uint64_t i = 0; i <= j->rounds && !status; i++) {
        j->with->step[end]++;
        if (end == 0) status = put_block(j, end, error);
        if (!status) status = await_block(j, end, error);
        if (end == 1 && !status) status = put_block(j, end, error);
        if (i == 0) begin = now();
    }
    if (end == 0) j->seconds = now() - begin;
    return status;
}

static lar_status full_duplex(job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    double begin = 0, sending = 0;
    for (uint64_t i = 0; i <= j->rounds && !status; i++) {
        j->with->step[end]++;
        double before = now();
        status = put_block(j, end, error);
        if (i > 0) sending += now() - before;
        if (!status) status = await_block(j, end, error);
        if (i == 0) begin = now();
    }
    if (end == 0) {
        j->seconds = now() - begin;
        j->send = sending;
    }
    return status;
}

/* Receives what has arrived already. A network needs a moment more than the sender's last put. */
static lar_status late_receive(job *j, int end, lar_error *error) {
    pair *p = j->with;
    lar_status status = LAR_OK;
    double receiving = 0;
    for (uint64_t i = 0; i < j->rounds && !status; i++) {
        p->step[end]++;
        status = put_block(j, end, error);
        if (end == 1) {
            __atomic_store_n(&p->arrived, p->step[end], __ATOMIC_RELEASE);
            if (!status) status = await_block(j, end, error);
            continue;
        }
        double until = now() + (p->launched ? 200e-6 : 1); /* another process has another word */
        while (__atomic_load_n(&p->arrived, __ATOMIC_ACQUIRE) != p->step[end] && now() < until)
            sched_yield();
        for (double moment = now() + 50e-6; now() < moment;) continue;
        double before = now();
        if (!status) status = await_block(j, end, error);
        receiving += now() - before;
    }
    if (end == 0) j->receive = j->seconds = receiving;
    return status;
}

/* Under mpirun: the other end learns how long it took, and so decides the same. */
static lar_status share_time(job *j, lar_error *error) {
    pair *p = j->with;
    int end = p->launched->self;
    uint64_t step = ++p->step[end];
    const void *seconds;
    if (end == 0) {
        lar_status status =
            lar_comm_put(p->comm[0], 1, 0, &j->seconds, sizeof j->seconds, step, error);
        return status ? status : lar_comm_wait(p->comm[0], 1, 0, 0, step, NULL, error);
    }
    lar_status status = lar_comm_wait(p->comm[1], 0, 0, sizeof j->seconds, step, &seconds, error);
    if (status) return status;
    memcpy(&j->seconds, seconds, sizeof j->seconds);
    return lar_comm_put(p->comm[1], 0, 0, NULL, 0, step, error);
}

/* Repeats with more rounds until a sample is long enough. *rounds is where to begin and what was
 * found. */
static lar_status measure(job *j, uint64_t *rounds, lar_error *error) {
    for (;;) {
        j->rounds = *rounds;
        lar_status status = run_both(j, error);
        if (!status && j->with->launched) status = share_time(j, error);
        if (status || j->seconds >= SAMPLE_TIME || *rounds >= 1 << 20) return status;
        *rounds *= 2;
    }
}

/* ---- opening and closing -------------------------------------------------------------------- */

static lar_status open_end(job *j, int end, lar_error *error) {
    pair *p = j->with;
    lar_comm_options o = lar_comm_options_default();
    o.backend = p->backend;
    o.self = end;
    o.count = 2;
    o.receive_bytes = HALF_BYTES;
    o.team = p->team;
    o.master = p->master;
    if (end == 0) o.listener = p->listener;
    lar_status status = p->launched ? lar_comm_job_meet(p->launched, &o, error) : LAR_OK;
    return status ? status : lar_comm_open(&o, &p->comm[end], error);
}

/* Both at once: each waits for the other's goodbye. */
static lar_status close_end(job *j, int end, lar_error *error) {
    (void)error;
    lar_comm_close(j->with->comm[end]);
    j->with->comm[end] = NULL;
    return LAR_OK;
}

static lar_status open_pair(pair *p, const int cores[2], lar_error *error) {
    p->payload = lar_calloc_aligned(LAR_BENCH_COMM_BYTES_MOST, 1);
    p->word = lar_calloc_aligned(64, 1);
    for (int end = 0; end < 2; end++) p->buffer[end] = lar_calloc_aligned(2 * HALF_BYTES, 1);
    if (!p->payload || !p->word || !p->buffer[0] || !p->buffer[1])
        return lar_fail_memory(error, 4 * HALF_BYTES, "the benchmark's buffers");
    if (p->kind != PAIR_COMM) return LAR_OK;
    lar_status status = p->launched ? LAR_OK
                        : strcmp(p->backend, "threads") == 0
                            ? lar_comm_team_create(2, &p->team, error)
                            : lar_comm_listen("127.0.0.1:0", &p->listener, p->master, error);
    job j = {.with = p, .run = open_end, .cores = cores};
    return status ? status : run_both(&j, error);
}

static void close_pair(pair *p, const int cores[2]) {
    job j = {.with = p, .run = close_end, .cores = cores};
    if (p->comm[0] || p->comm[1]) run_both(&j, NULL);
    lar_comm_team_destroy(p->team);
    for (int end = 0; end < 2; end++) free(p->buffer[end]);
    free(p->word);
    free(p->payload);
}

/* ---- rows ------------------------------------------------------------------------------------ */

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static lar_spread spread_of(double *samples, int count) {
    qsort(samples, (size_t)count, sizeof *samples, by_size);
    return (lar_spread){samples[0], samples[count / 2], samples[count - 1]};
}

static int packets_of(size_t bytes) {
    size_t packets = BLOCK_BYTES / lar_comm_packet_bytes(bytes);
    return packets > BLOCK_MOST ? BLOCK_MOST : (int)packets;
}

/* [MB/s] of blocks of packets of this size. */
static lar_status bandwidth(pair *p, const int cores[2], size_t bytes, double *half,
                            lar_error *error) {
    uint64_t rounds = 4;
    job j = {.with = p,
             .run = half_duplex,
             .cores = cores,
             .bytes = bytes,
             .packets = packets_of(bytes)};
    lar_status status = measure(&j, &rounds, error);
    *half = 2e-6 * (double)bytes * j.packets * (double)j.rounds / j.seconds;
    return status;
}

/* The least size, between those tried, that reaches half of the best bandwidth. */
static lar_status find_half_bandwidth(pair *p, const int cores[2], lar_bench_comm_row *row,
                                      lar_error *error) {
    enum { SIZES = 12 };
    double speed[SIZES], best = 0;
    for (int i = 0; i < SIZES; i++) {
        lar_status status = bandwidth(p, cores, (size_t)8 << i, &speed[i], error);
        if (status) return status;
        if (speed[i] > best) best = speed[i];
    }
    int i = 0;
    while (speed[i] < 0.5 * best) i++;
    row->best_half_duplex = best;
    row->half_bandwidth_bytes = (double)(8 << i);
    if (i > 0)
        row->half_bandwidth_bytes =
            (8 << (i - 1)) * (1 + (0.5 * best - speed[i - 1]) / (speed[i] - speed[i - 1]));
    return LAR_OK;
}

static lar_status fill_row(pair *p, const int cores[2], size_t bytes, lar_bench_comm_row *row,
                           lar_error *error) {
    uint64_t rounds = 4;
    row->moves_packets = p->kind != PAIR_WORD;
    if (!row->moves_packets) return LAR_OK;
    lar_status status = bandwidth(p, cores, bytes, &row->half_duplex, error);
    job j = {.with = p,
             .run = full_duplex,
             .cores = cores,
             .bytes = bytes,
             .packets = packets_of(bytes)};
    if (!status) status = measure(&j, &rounds, error);
    if (status) return status;
    double packets = (double)j.packets * (double)j.rounds;
    row->full_duplex = 2e-6 * (double)bytes * packets / j.seconds;
    row->send = 1e9 * j.send / packets;
    j.run = late_receive;
    j.rounds = 50;
    status = run_both(&j, error);
    row->receive = 1e9 * j.receive / ((double)j.packets * (double)j.rounds);
    return status ? status : find_half_bandwidth(p, cores, row, error);
}

/* Latencies of all rows in turns. */
static lar_status measure_latencies(pair *pairs, lar_bench_comm_result *r, double *samples,
                                    lar_error *error) {
    uint64_t rounds[LAR_BENCH_COMM_ROWS];
    for (int i = 0; i < r->rows; i++) rounds[i] = 16;
    for (int k = -1; k < r->repeat; k++) /* the first finds the rounds and warms up */
        for (int i = 0; i < r->rows; i++) {
            if (r->row[i].missing) continue;
            job j = {.with = &pairs[i],
                     .run = half_duplex,
                     .cores = r->cores,
                     .bytes = (size_t)r->bytes,
                     .packets = 1};
            lar_status status = measure(&j, &rounds[i], error);
            if (status) return status;
            if (k >= 0) samples[i * r->repeat + k] = 0.5e9 * j.seconds / (double)j.rounds;
        }
    for (int i = 0; i < r->rows; i++)
        if (!r->row[i].missing) r->row[i].latency = spread_of(samples + i * r->repeat, r->repeat);
    return LAR_OK;
}

/* Under mpirun: what joins processes. */
static void list_launched_rows(pair *pairs, lar_bench_comm_result *r, lar_comm_job *launched) {
    lar_comm_backend_info info;
    for (int i = 0; r->rows < LAR_BENCH_COMM_ROWS && lar_comm_backend_list(i, &info); i++) {
        if (info.missing || info.start == LAR_COMM_BY_TEAM) continue;
        pairs[r->rows] = (pair){.kind = PAIR_COMM, .backend = info.name, .launched = launched};
        r->row[r->rows++].name = info.name;
    }
}

static void list_rows(pair *pairs, lar_bench_comm_result *r) {
    lar_comm_backend_info info;
    pairs[0].kind = PAIR_WORD;
    r->row[0].name = "core to core";
    pairs[1].kind = PAIR_HAND;
    r->row[1].name = "by hand";
    for (r->rows = 2; r->rows < LAR_BENCH_COMM_ROWS; r->rows++) {
        if (!lar_comm_backend_list(r->rows - 2, &info)) return;
        pairs[r->rows].kind = PAIR_COMM;
        pairs[r->rows].backend = r->row[r->rows].name = info.name;
        r->row[r->rows].missing = info.missing;
        if (!info.missing && info.start == LAR_COMM_BY_LAUNCHER)
            r->row[r->rows].missing = "mpirun -n 2 lariat bench comm measures it";
    }
}

static void choose_cores(const cpu_set_t *allowed, int cores[2]) {
    int found = 0;
    cores[0] = cores[1] = -1;
    if (CPU_COUNT(allowed) < 2) return;
    for (int core = 0; core < CPU_SETSIZE && found < 2; core++)
        if (CPU_ISSET(core, allowed)) cores[found++] = core;
}

static lar_status measure_rows(lar_bench_comm_result *r, lar_comm_job *launched, lar_error *error) {
    cpu_set_t before;
    CPU_ZERO(&before);
    sched_getaffinity(0, sizeof before, &before);
    pair pairs[LAR_BENCH_COMM_ROWS] = {{.kind = PAIR_WORD}};
    if (launched)
        list_launched_rows(pairs, r, launched);
    else
        list_rows(pairs, r);
    choose_cores(&before, r->cores);
    double *samples = lar_calloc((size_t)(r->rows * r->repeat), sizeof *samples);
    lar_status status =
        samples ? LAR_OK : lar_fail_memory(error, sizeof *samples * 1000, "samples");
    bind_to(r->cores[launched ? launched->self : 0]);
    for (int i = 0; i < r->rows && !status; i++)
        if (!r->row[i].missing) status = open_pair(&pairs[i], r->cores, error);
    if (!status) status = measure_latencies(pairs, r, samples, error);
    for (int i = 0; i < r->rows && !status; i++)
        if (!r->row[i].missing)
            status = fill_row(&pairs[i], r->cores, (size_t)r->bytes, &r->row[i], error);
    for (int i = 0; i < r->rows; i++) close_pair(&pairs[i], r->cores);
    if (r->cores[0] >= 0) sched_setaffinity(0, sizeof before, &before);
    free(samples);
    return status;
}

lar_status lar_bench_comm(const lar_bench_comm_options *options, lar_bench_comm_result *result,
                          lar_error *error) {
    if (options->bytes < 1 || options->bytes > LAR_BENCH_COMM_BYTES_MOST || options->repeat < 1 ||
        options->repeat > LAR_BENCH_REPEAT_MOST)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "packets of %d bytes, %d samples; take 1 to %d bytes and 1 to %d samples",
                        (int)options->bytes, options->repeat, LAR_BENCH_COMM_BYTES_MOST,
                        LAR_BENCH_REPEAT_MOST);
    lar_comm_job launched;
    lar_status status = lar_comm_job_find(&launched, error);
    if (status) return status;
    lar_bench_comm_result r = {.bytes = options->bytes, .repeat = options->repeat};
    if (launched.count > 2)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "%d processors; latency is between two: mpirun -n 2 lariat bench comm",
                          (int)launched.count);
    if (!status) status = measure_rows(&r, launched.count == 2 ? &launched : NULL, error);
    if (launched.self > 0) r.rows = 0;
    lar_status left = lar_comm_job_end(&launched, status != LAR_OK, status ? NULL : error);
    if (!status) status = left;
    if (!status) *result = r;
    return status;
}
