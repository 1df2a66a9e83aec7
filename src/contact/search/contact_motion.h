/* How far contact nodes have moved since the search that a list is of (contact_search.h), and how
 * long the list is good.
 *
 * That is looked at now and then. Between two looks it is enough to know how fast the fastest node
 * is: nobody goes farther. So what nodes have moved is counted as on a list on which all may move
 * by half the skin: by half of it less what the one that is nearest to its end has left.
 */
#ifndef LAR_CONTACT_SEARCH_CONTACT_MOTION_H
#define LAR_CONTACT_SEARCH_CONTACT_MOTION_H

#include <math.h>

#include "contact/contact_surface.h"
#include "layout/state.h"

/* The larger one, or no number where one of them is none. */
static inline double lar_larger(double max, double other) {
    return other <= max || isnan(max) ? max : other;
}

typedef struct lar_contact_motion {
    double farthest; /* along any axis [m] */
    double spent;    /* by how much more than it may, the one nearest to its end: below 0 [m] */
    double used;     /* the largest part of what one may move, `reserved` aside */
    double pace;     /* likewise of what it moves in a step */
    double way;      /* of the fastest in a step [m] */
} lar_contact_motion;

static inline lar_contact_motion lar_contact_no_motion(void) {
    return (lar_contact_motion){.spent = -INFINITY};
}

/* Where a contact node is, which has the number `local` in the state; returns how fast it is along
 * an axis, at most [m/s]. */
static inline double lar_contact_node_place(const lar_contact_surface *surface, int32_t n,
                                            const lar_state *state, int32_t local, double x[3]) {
    double u[3], v[3], speed = 0;
    lar_state_displacement(state, local, u);
    lar_state_velocity(state, local, v);
    for (int i = 0; i < 3; i++) {
        x[i] = surface->rest[n][i] + u[i];
        speed = lar_larger(speed, fabs(v[i]));
    }
    return speed;
}

/* One more node, from its place at the search to where it is; it goes `way` in a step, and may move
 * by `allow` [m]. */
static inline void lar_contact_motion_add(lar_contact_motion *motion, const double from[3],
                                          const double x[3], double way, double allow,
                                          double reserved) {
    const double own = allow - reserved;
    double moved = 0;
    for (int i = 0; i < 3; i++) moved = lar_larger(moved, fabs(x[i] - from[i]));
    motion->farthest = lar_larger(motion->farthest, moved);
    motion->spent = lar_larger(motion->spent, moved - allow);
    motion->used = lar_larger(motion->used, own > 0 ? moved / own : INFINITY);
    motion->pace = lar_larger(motion->pace, own > 0 ? way / own : INFINITY);
    motion->way = lar_larger(motion->way, way);
}

/* How far all would have moved on a list on which they may move alike [m]. */
static inline double lar_contact_motion_alike(const lar_contact_motion *motion, double skin) {
    return 0.5 * skin + motion->spent;
}

/* Steps until a node has moved by all that it may, if it becomes faster by a quarter. */
static inline double lar_contact_motion_steps(const lar_contact_motion *motion) {
    return motion->pace > 0 ? (1 - motion->used) / (1.25 * motion->pace) : 1e9;
}

#endif
