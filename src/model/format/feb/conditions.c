/* FEBio decks: <Boundary>, <Loads>, <Initial>. See feb.h.
 *
 * Signs, as FEBio has them. A pressure p gives the traction -p n, with n the normal that the
 * order of the face's corners makes (right-hand rule): positive pushes against it. A body load b
 * gives the force -rho b per volume: a deck writes z = 9.81 for gravity that pulls downwards, so
 * Lariat's gravity is -b.
 */
#include "model/format/feb/feb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

/* The child that every condition of this kind must have. */
static lar_status need_child(lar_feb *feb, const xmlNode *parent, const char *name,
                             const xmlNode **child) {
    *child = lar_feb_child(parent, name);
    if (*child) return LAR_OK;
    return lar_feb_fail(feb, parent, LAR_ERROR_FORMAT, "<%s> has no <%s>; add it",
                        (const char *)parent->name, name);
}

/* Nodes of the attribute node_set. *list is owned by the caller, also after a failure. */
static lar_status read_node_set(lar_feb *feb, const xmlNode *at, lar_node_list *list) {
    const char *reference;
    lar_status status = lar_feb_need_attribute(feb, at, "node_set", &reference);
    return status ? status : lar_feb_node_list(feb, at, reference, list);
}

/* "x", "y" or "z" as an axis number. */
static lar_status parse_axis(lar_feb *feb, const xmlNode *at, lar_span word, int *axis) {
    static const char *const names[] = {"x", "y", "z"};
    word = lar_span_trim(word);
    for (*axis = 0; *axis < 3; ++*axis)
        if (lar_span_equal(word, names[*axis])) return LAR_OK;
    return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                        "the degree of freedom '%.*s' is not one of x, y, z, all that a solid has; "
                        "remove it",
                        (int)(word.length < 40 ? word.length : 40), word.at);
}

static lar_status refuse_type(lar_feb *feb, const xmlNode *at, const char *known) {
    const char *type = lar_feb_attribute(feb, at, "type");
    return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                        "<%s> of type '%.60s' is not read and would change the answer; Lariat "
                        "reads %s",
                        (const char *)at->name, type ? type : "", known);
}

static lar_status refuse_flag(lar_feb *feb, const xmlNode *at, const char *name) {
    bool set;
    lar_status status = lar_feb_flag(feb, at, name, false, &set);
    if (status || !set) return status;
    return lar_feb_fail(feb, lar_feb_child(at, name), LAR_ERROR_UNSUPPORTED,
                        "<%s> other than 0 is not read; set it to 0", name);
}

/* Refuses flags that ask for something else than FEBio's default, and a size in two places, which
 * versions of FEBio multiply or do not. */
static lar_status refuse_extras(lar_feb *feb, const xmlNode *at) {
    const xmlNode *scale = lar_feb_child(at, "scale");
    if (scale && lar_feb_child(at, "value"))
        return lar_feb_fail(feb, scale, LAR_ERROR_UNSUPPORTED,
                            "<scale> stands beside <value>; write their product into one of them "
                            "and remove the other");
    lar_status status = refuse_flag(feb, at, "relative");
    return status ? status : refuse_flag(feb, at, "shell_bottom");
}

/* ---- boundary -------------------------------------------------------------------------------- */

/* x_dof, y_dof, z_dof: 0 or 1 each (version 4). */
static lar_status read_axis_flags(lar_feb *feb, const xmlNode *at, unsigned *axes) {
    static const char *const names[] = {"x_dof", "y_dof", "z_dof"};
    lar_status status = LAR_OK;
    *axes = 0;
    for (int i = 0; i < 3 && !status; i++) {
        bool set;
        status = lar_feb_flag(feb, at, names[i], false, &set);
        if (!status && set) *axes |= 1u << i;
    }
    return status;
}

/* "x,y,z" in <dofs> (version 3). */
static lar_status read_axis_list(lar_feb *feb, const xmlNode *dofs, unsigned *axes) {
    lar_feb_list list = lar_feb_list_of(feb, dofs);
    lar_span word;
    lar_status status = LAR_OK;
    *axes = 0;
    while (!status && lar_feb_list_next(&list, &word)) {
        int axis;
        status = parse_axis(feb, dofs, word, &axis);
        if (!status) *axes |= 1u << axis;
    }
    return status;
}

static lar_status read_fix(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "x_dof y_dof z_dof";
    const xmlNode *dofs = lar_feb_child(at, "dofs");
    unsigned axes;
    lar_status status = dofs ? read_axis_list(feb, dofs, &axes) : read_axis_flags(feb, at, &axes);
    lar_node_list nodes = {0};
    if (!status && !dofs && !lar_feb_child(at, "x_dof") && !lar_feb_child(at, "y_dof") &&
        !lar_feb_child(at, "z_dof"))
        return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                            "<%s> does not say which axes it holds; add <x_dof>, <y_dof> or "
                            "<z_dof> with 1",
                            (const char *)at->name);
    if (!status) status = lar_feb_notice_others(feb, at, dofs ? "dofs" : known);
    if (!status) status = read_node_set(feb, at, &nodes);
    if (!status && (axes == 0 || nodes.count == 0)) {
        free(nodes.node);
        return lar_feb_notice(feb, at, "<%s> holds no %s and was left out", (const char *)at->name,
                              axes ? "node" : "axis");
    }
    lar_fix *fix = status ? NULL : LAR_MODEL_APPEND(feb->model, fix);
    if (!status && !fix) status = lar_feb_no_memory(feb, "the supports");
    if (status) {
        free(nodes.node);
        return status;
    }
    *fix = (lar_fix){nodes, axes};
    return LAR_OK;
}

/* Without a load curve a displacement is there at once. Of a static deck only the end matters. */
static lar_status notice_at_once(lar_feb *feb, const xmlNode *value, double by, int curve) {
    const lar_model *model = feb->model;
    if (by * lar_curve_value(&model->curve[curve], 0.0) == 0.0 || feb->is_static) return LAR_OK;
    return lar_feb_notice(feb, value,
                          "this displacement is there at once: the body starts with these nodes "
                          "displaced, and shakes; to ramp it, name a load curve that rises from 0 "
                          "(lc=)");
}

/* Its size stands in <value> in version 4, in <scale> in version 3. */
static lar_status read_move(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "dof value scale relative shell_bottom";
    const xmlNode *dof, *value = lar_feb_child(at, "value");
    int axis = 0, curve = 0;
    double by = 0.0;
    lar_node_list nodes = {0};
    lar_status status = need_child(feb, at, "dof", &dof);
    if (!status) status = parse_axis(feb, dof, lar_feb_text(feb, dof), &axis);
    if (!status && !value) value = lar_feb_child(at, "scale");
    if (!status && !value) status = need_child(feb, at, "value", &value);
    if (!status) status = lar_feb_curve_of(feb, value, &curve);
    if (!status) status = lar_feb_doubles(feb, value, &by, 1);
    if (!status) status = notice_at_once(feb, value, by, curve);
    if (!status) status = refuse_extras(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    if (!status) status = read_node_set(feb, at, &nodes);
    lar_move *move = status || nodes.count == 0 ? NULL : LAR_MODEL_APPEND(feb->model, move);
    if (move) {
        *move = (lar_move){nodes, 1u << axis, by, curve};
        return LAR_OK;
    }
    free(nodes.node);
    if (status) return status;
    return nodes.count ? lar_feb_no_memory(feb, "the supports")
                       : lar_feb_notice(feb, at, "<%s> holds no node and was left out",
                                        (const char *)at->name);
}

static lar_status read_bc(lar_feb *feb, const xmlNode *bc) {
    static const char known[] =
        "zero displacement, fixed displacement, fix, prescribed displacement and prescribe";
    if (!lar_feb_is(bc, "bc"))
        return lar_feb_fail(feb, bc, LAR_ERROR_UNSUPPORTED,
                            "<%s> in <Boundary> is not read and would change the answer; Lariat "
                            "reads <bc>",
                            (const char *)bc->name);
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, bc, "type", &type);
    if (status) return status;
    if (strcmp(type, "zero displacement") == 0 || strcmp(type, "fixed displacement") == 0 ||
        strcmp(type, "fix") == 0)
        return read_fix(feb, bc);
    if (strcmp(type, "prescribed displacement") == 0 || strcmp(type, "prescribe") == 0)
        return read_move(feb, bc);
    return refuse_type(feb, bc, known);
}

lar_status lar_feb_read_boundary(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *bc = lar_feb_first(section); bc && !status; bc = lar_feb_next(bc))
        status = read_bc(feb, bc);
    return status;
}

/* ---- loads ----------------------------------------------------------------------------------- */

/* The force vector and curve of a nodal load of either form. */
static lar_status read_nodal_force(lar_feb *feb, const xmlNode *at, const char *type,
                                   double force[3], int *curve) {
    const xmlNode *value, *dof;
    lar_status status;
    if (strcmp(type, "nodal_force") == 0) {
        status = need_child(feb, at, "value", &value);
        if (!status) status = lar_feb_curve_of(feb, value, curve);
        if (!status) status = lar_feb_doubles(feb, value, force, 3);
        return status;
    }
    int axis = 0;
    status = need_child(feb, at, "dof", &dof);
    if (!status) status = parse_axis(feb, dof, lar_feb_text(feb, dof), &axis);
    if (!status) status = need_child(feb, at, "scale", &value);
    if (!status) status = lar_feb_curve_of(feb, value, curve);
    if (!status) status = lar_feb_doubles(feb, value, &force[axis], 1);
    return status;
}

static lar_status read_nodal_load(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "value dof scale relative shell_bottom";
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    if (strcmp(type, "nodal_force") != 0 && strcmp(type, "nodal_load") != 0)
        return refuse_type(feb, at, "nodal_force and nodal_load");
    lar_nodal_load entry = {0};
    status = read_nodal_force(feb, at, type, entry.force, &entry.curve);
    if (!status) status = refuse_extras(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    if (!status) status = read_node_set(feb, at, &entry.nodes);
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

static lar_status no_surface(lar_feb *feb, const xmlNode *at, const char *name) {
    return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                        "<surface_load> names the surface '%.100s', which the mesh does not "
                        "define; define it or correct the name",
                        name);
}

static lar_status add_pressures(lar_feb *feb, const xmlNode *at, const char *name, double pressure,
                                int curve) {
    const lar_set *set = lar_mesh_find_set(feb->mesh, name, LAR_SET_FACES);
    const xmlNode *surface = lar_feb_find_surface(feb, name);
    if (!set || !surface) return no_surface(feb, at, name);
    int32_t *face = lar_calloc((size_t)set->count, sizeof *face), outward = 0;
    if (!face) return lar_feb_no_memory(feb, "the pressures");
    lar_status status = split_by_winding(feb, surface, set, face, &outward);
    if (!status) status = add_pressure(feb, face, outward, pressure, curve);
    if (!status) status = add_pressure(feb, face + outward, set->count - outward, -pressure, curve);
    if (!status && outward < set->count)
        status = lar_feb_notice(feb, surface,
                                "%d faces of surface '%.100s' are listed with their normals into "
                                "the body; their pressure changes sign, as in FEBio",
                                (int)(set->count - outward), name);
    free(face);
    return status;
}

static lar_status read_pressure(lar_feb *feb, const xmlNode *at, const char *surface) {
    static const char known[] = "pressure linear symmetric_stiffness shell_bottom";
    const xmlNode *value;
    int curve = 0;
    double pressure = 0.0;
    bool linear = false;
    lar_status status = need_child(feb, at, "pressure", &value);
    if (!status) status = lar_feb_curve_of(feb, value, &curve);
    if (!status) status = lar_feb_doubles(feb, value, &pressure, 1);
    if (!status) status = refuse_extras(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    if (!status) status = lar_feb_flag(feb, at, "linear", false, &linear);
    if (!status && linear)
        status = lar_feb_notice(feb, lar_feb_child(at, "linear"),
                                "<linear> is left out: the pressure follows the deformed faces");
    return status ? status : add_pressures(feb, at, surface, pressure, curve);
}

/* A face's area at rest, shared among its corners as by the element's shape functions: two by two
 * Gauss points are exact where the face is flat. */
static void share_area(const lar_mesh *mesh, int32_t face, double *area) {
    static const double at[2] = {-0.57735026918962576, 0.57735026918962576};
    static const int sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const int32_t *element = mesh->element[face / 6];
    for (int point = 0; point < 4; point++) {
        double r = at[point % 2], s = at[point / 2], along[2][3] = {{0}}, normal[3];
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) {
                double x = 0.25 * mesh->position[element[lar_face_node[face % 6][a]]][i];
                along[0][i] += sign[a][0] * (1 + sign[a][1] * s) * x;
                along[1][i] += sign[a][1] * (1 + sign[a][0] * r) * x;
            }
        lar_cross(along[0], along[1], normal);
        for (int a = 0; a < 4; a++)
            area[element[lar_face_node[face % 6][a]]] +=
                0.25 * (1 + sign[a][0] * r) * (1 + sign[a][1] * s) * sqrt(lar_dot(normal, normal));
    }
}

static lar_status add_node_load(lar_feb *feb, int32_t node, double area, const double traction[3],
                                int curve) {
    int32_t *only = lar_calloc(1, sizeof *only);
    lar_nodal_load *load = only ? LAR_MODEL_APPEND(feb->model, load) : NULL;
    if (!load) {
        free(only);
        return lar_feb_no_memory(feb, "the loads");
    }
    *only = node;
    *load = (lar_nodal_load){.nodes = {1, only}, .curve = curve};
    for (int i = 0; i < 3; i++) load->force[i] = area * traction[i];
    return LAR_OK;
}

static lar_status add_traction(lar_feb *feb, const xmlNode *at, const char *name,
                               const double traction[3], int curve) {
    const lar_mesh *mesh = feb->mesh;
    const lar_set *set = lar_mesh_find_set(mesh, name, LAR_SET_FACES);
    if (!set) return no_surface(feb, at, name);
    double *area = lar_calloc((size_t)mesh->node_count, sizeof *area);
    if (!area) return lar_feb_no_memory(feb, "the loads");
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < set->count; i++) share_area(mesh, set->index[i], area);
    for (int32_t n = 0; n < mesh->node_count && !status; n++)
        if (area[n] > 0) status = add_node_load(feb, n, area[n], traction, curve);
    free(area);
    return status;
}

/* A dead load per area at rest, `traction` times `scale`: FEBio's with `linear`. */
static lar_status read_traction(lar_feb *feb, const xmlNode *at, const char *surface) {
    static const char known[] = "traction scale linear shell_bottom";
    const xmlNode *value, *scale = lar_feb_child(at, "scale");
    double traction[3], factor = 1;
    int curve = 0;
    bool linear;
    lar_status status = lar_feb_flag(feb, at, "linear", false, &linear);
    if (!status && !linear)
        status = lar_feb_notice(feb, at,
                                "the traction acts on the area at rest, as with <linear>1</linear>;"
                                " FEBio's goes with the area of the deformed faces");
    if (!status) status = need_child(feb, at, "traction", &value);
    if (!status) status = lar_feb_doubles(feb, value, traction, 3);
    if (!status && scale) status = lar_feb_doubles(feb, scale, &factor, 1);
    if (!status && scale && lar_feb_attribute(feb, scale, "lc")) {
        if (lar_feb_attribute(feb, value, "lc"))
            return lar_feb_fail(feb, scale, LAR_ERROR_UNSUPPORTED,
                                "<scale> and <traction> follow a load curve each; Lariat's loads "
                                "have one, join the two");
        value = scale;
    }
    if (!status) status = lar_feb_curve_of(feb, value, &curve);
    if (!status) status = refuse_extras(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    for (int i = 0; i < 3; i++) traction[i] *= factor;
    return status ? status : add_traction(feb, at, surface, traction, curve);
}

static lar_status read_surface_load(lar_feb *feb, const xmlNode *at) {
    const char *type, *surface;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    bool pressure = strcmp(type, "pressure") == 0;
    if (!pressure && strcmp(type, "traction") != 0)
        return refuse_type(feb, at, "pressure and traction");
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
        return refuse_type(feb, at, "const, gravity and body force");
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
                                  (const char *)load->name);
    }
    return status;
}

/* ---- initial --------------------------------------------------------------------------------- */

static lar_status read_ic(lar_feb *feb, const xmlNode *ic) {
    static const char known[] = "value";
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, ic, "type", &type);
    if (status) return status;
    if ((!lar_feb_is(ic, "ic") && !lar_feb_is(ic, "init")) ||
        (strcmp(type, "velocity") != 0 && strcmp(type, "initial velocity") != 0))
        return refuse_type(feb, ic, "<ic> of type velocity");
    const xmlNode *value;
    lar_initial_velocity entry = {0};
    status = need_child(feb, ic, "value", &value);
    if (!status && (lar_feb_attribute(feb, value, "lc") || lar_feb_attribute(feb, value, "type")))
        status = lar_feb_fail(feb, value, LAR_ERROR_UNSUPPORTED,
                              "an initial velocity with a curve or a map is not read; give it "
                              "three numbers");
    if (!status) status = lar_feb_doubles(feb, value, entry.velocity, 3);
    if (!status) status = lar_feb_notice_others(feb, ic, known);
    if (!status) status = read_node_set(feb, ic, &entry.nodes);
    lar_initial_velocity *initial = status ? NULL : LAR_MODEL_APPEND(feb->model, initial);
    if (!status && !initial) status = lar_feb_no_memory(feb, "the initial velocities");
    if (status) {
        free(entry.nodes.node);
        return status;
    }
    *initial = entry;
    return LAR_OK;
}

lar_status lar_feb_read_initial(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *ic = lar_feb_first(section); ic && !status; ic = lar_feb_next(ic))
        status = read_ic(feb, ic);
    return status;
}
