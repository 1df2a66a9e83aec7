/* Fibres of a meshed body, by a rule: region after region, but for bones. */
#include <stdlib.h>

#include "meshing/meshing.h"
#include "model/scene/scene.h"

lar_status lar_starter_lay_fibres(lar_meshing *m, lar_error *error) {
    const size_t elements = (size_t)m->mesh.element_count;
    int32_t *region = lar_calloc(elements, sizeof *region);
    if (!region) return lar_fail_memory(error, elements * sizeof *region, "fibres");
    for (char *c = m->fibres; *c; c++)
        if (*c == '\n' || *c == '\r' || *c == '\t')
            *c = ' '; /* it stands on one line of the scene */
    int count = 0;
    for (size_t e = 0; e < elements; e++) region[e] = -1;
    for (int32_t r = 0; r < m->info.regions; r++) {
        if (m->region[r].held || m->region[r].elements == 0) continue;
        for (size_t e = 0; e < elements; e++)
            if (m->mesh.element_tag[e] == m->region[r].tag) region[e] = count;
        count++;
    }
    lar_status status = lar_scene_fibres_by_rule(m->fibres, region, count, &m->mesh, error);
    free(region);
    return status;
}
