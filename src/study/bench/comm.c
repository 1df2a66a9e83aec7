#include "study/bench/comm.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "study/bench/comm_pair.h"

/* [s] at least. Short, so that most samples are not cut in two by what else runs. */
static const double SAMPLE_TIME = 3e-4, SHORT_TIME = 1e-4;
static const double PORTION = 20e-6; /* of computation [s] */
enum { COMPUTED = 2048 /* doubles: half of a first-level cache */ };

/* What is measured, in the order in which samples lie. */
typedef enum figure { LATENCY, HALF_DUPLEX, FULL_DUPLEX, SEND, RECEIVE, DELAY, FIGURES } figure;

typedef struct bench {
    const lar_bench_comm_options *options;
    lar_bench_comm_result *result;
    lar_comm_job *launched; /* or NULL */
    lar_pair pairs[LAR_BENCH_COMM_ROWS];
    uint64_t latency_rounds[LAR_BENCH_COMM_ROWS];
    double *samples; /* [rows][sizes][FIGURES][repeat] */
    double *numbers; /* [COMPUTED] */
    int sweeps;      /* of a portion */
    uint64_t portions;
} bench;

/* ---- jobs ------------------------------------------------------------------------------------ */

/* There and back, the whole block. Blocks of one packet: latency. The first round, before the clock
 * starts, waits until the other thread runs. */
static lar_status half_duplex(lar_pair_job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    double begin = 0;
    for (uint64_t i = 0; i <= j->rounds && !status; i++) {
        j->with->step[end]++;
        if (end == 0) status = lar_pair_put(j, end, error);
        if (!status) status = lar_pair_await(j, end, error);
        if (end == 1 && !status) status = lar_pair_put(j, end, error);
        if (i == 0) begin = lar_pair_now();
    }
    if (end == 0) j->seconds = lar_pair_now() - begin;
    return status;
}

static lar_status full_duplex(lar_pair_job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    double begin = 0, sending = 0;
    for (uint64_t i = 0; i <= j->rounds && !status; i++) {
        j->with->step[end]++;
        double before = lar_pair_now();
        status = lar_pair_put(j, end, error);
        if (i > 0) sending += lar_pair_now() - before;
        if (!status) status = lar_pair_await(j, end, error);
        if (i == 0) begin = lar_pair_now();
    }
    if (end == 0) {
        j->seconds = lar_pair_now() - begin;
        j->part = sending;
    }
    return status;
}

/* Receives what has arrived already. A network needs a moment more than the sender's last put. */
static lar_status late_receive(lar_pair_job *j, int end, lar_error *error) {
    lar_pair *p = j->with;
    lar_status status = LAR_OK;
    double receiving = 0;
    for (uint64_t i = 0; i < j->rounds && !status; i++) {
        p->step[end]++;
        status = lar_pair_put(j, end, error);
        if (end == 1) {
            __atomic_store_n(&p->arrived, p->step[end], __ATOMIC_RELEASE);
            if (!status) status = lar_pair_await(j, end, error);
            continue;
        }
        double until = lar_pair_now() + (p->launched ? 200e-6 : 1); /* a process: another word */
        /* The other end may be a step ahead already. */
        while (__atomic_load_n(&p->arrived, __ATOMIC_ACQUIRE) < p->step[end] &&
               lar_pair_now() < until)
            sched_yield();
        for (double moment = lar_pair_now() + 50e-6; lar_pair_now() < moment;) continue;
        double before = lar_pair_now();
        if (!status) status = lar_pair_await(j, end, error);
        receiving += lar_pair_now() - before;
    }
    if (end == 0) j->part = receiving;
    return status;
}

static void compute(const bench *b) {
    double *x = b->numbers;
    for (int sweep = 0; sweep < b->sweeps; sweep++)
        for (int i = 0; i < COMPUTED; i++) x[i] = x[i] * 0.75 + 0.25;
}

/* End 0 computes, end 1 polls, whether there are packets or not. */
static lar_status computing(lar_pair_job *j, int end, lar_error *error) {
    lar_pair *p = j->with;
    lar_status status = LAR_OK;
    double begin = 0;
    for (uint64_t i = 0; i <= j->rounds && !status; i++) {
        p->step[end]++;
        status = lar_pair_put(j, end, error);
        if (end == 0) compute(j->context);
        if (!status) status = lar_pair_await(j, end, error);
        if (i == 0) begin = lar_pair_now();
    }
    if (end == 0) j->seconds = lar_pair_now() - begin;
    if (end == 0) __atomic_store_n(&p->arrived, p->step[0], __ATOMIC_RELEASE);
    bool waits = end == 1 && !p->launched && !status;
    while (waits && __atomic_load_n(&p->arrived, __ATOMIC_ACQUIRE) != p->step[1]) sched_yield();
    return status;
}

/* ---- samples --------------------------------------------------------------------------------- */

static double *samples_of(const bench *b, int row, int size, figure what) {
    const lar_bench_comm_result *r = b->result;
    return b->samples +
           (((size_t)row * (size_t)r->sizes + (size_t)size) * FIGURES + what) * (size_t)r->repeat;
}

static double sample_time(const bench *b) {
    return b->options->quick ? SHORT_TIME : SAMPLE_TIME;
}

static int packets_of(size_t bytes) {
    size_t packets = LAR_PAIR_BLOCK_BYTES / lar_comm_packet_bytes(bytes);
    return packets > LAR_PAIR_BLOCK_MAX ? LAR_PAIR_BLOCK_MAX : (int)packets;
}

static lar_status take_latency(bench *b, int row, int size, int k, lar_error *error) {
    lar_pair_job j = {.with = &b->pairs[row],
                      .run = half_duplex,
                      .cores = b->result->cores,
                      .bytes = (size_t)b->result->size[size],
                      .packets = 1};
    lar_status status = lar_pair_measure(&j, sample_time(b), &b->latency_rounds[row], error);
    samples_of(b, row, size, LATENCY)[k] = 0.5e9 * j.seconds / (double)j.rounds;
    return status;
}

static lar_status take_blocks(bench *b, int row, int size, int k, lar_error *error) {
    size_t bytes = (size_t)b->result->size[size];
    uint64_t rounds = 4;
    lar_pair_job j = {.with = &b->pairs[row],
                      .run = half_duplex,
                      .cores = b->result->cores,
                      .bytes = bytes,
                      .packets = packets_of(bytes)};
    lar_status status = lar_pair_measure(&j, sample_time(b), &rounds, error);
    if (status) return status;
    double packets = (double)j.packets * (double)j.rounds;
    samples_of(b, row, size, HALF_DUPLEX)[k] = 2e-6 * (double)bytes * packets / j.seconds;
    j.run = full_duplex;
    if ((status = lar_pair_measure(&j, sample_time(b), &rounds, error))) return status;
    packets = (double)j.packets * (double)j.rounds;
    samples_of(b, row, size, FULL_DUPLEX)[k] = 2e-6 * (double)bytes * packets / j.seconds;
    samples_of(b, row, size, SEND)[k] = 1e9 * j.part / packets;
    j.run = late_receive;
    rounds = b->options->quick ? 2 : 6;
    status = lar_pair_measure(&j, 0, &rounds, error);
    samples_of(b, row, size, RECEIVE)[k] = 1e9 * j.part / ((double)j.packets * (double)j.rounds);
    return status;
}

static lar_status take_delay(bench *b, int row, int size, int k, lar_error *error) {
    lar_pair_job j = {.with = &b->pairs[row],
                      .run = computing,
                      .cores = b->result->cores,
                      .bytes = (size_t)b->result->size[size],
                      .context = b};
    uint64_t rounds = b->portions;
    lar_status status = lar_pair_measure(&j, 0, &rounds, error);
    double alone = j.seconds;
    j.packets = 1;
    if (!status) status = lar_pair_measure(&j, 0, &rounds, error);
    samples_of(b, row, size, DELAY)[k] = 1e9 * (j.seconds - alone) / (double)j.rounds;
    return status;
}

/* All rows in turns; k = -1 finds the rounds and warms up. */
static lar_status take_turn(bench *b, int size, int k, lar_error *error) {
    const lar_bench_comm_result *r = b->result;
    lar_status status = LAR_OK;
    for (int i = 0; i < r->rows && !status; i++)
        if (!r->row[i].missing) status = take_latency(b, i, size, k < 0 ? 0 : k, error);
    for (int i = 0; i < r->rows && !status && k >= 0; i++)
        if (r->row[i].moves_packets) status = take_blocks(b, i, size, k, error);
    for (int i = 0; i < r->rows && !status && k >= 0; i++)
        if (r->row[i].moves_packets) status = take_delay(b, i, size, k, error);
    return status;
}

static int samples_at(const bench *b, int size) {
    const lar_bench_comm_result *r = b->result;
    return size == r->asked ? r->repeat : (r->repeat + 2) / 3;
}

static lar_status take_samples(bench *b, lar_error *error) {
    lar_status status = LAR_OK;
    for (int i = 0; i < LAR_BENCH_COMM_ROWS; i++) b->latency_rounds[i] = 16;
    for (int size = 0; size < b->result->sizes; size++)
        for (int k = -1; k < samples_at(b, size) && !status; k++)
            status = take_turn(b, size, k, error);
    return status;
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* The least size, between those tried, that reaches half of the best bandwidth. */
static void find_half_bandwidth(const lar_bench_comm_result *r, lar_bench_comm_row *row) {
    double best = 0;
    for (int i = 0; i < r->sizes; i++)
        if (row->at[i].half_duplex > best) best = row->at[i].half_duplex;
    int i = 0;
    while (row->at[i].half_duplex < 0.5 * best) i++;
    row->best_half_duplex = best;
    row->half_bandwidth_bytes = (double)r->size[i];
    if (i == 0) return;
    double below = row->at[i - 1].half_duplex, above = row->at[i].half_duplex;
    row->half_bandwidth_bytes =
        r->size[i - 1] + (r->size[i] - r->size[i - 1]) * (0.5 * best - below) / (above - below);
}

/* Before samples are sorted: turn by turn. */
static void compare_with_hand(bench *b, int hand, int row, double *scratch) {
    const lar_bench_comm_result *r = b->result;
    const double *own = samples_of(b, row, r->asked, LATENCY);
    const double *best = samples_of(b, hand, r->asked, LATENCY);
    for (int k = 0; k < r->repeat; k++) scratch[k] = own[k] / best[k];
    b->result->row[row].over_hand = lar_spread_of(scratch, r->repeat).median;
}

static void fill_row(bench *b, int row) {
    lar_bench_comm_result *r = b->result;
    lar_bench_comm_row *to = &r->row[row];
    for (int size = 0; size < r->sizes; size++) {
        lar_spread of[FIGURES];
        for (figure what = 0; what < FIGURES; what++)
            of[what] = lar_spread_of(samples_of(b, row, size, what), samples_at(b, size));
        if (size == r->asked) to->latency = of[LATENCY];
        to->at[size] = (lar_bench_comm_figures){.latency = of[LATENCY].median,
                                                .half_duplex = of[HALF_DUPLEX].median,
                                                .full_duplex = of[FULL_DUPLEX].median,
                                                .send = of[SEND].median,
                                                .receive = of[RECEIVE].median,
                                                .delay = of[DELAY].median,
                                                .slowdown = of[DELAY].median / r->portion};
    }
    if (to->moves_packets) find_half_bandwidth(r, to);
}

static lar_status fill_rows(bench *b, lar_error *error) {
    lar_bench_comm_result *r = b->result;
    double *scratch = lar_calloc((size_t)r->repeat, sizeof *scratch);
    if (!scratch) return lar_fail_memory(error, (size_t)r->repeat * sizeof *scratch, "samples");
    for (int hand = 0; hand < r->rows; hand++)
        for (int i = 0; b->pairs[hand].kind == LAR_PAIR_HAND && i < r->rows; i++)
            if (r->row[i].moves_packets) compare_with_hand(b, hand, i, scratch);
    free(scratch);
    for (int i = 0; i < r->rows; i++)
        if (!r->row[i].missing) fill_row(b, i);
    return LAR_OK;
}

/* ---- what to measure ------------------------------------------------------------------------ */

static bool name_in_list(const char *name, const char *list) {
    size_t length = strlen(name);
    for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL)
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0'))
            return true;
    return false;
}

/* Every word of the list must be a backend. */
static lar_status check_list(const char *list, lar_error *error) {
    for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        lar_comm_backend_info info;
        size_t length = strcspn(at, ",");
        bool found = false;
        for (int i = 0; !found && lar_comm_backend_list(i, &info); i++)
            found = strlen(info.name) == length && strncmp(at, info.name, length) == 0;
        if (!found)
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "there is no communication backend %.*s; lariat bench comm lists them",
                            (int)length, at);
    }
    return LAR_OK;
}

static void add_row(bench *b, lar_pair pair, const char *name, const char *missing) {
    lar_bench_comm_result *r = b->result;
    if (r->rows == LAR_BENCH_COMM_ROWS) return;
    b->pairs[r->rows] = pair;
    r->row[r->rows++] = (lar_bench_comm_row){
        .name = name, .missing = missing, .moves_packets = !missing && pair.kind != LAR_PAIR_WORD};
}

/* Under mpirun: what joins processes. */
static void list_rows(bench *b) {
    const char *only = b->options->backends;
    lar_comm_backend_info info;
    if (!b->launched) {
        add_row(b, (lar_pair){.kind = LAR_PAIR_WORD}, "core to core", NULL);
        add_row(b, (lar_pair){.kind = LAR_PAIR_HAND}, "by hand", NULL);
    }
    for (int i = 0; lar_comm_backend_list(i, &info); i++) {
        if (only && !name_in_list(info.name, only)) continue;
        if (b->launched && (info.missing || info.start == LAR_COMM_BY_TEAM)) continue;
        if (!info.missing && !b->launched && info.start == LAR_COMM_BY_LAUNCHER)
            info.missing = "mpirun -n 2 lariat bench comm measures it";
        lar_pair pair = {.kind = LAR_PAIR_COMM,
                         .backend = info.name,
                         .start = info.start,
                         .launched = b->launched};
        add_row(b, pair, info.name, info.missing);
    }
}

static void list_sizes(const lar_bench_comm_options *options, lar_bench_comm_result *r) {
    for (int32_t size = 8; size <= LAR_BENCH_COMM_BYTES_MAX; size *= options->quick ? 2048 : 2)
        r->size[r->sizes++] = size;
    int at = 0;
    while (at < r->sizes && r->size[at] < options->bytes) at++;
    r->asked = at;
    if (at < r->sizes && r->size[at] == options->bytes) return;
    memmove(&r->size[at + 1], &r->size[at], (size_t)(r->sizes++ - at) * sizeof r->size[0]);
    r->size[at] = options->bytes;
}

static void choose_cores(const cpu_set_t *allowed, int cores[2]) {
    int found = 0;
    cores[0] = cores[1] = -1;
    if (CPU_COUNT(allowed) < 2) return;
    for (int core = 0; core < CPU_SETSIZE && found < 2; core++)
        if (CPU_ISSET(core, allowed)) cores[found++] = core;
}

/* How many sweeps are a portion; the best of several, because something else may run. */
static void calibrate(bench *b) {
    double best = 1;
    b->portions = b->options->quick ? 5 : 15;
    b->sweeps = 100;
    for (int i = 0; i < 10; i++) {
        double begin = lar_pair_now();
        compute(b);
        double time = lar_pair_now() - begin;
        if (time < best) best = time;
    }
    double sweeps = 100 * PORTION / best;
    b->sweeps = sweeps > 1 ? (int)(sweeps + 0.5) : 1;
    b->result->portion = 1e9 * best * b->sweeps / 100;
}

static lar_status measure(bench *b, lar_error *error) {
    lar_bench_comm_result *r = b->result;
    size_t samples = (size_t)(r->rows * r->sizes) * FIGURES * (size_t)r->repeat;
    b->samples = lar_calloc(samples, sizeof *b->samples);
    b->numbers = lar_calloc_aligned(COMPUTED, sizeof *b->numbers);
    if (!b->samples || !b->numbers)
        return lar_fail_memory(error, samples * sizeof *b->samples, "samples");
    calibrate(b);
    lar_status status = LAR_OK;
    for (int i = 0; i < r->rows && !status; i++)
        if (!r->row[i].missing) status = lar_pair_open(&b->pairs[i], r->cores, error);
    if (!status) status = take_samples(b, error);
    if (!status) status = fill_rows(b, error);
    for (int i = 0; i < r->rows; i++) lar_pair_close(&b->pairs[i], r->cores);
    return status;
}

static lar_status measure_bound(const lar_bench_comm_options *options, lar_comm_job *launched,
                                lar_bench_comm_result *r, lar_error *error) {
    bench *b = lar_calloc(1, sizeof *b);
    if (!b) return lar_fail_memory(error, sizeof *b, "the benchmark");
    b->options = options;
    b->result = r;
    b->launched = launched;
    cpu_set_t before;
    CPU_ZERO(&before);
    sched_getaffinity(0, sizeof before, &before);
    list_sizes(options, r);
    list_rows(b);
    choose_cores(&before, r->cores);
    lar_pair_bind(r->cores[launched ? launched->self : 0]);
    lar_status status = measure(b, error);
    if (r->cores[0] >= 0) sched_setaffinity(0, sizeof before, &before);
    free(b->samples);
    free(b->numbers);
    free(b);
    return status;
}

lar_status lar_bench_comm(const lar_bench_comm_options *options, lar_bench_comm_result *result,
                          lar_error *error) {
    if (options->bytes < 1 || options->bytes > LAR_BENCH_COMM_BYTES_MAX || options->repeat < 1 ||
        options->repeat > LAR_BENCH_REPEAT_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "packets of %d bytes, %d samples; take 1 to %d bytes and 1 to %d samples",
                        (int)options->bytes, options->repeat, LAR_BENCH_COMM_BYTES_MAX,
                        LAR_BENCH_REPEAT_MAX);
    lar_status status = check_list(options->backends, error);
    lar_comm_job launched;
    if (!status) status = lar_comm_job_find(&launched, error);
    if (status) return status;
    lar_bench_comm_result *r = lar_calloc(1, sizeof *r);
    if (!r) status = lar_fail_memory(error, sizeof *r, "the benchmark");
    if (!status && launched.count > 2)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "%d processors; latency is between two: mpirun -n 2 lariat bench comm",
                          (int)launched.count);
    if (!status) {
        r->bytes = options->bytes;
        r->repeat = options->repeat;
        status = measure_bound(options, launched.count == 2 ? &launched : NULL, r, error);
        if (launched.self > 0) r->rows = 0;
    }
    lar_status left = lar_comm_job_end(&launched, status != LAR_OK, status ? NULL : error);
    if (!status) status = left;
    if (!status) *result = *r;
    free(r);
    return status;
}
