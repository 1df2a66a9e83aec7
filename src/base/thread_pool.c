#include "base/thread_pool.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/pin.h"
#include "base/thread.h"

/* Polls before a waiting thread yields. */
enum { POLLS = 50 };

/* How long it polls and yields before it sleeps [s]: longer than from one tick of a session to the
 * next (1 ms), because being woken takes some 50 us, a tenth of a tick's work. Where threads are
 * more than cores, who stays awake takes time from the one that the next job comes from. */
static const double AWAKE = 2.5e-3, AWAKE_OVERSUBSCRIBED = 0.2e-3;
/* And where no other thread has the core meanwhile. */
static const double AWAKE_URGENT = 0.05e-3;

typedef struct worker {
    lar_thread_pool *pool;
    int32_t number;
    lar_thread thread;
    int before;    /* its own priority */
    double awake;  /* [s] */
    uint64_t done; /* atomic: jobs finished */
} __attribute__((aligned(64))) worker;

struct lar_thread_pool {
    int32_t count, started; /* threads that run, the caller's not among them */
    bool pin;
    int32_t first_core;
    pid_t process;            /* that has the threads */
    double awake;             /* of ordinary threads [s] */
    lar_pin *caller;          /* where the caller's thread was before */
    uint64_t caller_slice;    /* as long as its turns were; see base/thread.h */
    lar_thread_pool_job *job; /* NULL: end */
    void *context;
    uint64_t orders;  /* atomic: jobs given out */
    int32_t sleepers; /* atomic; changed under the lock */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    worker *worker; /* [count] */
};

static void sleep_until_order(lar_thread_pool *pool, uint64_t known) {
    pthread_mutex_lock(&pool->lock);
    __atomic_fetch_add(&pool->sleepers, 1, __ATOMIC_SEQ_CST);
    /* Counted first, looked second: give_order stores first and counts second. */
    while (__atomic_load_n(&pool->orders, __ATOMIC_SEQ_CST) == known)
        pthread_cond_wait(&pool->wake, &pool->lock);
    __atomic_fetch_sub(&pool->sleepers, 1, __ATOMIC_SEQ_CST);
    pthread_mutex_unlock(&pool->lock);
}

static void wait_for_order(const worker *own, uint64_t known) {
    lar_thread_pool *pool = own->pool;
    double until = lar_clock_seconds() + own->awake;
    do {
        for (int i = 0; i < POLLS; i++)
            if (__atomic_load_n(&pool->orders, __ATOMIC_ACQUIRE) != known) return;
        sched_yield();
    } while (lar_clock_seconds() < until);
    sleep_until_order(pool, known);
}

static void *attend(void *argument) {
    worker *own = argument;
    lar_thread_pool *pool = own->pool;
    if (pool->pin) lar_pin_to(pool->first_core + own->number);
    lar_thread_shorten_slice();
    own->before = lar_thread_priority();
    for (uint64_t known = 0;; known++) {
        wait_for_order(own, known);
        if (!pool->job) return NULL;
        pool->job(pool->context, own->number);
        __atomic_store_n(&own->done, known + 1, __ATOMIC_RELEASE);
    }
}

static void give_order(lar_thread_pool *pool, lar_thread_pool_job *job, void *context) {
    pool->job = job;
    pool->context = context;
    __atomic_fetch_add(&pool->orders, 1, __ATOMIC_SEQ_CST);
    if (__atomic_load_n(&pool->sleepers, __ATOMIC_SEQ_CST) == 0) return;
    pthread_mutex_lock(&pool->lock);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
}

lar_status lar_thread_pool_create(int32_t count, bool pin, int32_t first_core,
                                  lar_thread_pool **out, lar_error *error) {
    lar_thread_pool *pool = lar_calloc(1, sizeof *pool);
    if (!pool) return lar_fail_memory(error, sizeof *pool, "threads");
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pool->count = count;
    pool->process = getpid();
    pool->first_core = first_core;
    pool->awake = count <= sysconf(_SC_NPROCESSORS_ONLN) ? AWAKE : AWAKE_OVERSUBSCRIBED;
    pool->pin = pin && lar_pin_cores() >= first_core + count;
    pool->worker = lar_calloc_aligned((size_t)count, sizeof *pool->worker);
    lar_status status =
        pool->worker ? LAR_OK
                     : lar_fail_memory(error, (size_t)count * sizeof *pool->worker, "threads");
    for (int32_t i = 1; i < count && !status; i++) {
        pool->worker[i].pool = pool;
        pool->worker[i].number = i;
        pool->worker[i].awake = pool->awake;
        int cause = lar_thread_start(&pool->worker[i].thread, attend, &pool->worker[i]);
        if (cause)
            status = lar_fail(error, LAR_ERROR_MEMORY,
                              "the system gives no thread %d of %d: %s; use fewer processors or "
                              "threads, free memory, or raise the limit (ulimit -u)",
                              (int)i, (int)count, strerror(cause));
        else
            pool->started++;
    }
    if (status) {
        lar_thread_pool_destroy(pool);
        return status;
    }
    if (pool->pin) {
        pool->caller = lar_pin_remember();
        lar_pin_to(first_core);
    }
    pool->caller_slice = lar_thread_shorten_slice();
    *out = pool;
    return LAR_OK;
}

bool lar_thread_pool_is_here(const lar_thread_pool *pool) {
    return pool->process == getpid();
}

void lar_thread_pool_destroy(lar_thread_pool *pool) {
    if (!pool) return;
    bool here = lar_thread_pool_is_here(pool);
    if (here) give_order(pool, NULL, NULL);
    for (int32_t i = 1; i <= pool->started; i++) lar_thread_join(&pool->worker[i].thread);
    lar_pin_restore(pool->caller);
    lar_thread_restore_slice(pool->caller_slice);
    /* In a forked child these may look as if somebody slept there, who would be waited for. */
    if (here) pthread_cond_destroy(&pool->wake);
    if (here) pthread_mutex_destroy(&pool->lock);
    free(pool->worker);
    free(pool);
}

void lar_thread_pool_run(lar_thread_pool *pool, lar_thread_pool_job *job, void *context) {
    uint64_t order = __atomic_load_n(&pool->orders, __ATOMIC_RELAXED) + 1;
    if (pool->count > 1) give_order(pool, job, context);
    job(context, 0);
    for (int32_t i = 1; i < pool->count; i++)
        for (int polls = 0; __atomic_load_n(&pool->worker[i].done, __ATOMIC_ACQUIRE) != order;)
            if (++polls % POLLS == 0) sched_yield();
}

typedef struct precedence {
    lar_thread_pool *pool;
    int priority;
} precedence;

static void go_before(void *context, int32_t number) {
    const precedence *wanted = context;
    worker *own = &wanted->pool->worker[number];
    if (number == 0) return;
    int priority = wanted->priority > 0 ? wanted->priority : own->before;
    bool urgent = lar_thread_set_priority(priority) == 0 && wanted->priority > 0;
    own->awake = urgent ? fmin(AWAKE_URGENT, wanted->pool->awake) : wanted->pool->awake;
}

void lar_thread_pool_go_before(lar_thread_pool *pool, int priority) {
    if (pool->count > 1) lar_thread_pool_run(pool, go_before, &(precedence){pool, priority});
}

static void wake_up(void *context, int32_t number) {
    (void)context, (void)number;
}

void lar_thread_pool_rouse(lar_thread_pool *pool) {
    if (pool->count > 1) lar_thread_pool_run(pool, wake_up, NULL);
}
