/* A hand, its coupling and a wall of tissue, tick by tick. */
#ifndef LAR_COUPLING_TEST_H
#define LAR_COUPLING_TEST_H

#include "testing.h"

#include "session/coupling.h"

/* ---- tissue: a wall at z = 0, elastic, felt as the mean over a tick's even way --------------- */

typedef struct wall {
    double stiffness; /* [N/m] */
    double weight;    /* that hangs on the tool [N] */
    bool held;        /* pulls as well as pushes */
} wall;

/* The mean of -k min(z, 0) from a to b: the integral is exact, so its work is the energy's change.
 */
static inline double wall_force(const wall *w, double a, double b) {
    double low = w->held ? a : fmin(a, 0), high = w->held ? b : fmin(b, 0);
    if (a == b) return -w->stiffness * low;
    return -0.5 * w->stiffness * (high * high - low * low) / (b - a);
}

typedef struct world {
    lar_coupling coupling;
    double seconds; /* of a tick */
    wall wall;
    lar_tool_pose hand, tool;
    lar_tool_force felt;
    double hand_work; /* put in [J] */
    double fastest;   /* of the tool [m/s] */
} world;

static inline void tick(world *w, double x, double z) {
    double before[3] = {w->hand.position[0], 0, w->hand.position[2]}, from = w->tool.position[2];
    double from_x = w->tool.position[0];
    w->hand.position[0] = x;
    w->hand.position[2] = z;
    w->hand_work -= w->felt.force[0] * (x - before[0]) + w->felt.force[2] * (z - before[2]);
    lar_coupling_follow(&w->coupling, &w->hand, NULL, &w->tool);
    double to = w->tool.position[2];
    double speed = hypot(to - from, w->tool.position[0] - from_x) / w->seconds;
    w->fastest = fmax(w->fastest, speed);
    lar_tool_force tissue = {.force = {0, 0, wall_force(&w->wall, from, to) - w->wall.weight},
                             .held = w->wall.held};
    lar_coupling_feel(&w->coupling, &tissue, w->seconds, &w->felt);
}

/* At rest at height z, with ticks of so many seconds. */
static inline world start_at(const lar_tool_info *tool, double stiffness, double z,
                             double seconds) {
    const lar_coupling_limits limits = {1, 5, seconds, 0.0001};
    world w = {.seconds = seconds, .wall = {.stiffness = stiffness}};
    lar_coupling_create(&w.coupling, tool, &limits);
    w.hand = w.tool = tool->rest;
    w.hand.position[2] = w.tool.position[2] = z;
    lar_coupling_reset(&w.coupling, &w.tool);
    tick(&w, 0, z);
    return w;
}

/* ---- chance ---------------------------------------------------------------------------------- */

static uint64_t seed;
static inline double any(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-53;
}

#endif
