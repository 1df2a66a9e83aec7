/* Which grid a model is divided into when nobody says: tried on this machine, as busy as it is.
 *
 *     simulations    one processor, two, four, ...  all alive, one computes at a time
 *     rounds         |1|2|4|1|2|4|1|2|4|            so that a busy moment meets all of them
 *     with a tick    beside them a thread wakes as often as devices do, and works for a moment
 *
 * Counted is the time of a batch: of some milliseconds, the median; where there are ticks, of one
 * tick, half the median and half the slowest twentieth: deadlines are missed there, but of some
 * hundred ticks it is known only roughly. */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/histogram.h"
#include "base/memory.h"
#include "base/pin.h"
#include "base/parallel_for.h"
#include "base/text.h"
#include "base/thread.h"
#include "divide/grid_choice.h"
#include "model/model.h"
#include "parallel/division.h"
#include "lariat.h"

/* Fewer elements of a processor than this do not pay for the exchange; models of more take longer
 * to set up and try than can be waited for. */
enum { ELEMENTS_MIN = 250, ELEMENTS_MAX = 200000, TRIALS = 12, ROUNDS = 4 };
static const double GAIN = 1.1;   /* times as fast: what more processors must be */
static const double ROUND = 0.03; /* of one simulation [s] */
/* Cores that were idle need a while until they run at their pace (study/bench/scaling.c). */
static const double WARM_UP = 0.15;    /* [s] */
static const double WORTH_TRYING = 1;  /* of the clock [s]: what is over before is not tried, */
static const double SETUPS = 4;        /* nor what is over before so many could be created */
static const int64_t BATCH = 3000000;  /* without ticks [ns] */
static const double COMPANION = 100e3; /* what devices and viewers take of a millisecond [ns] */

typedef struct trial {
    lar_grid grid;
    lar_simulation *simulation;
    lar_histogram times; /* of batches, per step [ns] */
    double score;        /* of a step [ns] */
} trial;

typedef struct choosing {
    const lar_model *model;
    lar_options options; /* without a grid */
    lar_grid_aim aim;
    trial *trial; /* [TRIALS] */
    int trials;
    double setup; /* what creating the first of them took [s] */
    bool beside;  /* a companion works */
    _Atomic bool over;
    lar_thread companion;
} choosing;

/* ---- one simulation ------------------------------------------------------------------------- */

static uint64_t batch_of(const choosing *c, const trial *t) {
    double step = lar_simulation_time_step(t->simulation);
    if (c->aim.tick > 0) return (uint64_t)fmax(1, round(c->aim.tick / step));
    double took = lar_histogram_quantile(&t->times, 0.5);
    return (uint64_t)fmin(1e5, fmax(1, took > 0 ? (double)BATCH / took : 1));
}

/* Batches for so many seconds, at least one. A run that breaks at once is not this one's to
 * report. */
static lar_status work(const choosing *c, trial *t, double seconds, lar_error *error) {
    int64_t begin = lar_clock_ns(), now = begin;
    lar_status status = LAR_OK;
    while (!status && (now == begin || (double)(now - begin) < 1e9 * seconds)) {
        uint64_t steps = batch_of(c, t);
        int64_t before = now;
        status = lar_simulation_advance(t->simulation, steps, error);
        now = lar_clock_ns();
        lar_histogram_add(&t->times, (uint64_t)(now - before) / steps);
    }
    return status;
}

static lar_status begin_trial(choosing *c, const char *grid, lar_error *error) {
    trial *t = &c->trial[c->trials];
    lar_options options = c->options;
    options.grid = grid;
    if (!grid) options.distribution = options.scheme = options.channels = NULL;
    int64_t begin = lar_clock_ns();
    lar_status status = lar_simulation_create(c->model, &options, &t->simulation, error);
    if (c->trials == 0) c->setup = 1e-9 * (double)(lar_clock_ns() - begin);
    if (!status) c->trials++;
    if (!status) status = work(c, t, WARM_UP, error);
    lar_histogram warm = t->times;
    memset(&t->times, 0, sizeof t->times);
    lar_histogram_add(&t->times, (uint64_t)lar_histogram_quantile(&warm, 0.5));
    t->score = lar_histogram_quantile(&warm, 0.5);
    return status;
}

/* ---- company -------------------------------------------------------------------------------- */

static void *keep_company(void *context) {
    choosing *c = context;
    lar_pin_nowhere();
    lar_clock_be_prompt();
    int64_t next = lar_clock_ns();
    while (!atomic_load(&c->over)) {
        int64_t begin = lar_clock_ns();
        while ((double)(lar_clock_ns() - begin) < COMPANION) continue;
        next += 1000000;
        lar_clock_sleep_until(next);
    }
    return NULL;
}

static void begin_company(choosing *c) {
    c->beside = c->aim.tick > 0 && lar_thread_start(&c->companion, keep_company, c) == 0;
}

static void end_company(choosing *c) {
    atomic_store(&c->over, true);
    if (c->beside) lar_thread_join(&c->companion);
}

/* ---- all of them ---------------------------------------------------------------------------- */

/* 1, 2, 4, ... and all cores; with a clock also all but one, which is left to the others. */
static int counts_of(int32_t cores, int32_t max, bool ticks, int32_t count[TRIALS]) {
    int counts = 0;
    for (int32_t n = 2; n <= max && counts < TRIALS - 3; n *= 2) {
        if (ticks && n > cores - 1 && cores - 1 > n / 2 && cores > 2)
            count[counts++] = cores - 1 < max ? cores - 1 : max;
        count[counts++] = n;
    }
    if (counts > 0 && count[counts - 1] < max) count[counts++] = max;
    return counts;
}

/* Ever more processors, until that is slower. What cannot be divided so is left out. */
static lar_status begin_trials(choosing *c, int32_t cores, lar_error *error) {
    const lar_mesh *mesh = &c->model->mesh;
    int32_t max = cores / (c->options.threads > 1 ? c->options.threads : 1);
    int32_t count[TRIALS];
    if (max > mesh->element_count / ELEMENTS_MIN) max = mesh->element_count / ELEMENTS_MIN;
    int counts = counts_of(cores, max, c->aim.tick > 0, count);
    double best = c->trial[0].score;
    for (int i = 0; i < counts; i++) {
        trial *t = &c->trial[c->trials];
        char text[LAR_GRID_TEXT];
        lar_error ignored;
        lar_status status = lar_grid_cheapest(mesh, count[i], &t->grid, &ignored);
        lar_grid_format(&t->grid, text);
        if (!status) status = begin_trial(c, text, &ignored);
        if (status == LAR_ERROR_MEMORY) return lar_fail(error, status, "%s", ignored.message);
        if (status || t->score > GAIN * best) break;
        best = fmin(best, t->score);
    }
    return LAR_OK;
}

static lar_status compare(choosing *c, lar_error *error) {
    lar_status status = LAR_OK;
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < c->trials && !status; i++) status = work(c, &c->trial[i], ROUND, error);
    for (int i = 0; i < c->trials && !status; i++) {
        const lar_histogram *times = &c->trial[i].times;
        double median = lar_histogram_quantile(times, 0.5);
        c->trial[i].score =
            c->aim.tick > 0 ? 0.5 * (median + lar_histogram_quantile(times, 0.95)) : median;
    }
    return status;
}

/* The fewest processors that the next more do not outrun. */
static int best_of(const choosing *c) {
    int best = 0;
    for (int i = 1; i < c->trials; i++)
        if (c->trial[best].score > GAIN * c->trial[i].score) best = i;
    return best;
}

/* What the run will take of the clock with one processor [s]; infinite: not known. */
static double length_of(const choosing *c) {
    const trial *alone = &c->trial[0];
    double steps = (double)c->aim.steps;
    if (steps <= 0) steps = c->aim.seconds / lar_simulation_time_step(alone->simulation);
    return steps > 0 ? 1e-9 * alone->score * steps : INFINITY;
}

static void say(lar_grid_choice *choice, const choosing *c, int best) {
    const trial *alone = &c->trial[0], *chosen = &c->trial[best];
    const char *by = c->aim.tick > 0 ? ", by ticks and their slowest twentieth" : "";
    lar_grid_format(&chosen->grid, choice->grid);
    choice->processors = chosen->grid.count;
    choice->tried = c->trials;
    choice->alone = 1e-9 * alone->score;
    choice->chosen = 1e-9 * chosen->score;
    const lar_time_text first = lar_text_time(choice->alone);
    if (best > 0)
        snprintf(choice->reason, sizeof choice->reason,
                 "a step takes %s instead of %s with one processor%s",
                 lar_text_time(choice->chosen).text, first.text, by);
    else if (c->trials > 1)
        snprintf(choice->reason, sizeof choice->reason,
                 "a step takes %s, and %s with %d processors%s", first.text,
                 lar_text_time(1e-9 * c->trial[1].score).text, (int)c->trial[1].grid.count, by);
    else
        snprintf(choice->reason, sizeof choice->reason, "a step takes %s", first.text);
}

static lar_status try_all(choosing *c, lar_grid_choice *choice, lar_error *error) {
    begin_company(c);
    lar_status status = begin_trial(c, NULL, error);
    c->trial[0].grid = (lar_grid){.edge = {1, 1, 1}, .count = 1};
    bool is_short = !status && length_of(c) < WORTH_TRYING + SETUPS * c->setup;
    if (!status && !is_short) status = begin_trials(c, choice->cores, error);
    if (!status && c->trials > 1) status = compare(c, error);
    end_company(c);
    if (!status) say(choice, c, best_of(c));
    if (is_short)
        snprintf(choice->reason, sizeof choice->reason, "it is over in %.2g s", length_of(c));
    if (status == LAR_ERROR_UNSTABLE || status == LAR_ERROR_MODEL) {
        snprintf(choice->reason, sizeof choice->reason, "it could not be tried");
        status = LAR_OK; /* the run itself will say why */
    }
    while (c->trials > 0) lar_simulation_destroy(c->trial[--c->trials].simulation);
    return status;
}

/* ---- without trying ------------------------------------------------------------------------- */

static lar_status take_as_it_is(const char *text, const lar_model *model, lar_grid_choice *choice,
                                lar_error *error) {
    lar_grid grid;
    lar_error why;
    if (lar_grid_parse(text, &grid, &why))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "LARIAT_GRID: %s", why.message);
    if (grid.count > model->mesh.element_count) {
        snprintf(choice->reason, sizeof choice->reason,
                 "there are fewer elements than processors in LARIAT_GRID");
        return LAR_OK;
    }
    lar_grid_format(&grid, choice->grid);
    choice->processors = grid.count;
    snprintf(choice->reason, sizeof choice->reason, "LARIAT_GRID says so");
    return LAR_OK;
}

static lar_status check(const lar_options *o, lar_error *error) {
    if (o->comm && strcmp(o->comm, "threads") != 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a grid is chosen for threads of one process; with communication by %s say "
                        "which, e.g. 2x1x1",
                        o->comm);
    if (o->schedules || lar_distribution_is_file(o->distribution))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s has its own grid, so none can be chosen; leave one of the two out",
                        o->schedules ? o->schedules : o->distribution);
    return LAR_OK;
}

/* Why there is nothing to try; NULL: there is. */
static const char *why_not(const lar_model *model, const lar_options *options, int32_t cores) {
    int32_t elements = model->mesh.element_count;
    if (options->verify) return "nothing moves in a verification";
    if (cores < 2) return "there is one core";
    if (elements < 2 * ELEMENTS_MIN) return "there are too few elements to divide";
    return NULL;
}

/* A model that is too large to be tried gains from every core. */
static lar_status take_all(const lar_model *model, const lar_options *options,
                           lar_grid_choice *choice, lar_error *error) {
    int32_t count = choice->cores / (options->threads > 1 ? options->threads : 1);
    lar_grid grid;
    lar_status status = lar_grid_cheapest(&model->mesh, count, &grid, error);
    if (status) return status;
    lar_grid_format(&grid, choice->grid);
    choice->processors = grid.count;
    snprintf(choice->reason, sizeof choice->reason, "so large a model gains from every core");
    return LAR_OK;
}

lar_status lar_grid_choose(const lar_model *model, const lar_options *options,
                           const lar_grid_aim *aim, lar_grid_choice *choice, lar_error *error) {
    choosing c = {.model = model, .options = options ? *options : lar_options_default()};
    if (!model || !choice)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_grid_choose needs a model and a place for the choice");
    *choice = (lar_grid_choice){.grid = "1x1x1", .processors = 1, .cores = lar_usable_cores()};
    const char *asked = getenv("LARIAT_GRID"), *why;
    lar_status status = check(&c.options, error);
    if (status) return status;
    if (asked && *asked && strcmp(asked, "auto") != 0)
        return take_as_it_is(asked, model, choice, error);
    if ((why = why_not(model, &c.options, choice->cores))) {
        snprintf(choice->reason, sizeof choice->reason, "%s", why);
        return LAR_OK;
    }
    if (model->mesh.element_count > ELEMENTS_MAX) return take_all(model, &c.options, choice, error);
    if (aim) c.aim = *aim;
    c.trial = lar_calloc(TRIALS, sizeof *c.trial);
    if (!c.trial) return lar_fail_memory(error, TRIALS * sizeof *c.trial, "a choice of grids");
    status = try_all(&c, choice, error);
    free(c.trial);
    return status;
}

void lar_grid_take(const lar_grid_choice *choice, lar_options *options) {
    if (!choice || !options) return;
    options->grid = choice->processors > 1 ? choice->grid : NULL;
    if (!options->grid) options->distribution = options->scheme = options->channels = NULL;
}
