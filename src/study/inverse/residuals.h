/* What the residuals say of the law: whether they are chance.
 *
 * Two tests in the order of the rows: as many changes of sign as chance makes (Wald and Wolfowitz,
 * Annals of Mathematical Statistics 11:147, 1940), and no correlation of neighbours beyond
 * 2 / sqrt(n). Of points in space, which have no order, those that are nearest to each other are
 * compared. A law that fails has another shape than the tissue; where it is too soft or too
 * stiff is said in a note.
 */
#ifndef LAR_STUDY_INVERSE_RESIDUALS_H
#define LAR_STUDY_INVERSE_RESIDUALS_H

#include "study/inverse/result.h"

/* Fills result->residuals from result->model, and adds notes. */
void lar_inverse_look_at_residuals(const lar_inverse_problem *problem, lar_inverse_result *result);

#endif
