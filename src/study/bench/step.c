#include "study/bench/step.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/pin.h"
#include "model/demo/demo.h"
#include "model/demo/demo_scene.h"
#include "model/scene/scene.h"
#include "study/bench/step_clock.h"

static const double SAMPLE_TIME = 0.3; /* a sample lasts up to so long when not told [s] */

typedef struct bench {
    const lar_bench_step_options *options;
    lar_bench_step_result *result;
    lar_step_clock *clock; /* of a sample */
    lar_histogram *times;  /* of the steps of all samples */
    double *samples;       /* [repeat] us */
    double interval;       /* between frames of a run [s], 0: none */
} bench;

/* ---- the demonstration organ -------------------------------------------------------------- */

static lar_status make_organ_mesh(const char *path, double scale, lar_mesh *mesh,
                                  lar_error *error) {
    (void)path;
    (void)scale; /* its scenes have none */
    return lar_demo_mesh(mesh, error);
}

lar_status lar_bench_step_organ(lar_model **model, lar_error *error) {
    const lar_demo_scene *scene = &lar_demo_scene_of[0];
    size_t size = 1;
    for (int i = 0; i < LAR_DEMO_SCENE_PARTS; i++) size += strlen(scene->part[i]);
    char *text = lar_calloc(size, 1);
    if (!text) return lar_fail_memory(error, size, "the demonstration organ");
    for (int i = 0; i < LAR_DEMO_SCENE_PARTS; i++) strcat(text, scene->part[i]);
    const lar_bytes bytes = {(unsigned char *)text, size - 1};
    lar_status status = lar_scene_parse_with(scene->name, &bytes, make_organ_mesh, model, error);
    free(text);
    return status;
}

/* ---- going back ----------------------------------------------------------------------------- */

enum { TRIES = 101 };

/* Microseconds of what comes between two looks at the clock. */
static double since(int64_t begin) {
    return 1e-3 * (double)(lar_clock_ns() - begin);
}

static lar_status try_once(lar_simulation *simulation, lar_saved *saved, double time[3],
                           lar_error *error) {
    int64_t begin = lar_clock_ns();
    lar_status status = lar_simulation_save_to(simulation, saved, error);
    time[0] = since(begin);
    if (!status) status = lar_simulation_advance(simulation, 1, error);
    begin = lar_clock_ns();
    if (!status) status = lar_simulation_load_from(simulation, saved, error);
    time[1] = since(begin);
    begin = lar_clock_ns();
    if (!status) status = lar_simulation_advance(simulation, 1, error);
    time[2] = since(begin);
    return status ? status : lar_simulation_load_from(simulation, saved, error);
}

static lar_status time_saving(lar_bench_step_result *r, lar_simulation *simulation,
                              lar_error *error) {
    double time[3][TRIES];
    lar_saved *saved = NULL;
    lar_status status = lar_saved_create(simulation, &saved, error);
    for (int i = 0; i < TRIES && !status; i++) {
        double one[3];
        status = try_once(simulation, saved, one, error);
        for (int k = 0; k < 3; k++) time[k][i] = one[k];
    }
    lar_saved_destroy(saved);
    if (status) return status;
    r->save = lar_spread_of(time[0], TRIES).median;
    r->load = lar_spread_of(time[1], TRIES).median;
    r->step_after = lar_spread_of(time[2], TRIES).median;
    return LAR_OK;
}

/* ---- one sample ----------------------------------------------------------------------------- */

/* The step nearest to the next frame of a run, or `end`, whichever is first. */
static uint64_t next_stop(const bench *b, uint64_t now, uint64_t end) {
    if (b->interval <= 0) return end;
    double steps = b->interval / b->result->time_step; /* between frames */
    double stop = round((floor(((double)now + 0.5) / steps) + 1) * steps);
    return stop > (double)now && stop < (double)end ? (uint64_t)stop : end;
}

static lar_status advance_to(const bench *b, lar_step_clock *clock, lar_simulation *simulation,
                             uint64_t end, lar_error *error) {
    lar_status status = LAR_OK;
    for (uint64_t now = lar_simulation_steps(simulation); !status && now < end;
         now = lar_simulation_steps(simulation))
        status = lar_step_clock_advance(clock, simulation, next_stop(b, now, end) - now, NULL, NULL,
                                        error);
    return status;
}

static lar_status time_steps(bench *b, lar_simulation *simulation, double *microseconds,
                             lar_error *error) {
    const lar_bench_step_result *r = b->result;
    lar_step_clock *clock = b->clock;
    lar_step_clock_start(clock, simulation, false);
    lar_status status = advance_to(b, clock, simulation, r->warm_up + r->steps, error);
    if (status) return status;
    lar_histogram_merge(b->times, &clock->times);
    *microseconds = lar_step_clock_quantile(clock, 0.5);
    return LAR_OK;
}

static lar_status check_hash(lar_bench_step_result *r, uint64_t hash, int sample,
                             lar_error *error) {
    if (sample == 0) r->hash = hash;
    if (r->hash == hash) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "after %llu steps the state hash is %016llx in sample %d, and %016llx in the "
                    "first: report this with the model",
                    (unsigned long long)(r->warm_up + r->steps), (unsigned long long)hash,
                    sample + 1, (unsigned long long)r->hash);
}

static lar_status create(const bench *b, lar_simulation **simulation, lar_error *error) {
    lar_options options = lar_options_default();
    options.isa = b->options->isa;
    return lar_simulation_create(b->options->model, &options, simulation, error);
}

static lar_status take_sample(bench *b, int sample, lar_error *error) {
    lar_bench_step_result *r = b->result;
    lar_simulation *simulation = NULL;
#ifdef __GLIBC__
    malloc_trim(0); /* or every simulation would get the pages of the one before */
#endif
    lar_status status = create(b, &simulation, error);
    if (status) return status;
    status = lar_simulation_advance(simulation, r->warm_up, error);
    if (!status) status = time_steps(b, simulation, &b->samples[sample], error);
    if (!status) status = check_hash(r, lar_simulation_hash(simulation), sample, error);
    lar_simulation_contact(simulation, &r->contact);
    if (!status) status = time_saving(r, simulation, error);
    lar_simulation_destroy(simulation);
    return status;
}

/* ---- all samples ---------------------------------------------------------------------------- */

/* The largest of 1, 2, 5, 10, 20, ... that is not above `max`. */
static uint64_t round_down(double max) {
    uint64_t power = 1;
    while ((double)power * 10 <= max && power < LAR_BENCH_STEP_STEPS_MAX) power *= 10;
    return 5 * (double)power <= max ? 5 * power : 2 * (double)power <= max ? 2 * power : power;
}

/* How many steps a sample has; what a machine takes for them differs little from day to day, and
 * the number so hardly ever. */
static lar_status choose_steps(bench *b, lar_error *error) {
    lar_bench_step_result *r = b->result;
    lar_simulation *simulation = NULL;
    lar_status status = create(b, &simulation, error);
    if (status) return status;
    r->isa = lar_simulation_isa(simulation);
    r->time_step = lar_simulation_time_step(simulation);
    r->steps = b->options->steps;
    if (r->steps == 0) {
        lar_step_clock_start(b->clock, simulation, false);
        while (!status && lar_step_clock_elapsed(b->clock) < 0.2 * SAMPLE_TIME)
            status = lar_step_clock_advance(b->clock, simulation, 5, NULL, NULL, error);
        double step = 1e-6 * lar_step_clock_quantile(b->clock, 0.5);
        r->steps = round_down(step > 0 ? SAMPLE_TIME / step : 1);
    }
    r->warm_up = b->options->warm_up == UINT64_MAX ? (r->steps + 4) / 5 : b->options->warm_up;
    lar_simulation_destroy(simulation);
    return status;
}

static lar_status take_samples(bench *b, lar_error *error) {
    lar_bench_step_result *r = b->result;
    lar_status status = choose_steps(b, error);
    for (int k = 0; k < r->repeat && !status; k++) status = take_sample(b, k, error);
    if (status) return status;
    r->microseconds = lar_spread_of(b->samples, r->repeat);
    r->timed = b->times->count;
    r->mean = 1e-3 * (double)b->times->sum / (double)b->times->count;
    r->p50 = 1e-3 * lar_histogram_quantile(b->times, 0.5);
    r->p99 = 1e-3 * lar_histogram_quantile(b->times, 0.99);
    r->p999 = 1e-3 * lar_histogram_quantile(b->times, 0.999);
    r->longest = 1e-3 * (double)b->times->max;
    return LAR_OK;
}

static lar_status check_options(const lar_bench_step_options *o, lar_error *error) {
    if (o->repeat < 1 || o->repeat > LAR_BENCH_REPEAT_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%d samples; take 1 to %d", o->repeat,
                        LAR_BENCH_REPEAT_MAX);
    if (o->steps > LAR_BENCH_STEP_STEPS_MAX ||
        (o->warm_up > LAR_BENCH_STEP_STEPS_MAX && o->warm_up != UINT64_MAX))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a sample has at most %d steps, after as many",
                        LAR_BENCH_STEP_STEPS_MAX);
    return LAR_OK;
}

lar_status lar_bench_step(const lar_bench_step_options *options, lar_bench_step_result *result,
                          lar_error *error) {
    lar_bench_step_result made = {.repeat = options->repeat};
    bench b = {.options = options, .result = &made};
    lar_status status = check_options(options, error);
    if (!status) status = lar_model_inspect(options->model, &made.info, error);
    if (status) return status;
    b.interval = lar_model_output_interval(options->model);
    b.times = lar_calloc(1, sizeof *b.times);
    b.clock = lar_calloc(1, sizeof *b.clock);
    b.samples = lar_calloc((size_t)options->repeat, sizeof *b.samples);
    status = b.times && b.clock && b.samples ? take_samples(&b, error)
                                             : lar_fail_memory(error, sizeof *b.times, "samples");
    free(b.times);
    free(b.clock);
    free(b.samples);
    if (!status) *result = made;
    return status;
}
