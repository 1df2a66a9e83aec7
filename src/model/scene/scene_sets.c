#include "model/scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const kind_word[] = {"node", "element", "face"};

size_t lar_scene_mark_count(const lar_scene *scene, lar_set_kind kind) {
    const lar_mesh *mesh = &scene->model->mesh;
    if (kind == LAR_SET_NODES) return (size_t)mesh->node_count;
    return (size_t)mesh->element_count * (kind == LAR_SET_FACES ? 6 : 1);
}

lar_status lar_scene_need_boundary(lar_scene *scene) {
    if (scene->boundary) return LAR_OK;
    return lar_mesh_boundary(&scene->model->mesh, &scene->boundary, &scene->boundary_count,
                             scene->error);
}

lar_status lar_scene_need_surface(lar_scene *scene) {
    lar_model *model = scene->model;
    if (model->surface.face_count) return LAR_OK;
    return lar_surface_build(&model->mesh, &model->surface, scene->error);
}

void lar_scene_sets_clear(lar_scene *scene) {
    lar_id_map_clear(&scene->node_ids);
    lar_id_map_clear(&scene->element_ids);
    free(scene->boundary);
    scene->boundary = NULL;
}

/* ---- one kind of set seen as another -------------------------------------------------------- */

static void mark_nodes_of_elements(const lar_mesh *mesh, const uint8_t *elements, uint8_t *nodes) {
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; elements[e] && a < 8; a++) nodes[mesh->element[e][a]] = 1;
}

static void mark_nodes_of_face(const lar_mesh *mesh, int32_t face, uint8_t *nodes) {
    for (int i = 0; i < 4; i++) nodes[mesh->element[face / 6][lar_face_node[face % 6][i]]] = 1;
}

/* Boundary faces whose four nodes are all marked. */
static void mark_faces_of_nodes(const lar_scene *scene, const uint8_t *nodes, uint8_t *faces) {
    const lar_mesh *mesh = &scene->model->mesh;
    for (int32_t b = 0; b < scene->boundary_count; b++) {
        int32_t face = scene->boundary[b];
        bool inside = true;
        for (int i = 0; i < 4; i++)
            inside = inside && nodes[mesh->element[face / 6][lar_face_node[face % 6][i]]];
        if (inside) faces[face] = 1;
    }
}

static void mark_elements_of_nodes(const lar_mesh *mesh, const uint8_t *nodes, uint8_t *elements) {
    for (int32_t e = 0; e < mesh->element_count; e++) {
        bool inside = true;
        for (int a = 0; a < 8; a++) inside = inside && nodes[mesh->element[e][a]];
        if (inside) elements[e] = 1;
    }
}

/* Turns marks of one kind into marks of another; the boundary is known where faces are asked. */
static void convert(const lar_scene *scene, lar_set_kind from, const uint8_t *given,
                    lar_set_kind to, uint8_t *mark) {
    const lar_mesh *mesh = &scene->model->mesh;
    size_t count = lar_scene_mark_count(scene, from);
    if (from == LAR_SET_NODES && to == LAR_SET_FACES) mark_faces_of_nodes(scene, given, mark);
    if (from == LAR_SET_NODES && to == LAR_SET_ELEMENTS) mark_elements_of_nodes(mesh, given, mark);
    if (from == LAR_SET_ELEMENTS && to == LAR_SET_NODES) mark_nodes_of_elements(mesh, given, mark);
    if (from == LAR_SET_ELEMENTS && to == LAR_SET_FACES)
        for (int32_t b = 0; b < scene->boundary_count; b++)
            if (given[scene->boundary[b] / 6]) mark[scene->boundary[b]] = 1;
    if (from == LAR_SET_FACES)
        for (size_t f = 0; f < count; f++) {
            if (!given[f]) continue;
            if (to == LAR_SET_ELEMENTS)
                mark[f / 6] = 1;
            else
                mark_nodes_of_face(mesh, (int32_t)f, mark);
        }
}

static lar_status mark_converted(lar_scene *scene, lar_set_kind from, const uint8_t *given,
                                 lar_set_kind to, uint8_t *mark) {
    if (to == LAR_SET_FACES) {
        lar_status status = lar_scene_need_boundary(scene);
        if (status) return status;
    }
    if (from != to)
        convert(scene, from, given, to, mark);
    else
        for (size_t i = 0; i < lar_scene_mark_count(scene, to); i++) mark[i] |= given[i];
    return LAR_OK;
}

lar_status lar_scene_mark_surface(lar_scene *scene, lar_set_kind kind, uint8_t *mark) {
    lar_status status = lar_scene_need_boundary(scene);
    for (int32_t b = 0; !status && b < scene->boundary_count; b++) {
        int32_t face = scene->boundary[b];
        if (kind == LAR_SET_FACES)
            mark[face] = 1;
        else if (kind == LAR_SET_ELEMENTS)
            mark[face / 6] = 1;
        else
            mark_nodes_of_face(&scene->model->mesh, face, mark);
    }
    return status;
}

/* ---- by name ------------------------------------------------------------------------------ */

static lar_status unknown_set(const lar_scene *scene, const lar_yaml *name) {
    const lar_mesh *mesh = &scene->model->mesh;
    const lar_yaml *sets = lar_yaml_get(scene->root, "sets");
    for (const lar_yaml *set = sets ? sets->first : NULL; set; set = set->next) {
        const lar_yaml *later = lar_yaml_get(set, "name");
        if (later && later->kind == LAR_YAML_SCALAR && strcmp(later->text, name->text) == 0)
            return lar_scene_fail(scene, name, LAR_ERROR_MODEL,
                                  "the set \"%.60s\" is defined only in line %d; move it up",
                                  name->text, set->line);
    }
    if (mesh->set_count == 0)
        return lar_scene_fail(scene, name, LAR_ERROR_MODEL,
                              "the set \"%.60s\" is unknown, the mesh has no sets; define it, for "
                              "example sets: [ { name: %.60s, nodes: { box: [[-1, -1, 0], "
                              "[1, 1, 0.01]] } } ], in metres",
                              name->text, name->text);
    const char **names = lar_calloc((size_t)mesh->set_count, sizeof *names);
    if (!names) return lar_scene_no_memory(scene, sizeof *names * (size_t)mesh->set_count);
    for (int32_t i = 0; i < mesh->set_count; i++) names[i] = mesh->set[i].name;
    lar_status status = lar_scene_unknown(scene, name, LAR_ERROR_MODEL, "the set", "the sets are",
                                          names, mesh->set_count);
    free(names);
    return status;
}

/* The set of that name: of the kind asked for when there is one, otherwise of another kind. */
static const lar_set *find_set(const lar_mesh *mesh, const char *name, lar_set_kind kind) {
    static const lar_set_kind order[3][3] = {
        [LAR_SET_NODES] = {LAR_SET_NODES, LAR_SET_FACES, LAR_SET_ELEMENTS},
        [LAR_SET_ELEMENTS] = {LAR_SET_ELEMENTS, LAR_SET_NODES, LAR_SET_FACES},
        [LAR_SET_FACES] = {LAR_SET_FACES, LAR_SET_NODES, LAR_SET_ELEMENTS}};
    const lar_set *set = NULL;
    for (int i = 0; !set && i < 3; i++) set = lar_mesh_find_set(mesh, name, order[kind][i]);
    return set;
}

lar_status lar_scene_mark_set(lar_scene *scene, const lar_yaml *name, lar_set_kind kind,
                              uint8_t *mark) {
    const lar_set *set = find_set(&scene->model->mesh, name->text, kind);
    if (!set) return unknown_set(scene, name);
    size_t count = lar_scene_mark_count(scene, set->kind);
    uint8_t *own = lar_calloc(count, 1);
    if (!own) return lar_scene_no_memory(scene, count);
    for (int32_t i = 0; i < set->count; i++) own[set->index[i]] = 1;
    lar_status status = mark_converted(scene, set->kind, own, kind, mark);
    free(own);
    return status;
}

/* ---- by number ---------------------------------------------------------------------------- */

static lar_status unknown_tag(const lar_scene *scene, const lar_yaml *node) {
    enum { MAX = 20 };
    const lar_mesh *mesh = &scene->model->mesh;
    int32_t tag[MAX];
    int count = 0;
    for (int32_t e = 0; e < mesh->element_count && count < MAX; e++) {
        int i = 0;
        while (i < count && tag[i] != mesh->element_tag[e]) i++;
        if (i == count) tag[count++] = mesh->element_tag[e];
    }
    char list[MAX * 13] = "";
    size_t used = 0;
    for (int i = 0; i < count; i++)
        used +=
            (size_t)snprintf(list + used, sizeof list - used, "%s%d", i ? ", " : "", (int)tag[i]);
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                          "no element has the tag %.24s; the tags in the mesh are %s%s", node->text,
                          list, count == MAX ? ", ..." : "");
}

lar_status lar_scene_mark_tag(lar_scene *scene, const lar_yaml *node, lar_set_kind kind,
                              uint8_t *mark) {
    const lar_mesh *mesh = &scene->model->mesh;
    int64_t tag;
    lar_status status =
        lar_scene_integer(scene, node, "an integer, the tag of elements in the mesh file", &tag);
    if (status) return status;
    uint8_t *own = lar_calloc((size_t)mesh->element_count, 1);
    if (!own) return lar_scene_no_memory(scene, (size_t)mesh->element_count);
    bool any = false;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        own[e] = mesh->element_tag[e] == tag;
        any = any || own[e];
    }
    status =
        any ? mark_converted(scene, LAR_SET_ELEMENTS, own, kind, mark) : unknown_tag(scene, node);
    free(own);
    return status;
}

lar_status lar_scene_mark_id(lar_scene *scene, const lar_yaml *node, lar_set_kind kind,
                             uint8_t *mark) {
    const lar_mesh *mesh = &scene->model->mesh;
    bool nodes = kind == LAR_SET_NODES;
    lar_id_map *map = nodes ? &scene->node_ids : &scene->element_ids;
    const int64_t *ids = nodes ? mesh->node_id : mesh->element_id;
    int32_t count = nodes ? mesh->node_count : mesh->element_count;
    lar_id_clash clash;
    if (!map->count && !lar_id_map_build(map, ids, count, sizeof *ids, &clash)) {
        lar_id_map_clear(map);
        return lar_scene_no_memory(scene, (size_t)count * sizeof *ids);
    }
    int64_t id;
    lar_status status = lar_scene_integer(scene, node, "the number of a node or element", &id);
    if (status) return status;
    int32_t index = lar_id_map_find(map, id);
    if (index < 0) {
        int64_t low = ids[0], high = ids[0];
        for (int32_t i = 1; i < count; i++) {
            if (ids[i] < low) low = ids[i];
            if (ids[i] > high) high = ids[i];
        }
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "there is no %s %lld in the mesh; its %d %ss have numbers from %lld "
                              "to %lld",
                              kind_word[kind], (long long)id, (int)count, kind_word[kind],
                              (long long)low, (long long)high);
    }
    mark[index] = 1;
    return LAR_OK;
}

/* ---- the key `sets` ----------------------------------------------------------------------- */

static lar_status read_set(lar_scene *scene, const lar_yaml *node) {
    static const char *const keys[] = {"name", "nodes", "elements", "faces", NULL};
    lar_mesh *mesh = &scene->model->mesh;
    const lar_yaml *name_node;
    const char *name;
    lar_status status = lar_scene_keys(scene, node, "a set", keys);
    if (!status) status = lar_scene_need(scene, node, "a set", "name", "name: base", &name_node);
    if (!status) status = lar_scene_text(scene, name_node, "the name of the set", &name);
    if (status) return status;
    const lar_yaml *value = NULL;
    lar_set_kind kind = LAR_SET_NODES;
    for (int i = 0; i < 3; i++) {
        const lar_yaml *found = lar_yaml_get(node, keys[1 + i]);
        if (!found) continue;
        if (value)
            return lar_scene_fail(scene, found->key, LAR_ERROR_FORMAT,
                                  "a set holds nodes, elements or faces, one of the three; make "
                                  "two sets (they may have the same name)");
        value = found;
        kind = (lar_set_kind)i;
    }
    if (!value)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "a set needs the key \"nodes\", \"elements\" or \"faces\"; add one, "
                              "for example nodes: {surface: true}");
    if (strcmp(name, "all") == 0)
        return lar_scene_fail(scene, name_node, LAR_ERROR_MODEL,
                              "\"all\" always means everything; choose another name");
    if (lar_mesh_find_set(mesh, name, kind))
        return lar_scene_fail(scene, name_node, LAR_ERROR_MODEL,
                              "there is already a %s set named \"%.60s\"; choose another name",
                              kind_word[kind], name);
    int32_t *index, count;
    status = lar_scene_select(scene, value, kind, false, &index, &count);
    if (status) return status;
    return lar_mesh_add_set(mesh, name, kind, index, count, scene->error);
}

lar_status lar_scene_read_sets(lar_scene *scene, const lar_yaml *node) {
    lar_status status = lar_scene_list(scene, node, "sets, {name: base, nodes: ...}");
    for (const lar_yaml *set = node->first; !status && set; set = set->next)
        status = read_set(scene, set);
    return status;
}
