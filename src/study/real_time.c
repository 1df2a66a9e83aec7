#include "study/real_time.h"

#include <math.h>

#include "model/model.h"
#include "session/advice.h"
#include "study/bench/step_clock.h"

/* Steps that warm the caches, and those that are the least to be measured. */
enum { WARM = 5, MIN = 10 };

/* Steps of one processor were measured one by one, which says more than batches of them. */
static lar_status look_at_divisions(const lar_model *model, lar_real_time *found,
                                    lar_error *error) {
    lar_status status = lar_grid_choose(model, NULL, NULL, &found->choice, error);
    if (status) return status;
    double step = found->choice.processors > 1 && found->choice.chosen > 0 ? found->choice.chosen
                                                                           : found->step;
    found->divided = found->time_step / step;
    found->holds = lar_two_digits(model->mesh.element_count *
                                  pow(found->divided / LAR_REAL_TIME_RESERVE, 0.75));
    return LAR_OK;
}

static lar_status measure_alone(const lar_model *model, double seconds, lar_real_time *found,
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

lar_status lar_real_time_measure(const lar_model *model, double seconds, lar_real_time *found,
                                 lar_error *error) {
    lar_status status = measure_alone(model, seconds, found, error);
    return status ? status : look_at_divisions(model, found, error);
}
