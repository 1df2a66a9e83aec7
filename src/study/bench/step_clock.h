/* Time steps by the clock: how long each takes, and, on request, one per tick of the wall clock.
 *
 *     tick 0        tick 1        tick 2        tick 3          tick n = start + n * time step
 *       |--step 0--... |--step 1-------|.. |--step 2--...          step 1 is late: one miss
 *
 * A step begins at its tick, or at once when the one before was late, and misses its deadline when
 * it ends after the next tick. Between the two the thread sleeps until shortly before the tick and
 * polls the clock from there: sleeping alone wakes tens of microseconds late, polling alone takes a
 * whole processor (and a real-time thread that never sleeps is throttled).
 */
#ifndef LAR_STUDY_BENCH_STEP_CLOCK_H
#define LAR_STUDY_BENCH_STEP_CLOCK_H

#include <signal.h>
#include <stdbool.h>

#include "base/histogram.h"
#include "lariat.h"

/* Called between two steps about every `every` seconds, while no step is measured: for progress on
 * a screen. False ends the steps. */
typedef struct lar_step_glance {
    double every; /* [s] */
    bool (*look)(void *context);
    void *context;
} lar_step_glance;

typedef struct lar_step_clock {
    bool paced;          /* follow the wall clock */
    lar_histogram times; /* of the steps, without waiting [ns] */
    uint64_t misses;     /* deadlines, when paced */
    double start;        /* monotonic clock at the first step [s] */
    uint64_t first_step; /* of the simulation, at the start */
} lar_step_clock;

/* Begins now: the step that the simulation is at belongs to this moment. When paced, the calling
 * thread's timers are made as exact as the system allows. */
void lar_step_clock_start(lar_step_clock *step_clock, const lar_simulation *simulation, bool paced);

/* Up to `steps` steps as one advance, each measured. Returns early, with LAR_OK, when *stop (may be
 * NULL) is not 0 or `glance` (may be NULL) says so, with several processors some steps later: ask
 * the simulation where it is. */
lar_status lar_step_clock_advance(lar_step_clock *step_clock, lar_simulation *simulation,
                                  uint64_t steps, const lar_step_glance *glance,
                                  const volatile sig_atomic_t *stop, lar_error *error);

/* Seconds since the start. */
double lar_step_clock_elapsed(const lar_step_clock *step_clock);

/* Seconds spent in steps. */
double lar_step_clock_busy(const lar_step_clock *step_clock);

/* Step time below or at which `share` of the steps lie [us]. */
double lar_step_clock_quantile(const lar_step_clock *step_clock, double share);
/* Longest step [us]. */
double lar_step_clock_longest(const lar_step_clock *step_clock);

#endif
