#include "study/bench/comm_pair.h"

#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"

double lar_pair_now(void) {
    return lar_clock_seconds();
}

void lar_pair_bind(int core) {
    cpu_set_t one;
    if (core < 0) return;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    sched_setaffinity(0, sizeof one, &one);
}

/* ---- both ends at once --------------------------------------------------------------------- */

static void *other_end(void *context) {
    lar_pair_job *j = context;
    lar_pair_bind(j->cores[1]);
    j->status[1] = j->run(j, 1, &j->error[1]);
    return NULL;
}

/* Under mpirun: the other end learns how long it took, and so decides the same. Both have then
 * received everything: MPI sends large packets only while the sender waits or puts. */
static lar_status share_time(lar_pair_job *j, lar_error *error) {
    lar_pair *p = j->with;
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

/* Both ends, once, with j->rounds. The caller is end 0, or the process's own end. */
static lar_status run_pair(lar_pair_job *j, lar_error *error) {
    pthread_t thread;
    if (j->with->launched) {
        int self = j->with->launched->self;
        lar_status status = j->run(j, self, error);
        bool open = j->with->comm[self] != NULL; /* not after closing */
        return status || !open ? status : share_time(j, error);
    }
    int cause = pthread_create(&thread, NULL, other_end, j);
    if (cause) return lar_fail_thread(error, cause, "the other end");
    j->status[0] = j->run(j, 0, &j->error[0]);
    pthread_join(thread, NULL);
    for (int end = 0; end < 2; end++) {
        if (!j->status[end]) continue;
        if (error) *error = j->error[end];
        return j->status[end];
    }
    return LAR_OK;
}

lar_status lar_pair_measure(lar_pair_job *j, double min, uint64_t *rounds, lar_error *error) {
    for (;;) {
        j->rounds = *rounds;
        lar_status status = run_pair(j, error);
        if (status || j->seconds >= min || *rounds >= 1 << 20) return status;
        *rounds *= 2;
    }
}

/* ---- put and wait -------------------------------------------------------------------------- */

static uint64_t *tail_at(unsigned char *buffer, size_t offset, size_t bytes, uint64_t step) {
    return (uint64_t *)(void *)(buffer + (step & 1 ? LAR_PAIR_HALF_BYTES : 0) + offset +
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

static lar_status put(lar_pair *p, int end, size_t offset, size_t bytes, lar_error *error) {
    uint64_t step = p->step[end];
    if (p->kind == LAR_PAIR_COMM)
        return lar_comm_put(p->comm[end], 1 - end, offset, p->payload, bytes, step, error);
    if (p->kind == LAR_PAIR_HAND) {
        unsigned char *there = p->buffer[1 - end];
        memcpy(there + (step & 1 ? LAR_PAIR_HALF_BYTES : 0) + offset, p->payload, bytes);
        __atomic_store_n(tail_at(there, offset, bytes, step), step, __ATOMIC_RELEASE);
    } else {
        __atomic_store_n(p->word, 2 * step + (uint64_t)end, __ATOMIC_RELEASE);
    }
    return LAR_OK;
}

static lar_status await(lar_pair *p, int end, size_t offset, size_t bytes, lar_error *error) {
    uint64_t step = p->step[end];
    if (p->kind == LAR_PAIR_COMM)
        return lar_comm_wait(p->comm[end], 1 - end, offset, bytes, step, NULL, error);
    if (p->kind == LAR_PAIR_HAND)
        poll_for(tail_at(p->buffer[end], offset, bytes, step), step);
    else
        poll_for(p->word, 2 * step + (uint64_t)(1 - end));
    return LAR_OK;
}

lar_status lar_pair_put(lar_pair_job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    size_t each = lar_comm_packet_bytes(j->bytes);
    for (int i = 0; i < j->packets && !status; i++)
        status = put(j->with, end, (size_t)i * each, j->bytes, error);
    return status;
}

lar_status lar_pair_await(lar_pair_job *j, int end, lar_error *error) {
    lar_status status = LAR_OK;
    size_t each = lar_comm_packet_bytes(j->bytes);
    for (int i = 0; i < j->packets && !status; i++)
        status = await(j->with, end, (size_t)i * each, j->bytes, error);
    return status;
}

/* ---- opening and closing -------------------------------------------------------------------- */

static lar_status open_end(lar_pair_job *j, int end, lar_error *error) {
    lar_pair *p = j->with;
    lar_comm_options o = lar_comm_options_default();
    o.backend = p->backend;
    o.self = end;
    o.count = 2;
    o.receive_bytes = LAR_PAIR_HALF_BYTES;
    o.team = p->team;
    o.timeout = o.patience = 30; /* also on a machine that has much else to do */
    o.master = p->master;
    if (end == 0) o.listener = p->listener;
    lar_status status = p->launched ? lar_comm_job_meet(p->launched, &o, error) : LAR_OK;
    if (!status) status = lar_comm_open(&o, &p->comm[end], error);
    return status ? status : lar_comm_check_interrupt(error);
}

/* Both at once: each waits for the other's goodbye. */
static lar_status close_end(lar_pair_job *j, int end, lar_error *error) {
    (void)error;
    lar_comm_close(j->with->comm[end]);
    j->with->comm[end] = NULL;
    return LAR_OK;
}

lar_status lar_pair_open(lar_pair *p, const int cores[2], lar_error *error) {
    p->listener = -1;
    p->payload = lar_calloc_aligned(LAR_PAIR_PACKET_MAX, 1);
    p->word = lar_calloc_aligned(64, 1);
    for (int end = 0; end < 2; end++)
        p->buffer[end] = lar_calloc_aligned(2 * LAR_PAIR_HALF_BYTES, 1);
    if (!p->payload || !p->word || !p->buffer[0] || !p->buffer[1])
        return lar_fail_memory(error, 4 * LAR_PAIR_HALF_BYTES, "the benchmark's buffers");
    if (p->kind != LAR_PAIR_COMM) return LAR_OK;
    lar_status status = LAR_OK;
    if (!p->launched && p->start == LAR_COMM_BY_TEAM)
        status = lar_comm_team_create(2, &p->team, error);
    else if (!p->launched)
        status = lar_comm_listen("127.0.0.1:0", &p->listener, p->master, error);
    lar_pair_job j = {.with = p, .run = open_end, .cores = cores};
    return status ? status : run_pair(&j, error);
}

void lar_pair_close(lar_pair *p, const int cores[2]) {
    lar_pair_job j = {.with = p, .run = close_end, .cores = cores};
    if (p->comm[0] || p->comm[1]) run_pair(&j, NULL);
    lar_comm_team_destroy(p->team);
    for (int end = 0; end < 2; end++) free(p->buffer[end]);
    free(p->word);
    free(p->payload);
}
