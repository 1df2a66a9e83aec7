/* The parts of cleaning a grid (voxel_grid.h: lar_voxel_grid_clean).
 *
 *     regions by majority --islands--> no islands, no pinholes
 *                         --manifold_repair--> manifold, and without what cannot be fitted
 *
 * and both again until the pieces stay.
 *
 * Joints. A grid point is clean when the inside ones of the eight cells around it hang together
 * by faces, and the outside ones too. Where all points are clean the boundary is a 2-manifold
 * (well-composed images: Latecki 1995 and 1997). Repairing cells one after the other in an
 * arbitrary order moves the trouble about, so cleaning goes downhill on a sum, over the grid,
 * of integers:
 *
 *     what                                                        costs
 *     a point where the body is not clean                         most, always more than the rest
 *     a point where a region is not clean                         much
 *     volume on the wrong side: share or 255 - share              0 .. 255 per cell
 *     a cell that fitting would squash (below)                    about half a cell's volume
 *     a face between regions                                      little: among equals the smooth
 *     a cell that a region lacks or has too many, where there     a cell's volume
 *     are several
 *
 * A cell takes the region of a neighbour wherever that lowers the sum. As every step lowers it, it
 * ends. Steps that mend no point must leave the topology alone: the cell is a simple point
 * (Bertrand and Malandain 1994), so that sheets are not torn and bars not cut. Points that are
 * still not clean have cells added around them, which ends too.
 *
 * Squashed cells. A cell with two opposite sides on the boundary is thin. Where its neighbours
 * continue it as a sheet (two by two) or a bar (two in a row) it stands for something thin. Where
 * they do not it is a bump: both sides, and what lies between, would come to lie on one smooth
 * surface. The same holds for outside cells (slots and tubes, or dents) and for cells of a region
 * in another one.
 */
#ifndef LAR_MESHING_CLEAN_CLEAN_H
#define LAR_MESHING_CLEAN_CLEAN_H

#include "meshing/grid/voxel_grid.h"

typedef struct lar_cleaner {
    lar_voxel_grid *voxel_grid;
    size_t cells;
    uint8_t *before; /* [cells] regions before cells were flipped; islands and pinholes are
                        flipped in it too */
    int32_t count[LAR_REGIONS_MAX + 1]; /* cells of each region, while they are flipped */
    uint8_t *mark;                      /* [cells] */
    int32_t *stack;                     /* grows */
    size_t stack_capacity;
    lar_cleaning *cleaning;
    lar_error *error;
} lar_cleaner;

/* i, j, k of a cell. */
void lar_clean_position(const lar_voxel_grid *voxel_grid, size_t cell, int at[3]);

/* True for a cell that may be inside: not of the outermost layer. */
bool lar_clean_may_fill(const lar_voxel_grid *voxel_grid, const int at[3]);

/* The region that a cell outside takes: the one with the largest part of it, else the one with most
 * of its faces; 0 when it has no neighbour inside. */
uint8_t lar_clean_fill(const lar_voxel_grid *voxel_grid, size_t cell);

/* Joins, leaves out or gives away islands and fills pinholes; *changed: whether there were any. */
lar_status lar_clean_islands(lar_cleaner *cleaner, bool *changed);

/* Joins the piece of cell `start`, whose cells are marked `own` and all others `other`, to another
 * piece of its region: by cells outside that hold a part of the region, few and full ones rather
 * than many. They count as full from now on, so that they stay. The marks are as before then. */
lar_status lar_clean_bridge(lar_cleaner *cleaner, size_t start, uint8_t own, uint8_t other,
                            bool *joined);

/* Neighbours of a cell by faces; those beyond the grid are left out. */
int lar_clean_neighbours(const lar_voxel_grid *voxel_grid, size_t cell, size_t found[6]);

/* Flips cells until every grid point is clean. */
lar_status lar_clean_manifold(lar_cleaner *cleaner);

/* The cells around one: label[k][j][i], -2..2 from the cell in the middle, which is [2][2][2].
 * Cells beyond the grid are outside. */
typedef struct lar_clean_window {
    uint8_t label[5][5][5];
} lar_clean_window;

void lar_clean_look(const lar_voxel_grid *voxel_grid, const int at[3], lar_clean_window *window);

/* The part of the sum that the cell in the middle has to do with; without its volume.
 * *unclean: points at the cell where the body is not clean. */
int32_t lar_clean_cost(const lar_clean_window *window, int *unclean);

/* Whether the middle cell may change its label to `label` without changing the topology of the
 * body, of the region that it leaves, and of the one it enters. */
bool lar_clean_is_simple(const lar_clean_window *window, uint8_t label);

/* Whether the set of cells of a 2 x 2 x 2 block (bits 1: +i, 2: +j, 4: +k) and the rest of the
 * block each hang together by faces. */
bool lar_clean_block(unsigned inside);

#endif
