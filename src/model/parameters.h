/* Parameters of materials that are set while a simulation runs, in place of the model's.
 *
 *     the model's parameters   <----   an entry: all parameters of one material, as they are now
 *     times its stiffness              (model/settings.h)
 *
 * Plain numbers, as forces that are set (model/forces.h): they travel with the tools and are in
 * checkpoints, where an entry is 104 bytes.
 */
#ifndef LAR_MODEL_PARAMETERS_H
#define LAR_MODEL_PARAMETERS_H

#include <stdbool.h>

#include "model/model.h"
#include "model/settings.h"

/* The law's, then those of fibres. Two names more stand for no value of their own: shear_modulus
 * and bulk_modulus of a law that has Lame's numbers, for scenes may give it these. */
enum {
    LAR_PARAMETER_VALUES = LAR_LAW_PARAMETERS + LAR_FIBRE_PARAMETERS,
    LAR_PARAMETER_SHEAR = LAR_PARAMETER_VALUES,
    LAR_PARAMETER_BULK,
    LAR_PARAMETER_NAMES
};

typedef struct lar_parameter_entry {
    int32_t material, padding;
    double faster; /* how many times the square of the frequencies of its elements at rest is what
                      it is with the model's, at most */
    double value[LAR_PARAMETER_VALUES];
} lar_parameter_entry;

typedef struct lar_parameters {
    int32_t count, padding;
    lar_parameter_entry entry[LAR_MATERIALS_SET_MAX]; /* by material */
} lar_parameters;

/* As the model says. */
lar_parameter_entry lar_parameters_of_model(const lar_model *model, int32_t material);
/* As they are now. */
lar_parameter_entry lar_parameters_at(const lar_parameters *parameters, const lar_model *model,
                                      int32_t material);
/* The material with these parameters. */
lar_material lar_parameters_give(const lar_model *model, const lar_parameter_entry *entry);

/* Which value of an entry a name is: a parameter of the law as scenes call it, or "fibres." and one
 * of its fibres. -1: none. */
int lar_parameter_find(const lar_material *material, const char *name);
/* The name of a value, without "fibres."; NULL: the material has none there. */
const char *lar_parameter_name(const lar_material *material, int k);
/* What a name stands for now, and in its place another value; from one of the two moduli follow
 * both of Lame's numbers, the other modulus stays. */
double lar_parameter_get(const lar_model *model, const lar_parameter_entry *entry, int k);
void lar_parameter_put(const lar_model *model, lar_parameter_entry *entry, int k, double value);
/* All names, with commas between them. */
void lar_parameter_names(const lar_material *material, char *out, size_t size);

/* Puts the entry in its place; one that says what the model says is removed. False: no place is
 * left. */
bool lar_parameters_put(lar_parameters *parameters, const lar_model *model,
                        const lar_parameter_entry *entry);

/* Whether elements stay slow enough for steps: stiffness and parameters together. */
static inline bool lar_parameters_bearable(const lar_parameters *parameters,
                                           const lar_settings *settings) {
    bool bearable = true;
    for (int32_t i = 0; i < parameters->count; i++) {
        const lar_parameter_entry *entry = &parameters->entry[i];
        double factor = settings->factor[lar_factor_of(entry->material)];
        bearable = bearable && entry->faster > 0 && entry->faster * factor <= LAR_STIFFNESS_MAX;
    }
    return bearable;
}

/* Whether they are such as the public call lets through: for what comes from files and from other
 * processes. */
bool lar_parameters_good(const lar_parameters *parameters, const lar_settings *settings,
                         const lar_model *model);

#endif
