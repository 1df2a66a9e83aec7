/* Whether a grid of cubes can stand for a body at all: before the work, by the body's thickness,
 * and once the grid is clean, by what of the surface it is near to. */
#ifndef LAR_MESHING_GRID_VOXEL_GRID_CHECK_H
#define LAR_MESHING_GRID_VOXEL_GRID_CHECK_H

#include "meshing/grid/voxel_grid.h"

/* The part of the true surface that may be without any cell within two of its edges. */
#define LAR_VOXEL_GRID_LOST_MAX 0.25

/* LAR_ERROR_MODEL when the body is so thin, by twice its volume over its outer surface's area, that
 * ten times as many elements as are asked for could not go round it. */
lar_status lar_voxel_grid_check_thickness(const lar_boundary *boundary, const lar_triangles *outer,
                                          int32_t elements, lar_error *error);

/* LAR_ERROR_MODEL when more than LAR_VOXEL_GRID_LOST_MAX of the outer surface is lost. */
lar_status lar_voxel_grid_check_reach(const lar_boundary *boundary, const lar_triangles *outer,
                                      const lar_voxel_grid *voxel_grid, lar_error *error);

#endif
