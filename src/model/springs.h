/* Springs between nodes and where these are at rest (lar_spring_bed): what they ask of steps.
 */
#ifndef LAR_MODEL_SPRINGS_H
#define LAR_MODEL_SPRINGS_H

#include "model/model.h"

/* What the model's springs add to the square of an element's frequency at most [1/s^2]: with each
 * node's spring divided among its elements like its mass, no eigenvalue of an element and its part
 * is above the sum. By node, free it; NULL where there are none. */
lar_status lar_spring_squares(const lar_model *model, double **squares, lar_error *error);
double lar_spring_square(const lar_model *model, const double *squares, lar_gid e);

#endif
