/* Which elements meet at a node: E_k (T 3.5), for all nodes in two flat arrays.
 *
 *     first    0     2        5  6          elements of node k: element[first[k] .. first[k + 1])
 *     element  4 9   0 4 7    2             ascending
 *
 * Everything in this room asks the mesh only through this: it is built once per mesh.
 */
#ifndef LAR_DIVIDE_INCIDENCE_H
#define LAR_DIVIDE_INCIDENCE_H

#include "model/mesh/mesh.h"

typedef struct lar_incidence {
    int32_t node_count, element_count;
    int32_t max;      /* elements at one node, at most */
    int64_t *first;   /* [node_count + 1] */
    int32_t *element; /* [first[node_count]], owned as first is */
} lar_incidence;

/* Fails only without memory. Cleared with lar_incidence_clear, also after a failure. */
lar_status lar_incidence_build(const lar_mesh *mesh, lar_incidence *out, lar_error *error);
void lar_incidence_clear(lar_incidence *incidence);

#endif
