#include "model/scene/scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- regions of space --------------------------------------------------------------------- */

typedef struct region {
    enum { REGION_BOX, REGION_SPHERE, REGION_PLANE } shape;
    double a[3];  /* lower corner, centre, point of the plane */
    double b[3];  /* upper corner, unused, unit normal */
    double reach; /* slack, radius, tolerance [m] */
} region;

static bool inside(const region *r, const double p[3]) {
    if (r->shape == REGION_BOX) {
        for (int i = 0; i < 3; i++)
            if (p[i] < r->a[i] - r->reach || p[i] > r->b[i] + r->reach) return false;
        return true;
    }
    double d[3] = {p[0] - r->a[0], p[1] - r->a[1], p[2] - r->a[2]};
    if (r->shape == REGION_SPHERE)
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= r->reach * r->reach;
    return fabs(d[0] * r->b[0] + d[1] * r->b[1] + d[2] * r->b[2]) <= r->reach;
}

static void mean_point(const lar_mesh *mesh, const int32_t *nodes, const uint8_t *local, int count,
                       double centre[3]) {
    centre[0] = centre[1] = centre[2] = 0.0;
    for (int a = 0; a < count; a++)
        for (int i = 0; i < 3; i++)
            centre[i] += mesh->position[nodes[local ? local[a] : a]][i] / count;
}

/* Nodes by their place, elements by their centre, boundary faces by their four nodes. */
static lar_status mark_region(lar_scene *scene, const region *r, lar_set_kind kind, uint8_t *mark) {
    const lar_mesh *mesh = &scene->model->mesh;
    if (kind == LAR_SET_NODES)
        for (int32_t n = 0; n < mesh->node_count; n++) mark[n] |= inside(r, mesh->position[n]);
    if (kind == LAR_SET_ELEMENTS)
        for (int32_t e = 0; e < mesh->element_count; e++) {
            double centre[3];
            mean_point(mesh, mesh->element[e], NULL, 8, centre);
            mark[e] |= inside(r, centre);
        }
    if (kind != LAR_SET_FACES) return LAR_OK;
    lar_status status = lar_scene_need_boundary(scene);
    for (int32_t b = 0; !status && b < scene->boundary_count; b++) {
        int32_t face = scene->boundary[b];
        bool all = true;
        for (int i = 0; all && i < 4; i++)
            all = inside(r, mesh->position[mesh->element[face / 6][lar_face_node[face % 6][i]]]);
        mark[face] |= all;
    }
    return status;
}

/* ---- selectors, one function each ----------------------------------------------------------- */

typedef lar_status selector_function(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                                     uint8_t *mark);

static lar_status mark_entry(lar_scene *scene, const lar_yaml *node, lar_set_kind kind, bool tags,
                             uint8_t *mark);

static lar_status select_box(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                             uint8_t *mark) {
    /* Coordinates that went through `scale` differ in the last bits: edges are inclusive. */
    region box = {.shape = REGION_BOX, .reach = 1e-9 * scene->size};
    if (value->kind != LAR_YAML_LIST || value->count != 2)
        return lar_scene_fail(scene, value, LAR_ERROR_FORMAT,
                              "box: expected two opposite corners, [[x, y, z], [x, y, z]], in "
                              "metres");
    lar_status status = lar_scene_vector(scene, value->first, LAR_IN_POSITION, box.a);
    if (!status) status = lar_scene_vector(scene, value->first->next, LAR_IN_POSITION, box.b);
    for (int i = 0; !status && i < 3; i++)
        if (box.a[i] > box.b[i])
            status = lar_scene_fail(scene, value, LAR_ERROR_MODEL,
                                    "box: the first corner is above the second along %c; exchange "
                                    "the two",
                                    'x' + i);
    return status ? status : mark_region(scene, &box, kind, mark);
}

static lar_status select_sphere(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                                uint8_t *mark) {
    static const char *const keys[] = {"center", "radius", NULL};
    region sphere = {.shape = REGION_SPHERE};
    const lar_yaml *center = NULL, *radius = NULL;
    lar_status status = lar_scene_keys(scene, value, "a sphere", keys);
    if (!status)
        status =
            lar_scene_need(scene, value, "a sphere", "center", "center: [0, 0, 0.01]", &center);
    if (!status)
        status = lar_scene_need(scene, value, "a sphere", "radius", "radius: 0.005", &radius);
    if (!status) status = lar_scene_vector(scene, center, LAR_IN_POSITION, sphere.a);
    if (!status) status = lar_scene_positive(scene, radius, LAR_IN_METRES, &sphere.reach);
    return status ? status : mark_region(scene, &sphere, kind, mark);
}

static lar_status select_plane(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                               uint8_t *mark) {
    static const char *const keys[] = {"point", "normal", "tolerance", NULL};
    region plane = {.shape = REGION_PLANE, .reach = 1e-6 * scene->size};
    const lar_yaml *point = NULL, *normal = NULL;
    lar_status status = lar_scene_keys(scene, value, "a plane", keys);
    if (!status)
        status = lar_scene_need(scene, value, "a plane", "point", "point: [0, 0, 0.01]", &point);
    if (!status)
        status = lar_scene_need(scene, value, "a plane", "normal", "normal: [0, 0, 1]", &normal);
    if (!status) status = lar_scene_vector(scene, point, LAR_IN_POSITION, plane.a);
    if (!status) status = lar_scene_direction(scene, normal, plane.b);
    const lar_yaml *tolerance = lar_yaml_get(value, "tolerance");
    if (!status && tolerance)
        status = lar_scene_not_negative(scene, tolerance, LAR_IN_METRES, &plane.reach);
    return status ? status : mark_region(scene, &plane, kind, mark);
}

static lar_status select_nearest(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                                 uint8_t *mark) {
    const lar_mesh *mesh = &scene->model->mesh;
    double target[3], best = DBL_MAX;
    lar_status status = lar_scene_vector(scene, value, LAR_IN_POSITION, target);
    if (!status && kind == LAR_SET_FACES) status = lar_scene_need_boundary(scene);
    if (status) return status;
    int32_t count = kind == LAR_SET_NODES      ? mesh->node_count
                    : kind == LAR_SET_ELEMENTS ? mesh->element_count
                                               : scene->boundary_count;
    int32_t found = -1;
    for (int32_t i = 0; i < count; i++) {
        int32_t entity = kind == LAR_SET_FACES ? scene->boundary[i] : i;
        double p[3];
        if (kind == LAR_SET_NODES)
            memcpy(p, mesh->position[i], sizeof p);
        else if (kind == LAR_SET_ELEMENTS)
            mean_point(mesh, mesh->element[i], NULL, 8, p);
        else
            mean_point(mesh, mesh->element[entity / 6], lar_face_node[entity % 6], 4, p);
        double distance = hypot(hypot(p[0] - target[0], p[1] - target[1]), p[2] - target[2]);
        if (distance < best) {
            best = distance;
            found = entity;
        }
    }
    if (found < 0)
        return lar_scene_fail(scene, value, LAR_ERROR_MODEL,
                              "nearest: this place is too far away; expected %s", LAR_IN_POSITION);
    mark[found] = 1;
    return LAR_OK;
}

static lar_status select_list(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                              uint8_t *mark) {
    if (kind == LAR_SET_FACES)
        return lar_scene_fail(scene, value, LAR_ERROR_FORMAT,
                              "list: faces have no numbers; list their nodes in a node set and "
                              "write {set: NAME} here");
    lar_status status = lar_scene_list(scene, value, "numbers of the mesh file");
    for (const lar_yaml *entry = value->first; !status && entry; entry = entry->next)
        status = lar_scene_mark_id(scene, entry, kind, mark);
    return status;
}

static lar_status select_set(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                             uint8_t *mark) {
    const char *name;
    lar_status status = lar_scene_text(scene, value, "the name of a set", &name);
    return status ? status : lar_scene_mark_set(scene, value, kind, mark);
}

static lar_status select_surface(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                                 uint8_t *mark) {
    if (value->quoted || !lar_scene_is_word(value, "true"))
        return lar_scene_fail(scene, value, LAR_ERROR_FORMAT,
                              "surface: expected true; write {not: {surface: true}} for the "
                              "inside");
    return lar_scene_mark_surface(scene, kind, mark);
}

static lar_status check_children(const lar_scene *scene, const lar_yaml *value) {
    lar_status status = lar_scene_list(scene, value, "selectors");
    if (!status && value->count == 0)
        status =
            lar_scene_fail(scene, value, LAR_ERROR_FORMAT,
                           "%.8s: the list is empty; name at least one selector", value->key->text);
    return status;
}

static lar_status select_any(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                             uint8_t *mark) {
    lar_status status = check_children(scene, value);
    for (const lar_yaml *entry = value->first; !status && entry; entry = entry->next)
        status = mark_entry(scene, entry, kind, false, mark);
    return status;
}

static lar_status select_all(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                             uint8_t *mark) {
    size_t count = lar_scene_mark_count(scene, kind);
    lar_status status = check_children(scene, value);
    uint8_t *common = status ? NULL : lar_calloc(count, 1), *one = NULL;
    if (common) one = lar_calloc(count, 1);
    if (!status && !one) status = lar_scene_no_memory(scene, count);
    for (const lar_yaml *entry = value->first; !status && entry; entry = entry->next) {
        memset(one, 0, count);
        status = mark_entry(scene, entry, kind, false, one);
        for (size_t i = 0; i < count; i++)
            common[i] = entry == value->first ? one[i] : common[i] & one[i];
    }
    for (size_t i = 0; !status && i < count; i++) mark[i] |= common[i];
    free(common);
    free(one);
    return status;
}

/* What is not selected: of nodes and elements all others, of faces the others on the boundary. */
static lar_status select_not(lar_scene *scene, const lar_yaml *value, lar_set_kind kind,
                             uint8_t *mark) {
    size_t count = lar_scene_mark_count(scene, kind);
    uint8_t *given = lar_calloc(count, 1);
    if (!given) return lar_scene_no_memory(scene, count);
    lar_status status = mark_entry(scene, value, kind, false, given);
    if (!status && kind == LAR_SET_FACES) status = lar_scene_need_boundary(scene);
    if (!status && kind == LAR_SET_FACES)
        for (int32_t b = 0; b < scene->boundary_count; b++)
            mark[scene->boundary[b]] |= !given[scene->boundary[b]];
    else if (!status)
        for (size_t i = 0; i < count; i++) mark[i] |= !given[i];
    free(given);
    return status;
}

static const char *const selector_name[] = {"box", "sphere",  "plane", "nearest", "list", "tag",
                                            "set", "surface", "all",   "any",     "not",  NULL};
static selector_function *const selector[] = {
    select_box, select_sphere,  select_plane, select_nearest, select_list, lar_scene_mark_tag,
    select_set, select_surface, select_all,   select_any,     select_not};

static lar_status mark_selector(lar_scene *scene, const lar_yaml *node, lar_set_kind kind,
                                uint8_t *mark) {
    lar_status status = lar_scene_keys(scene, node, "a selector", selector_name);
    if (status) return status;
    if (node->count != 1)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "a selector has one key and this one has %d; join several with "
                              "{all: [...]} or {any: [...]}",
                              node->count);
    int i = 0;
    while (strcmp(selector_name[i], node->first->key->text) != 0) i++;
    return selector[i](scene, node->first, kind, mark);
}

/* ---- what stands after nodes:, elements:, faces: and cells: -------------------------------- */

/* Nobody who names a set `all` expects the word to pass it over. */
static lar_status notice_own_all(const lar_scene *scene, const lar_yaml *node, lar_set_kind kind) {
    const lar_set *own = lar_mesh_find_set(&scene->model->mesh, "all", kind);
    if (!own || (size_t)own->count == lar_scene_mark_count(scene, kind)) return LAR_OK;
    return lar_model_notice(scene->model, scene->error,
                            "%.300s:%d: all means everything here, and the mesh has a set of this "
                            "name; write { set: all } for the mesh's own",
                            scene->path, node->line);
}

static lar_status mark_all(lar_scene *scene, const lar_yaml *node, lar_set_kind kind,
                           uint8_t *mark) {
    lar_status status = notice_own_all(scene, node, kind);
    if (status) return status;
    if (kind == LAR_SET_FACES) return lar_scene_mark_surface(scene, kind, mark);
    memset(mark, 1, lar_scene_mark_count(scene, kind));
    return LAR_OK;
}

static lar_status mark_integer(lar_scene *scene, const lar_yaml *node, lar_set_kind kind, bool tags,
                               uint8_t *mark) {
    if (tags) return lar_scene_mark_tag(scene, node, kind, mark);
    if (kind == LAR_SET_NODES) return lar_scene_mark_id(scene, node, kind, mark);
    return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                          "a number alone says too little here; write %s, or quotes around the "
                          "name of a set",
                          kind == LAR_SET_FACES ? "{tag: N} for the surface of tagged elements"
                                                : "{tag: N} or {list: [N, ...]}");
}

/* In quotes, as JSON has all words, it is a set of the mesh where that has one of this name. */
static bool means_all(const lar_scene *scene, const lar_yaml *node, const char *name,
                      lar_set_kind kind) {
    if (strcmp(name, "all") != 0) return false;
    return !node->quoted || !lar_mesh_find_set(&scene->model->mesh, name, kind);
}

/* One entry: "all", a set name, an integer or a selector. */
static lar_status mark_entry(lar_scene *scene, const lar_yaml *node, lar_set_kind kind, bool tags,
                             uint8_t *mark) {
    int64_t ignored;
    const char *name;
    if (node->kind == LAR_YAML_MAPPING) return mark_selector(scene, node, kind, mark);
    if (lar_scene_is_integer(node, &ignored)) return mark_integer(scene, node, kind, tags, mark);
    lar_status status = lar_scene_text(
        scene, node, "all, the name of a set, a number, or a selector such as {box: ...}", &name);
    if (status) return status;
    if (means_all(scene, node, name, kind)) return mark_all(scene, node, kind, mark);
    return lar_scene_mark_set(scene, node, kind, mark);
}

static int32_t *indices_of(const uint8_t *mark, size_t size, int32_t *count) {
    size_t used = 0;
    for (size_t i = 0; i < size; i++) used += mark[i];
    int32_t *index = lar_calloc(used, sizeof *index);
    if (!index) return NULL;
    *count = 0;
    for (const uint8_t *at = mark; (size_t)*count < used; at++) {
        at = memchr(at, 1, size - (size_t)(at - mark)); /* of a few among many */
        index[(*count)++] = (int32_t)(at - mark);
    }
    return index;
}

lar_status lar_scene_select(lar_scene *scene, const lar_yaml *node, lar_set_kind kind, bool tags,
                            int32_t **index, int32_t *count) {
    static const char *const plural[] = {"node", "element", "boundary face"};
    size_t size = lar_scene_mark_count(scene, kind);
    uint8_t *mark = lar_calloc(size, 1);
    if (!mark) return lar_scene_no_memory(scene, size);
    lar_status status = LAR_OK;
    if (node->kind == LAR_YAML_LIST)
        for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
            status = mark_entry(scene, entry, kind, tags, mark);
    else
        status = mark_entry(scene, node, kind, tags, mark);
    int32_t *found = NULL, found_count = 0;
    if (!status) {
        found = indices_of(mark, size, &found_count);
        if (!found) status = lar_scene_no_memory(scene, size * sizeof *found);
    }
    free(mark);
    if (!status && found_count == 0)
        status = lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                                "this selects no %s at all; check the place, the units (metres, "
                                "after scaling) and the names",
                                plural[kind]);
    if (status) {
        free(found);
        return status;
    }
    *index = found;
    *count = found_count;
    return LAR_OK;
}

lar_status lar_scene_select_nodes(lar_scene *scene, const lar_yaml *node, lar_node_list *nodes) {
    return lar_scene_select(scene, node, LAR_SET_NODES, false, &nodes->node, &nodes->count);
}
