/* What the precision study computes (precision.h): blocks of its own, or somebody's model. */
#ifndef LAR_STUDY_PRECISION_PRECISION_CASES_H
#define LAR_STUDY_PRECISION_PRECISION_CASES_H

#include "simulation/simulation.h"

typedef enum lar_precision_case {
    LAR_CASE_VIBRATION, /* a clamped block swings, without damping */
    LAR_CASE_REST,      /* it sags under gravity, and hangs still */
    LAR_CASE_PATH,      /* gravity comes and goes: back to zero? */
    LAR_CASE_TURN,      /* a free block turns and drifts away, without damping */
    LAR_CASE_CREEP,     /* overdamped sagging: slower and slower */
    LAR_CASE_FAR,       /* the same, a metre from where the mesh was */
    LAR_CASE_MODEL,     /* somebody's model */
    LAR_CASE_COUNT
} lar_precision_case;

extern const char *const lar_precision_case_names[LAR_CASE_COUNT];

/* The block of a case, which the caller destroys; `duration`: what its load path is made for. */
lar_status lar_precision_block(lar_precision_case what, int32_t elements, double duration,
                               lar_model **model, lar_error *error);

/* Puts its displacements and velocities at the start into a simulation of it. */
void lar_precision_start(lar_precision_case what, lar_simulation *simulation);

/* What every node of the case is displaced by, along each axis, apart from its motion [m]. */
double lar_precision_offset(lar_precision_case what);

#endif
