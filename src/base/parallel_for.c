#include "base/parallel_for.h"

#include <unistd.h>

#include "base/thread.h"

enum { THREADS_MAX = 16 };

static int32_t threads_asked; /* atomic */

typedef struct task {
    lar_parallel_for_work *work;
    void *context;
    int32_t count, portion;
    int64_t next; /* atomic: the first item that nobody has taken */
} task;

static void take_portions(task *shared) {
    for (;;) {
        const int64_t first = __atomic_fetch_add(&shared->next, shared->portion, __ATOMIC_RELAXED);
        if (first >= shared->count) return;
        const int64_t end = first + shared->portion;
        shared->work(shared->context, (int32_t)first,
                     end < shared->count ? (int32_t)end : shared->count);
    }
}

static void *help(void *argument) {
    take_portions(argument);
    return NULL;
}

/* Not of base/pin.h, which knows none where Lariat was built without hwloc. */
int32_t lar_usable_cores(void) {
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return CPU_COUNT(&allowed);
    const long online = sysconf(_SC_NPROCESSORS_ONLN); /* more than such a set holds */
    return online > 0 ? (int32_t)online : 1;
}

void lar_parallel_for_threads(int32_t count) {
    __atomic_store_n(&threads_asked, count, __ATOMIC_RELAXED);
}

static int32_t threads_at_most(void) {
    const int32_t asked = __atomic_load_n(&threads_asked, __ATOMIC_RELAXED);
    return asked > 0 ? asked : lar_usable_cores();
}

void lar_parallel_for(int32_t count, int32_t portion, lar_parallel_for_work *work, void *context) {
    task shared = {work, context, count, portion, 0};
    lar_thread thread[THREADS_MAX];
    const int64_t portions = ((int64_t)count + portion - 1) / portion;
    const int32_t max = portions > 1 ? threads_at_most() : 1;
    int started = 0;
    while (started + 1 < max && started + 1 < portions && started < THREADS_MAX &&
           !lar_thread_start(&thread[started], help, &shared))
        started++;
    take_portions(&shared);
    for (int i = 0; i < started; i++) lar_thread_join(&thread[i]);
}
