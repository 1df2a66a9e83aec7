#include "session/setting.h"

#include "simulation/simulation.h"
#include "step/identity.h"

static lar_status add_tool(const lar_setting *setting, lar_simulation *simulation,
                           lar_error *error) {
    const lar_tool_info wanted = {.shape = (lar_tool_shape)(setting->of % LAR_TOOL_HAND),
                                  .radius = setting->value[0],
                                  .length = setting->value[1],
                                  .spread = setting->value[2]};
    return lar_simulation_add_tool_at(simulation, &wanted, setting->of / LAR_TOOL_HAND, error);
}

/* Anything may stand in a file. */
static lar_status set_support(const lar_setting *setting, lar_simulation *simulation,
                              lar_error *error) {
    double axes = setting->value[0];
    return lar_simulation_set_support_of(
        simulation, setting->of, setting->kind == LAR_SETTING_SUPPORT_ON,
        axes >= 1 && axes <= LAR_AXIS_ALL ? (unsigned)axes : 0, setting->value[1] != 0, error);
}

static lar_status set_parameter(const lar_setting *setting, lar_simulation *simulation,
                                lar_error *error) {
    double index = setting->value[1];
    bool good = index >= -1 && index < LAR_PARAMETER_NAMES;
    return lar_simulation_set_parameter_at(
        simulation, setting->of, good ? (int)index : LAR_PARAMETER_NAMES, setting->value[0], error);
}

uint32_t lar_setting_members(const lar_setting *setting, const lar_simulation *simulation) {
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    bool on_set = setting->kind == LAR_SETTING_FORCE_ON || setting->kind == LAR_SETTING_SUPPORT_ON;
    if (!on_set || setting->of < 0 || setting->of >= mesh->set_count) return 0;
    uint32_t hash = (uint32_t)lar_set_hash(&mesh->set[setting->of]);
    return hash ? hash : 1;
}

lar_status lar_setting_apply(const lar_setting *setting, lar_simulation *simulation,
                             lar_error *error) {
    if (setting->members && setting->members != lar_setting_members(setting, simulation))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "the recording sets something on the nodes of set %ld, which has others "
                        "here than where it was recorded; play it with the model that it was "
                        "recorded with",
                        (long)setting->of);
    switch (setting->kind) {
    case LAR_SETTING_GRAVITY:
        return lar_simulation_set_gravity(simulation, setting->value, error);
    case LAR_SETTING_MODEL_GRAVITY:
        return lar_simulation_set_gravity(simulation, NULL, error);
    case LAR_SETTING_DAMPING:
        return lar_simulation_set_damping(simulation, setting->value[0], error);
    case LAR_SETTING_ADD_TOOL:
        return add_tool(setting, simulation, error);
    case LAR_SETTING_REMOVE_TOOL:
        return lar_simulation_remove_tool(simulation, setting->of, error);
    case LAR_SETTING_FORCE:
        return lar_simulation_set_force(simulation, setting->of,
                                        setting->of < 0 ? NULL : setting->value, error);
    case LAR_SETTING_FORCE_ON:
        return lar_simulation_set_force_at(simulation, setting->of, setting->value, error);
    case LAR_SETTING_SUPPORT:
    case LAR_SETTING_SUPPORT_ON:
        return set_support(setting, simulation, error);
    case LAR_SETTING_PARAMETER:
        return set_parameter(setting, simulation, error);
    case LAR_SETTING_ACTIVATION:
        return lar_simulation_activate(simulation, setting->of, setting->value[0], error);
    default:
        return lar_simulation_set_stiffness(simulation, setting->of, setting->value[0], error);
    }
}
