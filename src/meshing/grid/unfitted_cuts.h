/* Which outer faces of an unfitted mesh stand for a flat cut, where the image ends in the middle of
 * an organ (boundary.h).
 *
 * An outer face belongs to what lies in front of the true boundary near it: for the outside and
 * for every cut of its region, the distance from the face's centre to the nearest triangle in front
 * of which that lies [cells], plus how far the face turns away from that triangle's normal. The
 * least has the face. Along the edge of a cut, where two triangles are equally near, the normal
 * decides; on a grid that stands oblique to the cut, where no face has its normal, the distance
 * does.
 */
#ifndef LAR_MESHING_GRID_UNFITTED_CUTS_H
#define LAR_MESHING_GRID_UNFITTED_CUTS_H

#include "meshing/grid/voxel_grid.h"
#include "model/triangles/tree.h"

typedef struct lar_unfitted_cuts {
    const lar_boundary *boundary;
    /* Of the triangles with the outside (0) or cut f - 1 in front; NULL where there are none, and
       all of them where the boundary has no cuts. */
    lar_triangle_tree *tree[1 + LAR_CUTS];
    double (*normal)[3]; /* [triangles] of unit length */
} lar_unfitted_cuts;

/* Into a zeroed one. The boundary must outlive it. */
lar_status lar_unfitted_cuts_create(const lar_boundary *boundary, lar_unfitted_cuts *cuts,
                                    lar_error *error);
void lar_unfitted_cuts_clear(lar_unfitted_cuts *cuts);

/* What lies in front of face `face` (xi-, xi+, eta-, ... of the grid) of a cell inside: 0 or the
 * number of a cut. */
uint16_t lar_unfitted_cuts_front(const lar_unfitted_cuts *cuts, const lar_voxel_grid *voxel_grid,
                                 const int cell[3], int face);

#endif
