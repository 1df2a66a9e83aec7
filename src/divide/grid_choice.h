/* Of all boxes of so many processors the one whose cuts cost least (eq. 6.8).
 *
 *     12 processors: 12x1x1, 1x12x1, 6x2x1, 3x2x2, ...; each is cut and counted
 */
#ifndef LAR_DIVIDE_GRID_CHOICE_H
#define LAR_DIVIDE_GRID_CHOICE_H

#include "divide/grid.h"
#include "model/mesh/mesh.h"

/* Fails for more processors than elements, and out of memory. */
lar_status lar_grid_cheapest(const lar_mesh *mesh, int32_t count, lar_grid *grid, lar_error *error);

#endif
