#include "meshing/grid/voxel_grid_check.h"

#include <math.h>

#include "base/vector.h"

static const char *name_of(const lar_boundary *boundary) {
    return boundary->triangles.source ? boundary->triangles.source : "the body";
}

/* A sheet of thickness t has cells of t / THINNEST at most (voxel_grid_thin.c leaves out what is
 * thinner), so it takes half its area over their square. A body with thick parts too takes less:
 * hence the tenfold. */
lar_status lar_voxel_grid_check_thickness(const lar_boundary *boundary, const lar_triangles *outer,
                                          int32_t elements, lar_error *error) {
    static const double THINNEST = 0.15, SURELY = 10;
    double volume = 0, area = lar_triangles_area(outer);
    for (int32_t r = 1; r <= boundary->region_count; r++) volume += boundary->region[r].volume;
    if (!(volume > 0 && area > 0)) return LAR_OK;
    double thickness = 2 * volume / area, cell = thickness / THINNEST;
    double needed = area / 2 / (cell * cell);
    if (!(needed > SURELY * elements)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%.300s: the body is too thin for solid elements: its surface of %.3g cm^2 "
                    "encloses %.3g mL, so that it is %.3g mm thick in the mean and would need %.1e "
                    "elements, not %d; make it thicker, or ask for more elements",
                    name_of(boundary), 1e4 * area, 1e6 * volume, 1e3 * thickness, needed,
                    (int)elements);
}

/* ---- what the cells are near to -------------------------------------------------------------- */

static bool cell_is_near(const lar_voxel_grid *voxel_grid, const double point[3]) {
    enum { NEAR = 2 };
    int low[3], high[3];
    for (int a = 0; a < 3; a++) {
        double away[3];
        lar_minus(point, voxel_grid->origin, away);
        const double at = floor(lar_dot(voxel_grid->axis[a], away) / voxel_grid->size);
        if (!(at >= 0 && at < voxel_grid->cells[a])) return false;
        low[a] = at > NEAR ? (int)at - NEAR : 0;
        high[a] = at + NEAR < voxel_grid->cells[a] ? (int)at + NEAR : voxel_grid->cells[a] - 1;
    }
    for (int k = low[2]; k <= high[2]; k++)
        for (int j = low[1]; j <= high[1]; j++)
            for (int i = low[0]; i <= high[0]; i++)
                if (voxel_grid->region[lar_voxel_grid_cell(voxel_grid, i, j, k)]) return true;
    return false;
}

/* The part of a triangle without a cell near it, at places about a cell apart. */
static double lost_part(const lar_voxel_grid *voxel_grid, const lar_triangles *outer, int32_t t,
                        double area) {
    enum { CUTS_MAX = 64 };
    const int cuts = (int)fmin(fmax(1, ceil(sqrt(2 * area) / voxel_grid->size)), CUTS_MAX);
    const double *x[3];
    int lost = 0;
    for (int c = 0; c < 3; c++) x[c] = outer->vertex[outer->corner[t][c]];
    for (int i = 0; i < cuts; i++)
        for (int j = 0; j < cuts; j++) {
            double a = (i + 0.5) / cuts, b = (j + 0.5) / cuts, point[3];
            if (a + b > 1) a = 1 - a, b = 1 - b;
            for (int d = 0; d < 3; d++)
                point[d] = x[0][d] + a * (x[1][d] - x[0][d]) + b * (x[2][d] - x[0][d]);
            lost += !cell_is_near(voxel_grid, point);
        }
    return (double)lost / (cuts * cuts);
}

lar_status lar_voxel_grid_check_reach(const lar_boundary *boundary, const lar_triangles *outer,
                                      const lar_voxel_grid *voxel_grid, lar_error *error) {
    double all = 0, lost = 0;
    for (int32_t t = 0; t < outer->triangle_count; t++) {
        double normal[3];
        lar_triangles_normal(outer, t, normal);
        const double area = lar_length(normal) / 2;
        all += area;
        lost += area * lost_part(voxel_grid, outer, t, area);
    }
    if (!(lost > LAR_VOXEL_GRID_LOST_MAX * all)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%.300s: %.0f %% of the surface would have no element near it: the body is "
                    "thinner there than elements of %.3g mm can be; make it thicker, or ask for "
                    "more elements or a smaller size",
                    name_of(boundary), 100 * lost / all, 1e3 * voxel_grid->size);
}
