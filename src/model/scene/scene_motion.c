#include "model/scene/scene.h"

#include <math.h>
#include <stdlib.h>

#include "model/mesh/faces.h"

/* ---- curves: `over` or `curve` ------------------------------------------------------------ */

/* The new curve's index; -1 with an error written. */
static lar_status add_curve(const lar_scene *scene, lar_curve **curve, int *index) {
    *curve = LAR_MODEL_APPEND(scene->model, curve);
    if (!*curve) return lar_scene_no_memory(scene, sizeof **curve);
    *index = scene->model->curve_count - 1;
    return LAR_OK;
}

static lar_status read_shape(const lar_scene *scene, const lar_yaml *node, lar_curve_shape *shape) {
    static const char *const names[] = {"linear", "step", "smooth", "spline"};
    static const lar_curve_shape shapes[] = {LAR_CURVE_LINEAR, LAR_CURVE_HOLD, LAR_CURVE_SMOOTH,
                                             LAR_CURVE_SPLINE};
    for (int i = 0; i < 4; i++)
        if (lar_scene_is_word(node, names[i])) {
            *shape = shapes[i];
            return LAR_OK;
        }
    return lar_scene_unknown(scene, node, LAR_ERROR_FORMAT, "the shape", "the shapes are", names,
                             4);
}

static lar_status read_points(const lar_scene *scene, const lar_yaml *node, lar_curve *curve) {
    const char *const expected = "two numbers, [time in seconds, factor], for example [0.1, 1]";
    lar_status status = lar_scene_list(scene, node, "points, [time in seconds, factor]");
    if (status) return status;
    if (node->count == 0)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "points: the list is empty; give at least one point, for example "
                              "[[0, 0], [0.1, 1]]");
    curve->point = lar_calloc((size_t)node->count, sizeof *curve->point);
    if (!curve->point) return lar_scene_no_memory(scene, (size_t)node->count * 16);
    for (const lar_yaml *entry = node->first; entry; entry = entry->next) {
        double *point = curve->point[curve->count];
        if (entry->kind != LAR_YAML_LIST || entry->count != 2)
            return lar_scene_fail(scene, entry, LAR_ERROR_FORMAT, "points: expected %s", expected);
        status = lar_scene_number(scene, entry->first, expected, &point[0]);
        if (!status) status = lar_scene_number(scene, entry->first->next, expected, &point[1]);
        if (status) return status;
        if (curve->count > 0 && point[0] < point[-2])
            return lar_scene_fail(scene, entry, LAR_ERROR_MODEL,
                                  "points: time %g comes after time %g; write the points in the "
                                  "order of time",
                                  point[0], point[-2]);
        curve->count++;
    }
    return LAR_OK;
}

static lar_status read_repeat(const lar_scene *scene, const lar_yaml *node, lar_curve *curve) {
    const double *last = curve->point[curve->count - 1];
    curve->repeats = lar_scene_is_word(node, "true");
    if (!curve->repeats && !lar_scene_is_word(node, "false"))
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT, "repeat: expected true or false");
    if (curve->repeats && !(last[0] > curve->point[0][0]))
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "repeat: a curve that repeats needs points at two times: the last "
                              "is the first of the next round");
    return LAR_OK;
}

static lar_status read_table(const lar_scene *scene, const lar_yaml *node, lar_curve *curve) {
    static const char *const keys[] = {"points", "shape", "repeat", NULL};
    const lar_yaml *points = NULL;
    curve->kind = LAR_CURVE_TABLE;
    curve->shape = LAR_CURVE_LINEAR;
    lar_status status = lar_scene_keys(scene, node, "a curve", keys);
    if (!status)
        status =
            lar_scene_need(scene, node, "a curve", "points", "points: [[0, 0], [0.1, 1]]", &points);
    const lar_yaml *shape = lar_yaml_get(node, "shape");
    if (!status && shape) status = read_shape(scene, shape, &curve->shape);
    if (!status) status = read_points(scene, points, curve);
    const lar_yaml *repeat = lar_yaml_get(node, "repeat");
    return status || !repeat ? status : read_repeat(scene, repeat, curve);
}

/* A displacement that jumps would need infinite forces. */
static lar_status check_no_jump(const lar_scene *scene, const lar_yaml *node,
                                const lar_curve *curve) {
    const char *why = NULL;
    if (curve->kind == LAR_CURVE_RAMP) {
        if (!(curve->over > 0.0))
            why = "over must be more than zero: a sudden displacement is not physical, give the "
                  "seconds that the motion takes, for example over: 0.2";
    } else {
        if (lar_curve_value(curve, 0.0) != 0.0)
            why = "the curve of a motion must be 0 at time 0: a sudden displacement is not "
                  "physical, begin with the point [0, 0]";
        if (curve->shape == LAR_CURVE_HOLD && curve->count > 1)
            why = "the curve of a motion cannot have the shape step: a sudden displacement is not "
                  "physical, write shape: linear, smooth or spline";
        double most = 0; /* what programs write for the sine of a whole turn is no jump */
        for (int i = 0; i < curve->count; i++) most = fmax(most, fabs(curve->point[i][1]));
        if (curve->repeats && !(fabs(curve->point[curve->count - 1][1]) <= 1e-12 * most))
            why = "the curve of a motion that repeats must end with 0, as it begins: a sudden "
                  "displacement is not physical";
        for (int i = 1; i < curve->count; i++)
            if (curve->point[i][0] == curve->point[i - 1][0] &&
                curve->point[i][1] != curve->point[i - 1][1])
                why = "the curve of a motion cannot have two values at one time: a sudden "
                      "displacement is not physical, move the points apart";
    }
    return why ? lar_scene_fail(scene, node, LAR_ERROR_MODEL, "%s", why) : LAR_OK;
}

lar_status lar_scene_read_course(const lar_scene *scene, const lar_yaml *entry, bool motion,
                                 int *index) {
    const lar_yaml *over = lar_yaml_get(entry, "over"), *table = lar_yaml_get(entry, "curve");
    lar_curve *curve;
    if (over && table)
        return lar_scene_fail(scene, table->key, LAR_ERROR_FORMAT,
                              "over and curve say the same thing in two ways; remove one of them");
    if (motion && !over && !table)
        return lar_scene_fail(scene, entry, LAR_ERROR_FORMAT,
                              "a move entry needs \"over\", the seconds that the motion takes, or "
                              "a \"curve\": a sudden displacement is not physical; add for example "
                              "over: 0.2");
    lar_status status = add_curve(scene, &curve, index);
    if (!status && over) status = lar_scene_not_negative(scene, over, LAR_IN_SECONDS, &curve->over);
    if (!status && table) status = read_table(scene, table, curve);
    if (!status && motion) status = check_no_jump(scene, over ? over : table, curve);
    return status;
}

/* ---- supports ----------------------------------------------------------------------------- */

lar_status lar_scene_axes(const lar_scene *scene, const lar_yaml *node, unsigned *axes) {
    unsigned found = 0;
    bool good = node->kind == LAR_YAML_SCALAR && node->text[0] != '\0';
    for (const char *c = good ? node->text : ""; *c; c++) {
        unsigned axis = *c >= 'x' && *c <= 'z' ? 1U << (*c - 'x') : 0;
        good = good && axis && !(found & axis);
        found |= axis;
    }
    char shown[LAR_YAML_SHOWN];
    if (!good)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "%s: expected some of the letters x, y, z, each once, for example "
                              "xyz, but found %s",
                              node->key->text, lar_yaml_show(node, shown));
    *axes = found;
    return LAR_OK;
}

lar_status lar_scene_claim_axes(lar_scene *scene, const lar_yaml *entry, const lar_node_list *nodes,
                                unsigned axes, bool moved) {
    const lar_mesh *mesh = &scene->model->mesh;
    size_t count = 3 * (size_t)mesh->node_count;
    if (!scene->axis_line) scene->axis_line = lar_calloc(count, sizeof *scene->axis_line);
    if (!scene->axis_line) return lar_scene_no_memory(scene, count * sizeof *scene->axis_line);
    for (int32_t n = 0; n < nodes->count; n++)
        for (int axis = 0; axis < 3; axis++) {
            int *line = &scene->axis_line[3 * (size_t)nodes->node[n] + (size_t)axis];
            if (!(axes & 1U << axis)) continue;
            if (moved && *line)
                return lar_scene_fail(
                    scene, entry, LAR_ERROR_MODEL,
                    "node %lld is moved along %c here (line %d) and already %s in line %d; take it "
                    "out of one of the two",
                    (long long)mesh->node_id[nodes->node[n]], 'x' + axis, entry->line,
                    *line < 0 ? "fixed" : "moved", abs(*line));
            *line = moved ? entry->line : -entry->line;
        }
    return LAR_OK;
}

static lar_status read_fix_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"nodes", "axes", NULL};
    const char *const what = "a fix entry";
    const lar_yaml *nodes = NULL, *axes = NULL;
    lar_status status = lar_scene_keys(scene, entry, what, keys);
    if (!status) status = lar_scene_need(scene, entry, what, "nodes", "nodes: base", &nodes);
    if (!status) status = lar_scene_need(scene, entry, what, "axes", "axes: xyz", &axes);
    if (status) return status;
    lar_fix *fix = LAR_MODEL_APPEND(scene->model, fix);
    if (!fix) return lar_scene_no_memory(scene, sizeof *fix);
    status = lar_scene_axes(scene, axes, &fix->axes);
    if (!status) status = lar_scene_select_nodes(scene, nodes, &fix->nodes);
    return status ? status : lar_scene_claim_axes(scene, entry, &fix->nodes, fix->axes, false);
}

static lar_status read_screw(lar_scene *scene, const lar_yaml *node, lar_screw *screw) {
    static const char *const keys[] = {"axis", "point", "degrees", "by", "over", "curve", NULL};
    const char *const what = "a rigid motion";
    const lar_yaml *axis = NULL, *point = lar_yaml_get(node, "point");
    const lar_yaml *degrees = lar_yaml_get(node, "degrees"), *by = lar_yaml_get(node, "by");
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status) status = lar_scene_need(scene, node, what, "axis", "axis: [0, 0, 1]", &axis);
    if (status) return status;
    if (!degrees && !by)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "a rigid motion needs degrees, how far it turns about its axis, or "
                              "by, how far it slides along it, for example degrees: 30");
    if (degrees && !point)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "a rigid motion that turns needs a point that its axis goes through, "
                              "for example point: [0, 0, 0.1]");
    status = lar_scene_direction(scene, axis, screw->axis);
    if (!status && point) status = lar_scene_vector(scene, point, LAR_IN_POSITION, screw->point);
    if (!status && degrees)
        status = lar_scene_number(scene, degrees, LAR_IN_DEGREES, &screw->angle);
    screw->angle *= LAR_PI / 180;
    if (!status && by) status = lar_scene_number(scene, by, LAR_IN_METRES, &screw->slide);
    return status ? status : lar_scene_read_course(scene, node, true, &screw->curve);
}

/* Of one motion, or a list of several, one after the other. */
static lar_status read_screws(lar_scene *scene, const lar_yaml *node, lar_screw **screw,
                              int *count) {
    const lar_yaml *one = node->kind == LAR_YAML_LIST ? node->first : node;
    const int64_t wanted = node->kind == LAR_YAML_LIST ? node->count : 1;
    if (wanted < 1 || wanted > LAR_SCREWS_MAX)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "rigid: a list of 1 to %d motions, one after the other, each for "
                              "example {axis: [0, 0, 1], point: [0, 0, 0], degrees: 30, over: 0.5}",
                              LAR_SCREWS_MAX);
    lar_screw *list = lar_calloc((size_t)wanted, sizeof *list);
    if (!list) return lar_scene_no_memory(scene, (size_t)wanted * sizeof *list);
    lar_status status = LAR_OK;
    *screw = list;
    for (; !status && *count < wanted; one = one->next, ++*count)
        status = read_screw(scene, one, &list[*count]);
    return status;
}

static lar_status read_rigid_entry(lar_scene *scene, const lar_yaml *entry, const lar_yaml *rigid) {
    static const char *const keys[] = {"nodes", "rigid", NULL};
    const char *const what = "a move entry with rigid";
    const lar_yaml *nodes = NULL;
    lar_screw *screw = NULL;
    int count = 0;
    lar_status status = lar_scene_keys(scene, entry, what, keys);
    if (!status) status = lar_scene_need(scene, entry, what, "nodes", "nodes: bone", &nodes);
    if (!status) status = read_screws(scene, rigid, &screw, &count);
    lar_move *move = status ? NULL : LAR_MODEL_APPEND(scene->model, move);
    if (!status && !move) status = lar_scene_no_memory(scene, sizeof *move);
    if (status) {
        free(screw);
        return status;
    }
    *move = (lar_move){
        .axes = LAR_AXIS_ALL, .curve = screw[0].curve, .screw_count = count, .screw = screw};
    status = lar_scene_select_nodes(scene, nodes, &move->nodes);
    return status ? status : lar_scene_claim_axes(scene, entry, &move->nodes, LAR_AXIS_ALL, true);
}

static lar_status read_move_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"nodes", "axes", "by", "over", "curve", "rigid", NULL};
    const char *const what = "a move entry";
    const lar_yaml *nodes = NULL, *axes = NULL, *by = NULL, *rigid = lar_yaml_get(entry, "rigid");
    if (rigid) return read_rigid_entry(scene, entry, rigid);
    lar_status status = lar_scene_keys(scene, entry, what, keys);
    if (!status) status = lar_scene_need(scene, entry, what, "nodes", "nodes: top", &nodes);
    if (!status) status = lar_scene_need(scene, entry, what, "axes", "axes: x", &axes);
    if (!status) status = lar_scene_need(scene, entry, what, "by", "by: 0.01", &by);
    if (status) return status;
    lar_move *move = LAR_MODEL_APPEND(scene->model, move);
    if (!move) return lar_scene_no_memory(scene, sizeof *move);
    status = lar_scene_axes(scene, axes, &move->axes);
    if (!status) status = lar_scene_number(scene, by, LAR_IN_METRES, &move->by);
    if (!status) status = lar_scene_read_course(scene, entry, true, &move->curve);
    if (!status) status = lar_scene_select_nodes(scene, nodes, &move->nodes);
    return status ? status : lar_scene_claim_axes(scene, entry, &move->nodes, move->axes, true);
}

/* ---- springs ------------------------------------------------------------------------------ */

/* Each corner of a face gets its part of the area at rest. */
static lar_status share_by_area(lar_scene *scene, const lar_yaml *faces, lar_spring_bed *bed,
                                double *area) {
    const lar_mesh *mesh = &scene->model->mesh;
    size_t nodes = (size_t)mesh->node_count;
    double(*share)[4] = lar_calloc(nodes, sizeof *share);
    int32_t *face = NULL, count = 0;
    bed->nodes.node = lar_calloc(nodes, sizeof *bed->nodes.node);
    bed->stiffness = lar_calloc(nodes, sizeof *bed->stiffness);
    lar_status status = share && bed->nodes.node && bed->stiffness
                            ? lar_scene_select(scene, faces, LAR_SET_FACES, false, &face, &count)
                            : lar_scene_no_memory(scene, nodes * sizeof *share);
    for (int32_t f = 0; f < count; f++) lar_face_share(mesh, face[f], 1, share);
    free(face);
    for (int32_t n = 0; !status && n < mesh->node_count; n++) {
        if (!(share[n][3] > 0)) continue;
        *area += share[n][3];
        bed->stiffness[bed->nodes.count] = share[n][3];
        bed->nodes.node[bed->nodes.count++] = n;
    }
    free(share);
    return status;
}

static lar_status share_by_node(lar_scene *scene, const lar_yaml *nodes, lar_spring_bed *bed) {
    lar_status status = lar_scene_select_nodes(scene, nodes, &bed->nodes);
    if (status) return status;
    size_t count = (size_t)bed->nodes.count;
    bed->stiffness = lar_calloc(count, sizeof *bed->stiffness);
    if (!bed->stiffness) return lar_scene_no_memory(scene, count * sizeof *bed->stiffness);
    for (size_t k = 0; k < count; k++) bed->stiffness[k] = 1;
    return LAR_OK;
}

static lar_status read_springs_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"nodes", "faces", "stiffness", "stiffness_per_area", NULL};
    lar_status status = lar_scene_keys(scene, entry, "a springs entry", keys);
    if (status) return status;
    const lar_yaml *nodes = lar_yaml_get(entry, "nodes"), *faces = lar_yaml_get(entry, "faces");
    const lar_yaml *all = lar_yaml_get(entry, "stiffness");
    const lar_yaml *each = lar_yaml_get(entry, "stiffness_per_area");
    if (!nodes == !faces || !all == !each || (nodes && each))
        return lar_scene_fail(scene, entry, LAR_ERROR_FORMAT,
                              "a springs entry needs nodes or faces, and the stiffness of all of "
                              "them together [N/m] or, of faces, stiffness_per_area [N/m^3], for "
                              "example {nodes: back, stiffness: 50}");
    lar_spring_bed *bed = LAR_MODEL_APPEND(scene->model, spring);
    if (!bed) return lar_scene_no_memory(scene, sizeof *bed);
    double stiffness = 0, whole = 0;
    bed->line = entry->line;
    status = lar_scene_positive(
        scene, all ? all : each,
        all ? "a number in N/m, for example 50" : "a number in N/m^3, for example 1e5", &stiffness);
    if (!status)
        status =
            nodes ? share_by_node(scene, nodes, bed) : share_by_area(scene, faces, bed, &whole);
    if (nodes) whole = bed->nodes.count;
    for (int32_t k = 0; !status && k < bed->nodes.count; k++)
        bed->stiffness[k] *= all ? stiffness / whole : stiffness;
    return status;
}

/* ---- loads -------------------------------------------------------------------------------- */

static lar_status read_force(lar_scene *scene, const lar_yaml *entry, const lar_yaml *nodes) {
    const lar_yaml *total = lar_yaml_get(entry, "force");
    const lar_yaml *each = lar_yaml_get(entry, "force_per_node");
    if (!total == !each)
        return lar_scene_fail(scene, total ? each->key : entry, LAR_ERROR_FORMAT,
                              "a load on nodes needs either force, the total that its nodes share "
                              "equally, or force_per_node, for example force: [0, 0, -0.1]");
    lar_nodal_load *load = LAR_MODEL_APPEND(scene->model, load);
    if (!load) return lar_scene_no_memory(scene, sizeof *load);
    load->line = (total ? total : each)->line;
    lar_status status = lar_scene_vector(scene, total ? total : each, LAR_IN_NEWTON, load->force);
    if (!status) status = lar_scene_read_course(scene, entry, false, &load->curve);
    if (!status) status = lar_scene_select_nodes(scene, nodes, &load->nodes);
    for (int axis = 0; !status && total && axis < 3; axis++) load->force[axis] /= load->nodes.count;
    return status;
}

static lar_status read_pressure(lar_scene *scene, const lar_yaml *entry, const lar_yaml *faces) {
    const lar_yaml *pressure = NULL;
    lar_status status =
        lar_scene_need(scene, entry, "a load on faces", "pressure", "pressure: 500", &pressure);
    if (status) return status;
    lar_pressure_load *load = LAR_MODEL_APPEND(scene->model, pressure);
    if (!load) return lar_scene_no_memory(scene, sizeof *load);
    status = lar_scene_number(scene, pressure, LAR_IN_PASCAL, &load->pressure);
    if (!status) status = lar_scene_read_course(scene, entry, false, &load->curve);
    if (!status)
        status = lar_scene_select(scene, faces, LAR_SET_FACES, false, &load->face, &load->count);
    return status;
}

static lar_status read_load_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"nodes",    "force", "force_per_node", "faces",
                                       "pressure", "over",  "curve",          NULL};
    static const char *const on_nodes[] = {"nodes", "force", "force_per_node",
                                           "over",  "curve", NULL};
    static const char *const on_faces[] = {"faces", "pressure", "over", "curve", NULL};
    lar_status status = lar_scene_keys(scene, entry, "a load entry", keys);
    if (status) return status;
    const lar_yaml *nodes = lar_yaml_get(entry, "nodes"), *faces = lar_yaml_get(entry, "faces");
    if (!nodes == !faces)
        return lar_scene_fail(scene, nodes ? faces->key : entry, LAR_ERROR_FORMAT,
                              "a load entry needs either nodes, with a force, or faces, with a "
                              "pressure");
    if (nodes) {
        status = lar_scene_keys(scene, entry, "a load on nodes", on_nodes);
        return status ? status : read_force(scene, entry, nodes);
    }
    status = lar_scene_keys(scene, entry, "a load on faces", on_faces);
    return status ? status : read_pressure(scene, entry, faces);
}

static lar_status read_initial_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"nodes", "velocity", NULL};
    const char *const what = "an initial entry";
    const lar_yaml *nodes = NULL, *velocity = NULL;
    lar_status status = lar_scene_keys(scene, entry, what, keys);
    if (!status) status = lar_scene_need(scene, entry, what, "nodes", "nodes: all", &nodes);
    if (!status)
        status = lar_scene_need(scene, entry, what, "velocity", "velocity: [0, 0, 0.5]", &velocity);
    if (status) return status;
    lar_initial_velocity *initial = LAR_MODEL_APPEND(scene->model, initial);
    if (!initial) return lar_scene_no_memory(scene, sizeof *initial);
    status = lar_scene_vector(scene, velocity, LAR_IN_VELOCITY, initial->velocity);
    return status ? status : lar_scene_select_nodes(scene, nodes, &initial->nodes);
}

/* ---- the five lists ----------------------------------------------------------------------- */

static lar_status read_entries(lar_scene *scene, const lar_yaml *node, const char *what,
                               lar_status (*read)(lar_scene *scene, const lar_yaml *entry)) {
    lar_status status = lar_scene_list(scene, node, what);
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
        status = read(scene, entry);
    return status;
}

lar_status lar_scene_read_fix(lar_scene *scene, const lar_yaml *node) {
    return read_entries(scene, node, "supports, {nodes: base, axes: xyz}", read_fix_entry);
}

lar_status lar_scene_read_move(lar_scene *scene, const lar_yaml *node) {
    return read_entries(scene, node, "motions, {nodes: top, axes: x, by: 0.01, over: 0.2}",
                        read_move_entry);
}

lar_status lar_scene_read_load(lar_scene *scene, const lar_yaml *node) {
    return read_entries(scene, node, "loads, {nodes: tip, force: [0, 0, -0.1], over: 0.1}",
                        read_load_entry);
}

lar_status lar_scene_read_springs(lar_scene *scene, const lar_yaml *node) {
    return read_entries(scene, node, "springs, {nodes: back, stiffness: 50}", read_springs_entry);
}

lar_status lar_scene_read_initial(lar_scene *scene, const lar_yaml *node) {
    return read_entries(scene, node, "velocities, {nodes: all, velocity: [0, 0, 0.5]}",
                        read_initial_entry);
}
