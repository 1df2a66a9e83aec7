/* What may touch what, compiled from the model: the part of contact that never changes.
 *
 *     contact "self"       faces A                 one pass:   nodes of A against faces of A
 *     contact "between"    faces A, faces B        two passes: nodes of A against faces of B,
 *                                                              nodes of B against faces of A
 *
 * A node and a face belong together when some pass has both: bits say which. Faces around the edge
 * of a set are taken along mute: they say where inside and outside are beside the set's last face,
 * and push nobody.
 *
 * Never together are neighbours: a node and a face whose elements have a node in common, for these
 * the elements themselves answer. Nor are a node and a face of one and the same body when the
 * mesh has the node in the layer below the face already at rest, where a body tapers.
 *
 * Bodies are the connected parts of the mesh. A node touches one face of every body at most. How
 * deep the layer is in which a body repels a node is the same for all its faces: nowhere does a
 * node come into it but through a face, or leave it from less deep than it came (docs/theory.md,
 * contact).
 */
#ifndef LAR_CONTACT_CONTACT_SURFACE_H
#define LAR_CONTACT_CONTACT_SURFACE_H

#include <stdbool.h>

#include "model/model.h"

enum { LAR_CONTACT_PASSES_MAX = 64 };

typedef struct lar_contact_face {
    int32_t corner[4]; /* contact nodes, counter-clockwise seen from outside */
    int32_t element;   /* behind it */
    int32_t body;
    uint64_t active, mute; /* passes */
    double size;           /* its longer diagonal at rest [m] */
    bool fades;            /* a corner is on a sharp edge */
    unsigned plane;        /* axes: its corners are in one plane across it, and held there */
} lar_contact_face;

typedef struct lar_contact_body {
    double reach[2]; /* thickness of the virtual body below its faces (T 2.2.8) for its own nodes,
                        half that of its thinnest element, and for others, all of it [m] */
    double clear;    /* to the nearest other body at rest; INFINITY: none is within a layer [m] */
    double standoff; /* the contact distance: how far apart it and others push each other already,
                        at most [m] */
    double firm;     /* springs beside it are at least so stiff, where the step bears it [1/s^2] */
    bool cut;        /* by planes of symmetry: it ends there, */
    double from[3], to[3]; /* and all of it is between these; INFINITY: there is none [m] */
} lar_contact_body;

/* Nodes of the faces below: "contact nodes". */
typedef struct lar_contact_node {
    int32_t node; /* of the model; of a point of an edge that of its first */
    int32_t body;
    uint64_t passes; /* in which it is looked at against faces */
    double mass;     /* that a spring of the law counts it with, see lar_contact_surface_fit [kg] */
    double area;     /* of the surface around it at rest that looks one way [m^2] */
    unsigned held;   /* axes that supports of the scene hold it along */
    float bound;     /* of a free body: the part of its mass that it has by that, at least 1, which
                        is in `mass` (step/rigid/firm.h); else 0 */
    double blunt;    /* 1, or less where it is on a sharp edge, down to 0: contact_edges.c */
    int32_t along;   /* which of these is along an edge that goes on beyond the node; 3: none */
    int32_t inward[3]; /* on a sharp edge: contact nodes beside it that lie in the body, as seen
                          from it, or from a point's first node, and that one; -1: no more */
} lar_contact_node;

/* A point of a sharp edge, or of a face among such edges, which meets faces of other bodies as
 * nodes do. */
enum { LAR_CONTACT_PARENTS = 4 };
typedef struct lar_contact_point {
    int32_t count;                      /* 2 or 4 */
    int32_t node[LAR_CONTACT_PARENTS];  /* contact nodes */
    double weight[LAR_CONTACT_PARENTS]; /* their shares, sum 1 */
} lar_contact_point;

typedef struct lar_contact_surface {
    int32_t node_count, face_count, body_count;
    int32_t point_count;      /* nodes, and behind them points of edges and faces */
    int32_t slave_count;      /* those with passes */
    lar_contact_node *node;   /* [point_count] nodes ascending */
    lar_contact_point *point; /* [point_count - node_count] */
    lar_contact_face *face;   /* by the surface's order */
    lar_contact_body *body;   /* [body_count] */
    double (*rest)[3];        /* [point_count] reference positions */
    int64_t *apart_first;     /* [node_count + 1] faces that are never together with a node: */
    int32_t *apart;           /* ascending for each node */
    int32_t *flush_first;     /* [point_count + 1] faces that a node or point is flush with at */
    int32_t *flush;           /* rest, by bodies: history/flush.h */
    double reach;             /* the least of all bodies [m] */
    double reach_max;         /* the largest [m] */
    double rounding;          /* so deep bodies may lie in each other at rest [m] */
    double speed;             /* of bodies that springs before faces are for [m/s]; 0: of none */
    uint64_t possible;        /* pairs of a node and a face that belong together, neighbours too */
    double friction[LAR_CONTACT_PASSES_MAX]; /* Coulomb's coefficient of each pass */
    bool rough;                              /* one of them is not 0 */
} lar_contact_surface;

enum { LAR_PAIRS_PER_NODE = 64, LAR_GROUP_FACES_MAX = 128 };

/* What a search finds (contact_search.h): a node and faces of one body: entries first .. first +
 * count - 1 of lar_contact_list.face. */
typedef struct lar_contact_group {
    int32_t node; /* contact node */
    int32_t first, count;
    float gap; /* by which the node is outside the boxes of all faces, grown by their reach only,
                  along some axis; at most 0 when it is inside one [m] */
} lar_contact_group;

typedef struct lar_contact_list {
    int32_t group_count, face_count;
    lar_contact_group *group; /* [group_count] by node, then by body */
    int32_t *face;            /* [face_count] contact faces */
    float *gap;               /* [face_count] the same for each of them [m] */
    int32_t group_room, face_room;
    double skin;   /* twice the most that any node may move [m] */
    double *allow; /* [contact nodes] what each may, along any axis [m]; NULL: nobody looks */
} lar_contact_list;

/* Whether a group's faces are of its node's own body. */
static inline bool lar_group_is_own(const lar_contact_surface *surface,
                                    const lar_contact_list *list, const lar_contact_group *group) {
    return surface->face[list->face[group->first]].body == surface->node[group->node].body;
}

/* The first group of its node. */
static inline int32_t lar_group_first(const lar_contact_list *list, int32_t g) {
    while (g > 0 && list->group[g - 1].node == list->group[g].node) g--;
    return g;
}

/* Without contacts of these kinds node_count is 0 and nothing is allocated. mass[local[node]] is
 * the mass of a node of the model. Cleared with lar_contact_surface_clear. */
lar_status lar_contact_surface_create(const lar_model *model, const double *mass,
                                      const int32_t *local, lar_contact_surface *surface,
                                      lar_error *error);
void lar_contact_surface_clear(lar_contact_surface *surface); /* idempotent */

/* Adds pairs of a node and a face, ascending by node and not known yet, to those that are never
 * together. */
lar_status lar_contact_surface_keep_apart(lar_contact_surface *surface, const int32_t (*pair)[2],
                                          int32_t count, lar_error *error);

/* Whether the face pushes the node; a mute face only says where inside is. */
static inline bool lar_contact_active(const lar_contact_node *node, const lar_contact_face *face) {
    return (node->passes & face->active) != 0;
}

/* How far below the face the node is repelled [m]. */
static inline double lar_contact_reach(const lar_contact_surface *surface,
                                       const lar_contact_node *node, const lar_contact_face *face) {
    return surface->body[face->body].reach[node->body != face->body];
}

/* How far above a face the node is pushed already: 0 within a body, and for all nodes and faces of
 * two bodies the same. */
static inline double lar_contact_standoff(const lar_contact_surface *surface,
                                          const lar_contact_node *node,
                                          const lar_contact_face *face) {
    double one = surface->body[node->body].standoff, other = surface->body[face->body].standoff;
    return node->body == face->body ? 0 : one < other ? one : other;
}

/* What part of its stiffness [1/s^2] a spring has before the face: what it stores while it keeps
 * the contact distance [m] must not throw a light node. But tissue that is as stiff as springs
 * would give way to them then. */
double lar_contact_softness(const lar_contact_surface *surface, int32_t node, int32_t face,
                            double standoff, double stiffness);

/* Coulomb's coefficient of a node and a face: the largest of the passes that have both. */
static inline double lar_contact_friction(const lar_contact_surface *surface,
                                          const lar_contact_node *node,
                                          const lar_contact_face *face) {
    double max = 0;
    for (uint64_t both = node->passes & face->active; both; both &= both - 1) {
        double friction = surface->friction[__builtin_ctzll(both)];
        max = friction > max ? friction : max;
    }
    return max;
}

/* Fits masses and contact distances to a time step. Once, after `clear` is known. */
lar_status lar_contact_surface_fit(const lar_model *model, double time_step, double stable_step,
                                   lar_contact_surface *surface, lar_error *error);

/* The nodes of which a node or point is made, and their shares; returns how many. */
static inline int lar_contact_parents(const lar_contact_surface *surface, int32_t node,
                                      int32_t parent[LAR_CONTACT_PARENTS],
                                      double weight[LAR_CONTACT_PARENTS]) {
    parent[0] = node;
    weight[0] = 1;
    if (node < surface->node_count) return 1;
    const lar_contact_point *point = &surface->point[node - surface->node_count];
    for (int i = 0; i < point->count; i++) {
        parent[i] = point->node[i];
        weight[i] = point->weight[i];
    }
    return point->count;
}

/* Finds the sharp edges at rest: sets `blunt` and `fades`, and adds points of edges and faces. */
lar_status lar_contact_surface_edges(lar_contact_surface *surface, lar_error *error);

/* Masses of these points, from those of nodes. */
void lar_contact_edges_fit(lar_contact_surface *surface);

/* Whether a node and a face are never together. */
bool lar_contact_apart(const lar_contact_surface *surface, int32_t node, int32_t face);

#endif
