/* Between a hand and a tool: a virtual coupling (Colgate, Stanley and Brown 1995).
 *
 *     hand x ----/\/\/--[ k ]----.
 *            ----[ ]---[ b ]----- tool m, y ----> engine: moves to y within the tick
 *                                     ^---------- engine: mean force f of the tick before
 *
 * The tool has a small mass of its own and hangs on the hand by spring and damper; the tissue
 * pushes it, and the hand feels spring and damper, never the tissue itself. So what the hand feels
 * is bounded, whatever the tissue does; a tool that the tissue stops stays behind its hand; and
 * nothing that the hand does can move the tool faster than the speed limit. For tools of shape
 * hand the spring's pull is limited instead of the feeling: the tool stays so far behind that the
 * held tissue is pulled no harder.
 *
 * Passivity. A force that is held for a tick works on a hand that meanwhile moves on: a sampled
 * spring gives back more than it got, k (v T)^2 / 2 a tick. The energy that went in at both ends is
 * counted, and the hand gets only as much force as that pays for in the next tick (Hannaford and
 * Ryu 2002; Franken and others 2011).
 */
#ifndef LAR_SESSION_COUPLING_H
#define LAR_SESSION_COUPLING_H

#include <stdbool.h>

#include "lariat.h"

typedef struct lar_coupling_limits {
    double tool_speed; /* [m/s] */
    double hand_force; /* hands pull no harder [N] */
    double seconds;    /* of a tick */
} lar_coupling_limits;

typedef struct lar_coupling {
    lar_tool_shape shape;
    double mass, stiffness, damping; /* [kg] [N/m] [N s/m] */
    double speed, turn;              /* limits [m/s] [rad/s] */
    double pull, feel;               /* limits of the spring and of what the hand feels [N] */
    double feel_torque;              /* [N m] */
    double seconds;
    lar_tool_pose hand, tool; /* where they are: the hand now, the tool at the tick's end */
    double hand_velocity[3], tool_velocity[3]; /* [m/s] */
    double tissue[3];                          /* mean force of the last tick [N] */
    double felt[3];                            /* what the hand feels now [N] */
    double energy;                             /* that went in and was not given back [J] */
    bool begun;                                /* the hand has been seen since the reset */
} lar_coupling;

/* At rest with the tool. */
void lar_coupling_create(lar_coupling *coupling, const lar_tool_info *tool,
                         const lar_coupling_limits *limits);

/* The tool has been put somewhere: it rests at `pose`, and goes to its hand from there. */
void lar_coupling_reset(lar_coupling *coupling, const lar_tool_pose *pose);

/* The hand is at `hand` now: where the tool must be at the end of this tick. Call it in every tick,
 * also when the hand has not moved. */
void lar_coupling_follow(lar_coupling *coupling, const lar_tool_pose *hand, lar_tool_pose *tool);

/* The tick is done and the tissue pushed the tool with `force`: what the hand feels. Counts are
 * copied. */
void lar_coupling_feel(lar_coupling *coupling, const lar_tool_force *force, lar_tool_force *felt);

#endif
