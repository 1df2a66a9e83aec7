#include "base/crew.h"

#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/pin.h"

/* Polls before a waiting thread yields. */
enum { POLLS = 50 };

/* How long it polls and yields before it sleeps [s]: longer than from one tick of a session to the
 * next (1 ms), because being woken takes some 50 us, a tenth of a tick's work. Where threads are
 * more than cores, who stays awake takes time from the one that the next job comes from. */
static const double AWAKE = 2.5e-3, AWAKE_IN_A_CROWD = 0.2e-3;

typedef struct seat {
    lar_crew *crew;
    int32_t number;
    pthread_t thread;
    uint64_t done; /* atomic: jobs finished */
} __attribute__((aligned(64))) seat;

struct lar_crew {
    int32_t count, started; /* threads that run, the caller's not among them */
    bool pin;
    int32_t first_core;
    double awake;      /* [s] */
    lar_pin *caller;   /* where the caller's thread was before */
    lar_crew_job *job; /* NULL: go home */
    void *context;
    uint64_t orders;  /* atomic: jobs given out */
    int32_t sleepers; /* atomic; changed under the lock */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    seat *seat; /* [count] */
};

static void sleep_until_order(lar_crew *crew, uint64_t known) {
    pthread_mutex_lock(&crew->lock);
    __atomic_fetch_add(&crew->sleepers, 1, __ATOMIC_SEQ_CST);
    /* Counted first, looked second: give_order stores first and counts second. */
    while (__atomic_load_n(&crew->orders, __ATOMIC_SEQ_CST) == known)
        pthread_cond_wait(&crew->wake, &crew->lock);
    __atomic_fetch_sub(&crew->sleepers, 1, __ATOMIC_SEQ_CST);
    pthread_mutex_unlock(&crew->lock);
}

static void wait_for_order(lar_crew *crew, uint64_t known) {
    double until = lar_clock_seconds() + crew->awake;
    do {
        for (int i = 0; i < POLLS; i++)
            if (__atomic_load_n(&crew->orders, __ATOMIC_ACQUIRE) != known) return;
        sched_yield();
    } while (lar_clock_seconds() < until);
    sleep_until_order(crew, known);
}

static void *attend(void *argument) {
    seat *own = argument;
    lar_crew *crew = own->crew;
    if (crew->pin) lar_pin_to(crew->first_core + own->number);
    for (uint64_t known = 0;; known++) {
        wait_for_order(crew, known);
        if (!crew->job) return NULL;
        crew->job(crew->context, own->number);
        __atomic_store_n(&own->done, known + 1, __ATOMIC_RELEASE);
    }
}

static void give_order(lar_crew *crew, lar_crew_job *job, void *context) {
    crew->job = job;
    crew->context = context;
    __atomic_fetch_add(&crew->orders, 1, __ATOMIC_SEQ_CST);
    if (__atomic_load_n(&crew->sleepers, __ATOMIC_SEQ_CST) == 0) return;
    pthread_mutex_lock(&crew->lock);
    pthread_cond_broadcast(&crew->wake);
    pthread_mutex_unlock(&crew->lock);
}

lar_status lar_crew_create(int32_t count, bool pin, int32_t first_core, lar_crew **out,
                           lar_error *error) {
    lar_crew *crew = lar_calloc(1, sizeof *crew);
    if (!crew) return lar_fail_memory(error, sizeof *crew, "threads");
    pthread_mutex_init(&crew->lock, NULL);
    pthread_cond_init(&crew->wake, NULL);
    crew->count = count;
    crew->first_core = first_core;
    crew->awake = count <= sysconf(_SC_NPROCESSORS_ONLN) ? AWAKE : AWAKE_IN_A_CROWD;
    crew->pin = pin && lar_pin_cores() >= first_core + count;
    crew->seat = lar_calloc_aligned((size_t)count, sizeof *crew->seat);
    lar_status status =
        crew->seat ? LAR_OK : lar_fail_memory(error, (size_t)count * sizeof *crew->seat, "threads");
    for (int32_t i = 1; i < count && !status; i++) {
        crew->seat[i].crew = crew;
        crew->seat[i].number = i;
        int cause = pthread_create(&crew->seat[i].thread, NULL, attend, &crew->seat[i]);
        if (cause)
            status = lar_fail(error, LAR_ERROR_MEMORY,
                              "the system gives no thread %d of %d: %s; use fewer processors or "
                              "threads, free memory, or raise the limit (ulimit -u)",
                              (int)i, (int)count, strerror(cause));
        else
            crew->started++;
    }
    if (status) {
        lar_crew_destroy(crew);
        return status;
    }
    if (crew->pin) {
        crew->caller = lar_pin_remember();
        lar_pin_to(first_core);
    }
    *out = crew;
    return LAR_OK;
}

void lar_crew_destroy(lar_crew *crew) {
    if (!crew) return;
    give_order(crew, NULL, NULL);
    for (int32_t i = 1; i <= crew->started; i++) pthread_join(crew->seat[i].thread, NULL);
    lar_pin_restore(crew->caller);
    pthread_cond_destroy(&crew->wake);
    pthread_mutex_destroy(&crew->lock);
    free(crew->seat);
    free(crew);
}

void lar_crew_run(lar_crew *crew, lar_crew_job *job, void *context) {
    uint64_t order = __atomic_load_n(&crew->orders, __ATOMIC_RELAXED) + 1;
    if (crew->count > 1) give_order(crew, job, context);
    job(context, 0);
    for (int32_t i = 1; i < crew->count; i++)
        for (int polls = 0; __atomic_load_n(&crew->seat[i].done, __ATOMIC_ACQUIRE) != order;)
            if (++polls % POLLS == 0) sched_yield();
}
