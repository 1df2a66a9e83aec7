/* FEBio decks: fibres of materials, and what contracts. See feb.h.
 *
 * A material with fibres is a "trans iso" one, or a "solid mixture" of a law and one family. Along
 * what they run is read in direction.c.
 */
#include "model/format/feb/feb.h"

#include <math.h>
#include <string.h>

/* ---- laws ------------------------------------------------------------------------------------ */

/* Types of FEBio and their parameters, in the order of lar_fibre.parameter. */
static const struct fibre_type {
    char type[28];
    lar_fibre_law law;
    bool isochoric;
    char name[LAR_FIBRE_PARAMETERS][8]; /* "": none further */
} fibre_types[] = {
    {"fiber-exp-pow", LAR_FIBRE_EXP_POW, false, {"ksi", "alpha", "beta"}},
    {"fiber-exp-pow-uncoupled", LAR_FIBRE_EXP_POW, true, {"ksi", "alpha", "beta"}},
    {"uncoupled fiber-exp-pow", LAR_FIBRE_EXP_POW, true, {"ksi", "alpha", "beta"}},
    {"fiber-exp-linear", LAR_FIBRE_EXP_LINEAR, false, {"c3", "c4", "c5", "lambda"}},
    {"fiber-pow-linear", LAR_FIBRE_POW_LINEAR, false, {"E", "lam0", "beta"}},
    {"fiber-pow-linear-uncoupled", LAR_FIBRE_POW_LINEAR, true, {"E", "lam0", "beta"}},
    {"uncoupled fiber-exp-linear", LAR_FIBRE_EXP_LINEAR, true, {"c3", "c4", "c5", "lambda"}},
};
enum { FIBRE_TYPES = sizeof fibre_types / sizeof *fibre_types };
static const struct fibre_type trans_iso = {
    "", LAR_FIBRE_EXP_LINEAR, true, {"c3", "c4", "c5", "lam_max"}};

static const struct fibre_type *find_type(const char *type) {
    for (int i = 0; i < FIBRE_TYPES; i++)
        if (strcmp(type, fibre_types[i].type) == 0) return &fibre_types[i];
    return NULL;
}

bool lar_feb_is_fibre(const char *type) {
    return find_type(type) != NULL;
}

/* Types that contract by T0, along fibres and across them. */
static const struct active_type {
    char type[52];
    double along, across;
} active_types[] = {
    {"prescribed uniaxial active contraction", 1, 0},
    {"uncoupled prescribed uniaxial active contraction", 1, 0},
    {"prescribed trans iso active contraction", 0, 1},
    {"uncoupled prescribed trans iso active contraction", 0, 1},
    {"prescribed isotropic active contraction", 1, 1},
    {"uncoupled prescribed isotropic active contraction", 1, 1},
};

static const struct active_type *find_active(const char *type) {
    for (size_t i = 0; i < sizeof active_types / sizeof *active_types; i++)
        if (strcmp(type, active_types[i].type) == 0) return &active_types[i];
    return NULL;
}

bool lar_feb_is_active(const char *type) {
    return find_active(type) != NULL;
}

const char *lar_feb_fibre_name(int i) {
    const int rest = i - FIBRE_TYPES;
    if (rest < 0) return fibre_types[i].type;
    return (size_t)rest < sizeof active_types / sizeof *active_types ? active_types[rest].type
                                                                     : NULL;
}

/* Angles are a direction of their own, of fibres in decks of version 2.5 too. */
static lar_status refuse_both(lar_feb *feb, const xmlNode *node) {
    if (!lar_feb_child(node, "fiber") ||
        !(lar_feb_child(node, "theta") || lar_feb_child(node, "phi")))
        return LAR_OK;
    return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                        "<theta> and <phi> stand beside <fiber>; keep one of the two");
}

/* The same total stress in both forms: FEBio's uncoupled one is no deviator. */
lar_status lar_feb_read_active(lar_feb *feb, const xmlNode *node, const char *type,
                               lar_fibre *fibre) {
    static const char known[] = "density k pressure_model T0 fiber mat_axis theta phi";
    const struct active_type *active = find_active(type);
    const xmlNode *value = lar_feb_child(node, "T0");
    double stress = 0;
    lar_status status = value && lar_feb_attribute(feb, value, "lc")
                            ? lar_feb_doubles(feb, value, &stress, 1)
                            : lar_feb_parameter(feb, node, "T0", true, &stress);
    fibre->along = active->along * stress;
    fibre->across = active->across * stress;
    if (!fibre->line) fibre->line = lar_feb_line(node);
    if (!status) status = refuse_both(feb, node);
    return status ? status : lar_feb_notice_others(feb, node, known);
}

/* ---- T0 with a load curve -------------------------------------------------------------------- */

/* <T0> of what contracts within a material of any depth, NULL: there is none. */
static const xmlNode *find_stress(lar_feb *feb, const xmlNode *node) {
    const char *type = lar_feb_attribute(feb, node, "type");
    const xmlNode *found = type && find_active(type) ? lar_feb_child(node, "T0") : NULL;
    for (const xmlNode *inner = lar_feb_first(node); inner && !found; inner = lar_feb_next(inner))
        if (lar_feb_is(inner, "solid") || lar_feb_is(inner, "elastic"))
            found = find_stress(feb, inner);
    return found;
}

/* A copy of a curve of which 1 is the largest value; NULL without memory. */
static lar_curve *share_of_curve(lar_feb *feb, int index, double largest) {
    lar_curve *copy = LAR_MODEL_APPEND(feb->model, curve);
    if (!copy) return NULL;
    const lar_curve *from = &feb->model->curve[index];
    double(*point)[2] = lar_calloc((size_t)from->count, sizeof *point);
    if (!point) return NULL;
    *copy = *from;
    copy->point = point;
    for (int p = 0; p < copy->count; p++) {
        copy->point[p][0] = from->point[p][0];
        copy->point[p][1] = from->point[p][1] / largest;
    }
    return copy;
}

/* FEBio multiplies T0 by a curve of any values; here the stress is the largest one, and the curve
 * its parts. */
static lar_status follow(lar_feb *feb, const xmlNode *stress, int index, lar_material *material) {
    const lar_curve *curve = &feb->model->curve[index];
    double largest = 0;
    for (int p = 0; p < curve->count; p++) {
        largest = fmax(largest, curve->point[p][1]);
        if (!(curve->point[p][1] >= 0))
            return lar_feb_fail(feb, stress, LAR_ERROR_UNSUPPORTED,
                                "the load curve of <T0> has values below 0, so that muscle would "
                                "push; Lariat's pulls, give the curve values from 0 on");
    }
    material->activation.curve = index + 1;
    if (largest <= 1) return LAR_OK;
    material->fibre.along *= largest;
    material->fibre.across *= largest;
    if (!share_of_curve(feb, index, largest)) return lar_feb_no_memory(feb, "a load curve");
    material->activation.curve = feb->model->curve_count;
    return LAR_OK;
}

lar_status lar_feb_read_activation(lar_feb *feb) {
    lar_status status = LAR_OK;
    for (int i = 0; i < feb->material_count && !status; i++) {
        const lar_feb_material *entry = &feb->material[i];
        const xmlNode *stress = entry->index < 0 ? NULL : find_stress(feb, entry->node);
        int curve;
        if (!stress || !lar_feb_attribute(feb, stress, "lc")) continue;
        status = lar_feb_curve_of(feb, stress, &curve);
        if (!status) status = follow(feb, stress, curve, &feb->model->material[entry->index]);
    }
    return status;
}

/* A parameter that only its default leaves without an effect. */
static lar_status refuse_unless(lar_feb *feb, const xmlNode *node, const char *name,
                                double fallback) {
    double value = fallback;
    lar_status status = lar_feb_parameter(feb, node, name, false, &value);
    if (status || value == fallback) return status;
    return lar_feb_fail(feb, lar_feb_child(node, name), LAR_ERROR_UNSUPPORTED,
                        "<%s> of fibres is %g, which is not read; give it %g or remove it", name,
                        value, fallback);
}

/* Calcium and sarcomeres; without a scale nothing contracts. */
static lar_status refuse_calcium(lar_feb *feb, const xmlNode *node) {
    const xmlNode *muscle = lar_feb_child(node, "active_contraction");
    if (!muscle) return LAR_OK;
    const char *type = lar_feb_attribute(feb, muscle, "type");
    const bool calcium = !type || strcmp(type, "active_contraction") == 0 ||
                         strcmp(type, "force-velocity-Estrada") == 0;
    const xmlNode *scale = lar_feb_child(muscle, "ascl");
    double value = 0;
    if (!calcium || lar_feb_child(muscle, "T0"))
        return lar_feb_fail(feb, muscle, LAR_ERROR_UNSUPPORTED,
                            "<active_contraction> of type '%.60s' is not read; take a "
                            "prescribed active contraction in a mixture",
                            type ? type : "");
    lar_status status = scale ? lar_feb_doubles(feb, scale, &value, 1) : LAR_OK;
    if (status || value == 0) return status;
    return lar_feb_fail(feb, muscle, LAR_ERROR_UNSUPPORTED,
                        "<active_contraction>, which follows calcium and the length of sarcomeres, "
                        "is not read; take a prescribed active contraction in a mixture, or give "
                        "<ascl> 0");
}

static lar_status read_numbers(lar_feb *feb, const xmlNode *node, const struct fibre_type *type,
                               lar_fibre *fibre) {
    lar_status status = LAR_OK;
    fibre->law = type->law;
    fibre->isochoric = type->isochoric;
    fibre->line = lar_feb_line(node);
    for (int k = 0; k < LAR_FIBRE_PARAMETERS && !status; k++)
        if (*type->name[k])
            status = lar_feb_parameter(feb, node, type->name[k], true, &fibre->parameter[k]);
    /* FEBio then takes the one with which the slope goes on as c5. */
    double *p = fibre->parameter;
    if (!status && type->law == LAR_FIBRE_EXP_LINEAR && p[0] == 0 && p[1] > 0)
        p[0] = p[2] / p[1] * exp(-p[1] * (p[3] - 1));
    return status;
}

lar_status lar_feb_read_fibre(lar_feb *feb, const xmlNode *node, const char *type,
                              lar_fibre *fibre) {
    const struct fibre_type *own = find_type(type);
    static const char known[] = "density k pressure_model ksi alpha beta c3 c4 c5 lambda fiber "
                                "mat_axis E lam0 mu theta phi";
    lar_status status = refuse_both(feb, node);
    if (!status) status = refuse_unless(feb, node, "mu", 0);
    /* Of a power law that goes on straight, lam0 is where it does; of others fibres begin there. */
    if (!status && own->law != LAR_FIBRE_POW_LINEAR) status = refuse_unless(feb, node, "lam0", 1);
    if (!status) status = read_numbers(feb, node, own, fibre);
    return status ? status : lar_feb_notice_others(feb, node, known);
}

lar_status lar_feb_read_trans_iso(lar_feb *feb, const xmlNode *node, lar_fibre *fibre) {
    lar_status status = refuse_calcium(feb, node);
    return status ? status : read_numbers(feb, node, &trans_iso, fibre);
}
