/* Rows along given directions. When every element is turned already, it has one xi and one
 * continuation: the element whose left face is its right face, corner by corner.
 *
 *     3---2   3---2
 *     | e |   | n |     n follows e when its corners 0, 3, 7, 4 are e's corners 1, 2, 6, 5
 *     0---1   0---1
 *
 * The same for lines of nodes: beyond an edge along xi comes the edge of the next element, or of
 * the element next to any other that has this edge along its xi.
 */
#ifndef LAR_LAYOUT_CHAINS_H
#define LAR_LAYOUT_CHAINS_H

#include "layout/row_plan.h"

typedef struct lar_chains {
    const int32_t (*corner)[8];
    int32_t *next, *previous; /* [elements] 1 + element, 0: none */
    int32_t *first; /* [nodes] 1 + an edge that begins here, 4 * element + line; 0: none */
    int32_t *other; /* [4 * elements] 1 + another edge that begins there, 0: none */
} lar_chains;

/* Links elements[0..count) of a mesh as `corner` turns them. False without memory; destroyed in
 * any case. */
bool lar_chains_create(const lar_mesh *mesh, const int32_t (*corner)[8], const lar_gid *elements,
                       int32_t count, lar_chains *chains);
void lar_chains_destroy(lar_chains *chains); /* idempotent */

/* For lar_row_plan. */
lar_row_ways lar_chains_ways(const lar_chains *chains);

#endif
