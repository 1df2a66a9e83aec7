/* A meshing on disk: mesh, embedded surface, where there is one, and scene, all or none. They are
 * written beside the places that they shall have, and get their names when the last one is whole.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file/folder.h"
#include "meshing/meshing.h"
#include "model/format/mesh_io.h"

enum { MESH, SURFACE, SCENE, FILES };

static char *file_beside(const lar_meshing *m, const char *folder, const char *ending) {
    size_t size = strlen(m->stem) + strlen(ending) + 1;
    char *name = lar_calloc(size, 1), *path = NULL;
    if (name) {
        snprintf(name, size, "%s%s", m->stem, ending);
        path = lar_folder_join(folder, name);
    }
    free(name);
    return path;
}

static bool is_there(const lar_meshing *m, int which) {
    return which != SURFACE || !m->apart;
}

static lar_status write_file(const lar_meshing *m, int which, const char *path, lar_error *error) {
    if (!is_there(m, which)) return LAR_OK;
    if (which == MESH) return lar_vtu_write(path, &(lar_vtu_frame){.mesh = &m->mesh}, error);
    if (which == SURFACE) return lar_vtp_write(path, &m->outer, error);
    return lar_starter_write(m, path, error);
}

static lar_status write_all(const lar_meshing *m, char *const path[FILES], char *const fresh[FILES],
                            lar_error *error) {
    lar_status status = LAR_OK;
    int written = 0;
    for (int i = 0; !status && i < FILES; i++)
        if (is_there(m, i)) status = lar_file_replaceable(path[i], error);
    for (; !status && written < FILES; written += !status)
        status = write_file(m, written, fresh[written], error);
    for (int i = 0; !status && i < FILES; i++)
        if (is_there(m, i) && rename(fresh[i], path[i]) != 0)
            status =
                lar_fail(error, LAR_ERROR_IO,
                         "%s: cannot be given its name: %s; check the folder and what is there "
                         "with that name",
                         path[i], strerror(errno));
    for (int i = 0; status && i < written; i++) remove(fresh[i]);
    return status;
}

lar_status lar_meshing_write(lar_meshing *meshing, const char *folder, const char **scene,
                             lar_error *error) {
    static const char *const ending[FILES] = {".vtu", "_surface.vtp", ".yaml"};
    static const char *const fresh_ending[FILES] = {".vtu.new", "_surface.vtp.new", ".yaml.new"};
    if (!meshing || !folder || !*folder)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_meshing_write needs a meshing and the name of a folder, for example "
                        "liver");
    char *path[FILES], *fresh[FILES];
    bool ready = true;
    for (int i = 0; i < FILES; i++) {
        path[i] = file_beside(meshing, folder, ending[i]);
        fresh[i] = file_beside(meshing, folder, fresh_ending[i]);
        ready = ready && path[i] && fresh[i];
    }
    lar_status status =
        ready ? lar_folder_make(folder, error) : lar_fail_memory(error, strlen(folder), "a path");
    if (!status) status = write_all(meshing, path, fresh, error);
    if (!status) {
        free(meshing->scene);
        meshing->scene = path[SCENE];
        path[SCENE] = NULL;
        if (scene) *scene = meshing->scene;
    }
    for (int i = 0; i < FILES; i++) {
        free(path[i]);
        free(fresh[i]);
    }
    return status;
}
