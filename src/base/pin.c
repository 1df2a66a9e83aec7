#include "base/pin.h"

#include <stdlib.h>

#include "base/memory.h"

#ifdef LAR_HAVE_HWLOC

#include <hwloc.h>
#include <pthread.h>

struct lar_pin {
    hwloc_cpuset_t set;
};

static hwloc_topology_t topology; /* NULL: not to be had */
static pthread_once_t once = PTHREAD_ONCE_INIT;
static int bound; /* atomic: a thread has been bound */

static void load(void) {
    hwloc_topology_t made;
    if (hwloc_topology_init(&made) != 0) return;
    if (hwloc_topology_load(made) != 0) {
        hwloc_topology_destroy(made);
        return;
    }
    /* Only cores that this process may use: of a container, of taskset, of a batch system. */
    hwloc_bitmap_t allowed = hwloc_bitmap_alloc();
    if (allowed && hwloc_get_cpubind(made, allowed, HWLOC_CPUBIND_PROCESS) == 0)
        hwloc_topology_restrict(made, allowed, 0);
    hwloc_bitmap_free(allowed);
    topology = made;
}

static bool ready(void) {
    pthread_once(&once, load);
    return topology != NULL;
}

int32_t lar_pin_cores(void) {
    return ready() ? hwloc_get_nbobjs_by_type(topology, HWLOC_OBJ_PU) : 0;
}

/* The first thread of core 0, of core 1, ..., then the second threads. */
static hwloc_obj_t find_unit(int32_t number) {
    int cores = hwloc_get_nbobjs_by_type(topology, HWLOC_OBJ_CORE);
    if (cores <= 0) return hwloc_get_obj_by_type(topology, HWLOC_OBJ_PU, (unsigned)number);
    hwloc_obj_t core = hwloc_get_obj_by_type(topology, HWLOC_OBJ_CORE, (unsigned)(number % cores));
    return hwloc_get_obj_inside_cpuset_by_type(topology, core->cpuset, HWLOC_OBJ_PU,
                                               (unsigned)(number / cores));
}

bool lar_pin_to(int32_t core) {
    if (core < 0 || core >= lar_pin_cores()) return false;
    hwloc_obj_t unit = find_unit(core);
    __atomic_store_n(&bound, 1, __ATOMIC_RELEASE);
    return unit && hwloc_set_cpubind(topology, unit->cpuset, HWLOC_CPUBIND_THREAD) == 0;
}

void lar_pin_nowhere(void) {
    if (!__atomic_load_n(&bound, __ATOMIC_ACQUIRE) || !ready()) return;
    hwloc_set_cpubind(topology, hwloc_topology_get_topology_cpuset(topology), HWLOC_CPUBIND_THREAD);
}

lar_pin *lar_pin_remember(void) {
    lar_pin *pin = ready() ? lar_calloc(1, sizeof *pin) : NULL;
    if (!pin) return NULL;
    pin->set = hwloc_bitmap_alloc();
    if (pin->set && hwloc_get_cpubind(topology, pin->set, HWLOC_CPUBIND_THREAD) == 0) return pin;
    hwloc_bitmap_free(pin->set);
    free(pin);
    return NULL;
}

void lar_pin_restore(lar_pin *pin) {
    if (!pin) return;
    hwloc_set_cpubind(topology, pin->set, HWLOC_CPUBIND_THREAD);
    hwloc_bitmap_free(pin->set);
    free(pin);
}

#else

int32_t lar_pin_cores(void) {
    return 0;
}

bool lar_pin_to(int32_t core) {
    (void)core;
    return false;
}

void lar_pin_nowhere(void) {}

lar_pin *lar_pin_remember(void) {
    return NULL;
}

void lar_pin_restore(lar_pin *pin) {
    (void)pin;
}

#endif
