#include "module.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

struct python_pool {
    int wanted, started; /* threads beside the caller's */
    pthread_t *thread;   /* [wanted] */
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    /* Under the lock. */
    uint64_t round; /* jobs given out */
    int working;    /* threads that have not finished the present one */
    bool end;
    /* Of the job; constant while it lasts. */
    int items;
    python_pool_work *work;
    void *context;
    int next; /* atomic: the first item that nobody has taken */
};

static void do_items(python_pool *pool, bool caller) {
    int item;
    while ((item = __atomic_fetch_add(&pool->next, 1, __ATOMIC_RELAXED)) < pool->items)
        pool->work(pool->context, item, caller);
}

static void *attend(void *argument) {
    python_pool *pool = argument;
    uint64_t known = 0;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        while (pool->round == known && !pool->end) pthread_cond_wait(&pool->wake, &pool->lock);
        if (pool->end) break;
        known = pool->round;
        pthread_mutex_unlock(&pool->lock);
        do_items(pool, false);
        pthread_mutex_lock(&pool->lock);
        if (--pool->working == 0) pthread_cond_signal(&pool->done);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

python_pool *python_pool_create(int threads) {
    python_pool *pool = calloc(1, sizeof *pool);
    pthread_t *thread = calloc((size_t)threads, sizeof *thread);
    if (!pool || !thread) {
        free(pool);
        free(thread);
        return NULL;
    }
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_cond_init(&pool->done, &clock);
    pthread_condattr_destroy(&clock);
    pthread_cond_init(&pool->wake, NULL);
    pthread_mutex_init(&pool->lock, NULL);
    pool->wanted = threads - 1;
    pool->thread = thread;
    return pool;
}

/* Signals are for the interpreter's own threads. */
static void start(python_pool *pool) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->started < pool->wanted &&
           pthread_create(&pool->thread[pool->started], NULL, attend, pool) == 0)
        pool->started++;
    pool->wanted = pool->started;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void python_pool_destroy(python_pool *pool, bool lost) {
    if (!pool || lost) return;
    pthread_mutex_lock(&pool->lock);
    pool->end = true;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    for (int i = 0; i < pool->started; i++) pthread_join(pool->thread[i], NULL);
    pthread_cond_destroy(&pool->wake);
    pthread_cond_destroy(&pool->done);
    pthread_mutex_destroy(&pool->lock);
    free(pool->thread);
    free(pool);
}

/* Under the lock. */
static void wait_for_others(python_pool *pool, python_pool_wait *wait, void *context) {
    static const long TENTH = 100000000; /* [ns] */
    while (pool->working > 0) {
        struct timespec until;
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += TENTH;
        if (until.tv_nsec >= 1000000000) {
            until.tv_nsec -= 1000000000;
            until.tv_sec++;
        }
        if (pthread_cond_timedwait(&pool->done, &pool->lock, &until) != ETIMEDOUT) continue;
        pthread_mutex_unlock(&pool->lock);
        wait(context);
        pthread_mutex_lock(&pool->lock);
    }
}

void python_pool_run(python_pool *pool, int items, python_pool_work *work, python_pool_wait *wait,
                     void *context) {
    bool together = items > 1 && pool->wanted > 0;
    if (together && pool->started == 0) start(pool);
    pthread_mutex_lock(&pool->lock);
    pool->items = items;
    pool->work = work;
    pool->context = context;
    __atomic_store_n(&pool->next, 0, __ATOMIC_RELAXED);
    if (together) {
        pool->working = pool->started;
        pool->round++;
        pthread_cond_broadcast(&pool->wake);
    }
    pthread_mutex_unlock(&pool->lock);
    do_items(pool, true);
    pthread_mutex_lock(&pool->lock);
    wait_for_others(pool, wait, context);
    pthread_mutex_unlock(&pool->lock);
}
