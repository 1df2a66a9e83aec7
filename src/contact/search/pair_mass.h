/* The mass that a spring between a node and a point of a face moves. */
#ifndef LAR_CONTACT_SEARCH_PAIR_MASS_H
#define LAR_CONTACT_SEARCH_PAIR_MASS_H

#include <math.h>

#include "contact/contact_surface.h"
#include "mechanics/contact.h"
#include "mechanics/face_contact.h"

/* Whether supports of the scene hold a node along all axes, before and now: `held` where some were
 * set or released, else NULL. */
static inline bool lar_contact_still(const lar_contact_node *node, const uint8_t *held) {
    return node->held == LAR_AXIS_ALL &&
           (!held || (held[node->node] & LAR_AXIS_ALL) == LAR_AXIS_ALL);
}

/* Neither a node of a free body nor one that stands still has elements that take of a step; whether
 * both are of that kind. */
static inline bool lar_contact_of_rigid(const lar_contact_surface *surface,
                                        const lar_contact_node *node, const lar_contact_face *face,
                                        const uint8_t *held) {
    bool rigid = node->bound > 0 || lar_contact_still(node, held);
    for (int a = 0; a < 4 && rigid; a++) {
        const lar_contact_node *corner = &surface->node[face->corner[a]];
        rigid = corner->bound > 0 || lar_contact_still(corner, held);
    }
    return rigid;
}

/* A point of a surface, of its corners. */
typedef struct lar_point_mass {
    double light; /* one over its mass [1/kg] */
    double thin;  /* one over the mass of the surface around it [m^2/kg] */
} lar_point_mass;

/* Of the four corners of a face that a node meets [kg], [m^2/kg]. What stands still is as heavy as
 * can be for free bodies, which are not made of springs themselves. */
typedef struct lar_corner_masses {
    double mass[4], thin[4];
} lar_corner_masses;

void lar_corner_masses_of(const lar_contact_surface *surface, int32_t node, int32_t face,
                          const uint8_t *held, lar_corner_masses *of);

/* Adds a point of a face, by the weights of the corners, which may be a part of 1. */
static inline void lar_point_mass_add(const lar_corner_masses *of, const double weight[4],
                                      lar_point_mass *point) {
    for (int a = 0; a < 4; a++) {
        point->light += weight[a] / of->mass[a];
        point->thin += weight[a] * of->thin[a];
    }
}

/* The same between what is rigid: from corner to corner it has no kinks, so that its slope can be a
 * force. */
void lar_point_mass_ease(const lar_corner_masses *of, const double weight[4],
                         lar_point_mass *point);

/* Many nodes may press on one corner, and heavy ones have springs that are as hard as the point
 * bears each: together they have no more than their part of the surface leaves them. `corner`: one
 * of the point's. */
static inline double lar_contact_moved_mass(const lar_contact_node *node,
                                            const lar_contact_node *corner, const uint8_t *held,
                                            const lar_point_mass *point) {
    if (!(point->light > 0)) return node->mass;
    const double mass = 1 / point->light, cover = 1 / point->thin;
    const bool still = corner->bound > 0 && lar_contact_still(node, held);
    return fmin(still ? mass : lar_contact_pair_mass(node->mass, mass), node->area * cover);
}

/* What pushes a node where a face is. */
typedef struct lar_pair_press {
    const double *x;           /* of the node [m] */
    const double (*corner)[3]; /* of the face [m] */
    const lar_face_point *closest;
    double energy, force; /* what springs store, and push with [J], [N] */
} lar_pair_press;

/* The mass that springs go by changes along the face, and with it what they store: its slope is a
 * force as well. Adds it to slope[] [N], forces on the corners; the node gets minus their sum.
 * False: there is none. */
bool lar_pair_slope(const lar_contact_node *node, const lar_corner_masses *of,
                    const lar_point_mass *point, double moved, const lar_pair_press *press,
                    double slope[4][3]);

/* Friction has no more than nodes have by themselves. */
static inline double lar_contact_rub_mass(const lar_contact_node *node,
                                          const lar_contact_node *corner, double moved) {
    return moved / fmax(1, fmax((double)node->bound, (double)corner->bound));
}

#endif
