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

/* Weights of the face's corners, for each triangle. */
static inline void weights_of(four wb, four wc, four weight[4]) {
    four rest = 0.25 * wc, next = rest + wb, own = rest + (1 - wb - wc);
    weight[0] = MIX(MIX(rest, own, 4, 1, 2, 3), next, 0, 1, 2, 7);
    weight[1] = MIX(MIX(rest, own, 0, 5, 2, 3), next, 4, 1, 2, 3);
    weight[2] = MIX(MIX(rest, own, 0, 1, 6, 3), next, 0, 5, 2, 3);
    weight[3] = MIX(MIX(rest, own, 0, 1, 2, 7), next, 0, 1, 6, 3);
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
