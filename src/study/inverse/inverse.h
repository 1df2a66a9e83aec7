/* `lariat fit`: parameters of tissue from experiments, and what is known of them.
 *
 *     experiment.h  the file    solver.h  least squares    profile.h  what cannot be told
 *     forward.h     one run     result.h  the answer       output.h   tissue files, pictures
 *
 * Around the least squares the model is taken as linear in u (study/inverse/parameters.h): with the
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
 * Runs in time are run once more with half the step where the squares are least. How far that would
 * move a parameter, (J^T J)^-1 J^T (r_half - r), is added to both sides of its interval, and what
 * it changes in a measured number is neither a slip nor a sign of another law.
 *
 * Data without noise would give intervals of no width. Runs are exact to about 1e-4 of the largest
 * measured number at most, so s is never less than that.
 */
#ifndef LAR_STUDY_INVERSE_INVERSE_H
#define LAR_STUDY_INVERSE_INVERSE_H

#include "study/inverse/result.h"
#include "study/inverse/solver.h"

/* Fits. The caller clears the result in any case. */
lar_status lar_inverse_solve(const lar_inverse_problem *problem, const lar_inverse_options *options,
                             lar_inverse_result *result, lar_error *error);

/* Of |T| below it is the share of 95 %, with so many degrees of freedom. */
double lar_student_95(int freedom);

#endif
