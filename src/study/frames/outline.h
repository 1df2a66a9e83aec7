/* About where the tissue ends in a frame: the way from one side of the tube to the other along
 * which the picture changes most from tissue to background.
 *
 *     y  . . . . . . . . .      at every place (x, y): light above less light below, as means of
 *        . . . o o o . . .      some pixels; no place counts for more than the half of columns
 *        . . o . . . o . .      have, so that a speck is worth no more than the edge
 *        . o . . . . . o .
 *     x ->                      the best way with a price for every pixel up or down, found column
 *                               by column (dynamic programming): what is between specks goes on
 */
#ifndef LAR_STUDY_FRAMES_OUTLINE_H
#define LAR_STUDY_FRAMES_OUTLINE_H

#include "study/frames/view.h"

typedef struct lar_outline {
    int columns;
    double x, step; /* column k is at x + k step [pixels] */
    double *y;      /* [columns] */
    double change;  /* of light along the way, mean; 0: there is none */
} lar_outline;

/* Into a zeroed one; `tissue` is 1 or -1. Only LAR_ERROR_MEMORY. */
lar_status lar_outline_find(const lar_view *view, const lar_grey *image, int tissue,
                            lar_outline *outline, lar_error *error);
void lar_outline_clear(lar_outline *outline); /* idempotent */

/* Height and slope at x. */
void lar_outline_at(const lar_outline *outline, double x, double *y, double *slope);

#endif
