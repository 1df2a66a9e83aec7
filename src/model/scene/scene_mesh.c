#include "model/scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/mesh/arrays.h"

/* ---- putting two meshes together ------------------------------------------------------------ */

/* What must be added to the ids of `more`, so that no id is in use: its numbering goes on after
 * the largest id so far. 0 where the two do not overlap. */
static int64_t id_shift(const int64_t *ids, int32_t count, const int64_t *more,
                        int32_t more_count) {
    int64_t last = ids[0], low = more[0];
    for (int32_t i = 1; i < count; i++) last = ids[i] > last ? ids[i] : last;
    for (int32_t i = 1; i < more_count; i++) low = more[i] < low ? more[i] : low;
    return low > last ? 0 : last + 1 - low;
}

static bool ids_fit(const int64_t *ids, int32_t count) {
    const int64_t limit = INT64_MAX / 4;
    for (int32_t i = 0; i < count; i++)
        if (ids[i] > limit || ids[i] < -limit) return false;
    return true;
}

static bool grow(void *array, size_t count, size_t size) {
    void *old;
    memcpy(&old, array, sizeof old);
    void *grown = count > SIZE_MAX / size ? NULL : realloc(old, count * size);
    if (grown) memcpy(array, &grown, sizeof grown);
    return grown != NULL;
}

static bool grow_mesh(lar_mesh *mesh, int32_t nodes, int32_t elements) {
    size_t n = (size_t)nodes, e = (size_t)elements;
    return grow(&mesh->position, n, sizeof *mesh->position) &&
           grow(&mesh->node_id, n, sizeof *mesh->node_id) &&
           grow(&mesh->element, e, sizeof *mesh->element) &&
           grow(&mesh->element_id, e, sizeof *mesh->element_id) &&
           grow(&mesh->element_tag, e, sizeof *mesh->element_tag) &&
           (!mesh->fibre || grow(&mesh->fibre, e, sizeof *mesh->fibre)) &&
           (!mesh->second || grow(&mesh->second, e, sizeof *mesh->second));
}

/* Directions of one family of fibres, where one of the two meshes has some. */
static bool append_family(double (**fibre)[3], int32_t elements, const double (*more)[3],
                          int32_t count) {
    if (!*fibre && !more) return true;
    if (!*fibre) *fibre = lar_calloc((size_t)elements + (size_t)count, sizeof **fibre);
    if (!*fibre) return false;
    for (int32_t e = 0; e < count; e++)
        for (int i = 0; i < 3; i++) (*fibre)[elements + e][i] = more ? more[e][i] : 0;
    return true;
}

static bool append_fibres(lar_mesh *mesh, int32_t elements, const lar_mesh *more) {
    const int32_t count = more->element_count;
    return append_family(&mesh->fibre, elements, (const double(*)[3])more->fibre, count) &&
           append_family(&mesh->second, elements, (const double(*)[3])more->second, count);
}

/* Adds a set of the second mesh, or its entries to the set of that name. */
static lar_status append_set(lar_scene *scene, lar_mesh *mesh, const lar_set *more,
                             int32_t offset) {
    lar_set *into = NULL;
    for (int32_t i = 0; i < mesh->set_count; i++)
        if (mesh->set[i].kind == more->kind && strcmp(mesh->set[i].name, more->name) == 0)
            into = &mesh->set[i];
    int32_t old = into ? into->count : 0;
    size_t total = (size_t)old + (size_t)more->count;
    int32_t *index = lar_calloc(total, sizeof *index);
    if (!index) return lar_scene_no_memory(scene, total * sizeof *index);
    if (old) memcpy(index, into->index, (size_t)old * sizeof *index);
    for (int32_t i = 0; i < more->count; i++) index[old + i] = more->index[i] + offset;
    if (!into)
        return lar_mesh_add_set(mesh, more->name, more->kind, index, more->count, scene->error);
    free(into->index);
    into->index = index;
    into->count = (int32_t)total;
    return LAR_OK;
}

static lar_status append_mesh(lar_scene *scene, const lar_yaml *node, const lar_mesh *more) {
    lar_mesh *mesh = &scene->model->mesh;
    const int32_t nodes = mesh->node_count, elements = mesh->element_count;
    /* Faces are element * 6 + face in 32 bits. */
    if ((int64_t)nodes + more->node_count > INT32_MAX ||
        ((int64_t)elements + more->element_count) > INT32_MAX / 6 ||
        !ids_fit(mesh->node_id, nodes) || !ids_fit(more->node_id, more->node_count) ||
        !ids_fit(mesh->element_id, elements) || !ids_fit(more->element_id, more->element_count))
        return lar_scene_fail(scene, node, LAR_ERROR_UNSUPPORTED,
                              "the meshes together are too large, or their numbers are; at most "
                              "357 million elements can be numbered");
    if (!grow_mesh(mesh, nodes + more->node_count, elements + more->element_count) ||
        !append_fibres(mesh, elements, more))
        return lar_scene_no_memory(scene, (size_t)more->node_count * sizeof *mesh->position);
    int64_t node_shift = id_shift(mesh->node_id, nodes, more->node_id, more->node_count);
    int64_t element_shift =
        id_shift(mesh->element_id, elements, more->element_id, more->element_count);
    for (int32_t n = 0; n < more->node_count; n++) {
        memcpy(mesh->position[nodes + n], more->position[n], sizeof *mesh->position);
        mesh->node_id[nodes + n] = more->node_id[n] + node_shift;
    }
    for (int32_t e = 0; e < more->element_count; e++) {
        for (int a = 0; a < 8; a++) mesh->element[elements + e][a] = more->element[e][a] + nodes;
        mesh->element_id[elements + e] = more->element_id[e] + element_shift;
        mesh->element_tag[elements + e] = more->element_tag[e];
    }
    mesh->node_count += more->node_count;
    mesh->element_count += more->element_count;
    lar_status status = LAR_OK;
    for (int32_t i = 0; !status && i < more->set_count; i++) {
        static const int32_t faces = 6;
        lar_set_kind kind = more->set[i].kind;
        int32_t offset = kind == LAR_SET_NODES ? nodes : elements;
        if (kind == LAR_SET_FACES) offset *= faces;
        status = append_set(scene, mesh, &more->set[i], offset);
    }
    return status;
}

/* ---- the key `mesh` ----------------------------------------------------------------------- */

/* The reader's sentence names the mesh file; the scene's line is put before it. */
static lar_status read_file(lar_scene *scene, const lar_yaml *node, const char *name, double scale,
                            lar_mesh *mesh) {
    char *path = lar_path_beside(scene->path, name);
    char **kept = path ? LAR_MODEL_APPEND(scene->model, mesh_file) : NULL;
    if (!kept) {
        free(path);
        return lar_scene_no_memory(scene, strlen(name));
    }
    *kept = path;
    lar_error own = {0};
    lar_status status = scene->read_mesh(path, scale, mesh, &own);
    if (status) return lar_scene_fail(scene, node, status, "%s", own.message);
    if (mesh->node_count <= 0 || mesh->element_count <= 0)
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "the mesh \"%.200s\" has no hexahedra; name another file", name);
    return LAR_OK;
}

static lar_status read_one(lar_scene *scene, const lar_yaml *node, double scale, lar_mesh *mesh) {
    static const char *const keys[] = {"file", "tag", NULL};
    const lar_yaml *file = node, *tag_node = NULL;
    int64_t tag = 0;
    lar_status status = LAR_OK;
    if (node->kind == LAR_YAML_MAPPING) {
        status = lar_scene_keys(scene, node, "a mesh", keys);
        if (!status)
            status = lar_scene_need(scene, node, "a mesh", "file", "file: organ.vtu", &file);
        tag_node = lar_yaml_get(node, "tag");
    }
    const char *name;
    if (!status)
        status = lar_scene_text(scene, file, "the name of a mesh file (.vtu .vtk .msh .inp .feb)",
                                &name);
    if (!status && tag_node)
        status =
            lar_scene_integer(scene, tag_node, "an integer for all elements of this mesh", &tag);
    if (!status && (tag > INT32_MAX || tag < INT32_MIN))
        status = lar_scene_fail(scene, tag_node, LAR_ERROR_FORMAT,
                                "tag: %lld is too large; use a small integer", (long long)tag);
    if (!status) status = read_file(scene, file, name, scale, mesh);
    for (int32_t e = 0; !status && tag_node && e < mesh->element_count; e++)
        mesh->element_tag[e] = (int32_t)tag;
    return status;
}

double lar_scene_size(const lar_mesh *mesh) {
    double edge[3];
    for (int i = 0; i < 3; i++) {
        double low = mesh->position[0][i], high = low;
        for (int32_t n = 1; n < mesh->node_count; n++) {
            low = fmin(low, mesh->position[n][i]);
            high = fmax(high, mesh->position[n][i]);
        }
        edge[i] = high - low;
    }
    return hypot(hypot(edge[0], edge[1]), edge[2]);
}

lar_status lar_scene_check_mesh(const lar_scene *scene, const lar_yaml **mesh) {
    if (!scene->given) {
        lar_status status =
            lar_scene_need(scene, scene->root, "a scene", "mesh", "mesh: organ.vtu", mesh);
        if (status || !lar_scene_is_word(*mesh, "given")) return status;
        return lar_scene_fail(scene, *mesh, LAR_ERROR_MODEL,
                              "mesh: given stands for a mesh from arrays, and none were given with "
                              "this scene; name its mesh file, for example mesh: organ.vtu");
    }
    *mesh = lar_yaml_get(scene->root, "mesh");
    const lar_yaml *surface = lar_yaml_get(scene->root, "surface");
    if (*mesh && !lar_scene_is_word(*mesh, "given"))
        return lar_scene_fail(scene, *mesh, LAR_ERROR_MODEL,
                              "mesh: the mesh of this scene was given as arrays, and no file is "
                              "read besides; remove this key, or write mesh: given");
    if (surface)
        return lar_scene_fail(scene, surface, LAR_ERROR_UNSUPPORTED,
                              "surface: a model from arrays reads no file; remove this key");
    return LAR_OK;
}

lar_status lar_scene_read_meshes(lar_scene *scene, const lar_yaml *node, double scale) {
    lar_mesh *mesh = &scene->model->mesh;
    if (scene->given) {
        lar_status taken = lar_mesh_from_arrays(scene->given, scale, mesh, scene->error);
        if (!taken) scene->size = lar_scene_size(mesh);
        return taken;
    }
    bool list = node->kind == LAR_YAML_LIST;
    lar_status status = LAR_OK;
    if (list && node->count == 0)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "mesh: the list is empty; name at least one file");
    for (const lar_yaml *entry = list ? node->first : node; !status && entry;
         entry = list ? entry->next : NULL) {
        if (mesh->element_count == 0) {
            status = read_one(scene, entry, scale, mesh);
            continue;
        }
        lar_mesh more = {0};
        status = read_one(scene, entry, scale, &more);
        if (!status) status = append_mesh(scene, entry, &more);
        lar_mesh_clear(&more);
    }
    if (!status) scene->size = lar_scene_size(mesh);
    return status;
}
