#include "meshing/crossing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/share.h"
#include "base/vector.h"
#include "meshing/face_boxes.h"
#include "model/triangles.h"

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
static double least(const double (*x)[3], const int32_t face[4], int i) {
    const double one = x[face[0]][i] < x[face[1]][i] ? x[face[0]][i] : x[face[1]][i];
    const double other = x[face[2]][i] < x[face[3]][i] ? x[face[2]][i] : x[face[3]][i];
    return one < other ? one : other;
}

static double most(const double (*x)[3], const int32_t face[4], int i) {
    const double one = x[face[0]][i] > x[face[1]][i] ? x[face[0]][i] : x[face[1]][i];
    const double other = x[face[2]][i] > x[face[3]][i] ? x[face[2]][i] : x[face[3]][i];
    return one > other ? one : other;
}

static bool boxes_apart(const double (*x)[3], const int32_t a[4], const int32_t b[4], double gap) {
    for (int i = 0; i < 3; i++)
        if (least(x, b, i) - most(x, a, i) > gap || least(x, a, i) - most(x, b, i) > gap)
            return true;
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

double lar_faces_cross(const double (*x)[3], const int32_t a[4], const int32_t b[4], double gap) {
    double at[4][3], bt[4][3], deepest = 0;
    int common[4];
    if (boxes_apart(x, a, b, gap)) return 0;
    const int shared = common_nodes(a, b, common);
    for (int k = 0; k < 4; k++) {
        lar_minus(x[a[k]], x[a[0]], at[k]);
        lar_minus(x[b[k]], x[a[0]], bt[k]);
    }
    if (shared > 0) gap = 0;
    if (shared > 2 || divided((const double(*)[3])at, (const double(*)[3])bt, shared, common, gap))
        return 0;
    for (int s = 0; s < 4; s++)
        for (int t = 0; t < 4; t++) {
            double one[3][3], other[3][3];
            int same = 0;
            for (int i = 0; i < 3; i++) {
                memcpy(one[i], at[half[s][i]], sizeof one[i]);
                memcpy(other[i], bt[half[t][i]], sizeof other[i]);
                for (int k = 0; k < 3; k++) same += a[half[s][i]] == b[half[t][k]];
            }
            if (same >= 2) continue;
            const double depth =
                lar_triangle_overlap((const double(*)[3])one, (const double(*)[3])other, gap);
            deepest = fmax(deepest, depth);
        }
    return deepest;
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
                                    double gap, bool *crosses, lar_face_crossings *found,
                                    lar_error *error) {
    enum { PORTION = 256 };
    lar_face_boxes boxes = {0};
    search s = {.x = x, .face = face, .gap = gap, .boxes = &boxes};
    s.pairs = lar_calloc((size_t)count, sizeof *s.pairs);
    s.deepest = lar_calloc((size_t)count, sizeof *s.deepest);
    lar_status status = s.pairs && s.deepest ? LAR_OK
                                             : lar_fail_memory(error, 12 * (size_t)count,
                                                               "which faces cross each other");
    if (!status) status = lar_face_boxes_create(x, face, count, &boxes, error);
    if (!status) lar_share(count, PORTION, look_around, &s);
    *found = (lar_face_crossings){0};
    for (int32_t f = 0; !status && f < count; f++) {
        found->pairs += s.pairs[f];
        found->deepest = fmax(found->deepest, s.deepest[f]);
        if (crosses) crosses[f] = s.deepest[f] > 0;
    }
    lar_face_boxes_clear(&boxes);
    free(s.pairs);
    free(s.deepest);
    return status;
}
