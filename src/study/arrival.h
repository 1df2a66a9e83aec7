/* While processes that were started here are on their way to processor zero. It waits for them at
 * a listener, and would do so until its limit when one of them has died: a thread looks whether
 * they live, and shuts the listener down when one does not.
 *
 *     start ... lar_arrival_begin | lar_simulation_create | lar_arrival_end ... steps
 *                                   everyone comes
 *
 * Once they are there the connections tell who is lost (comm/heartbeat.h), so that no thread looks
 * at anything while steps are done.
 */
#ifndef LAR_STUDY_ARRIVAL_H
#define LAR_STUDY_ARRIVAL_H

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

#include "base/thread.h"
#include "lariat.h"

typedef struct lar_arrival {
    /* set by the caller */
    const pid_t *pid; /* [count], from 1 */
    int32_t count;
    int listener; /* of processor zero */
    /* its own */
    lar_thread thread;
    bool runs;
    int over;        /* atomic */
    int32_t missing; /* who has ended; 0: nobody */
    siginfo_t how;
} lar_arrival;

/* Without a thread, where the system gives none, nobody looks. */
void lar_arrival_begin(lar_arrival *arrival);

/* The processor that has ended on the way, and how (*error); 0: none. */
int32_t lar_arrival_end(lar_arrival *arrival, lar_error *error);

#endif
