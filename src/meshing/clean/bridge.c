/* A thin part of a body, between half a cell and nothing, falls out of a grid, and what hung on
 * it becomes an island. Where cells that hold some of the body lead from the island to the rest,
 * the cheapest row of them is taken in (Dijkstra 1959, with a list of cells for each cost: Dial
 * 1969). */
#include <stdlib.h>

#include "meshing/clean/clean.h"

/* A cell costs what it lacks, and something for being one more; longer ways are not looked for. */
enum { CELL = 255, ONE_MORE = 32, COST_MAX = 6 * (CELL + ONE_MORE) };

/* A cell that can be reached. */
typedef struct reached {
    size_t cell;
    int32_t from; /* the one before on the way, -1 at the start */
    int32_t next; /* the next with the same cost, -1 at the end */
} reached;

typedef struct search {
    reached *all;
    size_t count, capacity;
    int32_t first[COST_MAX + 1]; /* of each cost */
} search;

static bool reach(search *way, size_t cell, int32_t from, int32_t cost) {
    if (cost > COST_MAX) return true;
    if (way->count >= INT32_MAX || !LAR_GROW(way->all, way->capacity, way->count)) return false;
    way->all[way->count] = (reached){cell, from, way->first[cost]};
    way->first[cost] = (int32_t)way->count++;
    return true;
}

static bool may_take(const lar_voxel_grid *voxel_grid, size_t cell, uint8_t region) {
    if (voxel_grid->region[cell] != 0 || voxel_grid->inner[cell] != region) return false;
    int at[3];
    lar_clean_position(voxel_grid, cell, at);
    return lar_clean_may_fill(voxel_grid, at);
}

static void take_way(lar_voxel_grid *voxel_grid, const search *way, int32_t end, uint8_t region) {
    for (; end >= 0; end = way->all[end].from) {
        const size_t cell = way->all[end].cell;
        if (voxel_grid->region[cell] != 0) continue;
        voxel_grid->region[cell] = region;
        voxel_grid->share[cell] = CELL;
    }
}

/* The mark of cells that a search has come by. */
enum { DONE = 4 };

/* Goes on from one cell; *end: the last one of a way that has come to another piece. */
static bool go_on(lar_cleaner *cleaner, search *way, int32_t index, int32_t cost, uint8_t own,
                  int32_t *end) {
    const lar_voxel_grid *voxel_grid = cleaner->voxel_grid;
    const uint8_t region = voxel_grid->region[way->all[0].cell];
    size_t next[6];
    const int count = lar_clean_neighbours(voxel_grid, way->all[index].cell, next);
    for (int n = 0; n < count; n++) {
        const uint8_t mark = cleaner->mark[next[n]];
        if (mark == DONE) continue;
        if (voxel_grid->region[next[n]] == region && mark != own) {
            *end = index;
            return true;
        }
        if (mark != own && !may_take(voxel_grid, next[n], region)) continue;
        const int32_t more = mark == own ? 0 : CELL - voxel_grid->share[next[n]] + ONE_MORE;
        if (!reach(way, next[n], index, cost + more)) return false;
    }
    return true;
}

/* Takes the cells in the order of their cost. */
static bool run_search(lar_cleaner *cleaner, search *way, uint8_t own, int32_t *end) {
    for (int32_t cost = 0; cost <= COST_MAX && *end < 0; cost++)
        while (way->first[cost] >= 0 && *end < 0) {
            const int32_t index = way->first[cost];
            const reached *one = &way->all[index];
            way->first[cost] = one->next;
            if (cleaner->mark[one->cell] == DONE) continue;
            cleaner->mark[one->cell] = DONE;
            if (!go_on(cleaner, way, index, cost, own, end)) return false;
        }
    return true;
}

lar_status lar_clean_bridge(lar_cleaner *cleaner, size_t start, uint8_t own, uint8_t other,
                            bool *joined) {
    search *way = lar_calloc(1, sizeof *way);
    int32_t end = -1;
    *joined = false;
    if (!way) return lar_fail_memory(cleaner->error, sizeof *way, "the islands of the grid");
    for (int cost = 0; cost <= COST_MAX; cost++) way->first[cost] = -1;
    lar_status status = LAR_OK;
    if (!reach(way, start, -1, 0) || !run_search(cleaner, way, own, &end))
        status = lar_fail_memory(cleaner->error, 2 * way->capacity * sizeof *way->all,
                                 "the islands of the grid");
    for (size_t r = 0; r < way->count; r++) {
        const size_t cell = way->all[r].cell;
        cleaner->mark[cell] = cleaner->voxel_grid->region[cell] != 0 ? own : other;
    }
    if (!status && end >= 0) {
        take_way(cleaner->voxel_grid, way, end, cleaner->voxel_grid->region[start]);
        *joined = true;
    }
    free(way->all);
    free(way);
    return status;
}
