/* Where a point stands to a face of a body: how far, on which side, and over which of its points.
 *
 *        d---------c      A face is taken as four flat triangles around its centre m, the mean of
 *        | \     / |      its corners. The closest point of the closest triangle has weights in
 *        |   \ /   |      that triangle; m's is shared out evenly. So
 *        |    m    |          sum w_a = 1,   sum w_a x_a = the point,
 *        |   / \   |      and forces w_a F on the corners and -F on the other point, along the line
 *        | /     \ |      between the two, balance in force and in moment (T figure 2.7 a).
 *        a---------b
 *
 * Why triangles: the closest point of a bilinear face needs an iteration, of a triangle it is
 * found in closed form, and the surface has no gaps between neighbouring faces either way.
 *
 * Which side. The sign of the distance to a closed surface is that of the height over the plane of
 * the closest triangle, if that is unique. On an edge of two, the planes may disagree; the one over
 * or under which the point is farthest has the right sign (its plane lies most squarely to the way
 * from the point to the edge). In a corner of several, two of them count: those at the edge that
 * turns most towards the point. Seen from the corner, all edges and planes are at least a right
 * angle away from the point, so the way to the nearest of them ends at that edge and crosses no
 * other: the planes beside it say which side it is. That decides between the triangles of a face
 * here, and between faces in lar_face_point_before.
 */
#ifndef LAR_MECHANICS_FACE_CONTACT_H
#define LAR_MECHANICS_FACE_CONTACT_H

#include <stdbool.h>
#include <stdint.h>

#include "mechanics/contact.h"

typedef struct lar_face_point {
    double distance;  /* from the point to the closest one of the face, at least 0 [m] */
    double height;    /* of the point over the plane of that triangle, negative inside [m] */
    double toward;    /* cosine between the way to the point and the way along the triangle that
                         comes closest to it: 0 but where the closest point is a corner */
    double weight[4]; /* of the corners */
    int triangle;     /* at corners `triangle` and the next */
    double next;      /* the distance of the closest one of the others [m] */
} lar_face_point;

/* Distances closer to each other than this part of the size of a face are equal: rounding must not
 * choose between two planes. */
#define LAR_FACE_TIE 1e-9
/* And such cosines. */
#define LAR_TOWARD_TIE 1e-6

/* The distance alone. `corner` counter-clockwise seen from outside. */
double lar_face_distance(const double x[3], const double corner[4][3]);

/* The distance of the box around a face: the face is no nearer. */
static inline double lar_face_box_distance(const double x[3], const double corner[4][3]) {
    double square = 0;
    for (int i = 0; i < 3; i++) {
        double low = corner[0][i], high = low;
        for (int a = 1; a < 4; a++) {
            low = corner[a][i] < low ? corner[a][i] : low;
            high = corner[a][i] > high ? corner[a][i] : high;
        }
        double away = x[i] < low ? low - x[i] : x[i] > high ? x[i] - high : 0;
        square += away * away;
    }
    return sqrt(square);
}

/* The closest point of a face to x. Triangles whose distance exceeds the smallest by no more than
 * `tie` [m] count as equally close. Faces without area are as good as any, at height 0. */
void lar_face_closest(const double x[3], const double corner[4][3], double tie,
                      lar_face_point *point);

/* How much x and the corners may move against each other [m] while x stays before the planes of all
 * four triangles; 0 where it is not. */
double lar_face_before(const double x[3], const double corner[4][3]);

/* How much ways between nodes, x among them, may change [m] while `face` does not decide on which
 * side x is, because `front`, which shares its edge from corner `edge` to the next one and which x
 * is before, does: all of the face is turned away from x behind that edge, so the closest point of
 * it is on the edge, and x is farther over the plane of `front` than under that of the face. 0: it
 * may decide. So a node that is straight before the edge of a block need not be looked at in every
 * step, although it is in the plane of the block's side. */
double lar_face_outdone(const double x[3], const double face[4][3], int edge,
                        const double front[4][3]);

/* Where a segment comes closest to a face, or nearly so. */
typedef struct lar_face_segment {
    double distance;  /* at least 0; 0 where the segment goes through the face [m] */
    double along;     /* where on the segment, 0 to 1 */
    double weight[4]; /* of the corners in the point of the face */
    double normal[3]; /* unit, from the segment to that point; 0 where the distance is 0 */
} lar_face_segment;

/* To each of its triangles. Of a triangle along which the segment lies many points are as close as
 * each other, and the closest one runs from one end to the other when it turns by next to nothing.
 * So where it is closer than `reach` it is asked for that point of the segment which is the mean of
 * where it is closest to the triangle's edges and of its ends, the deeper (reach less distance) the
 * more, those more than half as deep as the deepest; so that no point jumps (theory.md, tools).
 * Not so where it goes through. Returns the least distance. */
double lar_face_segment_closest(const lar_segment *segment, const double corner[4][3], double reach,
                                lar_face_segment closest[4]);

/* Points of a face by the weights of its corners, component by component. What fills the last four
 * is the last point again. */
enum { LAR_FACE_GRID_MAX = 36 };
typedef struct lar_face_grid {
    int32_t count, padding;
    double weight[4][LAR_FACE_GRID_MAX];
} lar_face_grid;

/* How they stand to a segment. */
typedef struct lar_face_near {
    uint64_t points; /* which are near it, a bit each; and of these, as lar_segment_away: */
    double away[3][LAR_FACE_GRID_MAX], along[LAR_FACE_GRID_MAX], square[LAR_FACE_GRID_MAX];
    double least; /* square of the least distance of all; INFINITY: there are no numbers [m^2] */
} lar_face_near;

/* Near: closer than the square root of `within` [m^2]. */
void lar_face_grid_near(const lar_segment *segment, const double corner[4][3],
                        const lar_face_grid *grid, double within, lar_face_near *near);

/* A point of the surface that moves smoothly where the closest one jumps: the mean of the closest
 * points of all triangles that are about as close to x as the closest of all, `min` away. Adds
 * those of one face: to sum[] their weights of its corners, times how much each of them counts, all
 * of which is returned, and to *far their distances [m], times the same. A triangle counts
 * 1 - (distance - min) / fade times how far within it the foot of x is, and a little more, which
 * goes to nothing as far outside; the closest one counts wherever the foot is. */
double lar_face_blend(const double x[3], const double corner[4][3], double min, double fade,
                      double sum[4], double *far);

/* The slopes of a number that is `value` at the corners of a face and, last, in its middle, linear
 * in the triangles: with the places of the corners and, last, with x [1/m]. Forces and moments that
 * balance, as those of any potential of the five places. */
__attribute__((cold)) void lar_face_slope(const double x[3], const double corner[4][3],
                                          const lar_face_point *point, const double value[5],
                                          double slope[5][3]);

/* Whether a decides before b, both being equally close. */
static inline bool lar_face_point_before(const lar_face_point *a, const lar_face_point *b) {
    double more = a->toward - b->toward;
    if (more > LAR_TOWARD_TIE || more < -LAR_TOWARD_TIE) return more > 0;
    double over = a->height < 0 ? -a->height : a->height;
    double under = b->height < 0 ? -b->height : b->height;
    return over > under;
}

#endif
