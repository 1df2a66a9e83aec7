#include <stdlib.h>
#include <string.h>

#include "meshing/clean/clean.h"

/* Limits of islands and pinholes, voxel_grid.h. */
static const double ISLAND_PART = 0.05, SPECK_PART = 0.0005, PINHOLE_PART = 0.01;
enum { PINHOLE_CELLS = 27 };
/* An island goes to its neighbours when these have at least this part of its outer faces. */
static const double GIVEN_PART = 0.25;

/* Marks of cells: all, those of the piece that is looked at. */
enum { OTHER = 1, OWN = 2 };

/* Cells of one region that hang together by faces. */
typedef struct piece {
    size_t start; /* its first cell */
    int32_t size;
    uint8_t region;
} piece;

/* What lies around a piece. */
typedef struct surroundings {
    int32_t faces[LAR_REGIONS_MAX + 1]; /* by region */
} surroundings;

int lar_clean_neighbours(const lar_voxel_grid *voxel_grid, size_t cell, size_t found[6]) {
    size_t step = 1, rest = cell;
    int count = 0;
    for (int d = 0; d < 3; d++) {
        const size_t length = (size_t)voxel_grid->cells[d], at = rest % length;
        if (at > 0) found[count++] = cell - step;
        if (at + 1 < length) found[count++] = cell + step;
        rest /= length;
        step *= length;
    }
    return count;
}

/* Visits the piece of `start` and marks its cells; `around` may be NULL. With `label` not negative
 * its cells are given that region, or, where the piece is outside, the one that has most of them.
 */
static lar_status visit(lar_cleaner *cleaner, size_t start, uint8_t mark, int label, int32_t *size,
                        surroundings *around) {
    lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    const uint8_t region = voxel_grid->region[start];
    size_t waiting = 0;
    *size = 0;
    if (!LAR_GROW(cleaner->stack, cleaner->stack_capacity, waiting))
        return lar_fail_memory(cleaner->error, 64, "the pieces of the grid");
    cleaner->mark[start] = mark;
    cleaner->stack[waiting++] = (int32_t)start;
    while (waiting > 0) {
        const size_t cell = (size_t)cleaner->stack[--waiting];
        size_t next[6];
        const int count = lar_clean_neighbours(voxel_grid, cell, next);
        (*size)++;
        for (int n = 0; n < count; n++) {
            /* Looked at first: cells with the mark may have another region already. */
            if (cleaner->mark[next[n]] == mark) continue;
            if (voxel_grid->region[next[n]] != region) {
                if (around) around->faces[voxel_grid->region[next[n]]]++;
                continue;
            }
            if (!LAR_GROW(cleaner->stack, cleaner->stack_capacity, waiting))
                return lar_fail_memory(cleaner->error, 8 * cleaner->stack_capacity,
                                       "the pieces of the grid");
            cleaner->mark[next[n]] = mark;
            cleaner->stack[waiting++] = (int32_t)next[n];
        }
        if (label < 0) continue;
        const bool fill = region == 0 && voxel_grid->inner[cell] != 0;
        voxel_grid->region[cell] = fill ? voxel_grid->inner[cell] : (uint8_t)label;
        cleaner->before[cell] = voxel_grid->region[cell];
    }
    return LAR_OK;
}

/* All pieces, by first cell: the first one is what lies around the body. */
static lar_status find_islands(lar_cleaner *cleaner, piece **islands, size_t *count) {
    size_t capacity = 0;
    memset(cleaner->mark, 0, cleaner->cells);
    for (size_t c = 0; c < cleaner->cells; c++) {
        if (cleaner->mark[c]) continue;
        if (!LAR_GROW(*islands, capacity, *count))
            return lar_fail_memory(cleaner->error, 2 * capacity * sizeof **islands,
                                   "the pieces of the grid");
        piece *found = &(*islands)[(*count)++];
        *found = (piece){.start = c, .region = cleaner->voxel_grid->region[c]};
        lar_status status = visit(cleaner, c, OTHER, -1, &found->size, NULL);
        if (status) return status;
    }
    return LAR_OK;
}

/* Who gets an island: the region with most of its faces, or nobody (0). */
static uint8_t heir_of(const surroundings *around, uint8_t region) {
    int64_t sum = around->faces[0];
    int heir = 0;
    for (int r = 1; r <= LAR_REGIONS_MAX; r++) {
        sum += around->faces[r];
        if (r != region && (heir == 0 || around->faces[r] > around->faces[heir])) heir = r;
    }
    return (double)(sum - around->faces[0]) >= GIVEN_PART * (double)sum ? (uint8_t)heir : 0;
}

/* Marks a piece and looks around it. False when it is no longer the one that was found: islands
 * beside it that were left out or given away may have opened it or made it part of another one; the
 * next round judges it anew. */
static lar_status open_piece(lar_cleaner *cleaner, const piece *one, surroundings *around,
                             bool *same) {
    int32_t size;
    lar_status status = visit(cleaner, one->start, OWN, -1, &size, around);
    *same = size == one->size && cleaner->voxel_grid->region[one->start] == one->region;
    return status;
}

/* Unmarks it again; gives it to another region when `label` is not negative. */
static lar_status close_piece(lar_cleaner *cleaner, const piece *one, int label) {
    int32_t size;
    return visit(cleaner, one->start, OTHER, label, &size, NULL);
}

/* An island is joined to the rest of its region where the body leads there. A speck is given away
 * or left out otherwise. */
static lar_status take_island(lar_cleaner *cleaner, const piece *island, int32_t largest,
                              bool *changed) {
    const bool speck = island->size == 1 || island->size < SPECK_PART * largest;
    surroundings around = {{0}};
    bool joined = false, same;
    lar_status status = open_piece(cleaner, island, &around, &same);
    if (!status && same) status = lar_clean_bridge(cleaner, island->start, OWN, OTHER, &joined);
    if (status) return status;
    *changed = *changed || joined || !same || speck;
    if (joined || !same || !speck) return close_piece(cleaner, island, -1);
    const uint8_t heir = heir_of(&around, island->region);
    if (heir == 0) {
        cleaner->cleaning->islands++;
        cleaner->cleaning->island_cells += island->size;
    }
    return close_piece(cleaner, island, heir);
}

static lar_status fill_pinhole(lar_cleaner *cleaner, const piece *pinhole, bool *changed) {
    surroundings around = {{0}};
    bool same;
    lar_status status = open_piece(cleaner, pinhole, &around, &same);
    if (status) return status;
    *changed = true;
    if (!same) return close_piece(cleaner, pinhole, -1);
    const uint8_t heir = heir_of(&around, 0);
    cleaner->cleaning->pinholes++;
    cleaner->cleaning->pinhole_cells += pinhole->size;
    return close_piece(cleaner, pinhole, heir);
}

lar_status lar_clean_islands(lar_cleaner *cleaner, bool *changed) {
    piece *islands = NULL;
    size_t count = 0;
    int64_t body = 0;
    int32_t largest[LAR_REGIONS_MAX + 1] = {0};
    lar_status status = find_islands(cleaner, &islands, &count);
    for (size_t p = 0; !status && p < count; p++) {
        if (islands[p].region != 0) body += islands[p].size;
        if (islands[p].size > largest[islands[p].region])
            largest[islands[p].region] = islands[p].size;
    }
    *changed = false;
    /* The first piece is the outermost layer and all outside cells that it reaches. */
    for (size_t p = 1; !status && p < count; p++) {
        const piece *one = &islands[p];
        if (one->region == 0) {
            const double limit = PINHOLE_PART * (double)body;
            if (one->size > PINHOLE_CELLS || (one->size > 1 && one->size >= limit)) continue;
            status = fill_pinhole(cleaner, one, changed);
        } else {
            const int32_t max = largest[one->region];
            if (one->size == max || (one->size > 1 && one->size >= ISLAND_PART * max)) continue;
            status = take_island(cleaner, one, max, changed);
        }
    }
    free(islands);
    return status;
}
