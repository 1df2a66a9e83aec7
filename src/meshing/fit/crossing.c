#include "meshing/fit/crossing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel_for.h"
#include "base/vector.h"
#include "model/triangles/triangles.h"

/* Corners of a face's triangles: two for each of its diagonals. */
static const uint8_t half[4][3] = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}, {1, 3, 0}};

/* ---- two faces ------------------------------------------------------------------------------ */

/* Nodes that both have, by their corners in `a`; their number. */
static int common_nodes(const int32_t a[4], const int32_t b[4], int common[4]) {
    int count = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            if (a[i] == b[k]) common[count++ & 3] = i;
    return count;
}

/* Compares, where fmin and fmax would be calls: most pairs end here. */
static double min(const double (*x)[3], const int32_t face[4], int i) {
    const double one = x[face[0]][i] < x[face[1]][i] ? x[face[0]][i] : x[face[1]][i];
    const double other = x[face[2]][i] < x[face[3]][i] ? x[face[2]][i] : x[face[3]][i];
    return one < other ? one : other;
}

static double max(const double (*x)[3], const int32_t face[4], int i) {
    const double one = x[face[0]][i] > x[face[1]][i] ? x[face[0]][i] : x[face[1]][i];
    const double other = x[face[2]][i] > x[face[3]][i] ? x[face[2]][i] : x[face[3]][i];
    return one > other ? one : other;
}

static bool boxes_apart(const double (*x)[3], const int32_t a[4], const int32_t b[4], double gap) {
    for (int i = 0; i < 3; i++)
        if (min(x, b, i) - max(x, a, i) > gap || min(x, a, i) - max(x, b, i) > gap) return true;
    return false;
}

/* Whether a plane across `way` divides the faces, `b` in front of it. */
static bool divides(const double way[3], const double a[4][3], const double b[4][3], bool touching,
                    double gap) {
    double front = lar_dot(way, a[0]), back = lar_dot(way, b[0]), square = 0;
    for (int k = 0; k < 4; k++) {
        const double of_a = lar_dot(way, a[k]), of_b = lar_dot(way, b[k]);
        const double far = lar_dot(b[k], b[k]);
        front = of_a > front ? of_a : front;
        back = of_b < back ? of_b : back;
        square = far > square ? far : square;
    }
    const double length = lar_length(way), rounding = 1e-12 * sqrt(square);
    if (!(length > rounding)) return false;
    return back - front > length * (touching ? -rounding : gap);
}

/* The way across a face that leads towards `to`. */
static void way_across(const double face[4][3], const double to[3], double way[3]) {
    double along[3], across[3];
    lar_minus(face[2], face[0], along);
    lar_minus(face[3], face[1], across);
    lar_cross(along, across, way);
    const double sign = lar_dot(way, to) < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) way[i] *= sign;
}

/* Whether a plane is found that divides the faces: across the way from the middle of the one to
 * that of the other, or through the edge that they share, or along one of them. So it is for nearly
 * all other pairs, at a small part of the work. Corners are given from a corner of `a`. */
static bool divided(const double a[4][3], const double b[4][3], int shared, const int common[4],
                    double gap) {
    double way[3] = {0}, across[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) way[i] += b[k][i] - a[k][i];
    if (shared != 2 && divides(way, a, b, shared > 0, gap)) return true;
    way_across(a, way, across);
    if (divides(across, a, b, shared > 0, gap)) return true;
    way_across(b, way, across);
    if (divides(across, a, b, shared > 0, gap)) return true;
    if (shared != 2) return false;
    double edge[3];
    lar_minus(a[common[1]], a[common[0]], edge);
    const double along = lar_dot(way, edge) / lar_dot(edge, edge);
    for (int i = 0; i < 3; i++) way[i] -= along * edge[i];
    return divides(way, a, b, true, gap);
}

/* The planes of a face's four triangles, and how far in front of them the other face's corners are,
 * times the length of the normal. */
typedef struct planes {
    double normal[4][3], length[4], front[4][4];
} planes;

static void lay_planes(const double own[4][3], const double other[4][3], planes *p) {
    for (int s = 0; s < 4; s++) {
        const double *from = own[half[s][0]];
        double along[3], across[3], way[3];
        lar_minus(own[half[s][1]], from, along);
        lar_minus(own[half[s][2]], from, across);
        lar_cross(along, across, p->normal[s]);
        p->length[s] = lar_length(p->normal[s]);
        for (int k = 0; k < 4; k++) {
            lar_minus(other[k], from, way);
            p->front[s][k] = lar_dot(p->normal[s], way);
        }
    }
}

/* Rounding of products of three lengths, generously: the faces' sizes are near each other. */
static const double DOUBT = 1e-9;

/* Whether triangle t of the other face is on one side of the plane of triangle s; the corner
 * `common` [or -1] lies in it. */
static bool is_on_one_side(const planes *p, int s, int t, int common, double gap) {
    const double far = p->length[s] * gap + DOUBT * p->length[s] * sqrt(p->length[s]);
    bool front = true, back = true;
    for (int i = 0; i < 3; i++) {
        const int k = half[t][i];
        if (k == common) continue;
        front = front && p->front[s][k] > far;
        back = back && p->front[s][k] < -far;
    }
    return front || back;
}

/* Where the side of a triangle that is opposite to its corner `common` goes through a plane. */
static void piercing(const double corner[4][3], const uint8_t triangle[3], int common,
                     const double front[4], double at[3]) {
    int k[2], count = 0;
    for (int i = 0; i < 3; i++)
        if (triangle[i] != common) k[count++ & 1] = triangle[i];
    const double one = fabs(front[k[0]]), other = fabs(front[k[1]]);
    for (int i = 0; i < 3; i++)
        at[i] = other * (corner[k[0]][i] - corner[common][i]) +
                one * (corner[k[1]][i] - corner[common][i]);
}

/* Whether two triangles are seen to be apart without trying all directions: each, but for what they
 * share, on one side of the other's plane; or, where they share a corner, the lines from it along
 * which they meet each other's plane go opposite ways. */
static bool seen_apart(const double a[4][3], const double b[4][3], const planes *of_a,
                       const planes *of_b, int s, int t, const int common[2], double gap) {
    if (is_on_one_side(of_a, s, t, common[1], gap) || is_on_one_side(of_b, t, s, common[0], gap))
        return true;
    if (common[0] < 0) return false;
    double one[3], other[3];
    piercing(a, half[s], common[0], of_b->front[t], one);
    piercing(b, half[t], common[1], of_a->front[s], other);
    const double along = lar_dot(one, other);
    return along < 0 && along * along > 0.25 * lar_dot(one, one) * lar_dot(other, other);
}

/* The corners that two triangles share: their number, and which the last one is in each face. */
static int common_corners(const int32_t a[4], const int32_t b[4], int s, int t, int common[2]) {
    int same = 0;
    common[0] = common[1] = -1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            if (a[half[s][i]] != b[half[t][k]]) continue;
            common[0] = half[s][i];
            common[1] = half[t][k];
            same++;
        }
    return same;
}

static double triangles_cross(const double a[4][3], const double b[4][3], int s, int t,
                              double gap) {
    double one[3][3], other[3][3];
    for (int i = 0; i < 3; i++) {
        memcpy(one[i], a[half[s][i]], sizeof one[i]);
        memcpy(other[i], b[half[t][i]], sizeof other[i]);
    }
    return lar_triangle_overlap((const double(*)[3])one, (const double(*)[3])other, gap);
}

double lar_faces_cross(const double (*x)[3], const int32_t a[4], const int32_t b[4], double gap) {
    double at[4][3], bt[4][3], deepest = 0;
    int common[4];
    if (boxes_apart(x, a, b, gap)) return 0;
    const int shared = common_nodes(a, b, common);
    for (int k = 0; k < 4; k++) {
        lar_minus(x[a[k]], x[a[0]], at[k]);
        lar_minus(x[b[k]], x[a[0]], bt[k]);
    }
    const double(*ac)[3] = (const double(*)[3])at, (*bc)[3] = (const double(*)[3])bt;
    if (shared > 0) gap = 0;
    if (shared > 2 || divided(ac, bc, shared, common, gap)) return 0;
    planes of_a, of_b;
    lay_planes(ac, bc, &of_a);
    lay_planes(bc, ac, &of_b);
    for (int s = 0; s < 4; s++)
        for (int t = 0; t < 4; t++) {
            if (common_corners(a, b, s, t, common) >= 2) continue;
            if (seen_apart(ac, bc, &of_a, &of_b, s, t, common, gap)) continue;
            deepest = fmax(deepest, triangles_cross(ac, bc, s, t, gap));
        }
    return deepest;
}

/* ---- how far they are apart ----------------------------------------------------------------- */

/* Corners of two faces, seen from one of the first. */
typedef struct corners {
    double a[4][3], b[4][3];
    int shared, common[4]; /* nodes, by their corners in `a`, */
    bool both[2][4];       /* which corners these are */
} corners;

static void see(const double (*x)[3], const int32_t a[4], const int32_t b[4], corners *c) {
    *c = (corners){0};
    c->shared = common_nodes(a, b, c->common);
    const double *from = x[a[c->shared > 0 ? c->common[0] : 0]];
    for (int k = 0; k < 4; k++) {
        lar_minus(x[a[k]], from, c->a[k]);
        lar_minus(x[b[k]], from, c->b[k]);
        for (int l = 0; l < 4; l++)
            if (a[k] == b[l]) c->both[0][k] = c->both[1][l] = true;
    }
}

/* How far behind a plane across `way` and before it corners are that are not of both; where none
 * are shared it is what lies between the faces. */
static double room(const corners *c, const double way[3]) {
    double front = -INFINITY, back = INFINITY;
    for (int k = 0; k < 4; k++) {
        const double of_a = lar_dot(way, c->a[k]), of_b = lar_dot(way, c->b[k]);
        if (!c->both[0][k] && of_a > front) front = of_a;
        if (!c->both[1][k] && of_b < back) back = of_b;
    }
    const double length = lar_length(way);
    if (!(length > 0)) return -INFINITY;
    if (c->shared == 0) return (back - front) / length;
    return (back < -front ? back : -front) / length;
}

static double room_between_boxes(const double (*x)[3], const int32_t a[4], const int32_t b[4]) {
    double widest = -INFINITY;
    for (int i = 0; i < 3; i++) {
        const double above = min(x, b, i) - max(x, a, i), below = min(x, a, i) - max(x, b, i);
        widest = above > widest ? above : widest;
        widest = below > widest ? below : widest;
    }
    return widest;
}

/* Without the part along the edge that both share. */
static void turn_from_edge(const double edge[3], double way[3]) {
    const double along = lar_dot(way, edge) / lar_dot(edge, edge);
    for (int i = 0; i < 3; i++) way[i] -= along * edge[i];
}

/* Where faces share nodes, the widest plane through these that is found when, from `way` on, it is
 * again and again turned to the corner that has least room (Rosenblatt's perceptron, 1958). `edge`:
 * what they share, or NULL. */
static double room_at_shared(const corners *c, const double *edge, const double way[3]) {
    enum { TURNS = 12 };
    double out[6][3], far[6], at[3], widest = -INFINITY;
    int count = 0;
    for (int k = 0; k < 8; k++) {
        double *to = out[count];
        if (c->both[k / 4][k & 3]) continue;
        memcpy(to, k < 4 ? c->a[k] : c->b[k - 4], sizeof out[count]);
        if (edge) turn_from_edge(edge, to);
        far[count] = lar_length(to);
        for (int i = 0; i < 3; i++) to[i] *= (k < 4 ? -1 : 1) / far[count];
        count++;
    }
    const double length = lar_length(way);
    for (int i = 0; i < 3; i++) at[i] = way[i] / length;
    for (int turn = 0; turn < TURNS; turn++) {
        int worst = 0;
        double min = INFINITY, room = INFINITY;
        for (int k = 0; k < count; k++) {
            const double cosine = lar_dot(at, out[k]);
            if (cosine < min) min = cosine, worst = k;
            room = far[k] * cosine < room ? far[k] * cosine : room;
        }
        room /= lar_length(at);
        widest = room > widest ? room : widest;
        for (int i = 0; i < 3; i++) at[i] += out[worst][i];
    }
    return widest;
}

/* The planes that `divided` tries. */
static double widest_room(const corners *c) {
    double way[3] = {0}, across[2][3], edge[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) way[i] += c->b[k][i] - c->a[k][i];
    way_across(c->a, way, across[0]);
    way_across(c->b, way, across[1]);
    if (c->shared == 2) {
        memcpy(edge, c->a[c->common[1]], sizeof edge);
        turn_from_edge(edge, way);
        for (int s = 0; s < 2; s++) turn_from_edge(edge, across[s]);
    }
    double widest = room(c, way);
    for (int s = 0; s < 2; s++) {
        const double other = room(c, across[s]);
        widest = other > widest ? other : widest;
    }
    if (c->shared == 0 || widest > 0) return widest;
    return room_at_shared(c, c->shared == 2 ? edge : NULL, way);
}

/* A plane through the edge turns with it, by what its ends move by over its length. */
static double clearance_at_edge(const corners *c, double widest) {
    double longest = 0;
    const double edge = lar_length(c->a[c->common[1]]);
    for (int k = 0; k < 4; k++)
        longest = fmax(longest, fmax(lar_length(c->a[k]), lar_length(c->b[k])));
    const double clear = widest / (2 + (longest + edge / 4) / (0.75 * edge));
    return fmin(clear, edge / 4);
}

double lar_faces_clearance(const double (*x)[3], const int32_t a[4], const int32_t b[4],
                           double gap) {
    const double ROUNDING = 1e-9;
    corners c;
    see(x, a, b, &c);
    double widest = 0;
    if (c.shared > 2) return INFINITY; /* for lar_faces_cross they never do */
    if (c.shared == 0) {
        widest = room_between_boxes(x, a, b);
        if (!(widest > 2 * gap)) widest = fmax(widest, widest_room(&c));
        widest -= gap;
    } else {
        widest = widest_room(&c) / 2;
        if (c.shared == 2)
            widest = (c.common[0] ^ c.common[1]) == 2 ? 0 : clearance_at_edge(&c, 2 * widest);
    }
    return widest > ROUNDING ? widest - ROUNDING : 0;
}

/* ---- all pairs ------------------------------------------------------------------------------ */

typedef struct search {
    const double (*x)[3];
    const int32_t (*face)[4];
    double gap;
    const lar_face_boxes *boxes;
    int32_t *pairs;  /* [faces] with faces of higher number */
    double *deepest; /* [faces] */
} search;

typedef struct comparison {
    const search *search;
    int32_t face;
} comparison;

static bool compare(void *context, int32_t other) {
    const comparison *c = context;
    const search *s = c->search;
    if (other == c->face) return true;
    const double depth = lar_faces_cross(s->x, s->face[c->face], s->face[other], s->gap);
    if (!(depth > 0)) return true;
    s->pairs[c->face] += other > c->face;
    s->deepest[c->face] = fmax(s->deepest[c->face], depth);
    return true;
}

static void look_around(void *context, int32_t first, int32_t end) {
    const search *s = context;
    for (int32_t f = first; f < end; f++) {
        comparison c = {s, f};
        lar_face_boxes_near(s->boxes, f, s->gap, compare, &c);
    }
}

lar_status lar_faces_find_crossings(const double (*x)[3], const int32_t (*face)[4], int32_t count,
                                    double gap, const lar_face_boxes *boxes, bool *crosses,
                                    lar_face_crossings *found, lar_error *error) {
    enum { PORTION = 256 };
    lar_face_boxes own = {0};
    search s = {.x = x, .face = face, .gap = gap, .boxes = boxes ? boxes : &own};
    s.pairs = lar_calloc((size_t)count, sizeof *s.pairs);
    s.deepest = lar_calloc((size_t)count, sizeof *s.deepest);
    lar_status status = s.pairs && s.deepest ? LAR_OK
                                             : lar_fail_memory(error, 12 * (size_t)count,
                                                               "which faces cross each other");
    if (!status && !boxes) status = lar_face_boxes_create(x, face, count, &own, error);
    if (!status) lar_parallel_for(count, PORTION, look_around, &s);
    *found = (lar_face_crossings){0};
    for (int32_t f = 0; !status && f < count; f++) {
        found->pairs += s.pairs[f];
        found->deepest = fmax(found->deepest, s.deepest[f]);
        if (crosses) crosses[f] = s.deepest[f] > 0;
    }
    lar_face_boxes_clear(&own);
    free(s.pairs);
    free(s.deepest);
    return status;
}
