/* The layout of what one processor of several recovers: some of the elements, with several threads.
 *
 *     whole layout                     part of processor p
 *     turned corners    ---- as they are ---->  corner
 *     rows, numbers                    rows and numbers of its own:
 *
 *     local nodes   | of thread 0        |s| of thread 1     | of thread 2       |s|s|
 *                   first_node[0]          first_node[1]       first_node[2]         first_node[3]
 *                                                              s: spare, ranges are even
 *
 * The last bits of an element depend on how it is turned (docs/determinism.md). So turns are
 * decided on the whole model, and a part's rows follow them (chains.h): the element that continues
 * e is the one whose left face is e's right face. With the direction of every element given, rows
 * are looked for as in a whole model (row_plan.h); cuts and threads only end some of them early.
 *
 * A block belongs to one thread. It is recovered with the earliest batch of its elements: an
 * element may be recovered earlier than somebody waits for it, never later. A line of a row must
 * have consecutive numbers and therefore one owner; whose range it lies in does not matter to the
 * thread that reads it.
 */
#ifndef LAR_LAYOUT_PART_LAYOUT_H
#define LAR_LAYOUT_PART_LAYOUT_H

#include "layout/layout.h"

/* Who recovers what in one processor, and when. */
typedef struct lar_part {
    int32_t threads;
    const int32_t *thread; /* [elements of the model] who recovers it; -1: another processor */
    const int32_t *batch;  /* [elements of the model] batch of its thread that needs it, from 0 */
    const int32_t *owner;  /* [nodes of the model] who moves it; -1: not in this processor */
} lar_part;

/* Lays out a part. `whole` lends its corners and must outlive the part. Fails for want of memory;
 * LAR_ERROR_ARGUMENT for threads and batches that are not there and for elements with nodes that
 * are not of this processor. Destroyed with lar_layout_destroy. */
lar_status lar_layout_create_part(const lar_model *model, const lar_layout *whole,
                                  const lar_part *part, lar_layout *layout, lar_error *error);

#endif
