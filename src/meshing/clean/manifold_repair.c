#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "meshing/clean/clean.h"

/* Volume: a cell's is 255. A region that has less of the cell than another one, and a cell that
 * holds nothing of the body, cost that much more. */
enum { CELL = 255, WRONG_REGION = 150, NOTHING_INSIDE = 120 };

/* A cell that a region lacks, or has too much, costs up to this: less than a point where a region
 * is not clean, more than a squashed cell in the wrong region. */
static const double NUMBER = 300, NUMBER_PART = 0.1;

/* The least gain of a flip in each pass: what is clearly wrong is put right before what could as
 * well be otherwise. The last entry repeats until nothing changes. */
static const int32_t GAINS[] = {50000, 800, 250, 100, 1};
enum { GAIN_COUNT = sizeof GAINS / sizeof *GAINS };

/* Marks of cells. */
enum { LOOK_AT = 1 };

/* Labels that a cell may take: its own, those of its neighbours, the one of its largest part. */
enum { LABELS_MAX = 9 };

static int32_t volume_cost(const lar_voxel_grid *voxel_grid, size_t cell, uint8_t label) {
    if (label == 0) return voxel_grid->share[cell];
    int32_t cost = CELL - voxel_grid->share[cell];
    if (voxel_grid->inner[cell] == 0) return cost + NOTHING_INSIDE;
    return cost + (label == voxel_grid->inner[cell] ? 0 : WRONG_REGION);
}

/* What it costs that a region has so many cells: nothing with those that it shall have, and beyond
 * a tenth too many or too few the same for each further one (Huber 1964). It is part of the sum
 * that every flip lowers. */
static int32_t number_cost(const lar_voxel_grid *voxel_grid, int region, int32_t count) {
    const double wanted = voxel_grid->wanted[region];
    if (region == 0 || !(wanted > 0)) return 0;
    const double tenth = fmax(1, NUMBER_PART * wanted), off = fabs(count - wanted);
    const double cost = off < tenth ? off * off / (2 * tenth) : off - tenth / 2;
    return (int32_t)lround(fmin(NUMBER * cost, 1e9));
}

/* By how much it changes when a cell goes from one region to another. */
static int32_t number_change(const lar_cleaner *cleaner, int from, int to) {
    const lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    const int32_t left = cleaner->count[from], entered = cleaner->count[to];
    return number_cost(voxel_grid, from, left - 1) - number_cost(voxel_grid, from, left) +
           number_cost(voxel_grid, to, entered + 1) - number_cost(voxel_grid, to, entered);
}

static void change_region(lar_cleaner *cleaner, size_t cell, uint8_t region) {
    cleaner->count[cleaner->voxel_grid->region[cell]]--;
    cleaner->count[region]++;
    cleaner->voxel_grid->region[cell] = region;
}

static int labels_around(const lar_clean_window *window, uint8_t inner, uint8_t label[LABELS_MAX]) {
    const uint8_t wanted[LABELS_MAX] = {window->label[2][2][2],
                                        window->label[2][2][1],
                                        window->label[2][2][3],
                                        window->label[2][1][2],
                                        window->label[2][3][2],
                                        window->label[1][2][2],
                                        window->label[3][2][2],
                                        inner,
                                        0};
    int count = 0;
    for (int w = 0; w < LABELS_MAX; w++) {
        bool known = false;
        for (int l = 0; l < count; l++) known = known || label[l] == wanted[w];
        if (!known) label[count++] = wanted[w];
    }
    return count;
}

/* A change of a cell, and by how much it lowers the sum. */
typedef struct flip {
    uint8_t label;
    int32_t gain;
} flip;

/* The best change of a cell; gain 0: none lowers the sum. */
static flip best_flip(const lar_cleaner *cleaner, size_t cell) {
    const lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    flip best = {voxel_grid->region[cell], 0};
    int at[3];
    lar_clean_position(voxel_grid, cell, at);
    if (!lar_clean_may_fill(voxel_grid, at)) return best;
    /* Of no region the last one. */
    if (best.label != 0 && cleaner->count[best.label] == 1) return best;
    lar_clean_window window;
    lar_clean_look(voxel_grid, at, &window);
    uint8_t label[LABELS_MAX];
    const int count = labels_around(&window, voxel_grid->inner[cell], label);
    if (count == 1) return best;
    int unclean, unclean_then;
    const uint8_t own = label[0];
    const int32_t cost = lar_clean_cost(&window, &unclean) + volume_cost(voxel_grid, cell, own);
    for (int l = 1; l < count; l++) {
        int32_t then =
            volume_cost(voxel_grid, cell, label[l]) + number_change(cleaner, own, label[l]);
        if (cost - then <= best.gain) continue; /* the rest of the sum is never below 0 */
        window.label[2][2][2] = label[l];
        then += lar_clean_cost(&window, &unclean_then);
        window.label[2][2][2] = own;
        if (cost - then <= best.gain) continue;
        if (unclean_then >= unclean && !lar_clean_is_simple(&window, label[l])) continue;
        best = (flip){label[l], cost - then};
    }
    return best;
}

/* Cells whose part of the sum may have changed with a cell. */
static void look_around(lar_cleaner *cleaner, size_t cell) {
    const lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    int at[3];
    lar_clean_position(voxel_grid, cell, at);
    for (int k = at[2] - 2; k <= at[2] + 2; k++)
        for (int j = at[1] - 2; j <= at[1] + 2; j++)
            for (int i = at[0] - 2; i <= at[0] + 2; i++) {
                const int other[3] = {i, j, k};
                if (lar_clean_may_fill(voxel_grid, other))
                    cleaner->mark[lar_voxel_grid_cell(voxel_grid, i, j, k)] = LOOK_AT;
            }
}

/* One pass over all marked cells; *flips: how many changed. */
static void descend(lar_cleaner *cleaner, int32_t min_gain, size_t *flips) {
    *flips = 0;
    for (size_t c = 0; c < cleaner->cells; c++) {
        if (cleaner->mark[c] != LOOK_AT) continue;
        const flip best = best_flip(cleaner, c);
        if (best.gain < min_gain) {
            /* Until something around it changes; a smaller gain is for a later pass. */
            if (best.gain == 0) cleaner->mark[c] = 0;
            continue;
        }
        change_region(cleaner, c, best.label);
        look_around(cleaner, c);
        (*flips)++;
    }
}

/* Marks cells that have another region beside them; those of the outermost layer have none. */
static void mark_surface(lar_cleaner *cleaner) {
    const lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    memset(cleaner->mark, 0, cleaner->cells);
    for (int k = 1; k < voxel_grid->cells[2] - 1; k++)
        for (int j = 1; j < voxel_grid->cells[1] - 1; j++)
            for (int i = 1; i < voxel_grid->cells[0] - 1; i++) {
                const size_t c = lar_voxel_grid_cell(voxel_grid, i, j, k);
                const uint8_t own = voxel_grid->region[c];
                const size_t row = (size_t)voxel_grid->cells[0];
                const size_t step[3] = {1, row, row * (size_t)voxel_grid->cells[1]};
                for (int d = 0; d < 3; d++)
                    if (voxel_grid->region[c - step[d]] != own ||
                        voxel_grid->region[c + step[d]] != own)
                        cleaner->mark[c] = LOOK_AT;
            }
}

/* Adds the cell outside that costs least at a point that is not clean. There is one: of the cells
 * around a point those that may be filled are 1, 2, 4 or 8 in a row, a square or a cube, and once
 * they are filled the point is clean. */
static bool add_at(lar_cleaner *cleaner, const int point[3]) {
    lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    size_t chosen = 0;
    int32_t min = INT32_MAX;
    for (int c = 0; c < 8; c++) {
        const int at[3] = {point[0] - 1 + (c & 1), point[1] - 1 + (c >> 1 & 1),
                           point[2] - 1 + (c >> 2)};
        if (!lar_clean_may_fill(voxel_grid, at)) continue;
        const size_t cell = lar_voxel_grid_cell(voxel_grid, at[0], at[1], at[2]);
        if (voxel_grid->region[cell] != 0) continue;
        const uint8_t label = lar_clean_fill(voxel_grid, cell);
        if (label == 0) continue;
        int unclean;
        lar_clean_window window;
        lar_clean_look(voxel_grid, at, &window);
        window.label[2][2][2] = label;
        const int32_t cost =
            lar_clean_cost(&window, &unclean) + volume_cost(voxel_grid, cell, label);
        if (cost >= min) continue;
        min = cost;
        chosen = cell;
    }
    if (min == INT32_MAX) return false;
    change_region(cleaner, chosen, lar_clean_fill(voxel_grid, chosen));
    look_around(cleaner, chosen);
    return true;
}

/* Adds cells at points that are not clean; how many. */
static size_t add_at_unclean(lar_cleaner *cleaner) {
    const lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    size_t added = 0;
    for (int k = 1; k < voxel_grid->cells[2]; k++)
        for (int j = 1; j < voxel_grid->cells[1]; j++)
            for (int i = 1; i < voxel_grid->cells[0]; i++) {
                unsigned inside = 0;
                for (int c = 0; c < 8; c++) {
                    const size_t cell = lar_voxel_grid_cell(voxel_grid, i - 1 + (c & 1),
                                                            j - 1 + (c >> 1 & 1), k - 1 + (c >> 2));
                    inside |= (unsigned)(voxel_grid->region[cell] != 0) << c;
                }
                if (!lar_clean_block(inside)) added += add_at(cleaner, (const int[]){i, j, k});
            }
    return added;
}

static void descend_to_the_end(lar_cleaner *cleaner) {
    size_t flips;
    for (int g = 0; g < GAIN_COUNT; g++) descend(cleaner, GAINS[g], &flips);
    do descend(cleaner, GAINS[GAIN_COUNT - 1], &flips);
    while (flips > 0);
}

lar_status lar_clean_manifold(lar_cleaner *cleaner) {
    mark_surface(cleaner);
    memset(cleaner->count, 0, sizeof cleaner->count);
    for (size_t c = 0; c < cleaner->cells; c++) cleaner->count[cleaner->voxel_grid->region[c]]++;
    descend_to_the_end(cleaner);
    /* Afterwards no descent makes a point unclean: nothing that it gains outweighs that. */
    while (add_at_unclean(cleaner) > 0) {
    }
    descend_to_the_end(cleaner);
    return LAR_OK;
}
