/* Writes the demonstration organ: FOLDER/uterus.vtu and its scenes. */
#include "model/demo/demo.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/folder.h"
#include "model/demo/demo_scene.h"
#include "model/format/mesh_io.h"

/* First under another name, so that a full disk leaves no half file. */
static lar_status write_text(const char *path, const char *part, const lar_demo_scene *scene,
                             lar_error *error) {
    FILE *file = fopen(part, "wb");
    bool good = file != NULL;
    for (int i = 0; good && i < LAR_DEMO_SCENE_PARTS; i++) good = fputs(scene->part[i], file) >= 0;
    int cause = errno;
    if (file && fclose(file) != 0 && good) good = false, cause = errno;
    if (good && rename(part, path) != 0) good = false, cause = errno;
    if (good) return LAR_OK;
    if (file) remove(part);
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: cannot be written: %s; check the folder, its permissions and the free "
                    "space",
                    path, strerror(cause));
}

static lar_status write_scene(const char *folder, const lar_demo_scene *scene, lar_error *error) {
    char *path = lar_folder_join(folder, scene->name);
    char *part = path ? lar_folder_join(folder, "scene.part") : NULL;
    lar_status status = part ? write_text(path, part, scene, error)
                             : lar_fail_memory(error, strlen(folder), "a path");
    free(path);
    free(part);
    return status;
}

lar_status lar_demo_write(const char *folder, lar_error *error) {
    if (!folder || !*folder)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "no folder is given for the demonstration organ; name one, for example "
                        "demo");
    lar_status status = lar_folder_make(folder, error);
    if (status) return status;
    lar_mesh mesh = {0};
    char *path = lar_folder_join(folder, "uterus.vtu");
    if (!path) status = lar_fail_memory(error, strlen(folder), "a path");
    if (!status) status = lar_demo_mesh(&mesh, error);
    if (!status) status = lar_vtu_write(path, &(lar_vtu_frame){.mesh = &mesh}, error);
    for (int i = 0; !status && i < LAR_DEMO_SCENES; i++)
        status = write_scene(folder, &lar_demo_scene_of[i], error);
    lar_mesh_clear(&mesh);
    free(path);
    return status;
}
