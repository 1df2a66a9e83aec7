/* Which regions of a mesh touch each other although they should not: where what is between them is
 * thinner than elements it has holes, and they hang together through these. */
#ifndef LAR_CLI_REPORT_MESH_TOUCH_H
#define LAR_CLI_REPORT_MESH_TOUCH_H

#include "lariat.h"

typedef struct mesh_touch {
    int32_t region[2];   /* of lar_meshing_region */
    double area, wanted; /* over how much they touch in the mesh, and should [m^2] */
} mesh_touch;

/* Those that touch over more than twice what they should and eight elements' faces, worst
 * first; the caller frees. NULL: there are none, or no memory to find out. */
mesh_touch *mesh_touches(const lar_meshing *meshing, int32_t *count);

#endif
