/* An instrument that goes through a trocar (T 1.6, fig. 1.4): four degrees of freedom.
 *
 *            | z of the trocar: out of the body
 *            |   / shaft, u
 *            |  /        alpha: tilt about x        u = Rx(alpha) Ry(beta) z
 *            | /         beta:  tilt about y        tip = point - d u
 *     -------o-------    d:     depth of the tip    orientation = Rx(alpha) Ry(beta) Rz(gamma)
 *           /  point     gamma: roll about the shaft
 *          /
 *         * tip
 *
 * Whatever the device says, the shaft passes through the point: tilts and depth follow from where
 * the tip is, only the roll is taken from how the device is held. No library call but sine, cosine
 * and their inverses; nothing here is part of the state that is hashed.
 */
#ifndef LAR_SESSION_DEVICE_TROCAR_H
#define LAR_SESSION_DEVICE_TROCAR_H

#include <stdbool.h>

#include "lariat.h"

typedef struct lar_trocar {
    double point[3];             /* where it pivots [m] */
    double frame[4];             /* quaternion: the trocar's axes into the scene's */
    double tilt_max;             /* limit of alpha and beta [rad] */
    double depth_min, depth_max; /* limits of d [m] */
} lar_trocar;

typedef struct lar_trocar_angles {
    double alpha, beta; /* [rad] */
    double d;           /* [m] */
    double gamma;       /* [rad], -pi..pi */
} lar_trocar_angles;

/* The trocar's z points from the tool's tip at rest to the point; where they are the same, along
 * the tool's shaft. Limits: 80 degrees, 1 mm, 0.5 m. */
void lar_trocar_create(lar_trocar *trocar, const double point[3], const lar_tool_pose *rest);

/* The pose that belongs to four degrees of freedom. The opening stays as it is. */
void lar_trocar_pose(const lar_trocar *trocar, const lar_trocar_angles *angles,
                     lar_tool_pose *pose);

/* The four degrees of freedom of a pose, without limits. False when the tip is not inside the body
 * (d would be less than depth_min, or it is on the outer side): alpha and beta then stay as they
 * are, d is depth_min. */
bool lar_trocar_find(const lar_trocar *trocar, const lar_tool_pose *pose,
                     lar_trocar_angles *angles);

/* Brings them within the limits. */
void lar_trocar_limit(const lar_trocar *trocar, lar_trocar_angles *angles);

#endif
