#include "model/curve.h"

#include <math.h>

static double smoothstep(double s) {
    return s * s * (3.0 - 2.0 * s);
}

static double ramp_value(double over, double time) {
    if (!(over > 0.0) || time >= over) return 1.0;
    return time <= 0.0 ? 0.0 : smoothstep(time / over);
}

/* The last point at or before `time`; the caller knows that there is one and that it is not the
 * last of the table. Of several points with the same time it is the last: a jump. */
static int point_before(const lar_curve *curve, double time) {
    int low = 0, high = curve->count - 1;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (curve->point[middle][0] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double table_value(const lar_curve *curve, double time) {
    int last = curve->count - 1;
    if (last < 0) return 1.0;
    double first = curve->point[0][0], end = curve->point[last][0];
    if (!(time >= first)) return curve->point[0][1];
    if (curve->repeats && time >= end) time = first + fmod(time - first, end - first);
    if (time >= end) return curve->point[last][1];
    int i = point_before(curve, time);
    const double *from = curve->point[i], *to = curve->point[i + 1];
    switch (curve->shape) {
    case LAR_CURVE_STEP:
        /* FEBio: a point's own time already belongs to the next interval, except the first. */
        return i == 0 && time == from[0] ? from[1] : to[1];
    case LAR_CURVE_HOLD:
        return from[1];
    case LAR_CURVE_SMOOTH:
        return from[1] + (to[1] - from[1]) * smoothstep((time - from[0]) / (to[0] - from[0]));
    case LAR_CURVE_LINEAR:
        break;
    }
    return from[1] + (to[1] - from[1]) * ((time - from[0]) / (to[0] - from[0]));
}

double lar_curve_value(const lar_curve *curve, double time) {
    return curve->kind == LAR_CURVE_RAMP ? ramp_value(curve->over, time) : table_value(curve, time);
}

void lar_curve_hold_from(lar_curve *curve, double time) {
    if (curve->kind != LAR_CURVE_TABLE || lar_curve_end(curve) <= time) return;
    double value = table_value(curve, time);
    int before = 0; /* points up to that time stay; one more begins what is held */
    while (curve->point[before][0] <= time) before++;
    curve->point[before][0] = time;
    curve->point[before][1] = value;
    curve->count = before + 1;
}

double lar_curve_end(const lar_curve *curve) {
    double end = 0.0;
    if (curve->kind == LAR_CURVE_RAMP)
        end = curve->over;
    else if (curve->count > 0)
        end = curve->point[curve->count - 1][0];
    return end > 0.0 ? end : 0.0;
}
