/* Vectors of three numbers, and which of two numbers is less. */
#ifndef LAR_BASE_VECTOR_H
#define LAR_BASE_VECTOR_H

#include <math.h>

/* fmin and fmax of a number `a`, without a call: what is no number in `b` is not taken. */
static inline double lar_lesser(double a, double b) {
    return b < a ? b : a;
}
static inline double lar_greater(double a, double b) {
    return b > a ? b : a;
}

static inline double lar_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = a x b; `out` is none of them. */
static inline void lar_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* out = a - b; `out` may be one of them. */
static inline void lar_minus(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static inline double lar_length(const double a[3]) {
    return sqrt(lar_dot(a, a));
}

#endif
