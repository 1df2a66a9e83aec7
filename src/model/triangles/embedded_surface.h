/* A fine surface embedded in a coarse mesh, for display: every vertex is bound to an element and
 * moves with its eight nodes (trilinear, the same weights for ever).
 *
 * A vertex outside of all elements, within reach of the body, is bound to the nearest element and
 * its natural coordinates lie beyond -1..1: an affine motion moves it exactly along.
 */
#ifndef LAR_MODEL_TRIANGLES_EMBEDDED_SURFACE_H
#define LAR_MODEL_TRIANGLES_EMBEDDED_SURFACE_H

#include "model/mesh/mesh.h"
#include "model/triangles/triangles.h"

typedef struct lar_embedded_surface {
    lar_triangles surface; /* at rest */
    int32_t *element;      /* [vertex_count] */
    float (*weight)[8];    /* [vertex_count], of the element's nodes; they sum to 1 */
    double farthest;       /* of the vertices outside of elements, how far [m] */
} lar_embedded_surface;

/* Binds `surface` (taken over, also on failure; zeroed) to the mesh. LAR_ERROR_MODEL when a vertex
 * is farther from the body than two mean edges of its elements: another body, or another unit. */
lar_status lar_embedded_surface_bind(const lar_mesh *mesh, lar_triangles *surface,
                                     lar_embedded_surface *embedded, lar_error *error);
void lar_embedded_surface_clear(lar_embedded_surface *embedded); /* a zeroed one is fine */

/* Places of all vertices when the mesh's nodes have moved by u [nodes][3]; NULL: at rest. */
void lar_embedded_surface_move(const lar_embedded_surface *embedded, const lar_mesh *mesh,
                               const double (*u)[3], double (*place)[3]);

#endif
