/* A lane for each of a face's four triangles (face_parts.h). */
#include <math.h>
#include <stdint.h>

#include "mechanics/face_parts.h"

typedef double four __attribute__((vector_size(32)));
typedef int64_t four_bits __attribute__((vector_size(32)));
typedef four four_anywhere __attribute__((aligned(8), may_alias));

/* Lanes of a, 0 to 3, and b, 4 to 7. */
#define MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

static inline four all(double value) {
    return (four){value, value, value, value};
}

static inline four choose(four_bits yes, four a, four b) {
    return (four)((yes & (four_bits)a) | (~yes & (four_bits)b));
}

static inline four dot(const four a[3], const four b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline four root(four a) {
    for (int t = 0; t < 4; t++) a[t] = sqrt(a[t]);
    return a;
}

static inline four share(four part, four whole) {
    return choose(whole > 0, part / whole, all(0));
}

/* Of triangle t its own corner, its edges to the next corner and to the middle, and the way from
 * its own corner to x. */
typedef struct triangles {
    four x[3], own[3], next[3], middle[3];
    four to_next[3], to_middle[3], to_x[3];
} triangles;

static inline void look_up(const double x[3], const double corner[4][3], const double middle[3],
                           triangles *of) {
    for (int i = 0; i < 3; i++) {
        of->x[i] = all(x[i]);
        of->middle[i] = all(middle[i]);
        of->own[i] = (four){corner[0][i], corner[1][i], corner[2][i], corner[3][i]};
        of->next[i] = MIX(of->own[i], of->own[i], 1, 2, 3, 0);
        of->to_next[i] = of->next[i] - of->own[i];
        of->to_middle[i] = of->middle[i] - of->own[i];
        of->to_x[i] = of->x[i] - of->own[i];
    }
}

/* closest_of_triangle (face_contact.c): one quotient for each weight, what is divided is chosen
 * from the last case to the first. */
static inline void closest_of(const triangles *of, four *wb, four *wc) {
    const four *ab = of->to_next, *ac = of->to_middle;
    four from_b[3], from_c[3];
    for (int i = 0; i < 3; i++) {
        from_b[i] = of->x[i] - of->next[i];
        from_c[i] = of->x[i] - of->middle[i];
    }
    four a_ab = dot(ab, of->to_x), a_ac = dot(ac, of->to_x);
    four b_ab = dot(ab, from_b), b_ac = dot(ac, from_b);
    four c_ab = dot(ab, from_c), c_ac = dot(ac, from_c);
    four area_c = a_ab * b_ac - b_ab * a_ac;
    four area_b = c_ab * a_ac - a_ab * c_ac;
    four area_a = b_ab * c_ac - c_ab * b_ac;
    four whole = area_a + area_b + area_c, up = b_ac - b_ab, down = c_ab - c_ac;
    four_bits on_ab = (area_c <= 0) & (a_ab >= 0) & (b_ab <= 0);
    four_bits on_ac = (area_b <= 0) & (a_ac >= 0) & (c_ac <= 0) & ~on_ab;
    four_bits on_bc = (area_a <= 0) & (up >= 0) & (down >= 0) & ~on_ab & ~on_ac;
    four b = share(choose(on_ab, a_ab, area_b), choose(on_ab, a_ab - b_ab, whole));
    four c = share(choose(on_ac, a_ac, choose(on_bc, up, area_c)),
                   choose(on_ac, a_ac - c_ac, choose(on_bc, up + down, whole)));
    c = choose(on_ab, all(0), c);
    b = choose(on_ac, all(0), choose(on_bc, 1 - c, b));
    four_bits at_a = (a_ab <= 0) & (a_ac <= 0);
    four_bits at_b = (b_ab >= 0) & (b_ac <= b_ab);
    four_bits at_c = (c_ac >= 0) & (c_ab <= c_ac) & ~at_b;
    b = choose(at_b, all(1), choose(at_c, all(0), b));
    c = choose(at_c, all(1), choose(at_b, all(0), c));
    *wb = choose(at_a, all(0), b);
    *wc = choose(at_a, all(0), c);
}

/* Weights of the face's corners, for each triangle, of those of its own one, the next one and both
 * others. */
static inline void corners_of(four own, four next, four rest, four weight[4]) {
    weight[0] = MIX(MIX(rest, own, 4, 1, 2, 3), next, 0, 1, 2, 7);
    weight[1] = MIX(MIX(rest, own, 0, 5, 2, 3), next, 4, 1, 2, 3);
    weight[2] = MIX(MIX(rest, own, 0, 1, 6, 3), next, 0, 5, 2, 3);
    weight[3] = MIX(MIX(rest, own, 0, 1, 2, 7), next, 0, 1, 6, 3);
}

static inline void weights_of(four wb, four wc, four weight[4]) {
    four rest = 0.25 * wc;
    corners_of(rest + (1 - wb - wc), rest + wb, rest, weight);
}

/* A row for each lane. */
static inline void store_rows(const four of[4], double row[4][4]) {
    four low[2] = {MIX(of[0], of[1], 0, 4, 2, 6), MIX(of[2], of[3], 0, 4, 2, 6)};
    four high[2] = {MIX(of[0], of[1], 1, 5, 3, 7), MIX(of[2], of[3], 1, 5, 3, 7)};
    *(four_anywhere *)row[0] = MIX(low[0], low[1], 0, 1, 4, 5);
    *(four_anywhere *)row[1] = MIX(high[0], high[1], 0, 1, 4, 5);
    *(four_anywhere *)row[2] = MIX(low[0], low[1], 2, 3, 6, 7);
    *(four_anywhere *)row[3] = MIX(high[0], high[1], 2, 3, 6, 7);
}

static inline void cross(const four a[3], const four b[3], four out[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

void lar_face_parts_in_lanes(const double x[3], const double corner[4][3], const double middle[3],
                             lar_face_parts *parts) {
    triangles of;
    four wb, wc, weight[4], away[3], normal[3];
    look_up(x, corner, middle, &of);
    closest_of(&of, &wb, &wc);
    weights_of(wb, wc, weight);
    for (int i = 0; i < 3; i++)
        away[i] = of.x[i] - ((weight[0] * corner[0][i] + weight[1] * corner[1][i]) +
                             (weight[2] * corner[2][i] + weight[3] * corner[3][i]));
    four distance = root(dot(away, away));
    cross(of.to_next, of.to_middle, normal);
    four height = share(dot(away, normal), root(dot(normal, normal)));
    *(four_anywhere *)parts->distance = distance;
    *(four_anywhere *)parts->height = height;
    store_rows(weight, parts->weight);
}

double lar_face_before_in_lanes(const double x[3], const double corner[4][3],
                                const double middle[3]) {
    triangles of;
    four normal[3];
    look_up(x, corner, middle, &of);
    cross(of.to_next, of.to_middle, normal);
    four volume = dot(of.to_x, normal), min = all(0);
    four la = root(dot(of.to_next, of.to_next)), lb = root(dot(of.to_middle, of.to_middle));
    four lc = root(dot(of.to_x, of.to_x));
    four areas = la * lb + lb * lc + lc * la, most = volume / areas;
    min = choose(volume > 0, volume / (areas + most * (la + lb + lc + most)), min);
    return fmin(fmin(fmin(INFINITY, min[0]), min[1]), fmin(min[2], min[3]));
}

/* ---- segments ------------------------------------------------------------------------------- */

/* A point of the segment and one of each triangle: the weights of its own corner and the next one
 * and, of the others, what each corner has of the middle. */
typedef struct candidate {
    four along, own, next, rest;
    four steady; /* where on the segment it is when it may not run away */
} candidate;

/* Not inlined: three of it take room, and no time. */
static __attribute__((noinline)) candidate candidate_of(const triangles *of, four along) {
    four wb, wc;
    closest_of(of, &wb, &wc);
    four rest = 0.25 * wc;
    return (candidate){along, rest + (1 - wb - wc), rest + wb, rest, along};
}

static inline four clamp(four x) {
    return choose(x < 0, all(0), choose(x > 1, all(1), x));
}

/* closest_of_segments (face_contact.c): the segment along `way` and edges along `to`, from the
 * triangles' own corners; `of` is seen from the segment's first end. `to` is shared with the next
 * one or with the middle. */
static __attribute__((noinline)) candidate edge_of(const triangles *of, const four way[3],
                                                   const four to[3], four stiff, bool middle) {
    four a = dot(way, way), e = dot(to, to), f = dot(to, of->to_x), c = dot(way, of->to_x);
    four b = dot(way, to), denominator = a * e - b * b;
    four s = choose(denominator > 0, clamp((b * f - c * e) / denominator), all(0));
    four t = choose(e > 0, (b * s + f) / e, all(0)), part = clamp(t);
    s = choose((t < 0) | (t > 1), choose(a > 0, clamp((b * part - c) / a), all(0)), s);
    four pull = stiff * (0.5 * b - c), whole = a * (e + stiff);
    four at = clamp((b * f - c * e + pull) / (whole - b * b));
    four on = choose(e > 0, clamp((b * at + f) / e), all(0));
    four steady = clamp(((b * on - c) * e + pull) / whole);
    four rest = middle ? 0.25 * part : all(0);
    return (candidate){s, rest + (1 - part), 0 + (middle ? rest : part), rest, steady};
}

/* The edge to the middle that a triangle shares with the next one. */
static inline candidate from_next(const candidate *of) {
    return (candidate){MIX(of->along, of->along, 1, 2, 3, 0), MIX(of->rest, of->rest, 1, 2, 3, 0),
                       MIX(of->own, of->own, 1, 2, 3, 0), MIX(of->rest, of->rest, 1, 2, 3, 0),
                       MIX(of->steady, of->steady, 1, 2, 3, 0)};
}

/* Of x, a point of the segment's line, over the planes. */
static inline four height_of(const double x[3], const triangles *of, const four normal[3]) {
    four away[3];
    for (int i = 0; i < 3; i++) away[i] = x[i] - of->middle[i];
    return share(dot(away, normal), root(dot(normal, normal)));
}

/* The point of each triangle that is closest to a point of the segment. `of` is seen from there
 * then. */
static candidate station_at(const lar_segment *segment, const four way[3], four along,
                            triangles *of) {
    for (int i = 0; i < 3; i++) {
        of->x[i] = segment->end[0][i] + along * way[i];
        of->to_x[i] = of->x[i] - of->own[i];
    }
    return candidate_of(of, along);
}

/* Where the segment goes through triangles: nowhere of others. Whether it does through a plane. */
static inline bool crossing(const lar_segment *segment, const four way[3], triangles *of,
                            four_bits *crosses, candidate *out) {
    four normal[3];
    cross(of->to_next, of->to_middle, normal);
    four below = height_of(segment->end[0], of, normal);
    four above = height_of(segment->end[1], of, normal);
    *crosses = below * above < 0;
    if (!__builtin_ia32_movmskpd256((four)*crosses)) return false;
    *out = station_at(segment, way, choose(*crosses, below / (below - above), all(NAN)), of);
    return true;
}

/* What is offered, how far each is, and how many there are. */
typedef struct offers {
    candidate of[6];
    four far[6];
    int count;
} offers;

/* What is closest of these, and the way there. */
typedef struct closest_yet {
    candidate of;
    four away[3], distance;
} closest_yet;

/* The first of equals. Not inlined, as above. */
static __attribute__((noinline)) void closest_offer(const lar_segment *segment, const four way[3],
                                                    const double corner[4][3], offers *list,
                                                    closest_yet *best) {
    *best = (closest_yet){.distance = all(INFINITY)};
    for (int k = 0; k < list->count; k++) {
        const candidate *at = &list->of[k];
        four weight[4], to[3];
        corners_of(at->own, at->next, at->rest, weight);
        for (int i = 0; i < 3; i++)
            to[i] = ((weight[0] * corner[0][i] + weight[1] * corner[1][i]) +
                     (weight[2] * corner[2][i] + weight[3] * corner[3][i])) -
                    (segment->end[0][i] + at->along * way[i]);
        four far = root(dot(to, to));
        list->far[k] = far;
        four_bits closer = far < best->distance;
        best->distance = choose(closer, far, best->distance);
        best->of.along = choose(closer, at->along, best->of.along);
        best->of.own = choose(closer, at->own, best->of.own);
        best->of.next = choose(closer, at->next, best->of.next);
        best->of.rest = choose(closer, at->rest, best->of.rest);
        for (int i = 0; i < 3; i++) best->away[i] = choose(closer, to[i], best->away[i]);
    }
}

/* Of triangles that are `steady` the point over the mean of the stations (face_contact.c), of
 * others what is closest. */
static inline void hold_steady(const lar_segment *segment, const four way[3],
                               const double corner[4][3], triangles *of, offers *list,
                               four_bits steady, double reach, closest_yet *best) {
    four least = 0.5 * (reach + best->distance), sum = all(0), along = all(0);
    for (int k = 0; k < 5; k++) {
        four count = least - list->far[k];
        count = choose(count > 0, count, all(0));
        sum += count;
        along += count * list->of[k].steady;
    }
    candidate mean = station_at(segment, way, along / sum, of);
    list->of[0].along = choose(steady, mean.along, best->of.along);
    list->of[0].own = choose(steady, mean.own, best->of.own);
    list->of[0].next = choose(steady, mean.next, best->of.next);
    list->of[0].rest = choose(steady, mean.rest, best->of.rest);
    list->count = 1;
    four min = best->distance;
    closest_offer(segment, way, corner, list, best);
    best->distance = choose(steady, best->distance, min);
}

double lar_face_segment_in_lanes(const lar_segment *segment, const double corner[4][3],
                                 const double middle[3], double reach,
                                 lar_face_segment closest[4]) {
    triangles of[2];
    offers list = {.count = 0};
    closest_yet best;
    four way[3], weight[4];
    four_bits crosses = {0};
    for (int i = 0; i < 3; i++) way[i] = all(segment->end[1][i] - segment->end[0][i]);
    bool is_point = lar_segment_is_point(segment);
    for (int e = 0; e < (is_point ? 1 : 2); e++) {
        look_up(segment->end[e], corner, middle, &of[e]);
        list.of[list.count++] = candidate_of(&of[e], all(e));
    }
    if (!is_point) {
        const four stiff = all(0.5 * reach * reach);
        list.of[2] = edge_of(&of[0], way, of[0].to_next, stiff, false);
        list.of[3] = edge_of(&of[0], way, of[0].to_middle, stiff, true);
        list.of[4] = from_next(&list.of[3]);
        list.count = crossing(segment, way, &of[0], &crosses, &list.of[5]) ? 6 : 5;
    }
    closest_offer(segment, way, corner, &list, &best);
    four min = best.distance;
    four_bits steady = (min < reach) & ~crosses;
    if (!is_point && __builtin_ia32_movmskpd256((four)steady))
        hold_steady(segment, way, corner, &of[0], &list, steady, reach, &best);
    corners_of(best.of.own, best.of.next, best.of.rest, weight);
    for (int i = 0; i < 3; i++) best.away[i] = share(best.away[i], best.distance);
    for (int t = 0; t < 4; t++) {
        closest[t].distance = best.distance[t];
        closest[t].along = best.of.along[t];
        for (int a = 0; a < 4; a++) closest[t].weight[a] = weight[a][t];
        for (int i = 0; i < 3; i++) closest[t].normal[i] = best.away[i][t];
    }
    return fmin(fmin(min[0], min[1]), fmin(min[2], min[3]));
}

/* ---- grids ---------------------------------------------------------------------------------- */

void lar_face_grid_in_lanes(const lar_segment *segment, const double corner[4][3],
                            const lar_face_grid *grid, double within, lar_face_near *near) {
    const int count = grid->count;
    uint64_t points = 0;
    four x[4][3], from[3], way[3], whole = all(0), min = all(INFINITY);
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 4; a++) x[a][i] = all(corner[a][i]);
        from[i] = all(segment->end[0][i]);
        way[i] = all(segment->end[1][i] - segment->end[0][i]);
        whole += way[i] * way[i];
    }
    for (int p = 0; p < count; p += 4) { /* lar_face_mean, lar_segment_away */
        four weight[4], away[3], dot = all(0), square = all(0);
        for (int a = 0; a < 4; a++) weight[a] = *(const four_anywhere *)&grid->weight[a][p];
        for (int i = 0; i < 3; i++) {
            away[i] = ((weight[0] * x[0][i] + weight[1] * x[1][i]) +
                       (weight[2] * x[2][i] + weight[3] * x[3][i])) -
                      from[i];
            dot += way[i] * away[i];
        }
        four t = choose(dot < whole, dot / whole, all(1));
        t = choose((dot > 0) & (whole > 0), t, all(0));
        for (int i = 0; i < 3; i++) {
            away[i] -= t * way[i];
            square += away[i] * away[i];
        }
        min = choose(square < min, square, min);
        unsigned some = (unsigned)__builtin_ia32_movmskpd256((four)(square < within));
        if (!some) continue;
        points |= (uint64_t)some << p;
        for (int i = 0; i < 3; i++) *(four_anywhere *)&near->away[i][p] = away[i];
        *(four_anywhere *)&near->along[p] = t;
        *(four_anywhere *)&near->square[p] = square;
    }
    double least = min[0];
    for (int t = 1; t < 4; t++) least = min[t] < least ? min[t] : least;
    near->points = points & ((UINT64_C(1) << count) - 1);
    near->least = least;
}
