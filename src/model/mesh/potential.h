/* A potential in a part of a mesh: Laplace's equation between two sets of nodes,
 *
 *     div grad u = 0,    u = 0 on one of them, 1 on the other, no flux through all else
 *
 * on trilinear hexahedra with eight points each, by conjugate gradients preconditioned by the
 * diagonal. Its gradient leads from the one to the other, its value says how far one has come:
 * what rules for fibres ask for (Bayer, Blake, Plank and Trayanova, Annals of Biomedical
 * Engineering 40, 2012).
 *
 * Sums go over elements and nodes in the order of the mesh, on one thread, by + - * / alone: the
 * same bits everywhere.
 */
#ifndef LAR_MODEL_MESH_POTENTIAL_H
#define LAR_MODEL_MESH_POTENTIAL_H

#include "model/mesh/mesh.h"

enum { LAR_POTENTIAL_FREE, LAR_POTENTIAL_LOW, LAR_POTENTIAL_HIGH };

/* held: [nodes of the mesh], each one of these. *loose becomes the first of the `count` elements
 * that has no way through them to a low node (*missing LAR_POTENTIAL_LOW) or to a high one; -1:
 * there is none. */
lar_status lar_potential_loose(const lar_mesh *mesh, const int32_t *element, int32_t count,
                               const uint8_t *held, int32_t *loose, int *missing, lar_error *error);

/* value: [nodes of the mesh], 0 at nodes of none of the elements. None may be loose. */
lar_status lar_potential_solve(const lar_mesh *mesh, const int32_t *element, int32_t count,
                               const uint8_t *held, double *value, lar_error *error);

/* In the centre of element e; returns the value there. */
double lar_potential_at(const lar_mesh *mesh, const double *value, int32_t e, double gradient[3]);

#endif
