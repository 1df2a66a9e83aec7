#include "study/bench/scaling.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/pin.h"
#include "comm/job.h"
#include "model/model.h"
#include "study/bench/comm.h"
#include "study/bench/comm_pair.h"
#include "study/processes.h"
#include "study/bench/scaling_rows.h"

static const double SAMPLE_TIME = 0.1; /* of the plain loop, warm-up apart [s] */
/* Virtual cores that have been idle may share one core of the host at first: after some 0.3 s they
 * do no more, and two processors are twice as fast. */
static const double WARM_UP_TIME = 0.6; /* of the plain loop [s] */
enum { SECTIONS = 20 };                 /* of a sample */

typedef struct bench {
    const lar_bench_scaling_options *options;
    lar_bench_scaling_result *result;
    lar_comm_job job; /* count 1: mpirun has started nothing */
    double *samples;  /* [rows][repeat] us */
    double *probes;   /* [repeat] ns */
} bench;

/* ---- the block ------------------------------------------------------------------------------ */

/* Every node has a velocity of its own, one wave over the block: some micrometres. */
static lar_status set_in_motion(lar_model *model, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    const double *end = mesh->position[mesh->node_count - 1];
    for (int32_t n = 0; n < mesh->node_count; n++) {
        lar_initial_velocity *initial = LAR_MODEL_APPEND(model, initial);
        int32_t *node = initial ? lar_calloc(1, sizeof *node) : NULL;
        if (!node) return lar_fail_memory(error, 64, "the motion of the block");
        *node = n;
        initial->nodes.node = node;
        initial->nodes.count = 1;
        for (int i = 0; i < 3; i++)
            initial->velocity[i] =
                1e-3 * sin(3 * mesh->position[n][(i + 1) % 3] / end[(i + 1) % 3] + 0.3 * i + 0.1);
    }
    return LAR_OK;
}

lar_status lar_bench_scaling_block(int32_t elements, lar_model **model, lar_error *error) {
    int32_t edge[3];
    lar_model *made = NULL;
    lar_bench_edges(elements, edge);
    lar_status status = lar_bench_block(edge, true, &made, error);
    if (!status) status = set_in_motion(made, error);
    if (status)
        lar_model_destroy(made);
    else
        *model = made;
    return status;
}

/* ---- processes ------------------------------------------------------------------------------ */

static lar_options options_of(const lar_bench_scaling_options *o,
                              const lar_bench_scaling_row *row) {
    lar_options options = lar_options_default();
    if (strcmp(row->comm, "none") == 0) return options;
    options.grid = row->grid;
    options.threads = row->threads;
    options.comm = row->comm;
    options.scheme = o->scheme;
    /* What is measured stays one division. */
    if (row->processors > 1) options.distribution = o->distribution ? o->distribution : "cut";
    options.pin = o->pin;
    return options;
}

/* The processes of one sample; *processes stays NULL where there are none to start. */
static lar_status call_processes(const bench *b, const lar_bench_scaling_row *row,
                                 lar_processes **processes, lar_error *error) {
    enum { ARGUMENTS = 12 };
    const lar_bench_scaling_options *o = b->options;
    const char *argument[ARGUMENTS] = {"--grid", row->grid, "--comm", row->comm};
    int count = 4;
    if (o->scheme) argument[count++] = "--scheme", argument[count++] = o->scheme;
    if (o->distribution) argument[count++] = "--distribution", argument[count++] = o->distribution;
    if (!o->pin) argument[count++] = "--no-pin";
    for (int i = 0; i < 2; i++)
        if (o->argument[i]) argument[count++] = o->argument[i];
    const lar_processes_setting setting = {.comm = row->comm,
                                           .processor = -1,
                                           .command = o->command,
                                           .argument_count = count,
                                           .argument = (char *const *)argument};
    lar_status status = lar_processes_begin(&setting, processes, error);
    return status ? status : lar_processes_start(*processes, row->processors, error);
}

/* How a process ended says more than that its connection did. */
static lar_status end_processes(lar_processes *processes, lar_status status, lar_error *error) {
    lar_error end;
    lar_status left = lar_processes_end(processes, status, &end);
    if (!left || (status && status != LAR_ERROR_PEER)) return status;
    if (error) *error = end;
    return left;
}

static lar_status serve(lar_processes *processes, const lar_model *model,
                        const lar_options *options, lar_error *error) {
    lar_simulation *simulation = NULL;
    lar_status status = lar_processes_create(processes, model, options, &simulation, error);
    if (!status) status = lar_simulation_serve(simulation, error);
    lar_simulation_destroy(simulation);
    return status;
}

lar_status lar_bench_scaling_serve(const lar_bench_scaling_options *o, int32_t processor,
                                   const char *master, lar_error *error) {
    const lar_processes_setting setting = {
        .comm = o->comm, .processor = processor, .master = master, .command = o->command};
    lar_processes *processes = NULL;
    lar_options options = lar_options_default();
    options.grid = o->grids;
    options.comm = o->comm;
    options.scheme = o->scheme;
    options.distribution = o->distribution;
    options.pin = o->pin;
    lar_status status = lar_processes_begin(&setting, &processes, error);
    if (status) return status;
    status = serve(processes, o->model, &options, error);
    if (status && status != LAR_ERROR_PEER) lar_processes_hesitate(processes);
    return end_processes(processes, status, error);
}

/* What the other processes of mpirun do: as many samples, in the same order. */
static lar_status serve_all(bench *b, lar_error *error) {
    const lar_bench_scaling_result *r = b->result;
    lar_status status = LAR_OK;
    for (int k = 0; k < r->repeat; k++)
        for (int i = 0; i < r->rows && !status; i++) {
            const lar_bench_scaling_row *row = &r->row[i];
            if (row->missing || !lar_scaling_by_processes(row)) continue;
            lar_options options = options_of(b->options, row);
            status = lar_processes_meet_in_job(&b->job, &options, error);
            if (!status) status = serve(NULL, b->options->model, &options, error);
        }
    return status;
}

/* ---- one sample ----------------------------------------------------------------------------- */

typedef struct stopwatch {
    uint64_t next, section; /* steps */
    int count;
    double at[SECTIONS + 1];
} stopwatch;

static int tick(void *context, uint64_t step) {
    stopwatch *w = context;
    if (step == w->next && w->count <= SECTIONS) {
        w->at[w->count++] = lar_pair_now();
        w->next += w->section;
    }
    return 1;
}

/* Microseconds of a step. */
static double median_of_sections(const stopwatch *w) {
    double section[SECTIONS];
    for (int i = 0; i < SECTIONS; i++)
        section[i] = 1e6 * (w->at[i + 1] - w->at[i]) / (double)w->section;
    return lar_spread_of(section, SECTIONS).median;
}

static lar_status check_hash(bench *b, const lar_bench_scaling_row *row, uint64_t hash,
                             lar_error *error) {
    lar_bench_scaling_result *r = b->result;
    if (r->hash == 0) r->hash = hash;
    if (r->hash == hash) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "after %llu steps the state hash is %016llx with grid %s by %s, and %016llx "
                    "without: report this with the model",
                    (unsigned long long)(r->warm_up + r->steps), (unsigned long long)hash,
                    row->grid, row->comm, (unsigned long long)r->hash);
}

static lar_status run_steps(bench *b, const lar_bench_scaling_row *row, lar_processes *processes,
                            const lar_options *options, double *microseconds, lar_error *error) {
    lar_bench_scaling_result *r = b->result;
    stopwatch callback = {.next = r->warm_up, .section = r->steps / SECTIONS};
    lar_simulation *simulation = NULL;
    lar_status status =
        lar_processes_create(processes, b->options->model, options, &simulation, error);
    if (status) return status;
    r->isa = lar_simulation_isa(simulation);
    status = lar_simulation_advance_with(simulation, r->warm_up + r->steps, tick, &callback, error);
    if (!status) status = check_hash(b, row, lar_simulation_hash(simulation), error);
    if (!status) *microseconds = median_of_sections(&callback);
    lar_simulation_destroy(simulation);
    return status;
}

/* The plain loop gets the same core as processor zero of the others. */
static lar_status run_bound(bench *b, const lar_bench_scaling_row *row, const lar_options *options,
                            double *microseconds, lar_error *error) {
    bool bound = b->options->pin && lar_pin_cores() > 1;
    lar_pin *before = bound ? lar_pin_remember() : NULL;
    if (bound) lar_pin_to(0);
    lar_status status = run_steps(b, row, NULL, options, microseconds, error);
    lar_pin_restore(before);
    return status;
}

static lar_status take_sample(bench *b, int i, int k, lar_error *error) {
    lar_bench_scaling_result *r = b->result;
    const lar_bench_scaling_row *row = &r->row[i];
    double *sample = &b->samples[i * r->repeat + k];
    lar_options options = options_of(b->options, row);
    lar_processes *processes = NULL;
    lar_status status = LAR_OK;
#ifdef __GLIBC__
    malloc_trim(0); /* or every simulation would get the pages of the one before */
#endif
    if (i == 0) return run_bound(b, row, &options, sample, error);
    if (lar_scaling_by_processes(row))
        status = b->job.count > 1 ? lar_processes_meet_in_job(&b->job, &options, error)
                                  : call_processes(b, row, &processes, error);
    if (!status) status = run_steps(b, row, processes, &options, sample, error);
    return end_processes(processes, status, error);
}

/* ---- all samples ---------------------------------------------------------------------------- */

/* Steps that the plain loop does in SAMPLE_TIME, whole sections. */
static lar_status calibrate(bench *b, lar_error *error) {
    lar_bench_scaling_result *r = b->result;
    lar_options options = lar_options_default();
    lar_simulation *simulation = NULL;
    uint64_t steps = 1;
    double took = 0;
    lar_status status = LAR_OK;
    if (!b->options->quick)
        status = lar_simulation_create(b->options->model, &options, &simulation, error);
    while (simulation && !status && took < 0.2 * SAMPLE_TIME) {
        double begin = lar_pair_now();
        steps *= 2;
        status = lar_simulation_advance(simulation, steps, error);
        took = lar_pair_now() - begin;
    }
    lar_simulation_destroy(simulation);
    double section = took > 0 ? (double)steps * SAMPLE_TIME / took / SECTIONS : 1;
    r->steps = SECTIONS * (uint64_t)fmax(1, section);
    r->warm_up = b->options->quick ? r->steps / 2
                                   : (uint64_t)(WARM_UP_TIME / SAMPLE_TIME * (double)r->steps);
    return status;
}

/* The word from core to core, of the same minute. */
static lar_status probe(double *nanoseconds, lar_error *error) {
    lar_bench_comm_options options = {
        .bytes = 8, .repeat = 3, .backends = "threads", .quick = true};
    lar_bench_comm_result *result = lar_calloc(1, sizeof *result);
    if (!result) return lar_fail_memory(error, sizeof *result, "the probe");
    lar_status status = lar_bench_comm(&options, result, error);
    if (!status) *nanoseconds = result->row[0].latency.median;
    free(result);
    return status;
}

static lar_status take_samples(bench *b, lar_error *error) {
    const lar_bench_scaling_result *r = b->result;
    lar_status status = calibrate(b, error);
    for (int k = 0; k < r->repeat && !status; k++) {
        if (b->options->turn) b->options->turn(b->options->context, k);
        if (b->job.count == 1) status = probe(&b->probes[k], error);
        for (int i = 0; i < r->rows && !status; i++)
            if (!r->row[i].missing) status = take_sample(b, i, k, error);
    }
    return status;
}

static void fill_rows(bench *b) {
    lar_bench_scaling_result *r = b->result;
    r->core_to_core = lar_spread_of(b->probes, r->repeat);
    for (int i = 0; i < r->rows; i++) {
        lar_bench_scaling_row *row = &r->row[i];
        if (row->missing) continue;
        row->microseconds = lar_spread_of(&b->samples[i * r->repeat], r->repeat);
        row->over_plain = row->microseconds.median / r->row[0].microseconds.median;
        row->speed_up = 1 / row->over_plain;
        row->efficiency = row->speed_up / (row->processors * row->threads);
    }
}

static lar_status measure(bench *b, lar_error *error) {
    lar_bench_scaling_result *r = b->result;
    r->cores = lar_pin_cores();
    r->pinned = b->options->pin && r->cores > 1;
    lar_status status = lar_model_inspect(b->options->model, &r->info, error);
    if (status) return status;
    size_t samples = (size_t)r->rows * (size_t)r->repeat;
    b->samples = lar_calloc(samples, sizeof *b->samples);
    b->probes = lar_calloc((size_t)r->repeat, sizeof *b->probes);
    if (!b->samples || !b->probes)
        status = lar_fail_memory(error, samples * sizeof *b->samples, "samples");
    if (!status) status = take_samples(b, error);
    if (!status) fill_rows(b);
    free(b->samples);
    free(b->probes);
    return status;
}

lar_status lar_bench_scaling(const lar_bench_scaling_options *options,
                             lar_bench_scaling_result *result, lar_error *error) {
    if (options->repeat < 1 || options->repeat > LAR_BENCH_REPEAT_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%d samples; take 1 to %d", options->repeat,
                        LAR_BENCH_REPEAT_MAX);
    lar_bench_scaling_result *made = lar_calloc(1, sizeof *made);
    if (!made) return lar_fail_memory(error, sizeof *made, "the benchmark");
    bench b = {.options = options, .result = made};
    made->repeat = options->repeat;
    lar_status status = lar_comm_job_find(&b.job, error);
    if (!status) {
        status = lar_scaling_rows(options, b.job.count, made, error);
        if (!status) status = b.job.self == 0 ? measure(&b, error) : serve_all(&b, error);
        if (b.job.self > 0) made->rows = 0;
        lar_status left = lar_comm_job_end(&b.job, status != LAR_OK, status ? NULL : error);
        if (!status) status = left;
    }
    if (!status) *result = *made;
    free(made);
    return status;
}
