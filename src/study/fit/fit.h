/* `lariat fit`: parameters of tissue from experiments, and what is known of them.
 *
 *     experiment.h  the file    solver.h  least squares    profile.h  what cannot be told
 *     forward.h     one run     fit.h     the answer       output.h   tissue files, pictures
 *
 * Around the least squares the model is taken as linear in u (study/fit/parameters.h): with the
 * Jacobian J of the weighted residuals and s^2 = squares / (values - parameters),
 *
 *     C = s^2 (J^T J)^-1,        interval: u +- t sqrt(C_jj), t of Student for 95 %
 *
 * which is a factor for parameters of positive bounds (Bard, Nonlinear Parameter Estimation, 1974,
 * chapter 7). J^T J is taken apart into its directions, the squares of J's singular values, so that
 * those that the data say nothing of have a name. Where an interval is wider than a factor of two,
 * or ends at a bound, the linear picture is not believed: there the parameter is moved by hand and
 * all others are fitted anew (profile likelihood: Raue et al., Bioinformatics 25:1923, 2009). What
 * then fits as well at a bound is "cannot be told", and not given a number.
 *
 * Data without noise would give intervals of no width. Runs are exact to about 1e-4 of the largest
 * measured number at most, so s is never less than that.
 */
#ifndef LAR_STUDY_FIT_FIT_H
#define LAR_STUDY_FIT_FIT_H

#include "study/fit/solver.h"

enum { LAR_FIT_NOTES_MAX = 24, LAR_FIT_NOTE = 400 };

typedef struct lar_fit_estimate {
    double value;
    double low, high;   /* 95 %; NAN: there is no interval */
    bool told;          /* whether the data say what it is */
    bool profiled;      /* the interval is of a profile */
    double sensitivity; /* length of its column of J: how many standard deviations of noise the
                           data change when it changes e times */
} lar_fit_estimate;

typedef struct lar_fit_residuals {
    double rms;      /* of measured minus model [N] or [m] */
    double relative; /* over the largest measured */
    int runs;        /* of equal signs */
    double runs_z;   /* against as many as chance gives; below -1.96: too few */
    double lag;      /* correlation of neighbours */
    bool systematic;
} lar_fit_residuals;

typedef struct lar_fit_result {
    int parameters, values, runs;
    bool converged, interrupted;
    double seconds, deviation; /* s, in units of the noise; NAN without a degree of freedom */
    lar_fit_estimate estimate[LAR_FIT_PARAMETERS_MAX];
    double correlation[LAR_FIT_PARAMETERS_MAX][LAR_FIT_PARAMETERS_MAX];
    lar_fit_residuals residuals[LAR_FIT_EXPERIMENTS_MAX];
    double *model; /* [values] what would have been measured, all experiments in a row */
    int notes;
    char note[LAR_FIT_NOTES_MAX][LAR_FIT_NOTE]; /* sentences: what to make of it */
} lar_fit_result;

/* Fits. The caller clears the result in any case. */
lar_status lar_fit_solve(const lar_fit_problem *problem, const lar_fit_options *options,
                         lar_fit_result *result, lar_error *error);
void lar_fit_result_clear(lar_fit_result *result); /* idempotent */

/* printf-style; what does not fit is left out. */
void lar_fit_note(lar_fit_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Of |T| below it is the share of 95 %, with so many degrees of freedom. */
double lar_student_95(int freedom);

#endif
