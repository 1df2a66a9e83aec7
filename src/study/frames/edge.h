/* The edge of the tissue at one place, to a small part of a pixel, and how well it is known.
 *
 *     light
 *       |-----.   background
 *       |      \
 *       |tissue '-----
 *       +-----------> y
 *
 * All pixels of a strip, 9 wide or less where points are closer, and some 20 high, are taken as
 * they are, without interpolation: light on either side that may lean, and between them a step
 * that is blurred by a normal curve,
 *
 *     I = a0 + a1 y + b x + (c0 + c1 y) Phi((y - y0 - s x - q x^2) / sigma)
 *
 * Least squares of these nine by Levenberg and Marquardt, with weights that leave out what lies far
 * off (Tukey's biweight: specks, glints). y0 is the height; its variance is that of the squares,
 * with the noise from what is left, times what is known less where neighbours' noise is alike. To
 * it comes a fiftieth of a pixel across the edge, for what no fit sees: pixels that are no points,
 * bent lenses. Blur leaves a straight edge where it is, and moves a bent one inwards by half its
 * curvature times sigma^2, which is taken back. Where more than a tenth of the pixels are black or
 * white in full the curve is cut off, and the error is as long as the blur.
 */
#ifndef LAR_STUDY_FRAMES_EDGE_H
#define LAR_STUDY_FRAMES_EDGE_H

#include "study/frames/outline.h"

typedef struct lar_edge {
    bool found, clipped;   /* clipped: where much is black or white in full */
    double y, error;       /* height and its standard deviation [pixels] */
    double blur, contrast; /* sigma [pixels]; light of the background less that of the tissue */
    double clear;          /* contrast in its own standard deviations */
} lar_edge;

/* At distance x from the axis [pixels]. */
void lar_edge_find(const lar_view *view, const lar_grey *image, const lar_outline *outline,
                   int tissue, double x, lar_edge *edge);

#endif
