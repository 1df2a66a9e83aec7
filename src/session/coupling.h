/* Between a hand and a tool: a virtual coupling (Colgate, Stanley and Brown 1995).
 *
 *     hand x ----/\/\/--[ k ]----.
 *            ----[ ]---[ b ]----- tool m, y ----> engine: moves to y within the tick
 *                                     ^---------- engine: mean force f of the tick before
 *
 * The tool has a small mass of its own and hangs on the hand by spring and damper; the tissue
 * pushes it, and the hand feels spring and damper, never the tissue itself:
 *
 *     m dv/dt = s + f,    s = k (x - y) + b (dx/dt - v),   |s| <= pull
 *     the hand feels -s, but no more than `feel`, and no more than was paid for
 *
 * So the force on the hand is bounded whatever the tissue does, a tool that tissue stops stays
 * behind its hand, and no hand moves a tool faster than the speed limit. For tools of shape hand
 * the spring's limit is the force that tissue may be pulled with: the hold cannot pull harder for
 * long than the spring does.
 *
 * One backward Euler step a tick, spring, damper and the tissue's stiffness taken at its end: the
 * tissue's force comes a tick late, and an explicit step would swing on stiff tissue. How stiff it
 * is, is seen from the last forces. While the spring is at its limit, the damper works against the
 * world, so that it still damps; it then lets the tool go just at the speed limit.
 *
 * Passivity. A force that is held for a tick works on a hand that meanwhile moves on: a sampled
 * spring gives back more than it got, k (v T)^2 / 2 a tick, and a damper of samples feeds a
 * tremble. The damper makes up for it as long as the hand moves smoothly. For all others the energy
 * that went in at both ends is counted (Hannaford and Ryu 2002): at the hand's with the force that
 * it holds while it goes, the last one (Ryu, Kim and Hannaford 2004), and what the damper ate is
 * struck off. No force is given while the account is overdrawn. Else it is held back so far that
 * the rest pays for it when the hand goes on with it as far as in any tick of the last tenth of a
 * second or so, jumps back as far as it has jumped, or changes its speed by no more than
 * ACCELERATION (Franken and others 2011). So only a hand that jumps farther than it did before
 * overdraws, by one tick's force times that way, and once: until that is paid there is no force.
 * The way that ACCELERATION leads to grows with the square of the tick: 0.1 mm in 1 ms, 12 mm in
 * 11. No account at rest pays for that, and a hand that holds still would feel a part of the force
 * for ever. So in ticks of more than 2 ms a hand is expected to change its way by some times what
 * it has changed it by lately, and one that is still to stay so, but for what the credit always
 * bears. What a hand has paid for alone, by its own count, is kept besides, since it may have been
 * lost in the tissue: an overdraft is forgiven as long as that lasts. Turns have an account of
 * their own, of what turning has put in. There is a credit of CREDIT in each, which refills by
 * REFILL, so that positions that come a little early and late, as on every network, do not use it
 * up.
 */
#ifndef LAR_SESSION_COUPLING_H
#define LAR_SESSION_COUPLING_H

#include <stdbool.h>

#include "lariat.h"

static const double LAR_COUPLING_RATE = 500;        /* [N/s] */
static const double LAR_COUPLING_RATE_LEVER = 0.05; /* of torques beside forces [m] */

typedef struct lar_coupling_limits {
    double tool_speed; /* [m/s] */
    double hand_force; /* hands pull no harder [N] */
    double seconds;    /* of a tick */
    double time_step;  /* of the engine [s]: no tool goes farther in a step than it may */
} lar_coupling_limits;

/* What a hand did in single ticks, along each axis. */
typedef struct lar_coupling_ways {
    double last[3], least[3], most[3]; /* in the last tick; of the last time, both around 0 */
    double change;                     /* from tick to tick, the largest of the last time */
} lar_coupling_ways;

typedef struct lar_coupling {
    lar_tool_shape shape;
    double mass, stiffness, damping; /* [kg] [N/m] [N s/m] */
    double speed, turn;              /* limits [m/s] [rad/s] */
    double squeeze;                  /* limit of the opening's change [1/s] */
    double lever, jaw;  /* from the tip to where a turn counts; way of a jaw's end [m] */
    double speed_max;   /* what lar_coupling_set_speed may give [m/s] */
    double pull, feel;  /* limits of the spring and of what the hand feels [N] */
    double drag;        /* of a tool whose spring is at its limit [N s/m] */
    double feel_torque; /* [N m] */
    double rate;        /* of what the hand feels, at most [N/s] */
    double seconds;
    lar_tool_pose hand, tool; /* where they are: the hand now, the tool at the tick's end */
    lar_tool_pose end;        /* of the spring, on the hand's side */
    double hand_velocity[3], tool_velocity[3]; /* [m/s] */
    double tissue[3];                          /* mean force of the last tick [N] */
    double tissue_stiffness;                   /* as seen lately [N/m] */
    double way[3];                             /* of the tool in the last tick [m] */
    double spring[3];                          /* what pulls the tool to the hand [N] */
    lar_coupling_ways steps, turns;            /* of the hand [m] [rad] */
    int32_t held;
    double felt[3];         /* what the hand feels now [N] */
    double turned[3];       /* the torque that it feels [N m] */
    double credit, energy;  /* at the beginning; that went in and was not given back [J] */
    double share;           /* of the spring that the hand feels, 0..1 */
    double paid, turn_paid; /* by the hand alone and not given back, by its way and its turn [J] */
    double held_back[2];    /* shares of force and torque that nobody paid for, last, 0..1 */
    double given;           /* to the tissue, and paid by nobody [J] */
    bool begun;             /* the hand has been seen since the reset */
} lar_coupling;

/* At rest with the tool. */
void lar_coupling_create(lar_coupling *coupling, const lar_tool_info *tool,
                         const lar_coupling_limits *limits);

/* The tool goes no faster than `speed` from now on, nor than its limits: INFINITY takes these. */
void lar_coupling_set_speed(lar_coupling *coupling, double speed);

/* What the hand feels changes by no more than so many N/s of the clock, a torque by that times 5
 * cm; but what nobody paid for is held back at once. Without it LAR_COUPLING_RATE. */
void lar_coupling_set_rate(lar_coupling *coupling, double rate);

/* Another hand takes over: it owes nothing of what the one before has got. */
void lar_coupling_greet(lar_coupling *coupling);

/* The tool has been put somewhere: it rests at `pose`, and goes to its hand from there. */
void lar_coupling_reset(lar_coupling *coupling, const lar_tool_pose *pose);

/* The hand is at `hand` now: where the tool must be at the end of this tick. Call it in every tick,
 * also when the hand has not moved. `evenly`: where the spring is led to; NULL: there too. News of
 * a hand may come early and late, and the spring should not feel that, but the account goes by the
 * news. A hand that holds nothing is put where it is wanted at once; when it closes in the same
 * tick in which it is put somewhere, it closes in the next. */
void lar_coupling_follow(lar_coupling *coupling, const lar_tool_pose *hand,
                         const lar_tool_pose *evenly, lar_tool_pose *tool);

/* The tick is done and the tissue pushed the tool with `force`: what the hand feels. Counts are
 * copied. `passed`: time of the clock since the last call [s], which is not the tick's at another
 * pace, or when ticks are late. Nothing that the tool does depends on it. */
void lar_coupling_feel(lar_coupling *coupling, const lar_tool_force *force, double passed,
                       lar_tool_force *felt);

/* From what is felt towards what is wanted, by no more than `max`. */
void lar_coupling_approach(double felt[3], const double wanted[3], double max);

#endif
