#include "mechanics/face_contact.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/face_parts.h"

static void between(const double from[3], const double to[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = to[i] - from[i];
}

/* A share of two numbers that add up to `whole`, which is 0 where an edge has no length. */
static double share(double part, double whole) {
    return whole > 0 ? part / whole : 0;
}

/* Weights of b and c in the point of the triangle a b c that is closest to x: a corner, a point of
 * an edge, or the foot of the perpendicular, by the signs of the projections of x - corner on the
 * edges and of the areas that the foot cuts off (Ericson, Real-Time Collision Detection, 2005,
 * 5.1.5 has the regions). */
static void closest_of_triangle(const double x[3], const double a[3], const double b[3],
                                const double c[3], double *wb, double *wc) {
    double ab[3], ac[3], from_a[3], from_b[3], from_c[3];
    between(a, b, ab);
    between(a, c, ac);
    between(a, x, from_a);
    between(b, x, from_b);
    between(c, x, from_c);
    double a_ab = lar_dot(ab, from_a), a_ac = lar_dot(ac, from_a);
    double b_ab = lar_dot(ab, from_b), b_ac = lar_dot(ac, from_b);
    double c_ab = lar_dot(ab, from_c), c_ac = lar_dot(ac, from_c);
    double area_c = a_ab * b_ac - b_ab * a_ac; /* opposite to c, times the area of the whole */
    double area_b = c_ab * a_ac - a_ab * c_ac;
    double area_a = b_ab * c_ac - c_ab * b_ac;
    *wb = *wc = 0;
    if (a_ab <= 0 && a_ac <= 0) return;
    if (b_ab >= 0 && b_ac <= b_ab) {
        *wb = 1;
    } else if (c_ac >= 0 && c_ab <= c_ac) {
        *wc = 1;
    } else if (area_c <= 0 && a_ab >= 0 && b_ab <= 0) {
        *wb = share(a_ab, a_ab - b_ab);
    } else if (area_b <= 0 && a_ac >= 0 && c_ac <= 0) {
        *wc = share(a_ac, a_ac - c_ac);
    } else if (area_a <= 0 && b_ac - b_ab >= 0 && c_ab - c_ac >= 0) {
        *wc = share(b_ac - b_ab, (b_ac - b_ab) + (c_ab - c_ac));
        *wb = 1 - *wc;
    } else {
        double whole = area_a + area_b + area_c;
        *wb = share(area_b, whole);
        *wc = share(area_c, whole);
    }
}

/* The closest point of triangle t: corners t, t + 1 and the middle. */
static void closest_of_part(const double x[3], const double corner[4][3], const double middle[3],
                            int t, double weight[4]) {
    int next = (t + 1) % 4;
    double wb, wc;
    closest_of_triangle(x, corner[t], corner[next], middle, &wb, &wc);
    for (int a = 0; a < 4; a++) weight[a] = 0.25 * wc;
    weight[next] += wb;
    weight[t] += 1 - wb - wc;
}

static double distance_to(const double x[3], const double corner[4][3], const double weight[4]) {
    double point[3], away[3];
    lar_face_mean(corner, weight, point);
    between(point, x, away);
    return sqrt(lar_dot(away, away));
}

/* Of x over the plane of triangle t, seen from a point of the triangle. */
static double height_over(const double x[3], const double corner[4][3], const double middle[3],
                          int t, const double weight[4]) {
    double point[3], away[3], to_next[3], to_middle[3], normal[3];
    lar_face_mean(corner, weight, point);
    between(point, x, away);
    between(corner[t], corner[(t + 1) % 4], to_next);
    between(corner[t], middle, to_middle);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = to_next[j] * to_middle[k] - to_next[k] * to_middle[j];
    }
    double length = sqrt(lar_dot(normal, normal));
    return length > 0 ? lar_dot(away, normal) / length : 0;
}

/* See lar_face_point.toward: the ways along a triangle lie between those to its corners. The
 * closest point is a corner where one of its weights, exactly, is 1. */
static double toward_of(const double x[3], const double corner[4][3], const double middle[3], int t,
                        const double weight[4], double tie) {
    int next = (t + 1) % 4, other = (t + 2) % 4;
    bool is_middle = weight[other] == 0.25 && weight[t] == 0.25 && weight[next] == 0.25;
    if (weight[t] != 1 && weight[next] != 1 && !is_middle) return 0;
    const double *ends[3] = {corner[t], corner[next], middle};
    double point[3], away[3], along[3], max = -1;
    lar_face_mean(corner, weight, point);
    between(point, x, away);
    double distance = sqrt(lar_dot(away, away));
    for (int i = 0; i < 3; i++) {
        between(point, ends[i], along);
        double length = sqrt(lar_dot(along, along));
        if (length > tie && distance > 0)
            max = fmax(max, lar_dot(along, away) / (length * distance));
    }
    return max;
}

static void middle_of(const double corner[4][3], double middle[3]) {
    static const double even[4] = {0.25, 0.25, 0.25, 0.25};
    lar_face_mean(corner, even, middle);
}

void lar_face_parts_one_by_one(const double x[3], const double corner[4][3], const double middle[3],
                               lar_face_parts *parts) {
    for (int t = 0; t < 4; t++) {
        closest_of_part(x, corner, middle, t, parts->weight[t]);
        parts->distance[t] = distance_to(x, corner, parts->weight[t]);
        parts->height[t] = height_over(x, corner, middle, t, parts->weight[t]);
    }
}

static inline void closest_of_parts(const double x[3], const double corner[4][3],
                                    const double middle[3], lar_face_parts *parts) {
#if defined(LAR_HAVE_FACE_LANES)
    if (lar_face_lanes()) {
        lar_face_parts_in_lanes(x, corner, middle, parts);
        return;
    }
#endif
    lar_face_parts_one_by_one(x, corner, middle, parts);
}

double lar_face_distance(const double x[3], const double corner[4][3]) {
    double middle[3], min = INFINITY;
    lar_face_parts parts;
    middle_of(corner, middle);
    closest_of_parts(x, corner, middle, &parts);
    for (int t = 0; t < 4; t++) min = fmin(min, parts.distance[t]);
    return min;
}

void lar_face_closest(const double x[3], const double corner[4][3], double tie,
                      lar_face_point *point) {
    double middle[3], min = INFINITY;
    lar_face_parts parts;
    middle_of(corner, middle);
    closest_of_parts(x, corner, middle, &parts);
    for (int t = 0; t < 4; t++) min = fmin(min, parts.distance[t]);
    int chosen = -1; /* stays so where there are no numbers */
    lar_face_point part, best = {.height = NAN, .toward = NAN};
    for (int t = 0; t < 4; t++) {
        if (!(parts.distance[t] <= min + tie)) continue;
        part.height = parts.height[t];
        part.toward = toward_of(x, corner, middle, t, parts.weight[t], tie);
        if (chosen >= 0 && !lar_face_point_before(&part, &best)) continue;
        best.height = part.height;
        best.toward = part.toward;
        chosen = t;
    }
    point->triangle = chosen >= 0 ? chosen : 0;
    point->distance = parts.distance[point->triangle];
    point->height = best.height;
    point->toward = best.toward;
    point->next = INFINITY;
    for (int t = 0; t < 4; t++)
        if (t != point->triangle) point->next = fmin(point->next, parts.distance[t]);
    memcpy(point->weight, parts.weight[point->triangle], sizeof point->weight);
}

/* Six times the volume of x over a triangle is a determinant of three ways. When each of them
 * changes by at most e it changes by at most (l1 + e)(l2 + e)(l3 + e) - l1 l2 l3 (Hadamard); the e
 * at which that is all of it is at least what one step from an upper bound gives. */
double lar_face_before_one_by_one(const double x[3], const double corner[4][3],
                                  const double middle[3]) {
    double min = INFINITY;
    for (int t = 0; t < 4; t++) {
        double a[3], b[3], c[3], volume = 0;
        between(corner[t], corner[(t + 1) % 4], a);
        between(corner[t], middle, b);
        between(corner[t], x, c);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            volume += c[i] * (a[j] * b[k] - a[k] * b[j]);
        }
        if (!(volume > 0)) return 0;
        double la = sqrt(lar_dot(a, a)), lb = sqrt(lar_dot(b, b)), lc = sqrt(lar_dot(c, c));
        double areas = la * lb + lb * lc + lc * la, most = volume / areas;
        min = fmin(min, volume / (areas + most * (la + lb + lc + most)));
    }
    return min;
}

double lar_face_before(const double x[3], const double corner[4][3]) {
    double middle[3];
    middle_of(corner, middle);
#if defined(LAR_HAVE_FACE_LANES)
    if (lar_face_lanes()) return lar_face_before_in_lanes(x, corner, middle);
#endif
    return lar_face_before_one_by_one(x, corner, middle);
}

/* ---- what decides at an edge ----------------------------------------------------------------- */

/* Below, ways between nodes change by e at most, which is so small that second orders are no more
 * than the first: e is halved for them in the end. */

/* Until the closest point to x of what lies behind an edge, at q now, may leave the edge: some of
 * (y - q) (x - q) is no longer negative. q and x change by `rate` e against y. */
static double edge_is_closest(const double x[3], const double q[3], const double y[3],
                              double rate) {
    double to_y[3], to_x[3];
    between(q, y, to_y);
    between(q, x, to_x);
    double behind = -lar_dot(to_y, to_x);
    if (!(behind > 0)) return 0;
    double lengths = lar_length(to_y) + lar_length(to_x);
    return behind / (lengths + behind / lengths) / rate;
}

/* Of the ways from `end`, a corner of a face, along it the one that comes closest to the way to x,
 * which decides where the closest point is that corner (lar_face_point.toward). */
static void best_way(const double x[3], const double end[3], const double face[4][3],
                     double best[3]) {
    double middle[3], to_x[3], way[3], max = -INFINITY;
    middle_of(face, middle);
    between(end, x, to_x);
    int at = 0;
    while (at < 3 && memcmp(face[at], end, 3 * sizeof *end)) at++;
    const double *to[3] = {face[(at + 1) % 4], face[(at + 3) % 4], middle};
    for (int i = 0; i < 3; i++) {
        between(end, to[i], way);
        double turned = lar_dot(way, to_x) / lar_length(way);
        if (!(turned > max)) continue;
        max = turned;
        memcpy(best, way, sizeof way);
    }
}

/* Until that to y may come closer than `way`. Not inlined: three of it take room, and no time. */
static __attribute__((noinline)) double turns_most(const double x[3], const double end[3],
                                                   const double way[3], const double y[3]) {
    double to_y[3], to_x[3];
    between(end, y, to_y);
    between(end, x, to_x);
    double far = lar_length(to_x), length = lar_length(to_y), best = lar_length(way);
    double more = lar_dot(way, to_x) / best - lar_dot(to_y, to_x) / length;
    return more > 0 ? more / (2 + 2 * far / best + 2 * far / length) : 0;
}

/* The least height of x over the planes of a face's triangles, and by how much e changes it. */
static double least_height(const double x[3], const double corner[4][3], double *rate) {
    double middle[3], min = INFINITY;
    middle_of(corner, middle);
    *rate = 0;
    for (int t = 0; t < 4; t++) {
        double a[3], b[3], c[3], normal[3];
        between(corner[t], corner[(t + 1) % 4], a);
        between(corner[t], middle, b);
        between(corner[t], x, c);
        lar_cross(a, b, normal);
        double twice = lar_length(normal);
        if (!(twice > 0)) return -INFINITY;
        min = fmin(min, lar_dot(c, normal) / twice);
        *rate = fmax(*rate, 1 + 2 * lar_length(c) * (lar_length(a) + lar_length(b)) / twice);
    }
    return min;
}

double lar_face_outdone(const double x[3], const double face[4][3], int edge,
                        const double front[4][3]) {
    const double *end[2] = {face[edge], face[(edge + 1) % 4]};
    double middle[3], along[3], best[3] = {0}, u[3], q[3], to_x[3], rate[2];
    middle_of(face, middle);
    const double *others[3] = {face[(edge + 2) % 4], face[(edge + 3) % 4], middle};
    between(end[0], end[1], along);
    between(end[0], x, u);
    double length = lar_length(along), part = lar_dot(u, along) / (length * length);
    if (!(length > 0)) return 0;
    part = fmin(fmax(part, 0), 1);
    for (int i = 0; i < 3; i++) q[i] = end[0][i] + part * along[i];
    between(q, x, to_x);
    double slide = 3 + 4 * lar_length(u) / length,
           until = fmin(0.5 * lar_length(to_x), 0.25 * length);
    for (int k = 0; k < 3; k++) until = fmin(until, edge_is_closest(x, q, others[k], slide));
    for (int k = 0; k < 2; k++) {
        double inside = (k == 0 ? part : 1 - part) * length / slide, turned = INFINITY;
        if (inside >= until) continue;
        best_way(x, end[k], front, best);
        for (int i = 0; i < 3; i++) turned = fmin(turned, turns_most(x, end[k], best, others[i]));
        until = fmin(until, fmax(inside, turned));
        if (!(until > 0)) return 0;
    }
    double height = least_height(x, front, &rate[0]) + least_height(x, face, &rate[1]);
    return height > 0 ? 0.5 * fmin(until, height / (rate[0] + rate[1])) : 0;
}

lar_face_finders lar_face_finders_here(void) {
#if defined(LAR_HAVE_FACE_LANES)
    if (lar_face_lanes())
        return (lar_face_finders){lar_face_parts_in_lanes, lar_face_before_in_lanes,
                                  lar_face_segment_in_lanes, lar_face_grid_in_lanes};
#endif
    return (lar_face_finders){lar_face_parts_one_by_one, lar_face_before_one_by_one,
                              lar_face_segment_one_by_one, lar_face_grid_one_by_one};
}

/* ---- segments ------------------------------------------------------------------------------- */

/* Takes a point of the face, by its weights, where it is closer than what was found before. Returns
 * how far it is. */
static double offer(const lar_segment *segment, const double corner[4][3], double along,
                    const double weight[4], lar_face_segment *closest) {
    double point[3], away[3];
    lar_face_mean(corner, weight, point);
    for (int i = 0; i < 3; i++) {
        double on = segment->end[0][i] + along * (segment->end[1][i] - segment->end[0][i]);
        away[i] = point[i] - on;
    }
    double distance = sqrt(lar_dot(away, away));
    if (!(distance < closest->distance)) return distance;
    closest->distance = distance;
    closest->along = along;
    memcpy(closest->weight, weight, sizeof closest->weight);
    for (int i = 0; i < 3; i++) closest->normal[i] = distance > 0 ? away[i] / distance : 0;
    return distance;
}

static double clamp(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* The closest points of two segments p + s d1, q + t d2 (Ericson 2005, 5.1.9); and the s of points
 * that are nearly as close and do not run away where both are nearly parallel: to the square of the
 * distance is added `stiff` over that of d2's length times that of how far s is from the middle. */
static void closest_of_segments(const double p[3], const double d1[3], const double q[3],
                                const double d2[3], double stiff, double *s, double *t,
                                double *steady) {
    double r[3];
    between(q, p, r);
    double a = lar_dot(d1, d1), e = lar_dot(d2, d2), f = lar_dot(d2, r), c = lar_dot(d1, r),
           b = lar_dot(d1, d2);
    double denominator = a * e - b * b;
    *s = denominator > 0 ? clamp((b * f - c * e) / denominator) : 0;
    *t = e > 0 ? (b * *s + f) / e : 0;
    if (*t < 0 || *t > 1) {
        *t = clamp(*t);
        *s = a > 0 ? clamp((b * *t - c) / a) : 0;
    }
    double pull = stiff * (0.5 * b - c), all = a * (e + stiff);
    double at = clamp((b * f - c * e + pull) / (all - b * b));
    double part = e > 0 ? clamp((b * at + f) / e) : 0;
    *steady = clamp(((b * part - c) * e + pull) / all);
}

/* Where on the segment the closest points of a triangle are, and how far [m]. */
typedef struct lar_face_stations {
    double along[5], distance[5];
} lar_face_stations;

/* Against the edge of triangle t from `from` to `to`, points of the face by their weights. */
static void offer_edge(const lar_segment *segment, const double corner[4][3], const double from[4],
                       const double to[4], double stiff, lar_face_segment *closest, double *along,
                       double *distance) {
    double begin[3], end[3], d1[3], d2[3], weight[4], at, part;
    lar_face_mean(corner, from, begin);
    lar_face_mean(corner, to, end);
    between(segment->end[0], segment->end[1], d1);
    between(begin, end, d2);
    closest_of_segments(segment->end[0], d1, begin, d2, stiff, &at, &part, along);
    for (int a = 0; a < 4; a++) weight[a] = (1 - part) * from[a] + part * to[a];
    *distance = offer(segment, corner, at, weight, closest);
}

/* The point of triangle t that is closest to a point of the segment's line. */
static void offer_station(const lar_segment *segment, const double corner[4][3],
                          const double middle[3], int t, double along, lar_face_segment *closest) {
    double weight[4], on[3], wb, wc;
    for (int i = 0; i < 3; i++)
        on[i] = segment->end[0][i] + along * (segment->end[1][i] - segment->end[0][i]);
    int next = (t + 1) % 4;
    closest_of_triangle(on, corner[t], corner[next], middle, &wb, &wc);
    for (int a = 0; a < 4; a++) weight[a] = 0.25 * wc;
    weight[next] += wb;
    weight[t] += 1 - wb - wc;
    offer(segment, corner, along, weight, closest);
}

/* Where the segment goes through triangle t, if it does. */
static bool offer_crossing(const lar_segment *segment, const double corner[4][3],
                           const double middle[3], int t, lar_face_segment *closest) {
    double weight[4] = {0.25, 0.25, 0.25, 0.25};
    double below = height_over(segment->end[0], corner, middle, t, weight);
    double above = height_over(segment->end[1], corner, middle, t, weight);
    if (!(below * above < 0)) return false;
    offer_station(segment, corner, middle, t, below / (below - above), closest);
    return true;
}

/* The mean of all stations that are less than half as deep again. */
static void steady(const lar_segment *segment, const double corner[4][3], const double middle[3],
                   int t, double reach, const lar_face_stations *list, lar_face_segment *closest) {
    double least = 0.5 * (reach + closest->distance), all = 0, along = 0;
    for (int k = 0; k < 5; k++) {
        double count = least - list->distance[k];
        if (!(count > 0)) continue;
        all += count;
        along += count * list->along[k];
    }
    closest->distance = INFINITY;
    offer_station(segment, corner, middle, t, along / all, closest);
}

double lar_face_segment_one_by_one(const lar_segment *segment, const double corner[4][3],
                                   const double middle[3], double reach,
                                   lar_face_segment closest[4]) {
    static const double at_corner[4][4] = {{1}, {0, 1}, {0, 0, 1}, {0, 0, 0, 1}},
                        at_middle[4] = {0.25, 0.25, 0.25, 0.25};
    bool is_point = lar_segment_is_point(segment);
    double least = INFINITY, stiff = 0.5 * reach * reach;
    for (int t = 0; t < 4; t++) {
        const double *edge[3][2] = {{at_corner[t], at_corner[(t + 1) % 4]},
                                    {at_corner[t], at_middle},
                                    {at_corner[(t + 1) % 4], at_middle}};
        double weight[4];
        lar_face_stations list = {.along = {0, 1}};
        lar_face_segment *of = &closest[t];
        *of = (lar_face_segment){.distance = INFINITY};
        for (int e = 0; e < (is_point ? 1 : 2); e++) {
            closest_of_part(segment->end[e], corner, middle, t, weight);
            list.distance[e] = offer(segment, corner, e, weight, of);
        }
        for (int e = 0; e < 3 && !is_point; e++)
            offer_edge(segment, corner, edge[e][0], edge[e][1], stiff, of, &list.along[2 + e],
                       &list.distance[2 + e]);
        bool crosses = !is_point && offer_crossing(segment, corner, middle, t, of);
        least = fmin(least, of->distance);
        if (!is_point && !crosses && of->distance < reach)
            steady(segment, corner, middle, t, reach, &list, of);
    }
    return least;
}

double lar_face_segment_closest(const lar_segment *segment, const double corner[4][3], double reach,
                                lar_face_segment closest[4]) {
    double middle[3];
    middle_of(corner, middle);
#if defined(LAR_HAVE_FACE_LANES)
    if (lar_face_lanes()) return lar_face_segment_in_lanes(segment, corner, middle, reach, closest);
#endif
    return lar_face_segment_one_by_one(segment, corner, middle, reach, closest);
}

/* ---- grids ---------------------------------------------------------------------------------- */

void lar_face_grid_one_by_one(const lar_segment *segment, const double corner[4][3],
                              const lar_face_grid *grid, double within, lar_face_near *near) {
    const lar_segment_axis axis = lar_segment_axis_of(segment);
    near->points = 0;
    near->least = INFINITY;
    for (int p = 0; p < grid->count; p++) {
        double weight[4], x[3], away[3];
        for (int a = 0; a < 4; a++) weight[a] = grid->weight[a][p];
        lar_face_mean(corner, weight, x);
        double square = lar_segment_away(segment, &axis, x, away, &near->along[p]);
        for (int i = 0; i < 3; i++) near->away[i][p] = away[i];
        near->square[p] = square;
        if (square < near->least) near->least = square;
        if (square < within) near->points |= UINT64_C(1) << p;
    }
}

void lar_face_grid_near(const lar_segment *segment, const double corner[4][3],
                        const lar_face_grid *grid, double within, lar_face_near *near) {
#if defined(LAR_HAVE_FACE_LANES)
    if (lar_face_lanes()) {
        lar_face_grid_in_lanes(segment, corner, grid, within, near);
        return;
    }
#endif
    lar_face_grid_one_by_one(segment, corner, grid, within, near);
}

/* ---- smoothly from face to face ------------------------------------------------------------- */

static const double NOTHING = 1e-12; /* of a corner's shares */

/* Slopes of the shares of a triangle's corners in its plane: across the side opposite to each. */
static void triangle_slopes(const double corner[3][3], double slope[3][3]) {
    for (int c = 0; c < 3; c++) {
        double side[3], up[3];
        between(corner[(c + 1) % 3], corner[(c + 2) % 3], side);
        between(corner[(c + 1) % 3], corner[c], up);
        double along = share(lar_dot(up, side), lar_dot(side, side));
        for (int i = 0; i < 3; i++) up[i] -= along * side[i];
        double square = lar_dot(up, up);
        for (int i = 0; i < 3; i++) slope[c][i] = share(up[i], square);
    }
}

/* How far from its sides the foot of x is within a triangle, and `more`, which goes to nothing as
 * far outside: who passes a side to a triangle beside it counts as much there. Past the end of a
 * surface the foot is outside of all, and none of the closest is: they share a side or a corner. */
static double within(const double x[3], const double corner[4][3], const double middle[3], int t,
                     const double weight[4], double distance, double more, double closest) {
    int next = (t + 1) % 4, other = (t + 2) % 4;
    double place[3][3], slope[3][3], min = INFINITY;
    double part[3] = {weight[t] - weight[other], weight[next] - weight[other], 4 * weight[other]};
    memcpy(place[0], corner[t], sizeof place[0]);
    memcpy(place[1], corner[next], sizeof place[1]);
    memcpy(place[2], middle, sizeof place[2]);
    if (part[0] > NOTHING && part[1] > NOTHING && part[2] > NOTHING) {
        triangle_slopes((const double(*)[3])place, slope);
        for (int c = 0; c < 3; c++)
            min = fmin(min, share(part[c], sqrt(lar_dot(slope[c], slope[c]))));
        return more + min;
    }
    double from = fmax(fabs(height_over(x, corner, middle, t, weight)), closest);
    return fmax(more - sqrt(fmax(distance * distance - from * from, 0)), 0);
}

double lar_face_blend(const double x[3], const double corner[4][3], double min, double fade,
                      double sum[4], double *far) {
    static const double MORE = 0.2; /* of the fade */
    double middle[3], all = 0;
    lar_face_parts parts;
    middle_of(corner, middle);
    closest_of_parts(x, corner, middle, &parts);
    for (int t = 0; t < 4; t++) {
        const double *weight = parts.weight[t];
        double distance = parts.distance[t];
        double count = 1 - (distance - min) / fade;
        if (!(count > 0)) continue;
        count *= within(x, corner, middle, t, weight, distance, MORE * fade, min);
        if (!(count > 0)) continue;
        for (int a = 0; a < 4; a++) sum[a] += count * weight[a];
        *far += count * distance;
        all += count;
    }
    return all;
}

/* ---- fading --------------------------------------------------------------------------------- */

/* The same where the closest point is on a side: along that; in a corner it stays. */
static void side_slopes(const double corner[3][3], const bool has[3], double slope[3][3]) {
    memset(slope, 0, 3 * sizeof *slope);
    for (int c = 0; c < 3; c++) {
        int next = (c + 1) % 3;
        if (!has[c] || !has[next]) continue;
        double side[3];
        between(corner[c], corner[next], side);
        double square = lar_dot(side, side);
        for (int i = 0; i < 3; i++) {
            slope[next][i] = share(side[i], square);
            slope[c][i] = -slope[next][i];
        }
    }
}

/* Shares of corner t, the next one, and the middle. */
static void shares_of(const lar_face_point *point, double part[3]) {
    int t = point->triangle, other = (t + 2) % 4;
    part[0] = point->weight[t] - point->weight[other];
    part[1] = point->weight[(t + 1) % 4] - point->weight[other];
    part[2] = 4 * point->weight[other];
}

void lar_face_slope(const double x[3], const double corner[4][3], const lar_face_point *point,
                    const double value[5], double slope[5][3]) {
    int t = point->triangle, next = (t + 1) % 4;
    double place[3][3], of[3][3], at[3], away[3], part[3];
    const double values[3] = {value[t], value[next], value[4]};
    bool has[3];
    shares_of(point, part);
    memcpy(place[0], corner[t], sizeof place[0]);
    memcpy(place[1], corner[next], sizeof place[1]);
    middle_of(corner, place[2]);
    for (int c = 0; c < 3; c++) has[c] = part[c] > NOTHING;
    if (has[0] && has[1] && has[2])
        triangle_slopes((const double(*)[3])place, of);
    else
        side_slopes((const double(*)[3])place, has, of);
    lar_face_mean(corner, point->weight, at);
    between(at, x, away);
    memset(slope, 0, 5 * sizeof *slope);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++) slope[4][i] += values[c] * of[c][i];
    /* Turning the triangle moves the foot of x as well. */
    for (int c = 0; c < 3; c++) {
        double turn = lar_dot(slope[4], of[c]);
        for (int i = 0; i < 3; i++) {
            double own = turn * away[i] - part[c] * slope[4][i];
            for (int a = 0; a < 4; a++)
                slope[a][i] += c == 2 ? 0.25 * own : a == (c == 0 ? t : next) ? own : 0;
        }
    }
}
