#include "model/settings.h"

#include <string.h>

void lar_gravity_at(const lar_model *model, const lar_settings *settings, double time, double width,
                    double gravity[3]) {
    if (settings && settings->gravity_set) {
        memcpy(gravity, settings->gravity, sizeof settings->gravity);
        return;
    }
    for (int axis = 0; axis < 3; axis++) {
        int curve = model->gravity_curve[axis];
        gravity[axis] = model->gravity[axis];
        if (curve >= 0) gravity[axis] *= lar_curve_mean(&model->curve[curve], time, width);
    }
}

int lar_settings_good(const lar_settings *settings, double time_step) {
    const double *g = settings->gravity;
    int good = (settings->gravity_set == 0 || settings->gravity_set == 1) &&
               (settings->damping_set == 0 || settings->damping_set == 1) &&
               g[0] * g[0] + g[1] * g[1] + g[2] * g[2] <= LAR_GRAVITY_MAX * LAR_GRAVITY_MAX &&
               lar_damping_fits(settings->damping, time_step);
    for (int i = 0; i < LAR_FACTORS_MAX; i++)
        good = good && settings->factor[i] >= LAR_STIFFNESS_MIN &&
               settings->factor[i] <= LAR_STIFFNESS_MAX && settings->activation[i] >= 0 &&
               settings->activation[i] <= 1;
    return good;
}
