/* The true surface, made fit to ride on a mesh (model/triangles/embedded_surface.h). */
#ifndef LAR_MESHING_FINE_SURFACE_H
#define LAR_MESHING_FINE_SURFACE_H

#include "model/mesh/mesh.h"
#include "model/triangles/triangles.h"

/* Leaves out the shells that the mesh has nothing of: loose pieces and hollows that cleaning left
 * out or filled. A shell is such a one when its vertices are on the mean farther from the mesh's
 * surface than half a cell; the one with the most vertices stays. */
lar_status lar_fine_surface_drop(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error);

/* Draws vertices that are farther than a cell from the mesh's surface onto it: thin tongues that
 * cells are too large for have nothing to ride on. */
lar_status lar_fine_surface_draw(const lar_mesh *mesh, double size, lar_triangles *surface,
                                 lar_error *error);

#endif
