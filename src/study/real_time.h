/* How fast a model runs on this machine, measured for a moment, and how many elements of the same
 * body would keep the clock.
 *
 * A mesh of N elements of a body has a time step that goes with their edge, N^(-1/3), and a step
 * costs as much as N: simulated time per time of the clock goes with N^(-4/3). So of a body that
 * runs at `factor` times real time with N elements, N (factor / wanted)^(3/4) keep the factor
 * `wanted`.
 */
#ifndef LAR_STUDY_REAL_TIME_H
#define LAR_STUDY_REAL_TIME_H

#include "lariat.h"

/* A third of the clock in reserve, for contact, strained elements and whoever looks on. */
#define LAR_REAL_TIME_RESERVE 1.5

typedef struct lar_real_time {
    double factor;    /* simulated time per time of the clock on one core; above 1 is faster */
    double step;      /* time of the clock for a step, the median [s] */
    double time_step; /* [s] */
    uint64_t steps;   /* measured */
    lar_grid_choice choice; /* the fastest division now, by the median of a step */
    double divided;         /* its factor */
    double holds; /* elements of this body with which that is LAR_REAL_TIME_RESERVE, about */
} lar_real_time;

/* Steps a simulation of the model from rest for about `seconds` of the clock, at least ten steps,
 * and then as lar_grid_choose does. Fails as creating and advancing a simulation fails. */
lar_status lar_real_time_measure(const lar_model *model, double seconds, lar_real_time *found,
                                 lar_error *error);

#endif
