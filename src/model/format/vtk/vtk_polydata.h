/* VTK's PolyData, and the one place where it becomes a surface.
 *
 *     .vtp (vtp.c) ---------+
 *                           +--> lar_vtk_polydata --> lar_vtk_polydata_to_triangles
 *     .vtk (vtk_surface.c) -+
 *
 * Polygons are cut into fans, strips of triangles into their triangles; single points and lines are
 * passed over. The first of the well-known integer cell arrays (lar_vtk_wants) is the tag; it
 * counts the cells of all four lists, one list after the other.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_POLYDATA_H
#define LAR_MODEL_FORMAT_VTK_VTK_POLYDATA_H

#include "model/format/vtk/vtk_grid.h"
#include "model/triangles/triangles.h"

typedef enum lar_vtk_list {
    LAR_VTK_VERTS,
    LAR_VTK_LINES,
    LAR_VTK_POLYS,
    LAR_VTK_STRIPS,
    LAR_VTK_LISTS
} lar_vtk_list;

/* Fills the zeroed *triangles; checks every number. `grid` has the points and arrays, no cells. */
lar_status lar_vtk_polydata_to_triangles(const char *path, const lar_vtk_grid *grid,
                                         const lar_vtk_cells list[LAR_VTK_LISTS],
                                         lar_triangles *triangles, lar_error *error);

#endif
