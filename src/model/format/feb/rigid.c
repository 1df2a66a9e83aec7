/* FEBio decks: <Rigid>, bodies that are not strained. See feb.h.
 *
 *     <rigid_bc type="rigid_fixed"> <rb>bone</rb> <Rx_dof>1</Rx_dof> ...     Rx Ry Rz Ru Rv Rw
 *     <rigid_bc type="rigid_displacement"> <rb>bone</rb> <dof>z</dof> <value lc="1">-1</value>
 *     <rigid_bc type="rigid_rotation"> <rb>bone</rb> <dof>Ru</dof> <value lc="1">0.5</value>
 *     <rigid_constraint type="fix"> <rb>2</rb> <dofs>Rx,Ry</dofs>             version 3:
 * "prescribe" <rigid_body mat="2"> <fixed bc="x"/> <prescribed bc="Rx"
 * lc="1">1</prescribed>       2.5
 *
 * All that such a body does is prescribed: its nodes move together (lar_screw), first turned about
 * its centre of mass, then along the axes. One that could move by itself is refused. Its elements
 * stay in the mesh, for what touches them; strained they never are, so they may be of any material.
 */
#include "model/format/feb/feb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- which body ------------------------------------------------------------------------------ */

bool lar_feb_is_rigid(lar_feb *feb, const lar_feb_material *material) {
    const char *type = lar_feb_attribute(feb, material->node, "type");
    return type && strcmp(type, "rigid body") == 0;
}

static lar_status add_body(lar_feb *feb, int material, lar_feb_body **body) {
    if (!LAR_GROW(feb->body, feb->body_room, feb->body_count))
        return lar_feb_no_memory(feb, "the rigid bodies");
    *body = &feb->body[feb->body_count++];
    **body = (lar_feb_body){.material = material};
    return LAR_OK;
}

/* The body of a material by its name, or its number. */
static lar_status find_body(lar_feb *feb, const xmlNode *at, const char *name,
                            lar_feb_body **body) {
    int64_t id = -1;
    int found = -1;
    lar_span_int64((lar_span){name, strlen(name)}, &id);
    for (int i = 0; i < feb->material_count && found < 0; i++)
        if (strcmp(feb->material[i].name, name) == 0 || feb->material[i].id == id) found = i;
    if (found < 0 || !lar_feb_is_rigid(feb, &feb->material[found]))
        return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                            "<%s> names '%.60s', which is no material of type rigid body; correct "
                            "the name",
                            lar_feb_name(at), name);
    for (int b = 0; b < feb->body_count; b++)
        if (feb->body[b].material == found) {
            *body = &feb->body[b];
            return LAR_OK;
        }
    return add_body(feb, found, body);
}

static lar_status named_body(lar_feb *feb, const xmlNode *at, lar_feb_body **body) {
    const xmlNode *name;
    lar_status status = lar_feb_need_child(feb, at, "rb", &name);
    if (status) return status;
    const char *word = lar_feb_word(feb, name);
    return word ? find_body(feb, name, word, body) : lar_feb_no_memory(feb, "the rigid bodies");
}

/* ---- what it does ---------------------------------------------------------------------------- */

/* Along x, y, z: 0 to 2; about them: 3 to 5. `old`: Rx, Ry, Rz are turns, as in version 2.5. */
static lar_status way_of(lar_feb *feb, const xmlNode *at, lar_span word, bool old, int *way) {
    static const char *const names[][3] = {{"x", "Rx", "x"},  {"y", "Ry", "y"},  {"z", "Rz", "z"},
                                           {"u", "Ru", "Rx"}, {"v", "Rv", "Ry"}, {"w", "Rw", "Rz"}};
    word = lar_span_trim(word);
    for (*way = 0; *way < 6; ++*way)
        if (lar_span_equal(word, names[*way][old ? 2 : 1]) ||
            (!old && lar_span_equal(word, names[*way][0])))
            return LAR_OK;
    return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                        "'%.*s' is no degree of freedom of a rigid body; they are %s",
                        (int)(word.length < 40 ? word.length : 40), word.at,
                        old ? "x, y, z, Rx, Ry, Rz" : "Rx, Ry, Rz, Ru, Rv, Rw");
}

static lar_status set_way(lar_feb *feb, const xmlNode *at, lar_feb_body *body, int way,
                          double value, int curve) {
    if (body->at[way])
        return lar_feb_fail(feb, at, LAR_ERROR_MODEL,
                            "<%s> says what the rigid body does along or about %c a second time, "
                            "after line %d; leave one of the two",
                            lar_feb_name(at), "xyz"[way % 3], lar_feb_line(body->at[way]));
    body->at[way] = at;
    body->value[way] = value;
    body->curve[way] = curve;
    return LAR_OK;
}

static lar_status read_fixed(lar_feb *feb, const xmlNode *at, lar_feb_body *body) {
    static const char *const names[] = {"Rx_dof", "Ry_dof", "Rz_dof", "Ru_dof", "Rv_dof", "Rw_dof"};
    lar_status status = LAR_OK;
    for (int way = 0; way < 6 && !status; way++) {
        bool set;
        status = lar_feb_flag(feb, at, names[way], false, &set);
        if (!status && set) status = set_way(feb, at, body, way, 0, -1);
    }
    return status ? status
                  : lar_feb_notice_others(feb, at, "rb Rx_dof Ry_dof Rz_dof Ru_dof Rv_dof Rw_dof");
}

static lar_status read_fixed_list(lar_feb *feb, const xmlNode *at, lar_feb_body *body) {
    const xmlNode *dofs;
    lar_span word;
    lar_status status = lar_feb_need_child(feb, at, "dofs", &dofs);
    if (status) return status;
    lar_feb_list list = lar_feb_list_of(feb, dofs);
    while (!status && lar_feb_list_next(&list, &word)) {
        int way;
        status = way_of(feb, dofs, word, false, &way);
        if (!status) status = set_way(feb, at, body, way, 0, -1);
    }
    return status ? status : lar_feb_notice_others(feb, at, "rb dofs");
}

/* What jumps within a contact is thrown. FEBio has it at the end of the first step, and of a static
 * deck only the end counts. */
static lar_status move_slowly(lar_feb *feb, const xmlNode *value, int *curve) {
    static const double PART = 0.05; /* of the deck's time, at least */
    const int index = feb->model->curve_count;
    if (!feb->is_static || !value || lar_feb_attribute(feb, value, "lc")) return LAR_OK;
    lar_curve *ramp = LAR_MODEL_APPEND(feb->model, curve);
    if (!ramp) return lar_feb_no_memory(feb, "a curve");
    *ramp = (lar_curve){.kind = LAR_CURVE_RAMP,
                        .over = fmax(feb->first_step, PART * feb->model->duration)};
    *curve = index;
    return LAR_OK;
}

static lar_status read_prescribed(lar_feb *feb, const xmlNode *at, lar_feb_body *body) {
    const xmlNode *dof, *value = lar_feb_child(at, "value");
    double by = 0;
    int curve = 0, way = 0;
    lar_status status = lar_feb_need_child(feb, at, "dof", &dof);
    if (!status) status = way_of(feb, dof, lar_feb_text(feb, dof), false, &way);
    if (!status) status = lar_feb_scaled(feb, at, "value", &by, 1, &curve);
    if (!status) status = lar_feb_check_flags(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, "rb dof value scale relative");
    if (!status) status = move_slowly(feb, value, &curve);
    if (!status) status = lar_feb_notice_at_once(feb, value ? value : at, by, curve);
    return status ? status : set_way(feb, at, body, way, by, curve);
}

static lar_status read_one(lar_feb *feb, const xmlNode *at) {
    const char *type;
    lar_feb_body *body = NULL;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    const bool fixed = strcmp(type, "rigid_fixed") == 0, fix = strcmp(type, "fix") == 0;
    const bool moved = strcmp(type, "rigid_displacement") == 0 ||
                       strcmp(type, "rigid_rotation") == 0 || strcmp(type, "prescribe") == 0;
    if (!lar_feb_is_any(at, "rigid_bc rigid_constraint") || !(fixed || fix || moved))
        return lar_feb_refuse_type(feb, at,
                                   "<rigid_bc> of types rigid_fixed, rigid_displacement and "
                                   "rigid_rotation: what a rigid body does is prescribed");
    status = named_body(feb, at, &body);
    if (status) return status;
    return fixed ? read_fixed(feb, at, body)
           : fix ? read_fixed_list(feb, at, body)
                 : read_prescribed(feb, at, body);
}

lar_status lar_feb_read_rigid(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *at = lar_feb_first(section); at && !status; at = lar_feb_next(at))
        status = read_one(feb, at);
    return status;
}

lar_status lar_feb_read_rigid_body(lar_feb *feb, const xmlNode *node) {
    const char *name, *dof;
    lar_feb_body *body = NULL;
    lar_status status = lar_feb_need_attribute(feb, node, "mat", &name);
    if (!status) status = find_body(feb, node, name, &body);
    for (xmlNode *at = lar_feb_first(node); at && !status; at = lar_feb_next(at)) {
        double by = 0;
        int curve = -1, way;
        if (!lar_feb_is_any(at, "fixed prescribed"))
            return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                                "<%s> of a rigid body is not read; what it does must be fixed or "
                                "prescribed",
                                lar_feb_name(at));
        status = lar_feb_need_attribute(feb, at, "bc", &dof);
        if (!status) status = way_of(feb, at, (lar_span){dof, strlen(dof)}, true, &way);
        if (!status && lar_feb_is(at, "prescribed")) {
            status = lar_feb_curve_of(feb, at, &curve);
            if (!status) status = lar_feb_doubles(feb, at, &by, 1);
            if (!status) status = move_slowly(feb, at, &curve);
            if (!status) status = lar_feb_notice_at_once(feb, at, by, curve);
        }
        if (!status) status = set_way(feb, at, body, way, by, curve);
    }
    return status;
}

lar_status lar_feb_tie_to_rigid(lar_feb *feb, const xmlNode *at) {
    lar_feb_body *body = NULL;
    lar_node_list nodes = {0};
    lar_status status = named_body(feb, at, &body);
    if (!status) status = lar_feb_notice_others(feb, at, "rb");
    if (!status) status = lar_feb_nodes_of(feb, at, &nodes);
    if (!status && !body->tied)
        body->tied = lar_calloc((size_t)feb->mesh->node_count, sizeof *body->tied);
    if (!status && !body->tied) status = lar_feb_no_memory(feb, "the rigid bodies");
    for (int32_t i = 0; i < nodes.count && !status; i++) body->tied[nodes.node[i]] = 1;
    free(nodes.node);
    return status;
}

/* ---- as supports ----------------------------------------------------------------------------- */

/* The nodes of its elements, and those that are tied to it; their number in list->count. */
static lar_status list_nodes(lar_feb *feb, const lar_feb_body *body, lar_node_list *list) {
    const lar_mesh *mesh = feb->mesh;
    const int index = feb->material[body->material].index;
    uint8_t *mark = lar_calloc((size_t)mesh->node_count, sizeof *mark);
    list->node = lar_calloc((size_t)mesh->node_count, sizeof *list->node);
    for (int32_t e = 0; mark && e < mesh->element_count; e++)
        for (int a = 0; a < 8 && feb->model->element_material[e] == index; a++)
            mark[mesh->element[e][a]] = 1;
    for (int32_t n = 0; mark && list->node && n < mesh->node_count; n++)
        if (mark[n] || (body->tied && body->tied[n])) list->node[list->count++] = n;
    free(mark);
    return mark && list->node ? LAR_OK : lar_feb_no_memory(feb, "the rigid bodies");
}

/* About what it turns: what the deck says, or the middle of its elements. */
static lar_status find_centre(lar_feb *feb, const lar_feb_body *body, double centre[3]) {
    const lar_feb_material *material = &feb->material[body->material];
    const xmlNode *given = lar_feb_child(material->node, "center_of_mass");
    double volume = 0;
    if (given) return lar_feb_doubles(feb, given, centre, 3);
    for (int i = 0; i < 3; i++) centre[i] = 0;
    for (int32_t e = 0; e < feb->mesh->element_count; e++) {
        double corner[8][3];
        if (feb->model->element_material[e] != material->index) continue;
        lar_mesh_corners(feb->mesh, e, corner);
        double part = lar_hexahedron_volume((const double(*)[3])corner);
        volume += part;
        for (int k = 0; k < 24; k++) centre[k % 3] += part / 8 * corner[k / 3][k % 3];
    }
    for (int i = 0; i < 3; i++) centre[i] /= volume;
    return lar_feb_notice(feb, material->node,
                          "there is no <center_of_mass>: the rigid body '%.60s' turns about the "
                          "middle of its elements, (%.4g, %.4g, %.4g)",
                          material->name, centre[0], centre[1], centre[2]);
}

/* The turn first, then the ways along the axes. */
static lar_status make_screws(lar_feb *feb, const lar_feb_body *body, lar_move *move) {
    int turns = 0;
    lar_status status = LAR_OK;
    move->screw = lar_calloc(LAR_SCREWS_MAX, sizeof *move->screw);
    if (!move->screw) return lar_feb_no_memory(feb, "the rigid bodies");
    for (int k = 0; k < 6 && !status; k++) {
        const int way = (k + 3) % 6;
        if (body->curve[way] < 0) continue;
        lar_screw *screw = &move->screw[move->screw_count++];
        screw->axis[way % 3] = 1;
        screw->curve = body->curve[way];
        *(way < 3 ? &screw->slide : &screw->angle) = body->value[way];
        if (way > 2) status = find_centre(feb, body, screw->point);
        if (way > 2 && ++turns > 1)
            return lar_feb_fail(feb, body->at[way], LAR_ERROR_UNSUPPORTED,
                                "a rigid body that turns about several axes is not read; give it "
                                "one, or take the mesh into a scene (rigid)");
    }
    return status;
}

static lar_status hold_body(lar_feb *feb, const lar_feb_body *body) {
    static const char *const free_ways[] = {"along x", "along y", "along z",
                                            "about x", "about y", "about z"};
    const lar_feb_material *material = &feb->material[body->material];
    lar_move move = {.axes = LAR_AXIS_ALL};
    bool moves = false;
    for (int way = 0; way < 6; way++) {
        if (!body->at[way])
            return lar_feb_fail(feb, material->node, LAR_ERROR_UNSUPPORTED,
                                "the rigid body '%.60s' may move %s by itself, which Lariat's do "
                                "not: all that they do is prescribed; fix it (rigid_fixed), or "
                                "make it of a stiff material",
                                material->name, free_ways[way]);
        moves = moves || body->curve[way] >= 0;
    }
    lar_status status = list_nodes(feb, body, &move.nodes);
    if (!status && moves) status = make_screws(feb, body, &move);
    if (!status && moves) move.curve = move.screw[0].curve;
    if (!status)
        status = lar_feb_hold(feb, body->at[0], LAR_AXIS_ALL, &move.nodes, moves ? &move : NULL);
    lar_move *to = status || !moves ? NULL : LAR_MODEL_APPEND(feb->model, move);
    lar_fix *fix = status || moves ? NULL : LAR_MODEL_APPEND(feb->model, fix);
    if (to) {
        *to = move;
    } else if (fix) {
        *fix = (lar_fix){move.nodes, LAR_AXIS_ALL};
    } else {
        free(move.nodes.node);
        free(move.screw);
        if (!status) status = lar_feb_no_memory(feb, "the rigid bodies");
    }
    return status;
}

lar_status lar_feb_hold_rigid(lar_feb *feb) {
    lar_status status = LAR_OK;
    for (int i = 0; i < feb->material_count && !status; i++) {
        lar_feb_body *body = NULL;
        if (feb->material[i].index < 0 || !lar_feb_is_rigid(feb, &feb->material[i])) continue;
        status = find_body(feb, feb->material[i].node, feb->material[i].name, &body);
        if (!status) status = hold_body(feb, body);
    }
    return status;
}

/* ---- what they are made of ------------------------------------------------------------------- */

lar_status lar_feb_fill_rigid(lar_feb *feb) {
    const lar_material *like = NULL;
    for (int i = 0; i < feb->material_count && !like; i++)
        if (feb->material[i].index >= 0 && !lar_feb_is_rigid(feb, &feb->material[i]))
            like = &feb->model->material[feb->material[i].index];
    for (int i = 0; i < feb->material_count; i++) {
        if (feb->material[i].index < 0 || !lar_feb_is_rigid(feb, &feb->material[i])) continue;
        if (!like)
            return lar_feb_fail(feb, feb->material[i].node, LAR_ERROR_UNSUPPORTED,
                                "all elements are of rigid bodies; nothing can be computed");
        lar_material *material = &feb->model->material[feb->material[i].index];
        material->law = LAR_LAW_neo_hookean;
        material->density = like->density;
        lar_material_from_shear_bulk(material, lar_material_instant_shear(like),
                                     lar_material_instant_bulk(like));
    }
    return LAR_OK;
}

/* Softer they cannot be made instead: what is followed to rest waits for the slowest waves. */
lar_status lar_feb_weigh_rigid(lar_feb *feb) {
    enum { HEAVIER = 100 };
    lar_status status = LAR_OK;
    for (int i = 0; i < feb->material_count && !status; i++) {
        if (feb->material[i].index < 0 || !lar_feb_is_rigid(feb, &feb->material[i])) continue;
        feb->model->material[feb->material[i].index].density *= HEAVIER;
        status = lar_feb_notice(feb, feb->material[i].node,
                                "the rigid body '%.60s' moves as prescribed; its elements are "
                                "never strained, and count as %d times as heavy as others%s",
                                feb->material[i].name, HEAVIER,
                                feb->weightless || !feb->is_static
                                    ? ""
                                    : ", also for body loads: reactions there hold that weight");
    }
    return status;
}
