#include <math.h>
#include <stdlib.h>

#include "model/mesh/mesh.h"

/* Nodes that are nearer stand at one place: a millionth of the mean edge, since programs that write
 * seven digits leave less between two copies of a node; where elements are thinner than that, half
 * of their shortest edge, whose ends are connected. */
static double near_of(const lar_mesh *mesh) {
    double near = 1e-6 * lar_mesh_mean_edge(mesh);
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int k = 0; k < 12; k++) {
            const double *a = mesh->position[mesh->element[e][lar_edge_node[k][0]]];
            const double *b = mesh->position[mesh->element[e][lar_edge_node[k][1]]];
            double farthest = 0; /* along an axis */
            for (int i = 0; i < 3; i++) farthest = fmax(farthest, fabs(a[i] - b[i]));
            near = fmin(near, 0.5 * farthest);
        }
    return near;
}

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
    const double near = near_of(mesh);
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
