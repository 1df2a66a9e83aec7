/* The clock that only goes forward: for measuring, for pacing, for waiting until a moment.
 */
#ifndef LAR_BASE_CLOCK_H
#define LAR_BASE_CLOCK_H

#include <stdint.h>
#include <time.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

/* Since some moment in the past [ns]. */
static inline int64_t lar_clock_ns(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (int64_t)at.tv_sec * 1000000000 + at.tv_nsec;
}

/* The same in seconds, to better than a microsecond. */
static inline double lar_clock_seconds(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* What the calling thread has had of a processor [ns]. */
static inline int64_t lar_clock_thread_ns(void) {
    struct timespec at;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &at);
    return (int64_t)at.tv_sec * 1000000000 + at.tv_nsec;
}

/* Sleeps until that moment [ns], or until a signal comes. */
static inline void lar_clock_sleep_until(int64_t ns) {
    struct timespec at = {ns / 1000000000, ns % 1000000000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
}

/* The same, but exactly: sleeps until `early` ns before and looks at the clock from there. A thread
 * that only sleeps wakes late by what the system takes to wake it. */
static inline void lar_clock_wait_until(int64_t ns, int64_t early) {
    if (ns - early > lar_clock_ns()) lar_clock_sleep_until(ns - early);
    while (lar_clock_ns() < ns) continue;
}

/* The calling thread wakes as promptly as the system can: Linux lets others wake up to 50 us late
 * to save energy. */
static inline void lar_clock_be_prompt(void) {
#ifdef PR_SET_TIMERSLACK
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
#endif
}

#endif
