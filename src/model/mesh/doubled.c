#include <math.h>
#include <stdlib.h>

#include "model/mesh/mesh.h"

/* Of the mean edge: nodes that are nearer stand at one place. Programs that write seven digits
 * leave less between two copies of a node; no element is so thin. */
static const double NEAR = 1e-6;

typedef struct placed {
    double cell[3]; /* of a grid so fine, whole numbers */
    int32_t node;
} placed;

static int compare_places(const void *a, const void *b) {
    const placed *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->cell[i] != y->cell[i]) return x->cell[i] < y->cell[i] ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

lar_status lar_mesh_doubled_nodes(const lar_mesh *mesh, int32_t *doubled, int32_t **leader,
                                  lar_error *error) {
    const size_t count = (size_t)mesh->node_count;
    placed *place = lar_calloc(count, sizeof *place);
    int32_t *first = lar_calloc(count, sizeof *first);
    if (!place || !first) {
        free(place);
        free(first);
        return lar_fail_memory(error, count * (sizeof *place + sizeof *first), "doubled nodes");
    }
    const double near = NEAR * lar_mesh_mean_edge(mesh);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        place[n].node = n;
        for (int i = 0; i < 3; i++)
            place[n].cell[i] =
                near > 0 ? floor(mesh->position[n][i] / near + 0.5) : mesh->position[n][i];
    }
    qsort(place, count, sizeof *place, compare_places);
    *doubled = 0;
    for (size_t p = 0; p < count; p++) {
        bool same = p > 0;
        for (int i = 0; i < 3 && same; i++) same = place[p].cell[i] == place[p - 1].cell[i];
        first[place[p].node] = same ? first[place[p - 1].node] : place[p].node;
        *doubled += same;
    }
    free(place);
    if (leader)
        *leader = first;
    else
        free(first);
    return LAR_OK;
}
