/* FEBio decks: <Loads>. See feb.h.
 *
 * Signs, as FEBio has them. A pressure p gives the traction -p n, with n the normal that the
 * order of the face's corners makes (right-hand rule): positive pushes against it. A body load b
 * gives the force -rho b per volume: a deck writes z = 9.81 for gravity that pulls downwards, so
 * Lariat's gravity is -b. Tractions, and pressures that are linear, act on the faces at rest: each
 * node gets its share of them as a force.
 */
#include "model/format/feb/feb.h"

#include <stdlib.h>
#include <string.h>

#include "model/mesh/faces.h"

/* The force vector and curve of a nodal load of either form. */
static lar_status read_nodal_force(lar_feb *feb, const xmlNode *at, const char *type,
                                   double force[3], int *curve) {
    const xmlNode *dof;
    if (strcmp(type, "nodal_force") == 0) return lar_feb_scaled(feb, at, "value", force, 3, curve);
    int axis = 0;
    lar_status status = lar_feb_need_child(feb, at, "dof", &dof);
    if (!status) status = lar_feb_axis_of(feb, dof, lar_feb_text(feb, dof), &axis);
    if (!status && axis > 2) return LAR_OK; /* of shells */
    return status ? status : lar_feb_scaled(feb, at, "value", &force[axis], 1, curve);
}

static lar_status read_nodal_load(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "value dof scale relative shell_bottom";
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    if (strcmp(type, "nodal_force") != 0 && strcmp(type, "nodal_load") != 0)
        return lar_feb_refuse_type(feb, at, "nodal_force and nodal_load");
    lar_nodal_load entry = {0};
    status = read_nodal_force(feb, at, type, entry.force, &entry.curve);
    if (!status) status = lar_feb_check_flags(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    if (!status) status = lar_feb_nodes_of(feb, at, &entry.nodes);
    lar_nodal_load *load = status ? NULL : LAR_MODEL_APPEND(feb->model, load);
    if (!status && !load) status = lar_feb_no_memory(feb, "the loads");
    if (status) {
        free(entry.nodes.node);
        return status;
    }
    *load = entry;
    return LAR_OK;
}

/* +1 when the corners go round the face as lar_face_node does (normal outwards), -1 when the
 * other way, 0 when they do not go round it. */
static int winding(const lar_mesh *mesh, int32_t face, const int64_t corner[4]) {
    const int32_t *element = mesh->element[face / 6];
    int64_t own[4];
    for (int a = 0; a < 4; a++) own[a] = mesh->node_id[element[lar_face_node[face % 6][a]]];
    for (int a = 0; a < 4; a++) {
        if (own[a] != corner[0]) continue;
        if (own[(a + 2) % 4] != corner[2]) return 0;
        if (own[(a + 1) % 4] == corner[1] && own[(a + 3) % 4] == corner[3]) return 1;
        if (own[(a + 3) % 4] == corner[1] && own[(a + 1) % 4] == corner[3]) return -1;
    }
    return 0;
}

/* Sorts the faces of a surface by winding: those outwards to the front of `face`, the others
 * behind. The mesh's set has the faces in the order of the file. */
static lar_status split_by_winding(lar_feb *feb, const xmlNode *surface, const lar_set *set,
                                   int32_t *face, int32_t *outward_count) {
    int32_t i = 0, front = 0, back = set->count;
    for (xmlNode *quad = lar_feb_first(surface); quad; quad = lar_feb_next(quad), i++) {
        int64_t corner[4];
        lar_status status = lar_feb_ids(feb, quad, corner, 4);
        if (status) return status;
        int way = i < set->count ? winding(feb->mesh, set->index[i], corner) : 0;
        if (way == 0)
            return lar_feb_fail(feb, quad, LAR_ERROR_FORMAT,
                                "this face stands twice in its surface, or its corners do not go "
                                "round it; correct the surface");
        face[way > 0 ? front++ : --back] = set->index[i];
    }
    *outward_count = front;
    return LAR_OK;
}

/* Appends `count` faces with one pressure; copies them. */
static lar_status add_pressure(lar_feb *feb, const int32_t *face, int32_t count, double pressure,
                               int curve) {
    if (count == 0) return LAR_OK;
    int32_t *copy = lar_calloc((size_t)count, sizeof *copy);
    lar_pressure_load *load = copy ? LAR_MODEL_APPEND(feb->model, pressure) : NULL;
    if (!load) {
        free(copy);
        return lar_feb_no_memory(feb, "the pressures");
    }
    memcpy(copy, face, (size_t)count * sizeof *copy);
    *load = (lar_pressure_load){count, copy, pressure, curve};
    return LAR_OK;
}

static lar_status add_node_load(lar_feb *feb, int32_t node, const double force[3], int curve) {
    int32_t *only = lar_calloc(1, sizeof *only);
    lar_nodal_load *load = only ? LAR_MODEL_APPEND(feb->model, load) : NULL;
    if (!load) {
        free(only);
        return lar_feb_no_memory(feb, "the loads");
    }
    *only = node;
    *load = (lar_nodal_load){.nodes = {1, only}, .curve = curve};
    memcpy(load->force, force, sizeof load->force);
    return LAR_OK;
}

/* Dead forces of faces, of which the first ones are listed outwards: a traction, or (NULL) a
 * pressure. */
static lar_status add_dead(lar_feb *feb, const int32_t *face, int32_t count, int32_t outward,
                           const double *traction, double pressure, int curve) {
    const lar_mesh *mesh = feb->mesh;
    double(*share)[4] = lar_calloc((size_t)mesh->node_count, sizeof *share);
    if (!share) return lar_feb_no_memory(feb, "the loads");
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < count; i++) lar_face_share(mesh, face[i], i < outward ? 1 : -1, share);
    for (int32_t n = 0; n < mesh->node_count && !status; n++) {
        double force[3];
        for (int i = 0; i < 3; i++)
            force[i] = traction ? share[n][3] * traction[i] : -pressure * share[n][i];
        if (share[n][3] > 0) status = add_node_load(feb, n, force, curve);
    }
    free(share);
    return status;
}

static lar_status add_pressures(lar_feb *feb, const xmlNode *at, const char *name, double pressure,
                                int curve, bool linear) {
    const lar_set *set = lar_mesh_find_set(feb->mesh, name, LAR_SET_FACES);
    const xmlNode *surface = lar_feb_find_surface(feb, name);
    if (!set || !surface) return lar_feb_no_set(feb, at, "surface", name);
    int32_t *face = lar_calloc((size_t)set->count, sizeof *face), outward = 0;
    if (!face) return lar_feb_no_memory(feb, "the pressures");
    const int32_t count = set->count;
    lar_status status = split_by_winding(feb, surface, set, face, &outward);
    if (!status && linear) {
        status = add_dead(feb, face, count, outward, NULL, pressure, curve);
    } else if (!status) {
        status = add_pressure(feb, face, outward, pressure, curve);
        if (!status) status = add_pressure(feb, face + outward, count - outward, -pressure, curve);
    }
    if (!status && outward < count)
        status = lar_feb_notice(feb, surface,
                                "%d faces of surface '%.100s' are listed with their normals into "
                                "the body; their pressure changes sign, as in FEBio",
                                (int)(count - outward), name);
    free(face);
    return status;
}

static lar_status read_pressure(lar_feb *feb, const xmlNode *at, const char *surface) {
    static const char known[] = "pressure linear symmetric_stiffness shell_bottom";
    const xmlNode *value;
    int curve = 0;
    double pressure = 0.0;
    bool linear = false;
    lar_status status = lar_feb_need_child(feb, at, "pressure", &value);
    if (!status) status = lar_feb_curve_of(feb, value, &curve);
    if (!status) status = lar_feb_doubles(feb, value, &pressure, 1);
    if (!status) status = lar_feb_check_flags(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    if (!status) status = lar_feb_flag(feb, at, "linear", false, &linear);
    return status ? status : add_pressures(feb, at, surface, pressure, curve, linear);
}

/* A dead load per area at rest, `traction` times `scale`: FEBio's with `linear`. */
static lar_status read_traction(lar_feb *feb, const xmlNode *at, const char *surface) {
    static const char known[] = "traction scale linear shell_bottom";
    double traction[3];
    int curve = 0;
    bool linear;
    lar_status status = lar_feb_flag(feb, at, "linear", false, &linear);
    if (!status && !linear)
        status = lar_feb_notice(feb, at,
                                "the traction acts on the area at rest, as with <linear>1</linear>;"
                                " FEBio's goes with the area of the deformed faces");
    if (!status) status = lar_feb_scaled(feb, at, "traction", traction, 3, &curve);
    if (!status) status = lar_feb_check_flags(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    const lar_set *set = status ? NULL : lar_mesh_find_set(feb->mesh, surface, LAR_SET_FACES);
    if (!status && !set) return lar_feb_no_set(feb, at, "surface", surface);
    return status ? status : add_dead(feb, set->index, set->count, 0, traction, 0, curve);
}

static lar_status read_surface_load(lar_feb *feb, const xmlNode *at) {
    const char *type, *surface;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    bool pressure = strcmp(type, "pressure") == 0;
    if (!pressure && strcmp(type, "traction") != 0)
        return lar_feb_refuse_type(feb, at, "pressure and traction");
    status = lar_feb_need_attribute(feb, at, "surface", &surface);
    if (status) return status;
    return pressure ? read_pressure(feb, at, surface) : read_traction(feb, at, surface);
}

/* Adds an acceleration -value on one axis. */
static lar_status add_gravity(lar_feb *feb, const xmlNode *at, int axis, double value, int curve) {
    lar_model *model = feb->model;
    if (value == 0.0 && model->gravity[axis] != 0.0) return LAR_OK;
    if (model->gravity[axis] != 0.0 && model->gravity_curve[axis] != curve)
        return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                            "a second body load acts along %c with another load curve; join the "
                            "two into one",
                            "xyz"[axis]);
    model->gravity[axis] -= value;
    model->gravity_curve[axis] = curve;
    return LAR_OK;
}

/* <x>, <y>, <z> with a curve each, or <force> (version 4, "body force") with one. */
static lar_status read_body_values(lar_feb *feb, const xmlNode *at) {
    static const char *const names[] = {"x", "y", "z"};
    const xmlNode *vector = lar_feb_child(at, "force");
    double value[3] = {0};
    int curve = 0;
    lar_status status = LAR_OK;
    if (vector) {
        status = lar_feb_curve_of(feb, vector, &curve);
        if (!status) status = lar_feb_doubles(feb, vector, value, 3);
        for (int i = 0; i < 3 && !status; i++)
            status = add_gravity(feb, vector, i, value[i], curve);
        return status;
    }
    int found = 0;
    for (int i = 0; i < 3 && !status; i++) {
        const xmlNode *child = lar_feb_child(at, names[i]);
        if (!child) continue;
        found++;
        status = lar_feb_curve_of(feb, child, &curve);
        if (!status) status = lar_feb_doubles(feb, child, value, 1);
        if (!status) status = add_gravity(feb, child, i, value[0], curve);
    }
    if (!status && !found)
        status = lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                              "<body_load> has neither <x>, <y>, <z> nor <force>; add them");
    return status;
}

static lar_status read_body_load(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "x y z force";
    const char *type, *part = lar_feb_attribute(feb, at, "elem_set");
    bool whole = true;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    if (strcmp(type, "const") != 0 && strcmp(type, "gravity") != 0 &&
        strcmp(type, "body force") != 0)
        return lar_feb_refuse_type(feb, at, "const, gravity and body force");
    status = lar_feb_notice_others(feb, at, known);
    if (!status && part && *part) status = lar_feb_is_whole_mesh(feb, at, part, &whole);
    if (!status && !whole)
        status = lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                              "the body load acts on '%.100s' only; Lariat's gravity acts on the "
                              "whole model",
                              part);
    return status ? status : read_body_values(feb, at);
}

lar_status lar_feb_read_loads(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *load = lar_feb_first(section); load && !status; load = lar_feb_next(load)) {
        if (lar_feb_is(load, "nodal_load"))
            status = read_nodal_load(feb, load);
        else if (lar_feb_is(load, "surface_load"))
            status = read_surface_load(feb, load);
        else if (lar_feb_is(load, "body_load"))
            status = read_body_load(feb, load);
        else
            status = lar_feb_fail(feb, load, LAR_ERROR_UNSUPPORTED,
                                  "<%s> in <Loads> is not read and would change the answer; Lariat "
                                  "reads nodal_load, surface_load and body_load",
                                  lar_feb_name(load));
    }
    return status;
}
