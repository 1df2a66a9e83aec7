#include "study/real_time.h"

#include "study/bench/step_clock.h"

/* Steps that warm the caches, and those that are the least to be measured. */
enum { WARM = 5, MIN = 10 };

lar_status lar_real_time_measure(const lar_model *model, double seconds, lar_real_time *found,
                                 lar_error *error) {
    lar_simulation *simulation = NULL;
    lar_status status = lar_simulation_create(model, NULL, &simulation, error);
    if (!status) status = lar_simulation_advance(simulation, WARM, error);
    if (status) {
        lar_simulation_destroy(simulation);
        return status;
    }
    lar_step_clock clock;
    lar_step_clock_start(&clock, simulation, false);
    while (!status && (clock.times.count < MIN || lar_step_clock_elapsed(&clock) < seconds))
        status = lar_step_clock_advance(&clock, simulation, MIN, NULL, NULL, error);
    if (!status) {
        double step = 1e-6 * lar_step_clock_quantile(&clock, 0.5);
        *found = (lar_real_time){.factor = lar_simulation_time_step(simulation) / step,
                                 .step = step,
                                 .time_step = lar_simulation_time_step(simulation),
                                 .steps = clock.times.count};
    }
    lar_simulation_destroy(simulation);
    return status;
}
