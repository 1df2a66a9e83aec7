#include "study/inverse/inverse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "study/inverse/parameters.h"
#include "study/inverse/profile.h"
#include "study/inverse/residuals.h"

enum { P = LAR_INVERSE_PARAMETERS_MAX };

/* How exact a run is, of the largest measured number: the least deviation that is believed. */
static const double EXACT = 1e-4;
/* Wider than this, in u on one side, an interval is looked at with a profile. */
static const double WIDE = 0.69; /* ln 2 */
/* Nearer to a bound than this part of the way between both is at it. */
static const double AT_BOUND = 2e-3;

/* ---- statistics ------------------------------------------------------------------------------ */

/* With T = sqrt(n) tan(a) the density of Student is cos(a)^(n - 1), up to a constant. */
static double area_to(double angle, int n) {
    enum { PIECES = 400 };
    double sum = 0, h = angle / PIECES;
    for (int i = 0; i <= PIECES; i++)
        sum += (i == 0 || i == PIECES ? 1 : i % 2 ? 4 : 2) * pow(cos(i * h), n - 1);
    return sum * h / 3;
}

double lar_student_95(int n) {
    static const double RIGHT = 1.57079632679489662;
    double low = 0, high = RIGHT, all = area_to(RIGHT, n);
    for (int i = 0; i < 50; i++) {
        double middle = 0.5 * (low + high);
        if (area_to(middle, n) < 0.95 * all)
            low = middle;
        else
            high = middle;
    }
    return sqrt(n) * tan(low);
}

/* Eigenvalues of a symmetric matrix, and its eigenvectors as columns of v, by Jacobi's rotations.
 */
static void eigen(int n, double a[P][P], double v[P][P]) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) v[i][j] = i == j;
    for (int sweep = 0; sweep < 30; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                if (fabs(a[p][q]) <= 1e-17 * sqrt(fabs(a[p][p] * a[q][q]))) continue;
                double angle = 0.5 * atan2(2 * a[p][q], a[q][q] - a[p][p]);
                double c = cos(angle), s = sin(angle);
                for (int k = 0; k < n; k++) {
                    double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (int k = 0; k < n; k++) {
                    double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                    x = v[k][p], y = v[k][q];
                    v[k][p] = c * x - s * y;
                    v[k][q] = s * x + c * y;
                }
            }
}

/* s: the root of what is left for each degree of freedom, not less than runs are exact. NAN: there
 * is none. */
static double deviation_of(const lar_inverse_solver *s, double squares, int parameters) {
    const lar_inverse_problem *p = s->problem;
    int freedom = s->values - parameters;
    double exact = 0;
    for (int k = 0; k < p->experiments; k++) {
        const lar_inverse_experiment *e = &p->experiment[k];
        exact += e->values * pow(EXACT * e->largest / e->noise, 2);
    }
    if (freedom <= 0) return NAN;
    return sqrt(fmax(squares / freedom, exact / s->values));
}

/* ---- the linear picture ---------------------------------------------------------------------- */

/* A direction that the data hardly see: which parameters share it. */
static void note_direction(const lar_inverse_problem *p, double v[P][P], int d, double width,
                           lar_inverse_result *result) {
    static const double SHARE = 0.3;
    char names[200] = "";
    size_t used = 0;
    int count = 0;
    for (int j = 0; j < p->parameters; j++) {
        if (fabs(v[j][d]) < SHARE || used >= sizeof names) continue;
        int wrote = snprintf(names + used, sizeof names - used, "%s%s of %s", count ? ", " : "",
                             p->parameter[j].name, p->parameter[j].material);
        used += wrote > 0 ? (size_t)wrote : 0;
        count++;
    }
    if (count > 1)
        lar_inverse_note(
            result,
            "these data cannot tell apart: %s; they can change together by a factor of "
            "%.3g and more unseen",
            names, exp(fmin(width, 20)));
}

static bool near_bound(const lar_inverse_parameter *p, double u, bool high) {
    double from = lar_inverse_u_low(p), to = lar_inverse_u_high(p);
    return (high ? to - u : u - from) <= AT_BOUND * (to - from);
}

static void note_held_back(const lar_inverse_problem *problem, const lar_inverse_parameter *p,
                           bool high, lar_inverse_result *result) {
    const double bound = high ? p->high : p->low;
    char others[160] = "";
    if (problem->parameters > 1)
        snprintf(others, sizeof others,
                 ", and the intervals of the others hold for a known %s of %.4g", p->name, bound);
    lar_inverse_note(result,
                     "%s of %s stands at its bound %.4g, and the data ask for a %s value; widen "
                     "that bound, or look whether a unit is wrong: until then no "
                     "other parameter of this fit can be relied on%s",
                     p->name, p->material, bound, high ? "larger" : "smaller", others);
}

/* Estimates that stand at a bound while the data ask for a value beyond it: the squares would be
 * least farther out than chance explains, by the step of Gauss and Newton without bounds. The
 * deviation is that of a fit which takes this step: what is left at the bound says what the bound
 * costs, not how well the data tell. Without a degree of freedom chance explains nothing, and a
 * step as long as that of a difference counts. inverse: covariances for a deviation of 1; slope:
 * half of that of the squares. */
static void find_held_back(const lar_inverse_solver *s, double inverse[P][P], const double *slope,
                           lar_inverse_result *result) {
    static const double SURE = 0.02;
    int n = s->parameters, m = s->values;
    double step[P] = {0}, squares = s->best_squares;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) step[i] -= inverse[i][j] * slope[j];
        squares += step[i] * slope[i];
    }
    double t = m > n ? lar_student_95(m - n) : NAN, deviation = deviation_of(s, squares, n);
    for (int i = 0; i < n; i++) {
        const lar_inverse_parameter *p = &s->problem->parameter[i];
        double half = m > n ? t * deviation * sqrt(inverse[i][i]) : SURE;
        bool high = step[i] > 0;
        if (!near_bound(p, s->best_u[i], high) || half >= WIDE || fabs(step[i]) <= half) continue;
        result->estimate[i].at_bound = true;
        result->estimate[i].low = result->estimate[i].high = NAN;
        note_held_back(s->problem, p, high, result);
    }
}

/* a becomes its eigenvalues, v its directions, inverse what it says. */
static void invert(int n, double a[P][P], double v[P][P], double inverse[P][P]) {
    static const double UNSEEN = 1e-12; /* of the largest eigenvalue: rounding */
    double largest = 0;
    eigen(n, a, v);
    for (int d = 0; d < n; d++) largest = fmax(largest, a[d][d]);
    memset(inverse, 0, P * sizeof *inverse);
    for (int d = 0; d < n; d++) {
        a[d][d] = fmax(a[d][d], UNSEEN * largest + 1e-300);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) inverse[i][j] += v[i][d] * v[j][d] / a[d][d];
    }
}

/* u +- half; NAN: there is no interval. */
static void set_interval(const lar_inverse_parameter *p, double u, double half,
                         lar_inverse_estimate *e) {
    double range = lar_inverse_u_high(p) - lar_inverse_u_low(p);
    e->low = isnan(half) ? NAN : lar_inverse_value(p, u - half);
    e->high = isnan(half) ? NAN : lar_inverse_value(p, u + half);
    e->told =
        half < fmin(WIDE, 0.25 * range) && !near_bound(p, u, false) && !near_bound(p, u, true);
}

/* Where estimates stand at their bounds the others were fitted with these bounds as known numbers,
 * and so are their intervals. normal: J^T J. */
static void give_bounds(const lar_inverse_solver *s, double normal[P][P],
                        lar_inverse_result *result) {
    double a[P][P], v[P][P], inverse[P][P];
    int own[P], n = 0;
    for (int j = 0; j < s->parameters; j++)
        if (!result->estimate[j].at_bound) own[n++] = j;
    if (n == 0 || n == s->parameters) return;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) a[i][j] = normal[own[i]][own[j]];
    invert(n, a, v, inverse);
    double width = lar_student_95(s->values - n) * deviation_of(s, s->best_squares, n);
    for (int i = 0; i < n; i++) {
        lar_inverse_estimate *e = &result->estimate[own[i]];
        set_interval(&s->problem->parameter[own[i]], s->best_u[own[i]], width * sqrt(inverse[i][i]),
                     e);
        e->given_bound = true;
    }
}

/* How far an estimate would go, in u, with other slopes: no chance, so it is added. */
static double moved_by(int n, const double *inverse, const double *turn) {
    double sum = 0;
    for (int j = 0; j < n; j++) sum += inverse[j] * turn[j];
    return fabs(sum);
}

static bool is_inside(const lar_inverse_parameter *p, double u) {
    return !near_bound(p, u, false) && !near_bound(p, u, true);
}

/* A search that ended where the slopes ask for another value than any of its interval. */
static void note_uneven(lar_inverse_result *result) {
    if (result->converged)
        lar_inverse_note(result, "the search ended where the squares are not least: forces of runs "
                                 "are less even than they have to be for it; begin again from "
                                 "another guess, with slower loads or a smaller time_step in the "
                                 "scenes");
    result->converged = false;
}

/* Covariances, intervals, correlations and the directions that are not seen. r: what is left;
 * change: of it, with half the time step. */
static void linearise(const lar_inverse_solver *s, const double *r, const double *change,
                      const double *jacobian, lar_inverse_result *result) {
    const lar_inverse_problem *p = s->problem;
    int n = s->parameters, m = s->values;
    double a[P][P], normal[P][P], v[P][P], inverse[P][P], slope[P] = {0}, turn[P] = {0};
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            a[i][j] = 0;
            for (int k = 0; k < m; k++) a[i][j] += jacobian[i * m + k] * jacobian[j * m + k];
            normal[i][j] = a[i][j];
        }
        for (int k = 0; k < m; k++) slope[i] += jacobian[i * m + k] * r[k];
        for (int k = 0; k < m; k++) turn[i] += jacobian[i * m + k] * change[k];
    }
    invert(n, a, v, inverse);
    double width = m > n ? lar_student_95(m - n) * result->deviation : NAN;
    bool uneven = false;
    for (int i = 0; i < n; i++) {
        lar_inverse_estimate *e = &result->estimate[i];
        e->sensitivity = sqrt(normal[i][i]);
        /* At half the step as much is left again, where errors go with the step itself. */
        double half = width * sqrt(inverse[i][i]) + 2 * moved_by(n, inverse[i], turn);
        uneven |=
            moved_by(n, inverse[i], slope) > half && is_inside(&p->parameter[i], s->best_u[i]);
        set_interval(&p->parameter[i], s->best_u[i], half, e);
        for (int j = 0; j < n; j++) {
            double tied = inverse[i][j] / sqrt(inverse[i][i] * inverse[j][j]);
            result->correlation[i][j] = i == j ? 1 : m > n ? tied : NAN;
        }
    }
    find_held_back(s, inverse, slope, result);
    if (uneven && !lar_inverse_at_bound(result)) note_uneven(result);
    give_bounds(s, normal, result);
    for (int d = 0; d < n && m > n && !lar_inverse_at_bound(result); d++)
        if (width / sqrt(a[d][d]) > WIDE) note_direction(p, v, d, width / sqrt(a[d][d]), result);
}

/* ---- what cannot be told --------------------------------------------------------------------- */

static void note_open(const lar_inverse_parameter *p, const lar_inverse_estimate *e, bool low,
                      bool high, lar_inverse_result *result) {
    if (low && high)
        lar_inverse_note(
            result,
            "%s of %s cannot be told from these data: everything between its bounds, %.4g "
            "to %.4g, fits as well; measure something else that depends on it, or fix it",
            p->name, p->material, p->low, p->high);
    else if (high)
        lar_inverse_note(result,
                         "%s of %s cannot be told from these data: everything from %.4g up to its "
                         "bound %.4g fits as well; widen that bound",
                         p->name, p->material, e->low, p->high);
    else if (low)
        lar_inverse_note(
            result,
            "%s of %s cannot be told from these data: everything from its bound %.4g up "
            "to %.4g fits as well; widen that bound",
            p->name, p->material, p->low, e->high);
}

/* Parameters whose interval is wide or ends at a bound. While one is held back by its bound the
 * squares are large wherever the others are, and a profile would say that everything fits. */
static lar_status profile_suspects(const lar_inverse_solver *s, lar_inverse_result *result) {
    const lar_inverse_problem *p = s->problem;
    int freedom = s->values - s->parameters;
    if (freedom <= 0) return LAR_OK;
    double grown = lar_student_95(freedom) * result->deviation;
    lar_status status = LAR_OK;
    if (lar_inverse_at_bound(result)) return LAR_OK;
    for (int j = 0; j < s->parameters && !status && !lar_inverse_stopped(s); j++) {
        lar_inverse_estimate *e = &result->estimate[j];
        bool low, high;
        if (e->told) continue;
        status =
            lar_inverse_profile(s, j, grown * grown, &e->low, &e->high, &low, &high, &result->runs);
        if (status) break;
        e->profiled = true;
        e->told = !low && !high;
        note_open(&p->parameter[j], e, low, high, result);
    }
    return status;
}

/* ---- the guess ------------------------------------------------------------------------------- */

/* By how much all that the model answers would have to grow to fit, least squares. */
static double ratio_of(const lar_inverse_experiment *e, const double *model) {
    double up = 0, down = 0;
    for (int32_t i = 0; i < e->values; i++) {
        up += model[i] * e->measured[i];
        down += model[i] * model[i];
    }
    return down > 0 ? up / down : 1;
}

static lar_status complain_profile(const lar_inverse_problem *p, const lar_inverse_experiment *e,
                                   double ratio, lar_error *error) {
    if (ratio < 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s:%d: the heights of %s have the opposite sign of the model's; z grows "
                        "out of the tissue, along the axis: turn axis, or say scale: {z: -1}",
                        p->path, e->line, e->data);
    return lar_fail(
        error, LAR_ERROR_MODEL,
        "%s:%d: the heights of %s are %.2g times those of the model at the guess; is a "
        "unit wrong (kPa or mbar instead of Pa: scale: {pressure: 1000}, mm: scale: {z: "
        "0.001}), or the guess? Give a nearer one",
        p->path, e->line, e->data, ratio);
}

/* Forces were measured, and the model has none in any row. */
static lar_status complain_touch(const lar_inverse_problem *p, const lar_inverse_experiment *e,
                                 lar_error *error) {
    if (e->tool < 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s:%d: the model of %s has no force in any row; look with lariat run what "
                        "the scene does",
                        p->path, e->line, e->scene);
    double deepest = 0;
    for (int32_t i = 0; i < e->rows; i++) deepest = fmax(deepest, e->along[i]);
    return lar_fail(
        error, LAR_ERROR_MODEL,
        "%s:%d: the tool %s touches nothing in any row of %s, and forces were measured; "
        "%s",
        p->path, e->line, e->model->tool[e->tool].name, e->data,
        deepest > 0 ? "give the direction into the tissue (direction: [x, y, z]), and "
                      "let it begin just above it: depth counts from its place in the "
                      "scene"
                    : "depth is positive into the tissue: say scale: {depth: -1}");
}

/* Whether there is any model's number but 0. */
static bool answers(const lar_inverse_experiment *e, const double *model) {
    for (int32_t i = 0; i < e->values; i++)
        if (model[i] != 0) return true;
    return false;
}

/* Forces that are far from those of the guess are of another unit, or of another sign. */
static lar_status check_units(const lar_inverse_solver *s, lar_error *error) {
    static const double FAR = 300;
    const lar_inverse_problem *p = s->problem;
    const double *model = s->best_model;
    for (int k = 0; k < p->experiments; model += p->experiment[k++].values) {
        const lar_inverse_experiment *e = &p->experiment[k];
        if (e->kind > LAR_INVERSE_ASPIRATION) continue;
        if (!answers(e, model)) return complain_touch(p, e, error);
        double ratio = ratio_of(e, model);
        if (e->kind == LAR_INVERSE_ASPIRATION && !(ratio >= 1 / FAR && ratio <= FAR))
            return complain_profile(p, e, ratio, error);
        if (ratio < 0)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s:%d: the forces of %s have the opposite sign of the model's; force "
                            "and way are positive in the direction in which the scene moves the "
                            "support or the tool goes in, beside a stretch where tension pulls or "
                            "compression presses: say scale: {force: -1}",
                            p->path, e->line, e->data);
        if (ratio > FAR || ratio < 1 / FAR)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s:%d: the forces of %s are %.2g times those of the model at the "
                            "guess; is a unit wrong (mN or kPa instead of N and Pa: scale: {force: "
                            "0.001}), or the guess? Give a nearer one",
                            p->path, e->line, e->data, ratio);
    }
    return LAR_OK;
}

static lar_status try_guess(lar_inverse_solver *s, lar_error *error) {
    double *r = lar_calloc((size_t)s->values, sizeof *r);
    if (!r) return lar_fail_memory(error, (size_t)s->values, s->problem->path);
    lar_status status = lar_inverse_begin(s, s->start, r);
    free(r);
    if (status == LAR_ERROR_UNSTABLE || status == LAR_ERROR_MODEL) {
        lar_error why = *error;
        return lar_fail(error, status,
                        "%s: no answer with the first guess: %.600s; give another guess, or look "
                        "with lariat run what the scene does",
                        s->problem->path, why.message);
    }
    return status ? status : check_units(s, error);
}

/* ---- the fit --------------------------------------------------------------------------------- */

/* How exact runs in time are, by what half the step changes; and where it was too long. */
static void note_steps(const lar_inverse_solver *s, const double *change,
                       lar_inverse_result *result) {
    static const double OPEN = 1e-3;
    for (int k = 0; k < s->problem->experiments; k++) {
        const lar_inverse_experiment *e = &s->problem->experiment[k];
        double *exact = &result->exact[k];
        for (int32_t i = 0; i < e->values; i++)
            *exact = fmax(*exact, fabs(*change++) * (e->error ? e->error[i] : e->noise));
        if (s->pace[k].open > OPEN)
            lar_inverse_note(result,
                             "%s: steps are too long for how fast things are here (the account of "
                             "energy is open by %.2g %%), and forces are noisy: give a smaller "
                             "time_step in %s",
                             e->name, 100 * s->pace[k].open, e->scene);
    }
}

static lar_status know(lar_inverse_solver *s, lar_inverse_result *result) {
    size_t values = (size_t)s->values;
    double *r = lar_calloc(values, sizeof *r);
    double *change = lar_calloc(values, sizeof *change);
    double *jacobian = lar_calloc((size_t)s->parameters * values, sizeof *jacobian);
    double u[P]; /* the best moves along in an evaluation */
    memcpy(u, s->best_u, sizeof u);
    s->doing = "looking how well the data tell";
    s->paces_fixed = true; /* these differences are of the same steps as what was found */
    lar_status status = r && change && jacobian ? lar_inverse_evaluate(s, u, r)
                                                : lar_fail_memory(s->error, values, "a fit");
    if (!status) status = lar_inverse_differentiate(s, u, r, jacobian);
    if (!status) {
        result->deviation = deviation_of(s, s->best_squares, s->parameters);
        lar_inverse_halve_steps(s, u, r, change);
        note_steps(s, change, result);
        linearise(s, r, change, jacobian, result);
        status = profile_suspects(s, result);
    }
    free(r);
    free(change);
    free(jacobian);
    return status;
}

static lar_status take(const lar_inverse_solver *s, lar_inverse_result *result) {
    result->model = lar_calloc((size_t)s->values, sizeof *result->model);
    if (!result->model) return lar_fail_memory(s->error, (size_t)s->values, s->problem->path);
    memcpy(result->model, s->best_model, (size_t)s->values * sizeof *result->model);
    for (int j = 0; j < s->parameters; j++)
        result->estimate[j] = (lar_inverse_estimate){
            .value = lar_inverse_value(&s->problem->parameter[j], s->best_u[j]),
            .low = NAN,
            .high = NAN};
    return LAR_OK;
}

/* Where it was stopped; nothing else is to be made of what the model answers there. */
static void note_interrupted(const lar_inverse_solver *s, lar_inverse_result *result) {
    const bool guess = memcmp(s->best_u, s->start, (size_t)s->parameters * sizeof *s->start) == 0;
    if (result->converged)
        lar_inverse_note(result,
                         "interrupted after the values were found and before the intervals: "
                         "fit again for those");
    else if (guess)
        lar_inverse_note(result, "interrupted before anything better than the guess was found: the "
                                 "values are the guess, and say nothing about the tissue");
    else
        lar_inverse_note(result, "interrupted: the values are where the fit was stopped, without "
                                 "intervals and without a word on the law; fit on from there");
}

lar_status lar_inverse_solve(const lar_inverse_problem *problem, const lar_inverse_options *options,
                             lar_inverse_result *result, lar_error *error) {
    lar_inverse_solver s;
    lar_error unused;
    if (!error) error = &unused;
    *result = (lar_inverse_result){.parameters = problem->parameters, .deviation = NAN};
    lar_status status = lar_inverse_solver_create(problem, options, &s, error);
    result->values = s.values;
    if (!status && lar_inverse_available()) status = try_guess(&s, error);
    if (!status) status = lar_inverse_minimise(&s, &result->converged);
    if (!status) status = take(&s, result);
    if (!status && !lar_inverse_stopped(&s)) {
        if (!result->converged)
            lar_inverse_note(result,
                             "the squares were still falling when the evaluations were used "
                             "up; begin again from here, or free fewer parameters");
        status = know(&s, result);
    }
    result->interrupted = lar_inverse_stopped(&s);
    if (result->interrupted && result->model) status = LAR_OK;
    if (!status && result->interrupted) note_interrupted(&s, result);
    if (!status) lar_inverse_look_at_residuals(problem, result);
    if (!status && isnan(result->deviation) && !result->interrupted &&
        !lar_inverse_at_bound(result))
        lar_inverse_note(
            result,
            "as many parameters as measured numbers, %d: the model can go through all "
            "of them, wrong ones too, so there is no interval, and no word on the law; "
            "measure more, or free fewer parameters",
            s.parameters);
    result->runs += s.runs;
    result->seconds = lar_clock_seconds() - s.begin;
    lar_inverse_solver_clear(&s);
    return status;
}
