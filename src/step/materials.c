#include "step/materials.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "step/activation.h"
#include "step/beside.h"

static lar_block_more *more_of(const lar_domain *domain, int32_t r, int32_t b) {
    return domain->run[r].more ? domain->more + domain->run_first[r] + b : NULL;
}

static lar_beside beside_of(const lar_domain *domain, int32_t r, int32_t b) {
    int32_t at = domain->run_first[r] + b;
    return (lar_beside){.relaxing = domain->run[r].viscous ? domain->relaxing + at : NULL,
                        .fibres = domain->run[r].fibrous ? domain->fibres + at : NULL,
                        .second = domain->run[r].second ? domain->second + at : NULL};
}

/* How many times as large the shear modulus is as the model's by the parameters that were set:
 * hourglass control goes with it (mechanics/hex8.h). */
static double shear_of(const lar_domain *domain, int32_t material) {
    for (int32_t i = 0; i < domain->set.count; i++) {
        const lar_parameter_entry *entry = &domain->set.entry[i];
        if (entry->material != material) continue;
        const lar_material made = lar_parameters_give(domain->model, entry);
        return lar_material_shear(&made) / lar_material_shear(&domain->model->material[material]);
    }
    return 1;
}

void lar_materials_fill(const lar_domain *domain, int32_t r, int32_t b, void *block, int lane) {
    int32_t at = domain->run_first[r] + b;
    lar_gid e = domain->layout.block[at].element[lane];
    const lar_lane_base *base = domain->base + LAR_BLOCK * at + lane;
    lar_block_head *head = block;
    lar_block_more *more = more_of(domain, r, b);
    lar_beside beside = beside_of(domain, r, b);
    int32_t material = domain->model->element_material[e];
    double factor = domain->factor[lar_factor_of(material)];
    double hourglass = factor * shear_of(domain, material);
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        head->stiffness[m][lane] = base->stiffness[m] * hourglass * domain->scale;
    const lar_material *made = &domain->material[material];
    for (int k = 0; k < lar_law_table[made->law].count; k++)
        *lar_block_parameter(head, more, k, lane) =
            lar_law_scales(made->law, k) ? made->parameter[k] * base->volume * domain->scale
                                         : made->parameter[k];
    if (beside.relaxing) lar_fill_viscosity(domain, base, beside.relaxing, lane, made, factor);
    if (beside.fibres) lar_fill_fibres(domain, base, beside, lane, made, e);
    domain->corner_limit[LAR_BLOCK * at + lane] = base->limit * hourglass * hourglass;
}

lar_status lar_materials_copy(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    size_t count = (size_t)model->material_count;
    for (int i = 0; i < LAR_FACTORS_MAX; i++) domain->factor[i] = domain->faster[i] = 1;
    domain->material = lar_calloc(count, sizeof *domain->material);
    if (!domain->material)
        return lar_fail_memory(error, count * sizeof *domain->material, "the materials");
    memcpy(domain->material, model->material, count * sizeof *domain->material);
    return LAR_OK;
}

/* Atomic, for those who look from other threads (lar_domain_material_copy). */
static void take_parameters(lar_domain *domain, int32_t material) {
    double factor = domain->factor[lar_factor_of(material)];
    const lar_parameter_entry entry = lar_parameters_at(&domain->set, domain->model, material);
    lar_material made = lar_parameters_give(domain->model, &entry),
                 *to = domain->material + material;
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++) {
        if (lar_law_scales(made.law, k)) made.parameter[k] *= factor;
        __atomic_store(&to->parameter[k], &made.parameter[k], __ATOMIC_RELAXED);
    }
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++) {
        if (lar_fibre_scales(made.fibre.law, k)) made.fibre.parameter[k] *= factor;
        __atomic_store(&to->fibre.parameter[k], &made.fibre.parameter[k], __ATOMIC_RELAXED);
    }
}

lar_material lar_domain_material_copy(const lar_domain *domain, lar_gid e, double *factor) {
    int32_t material = domain->model->element_material[e];
    lar_material made = domain->model->material[material], *now = domain->material + material;
    double at;
    if (factor) __atomic_load(&domain->factor[lar_factor_of(material)], factor, __ATOMIC_RELAXED);
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
        __atomic_load(&now->parameter[k], &made.parameter[k], __ATOMIC_RELAXED);
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        __atomic_load(&now->fibre.parameter[k], &made.fibre.parameter[k], __ATOMIC_RELAXED);
    if (!lar_fibre_active(&made.fibre)) return made;
    __atomic_load(&domain->now, &at, __ATOMIC_RELAXED);
    double activation = lar_activation_at(domain, e, at);
    made.fibre.along *= activation;
    made.fibre.across *= activation;
    return made;
}

/* Elements whose material has changed. */
static void fill_changed(lar_domain *domain, const bool changed[LAR_FACTORS_MAX]) {
    char *memory = domain->blocks;
    for (int32_t r = 0; r < domain->run_count; r++)
        for (int32_t b = 0; b < domain->run[r].count; b++) {
            const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + b];
            for (int lane = 0; lane < LAR_BLOCK; lane++) {
                lar_gid e = lanes->element[lane];
                if (e >= 0 && changed[lar_factor_of(domain->model->element_material[e])])
                    lar_materials_fill(domain, r, b, memory, lane);
            }
            memory += lar_run_stride(&domain->run[r]);
        }
}

static bool same_parameters(const lar_domain *domain, const lar_parameters *parameters) {
    size_t used =
        offsetof(lar_parameters, entry) + (size_t)domain->set.count * sizeof domain->set.entry[0];
    return memcmp(&domain->set, parameters, used) == 0;
}

bool lar_domain_follows(const lar_domain *domain, const lar_settings *settings,
                        const lar_parameters *parameters) {
    return memcmp(domain->factor, settings->factor, sizeof domain->factor) == 0 &&
           memcmp(domain->activation, settings->activation, sizeof domain->activation) == 0 &&
           same_parameters(domain, parameters);
}

/* Of materials that share a factor the fastest counts. */
static void note_faster(lar_domain *domain) {
    double faster[LAR_FACTORS_MAX];
    for (int i = 0; i < LAR_FACTORS_MAX; i++) faster[i] = i + 1 < LAR_FACTORS_MAX ? 0 : 1;
    for (int32_t k = 0; k < domain->set.count; k++) {
        int i = lar_factor_of(domain->set.entry[k].material);
        faster[i] = fmax(faster[i], domain->set.entry[k].faster);
    }
    for (int i = 0; i < LAR_FACTORS_MAX; i++)
        domain->faster[i] = domain->factor[i] * (faster[i] > 0 ? faster[i] : 1);
}

static void mark_set(const lar_parameters *parameters, bool changed[LAR_FACTORS_MAX]) {
    for (int32_t k = 0; k < parameters->count; k++)
        changed[lar_factor_of(parameters->entry[k].material)] = true;
}

bool lar_domain_stiffen(lar_domain *domain, const lar_settings *settings,
                        const lar_parameters *parameters) {
    bool changed[LAR_FACTORS_MAX], any = false;
    lar_activation_take(domain, settings);
    for (int i = 0; i < LAR_FACTORS_MAX; i++) {
        double factor = settings->factor[i];
        changed[i] = factor != domain->factor[i];
        __atomic_store(&domain->factor[i], &factor, __ATOMIC_RELAXED);
    }
    if (!same_parameters(domain, parameters)) {
        mark_set(&domain->set, changed);
        mark_set(parameters, changed);
        domain->set = *parameters;
    }
    for (int i = 0; i < LAR_FACTORS_MAX; i++) any = any || changed[i];
    if (!any) return false;
    note_faster(domain);
    for (int32_t i = 0; i < domain->model->material_count; i++) take_parameters(domain, i);
    if (domain->blocks) fill_changed(domain, changed);
    return true;
}
