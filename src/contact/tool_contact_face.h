/* One face of the surface before one tool: which of its points the tool touches, and how hard it
 * pushes them.
 *
 *     +---------+      a grid of n x n points, each pushed out along the tool's normal
 *     | . . . . |      and, of a small tool, the closest point of the face (the wall)
 *     | . . o . |
 *     | . . . . |      most points of most faces are far from most segments: what a point costs
 *     +---------+      then is a squared distance, four of them at once (mechanics/face_parts.h)
 *
 * See docs/theory.md, contact with tools.
 */
#ifndef LAR_CONTACT_TOOL_CONTACT_FACE_H
#define LAR_CONTACT_TOOL_CONTACT_FACE_H

#include "contact/tool_contact.h"
#include "contact/touch_list.h"

typedef struct lar_tool_contact_patch { /* one face before one tool */
    const lar_tool_contact_face *face;
    const lar_tool_body *body;
    double radius, mass, rate_of; /* of a point; 1 / time step */
    double x[4][3], v[4][3], out[3];
    double force[3][4]; /* by axis and corner */
    double min[2];      /* of each segment, squared, from the closest point of the grid [m^2] */
    double closest;     /* distance of the closest point [m] */
    double covered;     /* how many of the points are as deep in the tool as the wall */
    double depth;       /* the deepest point [m] */
    double hard;        /* of a free body's face: how many times as stiff it is; else 1 */
    double deep;        /* as `depth`, whether or not the point is let go [m] */
    double ahead;       /* the deepest, a lead on, as springs push [m] */
    double moves;       /* how springs of unit stiffness per mass would move the body that they
                           push: the sum of their masses times face->yields */
    double squeeze;     /* of the jaws, as a force at their ends [N] */
    double jaw[2];      /* on each jaw, outwards [N] */
    int32_t touching;
    int32_t outside;         /* 1: the tool's middle has passed nothing (lar_tool_motion) */
    int32_t behind;          /* 1: what may have been passed is in the tool */
    lar_touch_list *touches; /* of who looks; NULL in steps */
} lar_tool_contact_patch;

/* The mass behind each of n x n points [kg]: with weights w_a of all points their sum over a node's
 * faces is at most the node's mass (mechanics/contact.h, row sums). `mass`: by local node. */
double lar_tool_contact_point_mass(const lar_tool_contact_face *face, const double *mass, int n);

/* The stiffness of a hold of a point of the face that the step bears [N/m]. */
double lar_grasp_stiffness_limit(const lar_tool_contact_face *face, double radius,
                                 const lar_contact_law *law, const double *mass);

/* How hard a tool is for a free body. Springs fitted to the nodes' masses are soft beside all that
 * is behind them (step/rigid/firm.h). What the body bears of a tool, springs of `bears` times its
 * own inertia, is shared out among the faces f that it touches by how deep they are,
 *
 *     moves_f hard_f = moves_f d_f^2 / asked,      asked = sum over f of moves_f d_f^2 / bears,
 *
 * so that no force jumps where the tool comes to another face. Of a patch whose `hard` is 1. */
double lar_tool_contact_asked(const lar_tool_contact_patch *patch);
double lar_tool_contact_hardness(const lar_tool_contact_patch *patch, double asked);

/* Fills in the forces on the corners of a face [N] whose places `x` and velocities `v` are known,
 * and what the tool has of them. `weights`: of the points (lar_tool_contact.weights). */
void lar_tool_contact_push_face(lar_tool_contact_patch *patch, const lar_contact_law *law,
                                const double *mass, const lar_point_weights *weights);

#endif
