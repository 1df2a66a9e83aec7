#include "study/inverse/parameters.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- by name ------------------------------------------------------------------------------- */

static const char *const modulus_name[] = {"shear_modulus", "bulk_modulus", "youngs_modulus",
                                           "poisson_ratio"};
enum { SHEAR, BULK, YOUNG, POISSON, MODULI };
static const char *const share_name[LAR_VISCOUS_TERMS] = {"g1", "g2", "g3"};
static const char *const time_name[LAR_VISCOUS_TERMS] = {"time1", "time2", "time3"};

/* Whether two moduli say all that the law has: then they can be set through them. */
static bool by_moduli(const lar_material *m, double moduli[MODULI]) {
    const lar_law_row *law = &lar_law_table[m->law];
    double back[LAR_LAW_PARAMETERS] = {0}, g = law->shear(m->parameter),
           k = law->bulk(m->parameter);
    law->from_moduli(g, k, back);
    for (int i = 0; i < law->count; i++)
        if (fabs(back[i] - m->parameter[i]) > 1e-9 * (fabs(g) + fabs(k))) return false;
    moduli[SHEAR] = g;
    moduli[BULK] = k;
    moduli[YOUNG] = 9 * k * g / (3 * k + g);
    moduli[POISSON] = (3 * k - 2 * g) / (6 * k + 2 * g);
    return true;
}

static double *own_number(lar_material *m, const char *name) {
    const lar_law_row *law = &lar_law_table[m->law];
    for (int i = 0; i < law->count; i++)
        if (strcmp(law->parameter[i].name, name) == 0) return &m->parameter[i];
    if (m->viscosity.terms > 0 && strcmp(name, "g0") == 0) return &m->viscosity.rest;
    for (int i = 0; i < m->viscosity.terms; i++) {
        if (strcmp(name, share_name[i]) == 0) return &m->viscosity.share[i];
        if (strcmp(name, time_name[i]) == 0) return &m->viscosity.time[i];
    }
    return NULL;
}

static int modulus_of(const char *name) {
    int i = 0;
    while (i < MODULI && strcmp(name, modulus_name[i]) != 0) i++;
    return i;
}

bool lar_inverse_get(const lar_material *material, const char *name, double *value) {
    lar_material copy = *material;
    double moduli[MODULI];
    const double *own = own_number(&copy, name);
    int i = modulus_of(name);
    if (!own && (i == MODULI || !by_moduli(material, moduli))) return false;
    *value = own ? *own : moduli[i];
    return true;
}

bool lar_inverse_set(lar_material *m, const char *name, double value) {
    double moduli[MODULI], *own = own_number(m, name);
    int i = modulus_of(name);
    if (own) *own = value;
    if (own) return true;
    if (i == MODULI || !by_moduli(m, moduli)) return false;
    moduli[i] = value;
    if (i == YOUNG || i == POISSON)
        lar_material_from_young(m, moduli[YOUNG], moduli[POISSON]);
    else
        lar_material_from_shear_bulk(m, moduli[SHEAR], moduli[BULK]);
    return true;
}

int lar_inverse_names(const lar_material *m, const char **name, int max) {
    const lar_law_row *law = &lar_law_table[m->law];
    double moduli[MODULI];
    int count = 0;
    for (int i = 0; i < law->count && count < max; i++) name[count++] = law->parameter[i].name;
    for (int i = 0; i < MODULI && count < max && by_moduli(m, moduli); i++) {
        lar_material copy = *m;
        if (!own_number(&copy, modulus_name[i])) name[count++] = modulus_name[i];
    }
    if (m->viscosity.terms > 0 && count < max) name[count++] = "g0";
    for (int i = 0; i < m->viscosity.terms && count < max - 1; i++) {
        name[count++] = share_name[i];
        name[count++] = time_name[i];
    }
    return count;
}

const char *lar_inverse_unit(const lar_material *m, const char *name) {
    const lar_law_row *law = &lar_law_table[m->law];
    for (int i = 0; i < law->count; i++)
        if (strcmp(law->parameter[i].name, name) == 0)
            return lar_law_in_pascal(&law->parameter[i]) ? "Pa" : "";
    if (modulus_of(name) < POISSON) return "Pa";
    return strncmp(name, "time", 4) == 0 ? "s" : "";
}

const lar_material *lar_inverse_material(const lar_inverse_problem *problem, const char *name) {
    for (int k = 0; k < problem->experiments; k++) {
        const lar_model *model = problem->experiment[k].model;
        for (int i = 0; model && i < model->material_count; i++)
            if (model->material[i].name && strcmp(model->material[i].name, name) == 0)
                return &model->material[i];
    }
    return NULL;
}

void lar_inverse_set_all(const lar_inverse_problem *problem, const double *value,
                         lar_material *material, int materials) {
    for (int j = 0; j < problem->parameters; j++)
        for (int i = 0; i < materials; i++)
            if (material[i].name && strcmp(material[i].name, problem->parameter[j].material) == 0)
                lar_inverse_set(&material[i], problem->parameter[j].name, value[j]);
}

/* ---- the axes ------------------------------------------------------------------------------- */

static double size_of(const lar_inverse_parameter *p) {
    return fmax(fabs(p->low), fabs(p->high));
}

double lar_inverse_u(const lar_inverse_parameter *p, double value) {
    return p->log ? log(value) : value / size_of(p);
}

double lar_inverse_value(const lar_inverse_parameter *p, double u) {
    double value = p->log ? exp(u) : u * size_of(p);
    return fmin(fmax(value, p->low), p->high); /* rounding */
}

double lar_inverse_u_low(const lar_inverse_parameter *p) {
    return lar_inverse_u(p, p->low);
}

double lar_inverse_u_high(const lar_inverse_parameter *p) {
    return lar_inverse_u(p, p->high);
}

static const double SHIFT = 2;

double lar_inverse_x(const lar_inverse_parameter *p, double u) {
    /* At a bound the sine has no slope, and nothing would ever leave it. */
    static const double INSIDE = 0.998;
    double low = lar_inverse_u_low(p), high = lar_inverse_u_high(p);
    double s = (2 * u - low - high) / (high - low);
    return asin(fmin(fmax(s, -INSIDE), INSIDE)) + SHIFT;
}

double lar_inverse_u_of_x(const lar_inverse_parameter *p, double x, double *slope) {
    double low = lar_inverse_u_low(p), half = 0.5 * (lar_inverse_u_high(p) - low);
    *slope = half * cos(x - SHIFT);
    return low + half * (1 + sin(x - SHIFT));
}
