/* What nodes remember of lying in a body (body_contact.h, Offsets). */
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "contact/body_contact.h"
#include "contact/history/flush.h"
#include "mechanics/face_contact.h"

static double offset_of(const lar_body_contact *contact, const lar_state *state, int32_t node) {
    const lar_contact_view *view = &contact->view;
    return fabs(view->place ? view->place[view->slot[node]][6] : state->level[view->local[node]]);
}

/* Notes the offset that the node will have when it moves. */
static void set_offset(lar_body_contact *contact, const lar_state *state, int32_t node,
                       double offset) {
    if (offset == offset_of(contact, state, node) || (contact->keeps && !contact->keeps[node]))
        return;
    contact->offset[contact->offset_count++] =
        (lar_penetration_offset){contact->view.local[node], offset};
}

/* Who is so deep when it appears behind a face belongs inside. */
static double deep_of(const lar_body_contact *contact, int32_t node, int32_t face) {
    const lar_contact_surface *s = contact->surface;
    return 0.25 * lar_contact_reach(s, &s->node[node], &s->face[face]);
}

/* The node goes through faces that should keep it out: only counted. */
static void count_through(lar_body_contact *contact, int32_t node) {
    if (node < contact->surface->node_count && (!contact->adds_node || contact->adds_node[node]))
        contact->info.through++;
}

/* ---- its own body ---------------------------------------------------------------------------- */

double lar_offset_follow(lar_body_contact *contact, const lar_state *state, int32_t node,
                         int32_t face, double depth, double rate) {
    double before = offset_of(contact, state, node), offset = depth;
    double deep = deep_of(contact, node, face);
    bool returning = before == LAR_OFFSET_OUT || before == LAR_OFFSET_RETURN;
    if (returning)
        offset = LAR_OFFSET_RETURN;
    else if (depth <= contact->time_step * rate)
        offset = LAR_OFFSET_FRONT;
    else if (before > 0 && (before < depth || before >= deep))
        offset = before;
    if (!lar_offset_is_behind(before)) set_offset(contact, state, node, offset);
    return returning ? depth : offset;
}

void lar_offset_leave(lar_body_contact *contact, const lar_state *state, int32_t node,
                      int32_t face) {
    double before = offset_of(contact, state, node), offset = 0;
    if (lar_offset_is_behind(before)) return;
    if (before == LAR_OFFSET_FRONT && face < 0) count_through(contact, node);
    bool inside =
        before == LAR_OFFSET_RETURN || (face >= 0 && before >= deep_of(contact, node, face));
    if (before == LAR_OFFSET_OUT || (face >= 0 && inside)) offset = LAR_OFFSET_OUT;
    set_offset(contact, state, node, offset);
}

/* ---- flush bodies ---------------------------------------------------------------------------- */

static bool has_parted(const lar_body_contact *contact, const lar_state *state, int32_t node) {
    const lar_contact_view *view = &contact->view;
    return signbit(view->place ? view->place[view->slot[node]][6]
                               : state->level[view->local[node]]);
}

bool lar_offset_is_flush(const lar_body_contact *contact, const lar_state *state, int32_t g) {
    const lar_contact_group *group = &contact->list.group[g];
    const lar_contact_surface *s = contact->surface;
    const int32_t node = group->node;
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    if (!lar_flush_at_rest(s, node, s->face[contact->list.face[group->first]].body)) return false;
    int count = lar_contact_parents(s, node, parent, weight);
    for (int k = 0; k < count; k++)
        if (has_parted(contact, state, parent[k])) return false;
    return true;
}

void lar_offset_part(lar_body_contact *contact, int32_t node) {
    if (contact->keeps && !contact->keeps[node]) return;
    contact->offset[contact->offset_count++] =
        (lar_penetration_offset){contact->view.local[node], LAR_OFFSET_PARTED};
}

static bool is_straight(const lar_face_point *point) {
    static const double STRAIGHT = 0.9; /* cosine */
    return fabs(point->height) > STRAIGHT * point->distance;
}

/* Who was flush with one body. What it remembers is for all together, so who was with two does not
 * meet one of them again. */
static bool may_meet(const lar_body_contact *contact, const lar_state *state, int32_t g) {
    const lar_contact_surface *s = contact->surface;
    const lar_contact_group *group = &contact->list.group[g];
    int32_t at = 0, body = -1;
    return group->node < s->node_count && has_parted(contact, state, group->node) &&
           lar_flush_next_body(s, group->node, &at, &body) &&
           body == s->face[contact->list.face[group->first]].body &&
           !lar_flush_next_body(s, group->node, &at, &body);
}

/* Who is nearer to a face has not parted from its body. Bodies that began apart push each other
 * before they touch. */
static double near_of(const lar_contact_surface *s, int32_t node, int32_t face) {
    return lar_contact_standoff(s, &s->node[node], &s->face[face]) +
           LAR_FLUSH_NEAR * s->face[face].size;
}

double lar_offset_meet(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t face,
                       const lar_face_point *closest) {
    const lar_contact_surface *s = contact->surface;
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t *faces = contact->list.face + group->first;
    double most = 0;
    if (!may_meet(contact, state, g)) return INFINITY;
    for (int32_t i = 0; i < group->count; i++) most = fmax(most, near_of(s, group->node, faces[i]));
    /* Who is out of reach is not looked at in every step. */
    const double reach = lar_contact_reach(s, &s->node[group->node], &s->face[face]);
    if (closest->height > 0 && is_straight(closest) && closest->distance < reach &&
        closest->distance < near_of(s, group->node, face) &&
        !lar_flush_hides(s, group->node, face) && (!contact->keeps || contact->keeps[group->node]))
        contact->offset[contact->offset_count++] =
            (lar_penetration_offset){contact->view.local[group->node], LAR_OFFSET_MET};
    return fmax(0, closest->distance - most);
}

/* ---- sharp edges ----------------------------------------------------------------------------- */

/* Cosines of a face's normal with the ways from an edge into its body: a face that looks away has
 * none above the one, and one below the other. */
static const double AGAINST = 0.3, AWAY = -0.7;

double lar_looks_away(const lar_body_contact *contact, const lar_state *state, int32_t node,
                      const double corner[4][3], lar_edge_way *through) {
    static const double SURE = 0.1, CLEAR = 0.15; /* cosines */
    const lar_contact_surface *s = contact->surface;
    const lar_contact_node *at = &s->node[node];
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS], from[3], to[3], way[3], least = 1, most = -1;
    lar_edge_way edge = {.sure = 1};
    lar_contact_parents(s, node, parent, weight);
    lar_contact_place_of_node(contact, state, parent[0], from, NULL);
    lar_face_normal(corner, way);
    for (int k = 0; k < 3 && at->inward[k] >= 0; k++) {
        lar_contact_place_of_node(contact, state, at->inward[k], to, NULL);
        lar_minus(to, from, to);
        double deep = lar_dot(way, to) / lar_length(way), cosine = deep / lar_length(to);
        if (k == at->along) {
            /* Of a point: whether the edge ends at its node behind the face. */
            const bool ends = node >= s->node_count && s->node[parent[!(cosine > 0)]].along == 3;
            edge.sure = lar_ease((AGAINST - fabs(cosine)) / SURE);
            if (!(fabs(cosine) > AGAINST)) continue;
            edge.deeper = fabs(cosine) > -AWAY && !ends ? fabs(deep) : -1;
            edge.sure = lar_ease((fabs(cosine) + AWAY) / SURE);
            continue;
        }
        if (!through && cosine > AGAINST) return -1;
        least = fmin(least, cosine);
        most = fmax(most, cosine);
    }
    if (least < -AGAINST && !(edge.deeper > 0)) edge.deeper = -1;
    if (through) *through = edge;
    if (!(least < AWAY) || most > AGAINST) return -1;
    return lar_ease((AWAY - least) / CLEAR) * lar_ease((AGAINST - most) / CLEAR);
}

double lar_looks_on(const lar_body_contact *contact, const lar_state *state, int32_t node,
                    const double corner[4][3]) {
    static const double ROUND = 0.5; /* cosines do not change evenly */
    const lar_contact_node *at = &contact->surface->node[node];
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS], from[3], to[3], way[3], across[2][3];
    double against = -INFINITY, away = INFINITY, shortest = INFINITY;
    lar_contact_parents(contact->surface, node, parent, weight);
    lar_contact_place_of_node(contact, state, parent[0], from, NULL);
    lar_face_normal(corner, way);
    for (int k = 0; k < 2; k++) lar_minus(corner[2 + k], corner[k], across[k]);
    const double turns = (lar_length(across[0]) + lar_length(across[1])) / lar_length(way);
    for (int k = 0; k < 3 && at->inward[k] >= 0; k++) {
        if (k == at->along) continue;
        lar_contact_place_of_node(contact, state, at->inward[k], to, NULL);
        lar_minus(to, from, to);
        const double length = lar_length(to),
                     cosine = lar_dot(way, to) / (lar_length(way) * length);
        against = fmax(against, cosine - AGAINST);
        away = fmin(away, cosine - AWAY);
        shortest = fmin(shortest, length);
    }
    const double until = ROUND * fmin(fmax(against, away), 1) / (1 / shortest + turns);
    return until > 0 ? until : 0; /* NAN: of what is crushed nothing is known */
}

/* How far within a body's edges a point of one of its faces is; INFINITY: it has none [m]. */
static double within_edges(const lar_contact_surface *s, int32_t f, const double corner[4][3],
                           const lar_face_point *point) {
    static const double SHARP = 0.5;
    const int32_t *nodes = s->face[f].corner;
    double at[3], along[3], from[3], away[3], least = INFINITY;
    lar_face_mean(corner, point->weight, at);
    for (int a = 0; a < 4; a++) {
        const int next = (a + 1) % 4;
        if (!(fmax(s->node[nodes[a]].blunt, s->node[nodes[next]].blunt) < SHARP)) continue;
        lar_minus(corner[next], corner[a], along);
        lar_minus(at, corner[a], from);
        lar_cross(along, from, away);
        least = fmin(least, lar_length(away) / lar_length(along));
    }
    return least;
}

/* Whether face f stands against the one with that normal, which the node at x is straight behind by
 * `-height`, `within` of the edges of. Who is out of reach is not in every list. */
static lar_joint joint_with(const lar_body_contact *contact, const lar_state *state, int32_t node,
                            int32_t f, const double x[3], const double normal[3], double height,
                            double within) {
    static const double NEAR = 0.02;   /* of a face */
    static const double FACING = -0.9; /* cosine */
    const double size = contact->surface->face[f].size, near = NEAR * size;
    double corner[4][3], way[3];
    lar_face_point point;
    lar_contact_corners(contact, state, f, corner, NULL);
    const double reach = lar_contact_reach(contact->surface, &contact->surface->node[node],
                                           &contact->surface->face[f]);
    if (lar_face_box_distance(x, (const double(*)[3])corner) > fmin(near + fabs(height), reach))
        return LAR_JOINT_NONE;
    lar_face_closest(x, (const double(*)[3])corner, LAR_FACE_TIE * size, &point);
    if (!is_straight(&point) || point.distance > reach || fabs(point.height + height) > near)
        return LAR_JOINT_NONE;
    lar_face_normal((const double(*)[3])corner, way);
    if (!(lar_dot(way, normal) < FACING * lar_length(way) * lar_length(normal)))
        return LAR_JOINT_NONE;
    /* Where the one goes on beyond the other's edge, its side is in the way. */
    const double other = within_edges(contact->surface, f, (const double(*)[3])corner, &point);
    if (!(fabs(other - within) < LAR_JOINT_STEP * size)) return LAR_JOINT_NONE;
    return point.height < 0 ? LAR_JOINT_AHEAD : LAR_JOINT_PASSED;
}

lar_joint lar_joint_of(const lar_body_contact *contact, const lar_state *state, int32_t g,
                       int32_t face, const double x[3], const double corner[4][3],
                       const lar_face_point *point, double *within) {
    const lar_contact_list *list = &contact->list;
    const int32_t node = list->group[g].node;
    lar_joint joint = LAR_JOINT_NONE;
    double normal[3];
    int32_t h = lar_group_first(list, g);
    if (!is_straight(point)) return LAR_JOINT_NONE;
    lar_face_normal(corner, normal);
    *within = within_edges(contact->surface, face, corner, point);
    for (; h < list->group_count && list->group[h].node == node; h++) {
        const lar_contact_group *third = &list->group[h];
        if (h == g || lar_group_is_own(contact->surface, list, third)) continue;
        for (int32_t i = third->first; i < third->first + third->count && !joint; i++)
            joint =
                joint_with(contact, state, node, list->face[i], x, normal, point->height, *within);
    }
    return joint;
}

/* How sure it is that the edge lies along what the node is behind: along the closest face, and
 * along others the more, the closer they are to being that. */
static double lies_along(const lar_survey *s, const lar_edge_way *way, double least, double turns) {
    double sure = 1;
    for (int32_t k = 0; k < s->count; k++)
        if (way[k].deeper == 0 && s->distance[k] < s->across && s->point[k].height < 0)
            sure *= 1 - (1 - way[k].sure) * lar_ease(1 - (s->distance[k] - least) / turns);
    return sure;
}

void lar_edge_enters(const lar_body_contact *contact, const lar_state *state, int32_t g,
                     lar_survey *s) {
    static const double TURNS = 0.5;
    lar_edge_way way[LAR_GROUP_FACES_MAX];
    double least = s->across - s->fade, longest = 0, other = s->within;
    bool lies = false;
    s->inset = s->across;
    for (int32_t k = 0; k < s->count; k++) {
        const bool near = s->distance[k] < s->across;
        const bool behind = near && s->point[k].height < 0;
        way[k] = (lar_edge_way){.deeper = -1};
        if (behind || (near && s->above > 0))
            lar_looks_away(contact, state, contact->list.group[g].node,
                           (const double(*)[3])s->corner[k], &way[k]);
        const bool through = way[k].deeper > 0, along = behind && way[k].deeper == 0;
        if (near && !through && !along) other = fmin(other, s->distance[k]);
        if (!through && s->distance[k] < least) {
            least = s->distance[k];
            lies = along;
        }
        if (through && s->distance[k] < s->inset) {
            s->inset = s->distance[k];
            s->border = k;
            longest = way[k].deeper;
        }
    }
    if (!lies || !(least < longest)) s->border = -1;
    if (s->border < 0) return;
    const double turns = TURNS * (s->within - least);
    s->lies =
        lar_ease((other - least) / turns) * lies_along(s, way, least, turns) * way[s->border].sure;
    s->min = least;
    for (int32_t k = 0; k < s->count; k++) {
        if (way[k].deeper > 0) s->distance[k] = INFINITY;
        if (way[k].deeper > 0 && k != s->border) s->point[k].distance = INFINITY;
    }
    if (s->point[s->border].height < 0) return;
    s->point[s->border].distance = INFINITY;
    s->border = -1; /* it is before that still */
    s->over = true;
    s->gap = -INFINITY;
}

double lar_edge_part(const lar_survey *s, double energy, double on[4][3]) {
    const double *weight = s->point[s->border].weight, part = s->inset / s->within;
    double at[3], pull = 6 * (1 - part) * energy / (s->within * s->within);
    lar_face_mean((const double(*)[3])s->corner[s->border], weight, at);
    for (int i = 0; i < 12; i++)
        on[i / 3][i % 3] = s->lies * weight[i / 3] * pull * (s->x[i % 3] - at[i % 3]);
    return 1 - s->lies * (1 - lar_ease(part));
}

double lar_edge_slope(const lar_survey *s, double energy) {
    const double part = fmin(fmax(0.5 * (1 + s->hides.behind / s->within), 0), 1);
    return 3 * part * (1 - part) * energy / s->within;
}

double lar_edge_over(const lar_survey *s, double energy, double on[4][3]) {
    const double part = fmin(fmax(0.5 * (1 + s->hides.behind / s->within), 0), 1);
    const double(*corner)[3] = (const double(*)[3])s->corner[s->hidden];
    const lar_face_point *point = &s->point[s->hidden];
    const double length = lar_length(s->hides.way), pull = lar_edge_slope(s, energy);
    double at[3], up[3], normal[3], shift[4] = {0};
    const double sign = point->height < 0 ? 1 : -1;
    const double along = length > 0 ? sign * s->hides.steep * pull / length : 0;
    const double straight = point->distance > 0 ? s->hides.straight * pull / point->distance : 0;
    lar_face_mean(corner, point->weight, at);
    lar_rim_normal(corner, point->triangle, normal);
    /* Forces in one line have no moment. */
    for (int i = 0; i < 3; i++) up[i] = s->x[i] - s->hides.way[i] - at[i];
    const double out = lar_dot(up, normal);
    for (int i = 0; i < 3; i++) up[i] -= out * normal[i];
    if (!lar_rim_shift(corner, point->triangle, up, shift)) memset(shift, 0, sizeof shift);
    for (int i = 0; i < 12; i++)
        on[i / 3][i % 3] = along * (point->weight[i / 3] + shift[i / 3]) * s->hides.way[i % 3] +
                           straight * point->weight[i / 3] * (s->x[i % 3] - at[i % 3]);
    return lar_ease(part);
}

/* ---- other bodies ---------------------------------------------------------------------------- */

static void place_before(const double v[3], double past, double x[3]) {
    for (int i = 0; i < 3; i++) x[i] -= past * v[i];
}

/* A face, and where on it. */
typedef struct closest_face {
    lar_face_point point; /* distance INFINITY: there is none */
    double normal[3];     /* of any length */
    double size;          /* of the face [m] */
} closest_face;

static bool is_seen(const lar_survey *s, int32_t entry) {
    for (int32_t k = 0; s && k < s->count; k++)
        if (s->entry[k] == entry) return s->distance[k] < INFINITY;
    return true;
}

/* The closest face to the node of group g, `past` ago [s]: 0, or when forces were computed the last
 * time. Of those that a survey has seen, if there is one. */
static void closest_ago(const lar_body_contact *contact, const lar_state *state, int32_t g,
                        const lar_survey *s, double past, closest_face *closest) {
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t *face = contact->list.face + group->first;
    double x[3], v[3], corner[4][3], speed[4][3], min = INFINITY;
    closest_face all[LAR_GROUP_FACES_MAX];
    lar_contact_place(contact, state, group->node, x, v);
    place_before(v, past, x);
    const bool flush = lar_offset_is_flush(contact, state, g);
    int32_t hidden = flush ? contact->surface->flush_first[group->node] : 0;
    for (int32_t i = 0; i < group->count; i++) {
        all[i].point.distance = INFINITY;
        if (flush && lar_flush_hides_next(contact->surface, group->node, face[i], &hidden))
            continue;
        if (!is_seen(s, i)) continue;
        lar_contact_corners(contact, state, face[i], corner, speed);
        for (int a = 0; a < 4; a++) place_before(speed[a], past, corner[a]);
        lar_face_closest(x, (const double(*)[3])corner,
                         LAR_FACE_TIE * contact->surface->face[face[i]].size, &all[i].point);
        lar_face_normal((const double(*)[3])corner, all[i].normal);
        all[i].size = contact->surface->face[face[i]].size;
        min = fmin(min, all[i].point.distance);
    }
    *closest = (closest_face){.point.distance = INFINITY};
    for (int32_t i = 0; i < group->count; i++) {
        double tie = LAR_FACE_TIE * contact->surface->face[face[i]].size;
        if (!(all[i].point.distance <= min + tie)) continue;
        if (isinf(closest->point.distance) || lar_face_point_before(&all[i].point, &closest->point))
            *closest = all[i];
    }
}

static bool is_behind(const closest_face *closest, double reach) {
    return closest->point.height < 0 && closest->point.distance <= reach;
}

/* Whether faces look in opposite directions, or nearly so. */
static bool opposite(const double a[3], const double b[3]) {
    static const double COSINE = -0.5;
    double ab = 0, aa = 0, bb = 0;
    for (int i = 0; i < 3; i++) {
        ab += a[i] * b[i];
        aa += a[i] * a[i];
        bb += b[i] * b[i];
    }
    return ab < COSINE * sqrt(aa * bb);
}

static double reach_of(const lar_body_contact *contact, int32_t node, int32_t face) {
    const lar_contact_surface *s = contact->surface;
    return lar_contact_reach(s, &s->node[node], &s->face[face]);
}

/* Whether a node that is flush is near a body that it is flush with, other than that of group g, or
 * stands on it. What it remembers is for all together: at a line where four blocks meet, two part
 * and each stays on what it stands on. Its groups begin at `first`. */
static bool stands_on_another(const lar_body_contact *contact, const lar_state *state, int32_t node,
                              int32_t first, int32_t g) {
    const lar_contact_surface *s = contact->surface;
    const lar_contact_list *list = &contact->list;
    closest_face now;
    for (int32_t h = first; h < list->group_count && list->group[h].node == node; h++) {
        const int32_t face = list->face[list->group[h].first];
        if (h == g || !lar_flush_at_rest(s, node, s->face[face].body)) continue;
        closest_ago(contact, state, h, NULL, 0, &now);
        /* Who is out of reach is not in every list. */
        const double reach = reach_of(contact, node, face);
        if (now.point.distance < fmin(LAR_FLUSH_NEAR * now.size, reach) ||
            (is_behind(&now, reach) && is_straight(&now.point)))
            return true;
    }
    return false;
}

static bool is_listed(const lar_body_contact *contact, int32_t node, int32_t first, int32_t body) {
    const lar_contact_list *list = &contact->list;
    for (int32_t h = first; h < list->group_count && list->group[h].node == node; h++)
        if (contact->surface->face[list->face[list->group[h].first]].body == body) return true;
    return false;
}

void lar_offset_lose_flush(lar_body_contact *contact, const lar_state *state, int32_t node,
                           int32_t first) {
    int32_t at = 0, body = -1;
    bool lost = false;
    if (contact->keeps && !contact->keeps[node]) return;
    while (!lost && lar_flush_next_body(contact->surface, node, &at, &body))
        lost = !is_listed(contact, node, first, body);
    if (lost && !stands_on_another(contact, state, node, first, -1)) lar_offset_part(contact, node);
}

void lar_offset_stay_flush(lar_body_contact *contact, const lar_state *state, int32_t g,
                           int32_t face, const lar_face_point *closest) {
    static const double ROUNDING = 1e-6; /* who is nearer may be beside or above but for that */
    const lar_contact_surface *s = contact->surface;
    const int32_t node = contact->list.group[g].node;
    if (node >= s->node_count) return;
    double near = 0;
    if (face >= 0 && closest->height < 0) near = ROUNDING * s->face[face].size;
    if (face >= 0 && !(closest->height < 0)) near = near_of(s, node, face);
    if ((face < 0 || !(closest->distance < near)) &&
        !stands_on_another(contact, state, node, lar_group_first(&contact->list, g), g))
        lar_offset_part(contact, node);
}

/* Whether a node that is deep behind a face was neither so a step ago, nor has come through it. Who
 * was behind the opposite side has been pressed through the middle of a body: that pushes it out at
 * the back. What it was behind and does not see has not pushed it, but who is hardly behind
 * that is pushed as hardly. */
static bool comes_from_behind(lar_body_contact *contact, const lar_state *state, int32_t g,
                              int32_t face, const lar_survey *s, double depth, double rate) {
    static const double HARDLY = -0.7; /* there is 6 % of what pushes there (lar_edge_over) */
    const int32_t node = contact->list.group[g].node;
    if (!(depth > deep_of(contact, node, face)) || depth <= contact->time_step * rate ||
        !(state->past > 0))
        return false;
    closest_face before, now;
    if (s->hidden >= 0 && s->hides.behind < HARDLY * s->within) s = NULL;
    closest_ago(contact, state, g, s, state->past, &before);
    if (!is_behind(&before, reach_of(contact, node, face))) return true;
    closest_ago(contact, state, g, s, 0, &now);
    if (opposite(before.normal, now.normal)) count_through(contact, node);
    return false;
}

bool lar_offset_pushes(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t face,
                       const lar_survey *survey, double depth, double rate) {
    const lar_contact_surface *s = contact->surface;
    const int32_t node = contact->list.group[g].node;
    const double behind = lar_offset_behind(s->face[face].body);
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(s, node, parent, weight);
    for (int k = 0; k < count; k++)
        if (offset_of(contact, state, parent[k]) == behind) return false;
    /* Points remember nothing. */
    if (count > 1) return !(depth > deep_of(contact, node, face));
    if (!comes_from_behind(contact, state, g, face, survey, depth, rate)) return true;
    if (offset_of(contact, state, node) == 0) set_offset(contact, state, node, behind);
    return false;
}

/* Who was behind a face a step ago and is now too deep for contact. */
static void count_sunk(lar_body_contact *contact, const lar_state *state, int32_t g, double reach) {
    closest_face now, before;
    closest_ago(contact, state, g, NULL, 0, &now);
    if (!(now.point.height < 0) || is_behind(&now, reach) || !(state->past > 0)) return;
    closest_ago(contact, state, g, NULL, state->past, &before);
    if (is_behind(&before, reach)) count_through(contact, contact->list.group[g].node);
}

void lar_offset_out(lar_body_contact *contact, const lar_state *state, int32_t g, double gap) {
    const lar_contact_group *group = &contact->list.group[g];
    const lar_contact_surface *s = contact->surface;
    if (group->node >= s->node_count) return;
    int32_t face = contact->list.face[group->first];
    const double before = offset_of(contact, state, group->node);
    const double behind = lar_offset_behind(s->face[face].body);
    if (gap == -INFINITY)
        set_offset(contact, state, group->node, before == 0 ? behind : before);
    else if (before == behind)
        set_offset(contact, state, group->node, 0);
    else if (gap <= 0.5 * reach_of(contact, group->node, face))
        count_sunk(contact, state, g, reach_of(contact, group->node, face));
}
