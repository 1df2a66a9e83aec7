#include "model/material.h"

#include <math.h>
#include <string.h>

const char *const lar_fibre_law_name[LAR_FIBRE_LAWS] = {"", "exp-pow", "exp-linear", "pow-linear",
                                                        "hgo"};
const char *const lar_fibre_parameter_name[LAR_FIBRE_LAWS][LAR_FIBRE_PARAMETERS] = {
    [LAR_FIBRE_EXP_POW] = {"ksi", "alpha", "beta"},
    [LAR_FIBRE_EXP_LINEAR] = {"c3", "c4", "c5", "lam_max"},
    [LAR_FIBRE_POW_LINEAR] = {"E", "lam0", "beta"},
    [LAR_FIBRE_HGO] = {"k1", "k2", "kappa"}};

double lar_material_shear(const lar_material *material) {
    double shear = lar_law_table[material->law].shear(material->parameter);
    return material->viscosity.terms ? lar_viscosity_rest(&material->viscosity) * shear : shear;
}

double lar_material_bulk(const lar_material *material) {
    double bulk = lar_law_table[material->law].bulk(material->parameter);
    return material->viscosity.terms ? lar_viscosity_volume_rest(&material->viscosity) * bulk
                                     : bulk;
}

double lar_material_instant_shear(const lar_material *material) {
    double shear = lar_law_table[material->law].shear(material->parameter);
    return material->viscosity.terms ? lar_viscosity_instant(&material->viscosity) * shear : shear;
}

double lar_material_instant_bulk(const lar_material *material) {
    double bulk = lar_law_table[material->law].bulk(material->parameter);
    return material->viscosity.terms ? lar_viscosity_volume_instant(&material->viscosity) * bulk
                                     : bulk;
}

/* The bulk modulus of a law with an isochoric part is a parameter of its own. */
void lar_material_freeze(lar_material *material, bool at_once) {
    const lar_viscosity *v = &material->viscosity;
    const lar_law_row *law = &lar_law_table[material->law];
    const double factor = at_once ? lar_viscosity_instant(v) : lar_viscosity_rest(v);
    for (int k = 0; k < law->count; k++)
        if (lar_law_scales(material->law, k) &&
            !(v->isochoric && strcmp(law->parameter[k].name, "bulk_modulus") == 0))
            material->parameter[k] *= factor;
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        if (lar_fibre_scales(material->fibre.law, k)) material->fibre.parameter[k] *= factor;
    material->viscosity.terms = 0;
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

/* Shares and times as relaxation is measured: beyond, a unit is wrong. */
static lar_status check_viscosity(const lar_material *material, const char *where,
                                  lar_error *error) {
    static const double SUM = 1e4, TIME = 1e12;
    const lar_viscosity *v = &material->viscosity;
    if (v->terms == 0) return LAR_OK;
    if (v->terms < 0 || v->terms > LAR_VISCOUS_TERMS)
        return lar_fail(error, LAR_ERROR_MODEL, "%s: %d viscous terms; there can be 1 to %d", where,
                        v->terms, LAR_VISCOUS_TERMS);
    if (v->isochoric && !lar_law_table[material->law].uncoupled)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the law %s has no isochoric part that could relax alone; let the "
                        "whole stress relax, or take a law with an energy of the volume alone",
                        where, lar_law_name[material->law]);
    if (!(v->rest > 0) || !isfinite(v->rest))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: g0, what is left of the stress in the end, is %g; it must be "
                        "positive: a body that keeps no stress flows",
                        where, v->rest);
    double sum = v->rest;
    for (int i = 0; i < v->terms; i++) {
        if (!(v->share[i] > 0) || !isfinite(v->share[i]))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: g of viscous term %d is %g; it must be positive: leave out what "
                            "does not relax",
                            where, i + 1, v->share[i]);
        if (!(v->time[i] > 0) || !(v->time[i] <= TIME))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: the relaxation time of viscous term %d is %g s; it must be "
                            "positive, and at most %g s",
                            where, i + 1, v->time[i], TIME);
        sum += v->share[i];
    }
    if (sum > SUM * v->rest)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: at once the material is %g times as stiff as in the end; at most %g "
                        "times makes sense, check g0 and the g of its viscous terms",
                        where, sum / v->rest, SUM);
    return LAR_OK;
}

/* Numbers as they are met in tissue: beyond, a stretch of a tenth leaves the range of numbers, or a
 * unit is wrong. */
static lar_status check_fibres(const lar_material *material, const char *where, lar_error *error) {
    static const double STEEP = 1e4, POWER = 20, STIFF = 1e6;
    const lar_fibre *f = &material->fibre;
    const double *p = f->parameter;
    const char *wrong = NULL;
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        if (!isfinite(p[k])) wrong = "every parameter must be a finite number";
    double stiff = lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
    if (f->law == LAR_FIBRE_EXP_POW) {
        if (!(p[0] >= 0 && p[0] <= STIFF * stiff))
            wrong = "ksi, in pascal, must not be negative, nor a million times the law's moduli";
        if (!(p[1] >= 0 && p[1] <= STEEP)) wrong = "alpha must be between 0 and 10000";
        if (!(p[2] >= 2 && p[2] <= POWER)) wrong = "beta must be between 2 and 20";
    } else if (f->law == LAR_FIBRE_EXP_LINEAR) {
        if (!(p[0] >= 0 && p[0] * p[1] <= STIFF * stiff))
            wrong = "c3, in pascal, must not be negative, nor a million times the law's moduli";
        if (!(p[1] >= 0 && p[1] <= STEEP)) wrong = "c4 must be between 0 and 10000";
        if (!(p[2] >= 0 && p[2] <= STIFF * stiff))
            wrong = "c5, in pascal, must not be negative, nor a million times the law's moduli";
        if (!(p[3] >= 1 && p[3] <= POWER)) wrong = "lam_max must be between 1 and 20";
    } else if (f->law == LAR_FIBRE_POW_LINEAR) {
        if (!(p[0] >= 0 && p[0] <= STIFF * stiff))
            wrong = "E, in pascal, must not be negative, nor a million times the law's moduli";
        if (!(p[1] > 1 && p[1] <= POWER)) wrong = "lam0 must be above 1, and at most 20";
        if (!(p[2] >= 2 && p[2] <= POWER)) wrong = "beta must be between 2 and 20";
    }
    if (f->law == LAR_FIBRE_HGO) {
        if (!(p[0] >= 0 && p[0] <= STIFF * stiff))
            wrong = "k1, in pascal, must not be negative, nor a million times the law's moduli";
        if (!(p[1] >= 0 && p[1] <= STEEP)) wrong = "k2 must be between 0 and 10000";
        if (!(p[2] >= 0 && p[2] <= LAR_FIBRE_EVEN))
            wrong = "kappa must be between 0, all fibres alike, and 1/3, evenly spread";
        if (!f->isochoric)
            wrong = "the law hgo is one of the isochoric part of the stretch; take that part";
    }
    if (f->paired && f->law != LAR_FIBRE_HGO)
        wrong = "only fibres of the law hgo can have a second family; take that one";
    if (!(f->along >= 0 && f->across >= 0 && f->along + f->across <= STIFF * stiff))
        wrong = "the active stress must not be negative, nor a million times the law's moduli";
    if (!wrong && material->viscosity.terms > 0 && material->viscosity.isochoric &&
        f->law != LAR_FIBRE_NONE && !f->isochoric)
        wrong = "they see the whole stretch, and only the isochoric part of the stress relaxes; "
                "let the whole stress relax, or take fibres of the isochoric part";
    if (!wrong) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL, "%s: fibres: %s", where, wrong);
}

/* Frequencies of stiffer elements are no numbers. */
static const double MODULUS_MAX = 1e100;

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
                        "%s: the density is %g; it must be positive (soft tissue has about 1050 "
                        "kg/m^3)",
                        where, material->density);
    lar_status status = check_numbers(material, where, error);
    if (!status) status = check_viscosity(material, where, error);
    if (status) return status;
    double shear = lar_material_shear(material), bulk = lar_material_bulk(material);
    if (!(shear > 0.0 && shear < MODULUS_MAX))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the shear modulus is %g Pa; it must be positive and below 1e+100",
                        where, shear);
    if (!(bulk > 0.0 && bulk < MODULUS_MAX))
        return lar_fail(
            error, LAR_ERROR_MODEL,
            "%s: the bulk modulus is %g Pa; it must be positive and below 1e+100 (Poisson's ratio "
            "between -1 and 0.5, exclusive)",
            where, bulk);
    status = check_fibres(material, where, error);
    return status ? status : check_constants(material, where, bulk + 4.0 * shear / 3.0, error);
}

void lar_material_from_young(lar_material *material, double young, double poisson) {
    lar_material_from_shear_bulk(material, young / (2.0 * (1.0 + poisson)),
                                 young / (3.0 * (1.0 - 2.0 * poisson)));
}

void lar_material_from_shear_bulk(lar_material *material, double shear, double bulk) {
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++) material->parameter[k] = 0;
    lar_law_table[material->law].from_moduli(shear, bulk, material->parameter);
}
