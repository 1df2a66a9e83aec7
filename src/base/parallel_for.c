#include "base/parallel_for.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
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

/* ---- cores ----------------------------------------------------------------------------------- */

/* Two numbers from two files, or from one; false where they are not there. */
static bool read_limit(const char *folder, const char *const name[2], double limit[2]) {
    char path[1200];
    int got = 0;
    for (int i = 0; i < 2 && name[i]; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, name[i]);
        FILE *file = fopen(path, "re");
        while (file && got < 2 && fscanf(file, "%lf", &limit[got]) == 1) got++;
        if (file) fclose(file);
    }
    return got == 2;
}

/* Of one group: microseconds in every period. "max" and -1 are no limit. */
static double cores_in(const char *folder) {
    static const char *const files[2][2] = {{"cpu.max", NULL},
                                            {"cpu.cfs_quota_us", "cpu.cfs_period_us"}};
    double least = INFINITY, limit[2];
    for (int version = 0; version < 2; version++)
        if (read_limit(folder, files[version], limit) && limit[0] > 0 && limit[1] > 0)
            least = fmin(least, limit[0] / limit[1]);
    return least;
}

/* Of a group and all above it. A container may see its own as the root. */
static double cores_along(const char *mount, const char *controller, char *group) {
    char folder[1100];
    double least = INFINITY;
    for (;;) {
        snprintf(folder, sizeof folder, "%s%s%s", mount, controller, group);
        least = fmin(least, cores_in(folder));
        char *last = strrchr(group, '/');
        if (!last) return least;
        *last = 0;
    }
}

double lar_cores_of_groups(const char *groups, const char *mount) {
    char line[1024];
    double least = INFINITY;
    FILE *file = fopen(groups, "re");
    while (file && fgets(line, sizeof line, file)) { /* number:controllers:/group */
        char *controllers = strchr(line, ':'),
             *group = controllers ? strchr(controllers + 1, ':') : 0;
        if (!group) continue;
        *group++ = *controllers++ = 0;
        group[strcspn(group, "\n")] = 0;
        if (!*controllers)
            least = fmin(least, cores_along(mount, "", group));
        else if (strcmp(controllers, "cpu") == 0 || strstr(controllers, "cpu,"))
            least = fmin(least, cores_along(mount, "/cpu", group));
    }
    if (file) fclose(file);
    return least;
}

static int32_t cores_left; /* by control groups; a process stays in its own */

static void ask_groups(void) {
    double cores = lar_cores_of_groups("/proc/self/cgroup", "/sys/fs/cgroup");
    cores_left = cores < 1 ? 1 : cores < INT32_MAX ? (int32_t)cores : INT32_MAX;
}

/* Not of base/pin.h, which knows none where Lariat was built without hwloc. */
static int32_t allowed_cores(void) {
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return CPU_COUNT(&allowed);
    const long online = sysconf(_SC_NPROCESSORS_ONLN); /* more than such a set holds */
    return online > 0 ? (int32_t)online : 1;
}

/* Threads that poll in time that they do not have are stopped for the rest of a period, all at
 * once, for tens of milliseconds: so of a core and a half one counts. */
int32_t lar_usable_cores(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, ask_groups);
    int32_t allowed = allowed_cores();
    return allowed < cores_left ? allowed : cores_left;
}

/* ---- portions -------------------------------------------------------------------------------- */

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
