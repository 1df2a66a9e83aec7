/* How fast a model runs on this machine, measured for a moment: the real-time factor that `lariat
 * run` would reach on one core. */
#ifndef LAR_STUDY_REAL_TIME_H
#define LAR_STUDY_REAL_TIME_H

#include "lariat.h"

typedef struct lar_real_time {
    double factor;    /* simulated time per time of the clock; above 1 is faster */
    double step;      /* time of the clock for a step, the median [s] */
    double time_step; /* [s] */
    uint64_t steps;   /* measured */
} lar_real_time;

/* Steps a simulation of the model from rest for about `seconds` of the clock, at least ten steps.
 * Fails as creating and advancing a simulation fails. */
lar_status lar_real_time_measure(const lar_model *model, double seconds, lar_real_time *found,
                                 lar_error *error);

#endif
