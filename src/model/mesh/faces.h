/* All faces of all elements, sorted by their nodes.
 *
 * Equal faces stand side by side, so that one walk finds the boundary (faces that stand alone)
 * and a binary search finds the element behind four nodes. The faces are first dropped into one
 * bucket per smallest node (a counting sort, linear), then sorted inside the buckets: no mesh,
 * however odd, costs more than n log n.
 */
#ifndef LAR_MODEL_MESH_FACES_H
#define LAR_MODEL_MESH_FACES_H

#include "model/mesh/mesh.h"

typedef struct lar_face_key {
    int32_t node[4]; /* node indices, ascending */
    int32_t face;    /* element * 6 + local face */
} lar_face_key;

typedef struct lar_face_table {
    size_t count;
    lar_face_key *key;
} lar_face_table;

/* Sorts four node indices in place. */
void lar_face_sort_nodes(int32_t node[4]);

/* Fills a zeroed table; free table->key afterwards. Element nodes must be in range. */
lar_status lar_face_table_build(const lar_mesh *mesh, lar_face_table *table, lar_error *error);

/* The face with these nodes (ascending); of several the one of the first element. NULL: none. */
const lar_face_key *lar_face_table_find(const lar_face_table *table, const int32_t node[4]);

/* True when both faces have the same nodes. */
bool lar_face_key_same(const lar_face_key *a, const lar_face_key *b);

/* Adds a face's share of each of its corners at rest, [nodes], as by the element's shape functions:
 * the vector of its area, outwards times `sign`, and its area [m^2]. Two by two Gauss points are
 * exact for the vector, and for the area where the face is flat. */
void lar_face_share(const lar_mesh *mesh, int32_t face, double sign, double (*share)[4]);

#endif
