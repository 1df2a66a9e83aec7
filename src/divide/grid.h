/* The grid of processors: nx x ny x nz places, every place taken (T 3.4).
 *
 *            z                    processor p = x + nx (y + ny z)
 *            |  y                 place     c(p) = (x, y, z), each from 0 (the thesis counts from
 * 1) | /                  a local channel joins two processors at distance 1; o--- x everything
 * farther goes over global channels
 *
 * Distances count channels: they add up along the axes (eq. 3.5), there are no diagonals.
 */
#ifndef LAR_DIVIDE_GRID_H
#define LAR_DIVIDE_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

enum { LAR_GRID_MAX = 1024, LAR_GRID_TEXT = 40 };

typedef struct lar_grid {
    int32_t edge[3]; /* nx, ny, nz, each at least 1 */
    int32_t count;   /* their product, at most LAR_GRID_MAX */
} lar_grid;

/* A grid of the given edges; LAR_ERROR_ARGUMENT when one is below 1 or there are too many. */
lar_status lar_grid_make(int64_t nx, int64_t ny, int64_t nz, lar_grid *grid, lar_error *error);

/* From text: "2x2x3", digits and x only. */
lar_status lar_grid_parse(const char *text, lar_grid *grid, lar_error *error);
/* To text, as lar_grid_parse reads it. */
void lar_grid_format(const lar_grid *grid, char text[LAR_GRID_TEXT]);

/* The placement function c(p) and its inverse (T 3.4); -1 for a place outside the grid. */
void lar_grid_place(const lar_grid *grid, int32_t p, int32_t place[3]);
int32_t lar_grid_processor(const lar_grid *grid, const int32_t place[3]);

/* Distance along one axis (eqs. 3.2 to 3.4) and along all (eq. 3.5). */
int32_t lar_grid_distance_along(const lar_grid *grid, int axis, int32_t p1, int32_t p2);
int32_t lar_grid_distance(const lar_grid *grid, int32_t p1, int32_t p2);

/* The greatest distances within a set of processors, D_x, D_y, D_z (eqs. 3.7 to 3.9). 0 for sets of
 * less than two. */
void lar_grid_spread_along(const lar_grid *grid, const int32_t *set, int32_t count,
                           int32_t spread[3]);

/* Greatest distance within the whole grid. */
int32_t lar_grid_diameter(const lar_grid *grid);

/* Whether a channel joins the two (eq. 3.10), one along this axis (eqs. 3.11 to 3.13). */
bool lar_grid_neighbours(const lar_grid *grid, int32_t p1, int32_t p2);
bool lar_grid_neighbours_along(const lar_grid *grid, int axis, int32_t p1, int32_t p2);

#endif
