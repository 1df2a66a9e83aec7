/* Fibres of a meshed body, by a rule: of one region, or region after region, but for bones. */
#include <stdlib.h>
#include <string.h>

#include "meshing/meshing.h"
#include "model/scene/scene.h"

bool lar_starter_fibrous(const lar_meshing *m, const lar_region_info *region) {
    if (!m->fibres || region->elements == 0) return false;
    return m->fibre_region ? strcmp(region->name, m->fibre_region) == 0 : !region->held;
}

/* Nothing that could have fibres: the name is none, or all is bone. */
static lar_status no_region(const lar_meshing *m, lar_error *error) {
    if (m->fibre_region)
        return lar_starter_no_region(m, "fibres are asked for in", m->fibre_region, error);
    return lar_fail(error, LAR_ERROR_MODEL,
                    "all regions are bone, which has no fibres unless its region is named");
}

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
        if (!lar_starter_fibrous(m, &m->region[r])) continue;
        if (m->fibre_region) m->fibre_region = m->region[r].name; /* which lives as long */
        for (size_t e = 0; e < elements; e++)
            if (m->mesh.element_tag[e] == m->region[r].tag) region[e] = count;
        count++;
    }
    lar_status status = count > 0
                            ? lar_scene_fibres_by_rule(m->fibres, region, count, &m->mesh, error)
                            : no_region(m, error);
    free(region);
    return status;
}
