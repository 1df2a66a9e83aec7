/* The last steps of a layout: rows of four in pairs, blocks for what no row took, their order, and
 * the numbers of the nodes that are in no row. */
#ifndef LAR_LAYOUT_FINISH_H
#define LAR_LAYOUT_FINISH_H

#include "layout/draft.h"

/* Finishes the layout of a draft; `general`: loose elements go into general blocks also if they are
 * boxes. False without memory. */
bool lar_finish_layout(lar_draft *draft, bool general);

/* What the blocks cost in a step, a row of eight being 1. */
double lar_layout_cost(const lar_layout *layout);
/* The least that `elements` elements can cost. */
double lar_layout_min_cost(int32_t elements);

#endif
