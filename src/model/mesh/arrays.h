/* A mesh from the caller's memory (lar_mesh_arrays): what file readers do, without a file.
 *
 * Numbers of nodes and elements are their indices, from 0, so that messages say which they are.
 * Everything is copied. A node that no element uses is an error and not left out as from files: the
 * caller's indices would not hold any more. */
#ifndef LAR_MODEL_MESH_ARRAYS_H
#define LAR_MODEL_MESH_ARRAYS_H

#include "model/mesh/mesh.h"

/* Into *mesh, zeroed before, checked and in metres. `scale`: metres per unit. */
lar_status lar_mesh_from_arrays(const lar_mesh_arrays *arrays, double scale, lar_mesh *mesh,
                                lar_error *error);

#endif
