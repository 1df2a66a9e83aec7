#include "study/step_clock.h"

#include <string.h>
#include <time.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

/* How long before the tick sleeping ends and polling begins [ns]: more than a timer is late on an
 * idle machine. */
static const int64_t WAKE_EARLY = 30000;

static int64_t now(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (int64_t)at.tv_sec * 1000000000 + at.tv_nsec;
}

static void wait_until(int64_t tick) {
    int64_t wake = tick - WAKE_EARLY;
    if (wake > now()) {
        struct timespec at = {wake / 1000000000, wake % 1000000000};
        /* A signal ends the sleep: whoever asked to stop is heard after the tick. */
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
    }
    while (now() < tick) continue;
}

/* Linux lets a sleeping thread wake up to 50 us late to save energy; half a tick is too much. */
static void ask_for_prompt_waking(void) {
#ifdef PR_SET_TIMERSLACK
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
#endif
}

void lar_step_clock_start(lar_step_clock *step_clock, const lar_simulation *simulation,
                          bool paced) {
    memset(step_clock, 0, sizeof *step_clock);
    step_clock->paced = paced;
    if (paced) ask_for_prompt_waking();
    step_clock->first_step = lar_simulation_steps(simulation);
    step_clock->start = 1e-9 * (double)now();
}

lar_status lar_step_clock_advance(lar_step_clock *step_clock, lar_simulation *simulation,
                                  uint64_t steps, double most_seconds,
                                  const volatile sig_atomic_t *stop, lar_error *error) {
    const double tick = 1e9 * lar_simulation_time_step(simulation);
    const int64_t start = (int64_t)(1e9 * step_clock->start);
    const int64_t last = now() + (int64_t)(1e9 * most_seconds);
    for (uint64_t i = 0; i < steps && !(stop && *stop); i++) {
        int64_t begin = now();
        lar_status status = lar_simulation_advance(simulation, 1, error);
        int64_t end = now();
        lar_histogram_add(&step_clock->times, (uint64_t)(end - begin));
        if (status) return status;
        if (step_clock->paced) {
            uint64_t done = lar_simulation_steps(simulation) - step_clock->first_step;
            int64_t deadline = start + (int64_t)(tick * (double)done);
            if (end > deadline)
                step_clock->misses++;
            else
                wait_until(deadline);
        }
        if (end > last) break;
    }
    return LAR_OK;
}

double lar_step_clock_elapsed(const lar_step_clock *step_clock) {
    return 1e-9 * (double)now() - step_clock->start;
}

double lar_step_clock_busy(const lar_step_clock *step_clock) {
    return 1e-9 * (double)step_clock->times.sum;
}

double lar_step_clock_quantile(const lar_step_clock *step_clock, double share) {
    return 1e-3 * lar_histogram_quantile(&step_clock->times, share);
}

double lar_step_clock_longest(const lar_step_clock *step_clock) {
    return 1e-3 * (double)step_clock->times.most;
}
