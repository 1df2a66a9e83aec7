/* Independent items of work, divided among the cores that the calling thread may use.
 *
 *     items      0 . . . | . . . . | . . . . | . . .        in portions
 *     caller     #########           ########## ...         each takes the next one that is left
 *     thread 1            ##########           ...
 *
 * For set-up, where a call lasts milliseconds at least: threads live as long as the call. What
 * comes out may not depend on who did what: an item writes only what is its own. (A job that comes
 * again and again is for a thread pool, base/thread_pool.h.) */
#ifndef LAR_BASE_PARALLEL_FOR_H
#define LAR_BASE_PARALLEL_FOR_H

#include <stdint.h>

#include "lariat.h"

/* Does the items first..end - 1. */
typedef void lar_parallel_for_work(void *context, int32_t first, int32_t end);

/* How many cores' time control groups leave a process whose groups `groups` lists
 * (/proc/self/cgroup), in the file systems below `mount` (/sys/fs/cgroup); INFINITY: no limit. Both
 * versions of such groups, and of every group above as well. */
double lar_cores_of_groups(const char *groups, const char *mount);

/* Does `count` items, `portion` of them at a time, and returns when all are done. Portions are
 * taken in ascending order, so that an item may wait for one of lower number. Where the system
 * gives no thread the caller does it alone. Calls may be nested. */
void lar_parallel_for(int32_t count, int32_t portion, lar_parallel_for_work *work, void *context);

/* For tests of what may not depend on it: all later calls take so many threads, on any number of
 * cores; 0: one per core. */
void lar_parallel_for_threads(int32_t count);

#endif
