#include "step/materials.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "mechanics/hex8_guard.h"
#include "model/rest.h"
#include "step/activation.h"
#include "step/folds.h"

/* Beside one block. */
typedef struct beside_blocks {
    lar_viscous_block *relaxing; /* NULL: it is elastic */
    lar_fibre_block *fibres;     /* NULL: it has none */
    lar_fibre_block *second;     /* of the other family; NULL: they are no pair */
} beside_blocks;

static lar_block_more *more_of(const lar_domain *domain, int32_t r, int32_t b) {
    return domain->run[r].more ? domain->more + domain->run_first[r] + b : NULL;
}

static beside_blocks beside_of(const lar_domain *domain, int32_t r, int32_t b) {
    int32_t at = domain->run_first[r] + b;
    return (beside_blocks){.relaxing = domain->run[r].viscous ? domain->relaxing + at : NULL,
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

static void fill_viscosity(const lar_domain *domain, const lar_lane_base *base,
                           lar_viscous_block *block, int lane, const lar_material *material,
                           double factor) {
    const lar_viscosity *v = &material->viscosity;
    block->rest[lane] = v->rest;
    for (int i = 0; i < v->terms; i++) {
        block->term[i].share[lane] = v->share[i];
        block->term[i].rate[lane] = 1 / v->time[i];
    }
    block->unit[lane] = base->volume * domain->scale * factor;
    block->inverse[lane] = 1 / block->unit[lane];
}

/* One family of element e. */
static void fill_family(lar_fibre_block *block, int lane, const lar_material *material,
                        const double direction[3], double unit) {
    const lar_fibre *fibre = &material->fibre;
    for (int i = 0; i < 3; i++) block->direction[i][lane] = direction[i];
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        block->parameter[k][lane] =
            lar_fibre_scales(fibre->law, k) ? fibre->parameter[k] * unit : fibre->parameter[k];
    block->along[lane] = fibre->along * unit;
    block->across[lane] = fibre->across * unit;
    block->limit[lane] = lar_fibre_limit(material) * unit;
}

static void fill_fibres(const lar_domain *domain, const lar_lane_base *base, beside_blocks beside,
                        int lane, const lar_material *material, lar_gid e) {
    double direction[6], unit = base->volume * domain->scale;
    lar_model_fibres(domain->model, e, direction);
    fill_family(beside.fibres, lane, material, direction, unit);
    if (beside.second) fill_family(beside.second, lane, material, direction + 3, unit);
}

void lar_materials_fill(const lar_domain *domain, int32_t r, int32_t b, void *block, int lane) {
    int32_t at = domain->run_first[r] + b;
    lar_gid e = domain->layout.block[at].element[lane];
    const lar_lane_base *base = domain->base + LAR_BLOCK * at + lane;
    lar_block_more *more = more_of(domain, r, b);
    beside_blocks beside = beside_of(domain, r, b);
    int32_t material = domain->model->element_material[e];
    double factor = domain->factor[lar_factor_of(material)];
    double hourglass = factor * shear_of(domain, material);
    const lar_material *made = &domain->material[material];
    bool lean = domain->run[r].rest != NULL;
    double(*stiffness)[LAR_BLOCK] =
        lean ? ((lar_lean_block *)block)->stiffness : ((lar_block_head *)block)->stiffness;
    double held[LAR_HEX8_HOURGLASS];
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        held[m] = stiffness[m][lane] = base->stiffness[m] * hourglass * domain->scale;
    if (domain->run[r].folds) lar_folds_fill(domain, r, b, lane, held);
    if (lean) ((lar_lean_block *)block)->material[lane] = material;
    for (int k = 0; k < lar_law_table[made->law].count; k++) {
        bool scales = lar_law_scales(made->law, k), shared = lean && k < LAR_BLOCK_PARAMETERS;
        double value = scales ? made->parameter[k] * domain->scale : made->parameter[k];
        if (shared)
            domain->lean_parameters[material].of[k] = value;
        else
            *lar_block_parameter(block, more, k, lane) = scales ? value * base->volume : value;
    }
    if (beside.relaxing) fill_viscosity(domain, base, beside.relaxing, lane, made, factor);
    if (beside.fibres) fill_fibres(domain, base, beside, lane, made, e);
    domain->corner_limit[LAR_BLOCK * at + lane] = base->limit * hourglass * hourglass;
}

/* ---- fibres -------------------------------------------------------------------------------- */

bool lar_beside_plan(lar_domain *domain) {
    size_t blocks = (size_t)domain->layout.block_count;
    bool pairs = false;
    for (int32_t r = 0; r < domain->run_count; r++) {
        pairs = pairs || domain->run[r].fibrous > LAR_FIBRE_SINGLE;
        if (domain->run[r].fibrous) domain->fibre_bytes = blocks * sizeof *domain->fibres;
    }
    if (domain->fibre_bytes) domain->fibres = lar_calloc_aligned(domain->fibre_bytes, 1);
    if (pairs) domain->second = lar_calloc_aligned(domain->fibre_bytes, 1);
    if ((domain->fibre_bytes && !domain->fibres) || (pairs && !domain->second)) return false;
    for (int32_t r = 0; r < domain->run_count; r++) {
        lar_block_run *run = &domain->run[r];
        if (run->fibrous) run->fibres = domain->fibres + domain->run_first[r];
        if (run->fibrous > LAR_FIBRE_SINGLE) run->second = domain->second + domain->run_first[r];
    }
    return lar_folds_plan(domain);
}

lar_status lar_fibres_check(const lar_domain *domain, lar_error *error) {
    const lar_material *fibrous = lar_model_fibrous(domain->model);
    if (!fibrous || domain->kind == LAR_ELEMENT_HEX8) return LAR_OK;
    const char *quote = fibrous->name && *fibrous->name ? "'" : "";
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: the material %s%.60s%s has fibres, which only elements hex8 can have; "
                    "take these, or leave its fibres out",
                    lar_model_source(domain->model), fibrous->fibre.line, quote,
                    *quote ? fibrous->name : "without a name", quote);
}

/* ---- changes ------------------------------------------------------------------------------- */

lar_status lar_materials_copy(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    size_t count = (size_t)model->material_count;
    for (int i = 0; i < LAR_FACTORS_MAX; i++) domain->factor[i] = domain->faster[i] = 1;
    domain->memory = lar_model_memory(model);
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
