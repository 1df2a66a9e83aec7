/* Threads that do a job together, again and again.
 *
 *     caller   run -- worker 0 ----.  run -- worker 0 ----.
 *     thread 1 ... -- worker 1 ---'| ... -- worker 1 -----|      ... waiting: polls, yields, sleeps
 *     thread 2 ... -- worker 2 --'   | ... - worker 2 -'      |
 *
 * The caller is one of them: two processors of a computer on two cores are two threads. Between
 * jobs a thread polls for some milliseconds, because the next job usually comes at once or at the
 * next tick of a session, and then sleeps. Threads that go before all others of the machine sleep
 * soon, for nobody else has their core while they poll: who knows when the next job comes rouses
 * them before.
 */
#ifndef LAR_BASE_THREAD_POOL_H
#define LAR_BASE_THREAD_POOL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

typedef struct lar_thread_pool lar_thread_pool;

/* What a worker does, 0..count-1. */
typedef void lar_thread_pool_job(void *context, int32_t worker);

/* Starts count - 1 threads. With `pin` every worker gets a core of its own, from number
 * `first_core` of those that this process may use, where there are enough (base/pin.h); the
 * caller's thread is bound while the pool lives. All take short turns beside other programs
 * (base/thread.h), the caller as long as the pool lives. */
lar_status lar_thread_pool_create(int32_t count, bool pin, int32_t first_core,
                                  lar_thread_pool **pool, lar_error *error);
/* Accepts NULL. In a forked child it frees the memory and leaves the parent's threads alone. */
void lar_thread_pool_destroy(lar_thread_pool *pool);
/* Whether its threads are in this process. */
bool lar_thread_pool_is_here(const lar_thread_pool *pool);

/* Runs the job in all workers and returns when all are done. */
void lar_thread_pool_run(lar_thread_pool *pool, lar_thread_pool_job *job, void *context);

/* From now on the threads that the pool has started go before all ordinary threads of the machine
 * as far as that (lar_thread_start_urgent), where the system allows it; 0: as they did. */
void lar_thread_pool_go_before(lar_thread_pool *pool, int priority);
/* Returns when all are awake. */
void lar_thread_pool_rouse(lar_thread_pool *pool);

#endif
