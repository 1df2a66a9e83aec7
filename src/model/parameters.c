#include "model/parameters.h"

#include <stdio.h>
#include <string.h>

static const char FIBRES[] = "fibres."; /* laws have parameters of the same names */

lar_parameter_entry lar_parameters_of_model(const lar_model *model, int32_t material) {
    const lar_material *m = &model->material[material];
    lar_parameter_entry entry = {.material = material, .faster = 1};
    memcpy(entry.value, m->parameter, sizeof m->parameter);
    memcpy(entry.value + LAR_LAW_PARAMETERS, m->fibre.parameter, sizeof m->fibre.parameter);
    return entry;
}

lar_parameter_entry lar_parameters_at(const lar_parameters *parameters, const lar_model *model,
                                      int32_t material) {
    for (int32_t i = 0; i < parameters->count; i++)
        if (parameters->entry[i].material == material) return parameters->entry[i];
    return lar_parameters_of_model(model, material);
}

lar_material lar_parameters_give(const lar_model *model, const lar_parameter_entry *entry) {
    lar_material made = model->material[entry->material];
    memcpy(made.parameter, entry->value, sizeof made.parameter);
    memcpy(made.fibre.parameter, entry->value + LAR_LAW_PARAMETERS, sizeof made.fibre.parameter);
    return made;
}

static bool is_of_fibres(int k) {
    return k >= LAR_LAW_PARAMETERS && k < LAR_PARAMETER_VALUES;
}

const char *lar_parameter_name(const lar_material *material, int k) {
    const lar_law_row *law = &lar_law_table[material->law];
    if (is_of_fibres(k))
        return lar_fibre_parameter_name[material->fibre.law][k - LAR_LAW_PARAMETERS];
    if (k < LAR_PARAMETER_VALUES) return k < law->count ? law->parameter[k].name : NULL;
    if (material->law != LAR_LAW_coupled_neo_hookean) return NULL;
    return k == LAR_PARAMETER_SHEAR ? "shear_modulus" : "bulk_modulus";
}

int lar_parameter_find(const lar_material *material, const char *name) {
    bool fibres = strncmp(name, FIBRES, strlen(FIBRES)) == 0;
    if (fibres) name += strlen(FIBRES);
    for (int k = 0; k < LAR_PARAMETER_NAMES; k++) {
        const char *one = is_of_fibres(k) == fibres ? lar_parameter_name(material, k) : NULL;
        if (one && strcmp(one, name) == 0) return k;
    }
    return -1;
}

double lar_parameter_get(const lar_model *model, const lar_parameter_entry *entry, int k) {
    const lar_law_row *law = &lar_law_table[model->material[entry->material].law];
    if (k < LAR_PARAMETER_VALUES) return entry->value[k];
    return k == LAR_PARAMETER_SHEAR ? law->shear(entry->value) : law->bulk(entry->value);
}

void lar_parameter_put(const lar_model *model, lar_parameter_entry *entry, int k, double value) {
    if (k < LAR_PARAMETER_VALUES) {
        entry->value[k] = value;
        return;
    }
    double shear =
        k == LAR_PARAMETER_SHEAR ? value : lar_parameter_get(model, entry, LAR_PARAMETER_SHEAR);
    double bulk =
        k == LAR_PARAMETER_BULK ? value : lar_parameter_get(model, entry, LAR_PARAMETER_BULK);
    lar_law_table[model->material[entry->material].law].from_moduli(shear, bulk, entry->value);
}

void lar_parameter_names(const lar_material *material, char *out, size_t size) {
    size_t length = 0;
    *out = '\0';
    for (int k = 0; k < LAR_PARAMETER_NAMES; k++) {
        if (!lar_parameter_name(material, k) || length >= size) continue;
        length += (size_t)snprintf(out + length, size - length, "%s%s%s", length ? ", " : "",
                                   is_of_fibres(k) ? FIBRES : "", lar_parameter_name(material, k));
    }
}

bool lar_parameters_put(lar_parameters *parameters, const lar_model *model,
                        const lar_parameter_entry *entry) {
    const lar_parameter_entry usual = lar_parameters_of_model(model, entry->material);
    lar_parameter_entry *end = parameters->entry + parameters->count, *at = parameters->entry;
    while (at < end && at->material < entry->material) at++;
    size_t behind = (size_t)(end - at) * sizeof *at;
    bool there = at < end && at->material == entry->material;
    if (memcmp(entry->value, usual.value, sizeof usual.value) == 0) {
        if (!there) return true;
        memmove(at, at + 1, behind - sizeof *at);
        parameters->entry[--parameters->count] = (lar_parameter_entry){0};
        return true;
    }
    if (!there && parameters->count == LAR_MATERIALS_SET_MAX) return false;
    if (!there) memmove(at + 1, at, behind);
    parameters->count += !there;
    *at = *entry;
    return true;
}

bool lar_parameters_good(const lar_parameters *parameters, const lar_settings *settings,
                         const lar_model *model) {
    if (parameters->count < 0 || parameters->count > LAR_MATERIALS_SET_MAX) return false;
    for (int32_t i = 0, last = -1; i < parameters->count; i++) {
        const lar_parameter_entry *entry = &parameters->entry[i];
        if (entry->material <= last || entry->material >= model->material_count) return false;
        const lar_material made = lar_parameters_give(model, entry);
        if (lar_material_check(&made, "", NULL)) return false;
        last = entry->material;
    }
    return lar_parameters_bearable(parameters, settings);
}
