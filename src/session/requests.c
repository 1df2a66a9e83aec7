#include "session/requests.h"

#include <errno.h>
#include <time.h>

void lar_requests_create(lar_requests *requests) {
    pthread_condattr_t steady;
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_mutex_init(&requests->lock, NULL);
    pthread_cond_init(&requests->work, &steady);
    pthread_cond_init(&requests->bell, &steady);
    pthread_condattr_destroy(&steady);
}

void lar_requests_destroy(lar_requests *requests) {
    pthread_cond_destroy(&requests->bell);
    pthread_cond_destroy(&requests->work);
    pthread_mutex_destroy(&requests->lock);
}

static bool wait_on(lar_requests *requests, pthread_cond_t *condition, int64_t deadline) {
    struct timespec at = {deadline / 1000000000, deadline % 1000000000};
    return pthread_cond_timedwait(condition, &requests->lock, &at) != ETIMEDOUT;
}

void lar_requests_place(lar_requests *requests, const lar_request *request) {
    while (requests->placed - requests->taken == LAR_REQUESTS_MAX)
        pthread_cond_wait(&requests->bell, &requests->lock);
    requests->ring[requests->placed % LAR_REQUESTS_MAX] = *request;
    __atomic_store_n(&requests->placed, requests->placed + 1, __ATOMIC_RELEASE);
    pthread_cond_signal(&requests->work);
}

bool lar_requests_wait(lar_requests *requests, int64_t deadline) {
    return wait_on(requests, &requests->bell, deadline);
}

bool lar_requests_take(lar_requests *requests, lar_request *request) {
    if (requests->placed == requests->taken) return false;
    bool full = requests->placed - requests->taken == LAR_REQUESTS_MAX;
    *request = requests->ring[requests->taken % LAR_REQUESTS_MAX];
    requests->taken++;
    if (full) pthread_cond_broadcast(&requests->bell);
    return true;
}

bool lar_requests_next(lar_requests *requests, lar_request *request) {
    /* Only the engine changes `taken`. */
    if (__atomic_load_n(&requests->placed, __ATOMIC_ACQUIRE) == requests->taken) return false;
    if (pthread_mutex_trylock(&requests->lock)) return false;
    bool any = lar_requests_take(requests, request);
    pthread_mutex_unlock(&requests->lock);
    return any;
}

void lar_requests_answer(lar_requests *requests, lar_request_answer *answer) {
    pthread_mutex_lock(&requests->lock);
    answer->done = true;
    pthread_cond_broadcast(&requests->bell);
    pthread_mutex_unlock(&requests->lock);
}

void lar_requests_ring(lar_requests *requests) {
    requests->ring_the_bell = pthread_mutex_trylock(&requests->lock) != 0;
    if (requests->ring_the_bell) return;
    pthread_cond_broadcast(&requests->bell);
    pthread_mutex_unlock(&requests->lock);
}

void lar_requests_sleep(lar_requests *requests, bool (*wanted)(void *context), void *context,
                        int64_t deadline) {
    pthread_mutex_lock(&requests->lock);
    if (requests->ring_the_bell) pthread_cond_broadcast(&requests->bell);
    requests->ring_the_bell = false;
    if (requests->placed == requests->taken && !wanted(context))
        wait_on(requests, &requests->work, deadline);
    pthread_mutex_unlock(&requests->lock);
}
