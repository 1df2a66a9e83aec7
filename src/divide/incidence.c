#include "divide/incidence.h"

#include <stdlib.h>

lar_status lar_incidence_build(const lar_mesh *mesh, lar_incidence *out, lar_error *error) {
    size_t corners = 8 * (size_t)mesh->element_count;
    *out = (lar_incidence){
        .node_count = mesh->node_count,
        .element_count = mesh->element_count,
        .first = lar_calloc((size_t)mesh->node_count + 2, sizeof *out->first),
        .element = lar_calloc(corners, sizeof *out->element),
    };
    if (!out->first || !out->element) {
        lar_incidence_clear(out);
        return lar_fail_memory(error, corners * sizeof *out->element, "elements at nodes");
    }
    /* Counts are kept two places on: filling moves each start to its final place. */
    int64_t *start = out->first + 1;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) start[mesh->element[e][a] + 1]++;
    for (int32_t k = 0; k < mesh->node_count; k++) {
        if (start[k + 1] > out->max) out->max = (int32_t)start[k + 1];
        start[k + 1] += start[k];
    }
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) out->element[start[mesh->element[e][a]]++] = e;
    return LAR_OK;
}

void lar_incidence_clear(lar_incidence *incidence) {
    free(incidence->first);
    free(incidence->element);
    *incidence = (lar_incidence){0};
}
