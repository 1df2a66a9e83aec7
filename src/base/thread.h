/* Threads of the library's own. */
#ifndef LAR_BASE_THREAD_H
#define LAR_BASE_THREAD_H

#include <pthread.h>
#include <signal.h>

/* Starts a thread that takes no signals: they are for the threads of the program. Returns 0 or an
 * errno. */
static inline int lar_thread_start(pthread_t *thread, void *(*run)(void *), void *context) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int cause = pthread_create(thread, NULL, run, context);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return cause;
}

#endif
