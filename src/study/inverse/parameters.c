#include "study/inverse/parameters.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- by name ------------------------------------------------------------------------------- */

static const char *const modulus_name[] = {"shear_modulus", "bulk_modulus", "youngs_modulus",
                                           "poisson_ratio"};
enum { SHEAR, BULK, YOUNG, POISSON, MODULI };
static const char *const share_name[LAR_VISCOUS_TERMS] = {"g1", "g2", "g3", "g4", "g5", "g6"};
static const char *const time_name[LAR_VISCOUS_TERMS] = {"time1", "time2", "time3",
                                                         "time4", "time5", "time6"};
static const char FIBRES[] = "fibres."; /* laws have parameters of the same names */

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

/* `name` without what stands before it. */
static double *fibre_number(lar_fibre *fibre, const char *name) {
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++) {
        const char *own = lar_fibre_parameter_name[fibre->law][k];
        if (own && strcmp(own, name) == 0) return &fibre->parameter[k];
    }
    if (!lar_fibre_active(fibre)) return NULL;
    return strcmp(name, "along") == 0    ? &fibre->along
           : strcmp(name, "across") == 0 ? &fibre->across
                                         : NULL;
}

static double *own_number(lar_material *m, const char *name) {
    const lar_law_row *law = &lar_law_table[m->law];
    if (strncmp(name, FIBRES, strlen(FIBRES)) == 0)
        return fibre_number(&m->fibre, name + strlen(FIBRES));
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

static int add_name(lar_inverse_name *name, int count, int max, const char *before,
                    const char *own) {
    if (count == max) return max;
    snprintf(name[count], sizeof name[count], "%s%s", before, own);
    return count + 1;
}

static int add_fibre_names(const lar_fibre *fibre, lar_inverse_name *name, int count, int max) {
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++) {
        const char *own = lar_fibre_parameter_name[fibre->law][k];
        if (own) count = add_name(name, count, max, FIBRES, own);
    }
    if (!lar_fibre_active(fibre)) return count;
    count = add_name(name, count, max, FIBRES, "along");
    return add_name(name, count, max, FIBRES, "across");
}

int lar_inverse_names(const lar_material *m, lar_inverse_name *name, int max) {
    const lar_law_row *law = &lar_law_table[m->law];
    double moduli[MODULI];
    lar_material copy = *m;
    int count = 0;
    for (int i = 0; i < law->count; i++)
        count = add_name(name, count, max, "", law->parameter[i].name);
    for (int i = 0; i < MODULI && by_moduli(m, moduli); i++)
        if (!own_number(&copy, modulus_name[i]))
            count = add_name(name, count, max, "", modulus_name[i]);
    if (m->viscosity.terms > 0) count = add_name(name, count, max, "", "g0");
    for (int i = 0; i < m->viscosity.terms; i++) {
        count = add_name(name, count, max, "", share_name[i]);
        count = add_name(name, count, max, "", time_name[i]);
    }
    return add_fibre_names(&m->fibre, name, count, max);
}

const char *lar_inverse_unit(const lar_material *m, const char *name) {
    const lar_law_row *law = &lar_law_table[m->law];
    if (strncmp(name, FIBRES, strlen(FIBRES)) == 0) {
        lar_fibre fibre = m->fibre;
        const double *own = fibre_number(&fibre, name + strlen(FIBRES));
        for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
            if (own == &fibre.parameter[k]) return lar_fibre_scales(fibre.law, k) ? "Pa" : "";
        return "Pa";
    }
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

const char *lar_inverse_unit_of(const lar_inverse_problem *problem, int j) {
    const lar_inverse_parameter *p = &problem->parameter[j];
    return lar_inverse_unit(lar_inverse_material(problem, p->material), p->name);
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
