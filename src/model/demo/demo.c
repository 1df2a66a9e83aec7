/* Writes the demonstration organ: FOLDER/uterus.vtu and its scenes. */
#include "model/demo/demo.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file/folder.h"
#include "base/file/part_file.h"
#include "model/format/mesh_io.h"

/* Whether a plain file holds anything but the scene. One that cannot be read may. */
static bool holds_another(const char *path, const lar_demo_scene *scene) {
    struct stat found;
    if (stat(path, &found) != 0 || !S_ISREG(found.st_mode)) return false;
    FILE *file = fopen(path, "rb");
    if (!file) return errno != ENOENT;
    bool same = true;
    for (int i = 0; same && i < LAR_DEMO_SCENE_PARTS; i++)
        for (const char *c = scene->part[i]; same && *c; c++)
            same = getc(file) == (unsigned char)*c;
    same = same && getc(file) == EOF && !ferror(file);
    fclose(file);
    return !same;
}

/* *kept: the file is there, holds another scene and stays. */
static lar_status write_scene(const char *folder, const lar_demo_scene *scene, bool force,
                              bool *kept, lar_error *error) {
    char *path = lar_folder_join(folder, scene->name);
    if (!path) return lar_fail_memory(error, strlen(folder), "a path");
    lar_status status = LAR_OK;
    *kept = !force && holds_another(path, scene);
    if (!*kept) {
        lar_part_file out;
        status = lar_part_open(&out, path, error);
        for (int i = 0; !status && i < LAR_DEMO_SCENE_PARTS; i++)
            status = lar_part_print(&out, "%s", scene->part[i]);
        status = lar_part_close(&out, status);
    }
    free(path);
    return status;
}

lar_status lar_demo_write(const char *folder, lar_error *error) {
    bool kept[LAR_DEMO_SCENES];
    return lar_demo_write_beside(folder, false, kept, error);
}

lar_status lar_demo_write_beside(const char *folder, bool force, bool kept[LAR_DEMO_SCENES],
                                 lar_error *error) {
    for (int i = 0; i < LAR_DEMO_SCENES; i++) kept[i] = false;
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
        status = write_scene(folder, &lar_demo_scene_of[i], force, &kept[i], error);
    lar_mesh_clear(&mesh);
    free(path);
    return status;
}
