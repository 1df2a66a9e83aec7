#include "base/thread.h"

#include <signal.h>
#include <unistd.h>

#include "base/error.h"

static lar_thread_hooks host;

lar_status lar_threads_set(const lar_thread_hooks *hooks, lar_error *error) {
    if (hooks && (!hooks->start || !hooks->join))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_threads_set needs functions that start and join, or NULL for the "
                        "library's own");
    host = hooks ? *hooks : (lar_thread_hooks){0};
    return LAR_OK;
}

static int start_own(pthread_t *thread, int priority, void *(*run)(void *), void *context) {
    struct sched_param urgency = {.sched_priority = priority};
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    if (priority > 0) {
        pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
        pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
        pthread_attr_setschedparam(&attributes, &urgency);
    }
    int cause = pthread_create(thread, &attributes, run, context);
    pthread_attr_destroy(&attributes);
    return cause;
}

int lar_thread_start_urgent(lar_thread *thread, int priority, void *(*run)(void *), void *context) {
    sigset_t all, before;
    *thread = (lar_thread){.hosted = host.start != NULL, .process = getpid()};
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int cause = thread->hosted ? host.start(host.context, priority, run, context, &thread->hosts)
                               : start_own(&thread->own, priority, run, context);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return cause;
}

int lar_thread_priority(void) {
    struct sched_param urgency;
    int policy = SCHED_OTHER;
    bool known = pthread_getschedparam(pthread_self(), &policy, &urgency) == 0;
    return known && (policy == SCHED_FIFO || policy == SCHED_RR) ? urgency.sched_priority : 0;
}

int lar_thread_set_priority(int priority) {
    const struct sched_param urgency = {.sched_priority = priority};
    return pthread_setschedparam(pthread_self(), priority > 0 ? SCHED_FIFO : SCHED_OTHER, &urgency);
}

bool lar_thread_is_here(const lar_thread *thread) {
    return thread->process == getpid();
}

void lar_thread_join(const lar_thread *thread) {
    if (!lar_thread_is_here(thread)) return;
    if (thread->hosted)
        host.join(host.context, thread->hosts);
    else
        pthread_join(thread->own, NULL);
}

#ifdef __linux__

#include <sys/syscall.h>

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
