/* Which region gets a cell that several have a part of.
 *
 * By majority a region thinner than a cell gets nothing: everywhere another one has more. So parts
 * are weighted, with one weight per region, and the weights are such that every region gets about
 * as many cells as its volume fills. A plate of half a cell's thickness has the cells along it
 * then, and fitting gives them its thickness.
 */
#ifndef LAR_MESHING_GRID_VOXEL_GRID_VOTES_H
#define LAR_MESHING_GRID_VOXEL_GRID_VOTES_H

#include "meshing/grid/voxel_grid.h"

/* A region's part of a cell; those of a cell stand one after the other. Cells that one region fills
 * have none. */
typedef struct lar_vote {
    int32_t cell;
    float part; /* 0..1; 16 bits would round near ties to one side */
    uint8_t region;
} lar_vote;

typedef struct lar_votes {
    lar_vote *vote;
    size_t count, capacity;
    double volume[LAR_REGIONS_MAX + 1];   /* of each region [cells] */
    int32_t certain[LAR_REGIONS_MAX + 1]; /* cells that it fills */
} lar_votes;

/* Adds what lies in a cell: region, its part of the cell (0..1). False: no memory. */
bool lar_votes_add(lar_votes *votes, size_t cell, int region, double part);

/* Gives the cells to regions: grid->region, inner and share are written anew where there are
 * votes, share by weight as well, so that half of it decides whether a cell is inside. */
void lar_votes_count(const lar_votes *votes, int32_t regions, lar_voxel_grid *voxel_grid);

void lar_votes_clear(lar_votes *votes);

#endif
