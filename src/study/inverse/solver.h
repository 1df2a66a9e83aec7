/* Least squares over simulations: MINPACK's lmder by cminpack, derivatives by central differences
 * of runs that go on all cores at once.
 *
 *     x --parameters.h--> u --> values --forward.h--> model --> r = (model - measured) / noise
 *
 * The step of a difference is 0.02 in u, two per cent of a modulus. A run at rest is exact to
 * about eps = 1e-5, which a central difference of step h turns into eps / h, and it cuts off
 * h^2 / 6: the sum is least at h = (3 eps)^(1/3) = 0.03 and flat around it (Dennis and Schnabel,
 * Numerical Methods for Unconstrained Optimization, 1983, section 5.4), so derivatives are right to
 * about a thousandth. Runs are deterministic: nothing but rest and rounding is between two of them.
 * Runs in time are exact to some 1e-4: what a kink has set swinging is read at another phase in
 * each. Their differences have a step of 0.06. Levenberg-Marquardt: More, Lecture Notes in
 * Mathematics 630:105, 1978.
 *
 * Runs in time keep their time step while a search goes on. The automatic one follows the moduli,
 * and with it the moments at which forces are read and the phase of what swings: the squares get
 * rough. So a search begins with a little less than the automatic step of its first point; where
 * that becomes too long for the point that it has come to, or half as long as could be, it begins
 * again from there with that point's step. A run in between that needs a shorter one takes the
 * half. Steps that are too long for how a body is strained make forces noisy long before anything
 * breaks, and a search among noise ends where it began. The account of energy tells (theory.md,
 * chapter 7): closed to a millionth or better where steps are short enough, open by thousandths
 * where they are not. Then all steps of the experiment become half as long, and the search begins
 * again.
 */
#ifndef LAR_STUDY_INVERSE_SOLVER_H
#define LAR_STUDY_INVERSE_SOLVER_H

#include <signal.h>

#include "study/inverse/forward.h"

typedef struct lar_inverse_progress {
    const char *doing; /* "fitting", "looking how far ..." */
    int runs;          /* simulations so far */
    double residual;   /* root mean square, in units of the noise; the best so far */
    double remaining;  /* a guess [s]; below 0: not known yet */
} lar_inverse_progress;

typedef struct lar_inverse_options {
    const volatile sig_atomic_t *stop; /* not 0: end with the best so far; may be NULL */
    void (*progress)(void *context, const lar_inverse_progress *progress); /* may be NULL */
    void *context;
    int workers; /* runs at a time, at most; 0: one on each core */
} lar_inverse_options;

typedef struct lar_inverse_solver {
    const lar_inverse_problem *problem;
    lar_inverse_options options;
    int values, parameters;
    int runs, rounds;    /* simulations; evaluations with derivatives */
    int before;          /* simulations of the same fit by others, for who is told */
    double begin, round; /* clock at the start [s]; seconds of the last round */
    const char *doing;
    double *best_model; /* [values] */
    double best_u[LAR_INVERSE_PARAMETERS_MAX];
    double best_squares;                                /* of residuals; INFINITY: none yet */
    lar_inverse_pace pace[LAR_INVERSE_EXPERIMENTS_MAX]; /* that runs in time keep; open: at best */
    bool paces_fixed;                                   /* whatever point the search comes to */
    bool begin_anew; /* steps do not suit any more: what was computed last does not count */
    bool fixed[LAR_INVERSE_PARAMETERS_MAX];   /* stay at their u of the start */
    double start[LAR_INVERSE_PARAMETERS_MAX]; /* u */
    lar_error *error;
    lar_status status; /* what ended it */
} lar_inverse_solver;

/* Whether this program has cminpack. */
bool lar_inverse_available(void);

/* A solver at the first guess; NULL memory is an error. Cleared in any case. */
lar_status lar_inverse_solver_create(const lar_inverse_problem *problem,
                                     const lar_inverse_options *options, lar_inverse_solver *solver,
                                     lar_error *error);
void lar_inverse_solver_clear(lar_inverse_solver *solver);

/* Residuals at u, into r[values]; LAR_ERROR_UNSTABLE and LAR_ERROR_MODEL say that there is no
 * answer with these parameters. The best is kept. */
lar_status lar_inverse_evaluate(lar_inverse_solver *solver, const double *u, double *r);
/* Into change[values]: what residuals at u become in steps half as long; 0 where none are kept, or
 * where there is no answer. Nothing becomes the best. */
void lar_inverse_halve_steps(lar_inverse_solver *solver, const double *u, const double *r,
                             double *change);
/* dr/du into jacobian[parameters][values], of parameters that are not fixed; r: those at u. */
lar_status lar_inverse_differentiate(lar_inverse_solver *solver, const double *u, const double *r,
                                     double *jacobian);
/* Residuals at u, which becomes the best in any case, with steps that suit it. */
lar_status lar_inverse_begin(lar_inverse_solver *solver, const double *u, double *r);
/* From solver->start to the least squares; where it ends stands in best_*. *converged: whether
 * the squares are as small as they get. An interrupted fit is LAR_OK. */
lar_status lar_inverse_minimise(lar_inverse_solver *solver, bool *converged);
/* Whether it was asked to stop. */
bool lar_inverse_stopped(const lar_inverse_solver *solver);

#endif
