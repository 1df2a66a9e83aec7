#include "base/thread.h"

#include <stdbool.h>

#ifdef __linux__

#include <sys/syscall.h>
#include <unistd.h>

/* As the kernel has it; older headers have neither this nor the calls. */
typedef struct scheduling {
    uint32_t size, policy;
    uint64_t flags;
    int32_t nice;
    uint32_t priority;
    uint64_t runtime, deadline, period; /* [ns] runtime: the slice */
} scheduling;

enum { SLICE = 100000 /* [ns] the shortest that there is */, ORDINARY = 0 /* SCHED_OTHER */ };

/* Of an ordinary thread; 0: it has none of its own. */
static uint64_t slice_of(scheduling *own) {
    bool known = syscall(SYS_sched_getattr, 0, own, sizeof *own, 0) == 0;
    return known && own->policy == ORDINARY ? own->runtime : 0;
}

static bool set_slice(scheduling *own, uint64_t slice) {
    own->size = sizeof *own;
    own->runtime = slice;
    own->deadline = own->period = 0;
    return syscall(SYS_sched_setattr, 0, own, 0) == 0;
}

uint64_t lar_thread_shorten_slice(void) {
    scheduling own = {0};
    uint64_t before = slice_of(&own);
    return before > SLICE && set_slice(&own, SLICE) ? before : 0;
}

void lar_thread_restore_slice(uint64_t slice) {
    scheduling own = {0};
    if (slice > 0 && slice_of(&own) > 0) set_slice(&own, slice);
}

#else

uint64_t lar_thread_shorten_slice(void) {
    return 0;
}

void lar_thread_restore_slice(uint64_t slice) {
    (void)slice;
}

#endif
