/* Bodies that were parted (grid/part_regions.h) touch with all of their faces, and where they meet
 * at an angle near none a face of the one may lie behind one of the other. */
#ifndef LAR_MESHING_FIT_BODY_GAPS_H
#define LAR_MESHING_FIT_BODY_GAPS_H

#include "model/mesh/mesh.h"

/* Moves nodes until the surfaces of different bodies, the parts of a mesh that hang together, are a
 * fiftieth of `size` [m] apart or nearly so, as contact sees them (mechanics/face_contact.h). No
 * element gets worse than a scaled Jacobian of 0.2. What is farther in each other than half of
 * `size` stays. The same input gives the same bits. */
lar_status lar_body_gaps_open(lar_mesh *mesh, double size, lar_error *error);

#endif
