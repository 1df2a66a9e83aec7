/* One attempt to thread the elements of a model into rows.
 *
 * A node has one number, so it can be in rows of one direction only: elements where regions of
 * two directions meet stay loose. Two things keep regions large.
 *
 *   patience    the best runs go first: over several passes along the Z curve, what a run must be
 *               worth falls from high to nothing (run_score in row_plan.c);
 *   long lines  the four lines of the first row in a place are numbered on beyond its ends, from
 *               edge to edge as far as the mesh goes:
 *
 *                   +---+---+---+---+          the row that comes first
 *                   o---o---o---o---o . . .    its line, and the nodes numbered beyond it
 *                       +---+---+---+---+      a row beside it that starts elsewhere fits too
 *
 * What is best differs from mesh to mesh; layouts are made with several habits, and the cheapest is
 * kept. How runs are traced is replaceable: in a whole model in all three directions through
 * opposite faces (rows.h), in a part of one along given turns (chains.h).
 */
#ifndef LAR_LAYOUT_ROW_PLAN_H
#define LAR_LAYOUT_ROW_PLAN_H

#include "layout/draft.h"

typedef struct lar_row_habit {
    int axis;        /* of an element's own axes, the one that is looked at first */
    double patience; /* by which the wanted score falls from pass to pass */
} lar_row_habit;

/* The nodes of a turned element on its four lines along xi, at its left and right end. */
static const int lar_line_left[4] __attribute__((unused)) = {0, 3, 4, 7};
static const int lar_line_right[4] __attribute__((unused)) = {1, 2, 5, 6};

/* How a plan finds its way through a mesh. */
typedef struct lar_row_ways lar_row_ways;
struct lar_row_ways {
    const void *map;
    bool turned; /* layout->corner is settled: the way through an element is its xi direction */
    /* As lar_rows_trace and lar_rows_beyond (rows.h). */
    int (*trace)(const lar_row_ways *ways, const lar_draft *draft, lar_gid e, int front, int max,
                 int32_t *run, int32_t (*corner)[8]);
    lar_gid (*beyond)(const lar_row_ways *ways, const lar_draft *draft, lar_gid *e, lar_gid from,
                      lar_gid to);
};

/* All directions of a mesh. `neighbour`: lar_rows_neighbours. */
lar_row_ways lar_row_ways_all(const int32_t *neighbour);

/* Makes the blocks of rows of a fresh draft, rows of four alone in the first half of a block, and
 * numbers their nodes. False without memory. */
bool lar_row_plan(lar_draft *draft, const lar_row_ways *ways, lar_row_habit habit);

#endif
