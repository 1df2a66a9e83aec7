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
 * What is best differs from mesh to mesh; layout.c tries several habits and keeps the cheapest.
 */
#ifndef LAR_ENGINE_ROW_PLAN_H
#define LAR_ENGINE_ROW_PLAN_H

#include "engine/draft.h"

typedef struct lar_row_habit {
    int axis;        /* of an element's own axes, the one that is looked at first */
    double patience; /* by which the wanted score falls from pass to pass */
} lar_row_habit;

/* Fills the blocks of rows of a fresh draft and numbers their nodes. `order`: the elements along
 * the Z curve; `neighbour`: lar_rows_neighbours. False without memory. */
bool lar_row_plan(lar_draft *draft, const lar_gid *order, const int32_t *neighbour,
                  lar_row_habit habit);

#endif
