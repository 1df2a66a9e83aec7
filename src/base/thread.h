/* Threads of the library's own. */
#ifndef LAR_BASE_THREAD_H
#define LAR_BASE_THREAD_H

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>

/* Starts a thread that takes no signals: they are for the threads of the program. With a
 * `priority` of 1 to 99 it goes before all ordinary threads of the machine (SCHED_FIFO), which the
 * system may forbid; 0: ordinary. Returns 0 or an errno. */
static inline int lar_thread_start_urgent(pthread_t *thread, int priority, void *(*run)(void *),
                                          void *context) {
    struct sched_param urgency = {.sched_priority = priority};
    pthread_attr_t attributes;
    sigset_t all, before;
    pthread_attr_init(&attributes);
    if (priority > 0) {
        pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
        pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
        pthread_attr_setschedparam(&attributes, &urgency);
    }
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int cause = pthread_create(thread, &attributes, run, context);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return cause;
}

static inline int lar_thread_start(pthread_t *thread, void *(*run)(void *), void *context) {
    return lar_thread_start_urgent(thread, 0, run, context);
}

/* Lets the calling thread take its turns in slices of 0.1 ms, where it had longer ones, and returns
 * these for lar_thread_restore_slice [ns]; 0: nothing was changed. For threads that wait for each
 * other in every step: another program on the same core has it for a slice each time that they let
 * it, 3 ms by itself, and less beside a thread whose turns are short. Linux has slices of a
 * thread's own since 6.12; elsewhere, and for threads that go before others, nothing happens. */
uint64_t lar_thread_shorten_slice(void);
void lar_thread_restore_slice(uint64_t slice);

#endif
