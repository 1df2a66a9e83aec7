/* Parameters of materials while a simulation runs, as the public header has them. The work that a
 * change does is that of stiffness (simulation_settings.c). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/parameters.h"
#include "model/springs.h"
#include "simulation/simulation.h"
#include "step/stable_step.h"

lar_status lar_simulation_parameter_index(const lar_model *model, int32_t material,
                                          const char *name, int *index, lar_error *error) {
    char names[256];
    if (material < 0 || material >= model->material_count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no material %ld; the model has %ld, counted from 0",
                        (long)material, (long)model->material_count);
    const lar_material *m = &model->material[material];
    *index = name ? lar_parameter_find(m, name) : -1;
    if (!name || *index >= 0) return LAR_OK;
    lar_parameter_names(m, names, sizeof names);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "this material has no parameter '%.60s'; of its law, %s, these can be set: %s",
                    name, lar_law_table[m->law].name, names);
}

/* How many times the squares of frequencies are what they are with the model's parameters. Where
 * the step leaves room a little counts as nothing, as it does when steps are divided
 * (lar_step_room_of): the shear modulus of what hardly changes its volume is hardly felt there. */
static lar_status faster_with(const lar_domain *domain, int32_t material, const lar_material *made,
                              double *faster, lar_error *error) {
    const lar_model *model = domain->model;
    double most = 0, *squares;
    lar_status status = lar_spring_squares(model, &squares, error);
    if (status) return status;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        lar_hex8 hex8;
        if (model->element_material[e] != material) continue;
        double now = lar_element_frequency(model, domain->kind, e, made, &hex8);
        const lar_element_rate *rate = &domain->rate[e];
        double usual = rate->square * rate->mass / (rate->mass - rate->added);
        double square = (now * now + lar_spring_square(model, squares, e)) / usual;
        most = square <= most ? most : square; /* what is no number, too */
    }
    double dt = domain->time_step, fastest = domain->fastest[lar_factor_of(material)];
    bool roomy = lar_little_faster(most, 0.25 * dt * dt * fastest * most);
    *faster = (most > 1 && roomy) || most == 0 ? 1 : most; /* 0: nothing is made of it */
    free(squares);
    return LAR_OK;
}

static lar_status check_value(const lar_material *made, int index, double value, lar_error *error) {
    const lar_law_row *law = &lar_law_table[made->law];
    bool modulus = index < law->count && law->parameter[index].value == LAR_VALUE_MODULUS;
    if (modulus && !(value > 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s of %g Pa; it must be positive",
                        law->parameter[index].name, value);
    lar_error why;
    if (!lar_material_check(made, "with this parameter", &why)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%.900s", why.message);
}

lar_status lar_simulation_set_parameter_at(lar_simulation *simulation, int32_t material, int index,
                                           double value, lar_error *error) {
    const lar_model *model = simulation->domain.model;
    if (material < 0 || material >= model->material_count || index >= LAR_PARAMETER_NAMES ||
        (index >= LAR_PARAMETER_VALUES && !lar_parameter_name(&model->material[material], index)))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "there is no parameter %d of material %ld",
                        index, (long)material);
    lar_parameters wanted = simulation->tools.parameters;
    lar_parameter_entry entry = lar_parameters_of_model(model, material);
    if (index >= 0) {
        entry = lar_parameters_at(&wanted, model, material);
        lar_parameter_put(model, &entry, index, value + 0.0); /* no -0 */
        const lar_material made = lar_parameters_give(model, &entry);
        lar_status status = check_value(&made, index, value, error);
        if (!status)
            status = faster_with(&simulation->domain, material, &made, &entry.faster, error);
        if (status) return status;
        double factor = simulation->tools.settings.factor[lar_factor_of(material)];
        static const double SHORTEST = 1e9; /* more is no number that says anything */
        if (!(entry.faster * factor <= LAR_STIFFNESS_MAX))
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "%g for %s asks for steps %.3g times as short as the model's "
                            "materials, with the stiffness that is set; they are divided for that "
                            "down to half: take a value nearer to the model's, or one in the model",
                            value, lar_parameter_name(&made, index),
                            fmin(sqrt(entry.faster * factor), SHORTEST));
    }
    if (!lar_parameters_put(&wanted, model, &entry))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d materials have other parameters than the model's already; give one of "
                        "them the model's again, with NULL for the name",
                        LAR_MATERIALS_SET_MAX);
    if (memcmp(&wanted, &simulation->tools.parameters, sizeof wanted) == 0) return LAR_OK;
    return lar_simulation_change_materials(simulation, &simulation->tools.settings, &wanted, error);
}

lar_status lar_simulation_set_parameter(lar_simulation *simulation, int32_t material,
                                        const char *name, double value, lar_error *error) {
    int index;
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_parameter", error);
    if (!status)
        status =
            lar_simulation_parameter_index(simulation->domain.model, material, name, &index, error);
    if (status) return status;
    return lar_simulation_set_parameter_at(simulation, material, index, value, error);
}

double lar_simulation_parameter(const lar_simulation *simulation, int32_t material,
                                const char *name) {
    int index;
    if (!simulation || !name) return NAN;
    const lar_model *model = simulation->domain.model;
    if (lar_simulation_parameter_index(model, material, name, &index, NULL)) return NAN;
    const lar_parameter_entry entry =
        lar_parameters_at(&simulation->tools.parameters, model, material);
    return lar_parameter_get(model, &entry, index);
}
