/* Activation while a simulation runs, as the public header has it. What is set is kept beside the
 * other settings (model/settings.h); the work that a change does is worked out here. */
#include <string.h>

#include "simulation/simulation.h"
#include "step/activation.h"

/* Factors of materials that are not active have nothing to say. */
static lar_status check(const lar_simulation *simulation, int32_t material, double value,
                        lar_error *error) {
    const lar_model *model = simulation->domain.model;
    int32_t count = model->material_count;
    if (material < -1 || material >= count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no material %ld; the model has %ld, counted from 0, and -1 means "
                        "all that are active",
                        (long)material, (long)count);
    bool active = material < 0 ? lar_model_active(model) != NULL
                               : lar_fibre_active(&model->material[material].fibre);
    if (!active)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s active stress; give it one in the model, in a scene as fibres: "
                        "{active: {along: 2.0e3}, ...}",
                        material < 0 ? "no material has any" : "this material has no");
    if (!(value >= 0 && value <= 1))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "an activation of %g; it is from 0, nothing is active, to 1, as much as "
                        "the model says at that time",
                        value);
    return LAR_OK;
}

lar_status lar_simulation_activate(lar_simulation *simulation, int32_t material, double value,
                                   lar_error *error) {
    lar_status status = lar_simulation_check_change(simulation, "lar_simulation_activate", error);
    if (!status) status = check(simulation, material, value, error);
    if (status) return status;
    const lar_model *model = simulation->domain.model;
    lar_settings wanted = simulation->tools.settings;
    for (int i = 0; i < model->material_count; i++)
        if ((material < 0 && lar_fibre_active(&model->material[i].fibre)) || i == material)
            wanted.activation[lar_factor_of(i)] = value + 0.0; /* no -0 */
    if (memcmp(&wanted, &simulation->tools.settings, sizeof wanted) == 0) return LAR_OK;
    status = lar_simulation_gather(simulation, error);
    if (status) return status;
    const lar_domain *domain = &simulation->domain;
    const lar_step_division *division = &simulation->tools.division;
    double past = lar_past_step(domain, division, &simulation->state);
    double next = domain->time_step / division->parts;
    lar_simulation_add_external(
        simulation, lar_activation_work(domain, &wanted, &simulation->state, past, next));
    simulation->tools.settings = wanted;
    lar_simulation_settle(simulation);
    return lar_simulation_set_anew(simulation, error);
}

double lar_simulation_activation(const lar_simulation *simulation, int32_t material) {
    int32_t count = simulation ? simulation->domain.model->material_count : 0;
    if (material < 0 || material >= count) return 0;
    return simulation->tools.settings.activation[lar_factor_of(material)];
}
