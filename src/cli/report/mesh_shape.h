/* In how many bodies something hangs together, and how many holes go through them: what a mesh
 * should have of the surface that it was made of. */
#ifndef LAR_CLI_REPORT_MESH_SHAPE_H
#define LAR_CLI_REPORT_MESH_SHAPE_H

#include <stdbool.h>

#include "lariat.h"

typedef struct mesh_shape {
    int32_t bodies;  /* that have an inside; a hollow is none */
    int32_t holes;   /* through them, as in a ring: the genus of the surface, all its shells */
    int32_t hollows; /* closed, within them */
} mesh_shape;

/* False: no memory. The surface is closed; of the mesh each node belongs to an element. Hollows of
 * less than `least` [m^3] are not counted in a surface; of the mesh elements of one tag count, or
 * all where `tag` is NULL. */
bool mesh_shape_of_surface(const lar_surface_arrays *surface, double least, mesh_shape *shape);
bool mesh_shape_of_mesh(const lar_mesh_arrays *mesh, const int32_t *tag, mesh_shape *shape);

#endif
