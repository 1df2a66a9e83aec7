#include "meshing/grid/voxel_grid_votes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* A weight goes up while its region has too few cells and down while it has too many, by a step
 * that grows while the direction stays and halves when it turns (Riedmiller and Braun 1993). */
enum { ROUNDS = 60 };
static const double STEP_FIRST = 0.25, STEP_MAX = 0.5, GROW = 1.2, SHRINK = 0.5;

/* Near enough: this part of its cells, or half a cell. */
static const double NEAR = 0.01;

/* Rounding of a part: below it a region has nothing of the cell, from 1 less it on it has all. */
static const double ROUNDING = 1e-9;

/* A region is not made of cells that hold less than some hundredth of it. */
static const double WEIGHT_MAX = 32;

typedef struct ballot {
    double weight[LAR_REGIONS_MAX + 1], step[LAR_REGIONS_MAX + 1];
    int8_t turn[LAR_REGIONS_MAX + 1];
    int32_t cells[LAR_REGIONS_MAX + 1];
} ballot;

/* What a cell becomes. */
typedef struct choice {
    uint8_t region, inner, share;
} choice;

void lar_votes_clear(lar_votes *votes) {
    free(votes->vote);
    *votes = (lar_votes){0};
}

bool lar_votes_add(lar_votes *votes, size_t cell, int region, double part) {
    votes->volume[region] += part;
    if (part >= 1 - ROUNDING) {
        votes->certain[region]++;
        return true;
    }
    if (!(part > ROUNDING)) return true;
    if (!LAR_GROW(votes->vote, votes->capacity, votes->count)) return false;
    votes->vote[votes->count++] =
        (lar_vote){.cell = (int32_t)cell, .part = (float)part, .region = (uint8_t)region};
    return true;
}

/* The votes of one cell, from `first` on; *next: those of the next one. */
static choice choose(const lar_votes *votes, const double *weight, size_t first, size_t *next) {
    double inside = 0, outside = 1, largest = 0;
    choice made = {0};
    size_t v = first;
    for (; v < votes->count && votes->vote[v].cell == votes->vote[first].cell; v++) {
        const double part = weight[votes->vote[v].region] * votes->vote[v].part;
        inside += part;
        outside -= votes->vote[v].part;
        if (part > largest) largest = part, made.inner = votes->vote[v].region;
    }
    const double share = inside / (inside + fmax(0, outside));
    /* A body's flat side may lie in the middle of cells: rounding must not decide. */
    made.region = share >= 0.5 - 1e-6 ? made.inner : 0;
    made.share = (uint8_t)lround(255 * share);
    *next = v;
    return made;
}

static void count_cells(const lar_votes *votes, ballot *b) {
    memcpy(b->cells, votes->certain, sizeof b->cells);
    for (size_t v = 0; v < votes->count;) b->cells[choose(votes, b->weight, v, &v).region]++;
}

/* False: all are near enough. */
static bool change_weights(const lar_votes *votes, int32_t regions, ballot *b) {
    bool changed = false;
    for (int32_t r = 1; r <= regions; r++) {
        const double missing = votes->volume[r] - b->cells[r];
        if (fabs(missing) <= fmax(0.5, NEAR * votes->volume[r])) continue;
        const int8_t turn = missing > 0 ? 1 : -1;
        b->step[r] *= turn == -b->turn[r] ? SHRINK : GROW;
        b->step[r] = fmin(b->step[r], STEP_MAX);
        b->turn[r] = turn;
        const double factor = 1 + b->step[r];
        b->weight[r] = turn > 0 ? b->weight[r] * factor : b->weight[r] / factor;
        b->weight[r] = fmin(fmax(b->weight[r], 1 / WEIGHT_MAX), WEIGHT_MAX);
        changed = true;
    }
    return changed;
}

/* How far the numbers are from what they should be: for each region the part that it lacks, or has
 * too much. */
static double distance_of(const lar_votes *votes, int32_t regions, const ballot *b) {
    double sum = 0;
    for (int32_t r = 1; r <= regions; r++)
        sum += fabs(log((b->cells[r] + 0.5) / (votes->volume[r] + 0.5)));
    return sum;
}

void lar_votes_count(const lar_votes *votes, int32_t regions, lar_voxel_grid *voxel_grid) {
    ballot now = {.step = {0}};
    for (int32_t r = 0; r <= LAR_REGIONS_MAX; r++) now.weight[r] = 1, now.step[r] = STEP_FIRST;
    ballot best = now;
    double min = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        count_cells(votes, &now);
        const double distance = distance_of(votes, regions, &now);
        if (distance < min) min = distance, best = now;
        if (!change_weights(votes, regions, &now)) break;
    }
    for (int32_t r = 1; r <= regions; r++) voxel_grid->wanted[r] = votes->volume[r];
    for (size_t v = 0; v < votes->count;) {
        const size_t cell = (size_t)votes->vote[v].cell;
        const choice made = choose(votes, best.weight, v, &v);
        voxel_grid->region[cell] = made.region;
        voxel_grid->inner[cell] = made.inner;
        voxel_grid->share[cell] = made.share;
    }
}
