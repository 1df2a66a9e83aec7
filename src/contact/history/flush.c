#include "contact/history/flush.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

/* ---- at rest --------------------------------------------------------------------------------- */

static void corners_at_rest(const lar_contact_surface *s, int32_t face, double corner[4][3]) {
    for (int a = 0; a < 4; a++)
        memcpy(corner[a], s->rest[s->face[face].corner[a]], 3 * sizeof(double));
}

/* Cosines between faces that look the same way, and against each other. */
static const double SAME = 0.9, AGAINST = -0.9;

static double cosine_between(const lar_contact_surface *s, int32_t one, int32_t other) {
    double corner[2][4][3], way[2][3];
    corners_at_rest(s, one, corner[0]);
    corners_at_rest(s, other, corner[1]);
    for (int k = 0; k < 2; k++) lar_face_normal((const double(*)[3])corner[k], way[k]);
    return lar_dot(way[0], way[1]) / (lar_length(way[0]) * lar_length(way[1]));
}

/* Whether a face of one body goes on in the plane of one of another, or a little within it, and
 * looks the same way. */
static bool goes_on_in(const lar_contact_surface *s, int32_t own, int32_t other, int32_t node,
                       double rounding) {
    static const double WITHIN = 0.25; /* of a face */
    double corner[4][3], way[3], from[3];
    if (!(cosine_between(s, own, other) > SAME)) return false;
    corners_at_rest(s, other, corner);
    lar_face_normal((const double(*)[3])corner, way);
    lar_minus(s->rest[node], corner[0], from);
    double out = lar_dot(from, way) / lar_length(way);
    return out <= rounding && out >= -fmax(rounding, WITHIN * s->face[other].size);
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

/* The faces that a node, or all nodes of a point, are corners of; at most MOST_OWN. Returns their
 * number. */
enum { MOST_OWN = 16 };
static int faces_of(const lar_contact_surface *s, const around *faces, int32_t node,
                    int32_t own[MOST_OWN]) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(s, node, parent, weight), found = 0;
    for (int32_t i = faces->first[parent[0]]; i < faces->first[parent[0] + 1]; i++) {
        bool common = found < MOST_OWN;
        for (int k = 1; k < count; k++)
            common = common && has_corner(&s->face[faces->at[i]], parent[k]);
        if (common) own[found++] = faces->at[i];
    }
    return found;
}

/* Whether one of a node's own faces looks against `other`. */
static bool stands_against(const lar_contact_surface *s, const around *faces, int32_t node,
                           int32_t other) {
    int32_t own[MOST_OWN];
    int count = faces_of(s, faces, node, own);
    for (int k = 0; k < count; k++)
        if (cosine_between(s, own[k], other) < AGAINST) return true;
    return false;
}

/* Whether one of the faces `own` that is not in the plane of own[k] looks against a face of a
 * group: own[k] ends at a joint. However blunt the edge is between them: what one body has more of
 * a straight angle the other has less. */
static bool ends_at_joint(const lar_contact_surface *s, const lar_contact_list *list,
                          const lar_contact_group *group, const int32_t *own, int count, int k) {
    for (int j = 0; j < count; j++) {
        if (!(fabs(cosine_between(s, own[j], own[k])) < SAME)) continue;
        for (int32_t i = group->first; i < group->first + group->count; i++)
            if (cosine_between(s, own[j], list->face[i]) < AGAINST) return true;
    }
    return false;
}

/* Whether one of the faces of the node of a group goes on in `other`, at sharp edges or a joint. */
static bool goes_on(const lar_contact_surface *s, const lar_contact_list *list, const around *faces,
                    const lar_contact_group *group, int32_t other, double rounding) {
    const bool sharp = s->node[group->node].blunt < 1 && s->face[other].fades;
    int32_t own[MOST_OWN];
    int count = faces_of(s, faces, group->node, own);
    for (int k = 0; k < count; k++)
        if (goes_on_in(s, own[k], other, group->node, rounding) &&
            ((sharp && s->face[own[k]].fades) || ends_at_joint(s, list, group, own, count, k)))
            return true;
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
            straight = straight || stands_against(s, faces, group->node, face);
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
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    if (with != STRAIGHT) return with == NEAR;
    int count = lar_contact_parents(s, group->node, parent, weight);
    for (int k = 0; k < count && count > 1; k++)
        if (!lar_flush_at_rest(s, parent[k], s->face[list->face[group->first]].body)) return false;
    for (int32_t h = lar_group_first(list, g);
         h < list->group_count && list->group[h].node == group->node; h++)
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
        if (lar_group_is_own(s, list, group)) continue;
        while (next <= group->node) s->flush_first[next++] = count;
        if (!may_be_flush(s, list, &faces, g)) continue;
        for (int32_t i = group->first; i < group->first + group->count; i++)
            if (goes_on(s, list, &faces, group, list->face[i], rounding))
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

bool lar_flush_hides_next(const lar_contact_surface *s, int32_t node, int32_t face, int32_t *next) {
    const int32_t body = s->face[face].body, end = s->flush_first[node + 1];
    int32_t at = *next;
    while (at < end && (s->flush[at] < face || s->face[s->flush[at]].body != body)) at++;
    *next = at;
    return at < end && s->flush[at] == face;
}

/* ---- past an edge -------------------------------------------------------------------------- */

/* Whether a face has all corners that the closest point of another one is made of. */
static bool has_all(const lar_contact_surface *s, int32_t face, int32_t other,
                    const lar_face_point *closest) {
    static const double ROUNDING = 1e-9;
    bool has = s->face[face].body == s->face[other].body;
    for (int a = 0; a < 4 && has; a++)
        has = !(closest->weight[a] > ROUNDING) ||
              has_corner(&s->face[face], s->face[other].corner[a]);
    return has;
}

static bool is_on_rim(const lar_contact_surface *s, int32_t node, int32_t face,
                      const lar_face_point *closest) {
    bool on = false;
    for (int32_t i = s->flush_first[node]; i < s->flush_first[node + 1] && !on; i++)
        on = has_all(s, s->flush[i], face, closest);
    return on;
}

/* From a corner of a triangle of a face to the next one, and to the middle. */
static void sides_of(const double corner[4][3], int triangle, double one[3], double two[3]) {
    static const double even[4] = {0.25, 0.25, 0.25, 0.25};
    double middle[3];
    lar_face_mean(corner, even, middle);
    lar_minus(corner[(triangle + 1) % 4], corner[triangle], one);
    lar_minus(middle, corner[triangle], two);
}

bool lar_rim_shift(const double corner[4][3], int triangle, const double way[3], double shift[4]) {
    double one[3], two[3];
    sides_of(corner, triangle, one, two);
    const int next = (triangle + 1) % 4;
    const double a = lar_dot(one, one), b = lar_dot(one, two), c = lar_dot(two, two);
    const double p = lar_dot(one, way), q = lar_dot(two, way), area = a * c - b * b;
    if (!(area > 1e-6 * a * c)) return false; /* crushed to a line */
    const double along = (c * p - b * q) / area, up = (a * q - b * p) / area;
    for (int k = 0; k < 4; k++) shift[k] = 0.25 * up;
    shift[next] += along;
    shift[triangle] -= along + up;
    return true;
}

void lar_rim_normal(const double corner[4][3], int triangle, double normal[3]) {
    double one[3], two[3];
    sides_of(corner, triangle, one, two);
    lar_cross(one, two, normal);
    const double length = lar_length(normal);
    for (int i = 0; i < 3; i++) normal[i] = length > 0 ? normal[i] / length : 0;
}

bool lar_rim_foot(const double x[3], const double corner[4][3], const lar_face_point *closest,
                  lar_rim *rim) {
    double at[3], normal[3];
    lar_rim_normal(corner, closest->triangle, normal);
    lar_face_mean(corner, closest->weight, at);
    lar_minus(x, at, rim->away);
    for (int i = 0; i < 3; i++) rim->way[i] = rim->away[i] - closest->height * normal[i];
    return lar_rim_shift(corner, closest->triangle, rim->way, rim->shift);
}

bool lar_flush_past(const lar_contact_surface *s, int32_t node, int32_t face, const double x[3],
                    const double corner[4][3], const lar_face_point *closest, lar_rim *rim) {
    static const double HALF = 0.35; /* of the diagonal: what a node on the edge bears for */
    if (!is_on_rim(s, node, face, closest)) return false;
    const bool has_foot = lar_rim_foot(x, corner, closest, rim);
    const double past = lar_length(rim->way);
    rim->lasts = HALF * s->face[face].size;
    rim->part = fmin(past / rim->lasts, 1);
    return has_foot && past > LAR_FACE_TIE * s->face[face].size;
}

bool lar_rim_meets(const lar_contact_surface *s, int32_t one, int32_t other) {
    bool meets = false;
    for (int a = 0; a < 4; a++)
        meets = meets || has_corner(&s->face[one], s->face[other].corner[a]);
    return meets;
}

void lar_rim_forces(const lar_rim *rim, const lar_face_point *closest, double pull,
                    double on[4][3]) {
    const double per = pull / lar_length(rim->way);
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++)
            on[a][i] = per * (rim->away[i] * rim->shift[a] -
                              rim->way[i] * (closest->weight[a] + rim->shift[a]));
}

/* e(1 - part) of it; see theory.md, flush bodies. */
double lar_flush_left(const lar_rim *rim, const lar_face_point *closest, double energy,
                      double on[4][3]) {
    lar_rim_forces(rim, closest, 6 * rim->part * (1 - rim->part) * energy / rim->lasts, on);
    return 1 - lar_ease(rim->part);
}
