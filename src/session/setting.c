#include "session/setting.h"

lar_status lar_setting_apply(const lar_setting *setting, lar_simulation *simulation,
                             lar_error *error) {
    switch (setting->kind) {
    case LAR_SETTING_GRAVITY:
        return lar_simulation_set_gravity(simulation, setting->value, error);
    case LAR_SETTING_MODEL_GRAVITY:
        return lar_simulation_set_gravity(simulation, NULL, error);
    case LAR_SETTING_DAMPING:
        return lar_simulation_set_damping(simulation, setting->value[0], error);
    default:
        return lar_simulation_set_stiffness(simulation, setting->material, setting->value[0],
                                            error);
    }
}
