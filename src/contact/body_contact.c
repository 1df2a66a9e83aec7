#include "contact/body_contact.h"

#include <math.h>
#include <string.h>

#include "contact/history/body_friction.h"
#include "contact/search/pair_mass.h"
#include "contact/history/flush.h"
#include "contact/tool_body.h"
#include "mechanics/face_contact.h"

/* ---- one group ------------------------------------------------------------------------------ */

typedef struct touching {
    int32_t count;
    int32_t face[LAR_CONTACT_FACES];     /* contact faces, */
    double weight[LAR_CONTACT_FACES][4]; /* and of their corners; all together 1 */
    double far;                          /* how far they are in the mean; 0: one alone counts [m] */
    double force[3];                     /* on the node [N] */
    double depth;                        /* [m] */
    int32_t fading;    /* the face that fades towards its edge, or rubs; -1: none */
    double fade[4][3]; /* forces of that on its corners, the node gets minus them [N] */
    bool rubs;         /* there is friction in `fade`, which is of the one face */
    int32_t border;    /* the face through which the node's edge comes; -1: none */
    double pay[4][3];  /* the same of that */
    int32_t over;      /* the face that it comes past; -1: none */
    double pass[4][3]; /* the same of that */
} touching;

/* ---- one node and one face ------------------------------------------------------------------ */

/* Where the surface is that touches a node, and how that moves. */
typedef struct contact_point {
    double at[3], velocity[3]; /* [m], [m/s] */
    lar_point_mass mass;
} contact_point;

/* A face whose corners have been looked up. */
typedef struct known_face {
    int32_t face;
    double x[4][3], v[4][3]; /* [m], [m/s] */
    lar_corner_masses mass;
} known_face;

static void know_face(const lar_body_contact *contact, const lar_state *state, int32_t node,
                      int32_t face, known_face *known) {
    known->face = face;
    lar_contact_corners(contact, state, face, known->x, known->v);
    lar_corner_masses_of(contact->surface, node, face, contact->held, &known->mass);
}

/* The point of t->count faces with the weights of t that a node meets; one of them may be known. */
static void point_of(const lar_body_contact *contact, const lar_state *state, const touching *t,
                     const known_face *known, int32_t node, bool rigid, contact_point *point) {
    *point = (contact_point){0};
    for (int32_t f = 0; f < t->count; f++) {
        const known_face *of = known;
        known_face other;
        double at[3], velocity[3];
        if (t->face[f] != known->face) {
            know_face(contact, state, node, t->face[f], &other);
            of = &other;
        }
        lar_face_mean((const double(*)[3])of->x, t->weight[f], at);
        lar_face_mean((const double(*)[3])of->v, t->weight[f], velocity);
        for (int i = 0; i < 3; i++) {
            point->at[i] += at[i];
            point->velocity[i] += velocity[i];
        }
        (rigid ? lar_point_mass_ease : lar_point_mass_add)(&of->mass, t->weight[f], &point->mass);
    }
}

/* How much farther than the closest triangle others may be and count; 0: it counts alone [m]. */
static double fade_at(const lar_face_point *closest, const lar_survey *s) {
    /* Beside an edge that is convex as seen from the node the closest point is on the edge, not
     * straight below, and goes its way smoothly. */
    double upright = 1 - 50 * (1 - fabs(closest->height) / closest->distance);
    if (!(upright > 0)) return 0;
    bool behind = closest->height < 0;
    /* Who is out of reach is not in every list. */
    double fade =
        behind ? fmin(LAR_FADE_BEHIND * s->min, s->reach - s->min) : fmin(s->above, 0.5 * s->min);
    return fade * fmin(upright, 1);
}

/* Whether no other triangle of the closest face counts, behind it: with no other face then, the
 * closest point stays what it is, to the last bit, whether others had to be looked at or not. */
static bool alone(const lar_survey *s, const lar_face_point *closest, double fade) {
    return closest->height < 0 && !(closest->next < s->min + fade);
}

static bool others_near(const lar_survey *s, double fade) {
    int32_t count = 0;
    for (int32_t k = 0; k < s->count; k++) count += s->distance[k] < s->min + fade;
    return count > 1;
}

/* Above a hollow, and behind a ridge, the closest point jumps from face to face, and so would the
 * direction of the force: there the faces that are about as close as the closest one push together.
 */
static void blend(const lar_body_contact *contact, int32_t g, const lar_face_point *closest,
                  const lar_survey *s, touching *t) {
    const lar_contact_group *group = &contact->list.group[g];
    const lar_contact_surface *surface = contact->surface;
    double fade = fade_at(closest, s), all = 0;
    bool lone = alone(s, closest, fade);
    if (!(fade > 0) || (lone && !others_near(s, fade))) return;
    touching blended = {.fading = -1, .border = -1, .over = -1};
    for (int32_t k = 0; k < s->count; k++) {
        int32_t f = contact->list.face[group->first + s->entry[k]];
        double sum[4] = {0}, far = 0;
        if (!(s->distance[k] < s->min + fade) ||
            !lar_contact_active(&surface->node[group->node], &surface->face[f]))
            continue;
        double counts =
            lar_face_blend(s->x, (const double(*)[3])s->corner[k], s->min, fade, sum, &far);
        if (!(counts > 0) || blended.count == LAR_CONTACT_FACES) continue;
        all += counts;
        blended.far += far;
        blended.face[blended.count] = f;
        memcpy(blended.weight[blended.count++], sum, sizeof sum);
    }
    if (!(all > 0)) return;
    if (lone && blended.count == 1 && blended.face[0] == t->face[0]) return;
    for (int32_t f = 0; f < blended.count; f++)
        for (int a = 0; a < 4; a++) blended.weight[f][a] /= all;
    blended.far /= all;
    *t = blended;
}

/* The way out of the body for a node, of unit length, and how deep it is (negative: how far above).
 * Too close to the surface for a direction of its own it takes that of the face; NAN: there is none
 * either. */
static double outward(const double x[3], const contact_point *point, double sign, double tie,
                      const double corner[4][3], double way[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++) square += (point->at[i] - x[i]) * (point->at[i] - x[i]);
    double depth = sqrt(square);
    if (depth > tie) {
        for (int i = 0; i < 3; i++) way[i] = sign * (point->at[i] - x[i]) / depth;
        return sign * depth;
    }
    lar_face_normal(corner, way);
    double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    if (!(length > 0)) return NAN;
    for (int i = 0; i < 3; i++) way[i] /= length;
    return sign * depth;
}

/* What several walls push together is the mean of their forces: as much as one pushes from their
 * mean distance, times what is returned. Opposite ones, of a crevice or a fold that is pressed
 * flat, have a mean point that is closer to the node than any of them, or is the node itself: by
 * its distance they would push as if touched. */
static double push_together(const touching *t, double tie, double *depth) {
    if (!(t->far > tie)) return 1;
    double share = fabs(*depth) / t->far;
    *depth = copysign(t->far, *depth);
    return share;
}

/* What pushes a node is two springs of the same law, one behind the other. */
typedef struct spring {
    double mass;  /* which it counts its node with: its stiffness [kg] */
    double depth; /* how far it is pressed in [m] */
} spring;

/* The one acts from the contact distance on, the other, which is all that is left of the stiffness,
 * behind the face. */
static void springs_of(const lar_body_contact *contact, int32_t node, int32_t face, double mass,
                       double hard, double depth, double offset, spring two[2]) {
    const lar_contact_surface *s = contact->surface;
    double standoff = lar_contact_standoff(s, &s->node[node], &s->face[face]);
    double part = lar_contact_softness(s, node, face, standoff, hard * contact->law.stiffness);
    two[0] = (spring){part * hard * mass, depth + (standoff - offset)};
    two[1] = (spring){(1 - part) * hard * mass, depth};
}

/* How far a spring is pressed in where a sharp edge pushes like any other place [m]. */
static double full_of(const lar_body_contact *contact, int32_t node, int32_t face) {
    static const double MIN = 0.25; /* of the reach */
    const lar_contact_surface *s = contact->surface;
    double reach = lar_contact_reach(s, &s->node[node], &s->face[face]);
    return fmax(lar_contact_standoff(s, &s->node[node], &s->face[face]), MIN * reach);
}

/* The part of five forces that is no larger than `max`: of a face that is crushed slopes have no
 * bound. */
__attribute__((noinline)) static double within_force(double max, const double force[5][3]) {
    double largest = 0;
    for (int a = 0; a < 5; a++) {
        double square = 0;
        for (int i = 0; i < 3; i++) square += force[a][i] * force[a][i];
        largest = fmax(largest, square);
    }
    largest = sqrt(largest);
    return largest <= max ? 1 : max / largest;
}

/* Towards sharp edges springs fade, and the slope of what they store is a force of its own. Adds
 * what they store to *energy [J]. */
static double fade(const lar_body_contact *contact, const double x[3], const known_face *known,
                   const lar_face_point *closest, double full, const spring two[2], double rate,
                   double *energy, touching *t) {
    const lar_contact_face *f = &contact->surface->face[known->face];
    double blunt[4], change[5], slope[5][3], stored;
    for (int a = 0; a < 4; a++) blunt[a] = contact->surface->node[f->corner[a]].blunt;
    double part = lar_face_firmness(closest->weight, blunt, change);
    double all = 0, late = 0, more = 0;
    for (int i = 0; i < 2 && two[i].mass > 0; i++) {
        double force = lar_contact_force(&contact->law, two[i].mass, two[i].depth, rate);
        late +=
            lar_contact_late_force(&contact->law, two[i].mass, full, two[i].depth, rate, &stored);
        all += force;
        more += 0.5 * force * two[i].depth - stored;
        *energy += stored;
    }
    *energy += part * more;
    lar_face_slope(x, (const double(*)[3])known->x, closest, change, slope);
    for (int a = 0; a < 5; a++)
        for (int i = 0; i < 3; i++) slope[a][i] *= -more;
    double within = within_force(fmax(all, late), (const double(*)[3])slope);
    t->fading = known->face;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) t->fade[a][i] = within * slope[a][i];
    return part * all + (1 - part) * late;
}

/* A node and the face that pushes it. */
typedef struct meeting {
    const double *x; /* [m] */
    const known_face *known;
    const lar_face_point *closest;
    double full, rate; /* [m], [m/s] */
    bool fades;        /* towards its edge */
} meeting;

/* What both springs push with; adds what they store to *energy [J]. */
static double press(const lar_body_contact *contact, const meeting *m, const spring two[2],
                    double *energy, touching *t) {
    if (m->fades)
        return fade(contact, m->x, m->known, m->closest, m->full, two, m->rate, energy, t);
    double force = 0;
    for (int i = 0; i < 2; i++) {
        double one = lar_contact_force(&contact->law, two[i].mass, two[i].depth, m->rate);
        force += one;
        *energy += 0.5 * one * two[i].depth;
    }
    return force;
}

/* Where the node's edge comes in through another face, the border: on that it is as if it were
 * before the face that it is behind, and the force, which is returned, goes over to what it is
 * behind. What is stored on the way is paid at the border. */
__attribute__((noinline, cold)) static double come_in(const lar_body_contact *contact, int32_t g,
                                                      const lar_survey *s, const meeting *m,
                                                      const spring two[2], double *energy,
                                                      double together, double force, touching *t) {
    const spring over[2] = {{two[0].mass, two[0].depth - 2 * two[1].depth}};
    meeting back = *m;
    touching there = {0};
    double stored = 0;
    back.rate = -m->rate;
    const double up = press(contact, &back, over, &stored, &there);
    double part = lar_edge_part(s, together * (*energy - stored), t->pay);
    *energy = part * *energy + (1 - part) * stored;
    t->border = contact->list.face[contact->list.group[g].first + s->entry[s->border]];
    for (int i = 0; i < 12; i++)
        t->fade[i / 3][i % 3] =
            part * t->fade[i / 3][i % 3] + (1 - part) * there.fade[i / 3][i % 3];
    return part * force - (1 - part) * up;
}

/* Where the node comes past a face that it does not see, and what is stored is paid there, and at
 * the edge of the face that it does see. */
__attribute__((noinline, cold)) static double come_past(const lar_body_contact *contact, int32_t g,
                                                        const lar_survey *s, const meeting *m,
                                                        const lar_rim *rim, double together,
                                                        double energy, double force, touching *t) {
    double part = lar_edge_over(s, together * energy, t->pass), on[4][3] = {{0}};
    t->over = contact->list.face[contact->list.group[g].first + s->entry[s->hidden]];
    if (s->hides.rim > 0) {
        lar_rim_forces(rim, m->closest, s->hides.rim * lar_edge_slope(s, energy), on);
        t->fading = m->known->face;
    }
    for (int i = 0; i < 12; i++) {
        t->fade[i / 3][i % 3] = part * t->fade[i / 3][i % 3] + on[i / 3][i % 3];
        t->pay[i / 3][i % 3] *= part;
    }
    return part * force + lar_edge_slope(s, energy) * s->hides.lift;
}

/* Springs of nodes are harder there, and ask for parts of steps; what goes out is pushed less. */
static double press_deep(lar_body_contact *contact, int32_t node, int32_t face, double mass,
                         double depth, double rate, double force, double *energy) {
    const lar_contact_surface *s = contact->surface;
    const lar_contact_law *law = &contact->law;
    const lar_contact_body *body[] = {&s->body[s->node[node].body], &s->body[s->face[face].body]};
    const double layer = fmin(body[0]->reach[1], body[1]->reach[1]);
    if (node >= s->node_count) return lar_contact_let_go(law, layer, depth, rate) * force;
    const double soon = fmin(depth + LAR_INTERVAL_MAX * law->lead * rate, layer);
    contact->need = fmax(contact->need, lar_contact_deep_need(law, layer, fmax(depth, soon)));
    return lar_contact_let_go(law, layer, depth - layer / 3, rate) * force +
           lar_contact_let_go(law, layer, depth, rate) *
               lar_contact_deep_force(law, contact->time_step, mass, layer, depth, rate, energy);
}

/* The point that pushes moves from an edge to below a node that is past it. */
__attribute__((noinline, cold)) static bool shift(touching *t, int32_t face, const lar_rim *rim) {
    for (int32_t f = 0; f < t->count; f++) {
        if (t->face[f] != face) continue;
        for (int a = 0; a < 4; a++) t->weight[f][a] += rim->shift[a];
        return true;
    }
    return false;
}

/* There is less of the force the farther the node is past the edge, and what it stores there it
 * gives back along the way. */
__attribute__((noinline, cold)) static double slide_off(const lar_rim *rim,
                                                        const lar_face_point *closest, int32_t face,
                                                        double energy, double force, touching *t) {
    const double left = lar_flush_left(rim, closest, energy, t->pay);
    t->border = face;
    for (int i = 0; i < 12; i++) t->fade[i / 3][i % 3] *= left;
    return left * force;
}

/* Points deeper than that are not pushed any more (lar_offset_pushes), and store what they did
 * there. Who has come past a border or a hidden face pays there for that: or it would come from
 * nowhere where the point comes back up. */
static bool is_spent(const lar_body_contact *contact, int32_t node, const lar_survey *s,
                     double depth) {
    return node >= contact->surface->node_count && (s->border >= 0 || s->hidden >= 0) &&
           depth > s->within;
}

/* The force on the node of group g by a face which it is behind, or before it by less than the
 * contact distance. False: they do not touch, or no longer push. */
static bool push(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t face,
                 const lar_face_point *closest, const lar_survey *s, const lar_rim *rim,
                 touching *t) {
    const lar_contact_surface *surface = contact->surface;
    const lar_contact_face *f = &surface->face[face];
    int32_t node = contact->list.group[g].node;
    double x[3], v[3], way[3], rate = 0;
    contact_point point;
    known_face known;
    lar_contact_place(contact, state, node, x, v);
    know_face(contact, state, node, face, &known);
    *t = (touching){.count = 1, .face = {face}, .fading = -1, .border = -1, .over = -1};
    memcpy(t->weight[0], closest->weight, sizeof closest->weight);
    bool before = !(closest->height < 0), own = lar_same_body(contact, node, face);
    if ((before || !own) && lar_contact_active(&surface->node[node], f))
        blend(contact, g, closest, s, t);
    const bool past = rim->part > 0 && shift(t, face, rim);
    const lar_contact_node *own_node = &surface->node[node], *corner = &surface->node[f->corner[0]];
    const bool rigid = !own && lar_contact_of_rigid(surface, own_node, f, contact->held);
    point_of(contact, state, t, &known, node, rigid, &point);
    double depth = outward(x, &point, before ? -1 : 1, LAR_FACE_TIE * f->size,
                           (const double(*)[3])known.x, way);
    if (isnan(depth)) return false; /* without a length there is no direction */
    double together = push_together(t, LAR_FACE_TIE * f->size, &depth);
    for (int i = 0; i < 3; i++) rate += together * (point.velocity[i] - v[i]) * way[i];
    const bool spent = is_spent(contact, node, s, depth);
    if (spent) depth = s->within;
    double offset = own ? lar_offset_follow(contact, state, node, face, depth, rate) : 0;
    if (!own && !lar_offset_pushes(contact, state, g, face, s, depth, rate)) return false;
    if (!lar_contact_active(&surface->node[node], f)) return false;
    double moved = lar_contact_moved_mass(own_node, corner, contact->held, &point.mass);
    spring two[2];
    const double hard = rigid ? contact->rigid : 1;
    springs_of(contact, node, face, moved, hard, depth, offset, two);
    const meeting m = {
        x, &known, closest, full_of(contact, node, face), rate, f->fades && !own && !s->flush};
    double energy = 0, force = press(contact, &m, two, &energy, t);
    if (!own) force = press_deep(contact, node, face, moved, depth, rate, force, &energy);
    const lar_pair_press pressed = {x, (const double(*)[3])known.x, closest, energy, fabs(force)};
    if (rigid && lar_pair_slope(own_node, &known.mass, &point.mass, moved, &pressed, t->fade))
        t->fading = face;
    if (spent) memset(t->fade, 0, sizeof t->fade);
    if (spent) force = 0;
    if (s->border >= 0) force = come_in(contact, g, s, &m, two, &energy, together, force, t);
    if (s->hidden >= 0)
        force = come_past(contact, g, s, &m, rim, together, energy, force, t);
    else if (past)
        force = slide_off(rim, closest, face, together * energy, force, t);
    t->depth = fmax(depth, 0);
    for (int i = 0; i < 3; i++) {
        t->force[i] = together * force * way[i];
        for (int a = 0; a < 4; a++) t->fade[a][i] *= together;
    }
    if (!contact->friction) return true;
    const lar_rub rub = {.node = node,
                         .face = face,
                         .x = x,
                         .v = v,
                         .way = way,
                         .corner = (const double(*)[3])known.x,
                         .speed = (const double(*)[3])known.v,
                         .weight = closest->weight,
                         .press = together * fmax(force, 0),
                         .mass = hard * lar_contact_rub_mass(own_node, corner, moved)};
    if (!lar_body_friction_rub(contact, state, &rub, t->fade)) return true;
    t->rubs = t->fading < 0 && t->count == 1 && t->face[0] == face;
    if (!t->rubs) t->fading = face;
    return true;
}

/* Past the edge of a body whose sides it does not see (*rim; part 0: not) it may be beside it. */
static bool touches(const lar_body_contact *contact, const lar_state *state, int32_t node,
                    int32_t face, const lar_survey *s, const lar_face_point *point, lar_rim *rim) {
    const lar_contact_surface *surface = contact->surface;
    double away = point->distance;
    rim->part = 0;
    if (s->hidden >= 0 && s->hides.behind <= -s->within) return false;
    if (s->hidden >= 0 && s->hides.past > 0) {
        double corner[4][3];
        lar_face_point as_is = *point;
        if (s->over) as_is.height = -as_is.height;
        lar_contact_corners(contact, state, face, corner, NULL);
        if (!lar_rim_foot(s->x, (const double(*)[3])corner, &as_is, rim)) return false;
        rim->part = 1;
    }
    if (s->flush && !lar_flush_is_straight(point)) {
        double corner[4][3];
        lar_contact_corners(contact, state, face, corner, NULL);
        if (lar_flush_past(surface, node, face, s->x, (const double(*)[3])corner, point, rim)) {
            if (!(rim->part < 1)) return false;
            away = fabs(point->height);
        } else {
            rim->part = 0;
            if (lar_flush_is_beside(point)) return false;
        }
    }
    return point->height < 0 ||
           away < lar_contact_standoff(surface, &surface->node[node], &surface->face[face]);
}

/* Contact of group g. */
static bool in_contact(lar_body_contact *contact, const lar_state *state, int32_t g, touching *t) {
    const lar_contact_surface *surface = contact->surface;
    const lar_contact_group *group = &contact->list.group[g];
    lar_face_point point;
    lar_survey s;
    lar_rim rim;
    int32_t face = lar_survey_closest(contact, state, g, &s, &point);
    if (s.flush && group->node < surface->node_count)
        lar_offset_lose_flush(contact, state, group->node, lar_group_first(&contact->list, g));
    if (face >= 0 && touches(contact, state, group->node, face, &s, &point, &rim))
        return push(contact, state, g, face, &point, &s, &rim, t);
    if (lar_group_is_own(contact->surface, &contact->list, group)) {
        lar_offset_leave(contact, state, group->node, face);
        return false;
    }
    const bool past = s.before < INFINITY;
    const double standoff = lar_contact_standoff(surface, &surface->node[group->node],
                                                 &surface->face[contact->list.face[group->first]]);
    if (!(s.before < standoff))
        lar_offset_out(contact, state, g, face < 0 && !past ? s.gap : INFINITY);
    if (s.flush) {
        lar_offset_stay_flush(contact, state, g, face, &point);
    } else if (face >= 0) {
        double clear = lar_offset_meet(contact, state, g, face, &point);
        if (!(s.gap > -INFINITY) || past) return false;
        /* Past an edge it touches the plane of the face. */
        if (s.hidden >= 0) clear = fmin(clear, 0.25 * (point.height - standoff));
        clear = 0.999 * fmin(clear, lar_survey_clear(contact, state, g, &s, &point)) / LAR_APPROACH;
        if (clear > 0)
            contact->due[g] = fmax(contact->due[g], fmin(contact->travel + clear, s.next));
    }
    return false;
}

/* ---- forces --------------------------------------------------------------------------------- */

/* Adds a force, and notes it for its work. */
static void add_part(lar_body_contact_part *part, lar_state *state, int32_t node,
                     const int64_t sum[3], double scale) {
    part->node[part->count] = node;
    for (int i = 0; i < 3; i++) {
        state->force[lar_state_at(state, node, i)] += sum[i];
        part->force[part->count][i] = -(double)sum[i] / scale;
    }
    part->count++;
}

/* To the node, or to both ends of the edge, or the corners of the face, that the point is on. */
static void add_to_node(lar_body_contact *contact, const lar_condition_context *context,
                        lar_state *state, int32_t node, const int64_t sum[3],
                        lar_body_contact_part *part) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int64_t share[LAR_CONTACT_PARENTS][3];
    int count = lar_contact_parents(contact->surface, node, parent, weight);
    for (int i = 0; i < 3; i++) {
        share[0][i] = sum[i];
        for (int k = 1; k < count; k++) {
            share[k][i] = llrint(weight[k] * (double)sum[i]);
            share[0][i] -= share[k][i];
        }
    }
    for (int k = 0; k < count; k++)
        if (!contact->adds_node || contact->adds_node[parent[k]])
            add_part(part, state, contact->view.local[parent[k]], share[k], context->scale);
}

static void add_to_face(lar_body_contact *contact, const lar_condition_context *context,
                        lar_state *state, int32_t face, int64_t (*force)[3],
                        lar_body_contact_part *part) {
    if (contact->adds_corner && !contact->adds_corner[face]) return;
    for (int a = 0; a < 4; a++)
        add_part(part, state, contact->view.local[contact->surface->face[face].corner[a]], force[a],
                 context->scale);
}

static const double MAX = 0x1p58; /* of a force in force units */

/* What a border pays, in whole units. False: beyond all reason. */
__attribute__((noinline, cold)) static bool round_pay(const double paid[4][3], double scale,
                                                      int64_t pay[4][3], int64_t sum[3]) {
    for (int i = 0; i < 12; i++) {
        double along = paid[i / 3][i % 3] * scale;
        if (!(fabs(along) < MAX)) return false;
        pay[i / 3][i % 3] = -llrint(along);
        sum[i % 3] -= pay[i / 3][i % 3];
    }
    return true;
}

/* Force sums are internal minus external forces. Who adds only some of the parts rounds the same
 * numbers as who adds the others. */
static void add_forces(lar_body_contact *contact, const lar_condition_context *context,
                       lar_state *state, int32_t node, const touching *t) {
    lar_body_contact_part *part = &contact->part[contact->part_count];
    int64_t corner[4 * LAR_CONTACT_FACES][3], slope[4][3] = {{0}}, pay[4][3], pass[4][3],
                                              sum[3] = {0};
    for (int i = 0; i < 3; i++) {
        double force = t->force[i] * context->scale;
        /* Beyond all reason: the speeds that make such a force stop the run. */
        if (!(fabs(force) < MAX)) return;
        for (int a = 0; a < 4 * t->count; a++) {
            double along = t->rubs ? t->fade[a][i] * context->scale : 0;
            corner[a][i] = llrint(t->weight[a / 4][a % 4] * force - along);
            sum[i] -= corner[a][i];
        }
        for (int a = 0; a < 4 && t->fading >= 0; a++) {
            double along = t->fade[a][i] * context->scale;
            if (!(fabs(along) < MAX)) return;
            slope[a][i] = -llrint(along);
            sum[i] -= slope[a][i];
        }
    }
    if (t->border >= 0 && !round_pay(t->pay, context->scale, pay, sum)) return;
    if (t->over >= 0 && !round_pay(t->pass, context->scale, pass, sum)) return;
    part->count = 0;
    add_to_node(contact, context, state, node, sum, part);
    for (int32_t f = 0; f < t->count; f++)
        add_to_face(contact, context, state, t->face[f], &corner[4 * f], part);
    if (t->fading >= 0) add_to_face(contact, context, state, t->fading, slope, part);
    if (t->border >= 0) add_to_face(contact, context, state, t->border, pay, part);
    if (t->over >= 0) add_to_face(contact, context, state, t->over, pass, part);
    if (part->count) contact->part_count++;
}

/* The groups that are due within the next part of the way that the list is good for. */
static void look_ahead(lar_body_contact *contact) {
    enum { PARTS = 16 };
    contact->horizon = contact->travel + 0.5 * contact->list.skin / PARTS;
    contact->near_count = 0;
    for (int32_t g = 0; g < contact->list.group_count; g++)
        if (!(contact->due[g] > contact->horizon) || lar_offset_was_flush(contact, g))
            contact->near[contact->near_count++] = g;
}

void lar_body_contact_add(lar_body_contact *contact, const lar_condition_context *context,
                          lar_state *state) {
    contact->time_step = context->time_step; /* of a part, where steps are divided */
    contact->held = context->held;
    contact->part_count = contact->offset_count = 0;
    if (contact->friction) lar_body_friction_begin(contact->friction);
    contact->info.touching = 0;
    contact->info.deepest_ever = fmax(contact->info.deepest_ever, contact->info.deepest);
    contact->info.deepest = 0;
    if (contact->fresh) lar_body_contact_end_offsets(contact, state);
    if (!(contact->travel < contact->horizon)) look_ahead(contact);
    for (int32_t i = 0; i < contact->near_count; i++) {
        int32_t g = contact->near[i], node = contact->list.group[g].node;
        touching t;
        if (contact->travel < contact->due[g] && !lar_offset_flush_again(contact, state, g))
            continue;
        if (!in_contact(contact, state, g, &t)) continue;
        add_forces(contact, context, state, node, &t);
        /* Each node is counted once, by who adds its force. */
        if (node >= contact->surface->node_count) continue;
        bool own = !contact->adds_node || contact->adds_node[node];
        contact->info.touching += own;
        if (own) contact->info.deepest = fmax(contact->info.deepest, t.depth);
    }
}
