/* Regions of a mesh as bodies of their own.
 *
 *     o---o---o---o          o---o   o---o
 *     | a | a | b |   --->   | a |...| b |     nodes where regions meet are there once for each
 *     o---o---o---o          o---o   o---o
 */
#ifndef LAR_MESHING_GRID_PART_REGIONS_H
#define LAR_MESHING_GRID_PART_REGIONS_H

#include "model/mesh/mesh.h"

/* Elements of different tags no longer have a node in common, nor have those of one tag that hang
 * together by an edge or a corner alone: around each node those that hang together by faces keep
 * one. Additional nodes come behind the others; *added counts them. On failure the mesh is as it
 * was. */
lar_status lar_regions_part(lar_mesh *mesh, int32_t *added, lar_error *error);

#endif
