/* The true surface, made fit to ride on a mesh (model/triangles/embedded_surface.h). */
#ifndef LAR_MESHING_FINE_SURFACE_H
#define LAR_MESHING_FINE_SURFACE_H

#include "meshing/boundary/boundary.h"
#include "model/mesh/mesh.h"
#include "model/triangles/triangles.h"

/* What the mesh has not of the body. */
typedef struct lar_dropped {
    int32_t hollows;
    double volume[LAR_REGIONS_MAX + 1]; /* [region; m3] a hollow's is below zero */
} lar_dropped;

/* Leaves out the shells that the mesh has nothing of: loose pieces and hollows that cleaning left
 * out or filled, or cells are too large for. A shell is such a one when hardly any of it is nearer
 * to the mesh's surface than half a cell, or when it is a hollow of less than a cell; the largest
 * one stays. The surface has the tags of the boundary's regions. */
lar_status lar_fine_surface_drop(const lar_mesh *mesh, double size, const lar_boundary *boundary,
                                 lar_triangles *surface, lar_dropped *dropped, lar_error *error);

/* Draws vertices that are farther than a cell from the mesh's surface onto it: thin tongues that
 * cells are too large for have nothing to ride on. */
lar_status lar_fine_surface_draw(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error);

#endif
