/* How long the steps of a real scene take, as `lariat run` does them.
 *
 *     a sample   create | warm up | step step step ... | hash | destroy      --repeat samples
 *
 * Every sample makes its simulation anew, because where memory happens to lie changes a time by
 * some per cent, and does the same steps of the same scene: with contact and tools these do not
 * all cost the same. Advances end where a run would write a frame; nothing is written. A sample is
 * the median of its steps: on a machine that does something else as well the mean is mostly of
 * that. The percentiles are those of the single steps of all samples. All samples end with the same
 * state hash, or the benchmark fails.
 *
 * In the state at the end of each sample it is measured, too, what it takes to save it in memory,
 * to go back to it after a step, and how long the first step behind that is, in which contact is
 * searched anew: what one try costs of who tries many things from one state (lar_saved).
 */
#ifndef LAR_STUDY_BENCH_STEP_H
#define LAR_STUDY_BENCH_STEP_H

#include "study/bench/kernel.h"

enum { LAR_BENCH_STEP_STEPS_MAX = 100000000 };

typedef struct lar_bench_step_options {
    const lar_model *model;
    lar_isa isa;
    uint64_t steps;   /* of a sample, 0: 1, 2 or 5 times a power of ten that last some tenths of a
                         second; at most LAR_BENCH_STEP_STEPS_MAX */
    uint64_t warm_up; /* steps before them; UINT64_MAX: a fifth of them */
    int repeat;       /* samples, 1..LAR_BENCH_REPEAT_MAX */
} lar_bench_step_options;

typedef struct lar_bench_step_result {
    lar_model_info info;
    const char *isa;
    double time_step;        /* [s] */
    uint64_t warm_up, steps; /* of a sample */
    int repeat;
    uint64_t timed;                 /* single steps, of all samples */
    lar_spread microseconds;        /* of a step: the samples' medians */
    double mean;                    /* of all steps [us] */
    double p50, p99, p999, longest; /* of single steps [us] */
    uint64_t hash;                  /* after warm-up and steps */
    lar_contact_info contact;       /* then */
    double save, load, step_after;  /* in memory; of the steps after loading [us], medians */
} lar_bench_step_result;

/* Fails as creating and advancing a simulation fails, and for options out of range. */
lar_status lar_bench_step(const lar_bench_step_options *options, lar_bench_step_result *result,
                          lar_error *error);

/* The demonstration organ with the scene of `lariat demo-model`, uterus.yaml, without a file. Takes
 * about a second. The caller destroys it. */
lar_status lar_bench_step_organ(lar_model **model, lar_error *error);

#endif
