#include "cli/mesh_real_time.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "study/real_time.h"

enum { START = 2000, MIN = 60, MAX = 200000, ROUNDS = 5 };
static const double AIM = 0.9;    /* of what holds: the estimate is one */
static const double ENOUGH = 0.8; /* of what holds */
static const double LONG = 0.1;   /* a measurement on one core [s] */

const char *const cli_mesh_endings[] = {".yaml", ".vtu", "_surface.vtp", NULL};

/* ---- a mesh, measured ------------------------------------------------------------------------ */

static void remove_files(const char *folder, const char *stem) {
    for (int i = 0; cli_mesh_endings[i]; i++) {
        char path[4096];
        if (snprintf(path, sizeof path, "%s/%s%s", folder, stem, cli_mesh_endings[i]) <
            (int)sizeof path)
            unlink(path);
    }
    rmdir(folder);
}

/* The starter scene in a folder of its own, read and measured as lariat info would. */
static lar_status measure(lar_meshing *meshing, lar_real_time *found, lar_error *error) {
    const char *root = getenv("TMPDIR"), *scene = NULL;
    char folder[4096];
    lar_meshing_info info;
    lar_model *model = NULL;
    snprintf(folder, sizeof folder, "%s/lariat-mesh-XXXXXX", root && *root ? root : "/tmp");
    if (!mkdtemp(folder)) {
        *error = (lar_error){.status = LAR_ERROR_IO};
        snprintf(
            error->message, sizeof error->message,
            "%.900s: a folder for trying meshes cannot be made: %s; set TMPDIR to one that can",
            folder, strerror(errno));
        return LAR_ERROR_IO;
    }
    lar_meshing_inspect(meshing, &info);
    lar_status status = lar_meshing_write(meshing, folder, &scene, error);
    if (!status) status = lar_model_open(scene, &model, error);
    if (!status) status = lar_real_time_measure(model, LONG, found, error);
    lar_model_destroy(model);
    remove_files(folder, info.name);
    return status;
}

/* ---- the search ------------------------------------------------------------------------------ */

/* `kept` is the better one of both; the other one goes. */
static void keep_better(lar_meshing **kept, int32_t *kept_elements, int *kept_holds,
                        lar_meshing *next, int32_t elements, int holds) {
    bool better =
        !*kept || (holds && !*kept_holds) ||
        (holds == *kept_holds && (holds ? elements > *kept_elements : elements < *kept_elements));
    lar_meshing_destroy(better ? *kept : next);
    if (!better) return;
    *kept = next;
    *kept_elements = elements;
    *kept_holds = holds;
}

lar_status cli_mesh_real_time(cli_make_mesh *make, void *context, lar_meshing **meshing, int *holds,
                              lar_error *error) {
    lar_meshing *kept = NULL;
    int32_t elements = 0;
    double wanted = START;
    lar_status status = LAR_OK;
    *holds = 0;
    for (int round = 0; round < ROUNDS && !status; round++) {
        lar_meshing *next = NULL;
        lar_meshing_info info;
        lar_real_time found;
        status = make(context, (int32_t)wanted, &next, error);
        if (!status) status = measure(next, &found, error);
        if (status) {
            lar_meshing_destroy(next);
            break;
        }
        lar_meshing_inspect(next, &info);
        cli_complain(&cli_mesh, CLI_DONE, "note: %d elements: %.2g times as fast as real time",
                     (int)info.elements, found.divided);
        keep_better(&kept, &elements, holds, next, info.elements, info.elements <= found.holds);
        if (*holds && elements >= ENOUGH * found.holds) break;
        double asked = AIM * found.holds * wanted / info.elements; /* as meshing comes out */
        asked = fmin(MAX, fmax(MIN, asked));
        if (asked == wanted) break;
        wanted = asked;
    }
    if (status) lar_meshing_destroy(kept), kept = NULL;
    *meshing = kept;
    return status;
}
