#include "study/bench/jitter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/deadline_clock.h"
#include "base/histogram.h"
#include "base/memory.h"
#include "base/thread.h"
#include "mechanics/hex8_block.h"
#include "study/bench/fma_peak.h"

static const double PERIOD = 1e6;   /* [ns] */
static const double WARM_UP = 5e7;  /* ticks that do not count, before every turn [ns] */
static const double LONGEST = 3600; /* turn [s] */

/* One turn, of a thread of its own. */
typedef struct turn {
    int64_t length; /* [ns] */
    const lar_fma_peak *work;
    uint64_t rounds; /* of it in a tick */
    double sink;     /* what the work comes to, so that no compiler leaves it out */
    uint64_t misses;
    int64_t skipped; /* [ns] */
    lar_histogram late, done;
} turn;

typedef struct bench {
    const lar_bench_jitter_options *options;
    turn turn;
    lar_histogram late, done;             /* of all turns */
    double *late_p50, *late_p99, *missed; /* [repeat] */
} bench;

/* ---- the work ----------------------------------------------------------------------------- */

static double time_rounds(turn *t, uint64_t rounds) {
    int64_t begin = lar_clock_ns();
    t->sink += t->work->run(rounds);
    return (double)(lar_clock_ns() - begin);
}

/* How many rounds take `load` on a core that nobody takes away: the fastest of some tries. */
static lar_status count_out(turn *t, double load, lar_error *error) {
    static const double VISIBLE = 1e6; /* [ns] */
    enum { TRIES = 9 };
    const lar_kernels *kernels;
    lar_status status = lar_kernels_find(LAR_ISA_AUTO, &kernels, error);
    if (status || load <= 0) return status;
    t->work = lar_fma_peak_find(kernels->name);
    if (!t->work)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "this build has nothing to compute with %s; leave --load out",
                        kernels->name);
    uint64_t rounds = 256;
    while (time_rounds(t, rounds) < VISIBLE) rounds *= 2;
    double best = INFINITY;
    for (int i = 0; i < TRIES; i++) best = fmin(best, time_rounds(t, rounds));
    t->rounds = (uint64_t)fmax(1, 1e3 * load * (double)rounds / best);
    return LAR_OK;
}

/* ---- a turn ------------------------------------------------------------------------------- */

static void tick(turn *t, lar_deadline_clock *deadline) {
    lar_deadline_clock_wait(deadline);
    int64_t now = lar_clock_ns(), due = deadline->due;
    t->skipped += lar_deadline_clock_give_up(deadline, now);
    lar_histogram_add(&t->late, (uint64_t)(now - due));
    if (t->rounds > 0) t->sink += t->work->run(t->rounds);
    now = lar_clock_ns();
    lar_histogram_add(&t->done, (uint64_t)(now - due));
    t->misses += lar_deadline_clock_next(deadline, now);
}

static void forget(turn *t) {
    memset(&t->late, 0, sizeof t->late);
    memset(&t->done, 0, sizeof t->done);
    t->misses = 0;
    t->skipped = 0;
}

static void *keep_time(void *context) {
    turn *t = context;
    lar_deadline_clock deadline = {.period = PERIOD};
    lar_clock_be_prompt();
    lar_deadline_clock_restart(&deadline, lar_clock_ns() + (int64_t)PERIOD);
    int64_t begin = deadline.due + (int64_t)WARM_UP;
    while (deadline.due < begin) tick(t, &deadline);
    forget(t);
    int64_t end = deadline.due + t->length;
    while (deadline.due < end) tick(t, &deadline);
    return NULL;
}

static lar_status take_turn(bench *b, int k, lar_error *error) {
    turn *t = &b->turn;
    lar_thread thread;
    int cause = lar_thread_start_urgent(&thread, b->options->priority, keep_time, t);
    if (cause && b->options->priority > 0)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "no thread goes before ordinary ones with priority %d: %s; allow it "
                        "(ulimit -r, root), or leave --priority out",
                        b->options->priority, strerror(cause));
    if (cause) return lar_fail_thread(error, cause, "the clock");
    lar_thread_join(&thread);
    lar_histogram_merge(&b->late, &t->late);
    lar_histogram_merge(&b->done, &t->done);
    b->late_p50[k] = 1e-3 * lar_histogram_quantile(&t->late, 0.5);
    b->late_p99[k] = 1e-3 * lar_histogram_quantile(&t->late, 0.99);
    b->missed[k] = (double)t->misses / (double)t->late.count;
    return LAR_OK;
}

/* ---- all turns ---------------------------------------------------------------------------- */

static lar_percentiles percentiles_of(const lar_histogram *times) {
    return (lar_percentiles){.p50 = 1e-3 * lar_histogram_quantile(times, 0.5),
                             .p99 = 1e-3 * lar_histogram_quantile(times, 0.99),
                             .p999 = 1e-3 * lar_histogram_quantile(times, 0.999),
                             .max = 1e-3 * (double)times->max};
}

static lar_status take_turns(bench *b, lar_bench_jitter_result *r, lar_error *error) {
    lar_status status = count_out(&b->turn, b->options->load, error);
    b->turn.length = (int64_t)(1e9 * b->options->seconds);
    for (int k = 0; k < r->repeat && !status; k++) {
        status = take_turn(b, k, error);
        r->misses += b->turn.misses;
        r->skipped += 1e-9 * (double)b->turn.skipped;
    }
    if (status) return status;
    r->ticks = b->late.count;
    r->missed = (double)r->misses / (double)r->ticks;
    r->late = percentiles_of(&b->late);
    r->done = percentiles_of(&b->done);
    r->late_p50 = lar_spread_of(b->late_p50, r->repeat);
    r->late_p99 = lar_spread_of(b->late_p99, r->repeat);
    r->missed_of = lar_spread_of(b->missed, r->repeat);
    return LAR_OK;
}

static lar_status check_options(const lar_bench_jitter_options *o, lar_error *error) {
    if (!(o->seconds >= 1e-9 * PERIOD && o->seconds <= LONGEST) || o->repeat < 1 ||
        o->repeat > LAR_BENCH_REPEAT_MAX || !(o->load >= 0) ||
        o->load > LAR_BENCH_JITTER_LOAD_MAX || o->priority < 0 || o->priority > 99)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "turns last 0.001 to %g s, there are 1 to %d, a tick computes for up to "
                        "%d us, and the priority is 0 to 99",
                        LONGEST, LAR_BENCH_REPEAT_MAX, LAR_BENCH_JITTER_LOAD_MAX);
    return LAR_OK;
}

lar_status lar_bench_jitter(const lar_bench_jitter_options *options,
                            lar_bench_jitter_result *result, lar_error *error) {
    lar_bench_jitter_result made = {.period = 1e-3 * PERIOD, .repeat = options->repeat};
    lar_status status = check_options(options, error);
    if (status) return status;
    bench *b = lar_calloc(1, sizeof *b);
    double *samples = lar_calloc(3 * (size_t)options->repeat, sizeof *samples);
    if (b && samples) {
        b->options = options;
        b->late_p50 = samples;
        b->late_p99 = samples + options->repeat;
        b->missed = samples + 2 * options->repeat;
        status = take_turns(b, &made, error);
    } else {
        status = lar_fail_memory(error, sizeof *b, "the benchmark");
    }
    free(b);
    free(samples);
    if (!status) *result = made;
    return status;
}
