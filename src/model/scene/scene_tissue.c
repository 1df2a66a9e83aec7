/* A tissue file: law, density, stiffness and viscosity of a material in a file of its own, as
 * `lariat fit` writes them. It is read by the functions that read a material, as if its keys stood
 * in the scene; its sentences name its own lines. */
#include "model/scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* The entry has no key that the file would give; what lies in space is the scene's to say. */
static lar_status check_entry(const lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"cells", "tissue", "name", "fibres", NULL};
    return lar_scene_keys(scene, entry, "a material with a tissue file", keys);
}

bool lar_scene_is_tissue(const lar_scene *scene) {
    return lar_yaml_get(scene->root, "lariat-tissue") != NULL;
}

static lar_status check_version(const lar_scene *file) {
    const lar_yaml *version = NULL;
    int64_t number;
    lar_status status = lar_scene_need(file, file->root, "a tissue file", "lariat-tissue",
                                       "lariat-tissue: 1", &version);
    if (status || (lar_scene_is_integer(version, &number) && number == 1)) return status;
    return lar_scene_fail(file, version, LAR_ERROR_UNSUPPORTED,
                          "lariat-tissue: expected 1, the version that this program reads");
}

lar_status lar_tissue_read(const char *path, const lar_bytes *bytes, lar_material *material,
                           lar_error *error) {
    lar_yaml_tree tree;
    lar_status status = lar_yaml_parse(path, bytes, &tree, error);
    if (status) return status;
    lar_scene file = {.path = path, .root = tree.root, .error = error};
    status = check_version(&file);
    if (!status) status = lar_scene_read_material(&file, tree.root, material);
    lar_yaml_clear(&tree);
    return status;
}

lar_status lar_scene_read_tissue(lar_scene *scene, const lar_yaml *entry, lar_material *material) {
    const lar_yaml *at = lar_yaml_get(entry, "tissue");
    const char *name;
    lar_bytes bytes;
    lar_error own = {0};
    lar_status status = check_entry(scene, entry);
    if (!status) status = lar_scene_text(scene, at, "the name of a tissue file (.yaml)", &name);
    if (status) return status;
    if (scene->given)
        return lar_scene_fail(scene, at, LAR_ERROR_UNSUPPORTED,
                              "tissue: a scene from memory reads no files; write law and "
                              "parameters here");
    char *path = lar_path_beside(scene->path, name);
    if (!path) return lar_scene_no_memory(scene, strlen(name));
    status = lar_bytes_read(path, &bytes, &own);
    if (!status) {
        status = lar_tissue_read(path, &bytes, material, &own);
        lar_bytes_free(&bytes);
    }
    free(path);
    return status ? lar_scene_fail(scene, at, status, "%s", own.message) : LAR_OK;
}
