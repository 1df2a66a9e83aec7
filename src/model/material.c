#include "model/material.h"

#include <math.h>

const char *const lar_law_name[LAR_LAW_COUNT] = {
#define LAR_LAW_NAME(identifier, name) [LAR_LAW_##identifier] = name,
    LAR_LAWS(LAR_LAW_NAME)
#undef LAR_LAW_NAME
};

/* Small strains: every law is K, G linear elasticity there. With lambda = K - 2 G / 3:
 *   coupled-neo-hookean  G = mu, K = lambda + 2 mu / 3
 *   mooney-rivlin        G = 2 (c1 + c2) */

double lar_material_shear(const lar_material *material) {
    const double *p = material->parameter;
    return material->law == LAR_LAW_mooney_rivlin ? 2.0 * (p[0] + p[1]) : p[0];
}

double lar_material_bulk(const lar_material *material) {
    const double *p = material->parameter;
    switch (material->law) {
    case LAR_LAW_coupled_neo_hookean:
        return p[1] + 2.0 * p[0] / 3.0;
    case LAR_LAW_mooney_rivlin:
        return p[2];
    default:
        return p[1];
    }
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
    double shear = lar_material_shear(material), bulk = lar_material_bulk(material);
    if (!(shear > 0.0) || !isfinite(shear))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the shear modulus is %g Pa; it must be positive", where, shear);
    if (!(bulk > 0.0) || !isfinite(bulk))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the bulk modulus is %g Pa; it must be positive (Poisson's ratio "
                        "between -1 and 0.5, exclusive)",
                        where, bulk);
    return LAR_OK;
}

void lar_material_from_young(lar_material *material, double young, double poisson) {
    lar_material_from_shear_bulk(material, young / (2.0 * (1.0 + poisson)),
                                 young / (3.0 * (1.0 - 2.0 * poisson)));
}

void lar_material_from_shear_bulk(lar_material *material, double shear, double bulk) {
    double *p = material->parameter;
    p[0] = p[1] = p[2] = 0.0;
    switch (material->law) {
    case LAR_LAW_coupled_neo_hookean:
        p[0] = shear;
        p[1] = bulk - 2.0 * shear / 3.0;
        break;
    case LAR_LAW_mooney_rivlin:
        p[0] = shear / 2.0;
        p[2] = bulk;
        break;
    default:
        p[0] = shear;
        p[1] = bulk;
        break;
    }
}
