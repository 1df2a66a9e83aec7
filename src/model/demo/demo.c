/* Writes the demonstration organ: FOLDER/uterus.vtu and its scenes. */
#include "model/demo/demo.h"

#include <stdlib.h>
#include <string.h>

#include "base/file/folder.h"
#include "base/file/part_file.h"
#include "model/demo/demo_scene.h"
#include "model/format/mesh_io.h"

static lar_status write_scene(const char *folder, const lar_demo_scene *scene, lar_error *error) {
    char *path = lar_folder_join(folder, scene->name);
    if (!path) return lar_fail_memory(error, strlen(folder), "a path");
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    for (int i = 0; !status && i < LAR_DEMO_SCENE_PARTS; i++)
        status = lar_part_print(&out, "%s", scene->part[i]);
    status = lar_part_close(&out, status);
    free(path);
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
