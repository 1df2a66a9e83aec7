/* The key `surface`: an embedded surface, for display. */
#include "model/scene/scene.h"

#include <stdlib.h>
#include <string.h>

static lar_status read_scale(const lar_scene *scene, const lar_yaml *own, double *scale) {
    const lar_yaml *node = own ? own : lar_yaml_get(scene->root, "scale");
    *scale = 1;
    if (!node) return LAR_OK;
    return lar_scene_positive(scene, node,
                              "a number, metres per unit of the surface's file, for example 0.001 "
                              "for millimetres",
                              scale);
}

lar_status lar_scene_read_surface(lar_scene *scene, const lar_yaml *node) {
    static const char *const keys[] = {"file", "scale", NULL};
    const lar_yaml *file = node, *own_scale = NULL;
    const char *name;
    double scale;
    lar_status status = LAR_OK;
    if (node->kind == LAR_YAML_MAPPING) {
        status = lar_scene_keys(scene, node, "a surface", keys);
        if (!status)
            status = lar_scene_need(scene, node, "a surface", "file", "file: organ.stl", &file);
        own_scale = lar_yaml_get(node, "scale");
    }
    if (!status)
        status =
            lar_scene_text(scene, file, "the name of a surface file (.stl .obj .vtk .vtp)", &name);
    if (!status) status = read_scale(scene, own_scale, &scale);
    if (status) return status;
    char *path = lar_path_beside(scene->path, name);
    if (!path) return lar_scene_no_memory(scene, strlen(name));
    /* Sentences of others name the surface's file; the scene's line is put before it. */
    lar_error own = {0};
    lar_triangles surface = {0};
    status = lar_triangles_read(path, scale, &surface, &own);
    free(path);
    if (!status)
        status =
            lar_embedded_surface_bind(&scene->model->mesh, &surface, &scene->model->embedded, &own);
    return status ? lar_scene_fail(scene, file, status, "%s", own.message) : LAR_OK;
}
