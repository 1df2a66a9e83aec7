#include "study/bench/step_clock.h"

#include <string.h>

#include "base/clock.h"

/* How long before the tick sleeping ends and polling begins [ns]: more than a timer is late on an
 * idle machine. */
static const int64_t WAKE_EARLY = 30000;

void lar_step_clock_start(lar_step_clock *step_clock, const lar_simulation *simulation,
                          bool paced) {
    memset(step_clock, 0, sizeof *step_clock);
    step_clock->paced = paced;
    if (paced) lar_clock_be_prompt();
    step_clock->first_step = lar_simulation_steps(simulation);
    step_clock->start = 1e-9 * (double)lar_clock_ns();
}

/* What the callback of an advance knows. */
typedef struct stretch {
    lar_step_clock *clock;
    const lar_step_glance *glance;
    const volatile sig_atomic_t *stop;
    double tick;   /* [ns] */
    int64_t start; /* of step clock->first_step [ns] */
    int64_t begin; /* of the step under way */
    int64_t look;  /* when to glance next */
} stretch;

static int64_t nanoseconds(double seconds) {
    return seconds < 1e9 ? (int64_t)(1e9 * seconds) : INT64_MAX / 2;
}

static bool asked_to_stop(const stretch *s) {
    return s->stop && *s->stop;
}

static int64_t pace(const stretch *s, uint64_t step, int64_t end) {
    int64_t deadline = s->start + (int64_t)(s->tick * (double)(step - s->clock->first_step));
    if (end > deadline)
        s->clock->misses++;
    else
        lar_clock_wait_until(deadline, WAKE_EARLY);
    return lar_clock_ns();
}

/* Everything between two steps happens here: the end of one is measured first, the beginning of the
 * next last. */
static int after_step(void *context, uint64_t step) {
    stretch *s = context;
    int64_t end = lar_clock_ns();
    bool on = true;
    lar_histogram_add(&s->clock->times, (uint64_t)(end - s->begin));
    s->begin = end;
    if (s->clock->paced && !asked_to_stop(s)) s->begin = pace(s, step, end);
    if (s->glance && end >= s->look) {
        on = s->glance->look(s->glance->context);
        s->begin = lar_clock_ns();
        s->look = s->begin + nanoseconds(s->glance->every);
    }
    return on && !asked_to_stop(s);
}

lar_status lar_step_clock_advance(lar_step_clock *step_clock, lar_simulation *simulation,
                                  uint64_t steps, const lar_step_glance *glance,
                                  const volatile sig_atomic_t *stop, lar_error *error) {
    stretch s = {.clock = step_clock,
                 .glance = glance,
                 .stop = stop,
                 .tick = 1e9 * lar_simulation_time_step(simulation),
                 .start = (int64_t)(1e9 * step_clock->start)};
    if (asked_to_stop(&s)) return LAR_OK;
    s.begin = lar_clock_ns();
    s.look = s.begin + (glance ? nanoseconds(glance->every) : 0);
    return lar_simulation_advance_with(simulation, steps, after_step, &s, error);
}

double lar_step_clock_elapsed(const lar_step_clock *step_clock) {
    return 1e-9 * (double)lar_clock_ns() - step_clock->start;
}

double lar_step_clock_busy(const lar_step_clock *step_clock) {
    return 1e-9 * (double)step_clock->times.sum;
}

double lar_step_clock_quantile(const lar_step_clock *step_clock, double share) {
    return 1e-3 * lar_histogram_quantile(&step_clock->times, share);
}

double lar_step_clock_longest(const lar_step_clock *step_clock) {
    return 1e-3 * (double)step_clock->times.max;
}
