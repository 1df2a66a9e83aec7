#include "contact/history/flush.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/face_contact.h"

/* ---- at rest --------------------------------------------------------------------------------- */

static void corners_at_rest(const lar_contact_surface *s, int32_t face, double corner[4][3]) {
    for (int a = 0; a < 4; a++)
        memcpy(corner[a], s->rest[s->face[face].corner[a]], 3 * sizeof(double));
}

/* Whether a face of one body goes on in the plane of one of another, or a little within it, and
 * looks the same way. */
static bool goes_on_in(const lar_contact_surface *s, int32_t own, int32_t other, int32_t node,
                       double rounding) {
    static const double SAME = 0.9;    /* cosine */
    static const double WITHIN = 0.25; /* of a face */
    double corner[2][4][3], way[2][3], from[3];
    corners_at_rest(s, own, corner[0]);
    corners_at_rest(s, other, corner[1]);
    for (int k = 0; k < 2; k++) lar_face_normal((const double(*)[3])corner[k], way[k]);
    lar_minus(s->rest[node], corner[1][0], from);
    double length = lar_length(way[1]), out = lar_dot(from, way[1]) / length;
    return lar_dot(way[0], way[1]) > SAME * lar_length(way[0]) * length && out <= rounding &&
           out >= -fmax(rounding, WITHIN * s->face[other].size);
}

static bool looks_against(const lar_contact_surface *s, int32_t own, int32_t other) {
    static const double AGAINST = -0.9; /* cosine */
    double corner[2][4][3], way[2][3];
    corners_at_rest(s, own, corner[0]);
    corners_at_rest(s, other, corner[1]);
    for (int k = 0; k < 2; k++) lar_face_normal((const double(*)[3])corner[k], way[k]);
    return lar_dot(way[0], way[1]) < AGAINST * lar_length(way[0]) * lar_length(way[1]);
}

/* Faces by their corners: those of node n are at[first[n]] up to at[first[n + 1]]. */
typedef struct around {
    int32_t *first, *at;
} around;

static bool list_around(const lar_contact_surface *s, around *faces) {
    faces->first = lar_calloc((size_t)s->node_count + 2, sizeof *faces->first);
    faces->at = lar_calloc(4 * (size_t)s->face_count, sizeof *faces->at);
    if (!faces->first || !faces->at) return false;
    for (int32_t i = 0; i < 4 * s->face_count; i++)
        faces->first[s->face[i / 4].corner[i % 4] + 2]++;
    for (int32_t n = 2; n <= s->node_count; n++) faces->first[n] += faces->first[n - 1];
    for (int32_t i = 0; i < 4 * s->face_count; i++)
        faces->at[faces->first[s->face[i / 4].corner[i % 4] + 1]++] = i / 4;
    return true;
}

static bool has_corner(const lar_contact_face *face, int32_t node) {
    bool has = false;
    for (int a = 0; a < 4; a++) has = has || face->corner[a] == node;
    return has;
}

/* Whether one of the faces that a node, or all nodes of a point, are corners of goes on in `other`,
 * or looks against it. */
static bool has_face(const lar_contact_surface *s, const around *faces, int32_t node, int32_t other,
                     bool against, double rounding) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(s, node, parent, weight);
    for (int32_t i = faces->first[parent[0]]; i < faces->first[parent[0] + 1]; i++) {
        const int32_t own = faces->at[i];
        bool common = against || s->face[own].fades;
        for (int k = 1; k < count; k++) common = common && has_corner(&s->face[own], parent[k]);
        if (common &&
            (against ? looks_against(s, own, other) : goes_on_in(s, own, other, node, rounding)))
            return true;
    }
    return false;
}

typedef enum standing { AWAY, STRAIGHT, NEAR } standing;

/* Whether the node of a group is near its faces at rest, in parts of their size, or straight before
 * one that a face of its own looks against. */
static standing standing_of(const lar_contact_surface *s, const lar_contact_list *list,
                            const around *faces, const lar_contact_group *group) {
    static const double COSINE = 0.9;
    double min = INFINITY, corner[4][3];
    bool straight = false;
    lar_face_point point;
    for (int32_t i = group->first; i < group->first + group->count; i++) {
        const int32_t face = list->face[i];
        const double size = s->face[face].size, tie = LAR_FACE_TIE * size;
        corners_at_rest(s, face, corner);
        lar_face_closest(s->rest[group->node], (const double(*)[3])corner, tie, &point);
        if (point.distance < LAR_FLUSH_NEAR * size) return NEAR;
        if (point.distance < min - tie) straight = false;
        if (point.distance <= min + tie && point.height > COSINE * point.distance)
            straight = straight || has_face(s, faces, group->node, face, true, 0);
        min = fmin(min, point.distance);
    }
    return straight ? STRAIGHT : AWAY;
}

/* Whether a node that stands so may be flush with the body of group g. What parts from one has
 * parted from all, so who is near one is not listed with those that it is only straight before. */
static bool may_be_flush(const lar_contact_surface *s, const lar_contact_list *list,
                         const around *faces, int32_t g) {
    const lar_contact_group *group = &list->group[g];
    const standing with = standing_of(s, list, faces, group);
    int32_t parent[LAR_CONTACT_PARENTS], h = g;
    double weight[LAR_CONTACT_PARENTS];
    if (with != STRAIGHT) return with == NEAR;
    int count = lar_contact_parents(s, group->node, parent, weight);
    for (int k = 0; k < count && count > 1; k++)
        if (!lar_flush_at_rest(s, parent[k], s->face[list->face[group->first]].body)) return false;
    while (h > 0 && list->group[h - 1].node == group->node) h--;
    for (; h < list->group_count && list->group[h].node == group->node; h++)
        if (h != g && !lar_group_is_own(s, list, &list->group[h]) &&
            standing_of(s, list, faces, &list->group[h]) != AWAY)
            return false;
    return true;
}

lar_status lar_flush_find(lar_contact_surface *s, const lar_contact_list *list, double rounding,
                          lar_error *error) {
    around faces = {0};
    size_t points = (size_t)s->point_count;
    s->flush_first = lar_calloc(points + 1, sizeof *s->flush_first);
    s->flush = lar_calloc((size_t)list->face_count + 1, sizeof *s->flush);
    bool fits = s->flush_first && s->flush && list_around(s, &faces);
    int32_t count = 0, next = 0;
    for (int32_t g = 0; g < list->group_count && fits; g++) {
        const lar_contact_group *group = &list->group[g];
        if (lar_group_is_own(s, list, group) || !(s->node[group->node].blunt < 1)) continue;
        while (next <= group->node) s->flush_first[next++] = count;
        if (!may_be_flush(s, list, &faces, g)) continue;
        for (int32_t i = group->first; i < group->first + group->count; i++)
            if (s->face[list->face[i]].fades &&
                has_face(s, &faces, group->node, list->face[i], false, rounding))
                s->flush[count++] = list->face[i];
    }
    while (fits && next <= s->point_count) s->flush_first[next++] = count;
    free(faces.first);
    free(faces.at);
    return fits ? LAR_OK
                : lar_fail_memory(error, 8 * points + 16 * (size_t)s->face_count, "flush bodies");
}

/* ---- which they are ----------------------------------------------------------------------- */

bool lar_flush_next_body(const lar_contact_surface *s, int32_t node, int32_t *at, int32_t *body) {
    int32_t i = s->flush_first[node] + *at;
    while (i < s->flush_first[node + 1] && s->face[s->flush[i]].body == *body) i++;
    *at = i - s->flush_first[node];
    if (i >= s->flush_first[node + 1]) return false;
    *body = s->face[s->flush[i]].body;
    return true;
}

bool lar_flush_at_rest(const lar_contact_surface *s, int32_t node, int32_t body) {
    int32_t at = 0, other = -1;
    while (lar_flush_next_body(s, node, &at, &other))
        if (other == body) return true;
    return false;
}

bool lar_flush_hides(const lar_contact_surface *s, int32_t node, int32_t face) {
    bool hides = false;
    for (int32_t i = s->flush_first[node]; i < s->flush_first[node + 1] && !hides; i++)
        hides = s->flush[i] == face;
    return hides;
}
