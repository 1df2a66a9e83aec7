/* Threads that do a job together, again and again.
 *
 *     caller   run ---- seat 0 ----.  run ---- seat 0 ----.
 *     thread 1 ... ---- seat 1 ---'| ... ---- seat 1 -----|      ... waiting: polls, yields, sleeps
 *     thread 2 ... -- seat 2 --'   | ... - seat 2 -'      |
 *
 * The caller is one of them: two processors of a computer on two cores are two threads. Between
 * jobs a thread polls for some milliseconds, because the next job usually comes at once or at the
 * next tick of a session, and then sleeps.
 */
#ifndef LAR_BASE_CREW_H
#define LAR_BASE_CREW_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

typedef struct lar_crew lar_crew;

/* What a seat does, 0..count-1. */
typedef void lar_crew_job(void *context, int32_t seat);

/* Starts count - 1 threads. With `pin` every seat gets a core of its own, from number `first_core`
 * of those that this process may use, where there are enough (base/pin.h); the caller's thread is
 * bound while the crew lives. */
lar_status lar_crew_create(int32_t count, bool pin, int32_t first_core, lar_crew **crew,
                           lar_error *error);
void lar_crew_destroy(lar_crew *crew); /* accepts NULL */

/* Runs the job in all seats and returns when all are done. */
void lar_crew_run(lar_crew *crew, lar_crew_job *job, void *context);

#endif
