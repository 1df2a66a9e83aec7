#include "divide/grid.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

lar_status lar_grid_make(int64_t nx, int64_t ny, int64_t nz, lar_grid *grid, lar_error *error) {
    const int64_t edge[3] = {nx, ny, nz};
    int64_t count = 1;
    for (int i = 0; i < 3; i++) {
        if (edge[i] < 1 || edge[i] > LAR_GRID_MAX)
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "a grid has no edge of %" PRId64 " processors; give 1 to %d along x, "
                            "y and z, e.g. 2x2x3",
                            edge[i], LAR_GRID_MAX);
        count *= edge[i];
    }
    if (count > LAR_GRID_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a grid of %" PRId64 " processors is too large; at most %d are possible",
                        count, LAR_GRID_MAX);
    *grid = (lar_grid){{(int32_t)nx, (int32_t)ny, (int32_t)nz}, (int32_t)count};
    return LAR_OK;
}

/* Beyond it a message shows not all digits, and a number no longer fits. */
static const int64_t EDGE_SHOWN = 100000000000000000;

lar_status lar_grid_parse(const char *text, lar_grid *grid, lar_error *error) {
    int64_t edge[3] = {0};
    const char *at = text;
    for (int i = 0; i < 3; i++) {
        const char *start = at;
        for (; *at >= '0' && *at <= '9'; at++)
            if (edge[i] < EDGE_SHOWN) edge[i] = 10 * edge[i] + (*at - '0');
        if (at == start || *at != (i < 2 ? 'x' : '\0'))
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "'%.60s' is no grid of processors; write the numbers along x, y and z "
                            "as in 2x2x3",
                            text);
        at++;
    }
    return lar_grid_make(edge[0], edge[1], edge[2], grid, error);
}

void lar_grid_format(const lar_grid *grid, char text[LAR_GRID_TEXT]) {
    snprintf(text, LAR_GRID_TEXT, "%dx%dx%d", (int)grid->edge[0], (int)grid->edge[1],
             (int)grid->edge[2]);
}

void lar_grid_place(const lar_grid *grid, int32_t p, int32_t place[3]) {
    place[0] = p % grid->edge[0];
    place[1] = p / grid->edge[0] % grid->edge[1];
    place[2] = p / grid->edge[0] / grid->edge[1];
}

int32_t lar_grid_processor(const lar_grid *grid, const int32_t place[3]) {
    for (int i = 0; i < 3; i++)
        if (place[i] < 0 || place[i] >= grid->edge[i]) return -1;
    return place[0] + grid->edge[0] * (place[1] + grid->edge[1] * place[2]);
}

int32_t lar_grid_distance_along(const lar_grid *grid, int axis, int32_t p1, int32_t p2) {
    int32_t c1[3], c2[3];
    lar_grid_place(grid, p1, c1);
    lar_grid_place(grid, p2, c2);
    return abs(c1[axis] - c2[axis]);
}

int32_t lar_grid_distance(const lar_grid *grid, int32_t p1, int32_t p2) {
    int32_t c1[3], c2[3];
    lar_grid_place(grid, p1, c1);
    lar_grid_place(grid, p2, c2);
    return abs(c1[0] - c2[0]) + abs(c1[1] - c2[1]) + abs(c1[2] - c2[2]);
}

void lar_grid_spread_along(const lar_grid *grid, const int32_t *set, int32_t count,
                           int32_t spread[3]) {
    int32_t low[3], high[3];
    for (int32_t i = 0; i < count; i++) {
        int32_t c[3];
        lar_grid_place(grid, set[i], c);
        for (int axis = 0; axis < 3; axis++) {
            if (i == 0 || c[axis] < low[axis]) low[axis] = c[axis];
            if (i == 0 || c[axis] > high[axis]) high[axis] = c[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++) spread[axis] = count > 0 ? high[axis] - low[axis] : 0;
}

int32_t lar_grid_diameter(const lar_grid *grid) {
    return grid->edge[0] + grid->edge[1] + grid->edge[2] - 3;
}

bool lar_grid_neighbours(const lar_grid *grid, int32_t p1, int32_t p2) {
    return lar_grid_distance(grid, p1, p2) == 1;
}

bool lar_grid_neighbours_along(const lar_grid *grid, int axis, int32_t p1, int32_t p2) {
    return lar_grid_neighbours(grid, p1, p2) && lar_grid_distance_along(grid, axis, p1, p2) == 1;
}
