#include "contact/body_contact.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "contact/history/flush.h"

static double tie_of(const lar_body_contact *contact, int32_t face) {
    return LAR_FACE_TIE * contact->surface->face[face].size;
}

/* Of the contact distance, that part; 0 within a body. What goes over from one face to the next
 * within it is not the slope of anything: the less, the less energy comes from nowhere. */
static double fade_above(const lar_body_contact *contact, int32_t node, int32_t face) {
    static const double FADE = 0.06;
    const lar_contact_surface *surface = contact->surface;
    return FADE * lar_contact_standoff(surface, &surface->node[node], &surface->face[face]);
}

/* Whether a face that the node of group g, on a sharp edge, is before looks away from its body, and
 * is no joint: that has come over its edge. */
static bool is_over(const lar_body_contact *contact, const lar_state *state, int32_t g, int32_t f,
                    const lar_survey *s, const double corner[4][3], const lar_face_point *point) {
    double beside;
    return lar_looks_away(contact, state, contact->list.group[g].node, corner, NULL) >= 0 &&
           !(s->joints && lar_joint_of(contact, state, g, f, s->x, corner, point, &beside));
}

/* Whether a face that the node of group g, on a sharp edge, is behind is not in its way. */
static bool passes_by(const lar_body_contact *contact, const lar_state *state, int32_t g, int32_t f,
                      lar_survey *s, const double corner[4][3], lar_face_point *point) {
    const bool away =
        lar_looks_away(contact, state, contact->list.group[g].node, corner, NULL) >= 0;
    double beside;
    const lar_joint joint = s->joints
                                ? lar_joint_of(contact, state, g, f, s->x, corner, point, &beside)
                                : LAR_JOINT_NONE;
    if (joint && !away) s->beside = fmin(s->beside, beside);
    /* Farther away not all faces are looked at. */
    if (joint == LAR_JOINT_AHEAD && !away && point->distance < s->within) s->beyond = true;
    /* What one side stops to push there the other side begins to: nothing is to be paid. */
    if (joint) point->distance = INFINITY;
    return away || joint;
}

/* Looks at face f. Returns its distance, or at least so much; *point is that of the closest faces.
 * INFINITY: it is not seen. A slice of one element between two planes has its nodes in the planes
 * of its sides: a wall that goes through another one would find that one's side closest, at no
 * distance, and nothing that pushes. */
static double survey_face(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t f,
                          lar_survey *s, double corner[4][3], lar_face_point *point) {
    double tie = tie_of(contact, f);
    lar_contact_corners(contact, state, f, corner, NULL);
    double distance = lar_face_box_distance(s->x, (const double(*)[3])corner);
    if (distance <= lar_greater(s->min + s->fade, s->within) + tie && distance <= s->reach + tie) {
        contact->info.tested++;
        lar_face_closest(s->x, (const double(*)[3])corner, tie, point);
        distance = point->distance;
        if ((s->held & contact->surface->face[f].plane) && fabs(point->height) <= tie) {
            s->gap = fmin(s->gap, 0); /* it is looked at again in the next step */
            return INFINITY;
        }
        if (s->edge && point->height < -tie && distance <= s->reach &&
            passes_by(contact, state, g, f, s, (const double(*)[3])corner, point)) {
            s->gap = -INFINITY;
            return INFINITY;
        }
        if (s->touch && !(point->height < -tie) && distance <= s->reach &&
            is_over(contact, state, g, f, s, (const double(*)[3])corner, point)) {
            s->gap = fmin(s->gap, 0);
            s->before = fmin(s->before, distance);
            return INFINITY;
        }
        if (s->inside && !(point->height < 0)) return point->distance = INFINITY;
        if (distance <= s->reach && distance < s->min) s->min = distance;
    }
    if (distance - s->reach < s->gap) s->gap = distance - s->reach;
    return distance;
}

/* How far nodes may move against each other until a face that is farther away than the closest one
 * may be that: both distances change. */
static double farther_by(double distance, double tie, const lar_survey *s) {
    return 0.5 * (distance - 8 * tie - lar_greater(s->fade + s->min, s->within));
}

/* The travel until which a face cannot be the closest one within reach: it is out of reach, or
 * farther away. */
static double away_until(double travel, double distance, double tie, const lar_survey *s) {
    if (distance == INFINITY) return 0; /* not seen now */
    double reach = distance - tie - s->reach, min = farther_by(distance, tie, s);
    return travel + 0.999 * (reach > min ? reach : min) / LAR_APPROACH;
}

/* Where an edge comes in through a face, of the depth of the layer. */
static const double ACROSS = 0.25;

/* Who was flush with the body when its group was surveyed the last time did not look as far: all
 * faces are to be looked at. Returns the face that was closest then. */
static int32_t begin_with(lar_body_contact *contact, int32_t g, bool flush) {
    const lar_contact_group *group = &contact->list.group[g];
    const bool was_flush = contact->last[g] < 0;
    if (was_flush != flush) contact->last[g] = ~contact->last[g];
    for (int32_t i = 0; i < group->count && was_flush && !flush; i++)
        contact->away[group->first + i] = 0;
    return flush ? ~contact->last[g] : contact->last[g];
}

/* The one that was closest the last time goes first: most others then need no more than a look. */
static void survey_group(lar_body_contact *contact, const lar_state *state, int32_t g,
                         lar_survey *s) {
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t *face = contact->list.face + group->first;
    double *away = contact->away + group->first;
    s->reach = lar_contact_reach(contact->surface, &contact->surface->node[group->node],
                                 &contact->surface->face[face[0]]);
    s->above = fade_above(contact, group->node, face[0]);
    s->fade = lar_same_body(contact, group->node, face[0])
                  ? s->above
                  : fmax(s->above, LAR_FADE_BEHIND * s->reach);
    s->min = s->gap = s->next = s->beside = INFINITY;
    s->count = 0;
    s->flush = lar_offset_is_flush(contact, state, g);
    const int32_t first = begin_with(contact, g, s->flush);
    s->held =
        lar_same_body(contact, group->node, face[0]) ? contact->surface->node[group->node].held : 0;
    s->edge = !s->flush && !lar_same_body(contact, group->node, face[0]) &&
              contact->surface->node[group->node].inward[0] >= 0;
    s->border = -1;
    s->over = s->beyond = false;
    s->before = INFINITY;
    s->within = s->edge ? ACROSS * s->reach : 0;
    s->touch =
        s->edge && !(lar_contact_standoff(contact->surface, &contact->surface->node[group->node],
                                          &contact->surface->face[face[0]]) > 0);
    s->across = contact->surface->node[group->node].along < 3 ? s->within : 0;
    s->hidden = -1;
    lar_face_point of_first;
    double corner_of_first[4][3];
    lar_contact_place(contact, state, group->node, s->x, NULL);
    double distance_of_first = 0, soon = contact->travel + contact->list.skin / 16;
    if (!s->flush || !lar_flush_hides(contact->surface, group->node, face[first]))
        distance_of_first =
            survey_face(contact, state, g, face[first], s, corner_of_first, &of_first);
    int32_t hidden = s->flush ? contact->surface->flush_first[group->node] : 0;
    for (int32_t i = 0; i < group->count; i++) {
        if (s->flush && lar_flush_hides_next(contact->surface, group->node, face[i], &hidden))
            continue;
        if (i != first && soon < away[i]) {
            if (away[i] < s->next) s->next = away[i];
            continue;
        }
        int32_t k = s->count++;
        s->entry[k] = i;
        s->distance[k] = distance_of_first;
        if (i != first) {
            s->distance[k] = survey_face(contact, state, g, face[i], s, s->corner[k], &s->point[k]);
            continue;
        }
        s->point[k] = of_first;
        memcpy(s->corner[k], corner_of_first, sizeof corner_of_first);
    }
    for (int32_t k = 0; k < s->count; k++) {
        int32_t i = s->entry[k];
        away[i] = away_until(contact->travel, s->distance[k], tie_of(contact, face[i]), s);
    }
}

/* The closest face of a group, an entry of it. All that are as close as the closest one were so
 * when they were looked at. */
static int32_t choose_face(const lar_body_contact *contact, int32_t g, const lar_survey *s,
                           lar_face_point *point) {
    const lar_contact_group *group = &contact->list.group[g];
    int32_t chosen = -1;
    for (int32_t k = 0; k < s->count; k++) {
        int32_t i = s->entry[k], f = contact->list.face[group->first + i];
        double tie = tie_of(contact, f);
        if (!(s->distance[k] <= s->min + tie) || s->distance[k] > s->reach + tie) continue;
        if (chosen >= 0 && !lar_face_point_before(&s->point[k], point)) continue;
        *point = s->point[k];
        chosen = i;
    }
    return chosen;
}

/* From the closest point of a face to the node, in the plane with that normal. */
static void way_from(const lar_survey *s, int32_t k, const double normal[3], double way[3]) {
    double at[3];
    lar_face_mean((const double(*)[3])s->corner[k], s->point[k].weight, at);
    lar_minus(s->x, at, way);
    const double up = lar_dot(way, normal);
    for (int i = 0; i < 3; i++) way[i] -= up * normal[i];
}

/* The closest face, the node's way past its edge, and how shallow it lies behind it. */
typedef struct chosen_face {
    int32_t face;
    const lar_face_point *point;
    double normal[3]; /* unit */
    double past;      /* its edge, in its plane [m] */
    double window;    /* so far on either side of an edge the one face takes over [m] */
    double shallow;   /* from 1, half of that behind it, to 0 where it is all of it */
    double slope;     /* of that with the depth [1/m] */
} chosen_face;

static void look_at(const lar_body_contact *contact, const lar_state *state, int32_t node,
                    int32_t face, const lar_face_point *point, const lar_survey *s,
                    chosen_face *c) {
    double corner[4][3];
    lar_rim rim;
    *c = (chosen_face){.face = face, .point = point};
    lar_contact_corners(contact, state, face, corner, NULL);
    lar_rim_normal((const double(*)[3])corner, point->triangle, c->normal);
    if (lar_rim_foot(s->x, (const double(*)[3])corner, point, &rim)) c->past = lar_length(rim.way);
    if (!(c->past > tie_of(contact, face))) c->past = 0;
    /* A body that is thinner than that would be pushed by its far side. */
    c->window = fmin(s->within,
                     ACROSS * contact->surface->body[contact->surface->node[node].body].reach[1]);
    const double part = 2 + 2 * point->height / c->window;
    c->shallow = lar_ease(part);
    if (part > 0 && part < 1) c->slope = -12 * part * (1 - part) / c->window;
}

/* How squarely a face that is not seen meets the one that counts, and how surely it looks away,
 * from 0 to 1. */
static double squareness(const lar_body_contact *contact, const lar_state *state, int32_t node,
                         const lar_survey *s, int32_t k, int32_t face, const chosen_face *c) {
    static const double SQUARE = 0.2, BLUNT = 0.45; /* cosines of 78 and 63 degrees */
    const double(*corner)[3] = (const double(*)[3])s->corner[k];
    double other[3];
    if (!s->touch || !lar_rim_meets(contact->surface, face, c->face)) return 0;
    lar_rim_normal(corner, s->point[k].triangle, other);
    return fmax(lar_looks_away(contact, state, node, corner, NULL), 0) *
           lar_ease((BLUNT - fabs(lar_dot(c->normal, other))) / (BLUNT - SQUARE));
}

/* Where face k of a survey, which is not seen, meets the closest one squarely, all that lies not
 * deep fades from so far behind the one as past the edge of the other; else from where it is behind
 * the one on. */
static lar_inset inset_at(const lar_survey *s, int32_t k, double squarely, const chosen_face *c) {
    const lar_face_point *at = &s->point[k];
    const bool before = !(at->height < 0);
    const double square = squarely * c->shallow, times = s->within / c->window;
    lar_inset inset = {.square = square, .past = square > 0 ? c->past : 0};
    way_from(s, k, c->normal, inset.way);
    const double far = lar_length(inset.way);
    const bool by_far = before && far > c->past;
    const double over = times * (before ? -fmax(far, c->past) : far - c->past);
    const double in = before ? -s->within : 2 * at->distance - s->within;
    inset.behind = square * over + (1 - square) * in;
    inset.steep = before && !by_far ? 0 : times * square;
    inset.straight = before ? 0 : 2 * (1 - square);
    inset.rim = c->past > 0 && !by_far ? times * square : 0;
    inset.lift = (over - in) * squarely * c->slope;
    return inset;
}

/* Who comes past an edge must not be pushed all at once by the next face, as deep as he is behind
 * that: of the faces that he does not see the one counts that he is least far behind. False: he is
 * outside, before one that has nothing to do with the closest one that he sees. */
__attribute__((noinline, cold)) static bool find_hidden(const lar_body_contact *contact,
                                                        const lar_state *state, int32_t g,
                                                        int32_t chosen, const lar_face_point *point,
                                                        lar_survey *s) {
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t *faces = contact->list.face + group->first;
    const double tie = tie_of(contact, faces[chosen]);
    double outside = INFINITY, front = point->distance;
    chosen_face c;
    look_at(contact, state, group->node, faces[chosen], point, s, &c);
    s->hides = (lar_inset){.behind = s->within};
    for (int32_t k = 0; k < s->count; k++) {
        const lar_face_point *at = &s->point[k];
        const bool before = !(at->height < 0);
        if (k == s->border || s->distance[k] != INFINITY ||
            !(before ? at->distance <= point->distance + tie : at->distance < s->within))
            continue;
        const double squarely =
            squareness(contact, state, group->node, s, k, faces[s->entry[k]], &c);
        const lar_inset inset = inset_at(s, k, squarely, &c);
        if (before && inset.square > 0) front = fmin(front, at->distance);
        if (before && !(inset.square > 0)) outside = fmin(outside, at->distance);
        if (!(inset.behind < s->hides.behind)) continue;
        s->hides = inset;
        s->hidden = k;
    }
    return !(outside < front - tie);
}

/* Of all faces the closest one says on which side the node is, whether it is seen or not. Whether
 * it is behind one that it does not see, and those that it is before are farther: not those that
 * share an edge with it, to which both are as far but for a tie each. */
__attribute__((noinline, cold)) static bool is_inside(const lar_body_contact *contact, int32_t g,
                                                      const lar_survey *s) {
    const int32_t *face = contact->list.face + contact->list.group[g].first;
    double unseen = INFINITY, before = INFINITY;
    for (int32_t k = 0; k < s->count; k++) {
        if (s->distance[k] == INFINITY && s->point[k].height < 0)
            unseen = fmin(unseen, s->point[k].distance + tie_of(contact, face[s->entry[k]]));
        else if (s->distance[k] < INFINITY && s->distance[k] <= s->min + s->fade &&
                 !(s->point[k].height < 0))
            before = fmin(before, s->distance[k] - tie_of(contact, face[s->entry[k]]));
    }
    return before < INFINITY && unseen < before;
}

/* Once more, all of them. */
__attribute__((noinline)) static void
survey_again(lar_body_contact *contact, const lar_state *state, int32_t g, lar_survey *s) {
    const lar_contact_group *group = &contact->list.group[g];
    for (int32_t i = 0; i < group->count; i++) contact->away[group->first + i] = 0;
    survey_group(contact, state, g, s);
}

/* Then it is pushed by one that it is behind, and none that it is before takes the place of that
 * at once. */
__attribute__((noinline, cold)) static void
look_inside(lar_body_contact *contact, const lar_state *state, int32_t g, lar_survey *s) {
    s->inside = true;
    survey_again(contact, state, g, s);
    s->inside = s->min < INFINITY;
    if (!s->inside) survey_again(contact, state, g, s);
}

/* How far from an edge the joints are of a survey that has met some, and a little. Only of those no
 * farther than the closest face may be: of those farther away not all are looked at. */
__attribute__((noinline, cold)) static void
find_beside(const lar_body_contact *contact, const lar_state *state, int32_t g, lar_survey *s) {
    const lar_contact_group *group = &contact->list.group[g];
    const double far = lar_greater(s->min + s->fade, s->within);
    s->beside = INFINITY;
    for (int32_t k = 0; k < s->count; k++) {
        const double(*corner)[3] = (const double(*)[3])s->corner[k];
        const int32_t f = contact->list.face[group->first + s->entry[k]];
        lar_face_point point;
        double beside;
        if (s->distance[k] < INFINITY || s->point[k].distance < INFINITY) continue;
        lar_face_closest(s->x, corner, tie_of(contact, f), &point);
        if (!(point.distance < far) ||
            lar_looks_away(contact, state, group->node, corner, NULL) >= 0 ||
            !lar_joint_of(contact, state, g, f, s->x, corner, &point, &beside))
            continue;
        s->beside = fmin(s->beside, beside + LAR_JOINT_STEP * contact->surface->face[f].size);
    }
}

/* Who has come along in one body past a joint to the next one is as deep there as the joint is long
 * from its edge. Where it is deeper, or nothing is left, as where several bodies meet along a line,
 * it has not come along. */
static bool is_in_joint(const lar_survey *s) {
    return s->beyond || s->min <= s->beside;
}

static const lar_contact_body *body_of(const lar_body_contact *contact, int32_t g) {
    const int32_t face = contact->list.face[contact->list.group[g].first];
    return &contact->surface->body[contact->surface->face[face].body];
}

/* Whether the node of group g is beyond a plane of symmetry, where the body ends. Of its mirror
 * image there are no faces: the last ones before the plane would push it across the plane, as deep
 * as it is beyond. */
__attribute__((noinline, cold)) static bool
is_beyond_end(const lar_body_contact *contact, const lar_state *state, int32_t g, lar_survey *s) {
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t face = contact->list.face[group->first];
    const lar_contact_body *body = body_of(contact, g);
    bool beyond = false;
    if (lar_same_body(contact, group->node, face)) return false;
    lar_contact_place(contact, state, group->node, s->x, NULL);
    for (int i = 0; i < 3; i++) beyond = beyond || s->x[i] < body->from[i] || s->x[i] > body->to[i];
    return beyond;
}

int32_t lar_survey_closest(lar_body_contact *contact, const lar_state *state, int32_t g,
                           lar_survey *s, lar_face_point *point) {
    const lar_contact_group *group = &contact->list.group[g];
    s->inside = false;
    s->before = s->gap = INFINITY;
    contact->due[g] = 0;
    if (body_of(contact, g)->cut && is_beyond_end(contact, state, g, s)) {
        s->flush = lar_offset_is_flush(contact, state, g);
        return -1;
    }
    s->joints = true;
    survey_group(contact, state, g, s);
    /* Who was farther than a face that is not seen now may be the closest one. */
    if ((s->gap == -INFINITY || s->before < INFINITY) && s->next < INFINITY)
        survey_again(contact, state, g, s);
    if (s->beside < INFINITY) find_beside(contact, state, g, s);
    if (s->beside < INFINITY && !is_in_joint(s)) {
        s->joints = false;
        survey_again(contact, state, g, s);
    }
    /* A little earlier, for rounding. */
    contact->due[g] = s->gap > 0 && !s->flush
                          ? lar_lesser(contact->travel + 0.999 * s->gap / LAR_APPROACH, s->next)
                          : 0;
    if (s->beyond) s->gap = 0;
    if (!(s->min < INFINITY) || s->beyond) return -1;
    if (s->across > 0) lar_edge_enters(contact, state, g, s);
    const bool hides = s->gap == -INFINITY || s->before < INFINITY;
    if (s->border < 0 && !s->over && s->gap == -INFINITY && is_inside(contact, g, s))
        look_inside(contact, state, g, s);
    int32_t chosen = choose_face(contact, g, s, point);
    if (chosen < 0) return -1;
    if (hides && !find_hidden(contact, state, g, chosen, point, s)) return -1;
    if (!(s->before < point->distance - tie_of(contact, contact->list.face[group->first + chosen])))
        s->before = INFINITY;
    s->over = s->over && point->height < 0; /* it is before that already */
    if (s->over) point->height = -point->height;
    contact->last[g] = s->flush ? ~chosen : chosen;
    return contact->list.face[group->first + chosen];
}

/* Which edge of face f two faces share, by its first corner; -1: none. */
static int shared_edge(const lar_contact_face *f, const lar_contact_face *other) {
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++)
            if (f->corner[a] == other->corner[(b + 1) % 4] &&
                f->corner[(a + 1) % 4] == other->corner[b])
                return a;
    return -1;
}

/* How far nodes may move against each other [m] while the node of group g, on a sharp edge, sees
 * face k of a survey, which it is before. */
static double seen_until(const lar_body_contact *contact, const lar_state *state, int32_t g,
                         const lar_survey *s, int32_t k) {
    return s->touch ? lar_looks_on(contact, state, contact->list.group[g].node,
                                   (const double(*)[3])s->corner[k])
                    : INFINITY;
}

/* How far nodes may move against each other [m] while face k of a survey does not say where the
 * node is: for one that is beside it says so. */
static double outdone(const lar_body_contact *contact, const lar_state *state, int32_t g,
                      const lar_survey *s, int32_t k) {
    const int32_t *face = contact->list.face + contact->list.group[g].first;
    const lar_contact_face *all = contact->surface->face, *f = &all[face[s->entry[k]]];
    double until = 0;
    for (int32_t m = 0; m < s->count; m++) {
        if (m == k) continue;
        int edge = shared_edge(f, &all[face[s->entry[m]]]);
        if (edge < 0) continue;
        double before = lar_face_before(s->x, (const double(*)[3])s->corner[m]);
        if (!(before > until)) continue;
        double than = lar_face_outdone(s->x, (const double(*)[3])s->corner[k], edge,
                                       (const double(*)[3])s->corner[m]);
        than = lar_lesser(lar_lesser(before, than), seen_until(contact, state, g, s, m));
        until = lar_greater(until, than);
    }
    return until;
}

/* Half of the way to where it touches the closest face, and no farther than it surely stays before
 * every face that may be the closest one then, or before another one that decides. Before the
 * closest one alone is not enough: a body that is crushed has faces whose back is as near. Of its
 * own body a node does not see all faces, and may come behind one from the side. On a sharp edge it
 * sees a face of another body only until that looks away, as both turn. */
double lar_survey_clear(const lar_body_contact *contact, const lar_state *state, int32_t g,
                        const lar_survey *s, const lar_face_point *point) {
    static const double LASTING = 0.02; /* a quarter of what is usual beside an edge */
    const lar_contact_surface *surface = contact->surface;
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t *face = contact->list.face + group->first;
    double standoff =
        lar_contact_standoff(surface, &surface->node[group->node], &surface->face[face[0]]);
    double clear = 0.5 * (point->distance - standoff);
    /* What does not last until the next step is not worth finding out. */
    double step = LAR_APPROACH * contact->way;
    if (!(clear > step)) return 0;
    bool lasts = LASTING * point->distance > step;
    for (int32_t k = 0; k < s->count; k++)
        if (s->entry[k] == contact->last[g])
            clear = lar_lesser(clear, seen_until(contact, state, g, s, k));
    for (int32_t k = 0; k < s->count && clear > step; k++) {
        int32_t f = face[s->entry[k]];
        double farther = farther_by(s->distance[k], tie_of(contact, f), s);
        if (farther >= clear) continue;
        double before = lar_face_before(s->x, (const double(*)[3])s->corner[k]);
        farther = lar_greater(farther, before);
        if (farther < clear && lasts)
            farther = lar_greater(farther, outdone(contact, state, g, s, k));
        clear = lar_lesser(clear, farther);
    }
    return clear;
}
