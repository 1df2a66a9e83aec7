/* Turns as unit quaternions w, x, y, z (lar_tool_pose). */
#ifndef LAR_BASE_QUATERNION_H
#define LAR_BASE_QUATERNION_H

#include <math.h>
#include <stdbool.h>

/* out = a b: first b, then a. `out` may be one of them. */
static inline void lar_quaternion_product(const double a[4], const double b[4], double out[4]) {
    double w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    double x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    double y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    double z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    out[0] = w, out[1] = x, out[2] = y, out[3] = z;
}

static inline void lar_quaternion_inverse(const double q[4], double out[4]) {
    out[0] = q[0];
    for (int i = 1; i < 4; i++) out[i] = -q[i];
}

/* To length one. False when it is no quaternion: not finite, or too short to say a direction. */
static inline bool lar_quaternion_normalise(double q[4]) {
    double square = 0;
    for (int i = 0; i < 4; i++) square += q[i] * q[i];
    if (!(square > 1e-12 && square < 1e12)) return false;
    double length = sqrt(square);
    for (int i = 0; i < 4; i++) q[i] /= length;
    return true;
}

/* Between two turns on the shorter way: share 0 gives a, 1 gives b. Along the chord, brought back
 * to length one, which is even for small turns; of larger ones the half is taken, which is exact,
 * that has the share in it. */
void lar_quaternion_blend(const double a[4], const double b[4], double share, double out[4]);

/* The angle between two turns, 0..pi. */
static inline double lar_quaternion_angle(const double a[4], const double b[4]) {
    double difference[4], inverse[4];
    lar_quaternion_inverse(a, inverse);
    lar_quaternion_product(inverse, b, difference);
    double sine = sqrt(difference[1] * difference[1] + difference[2] * difference[2] +
                       difference[3] * difference[3]);
    return 2 * atan2(sine, fabs(difference[0]));
}

/* The turn from a to b on the shorter way: its axis, as long as its angle [rad]. */
static inline void lar_quaternion_turn(const double a[4], const double b[4], double out[3]) {
    double difference[4], inverse[4];
    lar_quaternion_inverse(a, inverse);
    lar_quaternion_product(b, inverse, difference);
    double sine = sqrt(difference[1] * difference[1] + difference[2] * difference[2] +
                       difference[3] * difference[3]);
    double angle = 2 * atan2(difference[0] < 0 ? -sine : sine, fabs(difference[0]));
    for (int i = 0; i < 3; i++) out[i] = sine > 0 ? angle / sine * difference[i + 1] : 0;
}

#endif
