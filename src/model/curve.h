/* How something changes in time: a factor, 1 by default.
 *
 * Values are evaluated with + - * / and fmod, which is exact, so that they have the same bits
 * everywhere.
 */
#ifndef LAR_MODEL_CURVE_H
#define LAR_MODEL_CURVE_H

#include <stdbool.h>

typedef enum lar_curve_kind {
    LAR_CURVE_RAMP, /* 0 to 1 over `over` seconds, smooth (third-order smoothstep), then held;
                       over == 0: 1 from the start */
    LAR_CURVE_TABLE /* through the points (time, value), held before and after */
} lar_curve_kind;

typedef enum lar_curve_shape {
    LAR_CURVE_LINEAR, /* straight between points */
    LAR_CURVE_STEP,   /* the value of the NEXT point (FEBio "STEP") */
    LAR_CURVE_SMOOTH, /* smoothstep between points (FEBio "SMOOTH" with two points) */
    LAR_CURVE_HOLD,   /* the value of the point before, held until the next ("step" in scenes) */
    LAR_CURVE_SPLINE  /* through the points without a kink, and nowhere beyond their values */
} lar_curve_shape;

typedef struct lar_curve {
    lar_curve_kind kind;
    double over;
    lar_curve_shape shape;
    bool repeats; /* a table's last point is its first again, for ever */
    int count;
    double (*point)[2]; /* (time [s], value), ascending; equal times are a jump; owned */
} lar_curve;

/* Value at `time` (seconds). A table without points is 1. */
double lar_curve_value(const lar_curve *curve, double time);

/* The mean over `width` seconds about `time`, not before 0, where a table goes there through pieces
 * shorter than sixteen times that: pulses keep their impulse however long a step is. Else, and
 * with a width of 0, the value at `time`. */
double lar_curve_mean(const lar_curve *curve, double time, double width);

/* Time after which the value no longer changes, or begins to repeat [s], at least 0. */
double lar_curve_end(const lar_curve *curve);

/* Keeps the value that a table has at `time` for ever after. */
void lar_curve_hold_from(lar_curve *curve, double time);

#endif
