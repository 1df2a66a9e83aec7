/* Lines through a grid along its first axis, 4 x 4 through each row of cells, and the stretches
 * of them that lie in each region.
 *
 *      ______ ______ ______        A line goes in at a triangle that looks against it and out at
 *     |    __|______|__    |       one that looks along it: counting both per region says where it
 *     |---/--|------|--\---|       is, in any order, even where two triangles are crossed at one
 *     |__|___|______|___|__|       place. Lengths along the line are exact.
 *
 * Triangles are scan-converted onto the lines. Across the lines all is in whole numbers: vertices
 * on even ones, lines on odd ones, sides of edges are exact, and a line through an edge counts as
 * beside it (Edelsbrunner and Muecke 1990, Simulation of Simplicity). So a line crosses a closed
 * surface as often inwards as outwards without exception.
 */
#ifndef LAR_MESHING_GRID_VOXEL_GRID_LINES_H
#define LAR_MESHING_GRID_VOXEL_GRID_LINES_H

#include "meshing/grid/voxel_grid.h"

enum { LAR_LINES_PER_CELL = 4 }; /* in each of the two directions */

typedef struct lar_crossing {
    double at; /* along the line, in cells from the grid's corner */
    int32_t line;
    int32_t triangle; /* ~triangle when it looks against the line */
} lar_crossing;

typedef struct lar_lines {
    const lar_boundary *boundary;
    int32_t count[2];       /* of lines, along the grid's second and third axis */
    size_t *start;          /* [count[0] * count[1] + 1] into crossing */
    lar_crossing *crossing; /* of each line, in the order along it */
} lar_lines;

/* Line (j, k) is number k * count[0] + j. The boundary must outlive the lines; of the grid only
 * origin, axis, size and cells are used. */
lar_status lar_lines_create(const lar_boundary *boundary, const lar_voxel_grid *voxel_grid,
                            lar_lines *lines, lar_error *error);
void lar_lines_clear(lar_lines *lines);

/* Tells of the stretches of a line that lie in a region, from where to where [cells]. */
typedef void lar_stretch(void *context, int region, double from, double to);

/* False, and nothing is told, when the line does not come out of the body again: the surface is
 * not closed there. */
bool lar_lines_follow(const lar_lines *lines, size_t line, lar_stretch *add, void *context);

#endif
