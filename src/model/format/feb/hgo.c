/* FEBio decks: the material "Holzapfel-Gasser-Ogden". See feb.h.
 *
 *     e2                   <mat_axis> says two vectors a and d: e1 runs along a, e2 in their plane
 * on |   / a1            the side of d. The families run at +gamma and -gamma from e1, both with |
 * /                k1, k2 and kappa. Without it e1 and e2 are the axes x and y. | /  gamma
 *      +------- e1         The ground is neo-Hookean of the shear modulus c.
 *        \
 *         \ a2
 */
#include "model/format/feb/feb.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"

static const char TYPE[] = "Holzapfel-Gasser-Ogden";

bool lar_feb_is_hgo(const char *type) {
    return strcmp(type, TYPE) == 0;
}

/* FEBio has four energies of the volume, and this material another one than others unless the deck
 * says which: K/2 ((J^2 - 1)/2 - ln J). It differs from ours in third order of J - 1. */
static lar_status choose_law(lar_feb *feb, const xmlNode *node, lar_law *law) {
    const xmlNode *pressure = lar_feb_child(node, "pressure_model");
    lar_span model = pressure ? lar_feb_text(feb, pressure) : (lar_span){"3", 1};
    *law = LAR_LAW_neo_hookean;
    if (lar_span_equal(model, "Abaqus") || lar_span_equal(model, "2")) return LAR_OK;
    if (lar_span_equal(model, "default") || lar_span_equal(model, "0")) {
        *law = LAR_LAW_mooney_rivlin;
        return LAR_OK;
    }
    if (lar_span_equal(model, "Abaqus (GOH)") || lar_span_equal(model, "3"))
        return lar_feb_notice(feb, pressure ? pressure : node,
                              "%s: Lariat answers a change of volume by K/2 (J - 1)^2 instead of "
                              "K/2 ((J^2 - 1)/2 - ln J), which is equal where the volume changes "
                              "little",
                              TYPE);
    return lar_feb_fail(feb, pressure, LAR_ERROR_UNSUPPORTED,
                        "pressure_model '%.*s' of a material %s is not read; default, Abaqus and "
                        "Abaqus (GOH) are",
                        (int)(model.length < 40 ? model.length : 40), model.at, TYPE);
}

lar_status lar_feb_read_hgo(lar_feb *feb, const xmlNode *node, lar_material *material) {
    static const char known[] = "density c k1 k2 kappa gamma mat_axis pressure_model k";
    static const char *const name[] = {"k1", "k2", "kappa"};
    lar_fibre *fibre = &material->fibre;
    double shear = 0, bulk = 0, gamma = 0;
    *fibre = (lar_fibre){
        .law = LAR_FIBRE_HGO, .isochoric = true, .paired = true, .line = lar_feb_line(node)};
    lar_status status = choose_law(feb, node, &material->law);
    if (!status) status = lar_feb_parameter(feb, node, "c", true, &shear);
    if (!status) status = lar_feb_parameter(feb, node, "k", true, &bulk);
    if (!status) status = lar_feb_parameter(feb, node, "gamma", true, &gamma);
    for (int k = 0; k < 3 && !status; k++)
        status = lar_feb_parameter(feb, node, name[k], true, &fibre->parameter[k]);
    if (status) return status;
    lar_material_from_shear_bulk(material, shear, bulk);
    return lar_feb_notice_others(feb, node, known);
}

/* ---- directions ------------------------------------------------------------------------------ */

lar_status lar_feb_lay_pair(lar_feb *feb, const xmlNode *at, int32_t e, const double a[3],
                            const double d[3]) {
    const xmlNode *material = NULL;
    double gamma = 0;
    for (int i = 0; i < feb->material_count && !material; i++)
        if (feb->material[i].index == feb->model->element_material[e])
            material = feb->material[i].node;
    lar_status status = lar_feb_parameter(feb, material, "gamma", true, &gamma);
    double *const way[2] = {feb->mesh->fibre[e], feb->mesh->second[e]};
    gamma *= 3.14159265358979323846 / 180;
    for (int k = 0; k < 2 && !status; k++) {
        way[k][0] = cos(gamma);
        way[k][1] = k == 0 ? sin(gamma) : -sin(gamma);
        way[k][2] = 0;
        status = lar_feb_turn(feb, at, e, a, d, way[k]);
    }
    return status;
}

/* Corners of an element, counted from 1 as in the deck: a runs from the first to the second, d to
 * the third. */
static lar_status read_corners(lar_feb *feb, const xmlNode *rule, int corner[3]) {
    int64_t id[3];
    const xmlNode *of = lar_feb_child(rule, "local");
    lar_status status = lar_feb_ids(feb, of ? of : rule, id, 3);
    if (status) return status;
    if (id[0] == 0 && id[1] == 0 && id[2] == 0) id[0] = 1, id[1] = 2, id[2] = 4;
    for (int i = 0; i < 3; i++) {
        if (id[i] < 1 || id[i] > 8)
            return lar_feb_fail(feb, rule, LAR_ERROR_FORMAT,
                                "a local <mat_axis> names three corners, of 1 to 8");
        corner[i] = (int)id[i] - 1;
        if (feb->mesh->turned) corner[i] = (corner[i] + 4) % 8; /* lar_mesh_turn */
    }
    return LAR_OK;
}

/* `rule` NULL: along x and y. */
lar_status lar_feb_lay_pairs(lar_feb *feb, const xmlNode *node, const xmlNode *rule, int material) {
    const lar_mesh *mesh = feb->mesh;
    const char *type = rule ? lar_feb_attribute(feb, rule, "type") : "";
    double a[3] = {1, 0, 0}, d[3] = {0, 1, 0};
    int corner[3];
    lar_status status = LAR_OK;
    bool local = rule && type && strcmp(type, "local") == 0;
    if (rule && type && strcmp(type, "user") == 0) return LAR_OK;
    if (rule && !lar_feb_is(rule, "mat_axis"))
        return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                            "a material %s has two families of fibres, which one <fiber> does not "
                            "say; give it a <mat_axis>",
                            TYPE);
    if (local) {
        status = read_corners(feb, rule, corner);
    } else if (rule && type && strcmp(type, "vector") == 0) {
        const xmlNode *first = lar_feb_child(rule, "a"), *other = lar_feb_child(rule, "d");
        if (!first || !other)
            return lar_feb_fail(feb, rule, LAR_ERROR_FORMAT,
                                "a <mat_axis> of type 'vector' needs <a> and <d>; add them");
        status = lar_feb_doubles(feb, first, a, 3);
        if (!status) status = lar_feb_doubles(feb, other, d, 3);
    } else if (rule) {
        return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                            "a <mat_axis> of type '%.40s' is not read; vector, local and user are",
                            type ? type : "");
    }
    for (int32_t e = 0; e < mesh->element_count && !status; e++) {
        if (feb->model->element_material[e] != material) continue;
        const int32_t *at = mesh->element[e];
        if (local) lar_minus(mesh->position[at[corner[1]]], mesh->position[at[corner[0]]], a);
        if (local) lar_minus(mesh->position[at[corner[2]]], mesh->position[at[corner[0]]], d);
        status = lar_feb_lay_pair(feb, rule ? rule : node, e, a, d);
    }
    return status;
}
