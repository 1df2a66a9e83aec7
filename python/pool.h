/* Threads of a batch: they do independent items together and sleep in between.
 *
 *     items      0 . . . . . . . . n - 1      each takes the next one that is left
 *     caller     ###   ####   ##  (waits, looks for Ctrl-C)
 *     thread 1      ###    ###  ###           asleep before and after: a condition, no polling
 *
 * Threads start with the first run and live as long as the pool. They know nothing of Python. */
#ifndef LARIAT_PYTHON_POOL_H
#define LARIAT_PYTHON_POOL_H

#include <stdbool.h>

typedef struct python_pool python_pool;

/* Does one item; `caller`: in the thread that called python_pool_run. */
typedef void python_pool_work(void *context, int item, bool caller);
/* Called by the caller ten times a second while it only waits for others. */
typedef void python_pool_wait(void *context);

/* Cores that this process may use, at least 1. */
int python_pool_cores(void);

/* The caller and threads - 1 more; NULL: no memory. */
python_pool *python_pool_create(int threads);
/* Nobody runs anything on it. In a child of a fork its threads are not there: `lost` frees nothing.
 */
void python_pool_destroy(python_pool *pool, bool lost);

/* Does `items` items and returns when all are done. Where the system gives fewer threads these do
 * it: what comes out may not depend on it. */
void python_pool_run(python_pool *pool, int items, python_pool_work *work, python_pool_wait *wait,
                     void *context);

#endif
