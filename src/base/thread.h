/* Threads that the library starts: its own, or the host's (lar_threads_set). */
#ifndef LAR_BASE_THREAD_H
#define LAR_BASE_THREAD_H

#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct lar_thread {
    pthread_t own;
    void *hosts; /* what the host calls it, if it is one of the host's */
    bool hosted;
    pid_t process; /* that it runs in */
} lar_thread;

/* Starts a thread that takes no signals: they are for the threads of the program. With a
 * `priority` of 1 to 99 it goes before all ordinary threads of the machine (SCHED_FIFO), which the
 * system may forbid; 0: ordinary. Returns 0 or an errno. */
int lar_thread_start_urgent(lar_thread *thread, int priority, void *(*run)(void *), void *context);

static inline int lar_thread_start(lar_thread *thread, void *(*run)(void *), void *context) {
    return lar_thread_start_urgent(thread, 0, run, context);
}

/* How far the calling thread goes before ordinary ones, as above, and from now on. Returns 0 or an
 * errno. */
int lar_thread_priority(void);
int lar_thread_set_priority(int priority);

/* Whether it runs in this process: a forked child has none of its parent's threads. */
bool lar_thread_is_here(const lar_thread *thread);

/* Waits for its end. Of a parent's thread it returns at once. */
void lar_thread_join(const lar_thread *thread);

/* Lets the calling thread take its turns in slices of 0.1 ms, where it had longer ones, and returns
 * these for lar_thread_restore_slice [ns]; 0: nothing was changed. For threads that wait for each
 * other in every step: another program on the same core has it for a slice each time that they let
 * it, 3 ms by itself, and less beside a thread whose turns are short. Linux has slices of a
 * thread's own since 6.12; elsewhere, and for threads that go before others, nothing happens. */
uint64_t lar_thread_shorten_slice(void);
void lar_thread_restore_slice(uint64_t slice);

#endif
