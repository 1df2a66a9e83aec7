#include "meshing/clean/clean.h"

#include <stdlib.h>
#include <string.h>

/* Flipping cells may cut off an island, leaving it out may open a joint: seldom more than once. */
enum { ROUNDS_MOST = 6 };

void lar_clean_position(const lar_lattice *lattice, size_t cell, int at[3]) {
    for (int d = 0; d < 3; d++) {
        at[d] = (int)(cell % (size_t)lattice->cells[d]);
        cell /= (size_t)lattice->cells[d];
    }
}

bool lar_clean_may_fill(const lar_lattice *lattice, const int at[3]) {
    for (int d = 0; d < 3; d++)
        if (at[d] < 1 || at[d] > lattice->cells[d] - 2) return false;
    return true;
}

uint8_t lar_clean_fill(const lar_lattice *lattice, size_t cell) {
    if (lattice->inner[cell] != 0) return lattice->inner[cell];
    const size_t row = (size_t)lattice->cells[0], layer = row * (size_t)lattice->cells[1];
    const size_t step[3] = {1, row, layer};
    uint8_t around[6], best = 0;
    int most = 0;
    for (int f = 0; f < 6; f++)
        around[f] = lattice->region[f % 2 ? cell + step[f / 2] : cell - step[f / 2]];
    for (int f = 0; f < 6; f++) {
        int count = 0;
        for (int g = 0; g < 6; g++) count += around[g] == around[f];
        if (around[f] == 0 || count < most || (count == most && around[f] > best)) continue;
        most = count;
        best = around[f];
    }
    return best;
}

static void count_flips(const lar_cleaner *cleaner) {
    for (size_t c = 0; c < cleaner->cells; c++) {
        const bool was = cleaner->before[c] != 0, is = cleaner->lattice->region[c] != 0;
        cleaner->cleaning->added += !was && is;
        cleaner->cleaning->removed += was && !is;
    }
}

static lar_status check_left(const lar_cleaner *cleaner) {
    for (size_t c = 0; c < cleaner->cells; c++)
        if (cleaner->lattice->region[c] != 0) return LAR_OK;
    return lar_fail(cleaner->error, LAR_ERROR_MODEL,
                    "nothing is left of the body at an element size of %g m: it is thinner than "
                    "that everywhere; take smaller elements",
                    cleaner->lattice->size);
}

lar_status lar_lattice_clean(lar_lattice *lattice, lar_cleaning *cleaning, lar_error *error) {
    *cleaning = (lar_cleaning){0};
    lar_cleaner cleaner = {.lattice = lattice, .cells = 1, .cleaning = cleaning, .error = error};
    for (int d = 0; d < 3; d++) cleaner.cells *= (size_t)lattice->cells[d];
    cleaner.before = lar_calloc(cleaner.cells, 1);
    cleaner.mark = lar_calloc(cleaner.cells, 1);
    lar_status status = LAR_OK;
    if (!cleaner.before || !cleaner.mark)
        status = lar_fail_memory(error, 2 * cleaner.cells, "cleaning the grid");
    else
        memcpy(cleaner.before, lattice->region, cleaner.cells);
    bool changed = true;
    for (int round = 0; !status && changed && round < ROUNDS_MOST; round++) {
        status = lar_clean_pieces(&cleaner, &changed);
        if (!status && (changed || round == 0)) status = lar_clean_joints(&cleaner);
        changed = changed || round == 0;
    }
    if (!status) status = check_left(&cleaner);
    if (!status) count_flips(&cleaner);
    free(cleaner.before);
    free(cleaner.mark);
    free(cleaner.stack);
    return status;
}
