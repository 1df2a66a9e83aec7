#include "session/device/trocar.h"

#include <math.h>

#include "contact/tools.h"
#include "base/quaternion.h"

static const double TILT_MAX = 80 * 3.14159265358979323846 / 180;
static const double DEPTH_MIN = 0.001, DEPTH_MAX = 0.5;

/* The shortest turn that brings z to the unit vector u. */
static void turn_of_z(const double u[3], double q[4]) {
    q[0] = 1 + u[2], q[1] = -u[1], q[2] = u[0], q[3] = 0;
    if (!lar_quaternion_normalise(q)) /* u = -z: any half turn does */
        q[0] = 0, q[1] = 1, q[2] = 0, q[3] = 0;
}

void lar_trocar_create(lar_trocar *trocar, const double point[3], const lar_tool_pose *rest) {
    *trocar = (lar_trocar){.point = {point[0], point[1], point[2]},
                           .tilt_max = TILT_MAX,
                           .depth_min = DEPTH_MIN,
                           .depth_max = DEPTH_MAX};
    double u[3], length = 0;
    for (int i = 0; i < 3; i++) {
        u[i] = point[i] - rest->position[i];
        length += u[i] * u[i];
    }
    length = sqrt(length);
    if (length < DEPTH_MIN)
        lar_turn(rest->orientation, (const double[3]){0, 0, 1}, u);
    else
        for (int i = 0; i < 3; i++) u[i] /= length;
    turn_of_z(u, trocar->frame);
}

static void turn_about(int axis, double angle, double q[4]) {
    q[0] = cos(angle / 2);
    for (int i = 0; i < 3; i++) q[1 + i] = i == axis ? sin(angle / 2) : 0;
}

/* Orientation of the shaft before it is rolled. */
static void tilt(const lar_trocar *trocar, const lar_trocar_angles *angles, double q[4]) {
    double x[4], y[4];
    turn_about(0, angles->alpha, x);
    turn_about(1, angles->beta, y);
    lar_quaternion_product(trocar->frame, x, q);
    lar_quaternion_product(q, y, q);
}

void lar_trocar_pose(const lar_trocar *trocar, const lar_trocar_angles *angles,
                     lar_tool_pose *pose) {
    double roll[4], u[3];
    tilt(trocar, angles, pose->orientation);
    turn_about(2, angles->gamma, roll);
    lar_quaternion_product(pose->orientation, roll, pose->orientation);
    lar_quaternion_normalise(pose->orientation);
    lar_turn(pose->orientation, (const double[3]){0, 0, 1}, u);
    for (int i = 0; i < 3; i++) pose->position[i] = trocar->point[i] - angles->d * u[i];
}

bool lar_trocar_find(const lar_trocar *trocar, const lar_tool_pose *pose,
                     lar_trocar_angles *angles) {
    double out[3], u[3];
    for (int i = 0; i < 3; i++) out[i] = trocar->point[i] - pose->position[i];
    lar_turn_back(trocar->frame, out, u);
    double d = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    bool inside = d >= trocar->depth_min && u[2] > 0;
    angles->d = inside ? d : trocar->depth_min;
    if (inside) { /* u = d (sin b, -sin a cos b, cos a cos b) */
        angles->beta = asin(fmax(-1, fmin(1, u[0] / d)));
        angles->alpha = atan2(-u[1], u[2]);
    }
    /* What is left of the orientation, as a turn about the shaft: its part along z. */
    double straight[4], rest[4];
    tilt(trocar, angles, straight);
    lar_quaternion_inverse(straight, straight);
    lar_quaternion_product(straight, pose->orientation, rest);
    if (rest[0] < 0) rest[0] = -rest[0], rest[3] = -rest[3];
    angles->gamma = rest[0] == 0 && rest[3] == 0 ? 0 : 2 * atan2(rest[3], rest[0]);
    return inside;
}

void lar_trocar_limit(const lar_trocar *trocar, lar_trocar_angles *angles) {
    angles->alpha = fmax(-trocar->tilt_max, fmin(trocar->tilt_max, angles->alpha));
    angles->beta = fmax(-trocar->tilt_max, fmin(trocar->tilt_max, angles->beta));
    angles->d = fmax(trocar->depth_min, fmin(trocar->depth_max, angles->d));
}
