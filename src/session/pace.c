#include "session/pace.h"

#include <math.h>
#include <string.h>

static const int64_t WINDOW_STEP = 100000000, SECOND = 1000000000; /* [ns] */

/* Bins of times begin at 2^10 ns. */
enum { FIRST_OCTAVE = 10 };

/* A tick: three years, which a number of nanoseconds holds [ns]. */
static const double LONGEST = 1e17;

static double played(const lar_pace *pace, int64_t now) {
    return pace->before +
           (pace->running && now > pace->since ? 1e-9 * (double)(now - pace->since) : 0);
}

static void set_factor(lar_pace *pace) {
    if (pace->total.played > 0) pace->factor = pace->total.simulated / pace->total.played;
}

void lar_pace_restart(lar_pace *pace, int64_t now) {
    if (pace->pace > 0 && pace->deadline.due > now) return;
    pace->before = played(pace, pace->pace > 0 ? pace->deadline.due : now);
    pace->since = now;
    lar_deadline_clock_restart(&pace->deadline, now);
}

void lar_pace_start(lar_pace *pace, int64_t now) {
    if (pace->running) return;
    pace->running = true;
    pace->since = now;
    lar_deadline_clock_restart(&pace->deadline, now);
    pace->given_up_at = 0;
    pace->moments = 0; /* rates do not look across a pause */
}

void lar_pace_stop(lar_pace *pace, int64_t now) {
    if (!pace->running) return;
    pace->before =
        played(pace, pace->pace > 0 && pace->deadline.due > now ? pace->deadline.due : now);
    pace->running = false;
    pace->total.played = pace->before;
    set_factor(pace);
    pace->given_up_at = 0;
    pace->moments = 0;
}

void lar_pace_set(lar_pace *pace, double wanted, int64_t now) {
    if (wanted == pace->pace) return;
    lar_pace_restart(pace, now);
    /* What is left of the tick under way goes at the new pace. */
    if (pace->running && wanted > 0 && pace->deadline.due > now) {
        double left = (double)(pace->deadline.due - now) * (pace->pace / wanted);
        pace->deadline.due = now + (int64_t)fmin(left, LONGEST);
    }
    pace->pace = wanted;
}

void lar_pace_wait(lar_pace *pace) {
    if (pace->pace > 0) lar_deadline_clock_wait(&pace->deadline);
}

static bool is_slow(const lar_pace *pace, int64_t now) {
    return pace->given_up_at > 0 && now - pace->given_up_at < SECOND;
}

static void give_up(lar_pace *pace, int64_t now) {
    int64_t excess = lar_deadline_clock_give_up(&pace->deadline, now);
    if (excess == 0) return;
    if (!is_slow(pace, now)) {
        pace->misses -= pace->late_run;
        pace->slow_ticks += pace->late_run;
        pace->late_run = 0;
    }
    pace->skipped += 1e-9 * (double)excess;
    pace->given_up_at = now;
}

void lar_pace_begin(lar_pace *pace, double seconds, int64_t now) {
    pace->deadline.period = pace->pace > 0 ? fmin(1e9 * seconds / pace->pace, LONGEST) : 0;
    if (pace->pace > 0)
        give_up(pace, now);
    else
        pace->deadline.due = now;
    pace->total.at = now;
    pace->total.played = played(pace, now);
    set_factor(pace); /* without this tick, whose time is still to come */
    pace->total.simulated += seconds;
}

void lar_pace_computed(lar_pace *pace, uint64_t steps, int64_t engine, int64_t busy) {
    if (steps == 0) steps = 1;
    lar_histogram_add(&pace->steps, (uint64_t)(engine > 0 ? engine : 0) / steps);
    double min = 1e-9 * (double)busy / (double)steps;
    if (busy > 0 && (pace->total.min == 0 || min < pace->total.min)) pace->total.min = min;
    pace->total.steps += steps;
}

void lar_pace_forget_min(lar_pace *pace) {
    for (int i = 0; i < pace->moments; i++) pace->window[i].min = 0;
    pace->total.min = 0;
}

void lar_pace_answered(lar_pace *pace, int64_t now) {
    bool slow = is_slow(pace, now);
    int64_t from = slow ? pace->total.at : pace->deadline.due;
    lar_histogram_add(&pace->ticks, (uint64_t)(now > from ? now - from : 0));
    pace->total.ticks++;
    if (pace->pace <= 0) return;
    if (!lar_deadline_clock_next(&pace->deadline, now)) {
        pace->late_run = 0;
    } else if (slow) {
        pace->slow_ticks++;
    } else {
        pace->misses++;
        pace->late_run++;
    }
}

bool lar_pace_look(lar_pace *pace, int64_t now) {
    if (pace->moments > 0 && now - pace->window[pace->moments - 1].at < WINDOW_STEP) return false;
    if (pace->moments == LAR_PACE_WINDOW) {
        memmove(pace->window, pace->window + 1, (LAR_PACE_WINDOW - 1) * sizeof pace->window[0]);
        pace->moments--;
    }
    lar_pace_moment *moment = &pace->window[pace->moments++];
    *moment = pace->total;
    pace->total.min = 0;
    moment->at = now;
    moment->played = played(pace, now);
    return true;
}

static void report_min(const lar_pace *pace, lar_session_status *status) {
    double min = 0;
    for (int i = 0; i < pace->moments; i++)
        if (pace->window[i].min > 0 && (min == 0 || pace->window[i].min < min))
            min = pace->window[i].min;
    status->step_min = min;
}

static void report_rates(const lar_pace *pace, lar_session_status *status) {
    status->engine_rate = status->haptic_rate = status->snapshot_rate = 0;
    status->real_time_factor_now = 0;
    report_min(pace, status);
    if (pace->moments < 2) return;
    const lar_pace_moment *first = &pace->window[0], *last = &pace->window[pace->moments - 1];
    double seconds = 1e-9 * (double)(last->at - first->at);
    double time = last->played - first->played;
    status->engine_rate = (double)(last->steps - first->steps) / seconds;
    status->haptic_rate = (double)(last->exchanges - first->exchanges) / seconds;
    status->snapshot_rate = (double)(last->snapshots - first->snapshots) / seconds;
    if (time > 0) status->real_time_factor_now = (last->simulated - first->simulated) / time;
}

double lar_time_bin(int bin) {
    return 1e-9 * ldexp(bin % 2 ? 1.5 : 1, FIRST_OCTAVE + bin / 2);
}

static void report_quantiles(const lar_pace *pace, lar_session_status *status) {
    lar_histogram_halves(&pace->steps, FIRST_OCTAVE, LAR_TIME_BINS, status->step_bins);
    lar_histogram_halves(&pace->ticks, FIRST_OCTAVE, LAR_TIME_BINS, status->tick_bins);
    status->step_p50 = 1e-9 * lar_histogram_quantile(&pace->steps, 0.5);
    status->step_p99 = 1e-9 * lar_histogram_quantile(&pace->steps, 0.99);
    status->step_p999 = 1e-9 * lar_histogram_quantile(&pace->steps, 0.999);
    status->tick_p50 = 1e-9 * lar_histogram_quantile(&pace->ticks, 0.5);
    status->tick_p99 = 1e-9 * lar_histogram_quantile(&pace->ticks, 0.99);
    status->tick_p999 = 1e-9 * lar_histogram_quantile(&pace->ticks, 0.999);
}

void lar_pace_report(const lar_pace *pace, bool quantiles, int64_t now,
                     lar_session_status *status) {
    status->pace = pace->pace;
    status->real_time_factor = pace->factor;
    status->ticks = pace->total.ticks;
    status->misses = pace->misses;
    status->slow_ticks = pace->slow_ticks;
    status->skipped = pace->skipped;
    status->lag = pace->running && pace->pace > 0 && now > pace->deadline.due
                      ? 1e-9 * (double)(now - pace->deadline.due)
                      : 0;
    status->slow_motion = is_slow(pace, now);
    status->step_max = 1e-9 * (double)pace->steps.max;
    status->tick_max = 1e-9 * (double)pace->ticks.max;
    if (!quantiles) return;
    report_rates(pace, status);
    report_quantiles(pace, status);
}
