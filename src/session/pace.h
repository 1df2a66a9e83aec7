/* Ticks by the clock, and what became of them.
 *
 *     due 0         due 1         due 2         due 3            due n+1 = due n + tick / pace
 *       |=tick=|      |=======tick=====|=tick=|   |=tick=|
 *              forces                  forces: after due 2, a miss
 *
 * A tick begins when it is due, or at once when the one before was late: so lost time is made up
 * for, as fast as the machine can. What is more than LAR_LAG_MAX behind is given up: it counts as
 * skipped, the simulation is in slow motion, and says so. Ticks of slow motion that are late are
 * counted beside the misses: nobody could have kept a deadline that a tick before has missed. So
 * are those that were late in a row when it began. Their times count from when they begin.
 *
 * Real-time factor: simulated time per time of the clock in which it was meant to go on; pauses and
 * waiting for a file do not belong to it, time that was given up does.
 *
 * `now` is base/clock.h's, as a number that the caller gives: a test can play every lateness.
 */
#ifndef LAR_SESSION_PACE_H
#define LAR_SESSION_PACE_H

#include <stdbool.h>

#include "base/deadline_clock.h"
#include "base/histogram.h"
#include "lariat.h"

enum { LAR_PACE_WINDOW = 11 }; /* moments kept for rates: one every tenth of a second */

/* What is counted, at one moment. */
typedef struct lar_pace_moment {
    int64_t at;       /* [ns] */
    double simulated; /* [s] since the start */
    double played;    /* time of the clock that was played [s] */
    uint64_t steps, ticks, exchanges, snapshots;
    double min; /* processor time of a step since the moment before, the least [s]; 0: none */
} lar_pace_moment;

typedef struct lar_pace {
    double pace; /* simulated per clock second; 0: as fast as it goes */
    lar_deadline_clock
        deadline;        /* of the tick under way, or the next one; its period is 0 without pace */
    bool running;        /* between lar_pace_start and lar_pace_stop */
    int64_t since;       /* of this stretch's start [ns] */
    double before;       /* played before this stretch [s] */
    int64_t given_up_at; /* when time was last given up [ns]; 0: never */
    lar_pace_moment total;
    lar_pace_moment window[LAR_PACE_WINDOW];
    int moments;
    uint64_t misses;
    uint64_t late_run;   /* of these, the latest in a row */
    uint64_t slow_ticks; /* late in slow motion */
    double skipped;
    double factor;       /* real-time factor when the latest tick was due */
    lar_histogram steps; /* time of a step, engine alone [ns] */
    lar_histogram ticks; /* from due to forces [ns] */
} lar_pace;

/* Play begins now, or goes on after a pause; the next tick is due now. Twice is once. */
void lar_pace_start(lar_pace *pace, int64_t now);
/* A pause: it begins when the next tick would be due. */
void lar_pace_stop(lar_pace *pace, int64_t now);
/* What lies behind is neither made up for nor counted: a late tick is due now. */
void lar_pace_restart(lar_pace *pace, int64_t now);
void lar_pace_set(lar_pace *pace, double wanted, int64_t now);

/* Waits until the next tick is due. */
void lar_pace_wait(lar_pace *pace);
/* A tick that lasts `seconds` (simulated) begins. */
void lar_pace_begin(lar_pace *pace, double seconds, int64_t now);
/* The steps are done: `engine` is the time that they took, `busy` what their thread had of a
 * processor meanwhile [ns]; 0: not known. */
void lar_pace_computed(lar_pace *pace, uint64_t steps, int64_t engine, int64_t busy);
/* Steps take another time from now on: the least that is known is of no use any more. */
void lar_pace_forget_min(lar_pace *pace);
/* The forces are out. */
void lar_pace_answered(lar_pace *pace, int64_t now);

/* Once in a while: the window of rates. True when a tenth of a second has passed since it last
 * was. */
bool lar_pace_look(lar_pace *pace, int64_t now);

/* Fills in what is counted, and with `quantiles` also what has to be summed up: some ten
 * microseconds. */
void lar_pace_report(const lar_pace *pace, bool quantiles, int64_t now, lar_session_status *status);

#endif
