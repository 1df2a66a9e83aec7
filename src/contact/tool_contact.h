/* Tools and fixed planes against the surface: what one thread has of them.
 *
 * The faces are compiled and constant (lar_tool_faces); what is known of the tools' surroundings,
 * what they have felt and what acts in a step stands beside the state (lar_tool_contact). Whoever
 * wants to know the forces without going on has one of these of its own (step/measure.h).
 *
 *     every step                      apply: tool -> near faces -> points of them -> corners
 *     when something could be near    search: tool -> groups of faces -> faces
 *
 * A face is touched at a grid of points, fine enough for the tool; a point inside a tool is pushed
 * along the tool's outward normal (mechanics/contact.h), and the corners take the force by the
 * point's weights. Like a pressure, all of it is local: a face's corners are on the processor that
 * has its element, so whoever recovers the element finds the face's contact with tools and applies
 * it to the four corners; a plane acts on single nodes (contact/plane_contact.h). Nothing needs to
 * be exchanged, and force sums make it the same bits on any grid.
 *
 * Prediction (T 3.8.2). Every tool has a path: how far it and the tissue can have gone towards each
 * other since the last search, added up step by step from the greatest velocity of the nodes that
 * this thread knows. What was farther away than the path has grown since is not looked at. That is
 * a bound and no estimate: the forces are the same with and without it.
 */
#ifndef LAR_CONTACT_TOOL_CONTACT_H
#define LAR_CONTACT_TOOL_CONTACT_H

#include <math.h>

#include "contact/plane_contact.h"
#include "contact/spares.h"
#include "contact/touch_list.h"
#include "mechanics/face_contact.h"
#include "mechanics/tool_lanes.h"

/* An advance may have any number of steps, and a force of one of them nearly 2^63 units. */
__extension__ typedef __int128 lar_wide;

/* Sum of what a tool felt, in force units (and those times metres), of all shares of all steps of
 * an advance. */
typedef struct lar_tool_sum {
    lar_wide force[3], torque[3]; /* of the tissue on the tool; about the tip */
    int64_t rest[3];              /* of the torques, in LAR_TORQUE_REST: arms are short */
    lar_wide squeeze;             /* of the jaws, outwards, as a force at their ends */
    lar_wide jaw[2];              /* of the tissue on each jaw, outwards */
    double depth;                 /* the deepest point since the last stretch of steps began [m] */
    int32_t touching, held;       /* in the last step */
    int32_t clings;               /* since the last stretch of steps began a held point has been no
                                     farther from where it is held than jaws reach: 1 */
    int32_t behind;               /* likewise, a point in it has looked away from it: 1 */
} lar_tool_sum;

/* A face of the surface. */
typedef struct lar_tool_contact_face {
    int32_t node[4];   /* local */
    int32_t of;        /* index into the model's surface */
    double share[4];   /* of a corner's mass: one over the number of faces that it is a corner of */
    double rest[4][3]; /* positions at rest [m] */
    double edge;       /* the longest at rest [m] */
    double lets_go;    /* what leaves a tool faster is pushed with less [m/s] */
    double wall;       /* where the wall begins, in radii of the tool (tool_contact_face.h) */
    int32_t body;      /* the tool that moves a free body whose face it is, or -1; then also */
    double yields[4];  /* how a push at a corner, along the normal, moves the body there [1/kg] */
} lar_tool_contact_face;

/* Weights of the corners in the points of a face, n x n of them (lar_tool_contact_points). */
enum { LAR_POINTS_ALONG_EDGE = 6 };
typedef struct lar_point_weights {
    lar_face_grid of[LAR_POINTS_ALONG_EDGE + 1];
} lar_point_weights;

/* Neighbouring faces. */
typedef struct lar_tool_contact_group {
    int32_t first, count;
} lar_tool_contact_group;

/* A node of the surface that may rub on tools (tool_friction.h). */
typedef struct lar_tool_rub_node {
    double rest[3]; /* [m] */
    int32_t node;   /* of the model */
    int32_t grip;   /* of a free body: its place in the history (history/tool_grip.h); else -1 */
    int32_t body;   /* then: the tool that moves it */
    uint8_t held;   /* LAR_AXIS bits of the axes that its supports hold */
} lar_tool_rub_node;

/* The faces before tools. */
typedef struct lar_tool_faces {
    int32_t face_count, group_count, foreign_count;
    lar_tool_contact_face *face;   /* [face_count] group after group */
    lar_tool_contact_group *group; /* [group_count] */
    int32_t *face_of;              /* [faces of the model's surface] index into `face`, or -1 */
    int32_t *foreign;              /* [foreign_count] local nodes: corners that others move */
    lar_point_weights *weights;    /* NULL: no faces */
    int32_t rub_count, local_count;
    bool grips;                  /* whether one of them is a free body's */
    bool weighs;                 /* all that is of free bodies is among them, and something is */
    double heavy[LAR_TOOLS_MAX]; /* then: the masses of the bodies, by the tools that move them */
    lar_tool_rub_node *rub; /* [rub_count] moved by the thread; NULL: no tool has friction. Of all
                               nodes of the processor there are `local_count` */
    int32_t *rub_at;        /* [local_count] index into `rub`; -1: none */
} lar_tool_faces;

/* The ball around a group. */
typedef struct lar_tool_contact_ball {
    double center[3], radius; /* [m] */
    double travel;            /* contact->travel when that was so */
} lar_tool_contact_ball;

/* What acts on the corners of a face in the step under way [force units]. */
typedef struct lar_tool_contact_force {
    int32_t face;
    int64_t force[4][3];
} lar_tool_contact_force;

/* Friction of a node in the step under way [force units]. */
typedef struct lar_tool_rubbed {
    int32_t node; /* local */
    int32_t grip; /* of what remembers, -1: nothing; and what then */
    int64_t force[3];
    double stick[LAR_STICK_VALUES];
} lar_tool_rubbed;

/* The segments of a tool, where they are and where they will be a step later. */
typedef struct lar_tool_body {
    int32_t count;
    lar_segment now[2], next[2];
    double outward[2][3]; /* of jaws: unit, where their ends go when they open */
} lar_tool_body;

/* What this thread knows of the surroundings of one tool. */
typedef struct lar_tool_vicinity {
    lar_tool_body body;
    int32_t serial;    /* of the tool, where it can be another one (contact/spares.h) */
    bool rests, known; /* `body` is for good; `near` belongs to the state */
    double path;       /* since the search [m] */
    double limit;      /* of the path, up to which `near` is complete */
    int32_t near_count;
    int32_t *near; /* [near_count] faces */
    double *look;  /* [near_count] the path from which on each must be looked at again */
} lar_tool_vicinity;

typedef struct lar_tool_contact {
    const lar_tool_list *list; /* NULL: no tools */
    const lar_tools *tools;
    const lar_tool_faces *faces;
    lar_tool_sum sum[LAR_TOOLS_MAX];
    lar_contact_info seen; /* counters since the start; `touching`, `deepest` of the last step */
    bool always;           /* search in every step */
    lar_plane_contact plane_contact;
    int32_t loaded_count;
    lar_tool_contact_force *loaded; /* [loaded_count] of [faces->face_count] */
    int32_t *loaded_at;             /* [faces->face_count] index into `loaded`; -1: nothing acts on
                                       the face in this step */
    lar_tool_contact_ball *ball;    /* [faces->group_count] */
    int64_t *press;                 /* [3][faces->local_count] sums of mu times what tools push, in
                                       force units, empty between steps; NULL: without friction */
    uint64_t *pressed; /* [(faces->local_count + 63) / 64] a bit for each node that may have any */
    int32_t rubbed_count;
    lar_tool_rubbed *rubbed; /* [rubbed_count] of [faces->rub_count] */
    lar_tool_vicinity vicinity[LAR_TOOLS_MAX];
    lar_bearings bearings;   /* where `faces->weighs`, in the step under way */
    lar_touch_list *touches; /* who looks wants to know where a tool touches; NULL in steps */
    double travel;           /* how far any corner can have gone, begun anew now and then [m] */
    uint64_t moved;          /* the step that the thread's nodes were last moved to */
} lar_tool_contact;

/* In the step under way. */
static inline const lar_bearings *lar_tool_bearings(const lar_tool_contact *contact) {
    return contact->faces->weighs ? &contact->bearings : &contact->tools->bearings;
}

/* How many times as stiff a tool is on free bodies: no more than parts of a step bear. */
static inline double lar_hardness_on_free(const lar_tools *tools, int32_t tool,
                                          const lar_condition_context *context) {
    const double parts = context->whole_step / context->time_step;
    return fmin(tools->hardness[tool], parts * parts);
}

/* Of the whole model, or with a share (NULL: all) of one thread. */
lar_status lar_tool_faces_create(const lar_model *model, const int32_t *local,
                                 const lar_condition_share *share, lar_tool_faces *faces,
                                 lar_error *error);
void lar_tool_faces_destroy(lar_tool_faces *faces); /* idempotent */

/* What has been found out of free bodies' faces, of all, told to those of a thread. */
void lar_tool_faces_yield_as(const lar_tool_faces *whole, lar_tool_faces *faces);

/* What it is given outlives it; `list` and `tools` may be NULL. Knows nothing yet. */
lar_status lar_tool_contact_create(const lar_tool_faces *faces, const lar_planes *planes,
                                   const lar_tool_list *list, const lar_tools *tools, bool always,
                                   lar_tool_contact *contact, lar_error *error);
void lar_tool_contact_destroy(lar_tool_contact *contact); /* idempotent */

/* The state has been replaced by another one, or the tools have been put elsewhere: everything is
 * searched anew. */
void lar_tool_contact_forget(lar_tool_contact *contact);

/* Before a stretch of steps: the deepest points are asked for stretch by stretch. */
static inline void lar_tool_contact_forget_depths(lar_tool_contact *contact) {
    for (int i = 0; contact->list && i < contact->list->count; i++) {
        lar_tool_sum *sum = &contact->sum[i];
        sum->depth = sum->clings = sum->behind = 0;
    }
}

/* Adds the forces at the state's step to state->force. Asks for no memory. */
void lar_tool_contact_apply(lar_tool_contact *contact, const lar_condition_context *context,
                            lar_state *state);

/* Half the work of these forces in this step, to state->external: once before and once after the
 * nodes move. */
void lar_tool_contact_half_work(const lar_tool_contact *contact,
                                const lar_condition_context *context, lar_state *state);

/* When all forces stand in state->force: tools that move nodes feel what pulls at these, without
 * their weight and inertia. */
void lar_tool_contact_carry(lar_tool_contact *contact, const lar_condition_context *context,
                            const lar_condition_notes *notes, const lar_state *state);

/* Planes: before the nodes move, and after they have, supports included. */
void lar_tool_contact_observe(lar_tool_contact *contact, const lar_condition_context *context,
                              const lar_state *state);
void lar_tool_contact_stop(lar_tool_contact *contact, const lar_condition_context *context,
                           lar_state *state);

/* ---- for other sources of tools, grasp.c and fault/tool.c ------------------------------------ */

/* Puts neighbouring faces next to each other, into groups. */
lar_status lar_tool_faces_group(lar_tool_faces *faces, lar_error *error);
/* Points along an edge of a face: no farther apart than half the tool's radius, so that a sphere
 * that touches has several inside. The weights of point 0 .. n n - 1. */
int lar_tool_contact_points(const lar_tool_contact_face *face, double radius);
void lar_tool_contact_weights(int point, int n, double weight[4]);
void lar_tool_contact_grid(int n, lar_face_grid *grid);
/* Corners of a face now [m], and the ball around them. */
void lar_tool_contact_corners(const lar_tool_contact_face *face, const lar_state *state,
                              double x[4][3]);
double lar_tool_contact_ball_of(const double x[4][3], double center[3]);
/* Sums of at most 64 forces on nodes, each below 2^56 units, and what they turn about the tip, as a
 * tool feels both. */
typedef struct lar_tool_push {
    int64_t force[3], torque[3], rest[3];
} lar_tool_push;
/* To what the tool feels. */
static inline void lar_tool_sum_add(lar_tool_sum *sum, int32_t shares, const lar_tool_push *push) {
    for (int i = 0; i < 3; i++) {
        sum->force[i] += (lar_wide)shares * push->force[i];
        sum->torque[i] += (lar_wide)shares * push->torque[i];
        sum->rest[i] += shares * push->rest[i];
    }
}
/* Where a tool's segments are in a pose. */
void lar_tool_place(const lar_tool *tool, const lar_tool_pose *pose, lar_tool_body *body,
                    lar_segment segment[2]);
/* How far a tool goes between two places of its segments [m]: no point of a segment goes farther
 * than one of its ends. */
double lar_tool_way(const lar_segment *from, const lar_segment *to, int32_t count);
/* Distance of a point from a tool's segments, less its radius. */
double lar_tool_contact_distance(const lar_tool_body *body, double radius, const double point[3]);
/* How far the path may grow before a gap can have closed: less than the gap by more than what
 * rounding could add to the one and take from the other. */
static inline double lar_tool_contact_clear(double gap, double radius) {
    double clear = gap - 1e-9 * radius;
    return clear > 0 ? clear : 0;
}

/* The faces near a tool, for some dozens of steps in which the path grows by `step_path` each. */
void lar_tool_contact_search(lar_tool_contact *contact, int32_t tool, const lar_state *state,
                             double step_path);

#endif
