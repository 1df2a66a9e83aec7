/* Lariat: parameters of tissue from experiments. The public C API of liblariat-fit.
 *
 * What the command `lariat fit` does, inside another program: an EXPERIMENT FILE (docs/fit.md,
 * docs/formats.md) names scenes, tables of measured numbers and the parameters that are free; a fit
 * simulates until the scenes answer as the tissue did.
 *
 *     lar_error error;
 *     lar_fit *fit = NULL;
 *     lar_fit_parameter_info c1;
 *     if (lar_fit_open("strip.yaml", &fit, &error) || lar_fit_run(fit, NULL, &error) ||
 *         lar_fit_parameter(fit, 0, &c1, &error) || lar_fit_write(fit, "fitted", &error))
 *         fprintf(stderr, "%s\n", error.message);
 *     else
 *         printf("%s: %g %s, %g to %g\n", c1.name, c1.value, c1.unit, c1.low, c1.high);
 *     lar_fit_destroy(fit);
 *
 * A library of its own, so that programs which only simulate need no cminpack:
 * `pkg-config lariat-fit`, or Lariat::fit in CMake. It simulates with liblariat, of exactly the
 * same version; memory comes from where that one's comes from (lar_memory_set).
 *
 * Conventions are those of lariat.h: SI units, a lar_status and one sentence, outputs on success
 * only, NULL for calls without a status. A fit belongs to one thread at a time, but for
 * lar_fit_stop; several fits may run at once.
 */
#ifndef LARIAT_FIT_H
#define LARIAT_FIT_H

#include "lariat.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lar_fit lar_fit;

/* ---- what is asked ----------------------------------------------------------------------- */

/* Reads an experiment file with the scenes and tables that it names. LAR_ERROR_FORMAT and
 * LAR_ERROR_MODEL name file and line. The caller destroys the fit. */
LAR_API lar_status lar_fit_open(const char *path, lar_fit **fit, lar_error *error);
/* The same from the text of such a file. What it names lies in `folder`; NULL: in the current one.
 * Messages call it "experiment" in that folder. Nothing is kept of text and folder. */
LAR_API lar_status lar_fit_from_text(const char *text, const char *folder, lar_fit **fit,
                                     lar_error *error);
LAR_API void lar_fit_destroy(lar_fit *fit);

/* ---- the fit ----------------------------------------------------------------------------- */

typedef struct lar_fit_progress {
    const char *doing; /* "fitting", "looking how well the data tell", ... */
    int32_t runs;      /* simulations so far */
    double residual;   /* root mean square in units of the noise, the best so far of what it is
                          doing; INFINITY: none yet */
    double remaining;  /* a guess [s]; below 0: not known yet */
} lar_fit_progress;

/* Called by the thread that calls lar_fit_run, after every round of simulations. Not 0: stop, with
 * the best so far. *progress lives as long as the call. */
typedef int lar_fit_callback(void *context, const lar_fit_progress *progress);

typedef struct lar_fit_options {
    int32_t workers;            /* simulations at a time, at most; 0: one on each core */
    lar_fit_callback *progress; /* may be NULL */
    void *context;              /* for it */
} lar_fit_options;

/* As `lariat fit` does it: on all cores, without a word. */
LAR_SIZED lar_fit_options lar_fit_options_default(void);

/* Fits; takes seconds to hours. options NULL: the default ones. What is found does not depend on
 * the number of workers. A fit that was stopped is LAR_OK, `interrupted`, with the best values so
 * far and no intervals; LAR_ERROR_ARGUMENT where there is none yet. LAR_ERROR_UNSTABLE: no answer
 * with the first guess. May be called again; a failed call leaves the former answer. */
LAR_SIZED lar_status lar_fit_run(lar_fit *fit, const lar_fit_options *options, lar_error *error);

/* Ends the run that is under way within some hundred steps, or the next one if there is none. From
 * any thread, and from signal handlers. */
LAR_API void lar_fit_stop(lar_fit *fit);

/* ---- the answer --------------------------------------------------------------------------- */

/* Counts are there from the beginning, all else after lar_fit_run. */
typedef struct lar_fit_info {
    const char *file, *title; /* live as long as the fit */
    int32_t parameters, experiments;
    int32_t values;      /* measured numbers of all experiments */
    int32_t done;        /* 0: no answer yet, and what follows is 0 */
    int32_t converged;   /* 0: the squares were still falling */
    int32_t interrupted; /* stopped: the best so far */
    int32_t runs;        /* simulations */
    int32_t notes;       /* sentences, for lar_fit_note */
    double seconds;      /* that it took */
    double deviation;    /* of what is left, in units of the noise; NAN: as many parameters as
                            values, or interrupted */
} lar_fit_info;

/* `info` is the caller's. */
LAR_SIZED lar_status lar_fit_inspect(const lar_fit *fit, lar_fit_info *info, lar_error *error);

/* One free parameter. Texts live as long as the fit. Numbers are in its unit. */
typedef struct lar_fit_parameter_info {
    const char *material, *name, *unit;     /* unit: "Pa", "s" or "" */
    double guess, lower_bound, upper_bound; /* of the file */
    double value;                           /* before lar_fit_run: the guess */
    double low, high;                       /* the 95 % interval; NAN: there is none */
    int32_t told;                           /* the data say what it is */
    int32_t profiled;                       /* the interval is of a profile: all others were fitted
                                               anew for each of its ends */
    int32_t at_bound;                       /* it stands at a bound, and the data ask for a value
                                               beyond: told is 0, widen the bound and fit again */
    int32_t given_bound;                    /* another one does: the interval is for that bound
                                               as a known number */
    double sensitivity;                     /* by how many standard deviations of the noise the data
                                               change when it changes e times; 0: not known */
} lar_fit_parameter_info;

/* Parameter `index` of lar_fit_info.parameters, in the order of the file; LAR_ERROR_ARGUMENT
 * beyond. `info` is the caller's. */
LAR_SIZED lar_status lar_fit_parameter(const lar_fit *fit, int32_t index,
                                       lar_fit_parameter_info *info, lar_error *error);
/* Of two parameters, -1 to 1: near either end only both together are known. NAN: not known, or no
 * such parameters. */
LAR_API double lar_fit_correlation(const lar_fit *fit, int32_t i, int32_t j);

/* One experiment, and how well it is met. Texts live as long as the fit, `model` until it runs
 * again. */
typedef struct lar_fit_experiment_info {
    const char *name, *kind, *scene, *data; /* kind: "tension", ... */
    int32_t in_time;                        /* simulated in its own time; 0: followed to rest */
    int32_t values;                         /* measured numbers */
    const double *measured;                 /* [values] N; heights, ways and distances: m */
    const double *model;                    /* [values] of the fitted model; NULL: no answer yet */
    double noise;                           /* standard deviation of one [N] or [m] */
    double rms;                             /* of measured minus model [N] or [m] */
    double relative;                        /* by the largest, surfaces: by the body's length */
    int32_t systematic;                     /* what is left is no chance: a note says how */
    int32_t sign_runs;                      /* how often what is left keeps its sign for a while */
    double sign_runs_z;                     /* against what chance gives; below -1.96: too few */
    double lag;                             /* correlation of neighbours in what is left */
} lar_fit_experiment_info;

/* Experiment `index` of lar_fit_info.experiments; LAR_ERROR_ARGUMENT beyond. `info` is the
 * caller's. */
LAR_SIZED lar_status lar_fit_experiment(const lar_fit *fit, int32_t index,
                                        lar_fit_experiment_info *info, lar_error *error);

/* What to make of the answer, one sentence each: read them. NULL beyond the count. Live until the
 * fit runs again. */
LAR_API const char *lar_fit_note(const lar_fit *fit, int32_t index);

/* ---- files -------------------------------------------------------------------------------- */

/* All that `lariat fit --out` writes, into a folder that is made where it is missing: a tissue file
 * of each material, a picture of each experiment, fit.json. Each file is whole or not there.
 * LAR_ERROR_ARGUMENT before lar_fit_run, here and below. */
LAR_API lar_status lar_fit_write(const lar_fit *fit, const char *folder, lar_error *error);
/* The tissue file of one fitted material, for `tissue: FILE` of a scene; material NULL: of the only
 * one. */
LAR_API lar_status lar_fit_write_tissue(const lar_fit *fit, const char *path, const char *material,
                                        lar_error *error);
/* Measured numbers and the model's of one experiment, as a picture (SVG). */
LAR_API lar_status lar_fit_write_svg(const lar_fit *fit, const char *path, int32_t experiment,
                                     lar_error *error);
/* The answer as `lariat fit --json` prints it. */
LAR_API lar_status lar_fit_write_json(const lar_fit *fit, const char *path, lar_error *error);

/* ---- structs that grow, as in lariat_sizes.h ------------------------------------------------ */

LAR_API void lar_fit_options_default_sized(lar_fit_options *options, size_t size);
LAR_API lar_status lar_fit_run_sized(lar_fit *fit, const lar_fit_options *options, size_t size,
                                     lar_error *error);
LAR_API lar_status lar_fit_inspect_sized(const lar_fit *fit, lar_fit_info *info, size_t size,
                                         lar_error *error);
LAR_API lar_status lar_fit_parameter_sized(const lar_fit *fit, int32_t index,
                                           lar_fit_parameter_info *info, size_t size,
                                           lar_error *error);
LAR_API lar_status lar_fit_experiment_sized(const lar_fit *fit, int32_t index,
                                            lar_fit_experiment_info *info, size_t size,
                                            lar_error *error);

LAR_SIZED lar_fit_options lar_fit_options_default(void) {
    lar_fit_options options;
    lar_fit_options_default_sized(&options, sizeof options);
    return options;
}
LAR_SIZED lar_status lar_fit_run(lar_fit *fit, const lar_fit_options *options, lar_error *error) {
    return lar_fit_run_sized(fit, options, sizeof *options, error);
}
LAR_SIZED lar_status lar_fit_inspect(const lar_fit *fit, lar_fit_info *info, lar_error *error) {
    return lar_fit_inspect_sized(fit, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_fit_parameter(const lar_fit *fit, int32_t index,
                                       lar_fit_parameter_info *info, lar_error *error) {
    return lar_fit_parameter_sized(fit, index, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_fit_experiment(const lar_fit *fit, int32_t index,
                                        lar_fit_experiment_info *info, lar_error *error) {
    return lar_fit_experiment_sized(fit, index, info, sizeof *info, error);
}

#ifdef __cplusplus
}
#endif

#endif
