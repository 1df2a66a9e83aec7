/* A grid of cubes laid over the true boundary, each with the region that has the most of it.
 *
 *     boundary + size --voxel_grid.c--> regions and shares --clean.c--> a manifold solid
 * --unfitted.c--> hexahedra on the grid --fit.c--> hexahedra on the boundary
 *
 * Cells are numbered i fastest; there is a ring of empty cells around the body.
 */
#ifndef LAR_MESHING_GRID_VOXEL_GRID_H
#define LAR_MESHING_GRID_VOXEL_GRID_H

#include "meshing/boundary/boundary.h"

enum { LAR_VOXEL_GRID_CELLS_MAX = 1 << 27 };

typedef struct lar_voxel_grid {
    int32_t cells[3];
    double origin[3];  /* corner of cell 0 [m] */
    double axis[3][3]; /* rows: unit directions of i, j, k; right-handed */
    double size;       /* edge of a cell [m] */
    uint8_t *region;   /* [cells] 0: outside. Regions by majority: 0 when less than half of the cell
                          is inside, else the region with the largest part. Of several regions parts
                          are weighted, voxel_grid_votes.h */
    uint8_t *inner;    /* [cells] the region with the largest part, whatever is outside; 0: none */
    uint8_t *share; /* [cells] part of the cell that is inside any region, by weight, 0..255, with
                       slots and thin parts widened (voxel_grid_thin.h) */
    double wanted[LAR_REGIONS_MAX + 1]; /* cells that each region shall have, where there are
                                            several: those that it fills, see share; 0: unknown */
    int32_t repaired; /* lines that did not come out of the body again and took no part */
} lar_voxel_grid;

static inline size_t lar_voxel_grid_cell(const lar_voxel_grid *voxel_grid, int i, int j, int k) {
    return ((size_t)k * (size_t)voxel_grid->cells[1] + (size_t)j) * (size_t)voxel_grid->cells[0] +
           (size_t)i;
}

/* Fills a zeroed grid along boundary->axis with cells of `size`: regions are sampled on 4 x 4
 * lines per cell by counting crossings (exact along the line). Flat cuts across an axis lie between
 * cells; where both ends are cut, the size is changed by up to 1 % for it, or the larger cut is
 * chosen. LAR_ERROR_ARGUMENT when the size gives more than LAR_VOXEL_GRID_CELLS_MAX cells,
 * LAR_ERROR_MODEL when no cell is half full, with slots and thin parts widened. */
lar_status lar_voxel_grid_fill(const lar_boundary *boundary, double size,
                               lar_voxel_grid *voxel_grid, lar_error *error);

/* The same with the size that gives about `elements` cells inside (within 2 % where the body lets
 * it). */
lar_status lar_voxel_grid_fill_count(const lar_boundary *boundary, int32_t elements,
                                     lar_voxel_grid *voxel_grid, lar_error *error);

/* The image's own voxels as a grid, when they are cubes within 0.1 % (option --voxel without a
 * size); LAR_ERROR_MODEL otherwise. */
lar_status lar_voxel_grid_from_image(const lar_image *image, const lar_boundary *boundary,
                                     lar_voxel_grid *voxel_grid, lar_error *error);

void lar_voxel_grid_clear(lar_voxel_grid *voxel_grid);

/* Volume of every region [region_count + 1, by the caller] by the same lines. */
lar_status lar_voxel_grid_measure(const lar_boundary *boundary, double size, double *volume,
                                  lar_error *error);

/* What cleaning did, to be told. */
typedef struct lar_cleaning {
    int32_t islands, island_cells;   /* pieces that hang on nothing large, left out */
    int32_t pinholes, pinhole_cells; /* hollows of few cells, filled */
    int32_t added, removed;          /* cells flipped so that none hang together by an edge or a
                                            corner only, and lone bumps and dents */
} lar_cleaning;

/* Makes the inside a manifold solid: no two cells joined by an edge or a corner only, neither do
 * two outside cells meet so; the same for each region where it is possible. Islands: of each
 * region, pieces with less than 5 % of the cells of its largest piece (less than 2 cells at least)
 * are joined to the rest where cells that hold a part of the region lead there; of the others those
 * of one cell or of less than 0.05 % go to the region around them, or are left out. Pinholes:
 * enclosed outside pieces of less than 1 % of the body's cells, at most 27. Cells flip in favour of
 * their share. Bumps and dents, which fitting would squash, are levelled; sheets and bars, and
 * slots and tubes, of one cell's width stay (clean.h). */
lar_status lar_voxel_grid_clean(lar_voxel_grid *voxel_grid, lar_cleaning *cleaning,
                                lar_error *error);

#endif
