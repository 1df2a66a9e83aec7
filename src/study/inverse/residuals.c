#include "study/inverse/residuals.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

/* Residuals of less than this, of the largest measured number, are the mesh's or the run's. */
static const double TINY = 5e-4;
enum {
    ENOUGH = 8, /* values that chance can be told in */
    A_FEW = 3   /* where all are off to one side by more than the noise */
};

static void test_runs(lar_inverse_residuals *r, const double *left, int n) {
    double up = 0, down = 0;
    r->runs = 0;
    for (int i = 0; i < n; i++) {
        bool above = left[i] > 0;
        *(above ? &up : &down) += 1;
        if (i == 0 || above != (left[i - 1] > 0)) r->runs++;
    }
    double mean = 2 * up * down / n + 1;
    double variance = (mean - 1) * (mean - 2) / (n - 1);
    if (up == 0 || down == 0)
        r->runs_z = -INFINITY;
    else
        r->runs_z = variance > 0 ? (r->runs - mean) / sqrt(variance) : 0;
}

static double lag_of(const double *left, int n) {
    double with = 0, all = 0;
    for (int i = 0; i < n; i++) {
        all += left[i] * left[i];
        if (i > 0) with += left[i] * left[i - 1];
    }
    return all > 0 ? with / all : 0;
}

/* Correlation of points with those that are nearest to them (Moran's, Biometrika 37:17, 1950, with
 * one neighbour each); of at most MANY of them, as all are looked at for each. */
static double lag_in_space(const lar_inverse_experiment *e, const double *left) {
    enum { MANY = 2000 };
    const double(*at)[3] = (const double(*)[3])e->points.surface.vertex;
    int axes = e->values / e->rows, every = 1 + (e->rows - 1) / MANY;
    double with = 0, all = 0;
    for (int32_t i = 0; i < e->rows; i += every) {
        double least = INFINITY;
        int32_t near = i;
        for (int32_t j = 0; j < e->rows; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++) square += (at[i][k] - at[j][k]) * (at[i][k] - at[j][k]);
            if (j == i || square >= least) continue;
            least = square;
            near = j;
        }
        for (int k = 0; k < axes; k++) {
            all += left[axes * i + k] * left[axes * i + k];
            with += left[axes * i + k] * left[axes * near + k];
        }
    }
    return all > 0 ? with / all : 0;
}

/* Mean of what is left where the way is longest, or shortest: a third of the way each. */
static double mean_at(const lar_inverse_experiment *e, const double *left, bool large) {
    double far = 0, sum = 0;
    int count = 0;
    for (int32_t i = 0; i < e->rows; i++) far = fmax(far, fabs(e->along[i]));
    for (int32_t i = 0; i < e->rows; i++) {
        double at = fabs(e->along[i]) / far;
        if (large ? at < 2.0 / 3 : at > 1.0 / 3 || at == 0) continue;
        sum += left[i];
        count++;
    }
    return count ? sum / count : 0;
}

/* Whether the model lies on one side of all that was measured, by more than the noise. */
static bool one_sided(const lar_inverse_experiment *e, const double *left) {
    for (int32_t i = 0; i < e->values; i++) {
        double noise = e->error ? e->error[i] : e->noise;
        if (fabs(left[i]) <= noise || (left[i] > 0) != (left[0] > 0)) return false;
    }
    return e->values >= A_FEW;
}

static void note_shape(const lar_inverse_experiment *e, const lar_inverse_residuals *r,
                       const double *left, lar_inverse_result *result) {
    const char *at = "";
    bool bound = lar_inverse_at_bound(result); /* then that is why, and said already */
    bool curve = !bound && e->kind <= LAR_INVERSE_INDENTATION && e->along;
    double large = curve ? mean_at(e, left, true) : 0, sign = 0;
    for (int32_t i = 0; curve && i < e->rows; i++) sign += e->measured[i];
    if (sign < 0) large = -large;
    if (curve && large > 0.3 * r->rms) at = "; the law is too soft at large strain";
    if (curve && large < -0.3 * r->rms) at = "; the law is too stiff at large strain";
    const char *advice =
        r->relative > 0.01 && !bound ? ": try another law, or look at mesh and supports" : "";
    lar_inverse_note(result,
                     "%s: what is left is no chance (%d changes of sign in %d values, neighbours "
                     "correlate by %.2f), %.2g %% of the largest measured%s%s",
                     e->name, r->runs - 1, (int)e->values, r->lag, 100 * r->relative, at, advice);
}

/* Of points: they have places, and no order. */
static void look_at_points(const lar_inverse_experiment *e, lar_inverse_residuals *r,
                           const double *left, double tiny, lar_inverse_result *result) {
    r->lag = lag_in_space(e, left);
    /* twice the deviation by chance, in which two that are nearest to each other count twice */
    r->systematic = r->rms > tiny && e->rows >= ENOUGH && r->lag > 2 * sqrt(2.0 / e->rows);
    if (!r->systematic) return;
    lar_inverse_note(result,
                     "%s: what is left is no chance (of %d points nearest ones correlate by %.2f), "
                     "%.3g mm in the mean: the shape at rest, supports or the law are a little "
                     "other ones. Intervals take points as independent, and are too narrow then",
                     e->name, (int)e->rows, r->lag, 1e3 * r->rms);
}

/* ---- single values ------------------------------------------------------------------------------
 */

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The deviation of normal numbers with this median in size, in which a slip hardly counts
 * (Rousseeuw and Croux, Journal of the American Statistical Association 88:1273, 1993). of[n] gets
 * sorted. */
static double robust_deviation(double *of, int n) {
    static const double OF_MEDIAN = 1.4826;
    qsort(of, (size_t)n, sizeof *of, by_size);
    return OF_MEDIAN * 0.5 * (of[(n - 1) / 2] + of[n / 2]);
}

/* Values that are off by far more than the others: slips of a person, or of a machine, which least
 * squares follow and no interval knows of. By chance one of 300 tables of eight values has one, and
 * fewer of longer tables. More than a tenth are no slips, but a law that does not fit. */
static void look_for_slips(const lar_inverse_experiment *e, const double *left, double tiny,
                           lar_inverse_result *result) {
    static const double FAR = 7;
    const int n = e->values;
    int far = 0, worst = 0;
    double *off = n < ENOUGH ? NULL : lar_calloc(2 * (size_t)n, sizeof *off);
    if (!off) return;
    double *sorted = off + n;
    for (int i = 0; i < n; i++) sorted[i] = off[i] = fabs(left[i]) / (e->error ? e->error[i] : 1);
    const double deviation = robust_deviation(sorted, n);
    for (int i = 0; i < n; i++) {
        far += off[i] > FAR * deviation && fabs(left[i]) > tiny;
        if (off[i] > off[worst]) worst = i;
    }
    if (far > 0 && far <= (n + 9) / 10)
        lar_inverse_note(result,
                         "%s:%d: this value is off by %.2g times the deviation of the others, and "
                         "%s; look for slips, and fit again without such rows (# in front of them)",
                         e->data, e->row_line[worst * e->rows / n], off[worst] / deviation,
                         far == 1 ? "no other one is off so far" : "a few are off like that");
    free(off);
}

void lar_inverse_look_at_residuals(const lar_inverse_problem *problem, lar_inverse_result *result) {
    double *model = result->model; /* becomes what is left, and the model again */
    const bool judged = result->converged || !result->interrupted;
    for (int k = 0; k < problem->experiments; model += problem->experiment[k++].values) {
        const lar_inverse_experiment *e = &problem->experiment[k];
        lar_inverse_residuals *r = &result->residuals[k];
        int n = e->values;
        double squares = 0;
        for (int i = 0; i < n; i++) {
            model[i] = e->measured[i] - model[i];
            squares += model[i] * model[i];
        }
        r->rms = sqrt(squares / n);
        r->relative = r->rms / e->whole;
        r->lag = NAN;
        test_runs(r, model, n);
        const double tiny = fmax(TINY * e->largest, result->exact[k]);
        if (judged) look_for_slips(e, model, tiny, result);
        if (judged && e->kind >= LAR_INVERSE_MARKERS) {
            look_at_points(e, r, model, tiny, result);
        } else if (judged) {
            r->lag = lag_of(model, n);
            r->systematic =
                r->rms > tiny && (one_sided(e, model) ||
                                  (n >= ENOUGH && (r->runs_z < -1.96 || r->lag > 2 / sqrt(n))));
            if (r->systematic) note_shape(e, r, model, result);
        }
        for (int i = 0; i < n; i++) model[i] = e->measured[i] - model[i];
    }
}
