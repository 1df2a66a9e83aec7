/* The mass that a spring between a node and a point of a face moves. */
#ifndef LAR_CONTACT_SEARCH_PAIR_MASS_H
#define LAR_CONTACT_SEARCH_PAIR_MASS_H

#include <math.h>

#include "contact/contact_surface.h"
#include "mechanics/contact.h"

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

/* The corner has `weight` of it, and meets a node. What stands still is as heavy as can be for free
 * bodies, which are not made of springs themselves. */
static inline void lar_point_mass_add(const lar_contact_node *corner, double weight,
                                      const lar_contact_node *node, const uint8_t *held,
                                      lar_point_mass *point) {
    if (node->bound > 0 && lar_contact_still(corner, held)) return;
    point->light += weight / corner->mass;
    point->thin += weight * (corner->area / corner->mass);
}

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

/* Friction has no more than nodes have by themselves. */
static inline double lar_contact_rub_mass(const lar_contact_node *node,
                                          const lar_contact_node *corner, double moved) {
    return moved / fmax(1, fmax((double)node->bound, (double)corner->bound));
}

#endif
