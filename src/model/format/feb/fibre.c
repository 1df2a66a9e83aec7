/* FEBio decks: fibres of materials, and along what they run. See feb.h.
 *
 * A material with fibres is a "trans iso" one, or a "solid mixture" of a law and one family. What
 * says the direction stands in it or in the material around it, as <fiber> or <mat_axis>, of which
 * the first axis counts, or which turns a <fiber>; or element by element in <MeshData>.
 */
#include "model/format/feb/feb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "model/mesh/id_map.h"

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

/* The same total stress in both forms: FEBio's uncoupled one is no deviator. */
lar_status lar_feb_read_active(lar_feb *feb, const xmlNode *node, const char *type,
                               lar_fibre *fibre) {
    static const char known[] = "density k pressure_model T0 fiber mat_axis";
    const struct active_type *active = find_active(type);
    const xmlNode *value = lar_feb_child(node, "T0");
    double stress = 0;
    lar_status status = value && lar_feb_attribute(feb, value, "lc")
                            ? lar_feb_doubles(feb, value, &stress, 1)
                            : lar_feb_parameter(feb, node, "T0", true, &stress);
    fibre->along = active->along * stress;
    fibre->across = active->across * stress;
    if (!fibre->line) fibre->line = lar_feb_line(node);
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

static lar_status refuse_angles(lar_feb *feb, const xmlNode *node) {
    const xmlNode *angle = lar_feb_child(node, "theta");
    if (!angle) angle = lar_feb_child(node, "phi");
    if (!angle) return LAR_OK;
    return lar_feb_fail(feb, angle, LAR_ERROR_UNSUPPORTED,
                        "<%s> of fibres is not read; say along what they run as <fiber>",
                        (const char *)angle->name);
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
    static const char known[] =
        "density k pressure_model ksi alpha beta c3 c4 c5 lambda fiber mat_axis E lam0 mu";
    lar_status status = refuse_angles(feb, node);
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

/* ---- directions ------------------------------------------------------------------------------ */

static lar_status refuse_second(lar_feb *feb, const xmlNode *rule, const xmlNode *first) {
    return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                        "a second direction within one material; it has one family of fibres, keep "
                        "the first (line %d)",
                        lar_feb_line(first));
}

/* What a material of any depth has of <fiber> or of <mat_axis>. */
static lar_status find_rule(lar_feb *feb, const xmlNode *node, const char *name,
                            const xmlNode **rule) {
    const xmlNode *own = lar_feb_child(node, name);
    if (own && *rule) return refuse_second(feb, own, *rule);
    if (own) *rule = own;
    lar_status status = LAR_OK;
    for (const xmlNode *inner = lar_feb_first(node); inner && !status; inner = lar_feb_next(inner))
        if (lar_feb_is(inner, "solid") || lar_feb_is(inner, "elastic"))
            status = find_rule(feb, inner, name, rule);
    return status;
}

/* Both: axes turn the direction of what stands in the same material or within it, not of another
 * part. */
static lar_status find_rules(lar_feb *feb, const xmlNode *node, const xmlNode **fiber,
                             const xmlNode **axes) {
    *fiber = *axes = NULL;
    lar_status status = find_rule(feb, node, "fiber", fiber);
    if (!status) status = find_rule(feb, node, "mat_axis", axes);
    if (status || !*fiber || !*axes) return status;
    const xmlNode *at = (*fiber)->parent;
    while (at && at != (*axes)->parent) at = at->parent;
    return at ? LAR_OK : refuse_second(feb, *axes, *fiber);
}

/* One direction for all: a vector, two angles, or the first of two vectors. */
static lar_status read_constant(lar_feb *feb, const xmlNode *rule, const char *type, double a[3]) {
    double theta, phi;
    const xmlNode *of = lar_feb_child(rule, strcmp(type, "vector") == 0 ? "vector" : "theta");
    if (strcmp(type, "vector") == 0) {
        if (!of) of = lar_feb_child(rule, "a");
        return lar_feb_doubles(feb, of ? of : rule, a, 3);
    }
    lar_status status = lar_feb_parameter(feb, rule, "theta", true, &theta);
    if (!status) status = lar_feb_parameter(feb, rule, "phi", true, &phi);
    if (!status) status = lar_feb_notice_others(feb, rule, "theta phi");
    if (status) return status;
    const double degree = 3.14159265358979323846 / 180;
    a[0] = cos(theta * degree) * sin(phi * degree);
    a[1] = sin(theta * degree) * sin(phi * degree);
    a[2] = cos(phi * degree);
    return LAR_OK;
}

/* "local": from one corner of an element to another, counted from 1 as in the deck. */
static lar_status read_corners(lar_feb *feb, const xmlNode *rule, int corner[2]) {
    int64_t id[3];
    const xmlNode *of = lar_feb_child(rule, "local");
    int count = lar_feb_is(rule, "mat_axis") ? 3 : 2;
    lar_status status = lar_feb_ids(feb, of ? of : rule, id, count);
    if (status) return status;
    if (id[0] == 0 && id[1] == 0) id[0] = 1, id[1] = 2; /* FEBio's default, of axes 1, 2, 4 */
    for (int i = 0; i < 2; i++) {
        if (id[i] < 1 || id[i] > 8 || id[0] == id[1])
            return lar_feb_fail(feb, rule, LAR_ERROR_FORMAT,
                                "a local direction runs from one corner to another, of 1 to 8");
        corner[i] = (int)id[i] - 1;
        if (feb->mesh->turned) corner[i] = (corner[i] + 4) % 8; /* lar_mesh_turn */
    }
    return LAR_OK;
}

/* "spherical" and "cylindrical": `vector`, turned as the x axis is to the ray from the centre, or
 * from the axis, to an element. */
typedef struct round_rule {
    double center[3], axis[3], vector[3]; /* axis 0: spherical */
} round_rule;

static lar_status read_round(lar_feb *feb, const xmlNode *rule, bool cylindrical, round_rule *to) {
    *to = (round_rule){.axis = {0, 0, cylindrical}, .vector = {1, 0, 0}};
    const xmlNode *center = lar_feb_child(rule, "center"), *axis = lar_feb_child(rule, "axis"),
                  *vector = lar_feb_child(rule, "vector");
    if (!center && lar_feb_text(feb, rule).length) center = rule; /* version 2.5 */
    lar_status status = center ? lar_feb_doubles(feb, center, to->center, 3) : LAR_OK;
    if (!status && axis && cylindrical) status = lar_feb_doubles(feb, axis, to->axis, 3);
    if (!status && vector) status = lar_feb_doubles(feb, vector, to->vector, 3);
    double length = lar_length(to->axis);
    if (!status && cylindrical && !(length > 0))
        return lar_feb_fail(feb, rule, LAR_ERROR_FORMAT,
                            "the axis of a cylindrical direction has no length; correct it");
    for (int i = 0; i < 3 && cylindrical; i++) to->axis[i] /= length;
    return status;
}

/* What the shortest turn from the x axis to `ray` makes of the vector; 0 without a ray. */
static void lay_round(const round_rule *rule, const double at[3], double out[3]) {
    double ray[3], turn[3], across[3];
    lar_minus(at, rule->center, ray);
    double along = lar_dot(ray, rule->axis);
    for (int i = 0; i < 3; i++) ray[i] -= along * rule->axis[i];
    double length = lar_length(ray);
    if (!(length > 0)) return;
    for (int i = 0; i < 3; i++) ray[i] /= length;
    lar_cross((const double[]){1, 0, 0}, ray, turn);
    lar_cross(turn, rule->vector, across);
    double bend = 1 + ray[0], share = bend > 0 ? lar_dot(turn, rule->vector) / bend : 0;
    for (int i = 0; i < 3; i++) out[i] = ray[0] * rule->vector[i] + across[i] + share * turn[i];
}

static void centre_of(const lar_mesh *mesh, int32_t e, double centre[3]) {
    for (int i = 0; i < 3; i++) {
        centre[i] = 0;
        for (int a = 0; a < 8; a++) centre[i] += 0.125 * mesh->position[mesh->element[e][a]][i];
    }
}

static lar_status need_directions(lar_feb *feb) {
    lar_mesh *mesh = feb->mesh;
    bool paired = false;
    for (int i = 0; i < feb->model->material_count; i++)
        paired = paired || feb->model->material[i].fibre.paired;
    if (!mesh->fibre) mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    if (!mesh->second && paired)
        mesh->second = lar_calloc((size_t)mesh->element_count, sizeof *mesh->second);
    return mesh->fibre && (mesh->second || !paired)
               ? LAR_OK
               : lar_feb_no_memory(feb, "the directions of fibres");
}

lar_status lar_feb_turn(lar_feb *feb, const xmlNode *at, int32_t e, const double a[3],
                        const double d[3], double direction[3]) {
    double e2[3], e3[3];
    lar_cross(a, d, e3);
    lar_cross(e3, a, e2);
    const double length[3] = {lar_length(a), lar_length(e2), lar_length(e3)};
    double share[3];
    for (int i = 0; i < 3; i++) {
        if (!(length[i] > 0) || !isfinite(length[i]))
            return lar_feb_fail(feb, at, LAR_ERROR_MODEL,
                                "the two vectors of <mat_axis> of element %lld span no plane; give "
                                "two that are not parallel",
                                (long long)feb->mesh->element_id[e]);
        share[i] = direction[i] / length[i];
    }
    for (int i = 0; i < 3; i++)
        direction[i] = share[0] * a[i] + share[1] * e2[i] + share[2] * e3[i];
    return LAR_OK;
}

/* A map is read where <MeshData> says of it that it is one of directions. */
static lar_status check_map(lar_feb *feb, const xmlNode *rule) {
    const xmlNode *section = lar_feb_child(feb->root, "MeshData");
    const xmlNode *data = section ? lar_feb_first(section) : NULL;
    while (data && !lar_feb_is_direction(feb, data)) data = lar_feb_next(data);
    if (data) return LAR_OK;
    lar_span name = lar_feb_text(feb, rule);
    return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                        "the map '%.*s' of directions is not read; give them as <ElementData "
                        "type=\"%s\">",
                        (int)(name.length < 60 ? name.length : 60), name.at,
                        (const char *)rule->name);
}

/* The directions of one material's elements, but for those that are `done`. A direction that an
 * element has already is one in the axes. */
static lar_status lay(lar_feb *feb, const xmlNode *rule, int material, const bool *done) {
    lar_mesh *mesh = feb->mesh;
    const char *type = lar_feb_attribute(feb, rule, "type");
    if (!type && lar_feb_is(rule, "fiber")) type = "vector";
    double a[3] = {0}, d[3], way[3] = {0};
    int corner[2];
    round_rule around;
    bool local = type && strcmp(type, "local") == 0;
    bool cylindrical = type && strcmp(type, "cylindrical") == 0;
    bool round = cylindrical || (type && strcmp(type, "spherical") == 0);
    if (type && strcmp(type, "map") == 0) return check_map(feb, rule);
    if (type && strcmp(type, "user") == 0) return LAR_OK;
    if (!type || (!local && !round && strcmp(type, "vector") != 0 && strcmp(type, "angles") != 0))
        return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                            "a direction of type '%.40s' is not read; vector, local, angles, "
                            "spherical, cylindrical and user are",
                            type ? type : "");
    lar_status status = need_directions(feb);
    if (!status)
        status = local   ? read_corners(feb, rule, corner)
                 : round ? read_round(feb, rule, cylindrical, &around)
                         : read_constant(feb, rule, type, a);
    const xmlNode *second = lar_feb_child(rule, "d");
    if (!status && second) status = lar_feb_doubles(feb, second, d, 3);
    for (int32_t e = 0; e < mesh->element_count && !status; e++) {
        if (feb->model->element_material[e] != material || done[e]) continue;
        if (lar_length(mesh->fibre[e]) > 0) {
            if (!second)
                return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                                    "a <mat_axis> of type '%.40s' around a <fiber> is not read; "
                                    "give it the type vector, with <a> and <d>",
                                    type);
            status = lar_feb_turn(feb, rule, e, a, d, mesh->fibre[e]);
            continue;
        }
        if (round) {
            centre_of(mesh, e, a);
            lay_round(&around, a, way);
        } else if (local)
            lar_minus(mesh->position[mesh->element[e][corner[1]]],
                      mesh->position[mesh->element[e][corner[0]]], way);
        memcpy(mesh->fibre[e], round || local ? way : a, sizeof a);
    }
    return status;
}

/* ---- <MeshData> ------------------------------------------------------------------------------ */

/* The ids of a set or part in the order of the deck; lid counts in it from 1. */
typedef struct id_list {
    int64_t *id;
    size_t count, room;
} id_list;

static lar_status list_ids(lar_feb *feb, const xmlNode *set, id_list *list) {
    lar_status status = LAR_OK;
    xmlNode *child = lar_feb_first(set);
    for (; child && !status; child = lar_feb_next(child)) {
        if (!LAR_GROW(list->id, list->room, list->count)) return lar_feb_no_memory(feb, "a set");
        status = lar_feb_id_attribute(feb, child, "id", &list->id[list->count++]);
    }
    if (list->count > 0 || status) return status;
    lar_feb_list text = lar_feb_list_of(feb, set);
    for (lar_span item; lar_feb_list_next(&text, &item);) {
        if (!LAR_GROW(list->id, list->room, list->count)) return lar_feb_no_memory(feb, "a set");
        if (!lar_span_int64(item, &list->id[list->count++]))
            return lar_feb_fail(feb, set, LAR_ERROR_FORMAT, "an entry of the set is no id");
    }
    return LAR_OK;
}

/* The element set of that name, or the part; NULL: there is none. */
static const xmlNode *find_elements(lar_feb *feb, const char *name) {
    const xmlNode *section = lar_feb_child(feb->root, "Mesh"), *part = NULL;
    xmlNode *block = section ? lar_feb_first(section) : NULL;
    for (; block; block = lar_feb_next(block)) {
        const char *found = lar_feb_attribute(feb, block, "name");
        if (!found || strcmp(found, name) != 0) continue;
        if (lar_feb_is(block, "ElementSet")) return block;
        if (lar_feb_is(block, "Elements")) part = block;
    }
    return part;
}

/* Axes mark their elements as `done`. */
static lar_status read_entries(lar_feb *feb, const xmlNode *data, const id_list *list,
                               const lar_id_map *map, bool axes, bool *done) {
    lar_status status = LAR_OK;
    for (xmlNode *entry = lar_feb_first(data); entry && !status; entry = lar_feb_next(entry)) {
        int64_t lid;
        double a[3], d[3];
        const xmlNode *first = lar_feb_child(entry, "a"), *second = lar_feb_child(entry, "d");
        status = lar_feb_id_attribute(feb, entry, "lid", &lid);
        if (!status) status = lar_feb_doubles(feb, first ? first : entry, a, 3);
        if (status) return status;
        int32_t e =
            lid >= 1 && (uint64_t)lid <= list->count ? lar_id_map_find(map, list->id[lid - 1]) : -1;
        if (e < 0)
            return lar_feb_fail(feb, entry, LAR_ERROR_FORMAT,
                                "lid %lld is no element of its set, which has %zu", (long long)lid,
                                list->count);
        if (axes && done[e])
            return lar_feb_fail(feb, entry, LAR_ERROR_FORMAT,
                                "a second <mat_axis> for element %lld; keep one",
                                (long long)feb->mesh->element_id[e]);
        done[e] = axes;
        const bool paired = lar_model_material_of(feb->model, e)->fibre.paired;
        double *fibre = feb->mesh->fibre[e];
        if (!paired && (!axes || !(lar_length(fibre) > 0))) {
            memcpy(fibre, a, sizeof a);
            continue;
        }
        if (!second)
            return lar_feb_fail(feb, entry, LAR_ERROR_FORMAT,
                                "element %lld has two families of fibres, or one along a direction "
                                "in its axes; give it <a> and <d>",
                                (long long)feb->mesh->element_id[e]);
        status = lar_feb_doubles(feb, second, d, 3);
        if (!status)
            status = paired ? lar_feb_lay_pair(feb, entry, e, a, d)
                            : lar_feb_turn(feb, entry, e, a, d, fibre);
    }
    return status;
}

static lar_status read_data(lar_feb *feb, const xmlNode *data, bool axes, bool *done) {
    const lar_mesh *mesh = feb->mesh;
    const char *name;
    lar_status status = lar_feb_need_attribute(feb, data, "elem_set", &name);
    if (status) return status;
    if (lar_feb_attribute(feb, data, "generator"))
        return lar_feb_fail(feb, data, LAR_ERROR_UNSUPPORTED,
                            "directions that a generator makes are not read; list them");
    const xmlNode *set = find_elements(feb, name);
    if (!set)
        return lar_feb_fail(feb, data, LAR_ERROR_FORMAT,
                            "<ElementData> names the element set '%.100s', which the mesh does not "
                            "define; define it or correct the name",
                            name);
    id_list list = {0};
    lar_id_map map = {0};
    lar_id_clash clash;
    status = need_directions(feb);
    if (!status && !lar_id_map_build(&map, mesh->element_id, mesh->element_count,
                                     sizeof *mesh->element_id, &clash))
        status = lar_feb_no_memory(feb, "the directions of fibres");
    if (!status) status = list_ids(feb, set, &list);
    if (!status) status = read_entries(feb, data, &list, &map, axes, done);
    lar_id_map_clear(&map);
    free(list.id);
    return status;
}

static bool has_type(lar_feb *feb, const xmlNode *data, const char *wanted) {
    const char *type = lar_feb_attribute(feb, data, "type");
    if (!type) type = lar_feb_attribute(feb, data, "var"); /* version 3.0 */
    return lar_feb_is(data, "ElementData") && type && strcmp(type, wanted) == 0;
}

bool lar_feb_is_direction(lar_feb *feb, const xmlNode *data) {
    return has_type(feb, data, "fiber") || has_type(feb, data, "mat_axis");
}

static lar_status read_mesh_data(lar_feb *feb, bool axes, bool *done) {
    const xmlNode *section = lar_feb_child(feb->root, "MeshData");
    xmlNode *data = section ? lar_feb_first(section) : NULL;
    lar_status status = LAR_OK;
    for (; data && !status && lar_model_fibrous(feb->model); data = lar_feb_next(data))
        if (has_type(feb, data, axes ? "mat_axis" : "fiber"))
            status = read_data(feb, data, axes, done);
    return status;
}

/* What materials say, by <fiber> or by <mat_axis>. */
static lar_status read_rules(lar_feb *feb, bool axes, const bool *done) {
    lar_status status = LAR_OK;
    for (int i = 0; i < feb->material_count && !status; i++) {
        const lar_feb_material *entry = &feb->material[i];
        const xmlNode *fiber, *turned;
        if (entry->index < 0 || !lar_fibre_directed(&feb->model->material[entry->index].fibre))
            continue;
        status = find_rules(feb, entry->node, &fiber, &turned);
        const xmlNode *rule = axes ? turned : fiber;
        if (status) return status;
        if (!feb->model->material[entry->index].fibre.paired) {
            status = rule ? lay(feb, rule, entry->index, done) : LAR_OK;
        } else if (!axes) {
            status = need_directions(feb);
            if (!status)
                status = lar_feb_lay_pairs(feb, entry->node, fiber ? fiber : turned, entry->index);
        }
    }
    return status;
}

/* As in FEBio a direction is one in the axes of the material, and both may be said for a material
 * or for each of its elements, which counts before. So first directions, then axes, which turn
 * them; without a direction fibres run along the first axis. */
lar_status lar_feb_lay_fibres(lar_feb *feb) {
    feb->model->fibre_remedy = "as <fiber> of its material or in <ElementData> of type fiber";
    bool *done = lar_calloc((size_t)feb->mesh->element_count, sizeof *done);
    lar_status status =
        done ? read_rules(feb, false, done) : lar_feb_no_memory(feb, "the directions of fibres");
    if (!status) status = read_mesh_data(feb, false, done);
    if (!status) status = read_mesh_data(feb, true, done);
    if (!status) status = read_rules(feb, true, done);
    free(done);
    return status;
}
