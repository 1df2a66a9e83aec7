/* Which nodes may come to touch which faces soon: the search over boxes (T 3.8.1).
 *
 *     tree of forks, four branches each  a box around all faces below a branch; made once from
 *                   []                   the places at rest, refitted at every search
 *         []    []      []    []
 *        ffff  ffff    ffff  fff         every node goes down the branches whose boxes, grown by
 *                                        the reach of the faces and what these may move, it may
 *                                        come to be in
 *
 * Four boxes are looked at together, in single precision: rounding to the nearest keeps the order
 * of numbers, so what a box holds is held by the rounded one.
 *
 * The result is a list of groups: a node, and the faces of ONE body that it may meet, ascending.
 * It misses nothing as long as no contact node has moved along any axis, since the search, by more
 * than it may: half the skin, or a share of that. Where an instrument strikes tissue some nodes are
 * much faster than most; with the same skin for all of them, a list has many times the pairs.
 *
 * A search of an organ takes as long as some twenty steps. So that nobody waits for it, it can be
 * made a few nodes at a time, for the places at its beginning, while the last list is still good.
 *
 * What is found depends on the skin, what touches does not: a list with more pairs than another
 * gives the same contacts (body_contact.h). A search asks for no memory: lists have room for
 * LAR_PAIRS_PER_NODE pairs per node; where that is not enough, it is made again with a thinner
 * skin.
 */
#ifndef LAR_CONTACT_CONTACT_SEARCH_H
#define LAR_CONTACT_CONTACT_SEARCH_H

#include <math.h>

#include "contact/contact_surface.h"

/* Up to four branches: forks, all of them with higher numbers, or faces, ~i for the face order[i]
 * of the tree. Those that are not there repeat the first one and have boxes that hold nothing. */
enum { LAR_FORK = 4 };
typedef struct lar_fork {
    int32_t branch[LAR_FORK];
} lar_fork;

typedef float lar_fours __attribute__((vector_size(4 * LAR_FORK)));
typedef struct lar_fork_box {
    lar_fours lower[3], upper[3]; /* of each branch */
} lar_fork_box;

typedef struct lar_box {
    double lower[3], upper[3];
} lar_box;

/* What may touch what, and the tree over it: constant once time step and masses are fitted. */
typedef struct lar_contact_tree {
    lar_contact_surface surface;
    int32_t fork_count;
    lar_fork *fork; /* [fork_count] the first one has everything */
    int32_t *order; /* [face_count] faces, those of a fork together */
    int32_t *place; /* [face_count] where a face stands in `order` */
} lar_contact_tree;

typedef struct lar_contact_search {
    const lar_contact_tree *tree;
    lar_fork_box *fork_box; /* [tree->fork_count] */
    lar_box *face_box;      /* [face_count] in the tree's order */
    int32_t *apart;         /* [face_count] the last node, plus 1, that never meets it */
    float *share;           /* [contact nodes] of half the skin, that each may move, in the searches
                               that begin from now on: in (0, 1] */
    lar_contact_list list;  /* of the last search */
    lar_contact_list next;  /* of the one under way */
    const double (*x)[3];   /* its places, not owned */
    int32_t boxes;          /* of faces made anew so far */
    int32_t at;             /* the node that comes next */
} lar_contact_search;

/* Without contacts between bodies surface.node_count is 0. Bodies that lie in each other at rest
 * are refused (LAR_ERROR_MODEL). */
lar_status lar_contact_tree_create(const lar_model *model, const double *mass, const int32_t *local,
                                   lar_contact_tree *tree, lar_error *error);
void lar_contact_tree_clear(lar_contact_tree *tree); /* idempotent */

/* For that: LAR_ERROR_MODEL where a node of the surface lies inside another body that may touch it,
 * deeper than the list of a search at rest tells. */
lar_status lar_contact_refuse_inside(const lar_model *model, const lar_contact_surface *surface,
                                     const lar_contact_list *list, lar_error *error);

/* How many nodes that no contact pushes, `force` being what it does to nodes of the model, and that
 * no face is near, lie inside another body that may touch them, when the nodes of the model have
 * moved by u; *node: one of them, of the model; -1: none. */
lar_status lar_contact_count_inside(const lar_model *model, const lar_contact_tree *tree,
                                    const double (*u)[3], const double (*force)[3], int32_t *count,
                                    int32_t *node, lar_error *error);

/* `tree`, which has nodes, outlives it. */
lar_status lar_contact_search_create(const lar_contact_tree *tree, lar_contact_search *search,
                                     lar_error *error);
void lar_contact_search_clear(lar_contact_search *search); /* idempotent */

/* A node's share, from its greatest velocity along an axis and that of all: half as much again as
 * it would use if all went on like that, and no less than `least`. */
static inline float lar_contact_share_of(double speed, double fastest, double least) {
    static const double LESS = 0.25, MORE = 1.5;
    double share = fmax(fmax(LESS, least), fastest > 0 ? MORE * speed / fastest : 1);
    return (float)fmin(share, 1);
}
/* All may move by half the skin. */
void lar_contact_share_alike(lar_contact_search *search);

/* Makes the list anew for the places x, [contact nodes][3], with a skin of at most `skin` [m];
 * list.skin says what it became. False when even without a skin there are too many pairs: the
 * surface is crushed beyond use, or not finite. */
bool lar_contact_search_run(lar_contact_search *search, const double (*x)[3], double skin);

/* The same in parts: x must stay as it is meanwhile, and `list` the last one. */
void lar_contact_search_begin(lar_contact_search *search, const double (*x)[3], double skin);
typedef enum lar_contact_progress {
    LAR_SEARCH_UNDER_WAY,
    LAR_SEARCH_DONE, /* `list` is the new one, and the memory of the old one is used next */
    LAR_SEARCH_FULL  /* too many pairs: take lar_contact_search_run */
} lar_contact_progress;
lar_contact_progress lar_contact_search_go_on(lar_contact_search *search, int32_t nodes);
/* The same for so long: up to `until` by lar_clock_seconds. What is found last is not looked for
 * when there would be less than `after` of it left to take the list [s]. */
lar_contact_progress lar_contact_search_until(lar_contact_search *search, double until,
                                              double after);
/* What is left to do, in nodes. */
int32_t lar_contact_search_left(const lar_contact_search *search);

#endif
