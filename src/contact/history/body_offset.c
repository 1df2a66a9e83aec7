/* What nodes remember of lying in a body (body_contact.h, Offsets). */
#include <math.h>

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

void lar_offset_stay_flush(lar_body_contact *contact, int32_t g, int32_t face,
                           const lar_face_point *closest) {
    static const double ROUNDING = 1e-6; /* who is nearer may be beside or above but for that */
    const lar_contact_surface *s = contact->surface;
    const int32_t node = contact->list.group[g].node;
    if (node >= s->node_count) return;
    double near =
        face < 0 ? 0 : (closest->height < 0 ? ROUNDING : LAR_FLUSH_NEAR) * s->face[face].size;
    if (face < 0 || !(closest->distance < near)) lar_offset_part(contact, node);
}

/* ---- other bodies ---------------------------------------------------------------------------- */

static void place_before(const double v[3], double past, double x[3]) {
    for (int i = 0; i < 3; i++) x[i] -= past * v[i];
}

/* Where the node of group g was when forces were computed the last time, to the face that was
 * closest then. */
static void point_before(const lar_body_contact *contact, const lar_state *state, int32_t g,
                         lar_face_point *point) {
    const lar_contact_group *group = &contact->list.group[g];
    const int32_t *face = contact->list.face + group->first;
    double x[3], v[3], corner[4][3], speed[4][3], min = INFINITY;
    lar_face_point all[LAR_GROUP_FACES_MAX];
    lar_contact_place(contact, state, group->node, x, v);
    place_before(v, state->past, x);
    const bool flush = lar_offset_is_flush(contact, state, g);
    for (int32_t i = 0; i < group->count; i++) {
        all[i].distance = INFINITY;
        if (flush && lar_flush_hides(contact->surface, group->node, face[i])) continue;
        lar_contact_corners(contact, state, face[i], corner, speed);
        for (int a = 0; a < 4; a++) place_before(speed[a], state->past, corner[a]);
        lar_face_closest(x, (const double(*)[3])corner,
                         LAR_FACE_TIE * contact->surface->face[face[i]].size, &all[i]);
        min = fmin(min, all[i].distance);
    }
    *point = (lar_face_point){.distance = INFINITY};
    for (int32_t i = 0; i < group->count; i++) {
        double tie = LAR_FACE_TIE * contact->surface->face[face[i]].size;
        if (!(all[i].distance <= min + tie)) continue;
        if (isinf(point->distance) || lar_face_point_before(&all[i], point)) *point = all[i];
    }
}

/* Whether a node that is deep behind a face was neither so a step ago, nor has come through it. */
static bool comes_from_behind(const lar_body_contact *contact, const lar_state *state, int32_t g,
                              int32_t face, double depth, double rate) {
    const lar_contact_surface *s = contact->surface;
    const int32_t node = contact->list.group[g].node;
    if (!(depth > deep_of(contact, node, face)) || depth <= contact->time_step * rate ||
        !(state->past > 0))
        return false;
    lar_face_point before;
    point_before(contact, state, g, &before);
    return !(before.height < 0 &&
             before.distance <= lar_contact_reach(s, &s->node[node], &s->face[face]));
}

bool lar_offset_pushes(lar_body_contact *contact, const lar_state *state, int32_t g, int32_t face,
                       double depth, double rate) {
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
    if (!comes_from_behind(contact, state, g, face, depth, rate)) return true;
    if (offset_of(contact, state, node) == 0) set_offset(contact, state, node, behind);
    return false;
}

void lar_offset_out(lar_body_contact *contact, const lar_state *state, int32_t g) {
    const lar_contact_group *group = &contact->list.group[g];
    const lar_contact_surface *s = contact->surface;
    if (group->node >= s->node_count) return;
    int32_t body = s->face[contact->list.face[group->first]].body;
    if (offset_of(contact, state, group->node) == lar_offset_behind(body))
        set_offset(contact, state, group->node, 0);
}
