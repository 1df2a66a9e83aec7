/* Slots and parts of the body that are thinner than a cell.
 *
 *      |  body  | |  body  |          By majority no cell is outside where a slot is narrower than
 *      |        | |        |          half a cell, and none is inside where a part is thinner. The
 *      |        | |        |          slot is filled as deep as it is, the part is gone, and
 * fitting
 *           ->|     |<-               cannot bring either back.
 *
 * So cells are counted as if slots were about a cell wide and parts nearly a cell thick. Fitting
 * then gives both their own width and the body its volume: cells beside a slot become longer, which
 * costs them little.
 *
 * How thin the body, or the outside, is at a place of its surface: the diameter of the largest ball
 * that touches the surface there and holds nothing of it, found by shrinking it (Ma, Bae and Choi
 * 2012, "3D medial axis point approximation using nearest neighbors and the normal field"). It must
 * touch the surface a second time nearly opposite: else the place lies at an edge or in a corner,
 * where balls are small too (the angle by which Foskey, Lin and Manocha 2003 prune a medial axis).
 */
#ifndef LAR_MESHING_GRID_VOXEL_GRID_THIN_H
#define LAR_MESHING_GRID_VOXEL_GRID_THIN_H

#include "meshing/grid/voxel_grid.h"

/* A place on the outer surface where the body or the outside is thin. */
typedef struct lar_thin_place {
    double point[3], normal[3]; /* normal out of the body */
    float slot, part;           /* width of the outside in front, thickness of the body behind [m];
                                   INFINITY: not thin */
    uint8_t region;             /* of the body behind */
    bool measured;              /* otherwise as thin as the last one before that was */
} lar_thin_place;

typedef struct lar_thin {
    lar_thin_place *place;
    size_t count, capacity;
    double size; /* the largest cells that it serves for, 0: none */
} lar_thin;

/* Fills a zeroed one, or one that serves for other cells. It serves for cells down to
 * LAR_THIN_SMALLEST times the size too, with less places for each. */
#define LAR_THIN_SMALLEST 0.6
lar_status lar_thin_find(const lar_boundary *boundary, double size, lar_thin *thin,
                         lar_error *error);
void lar_thin_clear(lar_thin *thin);

/* By how much of itself a cell counts as fuller, or emptier when it is negative. */
typedef struct lar_thin_change {
    float part;
    uint8_t region; /* that gets what is added */
} lar_thin_change;

/* Changes of cells; `of` NULL: of none. */
typedef struct lar_thin_changes {
    int32_t *of; /* [cells] index into `one`, -1: none */
    lar_thin_change *one;
    size_t count;
} lar_thin_changes;

/* What widening changes of the cells of a grid that has its place but no regions yet. */
lar_status lar_thin_widen(const lar_thin *thin, const lar_boundary *boundary,
                          const lar_voxel_grid *voxel_grid, lar_thin_changes *changes,
                          lar_error *error);
void lar_thin_changes_clear(lar_thin_changes *changes);

/* lar_voxel_grid_fill; what is thin is looked for where `thin`, zeroed at first, does not serve:
 * once for all sizes that are tried, as it takes longer than the grid. */
lar_status lar_voxel_grid_fill_thin(const lar_boundary *boundary, lar_thin *thin, double size,
                                    lar_voxel_grid *voxel_grid, lar_error *error);

#endif
