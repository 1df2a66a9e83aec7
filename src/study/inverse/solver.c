#include "study/inverse/solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "study/inverse/forward.h"
#include "study/inverse/parameters.h"

#ifdef LAR_HAVE_CMINPACK
#include <cminpack.h>
#endif

static const double STEP = 0.02, STEP_IN_TIME = 0.06; /* of differences, in u */

/* ---- runs, many at a time -------------------------------------------------------------------- */

typedef struct job {
    const lar_inverse_problem *problem;
    const volatile sig_atomic_t *stop;
    double value[LAR_INVERSE_PARAMETERS_MAX];
    int experiment;
    lar_inverse_pace pace;
    double *model;
    lar_status status;
    lar_error error;
} job;

static void do_jobs(void *context, int32_t first, int32_t end) {
    job *jobs = context;
    for (int32_t i = first; i < end; i++)
        jobs[i].status =
            lar_inverse_forward(jobs[i].problem, jobs[i].experiment, jobs[i].value, &jobs[i].pace,
                                jobs[i].stop, jobs[i].model, &jobs[i].error);
}

/* Threads take portions, so fewer portions are fewer threads. */
static void do_all(const lar_inverse_solver *s, job *jobs, int count) {
    const int workers = s->options.workers;
    int portion = workers > 0 ? (count + workers - 1) / workers : 1;
    lar_parallel_for(count, portion > 1 ? portion : 1, do_jobs, jobs);
}

static void set_jobs(const lar_inverse_solver *s, const double *u, job *jobs, double *model) {
    const lar_inverse_problem *p = s->problem;
    for (int k = 0; k < p->experiments; k++) {
        jobs[k] = (job){.problem = p,
                        .stop = s->options.stop,
                        .experiment = k,
                        .pace = s->pace[k],
                        .model = model};
        for (int j = 0; j < p->parameters; j++)
            jobs[k].value[j] = lar_inverse_value(&p->parameter[j], u[j]);
        model += p->experiment[k].values;
    }
}

/* ---- time steps ------------------------------------------------------------------------------ */

static lar_status own_steps(const lar_inverse_solver *s, const double *u, double *step) {
    double value[LAR_INVERSE_PARAMETERS_MAX];
    lar_status status = LAR_OK;
    for (int j = 0; j < s->parameters; j++)
        value[j] = lar_inverse_value(&s->problem->parameter[j], u[j]);
    for (int k = 0; k < s->problem->experiments && !status; k++)
        status = lar_inverse_own_step(s->problem, k, value, &step[k], s->error);
    return status;
}

/* At most `step`, such that rows and the kinks of what is driven stand at the end of steps, where
 * all times have a common part: forces that are read half a step too late or too soon are off. */
static double step_on_rows(const lar_inverse_experiment *e, double step) {
    static const double ROUNDING = 1e-6; /* of the last time */
    static const double MANY = 4;        /* steps in a part: then they get little shorter */
    double part = 0, same = e->time && e->rows > 0 ? ROUNDING * fabs(e->time[e->rows - 1]) : 0;
    for (int32_t i = 0; i < e->rows && same > 0; i++)
        for (double a = e->time[i], rest; a > same; a = rest) { /* Euclid */
            rest = part > 0 ? fmod(part, a) : 0;
            if (a - rest <= same) rest = 0;
            part = a;
        }
    return part > MANY * step ? part / ceil(part / step * (1 - 1e-12)) : step;
}

static lar_status choose_steps(lar_inverse_solver *s, const double *u) {
    static const double LESS = 0.9;
    double own[LAR_INVERSE_EXPERIMENTS_MAX];
    lar_status status = own_steps(s, u, own);
    for (int k = 0; k < s->problem->experiments && !status; k++)
        s->pace[k].step = step_on_rows(&s->problem->experiment[k], LESS * s->pace[k].part * own[k]);
    return status;
}

/* Experiments whose account of energy was open go in shorter steps from now on. */
static void judge_steps(lar_inverse_solver *s, const job *jobs, int count) {
    static const double OPEN = 1e-4, LEAST = 1.0 / 32;
    bool open[LAR_INVERSE_EXPERIMENTS_MAX] = {false};
    for (int i = 0; i < count; i++)
        open[jobs[i].experiment] |= !jobs[i].status && jobs[i].pace.open > OPEN;
    for (int k = 0; k < s->problem->experiments && !s->paces_fixed; k++) {
        if (!open[k] || s->pace[k].step == 0 || s->pace[k].part <= LEAST) continue;
        s->pace[k].part *= 0.5;
        s->begin_anew = true;
    }
}

/* The first failure of one set of experiments. */
static lar_status outcome(const lar_inverse_solver *s, const job *jobs) {
    for (int k = 0; k < s->problem->experiments; k++)
        if (jobs[k].status) {
            if (s->error) *s->error = jobs[k].error;
            return jobs[k].status;
        }
    return LAR_OK;
}

static void residuals(const lar_inverse_problem *p, const double *model, double *r) {
    for (int k = 0; k < p->experiments; k++) {
        const lar_inverse_experiment *e = &p->experiment[k];
        for (int32_t i = 0; i < e->values; i++)
            *r++ = (*model++ - e->measured[i]) / (e->error ? e->error[i] : e->noise);
    }
}

static bool no_answer(lar_status status) {
    return status == LAR_ERROR_UNSTABLE || status == LAR_ERROR_MODEL;
}

bool lar_inverse_stopped(const lar_inverse_solver *s) {
    return lar_inverse_stop_asked(s->options.stop);
}

static void tell(const lar_inverse_solver *s) {
    enum { ROUNDS = 6 }; /* that most fits take */
    if (!s->options.progress) return;
    int left = ROUNDS - s->rounds;
    const lar_inverse_progress progress = {
        .doing = s->doing,
        .runs = s->before + s->runs,
        .residual = sqrt(s->best_squares / s->values),
        .remaining = s->rounds > 0 ? s->round * (left > 1 ? left : 1) : -1};
    s->options.progress(s->options.context, &progress);
}

lar_status lar_inverse_evaluate(lar_inverse_solver *s, const double *u, double *r) {
    job jobs[LAR_INVERSE_EXPERIMENTS_MAX];
    if (isfinite(s->best_squares) && memcmp(u, s->best_u, (size_t)s->parameters * sizeof *u) == 0) {
        residuals(s->problem, s->best_model, r); /* the same bits again */
        return LAR_OK;
    }
    double *model = lar_calloc((size_t)s->values, sizeof *model), squares = 0;
    if (!model) return lar_fail_memory(s->error, (size_t)s->values, s->problem->path);
    set_jobs(s, u, jobs, model);
    do_all(s, jobs, s->problem->experiments);
    s->runs += s->problem->experiments;
    lar_status status = outcome(s, jobs);
    if (!status) residuals(s->problem, model, r);
    for (int i = 0; i < s->values && !status; i++) squares += r[i] * r[i];
    if (!status && !isfinite(squares))
        status = lar_fail(s->error, LAR_ERROR_UNSTABLE, "%s: forces that are no numbers",
                          s->problem->path);
    judge_steps(s, jobs, s->problem->experiments);
    if (!status && !s->begin_anew && squares < s->best_squares) {
        for (int k = 0; k < s->problem->experiments; k++) s->pace[k].open = jobs[k].pace.open;
        s->best_squares = squares;
        memcpy(s->best_u, u, (size_t)s->parameters * sizeof *u);
        memcpy(s->best_model, model, (size_t)s->values * sizeof *model);
    }
    free(model);
    tell(s);
    return status;
}

/* With other steps squares are a little other ones, so the best so far is no measure. */
lar_status lar_inverse_begin(lar_inverse_solver *s, const double *u, double *r) {
    const double squares = s->best_squares;
    lar_status status;
    do {
        s->begin_anew = false;
        s->best_squares = INFINITY;
        status = choose_steps(s, u);
        if (!status) status = lar_inverse_evaluate(s, u, r);
    } while (!status && s->begin_anew);
    if (status) s->best_squares = squares;
    return status;
}

void lar_inverse_halve_steps(lar_inverse_solver *s, const double *u, const double *r,
                             double *change) {
    const lar_inverse_problem *p = s->problem;
    job all[LAR_INVERSE_EXPERIMENTS_MAX], some[LAR_INVERSE_EXPERIMENTS_MAX];
    int count = 0;
    set_jobs(s, u, all, change);
    for (int k = 0; k < p->experiments; k++) {
        if (s->pace[k].step == 0) continue;
        all[k].pace.step *= 0.5;
        all[k].pace.part *= 0.5;
        some[count++] = all[k];
    }
    do_all(s, some, count);
    s->runs += count;
    residuals(p, change, change);
    for (int i = 0; i < s->values; i++) change[i] -= r[i];
    for (int k = 0, i = 0, next = 0; k < p->experiments; k++) {
        const bool ran = s->pace[k].step > 0 && !some[next++].status;
        for (int32_t j = 0; j < p->experiment[k].values; j++, i++)
            if (!ran) change[i] = 0;
    }
}

/* ---- differences ----------------------------------------------------------------------------- */

typedef struct difference {
    int parameter;
    double u[2];      /* below, above; within the bounds */
    double *model[2]; /* [values] */
    job *jobs[2];     /* [experiments] */
} difference;

/* Of one parameter. Where there is no answer on one side, the difference to the middle. */
static lar_status take_difference(lar_inverse_solver *s, const difference *d, double middle,
                                  const double *r, double *column) {
    double *side[2] = {d->model[0], d->model[1]}, at[2] = {d->u[0], d->u[1]};
    lar_status status[2];
    for (int i = 0; i < 2; i++) {
        status[i] = outcome(s, d->jobs[i]);
        if (status[i] && !no_answer(status[i])) return status[i];
        if (!status[i]) residuals(s->problem, side[i], side[i]);
        if (status[i]) at[i] = middle;
    }
    if (status[0] && status[1]) return status[0];
    for (int i = 0; i < s->values; i++) {
        double low = status[0] ? r[i] : side[0][i], high = status[1] ? r[i] : side[1][i];
        column[i] = (high - low) / (at[1] - at[0]);
    }
    return LAR_OK;
}

static void set_difference(const lar_inverse_solver *s, const double *u, difference *d, job *jobs,
                           double *model) {
    const lar_inverse_parameter *p = &s->problem->parameter[d->parameter];
    double moved[LAR_INVERSE_PARAMETERS_MAX];
    memcpy(moved, u, (size_t)s->parameters * sizeof *u);
    double step = STEP;
    for (int k = 0; k < s->problem->experiments; k++)
        if (s->problem->experiment[k].in_time) step = STEP_IN_TIME;
    d->u[0] = fmax(u[d->parameter] - step, lar_inverse_u_low(p));
    d->u[1] = fmin(u[d->parameter] + step, lar_inverse_u_high(p));
    for (int i = 0; i < 2; i++) {
        moved[d->parameter] = d->u[i];
        d->jobs[i] = jobs + i * s->problem->experiments;
        d->model[i] = model + (size_t)i * (size_t)s->values;
        set_jobs(s, moved, d->jobs[i], d->model[i]);
    }
}

lar_status lar_inverse_differentiate(lar_inverse_solver *s, const double *u, const double *r,
                                     double *jacobian) {
    difference d[LAR_INVERSE_PARAMETERS_MAX];
    int experiments = s->problem->experiments, count = 0;
    double begin = lar_clock_seconds();
    size_t of_one = 2 * (size_t)experiments, all = (size_t)s->parameters;
    job *jobs = lar_calloc(all * of_one, sizeof *jobs);
    double *model = lar_calloc(2 * all * (size_t)s->values, sizeof *model);
    lar_status status = jobs && model ? LAR_OK : lar_fail_memory(s->error, all, s->problem->path);
    for (int j = 0; j < s->parameters && !status; j++) {
        if (s->fixed[j]) continue;
        d[count].parameter = j;
        set_difference(s, u, &d[count], jobs + (size_t)count * of_one,
                       model + 2 * (size_t)count * (size_t)s->values);
        count++;
    }
    if (!status) {
        do_all(s, jobs, 2 * count * experiments);
        judge_steps(s, jobs, 2 * count * experiments);
    }
    for (int i = 0; i < count && !status; i++)
        status = take_difference(s, &d[i], u[d[i].parameter], r,
                                 jacobian + (size_t)d[i].parameter * (size_t)s->values);
    s->runs += 2 * count * experiments;
    s->rounds++;
    s->round = lar_clock_seconds() - begin;
    free(jobs);
    free(model);
    tell(s);
    return status;
}

/* ---- Levenberg-Marquardt --------------------------------------------------------------------- */

lar_status lar_inverse_solver_create(const lar_inverse_problem *problem,
                                     const lar_inverse_options *options, lar_inverse_solver *s,
                                     lar_error *error) {
    *s = (lar_inverse_solver){.problem = problem,
                              .values = lar_inverse_problem_values(problem),
                              .parameters = problem->parameters,
                              .begin = lar_clock_seconds(),
                              .best_squares = INFINITY,
                              .doing = "fitting",
                              .error = error};
    if (options) s->options = *options;
    for (int j = 0; j < s->parameters; j++)
        s->start[j] = lar_inverse_u(&problem->parameter[j], problem->parameter[j].guess);
    for (int k = 0; k < problem->experiments; k++) s->pace[k].part = 1;
    s->best_model = lar_calloc((size_t)s->values, sizeof *s->best_model);
    return s->best_model ? LAR_OK : lar_fail_memory(error, (size_t)s->values, problem->path);
}

void lar_inverse_solver_clear(lar_inverse_solver *s) {
    free(s->best_model);
    *s = (lar_inverse_solver){0};
}

#ifdef LAR_HAVE_CMINPACK
/* Whether the steps that are kept suit u: they leave room for differences, which move the automatic
 * step by half of theirs, and they are not half as long as could be. */
static bool steps_suit(const lar_inverse_solver *s, const double *u) {
    static const double ROOM = 1.04, SHORT = 2.2;
    double own[LAR_INVERSE_EXPERIMENTS_MAX];
    if (s->paces_fixed || own_steps(s, u, own)) return true;
    for (int k = 0; k < s->problem->experiments; k++) {
        const double most = s->pace[k].part * own[k], step = s->pace[k].step;
        if (most < ROOM * step || most > SHORT * step) return false;
    }
    return true;
}

bool lar_inverse_available(void) {
    return true;
}

/* x of the free parameters to u of all. */
static void place(const lar_inverse_solver *s, const double *x, double *u, double *slope) {
    for (int j = 0; j < s->parameters; j++) {
        u[j] = s->start[j];
        slope[j] = 0;
        if (!s->fixed[j]) u[j] = lar_inverse_u_of_x(&s->problem->parameter[j], *x++, &slope[j]);
    }
}

/* For lmder: residuals (iflag 1) or their derivatives by columns (2). Where there is no answer the
 * residuals are so large that a shorter step is tried. */
static int call(void *context, int values, int n, const double *x, double *r, double *jacobian,
                int rows, int iflag) {
    static const double FAR = 1e6;
    lar_inverse_solver *s = context;
    double u[LAR_INVERSE_PARAMETERS_MAX], slope[LAR_INVERSE_PARAMETERS_MAX];
    (void)n;
    if (lar_inverse_stopped(s)) return -1;
    place(s, x, u, slope);
    s->begin_anew = iflag == 2 && !steps_suit(s, u);
    if (s->begin_anew) return -1;
    if (iflag == 1) {
        s->status = lar_inverse_evaluate(s, u, r);
        bool far = no_answer(s->status) && isfinite(s->best_squares);
        for (int i = 0; far && i < values; i++) r[i] = FAR;
        if (far) s->status = LAR_OK;
        return s->status || s->begin_anew ? -1 : 0;
    }
    double *all = lar_calloc((size_t)s->parameters * (size_t)values, sizeof *all);
    s->status =
        all ? lar_inverse_differentiate(s, u, r, all) : lar_fail_memory(s->error, 1, "a fit");
    for (int j = 0, column = 0; j < s->parameters && !s->status; j++) {
        if (s->fixed[j]) continue;
        for (int i = 0; i < values; i++)
            jacobian[i + column * rows] = slope[j] * all[(size_t)j * (size_t)values + (size_t)i];
        column++;
    }
    free(all);
    return s->status || s->begin_anew ? -1 : 0;
}

/* One search from `from`, with steps that are kept. memory: (n + 2) values of room. */
static bool search(lar_inverse_solver *s, const double *from, double *memory, int *left) {
    enum { P = LAR_INVERSE_PARAMETERS_MAX };
    static const double SQUARES = 1e-7, CHANGE = 1e-5, FIRST = 0.25;
    double x[P], one[P], qtf[P], work[3][P];
    int pivot[P], n = 0, m = s->values, evaluations = 0, derivatives;
    s->begin_anew = false;
    for (int j = 0; j < s->parameters; j++)
        if (!s->fixed[j]) x[n++] = lar_inverse_x(&s->problem->parameter[j], from[j]);
    for (int j = 0; j < n; j++) one[j] = 1;
    if (n == 0) {
        s->status = lar_inverse_evaluate(s, s->start, memory);
        return !s->status;
    }
    int info =
        lmder(call, s, m, n, x, memory, memory + 2 * m, m, SQUARES, CHANGE, 0, *left, one, 2, FIRST,
              0, &evaluations, &derivatives, pivot, qtf, work[0], work[1], work[2], memory + m);
    *left -= evaluations;
    if (info >= 1 && info <= 4) s->begin_anew = !steps_suit(s, s->best_u);
    return info >= 1 && info <= 4;
}

lar_status lar_inverse_minimise(lar_inverse_solver *s, bool *converged) {
    int left = 60; /* evaluations */
    double from[LAR_INVERSE_PARAMETERS_MAX];
    double *memory = lar_calloc((size_t)s->values * (size_t)(s->parameters + 2), sizeof *memory);
    if (!memory) return lar_fail_memory(s->error, (size_t)s->values, s->problem->path);
    s->status = LAR_OK;
    memcpy(from, s->start, sizeof from);
    *converged = search(s, from, memory, &left);
    while (s->begin_anew && left > 0 && !s->status) {
        *converged = false;
        memcpy(from, s->best_u, sizeof from);
        s->status = lar_inverse_begin(s, from, memory);
        if (s->status) break;
        *converged = search(s, from, memory, &left);
    }
    free(memory);
    return lar_inverse_stopped(s) && isfinite(s->best_squares) ? LAR_OK : s->status;
}

#else

bool lar_inverse_available(void) {
    return false;
}

lar_status lar_inverse_minimise(lar_inverse_solver *s, bool *converged) {
    *converged = false;
    return lar_fail(s->error, LAR_ERROR_UNSUPPORTED,
                    "this program was built without cminpack, which fits need; apt-get install "
                    "libcminpack-dev, then make");
}

#endif
