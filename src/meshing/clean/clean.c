#include "meshing/clean/clean.h"

#include <stdlib.h>
#include <string.h>

/* Flipping cells may cut off an island, leaving it out may join cells by an edge or a corner only:
 * seldom more than once. */
enum { ROUNDS_MAX = 6 };

void lar_clean_position(const lar_voxel_grid *voxel_grid, size_t cell, int at[3]) {
    for (int d = 0; d < 3; d++) {
        at[d] = (int)(cell % (size_t)voxel_grid->cells[d]);
        cell /= (size_t)voxel_grid->cells[d];
    }
}

bool lar_clean_may_fill(const lar_voxel_grid *voxel_grid, const int at[3]) {
    for (int d = 0; d < 3; d++)
        if (at[d] < 1 || at[d] > voxel_grid->cells[d] - 2) return false;
    return true;
}

uint8_t lar_clean_fill(const lar_voxel_grid *voxel_grid, size_t cell) {
    if (voxel_grid->inner[cell] != 0) return voxel_grid->inner[cell];
    const size_t row = (size_t)voxel_grid->cells[0], layer = row * (size_t)voxel_grid->cells[1];
    const size_t step[3] = {1, row, layer};
    uint8_t around[6], best = 0;
    int max = 0;
    for (int f = 0; f < 6; f++)
        around[f] = voxel_grid->region[f % 2 ? cell + step[f / 2] : cell - step[f / 2]];
    for (int f = 0; f < 6; f++) {
        int count = 0;
        for (int g = 0; g < 6; g++) count += around[g] == around[f];
        if (around[f] == 0 || count < max || (count == max && around[f] > best)) continue;
        max = count;
        best = around[f];
    }
    return best;
}

static void count_flips(const lar_cleaner *cleaner) {
    for (size_t c = 0; c < cleaner->cells; c++) {
        const bool was = cleaner->before[c] != 0, is = cleaner->voxel_grid->region[c] != 0;
        cleaner->cleaning->added += !was && is;
        cleaner->cleaning->removed += was && !is;
    }
}

static lar_status check_left(const lar_cleaner *cleaner) {
    for (size_t c = 0; c < cleaner->cells; c++)
        if (cleaner->voxel_grid->region[c] != 0) return LAR_OK;
    return lar_fail(cleaner->error, LAR_ERROR_MODEL,
                    "nothing is left of the body at an element size of %g m: it is thinner than "
                    "that everywhere; take smaller elements",
                    cleaner->voxel_grid->size);
}

lar_status lar_voxel_grid_clean(lar_voxel_grid *voxel_grid, lar_cleaning *cleaning,
                                lar_error *error) {
    *cleaning = (lar_cleaning){0};
    lar_cleaner cleaner = {
        .voxel_grid = voxel_grid, .cells = 1, .cleaning = cleaning, .error = error};
    for (int d = 0; d < 3; d++) cleaner.cells *= (size_t)voxel_grid->cells[d];
    cleaner.before = lar_calloc(cleaner.cells, 1);
    cleaner.mark = lar_calloc(cleaner.cells, 1);
    lar_status status = LAR_OK;
    if (!cleaner.before || !cleaner.mark)
        status = lar_fail_memory(error, 2 * cleaner.cells, "cleaning the grid");
    else
        memcpy(cleaner.before, voxel_grid->region, cleaner.cells);
    bool changed = true;
    for (int round = 0; !status && changed && round < ROUNDS_MAX; round++) {
        status = lar_clean_islands(&cleaner, &changed);
        if (!status && (changed || round == 0)) status = lar_clean_manifold(&cleaner);
        changed = changed || round == 0;
    }
    if (!status) status = check_left(&cleaner);
    if (!status) count_flips(&cleaner);
    free(cleaner.before);
    free(cleaner.mark);
    free(cleaner.stack);
    return status;
}
