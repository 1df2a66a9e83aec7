/* Poses of tools that come from outside: a caller, a script, a packet, a message, a file. One rule
 * for all of them. */
#ifndef LAR_BASE_POSE_H
#define LAR_BASE_POSE_H

#include <stdbool.h>

#include "lariat.h"

#define LAR_POSE_FARTHEST 1e9 /* from the origin, along each axis [m] */

/* Refuses what is no pose of a tool: positions that are not finite or beyond 1e9 m, an orientation
 * whose length is off 1 by more than 1 %, an opening beyond 0 to 1. The orientation of a good one
 * then has length one but for rounding. `whose` begins the sentence: "tool probe"; NULL
 * where the caller does. */
lar_status lar_pose_normalise(lar_tool_pose *pose, const char *whose, lar_error *error);

/* Whether a pose is as lar_pose_normalise leaves it, also after it has been blended: for what
 * Lariat itself has written, and for models. */
bool lar_pose_is_normal(const lar_tool_pose *pose);

#endif
