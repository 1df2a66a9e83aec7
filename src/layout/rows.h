/* Threading elements into rows through opposite faces. See layout.h. */
#ifndef LAR_LAYOUT_ROWS_H
#define LAR_LAYOUT_ROWS_H

#include "model/mesh/mesh.h"

/* neighbour[6 e + f]: the face (element * 6 + face) on the other side of face f of element e, or
 * -1: on the boundary, and between more than two elements. The caller frees *neighbour. */
lar_status lar_rows_neighbours(const lar_mesh *mesh, int32_t **neighbour, lar_error *error);

/* The run of elements through e that leaves it by its local face `front`: elements for which
 * usable[element] is true, at most `max`, in run[], first to last; corner[k] gets the nodes of
 * run[k] turned so that the row is its xi direction. A run that begins with e and leaves it by xi+
 * keeps the order of e's nodes. Returns the length. */
int lar_rows_trace(const lar_mesh *mesh, const int32_t *neighbour, const bool *usable, int32_t e,
                   int front, int max, int32_t *run, int32_t (*corner)[8]);

/* The node that continues the edge from `from` to `to` of element *e, in a neighbour of *e or of
 * another element around that edge; -1 at the end of the mesh. *e becomes the element that has the
 * new edge. */
int32_t lar_rows_beyond(const lar_mesh *mesh, const int32_t *neighbour, int32_t *e, int32_t from,
                        int32_t to);

/* The local face to which the edge from node `from` to node `to` of an element leads. */
int lar_rows_face(const int32_t node[8], int32_t from, int32_t to);

#endif
