/* Bodies against each other and themselves: what one thread has of it (T 2.2.8, 3.8).
 *
 *     search (contact_search.h)     now and then: groups of a node and faces that it may meet
 *     prediction                    each group: not looked at before it can have come into reach
 *     contact                       a function of places, velocities and offsets
 *
 * Contact of a group. Of all its faces within reach the closest one counts; between equally close
 * ones the one over or under whose plane the node is farthest, then the one with the lower number.
 * If the node is behind it, the closest point p pulls it: F along p - x, of the law of
 * mechanics/contact.h, -w_a F on the corners. The mass is that of the node against that of the
 * point of the face. Which other pairs are in the list does not matter, nor
 * when it was made, so searching in every step gives the same bits. Forces are rounded at the
 * corners, and the node gets minus their sum: momentum is kept to the last bit.
 *
 * Different bodies push from a contact distance on, before they touch (contact_surface.h). Above a
 * hollow, and behind a ridge, several faces are about as close and the closest point jumps: up to
 * LAR_CONTACT_FACES of them push together, with the mean of their forces, in the line to a mean of
 * their points, which does not jump. docs/theory.md, contact.
 *
 * Sharp edges (contact_edges.c): towards them springs fade, with a force
 * along the face; and points of them are pushed by faces of other bodies as nodes are, but not by
 * those that they run through.
 *
 * Offsets. A node of a body may come to lie below that body's own faces without having come through
 * one of them: through its neighbours, which do not push it, or because the body lies in itself at
 * rest. Pushed from there it would get energy that contact never took. So the depth at which it
 * appears is its offset, and only what it sinks below that pushes it; coming out, it takes the
 * offset along. A node that came through the face has the offset 0. One that appears deep belongs
 * inside, as in a thin part that is squeezed: it keeps its offset, and when it comes out through
 * the back of the face nothing hinders it on its way in.
 *
 * Nor may faces of another body push who comes behind them from the back. Of a surface that is
 * folded so far that it goes through itself the closest face may turn its back to a node outside,
 * and once that is within reach it would be thrown out from the bottom of a layer that it never
 * sank into. Whether it was in the layer before is seen from where all were a step ago; that it is
 * not pushed is remembered until it touches nothing. Points of edges and faces, which have no
 * offset, are not pushed by other bodies from a quarter of the layer on.
 *
 * Blocks that stand exactly on each other (history/flush.h). A node has parted from the block that
 * it was flush with once it is beside it, or above it by a part of a face: then it sees all faces,
 * which is remembered in the sign of its offset, until it stands straight before the block again.
 *
 * Offsets are the one thing that contact remembers: they stand in state->level [m], 0 for who is
 * not inside, and belong to the state like u and v.
 *
 * Prediction (T 3.8.2). The thesis assumes a greatest acceleration. Here nothing is assumed: the
 * kernel that moves the nodes notes the fastest in passing (lar_state.fastest), so `travel` can add
 * up, step by step, how far any node has moved along any axis at most. A group whose faces are all
 * farther away than their reach, by a `gap`, is due when travel has grown by gap / (2 sqrt 3): two
 * nodes, three axes. Groups due beyond a horizon are not even compared until travel gets there. The
 * list is good until travel since its search is half its skin. Before that the real motion is
 * looked at, and the search is made anew if it is true that something has moved (contact_motion.h).
 *
 * Several threads and processors: contact_exchange.h.
 */
#ifndef LAR_CONTACT_BODY_CONTACT_H
#define LAR_CONTACT_BODY_CONTACT_H

#include <math.h>
#include <string.h>

#include "contact/conditions.h"
#include "contact/contact_search.h"
#include "contact/search/contact_motion.h"
#include "mechanics/contact.h"
#include "mechanics/face_contact.h"

/* Of a contact node in the exchange buffer: place, velocity, offset. */
enum { LAR_PLACE_VALUES = 7 };

/* And behind it, where bodies rub, LAR_STICK_VALUES (history/body_friction.h). */

typedef struct lar_body_friction lar_body_friction;

/* Where the contact nodes are: in the state of whoever has all of them, or in the exchange buffer.
 */
typedef struct lar_contact_view {
    const int32_t *local;                    /* [contact nodes] local node, -1: not here */
    const double (*place)[LAR_PLACE_VALUES]; /* NULL, or by slot */
    const int32_t *slot;                     /* [contact nodes] with `place` */
    const double (*stick)[LAR_STICK_VALUES]; /* likewise, where friction asks for it */
} lar_contact_view;

/* Faces of a body that push a node together, at most, and whom they push. */
enum {
    LAR_CONTACT_FACES = 4,
    LAR_CONTACT_PARTS = LAR_CONTACT_PARENTS + 4 * (LAR_CONTACT_FACES + 3)
};

/* What this thread adds in the step under way: forces on its local nodes. */
typedef struct lar_body_contact_part {
    int32_t count;
    int32_t node[LAR_CONTACT_PARTS]; /* local */
    double force[LAR_CONTACT_PARTS][3];
} lar_body_contact_part;

/* Offsets that cannot be measured, but are not 0: of a node that came through the face; of one that
 * belongs inside and is outside, having come out through the back of a face; of the same on its way
 * in again, which nothing hinders. */
#define LAR_OFFSET_FRONT  1e-300
#define LAR_OFFSET_OUT    2e-300
#define LAR_OFFSET_RETURN 3e-300

/* And of a node that has come behind the faces of another body from the back: these do not push it
 * before it is out. Of which body is told apart, so that it may be before those of a third. */
static inline double lar_offset_behind(int32_t body) {
    return 4e-300 + 1e-300 * body;
}
static inline bool lar_offset_is_behind(double offset) {
    return offset > 3.5e-300 && offset < 1e-280;
}

/* No offset: the node has parted from what it was flush with (history/flush.h), which the sign of
 * its offset says from then on. */
#define LAR_OFFSET_PARTED (-0.0)
/* And no longer: it stands before that again. Only noted, no offset is so. */
#define LAR_OFFSET_MET INFINITY

/* An offset that is another than in the last step. */
typedef struct lar_penetration_offset {
    int32_t node; /* local */
    double depth; /* [m] */
} lar_penetration_offset;

/* The list and what has moved since, of whoever has the whole model. */
typedef struct lar_body_contact_search_state {
    lar_contact_search *search;
    int32_t *local;            /* [contact nodes] of lar_contact_view */
    double (*x)[3];            /* [contact nodes] places at the search under way [m] */
    double (*searched)[3];     /* and at the last one */
    double skin_min, skin_max; /* [m] */
    double looked, look_at;    /* contact->moved when somebody looked, and what it must be feared
                                  to be before somebody does again [m] */
    double taking;             /* what it takes to take a list [s] */
    double steps;              /* that the list is good for, as it looked then */
    uint64_t next;             /* the round that follows the last one */
    bool searching;            /* a search is under way */
    bool whole;                /* the list is that of `searched`: nothing was left out */
    bool valid;                /* the list belongs to the state */
    bool always;               /* search in every step */
} lar_body_contact_search_state;

typedef struct lar_body_contact {
    const lar_contact_surface *surface; /* NULL: nothing to do */
    lar_contact_law law;
    double rigid; /* how many times as stiff it is between rigid bodies */
    double time_step;
    const uint8_t *held; /* as in the context of the step under way */
    lar_contact_view view;
    lar_contact_list list;            /* what this thread has to do with */
    uint8_t *adds_node, *adds_corner; /* [contact nodes], [contact faces]; NULL: all */
    double *due;                      /* [list.group_room] travel at which to look */
    int32_t *last;      /* [list.group_room] the closest face then, an entry; ~ of it where the node
                           was flush with the body */
    double *away;       /* [list.face_room] travel until which the face cannot
                           be the closest one within reach */
    int32_t *near;      /* [list.group_room] the groups that are due before */
    int32_t near_count; /* travel is at */
    double travel, horizon; /* [m] */
    double moved; /* since the search, along any axis, by nodes of this thread, at most [m] */
    double way;   /* the same in the last step [m] */
    double need;  /* of a step, by springs that are harder than the law's (lar_contact_deep_need),
                     at most since lar_report_stretch */
    int32_t part_count;
    lar_body_contact_part *part; /* [list.group_room] */
    uint8_t *keeps;              /* [contact nodes] those that this thread moves; NULL: all */
    int32_t offset_count;
    lar_penetration_offset *offset; /* [3 list.group_room] of these nodes, from when they move on */
    lar_body_friction *friction;    /* NULL: no body is rough */
    bool fresh;                     /* no forces have been computed with the list */
    bool too_many_pairs;            /* there was no room for all pairs: the run must stop */
    lar_contact_info info;
    lar_body_contact_search_state *search_state; /* of whoever has all nodes; otherwise NULL */
} lar_body_contact;

/* ---- places ---------------------------------------------------------------------------------- */

static inline void lar_contact_place_of_node(const lar_body_contact *contact,
                                             const lar_state *state, int32_t node, double x[3],
                                             double v[3]) {
    const lar_contact_view *view = &contact->view;
    if (view->place) {
        const double *place = view->place[view->slot[node]];
        memcpy(x, place, 3 * sizeof *x);
        if (v) memcpy(v, place + 3, 3 * sizeof *v);
        return;
    }
    const double *rest = contact->surface->rest[node];
    const int32_t local = view->local[node];
    for (int i = 0; i < 3; i++) x[i] = rest[i] + state->u[lar_state_at(state, local, i)];
    if (v) lar_state_velocity(state, local, v);
}

/* Of a node or a point; v may be NULL. */
static inline void lar_contact_place(const lar_body_contact *contact, const lar_state *state,
                                     int32_t node, double x[3], double v[3]) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS], one[3], speed[3];
    int count = lar_contact_parents(contact->surface, node, parent, weight);
    if (count == 1) {
        lar_contact_place_of_node(contact, state, node, x, v);
        return;
    }
    for (int k = 0; k < count; k++) {
        lar_contact_place_of_node(contact, state, parent[k], one, v ? speed : NULL);
        for (int i = 0; i < 3; i++) {
            x[i] = k == 0 ? weight[0] * one[i] : x[i] + weight[k] * one[i];
            if (v) v[i] = k == 0 ? weight[0] * speed[i] : v[i] + weight[k] * speed[i];
        }
    }
}

static inline void lar_contact_corners(const lar_body_contact *contact, const lar_state *state,
                                       int32_t face, double x[4][3], double v[4][3]) {
    for (int a = 0; a < 4; a++)
        lar_contact_place_of_node(contact, state, contact->surface->face[face].corner[a], x[a],
                                  v ? v[a] : NULL);
}

/* ---- surveys (survey/survey.c) --------------------------------------------------------------- */

/* Which face of a body counts for a node or point, of all that are near, with as few looks at the
 * others as will do: every group and face knows the travel until which nothing can come of it. */

/* How much nearer a node and a face come when all nodes move by 1 along every axis. */
#define LAR_APPROACH 3.4641016151377546 /* 2 sqrt 3 */

/* Of the depth behind the faces of another body, that part is what others than the closest one may
 * be farther away and still count. */
#define LAR_FADE_BEHIND 0.02

/* How a face that a node does not see takes part in what the closest one that it sees does. */
typedef struct lar_inset {
    double behind;   /* how far the node is behind it; negative: past the other's edge [m] */
    double square;   /* how squarely they meet, from 0 to 1 */
    double past;     /* past the other's edge, in its plane; 0 where they do not meet so [m] */
    double way[3];   /* from its closest point, in the other's plane [m] */
    double steep;    /* how much `behind` changes with the length of that, */
    double straight; /* with the distance, */
    double rim;      /* with minus `past`, */
    double lift;     /* and with the depth behind the other */
} lar_inset;

/* What is known of a group's faces: distances of those that may matter, at least so much. */
typedef struct lar_survey {
    double x[3];   /* the node [m] */
    double reach;  /* of the faces for the node [m] */
    bool flush;    /* with the body: some of its faces are not seen */
    unsigned held; /* axes that the node is held along; 0 for other bodies than its own */
    double fade;   /* by how much others than the closest may be farther away and still count, at
                      most, [m] */
    double above;  /* the same before the faces [m] */
    int32_t count;
    int32_t entry[LAR_GROUP_FACES_MAX]; /* ascending */
    double distance[LAR_GROUP_FACES_MAX];
    double corner[LAR_GROUP_FACES_MAX][4][3];  /* [m] */
    lar_face_point point[LAR_GROUP_FACES_MAX]; /* where they are closest, of those near `min` */
    double min;                                /* of those within reach; INFINITY: none is */
    double gap;     /* by which those looked at are out of reach, at most 0 when one is not [m];
                       -INFINITY: the node is behind some that it does not see */
    bool edge;      /* the node is on a sharp edge, and may not see all faces that it is behind */
    double within;  /* so far behind a face that it does not see all is as if that were not, and all
                       that are nearer are looked at; 0: as `min` says [m] */
    bool touch;     /* it is, and has no contact distance from the body */
    double across;  /* so far an edge that goes on is led over a border; 0: it is not [m] */
    int32_t border; /* the face through which the node's edge comes, of those above; -1: none */
    double lies;    /* how surely the edge lies on another, from 0, where one on which it does not
                       lie is as near, to 1 */
    bool over;      /* the node comes to that, and is pushed as if it were before the face */
    int32_t hidden; /* the one of those that it does not see that it is least far behind, or past
                       the edge of; within that; -1: none */
    double inset;   /* how far the node is behind the border [m] */
    lar_inset hides; /* how that one takes part */
    double before;   /* it is so far before one that it does not see; INFINITY: none [m] */
    bool inside;     /* it is behind one that it does not see: none that it is before counts */
    bool beyond;     /* it is in another body still, on the other side of a joint */
    bool joints;     /* closed joints are not in the way */
    double beside;   /* how far from an edge those are, at least, and a little; INFINITY: there are
                        none [m] */
    double next;     /* travel at which the first of the others may matter [m] */
} lar_survey;

/* The face that counts of group g, and where; -1: none is within reach. Sets when it is due. */
int32_t lar_survey_closest(lar_body_contact *contact, const lar_state *state, int32_t g,
                           lar_survey *s, lar_face_point *point);

/* How far nodes may move against each other [m] until a node of another body that touches nothing,
 * before its closest face, is looked at again. */
double lar_survey_clear(const lar_body_contact *contact, const lar_state *state, int32_t g,
                        const lar_survey *s, const lar_face_point *point);

/* ---- offsets (history/body_offset.c) --------------------------------------------------------- */

static inline bool lar_same_body(const lar_body_contact *contact, int32_t node, int32_t face) {
    return contact->surface->node[node].body == contact->surface->face[face].body;
}

/* From which depth on a node is pushed by a face of its own body, `depth` deep and sinking at
 * `rate`. Who was before the face a step ago has come through it. */
double lar_offset_follow(lar_body_contact *contact, const lar_state *state, int32_t node,
                         int32_t face, double depth, double rate);

/* The node is before the closest face of its own body, or none is near (-1). Who belongs inside
 * has come out through the back. */
void lar_offset_leave(lar_body_contact *contact, const lar_state *state, int32_t node,
                      int32_t face);

/* Whether a face of another body pushes the node or point of group g, `depth` deep behind it
 * (negative: before it) and sinking at `rate`: not where that has come behind the body's faces from
 * the back, and is not yet so far before them that nothing would push it. */
bool lar_offset_pushes(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t face,
                       const lar_survey *survey, double depth, double rate);

/* Where a sharp edge goes at a face. */
typedef struct lar_edge_way {
    double deeper; /* how much deeper behind the face it goes on to the next node, where it goes
                      through the face [m]; 0 where the face lies along it, with the node's body
                      before it; otherwise -1 */
    double sure;   /* of the first two, from 0 at the angle where it would be the third to 1 */
} lar_edge_way;

/* Whether a face that a node or point on a sharp edge is behind looks away from its body: pushed
 * out there the node would be pulled from its own body, for the surface of that goes on beyond the
 * face, with both bodies on one side of it. The face is only nearer than the one that is in the
 * way, as where a block slides over the end of what it lies on.
 * Returns how surely it does, from 0 to 1; -1: it does not. *through, if not NULL: where the edge
 * goes. */
double lar_looks_away(const lar_body_contact *contact, const lar_state *state, int32_t node,
                      const double corner[4][3], lar_edge_way *through);

/* How far nodes may move against each other [m] until a face that does not look away from the body
 * of that node may: both turn with it. 0: it does. */
double lar_looks_on(const lar_body_contact *contact, const lar_state *state, int32_t node,
                    const double corner[4][3]);

/* A face that the node of group g, on a sharp edge, is behind may stand against one of a third body
 * that looks the other way: a joint that is closed, with nothing between. Through that nobody comes
 * in, so the face is not in the way of who came along in the third body, and pushes as little as if
 * the two were one. Not so where one of the two faces goes on beyond the edge of the other: there
 * its side is in the way. `corner` and `point` are the face's; *within becomes how far from its
 * edge that is [m]. */
#define LAR_JOINT_STEP 0.02 /* of a face: who differs by less does not stand out */
typedef enum lar_joint {
    LAR_JOINT_NONE,
    LAR_JOINT_PASSED, /* the node is past the third body's face, */
    LAR_JOINT_AHEAD   /* or behind that still: bodies may lie in each other there */
} lar_joint;
lar_joint lar_joint_of(const lar_body_contact *contact, const lar_state *state, int32_t g,
                       int32_t face, const double x[3], const double corner[4][3],
                       const lar_face_point *point, double *within);

/* The edge of the node of group g may go into the other body through one face, the border, and lie
 * on another one, as that of a slab under a block that slides along it. Then only the other one is
 * in its way: of those that it goes through none is seen. The border takes part in what the other
 * one does, until the node is `across` behind it, and the less the nearer one is on which the edge
 * does not lie, as around the end of an edge: to that the node goes over. A node within the contact
 * distance before it is `over` the other one. */
void lar_edge_enters(const lar_body_contact *contact, const lar_state *state, int32_t g,
                     lar_survey *s);

/* The part of a spring that there is so far behind the border of one that stores `energy` more than
 * on that: none on it, or it would come from nowhere. on[]: the forces on that face's corners by
 * which it is paid; the node gets minus their sum [N]. */
double lar_edge_part(const lar_survey *s, double energy, double on[4][3]);

/* The same about a face that is not seen: all of it s->within behind it, half of it in its plane,
 * nothing as far before it. What one body's edge gives up there the other's takes over. */
double lar_edge_over(const lar_survey *s, double energy, double on[4][3]);

/* What that is less by per metre that s->hides.behind is less [N]. */
double lar_edge_slope(const lar_survey *s, double energy);

/* The node of group g touches no face of that other body, `gap` out of their reach [m] (INFINITY:
 * it is before one): from now on it is pushed like any other. Who is behind faces that look away
 * from its body (-INFINITY), and no others, has come there from the back. */
void lar_offset_out(lar_body_contact *contact, const lar_state *state, int32_t g, double gap);

/* Whether the node or point of group g is flush still with the body of that (history/flush.h), and
 * does not see all of its faces. */
bool lar_offset_is_flush(const lar_body_contact *contact, const lar_state *state, int32_t g);

/* Whether the node of group g was flush with somebody at rest. */
static inline bool lar_offset_was_flush(const lar_body_contact *contact, int32_t g) {
    const int32_t node = contact->list.group[g].node;
    return contact->surface->flush_first[node] < contact->surface->flush_first[node + 1];
}

/* Whether it is flush again, and was not when it was looked at the last time: what it touches then
 * is nearer than what it waits for. So it is where one of its ends has come straight before a body
 * once more. */
static inline bool lar_offset_flush_again(const lar_body_contact *contact, const lar_state *state,
                                          int32_t g) {
    return contact->last[g] >= 0 && lar_offset_was_flush(contact, g) &&
           lar_offset_is_flush(contact, state, g);
}

/* The node of group g, which is flush, touches nothing of that body. It has parted when it is
 * beside it, or too far above. `face`: the closest one that it sees, or -1. */
void lar_offset_stay_flush(lar_body_contact *contact, const lar_state *state, int32_t g,
                           int32_t face, const lar_face_point *closest);

/* Bodies that are not listed any more are out of reach: a node that is flush has parted when it was
 * so with one of these, unless it stands on another. To be asked in every step, or it would depend
 * on the list when it parts. Its groups begin at `first`, if it has some. */
void lar_offset_lose_flush(lar_body_contact *contact, const lar_state *state, int32_t node,
                           int32_t first);

/* The node of group g is not flush and touches nothing of that body: where it has been flush with
 * it and is straight before a face now, and near, it is so again. How far it may go before that has
 * to be looked at once more [m]. */
double lar_offset_meet(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t face,
                       const lar_face_point *closest);

/* A node has parted from all that it was flush with, from when it moves on. */
void lar_offset_part(lar_body_contact *contact, int32_t node);

/* ---- the step -------------------------------------------------------------------------------- */

/* For the whole model; `tree`, fitted to the time step, outlives it. Without contacts of bodies it
 * costs nothing. */
lar_status lar_body_contact_create(const lar_contact_tree *tree, const int32_t *local,
                                   double time_step, double stable_step, bool search_always,
                                   lar_body_contact *contact, lar_error *error);
void lar_body_contact_destroy(lar_body_contact *contact); /* idempotent */

/* The state was changed by others: nothing is known of its motion. */
void lar_body_contact_forget(lar_body_contact *contact);

/* Energy that says nothing [J]: that of all nodes as deep as a hundred-millionth of a layer. Where
 * loads have hardly begun, what moves is the rounding of places and forces. */
double lar_body_contact_nothing(const lar_body_contact *contact);

/* Between steps, while nobody waits: what there will be to search soon, up to `until` by
 * lar_clock_seconds. */
void lar_body_contact_work_ahead(lar_body_contact *contact, const lar_state *state, double until);

/* Adds the forces at the state's step to state->force, after a search where that is due. Asks for
 * no memory. */
void lar_body_contact_apply(lar_body_contact *contact, const lar_condition_context *context,
                            lar_state *state);

/* The same for a list that somebody else keeps. */
void lar_body_contact_add(lar_body_contact *contact, const lar_condition_context *context,
                          lar_state *state);

/* The list is another one: all groups are to be looked at again. */
void lar_body_contact_restart(lar_body_contact *contact);
/* With a list's first forces: nodes that have an offset are looked at, and who is not in the list
 * has come out of reach of its own body since the last one, so that its offset ends. */
void lar_body_contact_end_offsets(lar_body_contact *contact, const lar_state *state);

/* The nodes have moved, none farther than `way` along any axis [m]; offsets become theirs. */
void lar_body_contact_moved(lar_body_contact *contact, lar_state *state, double way);

/* Half the work of these forces in this step, to state->contact and ->exchanged: once before and
 * once after the nodes move. */
void lar_body_contact_half_work(const lar_body_contact *contact,
                                const lar_condition_context *context, lar_state *state);

#endif
