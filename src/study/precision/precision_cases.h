/* The blocks of the precision study (precision.h). */
#ifndef LAR_STUDY_PRECISION_PRECISION_CASES_H
#define LAR_STUDY_PRECISION_PRECISION_CASES_H

#include "simulation/simulation.h"
#include "study/precision/precision.h"

/* The block of a case, which the caller destroys; `duration`: what its load path is made for. */
lar_status lar_precision_block(lar_precision_case what, int32_t elements, double duration,
                               lar_model **model, lar_error *error);

/* Puts its displacements and velocities at the start into a simulation of it. */
void lar_precision_start(lar_precision_case what, lar_simulation *simulation);

/* What every node of the case is displaced by, along each axis, apart from its motion [m]. */
double lar_precision_offset(lar_precision_case what);

#endif
