#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/contact_check.h"
#include "model/scene/scene.h"

/* Open jaws of a grasper, where the scene does not say. */
static const double SPREAD = 60;

/* Which keys a shape takes, besides those of every tool. */
typedef struct shape_keys {
    const char *name, *what;
    lar_tool_shape shape;
    bool is_long, grasps;
    const char *keys[12];
} shape_keys;

static const shape_keys known[] = {
    {"sphere",
     "a sphere",
     LAR_TOOL_SPHERE,
     false,
     false,
     {"name", "shape", "radius", "at", "path", "friction", NULL}},
    {"capsule",
     "a capsule",
     LAR_TOOL_CAPSULE,
     true,
     false,
     {"name", "shape", "radius", "length", "at", "towards", "path", "friction", NULL}},
    {"grasper",
     "a grasper",
     LAR_TOOL_GRASPER,
     true,
     true,
     {"name", "shape", "radius", "length", "spread", "at", "towards", "turn", "path", "friction",
      NULL}},
    {"rigid",
     "a rigid tool",
     LAR_TOOL_RIGID,
     false,
     false,
     {"name", "shape", "nodes", "at", "path", "free", NULL}}};
enum { SHAPES = sizeof known / sizeof known[0] };

static lar_status read_shape(const lar_scene *scene, const lar_yaml *node,
                             const shape_keys **shape) {
    const char *names[SHAPES];
    for (int i = 0; i < SHAPES; i++) {
        names[i] = known[i].name;
        if (lar_scene_is_word(node, names[i])) {
            *shape = &known[i];
            return LAR_OK;
        }
    }
    return lar_scene_unknown(scene, node, LAR_ERROR_FORMAT, "the shape", "the shapes are", names,
                             SHAPES);
}

static lar_status read_name(lar_scene *scene, const lar_yaml *node, lar_tool *tool) {
    const lar_model *model = scene->model;
    const char *name;
    char problem[LAR_PROBLEM_SIZE];
    lar_status status = lar_scene_text(scene, node, "the name of the tool", &name);
    if (status) return status;
    if (lar_tool_name_problem(name, problem))
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL, "%s", problem);
    for (int i = 0; i < model->tool_count - 1; i++)
        if (strcmp(model->tool[i].name, name) == 0)
            return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                                  "there is already a tool named \"%s\"; choose another name",
                                  name);
    tool->name = lar_strdup(name);
    return tool->name ? LAR_OK : lar_scene_no_memory(scene, strlen(name) + 1);
}

/* The shortest turn that brings the tool's -z, where it points, to `towards`; before it, `turn`
 * radians about the tool's own axis. */
static void orient(const double towards[3], double turn, double q[4]) {
    double x = 0, y = 0, w = 1 - towards[2], c = cos(turn / 2), s = sin(turn / 2);
    if (w > 1e-12) {
        x = towards[1];
        y = -towards[0];
    } else { /* straight back: half a turn about x */
        x = 1;
        w = 0;
    }
    double length = sqrt(w * w + x * x + y * y);
    w /= length;
    x /= length;
    y /= length;
    q[0] = w * c;
    q[1] = x * c + y * s;
    q[2] = y * c - x * s;
    q[3] = w * s;
}

/* ---- the key `path` ----------------------------------------------------------------------- */

static lar_status read_path_file(lar_scene *scene, const lar_yaml *node, lar_tool *tool) {
    const char *name;
    lar_status status = lar_scene_text(
        scene, node, "the name of a file of positions at times (docs/devices.md), or a list",
        &name);
    if (!status && scene->given)
        status =
            lar_scene_fail(scene, node, LAR_ERROR_UNSUPPORTED,
                           "path: a scene from memory reads no files; give the positions here, "
                           "path: [[0, 0, 0, 0.02], [0.5, 0, 0, 0.01]]");
    if (status) return status;
    char *path = lar_path_beside(scene->path, name);
    if (!path) return lar_scene_no_memory(scene, strlen(name));
    lar_error own = {0};
    status = lar_tool_script_read(path, &tool->path, &own);
    free(path);
    return status ? lar_scene_fail(scene, node, status, "%s", own.message) : LAR_OK;
}

/* Four numbers, or five with the opening of a grasper's jaws. */
static lar_status read_path_row(const lar_scene *scene, const lar_yaml *entry, bool grasps,
                                lar_tool_script *path) {
    const char *const expected =
        grasps ? "four or five numbers, [time in seconds, x, y, z in metres, opening from 0 to 1]"
               : "four numbers, [time in seconds, x, y, z in metres]";
    lar_tool_script_row row = {.pose = {.orientation = {1, 0, 0, 0}, .opening = 1}};
    double *const place[] = {&row.time, &row.pose.position[0], &row.pose.position[1],
                             &row.pose.position[2], &row.pose.opening};
    lar_status status = LAR_OK;
    if (entry->kind != LAR_YAML_LIST || entry->count < 4 || entry->count > (grasps ? 5 : 4))
        return lar_scene_fail(scene, entry, LAR_ERROR_FORMAT, "path: expected %s", expected);
    const lar_yaml *number = entry->first;
    for (int i = 0; number && !status; i++, number = number->next) {
        status = lar_scene_number(scene, number, expected, place[i]);
        if (!status && i > 0 && i < 4 && fabs(*place[i]) > LAR_TOOL_SCRIPT_FAR)
            status = lar_scene_fail(scene, number, LAR_ERROR_MODEL,
                                    "path: %g m; positions are in metres, within %g", *place[i],
                                    LAR_TOOL_SCRIPT_FAR);
        if (!status && i == 4 && !(*place[i] >= 0 && *place[i] <= 1))
            status = lar_scene_fail(scene, number, LAR_ERROR_MODEL,
                                    "path: jaws are open by 0 (closed) to 1, not by %g", *place[i]);
    }
    if (!status && path->count > 0 && !(row.time > path->row[path->count - 1].time))
        status = lar_scene_fail(scene, entry, LAR_ERROR_MODEL,
                                "path: time %g does not come after %g; times must grow from row to "
                                "row",
                                row.time, path->row[path->count - 1].time);
    if (!status && !lar_tool_script_insert(path, path->count, &row))
        status = lar_scene_no_memory(scene, path->capacity * sizeof row);
    return status;
}

static lar_status read_path(lar_scene *scene, const lar_yaml *entry, const shape_keys *shape,
                            lar_tool *tool) {
    const lar_yaml *node = lar_yaml_get(entry, "path");
    lar_status status = LAR_OK;
    if (!node) return LAR_OK;
    if (node->kind != LAR_YAML_LIST) {
        status = read_path_file(scene, node, tool);
    } else {
        if (node->count == 0)
            status = lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                                    "path: the list is empty; give at least one row, for example "
                                    "[0.5, 0, 0, 0.01]");
        for (const lar_yaml *row = node->first; row && !status; row = row->next)
            status = read_path_row(scene, row, shape->grasps, &tool->path);
    }
    if (!status && tool->path.row[0].time < 0)
        status = lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                                "path: it begins at %g s; scenes begin at time 0",
                                tool->path.row[0].time);
    return status;
}

/* A path that does not say how the tool is turned leaves it as the scene has it; one that begins
 * later than the scene begins where the scene has the tool. */
static lar_status begin_path(lar_scene *scene, const lar_yaml *at, lar_tool *tool) {
    static const double SAME = 1e-6; /* of a radius */
    lar_tool_script *path = &tool->path;
    if (path->count == 0) return LAR_OK;
    for (size_t i = 0; i < path->count && !path->turns; i++)
        memcpy(path->row[i].pose.orientation, tool->rest.orientation,
               sizeof tool->rest.orientation);
    if (path->row[0].time > 0) {
        lar_tool_script_row row = {.time = 0, .pose = tool->rest};
        return lar_tool_script_insert(path, 0, &row)
                   ? LAR_OK
                   : lar_scene_no_memory(scene, path->capacity * sizeof row);
    }
    const double *begins = path->row[0].pose.position;
    for (int i = 0; i < 3 && at; i++)
        if (!(fabs(begins[i] - tool->rest.position[i]) <= SAME * tool->radius))
            return lar_scene_fail(scene, at, LAR_ERROR_MODEL,
                                  "at and the path's place at time 0, [%g, %g, %g], are not the "
                                  "same; leave one of them out",
                                  begins[0], begins[1], begins[2]);
    tool->rest = path->row[0].pose;
    return LAR_OK;
}

static lar_status read_pose(lar_scene *scene, const lar_yaml *entry, const shape_keys *shape,
                            lar_tool *tool) {
    const lar_yaml *at = NULL, *towards = lar_yaml_get(entry, "towards");
    const lar_yaml *turn = lar_yaml_get(entry, "turn");
    double direction[3] = {0, 0, -1}, degrees = 0;
    lar_status status = LAR_OK;
    const bool begins = tool->path.count > 0 && tool->path.row[0].time == 0;
    if (begins || shape->shape == LAR_TOOL_RIGID)
        at = lar_yaml_get(entry, "at");
    else
        status = lar_scene_need(scene, entry, shape->what, "at", "at: [0, 0, 0.1]", &at);
    if (!status && at) status = lar_scene_vector(scene, at, LAR_IN_POSITION, tool->rest.position);
    if (!status && towards) status = lar_scene_direction(scene, towards, direction);
    if (!status && turn) status = lar_scene_number(scene, turn, LAR_IN_DEGREES, &degrees);
    orient(direction, degrees * LAR_PI / 180, tool->rest.orientation);
    tool->rest.opening = 1;
    return status ? status : begin_path(scene, at, tool);
}

/* ---- what moves nodes ----------------------------------------------------------------------- */

static double distance_of(const double a[3], const double b[3]) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The shortest edge of elements of the nodes: what moves them by more within a step turns these
 * inside out. */
static lar_status find_shortest_edge(const lar_scene *scene, const lar_node_list *nodes,
                                     double *shortest) {
    const lar_mesh *mesh = &scene->model->mesh;
    uint8_t *moved = lar_calloc((size_t)mesh->node_count, 1);
    if (!moved) return lar_scene_no_memory(scene, (size_t)mesh->node_count);
    for (int32_t k = 0; k < nodes->count; k++) moved[nodes->node[k]] = 1;
    *shortest = INFINITY;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 24; a++) {
            const int32_t *face = mesh->element[e];
            const int32_t p = face[lar_face_node[a / 4][a % 4]];
            const int32_t q = face[lar_face_node[a / 4][(a + 1) % 4]];
            const double edge = distance_of(mesh->position[p], mesh->position[q]);
            if ((moved[p] || moved[q]) && edge > 0) *shortest = fmin(*shortest, edge);
        }
    free(moved);
    return LAR_OK;
}

/* Its nodes are moved by an entry of their own; before its place is read, which by default is in
 * their middle. */
static lar_status read_nodes(lar_scene *scene, const lar_yaml *entry, lar_tool *tool) {
    const lar_yaml *nodes = NULL;
    lar_model *model = scene->model;
    lar_status status =
        lar_scene_need(scene, entry, "a rigid tool", "nodes", "nodes: bone", &nodes);
    if (status) return status;
    lar_move *move = LAR_MODEL_APPEND(model, move);
    if (!move) return lar_scene_no_memory(scene, sizeof *move);
    move->axes = LAR_AXIS_ALL;
    move->tool = model->tool_count;
    status = lar_scene_select_nodes(scene, nodes, &move->nodes);
    if (!status) status = lar_scene_claim_axes(scene, entry, &move->nodes, LAR_AXIS_ALL, true);
    if (!status) status = find_shortest_edge(scene, &move->nodes, &tool->radius);
    for (int32_t k = 0; !status && k < move->nodes.count; k++)
        for (int i = 0; i < 3; i++)
            tool->rest.position[i] +=
                model->mesh.position[move->nodes.node[k]][i] / move->nodes.count;
    return status;
}

/* How far the farthest of them is, once it is known where the tool is. */
static void find_reach(const lar_model *model, lar_tool *tool) {
    const lar_node_list *nodes = &model->move[model->move_count - 1].nodes;
    for (int32_t k = 0; k < nodes->count; k++)
        tool->length = fmax(tool->length,
                            distance_of(model->mesh.position[nodes->node[k]], tool->rest.position));
}

/* Which nodes are those of free bodies, or of the one that is the last to have been read. */
static lar_status mark_nodes(lar_scene *scene, bool last, bool **marked) {
    const lar_model *model = scene->model;
    const size_t nodes = (size_t)model->mesh.node_count;
    *marked = lar_calloc(nodes, sizeof **marked);
    if (!*marked) return lar_scene_no_memory(scene, nodes);
    for (int m = last ? model->move_count - 1 : 0; m < model->move_count; m++) {
        const lar_move *move = &model->move[m];
        if (!last && !(move->tool && model->tool[move->tool - 1].free)) continue;
        for (int32_t k = 0; k < move->nodes.count; k++) (*marked)[move->nodes.node[k]] = true;
    }
    return LAR_OK;
}

static bool is_before(const lar_mesh *mesh, const bool *marked, const lar_contact *plane) {
    for (int32_t k = 0; k < 4 * plane->face_count; k++) {
        const int32_t face = plane->face[k / 4];
        if (marked[mesh->element[face / 6][lar_face_node[face % 6][k % 4]]]) return true;
    }
    return false;
}

/* Planes stop a body, and not its nodes one by one. */
static lar_status find_planes(lar_scene *scene, const lar_yaml *entry, lar_tool *tool) {
    enum { BITS = 32 };
    const lar_model *model = scene->model;
    int count = 0;
    bool *marked;
    lar_status status = mark_nodes(scene, true, &marked);
    for (int i = 0; !status && i < model->contact_count; i++) {
        const lar_contact *plane = &model->contact[i];
        if (plane->kind != LAR_CONTACT_PLANE || !is_before(&model->mesh, marked, plane)) continue;
        if (++count > LAR_TOOL_PLANES_MAX || i >= BITS)
            status = lar_scene_fail(scene, entry, LAR_ERROR_UNSUPPORTED,
                                    "\"%s\" is before more than %d planes, or behind %d other "
                                    "entries of contact; name only its own surface with those that "
                                    "stop it, and put their entries first",
                                    tool->name, LAR_TOOL_PLANES_MAX, BITS);
        else
            tool->planes |= 1u << i;
    }
    free(marked);
    return status;
}

/* A point of space about which it turns, and an axis through it. */
static lar_status read_joint(const lar_scene *scene, const lar_yaml *node, lar_tool *tool) {
    static const char *const keys[] = {"point", "axis", NULL};
    const lar_yaml *point = NULL, *axis = lar_yaml_get(node, "axis");
    tool->free = LAR_FREE_TURNS;
    lar_status status = lar_scene_keys(scene, node, "a joint", keys);
    if (!status)
        status = lar_scene_need(scene, node, "a joint", "point", "point: [0, 0, 0.1]", &point);
    if (!status) status = lar_scene_vector(scene, point, LAR_IN_POSITION, tool->point);
    return status || !axis ? status : lar_scene_direction(scene, axis, tool->axis);
}

/* Along which axes forces take it; with all of them it turns as well. */
static lar_status read_free(lar_scene *scene, const lar_yaml *entry, lar_tool *tool) {
    const lar_yaml *node = lar_yaml_get(entry, "free");
    if (!node) return LAR_OK;
    if (tool->path.count > 0)
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "free: a body that has a path is led; leave one of them out");
    lar_status status = find_planes(scene, entry, tool);
    if (status) return status;
    tool->free = LAR_AXIS_ALL | LAR_FREE_TURNS;
    if (node->kind == LAR_YAML_MAPPING) return read_joint(scene, node, tool);
    return lar_scene_is_word(node, "all") ? LAR_OK : lar_scene_axes(scene, node, &tool->free);
}

static lar_status read_size(lar_scene *scene, const lar_yaml *entry, const shape_keys *shape,
                            lar_tool *tool) {
    const lar_yaml *radius = NULL, *length = NULL, *spread = lar_yaml_get(entry, "spread");
    double degrees = SPREAD;
    if (shape->shape == LAR_TOOL_RIGID) return read_nodes(scene, entry, tool);
    lar_status status =
        lar_scene_need(scene, entry, shape->what, "radius", "radius: 0.005", &radius);
    if (!status) status = lar_scene_positive(scene, radius, LAR_IN_METRES, &tool->radius);
    if (!status && shape->is_long)
        status = lar_scene_need(scene, entry, shape->what, "length", "length: 0.02", &length);
    if (!status && length) status = lar_scene_positive(scene, length, LAR_IN_METRES, &tool->length);
    if (!status && spread) status = lar_scene_positive(scene, spread, LAR_IN_DEGREES, &degrees);
    if (!status && shape->grasps) tool->spread = degrees * LAR_PI / 180;
    if (!status && spread && !lar_tool_jaws_part(tool))
        status =
            lar_scene_fail(scene, spread, LAR_ERROR_MODEL,
                           "spread: these jaws do not part at that angle; if it is in radians, "
                           "write %.3g",
                           degrees * 180 / LAR_PI);
    return status;
}

static lar_status read_tool(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"name",  "shape",   "radius", "length", "spread",
                                       "at",    "towards", "turn",   "path",   "friction",
                                       "nodes", "free",    NULL};
    const char *const what = "a tool";
    const lar_yaml *name = NULL, *word = NULL;
    const shape_keys *shape = NULL;
    lar_status status = lar_scene_keys(scene, entry, what, keys);
    if (!status) status = lar_scene_need(scene, entry, what, "name", "name: probe", &name);
    if (!status) status = lar_scene_need(scene, entry, what, "shape", "shape: sphere", &word);
    if (!status) status = read_shape(scene, word, &shape);
    if (!status) status = lar_scene_keys(scene, entry, shape->what, shape->keys);
    if (!status && scene->model->tool_count >= LAR_MODEL_TOOLS_MAX)
        status = lar_scene_fail(scene, entry, LAR_ERROR_UNSUPPORTED,
                                "there are more than %d tools; remove some", LAR_MODEL_TOOLS_MAX);
    if (status) return status;
    lar_tool *tool = LAR_MODEL_APPEND(scene->model, tool);
    if (!tool) return lar_scene_no_memory(scene, sizeof *tool);
    tool->shape = shape->shape;
    status = read_name(scene, name, tool);
    if (!status) status = read_size(scene, entry, shape, tool);
    if (!status) status = read_path(scene, entry, shape, tool);
    if (!status) status = read_pose(scene, entry, shape, tool);
    if (!status && shape->shape == LAR_TOOL_RIGID) find_reach(scene->model, tool);
    if (!status) status = lar_scene_friction(scene, entry, &tool->friction);
    if (!status) status = read_free(scene, entry, tool);
    char problem[LAR_PROBLEM_SIZE];
    if (!status && lar_tool_problem(scene->model, tool, problem))
        status = lar_scene_fail(scene, entry, LAR_ERROR_MODEL, "%s", problem);
    return status;
}

/* But for free bodies', whose faces feel tools everywhere. */
static double longest_edge(const lar_model *model, const bool *marked) {
    double longest = 0;
    for (int32_t f = 0; f < model->surface.face_count; f++)
        for (int a = 0; a < 4; a++) {
            if (marked[model->surface.corner[f][a]]) continue;
            const double *p = model->mesh.position[model->surface.corner[f][a]];
            const double *q = model->mesh.position[model->surface.corner[f][(a + 1) % 4]];
            longest = fmax(longest, distance_of(p, q));
        }
    return longest;
}

/* A face feels tools at 6 x 6 points at most (contact/tool_contact.h). Between four of them there
 * is room for a tool of that radius. */
static lar_status notice_thin_tools(lar_scene *scene) {
    lar_model *model = scene->model;
    bool *marked;
    lar_status status = mark_nodes(scene, false, &marked);
    double edge = status ? 0 : longest_edge(model, marked), room = edge / 6 * sqrt(0.5);
    for (int i = 0; !status && i < model->tool_count; i++)
        if (model->tool[i].shape != LAR_TOOL_RIGID && model->tool[i].radius < room)
            status = lar_model_notice(
                model, scene->error,
                "%s: the tool \"%s\" has a radius of %.3g m, and the surface has edges of up to "
                "%.3g m: large faces feel it only where it meets one of their 36 points; give it "
                "a radius of %.2g m, or refine the mesh",
                scene->path, model->tool[i].name, model->tool[i].radius, edge, 1.05 * room);
    free(marked);
    return status;
}

lar_status lar_scene_read_tools(lar_scene *scene, const lar_yaml *node) {
    lar_status status = lar_scene_list(
        scene, node, "tools, {name: probe, shape: sphere, radius: 0.005, at: [0, 0, 0.1]}");
    if (!status) status = lar_scene_need_surface(scene);
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
        status = read_tool(scene, entry);
    return status ? status : notice_thin_tools(scene);
}
