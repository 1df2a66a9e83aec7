/* What tools do to four nodes beside each other: forces in whole units, their torques, friction.
 *
 * Coulomb's law: the press F, mu times what pushes at the node, is along the normal; the node would
 * get the velocity v' by all other forces, what it rubs on has V:
 *
 *     f = -p (v' - V)_t / unit,    p = 1: it sticks, less: as much as |F| can stop
 *
 * and p is less still where friction would turn round what does not slide yet (lar_friction_part,
 * contact.h). Torques, of which a tool feels sums, are a whole number and a rest. Each lane has the
 * bits of the same operations one by one, on any processor.
 */
#ifndef LAR_MECHANICS_TOOL_LANES_H
#define LAR_MECHANICS_TOOL_LANES_H

#include "mechanics/hex8_block.h"

enum { LAR_TOOL_LANES = 4 };

/* A number of each node, and three of each, axis by axis. */
typedef double lar_four[LAR_TOOL_LANES];
typedef lar_four lar_three_fours[3];

/* Forces on nodes, and the torques of their opposites about a point, as a tool there feels them.
 * All whole, and 0 beyond 2^56. */
typedef struct lar_tool_pushes {
    lar_three_fours force;  /* [force units] */
    lar_three_fours torque; /* rounded down [force units m] */
    lar_three_fours rest;   /* what it is more, in LAR_TORQUE_REST, from 0 to 2^20 */
} lar_tool_pushes;
static const double LAR_TORQUE_REST = 0x1p-20;

/* Of forces [N] on nodes at x, about `tip` [m]; `scale`: force units per newton. Returns false
 * where one is none, or beyond 2^56. */
bool lar_tool_push_lanes(double scale, const double force[3][4], const double x[4][3],
                         const double tip[3], lar_tool_pushes *pushes);

typedef struct lar_tool_rubs {
    lar_three_fours press;    /* F [force units], not all 0 */
    lar_three_fours force;    /* minus what else acts, as in force sums [force units] */
    lar_four unit;            /* what a force unit makes of its velocity in this step [m/s] */
    lar_three_fours v;        /* now [m/s] */
    lar_three_fours velocity; /* V [m/s] */
    lar_three_fours arm;      /* to the node from where torques are about [m] */
    lar_tool_pushes friction; /* out */
} lar_tool_rubs;

/* Of `count` times four nodes. `leapfrog`: of the update that follows. */
void lar_tool_rub_lanes(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count);

/* The same two by two, and four by four in builds for processors that may have so many lanes. */
void lar_tool_rub_pairs(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count);
void lar_tool_rub_fours(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count);
bool lar_tool_push_pairs(double scale, const double force[3][4], const double x[4][3],
                         const double tip[3], lar_tool_pushes *pushes);
bool lar_tool_push_fours(double scale, const double force[3][4], const double x[4][3],
                         const double tip[3], lar_tool_pushes *pushes);

#endif
