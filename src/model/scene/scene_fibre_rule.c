/* The keys `direction` and `second` of fibres: along what those of a material's elements run.
 *
 *     axis      the same everywhere
 *     around    around a line
 *     path      along the gradient of a potential from some faces to others
 *                                                                     n   t     t: the axis, or a
 *     wall      in the tangent plane of a wall, turned by an           \  | a      path, without
 *               angle that goes linearly through it                     \ |/       its part along n
 *                                                             inner _____\|_____ outer
 *     a = cos(w) t + sin(w) n x t,  w = (1 - f) w_inner + f w_outer
 *
 * n leads out of the wall and f is how far one has come: the gradient and the value of a potential
 * between its inner and outer faces, or, where no inner ones are named, the way to the nearest
 * place of the surface and one minus its length by that of the deepest element. Potentials are
 * solved in the elements of the material (model/mesh/potential.h). The rules are those for fibres
 * of hearts (Potse, Dube, Richer, Vinet and Gulrajani, IEEE Transactions on Biomedical Engineering
 * 53, 2006; Bayer, Blake, Plank and Trayanova, Annals of Biomedical Engineering 40, 2012).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "model/mesh/faces.h"
#include "model/mesh/potential.h"
#include "model/scene/scene.h"
#include "model/triangles/tree.h"

/* The elements of the material, and what was made for them. */
typedef struct rule {
    lar_scene *scene;
    int32_t *element, count;
    uint8_t *held; /* [nodes] of the potential that is being solved */
} rule;

/* A number and a vector for each of the rule's elements. */
typedef struct field {
    double *value, (*gradient)[3];
} field;

static void field_clear(field *f) {
    free(f->value);
    free(f->gradient);
}

static lar_status field_create(const rule *r, field *f) {
    size_t count = (size_t)r->count;
    f->value = lar_calloc(count, sizeof *f->value);
    f->gradient = lar_calloc(count, sizeof *f->gradient);
    return f->value && f->gradient ? LAR_OK
                                   : lar_scene_no_memory(r->scene, count * 4 * sizeof(double));
}

static long long id_of(const rule *r, int32_t i) {
    return (long long)r->scene->model->mesh.element_id[r->element[i]];
}

/* False: it has next to no length. */
static bool make_unit(double v[3], double least) {
    double length = lar_length(v);
    if (!(length > least)) return false;
    for (int i = 0; i < 3; i++) v[i] /= length;
    return true;
}

/* ---- around a line -------------------------------------------------------------------------- */

/* Along axis x (centre - point), 0 on the line itself. */
typedef struct circle {
    double point[3], axis[3];
} circle;

static lar_status read_circle(const lar_scene *scene, const lar_yaml *node, circle *around) {
    static const char *const keys[] = {"point", "axis", NULL}, what[] = "around";
    const lar_yaml *point = NULL, *axis = NULL;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status) status = lar_scene_need(scene, node, what, "point", "point: [0, 0, 0.01]", &point);
    if (!status) status = lar_scene_need(scene, node, what, "axis", "axis: [0, 0, 1]", &axis);
    if (!status) status = lar_scene_vector(scene, point, LAR_IN_POSITION, around->point);
    return status ? status : lar_scene_direction(scene, axis, around->axis);
}

static void centre_of(const lar_mesh *mesh, int32_t e, double centre[3]) {
    memset(centre, 0, 3 * sizeof *centre);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) centre[i] += mesh->position[mesh->element[e][a]][i] / 8;
}

static void turn_around(const lar_mesh *mesh, const circle *around, double size, int32_t e,
                        double out[3]) {
    double from[3];
    centre_of(mesh, e, from);
    lar_minus(from, around->point, from);
    lar_cross(around->axis, from, out);
    if (!(lar_dot(out, out) > 1e-18 * size * size)) memset(out, 0, 3 * sizeof *out);
}

/* ---- between two sets of faces -------------------------------------------------------------- */

/* Marks the nodes of faces of the material, towards nothing or towards another one, of which all
 * four are in `chosen`. */
static lar_status mark_ends(const rule *r, const uint8_t *chosen, uint8_t *mark) {
    const lar_model *model = r->scene->model;
    const int32_t own = model->element_material[r->element[0]];
    lar_face_table table = {0};
    lar_status status = lar_face_table_build(&model->mesh, &table, r->scene->error);
    for (size_t first = 0, end; first < table.count && !status; first = end) {
        int faces = 0;
        for (end = first; end < table.count; end++) {
            if (!lar_face_key_same(&table.key[first], &table.key[end])) break;
            faces += model->element_material[table.key[end].face / 6] == own;
        }
        const int32_t *node = table.key[first].node;
        bool all = faces == 1;
        for (int k = 0; k < 4 && all; k++) all = chosen[node[k]];
        for (int k = 0; k < 4 && all; k++) mark[node[k]] = 1;
    }
    free(table.key);
    return status;
}

/* The nodes of an end. Those of a set count as they are, whatever it holds; a selector of places
 * takes faces of the material. */
static lar_status choose(const rule *r, const lar_yaml *faces, uint8_t *mark) {
    int32_t *node, count;
    int64_t ignored;
    if (lar_scene_is_integer(faces, &ignored))
        return lar_scene_fail(r->scene, faces, LAR_ERROR_FORMAT,
                              "%.8s: a number alone says too little here; write {tag: N} for the "
                              "faces towards tagged elements, or quotes around the name of a set",
                              faces->key->text);
    lar_status status = lar_scene_select(r->scene, faces, LAR_SET_NODES, false, &node, &count);
    if (status) return status;
    size_t nodes = (size_t)r->scene->model->mesh.node_count;
    uint8_t *chosen = faces->kind == LAR_YAML_SCALAR ? mark : lar_calloc(nodes, 1);
    if (!chosen) status = lar_scene_no_memory(r->scene, nodes);
    for (int32_t n = 0; n < count && !status; n++) chosen[node[n]] = 1;
    if (!status && chosen != mark) status = mark_ends(r, chosen, mark);
    if (chosen != mark) free(chosen);
    free(node);
    return status;
}

/* The nodes of an end that belong to the material: FREE before, `as` afterwards. */
static lar_status hold(const rule *r, const lar_yaml *faces, const uint8_t *own, int as) {
    const lar_mesh *mesh = &r->scene->model->mesh;
    uint8_t *mark = lar_calloc((size_t)mesh->node_count, 1);
    int32_t held = 0;
    if (!mark) return lar_scene_no_memory(r->scene, (size_t)mesh->node_count);
    lar_status status = choose(r, faces, mark);
    for (int32_t n = 0; n < mesh->node_count && !status; n++) {
        if (!mark[n] || !own[n]) continue;
        if (r->held[n])
            status = lar_scene_fail(r->scene, faces, LAR_ERROR_MODEL,
                                    "%.8s: node %lld belongs to both ends, so that there is no way "
                                    "between them; leave out the faces around it at one end",
                                    faces->key->text, (long long)mesh->node_id[n]);
        r->held[n] = (uint8_t)as;
        held++;
    }
    free(mark);
    if (!status && held == 0)
        status = lar_scene_fail(r->scene, faces, LAR_ERROR_MODEL,
                                "%.8s: none of this is a face of an element of this material; "
                                "choose faces of its own, or what touches it",
                                faces->key->text);
    return status;
}

/* Both ends held, and every element between them. */
static lar_status hold_ends(const rule *r, const lar_yaml *const end[2]) {
    const lar_mesh *mesh = &r->scene->model->mesh;
    uint8_t *own = lar_calloc((size_t)mesh->node_count, 1);
    int32_t loose;
    int missing = 0;
    if (!own) return lar_scene_no_memory(r->scene, (size_t)mesh->node_count);
    for (int32_t i = 0; i < r->count; i++)
        for (int a = 0; a < 8; a++) own[mesh->element[r->element[i]][a]] = 1;
    memset(r->held, LAR_POTENTIAL_FREE, (size_t)mesh->node_count);
    lar_status status = hold(r, end[0], own, LAR_POTENTIAL_LOW);
    if (!status) status = hold(r, end[1], own, LAR_POTENTIAL_HIGH);
    if (!status)
        status = lar_potential_loose(mesh, r->element, r->count, r->held, &loose, &missing,
                                     r->scene->error);
    free(own);
    if (status || loose < 0) return status;
    return lar_scene_fail(r->scene, end[0], LAR_ERROR_MODEL,
                          "element %lld has no way through this material to the faces of \"%.8s\"; "
                          "connect them, or give that part a material with a direction of its own",
                          (long long)mesh->element_id[loose],
                          end[missing == LAR_POTENTIAL_HIGH]->key->text);
}

/* Nothing leads through an element: all of it lies in one end, or in a dead end. */
static lar_status no_way(const rule *r, const lar_yaml *const end[2], int32_t i) {
    const int32_t *node = r->scene->model->mesh.element[r->element[i]];
    int at = r->held[node[0]];
    for (int a = 1; a < 8; a++)
        if (r->held[node[a]] != at) at = LAR_POTENTIAL_FREE;
    const lar_yaml *one = end[at == LAR_POTENTIAL_HIGH];
    if (at != LAR_POTENTIAL_FREE)
        return lar_scene_fail(r->scene, one, LAR_ERROR_MODEL,
                              "%.8s: all nodes of element %lld belong to these faces, so that "
                              "nothing leads through it; leave out those of its faces that are not "
                              "the end itself",
                              one->key->text, id_of(r, i));
    return lar_scene_fail(
        r->scene, one, LAR_ERROR_MODEL,
        "in element %lld nothing leads from \"%.8s\" to \"%.8s\", it lies in a dead end; "
        "name faces between which it lies, or give that part a material with a "
        "direction of its own",
        id_of(r, i), end[0]->key->text, end[1]->key->text);
}

/* How far one has come from one end to the other, and along what. */
static lar_status solve_between(const rule *r, const lar_yaml *const end[2], field *f) {
    const double LEAST = 1e-6; /* of a way as long as the mesh is large */
    const lar_mesh *mesh = &r->scene->model->mesh;
    lar_error own = {0};
    double *value = NULL;
    if (r->count == 0) return LAR_OK; /* others have taken all of its elements */
    lar_status status = hold_ends(r, end);
    if (!status) status = field_create(r, f);
    if (!status && !(value = lar_calloc((size_t)mesh->node_count, sizeof *value)))
        status = lar_scene_no_memory(r->scene, (size_t)mesh->node_count * sizeof *value);
    if (!status && lar_potential_solve(mesh, r->element, r->count, r->held, value, &own))
        status = lar_scene_fail(r->scene, end[0], LAR_ERROR_MODEL, "%s", own.message);
    for (int32_t i = 0; i < r->count && !status; i++) {
        f->value[i] = lar_potential_at(mesh, value, r->element[i], f->gradient[i]);
        if (!make_unit(f->gradient[i], LEAST / r->scene->size)) status = no_way(r, end, i);
    }
    free(value);
    return status;
}

static lar_status follow_path(const rule *r, const lar_yaml *node, field *f) {
    static const char *const keys[] = {"from", "to", NULL}, what[] = "path";
    const lar_yaml *end[2] = {NULL, NULL};
    lar_status status = lar_scene_keys(r->scene, node, what, keys);
    if (!status) status = lar_scene_need(r->scene, node, what, "from", "from: inlet", &end[0]);
    if (!status) status = lar_scene_need(r->scene, node, what, "to", "to: outlet", &end[1]);
    return status ? status : solve_between(r, end, f);
}

/* ---- through a wall ------------------------------------------------------------------------- */

/* Of degrees, right at quarters and the same bits everywhere: series within an eighth of a turn. */
static void turn_of(double degrees, double *cosine, double *sine) {
    double quarter = floor(degrees / 90 + 0.5);
    double x = (degrees - 90 * quarter) * (3.14159265358979323846 / 180), z = x * x, c = 1, s = 1;
    for (int k = 18; k > 0; k -= 2) {
        c = 1 - z * c / (k * (k - 1));
        s = 1 - z * s / (k * (k + 1));
    }
    s *= x;
    int turns = (int)(quarter - 4 * floor(quarter / 4));
    *cosine = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
    *sine = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
}

/* Two triangles for each of the faces. */
static lar_status cut_faces(const rule *r, const int32_t *face, int32_t count, lar_triangles *t) {
    const lar_mesh *mesh = &r->scene->model->mesh;
    t->vertex_count = mesh->node_count;
    t->vertex = mesh->position;
    t->triangle_count = 2 * count;
    t->corner = lar_calloc((size_t)t->triangle_count, sizeof *t->corner);
    if (!t->corner) return lar_scene_no_memory(r->scene, (size_t)count * 2 * sizeof *t->corner);
    for (int32_t f = 0; f < t->triangle_count; f++)
        for (int k = 0; k < 3; k++) {
            int corner = k == 0 ? 0 : k + f % 2;
            t->corner[f][k] =
                mesh->element[face[f / 2] / 6][lar_face_node[face[f / 2] % 6][corner]];
        }
    return LAR_OK;
}

/* The way out of each element, and its length as a part of the longest one. */
static lar_status measure_depth(const rule *r, const lar_triangle_tree *tree, const lar_yaml *node,
                                field *f) {
    double deepest = 0;
    for (int32_t i = 0; i < r->count; i++) {
        double centre[3];
        lar_nearest nearest;
        centre_of(&r->scene->model->mesh, r->element[i], centre);
        if (lar_triangle_tree_nearest(tree, centre, INFINITY, &nearest))
            lar_minus(nearest.point, centre, f->gradient[i]);
        f->value[i] = lar_length(f->gradient[i]);
        deepest = fmax(deepest, f->value[i]);
        if (!make_unit(f->gradient[i], 1e-12 * r->scene->size))
            return lar_scene_fail(r->scene, node, LAR_ERROR_MODEL,
                                  "the faces of outer go through the middle of element %lld, which "
                                  "then has no way out; name faces beside the material",
                                  id_of(r, i));
    }
    for (int32_t i = 0; i < r->count; i++) f->value[i] = 1 - f->value[i] / deepest;
    return LAR_OK;
}

/* `outer` NULL: the whole surface. */
static lar_status solve_depth(const rule *r, const lar_yaml *node, const lar_yaml *outer,
                              field *f) {
    lar_triangles surface = {0};
    lar_triangle_tree *tree = NULL;
    int32_t *chosen = NULL, count = 0;
    lar_status status = lar_scene_need_boundary(r->scene);
    if (!status && outer)
        status = lar_scene_select(r->scene, outer, LAR_SET_FACES, false, &chosen, &count);
    if (!status) status = field_create(r, f);
    if (!status)
        status = cut_faces(r, outer ? chosen : r->scene->boundary,
                           outer ? count : r->scene->boundary_count, &surface);
    if (!status)
        status = lar_triangle_tree_create(&surface, NULL, surface.triangle_count, &tree,
                                          r->scene->error);
    if (!status) status = measure_depth(r, tree, node, f);
    lar_triangle_tree_destroy(tree);
    free(surface.corner);
    free(chosen);
    return status;
}

static lar_status read_angle(const lar_scene *scene, const lar_yaml *node, double angle[2]) {
    static const char *const keys[] = {"inner", "outer", NULL};
    static const char *const example[] = {"inner: 60", "outer: -60"}, what[] = "angle";
    lar_status status = lar_scene_keys(scene, node, what, keys);
    for (int k = 0; k < 2 && !status; k++) {
        const lar_yaml *value = NULL;
        status = lar_scene_need(scene, node, what, keys[k], example[k], &value);
        if (!status) status = lar_scene_number(scene, value, LAR_IN_DEGREES, &angle[k]);
        if (!status && !(fabs(angle[k]) <= 360))
            status = lar_scene_fail(scene, value, LAR_ERROR_MODEL,
                                    "%s: an angle of %g degrees; give one from -360 to 360",
                                    keys[k], angle[k]);
    }
    return status;
}

/* The keys of a wall; NULL: not there. */
typedef struct wall {
    const lar_yaml *node, *inner, *outer, *axis, *path;
    double along[3], angle[2];
} wall;

static lar_status read_wall(const lar_scene *scene, const lar_yaml *node, wall *w) {
    static const char *const keys[] = {"inner", "outer", "axis", "path", "angle", NULL};
    static const char what[] = "wall";
    const lar_yaml *angle = NULL;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status)
        status =
            lar_scene_need(scene, node, what, "angle", "angle: {inner: 60, outer: -60}", &angle);
    if (status) return status;
    w->node = node;
    w->inner = lar_yaml_get(node, "inner");
    w->outer = lar_yaml_get(node, "outer");
    w->axis = lar_yaml_get(node, "axis");
    w->path = lar_yaml_get(node, "path");
    if (!w->axis == !w->path)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "wall: expected one of axis: [x, y, z] and path: {from: FACES, to: "
                              "FACES}, from which angles count");
    if (w->inner && !w->outer)
        return lar_scene_need(scene, node, what, "outer", "outer: outside", &w->outer);
    status = read_angle(scene, angle, w->angle);
    return !status && w->axis ? lar_scene_direction(scene, w->axis, w->along) : status;
}

/* t: from what angles count, becomes the direction of element i. */
static lar_status turn_in_wall(const rule *r, const wall *w, const field *through, int32_t i,
                               double t[3]) {
    const double *n = through->gradient[i], far = through->value[i];
    double beside[3], cosine, sine, part = lar_dot(t, n);
    for (int k = 0; k < 3; k++) t[k] -= part * n[k];
    if (!make_unit(t, 1e-6))
        return lar_scene_fail(r->scene, w->axis ? w->axis : w->path, LAR_ERROR_MODEL,
                              "in element %lld the %.4s goes straight through the wall, so that no "
                              "angle can count from it; take another one, or %s",
                              id_of(r, i), w->axis ? "axis" : "path",
                              w->inner ? "give that part a material with a direction of its own"
                                       : "name faces as outer that leave out the ends");
    lar_cross(n, t, beside);
    turn_of((1 - far) * w->angle[0] + far * w->angle[1], &cosine, &sine);
    for (int k = 0; k < 3; k++) t[k] = cosine * t[k] + sine * beside[k];
    return LAR_OK;
}

static lar_status lay_wall(const rule *r, const lar_yaml *node, double (*fibre)[3]) {
    wall w = {0};
    field through = {0}, along = {0};
    lar_status status = read_wall(r->scene, node, &w);
    const lar_yaml *const end[2] = {w.inner, w.outer};
    if (!status)
        status =
            w.inner ? solve_between(r, end, &through) : solve_depth(r, node, w.outer, &through);
    if (!status && w.path) status = follow_path(r, w.path, &along);
    for (int32_t i = 0; i < r->count && !status; i++) {
        double *own = fibre[r->element[i]];
        memcpy(own, w.path ? along.gradient[i] : w.along, sizeof w.along);
        status = turn_in_wall(r, &w, &through, i, own);
    }
    field_clear(&through);
    field_clear(&along);
    return status;
}

/* ---- the rule of a material ----------------------------------------------------------------- */

static lar_status lay(const rule *r, const lar_yaml *node, double (*fibre)[3]) {
    const char *key = node->key->text;
    double along[3] = {0};
    circle round = {{0}, {0}};
    field way = {0};
    lar_status status;
    if (strcmp(key, "wall") == 0) return lay_wall(r, node, fibre);
    bool axis = strcmp(key, "axis") == 0, path = strcmp(key, "path") == 0;
    if (axis)
        status = lar_scene_direction(r->scene, node, along);
    else
        status = path ? follow_path(r, node, &way) : read_circle(r->scene, node, &round);
    for (int32_t i = 0; i < r->count && !status; i++) {
        double *own = fibre[r->element[i]];
        if (axis || path)
            memcpy(own, path ? way.gradient[i] : along, sizeof along);
        else
            turn_around(&r->scene->model->mesh, &round, r->scene->size, r->element[i], own);
        if (lar_dot(own, own) == 0)
            status = lar_scene_fail(r->scene, node, LAR_ERROR_MODEL,
                                    "the centre of element %lld lies on the axis, and nothing "
                                    "leads around it there; move point aside, or give that "
                                    "element a material with a direction of its own",
                                    id_of(r, i));
    }
    field_clear(&way);
    return status;
}

static lar_status rule_create(lar_scene *scene, int material, rule *r) {
    const lar_model *model = scene->model;
    size_t elements = (size_t)model->mesh.element_count, nodes = (size_t)model->mesh.node_count;
    *r = (rule){.scene = scene,
                .element = lar_calloc(elements, sizeof *r->element),
                .held = lar_calloc(nodes, 1)};
    if (!r->element || !r->held)
        return lar_scene_no_memory(scene, elements * sizeof *r->element + nodes);
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        if (model->element_material[e] == material) r->element[r->count++] = e;
    return LAR_OK;
}

/* The directions of one family, in `fibre`, which is made where it is not there yet. */
static lar_status lay_family(lar_scene *scene, const lar_yaml *direction, int material,
                             double (**fibre)[3]) {
    static const char *const keys[] = {"axis", "around", "path", "wall", NULL};
    const char *key = direction->key->text;
    const bool second = strcmp(key, "second") == 0;
    if (lar_scene_is_word(direction, "mesh")) {
        if (*fibre) return LAR_OK;
        return lar_scene_fail(scene, direction, LAR_ERROR_MODEL,
                              "%.9s: mesh, but no mesh has directions; they stand in a .vtu file "
                              "as a cell array \"%s\" of three components, or in the arrays of "
                              "lar_model_from_arrays",
                              key, second ? "fibre2" : "fibre");
    }
    lar_status status = lar_scene_keys(scene, direction, key, keys);
    if (!status && direction->count != 1)
        status = lar_scene_fail(scene, direction, LAR_ERROR_FORMAT,
                                "%.9s: expected mesh, {axis: [x, y, z]}, {around: {point: [x, y, "
                                "z], axis: [x, y, z]}}, {path: {from: FACES, to: FACES}} or "
                                "{wall: {...}}",
                                key);
    if (status) return status;
    size_t elements = (size_t)scene->model->mesh.element_count;
    if (!*fibre) *fibre = lar_calloc(elements, sizeof **fibre);
    if (!*fibre) return lar_scene_no_memory(scene, elements * sizeof **fibre);
    rule r;
    status = rule_create(scene, material, &r);
    if (!status) status = lay(&r, direction->first, *fibre);
    free(r.element);
    free(r.held);
    return status;
}

lar_status lar_scene_lay_fibres(lar_scene *scene, const lar_yaml *node, int material) {
    lar_mesh *mesh = &scene->model->mesh;
    const lar_yaml *direction = lar_yaml_get(node, "direction"),
                   *second = lar_yaml_get(node, "second");
    lar_status status = lay_family(scene, direction, material, &mesh->fibre);
    return !status && second ? lay_family(scene, second, material, &mesh->second) : status;
}

/* ---- without a scene ------------------------------------------------------------------------ */

static lar_status lay_all(lar_scene *scene, const int32_t *material, int materials) {
    lar_model *model = scene->model;
    lar_status status = LAR_OK;
    if (!lar_yaml_get(scene->root, "direction") || scene->root->count != 1)
        return lar_scene_fail(scene, scene->root, LAR_ERROR_FORMAT,
                              "this is no rule; give one as in a scene, for example axis: [0, 0, "
                              "1]");
    size_t size = (size_t)model->mesh.element_count * sizeof *material;
    model->element_material = lar_calloc((size_t)model->mesh.element_count, sizeof *material);
    if (!model->element_material) return lar_scene_no_memory(scene, size);
    memcpy(model->element_material, material, size);
    for (int m = 0; m < materials && !status; m++)
        status = lar_scene_lay_fibres(scene, scene->root, m);
    return status;
}

lar_status lar_scene_fibres_by_rule(const char *words, const int32_t *material, int materials,
                                    lar_mesh *mesh, lar_error *error) {
    static const char pattern[] = "{direction: %s%s%s}\n"; /* as in a scene: no comment ends it */
    const bool braced = *words == '{';
    size_t room = strlen(words) + sizeof pattern;
    lar_bytes text = {lar_calloc(room, 1), 0};
    lar_yaml_tree tree = {0};
    lar_error unused; /* the parts may rely on an error to write to */
    lar_scene scene = {
        .path = "fibres", .model = lar_model_create(), .error = error ? error : &unused};
    lar_status status = LAR_OK;
    if (!text.data || !scene.model) status = lar_fail_memory(error, room, "a rule for fibres");
    if (!status) {
        text.size = (size_t)snprintf((char *)text.data, room, pattern, braced ? "" : "{", words,
                                     braced ? "" : "}");
        status = lar_yaml_parse(scene.path, &text, &tree, error);
    }
    if (!status) {
        scene.root = tree.root;
        scene.model->mesh = *mesh; /* lent */
        scene.size = lar_scene_size(mesh);
        status = lay_all(&scene, material, materials);
        *mesh = scene.model->mesh;
        scene.model->mesh = (lar_mesh){0};
    }
    lar_scene_sets_clear(&scene);
    lar_yaml_clear(&tree);
    lar_bytes_free(&text);
    lar_model_destroy(scene.model);
    return status;
}
