/* What is answered: estimates with intervals, how well every experiment is met, and sentences that
 * say what to make of it. */
#ifndef LAR_STUDY_INVERSE_RESULT_H
#define LAR_STUDY_INVERSE_RESULT_H

#include "study/inverse/problem.h"

enum { LAR_INVERSE_NOTES_MAX = 24, LAR_INVERSE_NOTE = 400 };

typedef struct lar_inverse_estimate {
    double value;
    double low, high;   /* 95 %; NAN: there is no interval */
    bool told;          /* whether the data say what it is */
    bool profiled;      /* the interval is of a profile */
    bool at_bound;      /* stands at a bound, and the data ask for more: told is false */
    bool given_bound;   /* another one does: the interval is for that bound as a known number */
    double sensitivity; /* length of its column of J: how many standard deviations of noise the
                           data change when it changes e times */
} lar_inverse_estimate;

typedef struct lar_inverse_residuals {
    double rms;      /* of measured minus model [N] or [m] */
    double relative; /* over the largest measured, of surfaces over the body's length */
    int runs;        /* of equal signs */
    double runs_z;   /* against as many as chance gives; below -1.96: too few */
    double lag;      /* correlation of neighbours, by rows or in space */
    bool systematic;
} lar_inverse_residuals;

typedef struct lar_inverse_result {
    int parameters, values, runs;
    bool converged, interrupted;
    double seconds, deviation; /* s, in units of the noise; NAN without a degree of freedom */
    lar_inverse_estimate estimate[LAR_INVERSE_PARAMETERS_MAX];
    double correlation[LAR_INVERSE_PARAMETERS_MAX][LAR_INVERSE_PARAMETERS_MAX];
    lar_inverse_residuals residuals[LAR_INVERSE_EXPERIMENTS_MAX];
    double
        exact[LAR_INVERSE_EXPERIMENTS_MAX]; /* what half the time step changes at most [N], [m] */
    double *model; /* [values] what would have been measured, all experiments in a row */
    int notes;
    char note[LAR_INVERSE_NOTES_MAX][LAR_INVERSE_NOTE]; /* sentences: what to make of it */
} lar_inverse_result;

void lar_inverse_result_clear(lar_inverse_result *result); /* idempotent */

/* Whether an estimate is held back by its bound: then the others lean on a wrong one. */
bool lar_inverse_at_bound(const lar_inverse_result *result);

/* printf-style; what does not fit is left out. */
void lar_inverse_note(lar_inverse_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
