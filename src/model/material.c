#include "model/material.h"

#include <math.h>

double lar_material_shear(const lar_material *material) {
    return lar_law_table[material->law].shear(material->parameter);
}

double lar_material_bulk(const lar_material *material) {
    return lar_law_table[material->law].bulk(material->parameter);
}

/* A constant that moduli at rest do not know has been given in another unit when it dwarfs them:
 * a strain of a thousandth would ask for forces that nothing has room for. */
static lar_status check_constants(const lar_material *material, const char *where, double modulus,
                                  lar_error *error) {
    static const double MAX = 1e9;
    const lar_law_row *law = &lar_law_table[material->law];
    for (int k = 0; k < law->count; k++)
        if (lar_law_scales(material->law, k) && fabs(material->parameter[k]) > MAX * modulus)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: %s of the law %s is %g Pa, more than %g times its moduli at rest; "
                            "check its unit",
                            where, law->parameter[k].name, law->name, material->parameter[k], MAX);
    return LAR_OK;
}

/* What has no unit: numbers as they are met in tissue and rubber. Beyond, powers of stretches say
 * nothing, or more than doubles hold. */
static lar_status check_numbers(const lar_material *material, const char *where, lar_error *error) {
    static const double POWER_MIN = 0.01, POWER_MAX = 100;
    const lar_law_row *law = &lar_law_table[material->law];
    for (int k = 0; k < law->count; k++) {
        double value = material->parameter[k], size = fabs(value);
        const char *name = law->parameter[k].name;
        if (law->parameter[k].value == LAR_VALUE_NUMBER &&
            !(value >= LAR_LAW_NUMBER_MIN && value <= LAR_LAW_NUMBER_MAX))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: %s of the law %s is %g; it has no unit and must be between %g "
                            "and %g",
                            where, name, law->name, value, LAR_LAW_NUMBER_MIN, LAR_LAW_NUMBER_MAX);
        if (law->parameter[k].value == LAR_VALUE_POWER && material->parameter[k - 1] != 0 &&
            !(size >= POWER_MIN && size <= POWER_MAX))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: %s of the law %s is %g; it is the power of the term of %s and "
                            "must be between %g and %g, or between -%g and -%g",
                            where, name, law->name, value, law->parameter[k - 1].name, POWER_MIN,
                            POWER_MAX, POWER_MIN, POWER_MAX);
    }
    return LAR_OK;
}

lar_status lar_material_check(const lar_material *material, const char *where, lar_error *error) {
    if (!((unsigned)material->law < LAR_LAW_COUNT))
        return lar_fail(error, LAR_ERROR_MODEL, "%s: material law number %d does not exist", where,
                        (int)material->law);
    for (int i = 0; i < LAR_LAW_PARAMETERS; i++)
        if (!isfinite(material->parameter[i]))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: a parameter of the law %s is not a finite number; give every "
                            "modulus as a number in pascal",
                            where, lar_law_name[material->law]);
    if (!(material->density > 0.0) || !isfinite(material->density))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the density is %g; it must be positive, in kg/m^3 (soft tissue has "
                        "about 1050)",
                        where, material->density);
    lar_status status = check_numbers(material, where, error);
    if (status) return status;
    double shear = lar_material_shear(material), bulk = lar_material_bulk(material);
    if (!(shear > 0.0) || !isfinite(shear))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the shear modulus is %g Pa; it must be positive", where, shear);
    if (!(bulk > 0.0) || !isfinite(bulk))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the bulk modulus is %g Pa; it must be positive (Poisson's ratio "
                        "between -1 and 0.5, exclusive)",
                        where, bulk);
    return check_constants(material, where, bulk + 4.0 * shear / 3.0, error);
}

void lar_material_from_young(lar_material *material, double young, double poisson) {
    lar_material_from_shear_bulk(material, young / (2.0 * (1.0 + poisson)),
                                 young / (3.0 * (1.0 - 2.0 * poisson)));
}

void lar_material_from_shear_bulk(lar_material *material, double shear, double bulk) {
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++) material->parameter[k] = 0;
    lar_law_table[material->law].from_moduli(shear, bulk, material->parameter);
}
