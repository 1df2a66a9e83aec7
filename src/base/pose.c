#include "base/pose.h"

#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "base/quaternion.h"

static const double GIVEN = 0.02, NORMAL = 1e-9; /* what the square of the length may be off */

static bool good_position(const double x[3]) {
    bool good = true;
    for (int i = 0; i < 3; i++) good = good && fabs(x[i]) <= LAR_POSE_FARTHEST;
    return good;
}

static double square_of(const double q[4]) {
    return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
}

static bool good_opening(double opening) {
    return opening >= 0 && opening <= 1;
}

/* How the sentence begins. */
static void begin(const char *whose, char text[128]) {
    snprintf(text, 128, "%s%s", whose ? whose : "", whose ? ": " : "");
}

lar_status lar_pose_normalise(lar_tool_pose *pose, const char *whose, lar_error *error) {
    char head[128];
    double square = square_of(pose->orientation);
    begin(whose, head);
    if (!good_position(pose->position))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%sthe position %g %g %g; it is three finite numbers, in metres, none "
                        "beyond %g",
                        head, pose->position[0], pose->position[1], pose->position[2],
                        LAR_POSE_FARTHEST);
    if (!(fabs(square - 1) <= GIVEN))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%sthe orientation has length %.9g; it is a quaternion w, x, y, z of "
                        "length 1 (1, 0, 0, 0: as the world)",
                        head, sqrt(square));
    if (!good_opening(pose->opening))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%san opening of %g; it goes from 0, closed, to 1, open", head,
                        pose->opening);
    lar_quaternion_normalise(pose->orientation);
    return LAR_OK;
}

bool lar_pose_is_normal(const lar_tool_pose *pose) {
    return good_position(pose->position) && fabs(square_of(pose->orientation) - 1) <= NORMAL &&
           good_opening(pose->opening);
}

void lar_quaternion_blend(const double a[4], const double b[4], double share, double out[4]) {
    static const double SMALL = 0.99; /* cosine of half the turn, 16 degrees: even within 1e-4 */
    double from[4], to[4], dot = 0;
    for (int i = 0; i < 4; i++) dot += a[i] * b[i];
    for (int i = 0; i < 4; i++) {
        from[i] = a[i];
        to[i] = dot < 0 ? -b[i] : b[i];
    }
    for (dot = fabs(dot); dot < SMALL; dot = sqrt(0.5 * (1 + dot))) {
        double *moved = share < 0.5 ? to : from, half[4];
        for (int i = 0; i < 4; i++) half[i] = from[i] + to[i];
        lar_quaternion_normalise(half);
        for (int i = 0; i < 4; i++) moved[i] = half[i];
        share = share < 0.5 ? 2 * share : 2 * share - 1;
    }
    for (int i = 0; i < 4; i++) out[i] = (1 - share) * from[i] + share * to[i];
    if (!lar_quaternion_normalise(out))
        for (int i = 0; i < 4; i++) out[i] = a[i];
}
