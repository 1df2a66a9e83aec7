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

/* Slope between point i and the next; of a jump it does not count. */
static double chord(const lar_curve *curve, int i, double *width) {
    const double *from = curve->point[i], *to = curve->point[i + 1];
    *width = to[0] - from[0];
    return (to[1] - from[1]) / *width;
}

/* Slope in point i: the weighted harmonic mean of the chords beside it, 0 where they have different
 * signs, so that nothing is larger than its points (Fritsch and Butland 1984, eq. 5). 0 at the
 * ends, where the value is held, and beside a jump. */
static double slope_at(const lar_curve *curve, int i) {
    int last = curve->count - 1, before = i - 1, after = i;
    if (curve->repeats && (i == 0 || i == last)) {
        before = last - 1;
        after = 0;
    }
    if (before < 0 || after >= last) return 0;
    double h, k, first = chord(curve, before, &h), second = chord(curve, after, &k);
    if (!(h > 0) || !(k > 0) || !(first * second > 0)) return 0;
    double a = h + 2 * k, b = 2 * h + k;
    return (a + b) / (a / first + b / second);
}

/* The cubic of Hermite between point i and the next. */
static double spline_value(const lar_curve *curve, int i, double time) {
    const double *from = curve->point[i], *to = curve->point[i + 1];
    double h = to[0] - from[0], s = (time - from[0]) / h, t = 1 - s;
    double bend = t * slope_at(curve, i) - s * slope_at(curve, i + 1);
    return from[1] + (to[1] - from[1]) * smoothstep(s) + h * s * t * bend;
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
    case LAR_CURVE_SPLINE:
        return spline_value(curve, i, time);
    case LAR_CURVE_LINEAR:
        break;
    }
    return from[1] + (to[1] - from[1]) * ((time - from[0]) / (to[0] - from[0]));
}

double lar_curve_value(const lar_curve *curve, double time) {
    return curve->kind == LAR_CURVE_RAMP ? ramp_value(curve->over, time) : table_value(curve, time);
}

/* Whether a table goes through a piece shorter than `width` between two times; `first`: the point
 * that the earlier one lies behind. */
static bool is_quick(const lar_curve *curve, int first, double to, double width) {
    bool quick = false;
    for (int i = first; i + 1 < curve->count && curve->point[i][0] < to && !quick; i++) {
        const double length = curve->point[i + 1][0] - curve->point[i][0];
        quick = length > 0 && length < width;
    }
    return quick;
}

/* Adds a table's integral from one time to another, pieces between its points one by one: true,
 * when it goes there through one shorter than `width`. */
static bool integrate(const lar_curve *curve, double begin, double end, double width, double *sum) {
    static const double GAUSS = 0.28867513459481287; /* of a piece, from its middle: 1 / sqrt 12 */
    const int last = curve->count - 1;
    const int first = begin > curve->point[0][0] ? point_before(curve, begin) : 0;
    double from = begin;
    for (int i = first; from < end; i++) {
        const double to = i <= last ? fmin(curve->point[i][0], end) : end;
        if (!(to > from)) continue;
        const double middle = 0.5 * (from + to), aside = GAUSS * (to - from);
        *sum += 0.5 * (to - from) *
                (table_value(curve, middle - aside) + table_value(curve, middle + aside));
        from = to;
    }
    return is_quick(curve, first, end, width);
}

double lar_curve_mean(const lar_curve *curve, double time, double width) {
    static const double QUICK = 16, MANY = 64; /* widths; rounds of a table within one */
    const double begin = fmax(0, time - 0.5 * width), end = time + 0.5 * width;
    const int last = curve->count - 1;
    if (curve->kind != LAR_CURVE_TABLE || last < 1 || !(width > 0) || !(end > curve->point[0][0]) ||
        !(begin < curve->point[last][0] || curve->repeats))
        return lar_curve_value(curve, time);
    const double stop = curve->point[last][0], round = stop - curve->point[0][0];
    double from = begin, to = end, sum = 0;
    bool quick = false;
    if (curve->repeats && from >= stop) {
        from = curve->point[0][0] + fmod(from - curve->point[0][0], round);
        to = from + (end - begin);
    }
    if (to - from > MANY * round && curve->repeats) {
        integrate(curve, curve->point[0][0], stop, 0, &sum);
        return sum / round;
    }
    for (; curve->repeats && to > stop; to -= round) {
        quick = integrate(curve, from, stop, QUICK * width, &sum) || quick;
        from = curve->point[0][0];
    }
    quick = integrate(curve, from, to, QUICK * width, &sum) || quick;
    return quick ? sum / (end - begin) : lar_curve_value(curve, time);
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
