#include "meshing/grid/voxel_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "meshing/grid/voxel_grid_thin.h"

void lar_voxel_grid_clear(lar_voxel_grid *voxel_grid) {
    free(voxel_grid->region);
    free(voxel_grid->inner);
    free(voxel_grid->share);
    *voxel_grid = (lar_voxel_grid){0};
}

/* ---- a size for a number of cells --------------------------------------------------------- */

static int32_t count_inside(const lar_voxel_grid *voxel_grid) {
    size_t cells =
        (size_t)voxel_grid->cells[0] * (size_t)voxel_grid->cells[1] * (size_t)voxel_grid->cells[2];
    int32_t inside = 0;
    for (size_t c = 0; c < cells; c++) inside += voxel_grid->region[c] != 0;
    return inside;
}

/* The count falls with the cube of the size, roughly: cells half full come and go, and a thin body
 * has whole layers of them. So: the size by that law, and where it leaves the bracket its middle.
 */
typedef struct search {
    double fine, coarse; /* sizes that give too many and too few; 0: none yet */
    double size;
} search;

static void propose(search *state, int32_t inside, int32_t wanted) {
    if (inside >= wanted) state->fine = state->size;
    if (inside < wanted) state->coarse = state->size;
    double next = inside > 0 ? state->size * cbrt((double)inside / wanted) : state->size / 2;
    double low = state->fine, high = state->coarse > 0 ? state->coarse : INFINITY;
    if (!(next > low && next < high)) next = sqrt(low * high);
    state->size = next;
}

lar_status lar_voxel_grid_fill(const lar_boundary *boundary, double size,
                               lar_voxel_grid *voxel_grid, lar_error *error) {
    lar_thin thin = {0};
    lar_status status = lar_voxel_grid_fill_thin(boundary, &thin, size, voxel_grid, error);
    lar_thin_clear(&thin);
    return status;
}

lar_status lar_voxel_grid_fill_count(const lar_boundary *boundary, int32_t elements,
                                     lar_voxel_grid *voxel_grid, lar_error *error) {
    enum { TRIES = 10 };
    double volume = 0;
    for (int32_t r = 1; r <= boundary->region_count; r++) volume += boundary->region[r].volume;
    if (elements < 1)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d elements cannot be made; ask for one at least", (int)elements);
    if (!(volume > 0 && isfinite(volume)))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "the body encloses no volume; look at its surface's orientation and unit");
    search state = {.size = cbrt(volume / elements)};
    lar_voxel_grid best = {0};
    lar_thin thin = {0};
    int32_t off = INT32_MAX;
    lar_status status = LAR_OK;
    for (int i = 0; i < TRIES && off > elements / 100; i++) {
        lar_voxel_grid tried = {0};
        status = lar_voxel_grid_fill_thin(boundary, &thin, state.size, &tried, error);
        if (status && status != LAR_ERROR_MODEL) break;
        int32_t inside = status ? 0 : count_inside(&tried);
        if (!status && abs(inside - elements) < off) {
            off = abs(inside - elements);
            lar_voxel_grid swap = best;
            best = tried;
            tried = swap;
        }
        lar_voxel_grid_clear(&tried);
        propose(&state, inside, elements);
    }
    lar_thin_clear(&thin);
    if (off == INT32_MAX) return status;
    *voxel_grid = best;
    return LAR_OK;
}

/* ---- the image's own voxels ---------------------------------------------------------------- */

/* Steps of a voxel along the image's axes as columns; true when they are a cube's edges. */
static bool voxels_are_cubes(const lar_image *image, double step[3][3]) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) step[a][b] = image->to_world[b][a];
    double size = lar_length(step[0]);
    for (int a = 0; a < 3; a++) {
        if (fabs(lar_length(step[a]) - size) > 1e-3 * size) return false;
        if (fabs(lar_dot(step[a], step[(a + 1) % 3])) > 1e-3 * size * size) return false;
    }
    return size > 0;
}

/* The voxels of a region lie in low..high (past the end). */
static bool find_voxels(const lar_image *image, const uint8_t *region_of, int32_t low[3],
                        int32_t high[3]) {
    for (int a = 0; a < 3; a++) low[a] = image->size[a], high[a] = 0;
    const uint16_t *label = image->label;
    for (int32_t k = 0; k < image->size[2]; k++)
        for (int32_t j = 0; j < image->size[1]; j++)
            for (int32_t i = 0; i < image->size[0]; i++) {
                if (!region_of[*label++]) continue;
                int32_t at[3] = {i, j, k};
                for (int a = 0; a < 3; a++) {
                    if (at[a] < low[a]) low[a] = at[a];
                    if (at[a] >= high[a]) high[a] = at[a] + 1;
                }
            }
    return high[0] > low[0];
}

lar_status lar_voxel_grid_from_image(const lar_image *image, const lar_boundary *boundary,
                                     lar_voxel_grid *voxel_grid, lar_error *error) {
    double step[3][3];
    if (!voxels_are_cubes(image, step))
        return lar_fail(
            error, LAR_ERROR_MODEL,
            "%s: its voxels are no cubes (%.4g x %.4g x %.4g mm), which elements of the "
            "image's own voxels need; name a size",
            image->source, 1e3 * lar_length(step[0]), 1e3 * lar_length(step[1]),
            1e3 * lar_length(step[2]));
    int32_t low[3], high[3];
    if (!boundary->region_of_label || !find_voxels(image, boundary->region_of_label, low, high))
        return lar_fail(error, LAR_ERROR_MODEL, "%s: none of the chosen labels has a voxel",
                        image->source);
    lar_voxel_grid made = {.size = cbrt(lar_image_voxel_volume(image))};
    bool turned[3]; /* axes that the grid follows backwards, to be right-handed */
    for (int a = 0; a < 3; a++) {
        made.cells[a] = high[a] - low[a] + 2;
        memcpy(made.axis[a], boundary->axis[a], sizeof made.axis[a]);
        turned[a] = lar_dot(made.axis[a], step[a]) < 0;
    }
    for (int a = 0; a < 3; a++) {
        made.origin[a] = image->to_world[a][3];
        for (int b = 0; b < 3; b++)
            made.origin[a] += step[b][a] * (turned[b] ? high[b] - 0.5 : low[b] - 0.5) -
                              made.size * made.axis[b][a];
    }
    size_t cells = (size_t)made.cells[0] * (size_t)made.cells[1] * (size_t)made.cells[2];
    if (cells > LAR_VOXEL_GRID_CELLS_MAX)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: %zu voxels around the body are more than the %d that a grid may have; "
                        "name a size",
                        image->source, cells, (int)LAR_VOXEL_GRID_CELLS_MAX);
    made.region = lar_calloc(cells, 1);
    made.inner = lar_calloc(cells, 1);
    made.share = lar_calloc(cells, 1);
    if (!made.region || !made.inner || !made.share) {
        lar_voxel_grid_clear(&made);
        return lar_fail_memory(error, 3 * cells, "the grid of cells");
    }
    for (int32_t k = low[2]; k < high[2]; k++)
        for (int32_t j = low[1]; j < high[1]; j++)
            for (int32_t i = low[0]; i < high[0]; i++) {
                size_t voxel =
                    ((size_t)k * (size_t)image->size[1] + (size_t)j) * (size_t)image->size[0] +
                    (size_t)i;
                int32_t at[3] = {i, j, k};
                for (int a = 0; a < 3; a++)
                    at[a] = 1 + (turned[a] ? high[a] - 1 - at[a] : at[a] - low[a]);
                size_t cell = lar_voxel_grid_cell(&made, at[0], at[1], at[2]);
                made.region[cell] = boundary->region_of_label[image->label[voxel]];
                made.inner[cell] = made.region[cell];
                made.share[cell] = made.region[cell] ? 255 : 0;
            }
    *voxel_grid = made;
    return LAR_OK;
}
