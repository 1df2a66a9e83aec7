/* Moments that come at equal distances by the clock, and what is done about being late.
 *
 *     due 0         due 1         due 2         due 3            due n+1 = due n + period
 *       |=work=|      |=======work=====|=work=|   |=work=|
 *                              after due 2: a miss
 *
 * Work begins when it is due, or at once when the one before was late: so lost time is made up for,
 * as fast as the machine can. What is more than LAR_LAG_MAX behind is given up. A session's ticks
 * keep to this, and `lariat bench jitter` measures how well a machine can.
 *
 * `now` is base/clock.h's, as a number that the caller gives: a test can play every lateness.
 */
#ifndef LAR_BASE_DEADLINE_CLOCK_H
#define LAR_BASE_DEADLINE_CLOCK_H

#include <math.h>
#include <stdbool.h>

#include "base/clock.h"

#define LAR_LAG_MAX 0.1 /* [s] */

/* How long before it is due sleeping ends and polling begins [ns]: about as much as a timer is late
 * on an idle machine. */
enum { LAR_WAKE_EARLY = 20000 };

typedef struct lar_deadline_clock {
    int64_t due;     /* when the work under way, or the next, is due [ns] */
    double period;   /* [ns] */
    double fraction; /* of a nanosecond, what `due` leaves out */
} lar_deadline_clock;

/* From now on, without a past. */
static inline void lar_deadline_clock_restart(lar_deadline_clock *deadline, int64_t now) {
    deadline->due = now;
    deadline->fraction = 0;
}

static inline void lar_deadline_clock_wait(const lar_deadline_clock *deadline) {
    lar_clock_wait_until(deadline->due, LAR_WAKE_EARLY);
}

/* Puts off what cannot be made up for within LAR_LAG_MAX: returns how much that is [ns], or 0. */
static inline int64_t lar_deadline_clock_give_up(lar_deadline_clock *deadline, int64_t now) {
    int64_t excess = now - deadline->due - (int64_t)(1e9 * LAR_LAG_MAX);
    if (excess <= 0) return 0;
    deadline->due += excess;
    return excess;
}

/* The work is done; the next is due a period after this one was. True when that is past: a miss. */
static inline bool lar_deadline_clock_next(lar_deadline_clock *deadline, int64_t now) {
    double next = deadline->fraction + deadline->period;
    deadline->due += (int64_t)next;
    deadline->fraction = next - floor(next);
    return now > deadline->due;
}

#endif
